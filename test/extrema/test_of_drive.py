# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a designer asks of the drive: advantage, holding torque, power, work, time ratio."""
from dataclasses import replace
from math import asin, inf, isnan, nan, pi, tau

from fourbar_lab.drawing.curves import curves_of
from fourbar_lab.drawing.record import drive_of, properties_of
from fourbar_lab.drawing.tables import drive_in_words
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.measures import Design
from fourbar_lab.studies.study import from_document
from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    DriveFriction,
    External,
    find_extrema,
    FourBar,
    InvalidParameter,
    InvertedSlider,
    JointFriction,
    load_scene,
    MissingBodies,
    SliderCrank,
)
from fourbar_ros.cli.main import main
from fourbar_ros.extrema import OverInput
from fourbar_ros.extrema.over_input import efficiency
from fourbar_ros.machine import Dyad, Machine
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.elements import Attachment, Spring
from fourbar_ros.mechanisms.quantities import by_name, of_drive
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from support import contract, ROOT
from support.contract import every_mechanism
from support.samples import more

A1, A2 = 0.05, 0.2
ADVANTAGE = 'mechanical_advantage'


def advantage(theta):
    """Return dtheta/ds of a centric slider-crank with s = r cos + sqrt(l^2 - r^2 sin^2)."""
    root = np.sqrt(A2**2 - (A1 * np.sin(theta))**2)
    return -1.0 / (A1 * np.sin(theta) * (1.0 + A1 * np.cos(theta) / root))


def measured(scene, *names):
    """Return measures of a scene, as a study computes them."""
    design = Design(scene)
    measures = [design.measures.single('quantities', name) for name in names]
    design.search(measures)
    return [design.of(measure) for measure in measures]


def test_the_advantage_of_a_slider_crank_is_that_of_its_closed_form():
    linkage = SliderCrank(A1, A2, mode=2)
    extrema = find_extrema(linkage, ADVANTAGE, 3.0)
    poles = [extremum for extremum in extrema if extremum.place == 'limit']
    assert [(pole.side, pole.value) for pole in poles] == [
        (-1, inf), (1, -inf), (-1, -inf), (1, inf)]
    assert [pole.theta1 for pole in poles] == pytest.approx([0.0, 0.0, pi, pi], abs=4 * EPS)
    assert all(pole.is_global for pole in poles)
    first, last = [extremum for extremum in extrema if extremum.place == 'interior']
    assert first.theta1 == pytest.approx(tau - last.theta1, rel=1e-9)
    assert (first.kind, last.kind) == ('maximum', 'minimum')
    assert first.value == pytest.approx(-last.value, rel=1e-12)
    fine = np.linspace(0.01, pi - 0.01, 200001)
    assert first.value == pytest.approx(advantage(fine).max(), rel=1e-9)
    assert advantage(first.theta1) == pytest.approx(first.value, rel=1e-12)
    assert first.unit == 'N/(N m)' and not first.is_global
    asked = of_drive(linkage)[ADVANTAGE]
    assert asked.values(linkage, fine, 7.0) == pytest.approx(advantage(fine), rel=1e-10)


@every_mechanism
def test_the_advantage_is_one_over_the_ratio_of_the_rates(case, count=more(4, 20)):
    for mechanism, (position, rate, _) in contract.ordinary(case, 901, count):
        output, ratio = mechanism.outputs[0]
        asked = of_drive(mechanism, mechanism.input)[ADVANTAGE]
        motion = mechanism.motion(position, rate)
        value = float(asked.values(mechanism, position, rate))
        with np.errstate(divide='ignore'):      # an output may stand still
            inverse = np.divide((1.0, rate), [getattr(motion, name)
                                              for name in (ratio, output.rate)])
        assert inverse == pytest.approx(value, rel=64 * EPS)


