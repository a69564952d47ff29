# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A model as C99: one header, one source; one statement per operation, so none is contracted.

``NAME_prepare`` computes once all that depends on parameters alone.
"""
from __future__ import annotations

from math import inf
from textwrap import wrap

from fourbar_lab.export.drive import DriveCode, tables
from fourbar_lab.export.model import GeneratedModel, struct_of
from fourbar_lab.export.statements import filled, lines_of, literal, snippet, Statements
from fourbar_ros import __version__
from fourbar_ros.mechanisms.mechanism import Mechanism

FLAGS = '-std=c99 -O2'
STATUS = ('ok', 'out_of_range', 'invalid_input', 'toggle', 'rates_unknown')    # as in messages
OF_FRICTION = {7: 'locked'}      # and of mechanisms that have it


# The end of judged() in judge.c: loads are NaN, and the motion is not, where joints lock.
OVERFLOWS = '  return is_finite(load) && is_infinite(condition) ? 3 : 2;'
LOCKS = f'  if (load != load && is_finite(motion)) return {min(OF_FRICTION)};\n{OVERFLOWS}'


def statuses_of(mechanism: Mechanism) -> dict[int, str]:
    """Return {status that the code of a mechanism gives: its name}."""
    return {**dict(enumerate(STATUS)), **(OF_FRICTION if mechanism.friction else {})}


class Code:
    """Header and source of a model, whose values are named by the indices of their steps."""

    def __init__(self, model: GeneratedModel) -> None:
        """Write the formulas, once of motion alone (key False), once with loads (key True)."""
        trace = model.trace
        self.model, self.name, self.writer = model, model.name, Statements()
        self.kept: dict[int, int] = {}       # steps of prepared values -> indices in k of C
        # the C expression of each step that no input changes: a number of this scene, ...
        self._texts = {index: literal(value) for index, value
                       in enumerate(trace.constants(model.data)) if value is not None}
        # ... or what depends on tunable parameters: a field, or a result of such fields
        tuned = {trace.count + entry.slot: f'from->{entry.field}' for entry in model.tunable}
        computed = set[int]()
        for index, step in enumerate(trace.steps):
            if not (step.is_given or index in trace.varies) and tuned.keys() & step.arguments:
                computed.add(index)
                tuned[index] = f'd{index}'
        self._texts |= tuned
        self._tuned = tuned.keys()
        self.lines = {with_loads: self.writer.lines(
            trace, model.needed(with_loads), model.refusing(with_loads), self._name_of)
            for with_loads in ((False, True) if model.loads else (False,))}
        self.operations = {with_loads: sum(text.startswith('const') for text in lines)
                           for with_loads, lines in self.lines.items()}
        self._functions = [self._function(with_loads) for with_loads in self.lines]
        self.preparation = list[str]()       # what all statements above need of parameters alone
        for index in trace.needed(self.kept):
            if index in computed:
                step = trace.steps[index]
                self.preparation += self.writer.define(f'd{index}', step,
                                                       [self._texts[i] for i in step.arguments])
        self.preparation += [f'made->k[{i}] = {self._texts[index]};'
                             for index, i in self.kept.items()]
        self.drive = DriveCode(model, self.writer) if model.moves_by_torque else None

    def _name_of(self, index: int) -> str:
        """Return the C name of the result of a step in statements that vary with the inputs."""
        if index in self.model.trace.varies:
            return f'{"x" if index < self.model.trace.count else "v"}{index}'
        if index not in self._tuned:
            return self._texts[index]
        return f'k[{self.kept.setdefault(index, len(self.kept))}]'

    # --- header ---------------------------------------------------------------------------------

    def header(self) -> str:
        """Return the text of NAME.h."""
        name, model = self.name, self.model
        records = [('input', model.inputs, 'What drives it.'),
                   ('parameters', model.tunable, 'What can be changed at run time.'),
                   ('motion', model.motion, 'Motion; fields as in Python.')]
        if model.loads:
            records.append(('loads', model.loads, 'Loads; fields as in Python.'))
        loads = filled(snippet('model.c', 'header_of_loads'), {
            'STEP': self._signature(True)})
        modes = filled(snippet('model.c', 'header_of_modes'), {'NAME': name})
        return filled(snippet('model.c', 'header'), {
            'ABOUT': '\n'.join(self._about()), 'GUARD': name.upper(),
            'STATUS': ',\n'.join(f'  {name}_{text} = {i}'
                                 for i, text in statuses_of(model.mechanism).items()),
            'RECORDS': '\n'.join(text for which, named, about in records
                                 for text in struct_of(f'{name}_{which}', named, about)),
            'KEPT': max(1, len(self.kept)), 'MOTION_AT': self._signature(False),
            'OF_BOTH': loads if model.loads else '',
            'SET_MODE': modes if model.signs else '',
            'DRIVE': self.drive.declarations() if self.drive else '',
            'NAME': name})

    def _about(self) -> list[str]:
        """Return the comment at the head of both files: results, costs, zeros left out."""
        model, scene = self.model, self.model.scene
        mechanism = model.mechanism
        text = (f'{self.name}: {mechanism.description}, mode {mechanism.mode}. Generated by '
                f'fourbar_ros {__version__} from the scene {model.name}; not to be edited.')
        both = self.operations.get(True)
        count = (f'Motion takes {self.operations[False]} operations'
                 + (f', motion and loads {both}' if both else '')
                 + '; they are one line without loops, so the worst case is every case. '
                 'No allocation, no global, no recursion; libm alone.')
        signs = ('SI units. Angles from x, counter-clockwise positive, [rad]; x from O1 to O4 or '
                 'along the guide, y up. Fij, fij: force of link i on link j, along x and y; '
                 'torques and couples counter-clockwise. docs/conventions.md has all signs.')
        bits = ('The bits are those of Python with the same libm, if no operations are '
                f'contracted or reordered: {FLAGS} keeps them, -ffp-contract=off elsewhere, '
                '-ffast-math loses them.')
        fixed = ('Parameters are independent numbers here: a new length leaves masses, stroke and '
                 f'the limits that tell {STATUS[3]} from {STATUS[1]} as they are.')
        zeros = [name for i, (name, _) in enumerate(model.names)
                 if name and model.trace.steps[3 + i].operation == 'constant']
        left_out = f'Left out, as zero in the scene: {", ".join(zeros)}.' if zeros else ''
        loads = (f'No loads: {scene.linkage.why_no_loads}.' if not model.mechanism.bodies else '')
        return ['/*', *(f' * {line}' for part in (text, count, signs, bits, fixed, left_out,
                                                  loads) if part
                        for line in wrap(part, 92)), ' */']

    def _signature(self, with_loads: bool) -> str:
        name = self.name
        which, loads = ('step', f', {name}_loads *loads') if with_loads else ('motion_at', '')
        return (f'{name}_status {name}_{which}(const {name}_constants *with, '
                f'const {name}_input *input,\n    {name}_motion *motion{loads})')

    # --- source ---------------------------------------------------------------------------------

    def source(self) -> str:
        """Return the text of NAME.c."""
        name, model = self.name, self.model
        defaults = [f'to->{entry.field} = {literal(entry.value)};' for entry in model.tunable]
        unused = ['(void)from;'] if not (model.tunable and self.preparation) else []
        bounds = [f'from->{entry.field} {bound} 0.0' for entry in model.tunable
                  if (bound := model.bound_of(entry.name))]
        count = max(1, len(self.kept))
        preparation = [*unused, *(self.preparation or ['made->k[0] = 0.0;'])]
        if bounds:
            are_good = '\n        && '.join(bounds)
            preparation = ['int i;', *preparation, f'if (!({are_good}))\n    '
                           f'for (i = 0; i < {count}; ++i) made->k[i] = NAN;']
        fields = {entry.slot: entry.field for entry in model.tunable}
        signs = [f'to->{fields[index]} = mode == {literal(second)} ? '
                 f'{literal(sign_of[second])} : {literal(sign_of[first])};'
                 for index, sign_of in model.signs.items() for first, second, *_ in [sign_of]]
        set_mode = filled(snippet('model.c', 'set_mode'), {'NAME': name, 'SIGNS': lines_of(signs)})
        functions = [*([set_mode] if signs else []), *self._guards(), *self._functions,
                     *(self.drive.source() if self.drive else ()), self._self_check()]
        used = sorted(self.writer.used)
        runtime = [*([f'enum {{ MOST_TERMS = {self.writer.most_terms} }};', '']
                     if 'exact_sum' in used else []),
                   *(snippet('functions.c', function) for function in used),
                   *tables(self.writer.called, name)]
        # pragmas of model.c: gcc's vectorizer contracts a * b + c beside a * b - c all the same
        return filled(snippet('model.c', 'source'), {
            'ABOUT': '\n'.join(self._about()), 'NAME': name,
            'RUNTIME': ''.join(f'{text}\n' for text in runtime),
            'DEFAULTS': lines_of(defaults or ['to->none = 0.0;']),
            'PREPARATION': lines_of(preparation), 'FUNCTIONS\n': '\n'.join(functions)})

    def _guards(self) -> list[str]:
        """Return the functions that judge inputs and results; the same for all models."""
        model, mechanism = self.model, self.model.mechanism
        low, high = mechanism.stroke or (-inf, inf)
        reach = [f'x >= {literal(low)} && x <= {literal(high)}'] if mechanism.stroke else []
        near = 2.0**-17 * mechanism.input_unit
        # of x from a limit: of angles the short way round
        distance = ('fabs(x - {})' if mechanism.is_driven_by_slide
                    else 'fabs(remainder(x - {}, 6.283185307179586))')
        reach += [f'!({distance.format(literal(flat))} <= {literal(near)})'
                  for flat in sorted(set(mechanism.flat_limits))]
        toggles = (mechanism.input_ranges if mechanism.stroke is None
                   else mechanism.closing_ranges)
        ends = sorted({end for bounds in toggles for end in bounds})
        limits = [f'{distance.format(literal(end))} <= near' for end in ends]
        summed = sum(entry.name in mechanism.MOTION._fields for entry in model.motion)
        depends = ', '.join(map(str, model.depends))
        return [f'enum {{ MOTIONS = {len(model.motion)}, SUMMED = {summed} }};', '',
                f'static const unsigned char depends[] = {{{depends}}};', '',
                'static int reaches(double x)\n{', '  (void)x;',
                f'  return {" && ".join(reach) or "1"};', '}', '',
                'static int is_at_limit(double x)\n{',
                '  const double near = 4.0 * DBL_EPSILON * fabs(x);', '  (void)near;',
                f'  return {" || ".join(limits) or "0"};', '}', '',
                snippet('judge.c').replace(OVERFLOWS, LOCKS if mechanism.friction else OVERFLOWS)]

    def _function(self, with_loads: bool) -> str:
        """
        Return the C text of NAME_step or NAME_motion_at around its formula, a static function.

        It is called for finite inputs alone. Without an answer the inputs are copied and all
        other results are NaN. ``*closes`` gets the transmission angle: NaN out of range;
        ``*condition`` is infinite at a flat position.
        """
        model, of = self.model, self._name_of
        loads = model.loads if with_loads else ()
        results = *model.motion, *loads
        statements = [
            *self.lines[with_loads],
            *(f'values[{i}] = {of(entry.slot)};' for i, entry in enumerate(results)),
            f'*closes = {of(model.index_of("transmission_angle"))};',
            f'*condition = {of(model.index_of("condition"))};',
            *(f'if ({of(index)} < 0.0) *closes = NAN;' for index in model.roots_left_out)]
        x0, x1, x2 = (entry.field for entry in model.inputs)
        field_of = {entry.name: entry.field for entry in model.inputs}
        inputs = [f'  values[{i}] = input->{field_of[entry.name]};'
                  for i, entry in enumerate(model.motion) if entry.name in field_of]
        copy = ['memcpy(loads, values + MOTIONS, sizeof *loads);'] if loads else []
        return filled(snippet('model.c', 'function'), {
            'WHICH': 'step' if with_loads else 'motion', 'SIGNATURE': self._signature(with_loads),
            'RESULTS': len(results), 'LOADS': len(loads), 'NAME': self.name,
            'X0': x0, 'X1': x1, 'X2': x2, 'INVALID_INPUT': STATUS.index('invalid_input'),
            'OVERFLOWING': ('' if model.mechanism.is_driven_by_slide
                            else f' * {model.mechanism.overflowing!r}'),
            'INPUTS': lines_of(inputs), 'COPY': lines_of(copy),
            'STATEMENTS': lines_of(statements)})

    def _self_check(self) -> str:
        """
        Return the C text of NAME_self_check: it counts results whose bits differ from Python's.

        Python computes the results of one sample now; the text contains them as literals.
        """
        name, model = self.name, self.model
        inputs, result_of = model.sample()
        expected = {record: [result_of[entry.name] for entry in entries] for record, entries
                    in (('motion', model.motion), ('loads', model.loads)) if entries}
        compared = [f'differ += differing(&{record}, {record}_of_python, {len(values)});'
                    for record, values in expected.items()]
        return filled(snippet('model.c', 'self_check'), {
            'EXPECTED': lines_of(
                f'static const double {record}_of_python[] = {{'
                + '\n    '.join(['', *wrap(', '.join(map(literal, values)), 92)]) + '};'
                for record, values in expected.items()),
            'RESULTS': lines_of(f'{name}_{record} {record};' for record in expected),
            'INPUTS': lines_of(f'input.{entry.field} = {literal(value)};'
                               for entry, value in zip(model.inputs, inputs)),
            'CALL': 'step' if model.loads else 'motion_at',
            'POINTERS': ', &'.join(expected),
            'COMPARED': lines_of(compared) + (self.drive.self_check() if self.drive else ''),
            'NAME': name})
