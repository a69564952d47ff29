# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What each dyad is solved from: where its ends are and the links it hangs on, as the ground sees it.

Of a dyad between links of which one slides in the other, that one is the frame, and so it is for
pairs (:mod:`.pairs`): the dyad moves by the relative slide or angle alone.

A link that moves in a frame that moves, at the angle of the frame plus its own, e turned with the
frame, has

    (K1)  x = X + x_own e,   x' = X' + (x_own' + turn n x_own) e,
          x'' = X'' + (x_own'' + 2 turn n x_own' + bend n x_own - turn^2 x_own) e

with n the turn by +90 deg.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.curves import FIXED, LinkMotion, point_of
from fourbar_ros.mechanisms.machine.solve.dyads import (
    between,
    Direction,
    Driven,
    DyadMotion,
    Node,
    ORIGIN,
)
from fourbar_ros.mechanisms.machine.solve.pairs import (
    FIRST_JOINT,
    KnownJoints,
    other_of,
    Place,
    Slide,
    slides_of,
)
from fourbar_ros.mechanisms.machine.structure import CYLINDER, Layout, Numbers, Stage
from fourbar_ros.numerics.number_types import Scalar


class Hanging(NamedTuple):
    """How a dyad hangs on the links before it, the same in all poses."""

    stage: Stage
    at_p: Place         # of P on the link ``stage.first``
    at_q: Place         # of Q on the link ``stage.second``
    frame: int          # number of the link from which it is seen
    # where its two links are joined: the pin on the one that moves in the frame, and on that, or
    # start and direction of the slide in the frame
    joint: tuple[Place, Place]
    is_joined_by_slide: bool
    slides: list[tuple[int, Slide]]      # of its own links: (link that slides, its slide)


def hangings(layout: Layout, numbers: Sequence[Numbers]) -> list[Hanging]:
    """Return how the dyads hang, in their order."""
    joints, found = KnownJoints(layout.driver), []
    for stage, own in zip(layout.stages, numbers):
        both = stage.first, stage.second
        links = next((link for link in (both, both[::-1]) if link in joints.slides), None)
        joint = joints.slides[links] if links else (FIRST_JOINT, FIRST_JOINT)
        if stage.pair and not links:
            joint = joints.pin(other_of(stage), stage.pair.frame)
        frame = stage.pair.frame if stage.pair else links[1] if links else 0
        found.append(Hanging(stage, own.p, own.q, frame, joint, links is not None,
                             slides_of(stage, own)))
        joints.add(stage, own)
    return found


def composed(frame: LinkMotion, own: LinkMotion) -> LinkMotion:
    """
    Return the curve of a link from its ``own`` as seen in a frame and that of the frame, (K1).

    Place, direction and derivatives add up as of a body on a carrier that moves and turns.
    """
    x, y, c, s = own.x, own.y, frame.cosine, frame.sine
    turn, bend = frame.omega, frame.alpha
    a_x, a_y = (own.a_x - 2.0 * turn * own.v_y - bend * y - turn * turn * x,
                own.a_y + 2.0 * turn * own.v_x + bend * x - turn * turn * y)
    v_x, v_y = own.v_x - turn * y, own.v_y + turn * x
    return LinkMotion(
        frame.x + c * x - s * y, frame.y + s * x + c * y,
        frame.v_x + c * v_x - s * v_y, frame.v_y + s * v_x + c * v_y,
        frame.a_x + c * a_x - s * a_y, frame.a_y + s * a_x + c * a_y,
        c * own.cosine - s * own.sine, s * own.cosine + c * own.sine,
        turn + own.omega, bend + own.alpha)


def seen_from(curves: Sequence[LinkMotion], ground: int, still: Sequence[int]) -> list[LinkMotion]:
    """
    Return curves as seen from link number ``ground``; the frame stands in its place.

    By (K1), with the motion of the frame inverse to that of the link. Links of the numbers
    ``still`` do not turn, exactly.
    """
    link = curves[ground]
    back = composed(LinkMotion(*ORIGIN, link.cosine, -link.sine, -link.omega, -link.alpha),
                    link._replace(cosine=1.0, sine=0.0, omega=0.0, alpha=0.0))
    frame = LinkMotion(-back.x, -back.y, -back.v_x, -back.v_y, -back.a_x, -back.a_y,
                       back.cosine, back.sine, back.omega, back.alpha)
    found = [frame if number == ground else composed(frame, curve)
             for number, curve in enumerate(curves)]
    for number in still:
        found[number] = found[number]._replace(omega=0.0, alpha=0.0)
    return found


class Poses:
    """
    What is known so far of one pose: the curves of links as the ground sees them.

    Links are numbers: 0 the ground, 1 the driven link, then those of the dyads in their order.
    """

    def __init__(self, hanging: Sequence[Hanging], driven: Driven) -> None:
        """Start with the driven link (see :class:`.Driven`)."""
        self._hanging, self._of_cylinder = hanging, driven.of_cylinder
        self._curves = [FIXED, driven.curve]
        # {(link, one it is pinned to): direction of the first seen from the second}
        self._relations: dict[tuple[int, int], Direction] = {}
        # {(link that slides, its carrier): slide, first and second derivative}
        self._slides: dict[tuple[int, int], Sequence[Scalar]] = (
            {(1, 0): driven.slide} if driven.slide else {})

    def hang(self, number: int) -> tuple[Node, Node, Any, LinkMotion, LinkMotion]:
        """
        Return P, Q, D = Q - P and the curves of the links on which a dyad hangs, in its frame.

        In place of D a pair gets its angle or slide, and a cylinder its drive.
        """
        hanging = self._hanging[number]
        stage, frame = hanging.stage, hanging.frame
        first, second, relative = self._curves[stage.first], self._curves[stage.second], None
        if frame or stage.pair:
            moving, relative = self._in_frame(hanging)
            first, second = (moving, FIXED) if stage.second == frame else (FIXED, moving)
        nodes = point_of(first, *hanging.at_p), point_of(second, *hanging.at_q)
        apart = (relative if stage.pair else self._of_cylinder if stage.name == CYLINDER
                 else between(*nodes))
        return *nodes, apart, first, second

    def _in_frame(self, hanging: Hanging) -> tuple[LinkMotion, Any]:
        """Return the curve of the other link of a dyad in its frame, and its angle or slide."""
        stage, frame = hanging.stage, hanging.frame
        other = stage.first if stage.second == frame else stage.second
        relative = (self._slides[other, frame] if hanging.is_joined_by_slide
                    else self.relation(other, frame))
        if not frame:
            return self._curves[other], relative
        if hanging.is_joined_by_slide:
            (x, y), (c, s) = hanging.joint
            place, rate, change = relative
            return LinkMotion(x + place * c, y + place * s, rate * c, rate * s, change * c,
                              change * s, c, s, 0.0, 0.0), relative
        (along, across), on_frame = hanging.joint
        about_pin = LinkMotion(*on_frame, 0.0, 0.0, 0.0, 0.0, *relative)
        if hanging.joint[0] is FIRST_JOINT:
            return about_pin, relative
        return LinkMotion(*point_of(about_pin, -along, -across), *relative), relative

    def relation(self, link: int, other: int) -> Direction:
        """Return the direction of a link, and its derivatives, seen from one it is pinned to."""
        known, ground = self._relations, 0
        if (link, other) in known:
            return known[link, other]
        if other == ground:
            return self._curves[link].turning
        if (other, link) in known or link == ground:
            c, s, turn, bend = known.get((other, link), self._curves[other].turning)
            return c, -s, -turn, -bend
        c0, s0, turn0, bend0 = self._curves[other].turning
        c, s, turn, bend = self._curves[link].turning
        return c0 * c + s0 * s, c0 * s - s0 * c, turn - turn0, bend - bend0

    def add(self, number: int, moved: DyadMotion) -> tuple[LinkMotion, LinkMotion]:
        """Add how a dyad moved in its frame; return its links' curves."""
        frame, slides = self._hanging[number].frame, self._hanging[number].slides
        curves = moved.first, moved.second
        if frame:
            curves = (composed(self._curves[frame], moved.first),
                      composed(self._curves[frame], moved.second))
        self._curves += curves
        self._relations.update(moved.relations)
        for k, (link, (carrier, _, _)) in enumerate(slides):
            self._slides[link, carrier] = moved.slides[3 * k:3 * k + 3]
        return curves
