# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Forces over a position against virtual work, springs of the same law and quadrature."""
from decimal import Decimal
from math import pi, sin
import pickle

from fourbar_ros import Bodies, FourBar, InvertedSlider, round_rod, SliderCrank
from fourbar_ros.dynamics import legs, simulation
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.flywheel import flywheel_for
from fourbar_ros.dynamics.node_step import Mover, OK
from fourbar_ros.dynamics.piece_steps import BetweenSteps
from fourbar_ros.dynamics.run import EVENT, REACHED, STOPPED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import ConstantTorque, Drive, MotorLine
from fourbar_ros.dynamics.statics import equilibria
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Body
from fourbar_ros.mechanisms.elements import (
    Attachment,
    Distance,
    LinkAngle,
    PositionForce,
    Spring,
    TorsionSpring,
    Way,
)
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.scene.scene import load
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator
from support.dynamics_problems import samples, wheel

BODIES = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
CRANKS = [FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, gravity=(1.0, -9.81)),
          FourBar(0.4, 1.2, 0.8, 1.0, mode=1, bodies=BODIES),
          SliderCrank(0.3, 0.9, 0.1, bodies=BODIES, gravity=(0.0, -9.81)),
          InvertedSlider(0.3, 0.9, 0.1, bodies=BODIES)]
SLIDES = [SliderCrank(0.3, 0.9, 0.1, input='slide', bodies=BODIES),
          InvertedSlider(0.3, 0.9, 0.1, input='slide', bodies=BODIES)]
MACHINE = load('v_engine').linkage
ALL = [*CRANKS, *SLIDES, MACHINE]
TURN = 2.0 * pi
CYCLE = ForceTable(np.linspace(0.0, TURN, 9),
                   [3.0, 90.0, 40.0, -20.0, 5.0, 6.0, 7.0, -80.0, 3.0], is_periodic=True)
STROKE = ForceTable([-3.0, -0.4, 0.1, 0.5, 0.9, 1.3, 4.0],
                    [0.0, 50.0, -70.0, 30.0, 20.0, 9.0, 1.0])


def forces_on(linkage):
    """Return forces of all sorts on the links of a mechanism."""
    first, *_, last = (link.name for link in linkage.LINKS)
    middle = linkage.LINKS[1].name
    over_input = STROKE if linkage.is_driven_by_slide else CYCLE
    return [PositionForce(Attachment(last, 0.2, 0.1), over_input, direction=0.3),
            PositionForce(Attachment(middle, 0.1, -0.2), CYCLE, LinkAngle(middle), -0.7, middle),
            PositionForce(Attachment(first, 0.1), STROKE, Way(Attachment(last)), 0.5 * pi),
            PositionForce(Attachment(middle, 0.3),
                          lambda s: 40.0 * sin(3.0 * s), Way(Attachment(middle, 0.3),
                                                             Attachment('ground', 0.2, -0.1), 1.1),
                          2.0, first, factor=-1.5),
            PositionForce(Attachment(last), CYCLE, LinkAngle(middle, first), None)]


def pose(linkage, q):
    """Return the places of points (a function) and the angles of links at an input."""
    motion = linkage.motion(q, 0.0, 0.0)

    def place(attachment):
        if attachment.link == 'ground':
            return np.array([attachment.along, attachment.across])
        return point_motion(linkage, motion, attachment.link, attachment.along,
                            attachment.across).place

    def direction(link):
        if link == 'ground':
            return 1.0 + 0.0j
        return complex(*linkage.link_motion(motion, link)[6:8])
    return place, direction


def acting(linkage, force, q):
    """Return value and unit vector of a force from a pose alone."""
    place, direction = pose(linkage, q)
    over = force.over
    if over == 'input':
        s = q
    elif isinstance(over, LinkAngle):
        s = float(np.angle(direction(over.link) / direction(over.relative_to)))
    else:
        line = np.exp(1j * over.direction) * direction(over.origin.link)
        way = place(over.point) - place(over.origin)
        s = float(way @ (line.real, line.imag))
    value = force.factor * float(force.value(s))
    if force.direction is None:
        return value, None
    unit = np.exp(1j * force.direction) * direction(force.axes)
    return value, np.array([unit.real, unit.imag])


@pytest.mark.parametrize('linkage', ALL, ids=lambda linkage: linkage.description)
def test_the_generalised_force_is_virtual_work(linkage):
    """Q = F . dP/dq, the derivative of the place by differences of order 4."""
    for force in forces_on(linkage):
        equation, without = Equation(linkage.with_elements(force)), Equation(linkage)
        for q, _, _ in samples(linkage, 3, 12):
            value, unit = acting(linkage, force, q)
            h = 2e-4

            def moved(step, force=force, unit=unit, q=q):
                place, direction = pose(linkage, q + step)
                if unit is None:
                    turn = direction(force.point.link) / pose(linkage, q)[1](force.point.link)
                    return float(np.angle(turn))
                return float(place(force.point) @ unit)
            slope = (8.0 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12.0 * h)
            found = equation.terms(q).force - without.terms(q).force
            assert abs(found - value * slope) <= 1e-7 * (1.0 + abs(value))
            assert equation.terms(q).couples == pytest.approx(found, abs=1e-10 * (1 + abs(value)))


