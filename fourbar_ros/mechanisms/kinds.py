# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Two tables: the mechanisms by the names they have in scenes, and the loads that they have.

Formulas of a kind are imported when it is asked for. Manual, message LinkageLoads, services,
extrema, pictures, page, FMU and C code read the rows of the loads.
"""
from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import SimpleNamespace
from typing import Any, cast, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.parts import (
    Joint,
    Length,
    Link,
    SLOT,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
    TRAVEL,
)

if TYPE_CHECKING:      # its formulas need what stands here
    from fourbar_ros.mechanisms.mechanism import Mechanism


class Facts(NamedTuple):
    """
    A kind: its text, lengths, moving links and joints, as in its :class:`.Mechanism`.

    ``inputs``: the names of its driven joints; ``home``: module and name of its class.
    """

    text: str
    lengths: tuple[Length, ...]
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    inputs: tuple[str, ...]
    home: tuple[str, str]


_A1, _CRANK, _O1 = Length('a1', 'length of the crank O1-A'), Link('crank', 'crank', 'O1', 'a1'), (
    Joint('O1', THETA1, 'crank'))
_GUIDE = Length('offset', 'y of the guide', signed=True)
FACTS = {
    'four_bar': Facts(
        'four revolute joints',
        (_A1, Length('a2', 'length of the coupler A-B'),
         Length('a3', 'length of the output link O4-B'),
         Length('a4', 'length of the ground link O1-O4')),
        (_CRANK, Link('coupler', 'coupler', 'A', 'a2'), Link('output', 'output link', 'O4', 'a3')),
        (_O1, Joint('A', THETA2, 'coupler'), Joint('B', THETA3, 'coupler_output'),
         Joint('O4', THETA4, 'output')),
        ('crank',), ('four_bars', 'FourBar')),
    'slider_crank': Facts(
        'a slider on a guide parallel to x',
        (_A1, Length('a2', 'length of the coupler A-B'), _GUIDE),
        (_CRANK, Link('coupler', 'coupler', 'A', 'a2'),
         Link('output', 'slider', 'B', turns=False)),
        (_O1, Joint('A', THETA2, 'rod'), Joint('B', THETA3, 'pin'),
         Joint('guide', TRAVEL, 'slider')),
        ('crank', 'slide'), ('sliders', 'SliderCrank')),
    'inverted_slider': Facts(
        'a block on a bar that turns about O4, e.g. an oscillating cylinder',
        (_A1, Length('a4', 'length of the ground link O1-O4'),
         Length('offset', 'distance of the path of A on the bar from O4, positive to the left of '
                          'the bar', signed=True)),
        (_CRANK, Link('coupler', 'block', 'A'), Link('output', 'bar', 'O4')),
        (_O1, Joint('A', THETA2, 'block'), Joint('slide', TRAVEL, 'slide'),
         Joint('O4', THETA4, 'bar')),
        ('crank', 'slide'), ('sliders', 'InvertedSlider')),
    'scotch_yoke': Facts(
        'a crank pin in the slot of a yoke that slides parallel to x, a Scotch yoke',
        (_A1, _GUIDE),
        (_CRANK, Link('coupler', 'block', 'A', turns=False),
         Link('output', 'yoke', 'B', turns=False)),
        (_O1, Joint('A', THETA2, 'block'), Joint('slot', SLOT, 'slot'),
         Joint('guide', TRAVEL, 'yoke')),
        ('crank', 'slide'), ('sliders', 'ScotchYoke')),
}
# {kind: joints between two moving links, at which its links can be driven too}
AT_MOVING_JOINTS = {'four_bar': ('A', 'B')}
# {kind of dyad: names of its dimensions, in order}: lengths and offsets [m], angles [rad]
DIMENSIONS = {
    'RRR': ('length_1', 'length_2'),
    'RRP': ('length_1', 'direction_2'),
    'RPR': ('offset',),
    'RPP': ('direction_2', 'slot'),
    'PRP': ('direction_1', 'direction_2'),
}


def kind_of(name: str, driven: str) -> type[Mechanism]:
    """Return the class of a kind ('four_bar', ...) for an input; A and B have their own."""
    home = FACTS[name].home
    if driven in AT_MOVING_JOINTS.get(name, ()):
        home = 'moving_joint', 'MovingJointFourBar'
    module = import_module(f'fourbar_ros.mechanisms.{home[0]}')
    return cast('type[Mechanism]', getattr(module, home[1]))


# --- loads ---------------------------------------------------------------------------------------

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


def all_loads(mechanism: Any, constants: Any, own_loads: Callable[..., Any], fields: Any) -> Any:
    """Return LOADS for fields of a motion: its own, and those that follow from others."""
    motion = mechanism.MOTION(*fields)
    loads = SimpleNamespace(**dict(zip(mechanism.LOADS._fields, own_loads(motion))))
    for row in DERIVED:
        assert row.of
        try:
            value = row.of(mechanism, constants, motion, loads)
        except AttributeError as error:     # a field that other kinds have
            raise FourBarError(f'load {row.name} of {mechanism.TITLE}: {error}; a row of LOADS '
                               'holds for every kind of mechanism') from None
        setattr(loads, row.name, value)
    return mechanism.LOADS(**vars(loads))
