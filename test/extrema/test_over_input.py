# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Peaks, means and ranges over the input beside closed forms and dense scans of each range."""
from math import asin, inf, isnan, pi, sqrt, tau

from fourbar_lab.drawing.record import drive_of
from fourbar_ros import (
    Bodies,
    Body,
    flat_bar,
    FourBar,
    InvalidParameter,
    InvertedSlider,
    load_scene,
    ScotchYoke,
)
from fourbar_ros.extrema import Extremum, find_extrema, output_ranges, OverInput
from fourbar_ros.extrema.over_input import most_extreme
from fourbar_ros.machine import Dyad, Machine, Point
from fourbar_ros.mechanisms.elements import Attachment, PositionForce
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.inertia import held_rigid, mean_rigid
import numpy as np
import pytest
from support.contract import with_rods

EPS = 2.0**-52
ROCKER = FourBar(0.97, 0.23, 0.91, 0.57, mode=1)            # has two ranges of its input


def inside(low, high, count):
    """Return inputs of a range, dense at its ends, and weights of their mean."""
    phi = (np.arange(count) + 0.5) / count * pi - 0.5 * pi
    weights = np.cos(phi)
    return 0.5 * (low + high) + 0.5 * (high - low) * np.sin(phi), weights / weights.sum()


def test_figures_of_a_yoke_are_those_of_a_sine():
    velocity = OverInput(ScotchYoke(0.05), 'slide_velocity', 30.0)
    assert velocity.peak == pytest.approx(1.5, rel=8 * EPS)
    assert velocity.rms == pytest.approx(1.5 / sqrt(2.0), rel=64 * EPS)
    assert abs(velocity.mean) <= 64 * EPS
    assert OverInput(ScotchYoke(0.05), 'slide_velocity', 1e90).rms == pytest.approx(
        0.05e90 / sqrt(2.0), rel=64 * EPS)
    assert OverInput(ScotchYoke(0.05), 'slide_acceleration', 1e99).rms == pytest.approx(
        0.05e198 / sqrt(2.0), rel=64 * EPS)                 # its square overflows


def test_one_quantity_is_asked_for():
    for several in (('omega4', 'alpha4'), ()):
        with pytest.raises(InvalidParameter, match='^quantity .*must be one'):
            OverInput(FourBar(0.4, 1.2, 0.8, 1.0), several)


@pytest.mark.parametrize('turn', [0, 1, -1, 10])
def test_means_between_two_inputs_see_a_narrow_table(turn):
    """A couple on the crank, a trapezoid over the input, at rest: its integral in closed form."""
    width, low, high = 1e-3, 0.5 + turn * tau, 1.6 + turn * tau
    couple = ForceTable([0.0, 1.01, 1.01 + width / 3, 1.01 + width / 1.5, 1.01 + width, tau],
                        [0.0, 0.0, 300.0, 300.0, 0.0, 0.0], is_periodic=True, is_linear=True)
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=Bodies(*[Body(1.0)] * 3), gravity=(0.0, 0.0))
    linkage = linkage.with_elements(PositionForce(Attachment('crank'), couple, direction=None))
    torque = OverInput(linkage, 'driving_torque', 0.0, within=(low, high))
    error = 1e-12 + 64 * EPS * abs(high) / width  # of the points of the table beside its width
    assert torque.mean == pytest.approx(-300.0 * width / 1.5 / (high - low), rel=error)
    assert torque.rms == pytest.approx(300.0 * sqrt(5.0 / 9.0 * width / (high - low)), rel=error)


def test_the_mean_of_a_rate_is_what_the_output_moves_though_it_is_unbounded():
    """As one over the root of the distance: the mean is finite, the mean square is not."""
    linkage = FourBar(1.072, 0.219, 0.907, 0.201, mode=1)
    rate, ((low, high),) = OverInput(linkage, 'omega4'), linkage.input_ranges
    assert rate.peak == rate.rms == inf
    first, last = (extremum.value for extremum in sorted(
        find_extrema(linkage, 'theta4'), key=lambda one: -one.side) if extremum.side)
    assert rate.mean == pytest.approx((last - first) / (high - low), rel=1e-10)