@pytest.mark.parametrize('linkage', ALL, ids=lambda linkage: linkage.description)
def test_the_drive_of_the_loads_is_that_of_the_equation_also_in_arrays(linkage):
    """With a spring, a damper and a torsion spring beside the forces."""
    elements = [*forces_on(linkage),
                Spring(Attachment('ground', 1.4, 0.3), Attachment(linkage.LINKS[-1].name, 0.3),
                       900.0, free_length=0.4, damping=15.0),
                TorsionSpring(linkage.LINKS[0].name, linkage.LINKS[1].name, 20.0, free_angle=0.1,
                              damping=0.5)]
    linkage = linkage.with_elements(*elements)
    equation = Equation(linkage)
    motions = list(samples(linkage, 11, 30))
    found = linkage.loads(*np.array(motions).T.reshape(3, 5, 6))
    for i, sample in enumerate(motions):
        alone = linkage.loads(*sample)
        size = max(map(abs, alone))
        for one, many in zip(alone, found):
            assert abs(one - many.ravel()[i]) <= 1e-11 * size
        drive = alone.driving_force if linkage.is_driven_by_slide else alone.driving_torque
        condition = 1.0 + linkage.motion(*sample).condition / linkage.input_unit
        assert abs(drive - equation.torque(*sample)) <= 1e-11 * condition * size
    assert isinstance(linkage.loads(*motions[0])[0], float)


@pytest.mark.parametrize('linkage', ALL, ids=lambda linkage: linkage.description)
def test_stiffness_is_the_slope_of_the_force(linkage):
    equation = Equation(linkage.with_elements(*forces_on(linkage)))
    for q, _, _ in samples(linkage, 5, 12):
        h = 1e-5
        slope = (equation.terms(q + h).force - equation.terms(q - h).force) / (2.0 * h)
        assert equation.stiffness(q) == pytest.approx(-slope, rel=2e-4, abs=2e-2)


def test_a_linear_table_is_a_spring_also_through_toggles():
    """F = -k (x - x0) of a slider is a spring on its guide; a driven slide passes dead points."""
    linkage = SliderCrank(0.3, 0.9, 0.0, input='slide', bodies=BODIES, gravity=(0.0, -9.81))
    k, x0 = 300.0, 0.75
    spring = Spring(Attachment('ground', x0, 0.0), Attachment('output'), k)
    table = ForceTable([-4.0, 4.0], [k * (x0 + 4.0), k * (x0 - 4.0)], is_linear=True)
    runs = [simulate(System(linkage.with_elements(element), 0.7, 6.0), 0.5, 1e-8,
                     times=[0.2, 0.5])
            for element in (spring, PositionForce(Attachment('output'), table),
                            PositionForce(Attachment('output'), table, Way(Attachment('output'))),
                            PositionForce(Attachment('output'), lambda x: k * (x0 - x)))]
    assert len(set(simulate(System(linkage.with_elements(spring), 0.7, 6.0), 0.5).modes)) == 2
    for run in runs:
        assert run.status == REACHED
        assert np.max(np.abs(run.position - runs[0].position)) <= 4e-8 * linkage.input_unit


def test_a_flywheel_on_a_driven_slide_is_a_heavier_slider_through_toggles():
    heavy = BODIES._replace(output=Body(BODIES.output.mass + 5.0))
    light = BODIES._replace(output=Body(BODIES.output.mass))
    runs = [simulate(System(SliderCrank(0.3, 0.9, 0.0, input='slide', bodies=bodies), 0.7, 6.0,
                            drive=Drive(ConstantTorque(), flywheel=flywheel)), 0.5, 1e-9,
                     times=[0.2, 0.5])
            for bodies, flywheel in ((heavy, 0.0), (light, 5.0))]
    assert [run.status for run in runs] == [REACHED] * 2
    assert np.max(np.abs(runs[0].position - runs[1].position)) <= 4e-9


def test_a_linear_couple_over_an_angle_is_a_torsion_spring_through_toggles():
    linkage = FourBar(0.9, 1.0, 0.8, 1.2, bodies=BODIES, gravity=(0.0, -9.81))
    middle = 0.5 * sum(linkage.input_ranges[0])
    table = ForceTable([middle - pi, middle + pi], [25.0 * pi, -25.0 * pi], is_linear=True)
    runs = [simulate(System(linkage.with_elements(element), middle + turns * TURN, 2.0), 1.5,
                     1e-8, times=[0.8, 1.5])
            for turns in (0, 3)
            for element in (TorsionSpring('ground', 'crank', 25.0, free_angle=middle),
                            PositionForce(Attachment('crank'), table, 'input', None),
                            PositionForce(Attachment('crank'), table, LinkAngle('crank'), None))]
    for run in runs:
        assert run.status == REACHED
        turns = np.round((run.position - runs[0].position) / TURN)
        assert np.max(np.abs(run.position - turns * TURN - runs[0].position)) <= 1e-7


# --- a four-stroke engine ---------------------------------------------------------------------

def engine(drive=None, speed=150.0):
    return System(load('engine').linkage, 0.0, speed,
                  drive or Drive(ConstantTorque(), flywheel=0.5))


