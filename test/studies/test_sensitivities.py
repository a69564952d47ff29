# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Exact derivatives of outputs, extrema and measures beside many digits and beside differences."""
from dataclasses import replace
from math import isnan
from types import SimpleNamespace

from flint import ctx
from fourbar_lab.studies.derivatives import Derivatives, sensitivities
from fourbar_lab.studies.duals import derivatives_of, Dual, DUALS, value_of
from fourbar_lab.studies.measures import Design
from fourbar_lab.studies.study import from_document
from fourbar_ros import load_scene
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.tables import ARRAYS, run
from fourbar_ros.numerics.trace import Trace
from fourbar_ros.scene.scene import from_values
import mpmath as mp
import numpy as np
import pytest
from support.cartesian import BITS, exact, pose_of, reference_of, values_of
from support.samples import some

pytest.importorskip('scipy')
LENGTHS = [f'linkage.a{i}' for i in (1, 2, 3, 4)]
BODY = ('mass', 'cg_along', 'cg_across', 'inertia')
LINKS = ('crank', 'coupler', 'output')
STEP = mp.mpf(10)**-40
RATE = 25.0


def scene_of(rng=None, **more):
    """Return the paper's linkage with bodies of their own, changed at random."""
    values = from_document({'scene': 'paper', 'rows': 1, 'vary': {
        'linkage.a1': {'range': [0.3, 0.4]}}, 'quantities': ['swing']}).values
    values = dict(values) | {'bodies.rods.density': float('nan'),
                             'bodies.rods.radius': float('nan'), 'gravity.y': -9.8} | more
    for i, link in enumerate(LINKS):
        given = (1.0 + 0.5 * i, 0.2 + 0.1 * i, 0.03 * (i - 1), 0.02 * (i + 1))
        values |= {f'bodies.{link}.{field}': value for field, value in zip(BODY, given)}
    if rng is not None:
        for name in values:
            if name in LENGTHS or name.startswith('bodies.') and not isnan(values[name]):
                values[name] *= rng.uniform(0.97, 1.03)
    return from_values(values)


def of_reference(scene, x, moved=None):
    """Return all fields in many digits, with one parameter moved."""
    values = {key: mp.mpf(scene.values[key]) for key in Derivatives(scene).names}
    if moved:
        values[moved[0]] += moved[1]
    bodies = {link: SimpleNamespace(**{field: values[f'bodies.{link}.{field}'] for field in BODY})
              for link in LINKS}
    linkage = reference_of(scene.linkage)._replace(
        lengths=[values[key] for key in LENGTHS], bodies=SimpleNamespace(**bodies),
        gravity=(values['gravity.x'], values['gravity.y']))
    with ctx.workprec(BITS):
        return values_of(exact(linkage, (x, RATE, 0.0), pose_of(scene.linkage, x)))


def difference(function, step=STEP):
    """Return the derivative of a function of a step at zero."""
    return (function(step) - function(-step)) / (2 * step)


def close(found, true, size, bound=1e-12):
    assert abs(found - float(true)) <= bound * float(size), (found, float(true), float(size))


@pytest.mark.slow
def test_every_output_has_the_derivatives_of_many_digits():
    rng = np.random.default_rng(5)
    names = ('theta4', 'omega4', 'alpha4', 'alpha_beta', 'omega3', 'f41', 'f21', 'f32', 'f43',
             'driving_torque', 'shaking_force', 'shaking_moment')
    for _ in range(2):
        scene = scene_of(rng)
        found, x = Derivatives(scene), rng.uniform(0.0, 2.0 * np.pi, 2)
        motion, loads = found.state(x)
        fields = motion._asdict() | loads._asdict()
        ends = {one: [[of_reference(scene, place, (one, step)) for place in x.tolist()]
                      for step in (-STEP, STEP)] for one in found.names
                if one.startswith(('linkage', 'bodies', 'gravity'))}
        for name in names:
            for i in range(len(x)):
                true = {one: (after[i][name] - before[i][name]) / (2 * STEP)
                        for one, (before, after) in ends.items()}
                # each beside the largest, in the unit of the output: what rounding can reach
                size = max(abs(value * (scene.values[one] or 1.0))
                           for one, value in true.items())
                by = derivatives_of(fields[name])
                for one, value in true.items():
                    scale = abs(scene.values[one]) or 1.0
                    close(np.broadcast_to(by.get(one, 0.0), x.shape)[i] * scale, value * scale,
                          size)


