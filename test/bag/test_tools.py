# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What is done with a bag: export, plot, diff, its scene, and the command line around them."""
import csv
import io
import json
import math
from operator import attrgetter
import os
import subprocess
import sys

from fourbar_lab.drawing.recorded import make_figure
from fourbar_ros.bag import diff, export, info, recompute, recover
from fourbar_ros.bag.origin import origin_of
from fourbar_ros.bag.reader import Bag, records
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.bag.tables import table_of
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
from fourbar_ros.scene.scene import from_values
import matplotlib
from mcap.writer import Writer
import numpy as np
import pytest
from support import bags
from support.scenes import OUTPUTS, PAPER, ROCKER, RODS, TIP

STEPS = 120
TURNS = [(0.2 * k, 25.0, 0.1 * k) for k in range(STEPS)]
FULL = {**PAPER, **RODS, **TIP, 'outputs': OUTPUTS, 'drive.source': 'motion'}
JOINTS = 'sensor_msgs/msg/JointState'


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    return bags.run(tmp_path_factory.mktemp('tools'), 'run', FULL, TURNS)


@pytest.fixture(scope='module')
def mixed(tmp_path_factory):
    """Return a bag of JointStates whose number of joints changes to and fro, and one of them."""
    writer = BagWriter(tmp_path_factory.mktemp('mixed'), 'mixed',
                       [bags.channel('/joint_states', JOINTS)], {})
    for k in range(60):
        names = list('abc'[:1 + k % 3])
        writer.write(0, bags.encode(
            JOINTS, header=bags.stamp((k + 1) * 10**6), name=names, effort=np.zeros(0),
            position=np.arange(len(names)) + k * 1.0, velocity=np.zeros(0)))
    return writer.close()


@pytest.mark.parametrize('policy', ['none', 'hold', 'clamp'])
def test_bad_inputs_and_every_policy_recompute_exactly(tmp_path, policy):
    cranks = [(0.01 * k, 1.0, 0.0) for k in range(200)]
    cranks[5:9] = [(math.nan, 1.0, 0.0), (0.1, math.inf, 0.0), (1e300, 1e200, 0.0),
                   (0.2, math.nan, math.nan)]
    found = recompute(bags.run(tmp_path, 'run', {**ROCKER, **RODS, **TIP, 'outputs': OUTPUTS,
                                                 'drive.out_of_range': policy}, cranks))
    assert not found.problems() and found.compared == 200 * len(OUTPUTS)


# --- export --------------------------------------------------------------------------------------

def test_csv_npz_and_parquet_hold_every_number_exactly(bag, tmp_path):
    rows = export(bag, tmp_path / 'tables')
    assert rows['fourbar.state'] == rows['joint_states'] == STEPS and rows['fourbar.scene'] == 1
    export(bag, tmp_path / 'all.npz')
    export(bag, tmp_path / 'pq', 'parquet')
    arrays = np.load(tmp_path / 'all.npz')
    from pyarrow.parquet import read_table
    for name, topic in (('theta4', '/fourbar/state'),
                        ('wrench.force.x', '/fourbar/shaking_wrench')):
        sent, table = list(records(bag, [topic])), topic.strip('/').replace('/', '.')
        with open(tmp_path / 'tables' / f'{table}.csv', newline='') as file:
            lines = list(csv.DictReader(file))
        expected = [attrgetter(name)(record.message) for record in sent]
        assert [float(line[name]) for line in lines] == expected
        assert arrays[f'{table}/{name}'].tolist() == expected
        assert read_table(tmp_path / 'pq' / f'{table}.parquet')[name].to_pylist() == expected
        assert [int(line['log_time']) for line in lines] == [record.time for record in sent]
        assert [int(line['header.stamp']) for line in lines] == [
            (k + 1) * 10**6 for k in range(STEPS)]
    joints = [record.message for record in records(bag, ['/joint_states'])]
    assert arrays['joint_states/position[output]'].tolist() == [
        joint.position[joint.name.index('output')] for joint in joints]


