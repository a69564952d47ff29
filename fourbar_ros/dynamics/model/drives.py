# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Drives of the input: torque sources, a gear, a rotor, a controller, an elastic shaft.

A motor turns the input q (crank angle or slide) through a gear. The ratio N is the angle of the
motor over the angle of the output shaft. Torques and inertias refer to the output shaft: a rotor
of inertia J_r counts as N^2 J_r. A rigid coupling makes that shaft the input. With an elastic
shaft (stiffness k, damping c) it has its own angle p (dots are time derivatives):

    J_m p.. = T - T_shaft,    T_shaft = k (p - q) + c (p. - q.)                              (D1)

Torque sources, w the speed of the output shaft:

    constant     T = T0                                                                      (D2)
    motor line   T = N T_stall (1 - N w / w_free)                                            (D3)
    DC motor     L i. = U - R i - K N w,   T = N K i                                         (D4)
    controller   T = sat(kp e + ki z),  e = w_set - w,  z. = e, but 0 where that would only
                 push a saturated torque further into saturation (conditional integration)   (D5)
    table        T(t) held from one time to the next, or linear between them                 (D6)

Each but the table states its law once, by :meth:`Law.make_regime_at`, as pieces that are linear in
speed and own state z, or as the tangent of a smooth law:

    T = T_0 + T_w w + T_z z,    dz/dt = d_0 + d_w w + d_z z                                (M1)

A controller has such a law between its limits and beyond each limit, with or without integration.
Sometimes integration would push the torque beyond the limit, and stopping it would bring the
torque back. Then the torque slides along the limit (Filippov, Differential Equations with
Discontinuous Righthand Sides, 1988, section 4),

    T = limit,    kp (w_set - w) + ki z = limit,    so that  ki dz/dt = kp dw/dt           (M2)

``simulate`` and the steps of the node go from one regime to the next at the same kinks.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, nan
from typing import ClassVar, NamedTuple, Protocol

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.given import array, check_quantities, quantity
from fourbar_ros.numerics.number_types import Scalar
import numpy as np

State = Sequence[float]
Answer = tuple[float, tuple[float, ...]]      # torque [N m], derivative of the own state
# A torque within these parts of a limit is at it: always; at most, where the speed has an error.
NEAREST, NEAR = 1e-9, 1e-3
# Integration restarts at all times of a linear table of up to FEW times. In a longer table it
# restarts at every EVERY-th time, and at bends that change the next torque by more than SHARP of
# the whole range. A wave without such bends is at least pi / SHARP^0.5 = 10 000 times long, so no
# step passes over it.
FEW, SHARP, EVERY = 64, 1e-7, 4000


class Source(Protocol):
    """A torque source; it may have a state of its own, as a current."""

    @property
    def start(self) -> tuple[float, ...]:
        """Return the state at the beginning."""

    @property
    def breaks(self) -> tuple[float, ...]:
        """Return the times at which the torque jumps or bends [s]: integration restarts there."""

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque on the output shaft [N m] and the derivative of the state."""


class Piece(NamedTuple):
    """Coefficients of (M1), w the speed behind the gear; floats or any number type."""

    torque: Scalar
    by_speed: Scalar = 0.0
    by_state: Scalar = 0.0
    change: Scalar = 0.0
    change_by_speed: Scalar = 0.0
    change_by_state: Scalar = 0.0

    def torque_at(self, speed: float, state: float) -> float:
        """Return the torque T [N m] at a speed and an own state, (M1)."""
        torque: float = self.torque + self.by_speed * speed + self.by_state * state
        return torque

    def change_at(self, speed: float, state: float) -> float:
        """Return dz/dt of the own state at a speed and an own state, (M1)."""
        change: float = self.change + self.change_by_speed * speed + self.change_by_state * state
        return change


Margins = Callable[[float, float, float], tuple[float, ...]]
Tangent = Callable[[Scalar], Piece]


class Regime(NamedTuple):
    """
    A law and where it ends.

    ``tangent``, of any number type, takes the place of ``piece`` for a smooth law: w -> Piece with
    the torque at w and its derivative.
    """

    name: str
    piece: Piece                       # the law where it is linear
    margins: Margins | None = None     # (w, z, dw/dt) -> numbers; it ends where one is negative
    edge: tuple[float, float] | None = None      # (z_0, z_w), z = z_0 + z_w w if it slides, (M2)
    tangent: Tangent | None = None

    def piece_at(self, speed: float) -> Piece:
        """Return the law next to a speed."""
        return self.piece if self.tangent is None else self.tangent(speed)

    def own(self, speed: float, state: float) -> float:
        """Return the state of the source at a speed: on the limit while it slides there."""
        return state if self.edge is None else self.edge[0] + self.edge[1] * speed


class RegimeAt(Protocol):
    """Which regime holds at a speed w, an own state z and dw/dt, NaN where that is unknown."""

    def __call__(self, speed: float, state: float, slope: float = nan,
                 near: float = 0.0) -> Regime:
        """Return the regime; ``near``: error of the speed, within which a limit is reached."""


def always(piece: Piece, tangent: Tangent | None = None) -> RegimeAt:
    """Return the function of speed and state -> regime, of a source with one law everywhere."""
    regime = Regime('', piece, tangent=tangent)

    def regime_at(speed: float, state: float, slope: float = nan, near: float = 0.0) -> Regime:
        return regime
    return regime_at


class Law(ABC):
    """
    A torque source with a law of speed and state, in steps of the node too.

    Attributes
    ----------
    own : str
        The field of a DriveState message that holds the state, one number at most.

    """

    breaks: ClassVar[tuple[float, ...]] = ()
    own: ClassVar[str] = ''

    @property
    def start(self) -> tuple[float, ...]:
        """Return the state at the beginning; nothing: it has none."""
        return ()

    def __post_init__(self) -> None:
        check_quantities(self)

    @abstractmethod
    def make_regime_at(self) -> RegimeAt:
        """Return the function of speed and state that gives the law there, as a Regime."""

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque on the output shaft [N m] and the derivative of the state."""
        own = state[0] if state else 0.0
        return answer_of(self.make_regime_at()(speed, own), speed, state)