@pytest.mark.parametrize(('kind', 'load', 'effort'), [
    (FourBar(0.4, 1.2, 0.8, 1.0), Applied(couple=-5.0), 5.0),
    (SliderCrank(A1, A2, mode=2), Applied(-5.0, 0.0), 5.0),
    (SliderCrank(A1, A2, mode=2, input='slide'), Applied(couple=-5.0), 5.0)])
def test_the_drive_holds_a_load_at_the_output_with_one_over_the_advantage(kind, load, effort):
    """Links without masses, at rest: a couple or a force on the output, the drive against it."""
    loaded = 'crank' if kind.is_driven_by_slide else 'output'
    linkage = replace(kind, bodies=Bodies(*[Body(0.0)] * 3), external=External(**{loaded: load}))
    own = of_drive(linkage, linkage.input)
    hold = next(quantity for name, quantity in own.items() if name.startswith('holding'))
    low, high = linkage.input_ranges[0]
    x = np.linspace(low, high, 23)[1:-1] + 1e-3 * (high - low)
    assert hold.values(linkage, x, 3.0) == pytest.approx(
        effort / own[ADVANTAGE].values(linkage, x, 3.0), rel=1e-11)


@pytest.mark.parametrize('certify', [False, True])
def test_extrema_of_the_advantage_are_those_of_a_scan(certify):
    if certify:
        pytest.importorskip('flint')
    for name in ('paper', 'slides_7_6', 'toggle_press', 'jansen', 'cylinder', 'chebyshev'):
        linkage = load_scene(name).linkage
        extrema = find_extrema(linkage, ADVANTAGE, certify=certify)
        asked = of_drive(linkage, linkage.input)[ADVANTAGE]
        for low, high in linkage.input_ranges:
            x = np.linspace(low, high, 20001)[1:-1]
            values = asked.values(linkage, x, 1.0)
            slopes = np.diff(values)
            # a jump through infinity turns no slope
            turns = np.flatnonzero((slopes[1:] * slopes[:-1] < 0.0)
                                   & (values[1:-1] * values[2:] > 0.0)
                                   & (values[1:-1] * values[:-2] > 0.0)) + 1
            for i in turns:
                near = [extremum for extremum in extrema
                        if abs(linkage.distance(extremum.input, x[i])) < 2.0 * (x[1] - x[0])]
                assert any(extremum.value == pytest.approx(values[i], rel=1e-4)
                           for extremum in near), (name, x[i])
        if certify and name == 'paper':
            assert all('interval' in extremum.proof for extremum in extrema)


def test_an_advantage_without_dead_points_has_both_ends():
    parallelogram = load_scene('parallelogram').linkage
    constant, = find_extrema(parallelogram, ADVANTAGE)
    assert (constant.kind, constant.value) == ('constant', pytest.approx(1.0, rel=8 * EPS))
    drag_link = FourBar(0.4, 0.5, 0.45, 0.2)
    extrema = find_extrema(drag_link, ADVANTAGE)
    rates = find_extrema(drag_link, 'omega4', 1.0)
    assert [1.0 / rate.value for rate in rates] == [one.value for one in extrema]
    assert [rate.is_global for rate in rates] == [one.is_global for one in extrema]
    assert {(rate.kind, one.kind) for rate, one in zip(rates, extrema)} == {
        ('maximum', 'minimum'), ('minimum', 'maximum')}