def test_messages_of_several_layouts_are_one_table_in_the_order_of_the_bag(mixed, tmp_path):
    assert export(mixed, tmp_path / 'js.npz') == {'joint_states': 60}
    found = np.load(tmp_path / 'js.npz')
    assert (np.diff(found['joint_states/header.stamp']) == 10**6).all()
    assert found['joint_states/position[a]'].tolist() == list(range(60))
    second = found['joint_states/position[b]']
    assert np.isnan(second[::3]).all() and second[1::3].tolist() == list(range(2, 61, 3))
    assert set(found['joint_states/name[1]'].tolist()) == {'', 'b'}


def test_a_topic_of_another_encoding_is_left_out_and_named(bag, tmp_path, capsys):
    """JSON, no definition, ros2idl beside topics of ROS 2."""
    file, kinds = tmp_path / 'mixed_0.mcap', Bag(bag).types
    with open(file, 'wb') as stream:
        writer = Writer(stream)
        writer.start('', 'test')
        known = {topic: writer.register_channel(topic, 'cdr', writer.register_schema(
            kind, 'ros2msg', bags.text_of(kind).encode())) for topic, kind in kinds.items()}
        others = [writer.register_channel('/json', 'json', writer.register_schema(
                      'x', 'jsonschema', b'{}')), writer.register_channel('/free', 'json', 0),
                  writer.register_channel('/idl', 'cdr', writer.register_schema(
                      'a/msg/B', 'ros2idl', b'struct'))]
        for raw in Bag(bag).raw():
            writer.add_message(known[raw.topic], raw.time, raw.data, raw.time)
            for channel in others:
                writer.add_message(channel, raw.time, b'{"a": 1}', raw.time)
        writer.finish()
    assert main(['bag', 'export', str(file), '-o', str(tmp_path / 'out')]) == 3
    said = capsys.readouterr().out
    for topic, why in (('/json', 'json messages defined in jsonschema'),
                       ('/free', 'json messages defined in nothing'),
                       ('/idl', 'cdr messages defined in ros2idl')):
        assert f'left out: {file}: {topic}: {why}; only cdr' in said
    assert said.count('left out') == 3
    assert len(list((tmp_path / 'out').iterdir())) == len(kinds)
    assert main(['bag', 'export', str(file), '-o', str(tmp_path / 'one'), '--topics',
                 '/json']) == 1
    assert f'{file}: /json: json messages' in capsys.readouterr().err
    assert not recompute(file).problems() and info(file, check=True).is_sound
    assert main(['bag', 'diff', str(file), str(file), '--topics', '/fourbar/state']) == 0
    assert recover(file, tmp_path / 'new').messages == sum(
        topic.messages for topic in info(file).topics)


@pytest.mark.parametrize('out', ['a.csv', 'all.npz', 'tables', '-'])
def test_a_topic_without_messages_is_one_line(tmp_path, capsys, out):
    path = bag_of(tmp_path / 'run', 'std_msgs/msg/String', [])
    out = out if out == '-' else str(tmp_path / out)
    assert main(['bag', 'export', str(path), '-o', out]) == 1
    assert capsys.readouterr().err == f'fourbar: {path}: no message on /a\n'
    assert [*tmp_path.iterdir()] == [path]


def test_two_topics_of_one_table_are_refused(tmp_path):
    names = '/a/b', 'a/b'           # of a writer beside ROS
    writer = BagWriter(tmp_path, 'run', [bags.MOTION._replace(topic=name) for name in names], {})
    for channel in (0, 1, 1):
        writer.write(channel, bags.motion(channel))
    path = writer.close()
    with pytest.raises(BagError, match='would both be the table a.b'):
        export(path, tmp_path / 'out')
    assert [export(path, tmp_path / f'{k}.csv', topics=[name])
            for k, name in enumerate(names)] == [{'a.b': 1}, {'a.b': 2}]


def test_whole_numbers_of_some_messages_keep_their_digits(tmp_path):
    layout = bags.STORE.types['std_msgs/msg/MultiArrayLayout']([], 0)
    rows = [[1], [17 * 10**17 + 1, -2], [5, 17 * 10**17 + 1]]
    for name, count, expected in (('small', 2, ['nan', '-2.0']),
                                  ('large', 3, ['', '-2', '1700000000000000001'])):
        path = bag_of(tmp_path / name, 'std_msgs/msg/Int64MultiArray', [
            {'layout': layout, 'data': np.array(row)} for row in rows[:count]])
        export(path, path / 'out')
        lines = list(csv.DictReader(io.StringIO((path / 'out' / 'a.csv').read_text())))
        assert [line['data[1]'] for line in lines] == expected
        assert [int(line['data[0]']) for line in lines] == [row[0] for row in rows[:count]]


