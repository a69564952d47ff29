# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What is done with a bag: recompute, export, diff, plot, play, and the command line around it."""
import csv
import json
import math
import os
import pty
import re
import subprocess
import sys
import time

from fourbar_ros.bag.cdr import Decoder
from fourbar_ros.bag.diff import diff
from fourbar_ros.bag.difference import distance
from fourbar_ros.bag.recompute import recompute
from fourbar_ros.bag.export import export
from fourbar_ros.bag.exports.plot import over, plot, series, thinned
from fourbar_ros.bag.mcap import writer as container
from fourbar_ros.bag.mcap.records import MAGIC
from fourbar_ros.bag.read import reader
from fourbar_ros.bag.read.playback import Pace, play, span
from fourbar_ros.bag.reader import Bag, records
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.cli.main import main
from fourbar_ros.cli.replay import status_line
from fourbar_ros.errors import BagError
import matplotlib
import numpy as np
import pytest
from support import bags
from support.scenes import OUTPUTS, PAPER, ROCKER, RODS, TIP

STEPS = 400
TURNS = [(0.05 * k, 25.0, 0.1 * k) for k in range(STEPS)]
FULL = {**PAPER, **RODS, **TIP, 'outputs': OUTPUTS, 'drive.source': 'motion'}


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    return bags.run(tmp_path_factory.mktemp('tools'), 'run', FULL, TURNS)


# --- recompute -----------------------------------------------------------------------------------

def test_a_fresh_bag_recomputes_without_any_difference(bag):
    found = recompute(bag)
    assert found.inputs == STEPS and found.unmatched == 0 and not found.cut
    assert {(d.messages, d.largest) for d in found.differences} == {(STEPS, 0.0)}
    assert len(found.differences) > 45


@pytest.mark.parametrize('policy', ['none', 'hold', 'clamp'])
def test_bad_inputs_and_every_policy_recompute_exactly(tmp_path, policy):
    cranks = [(0.01 * k, 1.0, 0.0) for k in range(200)]
    cranks[5:9] = [(math.nan, 1.0, 0.0), (0.1, math.inf, 0.0), (1e300, 1e200, 0.0),
                   (0.2, math.nan, math.nan)]
    path = bags.run(tmp_path, 'run', {**ROCKER, **RODS, **TIP, 'outputs': OUTPUTS,
                                      'drive.out_of_range': policy}, cranks)
    found = recompute(path)
    assert max(d.largest for d in found.differences) == 0.0 and found.inputs == 200


def test_scenes_changed_on_the_way_are_followed(tmp_path):
    path = bags.run(tmp_path, 'run', FULL, TURNS,
                    {100: {'linkage.a1': 0.35}, 101: {'linkage.mode': 1},
                     333: {'bodies.rods.density': 2700.0}})
    found = recompute(path)
    assert max(d.largest for d in found.differences) == 0.0 and found.inputs == STEPS
    assert len(list(records(path, ['/fourbar/scene']))) == 4


def test_outputs_without_their_input_are_counted_not_compared(tmp_path):
    path = bags.run(tmp_path, 'run', FULL, TURNS[:20])
    topics = ['/fourbar/driven', '/fourbar/scene', '/fourbar/state']
    metadata = Bag(path).metadata()
    writer = BagWriter(tmp_path, 'less',
                       [bags.channel(t, 'fourbar_msgs/msg/Motion' if 'driven' in t else
                                     'std_msgs/msg/String' if 'scene' in t else
                                     'fourbar_msgs/msg/LinkageState') for t in topics],
                       metadata['custom_data'])
    for i, raw in enumerate(r for r in Bag(path).raw(topics)):
        if not (raw.topic == topics[0] and raw.sequence in (0, 7, 8)):
            writer.write(topics.index(raw.topic), raw.data)
    found = recompute(writer.close())
    assert (found.unmatched == 3 and found.inputs == 17
            and max(d.largest for d in found.differences) == 0.0)