def work_of_gas(system, start, end):
    """Return the integral of force over the piston's way, piece by piece of the table."""
    gas, linkage = system.equation.forces[0], system.mechanism
    table = gas.value.table
    breaks = [place + k * table.span for k in range(8) for place in table.places[:-1]]
    ends = [start, *(place for place in breaks if start < place < end), end]

    def power(q):
        return gas.factor * gas.value(q) * linkage.motion(q, 1.0, 0.0).slide_velocity
    return sum(quad(power, a, b, epsabs=1e-10, epsrel=1e-12)[0] for a, b in zip(ends, ends[1:]))


def test_the_work_of_a_cycle_is_the_integral_of_p_dv():
    """Kinetic energy at every step, from p dV by quadrature; two turns give 426 J."""
    system = engine()
    run = simulate(system, 0.11, 1e-8)
    inertia = system.equation.terms(run.position).inertia
    kinetic = 0.5 * inertia * run.rate**2
    assert run.status == REACHED and run.position[-1] > 4.0 * pi
    for i in (run.time.size // 3, run.time.size // 2, -1):
        work = work_of_gas(system, 0.0, run.position[i])
        assert kinetic[i] - kinetic[0] == pytest.approx(work, abs=2e-8 * kinetic[i])
        assert run.states.work[i] == pytest.approx(work, abs=2e-8 * kinetic[i])
    volume = 0.005808804816 * np.array([system.mechanism.motion(q).slide for q in
                                        system.equation.forces[0].value.table.places])
    pressure = np.array(system.equation.forces[0].value.table.values)
    by_trapezia = -np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume))
    assert work_of_gas(system, 0.0, 4.0 * pi) == pytest.approx(by_trapezia, rel=5e-3)
    assert by_trapezia == pytest.approx(426.0, rel=1e-2)


@pytest.mark.slow
def test_the_shipped_engine_reaches_five_seconds():
    """16 000 legs, one for each place of its table, within the evaluations allowed."""
    scene = load('engine')
    run = simulate(scene.dynamics.system(scene.linkage), 5.0, 1e-8)
    assert run.status == REACHED and run.error <= 1e-8 and run.drift <= 1e-8


@pytest.mark.parametrize(('tolerance', 'are_methods_different'), [(1e-6, True), (1e-8, False)])
def test_runs_whose_difference_is_the_error_take_other_steps_in_a_piece(
        monkeypatch, tolerance, are_methods_different):
    # pieces end at the same inputs in both, each took the step of a piece's length: a step that
    # was too long was too long in both (of an inverted slider-crank 8.3e-7 rad for 1.4e-8)
    runs, integrate = [], simulation.integrate

    def noted(*arguments):
        runs.append(legs := [])
        for leg in integrate(*arguments):
            legs.append(leg)
            yield leg
    monkeypatch.setattr(simulation, 'integrate', noted)
    run = simulate(engine(), 0.05, tolerance)
    rough, fine = (sum(leg.time.size - 1 for leg in legs) for legs in runs[-2:])
    methods = [{type(step.between) for leg in legs if isinstance(leg.between, BetweenSteps)
                for step in leg.between.steps} for legs in runs[-2:]]
    assert run.status == REACHED and all(len(each) == 1 for each in methods)
    assert methods[0] != methods[1] if are_methods_different else fine >= 1.7 * rough


@pytest.mark.parametrize('tolerance', [1e-5, 1e-7, 1e-9])
@pytest.mark.parametrize('speed', [150.0, -150.0])
def test_steps_of_the_input_are_the_motion_of_steps_in_time(monkeypatch, tolerance, speed):
    run, times = simulate(engine(speed=speed), 0.05, tolerance), np.linspace(0.0, 0.05, 334)
    steps = [step for leg in run.legs if isinstance(leg.between, BetweenSteps)
             for step in leg.between.steps]
    assert len(steps) >= 80             # over 5 deg each
    again = pickle.loads(pickle.dumps(run))
    assert np.array_equal(again.at(times).position, run.at(times).position)
    monkeypatch.setattr(legs, '_leg_over_pieces', lambda *arguments: None)
    in_time = simulate(engine(speed=speed), 0.05, tolerance)
    assert run.evaluations <= 0.8 * in_time.evaluations
    exact = simulate(engine(speed=speed), 0.05, 1e-11, times=times)
    allowed = run.error + exact.error + 1e-14 * abs(exact.position[-1])
    assert np.max(np.abs(run.at(times).position - exact.position)) <= allowed
    # and errors of the rate are those of the position within a step
    shortest = min(np.diff([step.time for step in steps]))
    assert np.max(np.abs(run.at(times).rate - exact.rate)) <= allowed / shortest


@pytest.mark.parametrize('beyond', [0.0, -1e-11])
def test_a_run_that_stops_at_the_end_of_a_piece_has_few_legs(beyond):
    """Each began in the middle of what was left of the piece, 37 of them."""
    system = System(wheel().with_elements(PositionForce(Attachment('crank'), CYCLE,
                                                        direction=None)), 0.0, 20.0)
    target = 9.0 / 8.0 * TURN + beyond
    stopped = simulate(system, 5.0, 1e-8, stop_when=lambda t, y: y[0] - target)
    reached = simulate(system, float(stopped.time[-1]), 1e-8)
    assert (stopped.status, reached.status) == (EVENT, REACHED)
    for run in (stopped, reached):
        assert run.position[-1] == pytest.approx(target, abs=1e-13) and len(run.legs) <= 3


