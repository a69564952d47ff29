# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loops of real robots: what a mimic joint and MuJoCo's connect with the file's settings lose."""
from math import pi, tau
from typing import NamedTuple
from xml.etree import ElementTree

from fourbar_ros.description import describe
from fourbar_ros.scene import from_values, read_values
import numpy as np
from scipy.optimize import minimize_scalar

from .pages import table

SAMPLES = 401


class Settings(NamedTuple):
    """Of the robot's own file: of its connect or weld, and its time step [s]."""

    solref: str = '0.02 1'
    solimp: str = '0.9 0.95 0.001'
    step: float = 0.002
    rate: float = 1.0       # [Hz], of a motion over nine tenths of the range


ROBOTS = {
    'xarm_hand': Settings('0.005 1'),
    'robotiq_2f85': Settings('0.005 1', '0.95 0.99 0.001'),
    'cassie_foot': Settings('0.005 1', step=0.0005),
    'toddlerbot_knee': Settings('0.004 1', '0.9999 0.9999 0.001 0.5 2'),
    'excavator_bucket': Settings(rate=0.25),
}


class Tree:
    """The tree of a scene in MuJoCo, its joints in the order of the scene's, loops cut at pins."""

    def __init__(self, scene, settings=None):
        import mujoco
        root = ElementTree.fromstring(describe(scene, 'mjcf'))
        for joint in root.iter('joint'):
            joint.attrib.pop('range', None)
        if settings:
            root.find('option').set('timestep', str(settings.step))
            for connect in root.iter('connect'):
                connect.set('solref', settings.solref)
                connect.set('solimp', settings.solimp)
        self.mujoco, self.linkage = mujoco, scene.linkage
        self.model = mujoco.MjModel.from_xml_string(ElementTree.tostring(root, 'unicode'))
        self.data = mujoco.MjData(self.model)
        known = {self.model.joint(i).name: i for i in range(self.model.njnt)}
        # (index in MuJoCo, coordinate, ratio, offset) of the joints of the tree, the driven first
        self.joints = sorted(((known[name], joint.coordinate, ratio, offset)
                              for name, joint, ratio, offset in zip(
                                  scene.joint_names, scene.linkage.JOINTS,
                                  scene.joint_states.ratios, scene.joint_states.offsets)
                              if name in known),
                             key=lambda joint: joint[1] != scene.linkage.input_coordinate)
        self.pins = [(self.model.site(pin.get('site1')).id, self.model.site(pin.get('site2')).id)
                     for pin in root.iter('connect')]

    def exact(self, x, rate=0.0, acceleration=0.0):
        """Return positions, rates and accelerations of MuJoCo's joints by the linkage."""
        motion, found = self.linkage.motion(x, rate, acceleration), np.zeros((3, self.model.nq))
        for i, coordinate, ratio, offset in self.joints:
            position, *others = (getattr(motion, name) for name in coordinate)
            found[:, i] = ratio * position + offset, *(ratio * other for other in others)
        return found

    def gap(self):
        """Return the largest distance of two points of a pin [m] in the pose of the data."""
        return max(float(np.linalg.norm(self.data.site_xpos[i] - self.data.site_xpos[j]))
                   for i, j in self.pins)


def load_of(linkage, *given):
    return getattr(linkage.loads(*given), linkage.drive_load)


def mimic(tree, low, high):
    """Return the error of the best straight line of the worst passive pin [deg]."""
    x, worst = np.linspace(low, high, SAMPLES), 0.0
    for _, coordinate, *_ in tree.joints[1:]:
        if coordinate.unit == 'rad':
            y = np.unwrap(getattr(tree.linkage.motion(x), coordinate.position))
            slope = float(np.polyfit(x, y, 1)[0])
            best = minimize_scalar(lambda s, y=y: float(np.ptp(y - s * x)),
                                   (0.9 * slope - 1e-3, 1.1 * slope + 1e-3))
            worst = max(worst, 0.5 * best.fun)
    return np.degrees(worst)


