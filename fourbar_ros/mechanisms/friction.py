# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Friction of joints and of the drive: what a mechanism is given; :mod:`.machine.solve.friction`.

Imported for mechanisms that have friction alone.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, KW_ONLY, replace
from math import inf
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter, Locked, one_of, Toggle
from fourbar_ros.mechanisms.parts import clipped, DRIVE, Ranges, Reaction
from fourbar_ros.numerics.arguments import check_quantities, quantity
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import NumberType, Scalar
import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.mechanism import Mechanism

BARELY = 1e-200             # rate of an impending motion: nothing comes from it but signs
SAMPLES, HALVINGS = 720, 50     # of each range of the input, to find where it locks


@dataclass(frozen=True)
class JointFriction:
    """
    Dry and viscous friction of a joint.

    A pin that transmits the force F brakes with the couple ``coefficient radius |F|``. A guide
    that transmits the normal force N and the couple C brakes with a force: the ends of its block
    bear N/2 + C/length and N/2 - C/length, on one face of the guide or on both, and their sizes
    add up, so ``coefficient max(|N|, 2 |C| / length)``. Both act against the relative motion; at
    relative rest there is none.

    Sources: Shigley's Mechanical Engineering Design (pins as journals); for guides the law of
    Coulomb at both ends of a block, as of a drawer that jams, in Meriam and Kraige, Engineering
    Mechanics: Statics, chapter 6.

    Parameters
    ----------
    coefficient : float
        Coefficient of dry friction.
    radius : float
        Of a pin: its radius [m]; positive, if there is a coefficient.
    viscous : float
        Viscous friction of a pin [N m s/rad], of a guide [N s/m].
    length : float
        Of a guide: length of the block [m], half of it on both sides of the first joint of the
        link that slides; infinite, so not given: the couple is borne without friction.

    """

    coefficient: float = quantity(0.0, least=0.0)
    _: KW_ONLY
    radius: float = quantity(0.0, least=0.0)
    viscous: float = quantity(0.0, least=0.0)
    length: float = quantity(inf, least=0.0, instead=inf)

    def __post_init__(self) -> None:
        check_quantities(self)
        if not self.length:
            raise InvalidParameter('length', self.length, 'must be positive')

    @property
    def structure(self) -> tuple[bool, bool]:
        """Return in what its formula differs besides numbers: is it dry, does its block tilt."""
        return self.coefficient > 0.0, self.length < inf


@dataclass(frozen=True)
class DriveFriction:
    """
    Friction of the drive itself, as of its gear and bearings: no joint feels it.

    Parameters
    ----------
    torque : float
        Constant torque, or force of a driven slide, against the motion [N m], [N].
    viscous : float
        Torque or force over the rate of the input [N m s/rad], [N s/m].
    slip_speed : float
        Rate of the input [rad/s], [m/s] below which dry friction of drive and joints falls off
        smoothly, to none at rest, as motion that follows from torque needs it; 0: it jumps.

    """

    torque: float = quantity(0.0, least=0.0)
    viscous: float = quantity(0.0, least=0.0)
    slip_speed: float = quantity(0.0, least=0.0)

    @property
    def structure(self) -> tuple[bool]:
        return (self.slip_speed > 0.0,)

    def __post_init__(self) -> None:
        check_quantities(self)


Friction = tuple[tuple[str, JointFriction | DriveFriction], ...]      # (name of a joint, friction)


def checked_friction(reactions: Sequence[Reaction], friction: Any) -> Friction:
    """Return {joint, or 'drive': its friction} as pairs; InvalidParameter names what is wrong."""
    # reactions: of the mechanism, one at each joint.
    try:
        by_joint: dict[str, Any] = dict(friction)
    except (TypeError, ValueError):
        raise InvalidParameter('friction', friction,
                               'must be a mapping {joint: JointFriction}') from None
    slides = {reaction.joint: bool(reaction.couple) for reaction in reactions}
    for name, record in by_joint.items():
        if name not in slides and name != DRIVE:
            raise InvalidParameter(f'friction.{name}', None, 'there is no such joint: '
                                   + one_of([*slides, DRIVE], name))
        kind = DriveFriction if name == DRIVE else JointFriction
        if not isinstance(record, kind):
            raise InvalidParameter(f'friction.{name}', record, f'must be a {kind.__name__}')
        if not isinstance(record, JointFriction):
            continue
        if slides[name] and record.radius:
            raise InvalidParameter(f'friction.{name}.radius', record.radius,
                                   'only pins have one: this joint slides')
        if not slides[name] and record.length != inf:
            raise InvalidParameter(f'friction.{name}.length', record.length,
                                   'only guides have one: this joint turns')
        if not slides[name] and record.coefficient and not record.radius:
            raise InvalidParameter(f'friction.{name}.radius', record.radius, 'must be positive: '
                                   'the couple of a pin is coefficient times radius times force')
    return tuple([(name, by_joint[name]) for name in (*slides, DRIVE) if name in by_joint])


