# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a study answers beside numpy, scipy and the whole table of the same files."""
import base64
import json
import re

from fourbar_ros.cli.main import main
from fourbar_ros.scene.scene import from_values, load
from fourbar_ros.studies import answers as module
from fourbar_ros.studies import StudyError
from fourbar_ros.studies.answers import Answers, rank_correlations, unbeaten
from fourbar_ros.studies.one_design import Design
from fourbar_ros.studies.parts import encode, Folder
from fourbar_ros.studies.rows import compute
from fourbar_ros.studies.study import from_document
import numpy as np
import pytest

parquet = pytest.importorskip('pyarrow.parquet')
stats = pytest.importorskip('scipy.stats')
DOCUMENT = {
    'scene': 'paper', 'rows': 64, 'seed': 1, 'chunk': 16, 'method': 'sobol',
    'vary': {'linkage.a1': {'range': [0.2, 0.6]}, 'linkage.a2': {'range': [0.8, 1.4]}},
    'constraints': {'class': ['crank-rocker']},
    'quantities': ['time_ratio'],
    'objectives': {'swing': 'maximize', 'omega4.peak': 'minimize', 'alpha4.peak': 'minimize'}}


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp('study') / 'found'
    study, folder = from_document(DOCUMENT), Folder(path)
    folder.begin(study, False)
    for number in range(study.chunks):
        folder.add(number, encode(study, compute(study, number)))
    return path


@pytest.fixture(scope='module')
def table(folder):
    """Return all rows, as any reader of Parquet sees them."""
    return parquet.ParquetDataset([str(path) for path in
                                   sorted(folder.glob('part-*.parquet'))]).read()


def column(table, name):
    return table[name].to_numpy()


def test_the_best_and_the_worst_are_those_of_the_whole_table(folder, table):
    answers = Answers(folder)
    for name, sense in DOCUMENT['objectives'].items():
        order = np.argsort(column(table, name) * (1 if sense == 'minimize' else -1))
        rows = column(table, 'row')[order].tolist()
        assert answers.best(name, 4) == rows[:4]
        assert answers.best(name, 3, worst=True) == rows[:-4:-1]
    assert answers.best() == answers.best('swing')


@pytest.mark.parametrize('objectives', [1, 2, 3, 4])
def test_no_point_of_a_front_is_beaten_and_every_other_is(objectives):
    rng = np.random.default_rng(objectives)
    points = rng.integers(0, 12, (300, objectives)).astype(float)       # with ties
    kept = unbeaten(points)
    for i, point in enumerate(points):
        others = np.delete(points, i, axis=0)
        is_beaten = ((others <= point).all(axis=1) & (others < point).any(axis=1)).any()
        assert not (is_beaten and i in kept)
        assert is_beaten or any((points[j] == point).all() for j in kept)


def test_the_front_of_the_parts_is_that_of_the_table(folder, table):
    names = list(DOCUMENT['objectives'])
    points = np.stack([column(table, names[0]) * -1, *(column(table, n) for n in names[1:])], 1)
    front = Answers(folder).front()
    assert front['row'].tolist() == column(table, 'row')[unbeaten(points)].tolist()
    assert (front['swing'] > 0.0).all()


def test_rank_correlations_are_spearmans(table):
    columns = {name: column(table, name) for name in table.column_names if name != 'class'}
    columns['linkage.a1'] = np.round(columns['linkage.a1'], 2)          # ties
    found = rank_correlations(columns, ['linkage.a1', 'linkage.a2'], ['swing', 'time_ratio'])
    for output, by_input in found.items():
        for name, value in by_input.items():
            expected = stats.spearmanr(columns[name], columns[output]).statistic
            assert abs(value - expected) < 1e-12


def test_summaries_are_numpys(folder, table):
    for one in Answers(folder).summaries():
        values = column(table, one.name).astype(float)
        assert (one.least, one.greatest) == (values.min(), values.max())
        assert one.mean == pytest.approx(values.mean(), rel=1e-14)
        nearest = np.percentile(values, (5, 50, 95), method='nearest')
        assert one.percentiles[1] == nearest[1] or values.size % 2 == 0
        assert one.least <= one.percentiles[0] <= one.percentiles[2] <= one.greatest


def test_of_more_rows_than_are_shown_evenly_spread_ones_are_taken(folder, monkeypatch):
    answers = Answers(folder)
    whole = answers.sample(['row'])['row']
    monkeypatch.setattr(module, 'SHOWN', 10)
    step = -(-whole.size // 10)
    assert answers.sample(['row'])['row'].tolist() == whole[::step].tolist()


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
    assert main(['study', 'pick', str(folder), '7']) == 0
    assert 'Row 7 of the study' in capsys.readouterr().out


def test_every_row_that_can_be_built_is_a_scene(folder):
    answers, study = Answers(folder), from_document(DOCUMENT)
    for row in range(0, 64, 9):
        expected = from_values(study.scene_values(row))
        assert from_values(answers.scene_values(row)).linkage == expected.linkage


def test_the_page_has_the_tables_and_real_pictures(folder, tmp_path):
    assert main(['study', 'plot', str(folder), str(tmp_path / 'page.html')]) == 0
    text = (tmp_path / 'page.html').read_text()
    assert re.findall('<h2>(.*?)</h2>', text) == ['Ranges', 'Best designs', 'Pareto front',
                                                  'Distributions', 'Sensitivities', 'Pairs']
    pictures = re.findall('base64,([^"]+)', text)
    assert len(pictures) == 4 and all(base64.b64decode(p)[1:4] == b'PNG' for p in pictures)
    assert not list(tmp_path.glob('.*')) and 'http' not in text


def test_show_prints_what_is_there_while_a_study_still_runs(folder, tmp_path, capsys):
    for name in ('manifest.json', 'part-00000000.parquet'):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    assert main(['study', 'show', str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert '16 of 64 designs' in said and '48 are not computed yet: --resume' in said


def test_what_cannot_be_answered_is_one_line(folder, tmp_path, capsys):
    for arguments, text in (
            (['show', str(tmp_path)], 'no study'),
            (['pick', str(folder), 'better'], 'must be best, worst or the number'),
            (['pick', str(folder), '64'], 'row 64'),
            (['pick', str(folder), 'best', '--by', 'mass'], 'no objective of the study')):
        assert main(['study', *arguments]) == 1
        said = capsys.readouterr().err
        assert text in said and said.count('\n') == 1
    (tmp_path / 'manifest.json').write_text(json.dumps({'fingerprint': '', 'study': {},
                                                        'units': {}}))
    with pytest.raises(StudyError, match='nothing is computed yet'):
        Answers(tmp_path)
