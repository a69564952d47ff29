# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One scene in the assembly modes that its motion takes, as through toggles."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fourbar_ros.pipeline.message_fields import mode_number
from fourbar_ros.pipeline.stepper import Stepper


class InModes:
    """
    A :class:`~fourbar_ros.pipeline.stepper.Stepper` for each mode, made when it is needed.

    Parameters
    ----------
    scene : Scene
    acting : dict, optional
        As of a stepper.

    """

    def __init__(self, scene: Any, acting: Any = None) -> None:
        self._scene, self.own_mode = scene, mode_number(scene.linkage)
        self._own = Stepper(scene, acting)
        self._all = {self.own_mode: self._own}

    @property
    def acting(self) -> dict[str, Any]:
        """Return the Wrench on each link that a topic loads."""
        return self._own.acting

    def act(self, link: str, wrench: Any) -> None:
        """Apply a Wrench to a link from the next step on."""
        for stepper in self._all.values():
            stepper.act(link, wrench)

    def prepare(self, modes: Iterable[int]) -> None:
        """Make the steppers of modes that may come."""
        for mode in modes:
            if mode not in self._all:
                self._all[mode] = Stepper(self._scene.taken_in(mode), self.acting)

    def step(self, mode: int, *given: Any) -> Any:
        """Return (status, values) of a Stepper in a mode, by its number in messages."""
        if mode not in self._all:
            self.prepare([mode])
        return self._all[mode].step(*given)

    def silence(self) -> tuple[float, ...]:
        """Return the values during a timeout."""
        return self._own.silence()
