# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Equilibria, frequencies, free motion and flywheels: against simulation and closed solutions."""
from dataclasses import replace
from math import pi, sqrt

from fourbar_ros import (
    Bodies,
    Body,
    DriveFriction,
    FourBar,
    InvalidParameter,
    JointFriction,
)
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.flywheel import flywheel_for
from fourbar_ros.dynamics.run import EVENT, REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import ConstantTorque, Drive
from fourbar_ros.dynamics.statics import equilibria, free_period
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import UnknownBaseMotion
from fourbar_ros.mechanics.bodies import NOT_APPLIED, UNKNOWN_BASE
from fourbar_ros.mechanisms.elements import Attachment, PositionForce, Spring, TorsionSpring
from fourbar_ros.mechanisms.force_table import ForceTable
import mpmath as mp
import numpy as np
import pytest
from support import contract
from support.cartesian import EPS
from support.dynamics_problems import paper_linkage
from support.machines import exact_potential, random_elements
from support.samples import more, some

scipy = pytest.importorskip('scipy')


def pendulum(**options):
    bodies = Bodies(Body(2.0, cg_along=0.25, inertia=0.1), Body(0.0), Body(0.0))
    return FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, gravity=(0.0, -9.81), **options)


@contract.every_mechanism
def test_the_stiffness_is_the_second_derivative_of_the_energy(case):
    rng = np.random.default_rng(300)
    for mechanism, (position, *_) in contract.ordinary(case, 301, 2):
        elements = random_elements(rng, mechanism)
        with mp.workdps(40):
            exact = mp.diff(lambda x: exact_potential(mechanism, elements, x), mp.mpf(position), 2,
                            h=mp.mpf(10)**-10)
        equation = Equation(mechanism.with_elements(*elements))
        assert abs(equation.stiffness(position) - exact) <= 1e-12 * (1 + abs(exact))
        many = equation.stiffness(position + 1e-4 * np.linspace(-1.0, 1.0, 41))
        assert many.shape == (41,) and many[20] == pytest.approx(float(exact), rel=1e-10)


@contract.every_mechanism
def test_the_rounding_error_of_the_force_is_bounded_by_a_few_of_it(case):
    rng, shares = np.random.default_rng(302), []
    for mechanism, (position, *_) in contract.ordinary(case, 303, more(3, 10)):
        elements = random_elements(rng, mechanism)
        equation = Equation(mechanism.with_elements(*elements))
        with mp.workdps(40):
            exact = -mp.diff(lambda x: exact_potential(mechanism, elements, x), mp.mpf(position),
                             h=mp.mpf(10)**-15)
            error = abs(float(exact - equation.terms(position).force))
        shares.append(error / float(equation.force_error(position)))
    assert 1e-4 < max(shares) <= 1.0


@contract.every_mechanism
def test_at_every_equilibrium_nothing_pushes_and_between_them_the_sign_stays(case):
    for mechanism, _ in contract.ordinary(case, 310, 4):
        equation = Equation(mechanism)
        found = equilibria(equation)
        for place in found:
            terms = equation.terms(place.position)
            step = 4.0 * EPS * max(1.0, abs(place.position))
            assert abs(terms.force) <= 1e-12 + 10.0 * step * abs(place.stiffness)
        stable = [place.is_stable for place in found]
        if mechanism.turns_fully:
            assert sum(stable) * 2 == len(stable)        # minima and maxima of V alternate
        for low, high in mechanism.input_ranges:
            inside = [place.is_stable for place in found if low <= place.position <= high]
            assert all(one != other for one, other in zip(inside, inside[1:]))


def test_two_equilibria_next_to_each_other_are_not_missed():
    """A pendulum nearly held by its torque: they are 2e-5 rad apart, a sample 3e-3."""
    weight = 2.0 * 9.81 * 0.25
    found = equilibria(Equation(pendulum()), weight * (1.0 - 5e-11))
    assert [place.is_stable for place in found] == [True, False]
    assert found[1].position - found[0].position == pytest.approx(2e-5, rel=1e-3)
    assert equilibria(Equation(pendulum()), weight * (1.0 + 1e-12)) == ()


def lamp(*lengths, stiffness):
    """Return an arm held by a spring without free length: everywhere if k = m g R/(a b)."""
    arm = Bodies(Body(2.0, cg_along=0.5, inertia=0.01), Body(0.0), Body(0.0))
    spring = Spring(Attachment('ground', 0.0, 0.1), Attachment('crank', 0.2), stiffness)
    return Equation(FourBar(*lengths, bodies=arm, gravity=(0.0, -9.81), elements=(spring,)))


