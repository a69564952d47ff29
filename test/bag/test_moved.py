# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""States of a drive stepped again: a swing through toggles of which a bag holds any part."""
from types import SimpleNamespace

from fourbar_ros.bag.comparison.inputs import DriveStates
from fourbar_ros.dynamics.step.mover import NAME, name_of
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.drive_states import columns_of, STEP
from support.samples import some
from support.scenes import PAPER, RODS

ROCKER = {**PAPER, **RODS, 'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.source': 'motor',
          'motor.stall_torque': 20.0, 'motor.free_speed': 30.0, 'shaft.stiffness': 400.0,
          'shaft.damping': 2.0, 'motor.rotor_inertia': 0.1,
          'drive.start': -0.5, 'drive.rate': 200.0, 'outputs': ['state']}


@pytest.fixture(scope='module')
def swing():
    """Return rows (status, mode, values) of a swing through several toggles."""
    mover = from_values(ROCKER).mover
    values = mover.start()
    rows = [(0, mover.mode, values)]
    for _ in range(450):
        status, values = mover.next(values, 1e-9 * STEP)
        rows.append((status, mover.mode, values))
    assert np.count_nonzero(np.diff([mode for _, mode, _ in rows])) >= 3
    return rows


def moved(*columns, values=ROCKER):
    """Return the DriveStates that has compared columns."""
    scene = from_values(values)
    found = DriveStates(scene, name_of(scene.linkage))
    for block in columns:
        found.compare([block])
    return found


def test_a_whole_swing_is_stepped_again(swing):
    found = moved(columns_of(swing[:150]), columns_of(swing[150:], 150))
    assert set(found.largest.values()) == {0.0}
    assert (found.compared, found.alone, found.unknown) == (len(swing) - 1, 1, 0)


@some('stride', [207, 69], 1)
def test_a_bag_may_begin_anywhere_and_miss_states(swing, stride):
    mover = from_values(ROCKER).mover
    told = [mover.tells_all(mover.place(mover.state(values), mode)) for _, mode, values in swing]
    assert 0.3 < np.mean(told) < 0.95
    for first in range(3, len(swing) - 100, stride):
        found = moved(columns_of(swing[first:], first))
        assert set(found.largest.values()) == {0.0}
        assert found.unknown == told[first:].index(True) and found.alone == 1
        assert found.compared == len(swing) - first - 1 - found.unknown
        # states are missing too
        found = moved(columns_of(swing[:first]), columns_of(swing[first + 2:], first + 2))
        assert set(found.largest.values()) == {0.0}
        assert found.unknown == told[first + 2:].index(True)


@some('field', ['position', 'acceleration', 'torque'], 1)
def test_what_was_not_so_is_found_also_next_to_a_toggle(swing, field):
    changes = np.flatnonzero(np.diff([mode for _, mode, _ in swing]))
    for place in changes[:3].tolist():
        status, mode, values = swing[place]
        wrong = values._replace(**{field: getattr(values, field) + 1e-9})
        found = moved(columns_of([*swing[:place], (status, mode, wrong), *swing[place + 1:]]))
        assert 1e-10 < found.largest[field] < 1.0
        other = moved(columns_of([*swing[:place], (status, 3 - mode, values),
                                  *swing[place + 1:]]))
        assert other.largest['mode'] == np.inf


def test_bags_of_before_are_stepped_again_where_there_are_no_toggles(swing):
    crank = {**ROCKER, **PAPER}
    mover = from_values(crank).mover
    rows = [(0, mover.mode, mover.start())]
    rows.append((*mover.next(rows[0][2], 1e-9 * STEP), mover.mode))
    rows[1] = rows[1][0], rows[1][2], rows[1][1]
    found = DriveStates(from_values(crank), NAME)
    found.compare([columns_of(rows)])
    assert (found.compared, set(found.largest.values())) == (1, {0.0})
    found = DriveStates(from_values(ROCKER), NAME)        # which held the input at its toggles
    found.compare([columns_of(swing[:20])])
    assert found.compared == 0 and found.alone == 20


def test_torques_of_two_layouts_are_taken_in_the_order_of_the_bag():
    """Columns hold messages of one length; of stamps with two names of frames there are two."""
    pushed = {**ROCKER, **PAPER, 'drive.source': 'torque'}
    mover = from_values(pushed).mover
    torques, rows = np.linspace(-3.0, 5.0, 20), [(0, mover.mode, mover.start())]
    for torque in torques.tolist():
        status, values = mover.next(rows[-1][2], 1e-9 * STEP, torque)
        rows.append((status, mover.mode, values))
    states = columns_of(rows)
    states.places[:] *= 2                       # torque, state, torque, state, ...
    found = DriveStates(from_values(pushed), name_of(from_values(pushed).linkage))
    found.commands([SimpleNamespace(
        places=2 * np.arange(20)[part] + 1,
        tree=SimpleNamespace(wrench=SimpleNamespace(torque=SimpleNamespace(z=torques[part]))))
        for part in (slice(0, None, 2), slice(1, None, 2))])
    found.compare([states])
    assert found.compared == 20 and set(found.largest.values()) == {0.0}
