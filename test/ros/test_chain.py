# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loads pass back along a chain of nodes, fall silent, and recompute from the bag."""
from functools import partial
from itertools import count
import math
import time

from fourbar_msgs.msg import LinkageState
from fourbar_ros import Applied, External
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.scene import scene
from geometry_msgs.msg import WrenchStamped
import pytest
from support.harness import LATCHED, recording_in, set_parameters, SimulatedClock
from support.samples import some
from support.scenes import PAPER, RODS

LOADED = {**PAPER, **RODS, 'outputs': ['state', 'loads'], 'drive.source': 'motion',
          'drive.timeout': 0.0}


def wrench(force_x=0.0, force_y=0.0, couple=0.0, frame=''):
    message = WrenchStamped()
    message.header.frame_id = frame
    message.wrench.force.x, message.wrench.force.y, message.wrench.torque.z = (force_x, force_y,
                                                                               couple)
    return message


class Loaded:
    """A node that a test loads and drives."""

    def __init__(self, run_node, client, ask, link='output', **parameters):
        self.client, self.link, self._ask, self._times = client, link, ask, count(1)
        parameters = {name.replace('__', '.'): value for name, value in parameters.items()}
        given = {**LOADED, f'external.{link}.from_topic': True, **parameters}
        self.node = run_node(given)
        given.pop('use_sim_time', None)
        self.linkage = scene.from_values(given).linkage
        self.applied = client.hear(WrenchStamped, f'/fourbar/applied/{link}', LATCHED)
        self.wrenches = client.node.create_publisher(WrenchStamped, f'/fourbar/external/{link}',
                                                     10)
        self.answer(0.1)
        client.until(lambda: self.wrenches.get_subscription_count() and self.applied,
                     'the wrench topics')

    def load(self, *numbers, frame=''):
        """Send a wrench until it acts."""
        def acts():
            self.wrenches.publish(wrench(*numbers, frame=frame))
            self.client.spin(0.1)
            # NaN is NaN here
            return repr(self.applied[-1].wrench) == repr(wrench(*numbers).wrench)
        self.client.until(acts, 'the wrench in effect')

    def answer(self, position):
        """Return (state, loads) of an input."""
        found = self._ask(next(self._times), position, 2.0, 3.0)
        return found.state, found.loads

    def under(self, position, *numbers):
        """Return the driving torque of the core under a wrench, in the place of the scene."""
        given = getattr(self.linkage.external, self.link)
        applied = Applied(*numbers[:2], along=given.along, across=given.across,
                          couple=numbers[2])
        loaded = self.linkage.with_external(External(**{self.link: applied}))
        return loaded.loads(position, 2.0, 3.0).driving_torque


@pytest.fixture
def loaded(run_node, client, lockstep):
    """Return the function that starts a node to be loaded."""
    return partial(Loaded, run_node, client, lockstep('state', 'loads'))


@some('link', ['crank', 'output'], 1)
def test_a_wrench_from_a_topic_acts_from_the_next_step_on(loaded, link):
    node = loaded(link, **{f'external.{link}.along': 0.4,
                           'external.timeout': 0.0})
    state, loads = node.answer(0.3)
    assert state.status == loads.status == LinkageState.STATUS_LOADS_UNKNOWN
    assert math.isfinite(state.alpha4) and math.isnan(loads.driving_torque)
    for numbers, frame in (((5.0, -3.0, 0.5), ''), ((-1.0, 0.0, 0.0), 'fourbar'),
                           ((0.0, 0.0, 7.0), 'other')):
        node.load(*numbers, frame=frame)
        state, loads = node.answer(0.3)
        assert (state.status == LinkageState.STATUS_OK and loads.driving_torque
                == node.under(0.3, *numbers))
    applied = node.applied[-1]
    assert (applied.header.frame_id, applied.wrench.torque.z) == ('fourbar', 7.0)
    node.load(math.nan)
    assert node.answer(0.4)[1].status == LinkageState.STATUS_LOADS_UNKNOWN


def test_a_force_of_another_frame_does_not_act(loaded, client):
    node = loaded(external__timeout=0.0)
    node.load(5.0)
    for _ in range(3):
        node.wrenches.publish(wrench(9.0, frame='tool'))
    client.until(lambda: "'tool'" in node.node.said, 'the warning')
    assert node.answer(0.3)[1].driving_torque == node.under(0.3, 5.0, 0.0, 0.0)
    node.node.stop()
    assert node.node.said.count("'tool'") == 1


