# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The live page of recorded runs and of a running node, in a real browser over real DDS."""
import csv
import itertools

from fourbar_lab.clients.node_client import NodeClient, opened
from fourbar_lab.drawing.poses import number
from fourbar_lab.live.server import read_run
from fourbar_msgs.msg import Motion
from fourbar_ros.cli.main import main
import numpy as np
import pytest
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from support import ROOT
from support.browser import live, needs_browser, PATIENCE, Tab
from support.harness import NodeProcess
from support.scenes import PAPER, RODS

pytestmark = [needs_browser, pytest.mark.slow]
RECORDED = ROOT / 'test/support/data/recorded'
BAGS = sorted(path for path in RECORDED.iterdir())


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


def exported(bag, folder):
    """Return {column: texts} of the state that ``fourbar bag export`` writes."""
    assert main(['bag', 'export', str(bag), '-o', str(folder)]) == 0
    file = next(file for file in folder.rglob('*.csv') if file.stem.endswith('state')
                and 'joint' not in file.stem)
    with file.open() as opened:
        rows = list(csv.DictReader(opened))
    return {name: [row[name] for row in rows] for name in rows[0]}


def test_two_runs_beside_each_other_have_the_numbers_of_their_exports(driver, tmp_path):
    bags = [RECORDED / 'slides_7_6', RECORDED / 'slides_7_7']
    runs = [read_run(bag)[1] for bag in bags]
    tables = [exported(bag, tmp_path / bag.name) for bag in bags]
    with live(*bags) as address:
        tab = Tab(driver, address)
        at = float(f'{runs[0].times[len(runs[0].times) // 2] + 1e-7:.9g}')
        tab.write('input value', f'{at:.9f}')
        places = [int(np.searchsorted(run.times, at, 'right')) - 1 for run in runs]
        values = [float(table['omega4'][i]) for table, i in zip(tables, places)]
        tab.until(lambda: tab.now().get('omega4') == number(values[0]), 'the first')
        row = next(row for row in tab.rows('now') if row[0] == 'omega4')
        # recomputed from the recorded input: within the rounding that bags keep
        assert [float(text) for text in row[1:4]] == pytest.approx(
            [values[0], values[1], values[1] - values[0]], rel=1e-8)
        assert 'class="ghost"' in tab.picture()
        chart = 'curves over the input, extrema marked'
        tab.until(lambda: tab.count_series(chart), 'curves')
        count = tab.count_series(chart)
        tab.tick('difference')
        tab.until(lambda: tab.count_series(chart) == count // 2, 'the differences')


def test_a_silent_node_is_said_to_be_silent(driver, tmp_path):
    scene = {**PAPER, **RODS, 'drive.source': 'motion'}
    node = NodeProcess(scene, tmp_path, name='silent_one')
    try:
        with live('--node', '/silent_one', '--wait', PATIENCE) as address:
            tab = Tab(driver, address)
            tab.until(lambda: 'no motion of the node yet' in tab.alarm(), 'that it is silent')
    finally:
        node.stop()


def test_a_node_is_followed_and_set(driver, tmp_path):
    scene = {**PAPER, **RODS, 'drive.speed': 0.5}
    node = NodeProcess(scene, tmp_path, name='watched_by_a_page')
    try:
        with live('--node', '/watched_by_a_page', '--wait', PATIENCE) as address:
            tab = Tab(driver, address)
            before = tab.picture()
            tab.until(lambda: tab.picture() != before, 'the motion of the node')
            old = tab.text('linkage.a2')
            tab.write('linkage.a2', '9')
            tab.until(lambda: 'cannot close' in tab.alarm(), "the node's reason")
            tab.until(lambda: tab.text('linkage.a2') == old, 'the value that holds')
            tab.write('linkage.a2', '1,1')
            tab.open('Facts')
            tab.until(lambda: any('a2 1.1' in row[1] for row in tab.rows('lengths')),
                      "the node's new linkage")
            assert not tab.alarm()
            set_elsewhere('watched_by_a_page', 'linkage.a3', 0.85)
            tab.until(lambda: tab.text('linkage.a3') == '0.85', 'what another has set')
            tab.until(lambda: tab.by('linkage.a3 slider').get_attribute('aria-valuenow')
                      == '0.85', 'its slider')
            set_elsewhere('watched_by_a_page', 'linkage.mode', 1)
            tab.until(lambda: 'aria-pressed="true"' in tab.driver.find_element(
                'xpath', '//button[contains(., "crossed")]').get_attribute('outerHTML'),
                'the other mode')
            assert tab.text('linkage.a2') == '1.1' and not tab.alarm()
    finally:
        node.stop()


def set_elsewhere(node, name, value):
    """Set a parameter of a node as any other program does."""
    with opened(lambda own: NodeClient(own, PATIENCE), 'somebody_else') as client:
        setter = client.node.create_client(SetParameters, f'/{node}/set_parameters')
        client.until(setter.service_is_ready, 'the node')
        request = SetParameters.Request(
            parameters=[Parameter(name, value=value).to_parameter_msg()])
        assert client.result_of(setter.call_async(request), name).results[0].successful


def test_the_input_of_a_node_goes_on_after_half_a_turn(driver, tmp_path):
    scene = {**PAPER, **RODS, 'drive.speed': 2.0, 'drive.start': 3.0}
    node = NodeProcess(scene, tmp_path, name='turning_on_and_on')
    try:
        with live('--node', '/turning_on_and_on', '--wait', PATIENCE) as address:
            tab = Tab(driver, address)
            seen = set()
            tab.until(lambda: seen.add(round(float(tab.text('input value'))) // 60)
                      or len(seen) == 6, 'every part of a turn')
    finally:
        node.stop()


def test_a_speed_beyond_all_pictures_does_not_stop_the_page(driver, tmp_path):
    """It takes the picture away until the node has other speeds."""
    node = NodeProcess({**PAPER, **RODS, 'drive.source': 'motion'}, tmp_path, name='flung')
    turned = itertools.count()
    try:
        with live('--node', '/flung', '--wait', PATIENCE) as address, opened(
                lambda own: NodeClient(own, PATIENCE), 'flinging') as client:
            publisher = client.node.create_publisher(Motion, '/flung/input', 10)

            def send(speed):
                publisher.publish(Motion(position=0.1 * next(turned), velocity=speed))

            tab = Tab(driver, address)
            tab.until(lambda: send(2.0) or tab.picture(), 'a picture')
            tab.until(lambda: send(1e154) or 'too large' in tab.alarm(), 'the reason')
            before = tab.picture()
            tab.until(lambda: send(2.0) or tab.picture() not in ('', before), 'a picture again')
    finally:
        node.stop()
