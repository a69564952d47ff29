# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Studies on real processes and a real Dask cluster: the same bits, whatever is killed."""
from contextlib import contextmanager
import json
import os
from pathlib import Path
import re
import signal
import socket
import subprocess
import sys
import threading
import time

from fourbar_lab.studies import StudyError
from fourbar_lab.studies.engine import Cluster, Local, run
from fourbar_lab.studies.folder import Folder
from fourbar_lab.studies.study import from_document
import pytest

pytest.importorskip('pyarrow')
DOCUMENT = {
    'scene': 'paper', 'method': 'sobol', 'rows': 240, 'seed': 3, 'chunk': 20,
    # many do not turn fully: these are computed one by one, which takes time for the kills
    'vary': {'linkage.a1': {'range': [0.2, 1.4]}, 'linkage.a2': {'normal': 0.05},
             'linkage.mode': {'list': [1, 2]}},
    'quantities': ['omega4', 'alpha4', 'shaking_force', 'shaking_moment', 'f32', 'f43',
                   'time_ratio'],
    'objectives': {'shaking_force.max': 'minimize'}}
PATIENCE = 600.0


def study_of(**changes):
    return from_document(DOCUMENT | changes)


def bytes_of(path):
    """Return {name: content} of the parts in a folder."""
    return {file.name: file.read_bytes() for file in sorted(Path(path).glob('part-*.parquet'))}


def run_locally(path, study, workers=1, resume=False, report=lambda progress: None):
    folder, executor = Folder(path), Local(workers)
    folder.begin(study, resume)
    try:
        return run(study, folder, executor, report)
    finally:
        executor.close()


@pytest.fixture(scope='module')
def expected(tmp_path_factory):
    """Return the parts as one worker computes them."""
    path = tmp_path_factory.mktemp('one') / 'study'
    run_locally(path, study_of())
    found = bytes_of(path)
    assert len(found) == 12
    return found


