# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What acts on a mechanism besides weight and constant forces: springs, dampers, position forces.

A force over a position is a function F(s) of one position s of the mechanism: of the input, of the
angle of a link, or of the way of a point.

Each element states its physics once, for any number type: equations (E5) and (E7) of
:mod:`fourbar_ros.dynamics.equation`, from the motions of the links (and the ground) it acts on.
Loads take its forces as external forces of the links, :func:`applied_in`.
"""
from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, KW_ONLY, replace
from functools import cached_property
from math import ceil, degrees, inf, lcm, remainder, tau
from typing import Any, ClassVar, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter, UnknownForce
from fourbar_ros.mechanics.bodies import Applied, NOT_APPLIED, unchecked
from fourbar_ros.mechanisms.curves import between, FIXED, LinkMotion, MovingPoint, point_of
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.parts import GROUND, NamedFields
from fourbar_ros.numerics.arguments import check_quantities, finite, quantity
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import converted, direction, NumberType, Scalar
from fourbar_ros.numerics.tables import slope_of
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.evaluation import Constants
    from fourbar_ros.mechanisms.geometry import MechanismGeometry
    from fourbar_ros.mechanisms.mechanism import Mechanism

LinkMotions = Mapping[str, LinkMotion]      # by name of the link, the ground among them
# After how many turns of a crank a function of its angle is looked at to repeat, and how: at so
# many angles of each turn, to this part of the largest value.
MOST_TURNS, PER_TURN, REPEATS = 4, 64, 1e-9


class ForceOnLink(NamedTuple):
    """A force [N] at a point [m] and a couple [N m] on a link, along the ground axes."""

    link: str
    x: Scalar
    y: Scalar
    force_x: Scalar
    force_y: Scalar
    couple: Scalar


@dataclass(frozen=True)
class Attachment:
    """A point of a link or of the ground: along it from its first joint, and to its left [m]."""

    link: str = GROUND
    along: float = quantity(0.0)
    across: float = quantity(0.0)

    def __post_init__(self) -> None:
        check_quantities(self)

    def on(self, link: LinkMotion) -> MovingPoint:
        return point_of(link, self.along, self.across)


@dataclass(frozen=True)
class Spring:
    """
    Linear spring and damper between two points of different links.

    Stiffness [N/m]; by name ``free_length`` [m], ``damping`` [N s/m], zero or more, and
    ``preload`` [N], its tension at the free length: the initial tension of an extension spring.
    """

    first: Attachment
    second: Attachment
    stiffness: float = quantity(0.0, least=0.0)
    _: KW_ONLY
    free_length: float = quantity(0.0, least=0.0)
    damping: float = quantity(0.0, least=0.0)
    preload: float = quantity(0.0)
    # without both it has no force where its ends meet, with one of them no direction there
    has_length: bool = field(init=False, repr=False)
    has_damping: bool = field(init=False, repr=False)
    is_one_way: ClassVar[bool] = False

    def __post_init__(self) -> None:
        _require_kind('first', self.first, Attachment)
        _require_kind('second', self.second, Attachment)
        check_quantities(self)
        _require_two_links(self)
        object.__setattr__(self, 'has_length', self.free_length != 0.0 or self.preload != 0.0)
        object.__setattr__(self, 'has_damping', self.damping != 0.0)

    @property
    def links(self) -> tuple[str, str]:
        return self.first.link, self.second.link

    def tension(self, n: NumberType, links: LinkMotions) -> tuple[Scalar, Scalar, Scalar]:
        """Return (k (l - l0) + F0) / l, r.r' and l^2 of (E5): pull, stretching over the length."""
        x, y, dx, dy, _, _ = _apart(self.first, self.second, links)
        square = x * x + y * y
        pull = self.stiffness
        if self.has_length:
            pull = pull - (self.stiffness * self.free_length - self.preload) / n.sqrt(square)
        return pull, x * dx + y * dy, square

    def energy(self, n: NumberType, links: LinkMotions) -> Scalar:
        gap = _apart(self.first, self.second, links)
        stretch: Scalar = n.sqrt(gap.x * gap.x + gap.y * gap.y) - self.free_length
        return (0.5 * self.stiffness * stretch + self.preload) * stretch

    def forces(self, n: NumberType, links: LinkMotions, *_: Scalar) -> list[ForceOnLink]:
        pull = _damped(self, n, links)
        p, q = self.first.on(links[self.first.link]), self.second.on(links[self.second.link])
        x, y = q.x - p.x, q.y - p.y
        return [ForceOnLink(self.first.link, p.x, p.y, pull * x, pull * y, 0.0),
                ForceOnLink(self.second.link, q.x, q.y, -pull * x, -pull * y, 0.0)]


