# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Through flat positions of change points: against Cartesian circles, quadrature of energy."""
from math import pi

from fourbar_ros import (
    Bodies,
    Body,
    FourBar,
    InvertedSlider,
    MovingJointFourBar,
    SliderCrank,
)
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.flywheel import flywheel_for
from fourbar_ros.dynamics.node_step import Mover, OK
from fourbar_ros.dynamics.run import REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import ConstantTorque, Drive
from fourbar_ros.dynamics.statics import equilibria, free_period
from fourbar_ros.dynamics.system import System
from fourbar_ros.numerics.number_types import REAL
import numpy as np
import pytest
from support.dynamics_problems import steps
from support.swings import BODIES, PULL

scipy = pytest.importorskip('scipy')
STEP = 1e-100          # of a derivative by the complex step
TURNING = {
    'parallelogram': FourBar(0.5, 1.0, 0.5, 1.0, **PULL),
    'rhombus': FourBar(1.0, 1.0, 1.0, 1.0, mode=1, **PULL),
    '1:5:2:4': FourBar(1.0, 5.0, 2.0, 4.0, **PULL),
    'in decimals': FourBar(0.1, 0.5, 0.2, 0.4, mode=1, **PULL),
    'kite': FourBar(0.5, 1.0, 1.0, 0.5, **PULL),
    'kite about its crank': FourBar(0.5, 0.5, 1.0, 1.0, mode=1, **PULL),
    'equal rods': SliderCrank(0.5, 0.5, 0.0, **PULL)}
ROCKING = {
    '5:1:2:4': FourBar(5.0, 1.0, 2.0, 4.0, **PULL),
    'in decimals': FourBar(0.5, 0.1, 0.2, 0.4, mode=1, **PULL),
    'flat at pi': FourBar(2.0, 5.0, 1.0, 4.0, **PULL),
    'kite': FourBar(4.0, 3.0, 3.0, 4.0, **PULL),
    'long crank': SliderCrank(0.7, 0.5, 0.2, **PULL),
    'slide of equal rods': SliderCrank(0.5, 0.5, 0.0, input='slide', **PULL),
    'slide with an offset': SliderCrank(0.5, 0.7, 0.2, input='slide', **PULL),
    'cylinder': InvertedSlider(0.5, 0.7, 0.2, input='slide', **PULL),
    'driven at B': MovingJointFourBar(1.0, 5.0, 2.0, 4.0, mode=1, input='B', **PULL)}


def joint_b(linkage, x):
    """
    Return B of a change point in its branch, an analytic function of x, as an array of x and y.

    By circles about A and O4: with d = |A O4|, (a2 + a3)^2 - d^2 and d^2 - (a2 - a3)^2 are 4 a1 a4
    times cos^2(x/2) and sin^2(x/2) where the links lie flat at x = pi and x = 0, and their roots
    change sign there. Of a kite with a1 = a4, B is on the bisector at O1.
    """
    a1, a2, a3, a4 = linkage.lengths
    c, s, side = np.cos(0.5 * x), np.sin(0.5 * x), linkage.sign
    if a1 == a4:
        r = a1 * c + side * (a2 * c if a1 == a2 else np.sqrt(a2 * a2 - a1 * a1 * s * s))
        return np.array([r * c, r * s])
    d = np.array([a4 - a1 * np.cos(x), -a1 * np.sin(x)])
    square, is_flat = sum(d * d), 2.0 * np.sqrt(a1 * a4)
    outer = is_flat * c if abs(a2 + a3 - a1 - a4) < 1e-12 else np.sqrt((a2 + a3)**2 - square)
    inner = (is_flat * s if abs(abs(a1 - a4) - abs(a2 - a3)) < 1e-12
             else np.sqrt(square - (a2 - a3)**2))
    along = 0.5 * (1.0 + (a2 * a2 - a3 * a3) / square)
    across = 0.5 * side * outer * inner / square
    return np.array([a4 + 0.0 * x, 0.0 * x]) + (along - 1.0) * d + across * np.array([-d[1], d[0]])


def energies(linkage, position):
    """Return J and V at inputs: of masses at points of the Cartesian plane."""
    x = position + 1j * STEP
    nothing, (g_x, g_y) = np.zeros((2, position.size), complex), PULL['gravity']
    a = linkage.a1 * np.array([np.cos(x), np.sin(x)])
    if isinstance(linkage, SliderCrank):
        b = np.array([(1.0 + linkage.sign) * a[0], nothing[0]])
        links = [(nothing, a), (a, b - a), (b, nothing + [[1.0], [0.0]])]
    else:
        b, pivot = joint_b(linkage, x), nothing + [[linkage.a4], [0.0]]
        links = [(nothing, a), (a, b - a), (pivot, b - pivot)]
    inertia, potential = 0.0, 0.0
    for (first, toward), body in zip(links, BODIES):
        c, s = toward / np.hypot(*toward.real)
        centre = (first[0] + body.cg_along * c - body.cg_across * s,
                  first[1] + body.cg_along * s + body.cg_across * c)
        v_x, v_y, turn = [z.imag / STEP for z in (*centre, c.real * s - s.real * c)]
        inertia = inertia + body.mass * (v_x**2 + v_y**2) + body.inertia * turn**2
        potential = potential - body.mass * (g_x * centre[0].real + g_y * centre[1].real)
    return inertia, potential


