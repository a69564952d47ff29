# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Springs and dampers between any two points or links of a mechanism; forces over a position.

A force over a position is a function F(s) of one position s of the mechanism: of the input, of the
angle of a link, or of the way of a point.

Each element states its physics once, for any number type: equations (E5) and (E7) of
:mod:`fourbar_ros.dynamics.equation`, from the motions of the links (and the ground) it acts on.
"""
from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, KW_ONLY
from functools import cached_property
from math import ceil, cos, inf, remainder, sin, tau
from typing import Any, NamedTuple, Union

from fourbar_ros.dynamics.force_table import ForceTable
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.curves import LinkMotion, MovingPoint, point_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_fields import check_quantities, quantity
from fourbar_ros.numerics.number_types import direction, NumberType, Scalar
import numpy as np

LinkMotions = Mapping[str, LinkMotion]      # by name of the link, the ground among them


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
        """Return the motion of the point from that of its link."""
        return point_of(link, self.along, self.across)


@dataclass(frozen=True)
class Spring:
    """
    Linear spring and damper between two points of different links.

    Stiffness [N/m]; by name ``free_length`` [m], at which it exerts no force, and ``damping``
    [N s/m]: zero or more.
    """

    first: Attachment
    second: Attachment
    stiffness: float = quantity(0.0, least=0.0)
    _: KW_ONLY
    free_length: float = quantity(0.0, least=0.0)
    damping: float = quantity(0.0, least=0.0)

    def __post_init__(self) -> None:
        check_quantities(self)
        _require_two_links(self)

    @property
    def links(self) -> tuple[str, str]:
        return self.first.link, self.second.link

    def tension(self, n: NumberType, links: LinkMotions) -> tuple[Scalar, Scalar, Scalar]:
        """Return k (1 - l0/l), r.r' and l^2 of (E5): pull and stretching over the length."""
        x, y, dx, dy, _, _ = _apart(self.first, self.second, links)
        square = x * x + y * y
        share = self.free_length / square**0.5 if self.free_length else 0.0
        return self.stiffness * (1.0 - share), x * dx + y * dy, square

    def energy(self, n: NumberType, links: LinkMotions) -> Scalar:
        gap = _apart(self.first, self.second, links)
        stretch: Scalar = (gap.x * gap.x + gap.y * gap.y)**0.5 - self.free_length
        return 0.5 * self.stiffness * stretch * stretch

    def forces(self, n: NumberType, links: LinkMotions) -> list[ForceOnLink]:
        """Return the forces on its first and on its second link, which move over time."""
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

    def __post_init__(self) -> None:
        check_quantities(self)
        _require_two_links(self)

    @property
    def links(self) -> tuple[str, str]:
        return self.first, self.second

    def _deflection(self, n: NumberType, links: LinkMotions) -> Scalar:
        """
        Return the angle of the second link from the first, less the free angle, in (-pi, pi].

        It comes from sines and cosines of the directions, so no angle has to be unwrapped.
        """
        cosine, sine = _turned(links[self.first], links[self.second])
        cos_0, sin_0 = cos(self.free_angle), sin(self.free_angle)
        angle: Scalar = n.atan2(sine * cos_0 - cosine * sin_0, cosine * cos_0 + sine * sin_0)
        return angle

    def tension(self, n: NumberType, links: LinkMotions) -> tuple[Scalar, Scalar, Scalar]:
        """Return k (a - a0), a' and 1 of (E5): moment and growth of the angle."""
        return (self.stiffness * self._deflection(n, links),
                links[self.second].omega - links[self.first].omega, 1.0)

    def energy(self, n: NumberType, links: LinkMotions) -> Scalar:
        stretch = self._deflection(n, links)
        return 0.5 * self.stiffness * stretch * stretch

    def forces(self, n: NumberType, links: LinkMotions) -> list[ForceOnLink]:
        """Return the couples on its first and on its second link, which move over time."""
        moment, first, second = _damped(self, n, links), links[self.first], links[self.second]
        return [ForceOnLink(self.first, first.x, first.y, 0.0, 0.0, moment),
                ForceOnLink(self.second, second.x, second.y, 0.0, 0.0, -moment)]


