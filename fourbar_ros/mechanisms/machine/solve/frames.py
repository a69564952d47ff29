# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Solve each dyad in the frame of the last link both sides share, so shared motion never enters.

In coordinates of the ground the rates of a dyad between two links on a third one are small
differences of large ones. So each link has a *frame*, the link from which its motion is simplest:
the one that carries its slide, or else the last one that moves both links on which its dyad hangs.
Points P and Q of links that are pinned to each other are
compared along the arms from one to the other: what is between them does not contain where they
are. Of links that are joined to each other one is the frame (:mod:`.pairs`).

A link that moves in a frame that moves, at the angle of the frame plus its own, e turned with the
frame, has

    (K1)  x = X + x_own e,   x' = X' + (x_own' + turn n x_own) e,
          x'' = X'' + (x_own'' + 2 turn n x_own' + bend n x_own - turn^2 x_own) e

with n the turn by +90 deg.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import reduce
from operator import add
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.machine.describe.description import (
    CYLINDER,
    Numbers,
    PRP,
    RPP,
    RRP,
)
from fourbar_ros.mechanisms.machine.describe.layout import Layout, Stage
from fourbar_ros.mechanisms.machine.solve.dyads import (
    between,
    Direction,
    Driven,
    DyadMotion,
    Node,
    ORIGIN,
)
from fourbar_ros.mechanisms.machine.solve.pairs import (
    anchors_of,
    FIRST_JOINT,
    Joints,
    other_of,
    Place,
    Slide,
    slides_of,
)
from fourbar_ros.mechanisms.points import Curve, FIXED, point_of
from fourbar_ros.numerics.number_types import Scalar

# Where the first joint of a link is pinned: (the link to which, along and across on that).
Anchor = tuple[int, tuple[Scalar, Scalar]]
Seen = tuple[int, int]        # a link and the frame in which it is seen


class Hanging(NamedTuple):
    """How a dyad hangs in its frame, the same in all poses."""

    stage: Stage
    frame: int          # number of the link in whose frame the dyad is solved
    at_p: Place         # of P on the link ``stage.first``
    at_q: Place         # of Q on the link ``stage.second``
    # (link, along, across) of the arms from P to Q; None: D is Q - P, or that of a pair
    arms: list[tuple[int, Scalar, Scalar]] | None
    pinned: Anchor | None       # link to pin in the frame first: (link, at)


def composed(frame: Curve, own: Curve) -> Curve:
    """
    Return the curve of a link from its ``own`` as seen in a frame and that of the frame, (K1).

    Place, direction and derivatives add up as of a body on a carrier that moves and turns.
    """
    x, y, dx, dy, ddx, ddy, c, s, d_angle, dd_angle = own
    x0, y0, dx0, dy0, ddx0, ddy0, cosine, sine, turn, bend = frame
    ddx, ddy = (ddx - 2.0 * turn * dy - bend * y - turn * turn * x,
                ddy + 2.0 * turn * dx + bend * x - turn * turn * y)
    dx, dy = dx - turn * y, dy + turn * x
    return (x0 + cosine * x - sine * y, y0 + sine * x + cosine * y,
            dx0 + cosine * dx - sine * dy, dy0 + sine * dx + cosine * dy,
            ddx0 + cosine * ddx - sine * ddy, ddy0 + sine * ddx + cosine * ddy,
            cosine * c - sine * s, sine * c + cosine * s, turn + d_angle, bend + dd_angle)


def seen_from(curves: Sequence[Curve], ground: int, still: Sequence[int]) -> list[Curve]:
    """
    Return curves as seen from link number ``ground``; the frame stands in its place.

    By (K1), with the motion of the frame inverse to that of the link. Links of the numbers
    ``still`` do not turn, exactly.
    """
    x, y, dx, dy, ddx, ddy, c, s, turn, bend = curves[ground]
    x, y, dx, dy, ddx, ddy, c, s, turn, bend = composed(
        (*ORIGIN, c, -s, -turn, -bend), (x, y, dx, dy, ddx, ddy, 1.0, 0.0, 0.0, 0.0))
    frame = (-x, -y, -dx, -dy, -ddx, -ddy, c, s, turn, bend)
    found = [frame if number == ground else composed(frame, curve)
             for number, curve in enumerate(curves)]
    for number in still:
        found[number] = (*found[number][:8], 0.0, 0.0)
    return found


class Poses:
    """
    What is known so far of one pose: the curves of links, each as seen in the frame of another.

    Links are numbers: 0 the ground, 1 the driven link, then those of the dyads in their order.
    """

    def __init__(self, base_of: Callable[[int, int], int], driven: Driven) -> None:
        """Start with the driven link, number 1 (see :class:`.Driven`), as the ground sees it."""
        # (link, frame) -> a third link, in which the first is known and which the frame knows
        self._base_of = base_of
        # {(link, frame): curve of the link seen in that frame}
        self.known: dict[Seen, Curve] = {(1, 0): driven.curve}
        # {(link, one it is pinned to): direction of the first seen from the second}
        self.relations: dict[Seen, Direction] = {}
        # {(link that slides, its carrier): slide, first and second derivative}
        self.ways: dict[Seen, Sequence[Scalar]] = {(1, 0): driven.way} if driven.way else {}
        self.of_cylinder = driven.of_cylinder

    def of(self, link: int, frame: int) -> Curve:
        """Return the curve of a link in one of its frames, composed from known ones if need be."""
        if link == frame:
            return FIXED
        if (link, frame) not in self.known:
            base = self._base_of(link, frame)
            self.known[link, frame] = composed(self.of(base, frame), self.known[link, base])
        return self.known[link, frame]

    def pin(self, frame: int, link: int, arm: tuple[Scalar, Scalar], shared: int) -> None:
        """
        Add the curve of a link in a frame to which its first joint is pinned, at ``arm`` there.

        Both are known in the frame ``shared``; only their directions matter, so no digit of the
        place is lost as it would be in a difference of places.
        """
        *_, c0, s0, turn0, bend0 = self.of(frame, shared)
        *_, c, s, turn, bend = self.of(link, shared)
        self.known[link, frame] = (*arm, 0.0, 0.0, 0.0, 0.0, c0 * c + s0 * s, c0 * s - s0 * c,
                                   turn - turn0, bend - bend0)

    def slide(self, link: int, slide: Slide, way: Sequence[Scalar]) -> None:
        """Add the curve of a link that slides in its carrier, and of the carrier seen from it."""
        (carrier, (x, y), (c, s)), (place, rate, change) = slide, way
        self.ways[link, carrier] = way
        if (link, carrier) not in self.known:
            self.known[link, carrier] = (x + place * c, y + place * s, rate * c, rate * s,
                                         change * c, change * s, c, s, 0.0, 0.0)
        self.known[carrier, link] = (-(x * c + y * s) - place, x * s - y * c, -rate, 0.0,
                                     -change, 0.0, c, -s, 0.0, 0.0)


class Frames:
    """
    The frames of all links of a machine, and how the dyads hang in them.

    Made once of layout and numbers (see :func:`.motion.make_motion`). In one pose :meth:`begin`
    starts with the driven link, :meth:`hang` gives what each dyad is solved from, :meth:`add`
    takes its links.
    """

    def __init__(self, layout: Layout, numbers: Sequence[Numbers]) -> None:
        """Choose the frame of each dyad, in their order, from the links and joints before it."""
        self._frame = {1: 0}        # {link: its frame, for a link that slides its carrier}
        self._solved = {1: 0}       # {link: the link in whose frame its dyad is solved}
        self._sliding: set[int] = set()             # links that slide in their carriers
        # of each dyad [(link that slides, its slide)]
        self._slides = [slides_of(stage, own) for stage, own in zip(layout.stages, numbers)]
        self._anchors: dict[int, Anchor] = {}       # {link: where its first joint is pinned}
        if layout.driver != 'slide':
            self._anchors[1] = 0, FIRST_JOINT
        self._joints = Joints(layout.driver)
        self._hangings: list[Hanging] = []
        for stage, own, slides in zip(layout.stages, numbers, self._slides):
            frame, pinned = (stage.pair.frame, None) if stage.pair else self._frame_of(stage)
            carriers = {link: carrier for link, (carrier, _, _) in slides}
            self._sliding.update(carriers)
            for link in (stage.number, stage.number + 1):
                self._frame[link], self._solved[link] = carriers.get(link, frame), frame
            arms = None if pinned or stage.pair else self._arms(stage, frame, own.p, own.q)
            self._hangings.append(Hanging(stage, frame, own.p, own.q, arms, pinned))
            if self._is_pinned_to_carrier(stage, frame, pinned):
                self._solved[stage.number] = stage.first
            self._anchors.update(anchors_of(stage, own))
            self._joints.add(stage, own)

    def _frame_of(self, stage: Stage) -> tuple[int, Anchor | None]:
        """
        Return the frame of a dyad, and what has to be pinned in that first, if anything.

        It is the last frame of both links on which the dyad hangs. Of moving links that are pinned
        to each other it is one of them; then also (the other, its first joint there). Of a dyad
        that slides on a block and hangs on what carries that it is the block, which gives its
        direction.
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

    def _is_pinned_to_carrier(self, stage: Stage, frame: int, pinned: Anchor | None) -> bool:
        """
        Return whether P of a dyad is on the link that carries its frame, a block or a crank.

        Its first link is then known in the frame of that carrier too, without the frame's motion.
        """
        if stage.pair:
            return stage.kind == RRP and stage.first in list(self._up(frame))[1:]
        return (pinned is None and stage.kind in (RRP, RPP) and frame == stage.second
                and frame in self._sliding and self._frame[frame] == stage.first)

    def _up(self, link: int) -> Iterator[int]:
        """Yield a link, its frame, the frame of that and so on down to the ground, 0."""
        while link:
            yield link
            link = self._frame[link]
        yield 0

    def _path(self, link: int, arm: tuple[Scalar, Scalar]) -> list[Anchor]:
        """
        Return the way down from a point: (link, place on it) of the point, then of pins.

        Each next one is where the first joint of the link before is pinned; a slide ends it.
        """
        found = [(link, arm)]
        while link in self._anchors:
            link, arm = self._anchors[link]
            found.append((link, arm))
        return found

    def _arms(self, stage: Stage, frame: int, at_p: Place,
              at_q: Place) -> list[tuple[int, Scalar, Scalar]] | None:
        """
        Return the arms (link, along, across) that lead from P to Q; their sum is D.

        They go from pin to pin over the last link that both have in common, so that its own motion
        is not in D. None if that is the frame: then Q - P has nothing to lose.
        """
        from_p, from_q = self._path(stage.first, at_p), self._path(stage.second, at_q)
        links = [link for link, _ in from_p]
        common = next((link for link, _ in from_q if link in links), frame)
        if common in (frame, 0):
            return None
        i, j = links.index(common), [link for link, _ in from_q].index(common)
        (p_along, p_across), (q_along, q_across) = from_p[i][1], from_q[j][1]
        arms = [(common, q_along - p_along, q_across - p_across),
                *((link, *arm) for link, arm in from_q[:j]),
                *((link, -arm[0], -arm[1]) for link, arm in from_p[:i])]
        # from a carrier a rod may lead out of the frame
        return arms if all(frame in self._up(link) for link, *_ in arms) else None

    def common(self, one: int, other: int) -> int:
        """Return the last frame that two links have in common."""
        chain = list(self._up(one))
        return next(link for link in self._up(other) if link in chain)

    def base_of(self, link: int, frame: int) -> int:
        """
        Return the link over which :meth:`Poses.of` composes the curve of a link in a frame.

        The frame in which its dyad was solved, if that moves in ``frame``, else its own frame.
        """
        solved = self._solved[link]
        return solved if frame in self._up(solved) else self._frame[link]

    def begin(self, driven: Driven) -> Poses:
        """Return the curves that are known when the driven link is."""
        return Poses(self.base_of, driven)

    def hang(self, number: int, poses: Poses) -> tuple[Node, Node, Any, Curve, Curve]:
        """
        Return P, Q, D = Q - P and the curves of the links on which a dyad hangs, in its frame.

        In place of D a pair gets its angle or slide, and a cylinder its drive.
        """
        stage, frame, at_p, at_q, arms, pinned = self._hangings[number]
        if stage.pair:
            return self._hang_pair(stage, poses, at_p, at_q)
        if pinned:
            link, arm = pinned
            poses.pin(frame, link, arm, self.common(frame, link))
        first, second = poses.of(stage.first, frame), poses.of(stage.second, frame)
        nodes = point_of(first, *at_p), point_of(second, *at_q)
        apart: Any
        if stage.name == CYLINDER:
            apart = poses.of_cylinder
        elif arms is None:
            apart = between(*nodes)
        else:
            apart = tuple([reduce(add, parts) for parts in zip(*[
                point_of((*ORIGIN, *poses.of(link, frame)[6:]), along, across)
                for link, along, across in arms])])
        return *nodes, apart, first, second

    def _hang_pair(self, stage: Stage, poses: Poses, at_p: Place,
                   at_q: Place) -> tuple[Node, Node, Any, Curve, Curve]:
        """Return what :meth:`hang` does, of a dyad between links that are joined to each other."""
        assert stage.pair is not None
        frame, other = stage.pair.frame, other_of(stage)
        way: Sequence[Scalar]
        if stage.pair.slides:
            way = poses.ways[other, frame]
        else:
            way = self.relation(other, frame, poses)
            if (other, frame) not in poses.known:
                on_other, on_frame = self._joints.pin(other, frame)
                about_pin = (*on_frame, 0.0, 0.0, 0.0, 0.0, *way)
                first_joint = (about_pin[:6] if on_other is FIRST_JOINT
                               else point_of(about_pin, -on_other[0], -on_other[1]))
                poses.known[other, frame] = (*first_joint, *way)
        first, second = poses.of(stage.first, frame), poses.of(stage.second, frame)
        return point_of(first, *at_p), point_of(second, *at_q), way, first, second

    def relation(self, link: int, other: int, poses: Poses) -> Direction:
        """Return the direction of a link, and its derivatives, seen from one it is pinned to."""
        for (one, two), is_inverse in (((link, other), False), ((other, link), True)):
            found = poses.relations.get((one, two)) or (
                (one, two) in poses.known and poses.known[one, two][6:])
            if found:
                c, s, turn, bend = found
                return (c, -s, -turn, -bend) if is_inverse else (c, s, turn, bend)
        frame = self.common(link, other)
        *_, c0, s0, turn0, bend0 = poses.of(other, frame)
        *_, c, s, turn, bend = poses.of(link, frame)
        return c0 * c + s0 * s, c0 * s - s0 * c, turn - turn0, bend - bend0

    def add(self, number: int, poses: Poses, moved: DyadMotion) -> tuple[Curve, Curve]:
        """Add to the poses how a dyad moved in its frame; return its links' curves in frame 0."""
        stage, frame, at_p, *_ = self._hangings[number]
        one, two = stage.number, stage.number + 1
        poses.known[one, frame], poses.known[two, frame] = moved.first, moved.second
        poses.relations.update(moved.relations)
        if self._solved[one] != frame:      # its joint does not feel how the block moves
            poses.pin(stage.first, one, at_p, frame)
        for k, (link, slide) in enumerate(self._slides[number]):
            poses.slide(link, slide, moved.slides[3 * k:3 * k + 3])
        return poses.of(one, 0), poses.of(two, 0)
