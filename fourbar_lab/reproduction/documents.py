# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Printed numbers and equations beside computed ones, and whether each verdict on them is earned.

A verdict that does not explain the difference, or explains one that is not there, becomes DIFFERS.
"""
from collections.abc import Sequence
from math import isnan, nan
from typing import NamedTuple

from fourbar_ros.terminal import make_console, make_table

EXACT = 1e-12      # of the sum of the terms: more than rounding, less than any slip
# the verdicts, and what each means; the help lists them
VERDICTS = {
    'agrees': 'to the last printed digit',
    'read off a drawing': 'as near as a drawing can be read',
    'rounded on the way': 'computed from rounded numbers',
    'copy garbled': 'our copy of the document garbles it: what is shown is a reading of the copy, '
                    'or a doubt',
    'misprint': 'a slip in print; the reason is given, and for equations the correction was '
                'checked',
    'wrong computation': 'the document computed something else; the reason is given',
    'assumption of ours': 'not printed; what we took for it',
    'definition': 'of symbols, or a step that a numbered equation sums up',
    'answered here': 'the document asks, and the reason answers',
    'not compared': 'and why',
    'DIFFERS': 'without a known reason',
}
(AGREES, DRAWN, ROUNDED, GARBLED, MISPRINT, WRONG, ASSUMED, DEFINED, ANSWERED, MISSING,
 DIFFERS) = VERDICTS
COLUMNS = ('', 'printed>', 'ours>', 'difference>', 'unit', 'verdict', '')


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
    """An example or table of a document; ``figure``: its drawing in :mod:`.page`, or ''."""

    title: str
    rows: list[Row]
    figure: str = ''

    @property
    def footnotes(self) -> dict[str, int]:
        """Return {reason: index from 1}, each reason once, in the order of the rows."""
        reasons = dict.fromkeys(row.reason for row in self.rows if row.reason)
        return {reason: index for index, reason in enumerate(reasons, 1)}

    @property
    def cells(self) -> list[tuple[str, ...]]:
        notes = self.footnotes
        return [(row.what, row.printed, '' if isnan(row.ours) else f'{row.ours:.10g}',
                 '' if isnan(row.difference) else f'{row.difference:.3g}', row.unit, row.verdict,
                 f'({notes[row.reason]})' if row.reason else '') for row in self.rows]


def printed(item: str, unit: str, text: str, ours: float, verdict: str = AGREES, why: str = '',
            *, within: float = 0.0) -> Row:
    """Return the Row of a printed number; the digits of its text say how exact it is."""
    # within: the largest difference that the verdict explains, as a share of our value. A garbled
    # number without a share is a doubt, so it must not agree.
    ours, value = float(ours), float(text or nan)           # ours: of numpy
    is_right = agrees(ours, text)
    is_near = abs(ours - value) <= within * abs(ours)
    is_earned = {
        AGREES: is_right, DRAWN: is_near and not is_right, ROUNDED: is_near and not is_right,
        MISPRINT: not is_right, WRONG: not is_right,
        GARBLED: is_near if within > 0.0 else not is_right}.get(verdict, True)
    return Row(item, unit, text, ours, ours - value, verdict if is_earned else DIFFERS, why)


def drawn(item: str, unit: str, text: str, ours: float, within: float, why: str = '') -> Row:
    """Return the Row of a number that the document reads off a drawing."""
    return printed(item, unit, text, ours, DRAWN, why, within=within)


def remark(item: str, verdict: str, why: str) -> Row:
    """Return the Row of an item that is not compared, or only defined."""
    return Row(item, '', '', nan, nan, verdict, why)


def agrees(value: float, text: str) -> bool:
    """Return whether a printed number is the value, rounded or cut: 0.67 and 0.66 are 2/3."""
    if not text:
        return False
    shown, last_digit = float(text), 10.0**-len(text.partition('.')[2])
    beyond = (value - shown if shown >= 0.0 else shown - value) / last_digit
    return -0.5 <= beyond < 1.0


def zero(item: str, *terms: complex, verdict: str = AGREES, why: str = '',
         correct: Sequence[complex] = ()) -> Row:
    """Return the Row of an equation whose terms, as printed, must add up to zero."""
    # The size of the sum is divided by the sizes of its terms; vectors are complex numbers. If the
    # verdict is a misprint, the terms must not add up to zero, and those of correct must.
    def relative_sum(addends: Sequence[complex]) -> float:
        return abs(sum(addends)) / sum(map(abs, addends)) if addends else nan

    row = equal(item, '', printed=relative_sum(terms), ours=0.0, verdict=verdict, why=why,
                correct=relative_sum(correct))
    return row._replace(printed='0') if row.verdict == AGREES else row    # not its rounding error


def equal(item: str, unit: str, printed: float, ours: float, verdict: str = AGREES, why: str = '',
          *, correct: float = nan) -> Row:
    """Return the Row of a printed formula, by its value, which must be ours."""
    # A misprint must differ, and its correction must not. An answer to a question of the document
    # is printed nowhere: both sides are ours.
    printed, ours = float(printed), float(ours)         # of numpy
    scale = max(1.0, abs(ours))
    is_right = abs(printed - ours) <= EXACT * scale
    is_earned = (not is_right and abs(correct - ours) <= EXACT * scale if verdict == MISPRINT
                 else is_right)
    verdict = verdict if is_earned else DIFFERS
    if verdict == ANSWERED:
        return Row(item, unit, '', printed, nan, verdict, why)
    return Row(item, unit, f'{printed:.6g}', ours, ours - printed, verdict, why)


def count(sections: Sequence[Section]) -> dict[str, int]:
    """Return the number of rows of each verdict, as a dict in the order of VERDICTS."""
    verdicts = [row.verdict for section in sections for row in section.rows]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS if verdict in verdicts}


def summary(sections: Sequence[Section]) -> str:
    """Return how many rows have each verdict, as '129 agrees, 9 misprint'."""
    return ', '.join(f'{rows} {verdict}' for verdict, rows in count(sections).items())


def print_tables(sections: Sequence[Section]) -> None:
    console = make_console()
    for section in sections:
        console.print(make_table(section.title, COLUMNS, section.cells))
        for reason, index in section.footnotes.items():
            console.print(f'({index}) {reason}', style='dim', markup=False)
        console.print()
    console.print(summary(sections))