def test_joints_of_one_name_are_columns_by_number_and_flags_are_columns(tmp_path):
    path = bag_of(tmp_path / 'run', JOINTS, [
        {'header': bags.stamp(1), 'name': ['x', 'x'], 'position': np.array([1.0, 2.0]),
         'velocity': np.zeros(0), 'effort': np.zeros(0)}])
    export(path, tmp_path / 'all.npz')
    found = np.load(tmp_path / 'all.npz')
    assert [found[f'a/position[{k}]'].tolist() for k in (0, 1)] == [[1.0], [2.0]]
    flags, = Bag(path).columns()
    flags = flags._replace(records=np.array([([True, False], [1, 2])],
                                            [('on', '?', 2), ('data', 'u1', 2)]))
    assert sorted(table_of(flags)) == ['log_time', 'on[0]', 'on[1]']


def test_what_exists_is_not_touched_and_what_fails_leaves_nothing(bag, tmp_path, capsys):
    (tmp_path / 'old.npz').write_text('old')
    for out, more, said in (('old.npz', [], 'exists already'),
                            ('x.csv', [], 'holds one topic'),
                            ('x', ['--topics', '/none'], 'not in the bag; it has'),
                            ('x', ['--units', 'kg'], "units = 'kg': is of no column: they "
                             'are in rad, '),
                            ('x', ['--topics', '/joint_states', '--units', 'deg'],
                             "units = 'deg': is of no column: they have no units"),
                            ('old.npz/below', [], 'ile exists'),
                            ('x', ['--format', 'npz'], 'x: is to be npz: name it x.npz'),
                            ('x.npz', ['--format', 'csv'], 'is to be csv: name it x.csv')):
        assert main(['bag', 'export', str(bag), '-o', str(tmp_path / out), *more]) == 1
        text = capsys.readouterr().err
        assert said in text and text.count('\n') == 1
    assert [path.name for path in tmp_path.iterdir()] == ['old.npz']
    assert (tmp_path / 'old.npz').read_text() == 'old'
    assert main(['bag', 'export', str(bag), '-o', str(tmp_path / 'x.csv'), '--topics',
                 '/fourbar/state']) == 0
    assert (tmp_path / 'x.csv').read_text().startswith('log_time,header.stamp,')


def test_a_table_in_other_units_names_them_and_keeps_whole_numbers(bag, tmp_path, capfdbinary):
    command = ['bag', 'export', str(bag), '-o', '-', '--topics', '/fourbar/state']
    assert main(command) == 0
    plain = list(csv.DictReader(io.StringIO(capfdbinary.readouterr().out.decode())))
    assert main([*command, '--units', 'deg,mm', '--digits', '5']) == 0
    out, err = capfdbinary.readouterr()
    rows = list(csv.DictReader(io.StringIO(out.decode())))
    assert err == f'-: fourbar.state, {STEPS} rows\n'.encode() and len(rows) == STEPS
    for before, row in zip(plain, rows):
        assert row['theta4 [deg]'] == f'{math.degrees(float(before["theta4"])):.5g}'
        assert row['omega4 [rad/s]'] == f'{float(before["omega4"]):.5g}'
        assert (row['log_time'], row['condition']) == (
            before['log_time'], f'{float(before["condition"]):.5g}')
        assert 'theta4' not in row and 'slide [mm]' in row
    export(bag, tmp_path / 'all.npz', units={'rad': 'deg'})
    found = np.load(tmp_path / 'all.npz')
    assert found['fourbar.state/theta4 [deg]'].tolist() == [
        math.degrees(float(row['theta4'])) for row in plain]
    assert 'joint_states/position[crank]' in found      # whose definition tells no unit
    for more, why in ((['--excel', '--format', 'npz'], 'are for csv, not npz'),
                      (['--format', 'parquet'], 'are for csv, not parquet')):
        assert main([*command, *more]) == 1
        assert why in capfdbinary.readouterr().err.decode()


