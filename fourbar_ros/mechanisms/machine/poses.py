# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Curves of links in frames, put together as they are asked for.

A link that moves in a frame that moves, at the angle of the frame plus its own, e turned with the
frame, has

    (K1)  x = X + x_own e,   x' = X' + (x_own' + turn n x_own) e,
          x'' = X'' + (x_own'' + 2 turn n x_own' + bend n x_own - turn^2 x_own) e

with n the turn by +90 deg.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.mechanisms.machine.dyads import Curve, FIXED

Place = tuple[int, int]        # a link and the frame in which it is seen
# How a link slides: (its carrier, start and direction of the slide there).
Slide = tuple[int, tuple[Any, Any], tuple[Any, Any]]


def composed(frame: Curve, own: Curve) -> Curve:
    """Return the curve of a link from its own in a frame and that of the frame, (K1)."""
    x, y, dx, dy, ddx, ddy, c, s, d_angle, dd_angle = own
    x0, y0, dx0, dy0, ddx0, ddy0, cosine, sine, turn, bend = frame
    ddx, ddy = (ddx - 2.0 * turn * dy - bend * y - turn * turn * x,
                ddy + 2.0 * turn * dx + bend * x - turn * turn * y)
    dx, dy = dx - turn * y, dy + turn * x
    return (x0 + cosine * x - sine * y, y0 + sine * x + cosine * y,
            dx0 + cosine * dx - sine * dy, dy0 + sine * dx + cosine * dy,
            ddx0 + cosine * ddx - sine * ddy, ddy0 + sine * ddx + cosine * ddy,
            cosine * c - sine * s, sine * c + cosine * s, turn + d_angle, bend + dd_angle)


class Poses:
    """Curves of links in frames, as far as they are known."""

    def __init__(self, base_of: Callable[[int, int], int], driven: Curve) -> None:
        # (link, frame) -> the link by whose frame the curve is found
        self._base_of = base_of
        self.known: dict[Place, Curve] = {(1, 0): driven}
        self.pinned: set[Place] = set()
        self.carrying: set[Place] = set()       # (carrier, the link that slides in it)

    def of(self, link: int, frame: int) -> Curve:
        """Return the curve of a link in one of its frames."""
        if link == frame:
            return FIXED
        found = self.known.get((link, frame))
        if found is None:
            base = self._base_of(link, frame)
            found = composed(self.of(base, frame), self.known[link, base])
            self.known[link, frame] = found
        return found

    def pin(self, frame: int, link: int, arm: tuple[Any, Any], shared: int) -> None:
        """Take a link that is pinned to its frame, both known in a shared one."""
        *_, c0, s0, turn0, bend0 = self.of(frame, shared)
        *_, c, s, turn, bend = self.of(link, shared)
        self.known[link, frame] = (*arm, 0.0, 0.0, 0.0, 0.0, c0 * c + s0 * s, c0 * s - s0 * c,
                                   turn - turn0, bend - bend0)
        self.pinned.add((link, frame))

    def slide(self, link: int, slide: Slide, way: Sequence[Any]) -> None:
        """Take a link that slides in its carrier, and the carrier as seen from it."""
        (carrier, (x, y), (c, s)), (place, rate, change) = slide, way
        if (link, carrier) not in self.known:
            self.known[link, carrier] = (x + place * c, y + place * s, rate * c, rate * s,
                                         change * c, change * s, c, s, 0.0, 0.0)
        self.known[carrier, link] = (-(x * c + y * s) - place, x * s - y * c, -rate, 0.0,
                                     -change, 0.0, c, -s, 0.0, 0.0)
        self.carrying.add((carrier, link))