def balanced(rng):
    """Return a four-bar whose links balance their weight (Berkof and Lowen), of any class."""
    while True:
        a1, a2, a3, a4 = lengths = rng.uniform(0.1, 1.0, 4).tolist()
        if 2.0 * max(lengths) < sum(lengths):
            break
    m1, m2, m3 = rng.uniform(0.5, 3.0, 3).tolist()
    share = complex(*rng.uniform(-0.5, 0.5, 2).tolist()) / a2
    centres = -m2 / m1 * a1 * (1.0 - share), a2 * share, -m2 / m3 * a3 * share
    return FourBar(a1, a2, a3, a4, gravity=(1.0, -9.81), bodies=Bodies(*[
        Body(mass, cg_along=centre.real, cg_across=centre.imag, inertia=0.1)
        for mass, centre in zip((m1, m2, m3), centres)]))


@pytest.mark.parametrize('equation', [
    lamp(0.3, 1.0, 0.9, 0.8, stiffness=490.5), lamp(0.9, 1.0, 0.8, 1.2, stiffness=490.5),
    *[Equation(balanced(np.random.default_rng(seed))) for seed in range(more(6, 40))],
    Equation(replace(pendulum(), gravity=(0.0, 0.0)))])
def test_what_is_balanced_is_in_equilibrium_everywhere(equation):
    """Its force is rounding, and was 725 positions, stable and not, with frequencies."""
    found = equilibria(equation)
    assert [(one.position, one.end) for one in found] == sorted(equation.mechanism.input_ranges)
    assert not any(one.is_stable or one.stiffness for one in found)
    start = min(found[0].position + 0.7, 0.5 * (found[0].position + found[0].end))
    system = System(equation.mechanism, start)
    with pytest.raises(InvalidParameter, match='equilibrium'):
        free_period(system)


@pytest.mark.parametrize('off', [1e-9, 1e-12])
def test_what_is_nearly_balanced_rests_at_single_positions(off):
    """The lamp with a spring that is a little too stiff stands up, and hangs unstably."""
    found = equilibria(lamp(0.3, 1.0, 0.9, 0.8, stiffness=490.5 * (1.0 + off)))
    assert [one.is_stable for one in found] == [False, True]
    for one, position in zip(found, (-0.5 * pi, 0.5 * pi)):
        assert one.position == one.end == pytest.approx(position, abs=10.0 * EPS / off)


@pytest.mark.parametrize('places, values, start, end', [
    ((-3.0, -2.0, 2.0, 3.0), (0.0, 3.0, -3.0, 0.0), 3.0, 2.0 * pi - 3.0),
    ((-pi, -1.0, 1.0, 2.0, 3.0, pi), (1.0, 0.0, 0.0, 2.0, 2.0, 1.0), -1.0, 1.0)])
def test_a_piece_without_force_is_one_equilibrium(places, values, start, end):
    """Over the seam of the turn too; the cubic leaves zero as a parabola, hidden by rounding."""
    crank = FourBar(0.4, 1.2, 0.8, 1.0,
                    bodies=Bodies(Body(0.0, inertia=1.0), Body(0.0), Body(0.0)))
    push = PositionForce(Attachment('crank'), ForceTable(places, values), direction=None)
    found = equilibria(Equation(crank.with_elements(push)))
    pieces = [one for one in found if one.end != one.position]
    assert len(pieces) == 1
    assert pieces[0].position == pytest.approx(start, abs=sqrt(100.0 * EPS))
    assert pieces[0].end == pytest.approx(end, abs=sqrt(100.0 * EPS))


@contract.every_mechanism
def test_no_equilibrium_of_a_scan_is_missing_and_none_is_added(case):
    for mechanism, _ in contract.ordinary(case, 330, more(2, 8)):
        springs = random_elements(np.random.default_rng(331), mechanism)[:2]    # without jumps
        equation = Equation(mechanism.with_elements(*springs))
        found = np.array([one.position for one in equilibria(equation)])
        scanned = 0
        for low, high in mechanism.input_ranges:
            inputs = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.linspace(0.0, pi, 20003))
            with np.errstate(all='ignore'):
                force = equation.terms(inputs[1:-1]).force
            changes = np.flatnonzero(np.diff(np.sign(force)))
            scanned += changes.size
            for i in changes + 1:
                assert np.sum((inputs[i] <= found) & (found <= inputs[i + 1])) == 1
        assert scanned == found.size


