# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What recompute must find: every field, text, stamp, missing and doubled message.

In bags of rosbag2 as well.
"""
import json
import math

from fourbar_ros.bag import recomputation
from fourbar_ros.bag.outputs import AT_AN_END, STOPPED
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recomputation import NO_ORDER, NOT_TOLD, recompute, UNTOLD
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
from fourbar_ros.pipeline.stepper import Stepper, Wanted
from fourbar_ros.scene import scene as scenes
import numpy as np
import pytest
from support import bags, ROOT
from support.samples import more
from support.scenes import OUTPUTS, PAPER, RODS, TIP

FULL = {**PAPER, **RODS, **TIP, 'outputs': OUTPUTS, 'drive.source': 'motion'}
STEPS = 40
TURNS = [(0.05 * k, 25.0, 0.1 * k) for k in range(STEPS)]


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    return bags.run(tmp_path_factory.mktemp('recompute'), 'run', FULL, TURNS, paced=True)


def rewritten(bag, directory, raws, name='new', about=None):
    """Write these (topic, data, log time) into a new bag, as an old one says of its topics."""
    old, used = Bag(bag), {topic for topic, *_ in raws}
    topics = {topic: type_name for topic, type_name in old.types.items()
              if about is None or topic in used}
    next(old.raw([]), None)         # which notes the definitions
    channels = [bags.channel(*topic)._replace(schema=old.definition_of(topic[0]))
                for topic in topics.items()]
    writer = BagWriter(directory, name, channels, old.about if about is None else about)
    numbers = {topic: i for i, topic in enumerate(topics)}
    for topic, data, time in raws:
        writer.clock = lambda time=time: time
        writer.write(numbers[topic], data)
    return writer.close()


def content(bag):
    return [(raw.topic, raw.data, raw.time) for raw in Bag(bag).raw()]


def problems(path):
    return ' '.join(recompute(path).problems())


# --- fields --------------------------------------------------------------------------------------

OUTPUT_TOPICS = ['/fourbar/state', '/fourbar/output', '/joint_states', '/fourbar/loads',
                 '/fourbar/shaking_wrench',
                 '/fourbar/points/tip']


@pytest.mark.parametrize('topic', OUTPUT_TOPICS)
def test_the_last_bit_of_every_number_of_every_output_counts(bag, tmp_path, topic):
    """Every number is changed, each in a message of its own."""
    source = Bag(bag)
    raws = [raw for raw in source.raw() if raw.topic == topic]
    _, records = next(source.arrays(topic, [raws[0].data]))
    places = [(name, offset + i * kind.base.itemsize, kind.base)
              for name, (kind, offset) in records.dtype.fields.items()
              for i in range(kind.shape[0] if kind.shape else 1)]
    assert len(places) > 4
    stamps = [place for place in places if 'stamp' in place[0]]
    places = [place for place in places if place not in stamps]

    def changed(data, name, offset, kind):
        data = bytearray(data)
        is_nan = kind.kind == 'f' and math.isnan(np.frombuffer(data, kind, 1, offset)[0])
        data[offset + (7 if is_nan else 0)] ^= 64 if is_nan else 1
        return bytes(data)

    for begin in range(0, len(places), STEPS):
        some = places[begin:begin + STEPS]
        path = bags.copy(bag, tmp_path, f'n{begin}',
                         lambda raw, some=some: changed(raw.data, *some[raw.sequence])
                         if raw.topic == topic and raw.sequence < len(some) else raw.data)
        found = recompute(path)
        assert {d.field for d in found.differences if d.largest} == {name for name, *_ in some}
        assert ({d.topic for d in found.differences if d.largest} == {topic}
                and len(found.problems()) == 1)
    path = bags.copy(bag, tmp_path, 'stamps', lambda raw: changed(raw.data, *stamps[raw.sequence])
                     if raw.topic == topic and raw.sequence < 2 else raw.data)
    assert recompute(path).problems() == ['2 outputs without their motion', '2 outputs missing']
    assert not recompute(bag).problems()


def test_frame_and_names_of_joints_are_compared(bag, tmp_path):
    for number, (topic, old, new) in enumerate((('/fourbar/state', b'fourbar\0', b'foubarr\0'),
                                                ('/fourbar/driven', b'fourbar\0', b'foubarr\0'),
                                                ('/joint_states', b'coupler\0', b'couplor\0'))):
        path = bags.copy(bag, tmp_path, f't{number}',
                         lambda raw, topic=topic, old=old, new=new: raw.data.replace(
                             old, new, 1) if raw.topic == topic and raw.sequence == 7
                         else raw.data)
        differing = [d for d in recompute(path).differences if d.largest]
        assert [(d.topic, d.field, d.largest) for d in differing] == [
            (topic, 'name[1]' if topic == '/joint_states' else 'header.frame_id', math.inf)]


def test_a_difference_tells_which_other_version_recorded_the_bag(bag, tmp_path, capsys):
    """Custom data of anybody's making are no fault of the bag."""
    raws, about = content(bag), Bag(bag).about
    at = next(i for i, raw in enumerate(raws) if raw[0] == '/fourbar/equation')
    data = bytearray(raws[at][1])
    data[-8] ^= 1                       # the last bit of its last number
    raws[at] = raws[at][0], bytes(data), raws[at][2]
    for number, (software, said) in enumerate((
            ('{"fourbar_ros": "0.9.0"}', '(recorded by fourbar_ros 0.9.0; if that is rounding'),
            ('{"other": 1}', ''), ('[1]', ''), ('{"fourbar', ''))):
        path = rewritten(bag, tmp_path, raws, f'v{number}', {**about, 'software': software})
        assert main(['bag', 'recompute', str(path)]) == 3
        found = ' '.join(capsys.readouterr().out.split())
        assert 'differences up to' in found and ('recorded by' in found) == bool(said)
        assert said in found
        assert main(['bag', 'info', str(path)]) == 0
        assert ('0.9.0' in capsys.readouterr().out) == bool(said)


