# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The live page of recorded runs and of a running node, in a real browser over real DDS."""
from fourbar_ros.live.recorded import read_run
from fourbar_ros.report.poses import number
import numpy as np
import pytest
from support import ROOT
from support.browser import browser, live, needs_browser, Tab
from support.harness import NodeProcess
from support.scenes import PAPER, RODS

pytestmark = needs_browser
RECORDED = ROOT / 'test/support/data/recorded'
BAGS = sorted(path for path in RECORDED.iterdir())


@pytest.fixture(scope='module')
def driver(tmp_path_factory):
    with browser(tmp_path_factory.mktemp('profile')) as driver:
        yield driver


def test_a_run_can_be_scrubbed_and_compared(driver):
    scene, run = read_run(BAGS[0])
    with live(BAGS[0], BAGS[1]) as address:
        tab = Tab(driver, address)
        middle = float(run.times[len(run.times) // 2])
        tab.write('input value', f'{middle + 1e-7:.9f}')
        i = int(np.searchsorted(run.times, middle + 1e-7, 'right')) - 1
        motion = scene.linkage.motion(*map(float, run.states[:, i]))
        name = scene.linkage.outputs[0].coordinate.rate
        tab.until(lambda: tab.now().get(name) == number(getattr(motion, name)),
                  'the pose of that sample')
        assert not tab.alarm()


def test_a_node_is_followed_and_set(driver, tmp_path):
    scene = {**PAPER, **RODS, 'drive.speed': 0.5}
    node = NodeProcess(scene, tmp_path, name='watched_by_a_page')
    try:
        with live('--node', '/watched_by_a_page') as address:
            tab = Tab(driver, address)
            before = tab.picture()
            tab.until(lambda: tab.picture() != before, 'the motion of the node')
            tab.write('linkage.a2', '9')
            tab.until(lambda: 'cannot close' in tab.alarm(), "the node's reason")
            tab.write('linkage.a2', '1.1')
            tab.open('Facts')
            tab.until(lambda: any('a2 1.1' in row[1] for row in tab.rows('lengths')),
                      "the node's new linkage")
    finally:
        node.stop()
