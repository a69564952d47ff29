# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Counterweights of the least peak: the largest magnitude over the input, for an added mass.

A minimax problem, convex by (B1), (B2): minimize t with u . load(q) <= t for every input q and
direction u. It is solved by linear programmes in which directions and inputs that are violated
enter as rows, and places of counterweights that would help as columns. The prices y of the rows,
of sum one, prove a lower bound: no design has a smaller peak than the least of sum y u . load.
At the end the extrema of the real mechanism are searched; where they exceed t, they enter too.
"""
from __future__ import annotations

from fourbar_lab.balancing.loads import Loads, without_weight
from fourbar_lab.balancing.rms import Balance, Counterweight, nearest_to_zero, Places, Spot
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.numerics.arrays import Array
import numpy as np

INPUTS, STEPS, ROUNDS, ENOUGH = 128, 200, 6, 1e-6


def least_peak(places: Places, name: str, mass: float) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least peak of a load.

    Parameters
    ----------
    places : Places
    name : str
        One of :attr:`.Loads.groups`.
    mass : float

    """
    loads = places.loads
    x, _ = loads.nodes(INPUTS)
    start = nearest_to_zero(places, loads.root((name,)), mass)
    spots = [(one.link, one.along, one.across) for one in start.counterweights]
    for _ in range(ROUNDS):
        problem = _Peak(places, name, mass, x)
        weights, spots, bound = problem.solve(spots)
        weights = weights * mass / max(weights.sum(), mass)      # within the solver's tolerance
        numbers = problem.numbers(spots, weights)
        value, places_of = peak(loads, name, numbers)
        if value <= problem.largest(numbers)[0] * (1.0 + ENOUGH):
            break
        x = np.concatenate((x, places_of))
    found = places.united(
        [Counterweight(spot[0], weight, *spot[1:])
         for spot, weight in zip(spots, weights.tolist()) if weight > 0.0],
        lambda numbers: problem.largest(numbers)[0], value * (1.0 + ENOUGH))
    numbers = places.numbers(found)
    return Balance(tuple(found), peak(loads, name, numbers)[0], bound, numbers)


def peak(loads: Loads, name: str, numbers: Array) -> tuple[float, Array]:
    """Return the largest magnitude of a load of inertia, and the inputs of its maxima."""
    still = without_weight(loads.balanced(numbers))
    field, = {component.removesuffix('_x').removesuffix('_y') for component in loads.group(name)}
    found = find_extrema(still, (field,), loads.rate, conditions=False)
    inputs = np.array([one.slide if still.is_driven_by_slide else one.theta1 for one in found])
    return max((abs(one.value) for one in found), default=0.0), inputs


class _Peak:
    """The linear programmes for some inputs."""

    def __init__(self, places: Places, name: str, mass: float, x: Array):
        self.places, self.mass = places, mass
        fields = places.loads.matrices(x, places.loads.group(name))
        self.matrices = np.stack(list(fields.values()))      # (components, inputs, numbers)
        self.given = places.loads.given

    def numbers(self, spots: list[Spot], weights: Array) -> Array:
        """Return the numbers of all links with counterweights."""
        return self.given + sum((weight * self.places.column(*spot)
                                 for spot, weight in zip(spots, weights)),
                                np.zeros(len(self.given)))

    def largest(self, numbers: Array) -> tuple[float, Array]:
        """Return the largest magnitude, and the rows u . A of the inputs where it is large."""
        load = self.matrices @ numbers                       # (components, inputs)
        size = np.linalg.norm(load, axis=0)
        top = float(size.max())
        around = (size >= np.roll(size, 1)) & (size >= np.roll(size, -1)) & (size > 0.0)
        rows = [np.einsum('c,cp->p', load[:, i] / size[i], self.matrices[:, i])
                for i in np.nonzero(around)[0]]
        return top, np.array(rows).reshape(-1, len(self.given))

    def solve(self, spots: list[Spot]) -> tuple[Array, list[Spot], float]:
        """Return masses, their places, and the bound."""
        rows = self.largest(self.given)[1]
        weights: Array = np.zeros(len(spots))
        bound = 0.0
        rows = np.concatenate((rows, -rows))
        best = np.inf
        for _ in range(STEPS):
            weights, prices = self._programme(rows, spots)
            slope, spot = self.places.lowest(rows.T @ prices)
            bound = max(bound, float(prices @ rows @ self.given)
                        + min(0.0, self.mass * slope))
            top, more = self.largest(self.numbers(spots, weights))
            best = min(best, top)
            if best - bound <= ENOUGH * best:
                break
            rows = np.concatenate((rows, more))
            if spot not in spots:
                spots, weights = [*spots, spot], np.append(weights, 0.0)
        return weights, spots, bound

    def _programme(self, rows: Array, spots: list[Spot]) -> tuple[Array, Array]:
        """Return the masses of the places, and the prices of the rows."""
        from scipy.optimize import linprog
        given = rows @ self.given
        scale = float(np.abs(given).max()) or 1.0
        columns = [rows @ self.places.column(*spot) * (self.mass / scale) for spot in spots]
        matrix = np.stack([*columns, -np.ones(len(rows))], axis=1)
        budget = np.array([[1.0] * len(spots) + [0.0]])
        found = linprog(np.array([0.0] * len(spots) + [1.0]),
                        A_ub=np.concatenate((matrix, budget)),
                        b_ub=np.concatenate((-given / scale, [1.0])), method='highs',
                        bounds=[(0.0, None)] * (len(spots) + 1))
        prices = np.maximum(-found.ineqlin.marginals[:-1], 0.0)
        return self.mass * found.x[:-1], prices / (prices.sum() or 1.0)
