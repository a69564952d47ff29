# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Letters for the joints of a picture, and symbols of forces, where their names are words."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import count
from math import hypot
import re
from string import ascii_uppercase
from typing import NamedTuple

from fourbar_ros.mechanisms.parts import Diagram
from fourbar_ros.numerics.arrays import Array
import numpy as np

LETTER = re.compile(r'[A-Z](_\w)?')
SAME = 1e-9      # joints nearer to each other than this share of the picture are at one place


class Labels(NamedTuple):
    """Names of joints and forces in a picture; textbook names need no ``words``, ``letters``."""

    joints: Mapping[str, Array]         # {letter as mathtext: place}
    forces: Mapping[str, str]           # {field of the loads: symbol as mathtext}
    words: Mapping[str, str]            # {field of the loads: words behind its symbol in a text}
    letters: Mapping[str, str]          # {joint: letter}


def labels_of(diagram: Diagram) -> Labels:
    """
    Return the labels of a diagram.

    Joints named A, B, O_1, ... keep their names, with forces F_41 etc. Others, as those of a
    machine, get one letter for each place; several joints there make forces F_A1, F_A2.
    """
    if all(map(LETTER.fullmatch, diagram.joints)):
        return Labels(diagram.joints, {name: f'F_{{{name[1:]}}}' for name in diagram.forces},
                      {}, {})
    size = max(np.ptp(np.array(list(diagram.joints.values())), axis=0))
    groups: list[list[str]] = []             # joints at one place
    for name, place in diagram.joints.items():
        for names in groups:
            other = diagram.joints[names[0]]
            if hypot(place[0] - other[0], place[1] - other[1]) <= SAME * size:
                names.append(name)
                break
        else:
            groups.append([name])
    free_letters = _letters()
    joints: dict[str, Array] = {}
    symbols: dict[str, str] = {}             # of the force at each joint
    letters: dict[str, str] = {}
    for names in groups:
        place = diagram.joints[names[0]]
        letter = 'O_1' if not joints and not place.any() else next(free_letters)
        joints[letter] = place
        letters.update(dict.fromkeys(names, letter))
        for number, name in enumerate(names, 1):
            mark = number if len(names) > 1 else ''
            symbols[name] = f'F_{{{letter.replace("_", "")}{mark}}}'
    forces = {force: symbols[joint] for force, joint in diagram.forces.items()}
    return Labels(joints, forces, {force: force.replace('_', ' ') for force in forces}, letters)


def _letters() -> Iterator[str]:
    """Yield A, B, ..., A_1, B_1, ... without O, for pivots on the ground, and F, for forces."""
    for round_ in count():
        for letter in ascii_uppercase.replace('O', '').replace('F', ''):
            yield f'{letter}_{round_}' if round_ else letter
