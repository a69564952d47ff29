# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steps of a trace as statements of C, one an operation, so that none can be contracted."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from importlib.resources import files
from math import isfinite
import re

from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.trace import flat, Step, Trace

_FORMS = {'add': '{} + {}', 'sub': '{} - {}', 'mul': '{} * {}', 'truediv': '{} / {}',
          'neg': '-{}', 'gt': '{} > {}', 'lt': '{} < {}', 'pow': 'power({}, {})',
          'hypot': 'hypot_of({}, {})'}
JUDGED = ('sqrt', 'truediv')       # refuse an input by their last argument
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


def literal(value: float) -> str:
    """Return a number as C and C++ read it, to the last bit."""
    if value != value:
        return 'NAN'
    text = repr(float(value)) if isfinite(value) else f'{"-" * (value < 0)}HUGE_VAL'
    return f'({text})' if text.startswith('-') else text


class Statements:
    """
    Writes statements, and keeps the functions that they call.

    Attributes
    ----------
    used : set of str
        Names of the C texts of this package that they need.
    most_terms : int
        Of a sum.
    called : list of callable
        Functions that are no formulas: a statement calls the i-th by the name ``called_i``.

    """

    def __init__(self) -> None:
        self.used = set[str]()
        self.most_terms = 0
        self.called: list[Function] = []

    def define(self, its_name: str, step: Step, names: Sequence[str], is_flag: bool = False,
               is_chosen_by_flag: bool = True) -> list[str]:
        """
        Return the definition of a number as the result of a step.

        Parameters
        ----------
        its_name : str
        step : Step
        names : sequence of str
            Of its arguments.
        is_flag : bool
            A comparison is an int, not 1.0 or 0.0.
        is_chosen_by_flag : bool
            The condition of a choice is an int.

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

    def function(self, its_name: str, trace: Trace, refuses: bool = True) -> str:
        """
        Return the C function of a trace without data: inputs x to results, flat.

        ``refuses``: it returns whether it refuses its inputs, as Python's floats do: a root of a
        negative number, the sine of an infinite one, a division by zero. Else it returns nothing,
        and such results are NaN or infinite.
        """
        values, steps = trace.constants([]), trace.steps

        def name_of(place: int) -> str:
            if place not in trace.varies:
                value = values[place]
                assert value is not None
                return literal(value)
            return f'x[{place}]' if steps[place].is_given else f'v{place}'
        results = flat(trace.results)
        refusing = [place for place in trace.varies
                    if refuses and steps[place].operation in JUDGED]
        needed = set(trace.needed([*results, *(steps[i].arguments[-1] for i in refusing)]))
        lines = list[str]()
        for place in sorted(trace.varies & {*needed, *refusing}):
            step = steps[place]
            if place in needed and not step.is_given:
                lines += self.define(f'v{place}', step, [name_of(i) for i in step.arguments],
                                     True, step.arguments[0] in trace.varies)
            refusal = _refusal(step, name_of) if refuses else ''
            if refusal and refusal not in lines:
                lines.append(refusal)
        lines += [f'to[{i}] = {name_of(place)};' for i, place in enumerate(results)]
        is_used = any('x[' in line for line in lines)
        return '\n'.join([f'static {"int" if refuses else "void"} {its_name}(const double *x, '
                          'double *to)\n{', *['  int refused = 0;'] * refuses,
                          *['  (void)x;'] * (not is_used), *(f'  {line}' for line in lines),
                          *['  return refused;'] * refuses, '}', ''])


def _refusal(step: Step, name_of: Callable[[int], str]) -> str:
    """Return the statement that notes a refusal by a function of floats, or nothing."""
    last = name_of(step.arguments[-1]) if step.arguments else ''
    if not last.startswith(('v', 'x')):
        return ''
    return {'sqrt': f'refused |= {last} < 0.0;',
            'truediv': f'refused |= {last} == 0.0;',
            'sin': f'refused |= is_infinite({last});',
            'cos': f'refused |= is_infinite({last});'}.get(step.operation, '')
