# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema where rounding hides them: none invented, none missed, no value but a computed one."""
from contextlib import suppress
from math import inf, isfinite, isinf, isnan, nan, pi

from fourbar_lab.studies.many import _compared
from fourbar_ros import (
    Bodies,
    Body,
    find_extrema,
    FourBar,
    InvertedSlider,
    load_scene,
    round_rod,
    ScotchYoke,
    SliderCrank,
)
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.extrema.find import _most_extreme, MOST_ALIKE
from fourbar_ros.extrema.over_input import are_equal
from fourbar_ros.extrema.path_search import PathExtremum
from fourbar_ros.extrema.sampling import Sampler
from fourbar_ros.mechanisms.four_bars import MovingJointFourBar
from fourbar_ros.mechanisms.machine.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.quantities import Function, known_quantities
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from support import contract, strategies
from support.cartesian import exact_values
from support.samples import more, record
from support.scans import tops

EPS = 2.0**-52
PAPER = (0.4, 1.2, 0.8, 1.0)
ROCKER = FourBar(0.8, 1.2, 0.4, 1.0)


# --- whatever the lengths ------------------------------------------------------------------------

@contract.every_case
@given(data=st.data())
def test_hostile_lengths_have_extrema_or_are_refused(case, data):
    lengths = [data.draw(strategies.hostile_lengths) for _ in case.kind.LENGTHS]
    try:
        linkage = case.make([length if signed else abs(length) for length, signed in
                             zip(lengths, contract.are_signed(case.kind))])
    except FourBarError:
        return
    output = linkage.outputs[0].coordinate
    with np.errstate(all='ignore'), suppress(FourBarError):
        find_extrema(linkage, (output.rate, output.acceleration))


def test_a_length_of_nothing_beside_the_others_is_refused():
    with pytest.raises(InvalidParameter, match='^a4 = 5e-324: must be at least 1e-100 of the'):
        FourBar(1e-12, 1.0, 1.0, 5e-324)


# --- none invented -------------------------------------------------------------------------------

def on_a_cylinder():
    """Return a machine whose slide has a smooth acceleration, though its links have none."""
    return Machine([Dyad('s', 'RRP', Point('rod', 0.0, 0.3), Point('tube'), ('l', 'b'),
                         length_1=0.5, direction_2=0.3)], 'cylinder',
                   cylinder=Cylinder(Point('ground', 0.7), Point('crank', -0.25),
                                     ('rod', 'tube')))


def test_no_extrema_of_noise_next_to_the_ends_of_a_cylinder():
    machine = on_a_cylinder()
    found = find_extrema(machine, 'slide_b_acceleration')
    assert [(e.kind, e.place, e.is_global) for e in found] == [
        ('minimum', 'limit', True), ('maximum', 'limit', True)]
    (low, high), = machine.closing_ranges
    for extremum, end, inward in zip(found, (low, high), (1.0, -1.0)):
        near = [end + inward * t for t in (1e-9, 4e-9)]
        one, other = exact_values(machine, 'slide_b_acceleration', near, (1.0, 0.0))
        # two points make the limit of a smooth value to the square of their distance
        assert extremum.value == pytest.approx(float(one + (one - other) / 3), rel=1e-8)
        assert (one > extremum.value) is (extremum.kind == 'minimum')


def test_a_load_beside_another_one_1e18_times_larger_is_said_not_to_be_certain():
    dyads = [Dyad('main', 'RRR', Point('crank', 0.4), Point('ground', 1.0), ('rod', 'rocker'),
                  length_1=1.2, length_2=0.8),
             Dyad('small', 'RRP', Point('rocker', 0.4, 0.1), Point('ground', 0.0, 0.6),
                  ('link', 'block'), length_1=1.5, direction_2=0.1)]
    heavy = Body(1e6, cg_along=0.3, cg_across=0.1, inertia=1e5)
    light = Body(1e-12, cg_along=0.3, cg_across=0.1, inertia=1e-13)
    machine = Machine(dyads, bodies={'rod': heavy, 'rocker': heavy, 'link': light, 'block': light})
    one, = find_extrema(machine, 'small_inner', 3.0)
    scan = machine.loads(np.linspace(-np.pi, np.pi, 2001), 3.0).small_inner
    assert one.kind == 'constant' and one.proof.startswith('not certain: constant within ')
    assert np.abs(scan - one.value).max() <= float(one.proof.split()[4])


