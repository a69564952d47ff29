# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What each dyad is solved from: where its ends are and the links it hangs on, as the ground sees it.

Of a dyad between links of which one slides in the other, that one is the frame, and so it is for
pairs (:mod:`.pairs`): the dyad moves by the relative slide or angle alone.

A link that moves in a frame that moves, at the angle of the frame plus its own, e turned with the
frame, has

    (K1)  x = X + x_in e,   x' = X' + (x_in' + turn n x_in) e,
          x'' = X'' + (x_in'' + 2 turn n x_in' + bend n x_in - turn^2 x_in) e

with n the turn by +90 deg.

O1 = (0, 0) of the frame: the ground, or one of the two moving links between which the drive is,
and then all is seen from the ground at the end. The driven link is a crank about
O1, a slider on the x axis, or a crank that is turned by a cylinder of length s between a point Q
of the frame and a point of the crank, rho from O1. With b = |Q| and psi the angle of that point as
seen from O1, from Q on:

    (K2)  psi = pi + theta2,   psi' = theta2',   psi'' = theta2''   of the cylinder's triangle,
          (T1) to (T8) of :mod:`fourbar_ros.mechanisms.slides`, with b and rho for its sides
    (K3)  condition: d psi = ((rho^2 + b^2)/(rho b) + 2 |cos psi|) / |sin psi|

which gives its rod as well. The transmission angle of a cylinder is that of its rod and the arm
from O1 to its pin.
"""
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import cos, sin
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.curves import between, Direction, FIXED, LinkMotion, point_of
from fourbar_ros.mechanisms.machine.solve import dyads, pairs
from fourbar_ros.mechanisms.machine.solve.dyads import Driven, DyadMotion, Ends
from fourbar_ros.mechanisms.machine.solve.pairs import FIRST_JOINT, Joints, OnBoth, OnLink
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, Stage
from fourbar_ros.mechanisms.slides import triangle
from fourbar_ros.numerics.number_types import NumberType, Scalar, TINY


class Hanging(NamedTuple):
    """How a dyad hangs on the links before it and how it moves, the same in all poses."""

    stage: Stage
    at_p: OnLink         # of P on the link ``stage.first``
    at_q: OnLink         # of Q on the link ``stage.second``
    frame: int          # number of the link from which it is seen
    # where its two links are joined: the pin on the one that moves in the frame, and on that, or
    # start and direction of the slide in the frame
    joint: OnBoth
    is_joined_by_slide: bool
    slides: list[tuple[int, pairs.Slide]]      # of its links: (link that slides, its slide)
    motion: Callable[[Ends], DyadMotion]


def hangings(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
             signs: Sequence[Scalar]) -> list[Hanging]:
    """Return how the dyads hang, in their order."""
    # A pair has a motion of its own: the general form would lose digits. dyad_lengths: of each
    # dyad (shaped()); signs: its assembly mode as +-1.
    joints, hanging = Joints(layout.driver, layout.stages, dyad_lengths), []
    for stage, lengths, sign in zip(layout.stages, dyad_lengths, signs):
        both, pair = (stage.first, stage.second), stage.pair
        links = next((link for link in (both, both[::-1]) if link in joints.slides), None)
        joint = (joints.slides[links] if links else joints.pins[pair.moving, pair.frame] if pair
                 else (FIRST_JOINT, FIRST_JOINT))
        motion: Callable[[Ends], DyadMotion] = (
            pairs.rod_of_cylinder if stage.name == CYLINDER else
            partial(pairs.PAIRS[stage.kind, pair.slides], n, sign, stage, pair, lengths)
            if pair else
            partial(dyads.DYADS[stage.kind], n, sign, lengths.sizes))
        hanging.append(Hanging(
            stage, lengths.p, lengths.q, pair.frame if pair else links[1] if links else 0, joint,
            links is not None, pairs.slides_of(stage, lengths), motion))
    return hanging


def composed(frame: LinkMotion, inner: LinkMotion) -> LinkMotion:
    """Return the curve of a link from its ``inner`` one, in a frame, and of the frame, (K1)."""
    x, y, c, s = inner.x, inner.y, frame.cosine, frame.sine
    turn, bend = frame.omega, frame.alpha
    a_x, a_y = (inner.a_x - 2.0 * turn * inner.v_y - bend * y - turn * turn * x,
                inner.a_y + 2.0 * turn * inner.v_x + bend * x - turn * turn * y)
    v_x, v_y = inner.v_x - turn * y, inner.v_y + turn * x
    return LinkMotion(
        frame.x + c * x - s * y, frame.y + s * x + c * y,
        frame.v_x + c * v_x - s * v_y, frame.v_y + s * v_x + c * v_y,
        frame.a_x + c * a_x - s * a_y, frame.a_y + s * a_x + c * a_y,
        c * inner.cosine - s * inner.sine, s * inner.cosine + c * inner.sine,
        turn + inner.omega, bend + inner.alpha)


def pinned(on_link: OnLink, on_carrier: OnLink, turning: Direction) -> LinkMotion:
    """Return the curve of a link that is pinned to a carrier, as that sees it."""
    about_pin = LinkMotion(*on_carrier, 0.0, 0.0, 0.0, 0.0, *turning)
    if on_link is FIRST_JOINT:
        return about_pin
    along, across = on_link
    return LinkMotion(*point_of(about_pin, -along, -across), *turning)


def slid(start: OnLink, direction: OnLink, slide: Sequence[Scalar]) -> LinkMotion:
    """Return the curve of a link that slides on a carrier, as that sees it."""
    (x, y), (c, s), (position, rate, change) = start, direction, slide
    return LinkMotion(x + position * c, y + position * s, rate * c, rate * s, change * c,
                      change * s, c, s, 0.0, 0.0)


def driven_crank(n: NumberType, angle: Scalar, seam: float | None = None) -> Driven:
    """Return a crank about the origin, by half its angle, the input; ``seam``: of its layout."""
    c, s = n.cos(0.5 * angle), n.sin(0.5 * angle)
    if seam is not None:        # half the angle beyond the seam is from 0 to pi
        turn = n.where((s * cos(0.5 * seam) - c * sin(0.5 * seam)).real < 0.0, -1.0, 1.0)
        c, s = turn * c, turn * s
    curve = LinkMotion(*dyads.ORIGIN, (c - s) * (c + s), 2.0 * (s * c), 1.0, 0.0)
    return Driven(curve, (0.0, 0.0), (c, s))


def driven_slider(x: Scalar, height: Scalar = 0.0) -> Driven:
    """Return a slider at x, the input, on a line at a height."""
    curve = LinkMotion(x, height, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    return Driven(curve, (0.0, 0.0), slide=(x, 1.0, 0.0))


def driven_link(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                signs: Sequence[Scalar], x: Scalar) -> Driven:
    """Return the driven link at an input: a crank, a slider on the x axis, or with a cylinder."""
    if layout.driver == CYLINDER:
        return crank_with_cylinder(n, signs[0], dyad_lengths[0], x)
    if layout.driver == 'slide':
        return driven_slider(x)
    return driven_crank(n, x, layout.seam)


def crank_with_cylinder(n: NumberType, sign: Scalar, lengths: DyadLengths, s: Scalar) -> Driven:
    """Return the crank, and the rod, at a length s of the cylinder that turns it [m], by (K2)."""
    # sign: of the sine of the angle from O1-base to O1-pin; lengths: pin on the crank, base on the
    # frame, their distances from O1 for shape.
    (along, across), (base_x, base_y), (rho, b) = lengths.p, lengths.q, lengths.shape
    per, per_rho, per_b = 1.0 / n.power_of_two(rho, b), 1.0 / rho, 1.0 / b
    of_pin = along * per_rho, -across * per_rho         # turned back from the crank
    of_base = -base_x * per_b, -base_y * per_b          # from the base to O1
    root = n.sqrt(s)        # refuses a length below zero: root - root is 0, or in arrays NaN
    # angles as cosine, sine, first and second derivative: x of the base seen along the cylinder,
    # theta2 from there to the crank; the transmission angle is that of b
    (cos_x, sin_x, d_x, dd_x), (cos_b, sin_b, *_), (cos_2, sin_2, d_2, dd_2) = triangle(
        n, b * per, rho * per, 0.0, -sign, (s + (root - root)) * per)                      # (K2)
    crank = pairs.turned_by(pairs.turned_by((cos_2, sin_2), of_base), of_pin)
    rod = pairs.turned_by((cos_x, -sin_x), of_base)
    # Half the angle of the crank, without a jump in its range, in which psi is on one side of the
    # base line: half its angle where psi = +-pi/2, and half of how far psi is from there.
    (x, y), z = pairs.turned_by(of_base, of_pin), sign * sin_2
    middle = pairs.half_angle(n, sign * y, -sign * x, False)
    beyond = pairs.half_angle(n, -z, sign * cos_2, False)
    half = pairs.turned_by((middle.cosine, middle.sine), (beyond.cosine, beyond.sine))
    error = (rho / b + b / rho + 2.0 * n.fabs(cos_2)) / (n.fabs(sin_2) + TINY)           # (K3)
    square = per * per
    return Driven(LinkMotion(*dyads.ORIGIN, *crank, d_2 * per, dd_2 * square), (0.0, error), half,
                  of_cylinder=(s, (*rod, -d_x * per, -dd_x * square), -sin_b, cos_b))


class Poses:
    """What is known so far of a pose: the curves of links as the frame sees them, the dyads."""

    # Links have indices: 0 the frame, 1 the driven link, then those of the dyads in their order.
    # Dyads are added in any order in which each comes after those that carry it.

    def __init__(self, hanging: Sequence[Hanging], driven: Driven) -> None:
        self._hanging, self._of_cylinder, self._half = hanging, driven.of_cylinder, driven.half
        self.curves, self.dyads = {0: FIXED, 1: driven.curve}, dict[int, DyadMotion]()
        # {(link, frame or link it is pinned to): direction of the first seen from the second}
        self._relations: dict[tuple[int, int], Direction] = {(1, 0): driven.curve[6:]}
        # {(link that slides, its carrier): slide, first and second derivative}
        self._slides: dict[tuple[int, int], Sequence[Scalar]] = (
            {(1, 0): driven.slide} if driven.slide else {})

    def ends(self, index: int) -> Ends:
        """Return the ends of a dyad and the links that carry them, in its frame."""
        hanging = self._hanging[index]
        stage, frame, half = hanging.stage, hanging.frame, None
        relative: Any = None
        first, second = self.curves[stage.first], self.curves[stage.second]
        if frame or stage.pair:
            link = stage.first if stage.second == frame else stage.second
            relative = (self._slides[link, frame] if hanging.is_joined_by_slide
                        else self.relation(link, frame))
            curve_of = slid if hanging.is_joined_by_slide else pinned
            moving = curve_of(*hanging.joint, relative) if frame else self.curves[link]
            first, second = (moving, FIXED) if stage.second == frame else (FIXED, moving)
        p, q = point_of(first, *hanging.at_p), point_of(second, *hanging.at_q)
        if stage.pair:
            if self._half and {stage.first, stage.second} == {0, 1}:
                c, s = self._half
                half = (c, s) if stage.pair.moving == 1 else (c, -s)
            return Ends(p, q, None, relative, half, first, second)
        if stage.name == CYLINDER:
            return Ends(p, q, None, self._of_cylinder, None, first, second)
        return Ends(p, q, between(p, q), None, None, first, second)

    def relation(self, link: int, seen_from: int) -> Direction:
        """Return the direction of a link, with derivatives, seen from a link it is pinned to."""
        known = self._relations
        if (link, seen_from) in known:
            return known[link, seen_from]
        if (seen_from, link) in known:
            c, s, turn, bend = known[seen_from, link]
            return c, -s, -turn, -bend
        c0, s0, turn0, bend0 = self.curves[seen_from][6:]
        c, s, turn, bend = self.curves[link][6:]
        return c0 * c + s0 * s, c0 * s - s0 * c, turn - turn0, bend - bend0

    def carry(self, index: int) -> Ends:
        """Add the dyads on which one hangs, directly or not, and return its ends."""
        pending = [index]
        while pending:
            stage = self._hanging[pending[-1]].stage
            carriers = [link // 2 - 1 for link in (stage.first, stage.second)
                        if link not in self.curves]
            if carriers:
                pending += carriers
            elif (dyad := pending.pop()) != index and dyad not in self.dyads:
                self.add(dyad)
        return self.ends(index)

    def add(self, index: int, moved: DyadMotion | None = None) -> tuple[LinkMotion, LinkMotion]:
        """Add a dyad, or how it moved in its frame; return its links' curves."""
        moved = self._hanging[index].motion(self.ends(index)) if moved is None else moved
        frame, slides = self._hanging[index].frame, self._hanging[index].slides
        curves = moved.first, moved.second
        if frame:
            curves = (composed(self.curves[frame], moved.first),
                      composed(self.curves[frame], moved.second))
        self.dyads[index] = moved
        self._relations |= {(2 * index + 2, 0): curves[0][6:], (2 * index + 3, 0): curves[1][6:],
                            **moved.relations}
        for k, (link, (carrier, _, _)) in enumerate(slides):
            self._slides[link, carrier] = moved.slides[3 * k:3 * k + 3]
        # last, as another thread takes a dyad with curves for one that has been added
        self.curves.update(zip((2 * index + 2, 2 * index + 3), curves))
        return curves

    def seen_from(self, ground: int, joints: Joints) -> list[LinkMotion]:
        """Return all curves as the link ``ground`` sees them: it and the frame swap indices."""
        # From the ground outward, each link as one that it is joined to sees it: differences of
        # what the frame sees would lose digits of small loads, all of them next to a toggle.
        seen, reached = {ground: FIXED}, [ground]
        for carrier in reached:         # which grows
            for link, curve in self._joined_to(carrier, joints):
                if link not in seen:
                    seen[link] = composed(seen[carrier], curve)
                    reached.append(link)
        seen[0], seen[ground] = seen[ground], seen[0]
        return [seen[link] for link in range(len(self.curves))]

    def _joined_to(self, link: int, joints: Joints) -> Iterator[tuple[int, LinkMotion]]:
        """Yield (index, curve as ``link`` sees it) of the links that are joined to it."""
        for (neighbour, of_pin), (there, here) in joints.pins.items():
            if of_pin == link:
                yield neighbour, pinned(there, here, self.relation(neighbour, link))
        for pair, (start, (c, s)) in joints.slides.items():
            if pair[1] == link:
                yield pair[0], slid(start, (c, s), self._slides[pair])
            elif pair[0] == link:
                curve = slid(start, (c, s), self._slides[pair])     # and back
                vectors = [-value for k in (0, 2, 4) for value in (
                    c * curve[k] + s * curve[k + 1], c * curve[k + 1] - s * curve[k])]
                yield pair[1], LinkMotion._make((*vectors, c, -s, 0.0, 0.0))


def pose_of(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
            signs: Sequence[Scalar], driven: Driven) -> Poses:
    """Return the pose of a machine from its driven link, dyad by dyad; see :func:`hangings`."""
    pose = Poses(hangings(n, layout, dyad_lengths, signs), driven)
    for i in range(len(layout.stages)):
        pose.add(i)
    return pose