def test_holding_torque_is_that_of_the_potential_energy(step=1e-5):
    rods = Bodies(Body(2.0, cg_along=0.2, inertia=0.03), Body(3.0, cg_along=0.6, inertia=0.4),
                  Body(2.5, cg_along=0.4, inertia=0.2))
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods, gravity=(0.0, -9.81))

    def energy(theta):
        motion = linkage.motion(theta)
        heights = 0.0
        for link, body in rods._asdict().items():
            at = linkage.link_motion(motion, link)
            heights = heights + body.mass * (at.y + at.sine * body.cg_along)
        return 9.81 * heights

    x = np.linspace(0.1, 6.1, 40)
    slope = (energy(x + step) - energy(x - step)) / (2.0 * step)
    assert of_drive(linkage)['holding_torque'].values(linkage, x, 50.0) == pytest.approx(
        slope, abs=1e-8 * np.abs(slope).max())
    # the same at every speed, with the extrema of the drive at rest
    extrema = find_extrema(linkage, 'holding_torque', 50.0)
    assert [one[3:] for one in extrema] == [
        one[3:] for one in find_extrema(linkage, 'driving_torque', 0.0)]
    assert find_extrema(linkage, 'driving_torque', 50.0)[0].value != extrema[0].value
    assert OverInput(linkage, 'holding_torque', 9.0).rms == OverInput(
        linkage, 'driving_torque', 0.0).rms


def test_power_is_the_rate_of_the_energy_of_the_links(step=1e-6):
    """Power of the drive = d(kinetic + potential)/dt along theta = w t + a t^2/2."""
    linkage = load_scene('slider_crank').linkage
    bodies = linkage.bodies._asdict()

    def energy(theta, rate):
        motion = linkage.motion(theta, rate)
        total = 0.0
        for link, body in bodies.items():
            at = linkage.link_motion(motion, link)
            x, y, v_x, v_y = centre_of(at, body)
            total += 0.5 * body.mass * (v_x**2 + v_y**2) + 0.5 * body.inertia * at.omega**2
            total -= body.mass * (linkage.gravity[0] * x + linkage.gravity[1] * y)
        return total

    rate, acceleration = 7.0, -30.0
    for theta in (0.4, 1.9, 3.3, 5.0):
        ahead, behind = (energy(theta + rate * t + 0.5 * acceleration * t * t,
                                rate + acceleration * t) for t in (step, -step))
        _, loads = linkage.step(theta, rate, acceleration)
        assert loads.driving_power == pytest.approx((ahead - behind) / (2.0 * step), rel=1e-6)


def centre_of(at, body):
    """Return place and velocity of the centre of gravity of a link."""
    x, y = (at.cosine * body.cg_along - at.sine * body.cg_across,
            at.sine * body.cg_along + at.cosine * body.cg_across)
    return at.x + x, at.y + y, at.v_x - at.omega * y, at.v_y + at.omega * x


def test_work_of_a_cycle_is_that_of_a_couple_on_the_crank_and_of_nothing_else():
    scene = load_scene('paper')
    linkage = scene.linkage.with_external(External(crank=Applied(couple=-3.0, force_y=20.0)))
    load = OverInput(linkage, 'driving_torque', 25.0)
    assert load.of_cycle == pytest.approx(3.0 * tau, rel=1e-12)
    assert OverInput(linkage, 'driving_power', 25.0).mean == pytest.approx(75.0, rel=1e-12)
    assert OverInput(scene.linkage, 'driving_torque', 25.0).of_cycle == 0.0
    assert isnan(OverInput(load_scene('cylinder').linkage, 'driving_force').of_cycle)
    assert isnan(OverInput(linkage, 'driving_torque', within=(0.0, 1.0)).of_cycle)


