# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The generated content of a scene: its trace, and a name, a unit and a text for each number."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from math import isfinite
import re
from typing import Any, NamedTuple

from fourbar_lab.export.statements import JUDGED
from fourbar_ros.dynamics.forces import make_external
from fourbar_ros.errors import FourBarError, InvalidParameter, one_of
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.mechanisms.curves import PointMotion
from fourbar_ros.mechanisms.evaluation import limits_at_zero
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.points import make_point, with_any_lengths
from fourbar_ros.mechanisms.quantities import fields_of
from fourbar_ros.numerics.number_types import (
    Function,
    numbers_of,
    NumberType,
    REAL,
)
from fourbar_ros.numerics.trace import flat, REFUSING, Trace
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


class NotGenerated(FourBarError):
    """A scene, or what is asked of it, cannot be generated; the message says why."""


class Named(NamedTuple):
    """A number of the generated code."""

    name: str       # as in Python: ``bodies.crank.mass``, ``theta4``, ``foot.x``
    field: str      # of a struct of C
    unit: str       # empty, as the text: none is known
    text: str
    value: float    # of a parameter: its value in the scene
    place: int      # of a parameter among the data of the trace, of a result among its steps


@dataclass(frozen=True)
class GeneratedModel:
    """A scene prepared for generation; NotGenerated or InvalidParameter where it cannot be."""

    scene: Scene
    name: str                                   # a word in C: prefix of all names
    outputs: Sequence[str] | None = None        # what is wanted; None: all
    parameters: Sequence[str] | None = None     # what can be changed at run time; None: all

    @cached_property
    def mechanism(self) -> Mechanism:
        """Return the linkage; without masses where its loads have limits besides springs."""
        bare = self.scene.bare_linkage
        return self.scene.linkage if bare.is_flat_at_zero else bare

    @cached_property
    def signs(self) -> dict[int, dict[int, float]]:
        """Return {place among the data: {mode: number}}: differences of the modes passed."""
        mechanism, modes = self.mechanism, tuple[int, ...]()
        if self.moves_by_torque:
            from fourbar_ros.dynamics.node_step import modes_of
            modes = modes_of(mechanism)
        rows = {mode: numbers_of(mechanism.in_mode(mode).constants) for mode in modes}
        return {place: dict(zip(rows, column)) for place, column in enumerate(zip(*rows.values()))
                if len(set(column)) > 1}

    @cached_property
    def is_fixed(self) -> bool:
        """Return whether it has change points, whose limits belong to its own numbers."""
        return self.mechanism.is_flat_at_zero or bool(self.mechanism.flat_limits)

    @property
    def from_topics(self) -> set[str]:
        """Return the groups of parameters that a node has from topics: inputs here."""
        return {name if name == BASE.name else f'external.{name}' for name in self.scene.acting}

    @property
    def moves_by_torque(self) -> bool:
        """Return whether its motion follows from torque."""
        return self.scene.dynamics is not None

    # --- its trace ------------------------------------------------------------------------------

    @cached_property
    def trace(self) -> Trace:
        """Return the trace of motion, loads and points, with the operations of ``step``."""
        mechanism, (found, _, end_of_loads) = self.mechanism, self._recorded
        zeros = {found.count + i: 0.0 for i, value in enumerate(self.data)
                 if value == 0.0 and i not in self._asked and i < len(numbers_of(self.constants))
                 } if mechanism.LEAVES_OUT_ZEROS else {}
        # of points a node leaves nothing out
        return found.simplified({**found.literals(), **zeros}, end_of_loads) if zeros else found

    @cached_property
    def _recorded(self) -> tuple[Trace, int, int]:
        """Return the trace of all results, and its steps where motion and where loads end."""
        mechanism, elements, ends = self.mechanism, self.scene.elements, list[int]()

        def make_formula(n: NumberType, data: Any) -> Function:
            """Return the formula (three inputs) -> (motion, loads, points), of some numbers."""
            constants, places = data
            parametric = with_any_lengths(mechanism, constants.lengths)
            # the lengths of motion by torque are fixed
            lengths = None if self.moves_by_torque else constants.lengths
            external = make_external(n, mechanism, elements, lengths) if elements else None
            points = [make_point(n, parametric, point.link, *place)
                      for point, place in zip(self.scene.points.values(), places)]
            motion_of = mechanism.motion_formula(n, constants)

            def formula(*given: Any) -> Any:
                motion, loads = mechanism.MOTION._make(motion_of(*given)), ()
                ends.append(len(given[0].trace.steps))
                if mechanism.bodies:
                    its = constants if external is None else constants._replace(
                        external=external(motion, given[0], constants.external))
                    loads = mechanism.loads_formula(n, its)(motion)
                ends.append(given[0].trace.begin_apart())
                return tuple(motion), loads, [point(motion) for point in points]
            return formula

        trace = Trace(make_formula, 3, (self.constants, self._places))
        end_of_motion, end_of_loads = ends
        return trace, end_of_motion, end_of_loads

    @property
    def _places(self) -> tuple[tuple[float, ...], ...]:
        """Return (along, across) of each point [m]."""
        return tuple([(point.along, point.across) for point in self.scene.points.values()])

    @cached_property
    def constants(self) -> Any:
        """Return the data of the mechanism's formulas."""
        constants = self.mechanism.constants
        return constants if self.mechanism.bodies else constants._replace(bodies=None)

    @cached_property
    def data(self) -> list[float]:
        """Return the numbers of the data, in the order of the trace."""
        return [float(value) for value in numbers_of((self.constants, self._places))]

    # --- names ----------------------------------------------------------------------------------

    @cached_property
    def inputs(self) -> tuple[Named, ...]:
        """Return position, rate and acceleration of the input."""
        coordinate = self.mechanism.input_coordinate
        texts = 'position of the input', 'its rate', 'its acceleration'
        return self._with_fields([Named(name, '', unit, text, 0.0, i) for i, (name, unit, text)
                                  in enumerate(zip(coordinate, coordinate.units, texts))])

    @cached_property
    def _asked(self) -> frozenset[int]:
        """Return which data are parameters, zero or not: by their names, or as topics set them."""
        names = [name for name, _ in self.names]
        wanted = self.parameters or ()
        topics = self.from_topics
        for name in wanted:
            if name not in names:
                raise InvalidParameter('parameters', name, one_of(filter(None, names), name))
            if self.moves_by_torque and name.rpartition('.')[0] not in topics:
                raise NotGenerated(f'{self.name}: parameter {name} cannot be changed, as the '
                                   'motion by torque has the numbers of the scene')
            if self.is_fixed:
                raise NotGenerated(f'{self.name}: parameter {name} cannot be changed, as its '
                                   'limits at change points belong to the lengths of the scene')
        return frozenset([*self.signs, *(names.index(name) for name in (
            *wanted, *(name for name in names if name.rpartition('.')[0] in topics)))])

    @cached_property
    def names(self) -> list[tuple[str, str]]:
        """Return name and unit of each number of the data; no name: it is fixed."""
        constants = self.constants
        found = [(name if isinstance(name, str) else '', 'm')
                 for name in self.mechanism.numbers_of_lengths]
        signs = list(self.signs)
        found += [((f'sign_{signs.index(place) + 1}' if len(signs) > 1 else 'sign')
                   if place in signs else '', '')
                  for place in range(len(found), len(found) + len(numbers_of(constants.sign)))]
        found += _of_links('bodies', constants.bodies)
        found += ([(f'base.{name}', unit) for name, unit in zip(
            Base._fields, ('m/s^2', 'm/s^2', 'rad/s', 'rad/s^2'))]
            if isinstance(constants.gravity, Base) else
            [('gravity.x', 'm/s^2'), ('gravity.y', 'm/s^2')])
        found += _of_links('external', constants.external)
        found += [(f'points.{name}.{what}', 'm') for name in self.scene.points
                  for what in ('along', 'across')]
        assert len(found) == len(self.data)
        return found

    @cached_property
    def tunable(self) -> tuple[Named, ...]:
        """Return the parameters that can be changed at run time."""
        trace, first = self.trace, self.trace.count
        used = {i - first for i in trace.needed(self.needed(True))}
        used |= {i for datum in used & self.derived.keys() for i in self.derived[datum]}
        chooses_all = self.parameters is None and not self.is_fixed and not self.moves_by_torque

        def is_tunable(place: int, name: str) -> bool:
            """Return whether it was asked for, or all are wanted and results depend on it."""
            return bool(name) and (place in self._asked or chooses_all and place in used
                                   and trace.steps[first + place].operation == 'datum')
        return self._with_fields([Named(name, '', unit, '', self.data[i], i)
                                  for i, (name, unit) in enumerate(self.names)
                                  if is_tunable(i, name)])

    def bound_of(self, name: str) -> str:
        """Return how a parameter must compare with 0: '>', '>=', or '' if it may be any number."""
        if name.startswith('bodies.') and name.endswith(('.mass', '.inertia')):
            return '>='
        return '>' * any(length.name == name and not length.signed
                         for length in self.mechanism.LENGTHS)

    @cached_property
    def derived(self) -> dict[int, tuple[int, int]]:
        """Return {place among the data: two others} of sizes of vectors."""
        return {i: name for i, name in enumerate(self.mechanism.numbers_of_lengths)
                if not isinstance(name, str)}

    @cached_property
    def motion(self) -> tuple[Named, ...]:
        """Return the wanted fields of the motion, and those of points."""
        return self._wanted(self.names_of_motion,
                            [*_parts(self.trace)[0], *_parts(self.trace)[2]], False)

    @property
    def names_of_motion(self) -> list[str]:
        """Return the names of all results of the motion, and of points."""
        return [*self.mechanism.MOTION._fields, *(
            f'{point}.{what}' for point in self.scene.points for what in PointMotion._fields)]

    @cached_property
    def loads(self) -> tuple[Named, ...]:
        """Return the wanted fields of the loads."""
        return self._wanted(self.mechanism.LOADS._fields if self.mechanism.bodies else (),
                            _parts(self.trace)[1], True)

    def _wanted(self, names: Sequence[str], places: Sequence[int], are_loads: bool
                ) -> tuple[Named, ...]:
        """
        Return the results that the user asked for, as C fields.

        ``places``: their places in the trace. The motion always includes the input with its rates.
        """
        texts = self.units_and_texts
        given = dict.fromkeys(self.mechanism.input_coordinate)
        return self._with_fields([
            Named(name, '', *texts.get(name, ('', '')), 0.0, place)
            for name, place in zip(names, places)
            if self.outputs is None or name in self.outputs
            or name in given and not are_loads])

    def check(self) -> None:
        """Raise NotGenerated or InvalidParameter where it cannot be generated."""
        mechanism, outputs = self.mechanism, list(self.outputs or ())
        known = self.names_of_motion
        for name in outputs:
            if name in mechanism.LOADS._fields and mechanism.bodies is None:
                raise NotGenerated(f'{self.name}: no loads, so no {name}: '
                                   f'{self.scene.why_no_loads}')
            if name not in (*known, *mechanism.LOADS._fields):
                raise InvalidParameter('outputs', name,
                                       one_of((*known, *mechanism.LOADS._fields), name))
        _ = self._asked

    @cached_property
    def units_and_texts(self) -> Mapping[str, tuple[str, str]]:
        """Return {field of motion or loads, or POINT.x: (unit, text)} as far as they are known."""
        words = {what: what.replace('_', ' along ' if what[-2:] in ('_x', '_y') else ' ')
                 for what in UNITS_OF_POINTS}
        of_points = {f'{point}.{what}': (unit, f'{words[what]} of point {point}')
                     for point in self.scene.points for what, unit in UNITS_OF_POINTS.items()}
        return of_points | {name: (quantity.unit, quantity.text)
                            for name, quantity in fields_of(self.mechanism).items()}

    def _with_fields(self, named: Iterable[Named]) -> tuple[Named, ...]:
        """Return them with fields that are words of C and differ."""
        taken, found = set[str](), []
        for one in named:
            field = word(one.name)
            while field in taken:
                field += '_'
            taken.add(field)
            found.append(one._replace(field=field))
        return tuple(found)

    # --- when there is no answer ----------------------------------------------------------------

    @cached_property
    def limits_at_zero(self) -> tuple[list[float], ...]:
        """
        Return the fields at a flat position at 0 as coefficients, four lists.

        Of 1, the rate, its square, the acceleration.
        """
        if not self.mechanism.is_flat_at_zero:
            return ()
        with_loads = self.mechanism.bodies is not None
        at, forward, back, faster = (
            limits_at_zero(self.mechanism, *given, with_loads)
            for given in ((0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0)))
        return (at, [0.5 * (a - b) for a, b in zip(forward, back)],
                [0.5 * (a + b) - c for a, b, c in zip(forward, back, at)],
                [a - b if isfinite(b) else b for a, b in zip(faster, at)])

    @property
    def depends(self) -> list[int]:
        """
        Return for each field of :attr:`motion` what it needs: 1 rate, 2 acceleration, 3 both.

        Terms that are zero in this scene count too.
        """
        trace = self._recorded[0]
        found = [{0: 0, 1: 1, 2: 2}.get(place, 0) for place in range(len(trace.steps))]
        for place, step in enumerate(trace.steps):
            for i in step.arguments:
                found[place] |= found[i]
        places = dict(zip(self.names_of_motion, _parts(trace)[0] + _parts(trace)[2]))
        return [found[places[one.name]] for one in self.motion]

    def sample(self) -> tuple[tuple[float, float, float], dict[str, float]]:
        """Return one input, and all results of Python there by name."""
        mechanism, points = self.mechanism, self.scene.points
        low, high = mechanism.input_ranges[0]
        given = low + 0.6180339887 * (high - low), 1.5, -0.5
        loaded = self.scene.linkage_at(*given[:2]) if self.scene.elements else mechanism
        motion, loads = loaded.motion_and_loads(*given)
        found = {**motion._asdict(), **(loads._asdict() if loads else {})}
        for name, point in points.items():
            values = make_point(REAL, mechanism, *point)(motion)
            found.update((f'{name}.{what}', value)
                         for what, value in zip(PointMotion._fields, values))
        return given, found

    def needed(self, with_loads: bool) -> list[int]:
        """Return the places of the steps that the wanted results and the status need."""
        steps = self.trace.steps
        wanted = [self.transmission, *(one.place for one in (
            *self.motion, *(self.loads if with_loads else ())))]
        for place in self.refusing(with_loads):
            wanted.append(steps[place].arguments[-1] if steps[place].operation in JUDGED
                          else place)
        return self.trace.needed(wanted)

    def refusing(self, with_loads: bool) -> list[int]:
        """Return the places of the steps that refuse some inputs."""
        trace = self.trace
        _, end_of_motion, _ = self._recorded
        end = len(trace.steps) if with_loads and self.loads else end_of_motion
        return [place for place, step in enumerate(trace.steps[:end])
                if step.operation in REFUSING and place in trace.varies]

    @property
    def roots_left_out(self) -> list[int]:
        """Return the arguments of roots that the transmission angle has but for zeros."""
        whole, trace = self._recorded[0], self.trace
        place = _parts(whole)[0][self.mechanism.MOTION._fields.index('transmission_angle')]
        lost = set(whole.needed([place])) - set(trace.needed([self.transmission]))
        return [trace.steps[i].arguments[0] for i in sorted(lost)
                if trace.steps[i].operation == 'sqrt' and i in trace.varies]

    @property
    def transmission(self) -> int:
        """Return the place of the transmission angle, which is a number where the links close."""
        names: Sequence[str] = self.mechanism.MOTION._fields
        return _parts(self.trace)[0][names.index('transmission_angle')]


