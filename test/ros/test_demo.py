# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What ``make run`` shows in a narrow terminal."""
import re
import signal
import subprocess
import sys
import time

import pytest
from support.harness import PATIENCE
from support.samples import some
from support.scenes import file_of, PAPER
from support.terminals import NUMBER, shown


@some('width, scene, expected', [
    (60, 'paper', ['13.5134368', '-23.9593817', '2512.31837', '-2048.6091', '0.1096285']),
    (80, 'slides_7_7', ['3.24931426', '-6.69593203'])
], 1)
def test_numbers_of_the_demonstration_are_whole(width, scene, expected, tmp_path):
    text, code = shown([sys.executable, '-m', 'fourbar_lab.clients.demo',
                        f'config/{scene}.yaml', '--seconds', '1',
                        '--directory', str(tmp_path)], width)
    assert code == 0 and '…' not in text, text
    assert set(expected) <= set(NUMBER.findall(text)), text
    assert 'largest difference 0' in text


@pytest.mark.parametrize('source', ['motion', 'joint_state'])
def test_a_scene_that_messages_drive_is_driven(source, tmp_path):
    scene = file_of({**PAPER, 'drive.source': source, 'drive.joint': 'motor', 'drive.speed': 2.0,
                     'outputs': ['state']}, tmp_path)
    scene.write_text(scene.read_text().replace('/**', 'left'))       # as of one node of several
    text, code = shown([sys.executable, '-m', 'fourbar_lab.clients.demo', f'{scene}:left',
                        '--seconds', '1', '--directory', str(tmp_path)], 120)
    assert code == 0 and int(re.search(r'recomputed: (\d+) outputs', text)[1]) > 20, text


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_demonstration_and_its_node(number, tmp_path):
    demo = subprocess.Popen([sys.executable, '-m', 'fourbar_lab.clients.demo', 'paper',
                             '--seconds', '600', '--directory', str(tmp_path)],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said = ''
    while 'driven by timer' not in said:
        said += demo.stdout.readline()
    time.sleep(2.0)                      # its client is made, or will be
    demo.send_signal(number)
    said += demo.communicate(timeout=PATIENCE)[0]
    assert demo.returncode == 128 + number and 'Traceback' not in said, said
    assert 'recorded' in said            # by the node, at its end
