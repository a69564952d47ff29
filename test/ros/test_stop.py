# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Whatever signals come, and whenever: exit code 0, a whole bag, soon.

Nothing waits for a search or a disk.
"""
from pathlib import Path
import random
import signal
import threading
import time

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros import load_scene
from fourbar_ros.bag.overview import info
from fourbar_ros.ros.messages import resolve
from fourbar_ros.ros.node.entities import Abandoned, Worker
from fourbar_ros.ros.node.start import caught_signals, SIGNALS
from fourbar_ros.scene.topics import SERVICES
import pytest
from support.harness import ALL_OUTPUTS, cpu_of, cpu_of_ended, PATIENCE, recording_in
from support.samples import some
from support.scenes import PAPER, RODS

RECORDING = {**PAPER, **RODS, 'drive.speed': 25.0, 'drive.rate': 200.0, 'outputs': ALL_OUTPUTS,
             'recording.start': True, 'recording.name': 'run'}
# [s] ros2 launch waits so long after Ctrl-C before it sends SIGTERM, and then SIGKILL
LAUNCH = 5.0
# [s] of CPU time from the signal to the end; the search takes some ten
ABANDONED = 2.0
SENT = 6


def catches(process, number):
    """Return whether a process has a handler for a signal."""
    status = Path(f'/proc/{process.pid}/status').read_text()
    return int(status.split('SigCgt:')[1].split()[0], 16) >> (number - 1) & 1


def flood(process, rng, period):
    """Send signals until the process has ended."""
    end = time.monotonic() + PATIENCE
    while process.poll() is None:
        assert time.monotonic() < end, 'still there'
        process.send_signal(signal.Signals[rng.choice(SIGNALS)])
        time.sleep(period)


TELLING = """
from fourbar_ros.ros.node import services
search = services.search
def tell(scene, request, *rest):
    if request.certify:
        print('proving', flush=True)
    return search(scene, request, *rest)
services.search = tell
"""


def test_a_certified_search_is_abandoned_and_the_bag_closed(run_node, client, tmp_path):
    """All quantities of a machine whose proofs take ten seconds: nobody waits for them."""
    node = run_node({**load_scene('jansen').values, 'drive.source': 'timer', 'drive.rate': 200.0,
                     'outputs': ['state', 'loads'], **recording_in(tmp_path)}, first=TELLING)
    client.listen(['state'])
    client.until(lambda: client.received['state'], 'the stream')
    # so that the next request arrives
    client.call('find_extrema', quantities=['?'])
    service = SERVICES['find_extrema']
    asked = client.service('find_extrema').call_async(resolve(service.type).Request(certify=True))
    client.until(lambda: 'proving' in node.said, 'the search')
    before, others = cpu_of(node.process.pid), cpu_of_ended()
    assert node.stop(signal.SIGINT) == 0, node.said
    assert cpu_of_ended() - others - before < ABANDONED
    assert 'Traceback' not in node.said
    bag = info(tmp_path / 'run', check=True)
    assert bag.is_sound and bag.ended == 'the node ended by SIGINT'
    # on a busy machine the node ends before the search has seen that it shall, and nobody answers
    began = time.monotonic()
    client.until(lambda: asked.done() or time.monotonic() - began > LAUNCH, 'an answer or none')
    assert not asked.done() or 'the node stops' in asked.result().message


@some('seed', range(SENT), 1)
def test_a_signal_at_any_moment_ends_it_with_a_whole_bag(run_node, tmp_path, seed):
    """While it starts, while it runs; half of them get others while it stops."""
    rng = random.Random(seed)
    node = run_node(RECORDING)
    while node.process.poll() is None and not catches(node.process, signal.SIGTERM):
        time.sleep(0.001)
    time.sleep(rng.choice([rng.uniform(0.0, 1.0), rng.uniform(1.0, 2.5)]))
    node.process.send_signal(signal.Signals[rng.choice(SIGNALS)])
    if rng.random() < 0.5:
        flood(node.process, rng, 0.02)
    assert node.wait() == 0, node.said
    assert 'Traceback' not in node.said and 'KeyboardInterrupt' not in node.said
    bag = tmp_path / 'bags/run'
    assert not bag.exists() or info(bag, check=True).is_sound


SLOW_DISK = """
import os, time
fsync = os.fsync
def slow(number):
    time.sleep(3.0)
    fsync(number)
os.fsync = slow
"""


@pytest.mark.slow
def test_a_slow_disk_at_the_end_of_a_bag_holds_up_no_input(run_node, client):
    """What is sent after the request to stop is answered before that: in order of events."""
    node = run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state']}, first=SLOW_DISK)
    client.listen(['state'])
    send = client.driving()
    assert client.call('start_recording', name='slow').success
    # the two have seen each other
    client.call('stop_recording')
    assert client.call('start_recording', name='slower').success
    stopping = client.service('stop_recording').call_async(
        resolve(SERVICES['stop_recording'].type).Request())
    for k in range(20):
        message = Motion(position=0.01 * k)
        message.header.stamp = Time(sec=k + 1)
        send(message)
        client.until(lambda k=k: len(client.received['state']) > k, f'answer {k}')
        assert not stopping.done()
    client.until(stopping.done, 'the end of the bag')
    path = Path(stopping.result().message)
    assert path.is_absolute() and info(path, check=True).is_sound
    client.until(lambda: f'recorded {path}' in node.said, 'the line of its log')


def test_a_flag_takes_signals_from_within_signals():
    """Each tenth of a millisecond, in the handler too: an Event would wait for its own lock."""
    before, numbers = signal.getsignal(signal.SIGALRM), [signal.Signals[name] for name in SIGNALS]
    signal.signal(signal.SIGALRM, lambda *_: [signal.raise_signal(number) for number in numbers])
    with caught_signals() as caught:
        signal.setitimer(signal.ITIMER_REAL, 1e-4, 1e-4)
        try:
            for _ in range(20_000):
                signal.raise_signal(signal.SIGTERM)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)
    assert len(caught) >= 20_000 and set(caught) <= set(numbers)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_script_that_starts_it_in_the_background_can_interrupt_it(run_node, client):
    """Its shell ignores SIGINT for what it starts with &."""
    node = run_node(PAPER, first='import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)')
    client.call('evaluate', position=0.5)
    assert catches(node.process, signal.SIGINT) and node.stop(signal.SIGINT) == 0


def test_under_nohup_it_stays_when_its_terminal_goes(run_node, client):
    node = run_node(PAPER, first='import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)')
    client.call('evaluate', position=0.5)
    assert not catches(node.process, signal.SIGHUP) and catches(node.process, signal.SIGTERM)
    node.process.send_signal(signal.SIGHUP)
    client.call('evaluate', position=0.5)
    assert node.process.poll() is None


def test_a_worker_survives_a_job_that_raises_and_ends_within_one_that_checks():
    said, done = [], threading.Event()
    worker = Worker('test', said.append)
    worker.do(lambda: 1 / 0)
    worker.do(done.set)
    assert done.wait(PATIENCE) and 'ZeroDivisionError' in said[0]

    done.clear()

    def search():
        done.set()
        try:
            while True:
                worker.check()
        except Abandoned:
            said.append('abandoned')
    worker.do(search)
    worker.do(lambda: said.append('never begun'))
    assert done.wait(PATIENCE)
    worker.stop(PATIENCE)
    assert said[1:] == ['abandoned']
