# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Forces from outside and on the drive.

Power balance of chains, what acts in a silence, what is not known.
"""
import math

from fourbar_ros.pipeline.stepper import LOADS_UNKNOWN, OK, OUT_OF_RANGE, Stepper, Wanted
from fourbar_ros.pipeline.wrenches import a_step_later, constant, in_silence, UNKNOWN, Wrench
from fourbar_ros.scene import scene as scenes
from hypothesis import given
from hypothesis import strategies as st
import pytest
from support.power import power
from support.scenes import PAPER, ROCKER, RODS
from support.strategies import inputs, wrenches

FROM_TOPIC = {'external.output.from_topic': True, 'external.coupler.from_topic': True}
LOADED = {**PAPER, **RODS, 'gravity.y': -9.81, 'outputs': ['state', 'loads', 'drive_wrench']}
SLIDER = {'linkage.kind': 'slider_crank', 'linkage.a1': 0.1, 'linkage.a2': 0.3,
          'linkage.offset': 0.02,
          'bodies.crank.mass': 1.0, 'bodies.crank.inertia': 0.01, 'bodies.coupler.mass': 2.0,
          'bodies.coupler.inertia': 0.02, 'bodies.output.mass': 3.0,
          'outputs': ['state', 'loads', 'drive_wrench']}
CYLINDER = {'linkage.kind': 'inverted_slider', 'linkage.input': 'slide', 'linkage.a1': 0.5,
            'linkage.a4': 1.0,
            'linkage.offset': 0.05, 'bodies.crank.mass': 1.0, 'bodies.crank.inertia': 0.1,
            'bodies.coupler.mass': 2.0, 'bodies.coupler.inertia': 0.02, 'bodies.output.mass': 3.0,
            'bodies.output.inertia': 0.3, 'outputs': ['state', 'loads', 'drive_wrench']}


def of(scene, values, output):
    return scene.layout.expected(output, values)


@given(st.sampled_from(['coupler', 'output']), wrenches, inputs)
def test_a_wrench_from_a_topic_is_that_of_the_scene_to_the_last_bit(link, wrench, given):
    place = {f'external.{link}.along': 0.3, f'external.{link}.across': -0.1}
    stepper = Stepper(scenes.from_values({**LOADED, **place,
                                          f'external.{link}.from_topic': True}))
    stepper.act(link, Wrench(*wrench))
    given_loads = {f'external.{link}.{name}': number
                   for name, number in Wrench(*wrench)._asdict().items()}
    fixed = Stepper(scenes.from_values({**LOADED, **place, **given_loads}))
    found = stepper.step(*given, Wanted(with_loads=True))
    assert found == fixed.step(*given, Wanted(with_loads=True)) and found[0] == OK


def test_a_chain_of_linkages_is_driven_by_the_power_that_goes_into_all_links():
    first = scenes.from_values({**LOADED, 'external.output.from_topic': True})
    second = scenes.from_values({**LOADED, 'linkage.a1': 0.3, 'linkage.a2': 1.4})
    one, two, given = Stepper(first), Stepper(second), (0.7, 6.0, -3.0)
    motion = first.linkage.motion(*given)
    passed_on = motion.theta4, motion.omega4, motion.alpha4
    _, values = two.step(*passed_on, Wanted(with_loads=True))
    reaction = of(second, values, 'drive_wrench')
    one.act('output', Wrench(reaction['wrench.force.x'], reaction['wrench.force.y'],
                             reaction['wrench.torque.z']))
    _, values = one.step(*given, Wanted(with_loads=True))
    taken = power(first.linkage, *given)[0] + power(second.linkage, *passed_on)[0]
    assert of(first, values, 'loads')['driving_torque'] * given[1] == pytest.approx(taken,
                                                                                    rel=1e-12)


@pytest.mark.parametrize('given, at', [({**SLIDER, 'linkage.input': 'slide'}, 0.3),
                                       (CYLINDER, 0.8)])
def test_the_wrench_on_a_sliding_drive_is_minus_its_force_along_the_slide(given, at):
    scene = scenes.from_values(given)
    status, values = Stepper(scene).step(at, 0.4, -2.0, Wanted(with_loads=True))
    loads, wrench = of(scene, values, 'loads'), of(scene, values, 'drive_wrench')
    direction = of(scene, values, 'state').get('theta4', math.nan)
    direction = 0.0 if math.isnan(direction) else direction
    assert status == OK
    assert wrench['wrench.force.x'] == pytest.approx(-loads['driving_force'] * math.cos(direction),
                                                     rel=1e-14)
    assert wrench['wrench.force.y'] == pytest.approx(-loads['driving_force'] * math.sin(direction),
                                                     rel=1e-14, abs=1e-300)
    assert wrench['wrench.torque.z'] == 0.0 != loads['driving_force']


CONSTANTS = {'external.output.force_x': 4.0, 'external.output.couple': -2.0}
LAST = Wrench(1.0, 2.0, 3.0)


def test_a_step_later_goes_on_along_a_line():
    before, last = Wrench(1.0, -4.0, 0.5), Wrench(3.0, -4.5, 0.25)
    assert a_step_later(last, before) == Wrench(5.0, -5.0, 0.0)
    assert a_step_later(last, None) == last
    assert a_step_later(last, UNKNOWN) == last
    assert a_step_later(Wrench(1e308, 0.0, 0.0), Wrench(-1e308, 0.0, 0.0)).force_x == 1e308


@pytest.mark.parametrize('policy, last, expected', [
    ('unknown', None, UNKNOWN), ('unknown', LAST, UNKNOWN), ('hold', LAST, LAST),
    ('hold', None, Wrench(4.0, 0.0, -2.0)), ('constant', LAST, Wrench(4.0, 0.0, -2.0))])
def test_what_acts_in_a_silence(policy, last, expected):
    scene = scenes.from_values({**LOADED, **FROM_TOPIC, **CONSTANTS,
                                'external.when_silent': policy})
    assert repr(in_silence(scene, 'output', last)) == repr(expected)
    stepper = Stepper(scene)
    status, values = stepper.step(0.3, 2.0, 1.0, Wanted(with_loads=True))
    assert status == (LOADS_UNKNOWN if policy == 'unknown' else OK)
    if policy == 'unknown':
        loads = of(scene, values, 'loads')
        assert all(map(math.isnan, loads.values()))
        assert all(map(math.isnan, of(scene, values, 'drive_wrench').values()))
        assert math.isfinite(of(scene, values, 'state')['alpha4'])
    else:
        assert constant(scene, 'output') == Wrench(4.0, 0.0, -2.0)
        assert values == Stepper(scenes.from_values({**LOADED, **CONSTANTS})).step(
            0.3, 2.0, 1.0, Wanted(with_loads=True))[1]


@pytest.mark.parametrize('number', [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize('field', Wrench._fields)
def test_a_number_that_is_none_makes_the_loads_unknown_until_the_next(field, number):
    scene = scenes.from_values({**LOADED, 'external.output.from_topic': True})
    stepper = Stepper(scene)
    stepper.act('output', LAST._replace(**{field: number}))
    assert stepper.step(0.3, 2.0, 1.0, Wanted(with_loads=True))[0] == LOADS_UNKNOWN
    stepper.act('output', LAST)
    assert stepper.step(0.3, 2.0, 1.0, Wanted(with_loads=True))[0] == OK


def test_both_links_must_be_known_and_other_statuses_come_first():
    scene = scenes.from_values({**ROCKER, **RODS, **FROM_TOPIC, 'outputs': ['loads']})
    stepper = Stepper(scene)
    stepper.act('output', LAST)
    assert stepper.step(0.2, 2.0, 1.0, Wanted(with_loads=True))[0] == LOADS_UNKNOWN
    assert stepper.step(1.0, 2.0, 1.0, Wanted(with_loads=True))[0] == OUT_OF_RANGE
    stepper.act('coupler', LAST)
    assert stepper.step(0.2, 2.0, 1.0, Wanted(with_loads=True))[0] == OK


def test_a_scene_without_loads_has_nothing_unknown():
    scene = scenes.from_values({**PAPER, **FROM_TOPIC})
    assert Stepper(scene).step(0.2, 2.0, 1.0, Wanted())[0] == OK
