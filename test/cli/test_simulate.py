# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar simulate``: what it says of a run, and what it refuses in one line."""
import json
from math import nan, pi, radians

from fourbar_ros.cli.main import main
from fourbar_ros.dynamics.flywheel import flywheel_for
from fourbar_ros.dynamics.sources import ConstantTorque
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import find
from fourbar_ros.scene.simulated import simulate_scene
import numpy as np
import pytest
from support.dynamics_problems import P2_POSITION
from support.scenes import PAPER, RODS

FREE = {**PAPER, **RODS, 'drive.source': 'torque', 'drive.rate': 200.0, 'outputs': ['state']}


def test_the_summary_of_a_motor(capsys):
    assert main(['simulate', 'motor', '--until', '0.2', '--tolerance', '1e-7']) == 0
    said = capsys.readouterr().out
    assert '201 samples' in said and 'reached the end: ' in said and '1e-07' in said
    assert 'energy constant within' in said and 'shaking_force' in said


def test_a_machine_is_simulated_with_its_loads(capsys):
    assert main(['simulate', 'door_closer', '--until', '6', '--tolerance', '1e-7']) == 0
    said = capsys.readouterr().out
    assert 'reached the end: ' in said and 'arms_first' in said
    end = float(said.partition('the input is at ')[2].split()[0])
    assert 0.0 < end < 0.1 * 1.5            # the door closes, and damped so much does not swing


def test_an_existing_bag_is_refused_before_the_work(tmp_path, capsys):
    assert main(['simulate', 'motor', '--until', '1e6', '-o', str(tmp_path)]) == 1
    assert 'exists already' in capsys.readouterr().err


def test_a_run_that_ends_at_a_limit_says_so_and_is_not_good(tmp_path, capsys):
    file = tmp_path / 'cylinder.yaml'
    file.write_text("""/**:
  ros__parameters:
    linkage: {kind: slider_crank, input: slide, a1: 0.1, a2: 0.3, mode: 2, range: [0.25, 0.35]}
    bodies:
      crank: {mass: 1.0, inertia: 0.01}
      coupler: {mass: 1.0, inertia: 0.01}
      output: {mass: 2.0}
    drive: {source: torque, start: 0.3, rate: 200.0}
    outputs: [state]
""")
    assert main(['simulate', str(file), '--until', '5', '--torque', '10']) == 3
    said = capsys.readouterr().out
    assert 'reached a limit of the input' in said and 'at 0.35 m' in said


def test_peaks_are_those_of_the_motion_at_the_samples():
    found = simulate_scene(scene.from_values({**FREE, 'outputs': ['loads']}), 1.0, torque=20.0)
    run, peaks = found.run, {peak.name: peak for peak in found.peaks()}
    linkage = scene.from_values(FREE).linkage
    loads = [linkage.step(*sample)[1] for sample in zip(run.position, run.rate,
                                                        run.acceleration)]
    largest = max(load.shaking_force for load in loads)
    assert peaks['shaking_force'].high == pytest.approx(largest, rel=1e-12)
    at = run.time[np.argmax([load.shaking_force for load in loads])]
    assert peaks['shaking_force'].high_at == at
    assert peaks['torque on the input'][2:6:2] == (20.0, 20.0)
    # all that the torque gives is in the motion: it is the driving torque of the loads
    assert [load.driving_torque for load in loads] == pytest.approx([20.0] * len(loads), abs=1e-9)


def test_the_ripple_is_that_for_which_a_flywheel_was_chosen():
    linkage = scene.from_values(FREE).linkage
    system = scene.from_values(FREE).dynamics.system(linkage)
    wheel = flywheel_for(system.equation, 25.0, 0.05)
    values = {**FREE, 'flywheel.inertia': wheel.inertia, 'drive.rate': 2000.0,
              'drive.start_speed': float(wheel.rate[0])}
    found = simulate_scene(scene.from_values(values), 2.5 * 2.0 * pi / 25.0, 1e-8,
                           torque=wheel.torque)
    low, high = found.speeds_of_last_turn()
    assert 2.0 * (high - low) / (low + high) == pytest.approx(0.05, rel=1e-3)
    assert 0.5 * (low + high) == pytest.approx(25.0, rel=1e-4)