@pytest.mark.parametrize('tolerance', [1e-3, 1e-6])
@pytest.mark.parametrize('has_table', [True, False])
def test_a_push_within_a_turn_is_felt(tolerance, has_table):
    """Of a wheel, by energy: a step of the whole turn passed over it, in both runs."""
    low, high, size, rate = 0.55 * TURN - 0.4, 0.55 * TURN + 0.4, 50.0, 10.0

    def push(s):
        s = s % TURN
        return size * sin(pi * (s - low) / (high - low)) if low < s < high else 0.0
    nothing = ForceTable([0.0, TURN], [0.0, 0.0], is_periodic=True)
    pushed = wheel().with_elements(*(PositionForce(Attachment('crank'), value, direction=None)
                                     for value in (nothing, push)[not has_table:]))
    run = simulate(System(pushed, 0.0, rate), 0.7, tolerance)
    work, inertia = size * (high - low) * 2.0 / pi, wheel().bodies.crank.inertia
    assert run.status == REACHED
    assert run.rate[-1] == pytest.approx((rate**2 + 2.0 * work / inertia)**0.5, rel=tolerance)


@pytest.mark.parametrize('speed', [150.0, -150.0])
@pytest.mark.parametrize('cycles', [-100_000, 1000, 79_577])
def test_a_run_whole_cycles_away_is_the_same(speed, cycles):
    """Up to 1e6 rad in steps of the input, beyond it in time; ends of pieces are rounded there."""
    near, shift = engine(speed=speed), cycles * 4.0 * pi
    far, times = System(near.mechanism, shift, speed, near.drive), np.linspace(0.0, 0.05, 101)
    for tolerance in (1e-6, 1e-8):
        runs = [simulate(system, 0.05, tolerance) for system in (near, far)]
        apart = np.subtract(*[run.at(times).position for run in runs]) + shift
        assert np.max(np.abs(apart)) <= sum(run.error for run in runs) + 32.0 * EPS * abs(shift)


def test_the_steps_of_a_node_follow_the_engine():
    """Each of 70 steps of 2 ms, over two turns, is within its tolerance of 1e-6 rad."""
    system = load('engine').dynamics.system(load('engine').linkage)
    mover = Mover(system, 1e-6, 400, False)
    values = mover.start()
    for _ in range(70):
        _, values = mover.next(values, 2e-3)
    run = simulate(system, 0.14, 1e-6, times=[0.14])
    assert values.position > 4.0 * pi
    assert values.position == pytest.approx(run.position[-1], abs=70 * 1e-6)


def test_a_crank_that_counts_turns_tells_the_strokes_apart():
    system = engine()
    firing, idle = (system.equation.terms(q).force for q in (TURN + 0.4, 0.4))
    assert firing > 100.0 > 2.0 > abs(idle)
    assert system.equation.terms(TURN + 0.4 + 8.0 * pi).force == pytest.approx(firing, rel=1e-12)
    torque = system.mechanism.loads(TURN + 0.4).driving_torque
    assert torque == pytest.approx(-firing, rel=1e-12)


def test_a_press_works_against_its_cut_and_stalls_at_a_heavier_one():
    """The motor's work less that of the cut is the change of energy; a stall has its place."""
    linkage = SliderCrank(0.05, 0.2, bodies=BODIES)
    cut = ForceTable([0.0, 0.19, 0.2, 0.24, 0.25, 1.0], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0])

    def pressed(force):
        element = PositionForce(Attachment('output'), cut, Way(Attachment('output')),
                                factor=-force)
        drive = Drive(MotorLine(300.0, 12.0), flywheel=1.0)
        return simulate(System(linkage.with_elements(element), pi, 1.0, drive), 2.0, 1e-7)
    light, heavy = pressed(200.0), pressed(3e4)
    assert light.status == heavy.status == REACHED
    assert light.position[-1] > 2.0 * TURN and heavy.position[-1] < TURN
    slide = linkage.motion(heavy.position[-1]).slide
    assert 0.18 < slide < 0.2 and abs(heavy.rate[-1]) < 1.0


def test_two_turns_count_in_statics_and_for_a_flywheel():
    """Equilibria of an engine at rest: all sign changes of Q over two turns; its steady cycle."""
    equation = engine().equation
    places = np.array([one.position for one in equilibria(equation)])
    dense = np.linspace(-pi, 3.0 * pi, 400_001) + 5e-6      # one end of the cycle is in it
    sides = equation.terms(dense).force > 0.0
    changes = dense[:-1][sides[1:] != sides[:-1]]
    assert equation.mechanism.turns == 2 and places.size == changes.size > 2
    assert np.max(np.abs(places - changes)) < 4.0 * pi / 400_000 + 1e-12
    wheel = flywheel_for(equation, 100.0, 0.02)
    assert wheel.position[-1] > 3.9 * pi and wheel.inertia > 0.0
    driven = engine(Drive(ConstantTorque(wheel.torque), flywheel=0.5 + wheel.inertia),
                    float(wheel.rate[0]))
    run = simulate(driven, 0.2, 1e-9, times=np.linspace(0.0, 0.2, 8001),
                   stop_when=lambda _, state: state[0] - 4.0 * pi)
    assert np.ptp(run.rate) / 100.0 == pytest.approx(0.02, rel=1e-4)
    assert run.rate[-1] == pytest.approx(run.rate[0], rel=1e-8)


