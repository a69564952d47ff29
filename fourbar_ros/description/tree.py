# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The joints of a mechanism as a tree, and those at which its loops are cut.

URDF knows trees only: every link hangs on one joint, and each joint beyond that closes a loop.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND


class NoDescription(FourBarError):
    """A mechanism or a scene cannot be written in a format."""


class Tree(NamedTuple):
    """
    Which joints hold the links, by their places in ``JOINTS``.

    Parameters
    ----------
    holding : dict
        {name of a link: its joint}, each link after the one that carries it.
    cut : tuple of int
        The joints that close the loops.

    """

    holding: dict[str, int]
    cut: tuple[int, ...]


def tree_of(mechanism: Mechanism) -> Tree:
    """
    Return the :class:`Tree` of a mechanism.

    A link hangs on the driven joint if that is at its first joint, else on a joint that slides,
    else on one that turns: so loops are cut at pins wherever they have one.

    Raises
    ------
    NoDescription
        Its joints do not reach every link from the ground.

    """
    connections, driven = mechanism.connections, mechanism.input_coordinate
    if not connections:
        raise NoDescription(f'a {mechanism.TITLE} does not state which links its joints connect')

    def preference(joint: int) -> tuple[bool, bool, int]:
        is_driven = mechanism.JOINTS[joint].coordinate == driven
        return not is_driven, connections[joint].axis is None, joint

    chosen = {}
    for link in mechanism.LINKS:
        at_its_first_joint = [joint for joint, its in enumerate(connections)
                              if its.child == link.name and its.on_child == (0.0, 0.0)]
        if not at_its_first_joint:
            raise NoDescription(f'no joint at the first joint of the link {link.name}')
        chosen[link.name] = min(at_its_first_joint, key=preference)
    ordered: dict[str, int] = {}
    while len(ordered) < len(chosen):
        reached = {link: joint for link, joint in chosen.items() if link not in ordered
                   and connections[joint].parent in (GROUND, *ordered)}
        if not reached:
            raise NoDescription('these links hang on each other in a circle: '
                                f'{", ".join(sorted(chosen.keys() - ordered.keys()))}')
        ordered |= reached
    cut = tuple(sorted(set(range(len(connections))) - set(ordered.values())))
    return Tree(ordered, cut)