def test_the_inertia_of_100_60_70_110_is_unbounded_and_has_no_mean():
    """A change point between toggles: at 0 all links lie in line, and the inertia is largest."""
    bars = [flat_bar(length, 7850.0, 0.02, 0.005) for length in (0.1, 0.06, 0.07)]
    linkage = FourBar(0.1, 0.06, 0.07, 0.11, bodies=Bodies(*bars))
    inertia = OverInput(linkage, 'inertia')
    scan = np.concatenate([linkage.inertia(inside(*bounds, 20_001)[0])
                           for bounds in linkage.input_ranges])
    assert inertia.least.value == pytest.approx(scan.min(), rel=1e-6)
    at_0, = (one.value for one in inertia.extrema if one.theta1 == 0.0)
    assert at_0 == pytest.approx(scan[np.abs(np.concatenate([
        inside(*bounds, 20_001)[0] for bounds in linkage.input_ranges])).argmin()], rel=1e-6)
    assert inertia.most.value == inertia.mean == inertia.peak == inf
    torque = OverInput(linkage, 'driving_torque', 1.0)      # +inf at one end, -inf at the other
    assert isnan(torque.mean) and torque.rms == inf


def test_a_jump_between_dyads_does_not_spoil_a_mean():
    linkage, count = load_scene('toggle_press').linkage, 2**18
    angles = linkage.motion(tau * (np.arange(count) + 0.5) / count).transmission_angle
    jumps = np.abs(np.diff(angles, append=angles[:1]))
    jumps = jumps[jumps > 0.01]
    assert jumps.size                                       # each may fall anywhere in a step
    angle = OverInput(linkage, 'transmission_angle')
    assert angle.mean == pytest.approx(angles.mean(), abs=jumps.sum() / count)
    assert angle.rms == pytest.approx(sqrt(np.mean(angles**2)), abs=pi * jumps.sum() / count)


def test_peaks_beside_a_change_point_are_not_stepped_over():
    linkage = with_rods((0.1, 0.5, 0.3, 0.7 - 1e-6))
    count = 2**19
    forces = linkage.loads(tau * np.arange(count) / count, 10.0).shaking_force
    assert OverInput(linkage, 'shaking_force', 10.0).rms == pytest.approx(
        sqrt(np.mean(forces**2)), rel=1e-10)
    assert OverInput(linkage, 'shaking_force', 10.0).peak > forces.max() * (1.0 - EPS)


def test_the_mean_of_a_linkage_held_rigid_is_that_of_a_scan():
    for linkage in (with_rods((1.2, 0.4, 0.8, 1.0)), load_scene('gripper').linkage):
        sums = np.zeros(2)
        for low, high in linkage.input_ranges:
            x, weights = inside(low, high, 100_001)
            held = held_rigid(linkage, linkage.motion(x))
            sums += (held.x @ weights, held.y @ weights)
        mean = mean_rigid(linkage)
        assert (mean.x, mean.y) == pytest.approx(sums / len(linkage.input_ranges), abs=1e-9)


@pytest.mark.parametrize('name', ['radial_engine', 'scott_russell'])
def test_the_mean_centre_of_gravity_is_at_the_pivot_where_symmetry_has_it_there(name):
    mean = mean_rigid(load_scene(name).linkage)
    assert (mean.x, mean.y) == (0.0, 0.0)


def test_what_an_output_sweeps_is_that_of_each_range_of_the_input():
    for mode in (1, 2):
        linkage = ROCKER.in_mode(mode)
        for swept in output_ranges(linkage):
            theta4 = np.unwrap(linkage.motion(inside(*swept.inputs, 20_001)[0]).theta4)
            theta4 -= tau * round((theta4[0] - swept.low) / tau)
            # an end of the scan is a width of 4e-9 from the toggle, where angles go as its root
            assert np.array((swept.low, swept.high)) == pytest.approx(
                (theta4.min(), theta4.max()), abs=2e-4)
            assert {swept.low, swept.high} <= {extremum.value for extremum in swept.extrema}


def test_an_output_that_turns_fully_and_reverses_on_the_way_sweeps_a_turn():
    """Its extrema are 0.573 rad apart: it goes 6.856 rad forwards and 0.573 rad back."""
    bar = reversing()
    swept, = output_ranges(bar, bar.outputs[0].coordinate)
    assert swept.turns_fully and swept.width == tau and not swept.extrema
    angle = np.unwrap(bar.motion(np.linspace(0.0, tau, 4097)).theta_bar)
    assert abs(angle[-1] - angle[0]) == pytest.approx(tau)
    assert np.abs(np.diff(angle)).sum() == pytest.approx(6.856 + 0.573, abs=2e-3)


def reversing():
    """Return a machine whose bar is led around its pivot by a point of the coupler."""
    one = Dyad('one', 'RRR', Point('crank', 0.41794208), Point('ground', 1.0),
               ('coupler', 'rocker'), length_1=1.02850654, length_2=1.10355668, mode=2)
    two = Dyad('two', 'RPR', Point('coupler', 0.10309871, -1.17079605),
               Point('ground', 1.02996685, -0.39033883), ('block', 'bar'), offset=0.0, mode=2)
    return Machine([one, two], output='bar')


