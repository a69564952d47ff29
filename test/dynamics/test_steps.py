# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps of given length through toggles: accuracy, energy, modes, work, what messages tell."""
from types import SimpleNamespace

from fourbar_ros import FourBar, SliderCrank
from fourbar_ros.dynamics import rosenbrock
from fourbar_ros.dynamics.equation import Terms
from fourbar_ros.dynamics.node_step import (
    AT_LIMIT,
    DriveValues,
    modes_of,
    Mover,
    OK,
    OUT_OF_BUDGET,
)
from fourbar_ros.dynamics.rosenbrock import (
    Coefficients,
    StateVector,
    StepFormulas,
    StepStart,
)
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import (
    ConstantTorque,
    DCMotor,
    Drive,
    MotorLine,
    Piece,
    Shaft,
    SpeedController,
)
from fourbar_ros.dynamics.system import System
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.dynamics_problems import steps
from support.samples import some
from support.scenes import PAPER, RODS
from support.swings import Alone, BODIES, CASES

SWINGS = [name for name in CASES if name not in ('non-Grashof, other class',
                                                 'inverted, with limits')]
TICK = 1e-3
DRIVES = {
    'torque': Drive(ConstantTorque(5.0), 0.02, 0.05),
    'dc motor': Drive(DCMotor(48.0, 0.5, 0.3, 1e-3, 10.0), 0.5),
    'shaft': Drive(MotorLine(30.0, 40.0), 0.2, 0.05, Shaft(50.0, 5.0)),
    'dc motor and shaft': Drive(DCMotor(48.0, 0.5, 0.3, 0.1, 10.0), 0.5, 0.1, Shaft(50.0, 5.0))}


def swing(system, until, tick=TICK, tolerance=1e-6, budget=10_000):
    """Return (states of the input, modes, energies, how each step went) after every tick."""
    mover = Mover(system, tolerance, budget)
    went = steps(mover, round(until / tick), tick)
    states = [done.state for done in went]
    energies = [state.coordinate.equation.energy(*state.vector[:2]) for state in states]
    return (np.array(list(map(mover.in_input, states))).T,
            [state.mode for state in states], np.array(energies), went)


@some('name', SWINGS, 2)
def test_a_released_linkage_swings_through_its_limits_as_simulate_says(name, monkeypatch):
    """Steps of one length, of order 4: those of half the length err by 1/15 of what changes."""
    monkeypatch.setattr(rosenbrock, 'DIFFERENCE', 1e-8)     # its error is below that of steps
    mechanism, position, rate = CASES[name]
    system, until, unit = System(mechanism, position, rate), 3.0, mechanism.input_unit
    times = TICK * np.arange(1, 3001)
    run = simulate(system, until, 1e-9, times=times)
    assert np.count_nonzero(np.diff(run.modes)) >= 4 and set(run.modes.tolist()) == {1, 2}
    whole, modes, energies, went = swing(system, until, tolerance=1e9)
    half, modes_of_half, less, _ = swing(system, until, 0.5 * TICK, tolerance=1e9)
    assert {done.status for done in went} == {OK}
    changes = np.abs(whole[0] - half[0, 1::2]).max()
    # order 3 is granted, and 1e-8 to the difference and to the reference
    assert np.abs(half[0, 1::2] - run.position).max() <= changes / 7.0 + 1e-8 * unit
    assert np.abs(whole[0] - run.position).max() <= changes * 8.0 / 7.0 + 1e-8 * unit
    assert modes == modes_of_half[1::2] == run.modes.tolist()
    drift, drift_of_half = np.ptp(energies), np.ptp(less)
    kinetic = np.ptp(energies) + 0.5 * rate**2 * float(system.equation.terms(position).inertia)
    assert drift_of_half <= drift / 7.0 + 1e-8 * kinetic and drift <= 1e-5 * kinetic


@pytest.mark.parametrize('drive', DRIVES)
@some('name', ['rocker of a crank-rocker', 'driven slider'], 1)
def test_the_order_is_four_through_toggles_with_every_drive(name, drive, monkeypatch):
    monkeypatch.setattr(rosenbrock, 'DIFFERENCE', 1e-8)     # its error is below that of steps
    mechanism, position, rate = CASES[name]
    system = System(mechanism, position, rate, drive=DRIVES[drive])
    times = 0.1 * np.arange(1, 9)
    run = simulate(system, 0.8, 1e-12, times=times, check=False)
    assert len(set(run.modes.tolist())) == 2
    errors = []
    for tick in (4e-3, 2e-3, 1e-3):
        states, *_ = swing(system, 0.8, tick, tolerance=1e9)
        errors.append(np.abs(states[0, round(0.1 / tick) - 1::round(0.1 / tick)]
                             - run.position).max())
    assert np.log2(errors[0] / errors[2]) > 2 * 3.0 and errors[2] < 1e-7, errors