@some('name', ['omega4', 'alpha4', 'shaking_force', 'driving_torque', 'f32'], ('shaking_force',))
def test_every_extremum_moves_as_in_many_digits(name):
    scene = scene_of()
    design, found = Design(scene), Derivatives(scene)
    study = from_document({'scene': 'paper', 'rows': 1, 'quantities': [name], 'vary': {
        'linkage.a1': {'range': [0.3, 0.4]}}})
    design.search(study.measures)
    small = mp.mpf(10)**-20

    def place(near, moved):
        def slope(x):
            return difference(lambda step: of_reference(scene, x + step, moved)[name])
        return mp.findroot(slope, (near, near + mp.mpf(10)**-9), tol=mp.mpf(10)**-60)

    for end in ('max', 'min'):
        extremum = design.extreme(name, end)
        of_value, of_place = found.at_extremum(name, extremum.theta1)
        true = {}
        for one in (LENGTHS[0], LENGTHS[2], 'bodies.output.mass', 'bodies.coupler.cg_across'):
            before, after = ((one, sign * small) for sign in (-1, 1))
            ends = [(x, of_reference(scene, x, moved)[name]) for moved in (before, after)
                    for x in [place(mp.mpf(extremum.theta1), moved)]]
            true[one] = [(b - a) / (2 * small) for a, b in zip(*ends)]
        for row, slopes in ((0, of_place), (1, of_value)):
            by = dict(zip(found.names, slopes))
            size = max(abs(value[row] * scene.values[one]) for one, value in true.items())
            for one, value in true.items():
                # a place is known to eps times its condition, some hundreds here
                close(by[one] * scene.values[one], value[row] * scene.values[one], size,
                      1e-12 if row else 1e-11)


MEASURES = {
    'paper': (['shaking_force', 'omega4.span', 'shaking_moment.peak', 'driving_torque.rms',
               'swing', 'time_ratio', 'least_transmission_angle', 'change_point_margin',
               'input_range'],
              ['linkage.a1', 'linkage.a3', 'bodies.rods.radius', 'drive.speed']),
    'slider_crank': (['shaking_force', 'slide_acceleration', 'f32.peak', 'driving_torque.rms',
                      'stroke', 'time_ratio', 'middle.acceleration'],
                     ['linkage.a1', 'linkage.a2', 'linkage.offset', 'bodies.coupler.mass',
                      'points.middle.across']),
    'scotch_yoke': (['shaking_force.max', 'driving_torque.rms', 'stroke', 'time_ratio'],
                    ['linkage.a1']),
    'cylinder': (['omega1', 'f32.peak', 'driving_force.rms', 'swing', 'input_range'],
                 ['linkage.a1', 'linkage.a4']),
    'jansen': (['omega_foot', 'driving_torque.peak', 'least_transmission_angle'],
               ['linkage.points.hip.along', 'linkage.points.pivot.y', 'bodies.foot.cg_across']),
    'watt': (['alpha_output', 'swing', 'shaking_moment.peak'],
             ['dyads.one.length_1', 'dyads.two.first.across', 'bodies.rods.radius']),
    'bucket': (['omega_bucket', 'driving_force.peak'],
               ['cylinder.base.along', 'dyads.bucket.length_2', 'external.bucket.force_x']),
    'quick_return': (['slide_ram_velocity', 'shaking_force.max'],
                     ['dyads.lever.second.across', 'dyads.ram.direction_2']),
}


@pytest.mark.parametrize('name', MEASURES)
def test_measures_of_every_kind_change_as_their_differences_say(name):
    quantities, names = MEASURES[name]
    study = from_document({'scene': name, 'rows': 1, 'quantities': quantities,
                           'vary': {names[0]: {'uniform': 1e-6}}})
    scene = from_values(study.values)
    names = [one for one in names if one in Derivatives(scene).names]
    measures = [measure for measure in study.measures if measure.part != 'extrema']
    found = sensitivities(Derivatives(scene, names), measures)
    for one in names:
        step = 1e-6 * (abs(study.values[one]) or 0.1)
        ends = []
        for moved in (-step, step):
            design = Design(from_values(study.values | {one: study.values[one] + moved}))
            design.search([*measures, *(replace(m, part='peak') for m in measures
                                        if m.quantity)])
            ends.append([design.of(measure) for measure in measures])
        for measure, before, after, mine in zip(measures, *ends, found):
            true = (after - before) / (2.0 * step)
            size = abs(true) + abs(mine.value) / (abs(study.values[one]) or 0.1)
            assert abs(mine.by[one] - true) <= 2e-6 * size, (measure.name, one, mine.by[one], true)
    assert not any(isnan(value) for one in found for value in one.by.values())