# Run with -B: Python would leave bytecode cut at the limit, which no later process can import.
FULL_DISK = """
import resource, sys
from fourbar_ros.cli.main import main
import fourbar_ros.bag.reader, fourbar_ros.bag.tables, fourbar_ros.bag.recovery
resource.setrlimit(resource.RLIMIT_FSIZE, (8000, 8000))
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize('verb', ['export', 'recover'])
def test_a_disk_that_is_full_is_one_line_and_leaves_nothing(bag, tmp_path, verb):
    done = subprocess.run([sys.executable, '-B', '-c', FULL_DISK, 'bag', verb, str(bag), '-o',
                           str(tmp_path / 'out')], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and 'File too large' in done.stderr, done.stderr
    assert done.stderr.startswith('fourbar: ') and done.stderr.count('\n') == 1
    assert not list(tmp_path.iterdir())


# --- plot ----------------------------------------------------------------------------------------

def lines_of(figure):
    return {line.get_label(): line.get_xydata().T for axis in figure.axes
            for line in axis.get_lines()}


def test_a_plot_has_its_fields_with_units_over_the_time_of_their_stamps(bag):
    figure = make_figure(bag, ['state.theta4', '/fourbar/loads.f41',
                               'joint_states.position[crank]'])
    assert [axis.get_ylabel() for axis in figure.axes] == ['[rad]', '[N]', '']
    times, values = lines_of(figure)['state.theta4']
    # an ulp of the largest time, for each of two roundings
    assert np.abs(times - np.arange(STEPS) * 1e-3).max() <= 2 * np.spacing(STEPS * 1e-3)
    assert values.tolist() == [r.message.theta4 for r in records(bag, ['/fourbar/state'])]


def test_a_plot_over_a_field_pairs_values_of_one_stamp(bag, tmp_path, capsys, monkeypatch):
    x, y = lines_of(make_figure(bag, ['loads.f41'], x='state.theta1'))['loads.f41']
    known = ~np.isnan(x)
    theta1 = [record.message.theta1 for record in records(bag, ['/fourbar/state'])]
    assert y[known].tolist() == [r.message.f41 for r in records(bag, ['/fourbar/loads'])]
    assert x[known].tolist() == np.mod(theta1, 2 * np.pi).tolist()
    # 24 rad are three turns and a bit: three gaps
    assert np.count_nonzero(~known) == 3 and np.array_equal(known, ~np.isnan(y))
    monkeypatch.setitem(matplotlib.rcParams, 'svg.fonttype', 'none')
    out = tmp_path / 'over.svg'
    assert main(['bag', 'plot', str(bag), 'loads.f41', '--x', 'state.theta1', '-o',
                 str(out)]) == 0
    assert 'state.theta1 [rad]' in out.read_text()
    for field, said in (('state.thetaX', 'no such field'),
                        ('stat.theta1', 'no such topic; did you mean state?'),
                        ('state', 'no such field'), ('state.header.frame_id', 'no such field')):
        assert main(['bag', 'plot', str(bag), field, '-o', str(tmp_path / 'no.svg')]) == 1
        text = capsys.readouterr().err
        assert said in text and text.startswith('fourbar: stat') and text.count('\n') == 1
    assert main(['bag', 'plot', str(bag), 'state.theta1', '-o', str(tmp_path / 'a.none')]) == 1
    assert [path.name for path in tmp_path.iterdir()] == ['over.svg']


def test_messages_that_nobody_stamped_do_not_break_the_time_axis(tmp_path):
    writer, begun = BagWriter(tmp_path, 'run', [bags.MOTION], {}), 1_800_000_000 * 10**9
    for k in range(100):
        writer.clock = lambda k=k: begun + k * 10**7 + 5000
        writer.write(0, bags.motion(begun + k * 10**7 if k not in (0, 40, 99) else 0))
    times, _ = lines_of(make_figure(writer.close(), ['driven.position']))['driven.position']
    assert times[0] == 0.0 and (np.diff(times) > 0).all() and 0.97 < times[-1] < 1.0


def test_two_topics_of_one_name_are_kept_apart(tmp_path):
    writer = BagWriter(tmp_path, 'run', [bags.MOTION, bags.MOTION._replace(topic='/other/driven')],
                       {})
    writer.write(0, bags.motion(1))
    writer.write(1, bags.motion(2))
    path = writer.close()
    with pytest.raises(BagError, match='which of /fourbar/driven, /other/driven'):
        make_figure(path, ['driven.position'])
    found = lines_of(make_figure(path, ['/other/driven.position']))
    assert found['/other/driven.position'][1].tolist() == [2.0]


# --- diff ----------------------------------------------------------------------------------------

def of_topics(found):
    return {topic.topic: topic for topic in found}


def test_diff_matches_by_stamp_and_counts_what_is_in_one_bag_only(bag, tmp_path, capsys):
    other = bags.run(tmp_path, 'other', {**FULL, 'linkage.a2': 1.2 + 1e-9},
                     [*TURNS[10:], (9.0, 1.0, 0.0)], step_ns=10**6)
    assert all(topic.is_same() for topic in diff(bag, bag))
    shifted = of_topics(diff(bag, other))
    assert shifted['/fourbar/state'].messages == STEPS - 9
    assert shifted['/fourbar/state'].only_first == 9
    assert shifted['/fourbar/scene'].largest == {'linkage.a2': pytest.approx(1e-9, rel=1e-6)}
    assert main(['bag', 'diff', str(bag), str(other)]) == 3
    said = capsys.readouterr().out
    assert 'linkage.a2' in said and '/fourbar/state' in said
    # the same steps of a slightly other linkage
    near = bags.run(tmp_path, 'near', {**FULL, 'linkage.a2': 1.2 + 1e-9}, TURNS)
    largest = of_topics(diff(bag, near))['/fourbar/state'].largest
    assert 0.0 < largest['theta4'] < 1e-7 and largest['theta1'] == 0.0
    topics = ['--topics', '/fourbar/state', '/joint_states']
    assert main(['bag', 'diff', str(bag), str(near), *topics]) == 3
    assert main(['bag', 'diff', str(bag), str(near), '--tolerance', '1', *topics]) == 0
    assert main(['bag', 'diff', str(bag), str(near), '--json', *topics]) == 3
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert [topic['topic'] for topic in told['topics']] == topics[1:] and not told['same']
    assert main(['bag', 'diff', str(bag), str(near), '--topics', '/nothing']) == 1
    assert '/nothing: in neither bag' in capsys.readouterr().err


def test_every_changed_or_missing_message_is_found(bag, tmp_path):
    raws = list(Bag(bag).raw())
    for k, raw in enumerate(raws[2::211]):
        changed = bags.copy(bag, tmp_path, f'c{k}', lambda each, raw=raw: each.data if
                            (each.topic, each.sequence) != (raw.topic, raw.sequence)
                            else each.data[:-8] + b'\0' * 8)
        assert [topic.topic for topic in diff(bag, changed) if not topic.is_same()] == [
            raw.topic] * (raw.data[-8:] != b'\0' * 8)


def test_messages_of_several_layouts_meet_in_a_diff(mixed, tmp_path):
    longer = list(Bag(mixed).raw())[31].data        # of two joints in place of one
    other = bags.copy(mixed, tmp_path, 'other', lambda raw: raw.data if raw.sequence != 30 else
                      raw.data[:12] + longer[12:])
    assert of_topics(diff(mixed, mixed))['/joint_states'].is_same()
    found = of_topics(diff(mixed, other))['/joint_states']
    assert found.messages == 60 and found.largest['position'] == math.inf


def test_messages_that_nobody_stamped_are_compared_by_their_place(tmp_path):
    paths = []
    for name, values in (('one', (1, 2, 3)), ('two', (1, 5, 3, 4))):
        writer = BagWriter(tmp_path, name, [bags.MOTION], {})
        for value in values:
            writer.write(0, bags.encode('fourbar_msgs/msg/Motion', header=bags.stamp(0),
                                        position=float(value), velocity=0.0, acceleration=0.0))
        paths.append(writer.close())
    found, = diff(*paths)
    assert (found.messages, found.only_first, found.only_second) == (3, 0, 1)
    assert found.largest['position'] == 3.0


def bag_of(path, kind, rows, about=None):
    """Write messages of a type on /a, each its fields, at one log time; return the bag's path."""
    writer = BagWriter(path.parent, path.name, [bags.channel('/a', kind)], about or {},
                       clock=lambda: 7)
    for fields in rows:
        writer.write(0, bags.encode(kind, **fields))
    return writer.close()


