# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Studies on real processes and a real Dask cluster: the same bits, whatever is killed."""
from contextlib import contextmanager
from functools import partial
import json
import os
from pathlib import Path
import re
import signal
import socket
import subprocess
import sys
import time

from fourbar_lab.studies import engine, Results, StudyError
from fourbar_lab.studies.engine import cluster, processes, run
from fourbar_lab.studies.study import from_document
import pytest

parquet = pytest.importorskip('pyarrow.parquet')
DOCUMENT = {
    'scene': 'paper', 'method': 'sobol', 'rows': 240, 'seed': 3, 'chunk': 20,
    # many do not turn fully: these are computed one by one, which takes time for the kills
    'vary': {'linkage.a1': {'range': [0.2, 1.4]}, 'linkage.a2': {'normal': 0.05},
             'linkage.mode': {'list': [1, 2]}},
    'quantities': ['omega4', 'alpha4', 'shaking_force', 'shaking_moment', 'f32', 'f43',
                   'time_ratio'],
    'objectives': {'shaking_force.max': 'minimize'}}
PATIENCE = 600.0
ONE = partial(processes, 1)


def study_of(**changes):
    return from_document(DOCUMENT | changes)


def bytes_of(path):
    """Return {name: content} of the parts in a folder."""
    return {file.name: file.read_bytes() for file in sorted(Path(path).glob('part-*.parquet'))}


@pytest.fixture(scope='module')
def expected(tmp_path_factory):
    """Return the parts as one worker computes them."""
    path = tmp_path_factory.mktemp('one') / 'study'
    assert run(study_of(), path, ONE) == 240
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
    run(study_of(), tmp_path, partial(processes, 3))
    assert bytes_of(tmp_path) == expected


@pytest.mark.slow
def test_a_worker_and_the_command_are_killed_and_nothing_is_lost(tmp_path, expected):
    """Either ends the run, no process stays behind, and the command goes on when it is resumed."""
    file, folder = write_study(tmp_path / 's.yaml'), tmp_path / 'out'
    options, done = [file, '-o', folder, '--workers', 2], 0
    for kill_a_worker in (True, False):
        process = start(*options, *['--resume'] * (not kill_a_worker))
        wait_for(lambda: len(bytes_of(folder)) > done + 1, 'second part')
        workers = children_of(process.pid)
        if kill_a_worker:
            os.kill(workers[0], signal.SIGKILL)
        else:
            process.kill()
        err = process.communicate(timeout=PATIENCE)[1]
        assert not kill_a_worker or err == ('fourbar: the workers are gone; what is done is kept, '
                                            '--resume goes on\n')
        wait_for(lambda: all(map(is_gone, workers)), 'end of the workers')
        done = len(bytes_of(folder))
        assert done < 12 and all(expected[name] == part
                                 for name, part in bytes_of(folder).items())
    (folder / '.part-00000011.parquet.99').write_bytes(b'half of a part')
    refused = start(*options)
    assert '--resume goes on' in refused.communicate()[1] and refused.returncode == 1
    again = start(*options, '--resume')
    out, err = again.communicate(timeout=PATIENCE)
    assert again.returncode == 0, err
    assert f'{20 * (12 - done)} designs' in out
    assert bytes_of(folder) == expected and not list(folder.glob('.*'))


@pytest.mark.slow
def test_ctrl_c_says_how_to_go_on(tmp_path):
    process = start(write_study(tmp_path / 's.yaml'), '-o', tmp_path / 'out', '--workers', 1)
    wait_for(lambda: bytes_of(tmp_path / 'out'), 'first part')
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130 and '--resume goes on' in err and 'Traceback' not in err