@dataclass(frozen=True)
class TableForce:
    """
    The function s -> F(s) of a table, times a factor, of floats and arrays.

    ``middle``: s is an angle that counts within half a turn of it; None: it is no such angle.
    """

    table: ForceTable
    factor: float
    middle: float | None

    def __call__(self, s: Any) -> Any:
        """Return the force [N] or couple [N m] at s, a float or an array."""
        middle = self.middle
        if middle is not None:
            s = (middle + remainder(s - middle, tau) if isinstance(s, float)
                 else s - tau * np.round((s - middle) / tau))
        return self.factor * self.table(s)

    @cached_property
    def largest(self) -> float:
        """Return the largest size of F, whose rounding is the error of all values."""
        return abs(self.factor) * max(map(abs, self.table.values))

    @property
    def period(self) -> float:
        """Return after which way F is the same again; infinite where it never is."""
        return (tau if self.middle is not None else
                self.table.span if self.table.is_periodic else inf)

    @cached_property
    def ends(self) -> list[float]:
        """Return the points s of a period and two more on either side, infinite without it."""
        points = list(self.table.places)[:-1 if self.table.is_periodic else None]
        cycles = ceil(2 / len(points))         # so many on either side have two points
        return [point + turn * self.period if turn else point
                for turn in range(-cycles, cycles + 1) for point in points]

    def piece(self, s: float) -> tuple[float, float]:
        """Return the two points of the table next to s: between them F is one polynomial."""
        base, first = s, self.table.places[0]
        if self.middle is not None:
            base = self.middle + remainder(s - self.middle, tau)
        elif self.table.is_periodic:
            base = first + (s - first) % self.table.span
        i, shift = bisect_right(self.ends, base), s - base
        return self.ends[i - 1] + shift, self.ends[i] + shift


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
        angle: Scalar = n.atan2(sine, cosine)
        return angle


@dataclass(frozen=True)
class Way:
    """
    How far a point has come along a line from its origin [m].

    The line's direction [rad] is from the direction of the origin's link, of the ground from x.
    """

    point: Attachment
    origin: Attachment = Attachment()
    direction: float = quantity(0.0)

    def __post_init__(self) -> None:
        _require_kind('point', self.point, Attachment)
        _require_kind('origin', self.origin, Attachment)
        check_quantities(self)

    @property
    def links(self) -> tuple[str, str]:
        return self.point.link, self.origin.link

    def of(self, n: NumberType, links: LinkMotions) -> Scalar:
        gap, (x, y) = _apart(self.origin, self.point, links), _along(
            direction(self.direction), links[self.origin.link])
        return gap.x * x + gap.y * y


