# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mode is a branch: change points of whole millimetres beside a continuation in many digits.

The reference closes the links as circles and lines meet, on one side or the other. Beyond each
pose in line it takes the side to which the pose before leads on.
"""
from functools import partial
from math import inf, pi
import random
from typing import NamedTuple

from fourbar_ros import FourBar, InvertedSlider, MovingJointFourBar, SliderCrank
from fourbar_ros.extrema.find import find_extrema
import mpmath as mp
import numpy as np
import pytest
from support.cartesian import EPS  # and 150 digits

BOUND = 5.0                  # in eps times condition
BEYOND = mp.mpf(10)**-25     # from an input: rates at a pose in line are those of its branch
STEP = mp.mpf(10)**-45       # of differences, whose error is its square
WAY = mp.mpf(10)**-30        # from a pose in line, beyond which it leads on
J = mp.mpc(0, 1)


# --- the reference: (lengths, input, side) -> angles as unit vectors, slides ---------------------

def meet(p, r1, q, r2, side):
    """Return where circles about p and q meet, on the left of the way from p to q, or right."""
    way = q - p
    square = abs(way)**2
    along = (square + r1**2 - r2**2) / 2
    return p + (along + J * side * mp.sqrt(max(r1**2 * square - along**2, 0))) / mp.conj(way)


def four_bar(lengths, x, side):
    a1, a2, a3, a4 = lengths
    a = a1 * mp.expj(x)
    b = meet(a, a2, a4, a3, side)
    return {'beta': (b - a) / a2, 'theta4': (b - a4) / a3}


def four_bar_at_a(lengths, x, side):
    """As the crank sees it: A = 0, O1 = -a1, and O4 where both rods meet."""
    a1, a2, a3, a4 = lengths
    b = a2 * mp.expj(x)
    pivot = meet(b, a3, mp.mpc(-a1), a4, side)
    ground = (pivot + a1) / a4
    return {'theta1': 1 / ground, 'beta': b / a2 / ground, 'theta4': (b - pivot) / a3 / ground}


def four_bar_at_b(lengths, x, side):
    """As the coupler sees it: B = 0, A = -a2, O4 in the direction theta3."""
    a1, a2, a3, a4 = lengths
    pivot = a3 * mp.expj(x)
    o1 = meet(pivot, a4, mp.mpc(-a2), a1, side)
    ground = (pivot - o1) / a4
    return {'theta1': (-a2 - o1) / a1 / ground, 'beta': 1 / ground,
            'theta4': -pivot / a3 / ground}


def slider_crank(lengths, x, side):
    a1, a2, e = lengths
    a = a1 * mp.expj(x)
    h = e - a.imag
    s = a.real + side * mp.sqrt(max(a2**2 - h**2, 0))
    return {'slide': s, 'beta': (s + J * e - a) / a2}


def inverted_slider(lengths, x, side):
    a1, a4, e = lengths
    d = a1 * mp.expj(x) - a4
    slide = side * mp.sqrt(max(abs(d)**2 - e**2, 0))
    return {'slide': slide, 'theta4': d / (slide + J * e)}


def driven_slider(lengths, s, side):
    a1, a2, e = lengths
    end = s + J * e
    a = meet(end, a2, mp.mpc(0), a1, side)
    return {'theta1': a / a1, 'beta': (end - a) / a2}


def cylinder(lengths, s, side):
    a1, a4, e = lengths
    a = meet(mp.mpc(0), a1, mp.mpc(a4), mp.sqrt(s**2 + e**2), side)
    return {'theta1': a / a1, 'theta4': (a - a4) / (s + J * e)}


# --- linkages ------------------------------------------------------------------------------------

class Drive(NamedTuple):
    """A kind with one of its inputs."""

    make: object
    pose: object            # of the reference
    measure: object         # pose -> what has the sign of the mode: 2 is positive
    has_sign: tuple         # the inputs between which it has that sign, links in line or not
    least: object           # lengths -> how near to each other the ends of the dyad come
    is_slide: bool = False


DRIVES = {
    'four-bar': Drive(FourBar, four_bar, lambda z: (z['theta4'] / z['beta']).imag,
                      (0.0, pi), lambda a1, a2, a3, a4: abs(a1 - a4)),
    'four-bar at A': Drive(
        partial(MovingJointFourBar, input='A'), four_bar_at_a, lambda z: z['theta4'].imag,
        (-pi, 0.0), lambda a1, a2, a3, a4: abs(a1 - a2)),
    'four-bar at B': Drive(
        partial(MovingJointFourBar, input='B'), four_bar_at_b, lambda z: z['theta1'].imag,
        (-pi, 0.0), lambda a1, a2, a3, a4: abs(a2 - a3)),
    'slider-crank': Drive(SliderCrank, slider_crank, lambda z: z['beta'].real,
                          (-0.5 * pi, 0.5 * pi), lambda *a: 0),
    'inverted slider-crank': Drive(InvertedSlider, inverted_slider, lambda z: z['slide'],
                                   (0.0, 2.0 * pi), lambda *a: abs(a[2])),
    'slide of a slider-crank': Drive(
        partial(SliderCrank, input='slide'), driven_slider,
        lambda z: (z['beta'] / z['theta1']).imag, (0.0, inf), lambda *a: abs(a[2]), True),
    'cylinder': Drive(partial(InvertedSlider, input='slide'), cylinder,
                      lambda z: z['theta1'].imag, (0.0, inf), lambda *a: abs(a[2]), True),
}
COORDINATES = {'theta1': ('theta1', 'omega1', 'alpha1'), 'theta4': ('theta4', 'omega4', 'alpha4'),
               'beta': ('beta', 'omega_beta', 'alpha_beta'),
               'slide': ('slide', 'slide_velocity', 'slide_acceleration')}


class Branch:
    """The motion of a linkage in a mode, followed from pose in line to pose in line."""

    def __init__(self, pose, lengths, is_slide, start, side):
        self.pose, self.lengths = pose, lengths
        self.quarter = None if is_slide else mp.pi / 2
        self.sides = {self.interval(start): side}

    def interval(self, x):
        """Return between which places, at which links may be in line, an input is."""
        return int(x > 0) if self.quarter is None else int(mp.floor(x / self.quarter))

    def side(self, x):
        """Return the side at an input."""
        wanted, known = self.interval(x), list(self.sides)
        way = 1 if wanted > known[0] else -1
        for interval in range(known[0], wanted, way):
            if interval + way not in self.sides:
                flat = 0 if self.quarter is None else self.quarter * (interval + (way > 0))
                before, ahead = (self.pose(self.lengths, flat - k * way * WAY * self.lengths[0],
                                           self.sides[interval]) for k in (3, 1))
                beyond = flat + way * WAY * self.lengths[0]
                self.sides[interval + way] = min((1, -1), key=lambda side: sum(
                    abs(value - 2 * ahead[name] + before[name])
                    for name, value in self.pose(self.lengths, beyond, side).items()))
        return self.sides[wanted]

    def levels(self, lengths, x):
        """Return {coordinate: (value, first, second derivative)}, angles as unit vectors."""
        side = self.side(x)
        poses = [self.pose(lengths, x + k * STEP, side) for k in (-1, 0, 1)]
        found = {}
        for name in poses[0]:
            low, here, high = (each[name] for each in poses)
            first, second = (high - low) / (2 * STEP), (high - 2 * here + low) / STEP**2
            if name != 'slide':     # of z = e^{iy}: y' = z'/(i z), y'' from z''/z = i y'' - y'^2
                first, second = (first / (J * here)).real, (second / here).imag
            found[name] = here, first, second
        return found


def moved_lengths(lengths, whole):
    """
    Yield lengths with some of them longer by WAY, such that the change point stays one.

    Of one the smallest makes up for it; of two, as of a parallelogram, equal ones stay equal.
    """
    every = [(1, 1, -1, -1), (1, -1, 1, -1), (1, -1, -1, 1)] if len(whole) == 4 else [
        (1, -1, 1), (1, -1, -1)]
    zero = [signs for signs in every
            if not sum(sign * abs(length) for sign, length in zip(signs, whole))]
    sizes = [abs(length) for length in whole]
    if len(zero) > 1:
        for size in {*sizes} - {0}:
            yield [length * (1 + WAY * (own == size)) for length, own in zip(lengths, sizes)]
        return
    signs, = zero
    least = min((i for i, size in enumerate(sizes) if size), key=lambda i: sizes[i])
    for i, size in enumerate(sizes):
        if size and i != least:
            moved = [*lengths]
            moved[i] *= 1 + WAY
            moved[least] *= 1 - signs[i] * signs[least] * WAY * size / mp.mpf(sizes[least])
            yield moved


def linkages(rng, count):
    """Yield (name of a drive, lengths in whole millimetres) of change points up to 200."""
    while count:
        name = rng.choice(list(DRIVES))
        a, b, c = (rng.randint(1, 200) for _ in range(3))
        kind = rng.random()
        if name.startswith('four-bar'):
            lengths = [a, b, c, rng.choice((a + b - c, a - b + c, b + c - a))]
            if kind < 0.2:          # parallelograms, kites, rhombi
                lengths = rng.choice(([a, b, a, b], [a, a, b, b], [a, b, b, a], [a, a, a, a]))
            rng.shuffle(lengths)
            lengths = lengths if kind > 0.2 else lengths[-1:] + lengths[:-1]
            ok = min(lengths) > 0
        else:
            e = 0 if kind < 0.2 else rng.choice((-1, 1)) * c
            lengths = [*rng.sample((a, a + abs(e)), 2), e]
            ok = True
        if ok and max(map(abs, lengths)) <= 200:
            count -= 1
            yield name, tuple(lengths)


def inputs(rng, low, high, is_slide):
    """Return inputs in line, next to it and between, in a range."""
    flats = [0.0] if is_slide else [k * 0.5 * pi for k in range(-4, 17)]
    near = [x + rng.choice((-1, 1)) * (high - low) * 10.0**rng.uniform(-12, -4) for x in flats]
    inner = [x for x in [*flats, *near, 1e-300]
             if 1e-3 < (x - low) / (high - low) < 0.999]
    return rng.sample(inner, min(4, len(inner))) + [
        low + (high - low) * rng.uniform(0.02, 0.98) for _ in range(3)]


def sizes(levels, of_slide, by_slide, whole, least):
    """
    Return how large a coordinate and its derivatives are in the unit of the linkage.

    ``least``: how near to each other both ends of the dyad come. Rates of sliders are quotients
    by it, and accelerations of all linkages once more.
    """
    longest = max(map(abs, whole))
    length, share = mp.mpf(longest) / 1000, longest / least if least else 1
    of_rate = 1 if len(whole) == 4 else share
    unit, per = length if of_slide else mp.mpf(1), 1 / length if by_slide else mp.mpf(1)
    rate = unit * per + abs(levels[1])
    # sines and cosines of half the input have an error of some eps, as if it moved so much
    return [unit + (0 if by_slide else abs(levels[1])), of_rate * rate,
            of_rate * share * (abs(levels[2]) + rate * rate / unit)]


def shares(name, whole, mode, rng):
    """Yield (field, error in eps times condition, input) of a linkage in metres, in four turns."""
    drive = DRIVES[name]
    lengths = [mp.mpf(length) / 1000 for length in whole]
    mechanism = drive.make(*[length / 1000 for length in whole], mode=mode)
    assert mechanism.classification == 'change point' and mechanism.change_point_margin == 0.0
    for low, high in mechanism.closing_ranges:
        if mechanism.turns_fully:
            low, high = -2.0 * pi, 6.0 * pi
        begin, end = next((max(begin, low), min(end, high)) for begin, end in [
            (drive.has_sign[0] + turn, drive.has_sign[1] + turn)
            for turn in ((0.0,) if drive.is_slide else (0.0, 2.0 * pi, -2.0 * pi))]
            if max(begin, low) < min(end, high))
        start = mp.mpf(0.55 * begin + 0.45 * end)
        side, = [side for side in (1, -1) if
                 (drive.measure(drive.pose(lengths, start, side)) > 0) == (mode == 2)]
        branch = Branch(drive.pose, lengths, drive.is_slide, start, side)
        for x in inputs(rng, low, high, drive.is_slide):
            # a range of the crank is the same in every turn
            turn = 0 if drive.is_slide or mechanism.turns_fully else rng.choice((0, 0, -1, 1, 3))
            x += 2.0 * pi * turn
            exactly = mp.mpf(x) - 2 * mp.pi * turn + BEYOND * lengths[0]
            motion, truth = mechanism.motion(x, 1.0), branch.levels(lengths, exactly)
            moved = [branch.levels(other, exactly) for other in moved_lengths(lengths, whole)]
            for coordinate, levels in truth.items():
                conditions = np.array(sizes(levels, coordinate == 'slide', drive.is_slide, whole,
                                            drive.least(*whole)))
                for other in moved:
                    conditions += np.abs(np.subtract(other[coordinate], levels)) / WAY
                ours = [mp.mpf(getattr(motion, field)) for field in COORDINATES[coordinate]]
                if coordinate != 'slide':
                    ours[0] = mp.expj(ours[0])
                for field, error, condition in zip(
                        COORDINATES[coordinate], np.abs(np.subtract(ours, levels)), conditions):
                    yield field, float(error / condition) / EPS, x


@pytest.mark.parametrize('count', [200, pytest.param(2000, marks=pytest.mark.slow)])
def test_a_mode_goes_on_through_poses_in_line(count):
    rng = random.Random(count)
    for name, whole in linkages(rng, count):
        for mode in (1, 2):
            for field, share, x in shares(name, whole, mode, rng):
                assert share <= BOUND, (name, whole, mode, x, field, share)


@pytest.mark.parametrize('count', [40, pytest.param(400, marks=pytest.mark.slow)])
def test_millimetres_metres_and_inches_are_one_linkage(count):
    """Class, ranges, poses in line and extrema are the same, but for roundings of the lengths."""
    rng = random.Random(count)
    for name, whole in linkages(rng, count):
        drive, mode, used = DRIVES[name], rng.choice((1, 2)), [abs(v) for v in whole if v]
        facts, numbers = zip(*[found_in_unit(drive, whole, mode, unit)
                               for unit in (1.0, 1e-3, 1.0 / 25.4)])
        assert facts[0] == facts[1] == facts[2], (name, whole, mode)
        for other in numbers[1:]:
            apart = np.abs(other - numbers[0]) / (1.0 + np.abs(numbers[0]))
            assert apart.max() <= 16.0 * EPS * max(used) / min(used), (name, whole, mode)


def found_in_unit(drive, whole, mode, unit):
    """Return facts of a linkage, and numbers in millimetres, by lengths in a unit."""
    mechanism = drive.make(*[length * unit for length in whole], mode=mode)
    output, of_input = mechanism.outputs[0].coordinate, unit if drive.is_slide else 1.0
    found = find_extrema(mechanism, output[1:], of_input, conditions=False)
    of_value = unit if output.unit == 'm' else 1.0
    at = [*np.ravel(mechanism.closing_ranges), *mechanism.flat_inputs,
          *[extremum.input for extremum in found]]
    return ((mechanism.classification, mechanism.period, len(mechanism.flat_inputs),
             [(extremum.quantity, extremum.kind, extremum.place) for extremum in found]),
            np.array([*[x / of_input for x in at],
                      *[np.clip(extremum.value / of_value, -1e200, 1e200) for extremum in found]]))
