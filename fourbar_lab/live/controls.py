# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The controls of a page: a field and a slider beside it for each number of the scene."""
from __future__ import annotations

from collections.abc import Callable
from math import inf, isfinite
import re

from fourbar_lab.live.model import Shown
from fourbar_ros.errors import FourBarError
from fourbar_ros.scene import parameters
from fourbar_ros.scene.settings import Parameter
from nicegui import ui
from nicegui.events import ValueChangeEventArguments

NUMBER = r'[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?'
TYPED = re.compile(rf'({NUMBER})(?:\s*/\s*({NUMBER}))?', re.ASCII)
THOUSANDS = re.compile(r'[-+]?[1-9]\d{0,2},\d{3}', re.ASCII)      # or a point and three digits
GROUPS = {'linkage': 'Linkage', 'dyads': 'Dyads', 'drive': 'Input', 'gravity': 'Gravity',
          'bodies': 'Bodies', 'external': 'Loads from outside', 'points': 'Points'}
OPEN = ('linkage', 'dyads', 'drive')       # groups that are open at first
SPAN = 2.5                                 # sliders reach so many times the first value

Change = Callable[[str, float], None]       # takes a parameter's name and new value
Refuse = Callable[[str], None]              # takes the reason


class NoNumber(FourBarError, ValueError):
    """What was typed is no finite number, or could be two; the message says what to type."""


def read_number(text: str) -> float:
    """Return the number of a typed 0.5, 0,5 or 1/2; NoNumber of 1,234, thousands to some."""
    text = text.strip().replace('\N{MINUS SIGN}', '-')
    match = TYPED.fullmatch(text)
    if not match:
        raise NoNumber(f'{text!r}: must be a number, as 0.5, 0,5 or 1/2' if text
                       else 'must be given')
    for part in filter(None, match.groups()):
        if THOUSANDS.fullmatch(part):
            raise NoNumber(f'{text!r}: write {part.replace(",", ".")} or {part.replace(",", "")}')
    above, below = (float(part.replace(',', '.')) if part else 1.0 for part in match.groups())
    value = above / below if below else inf
    if not isfinite(value):
        raise NoNumber(f'{text[:40]!r}: must be a finite number')
    return value


def field(label: str, value: float, take: Callable[[float], None], refuse: Refuse,
          name: str = '') -> ui.input:
    """
    Build a field for a number with a label: a typed one takes effect on Enter or leaving it.

    What is no number goes back, with its reason. ``name`` is the one for screen readers, by
    default the label.
    """
    def commit() -> None:
        nonlocal value
        text = str(made.value)
        if text == written(value):
            return
        try:
            value = read_number(text)
        except NoNumber as error:
            refuse(f'{name or label} = {error}')
        else:
            take(value)
        made.value = written(value)

    made = ui.input(label, value=written(value)).props(
        f'dense aria-label="{name or label}"').on('keydown.enter', commit).on('blur', commit)
    return made


def written(value: float) -> str:
    """Return a number as a field has it."""
    return f'{value:.12g}'


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


def build(shown: Shown, change: Change, refuse: Refuse) -> None:
    """
    Build the controls.

    ``change(name, value)`` is called with each new value of the user, ``refuse(why)`` if there is
    none in what he typed.
    """
    for group, members in shown_parameters(shown).items():
        with ui.expansion(GROUPS[group], value=group in OPEN).classes('full-width').props(
                'dense expand-separator'):
            for parameter in members:
                is_choice = parameter.name.endswith('.mode') and parameter.type == 'integer'
                with ui.row().classes('fb-middle full-width no-wrap fb-control'):
                    if is_choice:
                        _choice(parameter, shown, change)
                    else:
                        _number(parameter, shown, change, refuse)


def _tooltip(parameter: Parameter) -> None:
    """Add the text of a parameter to its control, on its right: below is the next one."""
    text = parameter.text.partition('; for the sliders')[0]         # a page has no docs
    ui.tooltip(text[0].upper() + text[1:]).props(
        'anchor="center right" self="center left" :delay="400"')


def _choice(parameter: Parameter, shown: Shown, change: Change) -> None:
    """Build the buttons of an assembly mode."""
    name = parameter.name
    modes = shown.linkage.modes if name == 'linkage.mode' else {1: '1', 2: '2'}
    dyad = name.split('.')[1] if name.startswith('dyads.') else ''
    ui.label(' '.join(filter(None, (dyad, 'assembly mode'))))
    with ui.toggle(dict(modes), value=shown.scene.values[name],
                   on_change=lambda event: change(name, event.value)).props(
            f'dense no-caps aria-label="{name}"'):
        _tooltip(parameter)


def _number(parameter: Parameter, shown: Shown, change: Change, refuse: Refuse) -> None:
    """
    Build a field for a number and a slider beside it.

    A typed number may lie beyond the ends of the slider, which then stands at an end.
    """
    name, current = parameter.name, float(shown.scene.values[parameter.name])
    low, high, step = _span(parameter, current, shown)

    def take_typed(value: float) -> None:
        nonlocal current
        current = value
        slider.set_value(min(max(value, low), high))
        change(name, value)

    def take_moved(event: ValueChangeEventArguments[float]) -> None:
        nonlocal current
        value = float(event.value)
        if value != min(max(current, low), high):           # not what take_typed has just set
            current = value
            typed.set_value(written(value))
            change(name, value)

    unit = f' [{parameter.unit}]' if parameter.unit else ''
    typed = field(f'{name.split(".", 1)[1]}{unit}', current, take_typed, refuse, name).classes(
        'fb-number')
    with typed:
        _tooltip(parameter)
    slider = ui.slider(min=low, max=high, step=step, value=min(max(current, low), high),
                       on_change=take_moved).props(f'aria-label="{name} slider"').classes('col')


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
