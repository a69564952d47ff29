# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The content of generated code: a scene's trace, with name, unit and text of each number."""
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
import re
from typing import Any, NamedTuple

from fourbar_lab.export.statements import JUDGED
from fourbar_ros import Base, FourBarError, InvalidParameter, Mechanism
from fourbar_ros.errors import one_of
from fourbar_ros.mechanisms.curves import PointMotion
from fourbar_ros.mechanisms.points import point_in, point_motion, with_any_lengths
from fourbar_ros.mechanisms.quantities import fields_of
from fourbar_ros.numerics.number_types import Function, numbers_of, NumberType
from fourbar_ros.numerics.trace import flat, REFUSING, Trace
from fourbar_ros.scene.elements import element_names, group_in
from fourbar_ros.scene.parameters import find_parameter, of_name
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import BASE

UNITS_OF_BODIES = {'mass': 'kg', 'inertia': 'kg m^2', 'force_x': 'N', 'force_y': 'N',
                   'couple': 'N m'}
UNITS_OF_POINTS = dict(zip(PointMotion._fields, ('m', 'm', 'm/s', 'm/s', 'm/s^2', 'm/s^2', 'm/s',
                                                 'm/s^2', 'm/s^2', '1/m')))
_WORDS = """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl const
    constexpr continue decltype default delete do double else enum explicit export extern false
    float for friend goto if inline int long mutable namespace new noexcept not not_eq nullptr
    operator or or_eq private protected public register reinterpret_cast requires restrict return
    short signed sizeof static static_assert static_cast struct switch template this thread_local
    throw true try typedef typeid typename typeof union unsigned using virtual void volatile
    wchar_t while xor xor_eq linux unix errno NAN INFINITY NULL EOF"""
RESERVED = frozenset(_WORDS.split())
# beginnings of the parameters that formulas are without where they are 0 or infinite
ELEMENTS = 'springs.', 'torsion_springs.', 'friction.'


class NotGenerated(FourBarError):
    """A scene, or what is asked of it, cannot be generated; the message says why."""


class Named(NamedTuple):
    """A number of the generated code."""

    name: str       # as in Python: ``bodies.crank.mass``, ``theta4``, ``foot.x``
    field: str      # of a struct of C
    unit: str       # empty, as the text: none is known
    text: str
    value: float    # of a parameter: its value in the scene
    slot: int       # index of a parameter among the data of the trace, of a result among its steps


class WholeTrace(NamedTuple):
    """A trace of all results, and how many of its steps are before the end of some."""

    trace: Trace
    end_of_motion: int
    end_of_loads: int


