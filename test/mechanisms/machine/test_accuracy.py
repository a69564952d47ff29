# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Random machines of one to five dyads against 40 digits and one dense system of all bodies."""
from fourbar_ros import Body
from fourbar_ros.mechanisms.machine.describe.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import mpmath as mp
import numpy as np
import pytest
from support.dyad_reference import conditions, EPS, loads_of, motion_of, random_machines
from support.samples import some

# In eps times condition: positions, rates, accelerations; reactions, couples, drive.
MOTION_BOUND, LOADS_BOUND = 5.0, 10.0
ZERO = mp.mpf(10)**-30       # what is left of an exact zero


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(40):
        yield


def in_conditions(name, value, truth, condition):
    error = abs(truth - value)
    if name.startswith('theta'):
        error, condition = abs(mp.arg(mp.expj(truth - value))), max(condition, 1.0)
    if error < ZERO:
        return 0.0
    if not condition:        # no datum moves it: it must be an exact zero
        return np.inf if value else 0.0
    return float(error / (EPS * condition))


def first_of_many(machine, given):
    """Return motion and loads by the program for arrays, as numbers."""
    return [type(part)(*[float(np.ravel(field)[0]) for field in part])
            for part in machine.step(*(np.full(100, v) for v in given))]


def check_motion(machine, given, bound=MOTION_BOUND):
    truth, _, _ = motion_of(machine, given)
    cond = conditions(machine, given, False)
    assert set(truth) == {name for name in machine.MOTION._fields
                          if name.startswith(('theta', 'omega', 'alpha', 'slide', 'x_', 'y_'))
                          and not name.endswith('_ratio')} - (
        set(machine.input_coordinate) if machine.input == 'slide' else set())
    for motion in (machine.motion(*given), first_of_many(machine, given)[0]):
        wrong = {name: error for name, value in truth.items()
                 if not (error := in_conditions(name, mp.mpf(getattr(motion, name)), value,
                                                cond[name])) <= bound}
        assert not wrong, (machine, given)


def check_loads(machine, given):
    truth, cond = loads_of(machine, given), conditions(machine, given, True)
    for loads in (machine.loads(*given), first_of_many(machine, given)[1]):
        wrong = {}
        for name, value in truth.items():
            ours = (mp.mpc(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
                    if isinstance(value, mp.mpc) else mp.mpf(getattr(loads, name)))
            error = in_conditions(name, ours, value, cond[name])
            if not error <= LOADS_BOUND:
                wrong[name] = error
        assert not wrong, (machine, given)


def test_the_dyads_of_random_machines_are_of_all_kinds_and_drives():
    machines = [machine for machine, _ in random_machines(401, 12)]
    assert {dyad.kind for machine in machines for dyad in machine.dyads} == {
        'RRR', 'RRP', 'RPR', 'RPP', 'PRP'}
    assert {machine.input for machine in machines} == {'crank', 'slide', 'cylinder'}


@some('count', [3, 40], 1)
@pytest.mark.parametrize('is_near', [False, True], ids=['anywhere', 'near a toggle'])
def test_motion_and_loads(is_near, count):
    for machine, given in random_machines(402, count, near_limit=is_near):
        check_motion(machine, given)
        check_loads(machine, given)


# Drive, then kind and links of each dyad: beyond the bounds now and then while dyads were solved
# in coordinates of the ground.
TOGETHER = {
    'a chain on the crank': ('crank', ('RPR', 'ground', 'crank'), ('RPR', 'b0', 'crank'),
                             ('RRR', 'b1', 'crank')),
    'a block on the bars of a dyad': ('crank', ('RRP', 'ground', 'crank'), ('RPR', 'b0', 'a0')),
    'slides on a block and its guide': ('slide', ('PRP', 'slider', 'ground'),
                                        ('PRP', 'b0', 'ground'), ('RRP', 'ground', 'b0')),
    'bars on a block and its slider': ('slide', ('PRP', 'slider', 'ground'),
                                       ('RRP', 'ground', 'a0'), ('RPR', 'slider', 'b1')),
}


STATED = {'bars on a block and its slider': 10.0}     # docs/limitations.md


@some('count', [2, 8], 1)
@pytest.mark.parametrize('name', TOGETHER)
def test_links_that_move_together(name, count):
    driver, *structure = TOGETHER[name]
    for machine, given in random_machines(404, count, structure=structure, driver=driver):
        check_motion(machine, given, STATED.get(name, MOTION_BOUND))
        check_loads(machine, given)


def test_a_block_pinned_to_what_carries_its_yoke_does_not_feel_the_yoke():
    """The slide a1 on a0 is flung along at 1e6 m/s^2; the block c, pinned to a0, is not."""
    machine = Machine([
        Dyad('d0', 'PRP', Point('ground', 0.856, 0.216), Point('crank', -0.043, -0.103),
             ('a0', 'b0'), direction_1=0.029, direction_2=1.743),
        Dyad('d1', 'PRP', Point('a0', 0.985, -0.013), Point('b0', 0.163, -0.318), ('a1', 'b1'),
             direction_1=-0.175238988, direction_2=1.504196840),
        Dyad('d2', 'RPP', Point('a0', -0.369, 0.167), Point('a1', 0.125, 0.332), ('c', 'bar'),
             direction_2=0.861, slot=0.965)],
        bodies=dict.fromkeys(('c', 'bar'), Body(1.3, -0.1, -0.3, 0.3)), gravity=(3.7, -9.1))
    given = (-0.25775713, 2.15674477, 1.162506906)
    assert abs(machine.motion(*given).slide_a1_acceleration) > 1e6
    check_motion(machine, given)
    check_loads(machine, given)
