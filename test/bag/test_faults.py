# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Bag tools on a full disk, ended by a signal, on files that cannot be read.

One line, and nothing half-made.
"""
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

from fourbar_ros.bag.export import export
from fourbar_ros.bag.mcap import writer as container
from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.cli.main import main
import pytest
from support import bags, TEST
from support.bags import MOTION, motion
from support.samples import some

PATIENCE = 60.0
COUNT = 6000
# A verb that stops in the middle of its work and waits there: the first block is read, the second
# never comes.
WAITING = """
import sys, time
from fourbar_ros.bag.read import reader
from fourbar_ros.bag.mcap import scan
from fourbar_ros.cli.main import main
reader.BLOCK = 1000
def held(blocks):
    for i, found in enumerate(blocks):
        if i == {after}:
            print('waiting', flush=True)
            # a signal just before a long sleep would wait for its end
            for _ in range(round({patience} / 0.01)):
                time.sleep(0.01)
        yield found
real, walk = reader.Bag.blocks, scan.Scan.__iter__
reader.Bag.blocks = lambda *args, **kwargs: held(real(*args, **kwargs))
if {verb!r} == 'recover':
    scan.Scan.__iter__ = lambda self: held(walk(self))
sys.exit(main({arguments!r}))
"""


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return the path of a bag that no format makes smaller than 100 kB."""
    with pytest.MonkeyPatch.context() as patch:
        # many chunks, however fast it is written
        patch.setattr(container, 'CHUNK_SIZE', 20_000)
        writer = BagWriter(tmp_path_factory.mktemp('faults'), 'run', [MOTION], {})
        noise = os.urandom(8 * COUNT)
        for k in range(COUNT):
            writer.write(0, bags.encode(MOTION.type, header=bags.stamp(k), position=float(k),
                                        acceleration=0.0,
                                        velocity=float(int.from_bytes(noise[8 * k:8 * k + 7],
                                                                      'big'))))
        return writer.close()


# Where files may not grow, coverage cannot write what it found either.
UNMEASURED = {name: value for name, value in os.environ.items() if 'COVERAGE' not in name}


def arguments_of(verb, bag, out):
    """Return the command line of a verb that writes something."""
    if verb == 'recover':
        return ['bag', 'recover', str(bag), '-o', str(out)]
    return ['bag', 'export', str(bag), '-o', str(out), '--format', verb]


@some('limit', [1000, 60_000], (60_000,))
@some('verb', ['recover', 'csv', 'npz', 'parquet'], ('recover', 'csv'))
def test_a_disk_that_is_full_is_one_line_and_leaves_nothing(bag, tmp_path, verb, limit):
    if verb == 'parquet':
        pytest.importorskip('pyarrow')
    code = ('import sys; from fourbar_ros.cli.main import main; '
            f'sys.exit(main({arguments_of(verb, bag, tmp_path / "deep/out")!r}))')
    done = subprocess.run([sys.executable, '-B', '-c', code], capture_output=True, text=True,
                          timeout=PATIENCE, check=False, env=UNMEASURED,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE,
                                                                (limit, limit)))
    assert (done.returncode == 1 and done.stderr.startswith('fourbar: ')
            and done.stderr.count('\n') == 1), done.stderr
    assert 'File too large' in done.stderr and str(tmp_path) in done.stderr and not done.stdout
    assert list(tmp_path.rglob('*')) == [tmp_path / 'deep']


@some('number, code', [(signal.SIGTERM, 143), (signal.SIGHUP, 129),
                                              (signal.SIGINT, 130)], 1)
