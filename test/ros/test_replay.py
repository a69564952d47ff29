# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A bag on the wire again, a live node driven by a bag, recording from the command line."""
import math
import os
import re
import signal
import subprocess
import sys
import time

from fourbar_msgs.msg import Motion
from fourbar_ros.bag.reader import Bag, records
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.ros.clients.rerun import stamp_of
from fourbar_ros.ros.messages import resolve
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from support import bags
from support.harness import ALL_OUTPUTS, PATIENCE
from support.scenes import PAPER, RODS, TIP

FULL = {**PAPER, **RODS, 'outputs': ALL_OUTPUTS, 'drive.source': 'motion'}
STEPS = 300


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return a bag of steps 2 ms apart, in its log times too."""
    return bags.run(tmp_path_factory.mktemp('replay'), 'run', FULL,
                    [(0.05 * k, 25.0, 0.1) for k in range(STEPS)],
                    step_ns=2 * 10**6, paced=True)


def fourbar(*arguments):
    return subprocess.Popen([sys.executable, '-m', 'fourbar_ros', *map(str, arguments)],
                            env=os.environ, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def finished(process, client):
    """Handle messages until a process ends; return (exit code, what it said)."""
    client.until(lambda: process.poll() is not None, 'the end of the command', 2 * PATIENCE)
    return process.returncode, process.communicate()[0]


def stamps(messages):
    return [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]


def test_replay_sends_every_message_again_as_it_was(client, bag):
    client.listen([*ALL_OUTPUTS, 'driven'], depth=20_000)     # a busy machine reads late
    late = []
    client.node.create_subscription(String, '/fourbar/scene', late.append,
                                    QoSProfile(depth=1,
                                               durability=DurabilityPolicy.TRANSIENT_LOCAL))
    process = fourbar('replay', bag, '--loop', '--rate', '2')
    client.until(lambda: all(len(m) > 2 * STEPS for m in client.received.values()), 'two rounds')
    process.send_signal(signal.SIGINT)
    code, said = finished(process, client)
    assert code == 130 and 'messages published' in said
    # latched again
    assert late and late[0].data == next(records(bag, ['/fourbar/scene'])).message.data
    for name, topic in (('state', '/fourbar/state'), ('joint_states', '/joint_states')):
        recorded = [r.message for r in records(bag, [topic])]
        heard = client.received[name]
        # from the second round on nothing is missed
        first = stamps(heard).index(stamps(recorded)[0], 1)
        assert stamps(heard[first:first + STEPS]) == stamps(recorded)
        for ours, theirs in zip(heard[first:first + STEPS], recorded):
            if name == 'state':
                assert (ours.theta4, ours.omega4, ours.alpha4) == (theirs.theta4, theirs.omega4,
                                                                   theirs.alpha4)
            else:
                assert list(ours.position) == theirs.position and list(ours.name) == theirs.name


@pytest.mark.slow
def test_the_clock_of_the_bag_is_published_at_its_rate(client, bag):
    clocks = []
    client.node.create_subscription(Clock, '/clock', clocks.append, 1000)
    process = fourbar('replay', bag, '--clock', '200', '--rate', '0.5', '--topics',
                      '/joint_states', '--start', '0.1',
                      '--delay', '5')
    client.until(lambda: client.node.count_publishers('/clock'), 'the clock')
    code, _ = finished(process, client)
    assert code == 0
    times = [c.clock.sec * 10**9 + c.clock.nanosec for c in clocks]
    first, last = 2 * 10**6, STEPS * 2 * 10**6          # by its stamps, which are far from today
    assert times == sorted(times) and first + 10**8 <= times[0] < first + 11 * 10**7
    assert last - 10**7 <= times[-1] <= last
    step, period = (times[-1] - times[0]) / (len(times) - 1), 10**9 / 200 * 0.5     # of the bag
    # never faster; slower as far as the machine is busy
    assert period <= step < 4 * period


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGHUP], ids=lambda s: s.name)
def test_an_interrupted_replay_says_so_by_its_exit_code(client, bag, number):
    client.listen(['state'])
    process = fourbar('replay', bag, '--loop', '--delay', '0')
    client.until(lambda: client.received['state'], 'the first message')
    process.send_signal(number)
    code, said = finished(process, client)
    assert code == 128 + number and 'messages published' in said and 'Traceback' not in said


def test_a_start_behind_the_end_is_refused(client, bag):
    process = fourbar('replay', bag, '--start', '77')
    code, said = finished(process, client)
    assert (code, said) == (1, 'fourbar: --start 77: the bag ends after 0.598 s\n')


def test_the_clock_of_a_bag_of_simulated_time_is_simulated(client, bag):
    clocks = []         # its stamps begin at 2 ms, its log times are of today
    client.node.create_subscription(Clock, '/clock', clocks.append, 1000)
    client.listen(['state'])
    process = fourbar('replay', bag, '--clock', '200', '--topics', '/fourbar/state', '--start',
                      '0.1')
    assert finished(process, client)[0] == 0
    times = [c.clock.sec * 10**9 + c.clock.nanosec for c in clocks]
    assert times == sorted(times) and times and set(times) <= set(range(10**8, 602 * 10**6,
                                                                        2 * 10**6))


def test_a_live_node_driven_by_the_bag_answers_exactly_what_was_recorded(run_node, client, bag,
                                                                         tmp_path):
    run_node(FULL)
    code, said = finished(fourbar('replay', bag, '--inputs-only'), client)
    assert code == 0, said
    lines = [line.split() for line in said.splitlines() if line.startswith('/')]
    assert (len(lines) == len(ALL_OUTPUTS) and all(line[1:4] == [str(STEPS), '0', '0']
                                                   for line in lines)), said


@pytest.mark.slow
def test_motions_with_unknown_rates_are_left_out_and_counted(run_node, client, tmp_path):
    """The node would estimate what the recorded one did not know: an infinite difference."""
    path = bags.run(tmp_path, 'gaps', FULL, [
        (0.05 * k, math.nan if k % 10 > 5 else 25.0, math.nan if k % 10 > 4 else 0.1)
        for k in range(STEPS)], step_ns=2 * 10**6, paced=True)
    run_node(FULL)
    code, said = finished(fourbar('replay', path, '--inputs-only'), client)
    assert code == 0 and f'{STEPS // 2} motions left out: their rates were unknown' in said, said
    lines = [line.split() for line in said.splitlines() if line.startswith('/')]
    assert lines and all(line[1:4] == [str(STEPS // 2), '0', '0'] for line in lines), said


@pytest.mark.slow
def test_the_scene_of_a_bag_runs_a_node(client, bag, tmp_path):
    code, text = finished(fourbar('bag', 'scene', bag), client)
    assert code == 0
    (tmp_path / 'again.yaml').write_text(text)
    node = subprocess.Popen([sys.executable, '-m', 'fourbar_ros.ros.node.start', '--ros-args',
                             '--params-file',
                             str(tmp_path / 'again.yaml'), '-r', '__node:=again'], env=os.environ,
                            cwd=tmp_path)
    try:
        client.until(lambda: node.poll() is not None or 'again' in client.node.get_node_names(),
                     'the node')
    finally:
        node.send_signal(signal.SIGTERM)
        assert node.wait(PATIENCE) == 0


@pytest.mark.slow
def test_points_are_compared_and_changes_of_the_scene_are_reported_and_taken_over(
        run_node, client, tmp_path):
    values = {**FULL, **TIP, 'outputs': [*ALL_OUTPUTS, 'points']}
    changes = {100: {'linkage.a1': 0.35}, 200: {'linkage.mode': 1, 'gravity.y': -9.81}}
    path = bags.run(tmp_path, 'changed', values, [(0.05 * k, 25.0, 0.1) for k in range(STEPS)],
                    changes,
                    step_ns=2 * 10**6, paced=True)
    node = run_node(values)
    code, said = finished(fourbar('replay', path, '--inputs-only'), client)
    assert code == 0, said
    lines = {line.split()[0]: line.split()[1:4] for line in said.splitlines()
             if line.startswith('/')}
    assert (lines.pop('/fourbar/points/tip') == [str(STEPS), '0', '0'] and len(lines)
            == len(ALL_OUTPUTS)), said
    assert all(line == [str(STEPS), '0', '0'] for line in lines.values()), said
    for change in ('linkage.a1 0.35', 'linkage.mode 1, gravity.y -9.81'):
        assert re.search(rf'scene of the bag changed after 0\.\d+ s: {change}: applied',
                         said), said
    assert node.stop() == 0
    run_node(values, name='again')
    code, said = finished(fourbar('replay', path, '--inputs-only', '--start', '0.5', '--node',
                                  '/again'), client)
    assert code == 0, said
    lines = [line.split() for line in said.splitlines() if line.startswith('/')]
    first = next(Bag(path).raw()).time
    left = sum(raw.time >= first + 5 * 10**8 for raw in Bag(path).raw(['/fourbar/driven']))
    assert (0 < left < 100 and all(line[1:4] == [str(left), '0', '0'] for line in lines)
            and len(lines) == len(ALL_OUTPUTS) + 1), said


@pytest.mark.slow
def test_a_node_that_stands_still_for_a_while_loses_no_input(run_node, client, bag):
    """The rest of the bag is more than its queue holds."""
    node = run_node(FULL)
    client.listen(['state'])
    publisher = client.publisher()
    client.handshake(lambda: publisher.publish(Motion(position=0.1)))
    replay = fourbar('replay', bag, '--inputs-only')
    client.until(lambda: client.received['state'] or replay.poll() is not None, 'an answer')
    node.process.send_signal(signal.SIGSTOP)
    try:
        time.sleep(0.7)              # all the bag takes 0.6 s
    finally:
        node.process.send_signal(signal.SIGCONT)
    code, said = finished(replay, client)
    assert code == 0, said


@pytest.mark.slow
def test_a_node_that_does_not_know_its_publisher_yet_misses_no_motion(client, bag):
    """A subscription that ignores the first messages and answers from the bag plays the node."""
    recorded = {}
    for raw in Bag(bag).raw():
        if raw.topic != '/fourbar/scene':
            recorded.setdefault(stamp_of(raw.data), []).append(raw)
    types = {topic['topic_metadata']['name']: topic['topic_metadata']['type']
             for topic in Bag(bag).metadata()['topics_with_message_count']}
    publishers = {topic: client.node.create_publisher(resolve(kind),
                                                      topic.replace('/fourbar/', '/late/'), 1000)
                  for topic, kind in types.items()}
    heard = []

    def take(motion):
        heard.append(stamp_of(motion))
        if len(heard) > 3:
            for raw in recorded[heard[-1]]:
                publishers[raw.topic].publish(bytes(raw.data))
    client.node.create_subscription(Motion, '/late/input', take, 1000, raw=True)
    code, said = finished(fourbar('replay', bag, '--inputs-only', '--node', '/late'), client)
    assert code == 0, said
    assert heard[:4] == [heard[0]] * 4 and set(heard) == set(recorded)


def test_readers_that_are_waited_for_hear_the_first_message(client, bag):
    client.listen([*ALL_OUTPUTS, 'driven'], depth=20_000)     # a busy machine reads late
    code, said = finished(fourbar('replay', bag, '--readers', len(ALL_OUTPUTS) + 1), client)
    assert code == 0 and re.match(r'0\.\d+ s, from 20', said), said
    for name, heard in client.received.items():
        topic = '/joint_states' if name == 'joint_states' else f'/fourbar/{name}'
        assert stamps(heard) == stamps([r.message for r in records(bag, [topic])]), name


@pytest.mark.slow
def test_a_bag_of_rosbag2_drives_a_live_node_from_its_topics(run_node, client, bag, tmp_path):
    """No word of the scene in its metadata; each step noted in the reverse order."""
    told = [topic['topic_metadata'] for topic in Bag(bag).metadata()['topics_with_message_count']]
    writer = BagWriter(tmp_path, 'rosbag2', [bags.channel(topic['name'], topic['type'])
                                             for topic in told], {})
    numbers = {topic['name']: i for i, topic in enumerate(told)}
    raws = list(Bag(bag).raw())
    steps = [raws[1 + k * (len(raws) // STEPS):1 + (k + 1) * (len(raws) // STEPS)]
             for k in range(STEPS)]
    for raw in raws[:1] + [raw for step in steps
                           for raw in (step if step is steps[0] else step[::-1])]:
        writer.clock.now = lambda raw=raw: raw.time
        writer.write(numbers[raw.topic], raw.data)
    path = writer.close()
    assert not recompute(path).problems()
    run_node(FULL)
    code, said = finished(fourbar('replay', path, '--inputs-only'), client)
    lines = [line.split() for line in said.splitlines() if line.startswith('/')]
    assert code == 0 and len(lines) == len(ALL_OUTPUTS), said
    assert all(line[1:4] == [str(STEPS), '0', '0'] for line in lines), said


def test_a_live_node_of_another_linkage_is_found_out(run_node, client, bag):
    run_node({**FULL, 'linkage.a2': 1.2000001}, name='other')
    code, said = finished(fourbar('replay', bag, '--inputs-only', '--node', '/other', '--rate',
                                  '2'), client)
    assert code == 3, said
    assert all(float(line.split()[3]) > 0.0 for line in said.splitlines()
               if line.startswith('/')), said


def test_a_node_that_is_not_there_is_one_line(client, bag):
    commands = (['replay', bag, '--inputs-only', '--node', '/nobody'],
                ['record', 'start', '--node', '/nobody'])
    for process in [fourbar(*command) for command in commands]:
        code, said = finished(process, client)
        assert code == 1 and said.startswith('fourbar: ') and said.count('\n') == 1, said


def test_messages_of_another_definition_are_left_out_and_reported(client, tmp_path):
    good = bags.channel('/good', 'std_msgs/msg/String')
    other = good._replace(topic='/other', hash='RIHS01_' + '0' * 64)
    writer = BagWriter(tmp_path, 'run',
                       [good, other, good._replace(topic='/unknown', type='no_msgs/msg/Such')], {})
    for number in (0, 1, 2, 0):
        writer.write(number, bags.encode('std_msgs/msg/String', data='text'))
    code, said = finished(fourbar('replay', writer.close(), '--delay', '0'), client)
    assert code == 0 and '2 messages published' in said, said
    assert ('/other: left out' in said and 'another definition' in said
            and 'no_msgs/msg/Such is not installed' in said)


@pytest.mark.slow
def test_a_bag_being_written_is_replayed_to_its_end(run_node, client, tmp_path):
    node = run_node({**PAPER, 'outputs': ['state'], 'recording.directory': str(tmp_path),
                     'recording.start': True,
                     'recording.name': 'run'})
    client.listen(['state'])
    client.until(lambda: client.received['state'], 'the stream')
    process = fourbar('replay', tmp_path / 'run', '--follow', '--rate', '1', '--topics',
                      '/fourbar/state',
                      '--ros-args', '-r', '/fourbar/state:=/again/state')
    client.listen(['state'], node='again')
    count = len(client.received['state'])
    client.until(lambda: client.node.count_publishers('/again/state')
                 and len(client.received['state']) > count + 100,
                 'the replay')
    assert node.stop() == 0
    code, said = finished(process, client)
    assert code == 0, said
    assert int(said.split()[-3]) == len(list(Bag(tmp_path / 'run').raw(['/fourbar/state']))), said


def test_recording_from_the_command_line(run_node, client, tmp_path):
    run_node({**PAPER, 'outputs': ['state'], 'recording.directory': str(tmp_path / 'bags')})
    client.listen(['state'])
    client.until(lambda: client.received['state'], 'the stream')
    code, said = finished(fourbar('record', 'start', 'named', '--wait', '120'), client)
    assert code == 0 and said.strip() == str(tmp_path / 'bags/named')
    count = len(client.received['state'])
    client.until(lambda: len(client.received['state']) > count + 20, 'samples')
    code, said = finished(fourbar('record', 'stop', '--wait', '120'), client)
    assert code == 0 and said.strip() == str(tmp_path / 'bags/named')
    found = recompute(tmp_path / 'bags/named')
    assert found.inputs > 20 and max(d.largest for d in found.differences) == 0.0
    code, said = finished(fourbar('record', 'stop', '--wait', '120'), client)
    assert code == 1 and 'not recording' in said
