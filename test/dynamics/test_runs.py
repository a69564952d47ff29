# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A run between its times, stopped where asked, with its loads and its picture."""
from dataclasses import replace
from math import inf, nan, pi
import pickle
import sys

from fourbar_ros import Bodies, FourBar, round_rod, SliderCrank
from fourbar_ros.dynamics.run import energy_drift, EVENT, REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import (
    ConstantTorque,
    DCMotor,
    Drive,
    MotorLine,
    Shaft,
    TorqueTable,
)
from fourbar_ros.dynamics.statics import free_period
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.elements import Attachment, PositionForce, Spring, Way
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.optional import MissingPackage
from fourbar_ros.scene.scene import load
import numpy as np
import pytest
from scipy.integrate import solve_ivp

BODIES = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
LINKAGE = FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, gravity=(0.0, -9.81))
ROCKER = FourBar(0.9, 1.0, 0.8, 1.2, bodies=BODIES, gravity=(0.0, -9.81))
CUT = PositionForce(Attachment('output', 0.3), ForceTable([0.0, 0.4, 0.8], [0.0, -40.0, 5.0]),
                    Way(Attachment('output', 0.3), direction=0.5 * pi))
SPRING = Spring(Attachment('ground', 1.4, 0.3), Attachment('output', 0.3, 0.1), 900.0,
                free_length=0.4, damping=15.0)
MIDDLE = 0.5 * sum(ROCKER.input_ranges[0])
SYSTEMS = {'motor': System(LINKAGE, 0.0, 0.0, Drive(MotorLine(400.0, 26.0), rotor=0.5)),
           'forces': System(LINKAGE.with_elements(CUT, SPRING), 0.3, 12.0),
           'free': System(LINKAGE, 0.0, 9.0),
           'constant': System(LINKAGE, 0.0, 0.0, Drive(ConstantTorque(60.0))),
           'table': System(LINKAGE, 0.0, 1.0, Drive(TorqueTable([0.0, 0.1, 0.2],
                                                                [50.0, -20.0, 90.0]))),
           'toggles': System(ROCKER, MIDDLE, 2.0)}


@pytest.mark.parametrize('name', SYSTEMS)
def test_a_run_is_as_good_between_its_times_as_at_them(name):
    """Against a run at a tolerance of 1e-11 at these times: no more than the tolerance asked."""
    asked, system = 1e-7, SYSTEMS[name]
    run = simulate(system, 0.4, asked)
    times = np.linspace(0.0, 0.4, 23)
    reference = simulate(system, 0.4, 1e-11, times=times)
    assert run.status == reference.status == REACHED
    assert np.max(np.abs(run.at(times).position - reference.position)) <= asked
    mixed = run.at([[0.3, 0.1], [0.1, 0.0]])
    assert mixed.position.shape == mixed.work.shape == (2, 2)
    assert np.array_equal(mixed.rate[0, 1], mixed.rate[1, 0])
    assert (mixed.position[1, 1], mixed.rate[1, 1]) == pytest.approx(system.start[:2])
    assert isinstance(run.at(0.4).rate, float)
    assert run.at(0.4).position == pytest.approx(run.position[-1], abs=asked)
    sparse = simulate(system, 0.4, asked, times=[0.4])
    assert np.max(np.abs(sparse.at(times).position - reference.position)) <= asked


@pytest.mark.parametrize('torque', [-50.25401195101878, 12.462865188599089])
def test_the_error_between_steps_counts_as_that_at_steps(torque):
    """Where steps were good to 3e-7 and runs compared at steps alone it was 2.4e-6 for 1e-6."""
    bodies = Bodies(*(round_rod(length, 7750.0, 0.02) for length in (0.4, 1.2, 0.8)))
    system = System(FourBar(0.9, 0.8, 0.9, 0.4, bodies=bodies), 0.3, -30.0,
                    Drive(ConstantTorque(torque), flywheel=2.0))
    run, times = simulate(system, 0.3, 1e-6), np.linspace(0.0, 0.3, 601)
    exact = simulate(system, 0.3, 1e-11, times=times)
    assert np.max(np.abs(run.at(times).position - exact.position)) <= 1e-6


@pytest.mark.parametrize('name', ['motor', 'engine'])
def test_a_run_without_scipy_says_so(name, monkeypatch):
    scene = load(name)
    system = scene.dynamics.system(scene.linkage)
    monkeypatch.setitem(sys.modules, 'scipy', None)
    with pytest.raises(MissingPackage, match='simulation requires scipy'):
        simulate(system, 0.01)


@pytest.mark.parametrize('drive, has_motor, states', [
    (None, False, 0), (Drive(ConstantTorque(1.0)), True, 0),
    (Drive(DCMotor(24.0, 0.5, 0.1, 0.05), rotor=0.1, shaft=Shaft(1e4, 1.0)), True, 1)])