@pytest.mark.parametrize('name', TURNING)
def test_inertia_and_potential_are_regular_at_flat_positions(name):
    """And over four turns; slopes by differences of the reference, as J' = 2 (J'/2)."""
    linkage = TURNING[name]
    for linkage in (linkage, linkage.in_mode(3 - linkage.mode)):
        equation, flats = Equation(linkage), np.array(linkage.flat_inputs)
        q = np.concatenate([flats, flats + 2.0 * pi, flats - 4.0 * pi, flats + 1e-9,
                            np.linspace(-4.0 * pi, 4.0 * pi, 101)])
        terms = equation.terms(q)
        inertia, potential = energies(linkage, q)
        assert terms.inertia == pytest.approx(inertia, rel=1e-13)
        assert equation.potential(q) == pytest.approx(potential, abs=1e-13 * 60.0)
        (before, v_before), (after, v_after) = [energies(linkage, q + d) for d in (-1e-5, 1e-5)]
        assert 2.0 * terms.half_slope == pytest.approx((after - before) / 2e-5,
                                                       abs=1e-6 * np.max(inertia))
        assert terms.force == pytest.approx((v_before - v_after) / 2e-5, abs=1e-6)
        for x in q[:flats.size].tolist():                   # floats as arrays, at flat positions
            assert equation.terms(x) == pytest.approx(equation.terms(np.array([x])), abs=1e-12)


@pytest.mark.parametrize('name', TURNING)
def test_a_run_goes_through_flat_positions_in_one_mode_and_one_leg(name):
    """Its times are the integral of dq sqrt(J / (2 (E - V))) of the reference."""
    linkage, start, times = TURNING[name], 0.7, np.linspace(0.1, 1.5, 15)
    run = simulate(System(linkage, start, 12.0), 1.5, 1e-10, times=times)
    assert run.status == REACHED and run.drift <= 1e-10 and len(run.legs) == 1
    assert set(run.modes.tolist()) == {linkage.mode} and run.position[-1] - start > 3.0 * pi
    inertia, potential = energies(linkage, np.array([start]))
    energy = 0.5 * inertia[0] * 12.0**2 + potential[0]

    def slowness(q):
        inertia, potential = energies(linkage, np.array([q]))
        return float(np.sqrt(0.5 * inertia / (energy - potential))[0])
    for before, after in zip([start, *run.position], run.position):
        found, _ = scipy.integrate.quad(slowness, before, after, epsabs=1e-12, limit=200)
        assert found == pytest.approx(0.1, abs=1e-9)
    # the links of the run are those of the mechanism in its mode, also as the node steps
    went = steps(Mover(System(linkage, start, 12.0), 1e-10, 1000), 1500)
    assert {done.status for done in went} == {OK}
    assert {done.state.mode for done in went} == {linkage.mode}
    stepped = np.array([done.state.vector.position for done in went[99::100]])
    assert np.abs(stepped - run.position).max() <= 1e-7


def pose_of(curves):
    """Return first joints and directions of links."""
    return np.array([(curve.x, curve.y, curve.cosine, curve.sine) for curve in curves], float)


