# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Inertia of a link for programs that think in three dimensions.

A planar mechanism gives the moment about z alone, and nothing in its plane depends on the other
two. Those of a flat body are written, I_xx = I_yy = I_zz / 2: a body that can exist.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Body

LEAST = 1e-9           # of mass times size squared: for a body that has none, as a slider's


class Inertia(NamedTuple):
    """Mass [kg], centre of gravity in the frame of the link [m], moments [kg m^2]."""

    mass: float
    x: float
    y: float
    about_x: float
    about_y: float
    about_z: float


def inertia_of(body: Body, size: float) -> Inertia:
    """
    Return the :class:`Inertia` of a body.

    No program takes a body without mass or inertia; ``size`` is that of the mechanism [m].
    """
    mass = max(body.mass, LEAST)
    about_z = max(body.inertia, LEAST * (body.mass or 1.0) * size * size)
    return Inertia(mass, body.cg_along, body.cg_across, 0.5 * about_z, 0.5 * about_z, about_z)
