# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Where a machine closes: the limits of its input, toggles there, the modes beyond them.

Where the dyad RRR between crank and ground is in line the crank turns back, and the dyad's link on
the ground goes on. Driven at that link (:class:`SeenFromLink`), the rod and the crank are a dyad
themselves, from the pin B of the rods to O1:

    (O1)  B = Q + a3 e(p);   RRR of the rod, from B to P, and the crank, from O1 to P

All other dyads hang as before.
"""
from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from decimal import Decimal
from math import hypot, pi, remainder
from typing import ClassVar, NamedTuple, NoReturn, TypeVar

from fourbar_ros.errors import FourBarError, InvalidParameter, Toggle
from fourbar_ros.mechanisms.checks import STROKE, two_numbers
from fourbar_ros.mechanisms.contract import cached_by_lengths, CRANK, CROSSED, OPEN, SLIDE
from fourbar_ros.mechanisms.machine.closings import make_closings
from fourbar_ros.mechanisms.machine.describe.description import (
    Dyad,
    Numbers,
    OF_ONE_MODE,
    RRR,
)
from fourbar_ros.mechanisms.machine.describe.layout import Layout
from fourbar_ros.mechanisms.machine.ranges import (
    Bound,
    Closings,
    DOUBLE,
    find_ranges,
    flat_place,
    Limit,
    SAME,
)
from fourbar_ros.mechanisms.machine.solve.dyads import (
    between,
    Driven,
    DyadMotion,
    ORIGIN,
    rrr,
)
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses
from fourbar_ros.mechanisms.machine.solve.motion import EXACT
from fourbar_ros.mechanisms.machine.solve.pairs import make_moves
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, Ranges
from fourbar_ros.mechanisms.points import Coefficients, FIXED, LinkMotion, point_of
from fourbar_ros.numerics.number_types import NumberType, REAL, Scalar

LIMIT, FLAT_LIMIT, FLAT, TOGGLE, POLE = 'limit', 'flat limit', 'flat', 'toggle', 'pole'
# How near another one is the same: a double root is found beside it as far as the root of its
# rounding error.
SAME_AS = {LIMIT: SAME, FLAT_LIMIT: DOUBLE, FLAT: DOUBLE}


class Singularity(NamedTuple):
    """
    An input at which a dyad of a machine is in line [rad or m].

    ``kind``: 'limit', an end of a range, or 'flat limit', one that is a change point; 'flat', a
    change point through which the motion goes on; off the real inputs 'toggle', or 'pole' where
    the ends of a dyad meet.
    """

    input: complex
    kind: str


_Self = TypeVar('_Self', bound='WithLimits')


class WithLimits(Mechanism):
    """The limits of a machine, from its ``layout``, ``stages`` and their ``signs``."""

    dyads: tuple[Dyad, ...]
    # set for each one when it is made; no fields
    layout: ClassVar[Layout]
    numbers: tuple[Numbers, ...]

    @property
    @abstractmethod
    def stages(self) -> tuple[Dyad, ...]:
        """Return all dyads; a cylinder is one whose slide is driven, and the first."""

    @property
    @abstractmethod
    def signs(self) -> tuple[float, ...]:
        """Return the assembly modes of all dyads as +-1."""

    def require_closing(self) -> None:
        """Raise InvalidParameter for the dyad that cannot be assembled at any input."""
        name = self._closings.stopped
        if name:
            one, other = next((dyad.first.link, dyad.second.link) for dyad in self.stages
                              if dyad.name == name)
            why = (f': it hangs on {one} alone, so no input moves its ends' if one == other else
                   '' if name == self.dyads[0].name else ' at which those before it do')
            raise InvalidParameter(f'dyads.{name}', None, f'cannot close at any input{why}')

    @cached_by_lengths
    def _closings(self) -> Closings:
        """Return where all dyads close; of a slide searched twice as far as lengths and stroke."""
        size = sum(map(abs, self.lengths))
        stroke = two_numbers('stroke', self.stroke, STROKE) if self.stroke is not None else ()
        far = 2.0 * max([size, *map(abs, stroke)])
        found = find_ranges(self.layout, self.numbers, self.signs, (-far, far), self.input_unit)
        if self.input == SLIDE and self.stroke is None and any(
                bound is not None and far in map(abs, (bound[0].x, bound[1].x))
                for bound in found.limits):
            raise InvalidParameter('stroke', self.stroke, 'must be given: no dyad limits the '
                                                          'slide')
        return found

    @cached_by_lengths
    def singularities(self) -> tuple[Singularity, ...]:
        """Return where a dyad is in line: real inputs, then complex ones near ranges."""
        real = [Singularity(complex(end.x), FLAT_LIMIT if end.is_flat else LIMIT)
                for end in self._ends]
        real += [Singularity(complex(x), FLAT) for x in self.flat_inputs]

        def is_new(z: complex) -> bool:
            """Return whether z is none of the real ones, which searches find too, a bit beside."""
            return all(abs(self.distance(z.real, one.input.real) + 1j * z.imag)
                       > SAME_AS[one.kind] * self.input_unit for one in real)
        return (*real,
                *[Singularity(z, TOGGLE) for search in self._closings.near for z in search()
                  if is_new(z)],
                *[Singularity(z, POLE) for search in self._closings.poles for z in search()
                  if is_new(z)])

    @property
    def singular_inputs(self) -> list[complex]:
        """Return the inputs of :attr:`singularities`."""
        return [one.input for one in self.singularities]

    @property
    def flat_inputs(self) -> tuple[float, ...]:
        """Return the inputs of change points through which the motion goes on [rad or m]."""
        return tuple(self._closings.flats)

    @property
    def flat_limits(self) -> tuple[float, ...]:
        """Return the ends of :attr:`closing_ranges` that are change points [rad or m]."""
        return tuple([end.x for end in self._ends if end.is_flat])

    def flat_place(self, place: float) -> Decimal:
        """Return the input of a flat position [rad or m] in many digits."""
        pairs = self._flat_pairs_at(place)
        return flat_place(self.layout, self.numbers, self.signs,
                          min(pairs) if pairs else self._stage_at(place), place)

    @property
    def closing_ranges(self) -> tuple[tuple[float, float], ...]:
        """Return the ranges of the input in which all dyads close [rad or m]."""
        return tuple([(-pi, pi) if bound is None else (bound[0].x, bound[1].x)
                      for bound in self._closings.limits])

    def without_stroke(self: _Self) -> _Self:
        """Return the same machine without a stroke, or with one ten times as long."""
        try:
            return super().without_stroke()
        except InvalidParameter:        # no dyad limits the slide
            assert self.stroke is not None
            low, high = self.stroke
            reach = 4.5 * (high - low)
            return replace(self, stroke=(low - reach, high + reach))

    @property
    def limits(self) -> tuple[Bound, ...]:
        """Return (low, high) of each range, with the dyads at toggles; None: full turns."""
        return self._closings.limits

    @property
    def margins(self) -> tuple[float, ...]:
        """Return nothing: change points of a machine are not differences of lengths."""
        return ()

    @property
    def change_point_margin(self) -> float:
        """Return the distance of the nearest complex toggle from a range, over its size."""
        if self.flat_inputs or self.flat_limits:
            return 0.0
        return min([abs(one.input.imag) / self.input_unit for one in self.singularities
                    if one.kind == TOGGLE], default=1.0)

    @property
    def is_flat_at_zero(self) -> bool:
        """Return whether input 0 is a flat position."""
        return 0.0 in self.flat_inputs

    @property
    def modes(self) -> dict[int, str]:
        """Return {mode: 'DYAD MODE, ...'}: its own, and those into which flat positions lead."""
        modes = dict.fromkeys([self.mode, *map(self.mode_beyond, self.flat_inputs)])
        return {one.mode: ', '.join(f'{dyad.name} {dyad.mode}' for dyad in one.stages
                                    if dyad.kind not in OF_ONE_MODE) or 'one'
                for one in map(self.in_mode, modes)}

    def mode_beyond(self, limit: float) -> int:
        """Return the mode in which a motion goes on smoothly beyond a limit or a flat position."""
        passed = self._flat_pairs_at(limit)
        if not passed:
            number = self._stage_at(limit)
            if self.stages[number].kind in OF_ONE_MODE:     # goes on in x, not in its root
                return self.mode
            passed = frozenset({number})
        return 1 + ((self.mode - 1) ^ sum(1 << number for number in passed))

    @property
    def modes_passed(self) -> tuple[int, ...]:
        """Return the modes between which a motion goes on: at flat positions and toggles."""
        ends = [end.x for end in self._ends if end.dyad]
        return tuple(sorted({*self.modes, *map(self.mode_beyond, ends)}))

    def driven_otherwise(self) -> tuple[SeenFromLink, ...]:
        """Return the machine driven at a link on the ground, if its dyad alone stops the crank."""
        names = {end.dyad for end in self._ends}
        dyads = [i for i, dyad in enumerate(self.stages) if {dyad.name} == names]
        if self.input != CRANK or not dyads or not can_drive(self.stages[dyads[0]],
                                                             self.layout.driven):
            return ()
        return tuple([SeenFromLink(self.layout, self.numbers, self.signs, dyads[0], mode)
                      for mode in (CROSSED, OPEN)])

    @property
    def _ends(self) -> list[Limit]:
        return [end for bound in self.limits if bound for end in bound]

    def _flat_pairs_at(self, place: float) -> frozenset[int]:
        """Return the numbers of the pairs that lie flat at an input without stopping motion."""
        return next((pairs for flat, pairs in self._closings.flats.items()
                     if abs(self.distance(place, flat)) < SAME * self.input_unit), frozenset())

    def _stage_at(self, place: float) -> int:
        """Return the number of the dyad at the limit next to an input."""
        end = min(self._ends, key=lambda end: abs(self.distance(place, end.x)))
        return [dyad.name for dyad in self.stages].index(end.dyad)

    def _why_no_motion(self, position: float) -> FourBarError:
        """Return OutOfRange, or Toggle with its dyad, for an input at which there is no motion."""
        error = super()._why_no_motion(position)
        unit = self.input_coordinate.unit
        if isinstance(error, Toggle):
            pairs = self._closings.flats.get(position)
            return Toggle(error.name, position, unit, self.stages[
                min(pairs) if pairs else self._stage_at(position)].name)
        place, turns = position, [0.0]
        if not self.is_driven_by_slide:
            place, turns = remainder(position, 2.0 * pi), [-2.0 * pi, 0.0, 2.0 * pi]
        # within a range all dyads close, so that one of them is at a toggle
        if self.is_in_stroke(position) and any(
                low <= place + turn <= high for low, high in self.closing_ranges
                for turn in turns):
            return Toggle(self.input_coordinate.position, position, unit, self._dyad_at(place))
        return error

    def _dyad_at(self, position: float) -> str:
        """Return the name of the first dyad that cannot be solved at an input."""
        for number in range(len(self.stages) - 1):
            try:
                make_closings(REAL, self.layout, self.numbers, self.signs, number + 2)(position)
            except (ValueError, ZeroDivisionError):
                return self.stages[number].name
        return self.stages[-1].name


def can_drive(dyad: Dyad, driven: str) -> bool:
    """Return whether a dyad is RRR between crank and ground, so that it can turn the crank."""
    ends = {dyad.first.link: dyad.first, dyad.second.link: dyad.second}
    return (dyad.kind == RRR and set(ends) == {driven, GROUND}
            and any(ends[driven][1:]) and any(ends[GROUND][1:]))


class SeenFromLink:
    """
    A machine driven at a link on the ground, whose angle is the coordinate p [rad].

    ``layout``, ``numbers``, ``signs``: as for :func:`.motion.motion_of`; ``number``: of the dyad
    that has this link; ``mode`` 2: from the rod, B to P, to the crank, O1 to P, one turns left by
    less than pi, 1: right. It never lies flat.
    """

    change_point_margin, input_unit, is_driven_by_slide, turns_fully = 1.0, 1.0, False, False
    input_ranges: Ranges = ()
    flat_inputs: tuple[float, ...] = ()

    def __init__(self, layout: Layout, numbers: Sequence[Numbers], signs: Sequence[float],
                 number: int, mode: int) -> None:
        """Keep the structure, and which link of the dyad drives."""
        self._layout, self._numbers, self._signs = layout, numbers, signs
        self._number, self.mode = number, mode
        stage = layout.stages[number]
        self._is_rod_first = stage.second == 0      # the dyad's second link is then on the ground
        self._link = stage.number - 1 + int(self._is_rod_first)     # among the moving ones

    def in_mode(self, mode: int) -> SeenFromLink:
        """Return the same in another assembly mode."""
        return SeenFromLink(self._layout, self._numbers, self._signs, self._number, mode)

    def distance(self, one: float, other: float) -> float:
        """Return one angle less another, the short way round [rad]."""
        return remainder(one - other, 2.0 * pi)

    def mode_beyond(self, _limit: float) -> int:
        """Return the other mode."""
        return 3 - self.mode

    def motion(self, position: float, *_: float) -> NoReturn:
        """Refuse an angle at which the dyad does not close, which an integrator may try."""
        link = self._layout.moving[self._link]
        raise FourBarError(f'theta_{link} = {position!r}: the links do not close')

    def make_coefficients(self, numbers: NumberType) -> Coefficients:
        """Return p -> coefficients of all links, as those of a mechanism."""
        inverse, number = self._make_inverse(numbers), self._number
        hanging = hangings(self._layout, self._numbers)
        work = make_moves(numbers, self._layout, self._numbers, self._signs)

        def coefficients(position: Scalar) -> list[LinkMotion]:
            """Return the curves of all links: first crank and dyad, then the other dyads."""
            crank, one, two = inverse(position)
            poses, curves = Poses(hanging, Driven(crank, EXACT)), [crank]
            for i, moves in enumerate(work):
                moved = (DyadMotion(one, two, (), 1.0, 0.0, {}) if i == number
                         else moves(*poses.hang(i)))
                curves += poses.add(i, moved)
            return curves
        return coefficients

    def _make_inverse(self, n: NumberType
                      ) -> Callable[[Scalar], tuple[LinkMotion, LinkMotion, LinkMotion]]:
        """Return p -> curves of the crank and of both links of the dyad, (O1)."""
        own, is_rod_first = self._numbers[self._number], self._is_rod_first
        pin, at_q, (rod, output) = own.p, own.q, own.sizes
        if not is_rod_first:
            pin, at_q, rod, output = at_q, pin, output, rod
        length = hypot(*pin)
        sign = 1.0 if self.mode == 2 else -1.0
        sin, cos, c0, s0 = n.sin, n.cos, pin[0] / length, pin[1] / length

        def inverse(p: Scalar) -> tuple[LinkMotion, LinkMotion, LinkMotion]:
            """Return crank, first and second link of the dyad at an angle p, by (O1)."""
            driven = LinkMotion(*point_of(FIXED, *at_q), cos(p), sin(p), 1.0, 0.0)
            at_b = point_of(driven, output, 0.0)
            first, arm, *_ = rrr(n, sign, (rod, length), at_b, ORIGIN, between(at_b, ORIGIN),
                                 FIXED, FIXED)
            crank = LinkMotion(*ORIGIN, arm.cosine * c0 + arm.sine * s0,
                               arm.sine * c0 - arm.cosine * s0, arm.omega, arm.alpha)
            coupler = LinkMotion(*point_of(crank, *pin), -first.cosine, -first.sine,
                                 first.omega, first.alpha)
            return crank, *((coupler, driven) if is_rod_first else (driven, coupler))
        return inverse

    def read_coordinate(self, numbers: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        """Return p in (-pi, pi] and its two derivatives from coefficients of the links."""
        link = curves[self._link]
        return numbers.atan2(link.sine, link.cosine), link.omega, link.alpha
