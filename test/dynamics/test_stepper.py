# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps of given length: accuracy, stability and work on soft and stiff shafts."""
from fourbar_ros import Bodies, FourBar, round_rod
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.node_step import AT_LIMIT, Mover, OK, OUT_OF_BUDGET
from fourbar_ros.dynamics.rosenbrock import StateVector
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import (
    ConstantTorque,
    DCMotor,
    Drive,
    MotorLine,
    Shaft,
    SpeedController,
)
from fourbar_ros.dynamics.system import System
from fourbar_ros.numerics.number_types import REAL
import numpy as np
import pytest
from support.dynamics_problems import steps
from support.samples import some
from support.swings import Alone

RODS = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
PAPER = FourBar(0.4, 1.2, 0.8, 1.0, bodies=RODS, gravity=(0.0, -9.81))
LINE = MotorLine(400.0, 26.0)
TICK = 1e-3
DRIVES = {'rigid': Drive(LINE, 0.5), 'soft shaft': Drive(LINE, 0.5, shaft=Shaft(1e3, 10.0)),
          'dc motor': Drive(DCMotor(48.0, 0.5, 0.3, 1e-3, 10.0), 0.5, 1.0, Shaft(1e3, 10.0))}


def by_formulas(mover):
    """Return a mover that calls its formulas themselves, not the functions written from them."""
    for formulas in mover.formulas.values():
        formulas.linearize, formulas.attempt, formulas.euler = (make(REAL) for make in (
            formulas.make_linearization, formulas.make_attempt, formulas.make_euler))
    return mover


def states_of(system, until, tick=TICK, tolerance=1e-6, budget=10_000, command=None,
              taken=lambda mover: mover):
    """Return the states after every tick, and how each step went."""
    mover = taken(Mover(system, tolerance, budget, command is not None))
    went = steps(mover, round(until / tick), tick, command or 0.0)
    return np.array([mover.first.vector, *(done.state.vector for done in went)]).T, went


@some('stiffness', [10.0**k for k in range(2, 10)], (1e9,))
def test_stiff_shafts_against_scipy(stiffness):
    damping = 100.0 if stiffness > 1e4 else 1e-3 * stiffness
    system = System(PAPER, 0.0, drive=Drive(LINE, 0.5, shaft=Shaft(stiffness, damping)))
    reference = simulate(system, 0.3, 1e-7, times=[0.1, 0.2, 0.3])
    assert reference.status == 'reached the end'
    states, went = states_of(system, 0.3)
    assert {done.status for done in went} == {OK}
    error = np.abs(states[0, [100, 200, 300]] - reference.position)
    # three hundred steps of 1e-6 would be 3e-4, if all erred to one side; they do not
    assert error.max() < 1e-5
    # a torque of 400 N m twists a stiff shaft by no more than twice T / k
    assert np.abs(states[2]).max() < 2.5 * 400.0 / stiffness
    assert np.median([done.evaluations for done in went]) == 7


def test_an_undamped_stiff_shaft_stays_stable_for_long():
    system = System(PAPER, 0.0, drive=Drive(LINE, 0.5, shaft=Shaft(1e9, 0.0)))
    rigid = System(PAPER, 0.0, drive=Drive(LINE, 0.5))
    states, went = states_of(system, 5.0)
    reference = simulate(rigid, 5.0, 1e-8, times=[5.0])
    assert {done.status for done in went} == {OK}
    assert abs(states[0, -1] - reference.position[-1]) < 1e-3
    assert max(done.evaluations for done in went) < 1000


def test_work_is_counted_and_never_more_than_the_budget(monkeypatch):
    calls, make = 0, Equation.make_terms

    def make_counted(*given):
        terms_at = make(*given)

        def counted(position):
            nonlocal calls
            calls += 1
            return terms_at(position)
        return counted

    monkeypatch.setattr(Equation, 'make_terms', make_counted)
    system = System(PAPER, 0.0, drive=Drive(LINE, 0.5, shaft=Shaft(1e5, 0.0)))
    for budget in (12, 20, 60):
        mover = by_formulas(Mover(system, 1e-11, budget))
        state, statuses = mover.first, set()
        for _ in range(200):
            calls = 0
            done = mover.advance(state, TICK)
            # the state at the end counts in the next step, unless nothing is left of this one
            assert done.evaluations <= calls <= done.evaluations + 1 <= budget + 1
            state = done.state
            statuses.add(done.status)
        vector = state.vector
        assert OUT_OF_BUDGET in statuses and np.isfinite(vector).all()
        reference = simulate(system, 0.2, 1e-6, times=[0.2]).position[-1]
        # less accurate, and still a motion of this linkage: within a percent of the way
        assert abs(vector.position - reference) < 0.05 * reference


