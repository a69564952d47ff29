# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Bags of other recorders and converters, and files made to do harm.

Right values, or one line within bounds.
"""
import csv
import json
import subprocess
import sys
import time

from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.diff import diff
from fourbar_ros.bag.export import export
from fourbar_ros.bag.mcap.records import encoded, HEAD, MAGIC
from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag, records
from fourbar_ros.bag.recover import recover
from fourbar_ros.cli.main import main
import lz4.frame
from mcap.records import Channel, Chunk, Header, Schema
from mcap.writer import CompressionType, Writer
import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from support import bags
from support.bags import STORE
from support.samples import some
import zstandard

STRING, JOINTS, IMAGE = ('std_msgs/msg/String', 'sensor_msgs/msg/JointState',
                         'sensor_msgs/msg/Image')
CUSTOM = 'custom_data'


def text(value):
    return bags.encode(STRING, data=value)


def joints(names, k=0):
    return bags.encode(JOINTS, header=bags.stamp(k), name=list(names),
                       position=np.arange(float(len(names))) + k,
                       velocity=np.zeros(0), effort=np.zeros(0))


def image(k, size):
    return bags.encode(IMAGE, header=bags.stamp(k), height=1, width=size, encoding='mono8',
                       is_bigendian=0, step=size,
                       data=np.full(size, k, np.uint8))


def write(path, messages, metadata=None, profile='ros2', encoding='cdr', schemas=None,
          compression=CompressionType.ZSTD):
    """Write (topic, type, data) with the mcap library, 1 ms apart; return the path."""
    with open(path, 'wb') as file:
        writer = Writer(file, compression=compression)
        writer.start(profile, 'test')
        numbers = {}
        for k, (topic, kind, data) in enumerate(messages):
            if (topic, kind) not in numbers:
                definition = (schemas or {}).get(kind) or bags.text_of(kind).encode()
                schema = writer.register_schema(kind, 'ros2msg', definition)
                numbers[topic, kind] = writer.register_channel(topic, encoding, schema, {})
            writer.add_message(numbers[topic, kind], 10**9 + k * 10**6, data, 10**9 + k * 10**6)
        if metadata is not None:
            writer.add_metadata(rosbag2.RECORD, {rosbag2.KEY: metadata})
        writer.finish()
    return path


# --- tables --------------------------------------------------------------------------------------

def test_tables_of_topics_whose_names_meet_stay_apart(tmp_path):
    path = write(tmp_path / 'js.mcap',
                 [('/js', JOINTS, joints('ab')), ('/js', JOINTS, joints('abc')),
                  ('/js_2', JOINTS, joints('xyz')), ('/js.2', JOINTS, joints('pq')),
                  ('/a/b', STRING, text('slash')), ('/a.b', STRING, text('dot')),
                  ('/../..', STRING, text('up')), ('/nul\0/[bold]', STRING, text('nul'))])
    rows = export(path, tmp_path / 'out')
    assert (len(rows) == 8 and set(rows.values()) == {1}
            and rows == export(path, tmp_path / 'out.npz', 'npz'))
    assert (len(list((tmp_path / 'out').iterdir())) == 8 and {p.name for p in tmp_path.iterdir()}
            == {'js.mcap', 'out', 'out.npz'})
    heads = {p.stem: p.read_text().splitlines()[0].rpartition(',')[2]
             for p in (tmp_path / 'out').iterdir()}
    assert heads['js'] == 'position[b]' and heads['js_2'] == 'position[z]'
    assert sorted(head for name, head in heads.items()
                  if name.startswith('js')) == [f'position[{c}]' for c in 'bcqz']


def test_two_types_on_one_topic_are_decoded_each_by_its_own(tmp_path):
    path = (write(tmp_path / 'two.mcap',
                  [('/t', STRING, text('one')), ('/t', JOINTS, joints('ab', 3)),
                   ('/t', STRING, text('two'))]))
    assert [(raw.topic, raw.type) for raw in Bag(path).raw()] == [('/t', STRING), ('/t', JOINTS),
                                                                  ('/t', STRING)]
    found = [record.message for record in records(path)]
    assert found[0].data == 'one' and found[1].position == [3.0, 4.0] and found[2].data == 'two'
    assert export(path, tmp_path / 'out') == {'t': 2, 't.2': 1}
    assert all(topic.is_same() for topic in diff(path, path))
    again = recover(path)
    assert [(raw.type, raw.data) for raw in Bag(again.path).raw()] == [(raw.type, raw.data)
                                                                       for raw in Bag(path).raw()]


def test_pictures_are_one_column_of_bytes_and_texts_one_column_however_long(tmp_path):
    sizes = [5, 0, 300, 7]
    path = write(tmp_path / 'camera.mcap', [pair for k, size in enumerate(sizes) for pair in (
        ('/camera', IMAGE, image(k, size)), ('/log', STRING, text('x' * (3 * size + 1))))])
    assert export(path, tmp_path / 'out.npz', 'npz') == {'camera': 4, 'log': 4}
    arrays = np.load(tmp_path / 'out.npz')
    begin = 0
    for k, end in enumerate(arrays['camera/data.ends']):
        assert arrays['camera/data'][begin:end].tolist() == [k] * sizes[k]
        begin = end
    assert arrays['log/data'].tolist() == ['x' * (3 * size + 1) for size in sizes]
    assert export(path, tmp_path / 'out') == {'camera': 4, 'log': 4}
    with open(tmp_path / 'out/camera.csv', newline='') as file:
        assert [bytes.fromhex(line['data'])
                for line in csv.DictReader(file)] == [bytes([k]) * n for k, n in enumerate(sizes)]
    pyarrow = pytest.importorskip('pyarrow.parquet')
    export(path, tmp_path / 'arrow', 'parquet')
    assert (pyarrow.read_table(tmp_path / 'arrow/camera.parquet')['data'].to_pylist()
            == [bytes([k]) * n for k, n in enumerate(sizes)])


# The limit is of the address space of a fresh process, beyond what its imports take.
LIMITED = """
import resource, sys
from fourbar_ros.bag.comparison import diff
from fourbar_ros.bag.export import export
from fourbar_ros.bag.read import info
from fourbar_ros.bag.exports import plot
from fourbar_ros.bag.comparison import recompute
from fourbar_ros.bag import repair as recover
from fourbar_ros.cli.main import main
if {arguments!r}[-1] == "parquet":
    import pyarrow.parquet
