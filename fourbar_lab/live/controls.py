# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The controls of a page: fields and sliders, one pair for each number of the scene.

A control belongs to its user while he types or moves it. The server may set ``value`` at any
time; the browser shows it when the control is not in use and the server has answered all that
its user did. So nothing that arrives late overwrites what he does. ``ui.number`` and
``ui.slider`` show every value as it comes: on a page that moves they drop digits while they are
typed, and set a slider back to an older place. A value that the server sets calls nobody back.
"""
from __future__ import annotations

from collections.abc import Awaitable, Callable
from math import inf, isfinite
import re

from fourbar_lab.live.model import Shown
from fourbar_ros.errors import FourBarError
from fourbar_ros.scene import parameters
from fourbar_ros.scene.settings import Parameter
from nicegui import ui
from nicegui.elements.mixins.disableable_element import DisableableElement
from nicegui.elements.mixins.value_element import ValueElement
from nicegui.events import GenericEventArguments, ValueChangeEventArguments

THROTTLE = 0.05         # [s] between two values of a slider that is moved
NUMBER = r'[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?'
TYPED = re.compile(rf'({NUMBER})(?:\s*/\s*({NUMBER}))?', re.ASCII)
THOUSANDS = re.compile(r'[-+]?[1-9]\d{0,2},\d{3}', re.ASCII)      # or a point and three digits
GROUPS = {'linkage': 'Linkage', 'dyads': 'Dyads', 'drive': 'Input', 'gravity': 'Gravity',
          'bodies': 'Bodies', 'external': 'Loads from outside', 'points': 'Points'}
OPEN = ('linkage', 'dyads', 'drive')       # groups that are open at first
SPAN = 2.5                                 # sliders reach so many times the first value

Answer = Awaitable[None] | None          # of a node it comes later
Change = Callable[[str, float], Answer]     # takes a parameter's name and new value
Refuse = Callable[[str], None]              # takes the reason
Show = Callable[[float], None]              # shows a parameter's value in its controls


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


class UserValue(ValueElement, DisableableElement):
    """
    A control whose browser counts what its user does, and whose server answers with the count.

    ``take`` is called with the number that the user gives, or ``refuse`` with a :class:`NoNumber`,
    and the control goes back to its value. ``throttle``: least time between two values from the
    browser, of which the last one always comes [s].
    """

    VALUE_PROP = 'value'

    def __init__(self, value: float, take: Callable[[float], Answer] | None = None,
                 refuse: Callable[[NoNumber], None] | None = None, throttle: float = 0.0):
        super().__init__(value=value)
        self._take, self._refuse = take, refuse
        self._props['answered'] = 0
        self.on('commit', self._answer, [None], throttle=throttle)

    def _answer(self, event: GenericEventArguments) -> Answer:
        """
        Take (text, count of the user's actions) from the browser, and answer with the count.

        The answer is sent even if the value stays what it was: the browser waits for it.
        """
        text, self._props['answered'] = event.args
        self.update()
        try:
            value = read_number(str(text))
        except NoNumber as error:
            if self._refuse:
                self._refuse(error)
            return None
        self.set_value(value)
        return self._take(value) if self._take else None


class Field(UserValue, component='field.js'):       # type: ignore[call-arg]  # as NiceGUI asks
    """A number with a label; a typed one takes effect on Enter or leaving it."""

    def __init__(self, label: str, value: float, take: Callable[[float], Answer],
                 refuse: Callable[[NoNumber], None], digits: int = 12):
        self._digits = digits
        super().__init__(value, take, refuse)
        self._props.update({'label': label, 'for': self.html_id})

    def _value_to_model_value(self, value: float) -> str:
        return f'{value:.{self._digits}g}'


class Slider(UserValue, component='slider.js'):     # type: ignore[call-arg]  # as NiceGUI asks
    """A slider, whose values come while it is moved."""

    def __init__(self, low: float, high: float, step: float, value: float,
                 take: Callable[[float], Answer] | None = None):
        super().__init__(value, take, throttle=THROTTLE)
        self.set_range(low, high, step)

    def set_range(self, low: float, high: float, step: float) -> None:
        """Set ends and step as numbers: as texts they would be joined, not added."""
        self._props.update({'min': low, 'max': high, 'step': step})


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


def build(shown: Shown, change: Change, refuse: Refuse) -> dict[str, Show]:
    """
    Build the controls; return {name of the parameter: a function that shows a value of it}.

    ``change(name, value)`` is called with each new value of the user, ``refuse(why)`` if there is
    none in what he typed.
    """
    shows = {}
    for group, members in shown_parameters(shown).items():
        with ui.expansion(GROUPS[group], value=group in OPEN).classes('full-width').props(
                'dense expand-separator'):
            for parameter in members:
                is_choice = parameter.name.endswith('.mode') and parameter.type == 'integer'
                with ui.row().classes('fb-middle full-width no-wrap fb-control'):
                    shows[parameter.name] = (_choice(parameter, shown, change) if is_choice
                                             else _number(parameter, shown, change, refuse))
    return shows


def _tooltip(parameter: Parameter) -> None:
    """Add the text of a parameter to its control, on its right: below is the next one."""
    text = parameter.text.partition('; for the sliders')[0]         # a page has no docs
    ui.tooltip(text[0].upper() + text[1:]).props(
        'anchor="center right" self="center left" :delay="400"')


def _choice(parameter: Parameter, shown: Shown, change: Change) -> Show:
    """Build the buttons of an assembly mode; return the function that shows a mode."""
    name = parameter.name
    modes = shown.linkage.modes if name == 'linkage.mode' else {1: '1', 2: '2'}
    dyad = name.split('.')[1] if name.startswith('dyads.') else ''
    ui.label(' '.join(filter(None, (dyad, 'assembly mode'))))
    value = current = shown.scene.values[name]

    def take(event: ValueChangeEventArguments[int]) -> Answer:
        """Take a mode from the user, unless it is what show() has just set."""
        nonlocal current
        if event.value == current:
            return None
        current = event.value
        return change(name, current)

    def show(value: float) -> None:
        nonlocal current
        current = value
        buttons.set_value(value)

    with ui.toggle(dict(modes), value=value, on_change=take).props(
            f'dense no-caps aria-label="{name}"') as buttons:
        _tooltip(parameter)
    return show


def _number(parameter: Parameter, shown: Shown, change: Change, refuse: Refuse) -> Show:
    """
    Build a field for a number and a slider beside it; return the function that shows a value.

    A typed number may lie beyond the ends of the slider, which then stands at an end.
    """
    name, value = parameter.name, shown.scene.values[parameter.name]
    low, high, step = _span(parameter, float(value), shown)

    def clamped(value: float) -> float:
        return min(max(value, low), high)

    def take_typed(value: float) -> Answer:
        slider.set_value(clamped(value))
        return change(name, value)

    def take_moved(value: float) -> Answer:
        field.set_value(value)
        return change(name, value)

    def show(value: float) -> None:
        field.set_value(value)
        slider.set_value(clamped(value))

    unit = f' [{parameter.unit}]' if parameter.unit else ''
    with Field(f'{name.split(".", 1)[1]}{unit}', value, take_typed,
               lambda why: refuse(f'{name} = {why}')).props(
            f'dense aria-label="{name}"').classes('fb-number') as field:
        _tooltip(parameter)
    slider = Slider(low, high, step, clamped(float(value)), take_moved).props(
        f'aria-label="{name} slider"').classes('col')
    return show


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
