# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The tables of the documents are those of the code."""
import re
import sys

from support import ROOT

sys.path.insert(0, str(ROOT / 'docs'))


def test_the_tables_of_the_manual_are_those_of_the_code():
    import tables
    for page, text in tables.pages().items():
        assert page.read_text(encoding='utf-8') == text, f'{page.name}: run python docs/tables.py'


def test_every_parameter_stands_once_for_the_robot_or_the_desk():
    from fourbar_ros.scene.settings import FAMILIES, PARAMETERS
    row = re.compile(r'^\| `([\w.]+)` \| [\w ]+ \| [^|]* \| [^|]+ \| [^|]* \| (?:yes)? \|', re.M)
    robot, desk = (row.findall((ROOT / f'docs/reference_{name}.md').read_text())
                   for name in ('robot', 'desk'))
    every = [name for table in (PARAMETERS, *FAMILIES.values()) for name in table]
    assert sorted(robot + desk) == sorted(every)
    assert {'outputs', 'frame_id', 'recording.start'} <= set(robot)
    assert {'linkage.a1', 'bodies.NAME.mass', 'drive.speed'} <= set(desk)


def test_a_label_names_one_equation_in_the_whole_tree():
    """A label stands before an equation, or at the end of its line."""
    import formulas
    labelled = {}
    for module in formulas.modules():
        for label in (*[tag for _, tag, _ in formulas.NUMBERED.findall(module.doc)],
                      *re.findall(r'^ +\S.* {3,}\(([A-Z]{1,2}\d+)\)$', module.doc, re.M)):
            labelled.setdefault(label, []).append(module.path)
    assert len(labelled) > 80
    assert {label: paths for label, paths in labelled.items() if len(paths) > 1} == {}


def test_the_list_of_formulas_finds_the_equations_of_both_documents():
    import formulas
    slides, paper = formulas.cited('slides'), formulas.cited('paper')
    assert {2, 6, 9, *range(16, 38)} <= set(slides) and {*range(1, 7), 9} <= set(paper)
    for document, last in (('slides', 38), ('paper', 10)):
        rows = [number for first, end, _ in formulas.SUBJECTS[document]
                for number in range(first, end + 1)]
        assert rows == list(range(1, last + 1)), document
        algorithm, = {row.split('|')[3] for row in formulas.source(document).splitlines()
                      if row.startswith('| algorithm')}
        assert 'search.py' in algorithm
    assert any(name == 'AngleEquation.ratio' for _, name in slides[24])


def test_every_field_of_every_message_has_its_unit_or_meaning():
    for file in (ROOT / 'msg_defs').glob('*/*.*'):
        if file.suffix in ('.msg', '.srv'):
            for line in file.read_text().splitlines():
                assert (not line or line.startswith('---') or '#' in line or '=' in line
                        or line.split()[1] in ('state', 'loads', 'success')), (
                            f'{file.name}: {line}')


def test_every_module_and_message_field_is_named_as_in_the_core():
    from fourbar_ros.mechanisms.curves import PointMotion
    from fourbar_ros.mechanisms.load_table import LOADS
    from fourbar_ros.scene.message_fields import STATE_FIELDS

    def fields(name):
        words = [line.split('#')[0].split()
                 for line in (ROOT / f'msg_defs/msg/{name}.msg').read_text().splitlines()]
        return [w[1] for w in words if len(w) == 2 and w[0] == 'float64']
    assert sorted(fields('LinkageState')) == sorted((*STATE_FIELDS, 'change_point_margin'))
    assert sorted(fields('LinkageLoads')) == sorted(LOADS)
    assert tuple(fields('PointMotion')) == PointMotion._fields