def test_work_of_a_cycle_of_an_engine_is_that_of_its_gas_over_two_turns():
    """Minus the integral of the force over the stroke: between points of its table, by Gauss."""
    engine = load_scene('engine')
    linkage = engine.linkage
    degrees, bar = np.loadtxt(ROOT / 'config/engine.csv', delimiter=',', skiprows=2).T
    x = np.radians(degrees)
    pressure = PchipInterpolator(np.concatenate([x[:-1] - 2.0 * tau, x, x[1:] + 2.0 * tau]),
                                 np.concatenate([bar[:-1], bar, bar[1:]]))
    roots, weights = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(x)[:, None]
    theta = x[:-1, None] + half * (1.0 + roots)
    r, length = linkage.a1, linkage.a2
    root = np.sqrt(length**2 - (r * np.sin(theta))**2)
    slope = -r * np.sin(theta) * (1.0 + r * np.cos(theta) / root)      # of the stroke, by theta
    gas = (half * weights * engine.values['forces.gas.factor'] * 1e5 * pressure(theta)
           * slope).sum()
    load = OverInput(linkage, 'driving_torque', 100.0)
    assert load.of_cycle == pytest.approx(-gas, rel=1e-10) and gas > 100.0
    work, power = measured(engine, 'work', 'driving_power.mean')
    assert work == pytest.approx(load.of_cycle, rel=1e-12)
    speed = engine.drive.speed
    assert power == pytest.approx(work * speed / (2.0 * tau), rel=1e-10)
    assert drive_of(linkage, speed)['cycle'] == {
        'work': pytest.approx(work, rel=1e-12), 'without_friction': pytest.approx(work, rel=1e-12),
        'friction': 0.0, 'mean_power': pytest.approx(power, rel=1e-12), 'efficiency': 1.0}


def test_a_spring_is_held_where_its_energy_has_that_slope(step=1e-5):
    spring = Spring(Attachment('ground', 0.2, 0.7), Attachment('output', 0.5), 900.0,
                    free_length=0.3)
    rods = Bodies(*[Body(0.0)] * 3)
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods).with_elements(spring)

    def energy(theta):
        at = linkage.link_motion(linkage.motion(theta), 'output')
        length = np.hypot(at.x + 0.5 * at.cosine - 0.2, at.y + 0.5 * at.sine - 0.7)
        return 450.0 * (length - 0.3)**2

    x = np.linspace(0.1, 6.1, 40)
    slope = (energy(x + step) - energy(x - step)) / (2.0 * step)
    assert of_drive(linkage)['holding_torque'].values(linkage, x, 50.0) == pytest.approx(
        slope, abs=1e-8 * np.abs(slope).max())
    assert OverInput(linkage, 'driving_torque', 25.0).of_cycle == 0.0


@pytest.mark.parametrize(('couple', 'torque', 'viscous', 'expected'), [
    (-6.0, 0.0, 0.0, 1.0), (-6.0, 2.0, 0.0, 6.0 / 8.0), (-6.0, 1.0, 0.05, 6.0 / 8.0),
    (6.0, 2.0, 0.0, 4.0 / 6.0), (6.0, 7.0, 0.0, nan), (0.0, 2.0, 0.0, 0.0), (0.0, 0.0, 0.0, nan)])
def test_efficiency_with_friction_of_the_drive(couple, torque, viscous, expected):
    """A couple on the crank, and friction against it at 20 rad/s: quotients of torques."""
    linkage = load_scene('paper').linkage.with_external(
        External(crank=Applied(couple=couple))).with_friction(
            {'drive': DriveFriction(torque, viscous)})
    assert efficiency(linkage, 20.0) == pytest.approx(expected, rel=1e-10, nan_ok=True)
    ratio = drive_of(linkage, 20.0)['cycle']['efficiency']
    assert ratio == pytest.approx(expected, rel=1e-10, nan_ok=True)
    words = dict(drive_in_words(linkage, drive_of(linkage, 20.0), 20.0))['cycle']
    assert ('efficiency' in words) is not (isnan(expected) or not couple)
    assert ('no force takes work out over a cycle' in words) is (couple == 0.0)


def test_efficiency_of_pins_is_that_of_what_they_dissipate(count=20000):
    """Work with friction less that without: couples of the pins times their relative rates."""
    scene = load_scene('paper')
    linkage = scene.linkage.with_external(External(output=Applied(couple=-40.0),
                                                   crank=Applied(couple=-30.0)))
    rubbing = linkage.with_friction({joint: JointFriction(0.1, radius=0.01) for joint in
                                     ('O1', 'A', 'B', 'O4')})
    rate = 8.0
    x = (np.arange(count) + 0.5) * tau / count
    motion, loads = rubbing.step(x, rate)
    lost = 0.001 * sum(force * np.abs(speed) for force, speed in (
        (loads.f41, motion.omega1), (loads.f21, motion.omega2), (loads.f32, motion.omega3),
        (loads.f43, motion.omega4)))
    without = 30.0 * tau
    assert efficiency(linkage, rate) == 1.0
    # midpoints between kinks where rates turn: an error of the square of a step
    assert efficiency(rubbing, rate) == pytest.approx(
        without / (without + lost.mean() * tau / rate), rel=1e-6)


