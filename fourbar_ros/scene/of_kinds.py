# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What all kinds of mechanisms together have.

Names and texts for parameters and topics, from the kinds.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fourbar_ros.mechanisms.described import find_link
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.parts import Link


class KnownLength(NamedTuple):
    """A length of any kind: text, whether it may be zero or negative, whether all have it."""

    text: str
    signed: bool
    is_in_all: bool


def _grouped(pairs: list[tuple[str, str]]) -> dict[str, list[str]]:
    """Return {text: kinds} of pairs (kind, text)."""
    found: dict[str, list[str]] = {}
    for kind, text in pairs:
        found.setdefault(text, []).append(kind)
    return found


def _lengths() -> dict[str, KnownLength]:
    """Return {name: :class:`KnownLength`}; a text that is not of every kind names its kinds."""
    found = {}
    for name in dict.fromkeys(length.name for kind in KINDS.values() for length in kind.LENGTHS):
        having = [(kind, length) for kind, its in KINDS.items() for length in its.LENGTHS
                  if length.name == name]
        texts = _grouped([(kind, length.text) for kind, length in having])
        is_in_all = len(having) == len(KINDS)
        text = next(iter(texts)) if is_in_all and len(texts) == 1 else '; '.join(
            f'{text} ({", ".join(kinds)})' for text, kinds in texts.items())
        found[name] = KnownLength(text, any(length.signed for _, length in having), is_in_all)
    return found


def _links(is_wanted: Callable[[Link], bool]) -> dict[str, str]:
    """Return {name of a link: its first joint, or joints by kind} of the links that are wanted."""
    found = {}
    for name in dict.fromkeys(link.name for kind in KINDS.values()
                              for link in filter(is_wanted, kind.LINKS)):
        joints = _grouped([(kind, find_link(its.LINKS, name).first_joint)
                           for kind, its in KINDS.items()
                           if name in [link.name for link in its.LINKS]])
        usual, *others = sorted(joints, key=lambda joint: -len(joints[joint]))
        found[name] = usual + ''.join(f' ({joint} of a {" or ".join(joints[joint])})'
                                      for joint in others)
    return found


LENGTHS = _lengths()
LINKS = _links(lambda link: True)                    # {name: first joint}
LOADED_LINKS = _links(lambda link: link.is_loadable)
INPUTS = tuple(dict.fromkeys(name for kind in KINDS.values() for name in kind.INPUTS))
KINDS_IN_WORDS = '; '.join(f'{kind.TEXT} ({name})' for name, kind in KINDS.items())
JOINTS_IN_WORDS = '; '.join(f'{", ".join(joint.name for joint in kind.JOINTS)} ({name})'
                            for name, kind in KINDS.items())
MORE_INPUTS_IN_WORDS = ' or '.join(name for name, kind in KINDS.items() if len(kind.INPUTS) > 1)
