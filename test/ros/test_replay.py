# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A bag on the wire again, a live node driven by a bag, recording from the command line."""
import math
import os
import signal
import subprocess
import sys
from types import SimpleNamespace

from bag.test_other_writers import by_mcap
from fourbar_ros.bag import metadata
from fourbar_ros.bag.comparison import diff
from fourbar_ros.bag.reader import Bag, records
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.errors import FourBarError
from fourbar_ros.ros import messages, replay
from fourbar_ros.ros.refusals import init
import pytest
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from support import bags
from support.harness import ALL_OUTPUTS, LATCHED, nanoseconds, PATIENCE, recording_in
from support.scenes import PAPER, RODS

FULL = {**PAPER, **RODS, 'outputs': ALL_OUTPUTS, 'drive.source': 'motion'}
STEPS = 300
QOS = 'qos_overrides./fourbar/input.subscription.'
NOTHING_MISSED = {f'{QOS}depth': 2 * STEPS, f'{QOS}reliability': 'reliable'}  # on a busy machine


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
    return [nanoseconds(m) for m in messages]


def test_replay_sends_every_message_again_as_it_was(client, bag):
    client.listen([*ALL_OUTPUTS, 'driven'], depth=20_000)     # a busy machine reads late
    late = client.hear(String, '/fourbar/scene', LATCHED)
    process = fourbar('replay', bag, '--loop', '--rate', '2')
    client.until(lambda: all(len(m) > 2 * STEPS for m in client.received.values()), 'two rounds')
    process.send_signal(signal.SIGINT)
    code, said = finished(process, client)
    assert code == 130 and 'messages published' in said, said
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
                assert (list(ours.position), ours.name) == (theirs.position.tolist(), theirs.name)


def test_replay_sends_every_message_of_a_file_without_chunks(client, bag, tmp_path):
    file = by_mcap(bag, tmp_path / 'run_0.mcap', use_chunking=False)
    process = fourbar('replay', file, '--rate', '4', '--topics', '/fourbar/state')
    assert finished(process, client) == (0, f'{STEPS} messages published\n')


def test_the_clock_of_a_bag_of_simulated_time_is_simulated(client, bag):
    clocks = client.hear(Clock, '/clock')        # stamps begin at 2 ms, log times are of today
    process = fourbar('replay', bag, '--clock', '200', '--rate', '0.5', '--topics',
                      '/joint_states', '--start', '0.1', '--delay', '5')
    client.until(lambda: client.node.count_publishers('/clock'), 'the clock')
    assert finished(process, client)[0] == 0
    times = [c.clock.sec * 10**9 + c.clock.nanosec for c in clocks]
    # 0.5 s of the bag in 1 s: 200 at most; fewer as far as the machine is busy
    assert times == sorted(times) and 2 < len(times) <= 201
    assert 10**8 <= times[0] < 3 * 10**8 < times[-1] < 602 * 10**6


def test_motions_with_unknown_rates_are_left_out_and_counted(run_node, client, tmp_path):
    """The node would estimate what the recorded one did not know."""
    path = bags.run(tmp_path, 'gaps', FULL, [
        (0.05 * k, math.nan if k % 10 > 5 else 25.0, math.nan if k % 10 > 4 else 0.1)
        for k in range(STEPS)], step_ns=2 * 10**6, paced=True)
    run_node(FULL)
    code, said = finished(fourbar('replay', path, '--inputs-only'), client)
    assert code == 0 and f'{STEPS // 2} motions left out: their rates were unknown' in said, said
    assert f'{STEPS // 2} messages published' in said


def test_the_clock_goes_on_between_messages_that_are_far_apart(client, tmp_path):
    writer = BagWriter(tmp_path, 'run', [bags.channel('/text', 'std_msgs/msg/String')], {})
    for k in range(2):
        writer.clock = lambda k=k: 10**18 + k * 10**9
        writer.write(0, bags.encode('std_msgs/msg/String', data='text'))
    clocks = client.hear(Clock, '/clock')
    process = fourbar('replay', writer.close(), '--clock', '50', '--delay', '3')
    assert finished(process, client)[0] == 0
    assert 3 < len({c.clock.nanosec for c in clocks}) <= 51


def test_the_clock_follows_simulated_time_that_stands_and_begins_again(client, tmp_path):
    """Log times go on meanwhile, also those of a message without a stamp."""
    text = bags.channel('/text', 'std_msgs/msg/String')
    writer = BagWriter(tmp_path, 'run', [bags.MOTION, text], {})
    # (log time, stamp of simulated time or none) [s]
    for log, stamp in ((0.0, None), (0.1, 1.0), (0.2, 1.1), (0.9, None), (1.3, 1.2), (1.4, 1.15),
                       (1.5, 1.25), (1.6, 0.2), (1.8, 0.3)):
        writer.clock = lambda log=log: 10**18 + round(log * 1e9)
        writer.write(*((1, bags.encode('std_msgs/msg/String', data='text')) if stamp is None else
                       (0, bags.motion(round(stamp * 1e9)))))
    clocks = client.hear(Clock, '/clock')
    process = fourbar('replay', writer.close(), '--clock', '1000', '--delay', '3')
    assert finished(process, client)[0] == 0
    times = [c.clock.sec + 1e-9 * c.clock.nanosec for c in clocks]
    back = [k for k in range(1, len(times)) if times[k] < times[k - 1]]
    assert len(back) == 1 and max(times) < 1.251 and 0.199 < min(times) == times[back[0]]