# --- messages ------------------------------------------------------------------------------------

@pytest.mark.parametrize('topic', OUTPUT_TOPICS)
@pytest.mark.parametrize('which', more((17,), (0, STEPS - 1)))
def test_a_removed_or_doubled_message_is_found(bag, tmp_path, topic, which):
    raws = content(bag)
    at = [i for i, raw in enumerate(raws) if raw[0] == topic][which]
    assert problems(rewritten(bag, tmp_path, raws[:at] + raws[at + 1:],
                              'less')) == '1 outputs missing'
    assert problems(rewritten(bag, tmp_path, raws[:at + 1] + raws[at:],
                              'more')) == '1 messages more than once'


@pytest.mark.parametrize('is_of_rosbag2', [False, True])
@pytest.mark.parametrize('order', [
    lambda raws: [raw for raw in raws for _ in range(2)],       # as two recorders merged by time
    lambda raws: raws + raws])                                  # as one played twice
def test_a_run_that_is_twice_in_a_bag_gives_what_it_gave_once(tmp_path, order, is_of_rosbag2):
    run = ROOT / 'test/support/data/recorded/stepped_rocker'
    about, raws = {} if is_of_rosbag2 else Bag(run).about, content(run)
    one, two = (recompute(rewritten(run, tmp_path, raws, name, about))
                for name, raws in (('once', raws), ('twice', order(raws))))
    assert one.largest == two.largest == 0.0
    repeats = 4 * one.inputs            # a motion, its state, loads, state of the drive
    assert (two.doubled, two.stepped) in {(repeats, one.stepped), (0, 2 * one.stepped)}
    assert two.problems() == ([f'{repeats} messages more than once'] if two.doubled else [])
    assert two.skipped == ({NO_ORDER: two.inputs} if is_of_rosbag2 else {})


def test_motion_by_torque_in_simulated_time_that_went_back_is_computed_in_its_modes(tmp_path):
    """Stamps come again, in other modes: the second half of a run has those of the first."""
    run = ROOT / 'test/support/data/recorded/stepped_rocker'
    stamps = list(dict.fromkeys(raw.data[4:12] for raw in Bag(run).raw(['/fourbar/driven'])))
    half = len(stamps) // 2
    again = dict(zip(stamps[half:], stamps))
    raws = [(topic, data[:4] + again.get(data[4:12], data[4:12]) + data[12:], time)
            for topic, data, time in content(run)]
    path = rewritten(run, tmp_path, raws, 'again', Bag(run).about)
    modes = [record.message.mode for record in Bag(path).records(['/fourbar/drive_state'])]
    assert any(a != b for a, b in zip(modes, modes[half:]))
    assert not problems(path)


