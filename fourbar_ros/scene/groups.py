# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Groups of a scene's parameters as records: ``scene.drive.speed`` is the parameter drive.speed.

Types, units and texts of the parameters are in :mod:`fourbar_ros.scene.settings`.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, TypeVar

from fourbar_ros.scene.settings import ParameterValues

Record = TypeVar('Record')


@dataclass(frozen=True)
class DriveSettings:
    """Where the input comes from and how its rates are estimated: the parameters drive.*."""

    source: str
    speed: float
    start: float
    rate: float
    start_speed: float
    tolerance: float
    budget: int
    when_silent: str
    torque_limit: float             # NaN: none
    joint: str
    joint_ratio: float
    joint_offset: float
    window: int
    jump: float
    top_speed: float                # NaN: positions count their turns
    carried_inertia: float
    timeout: float
    out_of_range: str


@dataclass(frozen=True)
class CarriedBody:
    """What a simulator's own body has for the mechanism: the parameters base.carried.*."""

    mass: float
    x: float
    y: float
    inertia: float
    mean: bool


@dataclass(frozen=True)
class BaseSettings:
    """How the motion of the base is received: the parameters base.*."""

    topic: str
    rotation: list[float]
    frame_id: str
    window: int
    timeout: float
    when_silent: str
    carried: CarriedBody


@dataclass(frozen=True)
class WrenchSettings:
    """How external wrenches are received: external.*; ``links`` have a topic for theirs."""

    timeout: float
    when_silent: str
    extrapolated: bool
    links: tuple[str, ...]


@dataclass(frozen=True)
class FrameSettings:
    """Where the frame of the mechanism lies in a frame of the robot: the parameters frame.*."""

    parent: str                     # '': nowhere
    xyz: list[float]                # [m]
    rpy: list[float]                # [rad]


@dataclass(frozen=True)
class JointStates:
    """How joints are published: joint_states.*, ``ratios`` and ``offsets`` of each joint."""

    prefix: str
    ratios: list[float]
    offsets: list[float]
    when_unknown: str
    only_passive: bool
    leave_out: list[str]            # names of joints, without their prefix


@dataclass(frozen=True)
class RecordingSettings:
    """Where and how the node records: the parameters recording.*."""

    start: bool
    directory: str
    name: str
    split_size: float
    split_duration: float


@dataclass(frozen=True)
class NodeSettings:
    """What a node offers besides outputs: services, trajectories, pictures.rate."""

    services: list[str]
    trajectories: bool
    trajectory_fields: list[str]
    pictures_rate: float            # [Hz], of markers


def read(make: Callable[..., Record], group: str, values: ParameterValues, **more: Any) -> Record:
    """Return the parameters ``group``.* as a record; ``more``: fields made of other values."""
    return make(**{name: values[f'{group}.{name}'] for name in _fields_of(make)
                   if name not in more}, **more)


@cache      # the page reads a scene again at every move of a slider
def _fields_of(record: Any) -> tuple[str, ...]:
    return tuple(field.name for field in fields(record))
