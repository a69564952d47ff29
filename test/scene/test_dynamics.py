# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes whose motion follows from torque: what they give, and why others are refused."""
import subprocess
import sys

from fourbar_ros.scene import scene
import pytest
from support import ROOT
from support.scenes import PAPER, RODS

MOTOR = {**PAPER, **RODS, 'drive.source': 'motor', 'motor.stall_torque': 400.0,
         'motor.free_speed': 26.0}


def test_a_motor_behind_a_gear_turns_its_numbers_over():
    drive = scene.from_values({**MOTOR, 'motor.gear': -10.0, 'motor.rotor_inertia': 0.02,
                               'shaft.stiffness': 1e4, 'flywheel.inertia': 2}).dynamics.drive
    assert drive.rotor == pytest.approx(2.0) and drive.flywheel == 2.0
    assert drive.source.torque(0.0, 0.0, ()) == (-4000.0, ())
    assert drive.source.torque(0.0, -2.6, ()) == (0.0, ())
    # power of the motor itself at half its free speed: 200 N m at 13 rad/s
    torque, _ = drive.source.torque(0.0, -1.3, ())
    assert torque * -1.3 == pytest.approx(200.0 * 13.0)


def test_springs_and_dampers_are_named_freely_and_reach_the_equation():
    values = {**PAPER, **RODS, 'drive.source': 'torque', 'outputs': ['state'],
              'springs.back.second.link': 'output', 'springs.back.second.along': 0.8,
              'springs.back.first.along': 1.5, 'springs.back.stiffness': 300.0,
              'springs.back.free_length': 0.2, 'torsion_springs.pivot.damping': 0.5}
    there = scene.from_values(values)
    spring, pivot = there.linkage.elements
    assert spring.links == ('ground', 'output') and pivot.links == ('ground', 'crank')
    terms = there.dynamics.system(there.linkage).equation.terms(0.3)
    assert terms.damping == 0.5 and terms.force != 0.0


def test_the_source_torque_starts_at_rest_without_a_torque():
    found = scene.from_values({**PAPER, **RODS, 'drive.source': 'torque', 'drive.start': 0.4,
                               'drive.start_speed': -2})
    assert (found.dynamics.position, found.dynamics.rate) == (0.4, -2.0)
    assert found.dynamics.drive.source.torque(0.0, 1.0, ()) == (0.0, ())
    assert [topic.name for topic in found.recorded[2:4]] == ['torque', 'drive_state']
    assert scene.from_values({**PAPER, **RODS}).dynamics is None


@pytest.mark.parametrize('name', ['paper', 'motor', 'released', 'controlled'])
def test_no_scene_loads_the_integrators(name):
    done = subprocess.run([sys.executable, '-c', f"""
import sys
from fourbar_ros.scene.scene import load
scene = load({name!r})
print([m for m in sys.modules if m.startswith('scipy')],
      (scene.dynamics is None) is ('fourbar_ros.dynamics.system' not in sys.modules))
"""], capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.stdout.split() == ['[]', 'True'], done.stdout + done.stderr