# --- of equal extrema ----------------------------------------------------------------------------

def extremum(value, theta1):
    return Extremum('f', 'N', 2, 'maximum' if value > 0.0 else 'minimum', theta1, value, True)


@pytest.mark.parametrize('bits', [-2, 0, 2])
def test_of_equal_extrema_that_at_the_least_input_counts(bits):
    """Rounding chose among them the peak of a drive, the worst pin and the worst angle."""
    other = 7.0 * (1.0 + bits * EPS)
    every = [extremum(*each) for each in ((3.0, 0.5), (-7.0, 1.0), (other, 2.0), (-other, 3.0))]
    over = OverInput(FourBar(0.4, 1.2, 0.8, 1.0), 'omega4', extrema=every)
    assert (over.largest.input, over.largest.value) == (1.0, -max(7.0, other))
    assert (over.most.input, over.least.input) == (2.0, 1.0) and over.peak == max(7.0, other)
    # the same of two pins, in any order, of unbounded values and of angles that differ from pi/2
    assert most_extreme(every[::-1], 1, abs).input == 1.0
    assert most_extreme([extremum(inf, 2.0), extremum(inf, 1.0)], 1).input == 1.0
    angles = [extremum(0.5, 3.0), extremum(pi - 0.5 * (1.0 + bits * EPS), 1.0)]
    worst = most_extreme(angles, 1, lambda angle: abs(angle - 0.5 * pi))
    assert worst == angles[1] and most_extreme([], 1) is None


@pytest.mark.parametrize('bits', range(-3, 4))
def test_the_peak_of_a_symmetric_torque_does_not_depend_on_the_last_bits(bits):
    """A yoke whose torque is as large in each quarter of a turn."""
    yoke = ScotchYoke(0.1 * (1.0 + bits * EPS), bodies=Bodies(*[Body(1.0)] * 3))
    effort = drive_of(yoke, 10.0)['effort']
    assert effort['peak_at'] == pytest.approx(0.25 * pi, abs=1e-7)


# --- the turn of angles --------------------------------------------------------------------------

def test_positions_over_two_ranges_are_those_of_the_mirror_image():
    """One range of mode 1 was a turn beside the other: 8.27 rad, and no mean."""
    lengths = 0.66063946, 1.05541733, 0.32974365, 1.0537845
    one, two = (FourBar(*lengths, mode=mode) for mode in (1, 2))
    swept = [OverInput(each, 'theta4') for each in (one, two)]
    assert len(one.input_ranges) == 2
    assert swept[0].most.value == pytest.approx(-swept[1].least.value, rel=64 * EPS)
    assert swept[0].least.value == pytest.approx(-swept[1].most.value, rel=64 * EPS)
    assert swept[0].most.value - swept[0].least.value < tau
    assert swept[0].mean == pytest.approx(-swept[1].mean, rel=1e-12)
    assert swept[0].rms == pytest.approx(swept[1].rms, rel=1e-12)
    for each, over in zip((one, two), swept):
        values = sorted(extremum.value for extremum in over.extrema)
        ranges = output_ranges(each)
        assert values == sorted(extremum.value for part in ranges for extremum in part.extrema)
        assert all(abs(part.low + part.high) <= tau for part in ranges)


@pytest.mark.parametrize('bits', range(-4, 5))
def test_a_range_about_half_a_turn_is_counted_beyond_it_whatever_the_rounding(bits):
    """A bar that swings about 180 deg: the kind and the machine that it is said +180 and -180."""
    a1, a4 = 0.1 * (1.0 + bits * EPS), 0.3
    machine = Machine([Dyad('d', 'RPR', Point('crank', a1), Point('ground', a4),
                            ('block', 'bar'), offset=0.0)])
    for linkage in (InvertedSlider(a1, a4), machine):
        (low, high), = [(part.low, part.high) for part in output_ranges(linkage)]
        assert (low, high) == pytest.approx((pi - asin(1 / 3), pi + asin(1 / 3)), rel=1e-12)
        assert {round(extremum.value, 9) for extremum in find_extrema(
            linkage, linkage.outputs[0].coordinate.position)} == {round(low, 9), round(high, 9)}


def test_an_angle_that_turns_on_with_reversals_has_no_mean():
    """Its reversals gave it a middle, and what lies about that a number."""
    whitworth = FourBar(2.0, 4.0, 3.5, 1.0)
    assert isnan(OverInput(whitworth, 'theta4').mean) and isnan(OverInput(whitworth, 'theta4').rms)
    drag = reversing()
    over = OverInput(drag, drag.outputs[0].coordinate.position)
    assert output_ranges(drag)[0].turns_fully and over.extrema
    assert isnan(over.mean) and isnan(over.rms)
