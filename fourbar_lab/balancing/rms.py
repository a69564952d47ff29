# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Counterweights of least root mean square for an added mass: a convex problem, solved exactly.

With (B1), (B2) of :mod:`fourbar_lab.balancing.loads`, all designs that add a mass M at most are
the convex hull of "no counterweight" and of points of mass M on one link, and the root mean
square |R p| is a norm: its minimum is the point of a convex set that is nearest to zero. Wolfe's
algorithm (1976) finds it in finitely many steps among given corners; here the corner that is
lowest along the gradient is found among all links, distances and directions in closed form. That
corner also proves how good the result is: for no design p' is

    (B3)  |R p'| < x . v / |x|,    x = R p,  v the lowest corner.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import NamedTuple

from fourbar_lab.balancing.loads import Loads, NUMBERS
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.given import number
import numpy as np

# Rounds of Wolfe's algorithm at most; gap to the bound that ends it, relative; what is zero beside
# the unbalanced load.
STEPS, ENOUGH, NOTHING = 500, 1e-9, 1e-13
NEAR = 1e-3         # of the radius: nearer counterweights may become one
LIGHT = 1e-15       # weight of a corner that is rounding


class Spot(NamedTuple):
    """A place of a counterweight on a link: from its first joint, along and across [m]."""

    link: str
    along: float
    across: float

    def with_mass(self, mass: float) -> Counterweight:
        """Return the counterweight of a mass [kg] there."""
        return Counterweight(self.link, mass, self.along, self.across)


class Counterweight(NamedTuple):
    """A point mass on a link [kg], place from the link's first joint, along and across [m]."""

    link: str
    mass: float
    along: float
    across: float

    @property
    def spot(self) -> Spot:
        """Return where it is."""
        return Spot(self.link, self.along, self.across)

    @property
    def numbers(self) -> Array:
        """Return what it adds to (m, m x, m y, J) of its link."""
        m, x, y = self.mass, self.along, self.across
        return np.array((m, m * x, m * y, m * (x * x + y * y)))


class Balance(NamedTuple):
    """Counterweights, and how good they are."""

    counterweights: tuple[Counterweight, ...]
    value: float        # what was minimized, for the links with them
    bound: float        # no counterweights within the radii and the mass give less than this
    numbers: Array      # (m, m x, m y, J) of all links with them, shape (4 links,)

    @property
    def added(self) -> float:
        """Return the added mass [kg]."""
        return sum(one.mass for one in self.counterweights)


class Places:
    """
    Where counterweights may be: ``radii``, {link: greatest distance from its first joint [m]}.

    InvalidParameter if there is no such link, or a radius is not positive.
    """

    def __init__(self, loads: Loads, radii: dict[str, float]):
        """Check the radii; ``loads`` are what counterweights at these places change."""
        for link, radius in radii.items():
            if link not in loads.links:
                raise InvalidParameter('link', link, f'must be one of {", ".join(loads.links)}')
            if not radius > 0.0:
                raise InvalidParameter(f'radius of {link}', radius, 'must be positive')
        self.loads, self.radii = loads, radii

    def column(self, link: str, along: float, across: float) -> Array:
        """Return what 1 kg at a spot [m] adds to (m, m x, m y, J) of all links, (4 links,)."""
        numbers = np.zeros(NUMBERS * len(self.loads.links))
        first = NUMBERS * self.loads.links.index(link)
        numbers[first:first + NUMBERS] = Counterweight(link, 1.0, along, across).numbers
        return numbers

    def numbers(self, counterweights: Iterable[Counterweight]) -> Array:
        """Return (m, m x, m y, J) of all links with counterweights, shape (4 links,)."""
        return self.loads.given + sum((one.mass * self.column(*one.spot)
                                       for one in counterweights),
                                      np.zeros(len(self.loads.given)))

    def without_rounding(self, link: str, along: float, across: float) -> tuple[float, float]:
        """Return along and across of a spot [m], with 0.0 for rounding beside the radius."""
        least = 64 * EPS * self.radii[link]
        return (along if abs(along) > least else 0.0, across if abs(across) > least else 0.0)

    def united(self, counterweights: Sequence[Counterweight], value: Callable[[Array], float],
               most: float) -> list[Counterweight]:
        """
        Return counterweights link by link, neighbours as one at their centre of mass.

        An algorithm may end with several that are micrometres apart, which no workshop can make.
        Two become one only if ``value`` of the numbers of all links stays ``most`` or less.
        """
        for one, other in combinations(counterweights, 2):
            apart = np.hypot(one.along - other.along, one.across - other.across)
            if one.link != other.link or apart > NEAR * self.radii[one.link]:
                continue
            mass = one.mass + other.mass
            both = Counterweight(one.link, mass, *(
                (one.mass * a + other.mass * b) / mass for a, b in zip(one[2:], other[2:])))
            fewer = [*(each for each in counterweights if each not in (one, other)), both]
            if value(self.numbers(fewer)) <= most:
                return self.united(fewer, value, most)
        # algorithms end with them in an order that rounding decides
        return sorted(counterweights, key=lambda one: (self.loads.links.index(one.link), one[2:]))

    def lowest(self, slope: Array) -> tuple[float, Spot]:
        """
        Return the least derivative per kilogram of a function among all spots, and that spot.

        ``slope``, shape (4 links,): the derivatives of the function by (m, m x, m y, J) of all
        links. At a distance r against (m x, m y) of a link, one kilogram changes the function by
        s_m - r |(s_x, s_y)| + r^2 s_J: a parabola of r, least at its vertex or at an end.
        """
        candidates = []
        for link, radius in self.radii.items():
            first = NUMBERS * self.loads.links.index(link)
            by_mass, by_x, by_y, by_inertia = slope[first:first + NUMBERS]
            side = np.hypot(by_x, by_y)
            vertex = 0.5 * side / by_inertia if by_inertia > 0.0 else np.inf
            r = min(vertex, radius) if side or by_inertia < 0.0 else 0.0
            value = by_mass - r * side + by_inertia * r * r
            cosine, sine = (by_x / side, by_y / side) if side else (1.0, 0.0)
            candidates.append((float(value), Spot(link, *self.without_rounding(
                link, float(-r * cosine), float(-r * sine)))))
        return min(candidates)


