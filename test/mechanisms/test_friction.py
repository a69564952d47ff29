# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Friction of joints and drive: beside Cartesian coordinates, by power, by textbooks."""
from dataclasses import replace
from itertools import islice
from math import asin, atan, cos, inf, pi, radians, sin, sqrt, tan
import subprocess
import sys

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    DriveFriction,
    External,
    find_extrema,
    FourBar,
    InvalidParameter,
    JointFriction,
    Locked,
    SliderCrank,
)
from fourbar_ros.machine import Dyad, Machine, Point
from fourbar_ros.mechanisms.elements import Attachment, Spring
from fourbar_ros.mechanisms.quantities import select
import numpy as np
import pytest
from support.contract import CASES, every_mechanism, ordinary
from support.random_machines import random_machines
from support.rubbing import loads_with, Locks
from support.samples import more

PRESS = SliderCrank(0.06, 0.25, 0.01, gravity=(0.0, -9.81), bodies=Bodies(
    Body(1.2, cg_along=0.02, inertia=0.004), Body(0.8, cg_along=0.09, inertia=0.006), Body(2.0)),
    external=External(output=Applied(-800.0)))
RUBS = {'O1': JointFriction(0.1, radius=0.01), 'A': JointFriction(0.1, radius=0.01),
        'B': JointFriction(0.1, radius=0.01), 'guide': JointFriction(0.1, length=0.1),
        'drive': DriveFriction(0.3, 0.01)}
RUBBING = PRESS.with_friction(RUBS)


def random_friction(rng, mechanism, strongest):
    """Return friction of most of the joints of a mechanism, and sometimes of its drive."""
    friction = {}
    for reaction in mechanism.REACTIONS:
        coefficient, radius, length, viscous = rng.uniform(
            (0.01, 0.01, 0.5, 0.0), (strongest, 0.1, 2.0, 0.2)).tolist()
        viscous *= rng.random() < 0.5
        if rng.random() < 0.75:
            friction[reaction.joint] = JointFriction(
                coefficient, viscous=viscous, **(
                    {'radius': radius} if not reaction.couple else
                    {'length': length} if rng.random() < 0.5 else {}))
    if rng.random() < 0.5:
        friction['drive'] = DriveFriction(*rng.uniform(0.0, 2.0, 2).tolist())
    return friction