@dataclass(frozen=True)
class GeneratedModel:
    """A scene prepared for generation; NotGenerated or InvalidParameter where it cannot be."""

    scene: Scene
    name: str                                   # a word in C: prefix of all names
    outputs: Sequence[str] | None = None        # names of the wanted results; None: all
    parameters: Sequence[str] | None = None     # names that can change at run time; None: all

    @cached_property
    def mechanism(self) -> Mechanism:
        return self.scene.linkage

    @cached_property
    def signs(self) -> dict[int, dict[int, float]]:
        """Return {index in the data: {mode: sign}} of the signs that change with the mode."""
        mechanism, modes = self.mechanism, tuple[int, ...]()
        if self.moves_by_torque:
            from fourbar_ros.dynamics.node_step import modes_of
            modes = modes_of(mechanism)
        rows = {mode: numbers_of(mechanism.in_mode(mode).constants) for mode in modes}
        return {index: dict(zip(rows, column)) for index, column in enumerate(zip(*rows.values()))
                if len(set(column)) > 1}

    @property
    def from_topics(self) -> set[str]:
        """Return the groups of parameters that a node has from topics: inputs here."""
        return {name if name == BASE.name else f'external.{name}' for name in self.scene.acting}

    @property
    def moves_by_torque(self) -> bool:
        return self.scene.dynamics is not None

    # --- its trace ------------------------------------------------------------------------------

    @cached_property
    def trace(self) -> Trace:
        """Return the trace of motion, loads and points, with the operations of ``step``."""
        whole, _, end_of_loads = self._whole
        of_mechanism = len(numbers_of(self.constants))
        lengths = {*range(len(self.mechanism.numbers_of_lengths)),
                   *range(of_mechanism, of_mechanism + len(self.named_points))}
        if not self._can_change_all and self._asked.isdisjoint(lengths) and not (
                whole.is_switched(self.data)):
            whole = whole.unswitched        # no length can change, to make or leave a change point
        if not self.mechanism.LEAVES_OUT_ZEROS:
            return whole
        # the node keeps the zero coordinates of points, which follow those of the mechanism
        of_mechanism += len(self.named_points)
        zeros = {whole.count + i: 0.0 for i, value in enumerate(self.data[:of_mechanism])
                 if value == 0.0 and i not in self._asked}
        return whole.simplified({**whole.literals(), **zeros}, end_of_loads) if zeros else whole

    @cached_property
    def _whole(self) -> WholeTrace:
        """Return the trace of motion, loads and points, whatever of it is wanted."""
        mechanism, ends = self.mechanism, list[int]()

        def make_formula(n: NumberType, data: Any) -> Function:
            constants, named_points, coordinates = data
            if named_points:
                from fourbar_ros.scene.machines import with_named_points  # few scenes have any
                values = dict(self.scene.values) | dict(zip(self.named_points, named_points))
                constants = constants._replace(lengths=with_named_points(
                    mechanism, values, n, constants.lengths))
            of_any_lengths = with_any_lengths(mechanism, constants.lengths)

            def formula(x: Any, rate: Any, acceleration: Any) -> Any:
                motion, loads = mechanism.motion_in(n, constants, x, rate, acceleration), ()
                ends.append(len(x.trace.steps))
                if mechanism.bodies:
                    loads = mechanism.loads_in(n, constants, motion)
                # of points the zeros stay, those of loads are left out: they share no step
                ends.append(x.trace.begin_apart())
                return tuple(motion), loads, [
                    point_in(n, of_any_lengths, motion, point.link, *along_across)
                    for point, along_across in zip(self.scene.points.values(), coordinates)]
            return formula

        return WholeTrace(Trace(make_formula, 3, self._tree), *ends)

    @property
    def _tree(self) -> tuple[Any, ...]:
        """Return constants, numbers of named points, and (along, across) of each point [m]."""
        return self.constants, tuple(self.named_points.values()), tuple([
            (point.along, point.across) for point in self.scene.points.values()])

    @cached_property
    def named_points(self) -> dict[str, float]:
        """Return {linkage.points.NAME.x: value [m]}: numbers of points on which dyads hang."""
        return {name: value for name, value in self.scene.values.items()
                if name.startswith('linkage.points.') and of_name(name).type == 'double'
                and value == value}

    @cached_property
    def constants(self) -> Any:
        constants = self.mechanism.constants
        return constants if self.mechanism.bodies else constants._replace(
            bodies=None, elements=(), friction=())

    @cached_property
    def data(self) -> list[float]:
        """Return the numbers of the data, in the order of the trace."""
        return [float(value) for value in numbers_of(self._tree)]

    # --- names ----------------------------------------------------------------------------------

    @cached_property
    def inputs(self) -> tuple[Named, ...]:
        coordinate = self.mechanism.input_coordinate
        texts = 'position of the input', 'its rate', 'its acceleration'
        return self._with_fields([Named(name, '', unit, text, 0.0, i) for i, (name, unit, text)
                                  in enumerate(zip(coordinate, coordinate.units, texts))])

    @cached_property
    def _asked(self) -> frozenset[int]:
        """Return the indices in the data of what is asked to change at run time; refuse others."""
        names = [name for name, _ in self.names]
        wanted, whole = self.parameters or (), self._whole.trace
        topics, used = self.from_topics, whole.needed(flat(whole.results))
        for name in wanted:
            if name not in names:
                raise InvalidParameter('parameters', name, one_of(filter(None, names), name))
            if name.startswith(ELEMENTS) and whole.count + names.index(name) not in used:
                raise InvalidParameter('parameters', name, 'no result depends on it: formulas are '
                                       'without what is 0 or infinite in the scene')
            if self.moves_by_torque and name.rpartition('.')[0] not in topics:
                raise NotGenerated(f'{self.name}: parameter {name} cannot be changed, as the '
                                   'motion by torque has the numbers of the scene')
            if self.mechanism.flat_limits:
                raise NotGenerated(f'{self.name}: parameter {name} cannot be changed, as a limit '
                                   'of its input is a change point of the lengths of the scene')
        return frozenset([*self.signs, *(names.index(name) for name in (
            *wanted, *(name for name in names if name.rpartition('.')[0] in topics)))])

    @property
    def _can_change_all(self) -> bool:
        return (self.parameters is None
                and not (self.mechanism.flat_limits or self.moves_by_torque))

    @cached_property
    def names(self) -> list[tuple[str, str]]:
        """Return name and unit of each number of the data, in their order; fixed: no name."""
        constants = self.constants
        # dyads.D.first: C says that an end is the named point C: its own along and across then
        # follow from points.C, and have no name here
        names = [('' if self.scene.values.get(f'dyads.{name.rpartition(".")[0]}') else name, 'm')
                 for name in self.mechanism.numbers_of_lengths]
        # self.signs: the indices of signs that a caller may change, its modes
        name_of = {index: f'sign_{i}' if len(self.signs) > 1 else 'sign'
                   for i, index in enumerate(self.signs, 1)}
        names += [(name_of.get(len(names) + i, ''), '')
                  for i in range(len(numbers_of(constants.sign)))]
        names += _of_links('bodies', constants.bodies)
        names += ([(f'base.{name}', unit) for name, unit in zip(
            Base._fields, ('m/s^2', 'm/s^2', 'rad/s', 'rad/s^2'))]
            if isinstance(constants.gravity, Base) else
            [('gravity.x', 'm/s^2'), ('gravity.y', 'm/s^2')])
        names += _of_links('external', constants.external)
        for name, element in zip(element_names(self.scene.values), constants.elements):
            names += self._names_in(name, element)
        for (name, _), friction in zip(self.mechanism.friction, constants.friction):
            names += self._names_in(f'friction.{name}', friction)
        names += [(name, 'm') for name in self.named_points]
        names += [(f'points.{name}.{field}', 'm') for name in self.scene.points
                  for field in ('along', 'across')]
        assert len(names) == len(self.data)
        return names

    def _names_in(self, name: str, record: Any) -> Iterable[tuple[str, str]]:
        """Yield (name in the scene or empty, unit) of each number of an element or friction."""
        for field in fields(record):
            value = getattr(record, field.name)
            if is_dataclass(value) and not callable(value):
                yield from self._names_in(group_in(name, field.name), value)
            else:
                parameter = f'{name}.{field.name}'
                named = ((parameter, of_name(parameter).unit) if parameter in self.scene.values
                         else ('', ''))
                yield from [named] * len(numbers_of(value))

    @cached_property
    def tunable(self) -> tuple[Named, ...]:
        """Return the parameters that can be changed at run time."""
        trace, first = self.trace, self.trace.count
        used = {i - first for i in trace.needed(self.needed(True))}
        if self._can_change_all:        # on which results depend
            tunable = self._asked | {i for i in used if i < len(self.data)
                                     and trace.steps[first + i].operation == 'datum'}
        else:
            tunable = self._asked
        return self._with_fields([Named(name, '', unit, '', self.data[i], i) for i, (name, unit)
                                  in enumerate(self.names) if name and i in tunable])

    def bound_of(self, name: str) -> str:
        """Return how a parameter must compare with 0: '>', '>=', or '' if it may be any number."""
        # lengths of links and dyads stand without their group here
        known = filter(None, map(find_parameter, (name, f'linkage.{name}', f'dyads.{name}')))
        parameter = next(known, None)       # a sign and a base are none of the scene
        return ('' if parameter is None else '>' if parameter.positive else
                '>=' if parameter.low == 0.0 else '')

    @cached_property
    def motion(self) -> tuple[Named, ...]:
        """Return the wanted fields of the motion, and those of points."""
        motion, _, points = _indices_of(self.trace)
        return self._wanted(self.names_of_motion, [*motion, *points],
                            self.mechanism.input_coordinate)

    @property
    def names_of_motion(self) -> list[str]:
        """Return the names of all results of the motion, and of points."""
        return [*self.mechanism.MOTION._fields, *(
            f'{point}.{field}' for point in self.scene.points for field in PointMotion._fields)]

    @cached_property
    def loads(self) -> tuple[Named, ...]:
        return self._wanted(self.mechanism.LOADS._fields if self.mechanism.bodies else (),
                            _indices_of(self.trace)[1])

    def _wanted(self, names: Sequence[str], indices: Sequence[int], always: Sequence[str] = ()
                ) -> tuple[Named, ...]:
        """Return as C fields the results that the user asked for, and those named ``always``."""
        texts = self.units_and_texts
        return self._with_fields([
            Named(name, '', *texts.get(name, ('', '')), 0.0, index)
            for name, index in zip(names, indices)
            if self.outputs is None or name in self.outputs or name in always])

    def check(self) -> None:
        """Refuse outputs and parameters that are not known, or cannot be had."""
        loads = self.mechanism.LOADS._fields
        known = (*self.names_of_motion, *loads)
        for name in self.outputs or ():
            if name in loads and self.mechanism.bodies is None:
                raise NotGenerated(f'{self.name}: no loads, so no {name}: '
                                   f'{self.mechanism.why_no_loads}')
            if name not in known:
                raise InvalidParameter('outputs', name, one_of(known, name))
        _ = self._asked         # which refuses parameters

    @cached_property
    def units_and_texts(self) -> Mapping[str, tuple[str, str]]:
        """Return {field of motion or loads, or POINT.x: (unit, text)} as far as they are known."""
        words = {field: field.replace('_', ' along ' if field[-2:] in ('_x', '_y') else ' ')
                 for field in UNITS_OF_POINTS}
        of_points = {f'{point}.{field}': (unit, f'{words[field]} of point {point}')
                     for point in self.scene.points for field, unit in UNITS_OF_POINTS.items()}
        return of_points | {name: (quantity.unit, quantity.text)
                            for name, quantity in fields_of(self.mechanism).items()}

    def _with_fields(self, named: Iterable[Named]) -> tuple[Named, ...]:
        by_field = dict[str, Named]()
        for entry in named:
            field = word(entry.name)
            while field in by_field:
                field += '_'
            by_field[field] = entry._replace(field=field)
        return tuple(by_field.values())

    # --- when there is no answer ----------------------------------------------------------------

    @property
    def depends(self) -> list[int]:
        """Return what each field of the motion needs: 1 the rate, 2 the acceleration, 3 both."""
        # Terms that are zero in this scene count too.
        trace = self._whole.trace
        needs = [0, 1, 2] + [0] * (len(trace.steps) - 3)      # the first steps are the inputs
        for index, step in enumerate(trace.steps):
            for i in step.arguments:
                needs[index] |= needs[i]
        motion, _, points = _indices_of(trace)
        index_of = dict(zip(self.names_of_motion, motion + points))
        return [needs[index_of[entry.name]] for entry in self.motion]

    def sample(self) -> tuple[tuple[float, float, float], dict[str, float]]:
        """Return an input with its rates, and Python's results for it by name."""
        mechanism, points = self.mechanism, self.scene.points
        low, high = mechanism.input_ranges[0]
        x, rate, acceleration = low + 0.6180339887 * (high - low), 1.5, -0.5
        motion, loads = mechanism.motion_and_loads(x, rate, acceleration)
        results = {**motion._asdict(), **(loads._asdict() if loads else {})}
        for name, point in points.items():
            moved = point_motion(mechanism, motion, *point)
            results |= {f'{name}.{field}': value for field, value in moved._asdict().items()}
        return (x, rate, acceleration), results

    def needed(self, with_loads: bool) -> list[int]:
        """Return the indices of the steps that the wanted results and the status need."""
        steps = self.trace.steps
        wanted = [self.index_of('transmission_angle'), self.index_of('condition'),
                  *(entry.slot for entry in (*self.motion, *(self.loads if with_loads else ())))]
        for index in self.refusing(with_loads):
            wanted.append(steps[index].arguments[-1] if steps[index].operation in JUDGED
                          else index)
        return self.trace.needed(wanted)

    def refusing(self, with_loads: bool) -> list[int]:
        trace = self.trace
        end_of_motion = self._whole.end_of_motion
        end = len(trace.steps) if with_loads and self.loads else end_of_motion
        return [index for index, step in enumerate(trace.steps[:end])
                if step.operation in REFUSING and index in trace.varies]

    @property
    def roots_left_out(self) -> list[int]:
        """Return the arguments of roots that zeros take out of the transmission angle."""
        whole, trace, name = self._whole.trace, self.trace, 'transmission_angle'
        angle = _indices_of(whole)[0][self.mechanism.MOTION._fields.index(name)]
        lost = set(whole.needed([angle])) - set(trace.needed([self.index_of(name)]))
        return [trace.steps[i].arguments[0] for i in sorted(lost)
                if trace.steps[i].operation == 'sqrt' and i in trace.varies]

    def index_of(self, name: str) -> int:
        """Return the index of the step that gives a field of the mechanism's motion."""
        names: Sequence[str] = self.mechanism.MOTION._fields
        return _indices_of(self.trace)[0][names.index(name)]