def _parts(trace: Trace) -> list[list[int]]:
    """Return the places of the fields of motion, loads and points."""
    assert not isinstance(trace.results, int)
    return [flat(part) for part in trace.results]


def word(name: str) -> str:
    """Return a name as a word of C and C++."""
    found = re.sub(r'\W', '_', name, flags=re.ASCII)
    if found[:1].isdigit() or found[:1] == '_' or not found:
        found = 'n' + found
    return found + '_' if found in RESERVED else found


def struct_of(name: str, named: Sequence[Named], about: str) -> list[str]:
    """
    Return the lines of a C struct: a double for each of ``named``; ``about``: comment above it.

    C has no empty struct: without fields it gets the field none.
    """
    if not named:
        return [f'/* {about} Nothing. */', f'typedef struct {{ double none; }} {name};', '']
    width = max(len(one.field) for one in named)
    return [f'/* {about} */', 'typedef struct {',
            *(f'  double {one.field};{" " * (width - len(one.field))}  /* '
              f'[{one.unit or "-"}] {one.text}'.rstrip() + ' */' for one in named),
            f'}} {name};', '']


def _of_links(group: str, record: Any) -> list[tuple[str, str]]:
    """Return name and unit of all numbers of bodies or external loads."""
    return [(f'{group}.{link}.{field.name}', UNITS_OF_BODIES.get(field.name, 'm'))
            for link in (record._fields if record else ())
            for field in fields(getattr(record, link))]