def test_a_crank_that_turns_back_does_the_work_of_the_mirrored_one(tmp_path):
    """Not its negative: one of the press, of one with an offset, of a row of a study."""
    press = load_scene('press').values
    for offset in (0.0, 0.008):
        there, mirrored = (from_values({
            **press, 'linkage.offset': sign * offset, 'drive.speed': sign * 12.0,
            'springs.back.first.across': sign * offset}) for sign in (-1.0, 1.0))
        backward, forward = (drive_of(each.linkage, each.drive.speed)['cycle']
                             for each in (there, mirrored))
        assert forward['work'] > 0.0 and 0.5 < forward['efficiency'] < 1.0
        assert backward == pytest.approx(forward, rel=1e-9)
        design = Design(there)
        measure = design.measures.single('quantities', 'work')
        design.search([measure])
        assert design.of(measure) == backward['work']
    (tmp_path / 'press.yaml').write_text(there.as_text)
    study = from_document({
        'scene': 'press.yaml', 'method': 'grid', 'keep': 'all', 'quantities': ['work'],
        'vary': {'drive.speed': {'list': [-12.0, 12.0]}}}, tmp_path)
    back, forth = compute(study, 0).columns['work'].tolist()
    assert back == pytest.approx(backward['work'], rel=1e-9) and forth > 0.0


@pytest.mark.parametrize(('a1', 'a4'), [(0.1, 0.15), (0.102, 0.3)])
def test_time_ratio_of_a_quick_return_is_the_same_in_show_and_study(a1, a4):
    """Shaper of 150/100: the bar turns back where it touches the circle of the pin."""
    linkage = InvertedSlider(a1, a4)
    half = asin(a1 / a4)
    expected = (pi + 2.0 * half) / (pi - 2.0 * half)
    output, = properties_of(linkage)['outputs']
    assert output['time_ratio'] == pytest.approx(expected, rel=1e-13)
    if a4 == 0.15:
        assert output['time_ratio'] == pytest.approx(2.735239, abs=5e-7)
    scene = from_values({'linkage.kind': 'inverted_slider', 'linkage.a1': a1, 'linkage.a4': a4,
                         'outputs': ['state']})
    study, = measured(scene, 'time_ratio')
    assert study == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize('scene', ['toggle_press', 'watt'])
def test_an_output_that_is_as_far_at_two_inputs_has_no_time_ratio(scene, capsys):
    """Which of the two would count was rounding: 2.72 or 1.16 of the toggle press."""
    output = properties_of(load_scene(scene).linkage)['outputs'][0]
    assert isnan(output['time_ratio']) and isnan(*measured(load_scene(scene), 'time_ratio'))
    assert sorted(map(len, output['least_at'] + output['most_at'])) == [1, 2]
    assert main(['show', scene]) == 0
    assert ', in this mode, no time ratio: ' in capsys.readouterr().out


