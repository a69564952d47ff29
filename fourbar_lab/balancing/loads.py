# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads as linear functions of masses.

At one motion every component of a load is linear in four moments of each link: its mass m, its
first moments m x and m y about its first joint, and its moment of inertia J about that joint,

    (G1)  load(q) = A(q) p,     p = (m, m x, m y, J) of all links.

A counterweight adds to p. What mass within a circle of radius R about the first joint can add is
a convex cone, spanned by points at distances r <= R in directions f:

    (G2)  m (1, r cos f, r sin f, r^2),   that is   (m x)^2 + (m y)^2 <= m J,   J <= R^2 m.

Springs and forces over a position add to a load what no mass changes: one more column of A, and 1
as the last entry of p. Weight and constant forces stay as they are, and are left out here.
"""
from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from math import isfinite

from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.mechanics.bodies import Body
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quadrature import mean_over_input, MOST_OF_RANGE, nodes
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.number_types import power_of_two
import numpy as np

MOMENTS = 4                 # of a link: m, m x, m y, J of (G1)
# Inputs of a root mean square: doubled from, at most to, until two results agree to this part.
POINTS, MOST_POINTS, AGREE = 128, 2**13, 1e-10


class BalanceError(FourBarError, ValueError):
    """A mechanism cannot be balanced as asked; the message gives the reason."""


def moments_of(body: Body) -> Array:
    """Return (m, m x, m y, J) of a body, with J about the first joint: J = J_cg + m r^2."""
    along, across = body.cg_along, body.cg_across
    return np.array((body.mass, body.mass * along, body.mass * across,
                     body.inertia + body.mass * (along * along + across * across)))


def body_of(moments: Array) -> Body:
    """Return the body with (m, m x, m y, J): the inverse of :func:`moments_of`, J_cg >= 0."""
    mass, along, across, inertia = moments.tolist()
    if mass == 0.0:
        return Body(0.0, inertia=max(inertia, 0.0))
    x, y = along / mass, across / mass
    return Body(mass, cg_along=x, cg_across=y, inertia=max(inertia - mass * (x * x + y * y), 0.0))


class Loads:
    """
    The loads of a mechanism with masses, as functions of these, at a constant input rate.

    The rate is in [rad/s or m/s]. BalanceError if it has no masses, or if its input ends at a
    toggle position, where no mass helps. ``unbalanced`` holds (m, m x, m y, J) of all links, shape
    (4 links,), before balancing.
    """

    def __init__(self, mechanism: Mechanism, rate: float):
        if not isinstance(mechanism, Mechanism):
            raise InvalidParameter('mechanism', mechanism, 'must be a mechanism, as a FourBar is')
        if mechanism.bodies is None:
            raise BalanceError('nothing to balance: the scene gives no masses')
        if rate == 0.0 or not isfinite(rate):
            raise InvalidParameter('rate', rate, 'must be finite, not zero')
        mechanism.require_no_friction('balancing')
        if mechanism.toggles:
            raise BalanceError('loads grow without bound at the toggle positions where the input '
                               'ends: give it a range (linkage.range) that keeps away')
        self.mechanism, self.rate = mechanism, rate
        self.links: tuple[str, ...] = mechanism.BODIES._fields      # in the order of p
        # a link of a machine may have no body
        self.unbalanced = np.concatenate([moments_of(body or Body(0.0))
                                          for body in mechanism.bodies])
        self.acting = mechanism.weightless.with_elements(*mechanism.elements)
        self.title = 'loads of inertia' + (', springs and forces' if mechanism.elements else '')

    def column(self, moments: Array) -> Array:
        """Return p of (G1) with these moments of all links."""
        return np.append(moments, 1.0) if self.mechanism.elements else moments

    @cached_property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Return {name of a load that can be balanced: its components, fields of the loads}."""
        fields = self.mechanism.LOADS._fields
        bearings = [name.removesuffix('_x') for name in fields
                    if name.endswith('_x') and not name.startswith('shaking')]
        return {'force': ('shaking_force_x', 'shaking_force_y'), 'moment': ('shaking_moment',),
                'torque': (self.mechanism.drive_load,),
                **{name: (f'{name}_x', f'{name}_y') for name in bearings}}

    def group(self, name: str) -> tuple[str, ...]:
        """Return the components of a load by its name; InvalidParameter if it is unknown."""
        if not isinstance(name, str) or name not in self.groups:
            raise InvalidParameter('minimize', name, f'unknown{nearest(name, self.groups)}')
        return self.groups[name]

    def _rounding(self, name: str, moments: Array) -> float:
        """Return the size [N or N m] of a load that is rounding alone: its terms cancel."""
        size = max(map(abs, self.mechanism.lengths))
        speed = self.rate * (1.0 if self.mechanism.is_driven_by_slide else size)
        energy = float(moments[::MOMENTS].sum()) * speed * speed
        return 16.0 * EPS * energy / (1.0 if name in ('moment', 'torque') else size)

    def matrices(self, x: Array, name: str) -> Array:
        """
        Return A of (G1) for a load by name at inputs x: shape (components, inputs, entries of p).

        A column is the load of a mechanism whose links have no mass but one, a probe: 1 kg at its
        first joint, 1 kg at a distance u along or across, 1 kg m^2. The second probe has the
        moments (1, u, 0, u^2), so A_x = (load - A_m - u^2 A_J) / u.
        """
        fields, columns = self.group(name), list[Array]()
        weightless, none = self.mechanism.weightless, [Body(0.0)] * len(self.links)

        def loads_of(mechanism: Mechanism, bodies: list[Body]) -> Array:
            """Return the loads of such bodies, shape (components, inputs)."""
            mechanism = replace(mechanism, bodies=self.mechanism.BODIES(*bodies))
            return np.array([np.broadcast_to(load, x.shape)
                             for load in mechanism.step(x, self.rate, fields=fields)])
        unit = power_of_two(*self.mechanism.lengths)        # u
        probes = (Body(1.0), Body(1.0, cg_along=unit), Body(1.0, cg_across=unit),
                  Body(0.0, inertia=1.0))
        for link in range(len(self.links)):
            mass, along, across, inertia = [
                loads_of(weightless, [*none[:link], probe, *none[link + 1:]]) for probe in probes]
            rest = mass / unit + unit * inertia         # (A_m + u^2 A_J) / u
            columns += [mass, along / unit - rest, across / unit - rest, inertia]
        if self.mechanism.elements:
            columns.append(loads_of(self.acting, none))
        return np.stack(columns, axis=-1)

    def root(self, names: Iterable[str], must_settle: bool = True) -> Array:
        """
        Return R such that |R p| is the root mean square over the input of the loads by name.

        R is square, as wide as p: a norm of p makes it a problem of least distance. If
        there are several loads, each counts relative to its unbalanced value, and |R p|^2 is the
        sum of their squares. Inputs are doubled until the size of R settles; BalanceError if it
        does not, and ``must_settle``.
        """
        names, points, before = tuple(names), POINTS, np.inf
        most = (MOST_POINTS if self.mechanism.turns_fully and not self.mechanism.flat_inputs
                else MOST_OF_RANGE)
        if not names or len({*names}) < len(names):
            raise InvalidParameter('minimize', names, 'must name a load at least, each once'
                                   f'{nearest("", self.groups)}')
        while True:
            x, weights = nodes(self.acting, points)
            blocks = []             # B with |B p| the root mean square of a load
            for name in names:
                block = np.concatenate(np.sqrt(weights)[:, None] * self.matrices(x, name))
                size = float(np.linalg.norm(block @ self.column(self.unbalanced)))
                is_relative = len(names) > 1 and size > self._rounding(name, self.unbalanced)
                blocks.append(block / size if is_relative else block)
            # B = Q R with |Q v| = |v|: R has the norms of B in few rows
            root = np.asarray(np.linalg.qr(np.concatenate(blocks), mode='r'))
            size = float(np.linalg.norm(root))
            has_settled = abs(size - before) <= AGREE * size + max(
                self._rounding(name, self.unbalanced) for name in names)
            if has_settled or points >= most:
                break
            points, before = 2 * points, size
        if must_settle and not has_settled:
            why = ('grows without bound at the flat positions of this change point'
                   if self.mechanism.flat_inputs else
                   f'does not settle with {points} inputs, so near to a change point')
            raise BalanceError(f'{" and ".join(names)}: the root mean square {why}')
        return root

    def rms(self, name: str, moments: Array) -> float:
        """Return the root mean square [N or N m] of a load; NaN if it does not settle."""
        def squares(x: Array) -> Array:
            load = self.matrices(x, name) @ self.column(moments)
            return np.asarray((load * load).sum(axis=0))[None]

        rounding = self._rounding(name, moments)
        mean, = mean_over_input(self.acting, squares, least_size=rounding * rounding / AGREE)
        return float(np.sqrt(mean))

    def balanced(self, moments: Array) -> Mechanism:
        """Return the mechanism with ``moments`` of its links; weight and springs act as before."""
        bodies = [body_of(of_link) for of_link in moments.reshape(-1, MOMENTS)]
        return replace(self.mechanism, bodies=self.mechanism.BODIES(*bodies))