@pytest.mark.parametrize('name', ROCKING)
def test_toggles_and_flat_positions_of_one_linkage(name):
    """The mode changes at toggles alone, and tells the links that the other coordinate moves."""
    linkage = ROCKING[name]
    low, high = linkage.input_ranges[0]
    at, rate, until = low + 0.6 * (high - low), -4.0 * linkage.input_unit, 3.0
    times = 2e-3 * np.arange(1, 1501)
    run = simulate(System(linkage, at, rate), until, 1e-10, times=times)
    assert run.status == REACHED and run.drift <= 1e-9
    flats, changes = linkage.flat_inputs, np.flatnonzero(np.diff(run.modes))
    assert changes.size and any(np.any((run.position[1:] > x) != (run.position[:-1] > x))
                                for x in (*flats, *[x + 2.0 * pi for x in flats]))
    for i in changes:
        assert min(run.position[i] - low, high - run.position[i]) < 0.05 * (high - low)
    last = None
    for leg, there, states in run._on_legs(run.time):
        own = leg.coordinate.equation.coordinate
        for value, position, mode in zip(states[0].tolist(), run.position[there].tolist(),
                                         run.modes[there].tolist()):
            pose = pose_of(own.make_coefficients(REAL)(value))
            theirs = pose_of(linkage.in_mode(mode).make_coefficients(REAL)(position))
            assert np.abs(pose - theirs).max() <= 1e-6            # half of the digits at a toggle
            assert last is None or np.abs(pose - last).max() < 0.3
            last = pose
    mover = Mover(System(linkage, at, rate), 1e-10, 2000)
    went = steps(mover, 1500, 2e-3)
    assert {done.status for done in went} == {OK}
    positions = np.array([mover.in_input(done.state).position for done in went])
    assert np.abs(positions - run.position).max() <= 1e-6 * linkage.input_unit
    assert [done.state.mode for done in went] == run.modes.tolist()


@pytest.mark.parametrize('mode', [1, 2])
def test_a_start_in_a_flat_position_next_to_which_another_coordinate_goes_on(mode):
    """Both modes of the other coordinate have the same pose there; only rates differ."""
    linkage = SliderCrank(0.1, 2.0, 1.9, input='slide', mode=mode, **PULL)
    system = System(linkage, 0.0, 1.0)
    coordinate, state = system.coordinates.begin(system.start)
    assert not coordinate.is_input
    along = coordinate.equation.coordinate.make_coefficients(REAL)(state[0])
    for own, other in zip(linkage.make_coefficients(REAL)(0.0), along):
        assert own.omega == pytest.approx(state[1] * other.omega, abs=1e-12)
    run = simulate(system, 0.5, 1e-9)
    assert run.status == REACHED and run.drift <= 1e-9


@pytest.mark.parametrize('name', ['kite', '1:5:2:4', 'parallelogram'])
def test_period_equilibria_and_flywheel_are_of_the_turns_after_which_all_repeats(name):
    linkage = TURNING[name]
    equation, turns = Equation(linkage), round(linkage.period / (2.0 * pi))
    assert linkage.turns == turns == (1 if name == 'parallelogram' else 2)
    system = System(linkage, 0.3, 15.0)
    period = free_period(system)
    run = simulate(system, period, 1e-10)
    assert run.position[-1] - 0.3 == pytest.approx(linkage.period, abs=1e-8)
    assert run.rate[-1] == pytest.approx(15.0, abs=1e-7)
    dense = np.linspace(-pi, linkage.period - pi, 20_001) + 1e-5
    sides = equation.terms(dense).force > 0.0
    changes = dense[:-1][sides[1:] != sides[:-1]]
    positions = np.array([one.position for one in equilibria(equation)])
    assert positions.size == changes.size >= 2 * turns
    assert np.max(np.abs(positions - changes)) <= linkage.period / 20_000
    wheel = flywheel_for(equation, 20.0, 0.02)
    drive = Drive(ConstantTorque(wheel.torque), flywheel=wheel.inertia)
    driven = simulate(System(linkage, 0.0, float(wheel.rate[0]), drive=drive),
                      linkage.period / 20.0, 1e-10, times=np.linspace(0.0, linkage.period / 20.0,
                                                                      4001))
    assert np.ptp(driven.rate) / 20.0 == pytest.approx(0.02, rel=1e-4)


@pytest.mark.parametrize('lengths', [(0.5, 1.0, 0.5, 1.0), (0.5, 1.0, 1.0, 0.5)],
                         ids=['parallelogram', 'kite'])
def test_a_flat_position_is_an_equilibrium_like_any_other(lengths):
    """All links hang in line: K by differences of the force; of the parallelogram by hand."""
    rods = Bodies(*[Body(1.0, cg_along=0.5 * length, inertia=0.02) for length in lengths[:3]])
    linkage = FourBar(*lengths, bodies=rods, gravity=(9.81, 0.0))
    equation = Equation(linkage)
    stable = [one for one in equilibria(equation) if one.is_stable]
    assert [one.position for one in stable] == pytest.approx(
        [0.0] if linkage.turns == 1 else [0.0, 2.0 * pi], abs=1e-12)
    for one in stable:
        before, after = equation.terms(one.position + np.array([-1e-5, 1e-5])).force
        assert one.stiffness == pytest.approx((before - after) / 2e-5, rel=1e-8)
    if linkage.turns == 1:       # two rods of 0.5 m swing on their ends, the third is carried
        inertia = 2.0 * (0.02 + 0.25**2) + 0.5**2
        assert stable[0].frequency == pytest.approx((9.81 / inertia)**0.5 / (2.0 * pi), rel=1e-13)