def test_a_motion_that_a_node_sends_again_is_no_copy(tmp_path):
    """An input may come twice with one stamp: its outputs stand between."""
    path = bags.run(tmp_path, 'run', {**PAPER, 'outputs': ['state']}, TURNS, paced=True)
    old, raws = Bag(path), content(path)
    first = next(k for k, raw in enumerate(raws) if raw[0].endswith('/driven'))
    again = raws[:first + 2] + raws[first:]
    assert raws[first + 1][0].endswith('/state')
    found = recompute(rewritten(path, tmp_path, again, 'again', old.about))
    assert not found.problems() and found.inputs == recompute(path).inputs + 1


def test_states_of_a_drive_that_are_not_compared_are_counted():
    found = recompute(ROOT / 'test/support/data/recorded/pushed')
    assert found.skipped == {NOT_TOLD: 321} and found.inputs == 322


def test_a_removed_motion_leaves_its_outputs_alone(bag, tmp_path):
    raws = content(bag)
    at = [i for i, raw in enumerate(raws) if raw[0] == '/fourbar/driven'][9]
    assert problems(rewritten(bag, tmp_path, raws[:at]
                              + raws[at + 1:])) == f'{len(OUTPUTS)} outputs without their motion'


def test_with_nothing_to_compare_it_does_not_say_that_all_is_well(bag, tmp_path, capsys):
    raws = content(bag)
    for name, keep in (('outputs', lambda t: t != '/fourbar/driven'), ('motions', lambda t: t in (
            '/fourbar/driven', '/fourbar/scene')), ('nothing', lambda t: False)):
        path = rewritten(bag, tmp_path, [raw for raw in raws if keep(raw[0])], name)
        assert main(['bag', 'recompute', str(path)]) == 3, name
        assert 'bad: nothing could be compared' in capsys.readouterr().out


def test_outputs_that_say_that_the_input_stopped_are_no_fault(tmp_path):
    values = {**FULL, 'joint_states.when_unknown': 'hold'}
    path = bags.run(tmp_path, 'run', values, TURNS)
    scene, raws = scenes.from_values(values), content(path)
    stepper = Stepper(scene)
    for turn in TURNS:
        stepper.step(*turn, Wanted.of(scene))
    topics = json.loads(Bag(path).about['topics'])
    late = [(topics[name], bags.output_message(name, 10**9, 5, stepper.silence(), scene),
             raws[-1][2] + 10**9)
            for name in scene.topics]
    found = recompute(rewritten(path, tmp_path, raws + late))
    assert found.skipped[STOPPED] == len(late) == len(OUTPUTS) and not found.problems()


def test_the_last_step_of_a_cut_bag_need_not_be_whole(bag, tmp_path):
    cut = rewritten(bag, tmp_path, content(bag)[:-3])
    assert problems(cut) == '3 outputs missing'
    data = (cut / 'new_0.mcap').read_bytes()
    # without its end
    (tmp_path / 'cut_0.mcap').write_bytes(data[:data.rindex(b'\x0f' + (4).to_bytes(8, 'little'))])
    found = recompute(tmp_path / 'cut_0.mcap')
    assert found.is_cut and not found.problems() and found.skipped == {AT_AN_END: 3}


def test_joints_of_bags_from_before_they_were_continuous_and_a_jump_of_those_that_are(tmp_path):
    turns = [(0.5 * k, 1.0, 0.0) for k in range(100)]
    for is_wrapped in (True, False):
        path = bags.run(tmp_path, f'run_{is_wrapped}', FULL, turns, is_wrapped=is_wrapped)
        assert recompute(path).largest == 0.0
    old, about = content(tmp_path / 'run_True'), Bag(path).about
    jumping = recompute(rewritten(path, tmp_path, old, 'jumping', about))
    assert jumping.largest > 6.0


# --- bags of rosbag2 -----------------------------------------------------------------------------

def as_recorded_by_rosbag2(bag, directory, jitter=0, late_scene=0, keep=lambda topic: True):
    """Write a bag again as ``ros2 bag record -a`` does: in the order of arrival, no scene."""
    rng = np.random.default_rng(1)
    raws = [raw for raw in content(bag) if keep(raw[0])]
    moved = [(time + int(rng.integers(0, jitter + 1)) + (late_scene if topic.endswith('/scene')
                                                         else 0), i)
             for i, (topic, _, time) in enumerate(raws)]
    return rewritten(bag, directory, [(*raws[i][:2], time) for time, i in sorted(moved)],
                     'rosbag2', about={})