def off(mechanism, given, friction):
    """Return the largest error of a load beside the reference, over the largest force."""
    truth = loads_with(mechanism, given, friction)
    loads = mechanism.with_friction(friction).loads(*given)
    size = max(getattr(loads, name) for name in loads._fields if f'{name}_x' in loads._fields)
    return max(abs((complex(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
                    if f'{name}_x' in loads._fields else getattr(loads, name)) - value)
               for name, value in truth.items()) / size


def check_against_reference(cases, rng, strongest):
    """Compare loads, and what locks, with the reference; return (compared, locked, ours alone)."""
    compared = locked = alone = 0
    for mechanism, given in cases:
        friction = random_friction(rng, mechanism, strongest)
        try:
            assert off(mechanism, given, friction) <= 1e-9, (mechanism, given, friction)
            compared += 1
        except Locks:
            with pytest.raises(Locked):
                mechanism.with_friction(friction).loads(*given)
            locked += 1
        except Locked:
            alone += 1
    return compared, locked, alone


@pytest.mark.parametrize('count', [12, pytest.param(1000, marks=pytest.mark.slow)])
def test_random_machines(count):
    rng = np.random.default_rng(31)
    for strongest, share in ((0.15, 0.6), (0.4, 0.4)):
        compared, locked, alone = check_against_reference(random_machines(
            32, round(count * share), dyads=(1, 5), least_sine=0.05), rng, strongest)
        assert compared > 5 * locked and alone <= 0.01 * count


@every_mechanism
def test_every_kind(case, count=more(2, 20)):
    rng = np.random.default_rng(33)
    compared, _, alone = check_against_reference(
        ((mechanism, given) for mechanism, given in ordinary(case, 34, count)
         if np.isfinite(mechanism.inertia(given[0]))), rng, 0.3)
    assert compared and not alone


@every_mechanism
def test_power_balance(case, count=more(5, 40)):
    """The drive pays for what is lost: sizes of efforts times relative rates, never negative."""
    rng = np.random.default_rng(35)
    for mechanism, given in ordinary(case, 36, count):
        friction = random_friction(rng, mechanism, 0.2)
        friction = {name: replace(record, length=inf) if name != 'drive' else record
                    for name, record in friction.items()}
        motion, loads = mechanism.with_friction(friction).step(*given)
        rates = {joint.place: getattr(motion, joint.coordinate.rate) for joint in mechanism.JOINTS}
        lost = 0.0
        for reaction in mechanism.REACTIONS:
            record, rate = friction.get(reaction.joint), rates[reaction.joint]
            if not record:
                continue
            force, arm = getattr(loads, reaction.magnitude), record.radius
            if reaction.couple:             # the friction is a part of the force of the guide
                arm = 1.0
                normal = {'slot': 'f32_x', 'guide': 'guide_force', 'slide': 'guide_force'}.get(
                    reaction.joint, f'{reaction.joint}_normal')
                force = abs(getattr(loads, normal))
            lost += (record.coefficient * arm * force + record.viscous * abs(rate)) * abs(rate)
        if 'drive' in friction:
            lost += (friction['drive'].torque * abs(given[1])
                     + friction['drive'].viscous * given[1]**2)
        free = mechanism.loads(*given)
        size = abs(loads.driving_power) + abs(free.driving_power) + lost
        assert lost >= 0.0
        assert abs(loads.driving_power - free.driving_power - lost) <= 1e-12 * size * (
            1.0 + motion.condition)
        # inside the machine: nothing of it reaches the ground
        assert loads.shaking_force == free.shaking_force
        assert loads.shaking_moment == free.shaking_moment


def test_arrays_are_single_values():
    positions = np.linspace(-3.0, 3.0, 41)
    loads = RUBBING.loads(positions, 12.0, 3.0)
    for i, position in enumerate(positions.tolist()):
        one = RUBBING.loads(position, 12.0, 3.0)
        for name, many in zip(loads._fields, loads):
            assert abs(many[i] - getattr(one, name)) <= 1e-12 * 800.0, name


def test_derivatives_by_a_complex_step():
    x, step = np.array([0.4, 1.3, 4.0]), 1e-6
    slope = RUBBING.loads(x + 1e-100j, 12.0, 3.0).driving_torque.imag / 1e-100
    difference = (RUBBING.loads(x + step, 12.0, 3.0).driving_torque
                  - RUBBING.loads(x - step, 12.0, 3.0).driving_torque) / (2.0 * step)
    assert np.abs(slope - difference).max() <= 1e-6 * np.abs(slope).max()


def test_springs_and_friction_together():
    """A spring is an external force at each input: friction grows with both."""
    spring = Spring(Attachment('ground', 0.5), Attachment('output'), 500.0, free_length=0.1)
    both = RUBBING.with_elements(spring)
    motion, loads = both.step(1.0, 12.0, 3.0)
    pull = 500.0 * (0.5 - motion.slide - 0.1)
    assert abs(motion.slide - 0.5) > 0.1
    distance = sqrt((0.5 - motion.slide)**2 + 0.01**2)
    force = 500.0 * (distance - 0.1)
    by_hand = RUBBING.with_external(External(output=Applied(
        -800.0 + force * (0.5 - motion.slide) / distance, -force * 0.01 / distance)))
    assert loads.driving_torque == pytest.approx(by_hand.loads(1.0, 12.0, 3.0).driving_torque,
                                                 rel=1e-12)
    assert pull > 0.0


def test_at_rest_there_is_none():
    """At rest friction may have any size up to its limit: loads have none, holding() says both."""
    assert RUBBING.loads(1.0) == PRESS.loads(1.0)
    lower, upper = RUBBING.holding(1.0)
    assert lower < PRESS.loads(1.0).driving_torque < upper
    assert upper == pytest.approx(RUBBING.loads(1.0, 1e-9).driving_torque, rel=1e-9)
    assert lower == pytest.approx(RUBBING.loads(1.0, -1e-9).driving_torque, rel=1e-9)
    assert PRESS.holding(1.0) == (PRESS.loads(1.0).driving_torque,) * 2
    many = RUBBING.holding(np.array([1.0, 2.0]))
    assert many[0][0] == pytest.approx(lower, rel=1e-12) and many[1][1] > many[0][1]


def turning_with_friction(seed, strongest):
    """Yield mechanisms with friction that turn fully and lock nowhere, kinds and machines."""
    rng = np.random.default_rng(seed)
    while True:
        for mechanism, _ in (*(drawn for case in CASES for drawn in ordinary(
                case, int(rng.integers(2**32)), 1)), *random_machines(
                    int(rng.integers(2**32)), 4, dyads=(1, 4), least_sine=0.1)):
            if mechanism.turns_fully and not mechanism.flat_inputs:
                rubs = mechanism.with_friction(random_friction(rng, mechanism, strongest))
                if not rubs.locked_ranges(2.0, 1.0):
                    yield rubs


@pytest.mark.parametrize('count', [4, pytest.param(120, marks=pytest.mark.slow)])
def test_extrema_beside_scans(count):
    """
    No load of a scan is beyond the extrema, and these are no farther than its steps.

    Loads jump where joints turn back: the scan keeps away from where they are at rest.
    """
    x, compared = np.linspace(-pi + 1e-7, pi + 1.3e-7, 20_001), 0
    for rubs in islice(turning_with_friction(37, 0.15), count):
        quantities = [quantity for quantity in select((), rubs, ()) if quantity.is_load]
        extrema = find_extrema(rubs, quantities, 2.0, 1.0, conditions=False)
        loads = rubs.loads(x, 2.0, 1.0)
        for quantity in quantities:
            values = getattr(loads, quantity.name)
            found = [each.value for each in extrema if each.quantity == quantity.name]
            size = np.abs(values).max()
            if not found:
                assert np.ptp(values) <= 1e-9 * size
                continue
            # between two samples, but for the jumps
            step = 10.0 * np.sort(np.abs(np.diff(values)))[-60] + 1e-6 * size
            for beyond in (max(found) - values.max(), values.min() - min(found)):
                assert -1e-9 * size <= beyond <= step, (quantity.name, rubs)
            compared += 1
    assert compared >= 8 * count


# --- without any ---------------------------------------------------------------------------------

def test_without_friction_all_is_as_if_there_were_none():
    """The same trace, the same constants, and no module of friction is imported."""
    assert PRESS.with_friction({}).record(True).trace is PRESS.record(True).trace
    assert RUBBING.record(False).trace is PRESS.record(False).trace
    assert RUBBING.without_friction.loads(1.0, 12.0, 3.0) == PRESS.loads(1.0, 12.0, 3.0)
    code = ('import sys; from fourbar_ros import load_scene; '
            'load_scene("engine").linkage.loads(0.3, 2.0); load_scene("paper").linkage.loads(0.3);'
            'print([name for name in sys.modules if name.endswith("friction")])')
    answer = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,
                            check=True)
    assert answer.stdout.strip() == '[]'