def test_one_changed_bit_is_found(bag, tmp_path):
    def change(raw):
        data = bytearray(raw.data)
        if raw.topic == '/fourbar/loads' and raw.sequence == 200:
            data[-32] ^= 1                                  # the last bit of shaking_moment
        return data
    path = bags.copy(bag, tmp_path, 'bit', change)
    differing = [d for d in recompute(path).differences if d.largest]
    assert [(d.topic, d.field) for d in differing] == [('/fourbar/loads', 'shaking_moment')]
    assert 0.0 < differing[0].largest < 1e-9
    assert main(['bag', 'recompute', str(path)]) == 3
    assert main(['bag', 'recompute', str(path), '--tolerance', '1e-6']) == 0
    assert main(['bag', 'recompute', str(bag)]) == 0
    found = {topic.topic: topic for topic in diff(bag, path)}
    assert (not found['/fourbar/loads'].is_same() and all(t.is_same() for n, t in found.items()
                                                          if n != '/fourbar/loads'))
    assert (main(['bag', 'diff', str(bag), str(path)]) == 3
            and main(['bag', 'diff', str(bag), str(bag)]) == 0)


def test_the_distance_knows_nan_and_infinity():
    nan, inf = math.nan, math.inf
    assert distance(np.array([1.0, nan, inf, -inf]), np.array([1.0, nan, inf, -inf])) == 0.0
    for a, b in ((nan, 1.0), (1.0, nan), (inf, -inf), (inf, 1.0), (nan, inf)):
        assert distance(np.array([0.0, a]), np.array([0.0, b])) == inf
    assert distance(np.array([1.0, 3.0]), np.array([1.5, 2.0])) == 1.0


def test_old_memory_in_the_padding_between_texts_changes_nothing(bag, tmp_path):
    rng, names = np.random.default_rng(3), next(records(bag, ['/joint_states'])).message.name
    assert any((len(name) + 1) % 4 for name in names)
    path = bags.copy(bag, tmp_path, 'dirty', lambda raw: raw.data if raw.topic != '/joint_states'
                     else
                     bags.with_old_memory(raw.data, names, rng))
    # behind the header
    assert len({raw.data[24:60] for raw in Bag(path).raw(['/joint_states'])}) > STEPS // 2
    assert len(list(Bag(path).columns(['/joint_states']))) == 1
    for pair in ((path, path), (path, bag)):
        assert [topic[1:4] for topic in diff(*pair, ['/joint_states'])] == [(STEPS, 0, 0)]
        assert all(topic.is_same() for topic in diff(*pair))
    assert export(path, tmp_path / 'run.npz', 'npz')['joint_states'] == STEPS
    assert (np.diff(np.load(tmp_path / 'run.npz')['joint_states/log_time']) > 0).all()
    name = 'joint_states.position[output]'
    times, values, _ = series(path, [name])[name]
    assert (np.diff(times) > 0).all() and values.tolist() == [
        r.message.position[3] for r in records(bag, ['/joint_states'])]
    found = recompute(path)
    assert (found.inputs == STEPS and found.unmatched == 0
            and {d.largest for d in found.differences} == {0.0})


# --- export, plot --------------------------------------------------------------------------------

def test_csv_and_npz_hold_every_number_exactly(bag, tmp_path):
    rows = export(bag, tmp_path / 'out')
    assert rows == export(bag, tmp_path / 'run.npz', 'npz') and rows['fourbar.state'] == STEPS
    arrays = np.load(tmp_path / 'run.npz')
    for topic in Bag(bag).metadata()['topics_with_message_count']:
        name = topic['topic_metadata']['name'].strip('/').replace('/', '.')
        with open(tmp_path / f'out/{name}.csv', newline='') as file:
            head, *lines = csv.reader(file)
        assert len(lines) == topic['message_count']
        for column, texts in zip(head, zip(*lines)):
            values = arrays[f'{name}/{column}']
            # NaN too
            assert repr(values.tolist()) == repr([type(values[0].item())(text) for text in texts])
    messages = [r.message for r in records(bag, ['/joint_states'])]
    assert arrays['joint_states/position[output]'].tolist() == [m.position[3] for m in messages]
    assert arrays['joint_states/effort[crank]'].tolist() == [m.effort[0] for m in messages]
    with pytest.raises(BagError, match='exists already'):
        export(bag, tmp_path / 'out')
    assert sorted(p.name for p in tmp_path.iterdir()) == ['out', 'run.npz']


