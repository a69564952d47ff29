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
def snippet(file: str, name: str = '') -> str:
    """Return a named text of a C file of this package, or the text above all names."""
    text = (files(__package__) / 'c' / file).read_text(encoding='utf-8')
    first, *named = re.split(r'(?m)^// --- (\w+)\n', text)
    return {'': first, **dict(zip(named[::2], named[1::2]))}[name]


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
    """Writes statements, and keeps the C texts, sizes and functions that these call."""

    def __init__(self) -> None:
        self.used = set[str]()              # names of C texts of this package
        self.most_terms = 0                 # of a sum
        self.called: list[Function] = []    # functions of Python: the i-th is ``called_i``

    def lines(self, trace: Trace, needed: Iterable[int], refusing: Iterable[int],
              name_of: Callable[[int], str], refused: Mapping[str, str] = JUDGED) -> list[str]:
        """
        Return the statements of all that varies with the inputs, in order.

        ``needed``: indices of steps whose results are wanted; ``refusing``: indices of steps that
        refuse some inputs, wanted or not; ``name_of`` gives the name in C of the result of a step;
        ``refused`` is {operation: test of its last argument that refuses the inputs}.
        """
        lines, needed = list[str](), set(needed)
        for index in sorted(trace.varies & {*needed, *refusing}):
            step = trace.steps[index]
            if index in needed and not step.is_given:
                lines += self.define(f'v{index}', step, [name_of(i) for i in step.arguments],
                                     True, step.arguments[0] in trace.varies)
            if step.operation in refused:
                last = name_of(step.arguments[-1])
                refusal = f'refused |= {refused[step.operation].format(last)};'
                # a number of the scene refuses nothing, unless it is zero
                if (last[0] in 'vxk' or last == '0.0') and refusal not in lines:
                    lines.append(refusal)
        return lines

    def define(self, name: str, step: Step, operands: Sequence[str], is_flag: bool = False,
               is_chosen_by_flag: bool = False) -> list[str]:
        """
        Return the C definition of the result of a step; ``operands``: names of its arguments.

        ``is_flag``: the result of a comparison is an int, not 1.0 or 0.0; ``is_chosen_by_flag``:
        the condition of a choice is such an int.
        """
        operation, kind = step.operation, 'double'
        if operation in _SNIPPETS:
            self.used.add(_SNIPPETS[operation])
        if operation in _OF_LISTS:
            self.most_terms = max(self.most_terms, len(operands))
            return [f'double {name};',
                    f'{{ const double terms[] = {{{", ".join(operands)}}}; '
                    f'{name} = {operation}({len(operands)}, terms); }}']
        if operation == 'where':
            condition = operands[0] if is_chosen_by_flag else f'{operands[0]} > 0.0'
            text = f'{condition} ? {operands[1]} : {operands[2]}'
        elif operation == 'call':
            if step.value not in self.called:
                self.called.append(step.value)
            text = f'called_{self.called.index(step.value)}({operands[0]})'
        else:
            call = f'{operation}({", ".join(operands)})'
            text = _FORMS[operation].format(*operands) if operation in _FORMS else call
        if operation in ('gt', 'lt') and is_flag:
            kind = 'int'
        elif operation in ('gt', 'lt'):
            text = f'{text} ? 1.0 : 0.0'
        return [f'const {kind} {name} = {text};']

    def function(self, name: str, trace: Trace) -> str:
        """
        Return the C function of a trace without data: inputs x to results, flat.

        It returns whether it refuses its inputs, as Python's floats do: a root of a negative
        number, the sine of an infinite one, a division by zero.
        """
        steps, results = trace.steps, flat(trace.results)
        names = {index: literal(value) for index, value in enumerate(trace.constants([]))
                 if value is not None}
        names |= {i: f'x[{i}]' if steps[i].is_given else f'v{i}' for i in trace.varies}
        refusing = [index for index in trace.varies if steps[index].operation in JUDGED]
        needed = trace.needed([*results, *(steps[i].arguments[-1] for i in refusing)])
        lines = self.lines(trace, needed, refusing, names.__getitem__, ALL_JUDGED)
        lines += [f'to[{i}] = {names[index]};' for i, index in enumerate(results)]
        unused = [] if any('x[' in line for line in lines) else ['(void)x;']
        return '\n'.join([f'static int {name}(const double *x, double *to)\n{{',
                          '  int refused = 0;', *(f'  {line}' for line in (*unused, *lines)),
                          '  return refused;', '}', ''])