# --- self-locking, by textbooks ------------------------------------------------------------------

def wedge(angle, friction, way=1.0):
    """Return a wedge that a slider pushes to the right, and a weight of 100 N that it lifts."""
    return Machine([Dyad('d', 'PRP', Point('slider'), Point('ground', 3.0), ('face', 'weight'),
                         direction_1=angle if way > 0.0 else -angle, direction_2=pi / 2)],
                   input='slide', stroke=(0.0, 2.0), bodies={'weight': Body(1.0)},
                   external={'weight': Applied(0.0, -100.0)}, friction=friction)


@pytest.mark.parametrize('degrees', [5.0, 12.0, 20.0])
def test_wedge(degrees):
    """
    Hold a weight: W (tan(angle + phi) + tan phi) lifts it, W (tan(angle - phi) - tan phi) sinks.

    Meriam and Kraige, Engineering Mechanics: Statics, article 6/4: friction angle phi on both
    faces of the wedge. It holds by itself up to angle = 2 phi.
    """
    mu, angle = 0.15, radians(degrees)
    phi = atan(mu)
    machine = wedge(-angle, {'base': JointFriction(mu), 'd_first': JointFriction(mu)})
    lower, upper = machine.holding(1.0)
    lift, sink = 100.0 * (tan(angle + phi) + mu), 100.0 * (tan(angle - phi) - mu)
    ways = sorted((abs(lower), abs(upper)))
    assert ways == pytest.approx(sorted((abs(lift), abs(sink))), rel=1e-12)
    assert (lower < 0.0 < upper) == (angle < 2.0 * phi)