def test_topics_whose_columns_change_go_on_in_a_new_table(tmp_path):
    writer = BagWriter(tmp_path, 'run', [bags.channel('/j', 'sensor_msgs/msg/JointState')], {})
    for k in range(30):
        names = ['a', 'b'] if k < 10 or k >= 20 else ['a', 'c', 'd']
        writer.write(0, bags.encode('sensor_msgs/msg/JointState', header=bags.stamp(k), name=names,
                                    position=np.arange(float(len(names))) + k,
                                    velocity=np.zeros(0),
                                    effort=np.zeros(0)))
    assert export(writer.close(), tmp_path / 'out') == {'j': 20, 'j.2': 10}
    head = (tmp_path / 'out/j.2.csv').read_text().splitlines()[0]
    assert head.endswith('position[a],position[c],position[d]')


@pytest.fixture
def mixed(tmp_path, monkeypatch):
    """Return a bag whose messages change to and fro between layouts, read in several blocks."""
    monkeypatch.setattr(reader, 'BLOCK', 16)
    writer = BagWriter(tmp_path, 'mixed', [bags.channel('/text', 'std_msgs/msg/String'),
                                           bags.MOTION,
                                           bags.channel('/j', 'sensor_msgs/msg/JointState')], {})
    for k in range(90):
        frame = 'x' * (7 * k % 5)
        names = ['a', 'b'] if k % 3 else ['a', 'c', 'd']
        writer.write(0, bags.encode('std_msgs/msg/String', data=f'{"-" * (11 * k % 7)}{k}'))
        writer.write(1, bags.encode('fourbar_msgs/msg/Motion',
                                    header=bags.stamp(k * 10**6 + 1, frame),
                                    position=float(k), velocity=0.0, acceleration=0.0))
        writer.write(2, bags.encode('sensor_msgs/msg/JointState', header=bags.stamp(k * 10**6 + 1),
                                    name=names,
                                    position=np.full(len(names), float(k)), velocity=np.zeros(0),
                                    effort=np.zeros(0)))
    return writer.close()


def test_rows_of_several_layouts_stand_in_the_order_of_the_bag(mixed, tmp_path):
    rows = export(mixed, tmp_path / 'out')
    assert (rows['text'], rows['j'], rows['j.2']) == (90, 30, 60)       # j: a, c, d came first
    for name in rows:
        with open(tmp_path / f'out/{name}.csv', newline='') as file:
            times = [int(line['log_time']) for line in csv.DictReader(file)]
        assert times == sorted(times), name
    with open(tmp_path / 'out/text.csv', newline='') as file:
        assert [int(line['data'].strip('-')) for line in csv.DictReader(file)] == list(range(90))
    for field in ('driven.position', 'j.position[a]'):
        times, values, _ = series(mixed, [field])[field]
        assert (np.diff(times) > 0).all() and values.tolist() == list(range(90))


def test_messages_of_several_layouts_meet_in_a_diff(mixed, tmp_path):
    assert [(topic[1:4], topic.is_same())
            for topic in diff(mixed, mixed)] == [((90, 0, 0), True)] * 3
    other = bags.copy(mixed, tmp_path, 'other', lambda raw: raw.data if raw.topic != '/text'
                      or raw.sequence != 40 else
                      bags.encode('std_msgs/msg/String', data='another, longer than all before'))
    found = {topic.topic: topic for topic in diff(mixed, other)}
    assert [name for name, topic in found.items() if not topic.is_same()] == ['/text']


def test_messages_that_nobody_stamped_are_compared_by_their_place(tmp_path):
    writer = BagWriter(tmp_path, 'unstamped', [bags.MOTION], {})
    for _ in range(50):
        writer.write(0, bags.motion(0))
    path = writer.close()
    assert [topic[1:4] for topic in diff(path, path)] == [(50, 0, 0)]