@pytest.mark.parametrize('width', [1e-1, 1e-3, 1e-6])
@pytest.mark.parametrize('inertia', [0.3, 3.0])
def test_a_flywheel_bears_a_push_however_short(width, inertia):
    """
    A push of so many radians takes 20 J: shorter than samples are apart, it was not counted.

    Of a constant inertia, by hand: the drive gives 20 J over the turn and the push takes them, so
    the largest change of energy is 20 (1 - width/2 pi), over the fluctuation and the square of
    the speed.
    """
    begin, end = 1.0, 1.0 + width
    pushes = ForceTable([0.0, begin, begin, end, end, TURN],
                        [0.0, 0.0, -20.0 / width, -20.0 / width, 0.0, 0.0], True, is_linear=True)
    mechanism = wheel().with_elements(PositionForce(Attachment('crank'), pushes, direction=None))
    flywheel = flywheel_for(Equation(mechanism, extra_inertia=inertia), 10.0, 0.02)
    span, change = end - begin, 20.0 * (1.0 - width / TURN)
    assert flywheel.torque == pytest.approx(20.0 / TURN, rel=4.0 * EPS / span)
    of_wheel = Equation(wheel()).terms(0.0).inertia + inertia
    assert flywheel.inertia == pytest.approx(max(change / (0.02 * 10.0**2) - of_wheel, 0.0),
                                             rel=8.0 * EPS / span)


# --- tables -----------------------------------------------------------------------------------

def test_a_table_is_that_of_scipy_on_floats_and_arrays():
    rng = np.random.default_rng(2)
    places, values = np.cumsum(rng.uniform(0.05, 1.0, 40)), rng.normal(size=40)
    inside = rng.uniform(places[0], places[-1], 300)
    table, lines = ForceTable(places, values), ForceTable(places, values, is_linear=True)
    assert np.max(np.abs(table(inside) - PchipInterpolator(places, values)(inside))) < 1e-14
    assert np.max(np.abs(lines(inside) - np.interp(inside, places, values))) < 1e-14
    cycle = ForceTable(places, [*values[:-1], values[0]], True)
    span, three = cycle.span, [np.array(cycle.places) + k * cycle.span for k in range(-2, 3)]
    every = np.concatenate([three[0][:1], *(part[1:] for part in three)])
    repeated = np.concatenate([cycle.values[:1], *[cycle.values[1:]] * 5])
    reference = PchipInterpolator(every, repeated)
    assert np.max(np.abs(cycle(inside) - reference(inside))) < 1e-13
    assert np.max(np.abs(cycle(inside + 7 * span) - cycle(inside))) < 1e-12
    ends = np.array([places[0] - 3.0, places[-1] + 3.0])
    assert table(ends).tolist() == [values[0], values[-1]]
    for its in (table, lines, cycle):
        wide = rng.uniform(places[0] - 9.0, places[-1] + 9.0, 400)
        assert its(wide).tolist() == [its(x) for x in wide.tolist()]
        low, high = its(wide).min(), its(wide).max()
        assert min(values) <= low and high <= max(values)                # no overshoot
        assert pickle.loads(pickle.dumps(its))(0.3) == its(0.3)
    step = 1e-7
    left, right = ((cycle(places[0] + side * step) - cycle(places[0])) / (side * step)
                   for side in (-1.0, 1.0))
    assert left == pytest.approx(right, abs=1e-4)


@pytest.mark.parametrize('is_linear', [True, False])
def test_a_table_with_jumps_is_one_curve_on_each_side(is_linear):
    """Against scipy and numpy on each part alone; at a place itself the value after the jump."""
    rng = np.random.default_rng(5)
    parts = [np.sort(rng.uniform(low, low + 1.0, count))
             for low, count in ((0, 4), (1, 2), (2, 7))]
    ends = [0.5 * (before[-1] + after[0]) for before, after in zip(parts, parts[1:])]
    parts = [np.array([*ends[i - 1:i], *part, *ends[i:i + 1]]) for i, part in enumerate(parts)]
    of_parts = [rng.normal(size=part.size) for part in parts]
    table = ForceTable(np.concatenate(parts), np.concatenate(of_parts), False, is_linear)
    for part, values in zip(parts, of_parts):
        curve = (lambda x, part=part, values=values: np.interp(x, part, values)) if is_linear \
            else PchipInterpolator(part, values)
        x = rng.uniform(part[0], part[-1], 99)
        assert np.max(np.abs(table(x) - curve(x))) < 1e-14
        assert table(x).tolist() == [table(each) for each in x.tolist()]
        assert table(float(part[0])) == values[0]
        assert table(float(np.nextafter(part[-1], 0.0))) == pytest.approx(values[-1], abs=1e-12)
    assert table(-9.0) == of_parts[0][0] and table(9.0) == of_parts[-1][-1]


