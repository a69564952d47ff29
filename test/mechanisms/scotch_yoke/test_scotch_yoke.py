# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The Scotch yoke against many digits and a textbook's harmonic motion."""
from math import cos, inf, pi, sin

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    find_extrema,
    InvalidParameter,
    OutOfRange,
    ScotchYoke,
    Toggle,
)
from fourbar_ros.mechanisms.quantities import known
import mpmath as mp
import numpy as np
import pytest
from support.reference import condition, EPS
from support.samples import some
from support.slider_reference import pieces, random_masses
from support.yoke_reference import FIELDS, fields_of, LOADS, loads_of

INPUTS = ('crank', 'slide')
BOUND = 5.0       # in eps cond, as of the other kinds
MASSES = Bodies(Body(2.0, 0.0, 0.0, 0.1), Body(0.3), Body(4.0))


def build(driven, lengths, mode, masses=None):
    """Return a yoke with or without the numbers of random_masses."""
    if masses is None:
        return ScotchYoke(*lengths, mode=mode, input=driven)
    bodies, applied, gravity = pieces(masses)
    return ScotchYoke(*lengths, mode=mode, input=driven,
                      bodies=Bodies(*(Body(*b) for b in bodies)),
                      external=External(*(Applied(*a) for a in applied)), gravity=tuple(gravity))


def draw(rng, driven, family):
    """Return lengths, mode and input of a case."""
    a1, e = float(rng.uniform(0.1, 1.0)), float(rng.normal(0.0, 0.5))
    if family == 'ratios 1e8':
        a1, e = float(10.0**rng.uniform(-4, 4)), float(10.0**rng.uniform(-4, 4))
    mode = int(rng.integers(1, 3)) if driven == 'slide' else 2
    share = rng.uniform(-1.0, 1.0)
    if family == 'near a toggle':
        share = rng.choice((-1.0, 1.0)) * (1.0 - 10.0**rng.uniform(-14, -1))
    elif family == 'near zero':
        share = rng.choice((-1.0, 1.0)) * 10.0**rng.uniform(-20, -1)
    return (a1, e), mode, (float(share * (pi if driven == 'crank' else a1)), float(rng.normal()),
                           float(rng.normal()))


FAMILIES = ('random', 'ratios 1e8', 'near a toggle', 'near zero')


def errors_of(driven, family, rng, with_loads):
    """Return the error of each number of a random case in eps cond, of angles below one in eps."""
    lengths, mode, given = draw(rng, driven, family)
    masses = random_masses(rng, max(map(abs, lengths)), 1.0) if with_loads else []
    sign, front = 2 * mode - 3, [given[0]] if driven == 'crank' else [0, given[0]]
    k = len(front) + 2

    def function(v):
        if with_loads:
            return loads_of(driven, v[k:k + 2], sign, v[k - 3:k], *pieces(v[k + 2:]))
        return fields_of(driven, v[k:k + 2], sign, v[k - 3:k])

    truth, cond = condition(function, [mp.mpf(v) for v in (*front, *given[1:], *lengths, *masses)])
    yoke = build(driven, lengths, mode, masses or None)
    result = yoke.loads(*given) if with_loads else yoke.motion(*given)
    errors = []
    for name, t, c in zip(LOADS if with_loads else FIELDS, truth, cond):
        if isinstance(t, mp.mpc):
            value = mp.mpc(getattr(result, f'{name}_x'), getattr(result, f'{name}_y'))
        else:
            value = (result.driving_torque + result.driving_force if name == 'drive'
                     else getattr(result, name))
        error = abs(value - t)
        if name in ('theta1', 'theta2'):
            error, c = abs(mp.arg(mp.expj(error))), max(c, 1)
        errors.append(float(error / (EPS * c)) if c else float(error))
    return errors


@pytest.mark.parametrize('driven', INPUTS)
@some('family', FAMILIES, 1)
def test_motion_and_loads_to_five_eps_cond(driven, family):
    rng = np.random.default_rng(7)
    for with_loads, names, count in ((False, FIELDS, 25), (True, LOADS, 4)):
        worst = np.max([errors_of(driven, family, rng, with_loads) for _ in range(count)], axis=0)
        assert {name: error for name, error in zip(names, worst) if not error <= BOUND} == {}


def test_harmonic_motion_of_a_textbook():
    """
    Any textbook: s = r cos wt, v = -r w sin wt, a = -r w^2 cos wt.

    The frame takes m a of yoke and block.
    """
    r, w = 0.1, 30.0
    yoke = ScotchYoke(r, bodies=MASSES)
    for t in (0.0, 0.01, 0.04, 0.07):
        motion, loads = yoke.step(w * t, w)
        assert motion.slide == pytest.approx(r * cos(w * t), abs=1e-16)
        assert motion.slide_velocity == pytest.approx(-r * w * sin(w * t), abs=1e-14)
        assert motion.slide_acceleration == pytest.approx(-r * w**2 * cos(w * t), abs=1e-12)
        assert loads.shaking_force_x == pytest.approx((4.0 + 0.3) * r * w**2 * cos(w * t),
                                                      abs=1e-11)
        assert loads.shaking_force_y == pytest.approx(0.3 * r * w**2 * sin(w * t), abs=1e-11)
        assert (loads.f32_x == pytest.approx(4.0 * r * w**2 * cos(w * t), abs=1e-11)
                and loads.f32_y == 0.0)
        assert loads.driving_torque == pytest.approx(0.5 * 4.0 * r**2 * w**2 * sin(2.0 * w * t),
                                                     abs=1e-11)