def test_a_replay_that_skips_latches_and_one_that_is_late_has_a_clock(client, tmp_path):
    text = bags.channel('/text', 'std_msgs/msg/String', 1, latched=True)
    writer = BagWriter(tmp_path, 'run', [
        text, bags.MOTION, bags.channel('/clock', 'rosgraph_msgs/msg/Clock')], {})
    for k in range(200):
        writer.clock = lambda k=k: 10**18 + k * 10**7
        if k < 50:
            writer.write(0, bags.encode('std_msgs/msg/String', data=str(k)))
        writer.write(1, bags.motion(10**9 + k * 10**7))
        writer.write(2, bags.encode('rosgraph_msgs/msg/Clock', clock=bags.stamp(k).stamp))
    clocks, texts = client.hear(Clock, '/clock'), client.hear(String, '/text', LATCHED)
    process = fourbar('replay', writer.close(), '--clock', '--start', '1', '--rate', '1e6',
                      '--loop')
    client.until(lambda: clocks and '49' in [t.data for t in texts], 'the latched text, a clock')
    process.send_signal(signal.SIGINT)
    finished(process, client)
    assert all(c.clock.sec in (2, 3) for c in clocks)


def test_a_live_node_driven_by_the_bag_records_the_same_answers(run_node, client, bag, tmp_path):
    node = run_node({**FULL, **NOTHING_MISSED, **recording_in(tmp_path)})
    code, said = finished(fourbar('replay', bag, '--inputs-only'), client)
    assert code == 0 and f'{STEPS} messages published' in said, said
    client.until(lambda: len(list(Bag(tmp_path / 'run').raw(['/fourbar/state']))) >= STEPS,
                 'all answers')
    assert node.stop() == 0
    found = {topic.topic: topic for topic in diff(bag, tmp_path / 'run')}
    for name in ('state', 'loads', 'driven', 'output', 'shaking_wrench'):
        topic = found[f'/fourbar/{name}']
        assert topic.messages == STEPS and topic.is_same(), topic
    assert found['/joint_states'].is_same()


def test_what_cannot_be_replayed_is_one_line(client, bag):
    wrong = [(['replay', bag, '--topics', '/none'], 'no message on /none'),
             (['replay', bag, '--start', '99', '--delay', '0'], 'no message after 99 s'),
             (['replay', bag, '--start', '99', '--loop', '--delay', '0'], 'no message after 99'),
             (['replay', bag, '--inputs-only', '--node', '/nobody'], 'no run of /nobody'),
             (['replay', bag, '--inputs-only'], 'no node listens on /fourbar/input'),
             (['replay', bag, '--ros-args', '-r', 'wrong'], 'remap rule'),
             (['replay', bag, '--ros-args', '--wrong'], 'ROS 2 knows no argument'),
             (['record', 'stop', '--node', '/no body'], '/no body/stop_recording'),
             (['record', 'start', '--node', '/nobody', '--wait', '1'], '/nobody')]
    for (_, said), process in zip(wrong, [fourbar(*words) for words, _ in wrong]):
        code, text = finished(process, client)
        last = text.splitlines()[-1]
        assert code == 1 and last.startswith('fourbar: ') and said in last, text
        assert 'Traceback' not in text


def test_ros_that_runs_already_is_not_said_to_have_no_log(client):
    with pytest.raises(FourBarError, match='^rclpy is initialised already'):
        init()


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


@pytest.mark.parametrize('offered', [
    ': : :', '{a: 1}', '- 3', '- depth: much', '- {depth: 100000000000, durability: [1]}'])
def test_names_and_quality_of_service_that_ros_does_not_know_stop_no_other_topic(
        client, tmp_path, offered):
    """Anybody may have made the bag."""

    class Strange(metadata.Channel):

        @property
        def metadata(self):
            return {**super().metadata, metadata.QOS: offered}
    good = bags.channel('/good', 'std_msgs/msg/String')
    writer = BagWriter(tmp_path, 'run', [Strange(*good), good._replace(topic='/no name')], {})
    for number in (0, 1, 0):
        writer.write(number, bags.encode('std_msgs/msg/String', data='text'))
    code, said = finished(fourbar('replay', writer.close(), '--delay', '0'), client)
    assert code == 0 and '2 messages published' in said and "'/no name': left out" in said, said


def test_a_bag_without_stamps_is_not_read_to_its_end_before_the_first_message(
        monkeypatch, tmp_path):
    monkeypatch.setattr(replay, 'MOST_WAITING', 100)
    writer = BagWriter(tmp_path, 'run', [bags.MOTION], {})
    for _ in range(250):
        writer.write(0, bags.motion(0))
    read, bag = [], Bag(writer.close())

    class Counted(Bag):

        def raw(self, *topics):
            for message in super().raw(*topics):
                read.append(message)
                yield message
    publishers = {topic: SimpleNamespace(msg_type=messages.resolve(type_name))
                  for topic, type_name in bag.types.items()}
    sent = replay._messages(Counted(bag.path), publishers, False)
    next(sent)
    assert len(read) == 100 and 1 + len([*sent]) == len(read) == 250


def test_messages_before_the_first_in_the_file_are_sent(client, tmp_path):
    writer = BagWriter(tmp_path, 'run', [bags.channel('/text', 'std_msgs/msg/String')], {})
    for time in (0.02, 0.01, 0.0, 0.1):
        writer.clock = lambda time=time: 10**18 + round(time * 1e9)
        writer.write(0, bags.encode('std_msgs/msg/String', data='text'))
    code, said = finished(fourbar('replay', writer.close(), '--delay', '0'), client)
    assert code == 0 and said == '4 messages published\n', said


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
    assert found.inputs > 20 and found.largest == 0.0
    code, said = finished(fourbar('record', 'stop', '--wait', '120'), client)
    assert code == 1 and 'not recording' in said
