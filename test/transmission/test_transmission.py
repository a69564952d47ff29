# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trajectories through a mechanism and back, power balance, and what cannot be followed."""
from dataclasses import replace
import re

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    DriveFriction,
    External,
    FourBar,
    InvalidParameter,
    JointFriction,
    load_scene,
)
from fourbar_ros.transmission import branch_of, CannotFollow, trajectory, Transmission
import numpy as np
import pytest
from support import contract
from support.contract import every_case
from support.power import power

EPS = 2.0**-52
ROCKER = FourBar(0.4, 1.2, 0.8, 1.0)


def drawn(case, seed=21):
    """Return a mechanism with everything acting and an input in the middle of a branch."""
    mechanism, _ = next(contract.ordinary(case, seed, 1))
    low, high = mechanism.input_ranges[0]
    branch = branch_of(mechanism, low + 0.37 * (high - low))
    return mechanism, branch


def inner(branch, count=40):
    """Return inputs of a branch away from its ends."""
    low, high = branch.inputs[0], branch.inputs[-1]
    return low + (high - low) * np.linspace(0.12, 0.88, count)


@every_case
def test_there_and_back_is_where_it_began(case):
    mechanism, branch = drawn(case)
    inputs, rng = inner(branch), np.random.default_rng(3)
    driven = trajectory(inputs, *rng.normal(size=(3, len(inputs))))
    through = Transmission(mechanism, float(inputs[7]))
    back = through.to_input(through.to_output(driven))
    motion = mechanism.motion(inputs, 1.0)
    output = mechanism.outputs[0].coordinate
    ratio = getattr(motion, output.rate)
    # of inputs behind a small ratio, and of terms that cancel
    worst = (1.0 + motion.condition) * (1.0 + 1.0 / np.abs(ratio))**3 * (1.0 + np.abs(
        getattr(motion, output.acceleration)))
    for got, want in zip(back, driven):
        size = 1.0 + np.abs(want).max()
        assert (np.abs(got - want) <= np.maximum(1e-12, 64.0 * EPS * worst) * size).all()


@pytest.mark.parametrize(('lengths', 'turns', 'advance'), [
    ((0.5, 1.0, 0.5, 1.0), 1, 1), ((0.5, 1.0, 1.0, 0.5), 2, 1), ((1.0, 1.0, 0.5, 0.5), 1, 2),
    ((0.4, 0.5, 0.2, 0.1), 2, 2)])
def test_change_points_turn_on_through_their_flat_positions(lengths, turns, advance):
    """The output of a kite makes one turn in two of the crank, or two in one."""
    linkage = FourBar(*lengths)
    through, inputs = Transmission(linkage, 0.3), np.linspace(-40.0, 40.0, 999)
    output = through.to_output(trajectory(inputs, 1.0, 0.5))
    motion = linkage.motion(inputs)
    assert np.abs(np.angle(np.exp(1j * (output.position - motion.theta4)))).max() < 1e-13
    assert np.abs(np.diff(output.position)).max() < 4.5 * 80.0 / 998
    period = 2.0 * np.pi * turns
    there = through.to_output(trajectory([1.0, 1.0 + period])).position
    assert np.diff(there) == pytest.approx(2.0 * np.pi * advance, abs=1e-13)
    back = through.to_input(output)
    assert np.abs(back.position - inputs).max() < 1e-13 and np.abs(back.rate - 1.0).max() < 1e-12


def test_a_kite_whose_output_stands_still_or_turns_back_is_refused():
    kite = FourBar(1.0, 1.0, 0.5, 0.5, mode=1)
    with pytest.raises(InvalidParameter, match='the output stands still'):
        Transmission(kite, 0.3)
    swinging = FourBar(0.1, 0.5, 0.2, 0.4)            # 1 : 5 : 2 : 4, two turns
    low, high = (end.input for end in Transmission(swinging, 0.3).branch.ends)
    again = Transmission(swinging, 0.3)
    assert again.to_output(trajectory(0.3 + 4.0 * np.pi)).position == pytest.approx(
        again.to_output(trajectory(0.3)).position)
    with pytest.raises(CannotFollow):
        again.to_output(trajectory(0.5 * (low + high) + 2.0 * np.pi))


