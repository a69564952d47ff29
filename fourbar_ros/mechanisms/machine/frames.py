# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Frames: what links have in common cancels before it is computed.

A dyad between two links that are carried by a third one does not feel how that one moves. In
coordinates of the ground its rates are small differences of large ones. So each link has a
*frame*, the link from which its motion is simplest: that which carries its slide, or else the last
one that moves both links on which its dyad hangs. A dyad is solved in the last frame that both its
links have in common (:mod:`.poses`). Points P and Q of links that are pinned to each other are
compared along the arms from one to the other: what is between them does not contain where they
are. A bar on a link that may run to infinity is given a weighted D (:mod:`.far`).
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from operator import add
from typing import Any

from fourbar_ros.mechanisms.machine.description import PRP, RPP, RPR, RRP, RRR
from fourbar_ros.mechanisms.machine.dyads import (
    between,
    Curve,
    DyadMotion,
    Node,
    node_of,
    ORIGIN,
)
from fourbar_ros.mechanisms.machine.far_poses import FarPoses
from fourbar_ros.mechanisms.machine.layout import Layout, Stage
from fourbar_ros.mechanisms.machine.poses import Slide

# Of a link whose joint is that of another: (that link, place of its numbers that are the arm).
Anchor = tuple[int, tuple[Any, Any]]


def slides_of(stage: Stage, numbers: Sequence[Any]) -> list[tuple[int, Slide]]:
    """Return [(number of a link that slides, its :data:`Slide`)] in the order of the joints."""
    one, two = stage.number, stage.number + 1
    p, q, sizes = tuple(numbers[:2]), tuple(numbers[2:4]), tuple(numbers[4:])
    if stage.kind == RRP:
        return [(two, (stage.second, q, sizes[1:]))]
    if stage.kind == RPR:
        return [(one, (two, (0.0, sizes[0]), (1.0, 0.0)))]
    if stage.kind == RPP:
        return [(one, (two, (0.0, 0.0), sizes[2:])), (two, (stage.second, q, sizes[:2]))]
    if stage.kind == PRP:
        return [(one, (stage.first, p, sizes[:2])), (two, (stage.second, q, sizes[2:]))]
    return []


def anchors_of(stage: Stage, numbers: Sequence[Any]) -> dict[int, Anchor]:
    """Return the anchors of the links of a dyad: where on another link their first joint is."""
    one, two = stage.number, stage.number + 1
    at_p, at_q = (stage.first, tuple(numbers[:2])), (stage.second, tuple(numbers[2:4]))
    if stage.kind == PRP:
        return {two: (one, (0.0, 0.0))}
    second = {RRR: at_q, RPR: at_q, RRP: (one, (numbers[4], 0.0))}.get(stage.kind)
    return {one: at_p, **({two: second} if second else {})}


