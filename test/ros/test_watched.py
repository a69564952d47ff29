# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The client behind the page of a node: what it sets arrives, even if an answer is lost."""
import time

from fourbar_lab.clients.watched import Watched
import pytest
from rclpy.task import Future
from support.harness import NodeProcess, PATIENCE
from support.scenes import PAPER


@pytest.fixture
def watched(tmp_path):
    node = NodeProcess(PAPER, tmp_path, name='watched')
    watched = Watched('watched', PATIENCE)
    yield watched
    watched.close()
    node.stop()


def test_a_parameter_whose_answer_is_lost_is_asked_for_again(watched, monkeypatch):
    ask, lost = watched._setter.call_async, [Future()]
    monkeypatch.setattr(watched._setter, 'call_async',
                        lambda request: lost.pop() if lost else ask(request))
    assert watched.set('linkage.a2', 1.1) == ''
    assert 'cannot close' in watched.set('linkage.a2', 9.0)
    end = time.monotonic() + PATIENCE
    while watched.values['linkage.a2'] != 1.1:
        assert time.monotonic() < end, 'no new scene'
        time.sleep(0.05)