@every_case
def test_power_of_drive_and_output_differ_by_what_the_links_take(case):
    """T x' = M y' + the power that masses, gravity and external loads take, computed apart."""
    mechanism, branch = drawn(case)
    inputs, rng = inner(branch), np.random.default_rng(4)
    through = Transmission(mechanism, float(inputs[3]))
    wanted = through.to_output(trajectory(inputs, *rng.normal(size=(3, len(inputs)))))
    driven = through.to_input(wanted)
    links, size = power(mechanism, *driven[:3])
    size = size + np.abs(driven.effort * driven.rate)
    motion = mechanism.motion(*driven[:3])
    balance = driven.effort * driven.rate - wanted.effort * wanted.rate - links
    bound = 1e-12 * (1.0 + np.array(motion.condition))
    assert (np.abs(balance) <= bound * (size + np.abs(wanted.effort * wanted.rate))).all()


def test_efforts_beside_dry_friction_are_refused():
    """It grows with what the output bears: 3.995 N m had been given for 4.205 N m."""
    rods = Bodies(*[Body(1.0, cg_along=0.1, inertia=0.1)] * 3)
    links = replace(ROCKER, bodies=rods)
    dry = links.with_friction({'A': JointFriction(0.2, radius=0.02)})
    outputs = [1.1, 1.2]
    with pytest.raises(InvalidParameter, match='^effort: must be left out.* friction at A grows'):
        Transmission(dry, 1.0).to_input(trajectory(outputs, 0.5, effort=10.0))
    driven = Transmission(dry, 1.0).to_input(trajectory(outputs, 0.5))      # which bears nothing
    for x, rate, acceleration, effort in zip(*driven):
        assert effort == pytest.approx(dry.loads(x, rate, acceleration).driving_torque, rel=1e-12)
    with pytest.raises(InvalidParameter, match='^effort: must be left out'):
        Transmission(dry, 1.0).to_output(driven)
    assert Transmission(dry, 1.0).to_output(
        driven._replace(effort=None)).position == pytest.approx(outputs)
    # friction that no force makes larger adds up
    through = Transmission(links.with_friction({
        'A': JointFriction(viscous=0.3), 'drive': DriveFriction(torque=0.5)}), 1.0)
    wanted = trajectory(outputs, 0.5, effort=10.0)
    for x, rate, acceleration, effort in zip(*through.to_input(wanted)):
        loaded = through.mechanism.with_external(External(output=Applied(couple=-10.0)))
        assert effort == pytest.approx(loaded.loads(x, rate, acceleration).driving_torque,
                                       rel=1e-12)


@every_case
def test_rates_are_those_of_a_difference(case):
    """A second formulation: differences of positions in time, without any ratio."""
    mechanism, branch = drawn(case)
    inputs = inner(branch, 3)
    through = Transmission(mechanism, float(inputs[1]))
    wanted = through.to_output(trajectory(inputs))
    h, speed = 1e-4, 0.3 * (branch.outputs[-1] - branch.outputs[0])
    for y in wanted.position:
        times = h * np.arange(-2, 3)
        x = through.to_input(trajectory(y + speed * times + 0.5 * speed * times**2)).position
        got = through.to_input(trajectory(y, speed, speed))
        rate = (x[0] - 8.0 * x[1] + 8.0 * x[3] - x[4]) / (12.0 * h)
        curve = (-x[0] + 16.0 * x[1] - 30.0 * x[2] + 16.0 * x[3] - x[4]) / (12.0 * h * h)
        scale = 1.0 + abs(got.rate[0]) + abs(got.acceleration[0])
        assert abs(rate - got.rate[0]) <= 1e-8 * scale
        assert abs(curve - got.acceleration[0]) <= 1e-5 * scale


def test_beyond_a_toggle_it_is_refused_with_its_angle():
    through = Transmission(ROCKER, 1.0)
    low, high = sorted(end.output for end in through.branch.ends)
    top = max(through.branch.ends, key=lambda end: end.output)
    with pytest.raises(CannotFollow) as error:
        through.to_input(trajectory([high - 0.1, high + 0.01]))
    assert str(error.value) == (
        f'sample 1: theta4 = {high + 0.01:.8g} rad lies beyond the toggle {high:.8g} rad, where '
        f'the output turns back, at theta1 = {top.input:.8g} rad')
    with pytest.raises(CannotFollow, match='sample 0: theta4 = .* lies beyond the toggle'):
        through.to_input(trajectory([low - 1e-6]))
    assert np.isfinite(through.to_input(trajectory([high - 1e-6, low + 1e-6])).position).all()


def test_the_drive_does_not_leave_its_branch():
    through = Transmission(ROCKER, 1.0)
    beyond = max(end.input for end in through.branch.ends) + 0.2
    with pytest.raises(CannotFollow, match='sample 0: theta1 = .* where the output turns back'):
        through.to_output(trajectory([beyond]))


# a double crank
TURNING = FourBar(0.5, 0.6, 0.55, 0.2)


