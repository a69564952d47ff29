# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a study answers beside numpy, scipy and the whole table of the same files."""
import json
import re

from fourbar_lab.studies import StudyError
from fourbar_lab.studies.engine import encode, KEY, PART
from fourbar_lab.studies.measures import Design
from fourbar_lab.studies.results import Results
from fourbar_lab.studies.study import from_document
from fourbar_ros.cli.main import main
from fourbar_ros.scene.scene import load
import numpy as np
import pytest

parquet = pytest.importorskip('pyarrow.parquet')
DOCUMENT = {
    'scene': 'paper', 'rows': 64, 'seed': 1, 'chunk': 16, 'method': 'sobol',
    'vary': {'linkage.a1': {'range': [0.2, 0.6]}, 'linkage.a2': {'range': [0.8, 1.4]}},
    'constraints': {'class': ['crank-rocker']},
    'quantities': ['time_ratio'],
    'objectives': {'swing': 'maximize', 'omega4.peak': 'minimize', 'alpha4.peak': 'minimize'}}


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp('study')
    study = from_document(DOCUMENT)
    for number in range(study.chunks):
        (path / PART.format(number)).write_bytes(encode(study, number))
    return path


@pytest.fixture(scope='module')
def table(folder):
    """Return all rows, as any reader of Parquet sees them."""
    return parquet.ParquetDataset([str(path) for path in
                                   sorted(folder.glob('part-*.parquet'))]).read()


def column(table, name):
    return table[name].to_numpy()


@pytest.mark.parametrize('library', ['pyarrow.parquet', 'pandas', 'polars', 'duckdb'])
def test_the_folder_is_a_table_to_every_reader_of_parquet(folder, table, library):
    reader, path = pytest.importorskip(library), str(folder)
    if library == 'duckdb':
        rows = reader.sql(f"select row from read_parquet('{path}') order by row").fetchall()
        found = [row for row, in rows]
    else:
        read = reader.read_table if library == 'pyarrow.parquet' else reader.read_parquet
        found = sorted(int(row) for row in read(path)['row'].to_numpy())
    assert found == sorted(column(table, 'row').tolist())


def test_the_best_and_the_worst_are_those_of_the_whole_table(folder, table):
    results = Results(folder)
    for name, sense in DOCUMENT['objectives'].items():
        order = np.argsort(column(table, name) * (1 if sense == 'minimize' else -1))
        rows = column(table, 'row')[order].tolist()
        assert results.best(name, 4) == rows[:4]
        assert results.best(name, 3, worst=True) == rows[:-4:-1]
    assert results.best() == results.best('swing')


def test_no_point_of_the_front_is_beaten_and_every_other_is(folder, table):
    first, second = -column(table, 'swing'), column(table, 'omega4.peak')
    front = Results(folder).front()
    assert list(front) == ['row', 'swing', 'omega4.peak'] and (front['swing'] > 0.0).all()
    for i, row in enumerate(column(table, 'row').tolist()):
        is_beaten = ((first <= first[i]) & (second <= second[i])
                     & ((first < first[i]) | (second < second[i]))).any()
        assert is_beaten != (row in front['row'])


def test_summaries_are_numpys(folder, table):
    for one in Results(folder).summaries():
        values = column(table, one.name).astype(float)
        assert (one.least, one.greatest) == (values.min(), values.max())
        assert one.mean == pytest.approx(values.mean(), rel=1e-14)
        assert one.percentiles == tuple(np.percentile(values, (5, 50, 95), method='nearest'))


def test_a_picked_design_is_the_scene_of_its_row(folder, table, tmp_path, capsys):
    file = tmp_path / 'best.yaml'
    assert main(['study', 'pick', str(folder), 'best', '--by', 'omega4.peak', '-o',
                 str(file)]) == 0
    values, names = column(table, 'omega4.peak'), ('linkage.a1', 'linkage.a2')
    i = int(np.argmin(values))
    scene = load(file)
    assert [scene.values[name] for name in names] == [column(table, name)[i] for name in names]
    design, study = Design(scene), from_document(DOCUMENT)
    design.search(study.measures)
    for measure in study.measures:
        found = design.of(measure)
        expected = table[measure.name].to_pylist()[i]       # computed beside others there
        assert found == expected or found == pytest.approx(expected, rel=1e-9), measure.name
    assert main(['study', 'pick', str(folder), 'best', '-o', str(file)]) == 1     # not overwritten
    row = column(table, 'row')[3]
    assert main(['study', 'pick', str(folder), str(row)]) == 0
    assert f'Row {row} of the study' in capsys.readouterr().out


def test_show_lists_rows_of_the_front_that_pick_takes(folder, table, tmp_path, capsys,
                                                      monkeypatch):
    monkeypatch.setenv('COLUMNS', '200')
    assert main(['study', 'show', str(folder)]) == 0
    said = capsys.readouterr().out.split('front: ')[1]
    rows = [int(number) for number in re.findall(r'^ *(\d+) +[-\d.]+ ', said, re.MULTILINE)]
    front = Results(folder).front()
    assert rows and set(rows) <= set(front['row'].tolist())
    assert said.startswith(f'{len(front["row"])} designs that none beats in swing without')
    for row in rows[::6]:
        assert main(['study', 'pick', str(folder), str(row), '-o',
                     str(tmp_path / f'{row}.yaml')]) == 0
        i = column(table, 'row').tolist().index(row)
        assert load(tmp_path / f'{row}.yaml').linkage.a1 == column(table, 'linkage.a1')[i]


def test_show_prints_what_is_there_while_a_study_still_runs(folder, tmp_path, capsys):
    (tmp_path / PART.format(0)).write_bytes((folder / PART.format(0)).read_bytes())
    assert main(['study', 'show', str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert '16 of 64 designs' in said and '48 are not computed yet: --resume' in said


def test_what_cannot_be_answered_is_one_line(folder, tmp_path, capsys):
    for arguments, text in (
            (['show', str(tmp_path)], 'no study'),
            (['pick', str(folder), 'better'], 'must be best, worst or the number'),
            (['pick', str(folder), '64'], 'row 64 is not among'),
            (['pick', str(folder), 'best', '--by', 'mass'], 'no objective of the study')):
        assert main(['study', *arguments]) == 1
        said = capsys.readouterr().err
        assert text in said and said.count('\n') == 1
    parquet.write_table(parquet.read_table(folder).replace_schema_metadata(),
                        tmp_path / PART.format(0))
    with pytest.raises(StudyError, match='no part of a study'):
        Results(tmp_path)
    whole = parquet.read_table(folder / PART.format(0))
    about = json.loads(whole.schema.metadata[KEY])
    about['study']['objectives'] = [['swing', 'maximize']]      # as of version 1.0.0
    parquet.write_table(whole.replace_schema_metadata({KEY: json.dumps(about)}),
                        tmp_path / PART.format(0))
    assert main(['study', 'show', str(tmp_path)]) == 1
    said = capsys.readouterr().err
    assert 'computed by another version' in said and said.count('\n') == 1


def test_of_all_kept_rows_those_that_fulfil_the_constraints_are_ranked(tmp_path):
    study = from_document(DOCUMENT | {'rows': 16, 'keep': 'all'})
    (tmp_path / PART.format(0)).write_bytes(encode(study, 0))
    table, results = parquet.read_table(tmp_path), Results(tmp_path)
    feasible = column(table, 'feasible').astype(bool)
    assert results.kept == feasible.size > feasible.sum() > 0
    assert results.table(['row'])['row'].tolist() == column(table, 'row')[feasible].tolist()