def test_the_state_of_a_run_is_one_record_whatever_the_system(drive, has_motor, states):
    run = simulate(System(LINKAGE, 0.0, 1.0, drive=drive), 0.01, 1e-6)
    for state in (run.at(0.01), run.at([0.01, 0.0]), run.states):
        assert state._fields == ('position', 'rate', 'motor_position', 'motor_rate', 'source',
                                 'dissipated', 'work')
        assert np.isfinite(state.motor_rate).all() == has_motor and len(state.source) == states
    state, work = run.at(0.01), run.states.work[-1]
    assert state.work == work and (work != 0.0) == (drive is not None)
    if drive and not drive.shaft:
        assert state[2:4] == state[:2]


@pytest.mark.parametrize('count, shape', [
    (100, (7,)), pytest.param(1800, (), marks=pytest.mark.slow)])
def test_early_times_are_those_asked_for(count, shape):
    """Random ones, singly and in arrays, against scipy on the same equation, at 1e-12."""
    run = simulate(System(LINKAGE, 0.0, drive=Drive(MotorLine(400.0, 26.0), flywheel=2.0)),
                   0.05, 1e-6)
    exact = solve_ivp(lambda t, y: run.system.derivative(t, y.tolist()), (0.0, 0.05),
                      run.system.start, rtol=1e-12, atol=1e-12, dense_output=True,
                      method='DOP853').sol
    for times in np.random.default_rng(1).uniform(0.0, 0.05, (count, *shape)):
        assert np.max(np.abs(run.at(times).position - exact(times)[0])) <= 1e-6


@pytest.mark.parametrize('wrong', [-0.1, 0.41, float('nan'), [0.1, 0.5], 'soon', None, []])
def test_times_that_are_not_in_the_run_are_refused(wrong):
    run = simulate(SYSTEMS['free'], 0.4, 1e-6)
    for what in (run.at, run.loads_at):
        with pytest.raises(InvalidParameter) as refused:
            what(wrong)
        assert '\n' not in str(refused.value)


@pytest.mark.parametrize('name', ['motor', 'forces', 'free', 'constant', 'table'])
def test_a_run_stops_at_an_angle(name):
    """Where scipy's own event is, of the one equation, to the tolerance over the speed."""
    system = SYSTEMS[name]
    run = simulate(system, 5.0, 1e-9, stop_when=lambda t, y: y[0] - 2.0)
    assert run.status == EVENT and run.position[-1] == pytest.approx(2.0, abs=1e-13)

    def passed(t, y):
        return y[0] - 2.0
    passed.terminal = True
    alone = solve_ivp(lambda t, y: system.derivative(t, y.tolist()), (0.0, 5.0), system.start,
                      'DOP853', events=passed, rtol=1e-11, atol=1e-11, max_step=0.01)
    assert run.time[-1] == pytest.approx(alone.t_events[0][0], abs=2e-9 / abs(run.rate[-1]))
    assert run.error <= 1e-9 and run.drift <= 1e-9
    later = simulate(system, 5.0, 1e-9, times=[4.9], stop_when=lambda t, y: y[0] - 2.0)
    assert later.status == EVENT and later.time.size == 1
    assert later.time[-1] == pytest.approx(run.time[-1], abs=2e-9 / abs(run.rate[-1]))


def test_a_swing_from_rest_stops_at_its_next_rest():
    """Half a period after the start, where it is at rest; the start itself does not count."""
    system = System(LINKAGE, -1.2)
    run = simulate(system, 10.0, 1e-10, stop_when=lambda t, y: y[1])
    assert run.status == EVENT and abs(run.rate[-1]) < 1e-9
    assert run.time[-1] == pytest.approx(0.5 * free_period(system), abs=1e-8)


def test_a_run_stops_beyond_toggles_in_numbers_of_its_input():
    middle = MIDDLE
    seen = []

    def rests(t, y):
        seen.append(len(y))
        return t - 1.1
    run = simulate(System(ROCKER, middle, 2.0), 3.0, 1e-8, stop_when=rests)
    assert run.status == EVENT and run.time[-1] == pytest.approx(1.1, abs=1e-12)
    assert len(set(run.modes.tolist())) == 2 and set(seen) == {2}
    whole = simulate(System(ROCKER, middle, 2.0), 3.0, 1e-8, times=[1.1])
    assert run.position[-1] == pytest.approx(whole.position[0], abs=2e-8)


def test_what_never_comes_ends_the_run_at_its_end():
    run = simulate(SYSTEMS['free'], 0.2, 1e-6, stop_when=lambda t, y: 1.0)
    assert run.status == REACHED and run.time[-1] == 0.2