@pytest.mark.parametrize('stroke', [(0.6, 1.2), (0.6, 1.2 + 2.0 * np.pi)])
def test_a_range_of_the_crank_ends_the_branch(stroke):
    """One of more than a turn too, of an output that turns on."""
    linkage = TURNING if stroke[1] > 2.0 * np.pi else ROCKER
    through, free = Transmission(replace(linkage, stroke=stroke), 0.9), Transmission(linkage, 0.9)
    assert [end.input for end in through.branch.ends] == list(stroke)
    inside = trajectory(np.linspace(*stroke, 7))
    outputs = through.to_output(inside).position
    assert outputs == pytest.approx(free.to_output(inside).position, abs=1e-14)
    assert through.to_input(trajectory(outputs)).position == pytest.approx(
        inside.position, abs=1e-13)
    with pytest.raises(CannotFollow, match='theta1 = .* where the range of the input ends'):
        through.to_output(trajectory(np.linspace(stroke[0], stroke[1] + 0.1, 7)))


def test_turns_are_those_of_the_positions_in_whatever_message():
    """An output some turns on belongs to a drive as many turns on, point by point."""
    rng = np.random.default_rng(5)
    for start in (0.5, -20.0, 0.5 + 400.0 * np.pi):
        through = Transmission(TURNING, start)
        assert abs(through.to_output(trajectory(start)).position[0]) <= np.pi
        inputs = start + rng.uniform(-300.0, 300.0, 50)
        output = through.to_output(trajectory(inputs)).position
        turns = np.round((output - through.to_output(trajectory(start)).position) / (2 * np.pi))
        assert (np.abs(turns - (inputs - start) / (2 * np.pi)) <= 1.5).all()
        for x, y in zip(inputs, output):                  # each alone, as in a stream
            assert through.to_output(trajectory(x)).position[0] == y
            assert abs(through.to_input(trajectory(y)).position[0] - x) <= 1e-10


@pytest.mark.parametrize('mode', [1, 2])
def test_a_kite_turns_its_output_once_in_two_turns(mode):
    """B is on the bisector at O1; the drive goes through flat positions, four of them exactly."""
    kite = FourBar(0.5, 1.0, 1.0, 0.5, mode=mode)
    x = np.concatenate([np.linspace(-4.0, 21.0, 200), 2.0 * np.pi * np.arange(4)])
    x.sort()
    r = 0.5 * np.cos(0.5 * x) + kite.sign * np.sqrt(1.0 - 0.25 * np.sin(0.5 * x)**2)
    exact = np.unwrap(np.arctan2(r * np.sin(0.5 * x), r * np.cos(0.5 * x) - 0.5))
    through = Transmission(kite, 1.0)
    output = through.to_output(trajectory(x, 1.0))
    assert np.abs(output.position - output.position[0] - (exact - exact[0])).max() <= 1e-14
    assert output.rate == pytest.approx(np.gradient(exact, x, edge_order=2), abs=5e-3)
    back = through.to_input(output)
    assert np.abs(back.position - x).max() <= 1e-13
    assert back.rate == pytest.approx(1.0, abs=1e-13)


def test_a_drive_that_repeats_after_two_turns_counts_from_another_two():
    through, turn = Transmission(FourBar(1.0, 5.0, 2.0, 4.0), 0.5), 2.0 * np.pi
    assert through.branch.ends[1].input - through.branch.ends[0].input > turn
    one, other = (through.to_output(trajectory([0.1 + k * turn, 0.2 + k * turn])).position
                  for k in (0, 4))
    assert np.abs(one - other).max() <= 64.0 * EPS * turn
    with pytest.raises(CannotFollow):                  # there it is on its way back
        through.to_output(trajectory([0.1 + turn]))


def test_a_swinging_output_may_count_from_another_turn():
    through, turn = Transmission(ROCKER, 1.0), 2.0 * np.pi
    one, other = (through.to_input(trajectory([1.9 + k * turn, 2.0 + k * turn])).position
                  for k in (0, 3))
    assert np.abs(one - other).max() <= 64.0 * EPS * turn
    one, other = (through.to_output(trajectory([1.9 + k * turn, 2.0 + k * turn])).position
                  for k in (0, -2))
    assert np.abs(one - other).max() <= 64.0 * EPS * turn
    for way in (through.to_input, through.to_output):     # within a message it cannot
        with pytest.raises(CannotFollow, match='sample 1: .* lies beyond'):
            way(trajectory([1.9, 1.9 + turn]))