def test_states_are_those_that_the_node_steps_through():
    values = {**FREE, 'drive.source': 'motor', 'motor.kind': 'dc', 'motor.voltage': 48.0,
              'motor.resistance': 0.5, 'motor.torque_constant': 0.3, 'motor.inductance': 1e-3,
              'motor.gear': 10.0, 'motor.rotor_inertia': 0.005, 'shaft.stiffness': 1e4,
              'shaft.damping': 10.0, 'drive.rate': 1000.0, 'drive.budget': 10000}
    there = scene.from_values(values)
    found = list(simulate_scene(there, 0.1, 1e-9).drive_values())
    mover = there.mover
    now = mover.start()
    for values in found[1:]:
        _, now = mover.next(now, values.step)
    assert found[0].step == 0.0 and len(found) == 101
    for name in ('position', 'velocity', 'twist', 'motor_velocity', 'current', 'torque'):
        assert getattr(now, name) == pytest.approx(getattr(found[-1], name), rel=2e-4, abs=1e-5)


def test_a_torque_needs_the_topic_as_its_source():
    with pytest.raises(InvalidParameter):
        simulate_scene(scene.from_values({**PAPER, **RODS}), 1.0)
    run = simulate_scene(scene.from_values(FREE), 0.1, torque=nan).run
    assert run.system.drive.source == ConstantTorque(0.0) and not run.rate.any()


def test_show_gives_loads_with_springs(capsys):
    """The drive of the pose is that of the equation of motion."""
    assert main(['show', 'released', '--at', '20', '--speed', '1', '--json']) == 0
    said, there = json.loads(capsys.readouterr().out), scene.load('released')
    assert there.linkage.elements and said['why_no_loads'] == ''
    equation = there.dynamics.system(there.linkage).equation
    assert said['pose']['loads']['driving_torque'] == pytest.approx(
        equation.torque(radians(20.0), 1.0, 0.0), rel=1e-11)
    assert 'shaking_force' in {one['quantity'] for one in said['extrema']}


def test_the_scene_of_sundials_ends_where_twenty_digits_say(capsys):
    """P2, read from its file: springs, dampers, external forces and the start reach the run."""
    found = simulate_scene(scene.load('sundials'), 10.0, 1e-10)
    assert abs(found.run.position[-1] - float(P2_POSITION)) < 1e-10
    assert main(['simulate', 'sundials', '--until', '10', '--tolerance', '1e-9']) == 0
    said = capsys.readouterr().out
    assert '1.27567584' in said and 'shaking_force' in said
    # nothing drives it, which the loads with the spring on its crank say too
    drive, = (peak for peak in found.peaks() if peak.name == 'driving_torque')
    assert max(abs(drive.low), abs(drive.high)) < 1e-12


def test_what_could_run_for_ever_ends_and_says_how_far_it_got(capsys, tmp_path):
    """A controller that slides on its limit; a torque without measure."""
    text = find('controlled').read_text().replace('proportional: 200', 'proportional: 10')
    sliding = tmp_path / 'sliding.yaml'
    sliding.write_text(text)
    assert main(['simulate', str(sliding), '--until', '0.3']) == 0
    assert 'reached the end: DOP853' in capsys.readouterr().out
    assert main(['simulate', str(sliding), '--until', '0.3', '--evaluations', '500']) == 3
    said = capsys.readouterr().out
    assert 'gave up: 500 evaluations are used up at 0.' in said
    assert main(['simulate', 'released', '--until', '0.1', '--torque', '1e308']) == 3
    assert 'gave up: no step' in capsys.readouterr().out