@pytest.mark.parametrize('wrong', [0.0, 1e-8, 1e-11])
def test_a_shaking_force_is_zero_within_an_error_that_is_told_if_the_masses_balance(wrong):
    """Berkof and Lowen's counterweights, and one that is a little wrong."""
    a1, a2, a3, a4 = PAPER
    coupler = Body(2.0, cg_along=0.5, cg_across=0.1, inertia=0.1)
    at_b = coupler.mass * complex(coupler.cg_along, coupler.cg_across) / a2
    crank, output = -(coupler.mass - at_b) * a1, -at_b * a3
    linkage = FourBar(*PAPER, bodies=Bodies(
        Body(1.0, cg_along=crank.real * (1.0 + wrong), cg_across=crank.imag, inertia=0.1), coupler,
        Body(1.0, cg_along=output.real, cg_across=output.imag, inertia=0.1)))
    # the crank's part turns with it: m e omega^2, constant up to the rounding of the others
    for extremum in find_extrema(linkage, 'shaking_force', 10.0):
        assert abs(extremum.value - abs(crank.real) * wrong * 100.0) <= 1e-12
        if not wrong:
            assert (extremum.kind, extremum.value) == ('constant', 0.0)
            assert 0.0 < float(extremum.proof.split()[4]) < 1e-10


# --- beside change points ------------------------------------------------------------------------

OFF = 1e-14                             # a1 + a4 = a2 + a3 but for this, more than rounding
BESIDE = 0.1, 0.5, 0.3, 0.7 - OFF
NEARLY_A_RHOMBUS = (1.0000033334616476, 1.0000762003798638, 1.0000662905053657, 1.00001799671099)


def with_rods(make, *lengths, **more):
    """Return a linkage with rods."""
    sides = [length for length in (*lengths, 0.3) if length][:3]
    return make(*lengths, bodies=Bodies(*(round_rod(side, 7850.0, 0.01) for side in sides)),
                **more)


def machine_of(a1, a2, a3, a4):
    rods = [round_rod(length, 7850.0, 0.01) for length in (a2, a3)]
    return Machine([Dyad('main', 'RRR', Point('crank', a1), Point('ground', a4),
                         ('rod', 'rocker'), length_1=a2, length_2=a3)],
                   bodies=dict(zip(('rod', 'rocker'), rods)))


@pytest.mark.parametrize('linkage', [
    with_rods(FourBar, *BESIDE), machine_of(*BESIDE),
    with_rods(FourBar, *BESIDE[:3], 0.7 - 1e-12), with_rods(FourBar, *BESIDE[:3], 0.7 - 3e-15),
    with_rods(SliderCrank, 0.3, 0.1, offset=0.2 - OFF),
    with_rods(SliderCrank, 0.7, 0.1, offset=0.6 - OFF),
    with_rods(InvertedSlider, 0.8, 0.1, offset=0.7 - OFF)])
@pytest.mark.parametrize('certify', [False, True])
def test_beside_a_change_point_values_are_those_of_a_step_and_global_ones_are_alike(linkage,
                                                                                    certify):
    quantities = ('shaking_force', 'shaking_moment', 'driving_torque')
    found = find_extrema(linkage, quantities, 10.0, certify=certify)
    for one in found:
        if one.place == 'interior':
            value = getattr(linkage.step(one.theta1, 10.0)[1], one.quantity)
            assert one.value == pytest.approx(value, rel=64 * EPS), one
        assert all(one.value == pytest.approx(other.value, rel=64 * EPS) for other in found
                   if (one.quantity, one.kind) == (other.quantity, other.kind)
                   and one.is_global and other.is_global)
    assert max(abs(one.value) for one in found if one.is_global) > 1e4


