# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps of a trace as statements of C, one an operation, so that none can be contracted."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from math import isfinite
import re

from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.trace import flat, Step, Trace

_FORMS = {'add': '{} + {}', 'sub': '{} - {}', 'mul': '{} * {}', 'truediv': '{} / {}',
          'neg': '-{}', 'gt': '{} > {}', 'lt': '{} < {}', 'pow': 'power({}, {})',
          'hypot': 'hypot_of({}, {})'}
# operations that refuse an input by their last argument, as floats of Python do: its test in C
JUDGED = {'sqrt': '{} < 0.0', 'truediv': '{} == 0.0'}
ALL_JUDGED = JUDGED | {'sin': 'is_infinite({})', 'cos': 'is_infinite({})'}
_OF_LISTS = ('exact_sum', 'power_of_two')
_SNIPPETS = {'pow': 'power', 'hypot': 'hypot', 'exact_sum': 'exact_sum',
             'power_of_two': 'power_of_two'}


@cache
def _parts(file: str) -> dict[str, str]:
    """Return {name: text} of a C file of this package; the text above all names has none."""
    text = (files(__package__) / 'c' / file).read_text(encoding='utf-8')
    first, *named = re.split(r'(?m)^// --- (\w+)\n', text)
    return {'': first, **dict(zip(named[::2], named[1::2]))}


def snippet(file: str, name: str = '') -> str:
    """Return a part of a C file of this package."""
    return _parts(file)[name]


def filled(text: str, words: Mapping[str, object]) -> str:
    """Return a text with these words replaced by their meanings, which are left as they are."""
    return re.sub('|'.join(map(re.escape, words)), lambda match: str(words[match[0]]), text)


def lines_of(texts: Iterable[str]) -> str:
    """Return statements as lines within a function."""
    return ''.join([f'  {text}\n' for text in texts])


def literal(value: float) -> str:
    """Return a number as C and C++ read it, to the last bit."""
    if value != value:
        return 'NAN'
    text = repr(float(value)) if isfinite(value) else f'{"-" * (value < 0)}HUGE_VAL'
    return f'({text})' if text.startswith('-') else text


class Statements:
    """Writes statements, and keeps what they need: texts, sizes, functions."""

    def __init__(self) -> None:
        self.used = set[str]()              # names of C texts of this package
        self.most_terms = 0                 # of a sum
        self.called: list[Function] = []    # no formulas: the i-th is called ``called_i``

    def lines(self, trace: Trace, needed: Iterable[int], refusing: Iterable[int],
              name_of: Callable[[int], str], refused: Mapping[str, str] = JUDGED) -> list[str]:
        """
        Return the statements of all that varies with the inputs, in order.

        ``needed``: places whose results are wanted; ``refusing``: places that refuse some inputs,
        wanted or not; ``name_of`` gives the name in C of the result of a place; ``refused`` is
        {operation: test of its last argument that refuses the inputs}.
        """
        found, needed = list[str](), set(needed)
        for place in sorted(trace.varies & {*needed, *refusing}):
            step = trace.steps[place]
            if place in needed and not step.is_given:
                found += self.define(f'v{place}', step, [name_of(i) for i in step.arguments],
                                     True, step.arguments[0] in trace.varies)
            if step.operation in refused:
                last = name_of(step.arguments[-1])
                refusal = f'refused |= {refused[step.operation].format(last)};'
                # a number of the scene refuses nothing, unless it is zero
                if (last[0] in 'vxk' or last == '0.0') and refusal not in found:
                    found.append(refusal)
        return found

    def define(self, its_name: str, step: Step, names: Sequence[str], is_flag: bool = False,
               is_chosen_by_flag: bool = False) -> list[str]:
        """
        Return the definition of a number as the result of a step; ``names`` of its arguments.

        ``is_flag``: a comparison is an int, not 1.0 or 0.0; ``is_chosen_by_flag``: so is the
        condition of a choice.
        """
        operation, kind = step.operation, 'double'
        if operation in _SNIPPETS:
            self.used.add(_SNIPPETS[operation])
        if operation in _OF_LISTS:
            self.most_terms = max(self.most_terms, len(names))
            return [f'double {its_name};',
                    f'{{ const double terms[] = {{{", ".join(names)}}}; '
                    f'{its_name} = {operation}({len(names)}, terms); }}']
        if operation == 'where':
            text = f'{names[0]}{" > 0.0" * (not is_chosen_by_flag)} ? {names[1]} : {names[2]}'
        elif operation == 'call':
            if step.value not in self.called:
                self.called.append(step.value)
            text = f'called_{self.called.index(step.value)}({names[0]})'
        else:
            text = _FORMS.get(operation, operation + '({})'
                              if len(names) == 1 else operation + '({}, {})').format(*names)
        if operation in ('gt', 'lt'):
            kind, text = ('int', text) if is_flag else (kind, f'{text} ? 1.0 : 0.0')
        return [f'const {kind} {its_name} = {text};']

    def function(self, its_name: str, trace: Trace) -> str:
        """
        Return the C function of a trace without data: inputs x to results, flat.

        It returns whether it refuses its inputs, as Python's floats do: a root of a negative
        number, the sine of an infinite one, a division by zero.
        """
        values, steps = trace.constants([]), trace.steps

        def name_of(place: int) -> str:
            if place not in trace.varies:
                value = values[place]
                assert value is not None
                return literal(value)
            return f'x[{place}]' if steps[place].is_given else f'v{place}'

        results = flat(trace.results)
        refusing = [place for place in trace.varies if steps[place].operation in JUDGED]
        needed = trace.needed([*results, *(steps[i].arguments[-1] for i in refusing)])
        lines = self.lines(trace, needed, refusing, name_of, ALL_JUDGED)
        lines += [f'to[{i}] = {name_of(place)};' for i, place in enumerate(results)]
        is_used = any('x[' in line for line in lines)
        return '\n'.join([f'static int {its_name}(const double *x, double *to)\n{{',
                          '  int refused = 0;', *['  (void)x;'] * (not is_used),
                          *(f'  {line}' for line in lines), '  return refused;', '}', ''])
