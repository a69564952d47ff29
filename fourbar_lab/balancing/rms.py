# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Counterweights of least root mean square for an added mass: a convex problem, solved exactly.

With (B1), (B2) of :mod:`fourbar_lab.balancing.loads`, all designs that add a mass M at most are
the convex hull of "no counterweight" and of points of mass M on one link, and the root mean
square |R p| is a norm: its minimum is the point of a convex set that is nearest to zero. Wolfe's
algorithm (1976) finds it in finitely many steps among given corners; here the corner that is
lowest along the gradient is found among all links, distances and directions in closed form. That
corner also proves how good the result is: for no design is

    (B3)  |R p'| < x . v / |x|,    x = R p,  v the lowest corner.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import NamedTuple, Union

from fourbar_lab.balancing.loads import Loads, NUMBERS
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import Array, EPS
import numpy as np

STEPS, ENOUGH, NOTHING = 500, 1e-9, 1e-13
NEAR = 1e-3         # of the radius: neighbours that may be one

Spot = tuple[str, float, float]         # of a counterweight: link, along, across
Name = Union[Spot, None]                # of a corner; None: no counterweight


class Counterweight(NamedTuple):
    """A point mass on a link [kg], place from the link's first joint, along and across [m]."""

    link: str
    mass: float
    along: float
    across: float

    @property
    def numbers(self) -> Array:
        """Return what it adds to (m, m x, m y, J)."""
        m, x, y = self.mass, self.along, self.across
        return np.array((m, m * x, m * y, m * (x * x + y * y)))


class Balance(NamedTuple):
    """
    A result.

    Parameters
    ----------
    counterweights : tuple of Counterweight
    value : float
        What was minimized, for the links with them.
    bound : float
        No counterweights within the radii and the mass give less than this.
    numbers : ndarray
        (m, m x, m y, J) of all links.

    """

    counterweights: tuple[Counterweight, ...]
    value: float
    bound: float
    numbers: Array

    @property
    def added(self) -> float:
        """Return the added mass [kg]."""
        return sum(one.mass for one in self.counterweights)


class Places:
    """
    Where counterweights may be.

    Parameters
    ----------
    loads : Loads
    radii : dict
        {link: greatest distance of a counterweight from its first joint [m]}.

    """

    def __init__(self, loads: Loads, radii: dict[str, float]):
        for link, radius in radii.items():
            if link not in loads.links:
                raise InvalidParameter('link', link, f'must be one of {", ".join(loads.links)}')
            if not radius > 0.0:
                raise InvalidParameter(f'radius of {link}', radius, 'must be positive')
        self.loads, self.radii = loads, radii

    def column(self, link: str, along: float, across: float) -> Array:
        """Return what one kilogram at a place adds to the numbers of all links."""
        numbers = np.zeros(NUMBERS * len(self.loads.links))
        first = NUMBERS * self.loads.links.index(link)
        numbers[first:first + NUMBERS] = Counterweight(link, 1.0, along, across).numbers
        return numbers

    def numbers(self, counterweights: Iterable[Counterweight]) -> Array:
        """Return the numbers of all links with counterweights."""
        return self.loads.given + sum((one.mass * self.column(one.link, one.along, one.across)
                                       for one in counterweights),
                                      np.zeros(len(self.loads.given)))

    def place(self, link: str, along: float, across: float) -> tuple[float, float]:
        """Return a place without what is rounding beside the radius."""
        least = 64 * EPS * self.radii[link]
        return (along if abs(along) > least else 0.0, across if abs(across) > least else 0.0)

    def united(self, counterweights: Sequence[Counterweight], value: Callable[[Array], float],
               most: float) -> list[Counterweight]:
        """
        Return counterweights link by link, neighbours as one at their centre of mass.

        The corners of a hull that an algorithm ends with may be micrometres apart. ``value`` of
        the numbers of all links stays ``most`` or less.
        """
        kept = list(counterweights)
        for one, other in combinations(counterweights, 2):
            if one not in kept or other not in kept or one.link != other.link:
                continue
            apart = np.hypot(one.along - other.along, one.across - other.across)
            mass = one.mass + other.mass
            both = Counterweight(one.link, mass, *(
                (one.mass * a + other.mass * b) / mass for a, b in zip(one[2:], other[2:])))
            without = [each for each in kept if each not in (one, other)]
            if (apart <= NEAR * self.radii[one.link]
                    and value(self.numbers([*without, both])) <= most):
                return self.united([*without, both], value, most)
        # algorithms end with them in an order that rounding decides
        return sorted(kept, key=lambda one: (self.loads.links.index(one.link), one[2:]))

    def lowest(self, slope: Array) -> tuple[float, Spot]:
        """
        Return the least slope per kilogram of all places, and that place.

        ``slope``: derivative of something with respect to the numbers of all links. In a direction
        against (m x, m y) it is a parabola of the distance.
        """
        found = []
        for link, radius in self.radii.items():
            first = NUMBERS * self.loads.links.index(link)
            by_mass, by_x, by_y, by_inertia = slope[first:first + NUMBERS]
            side = np.hypot(by_x, by_y)
            away = 0.5 * side / by_inertia if by_inertia > 0.0 else np.inf
            r = min(away, radius) if side or by_inertia < 0.0 else 0.0
            value = by_mass - r * side + by_inertia * r * r
            cosine, sine = (by_x / side, by_y / side) if side else (1.0, 0.0)
            found.append((float(value),
                          (link, *self.place(link, float(-r * cosine), float(-r * sine)))))
        return min(found)