@pytest.mark.parametrize('certify', [False, True])
def test_a_force_of_13203_newtons_is_not_zero_at_a_margin_of_1e_6(certify):
    linkage = FourBar(*NEARLY_A_RHOMBUS, mode=1, bodies=Bodies(
        Body(4.655679701884757, cg_along=-0.4163523403752849, cg_across=-0.24243452328563006,
             inertia=0.3457837970995006),
        Body(4.725234785077774, cg_along=-0.8241237999750397, cg_across=-0.09451813159506886,
             inertia=0.2090164375021505),
        Body(3.4090770447230163, cg_along=-0.06676229886692187, cg_across=-0.24101889060347803,
             inertia=0.8622759617605749)))
    found = [one for one in find_extrema(linkage, 'f32', -0.4716864451483751, certify=certify)
             if one.kind == 'minimum']
    near = min(found, key=lambda one: abs(one.theta1 - 4.5644676820757227e-06))
    # in exact arithmetic; a value is known to eps times its condition
    assert near.value == pytest.approx(13203.357362843, rel=EPS * near.value_condition)
    assert near.value > 1e4 and not near.is_global
    assert [one.value for one in found if one.is_global] == [pytest.approx(0.0234, rel=1e-2)]


@pytest.mark.parametrize('mode, sign', [(1, 1), (2, -1)])
def test_limits_of_a_rocker_beside_a_change_point_are_infinite_and_kinds_alternate(mode, sign):
    """a3 + a4 = a1 + a2 + 1e-14: two toggles 1e-7 rad apart."""
    linkage = with_rods(FourBar, 1.4, 1.5, 1.8, 1.1 + OFF, mode=mode)
    found = find_extrema(linkage, ('omega4', 'driving_torque'), 10.0)
    for name in ('omega4', 'driving_torque'):
        kinds = [one.kind for one in found if one.quantity == name]
        assert len(kinds) > 3 and all(a != b for a, b in zip(kinds, kinds[1:]))
    assert [one.value for one in found if one.quantity == 'omega4' and one.place == 'limit'] == [
        sign * inf, -sign * inf]
    assert not any(one.proof for one in found)


def test_limits_of_a_drive_between_two_toggles_beside_each_other_are_infinite():
    """The ends of the ranges of A are those of the crank's less pi, to the last bit."""
    linkage = MovingJointFourBar(0.44, 0.38, 0.08, 0.74 - OFF, input='A')
    found = find_extrema(linkage, 'alpha4', 10.0)
    assert [one.value for one in found] == [-inf, inf, inf, -inf]


def test_global_extrema_are_not_claimed_where_a_proof_knows_more():
    a3 = 0.08530725708380658
    linkage = with_rods(FourBar, 0.0853072573292753, 0.08530725720447806, a3, a3)
    for certify in (False, True):
        found = find_extrema(linkage, 'shaking_moment', 10.0, certify=certify, seconds=inf)
        largest = max(one.value for one in found)
        for one in found:
            assert not one.is_global or isinf(one.value) or one.value == largest > 1e15
        if certify:
            assert any(one.is_global for one in found if not isinf(one.value)) is not any(
                one.proof.startswith('not proved') for one in found)


@pytest.mark.parametrize('linkage, near', [
    (InvertedSlider(1.9489532166482688, 1.948953216648281, 1.7035423314519127e-14), '1e-12 rad'),
    (FourBar(1.0, 1.0 + 32 * EPS, 1.0, 1.0), '1e-12 rad'),
    (InvertedSlider(0.36542448816472595, 0.36542448816472595, -1.142e-16, input='slide'),
     '5e-13 m')])
def test_what_samples_cannot_resolve_is_said_and_no_finite_value_is_global(linkage, near):
    for one in find_extrema(linkage, linkage.outputs[0].coordinate.acceleration, 10.0):
        assert one.proof.startswith(f'not certain: changes within {near} of ')
        assert isinf(one.value) or not one.is_global