@some('verb', ['recover', 'csv', 'npz'], ('recover',))
def test_a_signal_ends_a_verb_and_leaves_nothing(bag, tmp_path, verb, number, code):
    program = WAITING.format(after=3 if verb == 'recover' else 1, patience=PATIENCE, verb=verb,
                             arguments=arguments_of(verb, bag, tmp_path / 'out'))
    process = subprocess.Popen([sys.executable, '-c', program], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == 'waiting\n', process.stderr.read()
        assert (any(path.name.startswith('.out.') for path in tmp_path.iterdir())
                and not (tmp_path / 'out').exists())
        process.send_signal(number)
        _, error = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    assert process.returncode == code and not error and not list(tmp_path.iterdir())


IGNORING = """
import signal, subprocess, sys
for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM):
    signal.signal(number, signal.SIG_IGN)
sys.path.insert(0, {test!r})
import conftest
for number in (signal.SIGHUP, signal.SIGINT):
    signal.raise_signal(number)             # still ignored here
print(subprocess.run(['cat', '/proc/self/status'], capture_output=True, text=True).stdout)
"""


@pytest.mark.skipif(not os.path.exists('/proc/self/status'), reason='no /proc')
def test_children_of_a_run_under_nohup_have_default_signals():
    done = subprocess.run([sys.executable, '-c', IGNORING.format(test=str(TEST))], text=True,
                          capture_output=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stderr
    ignored = int(done.stdout.split('SigIgn:')[1].split()[0], 16)
    assert not any(ignored >> (number - 1) & 1 for number in (
        signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM))


@some('verb', ['recover', 'csv'], 1)
def test_what_a_kill_leaves_the_next_call_removes(bag, tmp_path, verb):
    program = WAITING.format(after=3 if verb == 'recover' else 1, patience=PATIENCE, verb=verb,
                             arguments=arguments_of(verb, bag, tmp_path / 'out'))
    process = subprocess.Popen([sys.executable, '-c', program], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == 'waiting\n'
        hidden, = tmp_path.iterdir()
        assert hidden.name.startswith('.out.fourbar-')
        # at work: another call leaves it alone
        export(bag, tmp_path / 'meanwhile')
        assert hidden.is_dir()
    finally:
        process.kill()
        process.wait()
    assert hidden.is_dir()
    (tmp_path / '.other.fourbar').mkdir()              # not ours
    assert main(arguments_of(verb, bag, tmp_path / 'next')) == 0
    assert {path.name for path in tmp_path.iterdir()} == {'meanwhile', 'next', '.other.fourbar'}


def test_a_folder_in_place_of_the_file_and_one_without_rights_are_one_line(tmp_path, capsys):
    (tmp_path / 'run/run_0.mcap').mkdir(parents=True)
    for verb in (['info'], ['info', '--check'], ['recover'], ['recompute'], ['scene'],
                 ['export', '-o', str(tmp_path / 'out')]):
        assert main(['bag', verb[0], str(tmp_path / 'run'), *verb[1:]]) == 1
        error = capsys.readouterr().err
        assert (error.startswith('fourbar: ') and error.count('\n') == 1
                and 'run_0.mcap' in error), verb
    assert [path.name for path in tmp_path.iterdir()] == ['run']


def test_what_exists_is_not_touched_and_an_unknown_topic_leaves_nothing(bag, tmp_path, capsys):
    (tmp_path / 'link').symlink_to(tmp_path / 'nowhere')
    (tmp_path / 'there').write_text('mine')
    for name in ('link', 'there'):
        for verb in ('recover', 'csv', 'npz'):
            assert main(arguments_of(verb, bag, tmp_path / name)) == 1
            assert 'exists already' in capsys.readouterr().err
    for verb in ('csv', 'npz'):
        assert main([*arguments_of(verb, bag, tmp_path / 'out'), '--topics', MOTION.topic,
                     '/typo']) == 1
        assert (capsys.readouterr().err == 'fourbar: /typo: not in the bag; it has '
                                           f'{MOTION.topic}\n')
    assert ({path.name for path in tmp_path.iterdir()} == {'link', 'there'}
            and (tmp_path / 'there').read_text() == 'mine')


def test_a_file_that_is_removed_while_it_is_recorded_is_noticed(tmp_path, monkeypatch):
    from fourbar_ros.bag.write import recorder as writer_module
    monkeypatch.setattr(writer_module, 'SPACE_PERIOD', 0.0)
    for name, spoil in (('removed', lambda path: (path / f'{path.name}_0.mcap').unlink()),
                        ('replaced',
                         lambda path: (path / 'other').rename(path / f'{path.name}_0.mcap')),
                        ('moved', lambda path: path.rename(tmp_path / 'elsewhere'))):
        told = []
        writer = BagWriter(tmp_path, name, [MOTION], {}, tell=told.append)
        for k in range(20):
            writer.write(0, motion(k))
        (writer.path / 'other').write_text('')
        spoil(writer.path)
        end = time.monotonic() + PATIENCE
        while not told:
            assert time.monotonic() < end, name
            time.sleep(0.005)
        assert 'moved, replaced or removed' in told[0] and 'whole' not in told[0]
        with pytest.raises(Exception, match='moved, replaced or removed'):
            writer.close()
    assert len(list(Bag(tmp_path / 'elsewhere/moved_0.mcap').raw())) == 20      # it was not lost


def test_why_a_bag_ended_is_in_it_even_where_there_is_no_room_for_its_end(tmp_path):
    code = f"""
import resource, sys, time
sys.path[:0] = [{str(TEST)!r}]
from support import bags
from fourbar_ros.bag.recorder import BagError, BagWriter
writer = BagWriter({str(tmp_path)!r}, 'run', [bags.MOTION], dict(), flush_period=0.01)
resource.setrlimit(resource.RLIMIT_FSIZE, (SIZE, SIZE))
end = time.monotonic() + {PATIENCE}
k = 0
while not writer.error and time.monotonic() < end:
    writer.write(0, bags.motion(k))
    k += 1
    time.sleep(0.0005)
try:
    writer.close()
except BagError:
    print(writer.accepted, writer.dropped)
"""
    for limit in (9_000, 10_000, 20_000):
        done = subprocess.run([sys.executable, '-c',
                               code.replace('(SIZE, SIZE)', str((limit, limit)))],
                              capture_output=True, text=True, env=UNMEASURED,
                              timeout=PATIENCE, check=False)
        assert not done.stderr
        accepted, dropped = map(int, done.stdout.split())
        found = info(tmp_path / 'run', check=True)
        assert sum(topic.messages for topic in found.topics) == accepted and dropped > 0
        assert found.ended == 'File too large' and not found.is_sound, (limit, found)
        if found.state == 'finished':
            assert (found.dropped == found.missing == dropped and info(tmp_path / 'run').missing
                    == dropped)
        shutil.rmtree(tmp_path / 'run')