@pytest.mark.slow
def test_a_silence_runs_on_simulated_time(loaded, client):
    clock = SimulatedClock(client, 10 * 10**9, 50_000_000, repeats=True)
    node = loaded(use_sim_time=True, external__timeout=0.4)
    node.load(5.0, 1.0, -1.0)
    for _ in range(3):
        client.spin(0.6)                     # longer than the timeout, and simulated: nothing
        clock.tick()
        assert node.answer(0.3)[0].status == LinkageState.STATUS_OK
        node.load(5.0, 1.0, -1.0)
    clock.now = 3 * 10**9                    # back: it counts from there
    for _ in range(4):
        clock.tick()
    assert 'no wrench for' not in node.node.said
    client.until(lambda: clock.tick() or 'no wrench for' in node.node.said, 'the silence')
    assert 34 * 10**8 < clock.now
    assert node.answer(0.3)[0].status == LinkageState.STATUS_LOADS_UNKNOWN


@some('policy', ['unknown', 'hold', 'constant'], 1)
def test_a_bag_with_wrenches_silences_and_changes_computes_again(loaded, client, tmp_path,
                                                                 policy):
    node = loaded(external__timeout=0.0, external__when_silent=policy,
                  external__output__couple=2.5)
    node.load(5.0, 1.0, -1.0)
    # while something acts from before
    assert client.call('start_recording', name='run').success
    torques = [node.answer(0.3)[1].driving_torque]
    node.load(-2.0, 0.0, 0.3)
    torques.append(node.answer(0.3)[1].driving_torque)
    assert set_parameters(client, {'external.output.along': 0.2})[0].successful
    torques.append(node.answer(0.3)[1].driving_torque)
    assert set_parameters(client, {'external.timeout': 0.1})[0].successful
    client.until(lambda: 'no wrench for' in node.node.said, 'the silence')
    assert set_parameters(client, {'external.timeout': 0.0})[0].successful
    torques.append(node.answer(0.3)[1].driving_torque)
    assert set_parameters(client, {'external.output.couple': -1.5})[0].successful
    torques.append(node.answer(0.3)[1].driving_torque)
    node.load(1.0, 1.0, 1.0)
    torques.append(node.answer(0.3)[1].driving_torque)
    assert node.node.stop() == 0
    assert len(set(map(repr, torques))) == {'unknown': 5, 'hold': 4,
                                            'constant': 6}[policy], torques
    found = recompute(tmp_path / 'bags/run')
    assert found.inputs == 6 and found.largest == 0.0
    torque, = [d for d in found.differences if d.field == 'driving_torque']
    assert torque.messages == 6


@pytest.mark.slow
def test_a_split_bag_recomputes_and_a_later_file_alone_says_why_not(loaded, client, tmp_path):
    node = loaded(external__timeout=0.0, recording__split_duration=0.5)
    node.load(5.0, 1.0, -1.0)                            # once, before the bag
    assert client.call('start_recording', name='run').success
    end = time.monotonic() + 1.3
    while time.monotonic() < end:
        assert node.answer(0.3)[1].driving_torque == node.under(0.3, 5.0, 1.0, -1.0)
        client.executor.spin_once(timeout_sec=0.05)
    assert node.node.stop() == 0
    parts = sorted((tmp_path / 'bags/run').glob('*.mcap'))
    assert len(parts) > 1
    for bag in (tmp_path / 'bags/run', parts[0]):
        found = recompute(bag)
        assert found.compared and found.largest == 0.0 and not found.skipped, bag
    assert recompute(parts[1]).skipped == {'depend on what came before this file':
                                           2 * recompute(parts[1]).inputs}


@pytest.mark.slow
def test_a_wrench_of_a_chain_can_be_taken_a_step_further(loaded, client, tmp_path):
    """On the line through the last two; after a silence, and with a NaN, as it came."""
    node = loaded(external__timeout=0.0, external__extrapolated=True,
                  **recording_in(tmp_path))

    def sent(couple):
        count = len(node.applied)
        node.wrenches.publish(wrench(couple=couple))
        client.until(lambda: len(node.applied) > count, 'what acts')
        return node.applied[-1].wrench.torque.z
    assert [sent(couple) for couple in (1.0, 4.0, 5.0, 1e308, -1e308)] == [
        1.0, 7.0, 6.0, 1e308, -1e308]
    assert math.isnan(sent(math.nan)) and sent(2.0) == 2.0 and sent(3.0) == 4.0
    _, loads = node.answer(0.7)
    assert loads.driving_torque == node.under(0.7, 0.0, 0.0, 4.0)
    assert node.node.stop() == 0
    assert recompute(tmp_path / 'run').largest == 0.0
