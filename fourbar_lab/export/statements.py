# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps of a trace as statements of C or JavaScript.

One statement an operation, so that C contracts none.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from math import isfinite
import re
from typing import NamedTuple

from fourbar_ros.numerics.number_types import Function
from fourbar_ros.numerics.trace import flat, Step, Trace

_OF_BOTH = {'add': '{} + {}', 'sub': '{} - {}', 'mul': '{} * {}', 'truediv': '{} / {}',
            'neg': '-{}', 'gt': '{} > {}', 'lt': '{} < {}'}
# operations that refuse an input by their last argument, as floats of Python do: its test in C
JUDGED = {'sqrt': '{} < 0.0', 'truediv': '{} == 0.0'}
ALL_JUDGED = JUDGED | {'sin': 'is_infinite({})', 'cos': 'is_infinite({})'}
_OF_LISTS = ('exact_sum', 'power_of_two')
_SNIPPETS = {'pow': 'power', 'hypot': 'hypot', 'exact_sum': 'exact_sum',
             'power_of_two': 'power_of_two'}


@cache
def snippet(file: str, name: str = '') -> str:
    """Return a named text of a .c or .js file of this package, or the text above all names."""
    text = (files(__package__) / file.rpartition('.')[2] / file).read_text(encoding='utf-8')
    first, *named = re.split(r'(?m)^// --- (\w+)\n', text)
    return {'': first, **dict(zip(named[::2], named[1::2]))}[name]


def filled(text: str, words: Mapping[str, object]) -> str:
    """Return a text with these words replaced by their meanings, which are left as they are."""
    return re.sub('|'.join(map(re.escape, words)), lambda match: str(words[match[0]]), text)


def lines_of(texts: Iterable[str]) -> str:
    return ''.join([f'  {text}\n' for text in texts])


class Language(NamedTuple):
    """How a language writes the statements; operations without a form are calls of their name."""

    forms: Mapping[str, str]        # {operation: its text}
    double: str                     # how the definition of a number begins, of a truth
    truth: str
    of_list: Sequence[str]          # the statements of an operation of many numbers
    refusal: str                    # of the inputs, by a test
    nan: str
    infinity: str

    def literal(self, value: float) -> str:
        """Return a number as the language reads it, to the last bit."""
        if value != value:
            return self.nan
        text = repr(float(value)) if isfinite(value) else f'{"-" * (value < 0)}{self.infinity}'
        return f'({text})' if text.startswith('-') else text


C = Language(
    _OF_BOTH | {'pow': 'power({}, {})', 'hypot': 'hypot_of({}, {})'}, 'const double', 'const int',
    ('double {name};', '{{ const double terms[] = {{{terms}}}; '
                       '{name} = {operation}({count}, terms); }}'),
    'refused |= {};', 'NAN', 'HUGE_VAL')
JS = Language(
    _OF_BOTH | {'pow': 'power({}, {})', 'hypot': 'hypot({}, {})', 'fabs': 'Math.abs({})',
                **{name: f'Math.{name}({{}})' for name in ('sin', 'cos', 'sqrt')},
                'atan2': 'Math.atan2({}, {})'}, 'const', 'const',
    ('const {name} = {operation}({terms});',), 'if ({}) return refuse(to);', 'NaN', 'Infinity')
literal = C.literal


