# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The torque-driven step of a scene as C, with the bits of the node's.

The formulas of a step are written from the traces of which the node's are written too. The
decisions between them (length of steps, which coordinate, limits) are C of this package.
"""
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from math import tau
from typing import Any

from fourbar_lab.export.model import GeneratedModel, Named, NotGenerated, struct_of
from fourbar_lab.export.statements import filled, literal, snippet, Statements
from fourbar_ros.dynamics import equation, node_step, rosenbrock, sources
from fourbar_ros.dynamics.rosenbrock import StepFormulas
from fourbar_ros.mechanisms.elements import LinkAngle, PositionForce, TableForce
from fourbar_ros.numerics.arguments import quantities_of
from fourbar_ros.numerics.number_types import Function, NumberType
from fourbar_ros.numerics.trace import Trace
from fourbar_ros.scene.topics import TORQUE

CHECKED = 3            # steps of the self-check
STATUS_OF_DRIVE = ('ok', 'silent', 'out_of_budget', 'at_limit', 'not_finite')  # as DriveState
TEXTS = {
    'step': ('s', 'length of the step'), 'command': ('N m', 'torque given from outside'),
    'position': ('rad', 'of the input'), 'velocity': ('rad/s', 'of the input'),
    'acceleration': ('rad/s^2', 'of the input'),
    'twist': ('rad', 'of the shaft: motor less input'),
    'motor_position': ('rad', 'of the motor behind its gear'),
    'motor_velocity': ('rad/s', 'of the motor behind its gear'),
    'motor_torque': ('N m', 'of the motor behind its gear'), 'torque': ('N m', 'on the input'),
    'current': ('A', 'of a DC motor'), 'speed_error_integral': ('rad', 'of a controller'),
    'evaluations': ('', 'of the equation of motion')}
# C texts for markers of c/drive.c; a marker that begins with a blank is replaced with that blank
TAKE_PLACE = """  if (from->place[0] > 0.0) {
    at->phase = (int)from->place[0] - 1;
    memcpy(at->x, from->place + 1, sizeof at->x);
  }
"""
GIVE_PLACE = """  to->mode = MODES[is_input ? at->phase
                   : NEXT[at->phase][is_known && known[OTHER_RATIO] > 0.0]];
  to->place[0] = 1.0 + at->phase;
  memcpy(to->place + 1, at->x, sizeof at->x);
