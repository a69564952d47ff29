# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a study may say: refused before anything is computed, drawn as it says."""
from copy import deepcopy
from dataclasses import replace

from fourbar_lab.studies import StudyError
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.study import from_document, read
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene.files import SceneError
import numpy as np
import pytest
from support import ROOT
from support.samples import some

scipy_stats = pytest.importorskip('scipy.stats')
GOOD = {'scene': 'paper', 'rows': 100, 'vary': {'linkage.a1': {'range': [0.2, 0.6]}},
        'quantities': ['omega4.max']}
BAD = [
    ('scene', None, 'must be a scene'),
    ('rows', None, 'must be an integer from 1'),
    ('rows', 'many', 'must be an integer'),
    ('vary', [], '^vary = .*must be a mapping'),
    ('vary', {}, 'must name a parameter'),
    ('vary', {'linkage.a5': {'range': [1, 2]}}, 'vary.linkage.a5: no parameter.*did you mean'),
    ('vary', {'linkage.a1': {'range': [0.6, 0.2]}}, 'low less than high'),
    ('vary', {'linkage.a1': {'range': [-0.1, 0.2]}}, 'reaches -0.1, and it must be positive'),
    ('vary', {'linkage.a1': {'normal': [0.4, 0.1]}}, 'reaches -0.*must be positive'),
    ('vary', {'linkage.a1': {'log_range': [0.0, 0.2]}}, 'for log_range positive'),
    ('vary', {'linkage.a1': {'rnge': [0.1, 0.2]}}, 'one of range, log_range'),
    ('vary', {'linkage.a1': {'range': [0.1, float('nan')]}}, 'two finite numbers'),
    ('vary', {'linkage.a1': {'list': [0.1, 0.1]}}, 'different finite numbers'),
    ('vary', {'linkage.mode': {'range': [1, 2]}}, 'a list for linkage.mode'),
    ('vary', {'linkage.mode': {'list': [1, 3]}}, r'must lie in \[1, 2\]'),
    ('vary', {'linkage.kind': {'list': [1]}}, 'cannot vary'),
    ('vary', {'drive.rate': {'range': [1, 2]}}, 'cannot vary'),
    ('vary', {'cylinder.base.along': {'range': [1, 2]}}, 'cannot vary in this study'),
    ('vary', {'bodies.crank.mass': {'uniform': 0.1}}, 'without a centre the scene must give'),
    ('vary', {'bodies.crank.mass': {'uniform': [1.0, 0.1]}}, 'crank.inertia: must be given'),
    ('vary', {'linkage.a2': {'range': [5.0, 6.0]}}, 'none of the first 100 designs can be built'),
    ('method', 'sobel', 'must be one of grid, sobol'),
    ('quantities', ['omega5.max'], 'did you mean omega4'),
    ('quantities', ['omega4.maxi'], 'unknown part; did you mean max'),
    ('quantities', [], 'must be given'),
    ('quantities', [{'omega4': 'max'}], 'unknown'),         # no name, and no key of a table
    ('quantities', ['stroke'], 'ask for swing'),
    ('constraints', {'omega4': {'least': 1.0}}, 'say which part'),
    ('constraints', {'swing': {'least': 2.0, 'most': 1.0}}, 'least not more than most'),
    ('constraints', {'swing': 2.0}, 'must be a mapping of least, most'),
    ('constraints', {'class': 3}, 'a type or a list of types'),
    ('objectives', {'class': 'minimize'}, 'is text and cannot'),
    ('objectives', {'swing': 'max'}, 'must be one of minimize, maximize'),
    ('seed', -1, 'must be an integer from 0'),
    ('colour', 'red', 'study.colour: unknown'),
]


@pytest.mark.parametrize(('key', 'value', 'text'), BAD)
def test_a_bad_study_is_refused_with_the_reason(key, value, text):
    document = deepcopy(GOOD) | {key: value}
    with pytest.raises(InvalidParameter, match=text):
        from_document(document)


@pytest.mark.parametrize('text', [
    'rows: 10\nrows: 20\n', 'scene: paper\nvary:\n  linkage.a1: {range: [0.2, 0.6]}\n'
    '  linkage.a1: {range: [0.3, 0.4]}\n', 'vary: {linkage.a1: {normal: 1, normal: 2}}\n'])
def test_a_key_that_is_given_twice_is_refused(tmp_path, text):
    (tmp_path / 's.yaml').write_text(text)
    with pytest.raises(SceneError, match='line .*is given twice'):
        read(tmp_path / 's.yaml')


def test_a_load_of_a_scene_without_masses_is_refused():
    with pytest.raises(InvalidParameter, match='is a load, and loads need masses'):
        from_document(GOOD | {'scene': 'slides_7_7', 'quantities': ['shaking_force.max']})


def test_what_is_too_large_for_a_method_is_refused():
    for method, rows in (('sobol', 2**32 + 1), ('random', 2**44 + 1)):
        with pytest.raises(InvalidParameter, match='from 1 to'):
            from_document(GOOD | {'method': method, 'rows': rows})
    with pytest.raises(InvalidParameter, match='takes ranges and lists only'):
        from_document({**GOOD, 'rows': None, 'method': 'grid',
                       'vary': {'linkage.a1': {'normal': 0.01}}})
    with pytest.raises(InvalidParameter, match='product of its levels, 10'):
        from_document(GOOD | {'method': 'grid'})