def test_parquet_says_what_is_missing_or_writes(bag, tmp_path):
    try:
        import pyarrow.parquet
    except ImportError:
        with pytest.raises(BagError, match='pip install pyarrow'):
            export(bag, tmp_path / 'out', 'parquet')
        assert not list(tmp_path.iterdir())
    else:
        export(bag, tmp_path / 'out', 'parquet')
        table = pyarrow.parquet.read_table(tmp_path / 'out/fourbar.state.parquet')
        assert table['theta4'].to_pylist() == [r.message.theta4
                                               for r in records(bag, ['/fourbar/state'])]


@pytest.mark.parametrize('ending', ['csv', 'parquet'])
def test_a_path_with_an_ending_is_a_file_with_one_table(bag, tmp_path, capsys, ending):
    if ending == 'parquet':
        pytest.importorskip('pyarrow')
    path = tmp_path / f'state.{ending}'
    assert main(['bag', 'export', str(bag), '-o', str(path)]) == 1
    assert 'one file holds one table' in capsys.readouterr().err and not list(tmp_path.iterdir())
    assert main(['bag', 'export', str(bag), '-o', str(path), '--topics', '/fourbar/state']) == 0
    assert path.is_file() and list(tmp_path.iterdir()) == [path]
    export(bag, tmp_path / 'all', ending)
    assert path.read_bytes() == (tmp_path / f'all/fourbar.state.{ending}').read_bytes()
    assert main(['bag', 'export', str(bag), '-o', str(tmp_path / 'x.csv'), '--format',
                 'npz']) == 1
    assert 'ends in .csv, but the format is npz' in capsys.readouterr().err


def test_a_plot_over_a_field_pairs_values_of_one_stamp(bag, tmp_path, capsys, monkeypatch):
    curves, unit = over(bag, ['state.theta4', 'loads.f41'], 'state.theta1')
    states = [r.message for r in records(bag, ['/fourbar/state'])]
    loads = [r.message for r in records(bag, ['/fourbar/loads'])]
    assert unit == 'rad' and curves['loads.f41'][2] == 'N'
    for name, values in (('state.theta4', [m.theta4 for m in states]),
                         ('loads.f41', [m.f41 for m in loads])):
        x, y, _ = curves[name]
        known = ~np.isnan(x)
        assert y[known].tolist() == values
        assert x[known].tolist() == np.mod([m.theta1 for m in states], 2 * np.pi).tolist()
        # 20 rad are three turns and a bit: three gaps
        assert np.count_nonzero(~known) == 3 and np.array_equal(known, ~np.isnan(y))
    slow, _ = over(bag, ['state.theta1'], 'state.theta4')        # a rocker: no turn
    assert not np.isnan(slow['state.theta1'][0]).any()
    monkeypatch.setitem(matplotlib.rcParams, 'svg.fonttype', 'none')
    out = tmp_path / 'over.svg'
    assert main(['bag', 'plot', str(bag), 'loads.f41', '--x', 'state.theta1', '-o',
                 str(out)]) == 0
    assert 'state.theta1 [rad]' in out.read_text()
    assert main(['bag', 'plot', str(bag), 'loads.f41', '--x', 'state.thetaX', '-o',
                 str(tmp_path / 'no.svg')]) == 1
    assert 'state.thetaX: no such field' in capsys.readouterr().err


def test_a_plot_has_its_fields_with_units_and_names_what_is_not_there(bag, tmp_path):
    found = series(bag, ['state.theta4', '/fourbar/loads.f41', 'joint_states.position[crank]'])
    times, values, unit = found['state.theta4']
    assert unit == 'rad' and found['/fourbar/loads.f41'][2] == 'N' and len(times) == STEPS
    assert np.allclose(times, np.arange(STEPS) * 1e-3, rtol=0, atol=4 * np.spacing(STEPS * 1e-3))
    assert values.tolist() == [r.message.theta4 for r in records(bag, ['/fourbar/state'])]
    by_index = series(bag, ['joint_states.position[3]', 'joint_states.position[output]'])
    assert (by_index['joint_states.position[3]'][1].tolist()
            == by_index['joint_states.position[output]'][1].tolist())
    assert by_index['joint_states.position[3]'][2] == by_index['joint_states.position[output]'][2]
    for wrong, said in (('state.theta9', 'state has'), ('nothing.x', 'field; topics are'),
                        ('state', 'state has'),
                        ('f41', r'write TOPIC\.FIELD, as loads\.f41; topics are'),
                        ('theta', r'write TOPIC\.FIELD, as state\.theta4; topics are'),
                        *((f'joint_states.{field}', 'joint_states has') for field in
                          ('position[4]', 'position[-1]', 'position[]', 'position[3', 'position',
                           'header.frame_id',
                           'header.frame_id[0]', 'name[0]', 'header.stamp.sec[0]'))):
        with pytest.raises(BagError, match=said):
            series(bag, [wrong])
    plot(bag, ['state.theta4', 'loads.f41'], tmp_path / 'run.png')
    assert (tmp_path / 'run.png').read_bytes().startswith(b'\x89PNG')
    with pytest.raises(BagError, match='run.nothing'):
        plot(bag, ['state.theta4'], tmp_path / 'run.nothing')


