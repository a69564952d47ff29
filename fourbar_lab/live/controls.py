# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The controls of a page: a field and a slider beside it for each number of the scene."""
from __future__ import annotations

from collections.abc import Callable

from fourbar_lab.live.model import Shown
from fourbar_ros.scene import parameters
from fourbar_ros.scene.settings import Parameter
from nicegui import ui

GROUPS = {'linkage': 'Linkage', 'dyads': 'Dyads', 'drive': 'Input', 'gravity': 'Gravity',
          'bodies': 'Bodies', 'external': 'Loads from outside', 'points': 'Points'}
OPEN = ('linkage', 'dyads', 'drive')       # groups that are open at first
SPAN = 2.5                                 # sliders reach so many times the first value

OnChange = Callable[[str, float], None]       # takes a parameter's name and new value


def field(label: str, value: float, take: Callable[[float], None], name: str = '') -> ui.number:
    """
    Build a field for a number with a label: a typed one takes effect on Enter or leaving it.

    ``name`` is the one for screen readers, by default the label.
    """
    def commit() -> None:
        nonlocal value
        if made.value is None:              # emptied, or no number
            made.set_value(value)
        elif made.value != value:
            value = float(made.value)
            take(value)

    made = ui.number(label, value=value, format='%.12g').props(
        f'dense step=any aria-label="{name or label}"').on('keydown.enter', commit).on(
        'blur', commit)
    return made


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
                is_choice = parameter.name.endswith('.mode') and parameter.type == 'integer'
                with ui.row().classes('fb-middle full-width no-wrap fb-control'):
                    if is_choice:
                        _choice(parameter, shown, change)
                    else:
                        _number(parameter, shown, change)


def _tooltip(parameter: Parameter) -> None:
    """Add the text of a parameter to its control, on its right: below is the next one."""
    text = parameter.text.partition('; for the sliders')[0]         # a page has no docs
    ui.tooltip(text[0].upper() + text[1:]).props(
        'anchor="center right" self="center left" :delay="400"')


def _choice(parameter: Parameter, shown: Shown, change: OnChange) -> None:
    """Build the buttons of an assembly mode."""
    name = parameter.name
    modes = shown.linkage.modes if name == 'linkage.mode' else {1: '1', 2: '2'}
    dyad = name.split('.')[1] if name.startswith('dyads.') else ''
    ui.label(' '.join(filter(None, (dyad, 'assembly mode'))))
    with ui.toggle(dict(modes), value=shown.scene.values[name],
                   on_change=lambda event: change(name, event.value)).props(
            f'dense no-caps aria-label="{name}"'):
        _tooltip(parameter)


def _number(parameter: Parameter, shown: Shown, change: OnChange) -> None:
    """
    Build a field for a number and a slider beside it.

    A typed number may lie beyond the ends of the slider, which then stands at an end.
    """
    name, value = parameter.name, float(shown.scene.values[parameter.name])
    low, high, step = _span(parameter, value, shown)

    def take(new: float) -> None:
        nonlocal value
        if new != value:
            value = new
            slider.set_value(min(max(new, low), high))
            change(name, new)

    def move(new: float) -> None:
        if new != min(max(value, low), high):           # not what take has just set
            typed.set_value(new)
            take(new)

    unit = f' [{parameter.unit}]' if parameter.unit else ''
    typed = field(f'{name.split(".", 1)[1]}{unit}', value, take, name).classes('fb-number')
    with typed:
        _tooltip(parameter)
    slider = ui.slider(min=low, max=high, step=step, value=min(max(value, low), high),
                       on_change=lambda event: move(float(event.value))).props(
        f'aria-label="{name} slider"').classes('col')


def _span(parameter: Parameter, value: float, shown: Shown) -> tuple[float, float, float]:
    """
    Return (low, high, step) of the slider of a parameter with this value.

    It reaches :data:`SPAN` times the value, from zero or from as far below, within what the
    parameter allows. Of a zero, the longest link or 1 stands for the value.
    """
    size = max(map(abs, shown.linkage.lengths)) if parameter.unit == 'm' else 1.0
    reach = SPAN * (abs(value) or size)
    low = -reach if value < 0.0 or value == 0.0 or parameter.unit == 'rad/s or m/s' else 0.0
    low = max(low, parameter.low) if parameter.low > -1e300 else low
    if parameter.positive or parameter.name.split('.')[-1] in ('mass', 'inertia'):
        low = max(low, 0.0)
    step = float(f'{(reach - low) / 500.0:.0e}')
    low = step if parameter.positive and low <= 0.0 else low
    return low, min(reach, parameter.high), step