# --- none missed: linkages whose dyads come near their toggles together --------------------------

def near_two_toggles(rng):
    """Return a loaded machine with a second dyad that is nearly stretched where the first is."""
    while True:
        first = Dyad('a', 'RRR', Point('crank', rng.uniform(0.5, 1.5)),
                     Point('ground', *rng.uniform(-2.0, 2.0, 2).tolist()), ('a1', 'a2'),
                     length_1=rng.uniform(0.3, 2.0), length_2=rng.uniform(0.3, 2.0),
                     mode=int(rng.integers(1, 3)))
        try:
            alone = Machine([first])
            low, high = alone.closing_ranges[0]
            if alone.turns_fully or high - low < 0.1:
                continue
            carrier = alone.link_motion(alone.motion(low + 10.0**rng.uniform(-6.0, -2.0)), 'a1')
            own, ground = rng.uniform(-1.0, 1.0, 2).tolist(), rng.uniform(-3.0, 3.0, 2).tolist()
            reach = abs(complex(carrier.x, carrier.y) - complex(*ground)
                        + complex(*own) * complex(carrier.cosine, carrier.sine))
            rod, gap = reach * rng.uniform(0.3, 0.7), 10.0**rng.uniform(-6.0, -2.0)
            second = Dyad('b', 'RRR', Point('a1', *own), Point('ground', *ground), ('b1', 'b2'),
                          length_1=rod, length_2=reach * (1.0 + gap) - rod,
                          mode=int(rng.integers(1, 3)))
            bodies = {name: record(Body, rng.uniform(0.5, 2.0),
                                   *rng.uniform(-0.5, 0.5, 2).tolist(),
                                   rng.uniform(0.1, 0.5)) for name in ('a1', 'a2', 'b1', 'b2')}
            machine = Machine([first, second], bodies=bodies, gravity=(0.0, -9.81))
        except FourBarError:
            continue
        if min(high - low for low, high in machine.input_ranges) > 1e-3:
            return machine


def graded(low, high, points):
    """Return inputs that crowd towards both ends, up to 1e-6 of the range from them."""
    s = np.linspace(-1.0, 1.0, points + 2)[1:-1]
    phi = 0.5 * np.pi * np.sign(s) * (1.0 - 10.0**(-3.0 * np.abs(s)))
    return np.where(phi < 0.0, low + (high - low) * np.sin(0.5 * (phi + 0.5 * np.pi))**2,
                    high - (high - low) * np.sin(0.5 * (0.5 * np.pi - phi))**2)


def check_against_graded_scan(machine, points):
    """Return how many extrema a scan has; each must be found, alone of its kind between others."""
    number, quantities = 0, list(known_quantities(machine, machine.input).values())
    found = find_extrema(machine, quantities, 1.3, -0.7, conditions=False)
    for low, high in machine.input_ranges:
        x = graded(low, high, points)
        state = machine.step(x, 1.3, -0.7)
        for quantity in quantities:
            values = quantity.of(*state)
            # next to a toggle the rounding of x is 1e-10 of the distance
            for kind, i in tops(values, 1e-7 * np.abs(values[1:-1])):
                if min(x[i] - low, high - x[i]) > 1e-6 * (high - low):
                    number += 1
                    away = min([abs(machine.distance(e.theta1, x[i])) for e in found
                                if (e.quantity, e.kind, e.place) == (quantity.name, kind,
                                                                     'interior')], default=inf)
                    assert away <= 2.0 * (x[i + 1] - x[i - 1]), (machine, quantity.name, x[i])
    for quantity in quantities:
        own = [e for e in found if e.quantity == quantity.name]
        assert len(own) <= 40, (machine, quantity.name)
        assert all(e.is_global for e in own if isinf(e.value) and (e.value > 0.0) is (
            e.kind == 'maximum'))
    return number


@pytest.mark.parametrize('count, points', [more((3, 4000), (20, 50000))])
def test_machines_near_two_toggles_against_a_graded_scan(count, points):
    rng = np.random.default_rng(902)
    assert sum(check_against_graded_scan(near_two_toggles(rng), points)
               for _ in range(count)) > 40