# --- diff ----------------------------------------------------------------------------------------

def test_diff_matches_by_stamp_and_counts_what_is_in_one_bag_only(bag, tmp_path, capsys):
    part = bags.run(tmp_path, 'part', FULL, TURNS[:300])
    other = bags.run(tmp_path, 'other', {**FULL, 'linkage.a1': 0.39}, TURNS)
    by_topic = {topic.topic: topic for topic in diff(bag, part)}
    assert (by_topic['/fourbar/state'][1:4] == (300, 100, 0)
            and not any(by_topic['/fourbar/state'].largest.values()))
    assert {topic.topic: topic
            for topic in diff(part, bag)}['/fourbar/loads'][1:4] == (300, 0, 100)
    changed = {topic.topic: topic for topic in diff(bag, other)}
    assert (changed['/fourbar/driven'].is_same() and changed['/fourbar/state'].largest['theta4']
            > 1e-3)
    assert changed['/fourbar/state'].is_same(tolerance=1e4)
    assert (list(changed['/fourbar/scene'].largest) == ['linkage.a1']
            and not changed['/fourbar/scene'].is_same())
    assert changed['/fourbar/scene'].largest['linkage.a1'] == pytest.approx(0.01)
    assert main(['bag', 'diff', str(bag), str(other), '--topics', '/fourbar/scene']) == 3
    assert 'linkage.a1' in capsys.readouterr().out
    unlike = bags.run(tmp_path, 'unlike', {**FULL, 'outputs': ['state'], 'linkage.mode': 1},
                      TURNS[:9])
    found = diff(bag, unlike, ['/fourbar/scene'])[0]
    assert found.largest['outputs'] == math.inf and 'linkage.a1' not in found.largest
    with pytest.raises(BagError, match='in neither bag'):
        diff(bag, part, ['/nothing'])


# --- play ----------------------------------------------------------------------------------------

def paced(tmp_path, count=40, step=0.005):
    """Return a bag whose messages are ``step`` apart."""
    writer = BagWriter(tmp_path, 'paced', [bags.MOTION], {})
    clock, begun = writer.clock, writer.clock.now()
    for k in range(count):
        clock.now = lambda k=k: begun + round(k * step * 1e9)
        writer.write(0, bags.motion(k))
    return writer.close()


def test_play_keeps_the_original_pace_and_its_multiples(tmp_path):
    path = paced(tmp_path)
    for rate in (1.0, 4.0):
        began = time.monotonic()
        came = [time.monotonic() - began for _ in play(path, rate=rate)]
        due = [0.005 * k / rate for k in range(40)]
        assert len(came) == 40 and all(c >= d - 1e-9 for c, d in zip(came, due))      # never early
        # and mostly in time
        assert sorted(c - d for c, d in zip(came, due))[20] < 0.1
    assert len(list(play(path, rate=math.inf))) == 40


