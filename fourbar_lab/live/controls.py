# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The controls of a page: a field and a slider beside it for each number of the scene."""
from __future__ import annotations

from collections.abc import Callable

from fourbar_lab.live.model import Shown
from fourbar_ros.errors import FourBarError
from fourbar_ros.scene import parameters
from fourbar_ros.scene.parameters import as_number, unit_in
from fourbar_ros.scene.settings import Parameter
from nicegui import ui
from nicegui.element import Element

GROUPS = {'linkage': 'Linkage', 'dyads': 'Dyads', 'drive': 'Input', 'gravity': 'Gravity',
          'bodies': 'Bodies', 'external': 'Loads from outside', 'points': 'Points'}
OPEN = ('linkage', 'dyads', 'drive')       # groups that are open at first
SPAN = 2.5                                 # sliders reach so many times the first value

OnChange = Callable[[str, float], None]       # takes a parameter's name and new value


def number_field(label: str, value: float, read: Callable[[str], float],
                 change: Callable[[float], None], name: str = '',
                 span: tuple[float, float, float] | None = None) -> ui.input:
    """
    Build a field for a number with or without a unit; it takes effect on Enter or on leaving it.

    ``read`` gives the number of a text, or raises FourBarError, whose words then stand below the
    text. An emptied field takes back what it had. ``name`` is the one for screen readers, by
    default the label; ``span``: low, high and step of a slider beside it. A typed number may lie
    beyond its ends: it then stands at an end.
    """
    def take(new: float) -> None:
        nonlocal value
        before, value = value, new
        typed.set_value(f'{value:.12g}')
        typed.error = None
        if slider:
            slider.set_value(value)
        if value != before:
            change(value)

    def take_text() -> None:
        text = typed.value.strip()
        try:
            take(read(text) if text not in ('', f'{value:.12g}') else value)
        except FourBarError as error:
            typed.error = str(error)

    typed: ui.input = ui.input(label, value=f'{value:.12g}').props(
        f'dense hide-bottom-space aria-label="{name or label}"').on('change', take_text)
    slider: ui.slider | None = None
    if span:
        low, high, step = span
        slider = ui.slider(min=low, max=high, step=step, value=value,
                           on_change=lambda event: take(float(event.value))).props(
            f'aria-label="{name} slider"').classes('col')
    return typed


def shown_parameters(shown: Shown) -> dict[str, list[Parameter]]:
    """Return {group: parameters that get controls}, in the order of GROUPS."""
    groups: dict[str, list[Parameter]] = {group: [] for group in GROUPS}
    for name, value in shown.scene.values.items():
        group, parameter = name.partition('.')[0], parameters.of_name(name)
        if (group in GROUPS and parameter.type in ('double', 'integer') and value == value
                and _has_effect(shown, *name.split('.'))):
            groups[group].append(parameter)
    return {group: members for group, members in groups.items() if members}


def _has_effect(shown: Shown, group: str, *rest: str) -> bool:
    """Return whether a page of this mechanism shows what a parameter of a group does."""
    if group == 'drive':
        return rest == ('speed',)
    if group in ('bodies', 'external'):
        return rest[0] in {'rods', *(link.name for link in shown.linkage.LINKS)}
    if group == 'linkage' and rest[0] not in shown.linkage.length_names:
        # a machine has a mode for each dyad instead
        return rest == ('mode',) and not shown.scene.values.get('linkage.dyads')
    return True


def build(shown: Shown, change: OnChange) -> None:
    """Build the controls; ``change(name, value)`` is called with each new value of the user."""
    for group, members in shown_parameters(shown).items():
        with ui.expansion(GROUPS[group], value=group in OPEN).classes('full-width').props(
                'dense expand-separator'):
            for parameter in members:
                with ui.row().classes('fb-middle full-width no-wrap fb-control'):
                    _control(parameter, shown, change)


def _control(parameter: Parameter, shown: Shown, change: OnChange) -> None:
    """Build the buttons of an assembly mode, or field and slider of a number; with a tooltip."""
    name, value = parameter.name, shown.scene.values[parameter.name]
    made: Element
    if name.endswith('.mode'):
        modes = shown.linkage.modes if name == 'linkage.mode' else {1: '1', 2: '2'}
        dyad = name.split('.')[1] if name.startswith('dyads.') else ''
        ui.label(f'{dyad} assembly mode'.strip())
        made = ui.toggle(dict(modes), value=value,
                         on_change=lambda event: change(name, event.value)).props(
            f'dense no-caps aria-label="{name}"')
    else:
        unit = unit_in(parameter, shown.scene.values)
        label = f'{name.split(".", 1)[1]}{f" [{unit}]" if unit else ""}'
        made = number_field(label, float(value), lambda text: as_number(name, text, unit),
                            lambda new: change(name, new), name,
                            _span(parameter, float(value), shown)).classes('fb-number')
    text = parameter.text.partition('; for the sliders')[0]         # a page has no docs
    with made:                          # on its right: below is the next one
        ui.tooltip(text[0].upper() + text[1:]).props(
            'anchor="center right" self="center left" :delay="400"')


def _span(parameter: Parameter, value: float, shown: Shown) -> tuple[float, float, float]:
    """
    Return (low, high, step) of the slider of a parameter with this value.

    It reaches :data:`SPAN` times the value, from zero or from as far below, within what the
    parameter allows. Of a zero, the longest link or 1 stands for the value.
    """
    size = max(map(abs, shown.linkage.lengths)) if parameter.unit == 'm' else 1.0
    reach = SPAN * (abs(value) if value != 0.0 else size)
    low = -reach if value <= 0.0 or parameter.unit == 'rad/s or m/s' else 0.0
    low = max(low, parameter.low) if parameter.low > -1e300 else low
    if parameter.positive or parameter.name.split('.')[-1] in ('mass', 'inertia'):
        low = max(low, 0.0)
    step = float(f'{(reach - low) / 500.0:.0e}')
    low = step if parameter.positive and low <= 0.0 else low
    return low, min(reach, parameter.high), step