@pytest.mark.parametrize('shaft', [None, Shaft(70.0, 3.0)])
def test_the_linear_system_is_that_of_the_derivatives(shaft):
    """(g - d(dx/dt)/dx) y = b, with terms that vary with p, by differences of the derivatives."""
    rng = np.random.default_rng(5)
    piece = Piece(*rng.normal(size=6))
    drive = Drive(DCMotor(48.0, 0.5, 0.3, 1e-3, 10.0), 0.4, shaft=shaft)
    system = System(*CASES['driven slider'], drive=drive)
    formulas = StepFormulas(system.coordinates.first, drive, True, 1e-6)

    def terms_at(p):
        return Terms(2.0 + p * p, p, 3.0 - p + 0.4 * p * p, 0.5 + 0.1 * p, 0.0,
                     ratio=0.3 + 0.7 * p - 0.2 * p * p, ratio_slope=0.7 - 0.4 * p)

    formulas._source = SimpleNamespace(piece=lambda *_: piece)
    resists = formulas._equation.make_resistance(REAL)      # none
    x = np.array([0.4, 1.3, 0.2, -0.8, 0.6])

    def rates(x):
        at = formulas._rates(REAL, terms_at(x[0]), resists, StateVector(*x), 0.0)
        return np.array(at.change)

    step = 1e-5
    jacobian = np.array([(rates(x + step * e) - rates(x - step * e)) / (2.0 * step)
                         for e in np.eye(5)]).T
    right = rng.normal(size=5)
    if shaft is None:
        right[2:4] = 0.0
    terms = terms_at(x[0])
    start = StepStart(StateVector(*x), 1.0, 0.0, StateVector(*rates(x)), Coefficients(
        terms.inertia, terms.half_slope, terms.damping, terms.ratio, terms.ratio_slope,
        piece.by_speed, piece.by_state, piece.change_by_speed, piece.change_by_state), ())
    solve = formulas._solver(REAL, start, 3.0, terms_at, resists)
    solution = solve(StateVector(*right))
    assert (3.0 * np.eye(5) - jacobian) @ solution == pytest.approx(right, abs=1e-6)


@some('budget', [12, 20, 60], (20,))
@pytest.mark.parametrize('tick', [0.01, 0.03])
def test_the_work_of_a_step_is_bounded_through_toggles(budget, tick):
    """Long steps of little work: inaccurate, as their status says, and never out of range."""
    for name in SWINGS:
        mechanism, position, rate = CASES[name]
        low, high = next(ends for ends in mechanism.input_ranges if ends[0] < position < ends[1])
        states, modes, _, went = swing(System(mechanism, position, rate), 3.0, tick, 1e-9, budget)
        assert max(done.evaluations for done in went) <= budget
        assert {done.status for done in went} <= {OK, OUT_OF_BUDGET} and np.isfinite(states).all()
        assert states[0].min() >= low - 1e-12 and states[0].max() <= high + 1e-12
        assert set(modes) == {1, 2}, name


ROCKER = {**PAPER, **RODS, 'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.source': 'torque',
          'gravity.y': -9.81, 'drive.start': -0.5, 'outputs': ['state']}


def moved(mover, commands):
    """Return (status, mode, values) step by step."""
    values, mode, found = mover.start(), mover.mode, []
    for command in commands:
        status, values = mover.next(values, TICK, command, mode=mode)
        mode = mover.mode
        found.append((status, mode, values))
    return found


