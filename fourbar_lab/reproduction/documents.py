# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar reproduce``: compute everything that the slides and the paper print, and judge it."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan, degrees, isnan, nan, sqrt
from pathlib import Path
from typing import Any, NamedTuple, TYPE_CHECKING, Union

from fourbar_lab.reproduction import published, statements, verdicts
from fourbar_ros.terminal import make_console, make_table
import yaml

if TYPE_CHECKING:
    from rich.console import Console

DOCUMENTS = Path(__file__).with_name('published.yaml')
Entry = Mapping[str, Any]       # a row of published.yaml, whose head explains the keys
Term = Union[str, float]        # an expression of such a row
FUNCTIONS: dict[str, Any] = {'__builtins__': {}, 'atan': atan, 'degrees': degrees, 'sqrt': sqrt}
EXACT = 1e-12      # of the sum of the terms: more than rounding, less than any slip


class Row(NamedTuple):
    """One printed number or equation beside the computed one."""

    what: str
    unit: str
    printed: str
    ours: float
    difference: float      # ours - printed
    verdict: str
    reason: str


class Section(NamedTuple):
    """
    An example or a table of a document.

    ``figure``: name of a drawing of :mod:`fourbar_lab.reproduction.figures`, or ''.
    """

    title: str
    rows: list[Row]
    figure: str


def reproduce(path: str | Path = DOCUMENTS) -> list[Section]:
    """Return every :class:`Section`, computed now."""
    return [_section(entry) for entry in yaml.safe_load(Path(path).read_text(encoding='utf-8'))]


def _section(entry: Entry) -> Section:
    """Return a section of published.yaml, with the values that its functions compute."""
    values, symbols = (_computed(entry[key]) if key in entry else {}
                       for key in ('values', 'symbols'))
    rows = [_equation(row, symbols) if 'terms' in row or 'value' in row else _number(row, values)
            for row in entry['rows']]
    return Section(entry['title'], rows, entry.get('figure', ''))


def _computed(name: str) -> Mapping[str, float]:
    """Call a function of statements.py or published.py by its name; return its dict."""
    module = statements if hasattr(statements, name) else published
    numbers: Mapping[str, float] = getattr(module, name)()
    return numbers


def _number(row: Entry, values: Mapping[str, float]) -> Row:
    """
    Return the Row of a printed number, with its difference from ours and the verdict on it.

    A number that follows from others that are printed (``own``) must do so too.
    """
    printed = row.get('printed', '')
    own = _evaluate(row['own'], {}) if 'own' in row else nan
    ours = float(values[row['key']]) if 'key' in row else own
    verdict = _verdict(row, ours)
    if not isnan(own) and not agrees(own, printed):
        verdict = verdicts.DIFFERS
    reason = '' if verdict == verdicts.AGREES and 'rounded' in row else _reason(row)
    return Row(row['what'], row.get('unit', ''), printed, ours, ours - float(printed or nan),
               verdict, reason)


def _verdict(row: Entry, ours: float) -> str:
    """
    Return the verdict on a number.

    The keys of the row are published.yaml's: ``drawn`` and ``rounded`` are relative differences
    that are allowed, others name a reason. DIFFERS also if it gives a reason that does not explain
    the difference, or one although there is none.
    """
    for key, verdict in (('missing', verdicts.MISSING), ('assumed', verdicts.ASSUMED),
                         ('defined', verdicts.DEFINED)):
        if key in row:
            return verdict
    difference = abs(ours - float(row['printed']))
    if agrees(ours, row['printed']):
        verdict = verdicts.AGREES
    elif difference <= row.get('drawn', 0.0) * abs(float(row.get('scale', ours))):
        verdict = verdicts.DRAWN
    elif difference <= row.get('rounded', 0.0) * abs(ours):
        verdict = verdicts.ROUNDED
    else:
        verdict = verdicts.DIFFERS
    if 'copies' in row:
        is_explained = (verdict in (verdicts.AGREES, verdicts.ROUNDED)
                        and is_reading(row['printed'], row['copies']))
        return verdicts.GARBLED if is_explained else verdicts.DIFFERS
    for key, reason in (('garbled', verdicts.GARBLED), ('misprint', verdicts.MISPRINT),
                        ('wrong', verdicts.WRONG)):
        if key in row:
            return reason if verdict == verdicts.DIFFERS else verdicts.DIFFERS
    return verdict