def wait_for(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f'no {what} within {PATIENCE} s'
        time.sleep(0.02)


def write_study(path, **changes):
    path.write_text(json.dumps(DOCUMENT | changes))       # JSON is YAML
    return path


def start(*arguments):
    """Start the command; its own process group, so that nothing else is ever signalled."""
    return subprocess.Popen([sys.executable, '-m', 'fourbar_ros', 'study', *map(str, arguments)],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def children_of(process):
    """Return the processes that a process has started, without the resource tracker."""
    tasks = Path(f'/proc/{process}/task').glob('*/children')
    found = [int(child) for task in tasks for child in task.read_text().split()]
    return [child for child in found
            if b'spawn_main' in Path(f'/proc/{child}/cmdline').read_bytes()]


def is_gone(process):
    try:
        state = Path(f'/proc/{process}/stat').read_text().rpartition(')')[2].split()[0]
    except OSError:
        return True
    return state == 'Z'


@pytest.mark.slow
def test_any_number_of_workers_gives_the_same_bits(tmp_path, expected):
    run_locally(tmp_path / 'three', study_of(), workers=3)
    assert bytes_of(tmp_path / 'three') == expected


@pytest.mark.slow
def test_a_worker_that_is_killed_is_replaced(tmp_path, expected):
    process = start(write_study(tmp_path / 's.yaml'), '-o', tmp_path / 'out', '--workers', 2)
    wait_for(lambda: bytes_of(tmp_path / 'out'), 'first part')
    wait_for(lambda: children_of(process.pid), 'worker')
    os.kill(children_of(process.pid)[0], signal.SIGKILL)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    assert '240 designs' in out and bytes_of(tmp_path / 'out') == expected


@pytest.mark.slow
def test_the_command_is_killed_and_resumed_and_leaves_no_process(tmp_path, expected):
    file, folder = write_study(tmp_path / 's.yaml'), tmp_path / 'out'
    process = start(file, '-o', folder, '--workers', 2)
    wait_for(lambda: len(bytes_of(folder)) > 1, 'second part')
    workers = children_of(process.pid)
    process.kill()
    process.communicate()
    wait_for(lambda: all(map(is_gone, workers)), 'end of the workers')
    before = bytes_of(folder)
    assert 1 < len(before) < 12 and all(expected[name] == part for name, part in before.items())
    (folder / '.part-00000011.parquet.new').write_bytes(b'half of a part')
    refused = start(file, '-o', folder)
    assert '--resume goes on' in refused.communicate()[1] and refused.returncode == 1
    again = start(file, '-o', folder, '--resume')
    out, err = again.communicate(timeout=PATIENCE)
    assert again.returncode == 0, err
    assert f'{20 * (12 - len(before))} designs' in out
    assert bytes_of(folder) == expected and not list(folder.glob('.*'))


@pytest.mark.slow
def test_ctrl_c_says_how_to_go_on(tmp_path):
    process = start(write_study(tmp_path / 's.yaml'), '-o', tmp_path / 'out', '--workers', 1)
    wait_for(lambda: bytes_of(tmp_path / 'out'), 'first part')
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130 and '--resume goes on' in err and 'Traceback' not in err


def test_another_study_and_a_foreign_folder_are_refused(tmp_path):
    study = study_of(rows=20)
    run_locally(tmp_path / 'out', study)
    with pytest.raises(StudyError, match='another study: rows differ'):
        Folder(tmp_path / 'out').begin(study_of(rows=40), True)
    (tmp_path / 'foreign').mkdir()
    (tmp_path / 'foreign/letter.txt').write_text('dear')
    with pytest.raises(StudyError, match='is no study'):
        Folder(tmp_path / 'foreign').begin(study, False)
    assert (tmp_path / 'foreign/letter.txt').read_text() == 'dear'


def test_a_chunk_that_fails_is_listed_and_the_others_are_kept(tmp_path, monkeypatch):
    from fourbar_lab.studies import engine as executors

    def fails(study, number):
        if number == 1:
            raise RuntimeError('boom')
        return compute(study, number)

    compute = executors.compute
    monkeypatch.setattr(executors, 'compute', fails)
    part = executors.compute_part(study_of(), 1)
    folder = Folder(tmp_path)
    folder.add(1, part.content)
    folder.add(0, executors.compute_part(study_of(), 0).content)
    counts, failures = folder.totals()
    assert counts['failed'] == 20 and sum(counts.values()) == 40
    assert failures == [(20, 'rows 20 to 39: RuntimeError: boom')]


def test_progress_counts_designs_and_what_was_there_before(tmp_path):
    seen, study = [], study_of(rows=60)
    run_locally(tmp_path / 'out', study, report=seen.append)
    assert [progress.done for progress in seen] == [0, 20, 40, 60]
    assert seen[-1].remaining == 0.0 and seen[-1].rate > 0.0
    (tmp_path / 'out/part-00000001.parquet').unlink()
    seen.clear()
    done = run_locally(tmp_path / 'out', study, resume=True, report=seen.append)
    assert [progress.done for progress in seen] == [40, 60] and done.in_this_run == 20


# --- a cluster -----------------------------------------------------------------------------------

@contextmanager
def process_of_dask(name, *arguments, cwd):
    """Give a running scheduler or worker of Dask; kill it at the end."""
    process = subprocess.Popen([sys.executable, '-m', 'distributed.cli.dask_' + name, *arguments],
                               cwd=cwd, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def free_port():
    with socket.socket() as one:
        one.bind(('127.0.0.1', 0))
        return one.getsockname()[1]


@contextmanager
def cluster(tmp_path, workers=2):
    """Give (address, scheduler, workers) of a Dask cluster of real processes."""
    port = free_port()
    address = f'tcp://127.0.0.1:{port}'
    with process_of_dask('scheduler', '--host', '127.0.0.1', '--port', str(port),
                         '--no-dashboard', cwd=tmp_path) as scheduler:
        options = [address, '--nthreads', '1', '--no-nanny', '--no-dashboard',
                   '--host', '127.0.0.1', '--death-timeout', '60']
        with (process_of_dask('worker', *options, '--name', 'one', cwd=tmp_path) as one,
              process_of_dask('worker', *options, '--name', 'two', cwd=tmp_path) as two):
            yield address, scheduler, [one, two]


def workers_of(address):
    import distributed
    try:
        with distributed.Client(address, timeout=5.0, set_as_default=False) as client:
            return len(client.scheduler_info(n_workers=-1)['workers'])
    except (OSError, TimeoutError):
        return 0


@pytest.fixture
def dask(tmp_path):
    pytest.importorskip('distributed')
    with cluster(tmp_path) as parts:
        wait_for(lambda: workers_of(parts[0]) == 2, 'cluster of two workers')
        yield parts


@pytest.mark.slow
def test_a_cluster_gives_the_bits_of_this_machine_though_a_worker_dies(tmp_path, expected, dask):
    address, _, workers = dask
    folder, study = Folder(tmp_path / 'out'), study_of()
    folder.begin(study, False)
    executor, seen = Cluster(address), []

    def kill_one(progress):
        seen.append(progress)
        if progress.in_this_run == 40:
            workers[0].kill()

    try:
        run(study, folder, executor, kill_one)
    finally:
        executor.close()
    assert seen[-1].in_this_run == 240 and bytes_of(tmp_path / 'out') == expected


@pytest.mark.slow
def test_a_scheduler_dies_and_another_cluster_goes_on(tmp_path, expected, dask, capfd):
    address, scheduler, _ = dask
    folder, study = Folder(tmp_path / 'out'), study_of()
    folder.begin(study, False)
    executor = Cluster(address)

    def kill_it(progress):
        if progress.in_this_run == 60:
            scheduler.kill()

    begun = time.monotonic()
    try:
        with pytest.raises(StudyError, match='--resume goes on'):
            run(study, folder, executor, kill_it)
    finally:
        executor.close()
    assert time.monotonic() - begun < PATIENCE
    assert 'Traceback' not in capfd.readouterr().err
    before = bytes_of(tmp_path / 'out')
    assert 3 <= len(before) < 12
    (tmp_path / 'again').mkdir()
    with cluster(tmp_path / 'again') as (address, _, _):
        wait_for(lambda: workers_of(address), 'second cluster')
        process = start(write_study(tmp_path / 's.yaml'), '-o', tmp_path / 'out', '--resume',
                        '--cluster', address)
        out, err = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0, err
    assert re.search(r'^(\d+) designs', out)[1] == str(20 * (12 - len(before)))
    assert bytes_of(tmp_path / 'out') == expected


def test_no_scheduler_is_one_line(tmp_path, monkeypatch):
    pytest.importorskip('distributed')
    from fourbar_lab.studies import engine as executors
    monkeypatch.setattr(executors, 'PATIENCE', 1.0)
    with pytest.raises(StudyError, match='no Dask scheduler answers at tcp://127.0.0.1'):
        Cluster(f'tcp://127.0.0.1:{free_port()}')
    assert not [thread for thread in threading.enumerate() if 'executor' in thread.name.lower()]


@pytest.mark.slow
def test_two_commands_do_not_compute_the_same(tmp_path):
    file, out = write_study(tmp_path / 's.yaml'), tmp_path / 'out'
    first = start(file, '-o', out, '--workers', 1)
    try:
        wait_for(lambda: bytes_of(out), 'first part')
        os.kill(first.pid, signal.SIGSTOP)
        for arguments, why in (([], 'holds a study already'),
                               (['--resume'], 'another command computes it now')):
            second = start(file, '-o', out, '--workers', 1, *arguments)
            _, err = second.communicate(timeout=PATIENCE)
            assert second.returncode == 1 and why in err and err.count('\n') == 1, err
    finally:
        first.kill()            # the kernel ends its lock, and nothing is left to remove
        first.communicate()
    folder = Folder(out)
    folder.begin(study_of(), True)
    with folder.locked(), pytest.raises(StudyError, match='another command'):
        Folder(out).begin(study_of(), True)
    folder.begin(study_of(), True)


@pytest.mark.slow
def test_a_full_disk_is_one_line_with_the_path_and_resume_goes_on(tmp_path, expected):
    code = (f'import resource, sys; from fourbar_ros.cli.main import main; '
            f'resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000)); '
            f'sys.exit(main(["study", {str(write_study(tmp_path / "s.yaml"))!r}, "-o", '
            f'{str(tmp_path / "out")!r}, "--workers", "1"]))')
    (tmp_path / 'run.py').write_text(f'if __name__ == "__main__":\n    {code}\n')
    done = subprocess.run([sys.executable, '-B', tmp_path / 'run.py'], capture_output=True,
                          text=True, timeout=PATIENCE, check=False,
                          env={name: value for name, value in os.environ.items()
                               if 'COVERAGE' not in name})
    assert done.returncode == 1 and done.stderr.count('\n') == 1, done.stderr
    assert re.search(rf'{tmp_path}/out/\S+: File too large; what is done is kept, '
                     '--resume goes on', done.stderr)
    assert not list((tmp_path / 'out').glob('.*'))
    process = start(tmp_path / 's.yaml', '-o', tmp_path / 'out', '--resume', '--workers', 2)
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    assert bytes_of(tmp_path / 'out') == expected


@pytest.mark.slow
def test_a_study_that_keeps_nothing_says_so(tmp_path):
    file = write_study(tmp_path / 's.yaml', rows=20, constraints={'omega4.max': {'least': 1e9}})
    process = start(file, '-o', tmp_path / 'out', '--workers', 1)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0 and 'no design fulfils the constraints' in err
    assert 'most fail omega4.max' in err and 'omega4.max: 20' in out
