# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Counterweights that are plates of a given shape: discs, and sectors about the first joint.

Their mass and their moment of inertia grow together with their size, so the problem is no longer
convex: ``scipy.optimize`` looks for the best from several starts. The optimum of point masses
within the same circle is a proven bound, since a plate there is a sum of them.

A plate of sigma [kg/m^2] adds, about the first joint,

    disc of radius r at distance d         m = sigma pi r^2,     J = m (d^2 + r^2/2)
    sector of radius r, half-angle g       m = sigma g r^2,      J = m r^2/2,
                                           centre of gravity at 2 r sin(g) / (3 g)
"""
from __future__ import annotations

from collections.abc import Callable, Iterable
from math import cos, pi, sin
from typing import Any, cast, NamedTuple, Union
import warnings

from fourbar_lab.balancing.loads import NUMBERS
from fourbar_lab.balancing.rms import Balance, least_rms, Places
from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.numerics.arrays import Array
import numpy as np

STARTS = 12                 # random starts of the optimiser, beside those from the point masses
TOLERANCE = 1e-14           # of the optimiser
NOTHING, LIGHT = 1e-4, 1e-6     # plates below this radius over the limit, or mass over that added


class Disc(NamedTuple):
    """A disc on a link: mass [kg]; centre, along and across from the first joint; radius [m]."""

    link: str
    mass: float
    along: float
    across: float
    radius: float

    @property
    def numbers(self) -> Array:
        """Return what it adds to (m, m x, m y, J) of its link."""
        m, x, y = self.mass, self.along, self.across
        return np.array((m, m * x, m * y, m * (x * x + y * y + 0.5 * self.radius**2)))


class Sector(NamedTuple):
    """A sector about the first joint of a link: [kg], centre of gravity, radius [m], [rad]."""

    link: str
    mass: float
    along: float
    across: float
    radius: float
    half_angle: float

    @property
    def numbers(self) -> Array:
        """Return what it adds to (m, m x, m y, J) of its link."""
        m = self.mass
        return np.array((m, m * self.along, m * self.across, 0.5 * m * self.radius**2))


Plate = Union[Disc, Sector]


def disc(link: str, sigma: float, limit: float, sizes: Array) -> Disc:
    """
    Return a disc of sigma [kg/m^2] within the circle of radius ``limit`` [m].

    ``sizes``: its radius and the distance of its centre, each from 0 to 1 (as far as there is
    room), and the direction of its centre [rad].
    """
    radius = limit * sizes[0]
    distance = (limit - radius) * sizes[1]
    return Disc(link, float(sigma * pi * radius**2), float(distance * cos(sizes[2])),
                float(distance * sin(sizes[2])), float(radius))


def sector(link: str, sigma: float, limit: float, sizes: Array) -> Sector:
    """
    Return a sector of sigma [kg/m^2] within the circle of radius ``limit`` [m].

    ``sizes``: its radius and its half-angle over pi, each from 0 to 1, and its direction [rad].
    """
    radius, half_angle = limit * sizes[0], max(pi * sizes[1], 1e-9)     # divided by below
    away = 2.0 * radius * sin(half_angle) / (3.0 * half_angle)
    return Sector(link, float(sigma * half_angle * radius**2), float(away * cos(sizes[2])),
                  float(away * sin(sizes[2])), float(radius), float(half_angle))


SHAPES: dict[str, Callable[[str, float, float, Array], Plate]] = {'disc': disc, 'sector': sector}


def best_plates(places: Places, names: Iterable[str], mass: float, shape: str,
                sigma: float) -> Balance:
    """
    Return plates, one a link at most, with the least root mean square of loads that was found.

    Plates lie in the circles of ``places``, are of a shape of :data:`SHAPES` and of sigma, density
    times thickness [kg/m^2], and add ``mass`` [kg] at most; ``names`` as in :func:`.least_rms`.
    Point masses give the bound: a plate is a sum of them.
    """
    from scipy.optimize import minimize
    if shape not in SHAPES:
        raise InvalidParameter('shape', shape, f'unknown{nearest(shape, SHAPES)}')
    if not sigma > 0.0:
        raise InvalidParameter('density times thickness', sigma, 'must be positive')
    names = tuple(names)
    points, problem = least_rms(places, names, mass), _Problem(places, names, shape, sigma)
    # two turns each way: a direction may go round without meeting an end
    limits = [(0.0, 1.0), (0.0, 1.0), (-4.0 * pi, 4.0 * pi)] * len(places.radii)
    room = {'type': 'ineq', 'fun': lambda x: 1.0 - problem.mass(x) / mass}
    best, value = np.zeros(len(limits)), problem.value(np.zeros(len(limits)))
    for start in problem.starts(points) if mass else ():
        with warnings.catch_warnings():         # that it steps back into the bounds
            warnings.simplefilter('ignore', RuntimeWarning)
            end = minimize(problem.value, start, method='SLSQP', bounds=limits,
                           constraints=room, options={'ftol': TOLERANCE, 'maxiter': 300})
        if end.fun < value and problem.mass(end.x) <= mass * (1.0 + 1e-9):
            best, value = end.x, float(end.fun)
    plates = tuple([plate for plate in problem.plates(best)
                    if plate.radius > NOTHING * places.radii[plate.link]
                    and plate.mass > LIGHT * mass])
    numbers = problem.numbers(plates)
    value = float(np.linalg.norm(problem.root @ numbers))
    return Balance(cast(Any, plates), value, points.bound, numbers)


class _Problem:
    """
    The optimisation problem of plates.

    Its unknowns x are the ``sizes`` of one plate for each link: three numbers a link.
    """

    def __init__(self, places: Places, names: tuple[str, ...], shape: str, sigma: float) -> None:
        """Take the loads to reduce by name; ``shape``, ``sigma`` as in :func:`best_plates`."""
        self.root = places.loads.root(names)
        self._places, self._make, self._sigma = places, SHAPES[shape], sigma
        self._scale = float(np.linalg.norm(self.root @ places.loads.given)) or 1.0

    def plates(self, x: Array) -> list[Plate]:
        """Return the plate of each link at x."""
        return [self._make(link, self._sigma, limit, sizes) for (link, limit), sizes in
                zip(self._places.radii.items(), np.reshape(x, (-1, 3)))]

    def numbers(self, plates: Iterable[Plate]) -> Array:
        """Return (m, m x, m y, J) of all links with plates."""
        numbers = self._places.loads.given.copy()
        for plate in plates:
            first = NUMBERS * self._places.loads.links.index(plate.link)
            numbers[first:first + NUMBERS] += plate.numbers
        return numbers

    def mass(self, x: Array) -> float:
        """Return the added mass at x [kg]."""
        return sum(plate.mass for plate in self.plates(x))

    def value(self, x: Array) -> float:
        """Return the root mean square at x over that without plates."""
        numbers = self.numbers(self.plates(x))
        return float(np.linalg.norm(self.root @ numbers)) / self._scale

    def starts(self, points: Balance) -> list[Array]:
        """
        Return the x that the optimiser starts from.

        Two have plates (small, middling) in the directions of the best point masses, and tiny
        plates on the other links; the others are random, the same in every run.
        """
        rng, links = np.random.default_rng(0), list(self._places.radii)
        starts = []
        for size in (0.2, 0.5):
            start = np.tile((0.05, 0.5, 0.0), (len(links), 1))
            for one in points.counterweights:
                start[links.index(one.link)] = size, 0.5, np.arctan2(one.across, one.along)
            starts.append(start.ravel())
        anywhere = rng.uniform((0.0, 0.0, -pi), (0.6, 1.0, pi), (STARTS, len(links), 3))
        return starts + [start.ravel() for start in anywhere]
