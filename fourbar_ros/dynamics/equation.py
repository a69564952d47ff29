# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Eksergian's equation of motion of any mechanism with one degree of freedom.

With q the input (an angle or a slide), primes for derivatives with respect to it, and w = dq/dt,

    J dw/dt + J'/2 w^2 = Q - D w + T                                                       (E1)

T is the torque (force) of the drive. A link has the mass m; its first joint X moves along the
curve X(q) while it turns by theta(q). S is its first moment of mass about X (along the ground
axes), I its moment of inertia about X. It adds

    J    = m X'.X' + 2 theta' (S x X') + I theta'^2                                        (E2)
    J'/2 = m X'.X'' + theta'' (S x X') + theta' (S x X'') - theta'^2 (S.X')
           + I theta' theta''                                                              (E3)

Gravity g and a load applied to the link (force F at a point, couple C) add, with f = m g + F and c
the moment of all of these about X,

    Q = f.X' + c theta'                                                                    (E4)

A spring (k, free length l0) and damper d between two points the vector r apart, l = |r|, and a
torsion spring and damper between two links at the relative angle a, add

    Q = -k (1 - l0/l) r.r',   D = d (r.r'/l)^2;      Q = -k (a - a0) a',   D = d a'^2      (E5)

A force over a position, F(s) at a point P along the unit vector e, or a couple F(s), adds

    Q = F e.P',   Q = F theta'                                                              (E7)

