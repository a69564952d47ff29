# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Markers of one kind each, in the plane of the mechanism."""
from __future__ import annotations

from math import cos, sin

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

LINK, JOINT, BLOCK = (0.20, 0.45, 0.70), (0.15, 0.15, 0.15), (0.45, 0.45, 0.45)
FORCE, MOMENT, POINT = (0.10, 0.55, 0.20), (0.75, 0.35, 0.05), (0.55, 0.30, 0.00)
TOGGLE, EXTREMUM = (0.80, 0.10, 0.10), (0.45, 0.15, 0.60)


def marker(frame, group, number, kind, colour, scale, opacity=1.0):
    """Return a marker of a group (its namespace in RViz) with a number."""
    made = Marker(ns=group, id=number, type=kind, action=Marker.ADD,
                  color=ColorRGBA(r=colour[0], g=colour[1], b=colour[2], a=opacity))
    made.header.frame_id = frame
    made.scale.x, made.scale.y, made.scale.z = map(float, scale)
    made.pose.orientation.w = 1.0
    return made


def lines(frame, group, number, pairs, width, colour, opacity=1.0):
    """Return a marker of separate lines: pairs of places."""
    made = marker(frame, group, number, Marker.LINE_LIST, colour, (width, 0.0, 0.0), opacity)
    made.points = [point(*place) for pair in pairs for place in pair]
    return made


def strip(frame, group, number, places, width, colour):
    """Return a marker of one line through places."""
    made = marker(frame, group, number, Marker.LINE_STRIP, colour, (width, 0.0, 0.0))
    made.points = [point(*place) for place in places]
    return made


def spheres(frame, group, number, places, size, colour):
    """Return a marker of spheres."""
    made = marker(frame, group, number, Marker.SPHERE_LIST, colour, (size, size, size))
    made.points = [point(*place) for place in places]
    return made


def box(frame, group, number, place, angle, scale, colour):
    """Return a marker of a box that is turned."""
    made = marker(frame, group, number, Marker.CUBE, colour, scale)
    made.pose.position = point(*place)
    made.pose.orientation.z, made.pose.orientation.w = sin(0.5 * angle), cos(0.5 * angle)
    return made


def arrow(frame, group, number, start, end, width, colour):
    """Return a marker of an arrow between two places of space."""
    made = marker(frame, group, number, Marker.ARROW, colour, (width, 2.0 * width, 3.0 * width))
    made.points = [point(*start), point(*end)]
    return made


def label(frame, group, number, place, text, height, colour):
    """Return a marker of a text that faces the viewer."""
    made = marker(frame, group, number, Marker.TEXT_VIEW_FACING, colour, (0.0, 0.0, height))
    made.pose.position, made.text = point(*place), text
    return made


def point(x, y, z=0.0):
    """Return a Point."""
    return Point(x=float(x), y=float(y), z=float(z))