CONTROLLED = Drive(SpeedController(5.0, 50.0, 10.0, 200.0), 0.5, shaft=Shaft(1e5, 10.0))


@pytest.mark.parametrize('drive', [*DRIVES.values(), CONTROLLED], ids=[*DRIVES, 'controller'])
def test_the_function_without_calls_has_the_bits_of_the_formula(drive):
    system = System(PAPER, 0.0, drive=drive)
    quick, _ = states_of(system, 0.3, budget=25)
    plain, _ = states_of(system, 0.3, budget=25, taken=by_formulas)
    assert quick.tobytes() == plain.tobytes()


def test_terms_that_are_known_are_not_computed_again():
    system, asked = System(PAPER, 0.5, drive=DRIVES['soft shaft']), []
    mover = Mover(system, 1e-6, 60)
    formulas, = mover.formulas.values()
    linearize = formulas.linearize
    formulas.linearize = lambda *numbers: asked.append(numbers[0]) or linearize(*numbers)
    state = mover.advance(mover.first, TICK).state
    mover.values(state, TICK, 0.0, 0)
    mover.advance(state, TICK)
    assert asked.count(state.vector.position) == 1
    again = Mover(system, 1e-6, 60)        # which knows nothing
    assert again.advance(state, TICK) == mover.advance(state, TICK)


@pytest.mark.parametrize('gain', [1e1, 1e3, 1e6])
def test_a_limited_controller_settles_whatever_its_gain(gain):
    drive = Drive(SpeedController(25.0, gain, 5.0 * gain, 400.0), 0.5, 2.0)
    system = System(PAPER, 0.0, drive=drive)
    states, went = states_of(system, 1.0, budget=60)
    assert all(done.evaluations <= 60 for done in went)
    assert np.abs(states[1, -100:] - 25.0).max() < (0.6 if gain > 50.0 else 8.0)
    mover = Mover(system, 1e-6, 60)
    torques = np.array([mover.values(mover.state_at(StateVector(*vector)), TICK, 0.0,
                                     0).motor_torque for vector in states.T])
    assert np.abs(torques).max() <= 400.0 and bool(torques[1] == 400.0) is (gain > 16.0)
    if gain == 1e3:
        reference = simulate(system, 1.0, 1e-6, times=[0.5, 1.0], check=False)
        assert np.abs(states[0, [500, 1000]] - reference.position).max() < 1e-3


def test_a_torque_from_outside_is_that_of_the_source():
    held = System(PAPER, 0.0, drive=Drive(ConstantTorque(-30.0), 0.5))
    free = System(PAPER, 0.0, drive=Drive(ConstantTorque(0.0), 0.5))
    assert np.array_equal(states_of(held, 0.1)[0], states_of(free, 0.1, command=-30.0)[0])


def test_at_a_limit_the_input_is_held_at_rest_and_leaves_it_when_pulled_back():
    rocker = Alone(1.2, 0.4, 0.8, 1.0, bodies=Bodies(*(round_rod(a, 7750.0, 0.01)
                                                       for a in (1.2, 0.4, 0.8))))
    (low, high), *_ = rocker.input_ranges
    system = System(rocker, 0.5 * (low + high), drive=Drive(ConstantTorque(0.0)))
    states, went = states_of(system, 1.0, command=200.0)
    assert went[-1].status == AT_LIMIT and states[1, -1] == 0.0 and low < states[0, -1] < high
    mover, state = Mover(system, 1e-6, 60, True), went[-1].state
    for _ in range(20):
        done = mover.advance(state, TICK, -200.0)
        state = done.state
    assert done.status == OK and state.vector.rate < 0.0