@pytest.mark.parametrize('is_periodic', [True, False])
def test_at_a_jump_over_an_angle_the_value_is_the_second_to_the_bit(is_periodic):
    """Taken within a period, or half a turn of the middle, an angle was rounded to before it."""
    rng = np.random.default_rng(5)
    for jump in np.round(rng.uniform(-0.2, 0.2, 200), 3).tolist():
        low, high = -0.5, -0.5 + TURN if is_periodic else round(float(rng.uniform(1.0, 2.0)), 3)
        table = ForceTable([low, jump, jump, high], [0.0, 0.0, -500.0, 0.0], is_periodic)
        crank = FourBar(1.0, 1.2, 0.9, 1.3, bodies=BODIES, stroke=(-0.3, 0.3)).with_elements(
            PositionForce(Attachment('crank'), table, direction=None))
        by_table = crank.elements[0].value
        for x in (jump, np.array([jump]), np.array([jump + 1e-30j]), Decimal(jump)):
            assert float(np.ravel(by_table(x))[0].real) == -500.0, jump
        assert crank.loads(jump).driving_torque == crank.loads([jump]).driving_torque[0] == 500.0


def test_a_jump_at_an_end_is_a_step_there():
    table = ForceTable([1.0, 1.0, 2.0, 2.0], [7.0, 50.0, 40.0, -3.0])
    assert [table(x) for x in (0.0, 0.999, 1.0, 1.5, 1.999999, 2.0, 9.0)] == pytest.approx(
        [7.0, 7.0, 50.0, 45.0, 40.0, -3.0, -3.0], abs=1e-4)
    assert table(np.array([0.999, 1.0, 2.0])).tolist() == [7.0, 50.0, -3.0]


@pytest.mark.parametrize('is_linear', [True, False])
def test_a_cycle_may_jump_where_it_comes_round(is_linear):
    """Written at its end or at its begin it is one; without a jump there it goes on smoothly."""
    places, values = [0.0, 1.0, 2.5, 4.0], [3.0, -8.0, 5.0, 60.0]
    at_end = ForceTable([*places, 4.0], [*values, 3.0], True, is_linear)
    at_begin = ForceTable([0.0, *places], [60.0, *values], True, is_linear)
    one_turn = ForceTable(places, values, False, is_linear)
    x = np.linspace(-9.0, 9.0, 1234)
    assert np.max(np.abs(at_end(x) - one_turn(x % 4.0))) < 1e-12
    assert at_end(x).tolist() == at_begin(x).tolist() == [at_begin(each) for each in x.tolist()]
    assert at_end(0.0) == at_end(8.0) == 3.0 and at_end(-1e-300) == 60.0
    # a jump within: the curve over the seam is that of the cycle begun elsewhere
    inside = ForceTable([0.0, 1.0, 2.0, 2.0, 3.0, 4.0], [1.0, 5.0, 2.0, -9.0, 7.0, 1.0], True,
                        is_linear)
    turned = ForceTable([2.0, 3.0, 4.0, 5.0, 6.0], [-9.0, 7.0, 1.0, 5.0, 2.0], False, is_linear)
    assert np.max(np.abs(inside(x) - turned(2.0 + (x - 2.0) % 4.0))) < 1e-12


@pytest.mark.parametrize(('arguments', 'why'), [
    (([0.0], [1.0]), 'places = 1: must be 2 to 10000 points'),
    (([0.0, 1.0], [1.0]), 'values = 1: must be as many as places, 2'),
    (([0.0, 1.0, 0.9], [1.0, 2.0, 3.0]), r'places\[3\] = 0.9: must be larger than the one before'),
    (([0.0, 1.0, 1.0, 1.0], [1.0, 2.0, 3.0, 4.0]), r'places\[4\] = 1.0: stands three times'),
    (([1.0, 1.0], [1.0, 2.0]), r'places\[2\] = 1.0: must be larger than the one before, 1.0'),
    (([0.0, 0.0, 1.0, 1.0], [1.0, 2.0, 3.0, 1.0], True), r'places\[4\] = 1.0: .* one jump'),
    (([0.0, float('nan')], [1.0, 2.0]), r'places\[2\] = nan: must be a finite number'),
    (([0.0, 1.0], [1.0, 'x']), r"values\[2\] = 'x': must be a finite number, not a text"),
    (([0.0, 1.0], [1.0, 2.0], True), r'values\[2\] = 2.0: must be the first value again, 1.0'),
    (([0.0, 1e-300], [-1e300, 1e300]), 'slopes overflow'),
    (('ab', [1.0, 2.0]), r'places\[1\] = \'ab\': must be a finite number'),
    ((range(20_000), range(20_000)), 'places = 20000: must be 2 to 10000 points')])
def test_a_wrong_table_is_refused_in_one_line(arguments, why):
    with pytest.raises(InvalidParameter, match=why) as refused:
        ForceTable(*arguments)
    assert '\n' not in str(refused.value)


