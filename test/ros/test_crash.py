"""A real node, killed, or with a full disk, or splitting its bag: what the bag holds."""
import random
import time

from bag.test_recorder import assert_every_reader_takes
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag, records
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.recorder import FLUSH
from fourbar_ros.bag.recovery import recover
from rosbags.rosbag2 import Reader
from support.harness import ALL_OUTPUTS, recomputed, recording_in
from support.samples import some
from support.scenes import PAPER, RODS

RATE = 200.0
SLACK = 5.0             # [s] of a busy machine; test/bag/test_crash.py measures it


def recording_node(run_node, tmp_path, **others):
    return run_node({**PAPER, **RODS, 'drive.speed': 25.0, 'drive.rate': RATE,
                     'outputs': ALL_OUTPUTS, **recording_in(tmp_path / 'bags'), **others})


def whole_steps(path):
    """Return the driven joint's stamps in a bag; every step but the last is whole."""
    stamps = {}
    for record in records(path):
        if record.topic != '/fourbar/scene':
            stamp = record.message.header.stamp
            stamps.setdefault((stamp.sec, stamp.nanosec), []).append(record.topic)
    kept = list(stamps.values())
    assert all(len(topics) == 1 + len(ALL_OUTPUTS)
               and topics[0] == '/fourbar/driven' for topics in kept[:-1])
    return list(stamps)


@some('seed', range(3), 1)
def test_a_killed_node_leaves_all_but_the_newest_and_it_recomputes_exactly(
        run_node, client, tmp_path, seed):
    node = recording_node(run_node, tmp_path)
    client.listen(['driven'])
    heard = client.received['driven']
    client.until(lambda: len(heard) > 100, 'the stream')
    end = time.monotonic() + random.Random(seed).uniform(0.0, 1.0)
    while time.monotonic() < end:
        client.executor.spin_once(timeout_sec=0.01)
    node.process.kill()
    node.process.wait()
    last = heard[-1].header.stamp
    path = tmp_path / 'bags/run'
    assert not info(path, check=True).is_finished
    stamps = whole_steps(path)
    # what was heard is in the bag, but for the newest
    lost = (last.sec - stamps[-1][0]) + (last.nanosec - stamps[-1][1]) * 1e-9
    assert lost <= FLUSH + SLACK
    period = 1.0 / RATE
    steps = [(b[0] - a[0]) + (b[1] - a[1]) * 1e-9 for a, b in zip(stamps, stamps[1:])]
    # on the grid; a node that is more than a second late leaves samples out
    assert all(abs(step - round(step * RATE) * period) < 1e-6 and step > 0.5 * period
               for step in steps)
    recovered = recover(path)
    found = recompute(recovered.path)
    assert found.largest == 0.0 and found.inputs == len(
        stamps) and not found.is_cut
    assert_every_reader_takes(recovered.path, recovered.messages)


def test_a_recording_that_dies_is_reported_once_and_the_stream_goes_on(run_node, client, diagnosed,
                                                                       tmp_path):
    import resource
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    # the node inherits it: a full disk
    resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, limit[1]))
    try:
        node = recording_node(run_node, tmp_path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    client.listen(['driven'])
    client.until(lambda: 'recording stopped' in node.said, 'the disk is full')
    client.until(lambda: 'recording stopped' in diagnosed()[0].message, 'the diagnostics say so')
    client.received['driven'].clear()
    client.until(lambda: len(client.received['driven']) > 100, 'the stream goes on')
    answer = client.call('stop_recording')
    assert not answer.success and 'recording stopped' in answer.message
    path = tmp_path / 'bags/run'
    assert recompute(path).largest == 0.0 and recompute(path).inputs > 50
    assert recover(path, tmp_path / 'again').messages > 300
    assert client.call('start_recording', name='small').success
    assert client.call('stop_recording').success
    assert node.stop() == 0 and node.said.count('recording stopped') == 1


def test_a_node_splits_its_bag_by_its_parameters(run_node, client, tmp_path):
    node = recording_node(run_node, tmp_path, **{'recording.split_duration': 0.3})
    path = tmp_path / 'bags/run'
    client.until(lambda: (path / 'run_3.mcap').exists(), 'the files')
    assert node.stop() == 0
    found = info(path, check=True)
    assert found.is_sound and found.missing == 0 and found.files > 3 and info(path).is_sound
    whole = recomputed(path)
    assert whole.inputs > 100 and not whole.skipped
    for file in Bag(path).files[:3]:
        recomputed(file)
        assert info(file, check=True).is_sound
    with Reader(path) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages())
