# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The best counterweights, by one cone programme.

Loads are linear in what counterweights add, by (G1) of :mod:`fourbar_lab.balancing.loads`, and
what they may add is a cone, by (G2). Both the largest of some loads and the added mass are to be
small, so root mean square, peak and full balance are programmes that Clarabel solves:

    minimize t,            |load_k(p)| <= t for each k, added mass <= M
    minimize added mass,   equations(p) = 0

Its prices prove how good a result is, whatever the error of the solver. For directions u_k with
sum |u_k| <= 1 no design p' within M and the radii has less than

    (G3)  max |load_k(p')| >= sum u_k . load_k(given) + min(0, M s),

where s is the least derivative of sum u_k . load_k per kilogram at any place.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from fourbar_lab.balancing.loads import BalanceError, Loads, NUMBERS, without_weight
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.quadrature import nodes
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.given import number
import numpy as np

# Of the solver; gap that a result may have, relative; what is rounding beside the radius or mass.
TOLERANCE, ENOUGH, NOTHING = 1e-12, 1e-6, 1e-10
# Of the best counterweights the lightest: a kilogram costs so much of the load.
LIGHT = 1e-9
# Singular values below this part of the largest are rounding; nearer than this part of the radius
# to their middle, two counterweights are one.
RANK, APART = 1e-10, 1e-3
# Added mass over the mechanism's mass: more than any possible design needs.
PLENTY = 1e4
# Inputs of the first programme of a peak; programmes at most.
INPUTS, ROUNDS = 128, 6
# (A, b, cone): A @ unknowns + b lies in the cone, 'zero', 'positive' or 'second order'
Constraint = tuple[Array, Array, str]


class Counterweight(NamedTuple):
    """A point mass on a link [kg], place from the link's first joint, along and across [m]."""

    link: str
    mass: float
    along: float
    across: float

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
        first = np.array([NUMBERS * loads.links.index(link) for link in radii])
        self.columns = (first[:, None] + np.arange(NUMBERS)).ravel()    # of p, that may change
        # units of these: 1 kg at the radius
        self.units = np.concatenate([(1.0, radius, radius, radius**2)
                                     for radius in radii.values()])

    def numbers(self, counterweights: Iterable[Counterweight]) -> Array:
        """Return (m, m x, m y, J) of all links with counterweights, shape (4 links,)."""
        numbers = self.loads.given.copy()
        for one in counterweights:
            first = NUMBERS * self.loads.links.index(one.link)
            numbers[first:first + NUMBERS] += one.numbers
        return numbers

    def lowest(self, slope: Array) -> float:
        """
        Return the least derivative per kilogram of a function, among all links and places.

        ``slope``, shape (4 links,): the derivatives of the function by (m, m x, m y, J). At a
        distance r against (m x, m y) of a link one kilogram changes it by
        s_m - r |(s_x, s_y)| + r^2 s_J: a parabola of r, least at its vertex or at an end.
        """
        by_mass, by_x, by_y, by_inertia = (slope[self.columns] * self.units).reshape(-1, NUMBERS).T
        side = np.hypot(by_x, by_y)
        with np.errstate(divide='ignore', invalid='ignore'):
            vertex = np.where(by_inertia > 0.0, np.minimum(0.5 * side / by_inertia, 1.0), 1.0)
        return float(min(np.min(by_mass - r * side + by_inertia * r * r)
                         for r in (np.zeros(side.shape), vertex)))

    def counterweights(self, parts: Array, whole: float) -> tuple[Counterweight, ...]:
        """
        Return what is added, ``parts`` of a whole [kg] in :attr:`units`, as counterweights.

        One a link; two, square to the way from the joint, if it takes more inertia than a point.
        """
        found: list[Counterweight] = []
        for (link, radius), (m, x, y, inertia) in zip(self.radii.items(),
                                                      parts.reshape(-1, NUMBERS).tolist()):
            if m <= NOTHING:
                continue
            x, y = (0.0 if abs(part) < NOTHING else part for part in (x / m, y / m))
            away, apart = np.hypot(x, y), np.sqrt(max(inertia / m - x * x - y * y, 0.0))
            u, v = (-y / away, x / away) if away else (1.0, 0.0)
            ways = (-apart, apart) if apart > APART else (0.0,)
            found += [Counterweight(link, whole * m / len(ways), float(radius * (x + way * u)),
                                    float(radius * (y + way * v))) for way in ways]
        return tuple(found)

    def solved(self, cost: Sequence[float], rows: Sequence[Constraint], mass: float
               ) -> tuple[Array, list[Array]] | None:
        """
        Return the cheapest (what is added in :attr:`units`, t), and the prices of rows.

        ``cost`` is that of a kilogram and of t; None if nothing fulfils the rows.
        """
        import clarabel
        from scipy.sparse import csc_matrix
        cones = {'zero': clarabel.ZeroConeT, 'positive': clarabel.NonnegativeConeT,
                 'second order': clarabel.SecondOrderConeT}
        links = len(self.radii)
        unknown = np.eye(NUMBERS * links + 1)
        m, x, y, inertia = (unknown[i:-1:NUMBERS] for i in range(NUMBERS))      # of all links
        every = [*rows,
                 # at most the mass, and J <= R^2 m of (G2)
                 (np.vstack((-m.sum(axis=0), m - inertia)), np.append(mass, np.zeros(links)),
                  'positive'),
                 # the other half of (G2): |2 m x, 2 m y, m - J| <= m + J
                 *((np.stack(one), np.zeros(4), 'second order')
                   for one in zip(m + inertia, 2.0 * x, 2.0 * y, m - inertia))]
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
        by_mass, by_t = cost
        solution = clarabel.DefaultSolver(
            csc_matrix(np.zeros_like(unknown)), by_mass * m.sum(axis=0) + by_t * unknown[-1],
            csc_matrix(-np.concatenate([A for A, _, _ in every])),
            np.concatenate([b for _, b, _ in every]),
            [cones[cone](len(b)) for _, b, cone in every], settings).solve()
        if 'Infeasible' in str(solution.status):
            return None
        ends = np.cumsum([len(b) for _, b, _ in rows])
        return np.array(solution.x)[:-1], np.split(np.array(solution.z), ends)[:-1]


def _least(places: Places, blocks: Array, mass: float) -> tuple[tuple[Counterweight, ...], float]:
    """
    Return the counterweights for the least t with |B_k p| <= t, and the bound (G3) of t.

    ``blocks``, shape (k, components, 4 links): the matrices B_k.
    """
    given = blocks @ places.loads.given                             # (k, components)
    scale = float(np.linalg.norm(given, axis=1).max()) or 1.0
    share = mass or 1.0                         # unknowns are parts of it
    matrices = blocks[:, :, places.columns] * (places.units * (share / scale))
    rows = list[Constraint]()
    for matrix, constant in zip(matrices, given / scale):
        A = np.zeros((1 + len(matrix), matrix.shape[1] + 1))
        A[0, -1], A[1:, :-1] = 1.0, matrix
        rows.append((A, np.append(0.0, constant), 'second order'))
    found = places.solved((LIGHT, 1.0), rows, mass / share)
    assert found is not None                    # to add nothing is always possible
    added, prices = found
    # within the radii and the mass, without the solver's tolerance
    added *= min(1.0, mass / (share * added[::NUMBERS].sum() or 1.0))
    m, x, y, inertia = added.reshape(-1, NUMBERS).T
    with np.errstate(divide='ignore', invalid='ignore'):
        added.reshape(-1, NUMBERS)[:, 1:3] *= np.fmin(1.0, m / np.hypot(x, y))[:, None]
    added[NUMBERS - 1::NUMBERS] = np.minimum(inertia, m)
    ways = -np.array([price[1:] for price in prices])
    return places.counterweights(added, share), _bound(places, blocks, ways, mass)


def _bound(places: Places, blocks: Array, ways: Array, mass: float) -> float:
    """
    Return the bound (G3) of the largest |B_k p|, whatever is added within radii and mass.

    ``ways``, shape (k, components): the directions u_k, whose sizes have a sum of about one.
    """
    given = blocks @ places.loads.given
    # of sum one but for the solver's tolerance; less where nothing remains
    ways = ways / max(float(np.linalg.norm(ways, axis=1).sum()), 1.0 - ENOUGH)
    slope = np.einsum('kc,kcp->p', ways, blocks)
    scale = float(np.linalg.norm(given, axis=1).max()) or 1.0
    rounding = 4.0 * slope.size * EPS * (scale + mass * float(
        np.abs(blocks[:, :, places.columns] * places.units).max()))
    bound: float = (float(np.sum(ways * given)) + min(0.0, mass * places.lowest(slope))
                    - rounding)
    return max(bound, 0.0)


def least_rms(places: Places, names: Iterable[str], mass: float) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least root mean square of loads.

    ``names`` are of :attr:`.Loads.groups`; if several, each load counts relative to its unbalanced
    value.
    """
    return front(places, names, (mass,))[0]


def front(places: Places, names: Iterable[str], masses: Iterable[float]) -> list[Balance]:
    """Return :func:`least_rms` of each added mass [kg]."""
    root = places.loads.root(names)
    balances = []
    for mass in masses:
        weights, bound = _least(places, root[None], number('mass', mass, 'must be zero or more',
                                                           least=0.0))
        numbers = places.numbers(weights)
        balances.append(Balance(weights, float(np.linalg.norm(root @ numbers)), bound, numbers))
    return balances


def least_peak(places: Places, name: str, mass: float) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least peak of a load by name.

    They are the best for some inputs; if the extrema of the mechanism with them are larger, the
    inputs of these are added, and all is solved again.
    """
    loads, mass = places.loads, number('mass', mass, 'must be zero or more', least=0.0)
    if loads.mechanism.flat_inputs:
        loads.root((name,))                 # a BalanceError if the load has no bound there
    x, _ = nodes(loads.mechanism, INPUTS)
    for _ in range(ROUNDS):
        blocks = np.stack([*loads.matrices(x, name)], axis=1)       # one of each input
        weights, bound = _least(places, blocks, mass)
        numbers = places.numbers(weights)
        value, inputs_of_maxima = peak(loads, name, numbers)
        if value <= bound * (1.0 + ENOUGH):
            break
        x = np.concatenate((x, inputs_of_maxima))
    return Balance(weights, value, bound, numbers)


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


def full_force_balance(places: Places) -> Balance:
    """
    Return the lightest counterweights that take the shaking force away in any pose.

    The force is a sum of functions of the input times linear combinations of first moments and
    masses; all of these must be zero (Berkof and Lowen 1969, Tepper and Lowen 1972). ``value`` and
    ``bound`` of the result are the added mass and its proven lower bound [kg]. BalanceError if no
    counterweights on these links do it; the message says how much force remains.
    """
    loads = places.loads
    # |root p| is the shaking force's root mean square
    root = loads.root(('force',), must_settle=False)
    _, sizes, directions = np.linalg.svd(root)
    equations = directions[sizes > RANK * sizes[0]]         # equations @ p = 0: no shaking force
    whole = float(loads.given[::NUMBERS].sum())
    matrix, target = equations[:, places.columns] * places.units, -equations @ loads.given / whole
    A = np.concatenate((matrix, np.zeros((len(matrix), 1))), axis=1)
    found = places.solved((1.0, 0.0), [(A, -target, 'zero')], PLENTY)
    if found is None:
        nearest, = front(places, ('force',), (PLENTY * whole,))
        remains = 100.0 * nearest.bound / float(np.linalg.norm(root @ loads.given))
        raise BalanceError(f'no counterweights on {", ".join(places.radii)} take the shaking '
                           f'force away: {remains:.3g} % of its RMS remains at least, whatever '
                           'their mass')
    added, (prices,) = found
    added[np.abs(added) < NOTHING] = 0.0
    moments = np.array([i for i in np.nonzero(added)[0] if i % NUMBERS in (1, 2)], int)
    for _ in range(3):                      # takes the solver's tolerance out of the moments
        added[moments] += np.linalg.lstsq(matrix[:, moments], target - matrix @ added,
                                          rcond=None)[0]
    m, x, y, _ = added.reshape(-1, NUMBERS).T                   # forces depend on no inertia
    added[NUMBERS - 1::NUMBERS] = np.divide(x * x + y * y, m, out=np.zeros(m.shape), where=m > 0.0)
    weights = places.counterweights(added, whole)
    # p of the equations costs at least its share of the target's price: duality, as in (G3)
    price = float(prices @ target) * np.sign(prices @ target)
    slope = np.sign(prices @ target) * equations.T @ prices
    bound = whole * price / max(-places.lowest(-slope), EPS)
    return Balance(weights, sum(one.mass for one in weights), bound, places.numbers(weights))
