# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loads with springs against the equation of motion, which knows them as energies."""
from fourbar_ros import Bodies, FourBar, round_rod, SliderCrank
from fourbar_ros.dynamics.elements import Attachment, Spring, TorsionSpring
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.spring_forces import forces_of, make_loaded
from fourbar_ros.mechanics.bodies import Applied, External
from fourbar_ros.pipeline.status import OK
from fourbar_ros.pipeline.stepper import Stepper
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support.scenes import PAPER, RODS

BODIES = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
LOADS = External(Applied(3.0, -4.0, 0.2, 0.1, 1.5), Applied(-20.0, 7.0, 0.5, -0.2, 0.0))
LINKAGES = [FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, gravity=(1.0, -9.81), external=LOADS),
            FourBar(0.4, 1.2, 0.8, 1.0, mode=1, bodies=BODIES),
            SliderCrank(0.3, 0.9, 0.1, bodies=BODIES, gravity=(0.0, -9.81)),
            SliderCrank(0.3, 0.9, 0.1, input='slide', bodies=BODIES)]
LINEAR = [Spring(Attachment('ground', 1.4, 0.3), Attachment('output', 0.3, 0.1), 900.0, 0.4, 15.0),
          Spring(Attachment('coupler', 0.2, -0.3), Attachment('output', 0.0, 0.2), 700.0, 0.0),
          Spring(Attachment('coupler', 0.5, 0.5), Attachment('ground', 0.1, 2.0), 0.0, 0.0, 40.0)]
TORSION = [TorsionSpring('coupler', 'output', 60.0, 0.3, 2.0),
           TorsionSpring('ground', 'coupler', 25.0, -1.0, 0.5)]


@pytest.mark.parametrize('elements', [LINEAR[:1], LINEAR, TORSION, [*LINEAR, *TORSION]],
                         ids=['one', 'linear', 'torsion', 'all'])
@pytest.mark.parametrize('linkage', LINKAGES, ids=lambda linkage: linkage.description)
def test_the_drive_of_the_loads_is_that_of_the_equation(linkage, elements):
    equation, loaded = Equation(linkage, elements), make_loaded(linkage, elements)
    (low, high), *_ = linkage.input_ranges
    rng = np.random.default_rng(5)
    for share, rate, acceleration in rng.uniform((0.05, -9.0, -50.0), (0.95, 9.0, 50.0), (40, 3)):
        motion = float(low + share * (high - low)), float(rate), float(acceleration)
        loads = loaded(*motion[:2]).step(*motion)[1]
        drive = loads.driving_force if linkage.is_driven_by_slide else loads.driving_torque
        wanted = equation.torque(*motion)
        without = Equation(linkage).torque(*motion)
        size = abs(wanted) + abs(without) + 1e3 * (1.0 + rate * rate + abs(acceleration))
        assert abs(drive - wanted) <= 1e-11 * size
        assert abs(wanted - without) > 1e-6              # the springs matter


def test_a_spring_pulls_both_ends_alike():
    linkage = LINKAGES[0]
    motion = linkage.motion(0.7, 3.0, 0.0)
    one, two = (linkage.link_motion(motion, link) for link in ('coupler', 'output'))
    for element in (LINEAR[1], TORSION[0]):
        first, second = forces_of(element, one, two)
        assert (first.force_x, first.force_y) == (-second.force_x, -second.force_y)
        moment = sum(force.couple + force.x * force.force_y - force.y * force.force_x
                     for force in (first, second))
        assert abs(moment) < 1e-12 * (abs(first.couple) + 1e3)


def test_a_scene_publishes_loads_with_its_springs():
    values = {**PAPER, **RODS, 'drive.source': 'torque', 'outputs': ['loads'],
              'springs.back.second.link': 'output', 'springs.back.second.along': 0.4,
              'springs.back.first.along': 1.5, 'springs.back.first.across': 0.2,
              'springs.back.stiffness': 800.0, 'springs.back.damping': 10.0}
    there = scene.from_values(values)
    status, found = Stepper(there).step(0.4, 2.0, 1.0, True, False)
    torque = found[there.layout.place['driving_torque']]
    equation = there.dynamics.system(there.linkage).equation
    assert status == OK and torque == pytest.approx(equation.torque(0.4, 2.0, 1.0), rel=1e-11)
    assert Stepper(there).step(float('nan'), 2.0, 1.0, True, False)[0] != OK