class Texts:
    """The text of the result of each step: a literal, what follows from parameters, a variable."""

    # parameters: {index of a datum that can change: its text}; data: all data. Called with an
    # index it gives the text in statements that vary with the inputs. What these need of
    # parameters alone is computed once, and kept as k[0], k[1], ...

    def __init__(self, trace: Trace, data: Sequence[float], parameters: Mapping[int, str],
                 language: Language) -> None:
        self.trace, self.kept = trace, dict[int, int]()
        self._computed = set[int]()
        tuned = dict(parameters)
        for index, step in enumerate(trace.steps):
            if not (step.is_given or index in trace.varies) and tuned.keys() & step.arguments:
                self._computed.add(index)
                tuned[index] = f'd{index}'
        self._tuned = tuned.keys()
        # the rest of what no input changes are numbers of this scene
        self._texts = {index: language.literal(value) for index, value
                       in enumerate(trace.constants(data)) if value is not None} | tuned

    def __call__(self, index: int) -> str:
        """Return the text of the result of a step in statements that vary with the inputs."""
        if index in self.trace.varies:
            return f'{"x" if index < self.trace.count else "v"}{index}'
        if index not in self._tuned:
            return self._texts[index]
        return f'k[{self.kept.setdefault(index, len(self.kept))}]'

    def preparation(self, writer: Statements) -> list[str]:
        """Return the definitions, from parameters alone, of all that was asked for so far."""
        return [line for index in self.trace.needed(self.kept) if index in self._computed
                for line in writer.define(f'd{index}', self.trace.steps[index], [
                    self._texts[i] for i in self.trace.steps[index].arguments])]

    @property
    def prepared(self) -> list[str]:
        """Return the texts of k[0], k[1], ... after the preparation."""
        return [self._texts[index] for index in self.kept]


class Statements:
    """Writes statements, and keeps the texts, sizes and functions that these call."""

    def __init__(self, language: Language = C) -> None:
        self.language = language
        self.used = set[str]()              # names of texts of this package
        self.most_terms = 0                 # of a sum
        self.called: list[Function] = []    # functions of Python: the i-th is ``called_i``

    def lines(self, trace: Trace, needed: Iterable[int], refusing: Iterable[int],
              name_of: Callable[[int], str], refused: Mapping[str, str] = JUDGED) -> list[str]:
        """Return the statements of all that varies with the inputs, in order."""
        # needed: indices of steps whose results are wanted; refusing: indices of steps that refuse
        # some inputs, wanted or not; name_of gives the name of the result of a step; refused is
        # {operation: test of its last argument that refuses the inputs}.
        lines, needed = list[str](), set(needed)
        for index in sorted(trace.varies & {*needed, *refusing}):
            step = trace.steps[index]
            if index in needed and not step.is_given:
                lines += self.define(f'v{index}', step, [name_of(i) for i in step.arguments],
                                     True, step.arguments[0] in trace.varies)
            if step.operation in refused:
                last = name_of(step.arguments[-1])
                refusal = self.language.refusal.format(refused[step.operation].format(last))
                # a number of the scene refuses nothing, unless it is zero
                if (last[0] in 'vxk' or last == '0.0') and refusal not in lines:
                    lines.append(refusal)
        return lines

    def define(self, name: str, step: Step, operands: Sequence[str], is_flag: bool = False,
               is_chosen_by_flag: bool = False) -> list[str]:
        """Return the definition of the result of a step; ``operands``: names of its arguments."""
        # is_flag: the result of a comparison is a truth, not 1.0 or 0.0; is_chosen_by_flag: the
        # condition of a choice is such a truth.
        operation, language = step.operation, self.language
        kind, forms = language.double, language.forms
        if operation in _SNIPPETS:
            self.used.add(_SNIPPETS[operation])
        if operation in _OF_LISTS:
            self.most_terms = max(self.most_terms, len(operands))
            return [text.format(name=name, operation=operation, terms=', '.join(operands),
                                count=len(operands)) for text in language.of_list]
        if operation == 'where':
            condition = operands[0] if is_chosen_by_flag else f'{operands[0]} > 0.0'
            text = f'{condition} ? {operands[1]} : {operands[2]}'
        elif operation == 'call':
            if step.value not in self.called:
                self.called.append(step.value)
            text = f'called_{self.called.index(step.value)}({operands[0]})'
        else:
            call = f'{operation}({", ".join(operands)})'
            text = forms[operation].format(*operands) if operation in forms else call
        if operation in ('gt', 'lt') and is_flag:
            kind = language.truth
        elif operation in ('gt', 'lt'):
            text = f'{text} ? 1.0 : 0.0'
        return [f'{kind} {name} = {text};']

    def function(self, name: str, trace: Trace) -> str:
        """Return the C function of a trace without data: inputs x to results, flat."""
        # It returns whether it refuses its inputs, as Python's floats do: a root of a negative
        # number, the sine of an infinite one, a division by zero.
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
