# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism, evaluated: motion, loads and both of a sample or of arrays.

Its formulas are called for one input or for arrays by the same rules for all. What it states is in
:mod:`.statement`, what follows without a pose in :mod:`.geometry`.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields as fields_of
from dataclasses import replace
from functools import cache, cached_property
from math import inf, isfinite, isnan
from numbers import Real
from types import SimpleNamespace
from typing import Any, NoReturn, Self, TYPE_CHECKING, Union

from fourbar_ros import errors
from fourbar_ros.mechanics.bodies import Base, NOT_APPLIED, UnknownBase
from fourbar_ros.mechanisms import checks
from fourbar_ros.mechanisms.curves import Coefficients, LinkMotion
from fourbar_ros.mechanisms.evaluation import Constants, generated, Recorded, recorded
from fourbar_ros.mechanisms.geometry import cached_by_lengths, MechanismGeometry
from fourbar_ros.mechanisms.load_table import DERIVED
from fourbar_ros.mechanisms.parts import DRIVE, NamedFields, OPEN, Ranges
from fourbar_ros.notebook import as_html, in_lines, short_repr
from fourbar_ros.numerics.arguments import finite, NOT_SO_FAR
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.number_types import Function, NumberType, REAL, Scalar
import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink
    from fourbar_ros.mechanisms.machine.solve.friction import MachineFriction
    from fourbar_ros.mechanisms.pieces import Pieces

# Links and the coordinate that drives them: a mechanism, or the same links driven at another one.
DrivenLinks = Union['Mechanism', 'SeenFromLink']
LONGEST = 20.0      # [m] what is longer is likely in millimetres
# what tab completion shows besides the fields
SHOWN = ('bias', 'change_point_margin', 'classification', 'dead_points', 'description', 'holding',
         'in_mode', 'inertia', 'input', 'input_ranges', 'lengths', 'loads', 'margins', 'modes',
         'motion', 'output_ranges', 'outputs', 'reactions', 'step', 'turns_fully', 'with_base',
         'with_elements', 'with_external', 'with_lengths')


