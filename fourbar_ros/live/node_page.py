# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The page of a running node: it follows the node's topics and sets the node's parameters."""
from __future__ import annotations

from asyncio import Lock
from typing import Any

from fourbar_ros.live.course import OfNode
from fourbar_ros.live.page import Page
from fourbar_ros.ros.clients.watched import Watched
from nicegui import run

FASTER = 1.2            # ... than what the pictures have room for


class NodePage(Page):
    """A page whose scene and motion are those of a node."""

    def __init__(self, watched: Watched, query: dict[str, str]):
        super().__init__(watched.node, watched.values, {},
                         lambda shown: OfNode(shown, watched.latest))
        self.watched, self.version = watched, watched.version
        self._one_by_one = Lock()

    def build(self) -> None:
        """Build the elements of the page; it moves at once."""
        super().build()
        self.timer.activate()
        self.elements.play.set_visibility(False)
        self.elements.slider.disable()
        self.elements.field.disable()

    async def change(self, name: str, value: Any) -> None:
        """Set a parameter of the node; what it refuses is shown, and holds for none."""
        if value is None:
            return
        # sliders that yield whole numbers mean doubles
        value = float(value) if isinstance(self.values.get(name), float) else value
        async with self._one_by_one:         # the last that was typed is the last that is set
            self.problem = await run.io_bound(self.watched.set, name, value)

    def _advance(self) -> None:
        if self.version != self.watched.version:
            self.version, self.values = self.watched.version, self.watched.values
            self.rebuild(keep_problem=True)
        elif abs(self.course.speed or 0.0) > FASTER * abs(self.shown.rate):
            self.rebuild(keep_problem=True)              # else arrows would leave the picture
        super()._advance()

    def _remember(self) -> None:
        """Leave the address alone: the state is the node's."""