def answer_of(regime: Regime, speed: float, state: State) -> Answer:
    """Return the torque [N m] and the derivative of the own state by the law of a regime, (M1)."""
    own, piece = state[0] if state else 0.0, regime.piece_at(speed)
    return piece.torque_at(speed, own), (piece.change_at(speed, own),) if state else ()


class CommandedLaw(Law):
    """
    A law with one field that generated code takes anew at each step, as a voltage.

    ``command``: the name of this field.
    """

    command: ClassVar[str]

    @abstractmethod
    def piece(self, command: Scalar) -> Piece:
        """Return the law without limits for a value of that field, of any number type."""


@dataclass(frozen=True)
class ConstantTorque(Law):
    """A constant torque [N m] (of a slide a force [N]), (D2)."""

    value: float = quantity(0.0)

    def make_regime_at(self) -> RegimeAt:
        """Return the law of all speeds (D2)."""
        return always(Piece(self.value))


@dataclass(frozen=True)
class MotorLine(Law):
    """
    A motor whose torque falls linearly with its speed, (D3): [N m], [rad/s], N.

    Torque and speed have one sign: the torque of a motor does not grow with its speed.
    """

    stall_torque: float = quantity(unit='N m or N', text='torque of the motor at rest')
    free_speed: float = quantity(unit='rad/s or m/s', text='speed of the motor without load',
                                 is_not_zero=True)
    gear: float = quantity(1.0, is_not_zero=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.stall_torque / self.free_speed < 0.0:
            raise InvalidParameter('free_speed', self.free_speed, 'must have the sign of '
                                   f'stall_torque ({self.stall_torque:g}): a torque that grows '
                                   'with the speed is no motor line')

    def make_regime_at(self) -> RegimeAt:
        """Return the law (D3) at the output shaft."""
        stall, free = self.gear * self.stall_torque, self.free_speed / self.gear
        return always(Piece(stall, -stall / free))


@dataclass(frozen=True)
class DCMotor(CommandedLaw):
    """Permanent-magnet DC motor with a gear of ratio N, (D4); fields state units and meanings."""

    own: ClassVar[str] = 'current'
    command: ClassVar[str] = 'voltage'
    voltage: float = quantity(unit='V', text='voltage of the armature')
    resistance: float = quantity(unit='ohm', text='resistance of the armature', above=0.0)
    constant: float = quantity(unit='N m/A', parameter='torque_constant', above=0.0,
                               text='torque per current, and voltage per speed [V s/rad]')
    inductance: float = quantity(0.0, unit='H', least=0.0, text='inductance of the armature; '
                                                                '0: the current follows at once')
    gear: float = quantity(1.0, is_not_zero=True)

    @property
    def start(self) -> tuple[float, ...]:
        """Return the current at the beginning, where there is an inductance."""
        return (0.0,) if self.inductance else ()

    def piece(self, command: Scalar) -> Piece:
        """Return the law (D4) at a voltage; the current, its state, follows at once if L = 0."""
        constant = self.gear * self.constant
        if self.inductance:
            return Piece(0.0, by_state=constant, change=command / self.inductance,
                         change_by_speed=-constant / self.inductance,
                         change_by_state=-self.resistance / self.inductance)
        return Piece(constant * command / self.resistance,
                     by_speed=-constant * constant / self.resistance)

    def make_regime_at(self) -> RegimeAt:
        """Return the law (D4) of all speeds."""
        return always(self.piece(self.voltage))


@dataclass(frozen=True)
class SpeedController(CommandedLaw):
    """
    PI controller of the speed with a limited torque and conditional integration, (D5).

    Fields state units and meanings.
    """

    own: ClassVar[str] = 'speed_error_integral'
    command: ClassVar[str] = 'speed'
    speed: float = quantity(unit='rad/s or m/s', text='speed wanted of the shaft behind the gear')
    proportional: float = quantity(unit='N m s/rad', least=0.0,
                                   text='torque behind the gear per error of the speed')
    integral: float = quantity(0.0, unit='N m/rad', least=0.0,
                               text='torque behind the gear per integral of that error')
    limit: float = quantity(inf, unit='N m or N', above=0.0, instead=inf, parameter='torque_limit',
                            text='largest torque behind the gear; default: no limit')

    @property
    def start(self) -> tuple[float, ...]:
        """Return the integral of the error at the beginning, where there is an integral part."""
        return (0.0,) if self.integral else ()

    def piece(self, command: Scalar) -> Piece:
        """Return the law (D5) for a wanted speed; the state is the integral of the error, z."""
        kp, ki = self.proportional, self.integral
        return Piece(kp * command, -kp, ki, *((command, -1.0) if ki else ()))

    def make_regime_at(self) -> RegimeAt:
        """Return the law (D5) with its limits."""
        wanted, kp, ki, limit = self.speed, self.proportional, self.integral, self.limit
        unlimited = self.piece(wanted)
        if limit == inf:
            return always(unlimited)

        def within(speed: float, state: float, slope: float) -> tuple[float, ...]:
            """Return the margins to both limits, as parts of the limit; the slope has no say."""
            torque = unlimited.torque_at(speed, state) / limit
            return 1.0 - torque, 1.0 + torque

        inner = Regime('between its limits', unlimited, within)
        beyond = {side: self._at_limit(unlimited, side) for side in (1.0, -1.0)}

        def regime_at(speed: float, state: float, slope: float = nan, near: float = 0.0) -> Regime:
            """
            Return the regime: inner, or one of three at the limit next to the torque.

            Held: the error pushes further beyond, integration stops. Returning: the integral
            leads back. Sliding: the torque stays on the limit. ``state``: integral of the error;
            ``slope``: acceleration, NaN if unknown; ``near``: error of the speed, within which
            the limit counts as reached.
            """
            torque = unlimited.torque_at(speed, state)
            side = 1.0 if torque > 0.0 else -1.0
            held, returning, sliding = beyond[side]
            # from here on as at the upper limit
            over, error, slope = side * torque - limit, side * (wanted - speed), side * slope
            has_slope = slope == slope
            if has_slope and abs(error) <= NEAREST * (abs(wanted) + abs(speed)):
                error = -slope                # there is none: the next moment's counts
            at_limit = (min(kp * near, NEAR * limit) + NEAREST * limit
                        + 8.0 * EPS * kp * (abs(wanted) + abs(speed)))
            if abs(over) <= at_limit and has_slope:
                grows, falls = ki * error, kp * slope      # of the torque: by integral, by speed
                if grows - falls <= NEAREST * (abs(grows) + abs(falls)):
                    return inner              # it comes back between the limits
                if min(grows, 0.0) <= falls and ki:
                    return sliding            # integrating leads beyond, holding leads back
            elif over <= 0.0:
                return inner
            return held if error > 0.0 else returning
        return regime_at

    def _at_limit(self, unlimited: Piece, side: float) -> tuple[Regime, Regime, Regime]:
        """
        Return the regimes at the upper (side 1) or lower (-1) limit of the torque.

        Held: the error would push further beyond, integration stops. Returning: the integral
        decreases. Sliding: along the limit by (M2).
        """
        wanted, kp, ki, limit = self.speed, self.proportional, self.integral, self.limit
        unit, name = max(kp, ki) / limit, f'at its {"upper" if side > 0.0 else "lower"} limit'
        piece = Piece(side * limit)

        def over(speed: float, state: float) -> float:
            """Return how far the torque without limit is beyond it, as a part of the limit."""
            return side * unlimited.torque_at(speed, state) / limit - 1.0

        # margins of a regime: it holds while all are positive
        def while_held(speed: float, state: float, slope: float) -> tuple[float, ...]:
            return over(speed, state), side * unit * (wanted - speed)

        def while_returning(speed: float, state: float, slope: float) -> tuple[float, ...]:
            return over(speed, state), side * unit * (speed - wanted)

        def while_sliding(speed: float, state: float, slope: float) -> tuple[float, ...]:
            """Return margins: integrating would go beyond the limit, holding would come back."""
            falls = side * kp * slope
            inward = (side * ki * (wanted - speed) - falls) / limit
            return (inward, falls / limit) if kp else (inward,)

        edge = ((side * limit - kp * wanted) / ki, kp / ki) if ki else None
        return (Regime(f'{name}, held', piece, while_held),
                Regime(f'{name}, integrating', unlimited._replace(
                    torque=piece.torque, by_speed=0.0, by_state=0.0), while_returning),
                Regime(f'{name}, sliding', piece, while_sliding, edge))


@dataclass(frozen=True)
class TorqueTable:
    """
    Torque over time, (D6), as recorded from a topic.

    Parameters
    ----------
    times : sequence of float
        Increasing [s]; before the first and after the last the torque is that at the end.
    torques : sequence of float
        [N m]
    linear : bool
        Linear between times; else each torque is held until the next time.

    """

    times: Sequence[float]
    torques: Sequence[float]
    linear: bool = False
    start: ClassVar[tuple[float, ...]] = ()

    def __post_init__(self) -> None:
        """Check times and torques, and keep them as tuples of floats."""
        times, torques = array('times', self.times), array('torques', self.torques)
        if times.ndim != 1 or not times.size or times.shape != torques.shape:
            raise InvalidParameter('torques', torques, 'must be as many as times, at least one')
        if not np.all(np.isfinite(torques)):
            raise InvalidParameter('torques', torques, 'must be finite numbers')
        if not (np.all(np.isfinite(times)) and np.all(np.diff(times) > 0.0)):
            raise InvalidParameter('times', times, 'must increase')
        object.__setattr__(self, 'times', tuple(times.tolist()))
        object.__setattr__(self, 'torques', tuple(torques.tolist()))

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Return the times at which integration restarts [s]; of a long table at bends."""
        times, torques = np.array(self.times), np.array(self.torques)
        if not self.linear or times.size <= FEW:
            return tuple(self.times)
        slopes = np.diff(torques) / np.diff(times)
        sharp = np.abs(np.diff(slopes)) * np.diff(times)[1:] > SHARP * np.ptp(torques)
        kept = np.arange(times.size) % EVERY == 0
        kept[1:-1] |= sharp
        return tuple(times[kept].tolist())

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque of the table at a time [N m], and (): it has no own state."""
        after = bisect_right(self.times, time)
        before = max(after - 1, 0)
        if not self.linear or after in (0, len(self.times)):
            return self.torques[before], ()
        share = (time - self.times[before]) / (self.times[after] - self.times[before])
        return self.torques[before] + share * (self.torques[after] - self.torques[before]), ()


@dataclass(frozen=True)
class Shaft:
    """Elastic damped shaft between motor and input, (D1): [N m/rad], [N m s/rad]."""

    stiffness: float = quantity(above=0.0)
    damping: float = quantity(0.0, least=0.0)

    def __post_init__(self) -> None:
        check_quantities(self)


@dataclass(frozen=True)
class Drive:
    """
    A torque source with the inertia it brings, coupled rigidly or through an elastic shaft.

    Parameters
    ----------
    source : Source
    rotor : float
        Inertia of the motor side at the output shaft [kg m^2]; an elastic shaft needs one.
    flywheel : float
        Inertia on the input itself [kg m^2].
    shaft : Shaft, optional

    """

    source: Source
    rotor: float = quantity(0.0, least=0.0)
    flywheel: float = quantity(0.0, least=0.0)
    shaft: Shaft | None = None

    def __post_init__(self) -> None:
        """Check that the source is one, and that an elastic shaft has a rotor before it."""
        for name in ('start', 'breaks', 'torque'):
            if not hasattr(self.source, name):
                raise InvalidParameter('source', self.source, 'must be a torque source, as '
                                       f'ConstantTorque(5.0): it has no {name}')
        if not isinstance(self.shaft, (Shaft, type(None))):
            raise InvalidParameter('shaft', self.shaft, 'must be a Shaft')
        check_quantities(self)
        if self.shaft is not None and self.rotor == 0.0:
            raise InvalidParameter('rotor', self.rotor,
                                   'an elastic shaft needs an inertia on the motor side')

    @property
    def rigid_inertia(self) -> float:
        """Return the constant inertia on the input [kg m^2]."""
        return self.flywheel if self.shaft else self.flywheel + self.rotor
