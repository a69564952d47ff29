# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What dynamics needs of a mechanism: curves along which its links move, and what acts on them."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.errors import MissingBodies
from fourbar_ros.mechanics.bodies import Applied, Body

# (x, y, x', y', x'', y'', cosine, sine, theta', theta'') of a link: a LinkMotion at unit rate and
# zero acceleration, so that its rates are derivatives with respect to the input.
Curve = Sequence[Any]
CurvesOf = Callable[[Any], Sequence[Curve]]
FIXED: Curve = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)      # of the ground


def loads_of_links(mechanism: Any) -> dict[str, tuple[Body, Applied]]:
    """Return {link: (body, what is applied to it)}; MissingBodies without masses."""
    if mechanism.bodies is None:
        raise MissingBodies
    return dict(mechanism.loads_of_links())


def curves_of(mechanism: Any, links: Sequence[str]) -> CurvesOf:
    """Return the function input -> curves of these links; of a float, or of an array of inputs."""
    motion_of, link_motion = mechanism.motion, mechanism.link_motion

    def curves(position: Any) -> Sequence[Curve]:
        motion = motion_of(position, 1.0, 0.0)
        return [link_motion(motion, link) for link in links]
    return curves