@pytest.mark.parametrize('jitter, late_scene', [(0, 0), (3_000_000, 10_000_000)])
def test_a_bag_of_rosbag2_is_recomputed_from_its_topics(bag, tmp_path, jitter, late_scene):
    path = as_recorded_by_rosbag2(bag, tmp_path, jitter=jitter, late_scene=late_scene)
    order = [raw.topic for raw in Bag(path).raw()]
    assert jitter == 0 or order != [raw[0] for raw in content(bag)]
    found = recompute(path)
    assert (not found.problems() and (found.inputs, found.compared)
            == (STEPS, len(OUTPUTS) * STEPS) and found.largest == 0.0)
    assert main(['bag', 'recompute', str(path)]) == 0
    wrong = bags.copy(path, tmp_path, 'wrong', lambda raw: raw.data[:-8] + b'\0' * 8
                      if raw.topic == '/fourbar/loads'
                      else raw.data)
    assert recompute(wrong).largest > 0.0


def test_an_output_before_its_motion_waits_for_the_next_block(bag, tmp_path, monkeypatch):
    monkeypatch.setattr(recomputation, 'BLOCK', 10)
    result = recompute(as_recorded_by_rosbag2(bag, tmp_path, jitter=3_000_000))
    assert not result.problems() and result.largest == 0.0
    assert result.compared == len(OUTPUTS) * STEPS


def test_what_rosbag2_missed_in_the_middle_is_missing_at_the_ends_it_is_not(bag, tmp_path):
    raws = content(as_recorded_by_rosbag2(bag, tmp_path))
    at = [i for i, raw in enumerate(raws) if raw[0] == '/fourbar/state']
    for name, gone, said in (('begin', at[:3], ''), ('end', at[-3:], ''),
                             ('middle', at[5:8], '3 outputs missing'), ('topic', at, '')):
        path = rewritten(bag, tmp_path, [raw for i, raw in enumerate(raws) if i not in gone], name,
                         about={})
        found = recompute(path)
        assert ' '.join(found.problems()) == said, name
        assert found.skipped == ({AT_AN_END: len(gone)} if name in ('begin', 'end') else {})


def test_a_scene_changed_during_a_bag_of_rosbag2_leaves_a_moment_out(tmp_path):
    cranks = [(0.05 * k, 25.0, 0.1) for k in range(300)]
    path = bags.run(tmp_path, 'run', FULL, cranks, {150: {'linkage.a1': 0.35}}, step_ns=5 * 10**6,
                    paced=True)
    found = recompute(as_recorded_by_rosbag2(path, tmp_path, jitter=10**7))
    skipped = sum(found.skipped.values())
    assert not found.problems() and found.inputs == 300 and 300 < skipped < 1000
    assert found.compared + skipped == 300 * len(OUTPUTS)


def test_a_remapped_topic_of_joint_states_is_found_and_two_nodes_are_kept_apart(
        bag, tmp_path, capsys):
    raws = content(as_recorded_by_rosbag2(bag, tmp_path))
    other = bags.run(tmp_path, 'other', {**PAPER, 'outputs': ['state']}, TURNS[:20], paced=True)
    topics = {**Bag(bag).types, **Bag(other).types}
    names = sorted(topics)
    writer = BagWriter(tmp_path, 'both', [
        *(bags.channel(name if name != '/joint_states' else '/cell/joint_states',
                       topics[name])
          for name in names),
        *(bags.channel(f'/cell{name}', topics[name]) for name in (
              '/fourbar/driven', '/fourbar/scene', '/fourbar/state'))], {})
    for topic, data, _ in raws:
        writer.write(names.index(topic), data)
    second = ['/fourbar/driven', '/fourbar/scene', '/fourbar/state']
    for topic, data, _ in content(other):
        writer.write(len(names) + second.index(topic), data)
    path = writer.close()
    with pytest.raises(BagError, match='holds runs of /cell/fourbar, /fourbar; say which with '
                                       '--node'):
        recompute(path)
    assert recompute(path, node='/fourbar').compared == len(OUTPUTS) * STEPS
    assert recompute(path, node='/cell/fourbar').inputs == 20
    assert main(['bag', 'recompute', str(path), '--node', '/cell/fourbar']) == 0
    assert main(['bag', 'scene', str(path), '--node', '/fourbar']) == 0
    assert 'a1: 0.4' in capsys.readouterr().out
    with pytest.raises(BagError, match='no run of /nobody'):
        recompute(path, node='/nobody')