def direction_of(n: NumberType, rate: Scalar, slip_speed: Scalar | None) -> Scalar:
    """Return the sign of the rate of the input, between -1 and 1 within a slip speed, (J4)."""
    # With x = rate / slip_speed (J4) is x (3 - x^2) / 2, and so is the size of dry friction over
    # that of Coulomb, the same for all joints: of one degree of freedom they stick together.
    if slip_speed is None:
        return sign_of(n, rate)
    x = rate / slip_speed
    smooth: Scalar = 0.5 * x * (3.0 - x * x)
    direction: Scalar = n.where((n.fabs(x) - 1.0).real > 0.0, sign_of(n, x), smooth)
    return direction


def sign_of(n: NumberType, x: Scalar) -> Scalar:
    sign: Scalar = n.where(x.real > 0.0, 1.0, n.where(x.real < 0.0, -1.0, 0.0))
    return sign


def holding(mechanism: Mechanism, position: ArrayLike) -> tuple[Any, Any]:
    still = mechanism.with_friction([
        (name, replace(friction, viscous=0.0, **({'slip_speed': 0.0} if name == DRIVE else {})))
        for name, friction in mechanism.friction])
    bounds = list[Any]()
    for way in (-1.0, 1.0):
        try:
            drive = getattr(still.loads(position, way * BARELY), mechanism.drive_load)
        except Locked:
            drive = way * inf
        if isinstance(drive, np.ndarray):
            drive = np.where(_is_locked(still, position, way * BARELY, 0.0), way * inf, drive)
        bounds.append(drive)
    return bounds[0], bounds[1]


def locked_ranges(mechanism: Mechanism, rate: float, acceleration: float,
                  within: tuple[float, float] | None) -> Ranges:
    # pieces ask for friction too
    from fourbar_ros.mechanisms.pieces import ranges_of, samples_of_range
    # within: two inputs; those ranges alone that overlap with the range between them
    ranges = list[tuple[float, float]]()
    for low, high in ranges_of(mechanism):
        # next to a toggle all forces grow, so that it locks before
        x = (np.linspace(low, high, SAMPLES * mechanism.turns + 1) if mechanism.turns_fully
             else samples_of_range(low, high))
        is_locked = np.asarray(_is_locked(mechanism, x, rate, acceleration))
        # the ends, each between a free input and a locked one
        before = np.flatnonzero(is_locked[1:] != is_locked[:-1])
        begins_locked = is_locked[before]
        free = np.where(begins_locked, x[before + 1], x[before])
        locked = np.where(begins_locked, x[before], x[before + 1])
        for _ in range(HALVINGS):
            middle = 0.5 * (free + locked)
            locks = np.asarray(_is_locked(mechanism, middle, rate, acceleration))
            free, locked = np.where(locks, free, middle), np.where(locks, middle, locked)
        ends = [*([low] if is_locked[0] else []), *locked.tolist(),
                *([high] if is_locked[-1] else [])]
        ranges += zip(ends[::2], ends[1::2])
    if within is not None:
        ranges = [bounds for bounds in ranges if clipped((bounds,), within, mechanism.cycle)]
    return tuple(ranges)


def locking_joints(mechanism: Mechanism, bounds: tuple[float, float], rate: float,
                   acceleration: float) -> tuple[str, ...]:
    """Return the names of the joints that lock in the middle of a range of the input."""
    try:
        mechanism.loads(0.5 * (bounds[0] + bounds[1]), rate, acceleration)
    except Locked as error:
        return error.joints
    except Toggle:          # a flat position, beside which friction grows as the forces of joints
        pass
    return dry_joints(mechanism)


def dry_joints(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the names of the joints with dry friction."""
    return tuple([name for name, law in mechanism.friction if getattr(law, 'coefficient', 0.0)])


def _is_locked(mechanism: Mechanism, position: ArrayLike, rate: float, acceleration: float
               ) -> Array:
    """Return at which inputs friction alone leaves no loads."""
    drive, free = (getattr(each.loads(np.asarray(position), rate, acceleration),
                           mechanism.drive_load)
                   for each in (mechanism, mechanism.without_friction))
    is_locked: Array = np.isnan(drive) & ~np.isnan(free)
    return is_locked
