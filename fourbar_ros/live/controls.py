# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The fields and sliders of a page: one for each parameter of the scene, from its one table."""
from __future__ import annotations

from collections.abc import Callable
from math import isnan
from typing import Any

from fourbar_ros.live.model import Shown
from fourbar_ros.live.owned import Field, Slider
from fourbar_ros.scene import parameters
from fourbar_ros.scene.parameter import Parameter
from nicegui import ui

GROUPS = {'linkage': 'Linkage', 'dyads': 'Dyads', 'drive': 'Input', 'gravity': 'Gravity',
          'bodies': 'Bodies', 'external': 'Loads from outside', 'points': 'Points'}
OPEN = ('linkage', 'dyads', 'drive')       # groups that are open at first
HIDDEN = ('external.timeout',)
OF_DRIVE = ('drive.speed',)                # of the drive, what a picture depends on
SPAN = 2.5                                 # sliders reach so many times the first value


def shown_parameters(shown: Shown) -> dict[str, list[Parameter]]:
    """Return {group: numbers of the scene that this mechanism has}."""
    links = {link.name for link in shown.linkage.LINKS} | {'rods'}
    found: dict[str, list[Parameter]] = {}
    for name, value in shown.scene.values.items():
        group, *rest = name.split('.')
        parameter = parameters.of_name(name)
        if (group not in GROUPS or name in HIDDEN or parameter.type not in ('double', 'integer')
                or (group == 'drive' and name not in OF_DRIVE)
                or (group in ('bodies', 'external') and rest[0] not in links)
                or (isnan(value) if isinstance(value, float) else False)
                or (group == 'linkage' and not _has(shown, rest[0]))):
            continue
        found.setdefault(group, []).append(parameter)
    return found


def _has(shown: Shown, name: str) -> bool:
    # a machine has a mode for each dyad
    return (name in shown.linkage.length_names
            or (name == 'mode' and not shown.scene.values.get('linkage.dyads')))


def build(shown: Shown, change: Callable[[str, Any], None]) -> dict[str, Any]:
    """
    Build the controls; return {name of the parameter: its field}.

    ``change(name, value)`` is called with each new value.
    """
    fields = {}
    for group, found in shown_parameters(shown).items():
        with ui.expansion(GROUPS[group], value=group in OPEN).classes('full-width').props(
                'dense expand-separator'):
            for parameter in found:
                fields[parameter.name] = _control(parameter, shown.scene.values[parameter.name],
                                                  shown, change)
    return fields


def _control(parameter: Parameter, value: Any, shown: Shown,
             change: Callable[[str, Any], None]) -> Any:
    """Build the control of one parameter: modes to choose, or a number with a slider."""
    name, text = parameter.name, parameter.text[0].upper() + parameter.text[1:]
    if name.endswith('.mode') and parameter.type == 'integer':
        modes = shown.linkage.modes if name == 'linkage.mode' else {1: '1', 2: '2'}
        with ui.row().classes('fb-middle full-width no-wrap'):
            dyad = name.split('.')[1] if name.startswith('dyads.') else ''
            ui.label(' '.join(filter(None, (dyad, 'assembly mode'))))
            return ui.toggle(modes, value=value, on_change=lambda event: change(
                name, event.value)).props(f'dense no-caps aria-label="{name}"').tooltip(text)
    unit = f' [{parameter.unit}]' if parameter.unit else ''
    low, high, step = _span(parameter, float(value), shown)
    with ui.row().classes('fb-middle full-width no-wrap fb-control'):
        field = Field(f'{name.split(".", 1)[1]}{unit}', value,
                      lambda event: change(name, event.value)).props(
            f'dense aria-label="{name}"').classes('fb-number').tooltip(text)
        slider = Slider(low, high, step, float(value)).props(
            f'aria-label="{name} slider"').classes('col')
        slider.on_value_change(lambda event: field.set_value(event.value)
                               if event.value != _clamped(field.value, low, high) else None)
        field.on_value_change(lambda event: slider.set_value(_clamped(event.value, low, high)))
    return field


def _clamped(value: Any, low: float, high: float) -> Any:
    return value if value is None else min(max(value, low), high)


def _span(parameter: Parameter, value: float, shown: Shown) -> tuple[float, float, float]:
    """Return (low, high, step) of a slider."""
    size = max(map(abs, shown.linkage.lengths)) if parameter.unit == 'm' else 1.0
    reach = SPAN * (abs(value) or size)
    low = -reach if value < 0.0 or value == 0.0 or parameter.unit == 'rad/s or m/s' else 0.0
    low = max(low, parameter.low) if parameter.low > -1e300 else low
    if parameter.positive or parameter.name.split('.')[-1] in ('mass', 'inertia'):
        low = max(low, 0.0)
    step = float(f'{(reach - low) / 500.0:.0e}')
    low = step if parameter.positive and low <= 0.0 else low
    return low, min(reach, parameter.high), step
