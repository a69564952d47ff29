# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Markers of one kind each, in the plane of the mechanism."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import cos, sin
from typing import Union

from fourbar_ros.numerics.arrays import Array
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

Colour = tuple[float, float, float]
Place = Union[Sequence[float], Array]       # x, y, or x, y, z [m]

LINK, JOINT, BLOCK = (0.20, 0.45, 0.70), (0.15, 0.15, 0.15), (0.45, 0.45, 0.45)
FORCE, MOMENT, POINT = (0.10, 0.55, 0.20), (0.75, 0.35, 0.05), (0.55, 0.30, 0.00)
TOGGLE, EXTREMUM = (0.80, 0.10, 0.10), (0.45, 0.15, 0.60)


def marker(frame: str, group: str, number: int, kind: int, colour: Colour, scale: Iterable[float],
           opacity: float = 1.0) -> Marker:
    """Return a marker of a group (its namespace in RViz) with a number."""
    made = Marker(ns=group, id=number, type=kind, action=Marker.ADD,
                  color=ColorRGBA(r=colour[0], g=colour[1], b=colour[2], a=opacity))
    made.header.frame_id = frame
    made.scale.x, made.scale.y, made.scale.z = map(float, scale)
    made.pose.orientation.w = 1.0
    return made


def lines(frame: str, group: str, number: int, pairs: Iterable[Iterable[Place]], width: float,
          colour: Colour, opacity: float = 1.0) -> Marker:
    """Return a marker of separate lines: pairs of places."""
    made = marker(frame, group, number, Marker.LINE_LIST, colour, (width, 0.0, 0.0), opacity)
    made.points = [point(*place) for pair in pairs for place in pair]
    return made


def strip(frame: str, group: str, number: int, places: Iterable[Place], width: float,
          colour: Colour) -> Marker:
    """Return a marker of one line through places."""
    made = marker(frame, group, number, Marker.LINE_STRIP, colour, (width, 0.0, 0.0))
    made.points = [point(*place) for place in places]
    return made


def spheres(frame: str, group: str, number: int, places: Iterable[Place], size: float,
            colour: Colour) -> Marker:
    """Return a marker of spheres."""
    made = marker(frame, group, number, Marker.SPHERE_LIST, colour, (size, size, size))
    made.points = [point(*place) for place in places]
    return made


def box(frame: str, group: str, number: int, place: Place, angle: float, scale: Iterable[float],
        colour: Colour) -> Marker:
    """Return a marker of a box that is turned."""
    made = marker(frame, group, number, Marker.CUBE, colour, scale)
    made.pose.position = point(*place)
    made.pose.orientation.z, made.pose.orientation.w = sin(0.5 * angle), cos(0.5 * angle)
    return made


def arrow(frame: str, group: str, number: int, start: Place, end: Place, width: float,
          colour: Colour) -> Marker:
    """Return a marker of an arrow between two places of space."""
    made = marker(frame, group, number, Marker.ARROW, colour, (width, 2.0 * width, 3.0 * width))
    made.points = [point(*start), point(*end)]
    return made


def label(frame: str, group: str, number: int, place: Place, text: str, height: float,
          colour: Colour) -> Marker:
    """Return a marker of a text that faces the viewer."""
    made = marker(frame, group, number, Marker.TEXT_VIEW_FACING, colour, (0.0, 0.0, height))
    made.pose.position, made.text = point(*place), text
    return made


def point(x: float, y: float, z: float = 0.0) -> Point:
    """Return a Point."""
    return Point(x=float(x), y=float(y), z=float(z))