def test_texts_of_one_time_keep_their_order(tmp_path):
    """Texts of other lengths are other blocks of columns."""
    orders = ('start', 'stop', 'go'), ('go', 'stop', 'start')
    paths = [bag_of(tmp_path / f'run_{k}', 'std_msgs/msg/String', [
        {'data': text} for text in texts]) for k, texts in enumerate(orders)]
    found, = diff(*paths)
    assert (found.messages, found.largest) == (3, {'data': math.inf}) and not found.is_same()
    assert diff(paths[0], paths[0])[0].is_same()
    for path, texts in zip(paths, orders):
        export(path, path / 'all.npz')
        assert np.load(path / 'all.npz')['a/data'].tolist() == [*texts]


@pytest.mark.parametrize('kind, sign', [('UInt64', 1), ('Int64', -1)])
def test_whole_numbers_beyond_the_digits_of_floats_are_compared_exactly(kind, sign, tmp_path):
    """Times in ns: floats of that size are 256 apart."""
    first, second = (bag_of(tmp_path / f'run_{more}', f'std_msgs/msg/{kind}', [
        {'data': sign * (17 * 10**17 + more)}]) for more in (0, 100))
    assert diff(first, second)[0].largest == {'data': 100.0} and diff(first, first)[0].is_same()


def test_a_parameter_that_one_scene_alone_gives_is_a_difference(tmp_path):
    text, nothing = 'std_msgs/msg/String', {'data': '{"x": NaN, "y": NaN, "z": 1}'}
    first, second, third = (bag_of(tmp_path / f'run_{k}', text, [row]) for k, row in enumerate((
        nothing, {'data': '{"x": 2.5, "y": NaN, "z": 1}'}, {'data': f'{{"z": 1{"0" * 400}}}'})))
    assert diff(first, second)[0].largest == {'x': math.inf}
    assert diff(first, first)[0].is_same() and not diff(first, third)[0].is_same()


