# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Drives of the input: torque sources, a gear, a rotor, a controller, an elastic shaft.

A motor turns the input q (crank angle or slide) through a gear. The ratio N is the angle of the
motor over the angle of the output shaft. Torques and inertias refer to the output shaft: a rotor
of inertia J_r counts as N^2 J_r. A rigid coupling makes that shaft the input. With an elastic
shaft (stiffness k, damping c) it has its own angle p (dots are time derivatives):

    J_m p.. = T - T_shaft,    T_shaft = k (p - q) + c (p. - q.)                              (A1)

Torque sources, w the speed of the output shaft:

    constant     T = T0                                                                      (A2)
    motor line   T = N T_stall (1 - N w / w_free)                                            (A3)
    DC motor     L i. = U - R i - K N w,   T = N K i                                         (A4)
    controller   T = sat(kp e + ki z),  e = w_set - w,  z. = e + (T - kp e - ki z) / kp:
                 back-calculation takes z back while the torque is at its limit              (A5)
    table        T(t) held from one time to the next, or linear between them                 (A6)
    induction    T = N 2 T_b / (s / s_b + s_b / s),   s = 1 - N w / w_s the slip             (A7)
                 dT/dw = -(N / w_s) N 2 T_b s_b (s_b^2 - s^2) / (s^2 + s_b^2)^2              (A8)

(A7) is Kloss' formula (Drehmoment und Schluepfung des Drehstrommotors, Archiv fuer Elektrotechnik
5, 1916) for a motor at a constant frequency f of its supply: with p pairs of poles the synchronous
speed w_s is 2 pi f / p, T_b is the breakdown torque, at the slip s_b. It neglects the resistance
of the stator and electrical transients. Beyond w_s the motor brakes as a generator.

Each but the table states its law once, by :meth:`Law.piece`, next to a speed and a state z as
linear in both:

    T = T_0 + T_w w + T_z z,    dz/dt = d_0 + d_w w + d_z z                                (A9)
"""
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, tau
from typing import Any, ClassVar, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arguments import array, check_quantities, quantity
from fourbar_ros.numerics.number_types import NumberType, REAL, Scalar
import numpy as np

State = Sequence[float]
Answer = tuple[float, tuple[float, ...]]      # torque [N m], derivative of the state
# Integration restarts at all times of a linear table of up to FEW times. In a longer table it
# restarts at every EVERY-th time, and at bends that change the next torque by more than SHARP of
# the whole range. A wave without such bends is at least pi / SHARP^0.5 = 10 000 times long, so no
# step passes over it.
FEW, SHARP, EVERY = 64, 1e-7, 4000


class Piece(NamedTuple):
    """Coefficients of (A9), w the speed behind the gear; floats or any number type."""

    torque: Scalar
    by_speed: Scalar = 0.0
    by_state: Scalar = 0.0
    change: Scalar = 0.0
    change_by_speed: Scalar = 0.0
    change_by_state: Scalar = 0.0

    def torque_at(self, speed: float, state: float) -> float:
        """Return the torque T [N m] at a speed and a state, (A9)."""
        return self.torque + self.by_speed * speed + self.by_state * state

    def change_at(self, speed: float, state: float) -> float:
        """Return dz/dt of the state at a speed and a state, (A9)."""
        return self.change + self.change_by_speed * speed + self.change_by_state * state


class Law(ABC):
    """A torque source with a law of speed and state, in steps of the node too."""

    breaks: ClassVar[tuple[float, ...]] = ()
    state_field: ClassVar[str] = ''     # of a DriveState message, which holds the state
    command: ClassVar[str] = ''         # field that each step may take anew, as a voltage

    @property
    def start(self) -> tuple[float, ...]:
        """Return the state at the beginning, one number at most."""
        return ()

    def __post_init__(self) -> None:
        check_quantities(self)

    @abstractmethod
    def piece(self, speed: Scalar, state: Scalar, n: NumberType = REAL,
              command: Scalar | None = None) -> Piece:
        """Return the law next to a speed and a state; ``command``: value of that field instead."""

    def limited(self, command: Scalar | None = None) -> tuple[Piece, float] | None:
        """Return the linear law, and the size of its torque at which it is cut off, if it is."""
        return None

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque on the output shaft [N m] and the derivative of the state."""
        value = state[0] if state else 0.0
        piece = self.piece(speed, value)
        return piece.torque_at(speed, value), (piece.change_at(speed, value),) if state else ()