def test_play_starts_later_loops_selects_and_stops_on_request(tmp_path, bag):
    path = paced(tmp_path)
    assert [r.sequence for r in play(path, start=0.1, rate=math.inf)] == list(range(20, 40))
    assert list(play(path, start=99.0)) == []
    looped = []
    for raw in play(path, rate=math.inf, loop=True):
        looped.append(raw.sequence)
        if len(looped) == 100:
            break
    assert looped == [k % 40 for k in range(100)]
    assert {r.topic for r in play(bag, ['/joint_states'], rate=math.inf)} == {'/joint_states'}
    ticks = []
    assert len(list(play(path, tick=lambda now: ticks.append(now) or len(ticks) < 5,
                         rate=0.01))) < 5 == len(ticks)
    for name, value in (('rate', 0.0), ('rate', -1.0), ('rate', math.nan), ('rate', 1e-160),
                        ('start', -1.0), ('start', 1e308), ('start', math.nan)):
        with pytest.raises(BagError, match=f'^{name} = {re.escape(repr(value))}: must be '):
            list(play(path, **{name: value}))


def test_info_of_an_empty_file_promises_no_recovery(tmp_path, capsys):
    empty = tmp_path / 'empty.mcap'
    empty.touch()
    main(['bag', 'info', str(empty)])
    assert 'nothing to recover' in capsys.readouterr().out
    assert main(['bag', 'recover', str(empty)]) == 1
    assert 'nothing to recover' in capsys.readouterr().err


# --- command line --------------------------------------------------------------------------------

def test_exit_codes_and_messages(tmp_path, capsys, monkeypatch):
    # so that a part of it is left when it is cut
    monkeypatch.setattr(container, 'CHUNK_SIZE', 20_000)
    bag = bags.run(tmp_path, 'run', FULL, TURNS)
    assert main(['bag', 'info', str(bag)]) == 0 and main(['bag', 'info', str(bag), '--check']) == 0
    said = capsys.readouterr().out
    assert 'finished' in said and '/fourbar/state' in said and str(STEPS) in said
    cut = tmp_path / 'cut_0.mcap'
    cut.write_bytes((bag / 'run_0.mcap').read_bytes()[:60_000])
    assert (main(['bag', 'info', str(cut)]) == 3
            and 'fourbar bag recover' in capsys.readouterr().out)
    assert main(['bag', 'recover', str(cut)]) == 3
    assert main(['bag', 'recover', str(bag), '-o', str(tmp_path / 'same')]) == 0
    assert 'nothing lost' in capsys.readouterr().out
    assert main(['bag', 'recompute', str(cut)]) == 0
    assert 'the bag is cut' in capsys.readouterr().out
    for wrong in (['bag', 'info', str(tmp_path / 'no')], ['bag', 'recover', str(cut)],
                  ['bag', 'export', str(bag), '-o', str(tmp_path)],
                  ['bag', 'plot', str(bag), 'x.y', '-o', 'x.png']):
        assert main(wrong) == 1
        error = capsys.readouterr().err
        assert error.startswith('fourbar: ') and error.count('\n') == 1
    with pytest.raises(SystemExit) as stopped:
        main(['bag', 'diff', str(bag)])
    assert stopped.value.code == 2


def test_a_file_that_is_no_bag_is_not_reported_as_cut(tmp_path, capsys):
    for content in (b'linkage: {a1: 0.4}\n' * 40, b'x', MAGIC[1:4]):
        (tmp_path / 'no.yaml').write_bytes(content)
        for action in (['info'], ['info', '--check'], ['export', '-o', str(tmp_path / 'out')]):
            assert main(['bag', *action, str(tmp_path / 'no.yaml')]) == 1
            assert capsys.readouterr().err == f'fourbar: {tmp_path}/no.yaml: not an MCAP file\n'
    for length in range(len(MAGIC) + 1):
        (tmp_path / 'short.mcap').write_bytes(MAGIC[:length])
        assert main(['bag', 'info', str(tmp_path / 'short.mcap')]) == 3
        assert 'cut off' in capsys.readouterr().out


def test_a_foreign_bag_is_not_recomputed_but_reported_as_foreign(tmp_path):
    writer = BagWriter(tmp_path, 'foreign', [bags.MOTION], {})
    writer.write(0, bags.motion(1))
    with pytest.raises(BagError, match='holds no run of a fourbar_node'):
        recompute(writer.close())


