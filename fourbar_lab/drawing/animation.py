# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A mechanism moving through a cycle, as an animated GIF or an MP4."""
from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from fourbar_lab.drawing.cycles import cycles, usual_points
from fourbar_lab.drawing.figure import CannotDraw, need_matplotlib, STYLE
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Bar, Block, NamedFields
from fourbar_ros.mechanisms.picture import Arm, Joint, picture, Pivot, Points
from fourbar_ros.mechanisms.points import point_motion
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.animation import AbstractMovieWriter
    from matplotlib.axes import Axes

FRAMES, PER_SECOND = 90, 25
INK, LINK, POINT = '#1c1c1c', '#5a6b7d', '#8a5200'
SIGNS = {Pivot: ('^', 13, 'w'), Joint: ('o', 6, 'w'), Block: ('s', 14, '#dfe5ec')}


def animate(mechanism: Mechanism, rate: float, points: Points, path: str | Path) -> Path:
    """
    Write a cycle of a mechanism as .gif or .mp4 and return the path.

    The input turns once in the sense of ``rate``, or goes back and forth over its first range.

    Raises
    ------
    CannotDraw
        Another suffix, no ffmpeg for .mp4, or the file cannot be written.

    """
    need_matplotlib('draw --animate')
    import matplotlib
    from matplotlib.animation import FuncAnimation
    from matplotlib.figure import Figure
    path = Path(path)
    writer, poses = _writer(path), _poses(mechanism, rate)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.8), layout='constrained')
        axes = figure.subplots()
        frame = _Frame(axes, mechanism, usual_points(mechanism, points), poses)
        moving = FuncAnimation(figure, frame.draw, frames=len(poses), blit=False)
        try:
            moving.save(path, writer=writer, dpi=100)
        except OSError as error:
            raise CannotDraw(f'{path}: {error.strerror or error}') from None
    return path


def _writer(path: Path) -> AbstractMovieWriter:
    """Return matplotlib's writer for the suffix of a path; raise CannotDraw for another one."""
    from matplotlib.animation import FFMpegWriter, PillowWriter
    if path.suffix == '.gif':
        return PillowWriter(fps=PER_SECOND)
    if path.suffix != '.mp4':
        raise CannotDraw(f'{path}: an animation is a .gif or an .mp4')
    if not FFMpegWriter.isAvailable():
        raise CannotDraw(f'{path}: .mp4 requires the program ffmpeg; .gif does not')
    return FFMpegWriter(fps=PER_SECOND)


def _poses(mechanism: Mechanism, rate: float) -> list[NamedFields]:
    """Return the motion of each frame; about FRAMES of them, so that a cycle closes."""
    inputs = cycles(mechanism, FRAMES)[0]
    if mechanism.turns_fully:           # the end of the turn is its beginning
        inputs = inputs[:-1] if rate >= 0.0 else inputs[:0:-1]
    else:                               # every second pose on the way up, the others down
        inputs = np.concatenate([inputs[::2], inputs[-2:0:-2]])
    poses = []
    for position in inputs:
        with suppress(FourBarError):    # a singular pose has no rates
            poses.append(mechanism.motion(float(position), rate))
    return poses


class _Frame:
    """Draws any of the poses into the axes, all at one scale, with the paths of the points."""

    def __init__(self, axes: Axes, mechanism: Mechanism, points: Points, poses: list[NamedFields]):
        self.axes, self.mechanism, self.points, self.poses = axes, mechanism, points, poses
        # {point: its places in all poses, shape (n, 2) [m]}
        self.paths = {name: np.array([point_motion(mechanism, motion, *point).place
                                      for motion in poses]) for name, point in points.items()}
        ends = [place for motion in poses
                for place in mechanism.diagram(motion).joints.values()]
        ends = np.concatenate([np.array(ends), *self.paths.values()])
        low, high = ends.min(axis=0), ends.max(axis=0)
        room = 0.08 * float(max(high - low))             # for the signs of joints at the edge
        self.limits = (low - room, high + room)          # corners that hold all poses [m]

    def draw(self, number: int) -> None:
        """Draw pose ``number`` in place of the last one: paths of points, links, joints, arms."""
        axes, motion = self.axes, self.poses[number]
        axes.clear()
        axes.set_axis_off()
        axes.set_aspect('equal')
        (left, bottom), (right, top) = self.limits
        axes.set(xlim=(left, right), ylim=(bottom, top))
        for path in self.paths.values():
            closed = np.vstack([path, path[:1]]) if self.mechanism.turns_fully else path
            axes.plot(*closed.T, color=POINT, lw=1.2)
        for part in picture(self.mechanism, motion, self.points):
            if isinstance(part, Bar):
                axes.plot(*zip(part.start, part.end), color=LINK, lw=5, solid_capstyle='round')
            elif isinstance(part, Arm):
                axes.plot(*zip(part.start, part.end), color=LINK, lw=2)
                axes.plot(*part.end, 'o', color=POINT, ms=5)
            else:
                sign, size, fill = SIGNS[type(part)]
                axes.plot(*part.place, sign, ms=size, mfc=fill, mec=INK)
