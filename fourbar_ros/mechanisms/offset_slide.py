# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What both slider-cranks state alike: a crank, another length, a slide at an offset."""
from __future__ import annotations

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.contract import CRANK, of_geometry, SLIDE
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import THETA1, TRAVEL
from fourbar_ros.mechanisms.slide_dyad import closes, margins, SliderLoads


class OffsetSlide(Mechanism):
    """Base of the kinds whose three lengths make the triangle of :mod:`.slide_dyad`."""

    INPUTS = {CRANK: THETA1, SLIDE: TRAVEL}
    LOADS = SliderLoads
    MARGIN_SIGNS = ((-1, 1, -1), (1, -1, -1))

    def __post_init__(self) -> None:
        self._check()
        if not closes(*self.lengths):
            one, other, _ = self.length_names
            raise InvalidParameter('offset', self.lengths[2], 'the links cannot close: it must be '
                                   f'shorter than {one} + {other} '
                                   f'({self.lengths[0] + self.lengths[1]!r})')
        self._check_stroke()

    @of_geometry
    def margins(self) -> tuple[float, ...]:
        """Return r - p - |e| and p - r - |e| [m] of the lengths p, r and e."""
        return margins(*self.lengths)
