# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a study answers beside numpy, scipy and the whole table of the same files."""
import base64
import json
import re

from fourbar_lab.studies import report as pages
from fourbar_lab.studies import results as module
from fourbar_lab.studies import StudyError
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.design import Design
from fourbar_lab.studies.folder import encode, Folder
from fourbar_lab.studies.results import rank_correlations, Results, unbeaten
from fourbar_lab.studies.study import from_document
from fourbar_ros.cli.main import main
from fourbar_ros.scene.scene import from_values, load
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


def test_folders_with_the_manifest_of_before_are_read(folder, tmp_path):
    results = Results(folder)
    for path in results.parts.values():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / 'manifest.json').write_text(json.dumps(results.folder.manifest()))
    old = Results(tmp_path)
    assert (old.best(), old.counts, old.units) == (results.best(), results.counts, results.units)
    study = from_document(DOCUMENT)
    Folder(tmp_path).begin(study, True)         # and gone on with
    with pytest.raises(StudyError, match='holds a study already'):
        Folder(tmp_path).begin(study, False)


def test_the_best_and_the_worst_are_those_of_the_whole_table(folder, table):
    results = Results(folder)
    for name, sense in DOCUMENT['objectives'].items():
        order = np.argsort(column(table, name) * (1 if sense == 'minimize' else -1))
        rows = column(table, 'row')[order].tolist()
        assert results.best(name, 4) == rows[:4]
        assert results.best(name, 3, worst=True) == rows[:-4:-1]
    assert results.best() == results.best('swing')


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
    front = Results(folder).front()
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
    for one in Results(folder).summaries():
        values = column(table, one.name).astype(float)
        assert (one.least, one.greatest) == (values.min(), values.max())
        assert one.mean == pytest.approx(values.mean(), rel=1e-14)
        nearest = np.percentile(values, (5, 50, 95), method='nearest')
        assert one.percentiles[1] == nearest[1] or values.size % 2 == 0
        assert one.least <= one.percentiles[0] <= one.percentiles[2] <= one.greatest


def test_of_more_rows_than_are_shown_evenly_spread_ones_are_taken(folder, monkeypatch):
    results = Results(folder)
    whole = results.sample(['row'])['row']
    monkeypatch.setattr(module, 'SHOWN', 10)
    step = -(-whole.size // 10)
    assert results.sample(['row'])['row'].tolist() == whole[::step].tolist()


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
    results, study = Results(folder), from_document(DOCUMENT)
    for row in range(0, 64, 9):
        expected = from_values(study.scene_values(row))
        assert from_values(results.scene_values(row)).linkage == expected.linkage


def test_the_page_has_the_tables_and_real_pictures(folder, tmp_path):
    assert main(['study', 'plot', str(folder), str(tmp_path / 'page.html')]) == 0
    text = (tmp_path / 'page.html').read_text()
    assert re.findall('<h2>(.*?)</h2>', text) == ['Ranges', 'Best designs', 'Pareto front',
                                                  'Distributions', 'Sensitivities', 'Pairs']
    pictures = re.findall('base64,([^"]+)', text)
    assert len(pictures) == 4 and all(base64.b64decode(p)[1:4] == b'PNG' for p in pictures)
    assert not list(tmp_path.glob('.*')) and 'http' not in text


def test_the_front_has_the_numbers_that_pick_takes(folder, table, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv('COLUMNS', '200')
    assert main(['study', 'show', str(folder)]) == 0
    said = capsys.readouterr().out.split('Pareto front')[1]
    rows = [int(number) for number in re.findall(r'^ *(\d+) +[-\d.]+ ', said, re.MULTILINE)]
    front = Results(folder).front()
    assert rows and set(rows) <= set(front['row'].tolist())
    assert len(rows) == min(20, len(front['row']))
    assert f'The {len(front["row"])} designs that no other beats' in ' '.join(said.split())
    for row in rows[::6]:
        assert main(['study', 'pick', str(folder), str(row), '-o',
                     str(tmp_path / f'{row}.yaml')]) == 0
        i = column(table, 'row').tolist().index(row)
        assert load(tmp_path / f'{row}.yaml').linkage.a1 == column(table, 'linkage.a1')[i]


def test_a_front_of_three_objectives_is_two_projections_of_dots(folder, monkeypatch):
    pyplot = pytest.importorskip('matplotlib.pyplot')
    drawn = []
    monkeypatch.setattr(pages, '_png', lambda figure: drawn.append(figure) or '')
    results = Results(folder)
    list(pages.figures(results))
    front, panels = results.front(), drawn[0].axes
    assert [(axes.get_xlabel().split()[0], axes.get_ylabel().split()[0]) for axes in panels] == [
        ('swing', 'omega4.peak'), ('swing', 'alpha4.peak')]
    for axes, name in zip(panels, ('omega4.peak', 'alpha4.peak')):
        dots = axes.lines[-1]
        assert dots.get_linestyle() == 'None'
        assert sorted(dots.get_ydata()) == sorted(front[name])
        for note in axes.texts:
            i = front['row'].tolist().index(int(note.get_text()))
            assert note.xy == (front['swing'][i], front[name][i])
        assert len(axes.texts) == min(20, len(front['row']))
    for figure in drawn:
        pyplot.close(figure)


def test_show_prints_what_is_there_while_a_study_still_runs(folder, tmp_path, capsys):
    for name in ('_manifest.parquet', 'part-00000000.parquet'):
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
        Results(tmp_path)
