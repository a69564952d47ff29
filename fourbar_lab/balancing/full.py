# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Full force balance: no shaking force in any pose, with the least added mass.

The shaking force is a sum of functions of the input times linear combinations of the first
moments and masses of the links. All of these must be zero: linear equations (Berkof and Lowen
1969, for the 4R; Tepper and Lowen 1972: possible wherever every link has a way to the ground that
is not through slides alone). Among their solutions within the radii, a linear programme finds the
one of least mass.
"""
from __future__ import annotations

from fourbar_lab.balancing.loads import BalanceError, NUMBERS
from fourbar_lab.balancing.rms import Balance, Counterweight, nearest_to_zero, Places, Spot
from fourbar_ros.numerics.arrays import Array
import numpy as np

# Singular values below this part of the largest, and shaking forces below this part of the
# unbalanced one, are rounding.
RANK, BALANCED = 1e-10, 1e-9
# Added mass over the mechanism's mass: more than any possible design needs.
PLENTY = 1e4
# Spots that the linear programme tries at most; reduced cost per kilogram that counts as none.
STEPS, ENOUGH = 100, 1e-10


def full_force_balance(places: Places) -> Balance:
    """
    Return the lightest counterweights that take the shaking force away.

    ``value`` and ``bound`` of the result are the added mass and its proven lower bound [kg].
    BalanceError if no counterweights on these links do it; the message says how much force
    remains.
    """
    loads = places.loads
    root = loads.root(('force',))           # |root p|: the shaking force's root mean square
    unbalanced = float(np.linalg.norm(root @ loads.given))
    nearest = nearest_to_zero(places, root, PLENTY * float(loads.given[::NUMBERS].sum()))
    if nearest.value > BALANCED * unbalanced:
        raise BalanceError('no counterweights on '
                           f'{", ".join(places.radii)} take the shaking force away: '
                           f'{100.0 * nearest.bound / unbalanced:.3g} % of its RMS remains at '
                           'least, whatever their mass')
    _, sizes, directions = np.linalg.svd(root)
    equations = directions[sizes > RANK * sizes[0]]         # equations @ p = 0: no shaking force
    spots, masses, bound = _lightest(places, equations,
                                     [one.spot for one in nearest.counterweights])
    weights = _merged(places, equations, spots, masses)
    return Balance(weights, sum(one.mass for one in weights), bound, places.numbers(weights))


def _lightest(places: Places, equations: Array,
              spots: list[Spot]) -> tuple[list[Spot], Array, float]:
    """
    Return spots, their masses [kg], and a lower bound of the total mass of any solution [kg].

    The method is column generation. A linear programme finds the best masses at the known spots.
    Its prices tell which other spot would lower the total most. That spot is added, until none
    helps.
    """
    from scipy.optimize import linprog
    target = -equations @ places.loads.given
    scale = float(np.abs(target).max()) or 1.0
    for _ in range(STEPS):
        matrix = np.stack([equations @ places.column(*spot) for spot in spots], axis=1)
        solution = linprog(np.ones(len(spots)), A_eq=matrix, b_eq=target / scale, method='highs')
        if not solution.success:
            raise BalanceError(
                f'the linear programme of the masses ended with: {solution.message}')
        prices = solution.eqlin.marginals
        slope, spot = places.lowest(-equations.T @ prices)
        masses, total = scale * solution.x, scale * float(solution.fun)
        if 1.0 + slope >= -ENOUGH:      # a kilogram at the best spot saves no more than it adds
            break
        spots = [*spots, spot]
    # scaled by 1 / -slope the prices are feasible for every spot, so they bound the mass: duality
    return spots[:len(masses)], masses, total / max(1.0, -slope)


def _merged(places: Places, equations: Array, spots: list[Spot],
            masses: Array) -> tuple[Counterweight, ...]:
    """
    Return one counterweight a link, at the mass centre of its spots.

    That is allowed since the shaking force depends on masses and first moments alone. A least
    squares step repeated three times takes the solver's tolerance out of the first moments.
    """
    links = places.loads.links
    added = np.zeros((len(links), NUMBERS))
    for spot, mass in zip(spots, masses.tolist()):
        added[links.index(spot.link)] += mass * spot.with_mass(1.0).numbers
    used = [i for i in range(len(links)) if added[i, 0] > 0.0]
    moments = [NUMBERS * i + axis for i in used for axis in (1, 2)]
    for _ in range(3):
        residual = -equations @ (places.loads.given + added.ravel())
        added.flat[moments] += np.linalg.lstsq(equations[:, moments], residual, rcond=None)[0]
    return tuple([Counterweight(links[i], float(added[i, 0]), *places.without_rounding(
        links[i], float(added[i, 1] / added[i, 0]), float(added[i, 2] / added[i, 0])))
        for i in used])
