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

# Singular values below this part are rounding; forces below that part of the unbalanced one are
# balanced.
RANK, BALANCED = 1e-10, 1e-9
# Mass that is tried, over that of the mechanism; steps of the programme.
PLENTY, STEPS, ENOUGH = 1e4, 100, 1e-10


def full_force_balance(places: Places) -> Balance:
    """
    Return the lightest counterweights that take the shaking force away.

    ``value`` and ``bound`` of the result are the added mass and a proven lower bound of it [kg].

    Raises
    ------
    BalanceError
        It cannot be done with counterweights on these links; the message says what remains.

    """
    loads = places.loads
    root = loads.root(('force',))
    unbalanced = float(np.linalg.norm(root @ loads.given))
    mass = PLENTY * float(loads.given[::4].sum())
    start = nearest_to_zero(places, root, mass)
    if start.value > BALANCED * unbalanced:
        raise BalanceError('no counterweights on '
                           f'{", ".join(places.radii)} take the shaking force away: '
                           f'{100.0 * start.bound / unbalanced:.3g} % of its RMS remains at '
                           'least, whatever their mass')
    _, sizes, directions = np.linalg.svd(root)
    equations = directions[sizes > RANK * sizes[0]]
    spots, weights, bound = _lightest(places, equations,
                                      [(one.link, one.along, one.across)
                                       for one in start.counterweights])
    found = _merged(places, equations, spots, weights)
    return Balance(found, sum(one.mass for one in found), bound, places.numbers(found))


def _lightest(places: Places, equations: Array,
              spots: list[Spot]) -> tuple[list[Spot], Array, float]:
    """Return places, masses, and a lower bound of the mass: a linear programme, by columns."""
    from scipy.optimize import linprog
    target = -equations @ places.loads.given
    scale = float(np.abs(target).max()) or 1.0
    for _ in range(STEPS):
        matrix = np.stack([equations @ places.column(*spot) for spot in spots], axis=1)
        found = linprog(np.ones(len(spots)), A_eq=matrix, b_eq=target / scale, method='highs')
        if not found.success:
            raise BalanceError(f'the linear programme of the masses ended with: {found.message}')
        prices = found.eqlin.marginals
        slope, spot = places.lowest(-equations.T @ prices)
        weights, best = scale * found.x, scale * float(found.fun)
        if 1.0 + slope >= -ENOUGH:
            break
        spots = [*spots, spot]
    # prices over (1 - what a place violates) violate nowhere
    return spots[:len(weights)], weights, best / max(1.0, -slope)


def _merged(places: Places, equations: Array, spots: list[Spot],
            weights: Array) -> tuple[Counterweight, ...]:
    """
    Return one counterweight a link, where its mass centre is, to rounding.

    The shaking force depends on masses and first moments alone.
    """
    links = places.loads.links
    added = np.zeros((len(links), NUMBERS))
    for spot, weight in zip(spots, weights.tolist()):
        added[links.index(spot[0])] += weight * Counterweight(spot[0], 1.0, *spot[1:]).numbers
    used = [i for i in range(len(links)) if added[i, 0] > 0.0]
    moments = [NUMBERS * i + axis for i in used for axis in (1, 2)]
    for _ in range(3):
        rest = -equations @ (places.loads.given + added.ravel())
        added.flat[moments] += np.linalg.lstsq(equations[:, moments], rest, rcond=None)[0]
    return tuple([Counterweight(links[i], float(added[i, 0]), *places.place(
        links[i], float(added[i, 1] / added[i, 0]), float(added[i, 2] / added[i, 0])))
        for i in used])
