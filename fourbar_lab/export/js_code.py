# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The formulas of a scene as a module of JavaScript whose parameters are those of the scene.

Lengths, masses, springs, forces, friction and assembly modes can be changed; rods, directions and
exact sums of lengths follow. Another list of dyads, a further spring or a spring without a free
length that gets one is another structure: another module.
"""
from collections.abc import Sequence
from contextlib import suppress
from functools import cached_property
import json
from math import inf, isfinite, tau
from textwrap import wrap
from typing import Any

from fourbar_lab.export.model import NotGenerated, UNITS_OF_POINTS
from fourbar_lab.export.statements import filled, JS, JUDGED, lines_of, snippet, Statements, Texts
from fourbar_ros import __version__
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.mechanisms import curves, elements, evaluation
from fourbar_ros.mechanisms.geometry import BESIDE_FLAT_LIMITS
from fourbar_ros.mechanisms.points import point_in, with_any_lengths
from fourbar_ros.mechanisms.quantities import fields_of
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.trace import flat, REFUSING, Trace
from fourbar_ros.scene.elements import element_names
from fourbar_ros.scene.parameters import find_parameter
from fourbar_ros.scene.parametric import alike, constants_of, point_quantities_of
from fourbar_ros.scene.scene import Scene

GROUPS = ('linkage', 'dyads', 'cylinder', 'bodies', 'gravity', 'base', 'external', 'springs',
          'torsion_springs', 'forces', 'friction', 'points')
# of a spring: numbers that are another structure once they are not 0
SWITCHING = 'free_length', 'preload', 'damping'
UNITS_OF_FRAME = 'm', 'm', 'm/s', 'm/s', 'm/s^2', 'm/s^2', '', '', 'rad/s', 'rad/s^2'
CHECKED = 3             # recorded poses of the self-check
Inputs = tuple[float, float, float]         # position, rate and acceleration of the input


class JsModule:
    """A scene prepared for generation; NotGenerated of a force that is a Python function."""

    def __init__(self, scene: Scene, name: str) -> None:
        """Trace motion, frames of all links, loads and the quantities of points."""
        self.scene, self.name, self.mechanism = scene, name, scene.linkage
        self.values = self._changeable()
        self.ends = list[int]()
        trace = Trace(self._make_formula, 3, tuple(self.values.values()))
        self.trace = trace.simplified(trace.literals())

    def _changeable(self) -> dict[str, float]:
        """Return {name: value} of the parameters that are traced: numbers that are given."""
        scene = self.scene
        springs = [name for name in element_names(scene.values) if 'springs.' in name]
        fixed = {f'{name}.{field}' for name in springs for field in SWITCHING
                 if scene.values.get(f'{name}.{field}') == 0.0}
        values = {name: float(value) for name, value in scene.values.items()
                  if name.partition('.')[0] in GROUPS and name not in fixed
                  and (isinstance(value, float) and isfinite(value) or name.endswith('.mode'))}
        # of friction a zero, and a block without a length, are another structure
        values = {name: value for name, value in values.items()
                  if not name.startswith('friction.') or value != 0.0}
        if isinstance(self.mechanism.gravity, Base):
            values |= {f'base.{field}': value
                       for field, value in zip(Base._fields, self.mechanism.gravity)}
        return values

    def _constants(self, n: NumberType, changed: dict[str, Any]) -> evaluation.Constants:
        """Return the constants of the mechanism, numbers of type n, with changed parameters."""
        from fourbar_ros.machine import Machine
        mechanism, values = self.mechanism, {**self.scene.values, **changed}
        constants = constants_of(self.scene, values, n)
        if isinstance(mechanism.gravity, Base):
            constants = constants._replace(gravity=Base(*[
                changed[f'base.{field}'] for field in Base._fields]))
        # of a machine the signs of its dyads
        return constants._replace(sign=(
            2.0 * values['linkage.mode'] - 3.0 if not isinstance(mechanism, Machine) else
            tuple([2.0 * values[f'dyads.{dyad.name}.mode' if dyad in mechanism.dyads
                                else 'cylinder.mode'] - 3.0 for dyad in mechanism.stages])))

    def _make_formula(self, n: NumberType, data: Sequence[Scalar]) -> Function:
        """Return (position, rate, acceleration) -> all results, for values of the parameters."""
        changed = dict(zip(self.values, data))
        constants = self._constants(n, changed)
        scene = alike(self.scene, constants)
        mechanism = scene.linkage
        parametric = with_any_lengths(mechanism, [
            changed[f'linkage.{name}'] for name in mechanism.length_names
            if f'linkage.{name}' in changed])
        quantities = point_quantities_of(scene, {**scene.values, **changed}, parametric)

        def formula(x: Any, rate: Any, acceleration: Any) -> Any:
            motion = mechanism.motion_in(n, constants, x, rate, acceleration)
            moving = mechanism.link_motions(motion, constants.lengths)
            frames = [tuple(link) for link in moving.values()]
            self.ends.append(len(x.trace.steps))
            loads = mechanism.loads_in(n, constants, motion) if mechanism.bodies else ()
            self.ends.append(len(x.trace.steps))
            points = [point_in(n, parametric, motion, point.link, changed[f'points.{name}.along'],
                               changed[f'points.{name}.across'])
                      for name, point in scene.points.items()]
            return (tuple(motion), frames, points,
                    [quantity.of(motion, None) for quantity in quantities.values()], loads)
        self._of_points = quantities
        return formula

    @cached_property
    def _results(self) -> list[tuple[str, str | None]]:
        """Return name and unit of each result of the trace; without a unit it is not written."""
        mechanism, known = self.mechanism, fields_of(self.mechanism)
        loads = mechanism.LOADS._fields if mechanism.bodies else ()
        return [*((name, known[name].unit if name in known else None)
                  for name in mechanism.MOTION._fields),
                *((f'frame.{link.name}.{field}', unit) for link in mechanism.LINKS
                  for field, unit in zip(curves.LinkMotion._fields, UNITS_OF_FRAME)),
                *((f'{name}.{field}', UNITS_OF_POINTS[field]) for name in self.scene.points
                  for field in curves.PointMotion._fields),
                *((name, quantity.unit) for name, quantity in self._of_points.items()),
                *((name, known[name].unit) for name in loads)]

    @cached_property
    def units(self) -> dict[str, str]:
        """Return {name of a result: unit} in the order of the results, the loads last."""
        return {name: unit for name, unit in self._results if unit is not None}

    @property
    def first_load(self) -> int:
        """Return the index of the first load among the results."""
        return len(self.units) - len(self.mechanism.LOADS._fields) * bool(self.mechanism.bodies)

    @cached_property
    def _indices(self) -> dict[str, int]:
        """Return {name of a result: index of its step in the trace}."""
        return dict(zip([name for name, _ in self._results], flat(self.trace.results)))

    # --- text -----------------------------------------------------------------------------------

    @cached_property
    def parameters(self) -> dict[str, float]:
        """Return {name: value} of the parameters on which a result depends."""
        trace = self.trace
        used = set(trace.needed([self._indices[name] for name in self.units]))
        return {name: value for i, (name, value) in enumerate(self.values.items(), trace.count)
                if i in used}

    @cached_property
    def text(self) -> str:
        parameters = ', '.join(f'{json.dumps(name)}: {JS.literal(value)}'
                               for name, value in self.parameters.items())
        return filled(self.body, {'PARAMETERS': f'{{{parameters}}}',
                                  'RECORDED': json.dumps(self._recorded)})

    @cached_property
    def body(self) -> str:
        """Return the text without values of parameters: equal texts are the same structure."""
        trace, indices = self.trace, self._indices
        positions = {name: i for i, name in enumerate(self.values, trace.count)}
        texts = Texts(trace, list(self.values.values()), {
            positions[name]: f'p[{json.dumps(name)}]' for name in self.parameters}, JS)
        writer, lines, written = Statements(JS), list[str](), set[int]()
        names = list(self.units)
        refusing = [i for i, step in enumerate(trace.steps)
                    if step.operation in REFUSING and i in trace.varies]
        for first, last in ((0, self.first_load), (self.first_load, len(names))):
            results, end = names[first:last], self.ends[0] if first == 0 else len(trace.steps)
            refusing_here = [i for i in refusing if i < end and i not in written]
            needed = trace.needed([*(indices[name] for name in results), *(
                trace.steps[i].arguments[-1] if trace.steps[i].operation in JUDGED else i
                for i in refusing_here)])
            if first:
                lines.append('refuse = noLoads;')
            lines += writer.lines(trace, {*needed} - written, refusing_here, texts)
            written |= {*needed, *refusing_here}
            if first == 0:
                closes = texts(indices['transmission_angle'])
                lines.append(f'if (Number.isNaN({closes})) return noMotion(to);')
            lines += [f'to[{i}] = {texts(indices[name])};'
                      for i, name in enumerate(names[first:last], first)]
        loads = [texts(indices[name]) for name in names[self.first_load:]]
        lines += ([*wrap(f'const total = {" + ".join(loads)};', 96),
                   'return total * 0 === 0 ? 0 : noLoads(to);'] if loads else ['return 0;'])
        preparation = texts.preparation(writer)
        used, called = sorted(writer.used), writer.called
        runtime = [*(snippet('functions.js', name) for name in used),
                   *([snippet('functions.js', 'table')] if called else []),
                   *(self._table(i, force) for i, force in enumerate(called))]
        return filled(snippet('functions.js', 'module'), {
            'ABOUT': f'// {self.name}: {self.mechanism.TITLE}. Written by fourbar_ros '
                     f'{__version__}; not to be edited. SI units, angles in rad.',
            'BOUNDS': json.dumps(self._bounds),
            'NAMES': json.dumps(names), 'FIRST_LOAD': self.first_load,
            'FUNCTIONS\n': '\n'.join(runtime), 'PREPARATION\n': lines_of(preparation),
            'KEPT': ', '.join(texts.prepared), 'STATEMENTS\n': lines_of(self._reach + lines),
            'UNITS': json.dumps([*self.units.values()])})

    @property
    def operations(self) -> int:
        trace = self.trace
        return sum(1 for i in trace.needed([self._indices[name] for name in self.units])
                   if i in trace.varies and not trace.steps[i].is_given)

    @property
    def _reach(self) -> list[str]:
        """Return the statements that refuse inputs that overflow, as Mechanism.reaches does."""
        mechanism, cut, period = self.mechanism, self.mechanism.cut, self.mechanism.period
        far = 'x0' if mechanism.is_driven_by_slide else f'x0 * {mechanism.overflowing!r}'
        lines = [f'if (({far} + x1 * x1 + x2) * 0 !== 0) return refuse(to);']
        if cut:
            low, high, away = *cut, '0'
            if not mechanism.is_driven_by_slide:        # of angles in any turn
                middle = JS.literal(0.5 * (low + high))
                away = f'{period!r} * Math.round((x0 - {middle}) / {period!r})'
            lines += [f'const away = {away}, slack = 2 ** -51 * Math.abs(away);',
                      f'if (!(x0 - away >= {JS.literal(low)} - slack '
                      f'&& x0 - away <= {JS.literal(high)} + slack)) return refuse(to);']
        turns = '' if mechanism.is_driven_by_slide else f' - {tau!r} * Math.round(far / {tau!r})'
        return lines + [f'{{ const far = x0 - {JS.literal(flat)}; if (Math.abs(far{turns}) <= '
                        f'{BESIDE_FLAT_LIMITS * mechanism.input_unit!r}) return refuse(to); }}'
                        for flat in sorted(set(mechanism.flat_limits))]

    @property
    def _bounds(self) -> list[tuple[str, float, bool]]:
        """Return (name, least value, whether it may be reached) of parameters that have one."""
        bounds = list[tuple[str, float, bool]]()
        for name in self.parameters:
            parameter = find_parameter(name)        # those of a base are none of the scene
            if parameter and parameter.positive:
                bounds.append((name, 0.0, False))
            elif parameter and parameter.low > -inf:
                bounds.append((name, parameter.low, True))
        return bounds

    def _table(self, i: int, force: Any) -> str:
        """Return the text of ``called_i``: the cubic pieces of a force over a position."""
        if not isinstance(force, elements.TableForce):
            raise NotGenerated(f'{self.name}: a force that is a Python function')
        table, middle = force.table, force.middle
        argument = 'place'
        if middle is not None:
            argument = f'wrapped(place, {middle - 0.5 * tau!r}, {tau!r})'
        elif table.is_periodic:
            argument = f'wrapped(place, {table.places[0]!r}, {table.span!r})'
        return (f'const pieces_{i} = {json.dumps(table.pieces)}, starts_{i} = '
                f'{json.dumps(table.starts)};\nconst called_{i} = place => '
                f'value_in(pieces_{i}, starts_{i}, {argument});\n')

    @property
    def _recorded(self) -> list[tuple[Inputs, int, list[float | None]]]:
        """Return (inputs, status, results) of some poses, as Python computes them."""
        mechanism = self.mechanism
        low, high = mechanism.input_ranges[0]
        rate = float(self.scene.drive.speed) or 1.0
        return [(inputs, *self.sample(*inputs)) for inputs in (
            (low + (i + 0.618) / CHECKED * (high - low), rate, 0.5) for i in range(CHECKED))]

    def sample(self, x: float, rate: float, acceleration: float) -> tuple[int, list[float | None]]:
        """Return what ``step`` in JavaScript must give: its status, fields of motion and loads."""
        # Status 0: all, 1: no motion, 2: no loads. None: missing or not finite, as JSON has no
        # NaN.
        mechanism, status, results = self.mechanism, 1, dict[str, float]()
        with suppress(FourBarError):
            results, status = mechanism.motion(x, rate, acceleration)._asdict(), 2
            if mechanism.bodies:
                results |= mechanism.step(x, rate, acceleration)[1]._asdict()
            status = 0
        row = [results.get(name) for name in self.units]
        return status, [None if value is None or not isfinite(value) else value for value in row]
