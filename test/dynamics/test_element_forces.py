# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loads with springs against the equation of motion, which knows them as energies."""
from fourbar_ros import Bodies, FourBar, InvertedSlider, round_rod, SliderCrank
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Applied, External
from fourbar_ros.mechanisms.elements import Attachment, PositionForce, Spring, TorsionSpring
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.sliders import ScotchYoke
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.pipeline.stepper import OK, Stepper, Wanted
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support.dynamics_problems import samples
from support.samples import some
from support.scenes import PAPER, RODS

BODIES = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
LOADS = External(Applied(3.0, -4.0, along=0.2, across=0.1, couple=1.5),
                 Applied(-20.0, 7.0, along=0.5, across=-0.2, couple=0.0))
LINKAGES = [FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, gravity=(1.0, -9.81), external=LOADS),
            FourBar(0.4, 1.2, 0.8, 1.0, mode=1, bodies=BODIES),
            SliderCrank(0.3, 0.9, 0.1, bodies=BODIES, gravity=(0.0, -9.81)),
            SliderCrank(0.3, 0.9, 0.1, input='slide', bodies=BODIES)]
MORE = [*LINKAGES, InvertedSlider(0.3, 0.9, 0.1, bodies=BODIES, gravity=(0.0, -9.81)),
        InvertedSlider(0.3, 0.9, 0.1, input='slide', bodies=BODIES, gravity=(0.0, -9.81)),
        ScotchYoke(0.5, 0.1, input='slide', mode=1, bodies=BODIES, gravity=(2.0, -9.81))]
LINEAR = [Spring(Attachment('ground', 1.4, 0.3), Attachment('output', 0.3, 0.1), 900.0,
                 free_length=0.4, damping=15.0),
          Spring(Attachment('coupler', 0.2, -0.3), Attachment('output', 0.0, 0.2), 700.0,
                 free_length=0.0),
          Spring(Attachment('coupler', 0.5, 0.5), Attachment('ground', 0.1, 2.0), 0.0,
                 damping=40.0)]
ON_CRANK = [
    Spring(Attachment('ground', -0.3, 0.5), Attachment('crank', 0.2, 0.1), 600.0, free_length=0.3,
           damping=12.0),
    Spring(Attachment('crank', 0.1, -0.2), Attachment('output', 0.1, 0.2), 500.0, free_length=0.2,
           damping=7.0),
    TorsionSpring('ground', 'crank', 30.0, free_angle=0.4, damping=1.5),
    TorsionSpring('crank', 'coupler', 20.0, free_angle=-0.2, damping=0.8)]
TORSION = [TorsionSpring('coupler', 'output', 60.0, free_angle=0.3, damping=2.0),
           TorsionSpring('ground', 'coupler', 25.0, free_angle=-1.0, damping=0.5)]


@some('elements', [LINEAR[:1], LINEAR, TORSION, ON_CRANK,
                   [*LINEAR, *TORSION, *ON_CRANK]], 2,
      ids=['one', 'linear', 'torsion', 'on the crank', 'all'])
@pytest.mark.parametrize('linkage', MORE, ids=lambda linkage: linkage.description)
def test_the_drive_of_the_loads_is_that_of_the_equation(linkage, elements):
    loaded = linkage.with_elements(*elements)
    equation = Equation(loaded)
    for motion in samples(linkage, 5, 40):
        loads = loaded.loads(*motion)
        drive = loads.driving_force if linkage.is_driven_by_slide else loads.driving_torque
        wanted = equation.torque(*motion)
        without = Equation(linkage).torque(*motion)
        size = abs(wanted) + abs(without) + 1e3 * (1.0 + motion[1]**2 + abs(motion[2]))
        assert abs(drive - wanted) <= 1e-11 * size
        if elements is not TORSION or not isinstance(linkage, ScotchYoke):      # it does not turn
            assert abs(wanted - without) > 1e-6              # the springs matter


def stretched(linkage, motion, spring):
    """Return direction from the first to the second end, length and its rate, from the points."""
    (one, its_rate), (two, other_rate) = (end_of(linkage, motion, end)
                                          for end in (spring.first, spring.second))
    length = np.hypot(*(two - one))
    along = (two - one) / length
    return along, length, float(along @ (other_rate - its_rate))


def end_of(linkage, motion, end):
    """Return place and velocity of an end of a spring."""
    if end.link == 'ground':
        return np.array([end.along, end.across]), np.zeros(2)
    at = point_motion(linkage, motion, end.link, end.along, end.across)
    return at.place, at.velocity