taken = next(int(line.split()[1]) << 10 for line in open('/proc/self/status')
             if line.startswith('VmSize'))
resource.setrlimit(resource.RLIMIT_AS, (taken + {memory}, taken + {memory}))
resource.setrlimit(resource.RLIMIT_NOFILE, (40, 40))
sys.exit(main({arguments!r}))
"""


def limited(arguments, memory):
    """Run the command line with limited memory [bytes] after imports, and 40 open files."""
    return subprocess.run([sys.executable, '-c',
                           LIMITED.format(memory=memory, arguments=arguments)],
                          capture_output=True, text=True, timeout=120, check=False)


@some('format_', ['csv', 'npz', 'parquet'], ('csv',))
def test_large_pictures_and_wide_scans_need_little_memory_and_few_files(tmp_path, format_):
    if format_ == 'parquet':
        pytest.importorskip('pyarrow')
    size = 1_000_000
    wide = bags.encode('std_msgs/msg/Float64MultiArray',
                       layout=bags.zero('std_msgs/msg/MultiArrayLayout'), data=np.arange(1100.0))
    path = write(tmp_path / 'big.mcap', [pair for k in range(40) for pair in (
        ('/camera', IMAGE, image(k, size)), ('/scan', 'std_msgs/msg/Float64MultiArray', wide))])
    done = limited(['bag', 'export', str(path), '-o', str(tmp_path / 'out'), '--format', format_],
                   300 << 20)
    assert (done.returncode == 0 and 'camera, 40 rows' in done.stdout
            and 'scan, 40 rows' in done.stdout), done.stderr


# --- compressed, split, other formats ------------------------------------------------------------

@pytest.mark.parametrize('mode', ['zstd', 'lz4'])
def test_messages_that_were_compressed_one_by_one_are_read_as_they_were_sent(tmp_path, mode):
    if mode == 'zstd':                      # as rosbags writes them
        writer = RosbagsWriter(tmp_path / 'packed', version=9, storage_plugin=StoragePlugin.MCAP)
        writer.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
        with writer:
            place = writer.add_connection('/t', STRING, typestore=STORE)
            for k in range(50):
                writer.write(place, k, text(f'number {k}'))
        path = tmp_path / 'packed'
    else:
        path = write(tmp_path / 'packed.mcap',
                     [('/t', STRING, lz4.frame.compress(text(f'number {k}'))) for k in range(50)])
    expected = [f'number {k}' for k in range(50)]
    assert [raw.data for raw in Bag(path).raw()] == [text(value) for value in expected]
    assert [record.message.data for record in records(path)] == expected
    assert export(path, tmp_path / 'out') == {'t': 50}
    again = recover(path, tmp_path / 'again')
    assert [record.message.data for record in records(again.path)] == expected
    if mode == 'zstd':
        from rosbags.highlevel import AnyReader
        # metadata.yaml must still say that they are compressed
        with AnyReader([again.path]) as reader:
            assert [reader.deserialize(data, c.msgtype).data
                    for c, _, data in reader.messages()] == expected


@pytest.mark.parametrize(('name', 'said'), [
    ('run_0.mcap.zstd', 'zstd -d'), ('run_0.mcap.lz4', 'lz4 -d'), ('run_0.db3', 'rosbags-convert'),
    ('run_0.db3.zstd', 'rosbags-convert'), ('run.bag', 'ROS 1'), ('notes.txt', 'holds no')])
def test_bags_of_other_kinds_say_what_to_do_first(tmp_path, capsys, name, said):
    (tmp_path / 'run').mkdir()
    (tmp_path / 'run' / name).write_bytes(b'something')
    for verb in (['info'], ['recover'], ['export', '-o', str(tmp_path / 'out')], ['recompute']):
        assert main(['bag', verb[0], str(tmp_path / 'run'), *verb[1:]]) == 1
        error = capsys.readouterr().err
        assert said in error and error.count('\n') == 1


def test_recover_keeps_profile_encoding_and_what_is_no_cdr(tmp_path, capsys):
    path = write(tmp_path / 'json.mcap', [('/j', 'j/msg/J', b'{"a": 1}')], profile='',
                 encoding='json', schemas={'j/msg/J': b'{}'})
    again = recover(path)
    with open(next(again.path.glob('*.mcap')), 'rb') as file:
        from mcap.reader import make_reader
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == ''
        assert [(c.message_encoding, m.data)
                for _, c, m in reader.iter_messages()] == [('json', b'{"a": 1}')]
    told = Bag(again.path).metadata()['topics_with_message_count'][0]['topic_metadata']
    assert told['serialization_format'] == 'json'
    assert main(['bag', 'export', str(path), '-o', str(tmp_path / 'out')]) == 1
    assert "is 'json' defined in" in capsys.readouterr().err


# --- custom_data, QoS, definitions, times: nothing of them is ours -------------------------------

DEEP = '[' * 100_000
LAUGHS = 'a: &a ["x","x","x","x","x","x","x","x","x"]\n' + ''.join(
    f'{chr(98 + i)}: &{chr(98 + i)} [{",".join(["*" + chr(97 + i)] * 9)}]\n'
    for i in range(9)) + f'{CUSTOM}: *j\n'
ODD_METADATA = {
    'kitchen': f'{CUSTOM}: {{scene: kitchen, topics: lidar}}',
    'number': f'{CUSTOM}: {{software: 2, topics: 3, scene: 4, numbers: 5, dropped: -1}}',
    'list': f'{CUSTOM}: [1, 2]', 'self': f'&a {{{CUSTOM}: *a}}', 'int': f'{CUSTOM}: 7',
    'nothing': '', 'text': 'just text',
    'no yaml': '{[}', 'deep': f'{CUSTOM}: {DEEP}',
    'deep json': json.dumps({CUSTOM: {k: DEEP for k in ('scene', 'topics', 'software',
                                                        'numbers')}}),
    'laughs': LAUGHS, 'numbers': json.dumps({CUSTOM: {'numbers': json.dumps({'/t': ['a', {}]}),
                                                      'dropped': '{"/t": "x"}'}}),
    'numbers 2': json.dumps({CUSTOM: {'numbers': '[1]', 'dropped': '[2]'}}),
    'date': f'{CUSTOM}: {{a: 2024-99-99}}',
    'key': f'{CUSTOM}: {{[1]: 2}}', 'tag': f'{CUSTOM}: !!python/object:os.system {{}}'}


def assert_one_line(arguments, capsys, tmp_path, seconds=20.0):
    """
    Every verb answers, or says in one line why not; returns its exit code.

    Without bounds it would take hours.
    """
    begin = time.process_time()
    code = main(['bag', *arguments])
    assert time.process_time() - begin < seconds, arguments
    error = capsys.readouterr().err
    assert code in (0, 1, 3) and error.count('\n') == (code == 1), (arguments, code, error[:500])
    return code


def every_verb(path, capsys, tmp_path):
    """Run every verb that reads a bag."""
    for i, verb in enumerate((['info'], ['info', '--check'],
                              ['recover', '-o', str(tmp_path / 'again')], ['recompute'], ['scene'],
                              ['export', '-o', str(tmp_path / 'csv')],
                              ['export', '-o', str(tmp_path / 'npz.npz')],
                              ['diff', str(path)],
                              ['plot', 't.data', '-o', str(tmp_path / 'a.png')])):
        assert_one_line([verb[0], str(path), *verb[1:]], capsys, tmp_path)


@some('name', ODD_METADATA, 4)
def test_custom_data_of_others_are_no_traceback(tmp_path, capsys, name):
    path = write(tmp_path / 'odd.mcap', [('/t', STRING, text('x'))], ODD_METADATA[name])
    every_verb(path, capsys, tmp_path)
    assert [raw.data for raw in Bag(recover(path, tmp_path / 'last').path).raw()] == [text('x')]


DEEP_TYPES = (''.join(f'{"=" * 80}\nMSG: a/T{i}\na/T{i + 1} x\n' for i in range(3000))
              + f'{"=" * 80}\nMSG: a/T3000\nint8 x\n')
HUGE = 'a/A[100000000] x\n' + '=' * 80 + '\nMSG: a/A\nuint8[0] y\n'
WIDE = (''.join(f'{"=" * 80}\nMSG: a/W{i}\na/W{i + 1} x\na/W{i + 1} y\n' for i in range(40))
        + f'{"=" * 80}\nMSG: a/W40\nuint8[0] x\n')
ODD_SCHEMAS = {
    'self': b'a/T x\n', 'self list': b'a/T[] x\n', 'deep': b'a/T0 x\n' + DEEP_TYPES.encode(),
    'huge': HUGE.encode(),
    'wide': b'a/W0 x\n' + WIDE.encode(), 'no text': b'\xff\xfe\0string data',
    'twice': b'int8 x\nint8 x\n', 'empty': b'',
    'large': b'float64[1000000000000] x\n', 'wstring': b'wstring x\n',
    'texts': b'string[1000000000] x\n', 'unknown': b'b/None x\n'}


@some('name, kind', [*((name, 'a/msg/T') for name in ODD_SCHEMAS), *(
    ('self', kind) for kind in ('T', '', '/', 'a/b/c/d')), ('empty', '')], 5)
def test_odd_definitions_end_in_one_line(tmp_path, capsys, name, kind):
    data = b'\0\1\0\0' + bytes(4000)
    path = write(tmp_path / 'odd.mcap', [('/t', kind, data)],
                 schemas={kind: ODD_SCHEMAS[name] or b'\n'})
    if kind == 'a/msg/T':
        every_verb(path, capsys, tmp_path)
    else:
        assert_one_line(['export', str(path), '-o', str(tmp_path / 'csv')], capsys, tmp_path)


def test_topics_qos_and_times_of_any_kind_are_no_traceback(tmp_path, capsys):
    for i, (topic, qos, when) in enumerate((('/[/b]', '- {depth: [}', 1), ('nul\0', '7', 2**63),
                                            ('', DEEP, 2**64 - 1),
                                            ('/t', '&a [*a]', 0), ('/é\n/[bold]', '- 5', 5))):
        path = tmp_path / f'odd{i}.mcap'
        with open(path, 'wb') as file:
            writer = Writer(file)
            writer.start('ros2', 'test')
            number = writer.register_channel(topic, 'cdr',
                                             writer.register_schema(STRING, 'ros2msg',
                                                                    b'string data'),
                                             {rosbag2.QOS: qos, rosbag2.HASH: 'x'})
            writer.add_message(number, when, text('x'), when)
            writer.finish()
        (tmp_path / str(i)).mkdir()
        every_verb(path, capsys, tmp_path / str(i))


# --- bombs ---------------------------------------------------------------------------------------

def bomb(kind):
    """Return the bytes of an unfinished file whose chunk of 600 MiB has 20 kB or some MB."""
    size = 38 << 24
    if kind == 'lz4':
        data = lz4.frame.LZ4FrameCompressor(content_checksum=False)
        packed = data.begin() + b''.join(data.compress(bytes(1 << 24))
                                         for _ in range(size // (1 << 24))) + data.flush()
    else:
        data = zstandard.ZstdCompressor(write_content_size=False).compressobj()
        packed = (b''.join(data.compress(bytes(1 << 24)) for _ in range(size // (1 << 24)))
                  + data.flush())
    told = 1000 if kind.endswith('lying') else size
    return MAGIC + encoded(Header('ros2', 'test'), Schema(1, b'string data', 'ros2msg', STRING),
                           Channel(1, '/t', 'cdr', {}, 1),
                           Chunk(kind.split()[0], packed, 0, 0, 0, told))


@some('kind', ['zstd', 'zstd lying', 'lz4'], 1)
def test_bombs_are_refused_before_memory_is_taken_for_them(tmp_path, kind):
    (tmp_path / 'bomb.mcap').write_bytes(bomb(kind))
    for verb in (['info', '--check'], ['recover', '-o', str(tmp_path / 'out')],
                 ['export', '-o', str(tmp_path / 'csv')]):
        done = limited(['bag', verb[0], str(tmp_path / 'bomb.mcap'), *verb[1:]], 400 << 20)
        assert done.returncode in (1, 3) and done.stderr.count('\n') == (done.returncode == 1), (
            done.stderr)


def test_a_bomb_of_a_message_is_refused(tmp_path):
    packed = zstandard.ZstdCompressor().compress(bytes(1 << 29))
    path = write(tmp_path / 'bomb.mcap', [('/t', STRING, packed)])
    done = limited(['bag', 'export', str(path), '-o', str(tmp_path / 'csv')], 500 << 20)
    assert done.returncode == 1 and 'message' in done.stderr and done.stderr.count('\n') == 1


def seconds_for(content, path):
    """Return the processor time to look through a file of false records."""
    path.write_bytes(content)
    begin = time.process_time()
    info(path, check=True)
    return time.process_time() - begin


def test_false_heads_take_a_time_in_proportion_to_the_size_of_the_file(tmp_path):
    start = MAGIC + encoded(Header('ros2', 'test'))

    def heads(size):
        """Heads of chunks that would reach to the end; what their lengths tell does not fit."""
        return start + b''.join(HEAD.pack(6, size - 9 * i - 9) for i in range(size // 9))
    seconds_for(heads(30_000), tmp_path / 'warm.mcap')
    few = seconds_for(heads(100_000), tmp_path / 'few.mcap')
    many = seconds_for(heads(800_000), tmp_path / 'many.mcap')
    # 8 times as long; 64 times if each looked at all that follows
    assert many < 24 * few


def test_many_channels_take_a_time_in_proportion_to_their_number(tmp_path):
    def defined(count):
        return (MAGIC + encoded(Header('ros2', 'test'),
                                Schema(1, b'string data', 'ros2msg', STRING))
                + b''.join(encoded(Channel(i, f'/t{i}', 'cdr', {}, 1)) for i in range(count)))
    seconds_for(defined(500), tmp_path / 'warm.mcap')
    few = seconds_for(defined(2000), tmp_path / 'few.mcap')
    many = seconds_for(defined(16_000), tmp_path / 'many.mcap')
    assert many < 24 * few