def test_where_another_dyad_is_nearest_to_its_toggle_an_angle_has_a_kink():
    name = 'dyads.right.length_1'
    # both cylinders of the V are alike at theta1 = 0
    moves = Derivatives(load_scene('v_engine'), [name]).at_extremum('transmission_angle', 0.0)
    assert np.isnan(moves).all()


def slopes_of(scene, quantities, names, **changed):
    """Return {measure: (its Sensitivity, {name: slopes to the left and right by differences})}."""
    study = from_document({'scene': scene, 'rows': 1, 'quantities': quantities,
                           'vary': {names[0]: {'uniform': 1e-6}}})
    values = study.values | changed

    def value(**moved):
        design = Design(from_values(values | moved))
        design.search(study.measures)
        return np.array([design.of(measure) for measure in study.measures])

    found = sensitivities(Derivatives(from_values(values), names), study.measures)
    sides = {}
    for name in names:
        step = 1e-6 * (abs(values[name]) or 0.1)
        sides[name] = [(value(**{name: values[name] + sign * step}) - value()) / (sign * step)
                       for sign in (-1.0, 1.0)]
    return {one.measure.name: (one, {name: (left[i], right[i])
                                     for name, (left, right) in sides.items()})
            for i, one in enumerate(found)}


@pytest.mark.parametrize('scene, measure, names', [
    ('v_engine', 'shaking_force.max', ['bodies.left_piston.mass', 'bodies.right_piston.mass']),
    ('v_engine', 'driving_torque.peak', ['bodies.left_piston.mass', 'bodies.right_piston.mass']),
    ('radial_engine', 'least_transmission_angle', ['dyads.c1.length_1', 'dyads.c4.length_1']),
    ('v8', 'least_transmission_angle', ['dyads.L1.length_1', 'dyads.R2.length_1']),
])
def test_where_two_places_tie_for_an_extremum_there_is_no_derivative(scene, measure, names):
    (found, sides), = slopes_of(scene, [measure], names).values()
    for name in names:
        left, right = sides[name]
        assert abs(right - left) > 1e-2 * max(abs(left), abs(right))      # a kink it is
        assert isnan(found.by[name]) and 'it has a kink' in found.why_unknown


@pytest.mark.parametrize('scene, measure, name', [
    ('v_engine', 'driving_torque.peak', 'drive.speed'),
    ('v8', 'driving_torque.peak', 'bodies.rods.radius')])
def test_what_changes_all_places_that_tie_alike_has_a_derivative(scene, measure, name):
    (found, sides), = slopes_of(scene, [measure], [name]).values()
    left, right = sides[name]
    assert max(abs(found.by[name] - left), abs(found.by[name] - right)) <= 1e-4 * abs(left)
    assert not found.why_unknown


@pytest.mark.parametrize('scene, measure, name, why', [
    ('scotch_yoke', 'shaking_force.max_at', 'linkage.a1', '2 extrema tie'),
    ('toggle_press', 'time_ratio', 'dyads.knee.length_2', 'it has no value')])
def test_which_of_two_equal_extrema_counts_is_a_choice_of_rounding(scene, measure, name, why):
    (found, _), = slopes_of(scene, [measure], [name]).values()
    assert isnan(found.by[name]) and why in found.why_unknown


