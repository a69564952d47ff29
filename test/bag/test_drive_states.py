# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""States of a drive stepped again: a swing through toggles of which a bag holds any part."""
from types import SimpleNamespace

from fourbar_ros.bag.drive_states import DriveStates
from fourbar_ros.dynamics.node_step import KEY, NAME
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.samples import more, some
from support.scenes import PAPER, RODS

STEP = 5_000_000           # [ns]
ROCKER = {**PAPER, **RODS, 'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.source': 'motor',
          'motor.stall_torque': 20.0, 'motor.free_speed': 30.0, 'shaft.stiffness': 400.0,
          'shaft.damping': 2.0, 'motor.rotor_inertia': 0.1,
          'drive.start': -0.5, 'drive.rate': 200.0, 'outputs': ['state']}


def take_all(states, rows, first=0):
    """Give rows (status, mode, values) to DriveStates; ``first``: number of the first."""
    for k, (status, mode, values) in enumerate(rows, first + 1):
        states.take(k * STEP, SimpleNamespace(status=status, **values._asdict()),
                    mode)


def rows_of(values, count, torques=()):
    """Return rows (status, mode, values) of a drive that steps."""
    mover = from_values(values).mover
    rows = [(0, mover.mode, mover.start())]
    for torque in torques or [None] * count:
        status, found = mover.next(rows[-1][2], 1e-9 * STEP,
                                   *([] if torque is None else [torque]))
        rows.append((status, mover.mode, found))
    return rows


@pytest.fixture(scope='module')
def swing():
    """Return a swing through several toggles."""
    rows = rows_of(ROCKER, 450)
    assert np.count_nonzero(np.diff([mode for _, mode, _ in rows])) >= 3
    return rows


def moved(*parts, values=ROCKER, key=None):
    """Return the DriveStates that has compared parts, each (rows, number of the first)."""
    scene = from_values(values)
    found = DriveStates(scene, {KEY: key or NAME})
    for rows, first in parts:
        take_all(found, rows, first)
    return found


def test_a_whole_swing_is_stepped_again(swing):
    found = moved((swing, 0))
    assert set(found.largest.values()) == {0.0}
    assert (found.stepped, found.alone, found.unknown) == (len(swing) - 1, 1, 0)


def test_a_bag_may_begin_anywhere_and_miss_states(swing, stride=more(207, 69)):
    mover = from_values(ROCKER).mover
    told = [mover.is_told_by_message(mover.state_of(values, mode)) for _, mode, values in swing]
    assert 0.3 < np.mean(told) < 0.95
    for first in range(3, len(swing) - 100, stride):
        found = moved((swing[first:], first))
        assert set(found.largest.values()) == {0.0}
        assert found.unknown == told[first:].index(True) and found.alone == 1
        assert found.stepped == len(swing) - first - 1 - found.unknown
        found = moved((swing[:first], 0), (swing[first + 2:], first + 2))   # two are missing
        assert set(found.largest.values()) == {0.0}
        assert found.unknown == told[first + 2:].index(True)


@some('field', ['position', 'acceleration', 'torque'], 1)
def test_what_was_not_so_is_found_also_next_to_a_toggle(swing, field):
    changes = np.flatnonzero(np.diff([mode for _, mode, _ in swing]))
    for place in changes[:3].tolist():
        status, mode, values = swing[place]
        wrong = values._replace(**{field: getattr(values, field) + 1e-9})
        found = moved(([*swing[:place], (status, mode, wrong), *swing[place + 1:]], 0))
        assert 1e-10 < found.largest[field] < 1.0
        other = moved(([*swing[:place], (status, 3 - mode, values), *swing[place + 1:]], 0))
        assert other.largest['mode'] == np.inf


def test_bags_of_another_integrator_have_their_states_compared_one_by_one(swing):
    found = moved((swing[:20], 0), key='another')
    assert (found.stepped, found.alone) == (0, 20) and set(found.largest.values()) == {0.0}
    status, mode, values = swing[10]
    wrong = values._replace(acceleration=values.acceleration + 1e-3)
    found = moved(([*swing[:10], (status, mode, wrong)], 0), key=NAME)
    assert found.largest['acceleration'] == pytest.approx(1e-3, rel=1e-9)


def test_the_torque_in_effect_is_that_of_the_topic_cut_to_the_limit():
    pushed = {**ROCKER, **PAPER, 'drive.source': 'torque', 'drive.torque_limit': 4.0}
    torques = np.linspace(-3.0, 5.0, 20).tolist()
    rows = rows_of(pushed, 20, [min(torque, 4.0) for torque in torques])
    scene = from_values(pushed)

    def command(torque):
        return SimpleNamespace(wrench=SimpleNamespace(torque=SimpleNamespace(z=torque)))
    for wrong in (0.0, 0.125):
        found = DriveStates(scene, {KEY: NAME})
        take_all(found, rows[:1])
        for k, torque in enumerate(torques):
            found.command(command(torque + wrong))
            take_all(found, rows[k + 1:k + 2], k + 1)
        assert found.stepped == 20
        assert {field for field, apart in found.largest.items() if apart} == (
            {'command'} if wrong else set())
        assert found.largest['command'] == wrong
