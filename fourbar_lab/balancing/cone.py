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

    (G3)  max |load_k(p')| >= sum u_k . load_k(unbalanced) + min(0, M s),

where s is the least derivative of sum u_k . load_k per kilogram at any place.
"""
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

from fourbar_lab.balancing.loads import BalanceError, Loads, MOMENTS, moments_of
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanics.bodies import Body
from fourbar_ros.mechanisms.quadrature import nodes
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array, EPS
import numpy as np

# Tolerance of the solver; gap that a result may have, relative; rounding, of radius or mass.
TOLERANCE, ENOUGH, NOTHING = 1e-12, 1e-6, 1e-10
# Price of a kilogram beside the load, so that of equally good counterweights the lightest win.
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
    """A point mass on a link [kg]; along and across [m] from the link's first joint."""

    link: str
    mass: float
    along: float
    across: float


class Balance(NamedTuple):
    """Counterweights, and how good they are."""

    counterweights: tuple[Counterweight, ...]
    value: float        # the minimized load or mass, of the links with counterweights
    bound: float        # no counterweights within the radii and the mass give less
    moments: Array      # (m, m x, m y, J) of all links with them, shape (4 links,)

    @property
    def added(self) -> float:
        """Return the added mass [kg]."""
        return sum(weight.mass for weight in self.counterweights)


class Places:
    """
    Where counterweights may be: ``radii``, {link: greatest distance from its first joint [m]}.

    InvalidParameter of an unknown link or a radius that is not positive.
    """

    def __init__(self, loads: Loads, radii: dict[str, float]):
        for link, radius in radii.items():
            if link not in loads.links:
                raise InvalidParameter('link', link, f'must be one of {", ".join(loads.links)}')
            if not radius > 0.0:
                raise InvalidParameter(f'radius of {link}', radius, 'must be positive')
        self.loads, self.radii = loads, radii
        first = np.array([MOMENTS * loads.links.index(link) for link in radii])
        self.columns = (first[:, None] + np.arange(MOMENTS)).ravel()    # of p, that may change
        # units of these columns: 1 kg at the radius
        self.units = np.concatenate([(1.0, radius, radius, radius**2)
                                     for radius in radii.values()])

    def moments(self, counterweights: Iterable[Counterweight]) -> Array:
        """Return (m, m x, m y, J) of all links with counterweights, shape (4 links,)."""
        moments = self.loads.unbalanced.copy()
        for weight in counterweights:
            first = MOMENTS * self.loads.links.index(weight.link)
            moments[first:first + MOMENTS] += moments_of(Body(
                weight.mass, cg_along=weight.along, cg_across=weight.across))
        return moments

    def lowest(self, slope: Array) -> float:
        """
        Return the least derivative per kilogram of a function, of all links and distances.

        ``slope``, shape (4 links,): the derivatives of the function by (m, m x, m y, J). At a
        distance r against (m x, m y) of a link one kilogram changes it by
        s_m - r |(s_x, s_y)| + r^2 s_J: a parabola of r, least at its vertex or at an end.
        """
        by_mass, by_x, by_y, by_inertia = (slope[self.columns] * self.units).reshape(-1, MOMENTS).T
        side = np.hypot(by_x, by_y)
        with np.errstate(divide='ignore', invalid='ignore'):
            vertex = np.where(by_inertia > 0.0, np.minimum(0.5 * side / by_inertia, 1.0), 1.0)
        return float(min(np.min(by_mass - r * side + by_inertia * r * r)
                         for r in (np.zeros(side.shape), vertex)))

    def counterweights(self, shares: Array, mass: float) -> tuple[Counterweight, ...]:
        """
        Return the counterweights that add ``shares`` of a mass [kg], in :attr:`units`.

        One for each link; two, side by side on a line square to the radius, where the inertia is
        larger than that of a point mass.
        """
        weights: list[Counterweight] = []
        for (link, radius), (m, x, y, inertia) in zip(self.radii.items(),
                                                      shares.reshape(-1, MOMENTS).tolist()):
            if m <= NOTHING:
                continue
            x, y = (0.0 if abs(u) < NOTHING else u for u in (x / m, y / m))
            distance, apart = np.hypot(x, y), np.sqrt(max(inertia / m - x * x - y * y, 0.0))
            u, v = (-y / distance, x / distance) if distance != 0.0 else (1.0, 0.0)
            sides = (-apart, apart) if apart > APART else (0.0,)
            weights += [Counterweight(link, mass * m / len(sides), float(radius * (x + side * u)),
                                      float(radius * (y + side * v))) for side in sides]
        return tuple(weights)

    def solved(self, cost: Sequence[float], rows: Sequence[Constraint], mass: float
               ) -> tuple[Array, list[Array]] | None:
        """
        Return the cheapest unknowns (added moments in :attr:`units`), and the prices of rows.

        ``cost``: of a kilogram and of the last unknown, t. None if no design fulfils the rows.
        """
        import clarabel
        from scipy.sparse import csc_matrix
        cones = {'zero': clarabel.ZeroConeT, 'positive': clarabel.NonnegativeConeT,
                 'second order': clarabel.SecondOrderConeT}
        links = len(self.radii)
        unknown = np.eye(MOMENTS * links + 1)
        m, x, y, inertia = (unknown[i:-1:MOMENTS] for i in range(MOMENTS))      # of all links
        every = [*rows,
                 # at most the mass, and J <= R^2 m of (G2)
                 (np.vstack((-m.sum(axis=0), m - inertia)), np.append(mass, np.zeros(links)),
                  'positive'),
                 # the other half of (G2): |2 m x, 2 m y, m - J| <= m + J
                 *((np.stack(of_link), np.zeros(4), 'second order')
                   for of_link in zip(m + inertia, 2.0 * x, 2.0 * y, m - inertia))]
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


def _least(sites: Places, blocks: Array, mass: float) -> tuple[tuple[Counterweight, ...], float]:
    """Return the counterweights for the least t with |B_k p| <= t, and the bound (G3) of t."""
    # blocks, shape (k, components, MOMENTS * links): the matrices B_k; mass: the most that may be
    # added [kg].
    # 1. the cones |B_k p| <= t, with loads and masses of about one and t as the last unknown
    unbalanced = blocks @ sites.loads.column(sites.loads.unbalanced)     # (k, components)
    largest = float(np.linalg.norm(unbalanced, axis=1).max())
    scale = largest if largest != 0.0 else 1.0
    share = mass if mass != 0.0 else 1.0        # [kg], the unit of the unknown masses
    matrices = blocks[:, :, sites.columns] * (sites.units * (share / scale))
    rows = list[Constraint]()
    for matrix, constant in zip(matrices, unbalanced / scale):
        A = np.zeros((1 + len(matrix), matrix.shape[1] + 1))
        A[0, -1], A[1:, :-1] = 1.0, matrix
        rows.append((A, np.append(0.0, constant), 'second order'))
    solution = sites.solved((LIGHT, 1.0), rows, mass / share)
    assert solution is not None                 # no added mass is always a solution
    added, prices = solution        # prices: the dual variables of the cones
    # 2. the solver keeps limits to its tolerance: here to the last bit, first the mass, then the
    # radii (a place without mass has 0/0 and keeps its zeros), last the moments of inertia
    total = share * added[::MOMENTS].sum()
    added *= min(1.0, mass / (total if total != 0.0 else 1.0))
    m, x, y, inertia = added.reshape(-1, MOMENTS).T
    with np.errstate(divide='ignore', invalid='ignore'):
        added.reshape(-1, MOMENTS)[:, 1:3] *= np.fmin(1.0, m / np.hypot(x, y))[:, None]
    added[MOMENTS - 1::MOMENTS] = np.minimum(inertia, m)
    # 3. the bound (G3) holds for any directions u_k whose sizes have a sum of one at most, so
    # whatever the solver's tolerance; prices have that sum, and less where no load remains
    u = -np.array([price[1:] for price in prices])
    u = u / max(float(np.linalg.norm(u, axis=1).sum()), 1.0 - ENOUGH)
    slope = np.einsum('kc,kcp->p', u, blocks)
    rounding = 4.0 * slope.size * EPS * (scale + mass * float(
        np.abs(blocks[:, :, sites.columns] * sites.units).max()))
    bound = float(np.sum(u * unbalanced)) + min(0.0, mass * sites.lowest(slope)) - rounding
    return sites.counterweights(added, share), max(bound, 0.0)


def least_rms(sites: Places, names: Iterable[str], mass: float) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least root mean square of loads.

    ``names`` are of :attr:`.Loads.groups`; if several, each load counts relative to its unbalanced
    value.
    """
    return front(sites, names, (mass,))[0]


def front(sites: Places, names: Iterable[str], masses: Iterable[float]) -> list[Balance]:
    """Return :func:`least_rms` of each added mass [kg]."""
    root = sites.loads.root(names)
    balances = []
    for mass in masses:
        weights, bound = _least(sites, root[None], finite('mass', mass, 'must be zero or more',
                                                          least=0.0))
        moments = sites.moments(weights)
        value = float(np.linalg.norm(root @ sites.loads.column(moments)))
        balances.append(Balance(weights, value, bound, moments))
    return balances


def least_peak(sites: Places, name: str, mass: float) -> Balance:
    """
    Return the counterweights of ``mass`` [kg] at most with the least peak of a load by name.

    The counterweights are the best for some inputs. If the extrema of the mechanism with them are
    larger, the inputs of these extrema are added, and the programme is solved again.
    """
    loads, mass = sites.loads, finite('mass', mass, 'must be zero or more', least=0.0)
    if loads.mechanism.flat_inputs:
        loads.root((name,))                 # a BalanceError if the load has no bound there
    x, _ = nodes(loads.acting, INPUTS)
    for _ in range(ROUNDS):
        blocks = np.stack([*loads.matrices(x, name)], axis=1)       # a block for each input
        weights, bound = _least(sites, blocks, mass)
        moments = sites.moments(weights)
        value, inputs_of_maxima = peak(loads, name, moments)
        if value <= bound * (1.0 + ENOUGH):
            break
        x = np.concatenate((x, inputs_of_maxima))
    return Balance(weights, value, bound, moments)


def peak(loads: Loads, name: str, moments: Array) -> tuple[float, Array]:
    """Return the largest magnitude of a load [N or N m], and where it is extreme."""
    acting = replace(loads.acting, bodies=loads.balanced(moments).bodies)
    field, = {component.removesuffix('_x').removesuffix('_y') for component in loads.group(name)}
    extrema = find_extrema(acting, (field,), loads.rate, conditions=False)
    return (max((abs(extremum.value) for extremum in extrema), default=0.0),
            np.array([extremum.input for extremum in extrema]))


def full_force_balance(sites: Places) -> Balance:
    """
    Return the lightest counterweights that take the shaking force away in any pose.

    The force is a sum of functions of the input times linear combinations of first moments and
    masses; all of these must be zero (Berkof and Lowen 1969, Tepper and Lowen 1972). ``value`` and
    ``bound`` of the result are the added mass and its proven lower bound [kg]. BalanceError if no
    counterweights on these links do it; the message says how much force remains.
    """
    if sites.loads.mechanism.elements:      # whose forces no masses take away
        loads = Loads(sites.loads.mechanism.with_elements(), sites.loads.rate)
        return full_force_balance(Places(loads, sites.radii))
    loads = sites.loads
    # |root p| is the shaking force's root mean square
    root = loads.root(('force',), must_settle=False)
    _, sizes, directions = np.linalg.svd(root)
    equations = directions[sizes > RANK * sizes[0]]         # equations @ p = 0: no shaking force
    whole = float(loads.unbalanced[::MOMENTS].sum())
    matrix = equations[:, sites.columns] * sites.units
    target = -equations @ loads.unbalanced / whole
    A = np.concatenate((matrix, np.zeros((len(matrix), 1))), axis=1)
    solution = sites.solved((1.0, 0.0), [(A, -target, 'zero')], PLENTY)
    if solution is None:
        nearest, = front(sites, ('force',), (PLENTY * whole,))
        remains = 100.0 * nearest.bound / float(np.linalg.norm(root @ loads.unbalanced))
        raise BalanceError(f'no counterweights on {", ".join(sites.radii)} take the shaking '
                           f'force away: {remains:.3g} % of its RMS remains at least, whatever '
                           'their mass')
    added, (prices,) = solution
    added[np.abs(added) < NOTHING] = 0.0
    first_moments = np.array([i for i in np.nonzero(added)[0] if i % MOMENTS in (1, 2)], int)
    for _ in range(3):                      # takes the solver's tolerance out of these moments
        added[first_moments] += np.linalg.lstsq(matrix[:, first_moments], target - matrix @ added,
                                                rcond=None)[0]
    m, x, y, _ = added.reshape(-1, MOMENTS).T                   # forces depend on no inertia
    added[MOMENTS - 1::MOMENTS] = np.divide(x * x + y * y, m, out=np.zeros(m.shape), where=m > 0.0)
    weights = sites.counterweights(added, whole)
    # p of the equations costs at least its share of the target's price: duality, as in (G3)
    price = float(prices @ target) * np.sign(prices @ target)
    slope = np.sign(prices @ target) * equations.T @ prices
    bound = whole * price / max(-sites.lowest(-slope), EPS)
    return Balance(weights, sum(weight.mass for weight in weights), bound, sites.moments(weights))