@dataclass(frozen=True)
class TorsionSpring:
    """
    Torsion spring and damper between two links, or a link and the ground.

    It acts on the angle of the second relative to the first: stiffness [N m/rad]; by name
    ``free_angle`` [rad], at which it exerts no moment, and ``damping`` [N m s/rad]. Stiffness and
    damping are zero or more. The deflection counts within half a turn.
    """

    first: str
    second: str
    stiffness: float = quantity(0.0, least=0.0)
    _: KW_ONLY
    free_angle: float = quantity(0.0)
    damping: float = quantity(0.0, least=0.0)
    free_direction: tuple[float, float] = field(init=False, repr=False)
    has_damping: bool = field(init=False, repr=False)
    is_one_way: ClassVar[bool] = False

    def __post_init__(self) -> None:
        check_quantities(self)
        _require_two_links(self)
        object.__setattr__(self, 'free_direction', direction(self.free_angle))
        object.__setattr__(self, 'has_damping', self.damping != 0.0)

    @property
    def links(self) -> tuple[str, str]:
        return self.first, self.second

    def deflection(self, n: NumberType, links: LinkMotions) -> Scalar:
        """Return the angle from the first link to the second, less the free one, in (-pi, pi]."""
        cosine, sine = _turned(links[self.first], links[self.second])
        cos_0, sin_0 = self.free_direction
        return n.atan2(sine * cos_0 - cosine * sin_0, cosine * cos_0 + sine * sin_0)

    def tension(self, n: NumberType, links: LinkMotions) -> tuple[Scalar, Scalar, Scalar]:
        """Return k (a - a0), a' and 1 of (E5): moment and growth of the angle."""
        return (self.stiffness * self.deflection(n, links),
                links[self.second].omega - links[self.first].omega, 1.0)

    def energy(self, n: NumberType, links: LinkMotions) -> Scalar:
        stretch = self.deflection(n, links)
        return 0.5 * self.stiffness * stretch * stretch

    def forces(self, n: NumberType, links: LinkMotions, *_: Scalar) -> list[ForceOnLink]:
        moment, first, second = _damped(self, n, links), links[self.first], links[self.second]
        return [ForceOnLink(self.first, first.x, first.y, 0.0, 0.0, moment),
                ForceOnLink(self.second, second.x, second.y, 0.0, 0.0, -moment)]