# --- zero, or equal, but for little: no poles, and none more extreme than another ----------------

def test_a_bounded_quantity_that_is_zero_beside_a_toggle_is_bounded_at_it():
    """It falls to less than half from one sample to the next, as a pole does, but not again."""
    linkage = ROCKER
    low, high = linkage.input_ranges[0]
    at_toggle = linkage.motion(high - 1e-13 * (high - low)).theta4
    for apart in np.geomspace(1e-5, 1e-3, 24):
        crossing = Function('crossing', 'rad', 'zero beside the toggle',
                            lambda motion, _, apart=apart: motion.theta4 - at_toggle - apart)
        assert all(isfinite(one.value) for one in find_extrema(linkage, [crossing]))


def test_a_quantity_with_a_kink_at_a_toggle_is_not_continued_beyond_it():
    """|sin mu| goes on as a sine with its sign, which a polynomial through both sides is not."""
    kink = Function('kink', '1', 'kink at the toggle',
                    lambda motion, _: np.abs(np.sin(motion.transmission_angle)))
    limits = [one.value for one in find_extrema(ROCKER, [kink]) if one.side]
    assert len(limits) == 4 and np.abs(limits).max() < 1e-10


def test_rounding_where_three_dyads_come_into_line_together_is_no_pole():
    """Peaucellier's point Q, on a line: y = k / 2r tan(theta1 / 2), k = L^2 - l^2."""
    scene, rate = load_scene('peaucellier'), 2.0
    machine, arm, side, r = scene.linkage, 0.4, 0.15, 0.15
    found = find_extrema(machine, [*scene.point_quantities, 'shaking_force', 'shaking_moment',
                                   'omega_left_tip'], rate)
    # a straight line is not certain by floats, whose errors grow without bound at the toggles
    assert {(one.quantity, one.kind) for one in found if one.proof} == {('q.x', 'constant')}
    # in the sentence stands by how much its samples differ, not a bound of their errors
    (line,) = [one for one in found if one.proof]
    assert float(line.proof.split()[4]) < 1e-6 * line.value
    limits = [one for one in found if one.place == 'limit']
    assert all(one.value == -one.side * inf for one in limits if one.quantity == 'omega_left_tip')
    limits = [one for one in limits if one.quantity != 'omega_left_tip']
    assert len(limits) == 10
    cosine = (arm - side) / (2.0 * r)       # of half the angle, where the arms are in line
    speed = (arm**2 - side**2) / (4.0 * r * cosine**2) * rate
    exactly = {'q.speed': speed,
               'q.acceleration': speed * rate * np.sqrt(1.0 / cosine**2 - 1.0)}
    for one in limits:
        exactly['q.y'] = (arm**2 - side**2) / (2.0 * r) * np.tan(0.5 * one.input)
        if one.quantity in exactly:     # from 12 samples, whose inputs are rounded
            assert one.value == pytest.approx(exactly[one.quantity], rel=2**10 * EPS)
        else:                           # smooth in the root of the distance
            far, near = exact_values(machine, one.quantity, one.input + one.side * np.array(
                (4e-8, 1e-8)), (rate, 0.0))
            assert one.value == pytest.approx(float(2 * near - far), rel=1e-7), one


def size_by_a_mask(motion, _):
    sign = np.ones_like(motion.slide_velocity)
    sign[motion.slide_velocity < 0.0] = -1.0
    return sign * motion.slide_velocity


def on_arrays_alone(motion, _):
    if not isinstance(motion.slide_velocity, np.ndarray):
        raise ValueError('of arrays alone')
    return np.abs(motion.slide_velocity)