On a base with the specific force f at O1, the rate w0 and the angular acceleration e0, -f stands
in the place of g, and a link adds, by its moment of momentum and its moment of inertia about O1,

    Q = -e0 (m X x X' + S x X' + theta' (X.S + I))
        + w0^2 (m X.X' + S.X' - theta' (X x S))                                             (E8)

X', X'', theta', theta'' are the motion at unit rate and zero acceleration: exact, without
differences. Sources: Eksergian, Dynamical analysis of machines, J. Franklin Institute 209-211
(1930-31); Paul, Kinematics and Dynamics of Planar Machinery (1979), chapter 12.
"""
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from math import remainder, tau
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter, SPRING_ENDS_MEET, UnknownForce
from fourbar_ros.mechanics.bodies import Applied, Base, Body, field_of, NOT_APPLIED, unchecked
from fourbar_ros.mechanisms.curves import FIXED, LinkMotion, point_of
from fourbar_ros.mechanisms.elements import LinkAngle, PositionForce, TableForce
from fourbar_ros.mechanisms.mechanism import DrivenLinks, Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array, Value
from fourbar_ros.numerics.number_types import ARRAY, Function, NumberType, Scalar
from fourbar_ros.numerics.tables import rounding_bound
from fourbar_ros.numerics.trace import flat, Trace
from fourbar_ros.numerics.write import straight_line
import numpy as np

MakeFormula = Callable[[DrivenLinks, NumberType], Function]      # of the coordinate
COMPLEX_STEP = 1e-200
REACH = 0.5            # of a coordinate in its unit, within which a table does not come round


class Terms(NamedTuple):
    """Terms of (E1) in a coordinate q, which need not be the input; numbers of any type."""

    inertia: Any             # J [kg m^2], of a slide [kg]
    half_slope: Any          # J'/2 [kg m^2/rad], [kg/m]
    force: Any               # Q [N m], [N]; without drive, dampers, friction, forces one way
    damping: Any             # D [N m s/rad], [N s/m]
    couples: Any             # the part of Q without a potential
    ratio: Any               # r = d input / dq: a torque on the input counts r times
    ratio_slope: Any         # dr/dq


class Resistance(NamedTuple):
    """R of (E9) and what it is made of, in [N m], of a driven slide [N]; NaN where joints lock."""

    effort: Scalar                # R
    friction: Scalar = 0.0        # what of R is friction
    felt: Sequence[Any] = ()     # forces in the joints with friction, in their order
    # relative rates of joints at unit rate, and what guides bear as a share of all: R is not
    # smooth where one of them is zero
    edges: Sequence[Scalar] = ()


# {link: (force x, force y, couple)} that act from outside and change from step to step [N], [N m]
Wrenches = Mapping[str, Sequence[Any]]
NO_WRENCHES: Wrenches = {}


def compiled(make_formula: MakeFormula, links: DrivenLinks, count: int = 1) -> Function:
    """Return the function of one q, or of an array of them, that a formula of the links is."""
    # The formula gives several numbers; q is the first of its ``count`` arguments. At one q the
    # function raises as motion does where the links cannot close; arrays have NaN there.
    line, formula = straight_line(partial(make_formula, links), count), make_formula(links, ARRAY)

    def results(position: Value, *others: Any) -> Sequence[Any]:
        if type(position) is not float and isinstance(position, np.ndarray) and position.ndim:
            with np.errstate(all='ignore'):
                return [np.broadcast_to(row, position.shape)
                        for row in formula(position, *others)]
        try:
            of_one: Sequence[Any] = line(float(position), *others)
            return of_one
        except UnknownForce:        # of a user's function
            raise
        except (ValueError, ZeroDivisionError):
            links.motion(float(position), 1.0, 0.0)     # its error names the input
            if not (isinstance(links, Mechanism) and links.elements):
                raise
            raise UnknownForce(links.input_coordinate.position, position,
                               SPRING_ENDS_MEET) from None
    return results


def make_link_terms(body: Body, gravity: tuple[Scalar, Scalar], applied: Applied
                    ) -> Callable[[LinkMotion], tuple[Scalar, Scalar, Scalar]]:
    """Return the function motion of a link -> what it adds to J, J'/2 and Q, (E2) to (E4)."""
    mass, along, across = body.mass, body.mass * body.cg_along, body.mass * body.cg_across
    inertia = body.inertia + along * body.cg_along + across * body.cg_across
    (g_x, g_y), couple = gravity, applied.couple
    f_x, f_y = mass * g_x + applied.force_x, mass * g_y + applied.force_y
    # moment of weight and force about the first joint: by_cosine cos + by_sine sin
    by_cosine = (along * g_y - across * g_x
                 + applied.along * applied.force_y - applied.across * applied.force_x)
    by_sine = -(along * g_x + across * g_y
                + applied.along * applied.force_x + applied.across * applied.force_y)

    def terms(link: LinkMotion) -> tuple[Scalar, Scalar, Scalar]:
        dx, dy, turn, cosine, sine = link.v_x, link.v_y, link.omega, link.cosine, link.sine
        x, y = along * cosine - across * sine, along * sine + across * cosine        # S
        cross = x * dy - y * dx
        swing = inertia * turn + cross
        inertia_of = mass * (dx * dx + dy * dy) + turn * (swing + cross)                     # (E2)
        half_slope = (mass * (dx * link.a_x + dy * link.a_y) + link.alpha * swing            # (E3)
                      + turn * (x * link.a_y - y * link.a_x - turn * (x * dx + y * dy)))
        moment = couple + by_cosine * cosine + by_sine * sine
        return inertia_of, half_slope, f_x * dx + f_y * dy + moment * turn                   # (E4)
    return terms


def make_turning_force(body: Body, base: Base) -> Callable[[LinkMotion], Scalar]:
    """Return the function motion of a link -> Q of the turning of a base, (E8)."""
    mass, along, across = body.mass, body.mass * body.cg_along, body.mass * body.cg_across
    inertia = body.inertia + along * body.cg_along + across * body.cg_across
    square, turned = base.rate * base.rate, base.acceleration

    def turning_force(link: LinkMotion) -> Scalar:
        x, y, dx, dy, turn = link.x, link.y, link.v_x, link.v_y, link.omega
        cosine, sine = link.cosine, link.sine
        s_x, s_y = along * cosine - across * sine, along * sine + across * cosine
        m_x, m_y = mass * x + s_x, mass * y + s_y
        momentum = m_x * dy - m_y * dx + turn * (x * s_x + y * s_y + inertia)
        return (square * (m_x * dx + m_y * dy - turn * (x * s_y - y * s_x))
                - turned * momentum)                                                     # (E8)
    return turning_force


class Equation:
    """
    The equation of motion (E1) of a mechanism with all that acts on it; a stroke is no limit here.

    Friction and forces one way, R of (E9), are in :attr:`resistance` alone.

    ``extra_inertia``: constant, on the input, as of a flywheel [kg m^2], [kg]. ``coordinate``: one
    of ``mechanism.driven_otherwise()``: q and all terms then refer to that coordinate, while the
    extra inertia stays on the input. Raises MissingBodies without masses, UnknownBaseMotion.
    """

    def __init__(self, mechanism: Mechanism, extra_inertia: float = 0.0,
                 coordinate: DrivenLinks | None = None) -> None:
        if not isinstance(mechanism, Mechanism):
            raise InvalidParameter('mechanism', mechanism, 'must be a mechanism, as a FourBar is')
        self.mechanism = mechanism
        self.coordinate: DrivenLinks = mechanism if coordinate is None else coordinate
        self.extra_inertia = finite('extra_inertia', extra_inertia, 'must be zero or more',
                                    least=0.0)
        mechanism.require_loads()
        # (link, body, applied load), without links that add nothing
        self._bodies = [(name, body, applied)
                        for name, (body, applied) in mechanism.loads_of_links().items()
                        if body.mass or body.inertia or applied != NOT_APPLIED]
        gravity = mechanism.gravity
        self._gravity = field_of(gravity)
        self._base = gravity if isinstance(gravity, Base) else Base()
        self._is_turned = bool(self._base.rate or self._base.acceleration)
        forces = [e for e in mechanism.elements if isinstance(e, PositionForce)]
        self.forces = [force for force in forces if not force.is_one_way]
        self._springs = [e for e in mechanism.elements if not isinstance(e, PositionForce)]
        self.tables = [force for force in forces if isinstance(force.value, TableForce)]
        # a run has short legs then: of a user's function too nobody knows how narrow it is
        self.has_position_forces = bool(forces)
        self.has_couples = bool(self.forces) or self._is_turned or any(
            applied.couple for _, _, applied in self._bodies)
        self.has_dampers = any(spring.damping for spring in self._springs)
        # friction and forces one way, which are no functions of q; R of (E9)
        self.has_resistance = mechanism.has_direction
        self.is_input = self.coordinate is mechanism        # whether q is
        # q -> the fields of Terms, as a plain tuple
        self.fields_of_terms = compiled(self.make_terms, self.coordinate)

    def make_pose(self, coordinate: DrivenLinks, n: NumberType
                  ) -> Callable[[Scalar], tuple[dict[str, LinkMotion], tuple[Scalar, ...]]]:
        """Return q -> motions of all links at dq/dt = 1; the input with its two derivatives."""
        coefficients, read = coordinate.make_coefficients(n), self.mechanism.read_coordinate
        names = [link.name for link in self.mechanism.LINKS]

        def pose(position: Scalar) -> tuple[dict[str, LinkMotion], tuple[Scalar, ...]]:
            moving = coefficients(position)
            return ({**dict(zip(names, moving)), GROUND: FIXED},
                    (position, 1.0, 0.0) if self.is_input else read(n, moving))
        return pose

    def make_terms(self, coordinate: DrivenLinks, n: NumberType, base: Base | None = None,
                   wrenches: Wrenches = NO_WRENCHES) -> Function:
        """Return the formula q -> :class:`Terms`, for a coordinate and a number type."""
        # base and wrenches, of numbers of that type: what acts from outside, in place of the
        # mechanism's gravity and of the forces on these links.
        pose, extra = self.make_pose(coordinate, n), self.extra_inertia
        gravity, bodies = field_of(base) if base else self._gravity, self._bodies
        is_turned, base, is_outside = self._is_turned or base, base or self._base, base or wrenches
        if is_outside:
            bodies = [(name, body, applied if name not in wrenches else unchecked(
                Applied, *wrenches[name][:2], applied.along, applied.across, wrenches[name][2]))
                for name, (body, applied) in self.mechanism.loads_of_links().items()]
        links = [(name, make_link_terms(body, gravity, applied), applied.couple)
                 for name, body, applied in bodies]
        turned = [(name, make_turning_force(body, base)) for name, body, _ in bodies if is_turned]

        def terms(position: Scalar) -> Terms:
            motions, (value, turn, bend) = pose(position)
            inertia, half_slope = extra * turn * turn, extra * turn * bend
            force, damping, couples = 0.0, 0.0, 0.0
            for name, terms_of_link, couple in links:
                j, k, f = terms_of_link(motions[name])
                inertia, half_slope, force = inertia + j, half_slope + k, force + f
                couples = couples + couple * motions[name].omega
            for spring in self._springs:
                pull, growth, square = spring.tension(n, motions)
                force = force - pull * growth
                if spring.damping:
                    damping = damping + spring.damping * growth * growth / square
            for name, turning_force in turned:
                pushed = turning_force(motions[name])
                force, couples = force + pushed, couples + pushed
            if self.forces:
                pushed = 0.0
                for element in self.forces:
                    pushed = pushed + element.generalised(n, motions, value)
                force, couples = force + pushed, couples + pushed
            return Terms(inertia, half_slope, force, damping, couples, turn, bend)
        return terms

    def make_resistance(self, n: NumberType, base: Base | None = None,
                        wrenches: Wrenches = NO_WRENCHES) -> Function:
        """Return the formula of :func:`.make_resistance`: R of (E9), zero without any."""
        if not self.has_resistance:
            return lambda *_: Resistance(0.0)
        from fourbar_ros.dynamics.resistance import make_resistance  # few mechanisms have any
        return make_resistance(self, n, base, wrenches)

    @cached_property
    def resistance(self) -> Function:
        """Return (q, w, push, J) -> Resistance of floats; ArithmeticError: links do not close."""
        line = straight_line(self.make_resistance, 4)

        def resistance(*numbers: float) -> Resistance:
            try:
                return Resistance(*line(*numbers))
            except ValueError:
                raise ArithmeticError('the links do not close') from None
        return resistance

    def make_table_positions(self, coordinate: DrivenLinks, n: NumberType) -> Function:
        """Return the formula q -> the positions s of all forces with a table."""
        pose = self.make_pose(coordinate, n)

        def table_positions(position: Scalar) -> tuple[Scalar, ...]:
            motions, (value, _, _) = pose(position)
            return tuple([force.position(n, motions, value) for force in self.tables])
        return table_positions

    @cached_property
    def table_positions(self) -> Function:
        """Return q -> the positions s of all forces with a table."""
        return compiled(self.make_table_positions, self.coordinate)

    def make_excess(self, position: float) -> Callable[[float], float]:
        """Return q -> how far a table is beyond its piece at ``position``; negative within all."""
        # That is a distance in s over 1 + |s|. It is positive too at REACH from position, so that
        # no point of a table comes round unseen.
        starts, reach = self.table_positions(position), REACH * self.coordinate.input_unit
        pieces = [(start, force.value.piece(start), 1.0 + abs(start),
                   isinstance(force.over, LinkAngle))
                  for start, force in zip(starts, self.tables)]

        def excess(there: float) -> float:
            most = abs(there - position) - reach
            for s, (start, (low, high), unit, is_angle) in zip(
                    self.table_positions(there), pieces):
                if is_angle:
                    s = start + remainder(s - start, tau)
                most = max(most, (low - s) / unit, (s - high) / unit)
            return most
        return excess

    def _make_potential(self, coordinate: DrivenLinks, n: NumberType) -> Function:
        """Return the formula q -> (V, the sum of the sizes of its parts) [J]."""
        pose, (g_x, g_y) = self.make_pose(coordinate, n), self._gravity

        # V is of weight, constant forces and springs, whose balance with kinetic energy is what
        # energy_drift() of a run checks. Couples and forces over a position may have none.
        def potential(position: Scalar) -> tuple[Scalar, ...]:
            motions, _ = pose(position)     # of links; of the input, which these do not need
            energy, size = 0.0, 0.0
            for name, body, applied in self._bodies:
                centre = point_of(motions[name], body.cg_along, body.cg_across)
                loaded = point_of(motions[name], applied.along, applied.across)
                work = (body.mass * (g_x * centre.x + g_y * centre.y)
                        + applied.force_x * loaded.x + applied.force_y * loaded.y)
                energy, size = energy - work, size + n.fabs(work)
            for element in self._springs:
                stored = element.energy(n, motions)
                energy, size = energy + stored, size + n.fabs(stored)
            return energy, size
        return potential

    @cached_property
    def potential_and_size(self) -> Function:
        """Return q -> V [J] and the sum of the sizes of its parts, whose rounding is its error."""
        return compiled(self._make_potential, self.coordinate)

    def terms(self, position: Value) -> Terms:
        """Return the terms of (E1) at one q or an array of them; errors as of ``motion``."""
        return Terms(*self.fields_of_terms(position))

    def acceleration(self, position: Value, rate: Value, drive: float = 0.0) -> Value:
        """Return dw/dt under the torque (force) of the drive on the input, by (E1), without R."""
        inertia, half_slope, force, damping, *_ = self.terms(position)
        change: Value = (force + drive - (damping + half_slope * rate) * rate) / inertia
        return change

    def torque(self, position: Value, rate: Value, acceleration: Value) -> Value:
        """Return the torque (force) of the drive that this motion needs, by (E1), without R."""
        inertia, half_slope, force, damping, *_ = self.terms(position)
        torque: Value = inertia * acceleration + (half_slope * rate + damping) * rate - force
        return torque

    def stiffness(self, position: Value) -> Any:
        """Return the stiffness -dQ/dq [N m/rad], [N/m], of one q or an array: NaN out of reach."""
        # by the complex step, exact; of users' forces dF/ds is a central difference
        inputs = np.atleast_1d(np.asarray(position, float))
        with np.errstate(all='ignore'):
            force = self.make_terms(self.coordinate, ARRAY)(inputs + 1j * COMPLEX_STEP).force
            slopes = np.broadcast_to(-np.imag(force) / COMPLEX_STEP, inputs.shape)
        return slopes.reshape(np.shape(position)) if np.ndim(position) else float(slopes[0])

    @cached_property
    def _trace(self) -> Trace:
        return Trace(lambda n, _: self.make_terms(self.coordinate, n), 1)

    def force_error(self, position: Value) -> Array:
        """Return a bound of the rounding error of Q and its data, at one q or each of an array."""
        # A force that is smaller may be zero: eps times all numbers that it is a sum and product
        # of, each times the derivative of Q by it.
        positions = np.asarray(position, float)
        bounds: Array = rounding_bound(self._trace, flat(self._trace.results[2])[0],
                                       positions.ravel())
        return bounds.reshape(positions.shape)

    def potential(self, position: Value) -> Value:
        """Return V [J] of gravity, constant forces and springs; -V' is Q without its couples."""
        potential: Value = self.potential_and_size(position)[0]
        return potential

    def energy(self, position: Value, rate: Value) -> Value:
        """Return kinetic plus potential energy [J]."""
        kinetic: Value = 0.5 * self.terms(position).inertia * rate * rate
        return kinetic + self.potential(position)


def require_input(equation: Any) -> None:
    """Raise InvalidParameter but for an Equation in the input, which its drive acts on."""
    if not (isinstance(equation, Equation) and equation.is_input):
        raise InvalidParameter('equation', equation, 'must be an Equation of the input, as '
                                                     'Equation(mechanism)')