class Frames:
    """
    The frames of all links of a machine, and how the dyads hang in them.

    Parameters
    ----------
    layout, numbers
        As for :func:`.motion.make_motion`.

    """

    def __init__(self, layout: Layout, numbers: Sequence[Any]) -> None:
        # of each link but the ground: the link that carries it; in which it is solved
        self._frame, self._solved = {1: 0}, {1: 0}
        self._sliding: set[int] = set()
        self._slides = [slides_of(stage, own) for stage, own in zip(layout.stages, numbers)]
        # of each dyad: its links that are pinned to what it hangs on
        self._pins: list[dict[int, Anchor]] = []
        self._anchors: dict[int, Anchor] = {1: (0, (0.0, 0.0))} if layout.driver != 'slide' else {}
        self._work = []
        for stage, own, slides in zip(layout.stages, numbers, self._slides):
            frame, pair = self._frame_of(stage)
            carriers = {link: carrier for link, (carrier, _, _) in slides}
            self._sliding.update(carriers)
            for link in (stage.number, stage.number + 1):
                self._frame[link], self._solved[link] = carriers.get(link, frame), frame
            at_p, at_q = tuple(own[:2]), tuple(own[2:4])
            self._work.append((stage, frame, at_p, at_q,
                               None if pair else self._arms(stage, frame, at_p, at_q), pair))
            if self._is_pinned_to_carrier(stage, frame, pair):
                self._solved[stage.number] = stage.first
            anchors = anchors_of(stage, own)
            self._anchors.update(anchors)
            self._pins.append({} if stage.kind == PRP else anchors)

    def _frame_of(self, stage: Stage) -> tuple[int, Anchor | None]:
        """
        Return the frame of a dyad; between moving links that are pinned, one of these.

        Then also (the other, where on the frame its first joint is). Of a dyad that slides on a
        block and hangs on what carries that: the block, by which its direction is given.
        """
        frame = self.common(stage.first, stage.second)
        for parent, child in ((stage.first, stage.second), (stage.second, stage.first)):
            pinned, arm = self._anchors.get(child, (0, (0.0, 0.0)))
            if parent and pinned == parent and frame not in (parent, child):
                return parent, (child, arm)
            has_direction = stage.kind == PRP or (stage.kind in (RRP, RPP)
                                                  and parent == stage.second)
            if has_direction and parent in self._sliding and child == frame == (
                    self._frame[parent]):
                return parent, None
        return frame, None

    def _is_pinned_to_carrier(self, stage: Stage, frame: int, pair: Anchor | None) -> bool:
        """Return whether a dyad solved on a block has its first joint on what carries that."""
        return (pair is None and stage.kind in (RRP, RPP) and frame == stage.second
                and frame in self._sliding and self._frame[frame] == stage.first)

    def _up(self, link: int) -> Iterator[int]:
        """Yield a link, its frame, the frame of that, to the ground."""
        while link:
            yield link
            link = self._frame[link]
        yield 0

    def _path(self, link: int, arm: tuple[Any, Any]) -> list[Anchor]:
        """Return (link, arm) from a point on, joint by joint, as far as they are pinned."""
        found = [(link, arm)]
        while link in self._anchors:
            link, arm = self._anchors[link]
            found.append((link, arm))
        return found

    def _arms(self, stage: Stage, frame: int, at_p: Any,
              at_q: Any) -> list[tuple[Any, ...]] | None:
        """Return (link, along, across) of which D is the sum; None if P, Q meet in the frame."""
        from_p, from_q = self._path(stage.first, at_p), self._path(stage.second, at_q)
        links = [link for link, _ in from_p]
        common = next((link for link, _ in from_q if link in links), frame)
        if common in (frame, 0):
            return None
        i, j = links.index(common), [link for link, _ in from_q].index(common)
        (a, b), (c, d) = from_p[i][1], from_q[j][1]
        arms = [(common, c - a, d - b), *((link, *arm) for link, arm in from_q[:j]),
                *((link, -arm[0], -arm[1]) for link, arm in from_p[:i])]
        # from a carrier a rod may lead out of the frame
        return arms if all(frame in self._up(link) for link, *_ in arms) else None

    def common(self, one: int, other: int) -> int:
        """Return the last frame that two links have in common."""
        chain = list(self._up(one))
        return next(link for link in self._up(other) if link in chain)

    def base_of(self, link: int, frame: int) -> int:
        """Return the link by whose frame the curve of a link in a frame is found."""
        solved = self._solved[link]
        return solved if frame in self._up(solved) else self._frame[link]

    def begin(self, driven: Curve) -> FarPoses:
        """Return the curves that are known when that of the driven link is."""
        return FarPoses(self.base_of, driven)

    def hang(self, number: int, poses: FarPoses) -> tuple[Node, Node, Any, Curve, Curve]:
        """
        Return P, Q, D and the curves of the links they are of, in the frame of a dyad.

        D of a bar that hangs on a link that may run to infinity: as of :func:`.far.far_between`.
        """
        stage, frame, at_p, at_q, arms, pair = self._work[number]
        if pair:
            poses.pin(frame, *pair, self.common(frame, pair[0]))
        first, second = poses.of(stage.first, frame), poses.of(stage.second, frame)
        nodes = node_of(first, *at_p), node_of(second, *at_q)
        apart: Any
        if arms is None:
            bar = stage.kind == RPR and pair is None
            apart = (bar and poses.far_between(((stage.first, at_p), (stage.second, at_q)), nodes,
                                               frame)) or between(*nodes)
        else:
            apart = tuple([reduce(add, parts) for parts in zip(*[
                node_of((*ORIGIN, *poses.of(link, frame)[6:]), along, across)
                for link, along, across in arms])])
        hung = *nodes, apart, first, second
        if stage.kind == PRP:
            poses.run_far((stage.number, stage.number + 1), frame, hung, self._slides[number])
        return hung

    def add(self, number: int, poses: FarPoses, moved: DyadMotion) -> tuple[Curve, Curve]:
        """Take the curves of a dyad in its frame; return those on the ground."""
        stage, frame, at_p, *_ = self._work[number]
        one, two = stage.number, stage.number + 1
        poses.known[one, frame], poses.known[two, frame] = moved[:2]
        if self._solved[one] != frame:      # its joint does not feel how the block moves
            poses.pin(stage.first, one, at_p, frame)
        for k, (link, slide) in enumerate(self._slides[number]):
            poses.slide(link, slide, moved[2][3 * k:3 * k + 3])
        for link, pin in self._pins[number].items():
            poses.pin_far(link, pin, frame)
        return poses.of(one, 0), poses.of(two, 0)