def test_the_scene_of_a_bag_is_a_parameter_file_again(bag, tmp_path, capsys):
    from fourbar_ros.scene import scene as scenes
    assert main(['bag', 'scene', str(bag)]) == 0
    (tmp_path / 'again.yaml').write_text(capsys.readouterr().out)
    again, told = (scenes.load(tmp_path / 'again.yaml'),
                   json.loads(Bag(bag).metadata()['custom_data']['scene']))
    assert again.drive.source == 'motion' and again.linkage.lengths == (0.4, 1.2, 0.8, 1.0)
    assert {k: v for k, v in again.values.items() if v == v} == {k: v for k, v in told.items()
                                                                 if v == v}


def test_every_verb_explains_itself_with_ros_and_mcap_blocked():
    verbs = [[], ['bag'], ['replay'], ['record'],
             *(['bag', a] for a in ('info', 'recover', 'recompute', 'export',
                                    'plot', 'diff', 'scene'))]
    code = f"""import sys; sys.modules.update(rclpy=None, mcap=None, matplotlib=None)
from fourbar_ros.cli.main import main
for verb in {verbs}:
    try:
        main([*verb, '--help'])
    except SystemExit as ended:
        assert not ended.code
    print('#', end='')"""
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stderr
    pages = done.stdout.split('#')[:-1]
    assert len(pages) == len(verbs) and min(map(len, pages)) > 200