@dataclass(frozen=True)
class TableForce:
    """The function s -> F(s) of a table, of floats and arrays, real or complex."""

    # middle: s is an angle that counts within half a turn of it; None: it is no such angle.
    table: ForceTable
    middle: float | None

    def __call__(self, s: Any) -> Any:
        """Return the force [N] or couple [N m] at s, a float or an array."""
        return self.table(self._counted(s))

    def slope(self, s: Array) -> Array:
        return self.table.slope(self._counted(s))

    def _counted(self, s: Any) -> Any:
        """Return s within half a turn of the middle; such a one stays to the bit, as at a jump."""
        middle = self.middle
        if middle is None:
            return s
        if isinstance(s, np.ndarray):
            return s - tau * np.round((s.real - middle) / tau)
        away = float(s) - middle
        return s if abs(away) <= 0.5 * tau else type(s)(middle + remainder(away, tau))

    @cached_property
    def largest(self) -> float:
        """Return the largest size of F, whose rounding is the error of all values."""
        return max(map(abs, self.table.values))

    @property
    def period(self) -> float:
        """Return after which way F is the same again; infinite where it never is."""
        return (tau if self.middle is not None else
                self.table.span if self.table.is_periodic else inf)

    @cached_property
    def ends(self) -> list[float]:
        """Return the points s of a period and two more on either side, infinite without it."""
        points = self.table.starts[:-1 if self.table.is_periodic else None]
        cycles = ceil(2 / len(points))         # so many on either side have two points
        return [point + turn * self.period if turn else point
                for turn in range(-cycles, cycles + 1) for point in points]

    def polynomial(self, s: float) -> tuple[list[float], float, float, float]:
        """
        Return F about s: coefficients, highest first, of s less an offset, that too, and two s.

        Between these two F is this polynomial.
        """
        table, middle, turns = self.table, self.middle, 0.0
        low, high = -inf, inf
        if middle is not None:
            turns = tau * round((s - middle) / tau)
            low, high = middle - 0.5 * tau + turns, middle + 0.5 * tau + turns
        elif table.is_periodic:
            turns = table.span * ((s - table.places[0]) // table.span)
        i, starts = bisect_right(table.starts, s - turns), table.starts
        *coefficients, start = table.pieces[i]
        return (coefficients, start + turns, max(low, starts[i - 1] + turns) if i else low,
                min(high, starts[i] + turns) if i < len(starts) else high)

    def piece(self, s: float) -> tuple[float, float]:
        """Return the two points of the table next to s: between them F is one polynomial."""
        base, first = self._counted(s), self.table.places[0]
        if self.table.is_periodic and not 0.0 <= s - first < self.table.span:
            base = first + (s - first) % self.table.span
        i, shift = bisect_right(self.ends, base), s - base
        return self.ends[i - 1] + shift, self.ends[i] + shift


@dataclass(frozen=True)
class UserForce:
    """A user's function s -> F(s), of floats and arrays; its slope is a central difference."""

    function: Callable[[float], float]
    counts_turns: bool = False      # s is the angle of a crank that turns fully

    def __call__(self, s: Any) -> Any:
        """Return the force at s; of one s UnknownForce if the value is no finite number."""
        # of arrays such values stay: their samples are NaN. s may be a Decimal, and so the result
        if not isinstance(s, np.ndarray):
            value = self.function(float(s))
            try:
                return type(s)(finite('value', value))
            except InvalidParameter:
                raise UnknownForce('value', value,
                                   f'at {float(s)!r} must be a finite number') from None
        if np.iscomplexobj(s):
            return self(s.real) + 1j * slope_of(self, s.real) * s.imag
        return np.vectorize(lambda x: self.function(float(x)), otypes=[float])(s)

    @cached_property
    def turns(self) -> int:
        """Return after how many turns of the crank F repeats, up to MOST_TURNS; 0: it does not."""
        if not self.counts_turns:
            return 1
        # at no angle that is a multiple of a degree, where it may jump
        s = tau * (np.arange(-MOST_TURNS * PER_TURN, MOST_TURNS * PER_TURN) + 0.37) / PER_TURN
        with suppress(Exception):       # it may be one of some angles only, and raise anything
            values = self(s).reshape(-1, PER_TURN)
            least = REPEATS * np.abs(values).max()
            for turns in range(1, MOST_TURNS + 1):
                if (np.abs(values[turns:] - values[:-turns]) <= least).all():
                    return turns
        return 0


BOTH, FORWARD, BACKWARD = 'both', 'forward', 'backward'     # when a force acts
INPUT = 'input'        # s of a force over the input of the mechanism, an angle or a slide


@dataclass(frozen=True)
class LinkAngle:
    """The angle of a link, from that of a second link or of the ground [rad], in (-pi, pi]."""

    link: str
    relative_to: str = GROUND

    @property
    def links(self) -> tuple[str, str]:
        return self.link, self.relative_to

    def of(self, n: NumberType, links: LinkMotions) -> Scalar:
        cosine, sine = _turned(links[self.relative_to], links[self.link])
        return n.atan2(sine, cosine)

    def grows(self, links: LinkMotions) -> Scalar:
        """Return a number with the sign of its rate."""
        return links[self.link].omega - links[self.relative_to].omega


@dataclass(frozen=True)
class Way:
    """
    How far a point has come along a line from its origin [m].

    The line's direction [rad] is from the direction of the origin's link, of the ground from x.
    """

    point: Attachment
    origin: Attachment = Attachment()
    direction: float = quantity(0.0)
    unit_vector: tuple[float, float] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        _require_kind('point', self.point, Attachment)
        _require_kind('origin', self.origin, Attachment)
        check_quantities(self)
        object.__setattr__(self, 'unit_vector', direction(self.direction))

    @property
    def links(self) -> tuple[str, str]:
        return self.point.link, self.origin.link

    def of(self, n: NumberType, links: LinkMotions) -> Scalar:
        gap, (x, y) = _apart(self.origin, self.point, links), _along(
            self.unit_vector, links[self.origin.link])
        return gap.x * x + gap.y * y

    def grows(self, links: LinkMotions) -> Scalar:
        origin = links[self.origin.link]
        gap, (x, y) = _apart(self.origin, self.point, links), _along(self.unit_vector, origin)
        return gap.v_x * x + gap.v_y * y + origin.omega * (gap.y * x - gap.x * y)


@dataclass(frozen=True)
class Distance:
    """The distance of a point from another one [m], as the length of a gas strut."""

    point: Attachment
    origin: Attachment

    def __post_init__(self) -> None:
        _require_kind('point', self.point, Attachment)
        _require_kind('origin', self.origin, Attachment)

    @property
    def links(self) -> tuple[str, str]:
        return self.point.link, self.origin.link

    def of(self, n: NumberType, links: LinkMotions) -> Scalar:
        gap = _apart(self.origin, self.point, links)
        return n.sqrt(gap.x * gap.x + gap.y * gap.y)

    def grows(self, links: LinkMotions) -> Scalar:
        gap = _apart(self.origin, self.point, links)
        return gap.x * gap.v_x + gap.y * gap.v_y


Over = str | LinkAngle | Way | Distance        # INPUT and these: the s of a force


@dataclass(frozen=True)
class PositionForce:
    """
    A force or a couple on a moving link that depends on the position of the mechanism.

    Parameters
    ----------
    point : Attachment
        Where it acts; for a couple only its link counts.
    value : ForceTable or callable
        s -> F(s): floats, [N] or [N m]. A table over an angle holds for all turns: s counts within
        half a turn of its middle, or it is periodic. A function of the angle of a crank that turns
        fully repeats after a turn, or up to four; only motion by torque takes one that never does.
    over : 'input', LinkAngle, Way or Distance
        The position s. The input of a crank counts on over whole turns, so a table of two turns
        serves a four-stroke engine; other angles are in (-pi, pi].
    direction : float, optional
        Direction of the force, from that of the link ``axes`` or of the ground [rad]; None: a
        couple, counter-clockwise positive.
    factor : float
        Multiplies F(s): for a table of pressures the area [m^2], with its sign.
    apart_from : Attachment, optional
        A point of another link or of the ground: the force pushes both points apart, as a gas
        strut does, and has no other ``direction``.
    when : 'both', 'forward' or 'backward'
        It acts always, or only while s grows or falls, as a cut does; not at rest. What acts
        always gives back on the way back what it takes.

    """

    point: Attachment
    value: Any      # ForceTable or callable; on a mechanism a TableForce or a UserForce
    over: Over = INPUT
    direction: float | None = quantity(0.0, instead=None)
    axes: str = GROUND
    factor: float = quantity(1.0)
    apart_from: Attachment | None = None
    when: str = BOTH
    unit_vector: tuple[float, float] | None = field(init=False, repr=False)

    def __post_init__(self) -> None:
        _require_kind('point', self.point, Attachment)
        if self.point.link == GROUND:
            raise InvalidParameter('point', GROUND, 'a force acts on a moving link')
        if not callable(self.value):
            raise InvalidParameter('value', self.value, 'must be a ForceTable or a function')
        if not (isinstance(self.over, (LinkAngle, Way, Distance)) or self.over == INPUT):
            raise InvalidParameter('over', self.over, f'must be {INPUT!r}, a LinkAngle, a Way or '
                                                      'a Distance')
        if self.apart_from is not None:
            _require_kind('apart_from', self.apart_from, Attachment)
            if self.apart_from.link == self.point.link:
                raise InvalidParameter('apart_from', self.point.link,
                                       'must be on another link than the point')
        if self.when not in (BOTH, FORWARD, BACKWARD):
            raise InvalidParameter('when', self.when, f'must be {BOTH}, {FORWARD} or {BACKWARD}')
        check_quantities(self)
        object.__setattr__(self, 'unit_vector',
                           None if self.direction is None else direction(self.direction))

    @property
    def links(self) -> tuple[str, ...]:
        """Return the names of all links that it depends on, the loaded link first."""
        links_of_s = () if isinstance(self.over, str) else self.over.links
        second = (self.apart_from.link,) if self.apart_from else ()
        return self.point.link, self.axes, *links_of_s, *second

    @property
    def is_one_way(self) -> bool:
        return self.when != BOTH

    def position(self, n: NumberType, links: LinkMotions, input_position: Scalar) -> Scalar:
        return input_position if isinstance(self.over, str) else self.over.of(n, links)

    def _push(self, n: NumberType, links: LinkMotions, position: Scalar, rate: Scalar,
              direction: Scalar) -> tuple[Scalar, Scalar, Scalar, MovingPoint]:
        """Return F, the unit vector along which it acts, of a couple (0, 0), and what moves so."""
        # direction: in which the links move over that in which rate and they are given, its size
        # the share of a force one way.
        size = self.factor * n.call(self.value, self.position(n, links, position))
        if self.is_one_way:
            grows = rate if isinstance(self.over, str) else self.over.grows(links)
            grows, size = grows * direction, size * n.fabs(direction)
            is_acting = grows.real > 0.0 if self.when == FORWARD else grows.real < 0.0
            size = n.where(is_acting, size, 0.0)
        if self.apart_from is not None:
            gap = _apart(self.apart_from, self.point, links)
            length = n.sqrt(gap.x * gap.x + gap.y * gap.y)
            return size, gap.x / length, gap.y / length, gap
        point = self.point.on(links[self.point.link])
        if self.unit_vector is None:
            return size, 0.0, 0.0, point
        return size, *_along(self.unit_vector, links[self.axes]), point

    def generalised(self, n: NumberType, links: LinkMotions, position: Scalar,
                    direction: Scalar = 1.0) -> Scalar:
        """Return Q of (E7) in a pose at an input; ``direction`` of it, of a force one way."""
        size, x, y, moved = self._push(n, links, position, 1.0, direction)
        if self.unit_vector is None and self.apart_from is None:
            return size * links[self.point.link].omega
        return size * (x * moved.v_x + y * moved.v_y)

    def forces(self, n: NumberType, links: LinkMotions, position: Scalar, rate: Scalar,
               share: Scalar) -> list[ForceOnLink]:
        """Return the force on its link, and on a second one, at an input and its rate."""
        # share: of it that acts if it acts one way, 1 but at a rate within the slip speed.
        size, x, y, _ = self._push(n, links, position, rate, share)
        is_couple = self.unit_vector is None and self.apart_from is None
        on_link = [(self.point, size)]
        if self.apart_from is not None:
            on_link.append((self.apart_from, -size))
        acting = []
        for end, push in on_link:
            point = end.on(links[end.link])
            acting.append(ForceOnLink(end.link, point.x, point.y, push * x, push * y,
                                      push if is_couple else 0.0))
        return acting

    @property
    def turns(self) -> int:
        """Return after how many turns of the crank it repeats, 2 of a four-stroke; 0: never."""
        value: TableForce | UserForce = self.value
        if isinstance(value, UserForce):
            return value.turns
        return max(1, round(value.table.span / tau)) if value.table.is_periodic else 1

    def fitted(self, mechanism: MechanismGeometry) -> PositionForce:
        """Return the force on a mechanism: ``value`` is a TableForce or a UserForce."""
        # Raises InvalidParameter for a table that does not fit the mechanism.
        table = self.value.table if isinstance(self.value, TableForce) else self.value
        counts_turns = mechanism.turns_fully and self.over == INPUT
        if not isinstance(table, ForceTable):
            function = table.function if isinstance(table, UserForce) else table
            return replace(self, value=UserForce(function, counts_turns))
        is_angle = (not mechanism.is_driven_by_slide if self.over == INPUT
                    else isinstance(self.over, LinkAngle))
        _require_fitting(table, is_angle, counts_turns)
        return replace(self, value=TableForce(
            table, table.middle if is_angle and not table.is_periodic else None))


def _require_fitting(table: ForceTable, is_angle: bool, counts_turns: bool) -> None:
    """Refuse a table whose period or range does not fit the position over which it is given."""
    # A table over a length cannot be periodic. Over an angle its period must be a part of a turn.
    # Over the input of a crank that turns fully, turns are counted, and it may be several turns.
    turns = table.span / tau
    if table.is_periodic:
        if not is_angle:
            raise InvalidParameter('is_periodic', True, 'a length does not come round: only over '
                                                        'an angle is a table periodic')
        count = max(turns, 1.0 / turns)
        if abs(count - round(count)) > 1e-9 * count or (turns > 1.5 and not counts_turns):
            more = (', or some turns' if counts_turns else
                    ': turns are counted of a crank that is driven and turns fully')
            raise InvalidParameter('places', None, 'the period must be a turn, or a whole part of '
                                   f'it{more}, not {degrees(table.span):.9g} deg')
    elif is_angle and turns > 1.0 + 1e-9:
        raise InvalidParameter('places', None, 'more than a turn of an angle, and not periodic')
    elif counts_turns and table.values[0] != table.values[-1]:
        raise InvalidParameter('values', None, 'the crank turns fully: the last value must be the '
                                               'first again')


def refuses_turns(element: Element) -> bool:
    """Return whether it fits no crank that turns fully, but one that turns back: its table."""
    if not isinstance(element, PositionForce) or element.over != INPUT:
        return False
    table = getattr(element.value, 'table', None)
    return table is not None and not table.is_periodic and table.values[0] != table.values[-1]


Element = Spring | TorsionSpring | PositionForce


def _require_kind(name: str, value: Any, kind: type) -> None:
    if not isinstance(value, kind):
        raise InvalidParameter(name, value, f'must be of type {kind.__name__}')


def _require_two_links(element: Spring | TorsionSpring) -> None:
    first, second = element.links
    if first == second:
        raise InvalidParameter('second', second, 'must be on another link than the first')


def _apart(first: Attachment, second: Attachment, links: LinkMotions) -> MovingPoint:
    return between(first.on(links[first.link]), second.on(links[second.link]))


def _turned(first: LinkMotion, second: LinkMotion) -> tuple[Scalar, Scalar]:
    return (first.cosine * second.cosine + first.sine * second.sine,
            first.cosine * second.sine - first.sine * second.cosine)


def _along(unit: tuple[float, float], axes: LinkMotion) -> tuple[Scalar, Scalar]:
    """Return a unit vector given along a link, along the ground axes."""
    (c, s), cosine, sine = unit, axes.cosine, axes.sine
    return c * cosine - s * sine, c * sine + s * cosine


def _damped(element: Spring | TorsionSpring, n: NumberType, links: LinkMotions) -> Scalar:
    pull, growth, square = element.tension(n, links)
    return pull + element.damping * growth / square if element.has_damping else pull


def links_of(elements: Sequence[Element]) -> list[str]:
    """Return the moving links that elements name."""
    # Each once, in a fixed order: a formula recorded in another process has the same lines.
    return sorted({link for element in elements for link in element.links} - {GROUND}, key=str)


def fitted(elements: Any, mechanism: MechanismGeometry) -> tuple[Element, ...]:
    """Return elements as they act on a mechanism; InvalidParameter for one that does not fit."""
    elements = tuple(elements) if isinstance(elements, Iterable) else (elements,)
    for element in elements:
        if not isinstance(element, (Spring, TorsionSpring, PositionForce)):
            raise InvalidParameter('elements', element, 'must be Spring, TorsionSpring or '
                                                        'PositionForce, any of them')
    links = [link.name for link in mechanism.LINKS]
    for link in links_of(elements):
        if link not in links:
            raise InvalidParameter('link', link, f'must be one of {", ".join(links)}, {GROUND}')
    return tuple([element.fitted(mechanism) if isinstance(element, PositionForce) else element
                  for element in elements])


def structure_of(elements: Sequence[Element]) -> Hashable:
    """Return what the formula of elements depends on besides their numbers."""
    without_numbers: Hashable = converted(tuple(elements), lambda _: 0.0)
    return without_numbers


def turns_of(elements: Sequence[Element]) -> int:
    """Return after how many turns of the crank all of them repeat that ever do."""
    return lcm(*[element.turns or 1 for element in elements if isinstance(element, PositionForce)])


def require_cycle(elements: Sequence[Element]) -> None:
    """Refuse forces that never repeat, of which nothing can be said over a cycle."""
    if any(isinstance(element, PositionForce) and not element.turns for element in elements):
        raise InvalidParameter('value', None, 'a function of the angle of a crank that turns '
                               f'fully must repeat after a turn, or up to {MOST_TURNS}: extrema '
                               'and means are those of a cycle')


def applied_in(n: NumberType, mechanism: Mechanism, constants: Constants, motion: NamedFields
               ) -> Any:
    """Return what acts on each link in a motion: its constant force and all elements."""
    # The forces of elements on a link act at the point of its constant force; those on the ground
    # are left out. Numbers are of the type n, and not checked to be finite.
    driven = mechanism.input_coordinate
    moving = {**mechanism.link_motions(motion, constants.lengths), GROUND: FIXED}
    position, rate = getattr(motion, driven.position), getattr(motion, driven.rate)
    share: Scalar = 1.0     # of forces one way: they fade within the slip speed, (J4)
    if mechanism.slip_speed:
        from fourbar_ros.mechanisms.friction import direction_of  # few mechanisms have any
        share = n.fabs(direction_of(n, rate, mechanism.slip_speed_in(constants)))
    acting = [force for element in constants.elements
              for force in element.forces(n, moving, position, rate, share)]
    return constants.external._replace(**{link: _sum_of(
        getattr(constants.external, link, NOT_APPLIED), moving[link],
        [force for force in acting if force.link == link])
        for link in links_of(mechanism.elements)})


def _sum_of(constant: Applied, link: LinkMotion, acting: Sequence[ForceOnLink]) -> Applied:
    """Return the external force that does the same as a constant one and more on its link."""
    # It acts at the point of the constant force: moments of the others about that point are added.
    point = point_of(link, constant.along, constant.across)
    couple, force_x, force_y = 0.0, 0.0, 0.0
    for force in acting:                  # in a loop: sum() rounds otherwise from Python 3.12 on
        couple = couple + (force.couple + (force.x - point.x) * force.force_y
                           - (force.y - point.y) * force.force_x)
        force_x, force_y = force_x + force.force_x, force_y + force.force_y
    return unchecked(Applied, constant.force_x + force_x, constant.force_y + force_y,
                     constant.along, constant.across, constant.couple + couple)
