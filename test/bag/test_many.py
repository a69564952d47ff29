# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Several bags in one command, in processes of their own; what is found as JSON."""
import json
import shutil
import subprocess
import sys

from fourbar_ros.bag.read.collection import bags_below, each
from fourbar_ros.bag.info import info
from fourbar_ros.bag.recorder import Split
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
import pytest
from support import bags
from support.samples import some
from support.scenes import PAPER

VALUES = {**PAPER, 'outputs': ['state', 'joint_states'], 'drive.source': 'motion'}
TURNS = [(0.05 * k, 25.0, 0.1) for k in range(60)]


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    """
    Return a folder with bags at several depths.

    Good, split, of another scene, cut, loose files.
    """
    folder = tmp_path_factory.mktemp('many')
    good = bags.run(folder, 'good', VALUES, TURNS, paced=True, sync_period=0.0)
    bags.run(folder / 'day', 'split', VALUES, TURNS, paced=True, sync_period=0.0,
             flush_period=0.005,
             split=Split(duration=0.02, head=0))
    data = (good / 'good_0.mcap').read_bytes()
    (folder / 'day/loose').mkdir()
    (folder / 'day/loose/a_0.mcap').write_bytes(data)
    (folder / 'day/loose/b_0.mcap').write_bytes(data[:len(data) // 2])
    wrong = bags.copy(good, folder, 'wrong', lambda raw: raw.data[:-8] + bytes(8)
                      if raw.topic == '/joint_states' else raw.data)
    (folder / 'notes').mkdir()
    return folder, wrong


def lines(capsys):
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_bags_are_found_at_any_depth_each_once(folder):
    folder, _ = folder
    found = [str(bag.relative_to(folder))
             for bag in bags_below([folder, folder / 'good', folder / 'day'])]
    assert found == ['day/loose/a_0.mcap', 'day/loose/b_0.mcap', 'day/split', 'good', 'wrong']
    for nothing, said in ((folder / 'notes', 'holds no bags'),
                          (folder / 'nowhere', 'no such bag')):
        with pytest.raises(BagError, match=said):
            bags_below([folder, nothing])


@some('jobs', ['1', '2'], ('2',))
def test_info_of_a_folder_is_a_row_a_bag(folder, capsys, jobs):
    assert main(['bag', 'info', str(folder[0]), '--check', '--jobs', jobs]) == 3
    said = capsys.readouterr().out
    rows = [line.split() for line in said.splitlines() if line.startswith('/')]
    assert [row[1] for row in rows] == ['finished', 'cut', 'finished', 'finished', 'finished']
    assert main(['bag', 'info', str(folder[0] / 'good'), str(folder[0] / 'day/split')]) == 0


def test_json_of_info_has_the_documented_keys_and_is_a_line_a_bag(folder, capsys):
    assert main(['bag', 'info', str(folder[0]), '--json', '--jobs', '2']) == 3
    found = lines(capsys)
    assert [one['sound'] for one in found] == [True, False, True, True, True]
    assert all(set(one) == {'bag', 'sound', 'state', 'size', 'parts', 'start', 'end', 'messages',
                            'missing', 'dropped',
                            'ended', 'lost', 'damage', 'about', 'topics'} for one in found)
    assert found[2]['parts'] > 1 and found[2]['messages'] == found[3]['messages'] == 181
    assert set(found[0]['topics'][0]) == {'topic', 'type', 'messages', 'missing'}


def test_recompute_of_several_bags_and_its_json(folder, capsys):
    folder, wrong = folder
    assert main(['bag', 'recompute', str(folder / 'good'), str(folder / 'day/split'), '--jobs',
                 '2']) == 0
    assert [line.split()[1:4] for line in capsys.readouterr().out.splitlines()
            if line.startswith('/')] == [
        ['60', '120', '0'], ['60', '120', '0']]
    assert main(['bag', 'recompute', str(folder), '--json']) == 3
    found = {one['bag']: one for one in lines(capsys)}
    # of the cut one little is left
    whole = {bag: one for bag, one in found.items() if not bag.endswith('b_0.mcap')}
    assert ([one['good'] for one in whole.values()] == [True, True, True, False]
            and not found[str(wrong)]['good'])
    assert all(set(one) == {'bag', 'good', 'problems', 'by_rounding', 'verdict', 'largest',
                            'tolerance', 'cut', 'inputs', 'compared', 'unmatched', 'missing',
                            'doubled', 'silent', 'uncertain', 'driven', 'differences'}
               for one in found.values())
    assert {(d['topic'], d['field']) for d in found[str(wrong)]['differences']
            if d['largest']} == {('/joint_states', 'velocity')}
    assert (main(['bag', 'recompute', str(folder / 'good'), '--json']) == 0 and len(lines(capsys))
            == 1)


def test_json_of_a_diff_says_what_is_infinite_in_words(folder, capsys):
    folder, wrong = folder
    assert main(['bag', 'diff', str(folder / 'good'), str(wrong), '--json']) == 3
    found, = lines(capsys)
    assert set(found) == {'first', 'second', 'tolerance', 'same', 'topics'} and not found['same']
    topics = {topic['topic']: topic for topic in found['topics']}
    assert topics['/fourbar/state']['same'] and set(topics['/joint_states']) == {
        'topic', 'same', 'messages', 'only_first', 'only_second', 'largest'}
    assert main(['bag', 'diff', str(folder / 'good'), str(folder / 'good'), '--json']) == 0
    assert lines(capsys)[0]['same']


def test_a_bag_that_cannot_be_read_does_not_stop_the_others(folder, tmp_path, capsys):
    shutil.copytree(folder[0] / 'good', tmp_path / 'all/good')
    (tmp_path / 'all/no.mcap').parent.mkdir(exist_ok=True)
    (tmp_path / 'all/bad').mkdir()
    (tmp_path / 'all/bad/bad_0.mcap').write_text('no bag at all, but long enough to be looked at')
    for jobs in ('1', '2'):
        assert main(['bag', 'info', str(tmp_path / 'all'), '--json', '--jobs', jobs]) == 1
        found = lines(capsys)
        assert (set(found[0]) == {'bag', 'error'} and 'not an MCAP file' in found[0]['error']
                and found[1]['sound'])
    assert main(['bag', 'recompute', str(tmp_path / 'all')]) == 1
    assert 'not an MCAP file' in capsys.readouterr().out


def test_results_come_in_order_and_are_reported_as_they_are_done(folder):
    paths, told = bags_below([folder[0]]), []
    found = each(info, paths, jobs=2, done=told.append)
    assert ([one.state for one in found] == [info(path).state for path in paths]
            and told == [1, 2, 3, 4, 5])


def test_the_command_itself_works_in_processes(folder):
    done = subprocess.run([sys.executable, '-m', 'fourbar_ros', 'bag', 'info', str(folder[0]),
                           '--json', '--jobs', '2'],
                          capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 3 and len(done.stdout.splitlines()) == 5 and not done.stderr
