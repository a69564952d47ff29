# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The search for extrema as an action.

Feedback, the answer of the service, cancel, refusals, an end in time.
"""
import time

from action_msgs.msg import GoalStatus
import pytest
from rclpy.action import ActionClient
from support.samples import some
from support.scenes import PAPER, RODS

# Absent only where fourbar_msgs has not been built since it has the action; the node says so and
# runs without.
FindExtrema = pytest.importorskip('fourbar_msgs.action').FindExtrema

LOADED = {**PAPER, **RODS, 'drive.source': 'motion'}


class Goals:
    """A client of the action."""

    def __init__(self, client):
        self.client, self.feedback = client, []
        self.action = ActionClient(client.node, FindExtrema, '/fourbar/find_extrema')
        client.until(self.action.server_is_ready, 'the action')

    def send(self, **goal):
        """Return the handle of an accepted goal."""
        while True:                                      # until the server knows its client
            future = self.action.send_goal_async(FindExtrema.Goal(**goal), self.feedback.append)
            end = time.monotonic() + 5.0
            while time.monotonic() < end and not future.done():
                self.client.executor.spin_once(timeout_sec=0.05)
            if future.done():
                assert future.result().accepted
                return future.result()

    def result(self, handle):
        """Return (status, result)."""
        future = handle.get_result_async()
        self.client.until(future.done, 'the result', 60.0)
        return future.result().status, future.result().result


@pytest.fixture
def goals(client):
    """Return the function that gives a Goals once a node runs."""
    made = []

    def make():
        made.append(Goals(client))
        return made[-1]
    yield make
    for each in made:
        each.action.destroy()


def test_it_finds_what_the_service_finds_and_says_how_far_it_is(run_node, client, goals):
    run_node(LOADED)
    its = goals()
    asked = {'quantities': ['alpha4', 'shaking_force', 'f21'], 'mode': 3, 'velocity': 25.0}
    status, result = its.result(its.send(**asked))
    assert status == GoalStatus.STATUS_SUCCEEDED and result.result == result.RESULT_OK
    answer = client.call('find_extrema', **asked)
    assert len(answer.extrema) > 10 and repr(result.extrema) == repr(answer.extrema)
    heard = [(f.feedback.quantity, f.feedback.mode, f.feedback.done, f.feedback.total)
             for f in its.feedback]
    assert heard[-6:] == [(name, mode, 2 * i + mode - 1, 6)
                          for i, name in enumerate(asked['quantities']) for mode in (1, 2)]
    counts = [f.feedback.found for f in its.feedback]
    assert counts[-6:] == sorted(counts[-6:]) and counts[-1] < len(answer.extrema)


@some('asked, result', [
    ({'quantities': ['nonsense'], 'velocity': 1.0}, 'RESULT_UNKNOWN_QUANTITY'),
    ({'velocity': 0.0}, 'RESULT_INVALID_REQUEST'), ({'velocity': 1.0, 'mode': 9},
                                                    'RESULT_INVALID_REQUEST')], 1)
def test_what_cannot_be_is_aborted_with_the_reason(run_node, client, goals, asked, result):
    run_node(LOADED)
    its = goals()
    status, answer = its.result(its.send(**asked))
    assert (status == GoalStatus.STATUS_ABORTED and answer.result == getattr(answer, result)
            and answer.message)


def test_a_certified_search_is_canceled_and_the_next_goal_is_answered(run_node, client, goals):
    run_node(LOADED)
    its = goals()
    handle = its.send(velocity=25.0, mode=3, certify=True)       # of all quantities: seconds
    client.until(lambda: any(f.feedback.done >= 1 for f in its.feedback), 'feedback')
    waiting = its.send(velocity=25.0, certify=True)
    for each in (waiting, handle):
        future = each.cancel_goal_async()
        client.until(future.done, 'the answer to cancel')
        assert len(future.result().goals_canceling) == 1
    for each, least in ((handle, 1), (waiting, 0)):
        status, result = its.result(each)
        assert status == GoalStatus.STATUS_CANCELED and result.result == result.RESULT_CANCELED
        assert len(result.extrema) >= least
    status, result = its.result(its.send(quantities=['omega4'], velocity=25.0))
    assert status == GoalStatus.STATUS_SUCCEEDED


@pytest.mark.slow
def test_the_node_ends_with_code_0_during_a_goal(run_node, client, goals):
    node = run_node(LOADED)
    its = goals()
    its.send(velocity=25.0, mode=3, certify=True)
    client.until(lambda: its.feedback, 'feedback')
    assert node.stop() == 0