def test_messages_tell_the_state_except_next_to_a_toggle():
    """What another mover does from a message is what this one does, where it says so."""
    mover, other = from_values(ROCKER).mover, from_values(ROCKER).mover
    commands = [20.0 * np.sin(0.01 * i) for i in range(1500)]
    found, told = moved(mover, commands), []
    for (_, mode, values), command, (status, mode_then, then) in zip(found, commands[1:],
                                                                     found[1:]):
        copy = DriveValues(*values)
        told.append(other.is_told_by_message(other.state_of(copy, mode)))
        again = other.next(copy, TICK, command, mode=mode)
        if told[-1]:
            assert (again[0], other.mode, repr(again[1])) == (status, mode_then, repr(then))
        else:
            assert again[1].position == pytest.approx(then.position, abs=1e-9)
    modes = [mode for _, mode, _ in found]
    assert 0.5 < np.mean(told) < 0.95 and set(modes) == {1, 2}
    # no message at a toggle itself tells the state
    assert not any(told[i] for i in np.flatnonzero(np.diff(modes[:-1])))


def test_a_controller_and_its_limit_through_toggles():
    """Kinks of the source are found in the other coordinate too, by the speed of the input."""
    mechanism, position, rate = CASES['rocker of a crank-rocker']
    drive = Drive(SpeedController(6.0, 3.0, 0.0, 9.0), 0.02, 0.05)
    system = System(mechanism, position, rate, drive=drive)
    run = simulate(system, 1.5, 1e-7, times=TICK * np.arange(1, 1501))
    states, modes, _, went = swing(system, 1.5, tolerance=1e-8)
    torque = np.clip(3.0 * (6.0 - states[1]), -9.0, 9.0)
    assert (np.abs(torque) == 9.0).any() and (np.abs(torque) < 9.0).any()
    assert {done.status for done in went} == {OK} and len(set(modes)) == 2
    assert np.abs(states[0] - run.position).max() < 1e-4


def test_the_end_of_a_stroke_is_a_limit_and_toggles_are_not():
    slider = SliderCrank(0.5, 1.3, 0.1, input='slide', bodies=BODIES, gravity=(0.3, -9.81))
    low = slider.input_ranges[-1][0]
    with_stop = SliderCrank(0.5, 1.3, 0.1, input='slide', bodies=BODIES, gravity=(0.3, -9.81),
                            stroke=(low - 0.2, 1.5))
    states, modes, _, went = swing(System(with_stop, 1.2, -3.0), 2.0)
    at = [done.status for done in went].index(AT_LIMIT)
    assert 1.4 < states[0, at] < 1.5 and states[1, at] == 0.0
    assert len(set(modes[:at])) == 2 and min(states[0, :at]) < low + 0.01


def test_a_crank_that_turns_fully_is_held_at_the_end_of_its_range_and_comes_back():
    crank = FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, gravity=(9.81, 0.0), stroke=(-0.5, 0.85))
    assert not System(crank, 0.3).mechanism.cut and modes_of(crank) == ()
    mover = Mover(System(crank, 0.3), 1e-6, 10_000, takes_commands=True)
    values, statuses = mover.start(), []
    for command in (40.0,) * 200 + (-40.0,) * 5:
        status, values = mover.next(values, TICK, command)
        statuses.append(status)
        assert -0.5 < values.position < 0.85
    assert statuses[199] == AT_LIMIT and statuses[-1] == OK and values.velocity < 0.0


def test_steps_go_through_toggles_where_two_modes_and_another_coordinate_are():
    crank, rocker = (from_values({**ROCKER, **lengths}).linkage for lengths in (PAPER, {}))
    assert (modes_of(crank), modes_of(rocker)) == ((), (1, 2))
    assert modes_of(Alone(0.8, 1.2, 0.4, 1.0, bodies=BODIES)) == ()
    assert modes_of(FourBar(0.5, 1.0, 0.5, 1.0, bodies=BODIES)) == ()
    assert modes_of(FourBar(5.0, 1.0, 2.0, 4.0, bodies=BODIES)) == (1, 2)


def test_a_message_has_the_motor_before_its_shaft_and_says_when_the_budget_is_used_up():
    system = System(*CASES['non-Grashof'], drive=DRIVES['shaft'])
    mover = Mover(system, 1e-6, 10_000)
    status, values = mover.next(mover.start(), TICK)
    assert status == OK and values.twist != 0.0
    assert values.motor_position == values.position + values.twist
    shaft = system.drive.shaft                   # what it carries to the input
    assert values.torque == pytest.approx(
        shaft.stiffness * values.twist
        + shaft.damping * (values.motor_velocity - values.velocity), rel=1e-12)
    short = Mover(system, 1e-14, 12)
    status, values = short.next(short.start(), 0.05)
    assert status == OUT_OF_BUDGET and 0.0 < values.evaluations <= 12.0