def turned(linkage, motion, spring):
    """Return the angle of the second link to the first, less the free one, and its rate."""
    (c1, s1, w1), (c2, s2, w2) = ((1.0, 0.0, 0.0) if link == 'ground' else
                                  linkage.link_motion(motion, link)[6:9]
                                  for link in spring.links)
    free = np.exp(-1j * spring.free_angle)
    return float(np.angle(complex(c2, s2) / complex(c1, s1) * free)), w2 - w1


def tension(linkage, motion, spring):
    """Return force or moment of a spring and damper."""
    change = stretched if isinstance(spring, Spring) else turned
    *_, stretch, growth = change(linkage, motion, spring)
    stretch -= getattr(spring, 'free_length', 0.0)
    return spring.stiffness * stretch + spring.damping * growth


@pytest.mark.parametrize('linkage', MORE, ids=lambda linkage: linkage.description)
def test_the_crank_is_in_balance_with_the_springs_on_it(linkage):
    """Newton and Euler of the crank as a free body, with its springs and both its pins."""
    linkage = linkage.with_elements(*ON_CRANK)
    body = linkage.bodies.crank
    for sample in samples(linkage, 8):
        motion, loads = linkage.step(*sample)
        centre = point_motion(linkage, motion, 'crank', body.cg_along, body.cg_across)
        crank, pin = (point_motion(linkage, motion, 'crank', along, 0.0)
                      for along in (0.0, linkage.a1))
        forces = [(pin.place, (loads.f21_x, loads.f21_y)),
                  (crank.place, (loads.f41_x, loads.f41_y)),
                  (centre.place, body.mass * (np.array(linkage.gravity) - centre.acceleration))]
        moments = [loads.driving_torque,
                   -body.inertia * linkage.link_motion(motion, 'crank').alpha]
        for spring in ON_CRANK:
            pull = tension(linkage, motion, spring)
            sign = 1.0 if spring.links[0] == 'crank' else -1.0
            if isinstance(spring, TorsionSpring):
                moments.append(sign * pull)
            else:
                end = spring.first if sign > 0.0 else spring.second
                forces.append((end_of(linkage, motion, end)[0],
                               sign * pull * stretched(linkage, motion, spring)[0]))
        moments += [x * f_y - y * f_x for (x, y), (f_x, f_y) in forces]
        size = sum(abs(np.array(force)).sum() for _, force in forces)
        condition = 1.0 + motion.condition / linkage.input_unit
        assert np.abs(sum(np.array(force) for _, force in forces)).max() <= 1e-12 * size
        assert abs(sum(moments)) <= 1e-12 * condition * (size + sum(map(abs, moments)))


def test_a_spring_pulls_both_ends_alike():
    linkage = LINKAGES[0]
    motion = linkage.motion(0.7, 3.0, 0.0)
    links = {link: linkage.link_motion(motion, link) for link in ('coupler', 'output')}
    for element in (LINEAR[1], TORSION[0]):
        first, second = element.forces(REAL, links)
        assert (first.force_x, first.force_y) == (-second.force_x, -second.force_y)
        moment = sum(force.couple + force.x * force.force_y - force.y * force.force_x
                     for force in (first, second))
        assert abs(moment) < 1e-12 * (abs(first.couple) + 1e3)


def test_a_scene_publishes_loads_with_its_springs():
    values = {**PAPER, **RODS, 'drive.source': 'torque', 'outputs': ['loads'],
              'springs.back.second.link': 'output', 'springs.back.second.along': 0.4,
              'springs.back.first.along': 1.5, 'springs.back.first.across': 0.2,
              'springs.back.stiffness': 800.0, 'springs.back.damping': 10.0,
              'torsion_springs.pivot.stiffness': 25.0, 'torsion_springs.pivot.damping': 1.0}
    there = scene.from_values(values)
    status, found = Stepper(there).step(0.4, 2.0, 1.0, Wanted(with_loads=True))
    torque = found[there.layout.index_of['driving_torque']]
    equation = there.dynamics.system(there.linkage).equation
    assert status == OK and torque == pytest.approx(equation.torque(0.4, 2.0, 1.0), rel=1e-11)
    assert Stepper(there).step(float('nan'), 2.0, 1.0, Wanted(with_loads=True))[0] != OK


def test_forces_that_overflow_together_are_none():
    """Each is finite, their couple is not: refused, in arrays not finite."""
    push = PositionForce(Attachment('output', 0.5), lambda _: 1e306, direction=None)
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES)
    one, many = linkage.with_elements(push), linkage.with_elements(*[push] * 200)
    assert np.isfinite(one.loads(0.7).driving_torque)
    with pytest.raises(InvalidParameter, match='loads overflow'):
        many.loads(0.7)
    assert not np.isfinite(many.loads([0.7]).driving_torque).any()