def test_kinks_of_the_other_measures_have_no_derivative():
    # of a centred slider-crank both strokes take as long, and an offset to either side slows one
    centred = {'linkage.offset': 0.0}
    found = slopes_of('slider_crank', ['time_ratio', 'change_point_margin'],
                      ['linkage.offset', 'linkage.a1'], **centred)
    for measure, signs in (('time_ratio', (-1.0, 1.0)), ('change_point_margin', (1.0, -1.0))):
        one, sides = found[measure]
        left, right = sides['linkage.offset']
        assert left * signs[0] > 0.0 and right * signs[1] > 0.0
        assert isnan(one.by['linkage.offset']) and 'it has a kink' in one.why_unknown
    assert abs(found['change_point_margin'][0].by['linkage.a1']) > 0.1
    # the moment of a radial engine is 0 at every input, and a couple either way makes it larger
    (one, sides), = slopes_of('radial_engine', ['shaking_moment.peak'],
                              ['external.rod_4.couple']).values()
    assert sides['external.rod_4.couple'] == (-1.0, 1.0)
    assert isnan(one.by['external.rod_4.couple']) and 'it is constant' in one.why_unknown


def test_at_a_change_point_nothing_has_a_derivative_by_a_length():
    names = ['dyads.loop.second.across', 'bodies.rods.density']
    (one, sides), = slopes_of('parallelogram', ['shaking_force.min'], names).values()
    assert abs(sides[names[0]][0]) > 1e6       # it jumps
    assert isnan(one.by[names[0]]) and 'leaves the change point' in one.why_unknown
    assert abs(one.by[names[1]] / sides[names[1]][1] - 1.0) < 1e-4


@pytest.mark.parametrize('lengths', [(0.1, 0.5, 0.2, 0.4), (0.2, 0.5, 0.5, 0.2),
                                     (0.2, 0.5, 0.2, 0.5)])
def test_no_length_of_a_change_point_has_a_derivative_and_every_mass_has_one(lengths):
    values = dict(zip(LENGTHS, lengths)) | {'drive.speed': 3.0, 'gravity.y': -9.8}
    values |= {f'bodies.{link}.{field}': 0.1 + 0.01 * i for i, (link, field) in enumerate(
        (link, field) for link in LINKS for field in BODY)}
    names = ['shaking_force', 'driving_torque.rms', 'omega4', 'omega4.max_at', 'alpha4.peak',
             'shaking_moment.span', 'theta4', 'transmission_angle.min', 'time_ratio']
    scene = from_values(values)
    study = from_document({'scene': 'paper', 'rows': 1, 'quantities': names,
                           'vary': {LENGTHS[0]: {'uniform': 1e-6}}})
    derivatives = Derivatives(scene)
    for one in sensitivities(derivatives, study.measures):
        assert all(isnan(one.by[name]) for name in LENGTHS) and one.why_unknown
    x = np.linspace(0.1, scene.linkage.period, 7)
    for name in ('omega4', 'shaking_force', 'transmission_angle'):
        _, by = derivatives.of(name, x)
        are_lengths = [name in LENGTHS for name in derivatives.names]
        assert np.isnan(by[are_lengths]).all() and np.isfinite(by[~np.array(are_lengths)]).all()
        motion, loads = derivatives.state(x)
        slopes = derivatives_of(getattr(motion, name, None) or getattr(loads, name))
        assert all(np.isnan(slopes[length]).all() for length in LENGTHS)
        for slopes in derivatives.at_extremum(name, 1.0):
            assert np.isnan(slopes[are_lengths]).all()
    # of the mass of the output, beside a difference
    mass, step = 'bodies.output.mass', 1e-6
    measure, = [one for one in study.measures if one.name == 'driving_torque.rms']
    ends = [Design(from_values({**values, mass: values[mass] + sign * step})).of(measure)
            for sign in (1.0, -1.0)]
    found = sensitivities(derivatives, [measure])[0].by[mass]
    assert found == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-5)


@pytest.mark.parametrize('scene, measure, name', [
    ('toggle_press', 'transmission_angle.rms', 'dyads.knee.second.across'),
    ('toggle_press', 'transmission_angle.rms', 'dyads.ram.second.along'),
    ('jansen', 'theta_foot.rms', 'linkage.points.hip.along')])
def test_a_mean_over_jumps_has_no_derivative(scene, measure, name):
    study = from_document({'scene': scene, 'rows': 1, 'quantities': [measure],
                           'vary': {name: {'uniform': 1e-4}}})
    found, = sensitivities(Derivatives(load_scene(scene), [name]), study.measures)
    assert isnan(found.by[name])
    assert found.why_unknown in ('it jumps where another dyad is nearest to its toggle',
                                 'the angle wraps')


