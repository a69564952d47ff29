# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Fields and sliders that belong to their user while he types or moves them.

The server may set ``value`` at any time. The browser shows it when the control is not in use and
the server has answered all that its user did: so nothing that is on its way, however late,
overwrites what he does. ``ui.number`` and ``ui.slider`` show every value as it comes; on a page
that moves they take digits away while they are typed, and set a slider back to an older place.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui.elements.mixins.disableable_element import DisableableElement
from nicegui.elements.mixins.value_element import ValueElement

THROTTLE = 0.05         # [s] between two values of a slider that is moved


class Owned(ValueElement, DisableableElement):
    """
    A control whose browser counts what its user does, and whose server answers with the count.

    Parameters
    ----------
    value : float or None
        Number; None: empty.
    on_change : callable, optional
        Called with an event whose ``value`` is the new number.
    throttle : float
        Least time between two values from the browser; the last one always comes [s].

    """

    VALUE_PROP = 'value'

    def __init__(self, value: float | None, on_change: Callable[[Any], Any] | None = None,
                 throttle: float = 0.0):
        super().__init__(value=value, on_value_change=on_change)
        self._props['answered'] = 0
        self.on('commit', self._answer, [None], throttle=throttle)

    def _answer(self, event: Any) -> None:
        """Take what the user did; the browser learns it even if the value stays what it was."""
        value, asked = event.args
        self._props['answered'] = asked
        self.set_value(None if value in ('', None) else float(value))
        self.update()


class Field(Owned, component='field.js'):       # type: ignore[call-arg]
    """A number with a label; a typed one takes effect on Enter, an arrow key or leaving it."""

    def __init__(self, label: str, value: float | None, on_change: Callable[[Any], Any],
                 digits: int = 12):
        self._digits = digits
        super().__init__(value, on_change)
        self._props.update({'label': label, 'for': self.html_id})

    def _value_to_model_value(self, value: float | None) -> str:
        return '' if value is None else f'{value:.{self._digits}g}'


class Slider(Owned, component='slider.js'):     # type: ignore[call-arg]
    """A slider, whose values come while it is moved."""

    def __init__(self, low: float, high: float, step: float, value: float,
                 on_change: Callable[[Any], Any] | None = None):
        super().__init__(value, on_change, THROTTLE)
        self.set_range(low, high, step)

    def set_range(self, low: float, high: float, step: float) -> None:
        """Set ends and step as numbers: as texts they would be joined, not added."""
        self._props.update({'min': low, 'max': high, 'step': step})
