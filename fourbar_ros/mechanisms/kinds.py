# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The mechanisms by the names they have in scenes, and what the parameter table says of each.

Formulas of a kind are imported when it is asked for.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import cast, NamedTuple, TYPE_CHECKING

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
    A kind: its text, lengths, moving links and joints, as in its :class:`.Contract`.

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


class Kinds(Mapping[str, 'type[Mechanism]']):
    """{name: class} of all kinds."""

    def __getitem__(self, name: str) -> type[Mechanism]:
        return _class_of(*FACTS[name].home)

    def __iter__(self) -> Iterator[str]:
        return iter(FACTS)

    def __len__(self) -> int:
        return len(FACTS)


def _class_of(module: str, name: str) -> type[Mechanism]:
    return cast('type[Mechanism]',
                getattr(import_module(f'fourbar_ros.mechanisms.{module}'), name))


KINDS = Kinds()


def kind_of(name: str, driven: str) -> type[Mechanism]:
    """Return the class of a kind ('four_bar', ...) for an input; A and B have their own."""
    if driven in AT_MOVING_JOINTS.get(name, ()):
        return _class_of('four_bars', 'MovingJointFourBar')
    return KINDS[name]
