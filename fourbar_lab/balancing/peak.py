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
from fourbar_lab.balancing.rms import Balance, nearest_to_zero, Places, Spot
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.numerics.arrays import Array
import numpy as np

# Inputs of the first linear programmes; programmes for a set of inputs, and sets, at most; gap to
# the bound, or to the real extrema, that is small enough, relative.
INPUTS, STEPS, ROUNDS, ENOUGH = 128, 200, 6, 1e-6


def least_peak(places: Places, name: str, mass: float) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least peak of a load by name.

    They are the best for some inputs; if the extrema of the mechanism with them are larger, the
    inputs of these are added, and all is solved again.
    """
    loads = places.loads
    x, _ = loads.nodes(INPUTS)
    start = nearest_to_zero(places, loads.root((name,)), mass)
    spots = [one.spot for one in start.counterweights]
    for _ in range(ROUNDS):
        problem = _PeakAtInputs(places, name, mass, x)
        masses, spots, bound = problem.solve(spots)
        masses = masses * mass / max(masses.sum(), mass)         # within the solver's tolerance
        numbers = places.numbers(map(Spot.with_mass, spots, masses))
        value, inputs_of_maxima = peak(loads, name, numbers)
        if value <= problem.largest(numbers)[0] * (1.0 + ENOUGH):
            break
        x = np.concatenate((x, inputs_of_maxima))
    weights = places.united(
        [spot.with_mass(one) for spot, one in zip(spots, masses.tolist()) if one > 0.0],
        lambda numbers: problem.largest(numbers)[0], value * (1.0 + ENOUGH))
    numbers = places.numbers(weights)
    return Balance(tuple(weights), peak(loads, name, numbers)[0], bound, numbers)


def peak(loads: Loads, name: str, numbers: Array) -> tuple[float, Array]:
    """
    Return the largest magnitude of a load of inertia [N or N m], and the inputs of its extrema.

    ``numbers``: (m, m x, m y, J) of all links.
    """
    weightless = without_weight(loads.balanced(numbers))
    field, = {component.removesuffix('_x').removesuffix('_y') for component in loads.group(name)}
    extrema = find_extrema(weightless, (field,), loads.rate, conditions=False)
    return (max((abs(one.value) for one in extrema), default=0.0),
            np.array([one.input for one in extrema]))


class _PeakAtInputs:
    """The least peak of a load over a finite set of inputs x, by linear programmes."""

    def __init__(self, places: Places, name: str, mass: float, x: Array):
        self.places, self.mass = places, mass
        fields = places.loads.matrices(x, places.loads.group(name))
        self.matrices = np.stack(list(fields.values()))      # (components, inputs, numbers)
        self.given = places.loads.given

    def largest(self, numbers: Array) -> tuple[float, Array]:
        """
        Return the largest magnitude of the load, and rows, shape (maxima, 4 links).

        There is a row u . A of (B1) for each local maximum over the inputs, u the direction of the
        load there: row . p is its magnitude.
        """
        load = self.matrices @ numbers                       # (components, inputs)
        size = np.linalg.norm(load, axis=0)
        is_maximum = (size >= np.roll(size, 1)) & (size >= np.roll(size, -1)) & (size > 0.0)
        rows = [np.einsum('c,cp->p', load[:, i] / size[i], self.matrices[:, i])
                for i in np.nonzero(is_maximum)[0]]
        return float(size.max()), np.array(rows).reshape(-1, len(self.given))

    def solve(self, spots: list[Spot]) -> tuple[Array, list[Spot], float]:
        """
        Return masses [kg], their spots, and a lower bound of the peak.

        ``spots`` are where to begin. Each round adds the rows u . A that the last design violates
        and the spot that helps most, until peak and bound agree.
        """
        masses: Array = np.zeros(len(spots))
        rows = self.largest(self.given)[1]
        rows = np.concatenate((rows, -rows))
        bound, best = 0.0, np.inf
        for _ in range(STEPS):
            masses, prices = self._programme(rows, spots)
            slope, spot = self.places.lowest(rows.T @ prices)
            bound = max(bound, float(prices @ rows @ self.given)
                        + min(0.0, self.mass * slope))
            top, more = self.largest(self.places.numbers(map(Spot.with_mass, spots, masses)))
            best = min(best, top)
            if best - bound <= ENOUGH * best:
                break
            rows = np.concatenate((rows, more))
            if spot not in spots:
                spots, masses = [*spots, spot], np.append(masses, 0.0)
        return masses, spots, bound

    def _programme(self, rows: Array, spots: list[Spot]) -> tuple[Array, Array]:
        """
        Return the masses [kg] at spots of least peak t, and the prices of the rows, of sum one.

        Unknowns are shares of the mass, one a spot, and t: minimize t with row . p <= t for each
        row, and the shares add up to one at most.
        """
        from scipy.optimize import linprog
        unbalanced = rows @ self.given
        scale = float(np.abs(unbalanced).max()) or 1.0
        columns = [rows @ self.places.column(*spot) * (self.mass / scale) for spot in spots]
        matrix = np.stack([*columns, -np.ones(len(rows))], axis=1)
        budget = np.array([[1.0] * len(spots) + [0.0]])
        solution = linprog(np.array([0.0] * len(spots) + [1.0]),
                           A_ub=np.concatenate((matrix, budget)),
                           b_ub=np.concatenate((-unbalanced / scale, [1.0])), method='highs',
                           bounds=[(0.0, None)] * (len(spots) + 1))
        prices = np.maximum(-solution.ineqlin.marginals[:-1], 0.0)
        return self.mass * solution.x[:-1], prices / (prices.sum() or 1.0)
