# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The contract of a mechanism, for every kind with every input in every mode.

A new kind is tested by being one.

It needs an entry in :data:`support.references.REFERENCES`; everything else comes from the registry
of kinds.
"""

import json
from math import inf, nan, pi
import pickle

from fourbar_ros import Applied, InvalidParameter, MissingBodies, OutOfRange, Toggle
from fourbar_ros.cli.main import main
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.points import link_motion, point_motion, point_of
from fourbar_ros.mechanisms.quantities import known, point_acceleration, point_speed, select
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.scene import scene as scenes
import mpmath as mp
import numpy as np
import pytest
from support import bags, contract
from support.contract import ANGLE_BOUND, CASES, EPS, LOADS_BOUND, RATE_BOUND
from support.references import REFERENCES
from support.scans import check_against_scan

every_case = pytest.mark.parametrize('case', CASES, ids=contract.name_of)
every_family = pytest.mark.parametrize(
    'case, family',
    [
        (case, family)
        for case in CASES
        if case.name in REFERENCES
        for family in contract.families_of(case)
    ],
    ids=contract.name_of,
)
STEP = 1e-40  # of the complex step: its square is lost beside anything
OUTER = ('state', 'loads')
NOT_SENT = {'slot_couple'}  # loads of one kind alone, without a field in LinkageLoads


def test_every_kind_has_a_reference():
    assert set(REFERENCES) == set(KINDS)
    assert {case.name for case in CASES} == set(KINDS)


# --- accuracy ------------------------------------------------------------------------------------


def worst(errors_of, case, family, seed, count):
    """Return {field: largest error in eps cond} over some mechanisms of a family."""
    rng, largest = np.random.default_rng(seed), {}
    for _ in range(count):
        for name, error in errors_of(rng, *contract.draw(rng, case, family)).items():
            largest[name] = max(largest.get(name, 0.0), error)
    return largest


def check_motion(case, family, seed, count):
    errors = worst(
        lambda rng, *drawn: contract.motion_errors(case, *drawn), case, family, seed, count
    )
    assert set(errors) >= {
        name for coordinate in contract.coordinates(case.kind) for name in coordinate
    }
    assert {
        name: error
        for name, error in errors.items()
        if not error <= (ANGLE_BOUND if name.startswith(contract.ANGLES) else RATE_BOUND)
    } == {}


def check_loads(case, family, seed, count):
    errors = worst(
        lambda rng, lengths, given: contract.load_errors(
            case, lengths, given, contract.random_masses(rng, case, max(map(abs, lengths)), 1.0)
        ),
        case,
        family,
        seed,
        count,
    )
    known_fields = set(errors) | {f'{name}_{axis}' for name in errors for axis in 'xy'}
    assert known_fields >= set(case.kind.LOADS._fields)
    assert {name: error for name, error in errors.items() if not error <= LOADS_BOUND} == {}


@every_family
def test_motion_of_a_sample(case, family):
    check_motion(case, family, 201, 10)


@every_case
@pytest.mark.parametrize(
    'family', ['random', 'near a toggle', 'near a change point', 'link ratios 1e8']
)
def test_loads_of_a_sample(case, family):
    check_loads(case, family, 202, 1)


@pytest.mark.xfail(
    strict=True, reason='omega2, alpha2 and the velocity of the slider lose digits there'
)
@pytest.mark.parametrize(
    'lengths, given',
    [
        (
            (0.00146334100697, 1624.3261801388537, -1624.325154274245),
            (-0.2533962848214397, -1.15, -0.71),
        ),
        (
            (392.61885340430956, 0.011135637729296571, 392.62426529399465),
            (1.570739864501184, -0.57, 0.43),
        ),
    ],
)
def test_an_offset_near_a_length_a_thousand_times_the_other(lengths, given):
    case = next(case for case in CASES if case[0] == 'slider_crank' and case[2:] == ('crank', 1))
    assert max(contract.motion_errors(case, lengths, given).values()) <= RATE_BOUND


@pytest.mark.slow
@every_family
def test_motion_and_loads_in_full(case, family):
    check_motion(case, family, 203, 1500)
    check_loads(case, family, 204, 50)


@every_case
def test_magnitudes_are_those_of_their_components(case):
    for mechanism, given in contract.ordinary(case, 205, 20):
        loads = mechanism.loads(*given)
        pairs = [name[:-2] for name in loads._fields if name.endswith('_x')]
        assert len(pairs) >= 3
        for name in pairs:
            size = np.hypot(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
            assert abs(getattr(loads, name) - size) <= 2 * EPS * size, name


# --- links ---------------------------------------------------------------------------------------


def links_of(case):
    return case.bodies._fields


@every_case
def test_links_are_where_the_reference_has_them(case):
    """
    First joint and direction of every link.

    Away from toggles the condition is at most some hundred.
    """
    for mechanism, given in contract.ordinary(case, 206, 20):
        motion = mechanism.motion(*given)
        exact = case.reference.links(
            case.driven,
            [mp.mpf(v) for v in mechanism.lengths],
            case.sign,
            [mp.mpf(v) for v in given],
        )
        assert set(exact) == set(links_of(case))
        size = max(map(abs, mechanism.lengths))
        for link, (place, direction) in exact.items():
            at = link_motion(mechanism, motion, link)
            assert abs(mp.mpc(at.x, at.y) - place) <= 1e-13 * (size + abs(place)), link
            assert abs(mp.mpc(at.cosine, at.sine) - direction / abs(direction)) <= 1e-12, link


@every_case
def test_velocities_of_links_are_derivatives_of_their_places(case):
    """Complex step: at rate 1 and acceleration 0 derivatives by time are those by the input."""
    for mechanism, (value, _, _) in contract.ordinary(case, 207, 20):
        motion = mechanism.motion(np.array([value]) + 1j * STEP, 1.0)
        for link in links_of(case):
            at = link_motion(mechanism, motion, link)
            pairs = [
                (at.x, at.v_x),
                (at.y, at.v_y),
                (at.v_x, at.a_x),
                (at.v_y, at.a_y),
                (at.omega, at.alpha),
            ]
            size = max(
                1.0, *(abs(np.real(number)) for pair in pairs for number in map(first, pair))
            )
            for function, derivative in pairs:
                slope = first(function).imag / STEP
                assert abs(slope - first(derivative).real) <= 1e-11 * size**2, link
            spin = (
                first(at.sine).imag / STEP * first(at.cosine).real
                - first(at.cosine).imag / STEP * first(at.sine).real
            )
            assert abs(spin - first(at.omega).real) <= 1e-11 * size, link
            assert (
                abs(abs(complex(first(at.cosine).real, first(at.sine).real)) - 1.0) <= 4 * EPS
            ), link


def first(numbers):
    """Return the first of some numbers, or the only one."""
    return complex(np.ravel(numbers)[0])


@every_case
def test_rates_and_accelerations_are_derivatives(case):
    for mechanism, (value, _, _) in contract.ordinary(case, 208, 20):
        motion = mechanism.motion(np.array([value]) + 1j * STEP, 1.0)
        size = max(
            1.0,
            *(
                abs(first(getattr(motion, name)))
                for c in contract.coordinates(case.kind)
                for name in c[1:]
            ),
        )
        for coordinate in contract.coordinates(case.kind):
            slope = first(getattr(motion, coordinate.rate)).imag / STEP
            assert (
                abs(slope - first(getattr(motion, coordinate.acceleration)).real)
                <= 1e-11 * size**2
            ), coordinate
        ratios = [name for name in motion._fields if name.endswith('_ratio')]
        rates = [
            first(getattr(motion, name)).real
            for name in motion._fields
            if name.startswith('omega') or name.endswith('velocity')
        ]
        for name in ratios:
            value_of = first(getattr(motion, name)).real
            assert min(abs(value_of - rate) for rate in rates) <= 4 * EPS * size, name


@every_case
def test_differences_of_positions_are_rates(case):
    """Plain differences of single values, by time: of an independent kind, if coarse (h^2)."""
    h = 1e-5
    for mechanism, (value, rate, acceleration) in contract.ordinary(case, 209, 10):
        steps = [
            mechanism.motion(
                value + rate * t + 0.5 * acceleration * t * t,
                rate + acceleration * t,
                acceleration,
            )
            for t in (-h, 0.0, h)
        ]
        size = max(
            1.0,
            *(
                abs(getattr(steps[1], name))
                for c in contract.coordinates(case.kind)
                for name in c[1:]
            ),
        )
        for position, rate_name, acceleration_name in contract.coordinates(case.kind):
            one, _, other = (getattr(step, position) for step in steps)
            change = (
                np.remainder(other - one + pi, 2.0 * pi) - pi
                if position.startswith('theta')
                else other - one
            )
            assert abs(change / (2 * h) - getattr(steps[1], rate_name)) <= 1e-6 * size**3, position
            one, _, other = (getattr(step, rate_name) for step in steps)
            assert (
                abs((other - one) / (2 * h) - getattr(steps[1], acceleration_name))
                <= 1e-6 * size**4
            ), rate_name


# --- balances ------------------------------------------------------------------------------------


def needed(mechanism, motion):
    """Return force, moment about O1 and power that the links need, and their sizes."""
    total, sizes, gravity = np.zeros(4), np.zeros(3), complex(*mechanism.gravity)
    for link, body in mechanism.bodies._asdict().items():
        at, push = (
            link_motion(mechanism, motion, link),
            getattr(mechanism.external, link, Applied()),
        )
        couple = body.inertia * at.alpha - push.couple
        for along, across, is_body in (
            (body.cg_along, body.cg_across, True),
            (push.along, push.across, False),
        ):
            x, y, v_x, v_y, a_x, a_y = point_of(at, along, across)
            force = (
                body.mass * (complex(a_x, a_y) - gravity)
                if is_body
                else -complex(push.force_x, push.force_y)
            )
            total += (
                force.real,
                force.imag,
                x * force.imag - y * force.real,
                v_x * force.real + v_y * force.imag,
            )
            sizes += (abs(force), np.hypot(x, y) * abs(force), np.hypot(v_x, v_y) * abs(force))
        total += (0.0, 0.0, couple, couple * at.omega)
        sizes += (0.0, abs(couple), abs(couple * at.omega))
    return complex(*total[:2]), total[2], total[3], sizes


@every_case
def test_power_and_momentum_balance(case):
    """Shaking = -dP/dt, -dH/dt + loads; power of the drive = dE/dt: 1e-13 of the summed sizes."""
    for mechanism, given in contract.ordinary(case, 210, 60):
        motion, loads = mechanism.step(*given)
        force, moment, power, (size_force, size_moment, size_power) = needed(mechanism, motion)
        assert (
            abs(complex(loads.shaking_force_x, loads.shaking_force_y) + force)
            <= 1e-13 * size_force
        )
        assert abs(loads.shaking_moment + moment) <= 1e-13 * size_moment
        drives = [getattr(loads, name, 0.0) for name in ('driving_torque', 'driving_force')]
        assert abs(sum(drives) * given[1] - power) <= 1e-13 * size_power
        assert drives[case.turns] == 0.0 != drives[not case.turns]


# --- numbers of all kinds ------------------------------------------------------------------------


@every_case
def test_arrays_equal_single_values(case):
    for mechanism, given in contract.ordinary(case, 211, 10):
        one = mechanism.step(*given)
        for shape in ((2, 1, 3), (100,)):
            many = mechanism.step(*(np.full(shape, v) for v in given))
            for single, array in zip(one, many):
                size = max(1.0, *map(abs, single))
                for name, value, values in zip(single._fields, single, array):
                    assert values.shape == shape and (values == values.flat[0]).all(), name
                    assert abs(values.flat[0] - value) <= (
                        0.0 if values.size < 10 else 1e-12 * size
                    ), name
        assert mechanism.motion(np.float64(given[0]), *given[1:]) == one[0]


@every_case
def test_some_fields_are_those_of_the_whole(case):
    for mechanism, given in contract.ordinary(case, 212, 3):
        names = mechanism.MOTION._fields + mechanism.LOADS._fields
        for values in (given, [np.full(40, v) for v in given]):
            whole = dict(zip(names, sum(mechanism.step(*values), ())))
            for name in names:
                (part,) = mechanism.step(*values, fields=(name,))
                np.testing.assert_array_equal(part, whole[name], err_msg=name)
            assert len(mechanism.motion(*values, fields=mechanism.MOTION._fields)) == len(
                mechanism.MOTION._fields
            )
        for wrong in (('nothing',), 'theta1', (names[-1],)):
            with pytest.raises(InvalidParameter, match='^fields = '):
                mechanism.motion(*given, fields=wrong)


@every_case
@pytest.mark.parametrize('power', [-300, 200])
def test_scaling_by_a_power_of_two_changes_no_bit(case, power):
    """
    Lengths times a power of two, masses that keep the forces.

    Every field is the same times a power of it.
    """
    scale, exponents = 2.0**power, {}
    for mechanism, given in contract.ordinary(case, 213, 5):
        bodies = [
            type(b)(b.mass / scale, b.cg_along * scale, b.cg_across * scale, b.inertia * scale)
            for b in mechanism.bodies
        ]
        external = [
            Applied(a.force_x, a.force_y, a.along * scale, a.across * scale, a.couple * scale)
            for a in mechanism.external
        ]
        scaled = case.make(
            [v * scale for v in mechanism.lengths],
            bodies=case.bodies(*bodies),
            external=case.external(*external),
            gravity=tuple(v * scale for v in mechanism.gravity),
        )
        moved = given if case.turns else [v * scale for v in given]
        for one, other in zip(mechanism.step(*given), scaled.step(*moved)):
            for name, value, values in zip(one._fields, one, other):
                fits = {p for p in (-1, 0, 1) if value * scale**p == values}
                exponents[name] = exponents.get(name, {-1, 0, 1}) & fits
    assert {name for name, fits in exponents.items() if not fits} == set()
    quantities = known(case.kind, case.driven)
    assert {
        name: (1 if q.unit in ('m', 'm/s', 'm/s^2', 'N m') else 0) in exponents[name]
        for name, q in quantities.items()
    } == dict.fromkeys(quantities, True)


# --- what it says about itself -------------------------------------------------------------------


@every_case
def test_fields_are_named(case):
    fields = case.kind.MOTION._fields + case.kind.LOADS._fields
    assert len(set(fields)) == len(fields)
    for coordinate in (*contract.coordinates(case.kind), *case.kind.INPUTS.values()):
        assert set(coordinate) <= set(case.kind.MOTION._fields), coordinate
    assert {'transmission_angle', 'condition'} <= set(case.kind.MOTION._fields)
    assert {'shaking_force_x', 'shaking_force_y', 'shaking_force', 'shaking_moment'} <= set(
        case.kind.LOADS._fields
    )
    assert set(known(case.kind, case.driven)) <= set(fields)


@every_case
def test_what_is_given_comes_back(case):
    for mechanism, given in contract.ordinary(case, 214, 5):
        motion = mechanism.motion(*given)
        assert tuple(getattr(motion, name) for name in mechanism.input_coordinate) == given
        unknown = mechanism.unknown(*given)._asdict()
        assert tuple(unknown.pop(name) for name in mechanism.input_coordinate) == given
        assert all(np.isnan(value) for value in unknown.values())


@every_case
def test_pickled_and_compared(case):
    for mechanism, given in contract.ordinary(case, 215, 5):
        again = pickle.loads(pickle.dumps(mechanism))
        assert again == mechanism and again.step(*given) == mechanism.step(*given)
        assert again != case.make([2.0 * v for v in mechanism.lengths])


@every_case
def test_in_mode(case):
    for mechanism, given in contract.ordinary(case, 216, 5):
        assert mechanism.in_mode(case.mode) is mechanism
        for mode in contract.modes_of(case.kind, case.driven):
            other = mechanism.in_mode(mode)
            assert (
                other.mode == mode
                and other.lengths == mechanism.lengths
                and other.bodies == mechanism.bodies
            )
            if mode != case.mode:
                try:
                    assert other.motion(*given) != mechanism.motion(*given)
                except OutOfRange:  # a mode may have a range of its own
                    assert other.input_ranges != mechanism.input_ranges
        assert (mechanism.sign > 0.0) == (case.mode == 2)


@every_case
def test_wrong_arguments_are_refused_by_name(case):
    lengths, _ = contract.draw(np.random.default_rng(217), case)
    names = [getattr(length, 'name', length) for length in case.kind.LENGTHS]
    for i, (name, is_signed) in enumerate(zip(names, contract.are_signed(case.kind))):
        for value in (nan, inf, *(() if is_signed else (0.0, -1.0)), 'long'):
            with pytest.raises(InvalidParameter, match=f'^{name} = '):
                case.make([*lengths[:i], value, *lengths[i + 1:]])
    for name, value in (('gravity', (0.0,)), ('gravity', (nan, 0.0)), ('mode', 3), ('mode', True)):
        with pytest.raises(InvalidParameter, match=f'^{name} = '):
            case._replace(mode=value).make(lengths) if name == 'mode' else case.make(
                lengths, **{name: value}
            )
    if len(case.kind.INPUTS) > 1:
        with pytest.raises(InvalidParameter, match='^input = '):
            case.kind(*lengths, input='piston')
    mechanism, given = case.make(lengths), contract.draw(np.random.default_rng(217), case)[1]
    with pytest.raises(MissingBodies, match='mass'):
        mechanism.loads(*given)
    for i, name in enumerate(mechanism.input_coordinate):
        with pytest.raises(InvalidParameter, match=f'^{name} = '):
            mechanism.motion(*given[:i], inf, *given[i + 1:])


# --- ranges --------------------------------------------------------------------------------------


@every_case
def test_ranges_are_where_it_closes(case):
    """
    Inside of the ranges every array has numbers, outside NaN.

    Single values raise OutOfRange there.
    """
    rng, seen = np.random.default_rng(218), 0
    for _ in range(20):
        lengths, _ = contract.draw(rng, case)
        mechanism = case.make(lengths, contract.random_masses(rng, case, 1.0, 1.0))
        reach = pi if case.turns else 1.5 * sum(map(abs, lengths))
        x = rng.uniform(-reach, reach, 400)
        turns = (-2.0 * pi, 0.0, 2.0 * pi) if case.turns else (0.0,)
        ends = np.array(
            [end + turn for bounds in mechanism.input_ranges for end in bounds for turn in turns]
        )
        if not mechanism.turns_fully:
            x = x[np.abs(x[:, None] - ends).min(axis=1) > 1e-9 * reach]
        inside = np.zeros(x.shape, bool)
        for low, high in mechanism.input_ranges:
            assert low < high
            for turn in turns:
                inside |= (low + turn <= x) & (x <= high + turn)
        motion, loads = mechanism.step(x, 0.1)
        coordinates = {name for c in contract.coordinates(case.kind) for name in c} - set(
            mechanism.input_coordinate
        )
        for field in (
            *(getattr(motion, name) for name in coordinates),
            loads.shaking_moment,
            motion.condition,
        ):
            np.testing.assert_array_equal(np.isfinite(field), inside)
        for value in x[~inside][:5].tolist():
            seen += 1
            with pytest.raises(OutOfRange) as caught:
                mechanism.motion(value)
            assert caught.value.ranges == mechanism.input_ranges and caught.value.value == value
        low, high = mechanism.input_ranges[0]
        assert mechanism.turns_fully == (case.turns and (low, high) == (-pi, pi))
    if not case.turns:
        assert seen > 50


@every_case
def test_limits_are_singular(case):
    """
    Next to the ends of a range the mechanism is nearly in line.

    The sine falls as the root of the distance.
    """
    rng, ends = np.random.default_rng(219), 0
    for _ in range(40):
        lengths, _ = contract.draw(rng, case)
        mechanism = case.make(lengths)
        if mechanism.turns_fully or mechanism.change_point_margin < 1e-3:
            continue
        singular = np.array(mechanism.singular_inputs)
        for low, high in mechanism.input_ranges:
            for end, inward in ((low, 1.0), (high, -1.0)):
                ends += 1
                distance = 1e-8 * (high - low)
                motion = mechanism.motion(end + inward * distance)
                assert np.sin(motion.transmission_angle) <= 1e-2
                with pytest.raises((OutOfRange, Toggle)):
                    mechanism.motion(end - inward * distance)
                assert min(
                    abs(mechanism.distance(z.real, end)) + abs(z.imag) for z in singular
                ) <= 1e-7 * (high - low)
    if not case.turns:
        assert ends > 40


# --- extrema -------------------------------------------------------------------------------------


def everything(mechanism, rng):
    """Return all quantities of a mechanism, and two of a point of its second link."""
    link = mechanism.bodies._fields[1]
    at = rng.uniform(-0.5, 0.5, 2).tolist()
    return [
        *select((), mechanism),
        point_speed(mechanism, link, *at),
        point_acceleration(mechanism, link, *at),
    ]


def mechanisms_for_extrema(case, seed, count):
    """Yield random loaded mechanisms, not too near a change point."""
    rng = np.random.default_rng(seed)
    while count:
        lengths, _ = contract.draw(rng, case)
        mechanism = case.make(lengths, contract.random_masses(rng, case, 1.0, 1.0))
        if mechanism.change_point_margin > 1e-3:
            count -= 1
            yield rng, mechanism


@every_case
def test_extrema_against_a_scan(case):
    number = sum(
        check_against_scan(
            mechanism,
            everything(mechanism, rng),
            float(rng.normal(0.0, 10.0)),
            float(rng.normal(0.0, 50.0)),
            20_000,
        )
        for rng, mechanism in mechanisms_for_extrema(case, 220, 3)
    )
    assert number > 20


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(4))
@every_case
def test_extrema_of_many_against_a_scan(case, seed):
    for rng, mechanism in mechanisms_for_extrema(case, 230 + seed, 16):
        check_against_scan(
            mechanism, everything(mechanism, rng), float(rng.normal(0.0, 10.0)), 0.0, 60_000
        )


# --- scenes, messages, pictures ------------------------------------------------------------------


def parameters_of(mechanism, name):
    """Return the parameters of a scene of this mechanism."""
    kind = type(mechanism)
    values = {
        'linkage.kind': name,
        'linkage.mode': mechanism.mode,
        'linkage.input': mechanism.input,
        'gravity.x': mechanism.gravity[0],
        'gravity.y': mechanism.gravity[1],
    }
    names = [getattr(length, 'name', length) for length in kind.LENGTHS]
    values.update((f'linkage.{length}', value) for length, value in zip(names, mechanism.lengths))
    for link, body in mechanism.bodies._asdict().items():
        values.update(
            (f'bodies.{link}.{field}', getattr(body, field)) for field in body.__dataclass_fields__
        )
    for link, push in mechanism.external._asdict().items():
        values.update(
            (f'external.{link}.{field}', getattr(push, field))
            for field in push.__dataclass_fields__
        )
    return values


@every_case
def test_a_scene_keeps_every_digit(case):
    """Parameters -> mechanism -> parameters as JSON -> mechanism."""
    for mechanism, given in contract.ordinary(case, 221, 5):
        scene = scenes.from_values(parameters_of(mechanism, case.name))
        assert scene.linkage == mechanism
        again = scenes.from_values(json.loads(scene.as_json))
        assert again.linkage == mechanism and again.linkage.step(*given) == mechanism.step(*given)


@every_case
def test_messages_are_complete(case):
    """
    Every number of the messages has a source.

    Every joint and load of the mechanism is in one.
    """
    for mechanism, given in contract.ordinary(case, 222, 2):
        scene = scenes.from_values(
            {
                **parameters_of(mechanism, case.name),
                'outputs': ['state', 'output', 'joint_states', 'loads', 'shaking_wrench'],
            }
        )
        motion, loads = scene.linkage.step(*given)
        sent = {
            output: scene.layout.expected(output, motion + loads)
            for output in ('driven', *scene.outputs)
        }
        for output in OUTER:
            fields = {name for name, _ in bags.STORE.fielddefs[scene.topics[output].type][1]}
            assert fields - set(sent[output]) <= {
                'header',
                'status',
                'mode',
                'change_point_margin',
            }

        for output, values in (('state', motion), ('loads', loads)):
            for name in set(sent[output]) & set(values._fields):
                assert sent[output][name] == getattr(values, name), name
        assert set(loads._fields) - set(sent['loads']) <= NOT_SENT
        assert sent['joint_states']['velocity'] == tuple(
            getattr(motion, c.rate) for c in contract.coordinates(case.kind)
        )
        assert tuple(sent['driven'].values()) == given
        assert sent['joint_states']['position'] == tuple(
            getattr(motion, c.position) for c in contract.coordinates(case.kind)
        )
        absent = set(sent['state']) - set(motion._fields) - {'velocity_ratio'}
        assert all(np.isnan(sent['state'][name]) for name in absent)
        for output in scene.topics:
            assert bags.output_message(output, 10**9, 0, motion + loads, scene)


@every_case
def test_shown_and_drawn(case, tmp_path, capsys):
    pytest.importorskip('matplotlib')
    mechanism, given = next(contract.ordinary(case, 223, 1))
    scene = tmp_path / 'scene.yaml'
    scene.write_text(json.dumps({'/**': {'ros__parameters': parameters_of(mechanism, case.name)}}))
    at = str(np.degrees(given[0]) if case.turns else given[0])
    assert not main(['show', str(scene), '--at', at, '--speed', '3'])
    text = capsys.readouterr().out
    for name in known(case.kind, case.driven):
        assert name in text
    picture = tmp_path / 'pose.svg'
    assert not main(['draw', str(scene), '--at', at, '--speed', '3', '-o', str(picture)])
    assert picture.stat().st_size > 5_000


@every_case
def test_points_of_all_links(case):
    """Speed and acceleration of a point as a quantity, and its motion: one set of numbers."""
    for mechanism, given in contract.ordinary(case, 224, 5):
        state = mechanism.step(*given)
        for link in links_of(case):
            point = point_motion(mechanism, state[0], link, 0.3, -0.2)
            speed = point_speed(mechanism, link, 0.3, -0.2).of(*state)
            assert speed == pytest.approx(point.speed, rel=4 * EPS)
            assert point_acceleration(mechanism, link, 0.3, -0.2).of(*state) == pytest.approx(
                np.hypot(point.acceleration_x, point.acceleration_y), rel=4 * EPS
            )
        with pytest.raises(InvalidParameter, match='^link = '):
            link_motion(mechanism, state[0], 'spring')


# --- other coordinates ---------------------------------------------------------------------------


@every_case
def test_another_coordinate_gives_the_same_links_by_the_chain_rule(case):
    """X' = o' X_o and X'' = o'^2 X_oo + o'' X_o for every link, in one of its modes; and back."""
    for mechanism, (value, _, _) in contract.ordinary(case, 500, 20):
        curves = mechanism.make_coefficients(REAL)(value)
        others = mechanism.driven_otherwise()
        other, ratio, bend = others[0].read_coordinate(REAL, curves)
        own, *slopes = mechanism.read_coordinate(REAL, curves)
        assert abs(mechanism.distance(own, value)) <= 1e-13 * (1.0 + abs(value))
        assert slopes == pytest.approx((1.0, 0.0), abs=1e-11)
        errors = []
        for same in others:
            found = same.make_coefficients(REAL)(other)
            error = abs(mechanism.distance(mechanism.read_coordinate(REAL, found)[0], value))
            for (x, y, dx, dy, ddx, ddy, cosine, sine, turn, turn2), exact in zip(found, curves):
                by_chain = (x, y, ratio * dx, ratio * dy, ratio**2 * ddx + bend * dx,
                            ratio**2 * ddy + bend * dy, cosine, sine, ratio * turn,
                            ratio**2 * turn2 + bend * turn)
                error = max(error, *(abs(a - b) / (1.0 + abs(b))
                                     for a, b in zip(by_chain, exact)))
            errors.append(error)
        assert min(errors) <= 1e-9, (mechanism, value)
