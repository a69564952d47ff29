# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The loops of a robot's file as a file of scenes, with a report of what was read and left out."""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
import re
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import FourBarError, nearest
from fourbar_ros.importing.loops import loops_of, ROUNDED
from fourbar_ros.importing.machine import Imported, imported
from fourbar_ros.importing.robots import Refused, Robot, Wishes, word
from fourbar_ros.optional import MissingPackage
from fourbar_ros.scene.files import as_text, DESCRIPTIONS, ROOT, text_of
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.importing.check import Checked  # which imports MuJoCo's reader


class Result(NamedTuple):
    """The imported loops, the lines of the report, each loop beside MuJoCo if that was asked."""

    loops: Sequence[Imported]
    report: Sequence[str]
    is_good: bool                   # nothing was refused, lacks mass or differs
    checks: Sequence[Checked] = ()

    @property
    def text(self) -> str:
        """Return the parameter file: a section for each loop, for any node if there is one."""
        texts = dict[str, str]()
        for loop in self.loops:
            node = word(loop.drive.name, 'loop') if len(self.loops) > 1 else '/**'
            while node in texts:
                node += '_2'
            texts[node] = ''.join(f'# {line}\n' for line in loop.report) + as_text(
                loop.values).replace('/**:', f'{node}:', 1)
        return '\n'.join(texts.values())


def read(path: Path, wishes: Wishes = Wishes()) -> Robot:
    """Return the robot of an MJCF or URDF in the pose that is asked for; Refused or SceneError."""
    root = ROOT.match(re.sub('<!--.*?-->', '', text_of(path), flags=re.DOTALL))
    format_ = DESCRIPTIONS.get(root[1]) if root else None
    if format_ == 'MJCF':
        from fourbar_ros.importing.mjcf import read_mjcf
        if wishes.close:
            raise Refused('--close: the loops of MJCF are its equality constraints')
        robot = read_mjcf(path, wishes)
    elif format_ == 'URDF':
        from fourbar_ros.importing.urdf import read_urdf
        robot = read_urdf(path, wishes)
        if not wishes.gravity:
            robot.notes.append('URDF has no gravity: taken as 9.80665 m/s^2 against z of the root '
                               '(--gravity)')
    elif format_ == 'SDF':
        raise Refused(f'{path}: is SDF, which is not read: take the URDF or MJCF of the robot')
    else:
        raise Refused(f'{path}: is neither MJCF nor URDF')
    if wishes.gravity:
        robot.gravity = np.array(wishes.gravity)
    return robot


def import_file(path: Path, wishes: Wishes = Wishes()) -> Result:
    """
    Return the planar loops of a robot's file as scenes.

    Raises SceneError if the file cannot be read, Refused if it has no loop that is asked for; a
    loop that cannot be imported is a line of the report.
    """
    robot = read(path, wishes)
    loops = loops_of(robot, wishes.lock, wishes.cut)
    plural = '' if len(loops) == 1 else 's'
    report = [f'{path.name}: {robot.format}, {len(robot.poses)} bodies, {len(loops)} loop{plural}',
              *(f' note: {note}' for note in robot.notes)]
    words = [{joint.name for joint in loop.joints} | {*map(loop.name_of, loop.links)}
             for loop in loops]
    joints = [joint.name for loop in loops for joint in loop.joints]
    for option, name, known in (('--loop', wishes.loop, {*joints}.union(*words)),
                                *(('--drive', each, joints) for each in wishes.drive)):
        if name and name not in known:
            why = ('is a link, not a joint' if option == '--drive' and name in robot.poses else
                   'no loop has it')
            raise Refused(f'{option} {name}: {why}{nearest(name, known)}')
    wanted = [(index, loop) for index, (loop, of_loop) in enumerate(zip(loops, words), 1)
              if not wishes.loop or wishes.loop in of_loop]
    if wishes.mode and len(wanted) > 1:
        raise Refused(f'--mode is of one of {len(wanted)} loops: say by --loop of which')
    results, checks, is_good = [], [], True
    for index, loop in wanted:
        report.append(f' loop {index}: {", ".join(joint.name for joint in loop.joints)}')
        try:
            results.append(imported(loop, wishes))
        except FourBarError as error:       # of the scene too
            report.append(f'  refused: {error}')
            is_good = False
            continue
        is_skew, is_same = results[-1].off_parallel > ROUNDED, not results[-1].unweighed
        if wishes.check or is_skew:     # nobody would ask what the angle between axes does
            try:
                checks.append(_compared(path, results[-1], wishes))
                compared = f'{checks[-1]}' + ('' if checks[-1].is_good else ': BAD')
                is_same = is_same and checks[-1].is_good
            except FourBarError as error:
                compared, is_same = f'not compared: {error}', False
            if is_skew:
                compared = (f'{"note" if is_same else "warning"}: the axes, which are not '
                            f'parallel, are taken as parallel: {compared}')
            results[-1].report.append(compared)
        is_good = is_good and is_same
        report += [f'  {line}' for line in results[-1].report]
    return Result(results, report, is_good, checks)


def _compared(path: Path, loop: Imported, wishes: Wishes) -> Checked:
    try:
        from fourbar_ros.importing.check import check, mujoco_of  # MuJoCo, which few need
        return check(*mujoco_of(path, loop.loop.robot), loop, wishes.cut)
    except ModuleNotFoundError as error:
        if wishes.check or not MissingPackage.explains(error):
            raise
        raise MissingPackage('import --check', error) from None
