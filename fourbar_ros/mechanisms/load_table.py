# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The table of the loads that mechanisms have.

Manual, message LinkageLoads, services, extrema, pictures, page, FMU and C code read its rows.
"""
from collections.abc import Callable
from typing import Any, NamedTuple


class Load(NamedTuple):
    """A load, which the message LinkageLoads has as a field of its name."""

    # text says what it is where it can be asked for by name, as for extrema; label: in the table
    # of a pose. of: of a load that follows from others, the function (mechanism, its constants,
    # motion, loads above) -> its value; of it mechanisms need state nothing. One trace serves all
    # mechanisms of a structure, so masses and lengths come from the constants.
    name: str
    unit: str
    text: str = ''
    label: str = ''
    of: Callable[[Any, Any, Any, Any], Any] | None = None


LOADS = {row.name: row for row in (
    Load('shaking_force', 'N', 'magnitude of the force on the ground'),
    Load('shaking_moment', 'N m', 'moment on the ground about O1', 'shaking moment about O1'),
    Load('driving_torque', 'N m', 'torque of the drive on a driven crank', 'driving torque T41'),
    Load('driving_force', 'N', 'force of the drive along a driven slide', 'driving force'),
    Load('f41', 'N', 'magnitude of the reaction at O1'),
    Load('f21', 'N', 'magnitude of the reaction at A'),
    Load('f32', 'N', 'magnitude of the reaction at B, or of the bar on its block'),
    Load('f43', 'N', 'magnitude of the reaction at O4, or of the guide'),
    Load('guide_force', 'N', 'force of the guide, square to it', 'guide force'),
    Load('guide_couple', 'N m', 'couple of the guide', 'guide couple'),
    *(Load(f'{force}_{axis}', 'N') for force in ('f41', 'f21', 'f32', 'f43', 'shaking_force')
      for axis in 'xy'),
    Load('driving_power', 'W', 'power of the drive, positive where it drives', 'driving power',
         lambda mechanism, constants, motion, loads: (
             getattr(loads, mechanism.drive_load)       # torque or force
             * getattr(motion, mechanism.input_coordinate.rate))),
)}
DERIVED = tuple(row for row in LOADS.values() if row.of)