def test_extrema_of_harmonic_motion():
    """
    Two of the velocity and two of the acceleration, at quarters of a turn.

    Torque at odd eighths.
    """
    yoke = ScotchYoke(0.1, 0.02, bodies=MASSES)
    found = find_extrema(yoke, ('slide_velocity', 'slide_acceleration', 'driving_torque'), 30.0)
    places = {name: sorted(e.theta1 for e in found if e.quantity == name)
              for name in {e.quantity for e in found}}
    assert places['slide_velocity'] == pytest.approx([0.5 * pi, 1.5 * pi], abs=1e-12)
    assert places['slide_acceleration'] == pytest.approx([0.0, pi], abs=1e-12)
    assert places['driving_torque'] == pytest.approx([(k + 0.5) * 0.5 * pi for k in range(4)],
                                                     abs=1e-12)
    largest = {'slide_velocity': 3.0, 'slide_acceleration': 90.0, 'driving_torque': 18.0}
    for extremum in found:
        assert abs(extremum.value) == pytest.approx(largest[extremum.quantity], rel=1e-14)


@pytest.mark.parametrize('driven', INPUTS)
def test_extrema_against_a_scan(driven):
    rng = np.random.default_rng(9)
    for _ in range(3):
        lengths, mode, _ = draw(rng, driven, 'random')
        yoke = build(driven, lengths, mode, random_masses(rng, lengths[0], 1.0))
        quantities = list(known(yoke, driven).values())
        found = find_extrema(yoke, quantities, 1.3, 0.4)
        low, high = yoke.input_ranges[0]
        x = low + (high - low) * (np.arange(4000) + 0.5) / 4000
        motion, loads = yoke.step(x, 1.3, 0.4)
        for quantity in quantities:
            values = quantity.of(motion, loads)
            inside = values[1:-1]
            for kind, is_top in (('maximum', (inside > values[:-2]) & (inside > values[2:])),
                                 ('minimum', (inside < values[:-2]) & (inside < values[2:]))):
                ours = [e.theta1 if driven == 'crank' else e.slide for e in found
                        if (e.quantity, e.kind) == (quantity.name, kind)]
                for place in x[1:-1][is_top]:
                    assert min((abs(yoke.distance(place, other)) for other in ours),
                               default=inf) < 2 * (x[1] - x[0])


def test_toggles_modes_and_ranges():
    yoke = ScotchYoke(0.1, input='slide')
    assert yoke.input_ranges == ((-0.1, 0.1),) and set(yoke.modes) == {1, 2}
    with pytest.raises(Toggle):
        yoke.motion(0.1, 1.0)
    with pytest.raises(OutOfRange):
        yoke.motion(0.1000001, 1.0)
    assert yoke.in_mode(1).motion(0.05).theta1 == -yoke.motion(0.05).theta1
    assert np.isnan(yoke.motion(np.array([0.2])).theta1[0])
    with pytest.raises(InvalidParameter, match='one assembly mode'):
        ScotchYoke(0.1, mode=1)
    assert [tuple(point) for point in ScotchYoke(0.1).dead_points] == [(0.0, 0.1), (pi, -0.1)]
    assert ScotchYoke(0.1, input='slide', stroke=(0.0, 0.05)).input_ranges == ((0.0, 0.05),)


@pytest.mark.parametrize('driven', INPUTS)
def test_arrays_complex_steps_and_polygons(driven):
    rng = np.random.default_rng(3)
    for _ in range(5):
        lengths, mode, given = draw(rng, driven, 'random')
        yoke = build(driven, lengths, mode, random_masses(rng, lengths[0], 1.0))
        one, many = yoke.step(*given), yoke.step(*(np.full((2, 50), v) for v in given))
        for single, array in zip(one, many):
            scale = max(1.0, *map(abs, single))
            assert all(values.shape == (2, 50) and np.abs(values - value).max() <= 1e-12 * scale
                       for value, values in zip(single, array))
        moved = yoke.motion(np.array([given[0]]) + 1e-40j, 1.0)
        derivative = (moved.slide_velocity.imag[0] / 1e-40 if driven == 'crank'
                      else moved.omega1.imag[0] / 1e-40)
        second = moved.slide_acceleration if driven == 'crank' else moved.alpha1
        assert derivative == pytest.approx(second.real[0], rel=1e-12)
        motion = one[0]
        for arrows, ends in ((yoke.velocity_polygon(motion), ('V_A', 'V_{rel}')),
                             (yoke.acceleration_polygon(motion), ('A_A', 'A_{rel}'))):
            by_name = {arrow.label: arrow for arrow in arrows}
            tip = by_name[ends[1]].start + by_name[ends[1]].vector
            assert np.abs(by_name[ends[0]].vector
                          - tip).max() <= 1e-12 * max(1.0, np.abs(tip).max())