def test_wedge_that_cannot_be_driven():
    """Nothing drives a wedge in whose face is steeper than 90 deg - phi."""
    mu = 0.3
    limit = pi / 2 - atan(mu)
    for angle, locks in ((limit - 1e-6, False), (limit + 1e-6, True)):
        bounds = wedge(-angle, {'base': JointFriction(mu), 'd_first': JointFriction(mu)}
                       ).holding(1.0)
        assert any(map(np.isinf, bounds)) is locks
    with pytest.raises(Locked, match='d_first'):
        steep = wedge(-limit - 0.01, {'base': JointFriction(mu), 'd_first': JointFriction(mu)})
        steep.loads(1.0, 1.0 if np.isinf(steep.holding(1.0)[1]) else -1.0)


def test_drawer():
    """
    A drawer that is pushed at a distance jams where this is half its length over mu.

    The force P at the arm a makes the couple P a, which both ends of the block bear with P a / b
    each: friction is 2 mu P a / b, as much as the push at a = b / (2 mu).
    """
    mu, length = 0.25, 0.4
    limit = length / (2.0 * mu)
    for arm, locks in ((limit * (1.0 - 1e-6), False), (limit * (1.0 + 1e-6), True)):
        # a rod along y pushes the drawer at its end, square to the rod, as a yoke does
        machine = Machine([Dyad('d', 'RPP', Point('crank', 1.0), Point('ground', 0.0, 1.0 - arm),
                                ('block', 'drawer'), direction_2=0.0, slot=pi / 2)],
                          external={'drawer': Applied(-10.0)}, bodies={'drawer': Body(0.0)},
                          friction={'d_second': JointFriction(mu, length=length)})
        # at 90 deg the pin pushes along x, at y = 1
        if locks:
            with pytest.raises(Locked):
                machine.loads(pi / 2, -1.0)
        else:
            drive = machine.loads(pi / 2, -1.0).driving_torque
            assert drive == pytest.approx(-10.0 / (1.0 - arm / limit), rel=1e-4)


def test_bar_that_drives_a_block():
    """
    An inverted slider: a bar drives a rod by a block, if they are not within phi of in line.

    Square to the bar the block gets N, along it mu N; the rod turns by the part of both square to
    the rod, none of which is left where bar and rod are at the friction angle.
    """
    mu, rod = 0.2, 0.3
    machine = Machine([Dyad('d', 'RRP', Point('ground', 1.0), Point('crank'), ('rod', 'block'),
                            length_1=rod, direction_2=0.0)],
                      bodies={'rod': Body(0.0)}, external={'rod': Applied(couple=5.0)},
                      friction={'d_second': JointFriction(mu)})
    low, high = machine.input_ranges[0]
    # the block moves along the bar whichever way the bar turns, but where bar and rod are square
    locked = [x for way in (-1.0, 1.0) for ends in machine.locked_ranges(way) for x in ends]
    angles = []
    for x in locked:
        if low + 1e-6 < x < high - 1e-6:
            motion = machine.motion(x)
            between = motion.theta_rod - motion.theta_crank
            angles.append(abs(asin(abs(sin(between)))))
    assert angles and all(angle == pytest.approx(pi / 2 - atan(mu), abs=1e-9)
                          or angle == pytest.approx(atan(mu), abs=1e-9) for angle in angles)


