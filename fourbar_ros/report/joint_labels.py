# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Letters for the joints of a picture where their names are words."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
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
    """
    What a picture calls its joints and forces.

    Parameters
    ----------
    joints : mapping
        {letter as mathtext: place}, one for each place.
    forces : mapping
        {field of the loads: symbol as mathtext}.
    words : mapping
        {field of the loads: what follows its symbol in a text}; empty for textbook letters.
    letters : mapping
        {joint: letter}; empty for textbook letters.

    """

    joints: Mapping[str, Array]
    forces: Mapping[str, str]
    words: Mapping[str, str]
    letters: Mapping[str, str]


def labels_of(diagram: Diagram) -> Labels:
    """Return the :class:`Labels` of a Diagram; letters it has already stay."""
    if all(map(LETTER.fullmatch, diagram.joints)):
        return Labels(diagram.joints, {name: f'F_{{{name[1:]}}}' for name in diagram.forces},
                      {}, {})
    size = max(np.ptp(np.array(list(diagram.joints.values())), axis=0))
    places: list[list[str]] = []
    for name, at in diagram.joints.items():
        for names in places:
            there = diagram.joints[names[0]]
            if hypot(at[0] - there[0], at[1] - there[1]) <= SAME * size:
                names.append(name)
                break
        else:
            places.append([name])
    letters = _letters()
    joints: dict[str, Array] = {}
    symbols: dict[str, str] = {}
    of_joints: dict[str, str] = {}
    for names in places:
        at = diagram.joints[names[0]]
        letter = 'O_1' if not joints and not at.any() else next(letters)
        joints[letter] = at
        of_joints.update(dict.fromkeys(names, letter))
        marks = [''] if len(names) == 1 else [str(i + 1) for i in range(len(names))]
        symbols.update((name, f'F_{{{letter.replace("_", "")}{mark}}}')
                       for name, mark in zip(names, marks))
    forces = {force: symbols[joint] for force, joint in diagram.forces.items()}
    return Labels(joints, forces, {force: force.replace('_', ' ') for force in forces},
                  of_joints)


def _letters() -> Iterator[str]:
    """Yield A, B, ... without O, which is a pivot's; then A_1, B_1, ..."""
    mark = 0
    while True:
        for letter in ascii_uppercase.replace('O', '').replace('F', ''):
            yield f'{letter}_{mark}' if mark else letter
        mark += 1