@pytest.mark.parametrize('joint', ['O1', 'B', 'drive'])
def test_viscous_friction_damps_small_swings_as_a_damper_does(joint):
    linkage = paper_linkage(gravity=(0.0, -9.81))
    viscous = DriveFriction(viscous=0.7) if joint == 'drive' else JointFriction(viscous=0.7)
    links = ('coupler', 'output') if joint == 'B' else ('ground', 'crank')
    rests = [equilibria(Equation(each)) for each in (
        linkage.with_friction({joint: viscous}),
        linkage.with_elements(TorsionSpring(*links, damping=0.7)))]
    for rubbing, damped in zip(*rests, strict=True):
        assert rubbing == pytest.approx(damped, rel=1e-9, nan_ok=True)
    assert sum(rest.damping_ratio > 0.0 for rest in rests[0]) == 1


def test_frequency_is_that_of_small_swings():
    place = equilibria(Equation(pendulum()))[0]
    assert place.position == pytest.approx(-pi / 2, rel=1e-15)
    assert place.frequency == pytest.approx(sqrt(2.0 * 9.81 * 0.25 / 0.225) / (2.0 * pi),
                                            rel=1e-14)


@some('amplitude', [0.1, 1.0, 2.0, 3.0, 3.13], (1.0, 3.13))
def test_the_period_of_a_pendulum(amplitude):
    period = free_period(System(pendulum(), -pi / 2 + amplitude))
    frequency = mp.sqrt(2.0 * 9.81 * 0.25 / mp.mpf(0.225))
    exact = 4 * mp.ellipk(mp.sin(mp.mpf(amplitude) / 2)**2) / frequency
    # its condition
    assert period == pytest.approx(float(exact), rel=1e-12 / (pi - amplitude)**2)


@contract.every_mechanism
def test_after_its_period_a_free_motion_is_where_it_began(case, count=more(4, 12)):
    """Small swings about stable equilibria within the range of the input."""
    compared = 0
    for mechanism, _ in contract.ordinary(case, 320, count):
        mechanism = replace(mechanism, external=type(mechanism.external)._make(
            [NOT_APPLIED] * len(mechanism.external)))
        for place in equilibria(Equation(mechanism)):
            if place.is_stable and (mechanism.turns_fully or all(
                    abs(mechanism.distance(place.position, end)) > 0.1 * mechanism.input_unit
                    for bounds in mechanism.input_ranges for end in bounds)):
                system = System(mechanism, place.position,
                                0.05 * place.frequency * mechanism.input_unit)
                run = simulate(system, free_period(system), 1e-9)
                assert run.status == REACHED
                assert abs(run.position[-1] - system.start[0]) <= 2e-9 * mechanism.input_unit
                compared += 1
    # a yoke at the end of its slide rests next to its toggles alone
    assert compared or contract.name_of(case).startswith('scotch_yoke-slide')


def test_what_has_no_free_motion_is_refused():
    for system in (System(pendulum(), 0.0, drive=Drive(ConstantTorque(1.0))),
                   System(FourBar(0.8, 1.2, 0.4, 1.0,
                                  bodies=Bodies(*[Body(1.0, cg_along=0.2)] * 3)), 1.0,
                          1.0)):
        with pytest.raises(InvalidParameter, match='system'):
            free_period(system)


@some('fluctuation', [0.05, 0.005], 1)
def test_a_flywheel_gives_its_fluctuation_in_simulation(fluctuation):
    linkage = paper_linkage(gravity=(0.0, -9.81))
    wheel = flywheel_for(Equation(linkage), 25.0, fluctuation)
    assert wheel.inertia > 0.0 and wheel.fluctuation == pytest.approx(fluctuation, rel=1e-9)
    drive = Drive(ConstantTorque(wheel.torque), flywheel=wheel.inertia)
    times = np.linspace(0.0, 0.75, 1501)
    run = simulate(System(linkage, 0.0, float(wheel.rate[0]), drive=drive), 0.75, 1e-9,
                   times=times)
    measured = (np.max(run.rate) - np.min(run.rate)) / 25.0
    assert run.status == REACHED and measured == pytest.approx(fluctuation, rel=1e-4)
    assert 0.5 * (np.max(run.rate) + np.min(run.rate)) == pytest.approx(25.0, rel=1e-5)


@pytest.mark.parametrize('damping, rate, most', [
    (30.0, 1.0, 0.5), (30.0, 1.0, 1.5), (30.0, -3.0, 1.9), (1e3, 10.0, 0.05)])