@pytest.mark.parametrize(('stop_when', 'why'), [
    (3.0, 'must be a function'), ('angle', 'must be a function'),
    (lambda t, y: 'x', 'not a text'), (lambda t, y: None, 'None'),
    (lambda t, y: float('inf'), 'finite')])
def test_a_wrong_stop_is_refused_in_one_line(stop_when, why):
    with pytest.raises(InvalidParameter, match='stop_when') as refused:
        simulate(SYSTEMS['free'], 0.2, 1e-6, stop_when=stop_when)
    assert why in str(refused.value) and '\n' not in str(refused.value)


@pytest.mark.parametrize('name', SYSTEMS)
def test_loads_of_a_run_ask_for_the_torque_that_drove_it(name):
    """Driving torque of the loads + inertia of rotor and flywheel = torque of the drive."""
    system = SYSTEMS[name]
    run = simulate(system, 0.3, 1e-8)
    fields = type(run.loads)._fields
    assert fields == LINKAGE.LOADS._fields and run.loads.f41.shape == run.time.shape
    beside = system.equation.extra_inertia * run.acceleration
    size = 1.0 + np.abs(run.torque) + np.abs(run.loads.f41) + np.abs(run.loads.f32)
    inside = np.abs(run.loads.f41) < 1e6          # next to a toggle loads are unbounded
    error = np.abs(run.loads.driving_torque + beside - run.torque)
    assert inside.sum() > 3 and np.max((error / size)[inside]) < 1e-9
    at = run.loads_at([0.1, 0.2])
    assert at.f41.shape == (2,)
    single = run.loads_at(0.2)
    assert isinstance(single.f41, float) and single.f41 == pytest.approx(at.f41[1], rel=1e-6)


def test_a_plot_shows_all_of_a_run():
    run = simulate(SYSTEMS['motor'], 0.2, 1e-6)
    figure = run.plot()
    assert [ax.get_ylabel() for ax in figure.axes] == [
        'position [rad]', 'rate [rad/s]', 'acceleration [rad/s²]', 'drive [N m]']
    for ax, values in zip(figure.axes, (run.position, run.rate, run.acceleration, run.torque)):
        line = ax.lines[0]                # goes through the steps, and is smooth between them
        assert np.array_equal(line.get_ydata()[np.isin(line.get_xdata(), run.time)], values)
    slide = System(SliderCrank(0.3, 0.9, input='slide', bodies=BODIES), 0.8)
    assert len(simulate(slide, 0.1, 1e-6, times=[0.05, 0.1]).plot().axes) == 3


def test_an_energy_that_is_no_number_does_not_pass_for_constant():
    run = simulate(SYSTEMS['constant'], 0.1, 1e-6)
    leg = run.legs[-1]
    broken = leg._replace(states=np.where(leg.time == leg.time[-1], nan, leg.states))
    assert energy_drift(run) < 1e-6 and energy_drift(replace(run, legs=(broken,))) == inf


@pytest.mark.parametrize('times', ['ab', ['a'], [None], [0.2, 0.1], [[0.1]], [], [float('nan')],
                                   [0.1, 9.0], 3, b'x', {'a': 1}])
def test_wrong_times_of_a_run_are_errors_of_ours(times):
    with pytest.raises(FourBarError) as refused:
        simulate(SYSTEMS['free'], 0.4, 1e-6, times=times)
    assert '\n' not in str(refused.value)


@pytest.mark.parametrize('until', [1e6, 1e12, 1e300])
def test_an_end_far_away_costs_nothing_where_a_run_stops(until):
    far = simulate(SYSTEMS['forces'], until, 1e-8, stop_when=lambda t, y: y[0] - 2.0)
    near = simulate(SYSTEMS['forces'], 5.0, 1e-8, far.method, stop_when=lambda t, y: y[0] - 2.0)
    assert far.status == EVENT and far.evaluations <= 2 * near.evaluations
    assert far.time[-1] == pytest.approx(near.time[-1], abs=4e-8 / abs(near.rate[-1]))


@pytest.mark.parametrize('name', ['forces', 'motor', 'toggles'])
def test_a_run_and_its_system_are_pickled(name):
    run = simulate(SYSTEMS[name], 0.3, 1e-6)
    again = pickle.loads(pickle.dumps(run))
    assert again.status == run.status and np.array_equal(again.loads.f41, run.loads.f41)
    for field in ('time', 'position', 'rate', 'modes', 'torque', 'acceleration'):
        assert np.array_equal(getattr(again, field), getattr(run, field))
    assert again.at(0.1).rate == run.at(0.1).rate
    assert np.array_equal(simulate(again.system, 0.3, 1e-6).position, run.position)