def _indices_of(trace: Trace) -> list[list[int]]:
    assert not isinstance(trace.results, int)
    return [flat(group) for group in trace.results]


def word(name: str) -> str:
    text = re.sub(r'\W', '_', name, flags=re.ASCII)
    if not text or text[0].isdigit() or text[0] == '_':
        text = 'n' + text
    return text + '_' if text in RESERVED else text


def struct_of(name: str, named: Sequence[Named], about: str) -> list[str]:
    """Return the lines of a C struct, a double for each of ``named``; ``about``: a comment."""
    # C has no empty struct: a struct without fields gets the field none.
    if not named:
        return [f'/* {about} Nothing. */', f'typedef struct {{ double none; }} {name};', '']
    width = max(len(entry.field) for entry in named)
    return [f'/* {about} */', 'typedef struct {',
            *(f'  double {entry.field};{" " * (width - len(entry.field))}  /* '
              f'[{entry.unit or "-"}] {entry.text}'.rstrip() + ' */' for entry in named),
            f'}} {name};', '']


def _of_links(group: str, record: Any) -> list[tuple[str, str]]:
    return [(f'{group}.{link}.{field.name}', UNITS_OF_BODIES.get(field.name, 'm'))
            for link in (record._fields if record else ())
            for field in fields(getattr(record, link))]