def has_law(source: Any) -> bool:
    """Return whether the torque of a source is that of its piece, by no method of its class."""
    return getattr(type(source), 'torque', None) is Law.torque


@dataclass(frozen=True)
class ConstantTorque(Law):
    """A constant torque [N m] (of a slide a force [N]), (A2)."""

    command: ClassVar[str] = 'value'
    value: float = quantity(0.0)

    def piece(self, speed: Scalar, state: Scalar, n: NumberType = REAL,
              command: Scalar | None = None) -> Piece:
        return Piece(self.value if command is None else command)                            # (A2)


@dataclass(frozen=True)
class MotorLine(Law):
    """
    A motor whose torque falls linearly with its speed, (A3): [N m], [rad/s], N.

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

    def piece(self, speed: Scalar, state: Scalar, n: NumberType = REAL,
              command: Scalar | None = None) -> Piece:
        stall, free = self.gear * self.stall_torque, self.free_speed / self.gear
        return Piece(stall, -stall / free)                                                  # (A3)


@dataclass(frozen=True)
class DCMotor(Law):
    """Permanent-magnet DC motor with a gear of ratio N, (A4); fields state units and meanings."""

    state_field: ClassVar[str] = 'current'
    command: ClassVar[str] = 'voltage'
    voltage: float = quantity(unit='V', text='voltage of the armature')
    resistance: float = quantity(unit='ohm', text='resistance of the armature', above=0.0)
    constant: float = quantity(unit='N m/A or N/A', parameter='torque_constant', above=0.0,
                               text='torque per current, and voltage per speed [V s/rad]')
    inductance: float = quantity(0.0, unit='H', least=0.0, text='inductance of the armature; '
                                                                '0: the current follows at once')
    gear: float = quantity(1.0, is_not_zero=True)

    @property
    def start(self) -> tuple[float, ...]:
        return (0.0,) if self.inductance else ()

    def piece(self, speed: Scalar, state: Scalar, n: NumberType = REAL,
              command: Scalar | None = None) -> Piece:
        constant, voltage = self.gear * self.constant, self.voltage if command is None else command
        if self.inductance:                                                                 # (A4)
            return Piece(0.0, by_state=constant, change=voltage / self.inductance,
                         change_by_speed=-constant / self.inductance,
                         change_by_state=-self.resistance / self.inductance)
        return Piece(constant * voltage / self.resistance,
                     by_speed=-constant * constant / self.resistance)


@dataclass(frozen=True)
class SpeedController(Law):
    """
    PI controller of the speed with a limited torque and back-calculation, (A5).

    Fields state units and meanings.
    """

    state_field: ClassVar[str] = 'speed_error_integral'
    command: ClassVar[str] = 'speed'
    speed: float = quantity(unit='rad/s or m/s', text='speed wanted of the shaft behind the gear')
    proportional: float = quantity(unit='N m s/rad or N s/m', least=0.0,
                                   text='torque behind the gear per error of the speed')
    integral: float = quantity(0.0, unit='N m/rad or N/m', least=0.0,
                               text='torque behind the gear per integral of that error')
    limit: float = quantity(inf, unit='N m or N', above=0.0, instead=inf, parameter='torque_limit',
                            text='largest torque behind the gear; default: no limit')

    @property
    def start(self) -> tuple[float, ...]:
        return (0.0,) if self.integral else ()

    def piece(self, speed: Scalar, state: Scalar, n: NumberType = REAL,
              command: Scalar | None = None) -> Piece:
        inner, limit = self._inner(command), self.limit
        if limit == inf:
            return inner
        kp, ki = self.proportional, self.integral
        wanted = self.speed if command is None else command
        # without a proportional part, ki times one second takes its place in (A5)
        tracking = kp or ki

        def held_at(torque: float) -> tuple[Scalar, ...]:
            return tuple(Piece(torque) if not ki else Piece(
                torque, change=wanted + (torque - kp * wanted) / tracking,
                change_by_speed=kp / tracking - 1.0, change_by_state=-ki / tracking))
        torque = inner.torque_at(speed, state)      # complex in derivatives by a complex step
        return Piece(*n.where(torque.real > limit, held_at(limit), n.where(
            torque.real < -limit, held_at(-limit), tuple(inner))))

    def _inner(self, command: Scalar | None) -> Piece:
        """Return the law between the limits of the torque, (A5)."""
        wanted = self.speed if command is None else command
        kp, ki = self.proportional, self.integral
        torque = Piece(kp * wanted, by_speed=-kp, by_state=ki)
        return torque._replace(change=wanted, change_by_speed=-1.0) if ki else torque

    def limited(self, command: Scalar | None = None) -> tuple[Piece, float] | None:
        return None if self.limit == inf else (self._inner(command), self.limit)


@dataclass(frozen=True)
class InductionMotor(Law):
    """Induction motor by Kloss' formula (A7); behind a negative gear its shaft turns back."""

    breakdown_torque: float = quantity(unit='N m or N', above=0.0,
                                       text='largest torque of the motor')
    breakdown_slip: float = quantity(above=0.0, text='slip at which it gives that torque')
    frequency: float = quantity(50.0, unit='Hz', above=0.0, text='frequency of the supply')
    pole_pairs: int = quantity(2, least=1, is_whole=True, text='pairs of poles')
    gear: float = quantity(1.0, is_not_zero=True)

    @property
    def synchronous_speed(self) -> float:
        """Return the speed behind the gear at which it gives no torque [rad/s]."""
        return tau * self.frequency / self.pole_pairs / self.gear

    def piece(self, speed: Scalar, state: Scalar, n: NumberType = REAL,
              command: Scalar | None = None) -> Piece:
        synchronous, s_b = self.synchronous_speed, self.breakdown_slip
        factor = 2.0 * self.gear * self.breakdown_torque * s_b
        slip = 1.0 - speed / synchronous
        whole = slip * slip + s_b * s_b
        torque = factor * slip / whole                                                      # (A7)
        by_speed = factor * (slip * slip - s_b * s_b) / (synchronous * whole * whole)       # (A8)
        return Piece(torque - by_speed * speed, by_speed)      # the tangent at this speed