RELAY = {**PAPER, **RODS, 'outputs': ['state', 'joint_states', 'loads'],
         'drive.source': 'joint_state', 'drive.joint': 'motor', 'joint_states.only_passive': True}


@pytest.mark.parametrize('robot', [['wheel', 'motor'], ['a', 'b', 'motor'], []], ids=len)
def test_joint_states_of_a_robot_on_the_topic_of_a_relay_are_not_its_outputs(
        tmp_path, capsys, robot):
    """``ros2 bag record`` keeps both; a robot may have as many joints as the relay adds."""
    kind = 'sensor_msgs/msg/JointState'

    def with_robot(name, before):
        path = bags.run(tmp_path, f'run_{name}', RELAY, TURNS, paced=True)
        raws = []
        for topic, data, time in content(path):
            theirs = '/joint_states', bags.encode(
                kind, header=bags.STORE.types['std_msgs/msg/Header'](
                    bags.STORE.deserialize_cdr(data, kind).header.stamp, ''), name=robot,
                position=np.arange(len(robot)) + 0.5, velocity=np.ones(len(robot)),
                effort=np.zeros(0)) if topic == '/joint_states' else b'', time
            raws += [theirs] * (before and topic == '/joint_states') + [(topic, data, time)]
            raws += [theirs] * (not before and topic == '/joint_states')
        return rewritten(path, tmp_path, raws, name, about={})

    first, second = with_robot('first', True), with_robot('second', False)
    for path in (first, second):
        found = recompute(path)
        assert (found.inputs, found.compared, found.problems()) == (STEPS, 3 * STEPS, [])
    assert main(['bag', 'diff', str(first), str(second)]) == 0
    # the last velocity, before three efforts, of an answer
    moved = bags.copy(first, tmp_path, 'moved', lambda raw: raw.data[:-40] + bytes(8)
                      + raw.data[-32:] if raw.topic == '/joint_states' and raw.sequence == 9
                      else raw.data)
    assert main(['bag', 'recompute', str(moved)]) == 3 and main(
        ['bag', 'diff', str(first), str(moved)]) == 3
    capsys.readouterr()


# --- wrenches ------------------------------------------------------------------------------------

PUSHED = {**PAPER, **RODS, 'outputs': ['state', 'loads'], 'drive.source': 'motion',
          'external.output.from_topic': True, 'external.timeout': 0.0}
PUSHES = {0: {'output': (3.0, -1.0, 0.5)}, 120: {'output': (-2.0, 4.0, 1.0)},
          200: {'output': (-2.0, 4.0, 1.0)}}


def pushed(directory, name='run', **parameters):
    cranks = [(0.05 * k, 25.0, 0.1) for k in range(300)]
    return bags.run(directory, name, {**PUSHED, **parameters}, cranks, step_ns=5 * 10**6,
                    paced=True, loads=PUSHES)


@pytest.mark.parametrize('left_out', ['', '/external/'])
def test_wrenches_in_a_bag_of_rosbag2_act_in_its_recomputation(tmp_path, left_out):
    path = as_recorded_by_rosbag2(pushed(tmp_path), tmp_path,
                                  keep=lambda topic: not left_out or left_out not in topic)
    found = recompute(path)
    assert not found.problems() and found.inputs == 300, found
    # 0.2 s around the first and the second wrench, not the third, which changes nothing
    skipped = sum(found.skipped.values())
    assert 2 * 110 < skipped < 2 * 130 and found.compared + skipped == 600
    other = rewritten(path, tmp_path, [
        (topic, bags.wrench(0, (3.0, -1.0, 0.6)) if '/applied/' in topic or '/external/' in topic
         else data, time) for topic, data, time in content(path)], 'other', about={})
    assert [d.field for d in recompute(other).differences if d.largest]


def test_without_the_wrenches_in_effect_nothing_is_compared_and_it_says_why(tmp_path):
    """The node records and publishes them on ~/applied; received ones do not tell the order."""
    path = as_recorded_by_rosbag2(pushed(tmp_path), tmp_path,
                                  keep=lambda topic: '/applied/' not in topic)
    found = recompute(path)
    assert found.skipped == {UNTOLD: 600}
    assert found.problems() == ['nothing could be compared']