class Clock:
    """A time that passes on request."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def test_a_pace_can_be_paused_stepped_and_changed_without_a_jump():
    clock = Clock()
    pace = Pace(2.0, clock)
    clock.now += 3.0
    assert pace.passed() == 6.0 and pace.is_due(6.0) and not pace.is_due(6.1)
    pace.step()                                         # only while the time stands still
    assert not pace.is_due(6.1)
    pace.pause()
    clock.now += 50.0
    assert pace.passed() == 6.0 and not pace.is_due(5.0)
    pace.step()
    pace.step()
    assert pace.is_due(7.0) and pace.is_due(7.5) and not pace.is_due(7.6) and pace.passed() == 7.5
    pace.pause(False)
    assert pace.passed() == 7.5
    clock.now += 1.0
    pace.change(0.25)
    assert pace.passed() == 9.5 and pace.rate == 0.5
    clock.now += 4.0
    assert pace.passed() == 11.5
    with pytest.raises(BagError, match='rate'):
        Pace(0.0)


def test_play_follows_its_pace(tmp_path):
    path = paced(tmp_path)
    pace, heard, ticks = Pace(1.0), [], []
    pace.pause()

    def tick(now):
        ticks.append(now)
        if len(ticks) % 10 == 0 and len(heard) < 5:
            pace.step()
        elif len(heard) == 5:
            pace.pause(False)
        return True
    for raw in play(path, tick=tick, pace=pace, period=0.001):
        heard.append(raw.sequence)
    assert heard == list(range(40)) and len(ticks) > 50
    assert span(path) == (next(Bag(path).raw()).time, [raw.time for raw in Bag(path).raw()][-1])


def test_keys_are_read_from_a_terminal_as_they_are_pressed():
    code = ('import time, sys\nfrom fourbar_ros.cli.replay import Keyboard\nfound = []\n'
            'with Keyboard() as keyboard:\n    print(keyboard.is_there, flush=True)\n'
            '    end = time.monotonic() + 30\n'
            '    while len(found) < 5 and time.monotonic() < end:\n        found += '
            'keyboard.pressed()\n        time.sleep(0.01)\nprint(*found, flush=True)\n')
    child, terminal = pty.fork()
    if child == 0:
        os.execv(sys.executable, [sys.executable, '-c', code])
    said = b''
    while b'True' not in said:
        said += os.read(terminal, 1000)
    for key in (b' ', b'x', b'\x1b[', b'C', b'\x1b[A\x1b[B', b' '):
        os.write(terminal, key)
        time.sleep(0.02)
    while b'space right up down space' not in said:
        said += os.read(terminal, 1000)
    os.waitpid(child, 0)
    os.close(terminal)
    done = subprocess.run([sys.executable, '-c', code.replace('+ 30', '+ 0.1')],
                          stdin=subprocess.DEVNULL, check=True,
                          capture_output=True, text=True)
    assert done.stdout.split() == ['False']


def test_the_status_of_a_replay_says_where_it_is_and_what_is_left():
    pace = Pace(2.0)
    assert status_line(4 * 10**9, 10**9, 11 * 10**9, pace) == '3.0 s of 10.0 s, 3.5 s left, rate 2'
    pace.pause()
    assert status_line(4 * 10**9, 10**9, None, pace) == '3.0 s, rate 2, paused'


def test_a_thinned_curve_keeps_every_peak_and_every_gap(tmp_path, monkeypatch):
    rng = np.random.default_rng(5)
    values = rng.normal(size=100_003)
    values[[0, 777, 50_000, 100_002]] = 90.0, -1e3, 1e4, 80.0
    values[60_000:60_007] = np.nan
    places = np.cumsum(rng.integers(1, 5, len(values)))
    keep = thinned(places, values, 1000)
    assert len(keep) < 2200 and (np.diff(keep) > 0).all()
    assert {0, 777, 50_000, 100_002} <= set(keep.tolist()) and np.isnan(values[keep]).any()
    stretch = (places - places[0]) * 1000 // (places[-1] - places[0] + 1)
    for number in range(1000):                             # none loses its extrema
        whole, kept = values[stretch == number], values[keep][stretch[keep] == number]
        assert np.nanmax(whole) == np.nanmax(kept) and np.nanmin(whole) == np.nanmin(kept)
    assert thinned(places[:5], values[:5], 1000).tolist() == [0, 1, 2, 3, 4]
    writer = BagWriter(tmp_path, 'run', [bags.MOTION], {}, sync_period=0.0)
    peaks = [40_000.0 if k in (5, 3001, 9998) else -40_000.0 if k == 7000 else math.sin(k)
             for k in range(10_000)]
    for k, peak in enumerate(peaks):
        writer.write(0, bags.encode('fourbar_msgs/msg/Motion', header=bags.stamp((k + 1) * 10**6),
                                    position=peak,
                                    velocity=0.0, acceleration=0.0))
    path = writer.close()
    monkeypatch.setattr(reader, 'BLOCK', 500)
    times, found, _ = series(path, ['driven.position'], stretches=50)['driven.position']
    assert len(times) < 500 and (np.diff(times) > 0).all()
    assert [(round(t, 3), v) for t, v in zip(times, found) if abs(v) > 1] == [
        (0.005, 4e4), (3.001, 4e4), (7.0, -4e4), (9.998, 4e4)]
    assert series(path, ['driven.position'])['driven.position'][1].tolist() == peaks


def test_messages_that_nobody_stamped_do_not_break_the_time_axis(tmp_path):
    writer, begun = BagWriter(tmp_path, 'run', [bags.MOTION], {},
                              sync_period=0.0), 1_800_000_000 * 10**9
    for k in range(100):
        writer.clock.now = lambda k=k: begun + k * 10**7 + 5000
        writer.write(0, bags.motion(begun + k * 10**7 if k not in (0, 40, 99) else 0))
    times, _, _ = series(writer.close(), ['driven.position'])['driven.position']
    assert times[0] == 0.0 and (np.diff(times) > 0).all() and 0.97 < times[-1] < 1.0


def test_only_the_topics_that_are_drawn_are_decoded(bag, monkeypatch):
    decoded = []
    arrays = Decoder.arrays
    monkeypatch.setattr(Decoder, 'arrays',
                        lambda self, messages: decoded.append(self.definition.name) or arrays(
                            self, messages))
    monkeypatch.setattr(reader, 'BLOCK', 100)
    series(bag, ['state.theta4'])
    assert decoded.count('fourbar_msgs/msg/LinkageState') > 1
    assert decoded.count('fourbar_msgs/msg/LinkageLoads') <= 1          # where the time begins


def test_two_topics_of_one_name_are_kept_apart(tmp_path):
    writer = BagWriter(tmp_path, 'run', [bags.MOTION, bags.MOTION._replace(topic='/other/driven')],
                       {})
    writer.write(0, bags.motion(1))
    writer.write(1, bags.motion(2))
    path = writer.close()
    with pytest.raises(BagError, match='which of /fourbar/driven, /other/driven'):
        series(path, ['driven.position'])
    assert series(path, ['/other/driven.position'])['/other/driven.position'][1].tolist() == [2.0]
