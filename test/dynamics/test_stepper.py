# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps of given length: accuracy, stability and work on soft and stiff shafts."""
from fourbar_ros import Bodies, FourBar, round_rod
from fourbar_ros.dynamics.elements import TorsionSpring
from fourbar_ros.dynamics.equation import Equation, InBothModes
from fourbar_ros.dynamics.node_step import AT_LIMIT, Mover, OK, OUT_OF_BUDGET
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
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.scene.scene import from_values
from fourbar_ros.scene.settings import PARAMETERS
import numpy as np
import pytest
from support.samples import some
from support.swings import Alone

RODS = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
PAPER = FourBar(0.4, 1.2, 0.8, 1.0, bodies=RODS, gravity=(0.0, -9.81))
LINE = MotorLine(400.0, 26.0)
TICK = 1e-3
DRIVES = {'rigid': Drive(LINE, 0.5), 'soft shaft': Drive(LINE, 0.5, shaft=Shaft(1e3, 10.0)),
          'dc motor': Drive(DCMotor(48.0, 0.5, 0.3, 1e-3, 10.0), 0.5, 1.0, Shaft(1e3, 10.0))}


def steps(system, until, tick=TICK, tolerance=1e-6, budget=10_000, command=None):
    """Return the states after every tick, and how each went."""
    mover = Mover(system, tolerance, budget, command is not None)
    place, went = mover.first, []
    states = [place.state]
    for _ in range(round(until / tick)):
        done = mover.advance(place, tick, command or 0.0)
        place = done.at
        states.append(place.state)
        went.append(done)
    return np.array(states).T, went


@pytest.mark.parametrize('drive', DRIVES.values(), ids=DRIVES)
def test_the_order_is_four_at_least(drive):
    system = System(PAPER, 0.0, drive=drive)
    reference = simulate(system, 0.5, 1e-11, times=[0.5])
    errors = []
    for tick in (4e-3, 2e-3, 1e-3):
        states, went = steps(system, 0.5, tick, tolerance=1e9)
        assert all(done.evaluations == 7 for done in went)
        errors.append(abs(states[0, -1] - reference.position[-1]))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[-1] > 3.7 and errors[-1] < 1e-5, (errors, orders)


@some('stiffness', [10.0**k for k in range(2, 10)], (1e9,))
def test_stiff_shafts_against_scipy(stiffness):
    damping = 100.0 if stiffness > 1e4 else 1e-3 * stiffness
    system = System(PAPER, 0.0, drive=Drive(LINE, 0.5, shaft=Shaft(stiffness, damping)))
    reference = simulate(system, 0.3, 1e-7, times=[0.1, 0.2, 0.3])
    assert reference.status == 'reached the end'
    states, went = steps(system, 0.3)
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
    states, went = steps(system, 5.0)
    reference = simulate(rigid, 5.0, 1e-8, times=[5.0])
    assert {done.status for done in went} == {OK}
    assert abs(states[0, -1] - reference.position[-1]) < 1e-3
    assert max(done.evaluations for done in went) < 1000


def test_a_free_motion_and_its_energy():
    system = System(PAPER, 0.5, 3.0)
    times = np.arange(0.0, 3.0, TICK)
    states, went = steps(system, 3.0 - TICK, tolerance=1e-9)
    assert np.abs(states[0] - simulate(system, 3.0, 1e-9).at(times)[0]).max() < 1e-6
    energy = system.equation.energy(states[0], states[1])
    assert np.ptp(energy) < 1e-6 * (np.abs(energy).max() + 1.0)


def test_work_is_counted_and_never_more_than_the_budget(monkeypatch):
    monkeypatch.setattr(Equation, 'changes_mode', True)      # the formula itself, with calls
    system = System(PAPER, 0.0, drive=Drive(LINE, 0.5, shaft=Shaft(1e5, 0.0)))
    calls, terms_of = 0, InBothModes.of_one

    def counted(*given):
        nonlocal calls
        calls += 1
        return terms_of(*given)

    monkeypatch.setattr(InBothModes, 'of_one', counted)
    for budget in (12, 20, 60):
        mover = Mover(system, 1e-11, budget)
        place, statuses = mover.first, set()
        for _ in range(200):
            calls = 0
            done = mover.advance(place, TICK)
            # the state at the end counts in the next step, unless nothing is left of this one
            assert done.evaluations <= calls <= done.evaluations + 1 <= budget + 1
            place = done.at
            statuses.add(done.status)
        state = place.state
        assert OUT_OF_BUDGET in statuses and np.isfinite(state).all()
        reference = simulate(system, 0.2, 1e-6, times=[0.2]).position[-1]
        # less accurate, and still a motion of this linkage: within a percent of the way
        assert abs(state[0] - reference) < 0.05 * reference


CONTROLLED = Drive(SpeedController(5.0, 50.0, 10.0, 200.0), 0.5, shaft=Shaft(1e5, 10.0))


@pytest.mark.parametrize('drive', [*DRIVES.values(), CONTROLLED], ids=[*DRIVES, 'controller'])
def test_the_function_without_calls_has_the_bits_of_the_formula(drive, monkeypatch):
    system = System(PAPER, 0.0, drive=drive)
    quick, _ = steps(system, 0.3, budget=25)
    monkeypatch.setattr(Equation, 'changes_mode', True)
    plain, _ = steps(system, 0.3, budget=25)
    assert quick.tobytes() == plain.tobytes()