def test_what_is_there_is_gone_on_with_only_if_it_is_the_same(tmp_path, monkeypatch):
    study, seen, out = study_of(rows=60), [], tmp_path / 'out'
    assert run(study, out, ONE, report=seen.append) == 60 and seen == [0, 20, 40, 60]
    (out / 'part-00000001.parquet').unlink()
    seen.clear()
    assert run(study, out, ONE, resume=True, report=seen.append) == 20 and seen == [40, 60]
    with pytest.raises(StudyError, match='holds a study already'):
        run(study, out, ONE)
    with pytest.raises(StudyError, match='another study: rows differs'):
        run(study_of(rows=40), out, ONE, resume=True)
    monkeypatch.setattr(engine, 'made_with', lambda: {'numpy': '0.1'})
    with pytest.raises(StudyError, match='another study: numpy differs'):
        run(study, out, ONE, resume=True)
    with pytest.raises(StudyError, match="a worker has {'numpy': '0.1'}, and this"):
        engine.compute_part(study, 0, {'numpy': '0.2'})
    (tmp_path / 'foreign').mkdir()
    (tmp_path / 'foreign/letter.txt').write_text('dear')
    with pytest.raises(StudyError, match='is no study'):
        run(study, tmp_path / 'foreign', ONE)


def test_a_chunk_that_raises_is_one_line_with_its_rows(monkeypatch):
    monkeypatch.setattr(engine, 'compute', lambda study, number: 1 / 0)
    with pytest.raises(StudyError, match='rows 20 to 39 could not be computed: ZeroDivisionError'):
        engine.compute_part(study_of(), 1, engine.made_with())


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
    run(study_of(), tmp_path / 'out', ONE, resume=True)
    assert bytes_of(tmp_path / 'out') == expected


@pytest.mark.slow
def test_a_study_that_keeps_nothing_says_so(tmp_path):
    file = write_study(tmp_path / 's.yaml', rows=20, constraints={'omega4.max': {'least': 1e9}})
    process = start(file, '-o', tmp_path / 'out', '--workers', 1)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0 and 'no design fulfils the constraints' in err
    assert 'most fail omega4.max' in err and 'omega4.max: 20' in out
    assert Results(tmp_path / 'out').kept == 0


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


@pytest.fixture
def dask(tmp_path):
    """Give (address, scheduler, workers) of a Dask cluster of real processes."""
    distributed = pytest.importorskip('distributed')
    port = free_port()
    address = f'tcp://127.0.0.1:{port}'
    options = [address, '--nthreads', '1', '--no-nanny', '--no-dashboard',
               '--host', '127.0.0.1', '--death-timeout', '60']
    with (process_of_dask('scheduler', '--host', '127.0.0.1', '--port', str(port),
                          '--no-dashboard', cwd=tmp_path) as scheduler,
          process_of_dask('worker', *options, '--name', 'one', cwd=tmp_path) as one,
          process_of_dask('worker', *options, '--name', 'two', cwd=tmp_path) as two,
          distributed.Client(address, timeout=60, set_as_default=False) as client):
        client.wait_for_workers(2, timeout=PATIENCE)
        yield address, scheduler, [one, two]


@pytest.mark.slow
def test_a_cluster_gives_the_bits_of_this_machine_though_a_worker_dies(tmp_path, expected, dask):
    address, _, workers = dask

    def kill_one(designs):
        if designs == 40:
            workers[0].kill()

    assert run(study_of(), tmp_path / 'out', partial(cluster, address), report=kill_one) == 240
    assert bytes_of(tmp_path / 'out') == expected


@pytest.mark.slow
def test_a_scheduler_dies_and_this_machine_goes_on(tmp_path, expected, dask):
    address, scheduler, _ = dask

    def kill_it(designs):
        if designs == 60:
            scheduler.kill()

    with pytest.raises(StudyError, match='--resume goes on'):
        run(study_of(), tmp_path / 'out', partial(cluster, address), report=kill_it)
    assert 3 <= len(bytes_of(tmp_path / 'out')) < 12
    run(study_of(), tmp_path / 'out', resume=True)
    assert bytes_of(tmp_path / 'out') == expected


def test_no_scheduler_is_one_line(tmp_path, monkeypatch):
    pytest.importorskip('distributed')
    monkeypatch.setattr(engine, 'PATIENCE', 1.0)
    with pytest.raises(StudyError, match='no Dask scheduler answers at tcp://127.0.0.1'):
        run(study_of(), tmp_path, partial(cluster, f'tcp://127.0.0.1:{free_port()}'))
