# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Both documents recomputed.

Each verdict is earned, and Table 3 is what was said to have made it.
"""
from html.parser import HTMLParser
import re
import subprocess
import sys

from fourbar_lab.reproduction import published
from fourbar_lab.reproduction.documents import (
    AGREES,
    agrees,
    ANSWERED,
    ASSUMED,
    count,
    DEFINED,
    DIFFERS,
    DRAWN,
    equal,
    GARBLED,
    MISPRINT,
    MISSING,
    print_tables,
    printed,
    ROUNDED,
    VERDICTS,
    WRONG,
    zero,
)
from fourbar_lab.reproduction.paper import reproduce
from fourbar_ros import __version__, plain
from fourbar_ros.mechanisms.points import point_motion
import numpy as np
import pytest
from support import ROOT
from support.cartesian import EPS
from support.samples import some


@pytest.fixture(scope='module')
def sections():
    return reproduce()


def rows(sections, title):
    section, = (section for section in sections if title in section.title)
    return section.rows


# --- verdicts ------------------------------------------------------------------------------------

def test_nothing_differs_without_a_reason(sections):
    found = count(sections)
    assert DIFFERS not in found
    assert (found[AGREES] > 100 and sum(found.values()) > 170 and set(found) == set(VERDICTS)
            - {DIFFERS})
    for section in sections:
        for row in section.rows:
            assert row.reason or row.verdict in (AGREES, DRAWN, ROUNDED), row
            assert (row.verdict in (AGREES, ANSWERED, DEFINED, MISPRINT, MISSING)
                    or 'Example 7.' in section.title or 'Table' in section.title)


def verdicts(sections, title):
    return {row.what.strip(): row.verdict for row in rows(sections, title)}


def test_the_copy_is_not_taken_for_the_authors(sections):
    """Every garbled cell of Table 2 is near ours; nothing there is a misprint."""
    table_2 = rows(sections, 'Table 2')
    garbled = [row for row in table_2 if row.verdict == GARBLED]
    assert len(garbled) == 6 and MISPRINT not in {row.verdict for row in table_2}
    assert {row.what for row in garbled} == {'mode 1, omega4', 'mode 2, omega4', 'mode 2, alpha4'}
    for row in garbled:
        assert abs(row.difference) <= 2e-9 * abs(row.ours) and 'the copy has' in row.reason
    assert [row.what for row in rows(sections, 'Example 7.6 -') if row.verdict
            == GARBLED] == ['dv2/dt on the last page']


def test_table_3_is_a_wrong_computation_and_its_percentage_agrees(sections):
    found = rows(sections, 'Table 3')
    assert [row.verdict for row in found[:8]] == [WRONG] * 8
    percent, = (row for row in found if row.unit == '%')
    assert (percent.verdict == AGREES and percent.ours == pytest.approx(100.0 * 0.1839 / 5.7299,
                                                                        rel=1e-12))
    literal, = (row for row in found if 'r34 of Fig. 2' in row.what)
    assert literal.ours == pytest.approx(806.1692, abs=1e-4)
    assert 'inference' in ' '.join(row.reason for row in found)


def test_what_is_assumed_and_what_is_not_compared_is_listed(sections):
    for title, what in (('Example 7.2 -', 'crank angle'), ('Example 7.3 -', 'ground AD'),
                        ('Example 7.5 -', 'crank angle')):
        assert verdicts(sections, title)[what] == ASSUMED
    assert [row.what for section in sections for row in section.rows
            if row.verdict == MISSING] == [
        'acceleration of D', 'Slides, Eqs. (4), (5), (8)', 'Slides, Example 7.1']


# {what a document numbers: how often, as its pages have it}; the paper's steps: of both algorithms
NUMBERED = {'Slides': {'Eq.': 38, 'Eq. E': 4, 'Example 7': 7, 'step': 9, 'item': 17},
            'Paper': {'Eq.': 10, 'Table': 3, 'Figure': 4, 'velocity, step': 3,
                      'acceleration, step': 5}}
NAMED = re.compile(r'(Eq|Example 7|Table|Figure|velocity, step|acceleration, step|step|item)s?'
                   r'\.? ?(\(?E?\d+\)?(?:(?:, | and |-)\(?E?\d+\)?)*)')


def numbers_in(text):
    for name, found in NAMED.findall(text):
        for letter, first, last in re.findall(r'\(?(E?)(\d+)\)?(?:-\(?E?(\d+))?', found):
            kind = f'Eq. {letter}'.strip() if name == 'Eq' else name
            yield from ((kind, index) for index in range(int(first), int(last or first) + 1))


def test_every_numbered_thing_of_both_documents_has_its_row(sections):
    """Equations, steps and items by the names of rows; figures of tables may be in titles."""
    found = {document: set() for document in NUMBERED}
    for section in sections:
        for row in section.rows:
            document = row.what.split(',')[0] if 'Definitions' in section.title else (
                section.title.split(',')[0])
            found[document] |= set(numbers_in(row.what))
            found[document] |= {named for named in numbers_in(section.title)
                                if named[0] in ('Table', 'Figure')
                                or document == 'Slides' and named[0] == 'Example 7'}
    for document, kinds in NUMBERED.items():
        expected = {(kind, i) for kind, count in kinds.items() for i in range(1, count + 1)}
        assert expected == found[document], document


def test_the_open_questions_are_answered(sections):
    answers = [row.what for section in sections for row in section.rows
               if row.verdict == ANSWERED]
    assert sum('item 16' in what for what in answers) == 2
    assert any('item 17' in what for what in answers)


def test_the_misprinted_equations_are_these(sections):
    assert [row.what for row in rows(sections, '(16)-(37)') if row.verdict == MISPRINT] == [
        'Eq. (25)', 'Eq. (31)', 'Eq. (33)']
    assert [row.what for row in rows(sections, '(1)-(8)') if row.verdict
            == MISPRINT] == ['second derivative of v']


@pytest.mark.parametrize('value, text, expected', [
    (2.6810151, '2.6810', True), (2.68105, '2.6810', True), (2.68112, '2.6810', False),
    (2.68094, '2.6810', False),
    (-51.656958, '-51.6569', True), (-51.65701, '-51.6569', False), (188.49, '188.5', True),
    (49.5015, '49.6', False),
    (-0.4840322, '-0.4840', True), (7402.2, '7403', False), (2.0, '-2', False)])
def test_agreement_is_to_the_last_printed_digit(value, text, expected):
    assert agrees(value, text) == expected


@pytest.mark.parametrize('row', [
    printed('omega4', 'rad/s', '7.1791', 7.17814),
    printed('a', '', '9000', 7873.0, DRAWN, within=0.02),
    printed('v2', '', '-0.4840', -0.48403, MISPRINT, 'none'),
    printed('v4', '', '0.9094', 0.90945, GARBLED, 'none'),
    printed('a', '', '3250', 3250.0, WRONG, 'none'),
    printed('v4', '', '0.9094', 0.90945, DRAWN, within=0.1),         # it agrees
    printed('alpha4', '', '-462.6986675', -462.69865742, GARBLED, within=1e-9),
    zero('Eq.', 1.0, -2.0, 1.1), equal('Eq.', '', 1.0, 1.0 + 1e-9),
    zero('Eq.', 1.0, -1.0, verdict=MISPRINT, why='none', correct=[1.0, -1.0]),
    zero('Eq.', 1.0, -2.0, verdict=MISPRINT, why='so', correct=[1.0, -1.5]),
    equal('Eq.', '', 2.0, 1.0, MISPRINT, 'so', correct=1.001),
    equal('item', 'deg', 90.0, 89.9999, ANSWERED, 'so')])
def test_a_verdict_that_is_not_earned_is_seen(row):
    assert row.verdict == DIFFERS


# --- our side, against independent solutions -----------------------------------------------------

def test_the_moment_with_the_arm_of_fig_2_from_eq_9(sections):
    """The same maximum on a fine grid of Eq. (9), with r34 from the places of the points."""
    theta1 = np.radians(np.linspace(350.0, 365.0, 20001))
    motion = published.THIN.motion(theta1, published.PAPER_SPEED)
    by_eq_9 = plain.loads(published.PAPER_LENGTHS, published.THIN_RODS, motion)
    centre = point_motion(published.THIN, motion, 'output', 0.4).place
    arm_x, arm_y = (np.array([1.0, 0.0]) - centre).T
    moment = np.abs(-by_eq_9.driving_torque - arm_x * by_eq_9.f43_y + arm_y * by_eq_9.f43_x)
    row, = (row for row in rows(sections, 'Table 3') if 'r34 of Fig. 2' in row.what)
    assert row.ours == pytest.approx(moment.max(), rel=1e-9)


def test_table_3_is_momentum(sections):
    """The printed force is |sum m v| of the centres of gravity, straight from their velocities."""
    theta1, force, *_ = published.wrong_curves()
    m = published.THIN.motion(theta1, published.PAPER_SPEED)
    crank, coupler, output = (m.cos_x + 1j * m.sin_x, m.cos_b + 1j * m.sin_b,
                              m.cos_y + 1j * m.sin_y)
    velocities = (5j * crank, 10j * crank + 0.6j * m.omega_beta * coupler,
                  0.4j * m.omega4 * output)
    momentum = sum(body.mass * v for body, v in zip(published.RODS, velocities))
    np.testing.assert_allclose(force, np.abs(momentum), rtol=1e-11)
    found = {row.what: row.ours for row in rows(sections, 'Table 3')}
    assert found['largest shaking force'] == pytest.approx(2512.318373, rel=1e-9)
    assert found['largest shaking moment about O1 (thin rods)'] == pytest.approx(2048.519240,
                                                                                 rel=1e-9)


def test_a_counterweight_on_the_crank_cancels_the_force_in_one_pose_alone():
    at = published.largest_extremum(published.THIN, 'alpha4', 1.0).theta1
    weighted, x = published.counterweighted(published.THIN, at), np.linspace(-3.0, 3.0, 601)
    forces = weighted.loads(x, 1.0).shaking_force
    assert weighted.loads(at, 1.0).shaking_force <= 64.0 * EPS * forces.max()
    assert weighted.bodies.crank.mass > published.THIN.bodies.crank.mass


# --- what is written -----------------------------------------------------------------------------

class Page(HTMLParser):
    """Counts tags and keeps what would be loaded from elsewhere."""

    def __init__(self, text):
        super().__init__()
        self.open, self.count, self.loaded = [], {}, []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.count[tag] = self.count.get(tag, 0) + 1
        self.loaded += [value for name, value in attributes
                        if name in ('src', 'href', 'xlink:href') and not value.startswith('#')]


def test_the_command_writes_a_page_that_holds_all_and_loads_nothing(sections, tmp_path):
    pytest.importorskip('matplotlib')
    from fourbar_lab.reproduction.page import page
    out = tmp_path / 'report.html'
    done = subprocess.run([sys.executable, '-m', 'fourbar_ros', 'reproduce', '--html', str(out)],
                          capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr
    assert 'DIFFERS' not in done.stdout
    text = out.read_text()
    assert text.startswith('<!doctype html>')
    day = re.search(rf'fourbar_ros {re.escape(__version__)}, (\d{{4}}-\d\d-\d\d)', text)[1]
    found = Page(text)
    assert found.loaded == [] and found.count['table'] == len(sections)
    assert found.count['tr'] == len(sections) + sum(len(section.rows) for section in sections)
    assert found.count['figure'] == found.count['svg'] == 7
    assert text == page(sections, day)               # the same bytes every time
    assert found.count['dt'] == len(VERDICTS)
    for section in sections:
        for row in section.rows:
            assert row.printed in text


@some('name, word', [('example_7_2', '$V_{B}$ = 39.27'), ('example_7_3', '$A_{B}$ = 2961'),
                     ('example_7_5', '$A_{Cor}$')], 1)
def test_figures_have_the_units_and_letters_of_their_tables(name, word):
    pytest.importorskip('matplotlib')
    from fourbar_lab.reproduction.page import FIGURES
    figure, _ = FIGURES[name]()
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert any(text.startswith(word) for text in words), words
    assert any(text.endswith((' ft/s', ' ft/s$^2$')) for text in words)


def test_the_tables_number_their_reasons(sections, capsys):
    print_tables(sections)
    text = capsys.readouterr().out
    assert ('misprint' in text and '(1) ' in text
            and text.splitlines()[-1].startswith(f'{count(sections)[AGREES]} agrees, '))
    assert list(sections[0].footnotes.values()) == [1, 2, 3, 4]