def test_a_file_that_is_no_yaml_or_missing_is_one_line(tmp_path):
    with pytest.raises(SceneError, match='No such file'):
        read(tmp_path / 'none.yaml')
    (tmp_path / 'bad.yaml').write_text('a: [1, 2')
    with pytest.raises(SceneError, match='not YAML'):
        read(tmp_path / 'bad.yaml')
    (tmp_path / 'text.yaml').write_text('text')
    with pytest.raises(StudyError, match='must be a mapping'):
        read(tmp_path / 'text.yaml')


@pytest.mark.parametrize('method', ['grid', 'sobol', 'random'])
def test_rows_are_the_same_however_they_are_cut(method):
    vary = {f'linkage.a{i}': {'range': [0.5, 0.6], **({'levels': 6} if method == 'grid' else {})}
            for i in (1, 2, 3, 4)}
    vary['gravity.y'] = {'list': [0.0, -9.81]}
    study = from_document({**GOOD, 'rows': 6**4 * 2, 'method': method, 'vary': vary})
    whole = study.drawn(0, study.rows)
    for start, stop in ((0, 1), (17, 500), (2500, 2592)):
        part = study.drawn(start, stop)
        assert all((part[name] == column[start:stop]).all() for name, column in whole.items())


def test_designs_fill_the_box_as_their_names_say():
    vary = {'linkage.a1': {'range': [0.2, 0.6]}, 'linkage.a2': {'log_range': [0.5, 2.0]},
            'linkage.a3': {'normal': [0.8, 0.01]}, 'linkage.a4': {'uniform': 0.1}}
    for method, evenness in (('sobol', 0.002), ('random', 0.03)):
        study = from_document({**GOOD, 'rows': 4096, 'method': method, 'vary': vary})
        drawn = study.drawn(0, 4096)
        expected = (scipy_stats.uniform(0.2, 0.4), scipy_stats.loguniform(0.5, 2.0),
                    scipy_stats.norm(0.8, 0.01), scipy_stats.uniform(0.9, 0.2))
        for column, distribution in zip(drawn.values(), expected):
            assert scipy_stats.kstest(column, distribution.cdf).statistic < evenness, method


def test_a_grid_has_all_combinations_once():
    study = from_document({**GOOD, 'rows': None, 'method': 'grid', 'vary': {
        'linkage.a1': {'range': [0.2, 0.6], 'levels': 5},
        'linkage.a2': {'list': [1.0, 1.1, 1.3]}}})
    drawn = study.drawn(0, study.rows)
    pairs = set(zip(*(column.tolist() for column in drawn.values())))
    assert study.rows == len(pairs) == 15
    assert np.allclose(sorted({one for one, _ in pairs}), np.linspace(0.2, 0.6, 5))
    assert {two for _, two in pairs} == {1.0, 1.1, 1.3}


@some('file', sorted((ROOT / 'config' / 'studies').glob('*.yaml')), 1,
      ids=lambda file: file.stem)
def test_the_shipped_studies_find_designs(file):
    chunk = compute(replace(read(file), rows=400), 0)
    assert not chunk.failures and chunk.counts['feasible'] >= 5, chunk.counts


UNITS = """\
scene: paper
rows: 8
vary:
  linkage.a1: {list: [400mm, 41 cm]}
  linkage.a2: {uniform: 0.5mm}
  drive.speed: {uniform: [300rpm, 5 rpm]}
quantities: [swing]
constraints: {swing: {least: 45deg, most: 2.0}}
"""


def test_a_study_takes_units(tmp_path):
    file = tmp_path / 'study.yaml'
    file.write_text(UNITS)
    rpm = np.pi / 30.0
    plain = from_document({'scene': 'paper', 'rows': 8, 'quantities': ['swing'], 'vary': {
        'linkage.a1': {'list': [0.4, 0.41]}, 'linkage.a2': {'uniform': 0.0005},
        'drive.speed': {'uniform': [300.0 * rpm, 5.0 * rpm]}},
        'constraints': {'swing': {'least': np.pi / 4.0, 'most': 2.0}}})
    for found, expected in zip(read(file).vary, plain.vary):
        assert np.allclose(found.values, expected.values, rtol=4.0 * 2.0**-52, atol=0.0)
    assert read(file).bounds == plain.bounds
    for old, new, why in (('0.5mm', '0,5mm', '0,5mm must be written 0.5mm: a comma is no'),
                          ('0.5mm', '0.5kg', r'vary.linkage.a2.uniform.*units m, '),
                          ('45deg', '45mm', 'constraints.swing.least')):
        file.write_text(UNITS.replace(old, new))
        with pytest.raises((StudyError, SceneError), match=why):
            read(file)


@pytest.mark.parametrize(('scene', 'unit'), [('paper', 'rad/s'), ('cylinder', 'm/s')])
def test_what_varies_has_the_unit_of_the_scene(scene, unit):
    study = from_document({**GOOD, 'scene': scene, 'quantities': ['driving_power'],
                           'vary': {'drive.speed': {'range': [0.1, 0.2]}}})
    assert [varied.unit for varied in study.vary] == [unit]


def test_a_scene_beside_its_study_may_be_one_of_several_nodes(tmp_path, monkeypatch):
    (tmp_path / 'two.yaml').write_text(''.join(
        f'/{node}:\n  ros__parameters:\n    linkage: {{a1: {a1}, a2: 1.2, a3: 0.8, a4: 1.0}}\n'
        for node, a1 in (('left', 0.4), ('right', 0.3))))
    (tmp_path / 'elsewhere').mkdir()
    monkeypatch.chdir(tmp_path / 'elsewhere')
    study = from_document(GOOD | {'scene': 'two.yaml:right'}, tmp_path)
    assert study.values['linkage.a1'] == 0.3
