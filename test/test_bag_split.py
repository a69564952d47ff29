"""Bags of several files: as rosbag2 splits them, and as our recorder does."""
import json
import math

import pytest
import yaml
from mcap.writer import Writer

import bags
from fourbar_ros.bag import BagError, scan
from fourbar_ros.bag.diff import diff
from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recompute import compare
from fourbar_ros.bag.replay import play
from fourbar_ros.interfaces import OUTPUTS
from scenes import PAPER, RODS, TIP

FULL = {**PAPER, **RODS, **TIP, 'outputs': list(OUTPUTS), 'drive.source': 'motion'}
STEPS = 300


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return a bag of one file, steps 1 ms apart."""
    return bags.run(tmp_path_factory.mktemp('split'), 'run', FULL, [(0.05 * k, 25.0, 0.1 * k) for k in range(STEPS)],
                    paced=True, flush_period=0.01)


def as_rosbag2_splits(bag, directory, bounds, name='run', about=True, reverse=True):
    """Write a bag again with the mcap library as rosbag2 lays out a split one: channels numbered anew in each file."""
    folder = directory / name
    folder.mkdir()
    metadata = Bag(bag).metadata()
    raws, files = list(Bag(bag).raw()), []
    source = Bag(bag)
    list(source.chunks())
    for part, (begin, end) in enumerate(zip((0, *bounds), (*bounds, len(raws)))):
        files.append(f'{name}_{part}.mcap')
        with open(folder / files[-1], 'wb') as file:
            writer = Writer(file, chunk_size=20_000)
            writer.start('ros2', 'libmcap 1.3.0')
            channels = sorted(source.channels.values(), key=lambda c: c.topic, reverse=reverse and part % 2 == 1)
            numbers, schemas = {}, {}
            for channel in channels:
                type_name = source.type_of(channel.topic)
                if type_name not in schemas:
                    schemas[type_name] = writer.register_schema(type_name, 'ros2msg', bags.text_of(type_name).encode())
                numbers[channel.topic] = writer.register_channel(channel.topic, 'cdr', schemas[type_name], channel.metadata)
            for raw in raws[begin:end]:
                writer.add_message(numbers[raw.topic], raw.time, raw.data, raw.time, 0)
            told = {**metadata, 'relative_file_paths': [files[-1]], 'custom_data': metadata['custom_data'] if about else {}}
            writer.add_metadata('rosbag2', {'serialized_metadata': yaml.safe_dump(told)})
            writer.finish()
    (folder / 'metadata.yaml').write_text(yaml.safe_dump({'rosbag2_bagfile_information': {
        **metadata, 'relative_file_paths': files}}))
    return folder


def content(path, **kwargs):
    return [(raw.topic, raw.type, raw.time, raw.data) for raw in Bag(path).raw(**kwargs)]


def test_a_bag_split_by_rosbag2_is_read_as_one(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, (700, 701, 1500))
    assert content(split) == content(bag) and len(Bag(split).files) == 4
    assert len({channel.id for channel in Bag(split / 'run_1.mcap').summary().channels.values()}) == len(OUTPUTS) + 2
    for topic in ('/fourbar/state', '/fourbar/points/tip'):
        assert content(split, topics=[topic]) == content(bag, topics=[topic])
    assert {topic.topic: topic.messages for topic in info(split).topics} == {
        topic.topic: topic.messages for topic in info(bag, check=True).topics}
    assert all(topic.is_same() for topic in diff(bag, split))
    found = compare(split)
    assert found.inputs == STEPS and found.unmatched == 0 and max(d.largest for d in found.differences) == 0.0
    assert [raw.data for raw in play(split, rate=math.inf)] == [raw.data for raw in Bag(bag).raw()]
    assert content(split / 'run_2.mcap') == content(bag)[701:1500]


def test_parts_are_in_the_order_of_their_numbers_not_of_their_names(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, tuple(range(100, 1200, 100)))
    (split / 'metadata.yaml').unlink()
    assert [file.name for file in Bag(split).files] == [f'run_{k}.mcap' for k in range(12)]
    assert content(split) == content(bag)


def test_files_of_different_bags_in_one_folder_are_not_mixed(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, (700,))
    (split / 'other_0.mcap').write_bytes((bag / 'run_0.mcap').read_bytes())
    with pytest.raises(BagError, match='of different bags, name one'):
        Bag(split)


def test_only_the_chunks_that_can_matter_are_read(bag, tmp_path, monkeypatch):
    split = as_rosbag2_splits(bag, tmp_path, (700, 1500))
    read = []
    record_at = scan.Scan._record_at
    monkeypatch.setattr(scan.Scan, '_record_at', lambda self, offset, wait=False: read.append(offset) or record_at(
        self, offset, wait))
    times = [raw.time for raw in Bag(split).raw()]
    everything = len(read)
    for share in (0.5, 0.9, 0.99):
        start = times[0] + round((times[-1] - times[0]) * share)
        read.clear()
        assert content(split, start=start) == [item for item in content(bag) if item[2] >= start]
        read.clear()
        list(Bag(split).raw(start=start))
        assert len(read) < (1.2 - share) * everything / 2             # message indices are passed over as well
    read.clear()
    assert len(list(Bag(split).raw(['/fourbar/scene']))) == 1 and len(read) < everything / 10


def test_a_damaged_chunk_that_is_read_by_the_index_is_an_error(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, (700,))
    file = split / 'run_1.mcap'
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 4
    file.write_bytes(data)
    with pytest.raises(BagError, match=r'run_1.mcap: at byte \d+: chunk'):
        list(Bag(split).raw(['/fourbar/state']))
