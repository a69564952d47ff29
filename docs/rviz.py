# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Draw what RViz shows of a scene, without RViz or a display: ``python docs/rviz.py [SCENE ...]``.

A node runs the scene and records a bag; everything is drawn from the messages in that bag alone:
the URDF in ``robot_description``, posed by ``joint_states`` with yourdfpy's forward kinematics;
markers and traces, seen from above, as the RViz layout shows them. docs/images/rviz_SCENE.png.
"""
import json
from math import hypot
import os
from pathlib import Path
import signal
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

import matplotlib

matplotlib.use('agg')

from matplotlib.patches import Circle, PathPatch, Polygon  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.textpath import TextPath  # noqa: E402
from matplotlib.transforms import Affine2D  # noqa: E402
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: E402
import numpy as np  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from fourbar_ros.bag.reader import Bag  # noqa: E402, I100
from fourbar_ros.scene.files import read_values  # noqa: E402
from fourbar_ros.scene.topics import PICTURES  # noqa: E402

SHOWN = {'paper': 1.0, 'slider_crank': 1.0, 'jansen': 0.8}      # scene: input in the picture [rad]
PATIENCE = 60.0                     # [s] for the bag
PALETTE = ((0.36, 0.54, 0.74), (0.80, 0.55, 0.30), (0.45, 0.65, 0.45), (0.70, 0.45, 0.60),
           (0.55, 0.55, 0.55))
LIGHT = np.array([0.3, -0.4, 0.87])
ADD = 0                     # of actions
ARROW, CUBE, LINE_STRIP, LINE_LIST, SPHERE_LIST, TEXT = 0, 1, 4, 5, 7, 9


# --- a bag ---------------------------------------------------------------------------------------

def parameters(scene, name, folder):
    """Return the parameters of a scene that moves by itself and records its pictures."""
    values = read_values(scene)
    shown = [name for name in ('joint_states', 'loads') if name in values['outputs']]
    return values | {
        'drive.source': 'timer', 'drive.speed': 4.0, 'drive.rate': 100.0,
        'outputs': [*dict.fromkeys(('joint_states', *shown, *PICTURES))], 'pictures.rate': 0.0,
        'recording.start': True, 'recording.name': name, 'recording.directory': str(folder)}


def recorded(scene, name, folder, seconds=3.0):
    """Run the node of a scene for some time and return its bag."""
    file, bag = Path(folder) / f'{name}.yaml', Path(folder) / name
    file.write_text(json.dumps({'/**': {'ros__parameters': parameters(scene, name, folder)}}))
    node = subprocess.Popen([sys.executable, '-m', 'fourbar_ros.ros.node.start', '--ros-args',
                             '--params-file', str(file)], cwd=folder,
                            env={**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)})
    end = time.monotonic() + PATIENCE
    while not bag.exists() and time.monotonic() < end and node.poll() is None:
        time.sleep(0.1)
    time.sleep(seconds)
    node.send_signal(signal.SIGTERM)
    if node.wait() or not bag.exists():
        raise SystemExit(f'{name}: the node recorded no bag')
    return bag


class Seen(NamedTuple):
    """The messages of one pose, and the latched ones."""

    description: str
    joints: dict
    markers: list
    traces: list


def seen(bag, position):
    """Return what a bag shows where its first joint is nearest to a position [rad]."""
    by_topic = {}
    for record in Bag(bag).records():
        by_topic.setdefault(record.topic, []).append(record.message)
    joints = min(by_topic['/joint_states'],
                 key=lambda message: abs(np.sin(0.5 * (message.position[0] - position))))
    stamp = joints.header.stamp.sec, joints.header.stamp.nanosec
    markers = next(message.markers for message in by_topic['/fourbar/markers']
                   if (message.markers[0].header.stamp.sec,
                       message.markers[0].header.stamp.nanosec) == stamp)
    return Seen(by_topic['/robot_description'][-1].data, dict(zip(joints.name, joints.position)),
                markers, by_topic['/fourbar/traces'][-1].markers)


# --- the URDF ------------------------------------------------------------------------------------

def draw_robot(ax, what):
    """Draw the shapes of the URDF in the pose of the joint states."""
    from io import StringIO

    from yourdfpy import URDF
    robot = URDF.load(StringIO(what.description))
    robot.update_cfg({name: what.joints[name] for name in robot.actuated_joint_names})
    corners = []
    for number, mesh in enumerate(robot.scene.dump()):
        light = 0.55 + 0.45 * np.abs(mesh.face_normals @ (LIGHT / np.linalg.norm(LIGHT)))
        colour = np.clip(np.outer(light, PALETTE[number % len(PALETTE)]), 0.0, 1.0)
        ax.add_collection3d(Poly3DCollection(mesh.triangles, facecolors=colour,
                                             edgecolors=colour, linewidths=0.1))
        corners.append(mesh.bounds)
    low, high = np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))
    middle, half = 0.5 * (low + high), 0.5 * max(high - low)
    flat = 0.2 * half
    ax.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half),
           zlim=(middle[2] - flat, middle[2] + flat))
    ax.set_proj_type('ortho')
    ax.set_box_aspect((1.0, 1.0, flat / half), zoom=1.1)
    ax.view_init(elev=60.0, azim=-80.0)
    ax.set_axis_off()
    ax.set_title('robot_description and joint_states')


# --- markers -------------------------------------------------------------------------------------

def stroke(ax, one, other, width, **style):
    """Draw a line of a width in metres between two places."""
    along = np.subtract(other, one)
    length = hypot(*along)
    if length:
        across = 0.5 * width / length * np.array([-along[1], along[0]])
        ax.add_patch(Polygon([one + across, other + across, other - across, one - across],
                             lw=0.0, **style))


def arrow(ax, one, other, scale, style):
    """Draw an arrow as RViz does: shaft, head, their diameters and the length of the head."""
    along = np.subtract(other, one)
    length = hypot(*along)
    if length < scale.y:                       # along z: seen from its end
        ax.add_patch(Circle(one, 0.5 * scale.y, **style))
        return
    neck = other - min(scale.z, 0.5 * length) / length * along
    stroke(ax, one, neck, scale.x, **style)
    across = 0.5 * scale.y / length * np.array([-along[1], along[0]])
    ax.add_patch(Polygon([neck + across, other, neck - across], lw=0.0, **style))


def draw_marker(ax, marker, order):
    """Draw a marker, seen from above; none that takes others away."""
    if marker.action != ADD:
        return
    style = {'color': (marker.color.r, marker.color.g, marker.color.b), 'zorder': order,
             'alpha': marker.color.a}
    places = [np.array((point.x, point.y)) for point in marker.points]
    at = np.array((marker.pose.position.x, marker.pose.position.y))
    if marker.type == ARROW:
        arrow(ax, *places, marker.scale, style)
    elif marker.type in (LINE_LIST, LINE_STRIP):
        step = 2 if marker.type == LINE_LIST else 1
        for one, other in zip(places[::step], places[1::step]):
            stroke(ax, one, other, marker.scale.x, **style)
    elif marker.type == SPHERE_LIST:
        for place in places:
            ax.add_patch(Circle(place, 0.5 * marker.scale.x, lw=0.0, **style))
    elif marker.type == CUBE:
        turn = complex(marker.pose.orientation.w, marker.pose.orientation.z)**2
        way = 0.5 * marker.scale.x * np.array([turn.real, turn.imag])
        stroke(ax, at - way, at + way, marker.scale.y, **style)
    elif marker.type == TEXT:
        text = TextPath((0.0, 0.0), marker.text, size=marker.scale.z)
        box = text.get_extents()
        middle = 0.5 * np.array([box.x0 + box.x1, 0.7 * marker.scale.z])
        ax.add_patch(PathPatch(text.transformed(Affine2D().translate(*(at - middle))), lw=0.0,
                               **style))
    else:
        raise SystemExit(f'{marker.ns}: a marker of type {marker.type}')


def draw_markers(ax, what):
    """Draw traces and markers, seen from above."""
    for marker in what.traces:
        draw_marker(ax, marker, 2)
    for marker in what.markers:
        draw_marker(ax, marker, 3 if marker.type != ARROW else 5)
    ax.set_aspect('equal')
    ax.autoscale_view()
    ax.margins(0.15, 0.08)
    ax.grid(color='0.9', lw=0.6, zorder=0)
    ax.set(xlabel='x [m]', ylabel='y [m]', title='markers and traces, from above')


def draw(scene, out, position=1.0):
    """Write the picture of a scene, a file or a name, into a folder; return its path."""
    name = Path(scene).stem
    with tempfile.TemporaryDirectory() as folder:
        what = seen(recorded(scene, name, folder), position)
    figure = plt.figure(figsize=(11.0, 4.5), layout='constrained')
    left, right = figure.add_gridspec(1, 2, width_ratios=(2, 3))
    draw_robot(figure.add_subplot(left, projection='3d'), what)
    draw_markers(figure.add_subplot(right), what)
    path = Path(out) / f'rviz_{name}.png'
    figure.savefig(path, dpi=110, bbox_inches='tight')
    plt.close(figure)
    return path


if __name__ == '__main__':
    for scene in sys.argv[1:] or SHOWN:
        print(draw(scene, ROOT / 'docs' / 'images', SHOWN.get(scene, 1.0)))