SHORT = ForceTable([0.0, 1.0], [1.0, 2.0])
NOT_FULL = FourBar(0.9, 1.0, 0.8, 1.2, bodies=BODIES)
TWO_TURNS = ForceTable([0.0, 2.0 * TURN], [1.0, 1.0], True)


@pytest.mark.parametrize(('linkage', 'make', 'why'), [
    (CRANKS[0], lambda: PositionForce(Attachment('ground'), SHORT), 'acts on a moving link'),
    (CRANKS[0], lambda: PositionForce('output', SHORT), 'must be of type Attachment'),
    (CRANKS[0], lambda: PositionForce(Attachment('output'), 3.0), 'ForceTable or a function'),
    (CRANKS[0], lambda: PositionForce(Attachment('output'), SHORT, 'theta9'), "must be 'input'"),
    (CRANKS[0], lambda: PositionForce(Attachment('rocker'), CYCLE), "link = 'rocker': must be"),
    (CRANKS[0], lambda: PositionForce(Attachment('output'), SHORT), 'the crank turns fully'),
    (CRANKS[0], lambda: PositionForce(Attachment('output'),
                                      ForceTable([0.0, 3.0], [1.0, 1.0], True)), 'period must be'),
    (CRANKS[0], lambda: PositionForce(Attachment('output'), TWO_TURNS, LinkAngle('crank')),
     'turns are counted'),
    (NOT_FULL, lambda: PositionForce(Attachment('output'), TWO_TURNS), 'turns are counted'),
    (NOT_FULL, lambda: PositionForce(Attachment('output'), ForceTable([0.0, 7.0], [1.0, 2.0])),
     'more than a turn'),
    (SLIDES[0], lambda: PositionForce(Attachment('output'), CYCLE), 'a length does not come'),
    (CRANKS[0], lambda: PositionForce(Attachment('output', 0.2), lambda x: float('nan')),
     'must be a finite number')])
def test_a_force_that_does_not_fit_is_refused_in_one_line(linkage, make, why):
    with pytest.raises(InvalidParameter, match=why) as refused:
        Equation(linkage.with_elements(make())).terms(0.5)
    assert '\n' not in str(refused.value)


def test_a_force_of_a_user_that_fails_ends_the_run_with_a_status():
    linkage = CRANKS[0]
    broken = PositionForce(Attachment('output', 0.2), lambda q: 1.0 if q < 1.0 else float('inf'))
    run = simulate(System(linkage.with_elements(broken), 0.0, 5.0), 1.0, 1e-6)
    assert run.status == STOPPED and run.position[-1] == pytest.approx(1.0, abs=1e-6)


FLYWHEEL = 50.0         # [kg m^2] so heavy that steps are long
END = {'input': 5.0, 'way': 3.1, 'angle': 5.0}      # [rad], past the triangle once either way
NARROW = [(over, width, sign) for over in ('input', 'way', 'angle')
          for width in (0.1, 0.01, 0.001) for sign in (1.0, -1.0)]


def with_narrow_force(over, width, rate):
    """Return a system with a triangle of 100 J, of a half width [rad] or [m]."""
    if over == 'input':      # a couple over the crank, the same after each turn
        table = ForceTable([0.0, 2.0 - width, 2.0, 2.0 + width, 2.0 * pi],
                           [0.0, 0.0, 100.0 / width, 0.0, 0.0], is_periodic=True, is_linear=True)
        force = PositionForce(Attachment('crank'), table, direction=None)
    elif over == 'way':      # of the rocker's end, along the line that it acts along
        table = ForceTable([0.3, 0.7 - width, 0.7, 0.7 + width, 2.0],
                           [0.0, 0.0, 100.0 / width, 0.0, 0.0], is_linear=True)
        force = PositionForce(Attachment('output', 0.8), table, Way(Attachment('output', 0.8)))
    else:                    # a couple over the crank's angle as that of a link, in (-pi, pi]
        table = ForceTable([3.0 - width, 3.0, 3.0 + width], [0.0, 100.0 / width, 0.0],
                           is_linear=True)
        force = PositionForce(Attachment('crank'), table, LinkAngle('crank'), direction=None)
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, elements=(force,))
    return System(linkage, 0.0, rate, Drive(ConstantTorque(0.0), flywheel=FLYWHEEL))


def passes_of(over, system, end):
    """Return how often more a motion to an input has gone up over the triangle than down."""
    place = system.equation.table_positions
    if over == 'way':
        return float(place(end)[0] > 0.7) - float(place(0.0)[0] > 0.7)
    at = 2.0 if over == 'input' else 3.0
    return np.floor((end - at) / (2.0 * pi)) - np.floor(-at / (2.0 * pi))


@pytest.mark.parametrize(('over', 'width', 'sign'), NARROW)
def test_a_run_does_the_work_of_a_narrow_table(over, width, sign):
    system, tolerance = with_narrow_force(over, width, 25.0 * sign), 1e-8
    run = simulate(system, END[over] / 25.0, tolerance)
    assert run.status == REACHED
    energy = [system.equation.energy(run.position[i], run.rate[i]) for i in (0, -1)]
    work = 100.0 * passes_of(over, system, float(run.position[-1]))
    assert work
    # the tolerance is one of the energy in play
    assert energy[1] - energy[0] == pytest.approx(work, abs=10.0 * tolerance * energy[0])