def _reason(row: Entry) -> str:
    """Return the footnote that a row refers to."""
    if 'copies' in row:
        return f'the copy has {" and ".join(repr(text.strip()) for text in row["copies"])}'
    return next((row[name] for name in ('missing', 'assumed', 'defined', 'answered', 'garbled',
                                        'misprint', 'wrong', 'why') if name in row), '')


def is_reading(text: str, copies: Sequence[str]) -> bool:
    """Return whether each character of a text stands at its place in a garbled copy."""
    return all(len(copy) == len(text) for copy in copies) and all(
        any(copy[i] == character for copy in copies) for i, character in enumerate(text))


def agrees(value: float, text: str) -> bool:
    """Return whether a printed number is the value, rounded or cut: 0.67 and 0.66 are 2/3."""
    printed, unit = float(text), 10.0**-len(text.partition('.')[2])
    beyond = (value - printed) / unit if printed >= 0.0 else (printed - value) / unit
    return -0.5 <= beyond < 1.0


def _equation(row: Entry, symbols: Mapping[str, float]) -> Row:
    """
    Return the Row of an equation: its printed form against what it must give.

    A sum of ``terms`` must be zero, relative to their magnitudes; a ``value`` must be ``ours``. A
    misprint must be wrong, and its correction right.
    """
    def relative_sum(terms: Sequence[Term]) -> float:
        numbers = [_evaluate(term, symbols) for term in terms]
        return sum(numbers) / sum(map(abs, numbers))

    def value(form: Term | list[Term]) -> float:
        return relative_sum(form) if isinstance(form, list) else _evaluate(form, symbols)

    ours = _evaluate(row.get('ours', '0.0'), symbols)
    printed = value(row['terms'] if 'terms' in row else row['value'])
    scale = max(1.0, abs(ours))
    is_right = abs(printed - ours) <= row.get('within', EXACT) * scale
    verdict = verdicts.AGREES if is_right else verdicts.DIFFERS
    if 'answered' in row:       # nothing is printed: two sides of ours
        return Row(row['what'], row.get('unit', ''), '', printed, nan,
                   verdicts.ANSWERED if is_right else verdict, row['answered'])
    if 'misprint' in row and not is_right and abs(value(row['correct']) - ours) <= EXACT * scale:
        verdict = verdicts.MISPRINT
    text = f'{printed:.6g}' if not is_right or 'value' in row else '0'
    return Row(row['what'], row.get('unit', ''), text, ours, ours - printed, verdict, _reason(row))


def _evaluate(expression: Term, symbols: Mapping[str, float]) -> float:
    """Return the value of an expression in published.yaml; it knows these symbols only."""
    return float(eval(str(expression), FUNCTIONS, symbols))


# --- as tables -----------------------------------------------------------------------------------

COLUMNS = ('', 'printed>', 'ours>', 'difference>', 'unit', 'verdict', '')


def cells(row: Row) -> tuple[str, ...]:
    """Return the texts of a Row under :data:`COLUMNS`, but for the last: where its reason is."""
    return (row.what, row.printed, '' if isnan(row.ours) else f'{row.ours:.10g}',
            '' if isnan(row.difference) else f'{row.difference:.3g}', row.unit, row.verdict)


def footnotes(section: Section) -> dict[str, int]:
    """Return {reason: its number} of a Section, each once, in order from 1."""
    reasons = dict.fromkeys(row.reason for row in section.rows if row.reason)
    return {reason: number for number, reason in enumerate(reasons, 1)}


def count(sections: Sequence[Section]) -> dict[str, int]:
    """Return the number of rows of each verdict, as a dict in the order of VERDICTS."""
    given = [row.verdict for section in sections for row in section.rows]
    return {verdict: given.count(verdict) for verdict in verdicts.VERDICTS if verdict in given}


def summary(sections: Sequence[Section]) -> str:
    """Return the verdicts in one line."""
    return ', '.join(f'{number} {verdict}' for verdict, number in count(sections).items())


def print_tables(sections: Sequence[Section], console: Console | None = None) -> None:
    """Print a table for each section, the reasons below it."""
    console = console or make_console()
    for section in sections:
        notes = footnotes(section)
        table = make_table(section.title, COLUMNS)
        for row in section.rows:
            table.add_row(*cells(row), f'({notes[row.reason]})' if row.reason else '')
        console.print(table)
        for reason, number in notes.items():
            console.print(f'({number}) {reason}', style='dim', markup=False)
        console.print()
    console.print(summary(sections))
