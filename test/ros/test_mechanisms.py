# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Slider-crank and inverted slider-crank, driven at crank or slide, and points.

Node, services, bag as the 4R.
"""
import math

from fourbar_ros.mechanisms.quantities import known, select
from fourbar_ros.scene import scene
from fourbar_ros.scene.topics import OUTPUTS
import pytest
from support.exchange import BY_MESSAGES, check_bag, check_extrema, check_topics
from support.harness import ALL_OUTPUTS, fields_of, set_parameters
from support.samples import some
from support.scenes import PAPER, RODS, TIP

BODIES = {**RODS, 'bodies.output.mass': 1.5, 'bodies.output.inertia': 0.02, 'gravity.y': -9.81}
SLIDER_CRANK = {'linkage.kind': 'slider_crank', 'linkage.a1': 0.1, 'linkage.a2': 0.35,
                'linkage.offset': 0.03, **BODIES,
                'external.output.force_x': -200.0}
INVERTED = {'linkage.kind': 'inverted_slider', 'linkage.a1': 0.2, 'linkage.a4': 0.5,
            'linkage.offset': 0.04, **BODIES,
            'bodies.coupler.mass': 0.8, 'bodies.coupler.inertia': 0.001}
SCOTCH_YOKE = {'linkage.kind': 'scotch_yoke', 'linkage.a1': 0.1, 'linkage.offset': 0.03, **BODIES,
               'bodies.coupler.mass': 0.2, 'external.output.force_x': -200.0}
MECHANISMS = {
    'four-bar': ({**PAPER, **RODS}, ['crank', 'coupler', 'coupler_output', 'output']),
    'four-bar at A': ({**PAPER, **RODS, 'linkage.input': 'A'},
                      ['crank', 'coupler', 'coupler_output', 'output']),
    'slider-crank': (SLIDER_CRANK, ['crank', 'rod', 'pin', 'slider']),
    'slider-crank, slide': ({**SLIDER_CRANK, 'linkage.input': 'slide'},
                            ['crank', 'rod', 'pin', 'slider']),
    'inverted': (INVERTED, ['crank', 'block', 'slide', 'bar']),
    'scotch yoke': (SCOTCH_YOKE, ['crank', 'block', 'slot', 'yoke']),
    'scotch yoke, slide': ({**SCOTCH_YOKE, 'linkage.input': 'slide', 'linkage.mode': 1},
                           ['crank', 'block', 'slot', 'yoke']),
    'cylinder': ({**INVERTED, 'linkage.input': 'slide', 'linkage.mode': 1},
                 ['crank', 'block', 'slide', 'bar']),
}


@some('name', ['four-bar', 'cylinder', 'scotch yoke, slide'], 1)
def test_the_same_outputs_services_and_bag(name, run_node, client, tmp_path):
    values, joints = MECHANISMS[name]
    parameters = {**values, **TIP, 'points.pin.link': 'crank', 'points.pin.along': 0.05,
                  'joint_names': joints,
                  **BY_MESSAGES, 'outputs': list(OUTPUTS)}
    its = scene.from_values(parameters)
    linkage = its.linkage
    run_node(parameters)
    inputs = check_topics(client, its)
    assert set(client.received) == {
        *ALL_OUTPUTS, 'points/tip', 'points/pin',
        *(f'links/{link.name}' for link in linkage.LINKS),
        *(f'reactions/{reaction.joint}' for reaction in linkage.REACTIONS)}
    state = client.received['state'][-1]
    for field in ('slide', 'theta4', 'theta3', 'beta'):
        assert math.isnan(getattr(state, field)) == (field not in linkage.MOTION._fields)
    assert list(client.received['joint_states'][0].name) == joints
    check_services(client, its)
    assert client.call('stop_recording').success
    check_bag(tmp_path / 'bags/run', its, len(inputs))


def check_services(client, its):
    """Compare the answers of the services with the core, points included."""
    linkage = its.linkage
    quantities = select((), linkage, its.point_quantities)
    assert {q.name for q in quantities} == {*known(type(linkage), linkage.input), 'tip.speed',
                                            'tip.acceleration',
                                            'pin.speed', 'pin.acceleration'}
    answer, expected = check_extrema(client, linkage, quantities)
    assert [e.quantity for e in answer.extrema] == [e.quantity for e in expected]
    middle = (sum(linkage.input_ranges[0]) / 2.0
              + 0.3 * (linkage.input_ranges[0][1] - linkage.input_ranges[0][0]))
    for mode in {1, 2} - set(linkage.modes):
        answer = client.call('evaluate', position=middle, mode=mode)
        assert (answer.result == answer.RESULT_INVALID_REQUEST
                and f'mode = {mode}' in answer.message)
    for mode in linkage.modes:
        answer = client.call('evaluate', position=middle, velocity=2.0, acceleration=-3.0,
                             mode=mode)
        assert answer.result == answer.RESULT_OK and answer.has_loads
        values = sum(linkage.in_mode(mode).step(middle, 2.0, -3.0), ())
        named = {value.name: value.value for value in answer.values}
        assert {repr(named[name]) for name in named} <= set(map(repr, values))
        assert named[linkage.input_coordinate.position] == middle and named['shaking_moment'] == (
            answer.loads.shaking_moment)
        for output in ('state', 'loads'):
            assert (repr(fields_of(its.layout, output, getattr(answer, output)))
                    == repr(its.layout.expected(output, values)))
    if not linkage.turns_fully:
        outside = linkage.input_ranges[-1][1] + 0.1 * abs(linkage.input_ranges[-1][1])
        answer = client.call('evaluate', position=outside)
        assert (answer.result == answer.RESULT_OUT_OF_RANGE
                and answer.message.startswith('slide = '))


def test_points_are_changed_live_and_refused_with_a_reason(run_node, client):
    run_node({**PAPER, **TIP, 'outputs': ['points'], 'drive.speed': 3.0})
    client.listen(scene.from_values({**PAPER, **TIP, 'outputs': ['points']}).topics)
    client.until(lambda: client.received['points/tip'], 'the stream')
    before = client.received['points/tip'][-1]
    assert before.speed > 0.0
    assert set_parameters(client, {'points.tip.link': 'crank', 'points.tip.along': 0.4,
                                   'points.tip.across': 0.0},
                          atomically=True)[0].successful
    client.until(lambda: client.received['points/tip'][-1].normal_acceleration
                 == pytest.approx(9.0 * 0.4, rel=1e-12),
                 'the point on the crank')
    refused = set_parameters(client, {'points.tip.link': 'rocker'})[0]
    assert 'must be one of crank, coupler, output' in refused.reason