# --- the command line ----------------------------------------------------------------------------

def test_exit_codes_and_messages(bag, tmp_path, capsys):
    for action, says in (('info', 'finished'), ('scene', 'a1: 0.4'), (
            'recompute', f'{STEPS} driven motions, {len(OUTPUTS) * STEPS} outputs compared')):
        assert main(['bag', action, str(tmp_path / 'none')]) == 1
        assert capsys.readouterr().err == f'fourbar: {tmp_path}/none: no such bag\n'
        assert main(['bag', action, str(bag)]) == 0
        assert says in capsys.readouterr().out
        (tmp_path / 'text').write_text('no bag')
        assert main(['bag', action, str(tmp_path / 'text')]) == 1
        assert capsys.readouterr().err == f'fourbar: {tmp_path}/text: is no MCAP file\n'
    for action in ('info', 'recompute'):
        assert main(['bag', action, str(bag), '--json']) == 0
        told = json.loads(capsys.readouterr().out)
        assert told['bag'] == str(bag) and (told.get('sound') or told.get('good'))
    data = (bag / 'run_0.mcap').read_bytes()
    (tmp_path / 'run_0.mcap').write_bytes(data[:-100])
    assert main(['bag', 'info', str(tmp_path / 'run_0.mcap')]) == 3
    assert 'fourbar bag recover' in capsys.readouterr().out
    assert main(['bag', 'recover', str(tmp_path / 'run_0.mcap')]) == 0
    assert 'without its end' in capsys.readouterr().out
    assert main(['bag', 'recover', str(bag), '-o', str(tmp_path / 'new')]) == 0
    assert 'nothing lost' in capsys.readouterr().out
    assert all(topic.is_same() for topic in diff(bag, tmp_path / 'new'))


