# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The loads that mechanisms have, one row each, besides those of the joints of one kind.

Manual, message LinkageLoads, services, extrema, pictures, page, FMU and C code read the rows.
"""
from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from types import SimpleNamespace
from typing import Any, NamedTuple


class Load(NamedTuple):
    """
    A load, which the message LinkageLoads has as a field of its name.

    ``text`` says what it is where it can be asked for by name, as for extrema; ``label``: in the
    table of a pose. ``of``: of a load that follows from others, the function (mechanism, its
    constants, motion, loads above) -> its value; of it mechanisms need state nothing. One trace
    serves all mechanisms of a structure, so masses and lengths come from the constants.
    """

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
)}
DERIVED = tuple(row for row in LOADS.values() if row.of)


def derives(formula_of: Callable[..., Any]) -> Callable[..., Any]:
    """Let a method ``loads_formula`` return the loads that follow from its own, too."""
    @wraps(formula_of)
    def with_all(mechanism: Any, numbers: Any, constants: Any) -> Any:
        own = formula_of(mechanism, numbers, constants)
        names = mechanism.LOADS._fields

        def loads(fields: Any) -> Any:
            """Return fields of LOADS for fields of MOTION."""
            motion, found = mechanism.MOTION(*fields), SimpleNamespace(**dict(zip(names,
                                                                                  own(fields))))
            for row in DERIVED:
                assert row.of
                setattr(found, row.name, row.of(mechanism, constants, motion, found))
            return mechanism.LOADS(**vars(found))
        return loads if DERIVED else own
    return with_all