def least_rms(places: Places, names: Iterable[str], mass: float,
              start: Sequence[Counterweight] = ()) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least root mean square of loads.

    Parameters
    ----------
    places : Places
    names : iterable of str
        Some of :attr:`.Loads.groups`; if several, each counts relative to what it is unbalanced.
    mass : float
    start : sequence of Counterweight
        Places to begin with, as of a neighbouring mass; the result does not depend on it.

    """
    return nearest_to_zero(places, places.loads.root(names), mass, start)


def front(places: Places, names: Iterable[str], masses: Iterable[float]) -> list[Balance]:
    """Return the best for each added mass, as :func:`least_rms`."""
    root = places.loads.root(names)
    found: list[Balance] = []
    for mass in masses:
        start = found[-1].counterweights if found else ()
        found.append(nearest_to_zero(places, root, mass, start))
    return found


def nearest_to_zero(places: Places, root: Array, mass: float,
                    start: Sequence[Counterweight] = ()) -> Balance:
    """
    Return the design of least |root p|, p the numbers of :class:`.Loads`, by Wolfe's algorithm.

    Corners are designs with all of the mass at one spot, or without any (None). The design is
    their weighted mean; each round adds the corner that is lowest along the gradient x, until none
    is lower than the design itself.
    """
    given = root @ places.loads.given
    scale = float(np.linalg.norm(given))
    spots = [(one.link, one.along, one.across) for one in start]
    corners = [given] + [given + mass * (root @ places.column(*spot)) for spot in spots]
    weights = np.array([1.0] + [0.0] * len(spots))
    kept: list[Name] = [None, *spots]
    corners, weights, kept = _nearest(corners, weights, kept)
    for _ in range(STEPS):
        x = weights @ np.array(corners)
        slope, spot = places.lowest(root.T @ x)
        is_lower = slope < 0.0
        lowest = given + mass * (root @ places.column(*spot)) if is_lower else given
        least, size = float(x @ lowest), float(np.linalg.norm(x))
        if size <= NOTHING * scale or float(x @ x) - least <= ENOUGH * size * size:
            break
        corners.append(lowest)
        kept.append(spot if is_lower else None)
        corners, weights, kept = _nearest(corners, np.append(weights, 0.0), kept)
    weighted = [Counterweight(spot[0], mass * weight, *spot[1:])
                for spot, weight in zip(kept, weights.tolist()) if spot and weight > 0.0]
    whole = float(np.linalg.norm(root @ places.numbers(weighted)))
    weighted = places.united(weighted, lambda numbers: float(np.linalg.norm(root @ numbers)),
                             whole + ENOUGH * scale)
    numbers = places.numbers(weighted)
    # of v, a sum of what is there and what is added, and of x . v / |x|
    rounding = 2.0 * sum(root.shape) * EPS * (2.0 * scale + float(np.linalg.norm(lowest)))
    bound = max(least / size - rounding, 0.0) if size > NOTHING * scale else 0.0
    return Balance(tuple(weighted), float(np.linalg.norm(root @ numbers)), bound, numbers)


def _nearest(corners: list[Array], weights: Array, kept: list[Name]
             ) -> tuple[list[Array], Array, list[Name]]:
    """Return the corners, weights and names that span the point of a hull nearest to zero."""
    while True:
        better = _affine(np.array(corners))
        if (better > 0.0).all():
            return corners, better, kept
        falling = better <= 0.0
        room = weights[falling] - better[falling]
        safe = np.where(room > 0.0, room, 1.0)
        part = float(np.min(np.where(room > 0.0, weights[falling] / safe, 0.0)))
        weights = weights + min(part, 1.0) * (better - weights)
        stay = weights > 1e-15
        stay[falling] &= weights[falling] > weights[falling].min()
        corners = [corner for corner, is_in in zip(corners, stay) if is_in]
        kept = [name for name, is_in in zip(kept, stay) if is_in]
        weights = weights[stay] / weights[stay].sum()


def _affine(corners: Array) -> Array:
    """Return weights, of sum one, of the point of the plane through corners nearest to zero."""
    first, rest = corners[0], corners[1:] - corners[0]
    if not len(rest):
        return np.ones(1)
    others = np.linalg.lstsq(rest.T, -first, rcond=1e-13)[0]
    return np.concatenate(([1.0 - others.sum()], others))