@pytest.mark.parametrize('seed', range(8))
def test_dead_points_of_a_machine_are_those_of_the_kind_that_it_is(seed):
    """By the closed forms of the kinds: each input within eight digits, as a root of a slope."""
    rng = np.random.default_rng(seed)
    a1, a2, a3, a4 = rng.uniform([0.1, 0.7, 0.6, 0.8], [0.3, 0.9, 0.8, 1.0])
    crank, fixed = Point('crank', a1), Point('ground', 0.0, 0.1)
    for kind, dyad in (
            (FourBar(a1, a2, a3, a4), Dyad('d', 'RRR', crank, Point('ground', a4),
                                           ('coupler', 'output'), length_1=a2, length_2=a3)),
            (SliderCrank(a1, a2, 0.1), Dyad('d', 'RRP', crank, fixed, ('coupler', 'output'),
                                            length_1=a2, direction_2=0.0))):
        ours, theirs = (properties_of(each) for each in (Machine([dyad]), kind))
        assert len(ours['dead_points']) == 2
        for one, other in zip(ours['dead_points'], theirs['dead_points']):
            x, place = one.values()
            assert [x, place] == pytest.approx([*other.values()][:2], abs=1e-8)
        assert ours['outputs'][0]['time_ratio'] == pytest.approx(
            theirs['outputs'][0]['time_ratio'], rel=1e-7)
        assert sum(ours['outputs'][0]['least_at'] + ours['outputs'][0]['most_at'], []) == (
            pytest.approx(sum(theirs['outputs'][0]['least_at'] + theirs['outputs'][0]['most_at'],
                              []), abs=1e-8))


def test_an_output_that_turns_fully_or_rocks_with_its_input_has_no_time_ratio():
    whitworth = InvertedSlider(0.15, 0.1)       # the bar turns fully
    assert isnan(properties_of(whitworth)['outputs'][0]['time_ratio'])
    assert isnan(properties_of(load_scene('chebyshev').linkage)['outputs'][0]['time_ratio'])


def test_studies_have_the_parts_of_all_of_them():
    scene = load_scene('paper')
    linkage, speed = scene.linkage, scene.drive.speed
    power, mean, rms, least, work, holding, worst = measured(
        scene, 'driving_power.peak', 'driving_power.mean', 'driving_power.rms',
        f'{ADVANTAGE}.min', 'work', 'holding_torque.peak', 'transmission_angle.min')
    torque = OverInput(linkage, 'driving_torque', speed)
    assert power == pytest.approx(torque.peak * speed, rel=4 * EPS)
    assert rms == pytest.approx(torque.rms * speed, rel=1e-12)
    assert abs(mean) <= 1e-12 * rms and work == 0.0
    assert least == -inf and holding == 0.0 and 0.0 < worst < pi / 2
    names = 'holding_torque', ADVANTAGE, 'inertia', 'driving_power', 'transmission_angle'
    curves = curves_of(scene, linkage, names, speed)
    assert set(names) == set(curves.names[1:]) and set(names) <= set(by_name(linkage))
    drive = drive_of(linkage, speed)
    cycle = drive['cycle']
    assert isnan(cycle.pop('efficiency')) and set(cycle.values()) == {0.0}
    assert drive['holding_torque']['most'] == 0.0
    assert drive[ADVANTAGE]['most'] == inf and drive[ADVANTAGE]['least'] == min(
        abs(one.value) for one in find_extrema(linkage, ADVANTAGE))


def test_without_masses_there_is_an_advantage_and_no_load():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    assert list(drive_of(linkage, 1.0)) == [ADVANTAGE]
    with pytest.raises(MissingBodies):
        find_extrema(linkage, 'holding_torque')
    with pytest.raises(InvalidParameter, match='mass'):
        measured(load_scene('slides_7_6'), 'work')


def test_quantities_come_in_the_order_asked_and_at_a_stroke_end_have_one_side():
    linkage = load_scene('paper').linkage
    names = ['inertia', 'omega4', ADVANTAGE, 'f41']
    found = find_extrema(linkage, names, 2.0)
    assert list(dict.fromkeys(one.quantity for one in found)) == names
    dead = linkage.dead_points[1].theta1
    at_end = [one for one in find_extrema(linkage, ADVANTAGE, within=(dead, dead + 0.5))
              if abs(one.value) == inf]
    assert [(one.side, one.place) for one in at_end] == [(1, 'limit')]
