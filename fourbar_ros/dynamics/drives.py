# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What turns the input: torque sources, a gear, a rotor, a controller, an elastic shaft.

A motor turns the input q (crank angle or slide) through a gear of ratio N, the angle of the motor
over that of the gear's output shaft. Torques and inertias are those at the output shaft: a rotor
of inertia J_r counts as N^2 J_r. Rigidly coupled, that shaft is the input; through an elastic
shaft (stiffness k, damping c) it has its own angle p (dots are derivatives with respect to time):

    J_m p.. = T - T_shaft,    T_shaft = k (p - q) + c (p. - q.)                              (D1)

Torque sources, w the speed of the output shaft:

    constant     T = T0                                                                      (D2)
    motor line   T = T_stall (1 - w / w_free)                                                (D3)
    DC motor     L i. = U - R i - K N w,   T = N K i                                         (D4)
    controller   T = sat(kp e + ki z),  e = w_set - w,  z. = e, but 0 where that would only
                 push a saturated torque further into saturation (conditional integration)   (D5)
    table        T(t) held from one time to the next, or linear between them                 (D6)
"""
from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, ClassVar, Protocol

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.given import number

State = Sequence[float]
Answer = tuple[float, tuple[float, ...]]


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


class _WithoutState:
    """A source without a state of its own."""

    start: ClassVar[tuple[float, ...]] = ()

    @property
    def breaks(self) -> tuple[float, ...]:
        """Return nothing: the torque neither jumps nor bends."""
        return ()


def _check(source: Any, positive: tuple[str, ...] = (), finite: tuple[str, ...] = (),
           not_negative: tuple[str, ...] = (), not_zero: tuple[str, ...] = ()) -> None:
    """Convert fields to floats, or refuse them."""
    given = {name: number(name, getattr(source, name)) for name in (*finite, *not_zero)}
    for name in positive:
        given[name] = number(name, getattr(source, name), 'must be a positive number', above=0.0)
    for name in not_negative:
        given[name] = number(name, getattr(source, name), 'must be a finite number, zero or more',
                             least=0.0)
    for name in not_zero:
        if given[name] == 0.0:
            raise InvalidParameter(name, 0.0, 'must not be zero')
    for name, value in given.items():
        object.__setattr__(source, name, value)


@dataclass(frozen=True)
class ConstantTorque(_WithoutState):
    """A constant torque [N m] (of a slide a force [N]), (D2)."""

    value: float = 0.0

    def __post_init__(self) -> None:
        _check(self, finite=('value',))

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque and nothing."""
        return self.value, ()


@dataclass(frozen=True)
class MotorLine(_WithoutState):
    """A motor whose torque falls linearly with its speed, (D3): [N m], [rad/s]."""

    stall_torque: float
    free_speed: float

    def __post_init__(self) -> None:
        _check(self, finite=('stall_torque',), not_zero=('free_speed',))

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque at this speed and nothing."""
        return self.stall_torque * (1.0 - speed / self.free_speed), ()


@dataclass(frozen=True)
class DCMotor:
    """
    Permanent-magnet DC motor with a gear, (D4).

    Parameters
    ----------
    voltage : float
        [V]
    resistance, inductance : float
        [ohm], [H]; their ratio is the electrical time constant. An inductance of zero: none.
    constant : float
        Torque constant [N m/A], and speed constant [V s/rad].
    gear : float
        N.

    """

    voltage: float
    resistance: float
    constant: float
    inductance: float = 0.0
    gear: float = 1.0

    breaks: ClassVar[tuple[float, ...]] = ()

    def __post_init__(self) -> None:
        _check(self, positive=('resistance', 'constant'), finite=('voltage',),
               not_negative=('inductance',), not_zero=('gear',))

    @property
    def start(self) -> tuple[float, ...]:
        """Return the current at the beginning, where there is an inductance."""
        return (0.0,) if self.inductance else ()

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque and the derivative of the current."""
        back = self.voltage - self.constant * self.gear * speed
        if not self.inductance:
            return self.gear * self.constant * back / self.resistance, ()
        current, = state
        return (self.gear * self.constant * current,
                ((back - self.resistance * current) / self.inductance,))


@dataclass(frozen=True)
class SpeedController:
    """
    PI controller of the speed with a limited torque and conditional integration, (D5).

    Parameters
    ----------
    speed : float
        Set point [rad/s].
    proportional, integral : float
        [N m s/rad], [N m/rad].
    limit : float
        Largest torque [N m].

    """

    speed: float
    proportional: float
    integral: float = 0.0
    limit: float = inf

    breaks: ClassVar[tuple[float, ...]] = ()

    def __post_init__(self) -> None:
        _check(self, finite=('speed',), not_negative=('proportional', 'integral'))
        if not self.limit > 0.0:
            raise InvalidParameter('limit', self.limit, 'must be positive')

    @property
    def start(self) -> tuple[float, ...]:
        """Return the integral of the error at the beginning, where there is an integral part."""
        return (0.0,) if self.integral else ()

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque and the derivative of the integral."""
        error = self.speed - speed
        wanted = self.proportional * error + (self.integral * state[0] if state else 0.0)
        torque = min(max(wanted, -self.limit), self.limit)
        if not state:
            return torque, ()
        winds_up = wanted != torque and (wanted > 0.0) is (error > 0.0)
        return torque, (0.0 if winds_up else error,)


@dataclass(frozen=True)
class TorqueTable(_WithoutState):
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

    def __post_init__(self) -> None:
        times = tuple(number('times', time) for time in self.times)
        torques = tuple(number('torques', torque) for torque in self.torques)
        if not times or len(times) != len(torques):
            raise InvalidParameter('torques', torques, 'must be as many as times, at least one')
        if any(later <= earlier for earlier, later in zip(times, times[1:])):
            raise InvalidParameter('times', times, 'must increase')
        object.__setattr__(self, 'times', times)
        object.__setattr__(self, 'torques', torques)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Return the times [s]."""
        return tuple(self.times)

    def torque(self, time: float, speed: float, state: State) -> Answer:
        """Return the torque at this time and nothing."""
        after = bisect_right(self.times, time)
        before = max(after - 1, 0)
        if not self.linear or after in (0, len(self.times)):
            return self.torques[before], ()
        share = (time - self.times[before]) / (self.times[after] - self.times[before])
        return self.torques[before] + share * (self.torques[after] - self.torques[before]), ()


@dataclass(frozen=True)
class Shaft:
    """Elastic damped shaft between motor and input, (D1): [N m/rad], [N m s/rad]."""

    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        _check(self, positive=('stiffness',), not_negative=('damping',))


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
    rotor: float = 0.0
    flywheel: float = 0.0
    shaft: Shaft | None = None

    def __post_init__(self) -> None:
        _check(self, not_negative=('rotor', 'flywheel'))
        if self.shaft is not None and self.rotor == 0.0:
            raise InvalidParameter('rotor', self.rotor,
                                   'an elastic shaft needs an inertia on the motor side')

    @property
    def rigid_inertia(self) -> float:
        """Return the constant inertia on the input [kg m^2]."""
        return self.flywheel if self.shaft else self.flywheel + self.rotor
