# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A mechanism moving through a cycle, as an animated GIF."""
from contextlib import suppress
from pathlib import Path

from fourbar_lab.drawing.cycles import cycles, usual_points
from fourbar_lab.drawing.figure import CannotDraw, new_figure, writing
from fourbar_lab.drawing.mechanism_panel import draw_diagram, POINT
from fourbar_lab.drawing.sheet import Sheet
from fourbar_ros import FourBarError, Mechanism, point_motion
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import arms_of, diagram_of, Points
import numpy as np

FRAMES, PER_SECOND = 90, 25


def animate(mechanism: Mechanism, rate: float, points: Points, path: str | Path) -> Path:
    """Write a cycle as .gif, in the sense of ``rate``, and return the path; or CannotDraw."""
    from matplotlib.animation import FuncAnimation
    path, points = Path(path), usual_points(mechanism, points)
    if path.suffix != '.gif':
        raise CannotDraw(f'{path}: an animation is a .gif')
    inputs, poses = cycles(mechanism, FRAMES)[0], list[NamedFields]()
    if mechanism.turns_fully:           # the end of the cycle is its beginning
        inputs = inputs[:-1] if rate >= 0.0 else inputs[:0:-1]
    else:                               # every second pose on the way up, the others down
        inputs = np.concatenate([inputs[::2], inputs[-2:0:-2]])
    for position in inputs:
        with suppress(FourBarError):    # a singular pose has no rates
            poses.append(mechanism.motion(float(position), rate))
    paths = [np.array([point_motion(mechanism, motion, *point).place for motion in poses])
             for point in points.values()]
    joints = [joint for motion in poses for joint in diagram_of(mechanism, motion).joints.values()]
    with new_figure(6.4, 4.8) as figure:
        figure.page_width = None            # all frames are of one size
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))

        def draw(motion: NamedFields) -> None:
            axes.clear()
            sheet = Sheet(axes, [*joints, *np.concatenate([np.empty((0, 2)), *paths])], '')
            for curve in paths:
                closed = np.vstack([curve, curve[:1]]) if mechanism.turns_fully else curve
                axes.plot(*closed.T, color=POINT, lw=1.2, zorder=1.5)
            draw_diagram(sheet, diagram_of(mechanism, motion), arms_of(mechanism, motion, points))

        moving = FuncAnimation(figure, draw, frames=poses, blit=False)
        with writing(path):
            moving.save(path, writer='pillow', fps=PER_SECOND, dpi=100)
    return path