def least_rms(places: Places, names: Iterable[str], mass: float,
              start: Sequence[Counterweight] = ()) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least root mean square of loads.

    ``names`` are of :attr:`.Loads.groups`; if several, each load counts relative to its unbalanced
    value. Spots of ``start``, as of a neighbouring mass, save time; the result is the same.
    """
    return nearest_to_zero(places, places.loads.root(names), mass, start)


def front(places: Places, names: Iterable[str], masses: Iterable[float]) -> list[Balance]:
    """Return :func:`least_rms` of each added mass [kg]; each starts from the one before."""
    root = places.loads.root(names)
    balances: list[Balance] = []
    for mass in masses:
        start = balances[-1].counterweights if balances else ()
        balances.append(nearest_to_zero(places, root, mass, start))
    return balances


class _Corner(NamedTuple):
    """R p of a design that has all of the mass at one spot, or none (spot None)."""

    point: Array
    spot: Spot | None


def nearest_to_zero(places: Places, root: Array, mass: float,
                    start: Sequence[Counterweight] = ()) -> Balance:
    """
    Return the design of least |root p|, p the numbers of :class:`.Loads`, by Wolfe's algorithm.

    The design is a weighted mean of corners, each with all of the mass [kg] at one spot or none of
    it; a weight is the share of the mass there. Each round adds the corner that is lowest along
    x = root p of the design, the direction in which |root p| grows, until none is lower than the
    design itself.
    """
    mass = number('mass', mass, 'must be zero or more', least=0.0)
    unbalanced = root @ places.loads.given
    scale = float(np.linalg.norm(unbalanced))

    def corner(spot: Spot | None) -> _Corner:
        return _Corner(unbalanced + mass * (root @ places.column(*spot)) if spot else unbalanced,
                       spot)

    corners = [corner(None), *(corner(one.spot) for one in start)]
    weights = np.array([1.0] + [0.0] * len(start))
    corners, weights = _nearest(corners, weights)
    for _ in range(STEPS):
        x = weights @ np.array([one.point for one in corners])
        slope, spot = places.lowest(root.T @ x)
        lowest = corner(spot if slope < 0.0 else None)
        least, size = float(x @ lowest.point), float(np.linalg.norm(x))
        if size <= NOTHING * scale or float(x @ x) - least <= ENOUGH * size * size:
            break
        corners, weights = _nearest([*corners, lowest], np.append(weights, 0.0))
    weighted = [one.spot.with_mass(mass * weight)
                for one, weight in zip(corners, weights.tolist()) if one.spot and weight > 0.0]

    def value(numbers: Array) -> float:
        return float(np.linalg.norm(root @ numbers))

    weighted = places.united(weighted, value, value(places.numbers(weighted)) + ENOUGH * scale)
    numbers = places.numbers(weighted)
    # of v, a sum of what is there and what is added, and of x . v / |x| in (B3)
    rounding = 2.0 * sum(root.shape) * EPS * (2.0 * scale + float(np.linalg.norm(lowest.point)))
    bound = max(least / size - rounding, 0.0) if size > NOTHING * scale else 0.0
    return Balance(tuple(weighted), value(numbers), bound, numbers)


def _nearest(corners: list[_Corner], weights: Array) -> tuple[list[_Corner], Array]:
    """
    Return the corners of a hull that span its point nearest to zero, and their weights.

    Wolfe's minor cycle: the nearest point of the plane through all corners is the answer if it
    lies between them (weights > 0). If not, go towards it until a weight vanishes, drop that
    corner, and try again with the others.
    """
    while True:
        target = _affine(np.array([one.point for one in corners]))
        if (target > 0.0).all():
            return corners, target
        falling = target <= 0.0             # they vanish on the way from weights to target
        room = weights[falling] - target[falling]
        safe = np.where(room > 0.0, room, 1.0)
        # the part of the way after which the first one does
        part = float(np.min(np.where(room > 0.0, weights[falling] / safe, 0.0)))
        weights = weights + min(part, 1.0) * (target - weights)
        stay = weights > LIGHT
        stay[falling] &= weights[falling] > weights[falling].min()
        corners = [one for one, stays in zip(corners, stay) if stays]
        weights = weights[stay] / weights[stay].sum()


def _affine(corners: Array) -> Array:
    """
    Return weights, of sum one, of the point nearest to zero of the plane through all corners.

    ``corners`` has shape (corners, n). Weights may be negative: (1, 1) and (2, 2) give (2, -1).
    """
    first, edges = corners[0], corners[1:] - corners[0]
    if not len(edges):
        return np.ones(1)
    others = np.linalg.lstsq(edges.T, -first, rcond=1e-13)[0]
    return np.concatenate(([1.0 - others.sum()], others))
