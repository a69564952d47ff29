# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps that are made before they are due."""
from fourbar_ros import Bodies, FourBar, round_rod
from fourbar_ros.dynamics.drives import ConstantTorque, Drive, MotorLine, Shaft
from fourbar_ros.dynamics.mover import Mover, OK, SILENT
from fourbar_ros.dynamics.system import System
import pytest

RODS = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
PAPER = FourBar(0.4, 1.2, 0.8, 1.0, bodies=RODS, gravity=(0.0, -9.81))
TICK = 1e-3
DRIVES = {'torque': Drive(ConstantTorque(0.0), 0.5),
          'motor': Drive(MotorLine(400.0, 26.0), 0.5, shaft=Shaft(1e9, 100.0))}


def moved(drive, commands, ahead):
    """Return what a mover says step by step; ``ahead``: how often it works ahead, and for what."""
    mover = Mover(System(PAPER, 0.3, drive=DRIVES[drive]), 1e-6, 60, drive == 'torque')
    values, found = mover.start(), []
    for place, command in enumerate(commands):
        status, values = mover.next(values, TICK, command, place % 2 == 1)
        found.append((status, repr(values)))
        for step, torque in ahead:
            mover.work_ahead(values, step, torque)
    return found


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('ahead', [[(TICK, 5.0)], [(TICK, 7.0)], [(2.0 * TICK, 5.0)],
                                   [(TICK, 5.0), (TICK, 0.0)]], ids=str)
def test_what_is_made_ahead_is_given_only_where_it_is_what_was_asked_for(drive, ahead):
    commands = [5.0, 5.0, -5.0, 7.0, 5.0, 5.0]
    found = moved(drive, commands, ahead)
    assert found == moved(drive, commands, [])
    assert [status for status, _ in found] == [OK, SILENT] * 3


def test_a_step_made_ahead_is_not_made_again():
    mover = Mover(System(PAPER, 0.3, drive=DRIVES['motor']), 1e-6, 60, False)
    start = mover.start()
    ahead = mover.work_ahead(start, TICK)
    assert mover.next(start, TICK)[1] is ahead.values
    assert mover.next(start, 2.0 * TICK)[1] is not ahead.values