def test_the_scene_of_a_bag_is_a_parameter_file_again(bag, tmp_path, capsys):
    from fourbar_ros import load_scene
    assert main(['bag', 'scene', str(bag)]) == 0
    (tmp_path / 'again.yaml').write_text(capsys.readouterr().out)
    scene = load_scene(tmp_path / 'again.yaml')
    assert scene.linkage.a1 == 0.4 and scene.drive.source == 'motion'
    assert main(['bag', 'scene', str(bag), '--drive', 'timer']) == 0
    assert 'source: timer' in capsys.readouterr().out


@pytest.fixture
def with_scene(bag, tmp_path):
    """Return a function that writes the bag again, as anybody may, with other parameters."""
    def write(**changes):
        values = {**json.loads(Bag(bag).about['scene']), **changes}
        text = json.dumps({name: value for name, value in values.items() if value == value})
        writer = BagWriter(tmp_path, 'foreign', [bags.channel(*t) for t in Bag(bag).types.items()],
                           {**Bag(bag).about, 'scene': text})
        numbers = {topic: number for number, topic in enumerate(Bag(bag).types)}
        for raw in Bag(bag).raw():
            writer.write(numbers[raw.topic], bags.encode('std_msgs/msg/String', data=text)
                         if raw.topic == '/fourbar/scene' else raw.data)
        return writer.close()
    return write


@pytest.mark.parametrize('file', ['/dev/zero', '/etc/passwd', 'fifo', 'own.csv', 'nothing'])
def test_a_scene_in_a_bag_opens_no_file(with_scene, tmp_path, capsys, file):
    """/dev/zero has no end, and a pipe that nobody writes keeps its reader waiting."""
    os.mkfifo(tmp_path / 'fifo')
    (tmp_path / 'own.csv').write_text('theta1 [deg], couple [N m]\n0, 1\n360, 1\n')
    path = with_scene(**{'forces.g.link': 'output', 'forces.g.acts': 'couple',
                         'forces.g.table': str(tmp_path / file)})
    for verb in ('scene', 'recompute'):
        assert main(['bag', verb, str(path)]) == 1
        said = capsys.readouterr().err
        assert 'forces.g.table' in said and 'only the file of a scene names' in said
        assert said.count('\n') == 1
    with pytest.raises(BagError, match='only the file of a scene'):     # of replay --inputs-only
        origin_of(path)
    assert main(['bag', 'info', str(path), '--check']) == 0


@pytest.mark.parametrize('changes', [
    {f'points.p{k}.link': 'output' for k in range(20_000)}, {'joint_names': ['a'] * 2000},
    {'linkage.kind': 'machine', 'linkage.dyads': [f'd{k}' for k in range(5000)]},
    {'frame_id': 'x' * 2**24}], ids=['points', 'joints', 'dyads', 'text'])
def test_a_scene_in_a_bag_is_bounded(with_scene, capsys, changes):
    path = with_scene(**changes)
    for verb in ('scene', 'recompute'):
        assert main(['bag', verb, str(path)]) == 1
        said = capsys.readouterr().err
        assert 'its scene cannot be read: a scene ' in said and 'a bag may have' in said
        assert said.count('\n') == 1 and len(said) < 300


@pytest.mark.parametrize('topics', [{'driven': ['/a']}, {'driven': '/a', 'state': {}},
                                    {'driven': 1}])
def test_topics_in_metadata_that_are_no_texts_are_one_line(tmp_path, capsys, topics):
    path = bag_of(tmp_path / 'run', 'std_msgs/msg/String', [{'data': ''}], {
        'topics': json.dumps(topics), 'scene': json.dumps(from_values(FULL).values)})
    for verb in ('scene', 'recompute'):
        assert main(['bag', verb, str(path)]) == 1
        assert 'holds no run of a fourbar_node' in capsys.readouterr().err


def test_a_foreign_bag_is_not_recomputed_but_reported_as_foreign(mixed):
    with pytest.raises(BagError, match='holds no run of a fourbar_node'):
        recompute(mixed)
    assert info(mixed, check=True).is_sound and recover(
        mixed, mixed.parent / 'copy').messages == 60