def ours(tree, low, high):
    """Return pin gap [m] and error of the drive (share of its peak) beside MuJoCo's own tree."""
    mujoco, data, gaps, errors, sizes = tree.mujoco, tree.data, [], [], []
    for x in np.linspace(low, high, 43)[1:-1]:
        found = tree.exact(float(x), 2.0 * (high - low), 3.0 * (high - low))
        slopes = tree.exact(float(x), 1.0)[1]
        data.qpos, data.qvel, data.qacc = found
        mujoco.mj_fwdPosition(tree.model, data)
        mujoco.mj_fwdVelocity(tree.model, data)
        gaps.append(tree.gap())
        forces = np.zeros(tree.model.nv)
        mujoco.mj_rne(tree.model, data, 1, forces)          # of the tree, cut: virtual work
        sizes.append(load_of(tree.linkage, float(x), 2.0 * (high - low), 3.0 * (high - low)))
        errors.append(abs(sizes[-1] - forces @ slopes))
    return max(gaps), max(errors) / max(map(abs, sizes))


def simulated(tree, low, high, settings):
    """Return pin gap [m], angle [deg] and error of the drive (share) of a motion with connect."""
    mujoco, model, data, linkage = tree.mujoco, tree.model, tree.data, tree.linkage
    middle, reach, speed = 0.5 * (low + high), 0.45 * (high - low), tau * settings.rate
    i, _, ratio, offset = tree.joints[0]
    mass, stiff = float(linkage.inertia(middle)), 0.15 / settings.step
    data.qpos = tree.exact(middle - reach)[0]
    gaps, angles, errors, sizes = [], [], [], []
    for _ in range(round(2.0 / settings.rate / settings.step)):
        phase = speed * data.time
        wanted = middle - reach * np.cos(phase), reach * speed * np.sin(phase)
        x, v = (data.qpos[i] - offset) / ratio, data.qvel[i] / ratio
        data.ctrl = load_of(linkage, *map(float, (*wanted, reach * speed**2 * np.cos(phase)))) + (
            mass * stiff * (stiff * (wanted[0] - x) + 2.0 * (wanted[1] - v)))
        mujoco.mj_forward(model, data)
        if data.time > 1.0 / settings.rate:
            exact = tree.exact(float(x))[0]
            gaps.append(tree.gap())
            angles += [abs(np.remainder(data.qpos[j] - exact[j] + pi, tau) - pi)
                       for j, coordinate, *_ in tree.joints[1:] if coordinate.unit == 'rad']
            sizes.append(load_of(linkage, *map(float, (x, v, data.qacc[i] / ratio))))
            errors.append(abs(data.ctrl[0] - sizes[-1]))
        mujoco.mj_step(model, data)
    return max(gaps), np.degrees(max(angles)), max(errors) / max(map(abs, sizes))


def main():
    """Print one row for each robot."""
    rows = []
    for name, settings in ROBOTS.items():
        scene = from_values(read_values(name))
        low, high = scene.linkage.input_ranges[0]
        gap, force = ours(Tree(scene), low, high)
        soft = simulated(Tree(scene, settings), low, high, settings)
        rows.append((name, f'{mimic(Tree(scene), low, high):.2g}', f'{1e3 * soft[0]:.2g}',
                     f'{soft[1]:.2g}', f'{100.0 * soft[2]:.2g}', f'{gap:.1g}', f'{force:.1g}'))
    table(('scene', 'best `<mimic>` [deg]', '`connect`: pin gap [mm]', 'angle [deg]',
           'drive [% of peak]', 'ours: pin gap [m]', 'drive [share of peak]'), rows)
    print('`<mimic>`: the straight line with the least largest error, of the worst passive pin '
          'over the range. `connect`: MuJoCo with time step, solref and solimp of the file of the '
          'robot (of the excavator the defaults), a controlled motion over nine tenths of the '
          'range at 1 Hz, of the excavator at 0.25 Hz; passive angles and drive beside the exact '
          'ones at the position, rate and acceleration that the drive has. Ours: joint_states put '
          'into the tree of MuJoCo, and the drive beside virtual work of its recursive '
          'Newton-Euler. Springs, damping, friction, armature and contacts are left out '
          'everywhere.\n')