class Mechanism(MechanismGeometry):
    """Base of the mechanisms: four-bars, kinds with a slide, machines of dyads."""

    # They are frozen dataclasses of what StatedMechanism names.
    _repr_html_ = as_html

    def __repr__(self) -> str:
        """Return it with all that is not the default, in at most ten lines."""
        text = in_lines(short_repr(type(self).__name__, {
            field.name: value for field in fields_of(self)
            if (value := getattr(self, field.name)) != field.default}))
        return f'{text}  # {self.doubt}' if self.doubt else text

    @property
    def doubt(self) -> str:
        """Return a line on lengths that are likely in millimetres; empty: none are."""
        longest = float(np.max(np.abs(np.hstack([0.0, *self.lengths]))))
        return f'lengths of up to {longest:g} m: in mm?' if longest > LONGEST else ''

    @cached_by_lengths
    def _compute_motion(self) -> tuple[Function, Function]:
        return generated(self, with_loads=False), self.MOTION._make

    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """Return the motion of one of its ``LINKS`` by name, from one of its motions."""
        return self.link_motions(motion)[self.link(link).name]

    def loads_in(self, n: NumberType, constants: Constants, motion: NamedFields,
                 reports: list[Any] | None = None) -> NamedFields:
        """Return the loads, LOADS of numbers of a type, in a motion of that type."""
        # reports: a list to which joints with friction append a FrictionReport
        loads = SimpleNamespace(**dict(zip(
            self.LOADS._fields, self.joint_loads_in(n, constants, motion, reports))))
        for row in DERIVED:
            assert row.of
            try:
                value = row.of(self, constants, motion, loads)
            except AttributeError as error:     # a field that other kinds have
                raise errors.FourBarError(f'load {row.name} of {self.TITLE}: {error}; a row of '
                                          'LOADS holds for every kind of mechanism') from None
            setattr(loads, row.name, value)
        return self.LOADS(**vars(loads))

    def joint_loads_in(self, n: NumberType, constants: Constants, motion: NamedFields,
                       reports: Any = None) -> Any:
        """Return the loads that are not DERIVED, with the forces of all elements."""
        if constants.elements:
            from fourbar_ros.mechanisms.elements import applied_in  # few mechanisms have any
            constants = constants._replace(external=applied_in(n, self, constants, motion))
        return self.joint_loads(n, constants, motion, reports)

    def make_coefficients(self, n: NumberType) -> Coefficients:
        """Return position -> coefficients of all links for a number type, as dynamics needs."""
        # Those of a link are its LinkMotion at unit rate and zero acceleration: derivatives with
        # respect to the input, exact. A stroke is no limit here; where the links cannot close it
        # raises ValueError, or gives NaN in arrays.
        def coefficients(position: Scalar) -> list[LinkMotion]:
            motion = self.motion_in(n, self.constants, position, 1.0, 0.0)
            return [*self.link_motions(motion).values()]
        return coefficients

    def read_coordinate(self, n: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        """Return the input and its two derivatives from coefficients of the links."""
        # Inverse of make_coefficients(): where the derivatives are with respect to another
        # coordinate, as of driven_otherwise(), so are those returned. An angle is in [-pi, pi].
        if self.is_driven_by_slide:
            return curves[-1].x, curves[-1].v_x, curves[-1].a_x
        crank = curves[0]
        return n.atan2(crank.sine, crank.cosine), crank.omega, crank.alpha

    @cached_by_lengths
    def _record_of_motion(self) -> Recorded:
        return recorded(self, False)

    @cached_property
    def _record_with_loads(self) -> Recorded:
        return recorded(self, True)

    def record(self, with_loads: bool) -> Recorded:
        return self._record_with_loads if with_loads else self._record_of_motion

    @cached_property
    def pieces(self) -> Pieces | None:
        """Return where the elements on it make loads not smooth, None without elements."""
        if not self.elements:
            return None
        from fourbar_ros.mechanisms.pieces import pieces_of  # few mechanisms have any
        return pieces_of(self)

    def __dir__(self) -> list[str]:
        """Return what tab completion shows: what a user asks of a mechanism."""
        shown = {field.name for field in fields_of(self)}.union(SHOWN)
        return sorted(name for name in shown if hasattr(type(self), name) or name in self.__dict__)

    @cached_property
    def _compute_step(self) -> tuple[Function, Function, Function]:
        self.require_loads()
        return generated(self, with_loads=True), self.MOTION._make, self.LOADS._make

    @property
    def has_loads(self) -> bool:
        """Return whether loads can be asked for: masses are given, and so is gravity or a base."""
        return self.bodies is not None and not isinstance(self.gravity, UnknownBase)

    @property
    def why_no_loads(self) -> str:
        try:
            self.require_loads()
        except errors.FourBarError as error:
            return str(error)
        return ''

    def require_loads(self) -> None:
        if self.bodies is None:
            raise errors.MissingBodies
        if isinstance(self.gravity, UnknownBase):
            raise errors.UnknownBaseMotion

    def require_cycle(self) -> None:
        """Refuse forces over the input that repeat after no number of turns of the crank."""
        if self.elements:
            from fourbar_ros.mechanisms.elements import require_cycle  # few mechanisms have any
            require_cycle(self.elements)

    def prepare(self) -> Function:
        """Return the function of one sample; tracing and compiling a new structure takes 10 ms."""
        # ArithmeticError or ValueError where numbers overflow.
        return (self._compute_step if self.has_loads else self._compute_motion)[0]

    def driven_otherwise(self) -> tuple[DrivenLinks, ...]:
        """Return the same links driven at another coordinate, one for each mode; () if none."""
        # Where the input turns back at a toggle, the other coordinate goes on: a simulation
        # changes to it there. It needs the motion of the links alone, in whole ranges.
        for name in self.INPUTS:
            if name != self.input:
                free = replace(self, input=name, mode=OPEN, stroke=None, elements=())
                return tuple([free.in_mode(mode) for mode in sorted(free.modes)])
        return ()

    def motion(self, position: ArrayLike, rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0,
               fields: Iterable[str] | None = None) -> Any:
        """
        Return the motion for given input, its rate and acceleration.

        Parameters
        ----------
        position, rate, acceleration : float or array_like
            Crank angle [rad] (any number of turns), [rad/s], [rad/s^2], or slide [m], [m/s],
            [m/s^2], as ``input`` says; arrays are broadcast. Three floats take the fast scalar
            path; samples of arrays may differ from it in their last bits.
        fields : sequence of str, optional
            Names of fields of the result: these alone, computed with no more than they need, as a
            tuple in this order.

        Raises
        ------
        InvalidParameter, OutOfRange, Toggle
            For a single value that is not finite, out of range, at a toggle. In arrays such
            samples are NaN in every field that depends on it.

        Examples
        --------
        >>> from fourbar_ros import FourBar
        >>> linkage = FourBar(0.4, 1.2, 0.8, 1.0)
        >>> theta4, alpha4 = linkage.motion([0.5, 1.0], 25.0, fields=('theta4', 'alpha4'))
        >>> alpha4.shape
        (2,)

        """
        if fields is not None:
            return self._only(fields, (position, rate, acceleration), False)
        if not (type(position) is float and type(rate) is float and type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                position, rate, acceleration = map(finite, self.input_coordinate,
                                                   (position, rate, acceleration))
                return self.motion(position, rate, acceleration)
            from fourbar_ros.mechanisms.batches import evaluate  # nodes take one sample at a time
            return self.MOTION._make(evaluate(self, (position, rate, acceleration), None, False))
        # inf and nan times 0 are nan: so one sum finds an input that is not finite, or so large
        # that the motion overflows
        if (position * self.overflowing + rate * rate + acceleration) * 0.0 != 0.0:
            self._refuse(position, rate, acceleration)
        try:
            compute, as_motion = self._compute_motion
            return as_motion(compute(position, rate, acceleration))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None

    def loads(self, position: ArrayLike, rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0,
              base: Base | None = None) -> NamedFields:
        """
        Return the loads; arguments and errors as in :meth:`motion`, or MissingBodies.

        On a body that moves as ``base`` says, numbers or arrays that broadcast with the input,
        they are those along the axes of that body; it takes the place of gravity.
        """
        if base is None:
            return self.step(position, rate, acceleration)[1]
        if _are_numbers(position, rate, acceleration, *checks.required_base(base)):
            return self.with_base(base).step(position, rate, acceleration)[1]
        if self.bodies is None:
            raise errors.MissingBodies
        from fourbar_ros.mechanisms.batches import loads_on_bases
        return loads_on_bases(self, (position, rate, acceleration), base)

    @cached_property
    def weightless(self) -> Self:
        """Return the same mechanism without all that acts on it: masses alone."""
        external = self.EXTERNAL._make([NOT_APPLIED] * len(self.EXTERNAL._fields))
        return self._with(gravity=(0.0, 0.0), external=external, elements=(), friction=())

    def friction_in(self, n: NumberType, constants: Constants, unit: Scalar,
                    reports: list[Any] | None, rate: Scalar) -> MachineFriction:
        """Return the friction of its joints, for loads at a rate of the input."""
        # unit: of lengths [m]; reports: of loads_in(), or OpenForces of motion by torque
        # few mechanisms have friction
        from fourbar_ros.mechanisms.friction import direction_of
        from fourbar_ros.mechanisms.machine.solve import friction as solve
        kind = (solve.OpenFriction if isinstance(reports, solve.OpenForces)
                else solve.MachineFriction)
        joints = [name if name == DRIVE else self.joint_in_layout(name)
                  for name, _ in self.friction]
        return kind(
            n, self.layout, dict(zip(joints, constants.friction)),
            {joint: friction.length < inf for joint, (_, friction) in zip(joints, self.friction)
             if joint != DRIVE and friction.coefficient}, rate,      # dry: does its block tilt
            direction_of(n, rate, self.slip_speed_in(constants)), unit,
            [] if reports is None else reports)

    @property
    def has_direction(self) -> bool:
        """Return whether what acts depends on its direction: friction, forces one way alone."""
        return bool(self.friction) or any(element.is_one_way for element in self.elements)

    @property
    def slip_speed(self) -> float:
        """Return the rate of the input within which friction is smooth [rad/s], [m/s]; 0: none."""
        friction: Any = dict(self.friction).get(DRIVE)
        return friction.slip_speed if friction else 0.0

    def slip_speed_in(self, constants: Constants) -> Any:
        """Return the slip speed of constants of any number type, None where there is none."""
        return constants.friction[-1].slip_speed if self.slip_speed else None

    def with_slip_speed(self, slip_speed: float) -> Self:
        """Return the same mechanism with a slip speed, where what acts has a direction."""
        # That is friction, and forces over a position that act one way. One that has it keeps it.
        if self.slip_speed or not self.has_direction:
            return self
        from fourbar_ros.mechanisms.friction import DriveFriction  # few mechanisms have any
        friction = dict(self.friction)
        of_drive = friction.get(DRIVE, DriveFriction())
        return self.with_friction({**friction, DRIVE: replace(of_drive, slip_speed=slip_speed)})

    def joint_in_layout(self, joint: str) -> str:
        return joint

    def holding(self, position: ArrayLike) -> tuple[Any, Any]:
        """
        Return the least and the largest drive [N m], [N] that hold it at rest: (lower, upper).

        With less it goes backward, with more forward; at each bound friction is that of a motion
        about to begin that way. An infinite bound: the mechanism locks itself that way, and no
        drive moves it. Without friction both are equal. Arguments and errors as in :meth:`loads`.
        """
        if not self.friction:
            at_rest = getattr(self.loads(position), self.drive_load)
            return at_rest, at_rest
        from fourbar_ros.mechanisms.friction import holding  # few mechanisms have any
        return holding(self, position)

    def locked_ranges(self, rate: float, acceleration: float = 0.0,
                      within: tuple[float, float] | None = None) -> Ranges:
        """
        Return the ranges of the input in which the mechanism locks itself by friction [rad or m].

        ``within``: two inputs; those ranges alone that overlap with the range between them.
        """
        if not (self.friction and self.has_loads):
            return ()
        from fourbar_ros.mechanisms.friction import locked_ranges  # few mechanisms have any
        return locked_ranges(self, rate, acceleration, within)

    def require_no_friction(self, what: str) -> None:
        """Refuse a mechanism with friction for what does not take it, by name."""
        if self.friction:
            raise errors.InvalidParameter(f'friction.{self.friction[0][0]}', None,
                                          f'{what} takes no friction yet')

    @cached_property
    def without_friction(self) -> Self:
        return self._with(friction=()) if self.friction else self

    @property
    def drive_load(self) -> str:
        return 'driving_force' if self.is_driven_by_slide else 'driving_torque'

    def inertia(self, position: ArrayLike) -> Any:
        """
        Return the inertia at the input, J of T = J alpha + b [kg m^2], of a driven slide [kg].

        Arguments and errors as in :meth:`loads`. At another joint that turns ``ratio`` times as
        fast as the input it is J / ratio^2.
        """
        return getattr(self.weightless.loads(position, 0.0, 1.0), self.drive_load)

    def bias(self, position: ArrayLike, rate: ArrayLike = 0.0) -> Any:
        """Return b of T = J alpha + b [N m], [N]: the drive without acceleration."""
        return getattr(self.loads(position, rate, 0.0), self.drive_load)

    def step(self, position: ArrayLike, rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0,
             fields: Iterable[str] | None = None) -> Any:
        """
        Return (motion, loads) together, at the cost of the loads alone.

        Arguments and errors as in :meth:`motion`; ``fields`` may name fields of both. A mechanism
        without masses has no loads: MissingBodies. Where a spring has no direction, as its ends
        meet, there are none either: UnknownForce, in arrays NaN.
        """
        if fields is not None:
            return self._only(fields, (position, rate, acceleration), True)
        compute, as_motion, as_loads = self._compute_step
        if not (type(position) is float and type(rate) is float and type(acceleration) is float):
            if _are_numbers(position, rate, acceleration):
                position, rate, acceleration = map(finite, self.input_coordinate,
                                                   (position, rate, acceleration))
                return self.step(position, rate, acceleration)
            from fourbar_ros.mechanisms.batches import evaluate  # nodes take one sample at a time
            rows = evaluate(self, (position, rate, acceleration), None, True)
            count = len(self.MOTION._fields)
            return as_motion(rows[:count]), as_loads(rows[count:])
        if (position * self.overflowing + rate * rate + acceleration) * 0.0 != 0.0:
            self._refuse(position, rate, acceleration)
        try:
            motion, loads = compute(position, rate, acceleration)
        except errors.UnknownForce:        # of a user's function
            raise
        except (ValueError, ZeroDivisionError):
            motion = self.motion(position, rate, acceleration)      # its error, if it has one
            if not (self.elements and isfinite(motion.condition)):
                raise self._why_no_motion(position) from None
            raise errors.UnknownForce(self.input_coordinate.position, position,
                                      errors.SPRING_ENDS_MEET) from None
        if sum(loads) * 0.0 != 0.0:          # one is not finite, or nearly so
            raise self._why_no_loads(motion)
        return as_motion(motion), as_loads(loads)

    def motion_and_loads(self, position: ArrayLike, rate: ArrayLike = 0.0,
                         acceleration: ArrayLike = 0.0) -> tuple[NamedFields, NamedFields | None]:
        """Return (motion, loads) as :meth:`step` does; if it has no loads these are None."""
        if not self.has_loads:
            return self.motion(position, rate, acceleration), None
        both: tuple[NamedFields, NamedFields] = self.step(position, rate, acceleration)
        return both

    @cached_property
    def overflowing(self) -> float:
        """Return the factor by which an angle that is too far overflows; a slide never is."""
        return 1.0 if self.is_driven_by_slide else 2.0**970       # 2^1024 / FARTHEST

    def checked_input(self, name: str, value: Any) -> float:
        """Return an input as a float; refuse an angle that is too far, and what is no number."""
        position = finite(name, value)
        if not isfinite(position * self.overflowing):
            raise errors.InvalidParameter(name, value, NOT_SO_FAR)
        return position

    def _refuse(self, *values: float) -> NoReturn:
        for name, value in zip(self.input_coordinate, values):
            if not isfinite(value):
                raise errors.InvalidParameter(name, value, 'must be a finite number')
        self.checked_input(self.input_coordinate.position, values[0])
        raise errors.InvalidParameter(self.input_coordinate.rate, values[1],
                                      'so fast that its square overflows')

    def _why_no_loads(self, motion: Sequence[float]) -> errors.FourBarError:
        """Return the error for loads that are not finite in a motion: locked, or too large."""
        fields, driven = self.MOTION._make(motion), self.input_coordinate
        reports = list[Any]()
        if self.friction:
            self.loads_in(REAL, self.constants, fields, reports)
        for report in reports:
            if isnan(report.locks):         # it is 0 where friction leaves the loads a solution
                # joints have other names in the machine that the mechanism is
                names = {self.joint_in_layout(name): name for name, _ in self.friction
                         if name != DRIVE}
                return errors.Locked(driven.position, getattr(fields, driven.position),
                                     driven.unit, [names[joint] for joint in report.joints])
        return errors.InvalidParameter(driven.rate, getattr(fields, driven.rate),
                                       'so fast, or with such masses, that loads overflow')

    def _why_no_motion(self, position: float) -> errors.FourBarError:
        """Return the error for an input at which a square root was not real or a sine zero."""
        name, unit = self.input_coordinate.position, self.input_coordinate.unit
        # A limit and the input compared with it are each rounded, and so is their distance.
        tolerance = 4.0 * EPS * abs(position)
        is_flat = any(self.distance(position, flat) == 0.0 for flat in self.flat_inputs)
        is_at_limit = any(abs(self.distance(position, end)) <= tolerance
                          for ends in self.closing_ranges for end in ends)
        if self.is_in_stroke(position) and (is_flat or is_at_limit):
            return errors.Toggle(name, position, unit)
        return errors.OutOfRange(name, position, self.input_ranges, unit)

    def _only(self, fields: Iterable[str], inputs: tuple[ArrayLike, ArrayLike, ArrayLike],
              with_loads: bool) -> tuple[Any, ...]:
        if isinstance(fields, Iterable) and not isinstance(fields, str):
            fields = tuple(fields)
        wanted, needs_loads = _indices_of(self.MOTION, self.LOADS if with_loads else None, fields)
        if needs_loads:
            self.require_loads()
        if not _are_numbers(*inputs):
            from fourbar_ros.mechanisms.batches import evaluate  # nodes take one sample at a time
            return tuple(evaluate(self, inputs, wanted, needs_loads))
        if needs_loads:
            motion, loads = self.step(*inputs)
            values = [*motion, *loads]
        else:
            values = [*self.motion(*inputs)]
        return tuple([values[i] for i in wanted])


@cache
def _indices_of(motion: NamedFields, loads: NamedFields,
                fields: Any) -> tuple[tuple[int, ...], bool]:
    known = motion._fields + (loads._fields if loads else ())
    for name in fields if isinstance(fields, tuple) else (fields,):
        if name not in known or not isinstance(fields, tuple):
            raise errors.InvalidParameter('fields', name, f'must be some of {", ".join(known)}')
    wanted = tuple(map(known.index, fields))
    return wanted, any(i >= len(motion._fields) for i in wanted)


def _are_numbers(*values: ArrayLike) -> bool:
    return all(isinstance(value, Real) for value in values)