def test_a_force_that_is_0_at_an_input_has_a_mean_with_a_derivative():
    """The shaking force of a scotch yoke is proportional to its crank, and 0 where it turns."""
    found, = sensitivities(
        Derivatives(load_scene('scotch_yoke'), ['linkage.a1']), from_document(
            {'scene': 'scotch_yoke', 'rows': 1, 'quantities': ['shaking_force.rms'],
             'vary': {'linkage.a1': {'uniform': 1e-4}}}).measures)
    assert not isnan(found.by['linkage.a1'])


def test_a_toggle_has_no_derivative_and_a_turn_none_but_zero():
    study = from_document({'scene': 'paper', 'rows': 1, 'quantities': ['omega4.max', 'swing'],
                           'vary': {'linkage.a1': {'uniform': [0.95, 1e-3]}}})
    scene = from_values(study.values | {'linkage.a1': 0.95, 'linkage.a4': 0.9})
    found = sensitivities(Derivatives(scene, ['linkage.a1']), study.measures)
    assert isnan(found[0].by['linkage.a1'])
    turning = from_values(study.values | {'linkage.a1': 1.3, 'linkage.a4': 0.3})
    swing, = sensitivities(Derivatives(turning, ['linkage.a1']), study.measures[1:])
    assert swing.by == {'linkage.a1': 0.0}


@pytest.mark.parametrize('stroke', [[-0.5, 0.5], [6.0, 6.5], [-7.0, -6.0]])
def test_an_end_of_the_stroke_is_one_in_every_turn(stroke):
    """A difference over 1e-5 of a length has an error of about its square."""
    study = from_document({'scene': 'paper', 'rows': 1, 'quantities': ['swing'],
                           'vary': {'linkage.a2': {'uniform': 1e-6}}})
    scene = from_values(study.values | {'linkage.range': stroke})
    swing, = sensitivities(Derivatives(scene, ['linkage.a2']), study.measures)
    swept, a2 = Design(scene).output_range, scene.values['linkage.a2']
    # of the output between both inputs, as at an extremum inside it is level
    inputs = swept.least_at[0], swept.most_at[0]
    before, after = (np.ptp([from_values(scene.values | {'linkage.a2': length}).linkage.motion(
        x).theta4 for x in inputs]) for length in (a2 * (1.0 - 1e-5), a2 * (1.0 + 1e-5)))
    assert swing.by['linkage.a2'] == pytest.approx((after - before) / (2e-5 * a2), rel=1e-8)


def test_what_has_no_derivative_is_refused():
    for name in ('linkage.mode', 'linkage.a5', 'bodies.crank.mass', 'linkage.offset'):
        scene = from_values(from_document({'scene': 'paper', 'rows': 1, 'quantities': ['swing'],
                                           'vary': {'linkage.a1': {'uniform': 1e-3}}}).values)
        with pytest.raises(InvalidParameter, match='a number that the scene gives'):
            Derivatives(scene, [name])


def test_duals_obey_the_chain_rule_whatever_stands_left_and_right():
    def make(n, _):
        def formula(u, v):
            w = n.sqrt(u * u + v) / (1.0 + v**3) - 2.0 / u
            w = n.where(u > v, w * n.hypot(u, v), n.atan2(w, u) + n.fabs(-v))
            return 3.0 - (0.7 * w - n.sin(u) * n.cos(v)) / 2.0 * u + n.exact_sum((u, -v, 1.0))
        return formula

    def found(table, *inputs):
        values = [*inputs, *[step.value for step in trace.steps[2:]]]
        steps = [i for i in trace.needed([trace.results]) if not trace.steps[i].is_given]
        return run(trace, steps, table, values)[trace.results]

    trace, u, v = Trace(make, 2), np.array([0.7, 1.3]), np.array([0.4, 2.1])
    dual = found(DUALS, Dual(u, {'u': 1.0}), Dual(v, {'v': 1.0}))
    np.testing.assert_array_equal(value_of(dual), found(ARRAYS, u, v))
    step = 1j * 2.0**-200
    for name, moved in {'u': (u + step, v), 'v': (u, v + step)}.items():
        np.testing.assert_allclose(derivatives_of(dual)[name],
                                   found(ARRAYS, *moved).imag / step.imag, 1e-14)