def test_terms_that_are_known_are_not_computed_again():
    system, asked = System(PAPER, 0.5, drive=DRIVES['soft shaft']), []
    mover = Mover(system, 1e-6, 60)
    formulas, = mover.formulas.values()
    place_of = formulas.place
    formulas.place = lambda *given: asked.append(given[0]) or place_of(*given)
    place = mover.advance(mover.first, TICK).at
    mover.values(place, TICK, 0.0, 0)
    mover.advance(place, TICK)
    assert asked.count(place.state[0]) == 1
    again = Mover(system, 1e-6, 60)        # which knows nothing
    assert again.advance(place, TICK) == mover.advance(place, TICK)


@pytest.mark.parametrize('gain', [1e1, 1e3, 1e6])
def test_a_limited_controller_settles_whatever_its_gain(gain):
    drive = Drive(SpeedController(25.0, gain, 5.0 * gain, 400.0), 0.5, 2.0)
    system = System(PAPER, 0.0, drive=drive)
    states, went = steps(system, 1.0, budget=60)
    assert all(done.evaluations <= 60 for done in went)
    assert np.abs(states[1, -100:] - 25.0).max() < (0.6 if gain > 50.0 else 8.0)
    mover = Mover(system, 1e-6, 60)
    torques = np.array([mover.values(mover.at(tuple(state)), TICK, 0.0, 0).motor_torque
                        for state in states.T])
    assert np.abs(torques).max() <= 400.0 and bool(torques[1] == 400.0) is (gain > 16.0)
    if gain == 1e3:
        reference = simulate(system, 1.0, 1e-6, times=[0.5, 1.0], check=False)
        assert np.abs(states[0, [500, 1000]] - reference.position).max() < 1e-3


def test_a_torque_from_outside_is_that_of_the_source():
    held = System(PAPER, 0.0, drive=Drive(ConstantTorque(-30.0), 0.5))
    free = System(PAPER, 0.0, drive=Drive(ConstantTorque(0.0), 0.5))
    assert np.array_equal(steps(held, 0.1)[0], steps(free, 0.1, command=-30.0)[0])


def test_at_a_limit_the_input_is_held_at_rest_and_leaves_it_when_pulled_back():
    rocker = Alone(1.2, 0.4, 0.8, 1.0, bodies=Bodies(*(round_rod(a, 7750.0, 0.01)
                                                       for a in (1.2, 0.4, 0.8))))
    (low, high), *_ = rocker.input_ranges
    system = System(rocker, 0.5 * (low + high), drive=Drive(ConstantTorque(0.0)))
    states, went = steps(system, 1.0, command=200.0)
    assert went[-1].status == AT_LIMIT and states[1, -1] == 0.0 and low < states[0, -1] < high
    mover, place = Mover(system, 1e-6, 60, True), went[-1].at
    for _ in range(20):
        done = mover.advance(place, TICK, -200.0)
        place = done.at
    assert done.status == OK and place.state[1] < 0.0


def test_a_torsion_spring_swings_as_the_textbook_says():
    """A crank alone, massless otherwise: J = m l^2 / 3, w = sqrt(k / J)."""
    rods = Bodies(round_rod(0.4, 7750.0, 0.01), *(round_rod(a, 1e-12, 0.01) for a in (1.2, 0.8)))
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods)
    system = System(linkage, 0.3, 0.0, [TorsionSpring('ground', 'crank', 20.0)])
    inertia = rods.crank.inertia + rods.crank.mass * 0.2**2
    speed = (20.0 / inertia)**0.5
    states, _ = steps(system, 0.2, tolerance=1e-10)
    times = TICK * np.arange(201)
    assert np.abs(states[0] - 0.3 * np.cos(speed * times)).max() < 1e-7


OTHERS = {'slider_crank': {'a1': 0.1, 'a2': 0.3, 'offset': 0.02},
          'inverted_slider': {'a1': 0.1, 'a4': 0.3},
          'scotch_yoke': {'a1': 0.1}}


@some('kind', OTHERS, 1)
def test_other_kinds_in_a_scene_against_scipy(kind):
    lengths = {f'linkage.{name}': value for name, value in OTHERS[kind].items()
               if f'linkage.{name}' in PARAMETERS}
    bodies = {f'bodies.{link.name}.{field}': value for link in FACTS[kind].links
              for field, value in (('mass', 0.8), *((('inertia', 0.01),) * bool(link.turns)))}
    along = {f'bodies.{link.name}.cg_along': 0.05 for link in FACTS[kind].links}
    there = from_values({'linkage.kind': kind, **lengths, **bodies, **along, 'gravity.y': -9.81,
                         'drive.source': 'motor', 'motor.stall_torque': 6.0,
                         'motor.free_speed': 20.0, 'motor.rotor_inertia': 0.02,
                         'shaft.stiffness': 1e6, 'shaft.damping': 1.0, 'outputs': ['state']})
    system = there.dynamics.system(there.bare_linkage)
    reference = simulate(system, 0.3, 1e-8, times=[0.1, 0.2, 0.3])
    states, went = steps(system, 0.3)
    assert {done.status for done in went} == {OK}
    assert np.abs(states[0, [100, 200, 300]] - reference.position).max() < 1e-4
    assert abs(reference.position[-1]) > 0.5