@pytest.mark.parametrize('of', [size_by_a_mask, on_arrays_alone])
def test_a_function_that_no_trace_records_has_the_extrema_of_its_arrays(of):
    """The yoke goes 0.3 m sin(theta1), at 2 rad/s; equal extrema are compared in many digits."""
    most = [extremum for extremum in find_extrema(ScotchYoke(0.3, 0.1), of, 2.0)
            if extremum.kind == 'maximum']
    assert [extremum.input for extremum in most] == pytest.approx([pi / 2, 3 * pi / 2], abs=1e-6)
    assert [extremum.value for extremum in most] == pytest.approx([0.6, 0.6], rel=4 * EPS)


def test_a_quantity_without_a_value_in_many_digits_takes_none_of_another_one():
    rate, nothing = (Function(name, '', name, of) for name, of in (
        ('rate', lambda motion, _: motion.omega4),
        ('0/0', lambda motion, _: motion.omega4 / (motion.omega3 - motion.omega3))))
    exact = Sampler(FourBar(*PAPER), [rate, nothing], (1.0, 0.0)).exact(
        np.array([1.0, 1.0]), np.array([0, 1]))
    assert exact[0] == pytest.approx(FourBar(*PAPER).motion(1.0, 1.0).omega4, rel=16 * EPS)
    assert isnan(exact[1])


def test_a_limit_that_rounding_hides_and_many_digits_cannot_tell_is_left_out_and_said_so():
    scene = load_scene('peaucellier')
    speed = scene.point_quantities[0]
    rough = Function('rough', 'm/s', 'not recorded', lambda *state: np.abs(speed.of(*state)))
    found = find_extrema(scene.linkage, rough)
    assert all(isfinite(one.value) and one.proof.startswith('not certain') for one in found)


@pytest.mark.parametrize('error', [{'noise': 1e-6}, {'value_condition': 1e5}])
def test_many_digits_decide_between_values_within_their_errors_or_nobody_does(error):
    found = [PathExtremum(0, x, value, 1, **error) for x, value in (
        (0.1, 1.0), (0.2, 1.0 + 1e-12), (0.3, 1.0 - 1e-3))]
    for values, first, in_doubt in (([1.0, 0.9], {0}, set()), ([1.0, nan], {1}, {0, 1}),
                                    ([1.0, 1.0 + 10 * EPS], {0, 1}, set())):
        result = _most_extreme(found, 1, lambda x, values=values: np.array(values))
        assert result == (first, in_doubt)


@pytest.mark.parametrize('condition', [0.0, 10.0, 1e3, 1e5])
@pytest.mark.parametrize('part, are_alike', [(0.9, True), (1.1, False)])
def test_one_rule_tells_which_values_are_equal(condition, part, are_alike):
    values = np.array([1.0, 1.0 - part * 4.0 * EPS * (16.0 + min(condition, MOST_ALIKE))])
    extrema = [PathExtremum(0, x, value, 1, value_condition=condition)
               for x, value in zip((0.1, 0.2), values.tolist())]
    first, in_doubt = _most_extreme(extrema, 1, lambda x: values[[x.index(0.1), x.index(0.2)]])
    assert (len(first), in_doubt) == (1 + are_alike, set())
    _, is_global, has_ties = _compared(np.array([[*values, 0.0]]), np.array([3]))
    assert is_global[0, 1] == (are_alike and not condition) and (is_global[0, 1] or has_ties[0])
    if condition >= MOST_ALIKE:
        assert are_equal(values[1], 1.0, 1.0) == are_alike


# --- what is refused -----------------------------------------------------------------------------

@pytest.mark.parametrize('quantities', [
    5, None, (name for name in ('omega4',)), (5,), [None], b'omega4', 1.5, np.zeros(3),
    lambda motion, loads: motion.omega4 * np.nan, lambda motion, loads: np.sqrt(motion.omega4),
    lambda motion, loads: 1j * motion.omega4, lambda motion, loads: complex(motion.omega4),
    lambda motion, loads: 1j * abs(motion.omega4), lambda motion, loads: 'fast',
    lambda motion, loads: [1.0, 2.0], lambda motion, loads: None])
def test_what_is_no_quantity_is_refused_by_name(quantities):
    with pytest.raises(InvalidParameter, match='quantities'):
        find_extrema(FourBar(*PAPER), quantities)