def test_toggle_clamp():
    """
    A toggle clamp holds without a drive while the line of its rod is within the friction circles.

    Both rods without mass: the force in the rod is tangent to the circles of radius mu r about its
    pins, and the crank stays while that line meets the circle about O1.
    """
    mu, r, a1, a2 = 0.2, 0.01, 0.08, 0.2
    rho = mu * r
    clamp = SliderCrank(a1, a2, bodies=Bodies(Body(0.0), Body(0.0), Body(0.0)),
                        external=External(output=Applied(-500.0)),
                        friction={name: JointFriction(mu, radius=r) for name in ('O1', 'A', 'B')})

    def margin(theta):
        """Return the distance of the line of the rod from O1 less that of its friction circle."""
        motion = clamp.motion(theta)
        # opening, crank and rod turn against each other: the line crosses between A and B
        tilt = motion.beta + asin(2.0 * rho / a2) * (-1.0 if motion.beta < 0.0 else 1.0) * -1.0
        ax, ay = a1 * cos(theta), a1 * sin(theta)
        return abs(ax * sin(tilt) - ay * cos(tilt) - 0.0) - 2.0 * rho

    low, high = 1e-4, 0.5
    for _ in range(60):
        middle = 0.5 * (low + high)
        lower, upper = clamp.holding(middle)
        low, high = (middle, high) if lower <= 0.0 <= upper else (low, middle)
    assert margin(low) == pytest.approx(0.0, abs=1e-9)


def test_a_kite_locks_in_its_second_turn_too():
    rubs = {joint: JointFriction(0.3, radius=0.03) for joint in ('O1', 'A', 'B', 'O4')}
    kite = FourBar(0.1, 0.5, 0.2, 0.4, gravity=(0.0, -9.81), friction=rubs, bodies=Bodies(
        Body(0.2, cg_along=0.05), Body(1.2, cg_along=0.25, inertia=0.025),
        Body(0.5, cg_along=0.1, inertia=0.002)))
    locked = [bounds for bounds in kite.locked_ranges(10.0) if 5.9 < bounds[0] < 6.0]
    assert len(locked) == 1     # elsewhere in its first turn it is free
    (low, high), beside = locked[0], 1e-9
    x = np.array([low - beside, low + beside, high - beside, high + beside])
    assert np.isnan(kite.loads(x, 10.0).driving_torque).tolist() == [False, True, True, False]
    assert not np.isnan(kite.loads(x - 2.0 * pi, 10.0).driving_torque).any()
    for cycles in (-1, 0, 3):
        ends = [x + cycles * kite.cycle for x in (low - 0.01, high + 0.01)]
        with pytest.raises(InvalidParameter, match='it locks the mechanism'):
            find_extrema(kite, 'driving_torque', 10.0, within=ends)


# --- what is refused -----------------------------------------------------------------------------

@pytest.mark.parametrize('friction, words', [
    ({'A': JointFriction(0.1)}, 'friction.A.radius = 0.0: must be positive'),
    ({'guide': JointFriction(0.1, radius=0.01)}, 'friction.guide.radius = 0.01: only pins'),
    ({'A': JointFriction(0.1, radius=0.01, length=0.1)}, 'friction.A.length = 0.1: only guides'),
    ({'C': JointFriction(0.1, radius=0.01)}, 'friction.C: there is no such joint'),
    ({'A': DriveFriction(1.0)}, 'must be a JointFriction'),
    ({'drive': JointFriction(viscous=1.0)}, 'must be a DriveFriction'),
    (3, 'must be a mapping')])
def test_wrong_friction(friction, words):
    for make in (PRESS.with_friction, lambda friction: replace(PRESS, friction=friction)):
        with pytest.raises(InvalidParameter) as error:
            make(friction)
        assert words in str(error.value) and '\n' not in str(error.value)


@pytest.mark.parametrize('make, words', [
    (lambda: JointFriction(-0.1), 'coefficient = -0.1: must be a finite number, zero or more'),
    (lambda: JointFriction(0.1, length=0.0), 'length = 0.0: must be positive'),
    (lambda: DriveFriction(torque=-1.0), 'torque = -1.0')])
def test_wrong_numbers(make, words):
    with pytest.raises(InvalidParameter) as error:
        make()
    assert words in str(error.value)


def test_pickled_and_in_another_mode():
    import pickle
    again = pickle.loads(pickle.dumps(RUBBING))
    assert again == RUBBING and again.loads(1.0, 2.0) == RUBBING.loads(1.0, 2.0)
    assert RUBBING.in_mode(1).friction == RUBBING.friction
    links = FourBar(0.4, 1.2, 0.8, 1.0, friction={'B': JointFriction(0.1, radius=0.1)})
    assert [name for name, _ in links.friction] == ['B'] and CASES
