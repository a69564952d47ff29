# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Groups of a scene's parameters as records: ``scene.drive.speed`` is the parameter drive.speed.

Types, units and texts of the parameters are in :mod:`fourbar_ros.scene.settings`.
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.scene.settings import ParameterValues


class DriveSettings(NamedTuple):
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


class CarriedBody(NamedTuple):
    """What a simulator's own body has for the mechanism: the parameters base.carried.*."""

    mass: float
    x: float
    y: float
    inertia: float
    mean: bool


class BaseSettings(NamedTuple):
    """How the motion of the base is received: the parameters base.*."""

    topic: str
    rotation: list[float]
    frame_id: str
    window: int
    timeout: float
    when_silent: str
    carried: CarriedBody


class WrenchSettings(NamedTuple):
    """How external wrenches are received: external.*; ``links`` have a topic for theirs."""

    timeout: float
    when_silent: str
    extrapolated: bool
    links: tuple[str, ...]


class FrameSettings(NamedTuple):
    """Where the frame of the mechanism lies in a frame of the robot: the parameters frame.*."""

    parent: str                     # '': nowhere
    xyz: list[float]                # [m]
    rpy: list[float]                # [rad]


class JointStates(NamedTuple):
    """How joints are published: joint_states.*, ``ratios`` and ``offsets`` of each joint."""

    prefix: str
    ratios: list[float]
    offsets: list[float]
    when_unknown: str
    only_passive: bool
    leave_out: list[str]            # names of joints, without their prefix


class RecordingSettings(NamedTuple):
    """Where and how the node records: the parameters recording.*."""

    start: bool
    directory: str
    name: str
    split_size: float
    split_duration: float


class NodeSettings(NamedTuple):
    """What a node offers besides outputs: services, trajectories, pictures.rate."""

    services: list[str]
    trajectories: bool
    trajectory_fields: list[str]
    pictures_rate: float            # [Hz], of markers


def read(make: Any, group: str, values: ParameterValues, **more: Any) -> Any:
    """Return the parameters ``group``.* as a record; ``more``: fields made of other values."""
    return make(**{name: values[f'{group}.{name}'] for name in make._fields if name not in more},
                **more)
