# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What dynamics needs of a mechanism: curves along which its links move, and what acts on them."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fourbar_ros.errors import MissingBodies
from fourbar_ros.mechanics.bodies import Applied, Body

# (x, y, x', y', x'', y'', cosine, sine, theta', theta'') of a link, as ``make_coefficients`` of a
# mechanism gives them.
Curve = Sequence[Any]
FIXED: Curve = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)      # of the ground


def loads_of_links(mechanism: Any) -> dict[str, tuple[Body, Applied]]:
    """Return {link: (body, what is applied to it)}; MissingBodies without masses."""
    if mechanism.bodies is None:
        raise MissingBodies
    return dict(mechanism.loads_of_links())