@pytest.mark.parametrize('linkage', [TURNING, ROCKER])
@pytest.mark.parametrize('given, why', [
    (({'position': 1e308}), 'sample 0: theta. = 1e\\+308 rad tells no angle'),
    (({'position': [1.9, -1e12]}), 'sample 1: theta. = -1e\\+12 rad tells no angle: .* 0.00012'),
    (({'rate': 1e308}), 'sample 0: the (rate|acceleration) of theta. overflows'),
    (({'rate': 1e200}), 'the acceleration of theta. overflows'),
    (({'effort': 1.7e308, 'acceleration': 1.7e308}), 'the (effort|acceleration) of'),
])
def test_numbers_too_large_are_refused_for_that(linkage, given, why):
    through = Transmission(linkage, 1.0)
    for way in (through.to_input, through.to_output):
        try:
            found = way(trajectory(**{'position': 1.9, **given}))
        except CannotFollow as error:
            assert re.search(why, str(error)), error
        else:                                             # a ratio above 1: nothing overflows
            assert 'effort' in given and np.isfinite(found).all()


def test_a_velocity_in_the_toggle_is_refused_and_rest_is_not():
    through = Transmission(ROCKER, 1.0)
    for end in through.branch.ends:
        with pytest.raises(CannotFollow, match='lies at the toggle'):
            through.to_input(trajectory(end.output, 1e-9))
        found = through.to_input(trajectory(end.output))
        assert abs(found.position[0] - end.input) <= 1e-7 and found.rate[0] == 0.0
        # the output rests there whatever the drive does, but gives no effort
        assert abs(through.to_output(trajectory(end.input, 1.0, effort=None)).rate[0]) <= 1e-7


def test_what_is_not_given_is_not_answered():
    through = Transmission(ROCKER, 1.0)
    full = through.to_input(trajectory([1.9, 2.0], 1.0, 0.5, 3.0))
    found = through.to_input(trajectory([1.9, 2.0], 1.0, None, 3.0))
    assert found.acceleration is None and (found.rate == full.rate).all()
    assert (found.effort == full.effort).all()            # without masses it needs none
    back = through.to_output(found)
    assert back.acceleration is None and np.abs(back.effort - 3.0).max() <= 1e-12
    assert through.to_output(full._replace(effort=None)).effort is None
    heavy = Transmission(load_scene('paper').linkage, 1.0)
    assert heavy.to_input(trajectory(1.9, 1.0, None, None)).effort is None
    for way in (heavy.to_input, heavy.to_output):
        with pytest.raises(InvalidParameter, match='acceleration: must be given for an effort'):
            way(trajectory(1.9, 1.0, None, 0.0))


@pytest.mark.parametrize('wrong', [float('nan'), float('inf')])
def test_a_sample_that_is_not_finite_is_refused(wrong):
    with pytest.raises(InvalidParameter, match='must be finite in every sample'):
        trajectory([1.0, wrong])


def four_bar_linkage_transmission(actuators, n_a, n_j, offsets):
    """Return the joints as transmission_interface's header of ros2_control states them."""
    first = actuators[0] / (n_j[0] * n_a[0]) + offsets[0]
    second = (actuators[1] / n_a[1] - actuators[0] / (n_j[0] * n_a[0])) / n_j[1] + offsets[1]
    return first, second


def test_the_transmission_of_ros2_control_is_a_parallelogram_and_no_other_four_bar():
    """Its second link turns with the second actuator, relative to the ground."""
    n_a, n_j, offsets = (50.0, -30.0), (1.0, 1.0), (0.0, 0.0)
    crank = np.linspace(0.3, 2.8, 41)
    actuators = (50.0 * 0.7, n_a[1] * crank)       # the arm stands at 0.7 rad, the crank turns
    first, second = four_bar_linkage_transmission(actuators, n_a, n_j, offsets)
    parallelogram, nearly = FourBar(0.1, 0.5, 0.1, 0.5), FourBar(0.1, 0.5, 0.11, 0.5)
    error, other = (np.abs(linkage.motion(crank).theta4 - (first + second)).max()
                    for linkage in (parallelogram, nearly))
    assert error <= 8.0 * EPS * np.pi and other > 0.02


def test_two_turning_points_close_to_each_other_end_branches():
    """Klann's leg, with the last length such that its output turns back for 6e-4 rad only."""
    klann = load_scene('klann').linkage
    nearly = klann.with_lengths((*klann.lengths[:-1], 0.5550762939453125))
    before, between, after = (Transmission(nearly, start).branch for start in (3.3, 3.3202, 3.33))
    turning = [before.ends[1].input, between.ends[1].input]
    assert turning[0] == between.ends[0].input and turning[1] == after.ends[0].input
    assert 5e-4 < turning[1] - turning[0] < 8e-4 and before.sense == after.sense == -between.sense
