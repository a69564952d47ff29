# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A robot as its file has it: bodies and joints in one pose, all in the frame of its root.

Readers make it (:mod:`.mjcf`, :mod:`.urdf`); :mod:`.loops` and :mod:`.machine` take it apart.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import radians
import re
from typing import NamedTuple

from fourbar_ros.errors import FourBarError
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.units import quantity, WrongQuantity
import numpy as np

PIN, SLIDE, POINT, BALL, FIXED, FREE = 'pin', 'slide', 'point', 'ball', 'fixed', 'free'
LEAST_MASS, LEAST_INERTIA = 2e-9, 1e-6       # [kg], and of what weighs nothing [kg m^2]
CUT = re.compile('closing_|closedloop')         # frames where loops are cut: ours, Gepetto's
START = 'start'         # the pose that is read if a file has it, as those of fourbar describe do


class Refused(FourBarError):
    """A robot or a loop of it cannot be imported; the message says why and what would help."""


class Inertial(NamedTuple):
    """Mass [kg], centre of gravity [m], inertia about it [kg m^2], in the frame of the root."""

    mass: float
    centre: Array
    inertia: Array


@dataclass
class RobotJoint:
    """
    A joint: of the tree, or ``closes`` a loop.

    The body ``child`` turns or slides about ``axis`` relative to ``parent`` as ``position`` grows
    [rad or m]. ``on_parent`` and ``on_child`` [m] are its point on both bodies, apart where a loop
    is open. A ``point`` coincides on both and has no axis: a pin, if its loop is planar.
    """

    name: str
    kind: str
    parent: str
    child: str
    on_parent: Array
    on_child: Array
    axis: Array | None = None
    position: float = 0.0
    limits: tuple[float, float] | None = None
    closes: bool = False
    turned: float = 0.0                 # [rad], how far a fixed joint that closes is open

    @property
    def gap(self) -> float:
        return float(np.linalg.norm(self.on_parent - self.on_child))


class Coupling(NamedTuple):
    """A gear or mimic: position of ``joint`` = ``offset`` + ``ratio`` * position of ``motor``."""

    joint: str
    motor: str
    offset: float
    ratio: float


@dataclass
class Robot:
    """
    ``poses``: 4 x 4 of each body; ``notes``: a line for each thing that was left out.

    ``frames``: (body, point [m]) of what is fixed to bodies, but where loops are closed.
    """

    format: str
    root: str
    gravity: Array
    poses: dict[str, Array] = field(default_factory=dict)
    inertials: dict[str, Inertial] = field(default_factory=dict)
    joints: list[RobotJoint] = field(default_factory=list)
    frames: dict[str, tuple[str, Array]] = field(default_factory=dict)
    drives: list[str] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def add_inertial(self, body: str, mass: float, pose: Array, inertia: Array) -> None:
        """Add mass and inertia, about the origin of a pose; not those that only stand for none."""
        axes = pose[:3, :3]
        if mass > LEAST_MASS or np.max(np.abs(inertia)) > LEAST_INERTIA:
            self.inertials[body] = Inertial(mass, pose[:3, 3], axes @ inertia @ axes.T)

    def add_fixed_bodies(self) -> None:
        """Add the frames that are bodies fixed to others, when all joints are there."""
        closing = {body for joint in self.joints if joint.closes
                   for body in (joint.parent, joint.child)}
        self.frames |= {joint.child: (joint.child, joint.on_child) for joint in self.joints
                        if joint.kind == FIXED and joint.child not in closing
                        and not CUT.match(joint.child) and not joint.parent.endswith('_hinge')}


def word(name: str, kind: str) -> str:
    """Return a name as ROS takes it for nodes, topics and parameters: KIND_1 of 1."""
    text = re.sub(r'\W+', '_', name, flags=re.ASCII).strip('_')
    return text if text[:1].isalpha() else f'{kind}_{text}'


def pose_of(rotation: Array, position: Sequence[float] | Array) -> Array:
    """Return the 4 x 4 of a rotation and a position."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, position
    return pose


def angle_between(first: Array, second: Array) -> float:
    """Return the angle [rad] from one rotation to another."""
    return float(np.arccos(np.clip(0.5 * (np.trace(first.T @ second) - 1.0), -1.0, 1.0)))


def position_of(name: str, kind: str, text: str) -> float:
    """Return the position of a joint that a user gives: plain angles are degrees; Refused."""
    if kind not in (PIN, SLIDE):
        raise Refused(f'--at {name}: this joint neither turns about an axis nor slides')
    try:
        value = quantity(text, 'm' if kind == SLIDE else 'rad')
    except WrongQuantity as error:
        raise Refused(f'--at {name}={text}: {error}') from None
    return float(value) if kind == SLIDE or value.unit else radians(value)
