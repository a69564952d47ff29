# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A robot as its file has it: bodies and joints in one pose, all in the frame of its root.

Readers make it (:mod:`.mjcf`, :mod:`.urdf`); :mod:`.loops` and :mod:`.machine` take it apart.
"""
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import radians
import re
from typing import NamedTuple

from fourbar_ros.errors import FourBarError, nearest
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.units import quantity, WrongQuantity
import numpy as np

PIN, SLIDE, POINT, BALL, FIXED, FREE = 'pin', 'slide', 'point', 'ball', 'fixed', 'free'
LEAST_MASS, LEAST_INERTIA = 2e-9, 1e-6          # [kg], and of what weighs nothing [kg m^2]
CUT = re.compile('closing_|closedloop')         # frames where loops are cut: ours, Gepetto's
START = 'start'         # the pose that is read if a file has it, as those of fourbar describe do


class Refused(FourBarError):
    """A robot or a loop of it cannot be imported; the message says why and what would help."""


class Wishes(NamedTuple):
    """What the user says beside the file, by the options of the verb: ``docs/robots.md``."""

    loop: str = ''                          # a joint or link of the only loop that is wanted
    drive: Sequence[str] = ()               # joints
    base: str = ''                          # a link
    close: Sequence[str] = ()               # of URDF: FRAME,FRAME or FRAME,FRAME:fixed
    lock: Sequence[str] = ()                # joints that are held
    cut: Sequence[str] = ()                 # closing joints that are left out
    key: str = ''                           # a pose
    at: Mapping[str, str] = {}              # {joint: position}, as text
    mode: Mapping[str, int] = {}            # {dyad: 1 or 2}
    gravity: Sequence[float] = ()           # [m/s^2] in the frame of the root
    check: bool = False                     # against MuJoCo

    def pose_of(self, keys: Collection[str], kind: str) -> str:
        """Return the key of the pose, of those that the file has; '' is its zero pose."""
        if self.key:
            check_name('--key', self.key, keys, kind)
        return self.key or START * (START in keys)

    def positions(self, kinds: Mapping[str, str]) -> dict[str, float]:
        """Return {joint: position [rad or m]} of ``at``; ``kinds``: {joint: kind} of the file."""
        positions = {}
        for name, text in self.at.items():
            check_name('--at', name, kinds, 'joint')
            kind = kinds[name]
            if kind not in (PIN, SLIDE):
                raise Refused(f'--at {name}: this joint neither turns about an axis nor slides')
            try:
                value = quantity(text, 'm' if kind == SLIDE else 'rad', plain_angle='deg')
            except WrongQuantity as error:
                raise Refused(f'--at {name}={text}: {error}') from None
            positions[name] = radians(value) if kind == PIN else float(value)
        return positions


def check_name(option: str, name: str, known: Collection[str], kind: str) -> None:
    """Raise Refused for a name of an option that the file does not have."""
    if name not in known:
        raise Refused(f'{option} {name}: the file has no such {kind}{nearest(name, known)}')


class Inertial(NamedTuple):
    """Mass [kg], centre of gravity [m], inertia about it [kg m^2], in the frame of the root."""

    mass: float
    centre: Array
    inertia: Array


@dataclass
class RobotJoint:
    """A joint: the body ``child`` turns or slides about ``axis`` relative to ``parent``."""

    name: str
    kind: str                           # a POINT coincides on both bodies and has no axis
    parent: str
    child: str
    on_parent: Array                    # [m], where it is on both, apart where a loop is open
    on_child: Array
    axis: Array | None = None
    position: float = 0.0               # [rad or m]
    limits: tuple[float, float] | None = None
    closes: bool = False                # a loop; else it is one of the tree
    turned: float = 0.0                 # [rad], how far a fixed joint that closes is open
    ratio: float = 1.0                  # position = ratio * (coordinate in the scene) + offset
    offset: float = 0.0

    @property
    def gap(self) -> float:
        return float(np.linalg.norm(self.on_parent - self.on_child))

    @property
    def coordinate(self) -> float:
        """Return the coordinate in the scene where the joint stands [rad or m]."""
        return (self.position - self.offset) / self.ratio


class Coupling(NamedTuple):
    """A gear or mimic: position of ``joint`` = ``offset`` + ``ratio`` * position of ``motor``."""

    joint: str
    motor: str
    offset: float
    ratio: float


@dataclass
class Robot:
    """Bodies and joints of a file; positions, axes and gravity in the frame of the root."""

    format: str
    root: str
    gravity: Array                                                      # [m/s^2]
    poses: dict[str, Array] = field(default_factory=dict)               # 4 x 4 of each body
    inertials: dict[str, Inertial] = field(default_factory=dict)
    unweighed: Collection[str] = ()     # bodies with mass in meshes, which are not read
    joints: list[RobotJoint] = field(default_factory=list)
    # (body, point [m]) of what is fixed to bodies, but where loops are closed
    frames: dict[str, tuple[str, Array]] = field(default_factory=dict)
    drives: list[str] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)                      # of what was left out
    planes: list[str] = field(default_factory=list)                     # frames of its loops

    def add_inertial(self, body: str, mass: float, pose: Array, inertia: Array) -> None:
        """Add mass and inertia, about the origin of a pose; not those that only stand for none."""
        axes = pose[:3, :3]
        least, *_, most = np.linalg.eigvalsh(inertia)
        if mass < 0.0:
            raise Refused(f'{body} has a negative mass, {mass:.4g} kg')
        if least < -1e-9 * abs(most):           # more than digits of its file
            raise Refused(f'{body} has a negative moment of inertia, {least:.4g} kg m^2 about a '
                          'principal axis')
        if mass > LEAST_MASS or np.max(np.abs(inertia)) > LEAST_INERTIA:
            self.inertials[body] = Inertial(mass, pose[:3, 3], axes @ inertia @ axes.T)

    def add_closing(self, name: str, kind: str, bodies: Sequence[str], poses: Iterable[Array],
                    axis: Array | None = None) -> None:
        """Add a joint that closes a loop; ``poses``: its own on both bodies, axis in the root."""
        (parent, child), (here, there) = bodies, poses
        if name in {joint.name for joint in self.joints if not joint.closes}:
            raise Refused(f'two joints are called {name!r}')
        turn = 0.5 * (np.trace(here[:3, :3].T @ there[:3, :3]) - 1.0)       # its cosine
        self.joints.append(RobotJoint(
            name, POINT if axis is None and kind == PIN else kind, parent, child, here[:3, 3],
            there[:3, 3], unit_vector(name, axis) if axis is not None and kind in (PIN, SLIDE)
            else None, closes=True,
            turned=float(np.arccos(np.clip(turn, -1.0, 1.0))) if kind == FIXED else 0.0))

    def add_fixed_bodies(self) -> None:
        """Add the frames that are bodies fixed to others, when all joints are there."""
        closing = {body for joint in self.joints if joint.closes
                   for body in (joint.parent, joint.child)}
        self.frames |= {joint.child: (joint.child, joint.on_child) for joint in self.joints
                        if joint.kind == FIXED and joint.child not in closing
                        and not CUT.match(joint.child) and not joint.parent.endswith('_hinge')}


def unit_vector(joint: str, axis: Array) -> Array:
    """Return the direction of a joint's axis; raises Refused of one without length."""
    if not np.any(axis):
        raise Refused(f'{joint}: its axis is 0 0 0')
    direction: Array = axis / np.linalg.norm(axis)
    return direction


def word(name: str, kind: str) -> str:
    """Return a name as ROS takes it for nodes, topics and parameters: KIND_1 of 1."""
    text = re.sub(r'\W+', '_', name, flags=re.ASCII).strip('_')
    return text if text[:1].isalpha() else f'{kind}_{text}'


def pose_of(rotation: Array, position: Sequence[float] | Array) -> Array:
    """Return the 4 x 4 of a rotation and a position."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, position
    return pose