@pytest.mark.parametrize(('over', 'width', 'sign'), NARROW)
def test_steps_of_the_node_do_the_work_of_a_narrow_table(over, width, sign):
    """With the node's tolerance and budget, at 1 kHz."""
    system, tolerance, rate = with_narrow_force(over, width, 25.0 * sign), 1e-6, 25.0
    mover = Mover(system, tolerance, 60)
    values = mover.start()
    energy = system.equation.energy(values.position, values.velocity)
    while abs(values.position) < END[over]:
        status, values = mover.next(values, 1e-3)
        assert status == OK
    gained = system.equation.energy(values.position, values.velocity) - energy
    work = 100.0 * passes_of(over, system, values.position)
    assert work
    # a step has an error of the speed of its tolerance over its length, here that of a flank
    step = min(width / rate, 1e-3)
    assert gained == pytest.approx(work, abs=FLYWHEEL * rate * tolerance / step)


def with_steps(over, height, rate):
    """Return a system with a force that is on between two places alone, and its work [J]."""
    if over == 'input':
        places, values = [0.0, 1.9, 1.9, 2.1, 2.1, TURN], [0.0, 0.0, height, height, 0.0, 0.0]
        force = PositionForce(Attachment('crank'), ForceTable(places, values, True, True),
                              direction=None)
    elif over == 'way':
        places, values = [0.3, 0.65, 0.65, 0.75, 0.75], [0.0, 0.0, height, height, 0.0]
        force = PositionForce(Attachment('output', 0.8), ForceTable(places, values),
                              Way(Attachment('output', 0.8)))
    else:
        force = PositionForce(Attachment('crank'), ForceTable(
            [2.9, 2.9, 3.1, 3.1], [0.0, height, height, 0.0]), LinkAngle('crank'), direction=None)
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, elements=(force,))
    return (System(linkage, 0.0, rate, Drive(ConstantTorque(0.0), flywheel=FLYWHEEL)),
            height * (0.1 if over == 'way' else 0.2))


@pytest.mark.parametrize('sign', [1.0, -1.0])
@pytest.mark.parametrize('over', ['input', 'way', 'angle'])
def test_motions_from_torque_do_the_work_of_steps(over, sign):
    """By a run, and by the node at 1 kHz: a step ends about where the force jumps."""
    (system, work), tolerance, rate = with_steps(over, 2000.0, 25.0 * sign), 1e-8, 25.0
    if over != 'way':
        work = work * sign
    else:                       # the rocker's end goes back over the step on the way to END
        work = work * passes_of(over, system, sign * END[over])
    run = simulate(system, END[over] / rate, tolerance)
    assert run.status == REACHED
    energy = [system.equation.energy(run.position[i], run.rate[i]) for i in (0, -1)]
    assert energy[1] - energy[0] == pytest.approx(work, abs=10.0 * tolerance * energy[0])
    mover, tolerance = Mover(system, 1e-6, 60), 1e-6
    values = mover.start()
    while abs(values.position) < END[over]:
        status, values = mover.next(values, 1e-3)
        assert status == OK
    gained = system.equation.energy(values.position, values.velocity) - energy[0]
    # a step has an error of the speed of its tolerance over its length
    assert gained == pytest.approx(work, abs=FLYWHEEL * rate * tolerance / 1e-3)


@pytest.mark.parametrize('width', [0.05, 5e-4])
@pytest.mark.parametrize('over', ['input', 'angle'])
def test_equilibria_inside_a_narrow_table_are_found(over, width):
    """A triangle against half its height: one on each flank."""
    linkage = with_narrow_force(over, width, 0.0).mechanism
    found = [one.position for one in equilibria(Equation(linkage), -50.0 / width)]
    middle = 2.0 if over == 'input' else 3.0
    assert found == pytest.approx([middle - 0.5 * width, middle + 0.5 * width], abs=1e-12)


def test_a_strut_over_its_length_is_the_spring_of_the_same_law():
    """A table that is a straight line between two points, at all doors of the mechanism."""
    strut, pivot = Attachment('output', 0.4, 0.1), Attachment('ground', 1.5, 0.3)
    law = ForceTable([0.1, 3.0], [-900.0 * (0.1 - 0.3), -900.0 * (3.0 - 0.3)], is_linear=True)
    for plain in CRANKS:
        spring = plain.with_elements(Spring(strut, pivot, 900.0, free_length=0.3))
        table = plain.with_elements(PositionForce(strut, law, Distance(strut, pivot),
                                                  apart_from=pivot))
        for motion in samples(plain, 5, 7):
            one, other = spring.loads(*motion), table.loads(*motion)
            size = 1e3 * (1.0 + max(map(abs, one)))
            assert max(abs(a - b) for a, b in zip(one, other)) <= 64 * 2.0**-52 * size
            assert Equation(table).torque(*motion) == pytest.approx(
                other.driving_torque, abs=1e-11 * size)


def test_a_strut_has_two_links():
    with pytest.raises(InvalidParameter, match='another link'):
        PositionForce(Attachment('crank'), CYCLE, apart_from=Attachment('crank', 0.1))