"""
OF_SLIDES = {'rad': 'm', 'rad/s': 'm/s', 'rad/s^2': 'm/s^2', 'N m': 'N'}


class DriveCode:
    """The C text of the step of a scene that is driven by torque; NotGenerated of some."""

    # writer: of the functions that the step calls

    def __init__(self, model: GeneratedModel, writer: Statements) -> None:
        scene = model.scene
        assert scene.dynamics is not None
        self._model, self._scene, self._writer = model, scene, writer
        self.takes_torque = scene.drive.source == TORQUE.name
        self._mover = scene.mover
        self._system, self._drive = self._mover.system, scene.dynamics.drive
        self._source: sources.Law = self._drive.source
        # a phase of the motion: its coordinate and assembly mode -> formulas; the first begins
        self._phases = self._mover.formulas
        if self._mover.passes and not all(self._mover.taking_over.values()):
            raise NotGenerated(f'{model.name}: motion by torque of a change point with toggles')
        if scene.acting:
            raise NotGenerated(f'{model.name}: motion by torque under what acts by topic')
        self.modes = self._mover.modes
        self._argument, self._passed = ((', double torque', ', torque') if self.takes_torque
                                        else ('', ''))
        writer.used |= {'power'}
        self._tables: list[PositionForce] = self._system.equation.tables
        self._functions = [
            *self._functions_by_phase('place', StepFormulas.make_linearization,
                                      rosenbrock.AT_STATE),
            *self._functions_by_phase('attempt', StepFormulas.make_attempt, rosenbrock.OF_STEP),
            *self._functions_by_phase('euler', StepFormulas.make_euler, rosenbrock.OF_STEP)]
        if self._tables:
            self._functions += self._functions_by_phase(
                'places_of', StepFormulas.make_table_positions, 1)

    def _functions_by_phase(self, name: str,
                            make_formula: Callable[[StepFormulas, NumberType], Function],
                            inputs: int) -> list[str]:
        """Return a C function NAME_i of each phase, and NAME, which calls that of a phase."""
        # of a formula of so many inputs; they return whether an input is out of its domain
        functions, cases = [], []
        for i, formulas in enumerate(self._phases.values()):
            trace = Trace(lambda n, _: make_formula(formulas, n),   # noqa: B023  # called at once
                          inputs)
            functions.append(self._writer.function(f'{name}_{i}',
                                                   trace.simplified(trace.literals())))
            condition = f'if (phase == {i}) ' if i + 1 < len(self._phases) else ''
            cases.append(f'  {condition}return {name}_{i}(x, to);')
        if len(cases) == 1:
            cases.insert(0, '  (void)phase;')
        return [*functions, f'static int {name}(int phase, const double *x, double *to)\n{{',
                *cases, '}', '']

    # --- C text ---------------------------------------------------------------------------------

    @cached_property
    def fields(self) -> list[Named]:
        is_slide = self._system.mechanism.is_driven_by_slide
        texts = TEXTS | ({'mode': ('', 'assembly mode')} if self.modes else {})
        return [Named(name, name, OF_SLIDES.get(unit, unit) if is_slide else unit, text, 0.0, i)
                for i, (name, (unit, text)) in enumerate(texts.items())]

    @cached_property
    def command(self) -> Named | None:
        """Return the number that the source takes at each step; None: it takes none."""
        # A command without a C field is the argument torque.
        source, is_slide = self._source, self._system.mechanism.is_driven_by_slide
        if self.takes_torque:
            return Named('torque', '', self.fields[1].unit, 'of the source, during the next step',
                         0.0, 0)
        if not source.command:
            return None
        quantity = next(quantity for name, _, quantity in quantities_of(source)
                        if name == source.command)
        return Named(f'motor.{source.command}', f'motor_{source.command}',
                     quantity.unit.rpartition(' or ')[2] if is_slide else
                     quantity.unit.partition(' or ')[0], f'{quantity.text}, during the next step',
                     getattr(source, source.command), 0)

    @property
    def defined(self) -> set[str]:
        """Return the fields of a DriveState that this drive has, besides its motion."""
        names = {'torque', 'motor_torque', 'evaluations'}
        if self._source.start:
            names.add(self._source.state_field)
        if self.modes:
            names.add('mode')
        if self._drive.shaft:
            names |= {'twist', 'motor_position', 'motor_velocity'}
        return names

    def declarations(self) -> str:
        """Return the text of the header: the struct of the drive, its statuses and functions."""
        name, drive, command = self._model.name, self._scene.drive, self.command
        fields = list(self.fields)
        if self.modes:
            fields.append(Named('', 'place[6]', '', 'near a toggle, where position and velocity '
                                'do not tell it', 0.0, 0))
        if command and command.field:
            fields.append(command._replace(text=f'{command.text}: may be set anew'))
        return filled(snippet('drive.c', 'header'), {
            'BUDGET': drive.budget, 'STEP': literal(1.0 / drive.rate), 'NAME': name,
            'STATUS': ',\n'.join(f'  {name}_drive_{text} = {i}'
                                 for i, text in enumerate(STATUS_OF_DRIVE)),
            'STRUCT': '\n'.join(struct_of(f'{name}_drive', fields, 'As fourbar_msgs/DriveState; '
                                          'NaN: it has none.')),
            ' GIVEN': '; torque: that of the source during it' if self.takes_torque else '',
            ' AND_MODE': ', mode' if self.modes else '', ' ARGUMENT': self._argument})

    def source(self) -> list[str]:
        """Return the text behind the functions of motion and loads."""
        # current or integral: what the source keeps from step to step
        kept, command = self._source.state_field if self._source.start else '', self.command
        position, velocity = self._system.start[:2]
        starts = [f'  drive->position = {literal(position)};',
                  f'  drive->velocity = drive->motor_velocity = {literal(velocity)};']
        if kept:
            starts.append(f'  drive->{kept} = {literal(self._source.start[0])};')
        if self.modes:
            starts.append(f'  drive->mode = {literal(self._system.mechanism.mode)};')
        argument, limit = '0.0' if command is None else 'torque', self._scene.drive.torque_limit
        if self.takes_torque and limit == limit:        # as node_step.limited; NaN stays
            argument = (f'torque > {literal(limit)} ? {literal(limit)} : '
                        f'torque < {literal(-limit)} ? {literal(-limit)} : torque')
        if command and command.field:
            argument = f'drive->{command.field}'
            starts.append(f'  {argument} = {literal(command.value)};')
        text = filled(snippet('drive.c'), {
            ' ARGUMENT': self._argument, ' PASSED': self._passed, 'GIVEN_COMMAND': argument,
            'OWN_FIELD': f'from->{kept}' if kept else '0.0',
            'MODE_FIELD': 'from->mode' if self.modes else '0.0',
            '  GIVE_OWN\n': f'  to->{kept} = own;\n' if kept else '',
            '  TAKE_PLACE\n': TAKE_PLACE if self.modes else '',
            '  GIVE_PLACE\n': GIVE_PLACE if self.modes else '',
            '  FORGET_PLACE\n': '  drive->place[0] = 0.0;\n' if self.modes else '',
            'STARTS': '\n'.join(starts), 'NAME': self._model.name})
        return [*self._constants(), *self._functions, *self._of_tables(), snippet('step.c'), text]

    def self_check(self) -> str:
        """Return the C text that compares the state after some steps without torque with ours."""
        # ' PASSED' in the text is the argument of a torque, with the blank before it.
        mover, step = self._mover, 1.0 / self._scene.drive.rate
        values = mover.start()
        for _ in range(CHECKED):
            _, values = mover.next(values, step)
        return filled(snippet('drive.c', 'self_check'), {
            'EXPECTED': _list(values), 'NAME': self._model.name, 'COUNT': CHECKED,
            'STEP': literal(step), 'NUMBERS': len(values),
            ' PASSED': ', 0.0' if self.takes_torque else ''})

    def _constants(self) -> list[str]:
        """Return the C constants of this drive: phases, their modes and successors, tolerances."""
        mover, middle = self._mover, literal(self._system.coordinates.middle)
        low, high = self._system.stroke
        index_of = {phase: i for i, phase in enumerate(self._phases)}
        successors = [', '.join(str(index_of[phase]) for phase in mover.taking_over[before])
                      or '0, 0' for before in self._phases]
        flags = {'PHASES': len(self._phases), 'TABLES': len(self._tables),
                 'PASSES': int(bool(self.modes)), 'BUDGET': mover.budget,
                 'HAS_SHAFT': int(self._drive.shaft is not None),
                 'HAS_LIMITS': int(self._system.has_limits),
                 'TAKES_TORQUE': int(self.takes_torque), 'HALVINGS': node_step.BISECTIONS,
                 'OF_PLACE': node_step.LINEARIZE, 'OF_ATTEMPT': node_step.ATTEMPT,
                 'OF_EULER': node_step.EULER}
        is_turned = self.modes and not self._system.mechanism.is_driven_by_slide
        return [*(f'enum {{ {name} = {value} }};' for name, value in flags.items()),
                _array('int IS_INPUT[]', (int(phase.is_input) for phase in self._phases)),
                '/* The mode of each phase; the phase that takes over where it falls or grows. */',
                _array('double MODES[]', (float(phase.mode) for phase in self._phases)),
                _array('int NEXT[][2]', (f'{{{pair}}}' for pair in successors)),
                *_definitions({name: getattr(node_step, name) for name in (
                    'SMALLEST', 'DEEPEST', 'SHORTER', 'LATE', 'LEAST')}
                    | {'LOW': low, 'HIGH': high}), '',
                '/* An input, known but for whole turns, in the range of this motion. */',
                'static double continuous(double value)\n{',
                '  return value;' if not is_turned else
                f'  return {middle} + remainder(value - {middle}, {literal(tau)});', '}', '']

    def _of_tables(self) -> list[str]:
        """Return the C arrays of all force tables, by which a step ends at their points."""
        tables = self._tables
        if not tables:
            return [snippet('tables.c', 'no_tables')]
        reaches = (equation.REACH * phase.equation.coordinate.input_unit for phase in self._phases)
        return [*(_array(f'double ENDS_{i}[]', force.value.ends)
                  for i, force in enumerate(tables)),
                _array('double *const ENDS[]', (f'ENDS_{i}' for i in range(len(tables)))),
                _array('int COUNTS[]', (len(force.value.ends) for force in tables)),
                _array('int IS_ANGLE[]', (int(isinstance(force.over, LinkAngle))
                                          for force in tables)),
                _array('double REACHES[]', reaches),
                *_definitions({'AT_PLACE': node_step.NEAREST,
                               'LEAST_PART': node_step.SHORTEST, 'WHOLE_TURN': tau}), '',
                '/* A place within a table, turns and periods taken off. */',
                'static double base_of(int table, double place)\n{', '  (void)table;',
                *(f'  if (table == {i}) return {_base(force.value)};'
                  for i, force in enumerate(tables) if _base(force.value)),
                '  return place;', '}', '', snippet('tables.c', 'tables')]


def tables(forces: Sequence[Any], name: str) -> list[str]:
    """Return the functions of forces over a position, from their tables."""
    if any(not isinstance(force, TableForce) for force in forces):
        raise NotGenerated(f'{name}: a force that is a Python function')
    needed = {'wrapped': any(force.table.is_periodic for force in forces), 'table': bool(forces)}
    functions = [snippet('functions.c', name) for name, is_needed in needed.items() if is_needed]
    for i, force in enumerate(forces):
        table = force.table
        turned = [f'  place = {text};'] if (text := _base(force)) else []
        functions += [
            f'static double called_{i}(double place)\n{{',
            '  ' + _array('double starts[]', table.starts),
            '  static const double pieces[][5] = {',
            ',\n'.join(f'    {{{_list(row)}}}' for row in table.pieces), '  };', *turned,
            f'  return cubic(pieces[piece_at(place, starts, {len(table.starts)})], place);', '}',
            '']
    return functions


def _base(force: TableForce) -> str:
    """Return the C text that takes whole turns or periods off a position; '': there are none."""
    if force.middle is not None:
        middle = literal(force.middle)
        return (f'fabs(place - {middle}) <= {literal(0.5 * tau)} ? place : '
                f'{middle} + remainder(place - {middle}, {literal(tau)})')
    if force.table.is_periodic:
        return f'wrapped(place, {literal(force.table.places[0])}, {literal(force.table.span)})'
    return ''


def _definitions(constants: dict[str, float]) -> list[str]:
    return [f'static const double {name} = {literal(value)};'
            for name, value in constants.items()]


def _list(values: Iterable[float]) -> str:
    return ', '.join(map(literal, values))


def _array(name: str, values: Iterable[float | str]) -> str:
    texts = (literal(value) if isinstance(value, float) else str(value) for value in values)
    return f'static const {name} = {{{", ".join(texts)}}};'
