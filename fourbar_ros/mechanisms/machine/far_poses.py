# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Weighted curves of links that may run to infinity (:mod:`.far`), in frames.

Found only where a bar hangs on such a link: what else a machine does, does not need them.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

from fourbar_ros.mechanisms.machine.dyads import Curve, Node, ORIGIN, turned
from fourbar_ros.mechanisms.machine.far import (
    far_between,
    far_node,
    far_pin,
    far_slide,
    Jet,
    moved_by,
    weighed,
    weight_of,
    Weighted,
)
from fourbar_ros.mechanisms.machine.poses import composed, Place, Poses, Slide

Pin = tuple[int, tuple[Any, Any]]      # a link, and a point of it: along, across


class FarPoses(Poses):
    """Curves of links in frames, weighted ones too."""

    def __init__(self, base_of: Callable[[int, int], int], driven: Curve) -> None:
        super().__init__(base_of, driven)
        self._makers: dict[Place, Callable[[], Weighted | None]] = {}

    def far_of(self, link: int, frame: int) -> Weighted | None:
        """Return the weighted curve of a link in a frame where it may run to infinity, or None."""
        if link == frame or not self._makers or (link, frame) in self.pinned:
            return None
        if (link, frame) in self._makers:
            return self._makers[link, frame]()
        if (link, frame) in self.carrying:      # of a slide that does not run to infinity
            return None
        base = self._base_of(link, frame)
        if base == frame:
            return None
        outer, inner = self.far_of(base, frame), self.far_of(link, base)
        if outer and not inner:
            *arm, _, _, _, _ = own = composed((*ORIGIN, *outer.curve[6:]), self.known[link, base])
            place = moved_by(outer.curve[:6], weighed(tuple(arm), outer.weight))
            return Weighted((*place, *own[6:]), outer.weight)
        if inner and not outer:
            begin = self.of(base, frame)
            own = composed((*ORIGIN, *begin[6:]), inner.curve)
            place = moved_by(own[:6], weighed(begin[:6], inner.weight))
            return Weighted((*place, *own[6:]), inner.weight)
        return None

    def far_between(self, ends: tuple[Pin, Pin], nodes: tuple[Node, Node],
                    frame: int) -> tuple[Any, ...] | None:
        """Return the weighted D of two points, given by their links too; None if both are near."""
        links = [self.far_of(link, frame) for link, _ in ends]
        if not any(links):
            return None
        (at_p, at_q), (one, two) = [far_node(link, *at) if link else node for link, (_, at), node
                                    in zip(links, ends, nodes)], links
        return far_between(at_p, at_q, one and one.weight, two and two.weight)

    def run_far(self, links: Place, frame: int, hung: tuple[Node, Node, Node, Curve, Curve],
                slides: Sequence[tuple[int, Slide]]) -> None:
        """Take the links of a dyad PRP, hung in a frame, as running to infinity."""
        at_p, _, apart, *carriers = hung
        directions: list[Curve] = [(*ORIGIN, *turned(carrier, *way)) for carrier, (_, (_, _, way))
                                   in zip(carriers, slides)]

        @cache
        def weight() -> Jet:
            return weight_of(*directions)

        def way_of(k: int) -> Jet:
            return far_slide(apart, directions[1 - k])

        def pin(k: int) -> Weighted:
            place = far_pin(at_p, way_of(0), directions[0], weight())
            return Weighted((*place, *directions[k][6:]), weight())

        def slid(k: int, seen: Callable[..., Weighted]) -> Weighted:
            return seen(way_of(k), weight(), *slides[k][1][1:])

        for k, link in enumerate(links):
            carrier = slides[k][1][0]
            self._makers[carrier, link] = cache(lambda k=k: slid(k, carrier_from_slide))
            self._makers[link, carrier] = cache(lambda k=k: slid(k, slide_on_carrier))
            self._makers[link, frame] = cache(lambda k=k: pin(k))

    def pin_far(self, link: int, pin: Pin, frame: int) -> None:
        """Take a link of a dyad as running to infinity with the link to which it is pinned."""
        if not self._makers:
            return

        @cache
        def pinned() -> Weighted | None:
            parent = self.far_of(pin[0], frame)
            if parent is None:
                return None
            return Weighted((*far_node(parent, *pin[1]), *self.known[link, frame][6:]),
                            parent.weight)
        self._makers[link, frame] = pinned


def slide_on_carrier(way: Jet, weight: Jet, start: tuple[Any, Any],
                     direction: tuple[Any, Any]) -> Weighted:
    """Return the weighted curve of a link that slides, as seen from what carries it."""
    (c, s), fixed = direction, weighed((*start, 0.0, 0.0, 0.0, 0.0), weight)
    moving = (way[0] * c, way[0] * s, way[1] * c, way[1] * s, way[2] * c, way[2] * s)
    return Weighted((*moved_by(fixed, moving), c, s, 0.0, 0.0), weight)


def carrier_from_slide(way: Jet, weight: Jet, start: tuple[Any, Any],
                       direction: tuple[Any, Any]) -> Weighted:
    """Return the weighted curve of what carries a link, as seen from the link."""
    (x, y), (c, s) = start, direction
    fixed = weighed((-(x * c + y * s), x * s - y * c, 0.0, 0.0, 0.0, 0.0), weight)
    return Weighted((*moved_by(fixed, (-way[0], 0.0, -way[1], 0.0, -way[2], 0.0)), c, -s, 0.0,
                     0.0), weight)