Over = Union[str, LinkAngle, Way]        # INPUT and these: the s of a force


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
        half a turn of its middle, or it is periodic.
    over : 'input', LinkAngle or Way
        The position s. The input of a crank counts on over whole turns, so a table of two turns
        serves a four-stroke engine; other angles are in (-pi, pi].
    direction : float, optional
        Direction of the force, from that of the link ``axes`` or of the ground [rad]; None: a
        couple, counter-clockwise positive.
    factor : float
        Multiplies F(s): for a table of pressures the area [m^2], with its sign.

    """

    point: Attachment
    value: Callable[[float], float]
    over: Over = INPUT
    direction: float | None = quantity(0.0, instead=None)
    axes: str = GROUND
    factor: float = quantity(1.0)

    def __post_init__(self) -> None:
        _require_kind('point', self.point, Attachment)
        if self.point.link == GROUND:
            raise InvalidParameter('point', GROUND, 'a force acts on a moving link')
        if not callable(self.value):
            raise InvalidParameter('value', self.value, 'must be a ForceTable or a function')
        if not (isinstance(self.over, (LinkAngle, Way)) or self.over == INPUT):
            raise InvalidParameter('over', self.over, f'must be {INPUT!r}, a LinkAngle or a Way')
        check_quantities(self)

    @property
    def links(self) -> tuple[str, ...]:
        """Return the names of all links that it depends on, the loaded link first."""
        links_of_s = () if isinstance(self.over, str) else self.over.links
        return self.point.link, self.axes, *links_of_s

    def position(self, n: NumberType, links: LinkMotions, input_position: Scalar) -> Scalar:
        """Return the position s in a pose at an input."""
        return input_position if isinstance(self.over, str) else self.over.of(n, links)

    def _push(self, n: NumberType, value: Callable[[Any], Any], links: LinkMotions,
              position: Scalar) -> tuple[Scalar, Scalar, Scalar]:
        """Return F and the unit vector along which it acts, of a couple (0, 0)."""
        size = n.call(value, self.position(n, links, position))
        if self.direction is None:
            return size, 0.0, 0.0
        return size, *_along(direction(self.direction), links[self.axes])

    def generalised(self, n: NumberType, value: Callable[[Any], Any], links: LinkMotions,
                    position: Scalar) -> Scalar:
        """Return Q of (E7) in a pose; ``value``: the function of :meth:`make_value`."""
        size, x, y = self._push(n, value, links, position)
        if self.direction is None:
            return size * links[self.point.link].omega
        point = self.point.on(links[self.point.link])
        return size * (x * point.v_x + y * point.v_y)

    def forces(self, n: NumberType, value: Callable[[Any], Any], links: LinkMotions,
               position: Scalar) -> list[ForceOnLink]:
        """Return the force on its link; arguments as of :meth:`generalised`."""
        size, x, y = self._push(n, value, links, position)
        point = self.point.on(links[self.point.link])
        return [ForceOnLink(self.point.link, point.x, point.y, size * x, size * y,
                            size if self.direction is None else 0.0)]

    @property
    def turns(self) -> int:
        """Return after how many turns of the crank it repeats: 2 for a four-stroke table."""
        table = self.value
        if not (isinstance(table, ForceTable) and table.is_periodic):
            return 1
        return max(1, round(table.span / tau))

    def make_value(self, mechanism: Mechanism) -> Callable[[Any], Any]:
        """
        Return the function s -> F(s), times the factor, of floats and arrays.

        Raises InvalidParameter for a table that does not fit the mechanism; the function does for
        a value that is no finite number.
        """
        value, factor = self.value, self.factor
        if not isinstance(value, ForceTable):
            def force(s: float | Array) -> Any:
                if isinstance(s, float):
                    return factor * finite('value', value(s), f'at {s!r} must be a finite number')
                return np.vectorize(lambda x: factor * value(float(x)), otypes=[float])(s)
            return force
        is_angle = (not mechanism.is_driven_by_slide if self.over == INPUT
                    else isinstance(self.over, LinkAngle))
        _require_fitting(value, is_angle, mechanism.turns_fully and self.over == INPUT)
        return TableForce(value, factor,
                          value.middle if is_angle and not value.is_periodic else None)


def _require_fitting(table: ForceTable, is_angle: bool, counts_turns: bool) -> None:
    """
    Refuse a table whose period or range does not fit the position over which it is given.

    A table over a length cannot be periodic. Over an angle its period must be a part of a turn.
    Over the input of a crank that turns fully, turns are counted, and it may be several turns.
    """
    turns = table.span / tau
    if table.is_periodic:
        if not is_angle:
            raise InvalidParameter('is_periodic', True, 'a length does not come round: only over '
                                                        'an angle is a table periodic')
        count = max(turns, 1.0 / turns)
        if abs(count - round(count)) > 1e-9 * count or (turns > 1.5 and not counts_turns):
            more = (', or some turns' if counts_turns else
                    ': turns are counted of a crank that is driven and turns fully')
            raise InvalidParameter('places', table.span,
                                   f'the period must be 2 pi, or a whole part of it{more}')
    elif is_angle and turns > 1.0 + 1e-9:
        raise InvalidParameter('places', table.span, 'more than a turn of an angle, and not '
                                                     'periodic')
    elif counts_turns and table.values[0] != table.values[-1]:
        raise InvalidParameter('values', table.values[-1], 'the crank turns fully: the last value '
                               f'must be the first again, {table.values[0]!r}')


Element = Union[Spring, TorsionSpring, PositionForce]


def _require_kind(name: str, value: Any, kind: type) -> None:
    if not isinstance(value, kind):
        raise InvalidParameter(name, value, f'must be of type {kind.__name__}')


def _require_two_links(element: Spring | TorsionSpring) -> None:
    """Refuse a spring with both ends on one link, on which it would do nothing."""
    first, second = element.links
    if first == second:
        raise InvalidParameter('second', second, 'must be on another link than the first')


def _apart(first: Attachment, second: Attachment, links: LinkMotions) -> MovingPoint:
    """Return the vector from the first point to the second, with its derivatives."""
    p, q = first.on(links[first.link]), second.on(links[second.link])
    return MovingPoint(*[b - a for a, b in zip(p, q)])


def _turned(first: LinkMotion, second: LinkMotion) -> tuple[Scalar, Scalar]:
    """Return cosine and sine of the angle of the second link from the first."""
    return (first.cosine * second.cosine + first.sine * second.sine,
            first.cosine * second.sine - first.sine * second.cosine)


def _along(unit: tuple[float, float], axes: LinkMotion) -> tuple[Scalar, Scalar]:
    """Return a unit vector given along a link, along the ground axes."""
    (c, s), cosine, sine = unit, axes.cosine, axes.sine
    return c * cosine - s * sine, c * sine + s * cosine


def _damped(element: Spring | TorsionSpring, n: NumberType, links: LinkMotions) -> Scalar:
    """Return the pull of a spring with that of its damper."""
    pull, growth, square = element.tension(n, links)
    return pull + element.damping * growth / square if element.damping else pull


def links_of(elements: Sequence[Element], mechanism: Mechanism) -> list[str]:
    """
    Return the moving links that elements name; refuse one that the mechanism does not have.

    Each once, in a fixed order: a formula recorded in another process has the same lines.
    """
    links = [link.name for link in mechanism.LINKS]
    named = sorted({link for element in elements for link in element.links} - {GROUND})
    for link in named:
        if link not in links:
            raise InvalidParameter('link', link, f'must be one of {", ".join(links)}, {GROUND}')
    return named