@dataclass(frozen=True)
class TorqueTable:
    """
    Torque over time, (A6), as recorded from a topic: increasing times [s], torques [N m].

    ``linear``: between two times; else each torque is held until the next time. Before the first
    and after the last time the torque is that at the end.
    """

    times: Sequence[float]
    torques: Sequence[float]
    linear: bool = False
    start: ClassVar[tuple[float, ...]] = ()

    def __post_init__(self) -> None:
        times, torques = array('times', self.times), array('torques', self.torques)
        if times.ndim != 1 or not times.size or times.shape != torques.shape:
            raise InvalidParameter('torques', torques, 'must be as many as times, at least one')
        if not np.all(np.isfinite(torques)):
            raise InvalidParameter('torques', torques, 'must be finite numbers')
        if not (np.all(np.isfinite(times)) and np.all(np.diff(times) > 0.0)):
            raise InvalidParameter('times', times, 'must increase')
        object.__setattr__(self, 'times', tuple(times.tolist()))
        object.__setattr__(self, 'torques', tuple(torques.tolist()))

    def __repr__(self) -> str:
        return short_repr('TorqueTable', {
            'times': self.times, 'torques': self.torques, 'linear': self.linear})

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
        after = bisect_right(self.times, time)
        before = max(after - 1, 0)
        if not self.linear or after in (0, len(self.times)):
            return self.torques[before], ()
        share = (time - self.times[before]) / (self.times[after] - self.times[before])
        return self.torques[before] + share * (self.torques[after] - self.torques[before]), ()


@dataclass(frozen=True)
class Shaft:
    """Elastic damped shaft between motor and input, (A1): [N m/rad], [N m s/rad]."""

    stiffness: float = quantity(above=0.0)
    damping: float = quantity(0.0, least=0.0)

    def __post_init__(self) -> None:
        check_quantities(self)


@dataclass(frozen=True)
class Drive:
    """
    A torque source with the inertia it brings, coupled rigidly or through an elastic shaft.

    The source is a Law, a TorqueTable or any object with ``start``, its state at the beginning, a
    tuple; ``breaks``, times at which the torque jumps or bends [s]; ``torque(time, speed, state)``
    -> (torque on the output shaft [N m], derivatives of the state). ``rotor`` is the inertia of
    the motor side at the output shaft, ``flywheel`` that on the input itself [kg m^2].
    """

    source: Any
    rotor: float = quantity(0.0, least=0.0)
    flywheel: float = quantity(0.0, least=0.0)
    shaft: Shaft | None = None

    def __post_init__(self) -> None:
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