def test_a_flywheel_with_strong_dampers_gives_its_fluctuation_in_simulation(damping, rate, most):
    """A run of a turn comes back to its rate, and fluctuates as said, without flywheel or with."""
    linkage = paper_linkage(gravity=(0.0, -9.81)).with_elements(
        TorsionSpring('ground', 'crank', damping=damping))
    wheel = flywheel_for(Equation(linkage), rate, most)
    assert wheel.fluctuation == pytest.approx(most, rel=1e-9) or (
        wheel.inertia == 0.0 and wheel.fluctuation < most)
    run = simulate(System(linkage, 0.0, float(wheel.rate[0]), Drive(
        ConstantTorque(wheel.torque), flywheel=wheel.inertia)), 8.0 / abs(rate), 1e-9,
        stop_when=lambda t, y: abs(y[0]) - 2.0 * pi)
    rates = run.at(np.linspace(0.0, run.time[-1], 2000)).rate
    # the convergence of its samples, 1e-6 of the inertia
    assert run.status == EVENT and rates[-1] == pytest.approx(wheel.rate[0], rel=1e-5)
    assert np.ptp(rates) == pytest.approx(wheel.fluctuation * abs(rate), rel=1e-4)
    assert rates.max() + rates.min() == pytest.approx(2.0 * rate, rel=1e-5)


def test_a_speed_that_is_not_found_is_refused():
    linkage = paper_linkage(gravity=(0.0, -9.81)).with_elements(
        TorsionSpring('ground', 'crank', damping=1.0))
    with pytest.raises(InvalidParameter, match='no steady speed is found'):
        flywheel_for(Equation(linkage), 3.0, 1.99)


def test_no_flywheel_is_negative():
    wheel = flywheel_for(Equation(paper_linkage()), 25.0, 5.0)
    assert wheel.inertia == 0.0 and wheel.fluctuation < 5.0


def of_output(equation):
    """Return an equation in the other coordinate of its mechanism."""
    return Equation(equation.mechanism, coordinate=equation.mechanism.driven_otherwise()[0])


def test_loads_of_a_base_that_is_not_known_have_no_equation():
    with pytest.raises(UnknownBaseMotion):
        Equation(paper_linkage().with_base(UNKNOWN_BASE))


@pytest.mark.parametrize('call, name', [
    (lambda equation: flywheel_for(equation, 0.0, 0.1), 'rate'),
    (lambda equation: flywheel_for(equation, 1e160, 0.1), 'rate'),
    (lambda equation: flywheel_for(equation, 5e-324, 0.1), 'rate'),
    (lambda equation: flywheel_for(equation, 25.0, 0.0), 'fluctuation'),
    (lambda equation: flywheel_for(equation, 25.0, float('nan')), 'fluctuation'),
    (lambda equation: flywheel_for(equation.mechanism, 10.0, 0.05), 'equation'),
    (lambda equation: equilibria(equation.mechanism), 'equation'),
    (lambda equation: equilibria(of_output(equation)), 'equation'),
    (lambda equation: flywheel_for(of_output(equation), 10.0, 0.05), 'equation'),
    (lambda equation: equilibria(equation, float('nan')), 'drive')])
def test_what_is_wrong_is_refused_by_name(call, name):
    with pytest.raises(InvalidParameter) as caught:
        call(Equation(paper_linkage()))
    assert caught.value.name == name


@pytest.mark.parametrize('turned', [0.0, pi, 0.5 * pi, -0.5 * pi])
def test_equilibria_at_the_seam_of_a_turn_are_found_once(turned):
    """A pendulum hangs along gravity and stands against it, also where the angle is +-pi or 0."""
    bodies = Bodies(Body(2.0, cg_along=0.25, inertia=0.1), Body(0.0), Body(0.0))
    down = (9.81 * np.cos(turned), 9.81 * np.sin(turned))
    crank = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, gravity=down)
    found = equilibria(Equation(crank))
    assert [place.is_stable for place in found].count(True) == 1 and len(found) == 2
    for place in found:
        there = turned if place.is_stable else turned + pi
        assert abs(np.sin(0.5 * (place.position - there))) <= 4.0 * EPS
        assert -pi <= place.position <= pi


@pytest.mark.parametrize('free', [0.0, 1.0, -2.5, pi])
def test_the_wrap_of_a_torsion_spring_is_no_equilibrium(free):
    """The deflection jumps from pi to -pi opposite to the free angle; it rests at that alone."""
    bodies = Bodies(Body(0.0, inertia=0.3), Body(0.0), Body(0.0))
    spring = TorsionSpring('ground', 'crank', 7.0, free_angle=free)
    crank = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, elements=(spring,))
    found = equilibria(Equation(crank))
    assert len(found) == 1 and found[0].is_stable
    assert abs(np.sin(0.5 * (found[0].position - free))) <= 4.0 * EPS
    assert found[0].frequency == pytest.approx(sqrt(7.0 / 0.3) / (2.0 * pi), rel=1e-12)
