# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The page of a scene: its state, its elements, and how it answers to its user.

Everything on the page is state of its elements, never a command to them: whatever arrives late,
twice or not at all, a browser ends with the newest state. The server draws the pose in which the
mechanism rests, and, after each change, the frames of a whole cycle in one message: the browser
plays, scrubs and drags through these (player.js).
"""
from __future__ import annotations

import asyncio
from math import radians
from pathlib import Path
from typing import Any

from fourbar_lab.drawing.poses import DrawnPose
from fourbar_lab.drawing.tables import facts
from fourbar_lab.live import charts, controls, downloads, link, picture, tables
from fourbar_lab.live.model import Shown
from fourbar_lab.live.model import shown as shown_of
from fourbar_lab.live.svg import HEIGHT, STYLE, WIDTH
from fourbar_ros.errors import FourBarError
from fourbar_ros.pipeline.stepper import INVALID_INPUT, OK, STATUS_NAMES
from fourbar_ros.scene.linkage import warnings_of
from fourbar_ros.scene.parameters import as_number
from fourbar_ros.scene.settings import ParameterValues
from fourbar_ros.scene.units import quantity, WrongQuantity
from nicegui import background_tasks, run, ui
from nicegui.element import Element
from nicegui.events import GenericEventArguments

FRAMES = 181                # of a cycle, about
SOON, LATER = 0.005, 0.1    # [s] until charts, then the frames of a cycle follow a picture
VIEWS = 'Curves', 'Polygons', 'Extrema', 'Facts'
HEAD = f"""<style>{STYLE}
:root{{--fb-aspect:{WIDTH:g}/{HEIGHT:g};--fb-top:{charts.TOP}px;--fb-gap:{charts.GAP}px;
--fb-cursor:{charts.CURSOR}}}
{Path(__file__).with_name('page.css').read_text(encoding='utf-8')}</style>"""
# A place in the table of extrema: a button, so that the keyboard reaches it.
GO_THERE = """<q-td :props="props"><q-btn flat dense no-caps :label="props.value"
  @click.stop="() => $parent.$emit('go', props.row.input)" /></q-td>"""


class Player(Element, component='player.js'):   # type: ignore[call-arg]  # as NiceGUI asks
    """The picture and what moves it; an element of the page with the properties of player.js."""


class PoseElement(Element, component='pose.js'):    # type: ignore[call-arg]  # as NiceGUI asks
    """Something else that is drawn of each pose: an HTML element, by default a picture."""

    def __init__(self, label: str, tag: str = 'svg') -> None:
        super().__init__()
        if tag == 'svg':
            self.props(f'role=img aria-label="{label}" viewBox="0 0 {WIDTH:g} {HEIGHT:g}"')
            self.classes('fb-picture')
        show(self, tag=tag, **BLANK)


def show(element: Element, **properties: Any) -> None:
    """Give an element other properties."""
    element.props.update(properties)
    element.update()


class Page:
    """
    One tab of a browser: a scene, its state, and the elements that show it.

    ``title`` is the name of the scene, ``values`` its parameters; ``query`` that of the page's
    address, which may change them.
    """

    panel: Element              # of the controls

    def __init__(self, title: str, values: ParameterValues, query: dict[str, str]):
        """Take the state from the query; of a bad one, say so and show the scene as it is."""
        self.state = link.PageAddress(title, values, values)
        self.problem = ''                       # why something was not done
        try:
            self.state = link.read(query, title, values)
            self.shown = shown_of(self.state.values, self.state.acceleration)
        except FourBarError as error:
            self.state = self.state._replace(values=self.state.first, acceleration=0.0)
            self.problem, self.shown = str(error), shown_of(self.state.values)
        self.position = self.shown.nearest_input(self.shown.scene.drive.start)
        if self.state.input is not None:
            self.position = self._position_of(self.state.input)
        self.names = self.shown.usual_quantities        # whose curves are drawn
        self.layers = picture.USUAL                     # what is drawn beside the links
        self.pose: DrawnPose | None = None          # what is drawn now; None: nothing
        self.refusal = self.no_pose = ''            # why there is no mechanism, why it has no pose

    @property
    def shown_input(self) -> float:
        """Return the input in the unit of the page, with nine digits."""
        return link.rounded(self.shown.shown_input(self.position))

    def _position_of(self, shown_input: float) -> float:
        """Return the nearest possible input [rad] or [m] to one in the unit of the page."""
        nine_digits = link.rounded(shown_input)
        return self.shown.nearest_input(nine_digits if self.shown.linkage.is_driven_by_slide
                                        else radians(nine_digits))

    # --- elements -------------------------------------------------------------------------------

    def build(self) -> None:
        """Build the elements of the page, from top to bottom, and fill them."""
        self.client = ui.context.client
        ui.add_head_html(HEAD)
        ui.page_title(f'{self.state.title} - fourbar live')
        ui.colors(primary='#1f5f99')
        with ui.header(elevated=False).classes('fb-middle fb-head no-wrap'):
            # narrow windows show the controls after a click, wide ones until a click
            ui.button(icon='menu', on_click=lambda: self.panel.classes(toggle='fb-turned')).props(
                'flat dense color=white aria-label="parameters"')
            ui.label(self.state.title).classes('text-h6').props('role=heading aria-level=1')
            self.words = ui.label().classes('col ellipsis')
            downloads.menu(self)
            ui.button(icon='contrast').props(
                'flat dense color=white aria-label="dark or light"').on(
                'click', js_handler='() => Quasar.Dark.toggle()')
        with ui.element('div').classes('fb-columns'):
            with ui.element('div').classes('fb-controls') as self.panel:
                controls.build(self.shown, lambda name, value: self.change(
                    values={**self.state.values, name: value}))
                unit = f'{"m" if self.shown.linkage.is_driven_by_slide else "rad"}/s^2'
                controls.number_field(
                    f'acceleration of the input [{unit}]', self.state.acceleration,
                    lambda text: as_number('acceleration', text, unit),
                    lambda value: self.change(acceleration=value),
                    'acceleration of the input').classes('full-width')
            with ui.element('div').classes('fb-stage'):
                self.alarm = ui.label().classes('text-negative text-subtitle1 fb-alarm').props(
                    'role=alert')
                self.warnings = ui.label().classes('fb-warnings').props('role=status')
                self.player = Player()
                show(self.player, size=[WIDTH, HEIGHT], answered=0, **NOTHING)
                self.player.on('rest', self._rest, [None])
            with ui.row().classes('fb-options fb-middle'):
                for name, text in picture.LAYERS.items():
                    ui.checkbox(text, value=name in picture.USUAL,
                                on_change=lambda _, name=name: self.switch(name)
                                ).set_visibility(name != 'axis' or self.shown.has_axis)
                self.no_loads = ui.label()
            with ui.column().classes('fb-views'):
                self._build_views()
            with ui.column().classes('fb-now'):
                self.now = PoseElement('', 'div')
        self.rebuild()

    def _build_views(self) -> None:
        """Build a tab for each view; they are filled when they are opened."""
        with ui.tabs().props('dense no-caps align=left').classes('full-width') as self.tabs:
            for name in VIEWS:
                ui.tab(name)
        self.tabs.on_value_change(self.fill)
        with ui.tab_panels(self.tabs, value='Curves', animated=False, keep_alive=True).classes(
                'full-width bg-transparent'):
            with _panel('Curves'):
                self.chosen = ui.select(
                    list(self.shown.quantities), value=self.names, multiple=True,
                    label='quantities', on_change=lambda event: self.choose(event.value)).props(
                    'dense use-chips aria-label="quantities"').classes('full-width')
                with ui.element('div').classes('full-width fb-over'):
                    self.curves = ui.echart({}).classes('full-width').props(
                        'role=img aria-label="curves over the input, extrema marked"')
                    self.cursor = PoseElement('', 'div')
            with _panel('Polygons'):
                self.polygons = {}
                for name in picture.POLYGONS:
                    ui.label(f'{name} polygon')
                    self.polygons[name] = PoseElement(f'{name} polygon')
            with _panel('Extrema'):
                self.extrema = _table(tables.EXTREMA_COLUMNS, 'key')
                self.extrema.add_slot('body-cell-at', GO_THERE)
                self.extrema.on('go', lambda event: self.go(event.args))
                self.extrema.on('rowClick', lambda event: self.go(event.args[1]['input']))
            with _panel('Facts'):
                columns = [tables.column('name'), tables.column('text')]
                self.facts = _table(columns, 'name', 'wrap-cells hide-header').classes('fb-words')

    # --- what changes ---------------------------------------------------------------------------

    def change(self, **state: Any) -> None:
        """Take new values of the parameters or another acceleration, and show what has them."""
        self.state, self.problem = self.state._replace(**state), ''
        self.rebuild()

    def rebuild(self) -> None:
        """
        Compute and draw all that is shown again, after a change of parameters.

        Parameters that no mechanism can have take the picture away, with the reason.
        """
        try:
            shown = shown_of(self.state.values, self.state.acceleration)
            self.view = picture.mechanism_view(shown)
        except FourBarError as error:
            self.refusal, self.pose = str(error), None
            self.alarm.set_text(self.refusal)
            self.warnings.set_text('')
            self.words.set_text('impossible')
            show(self.player, **NOTHING)
            for element in self._pose_elements():
                show(element, **BLANK)
            self.set_curves({})
            self.extrema.rows, self.facts.rows = [], []
            return
        self.shown, self.refusal = shown, ''
        self.names = [name for name in self.names if name in shown.quantities]
        self.position = shown.nearest_input(self.position)
        self.words.set_text(shown.linkage.description)
        self.warnings.set_text('\n'.join(warnings_of(shown.scene)))
        self.no_loads.set_text(shown.what_lacks)
        self._refill()

    def _refill(self) -> None:
        """Draw all anew, after another choice of what is shown or how; views when they open."""
        if self.refusal:
            return
        self.draw()
        self.fill()
        self._remember()

    def _rest(self, event: GenericEventArguments) -> None:
        """Take (input, or its text as typed, count) from the player; answer with the count."""
        wanted, count = event.args
        unit = 'm' if self.shown.linkage.is_driven_by_slide else 'rad'
        try:        # what is typed without a unit is in that of the page
            self.go(quantity(wanted, unit, plain_angle='deg') if isinstance(wanted, str)
                    else float(wanted))
        except WrongQuantity as error:
            self.problem = f'{self.shown.linkage.input_coordinate.position} = {wanted!r}: {error}'
            self.draw()
        show(self.player, answered=count)

    def go(self, shown_input: float) -> None:
        """Go to an input given in the unit of the page."""
        if not self.refusal:
            self.position, self.problem = self._position_of(shown_input), ''
            self.draw()
            self._remember()

    def switch(self, layer: str) -> None:
        """Show or hide one of :data:`~fourbar_lab.live.picture.LAYERS`."""
        self.layers = self.layers ^ {layer}
        self._refill()

    def choose(self, names: list[str]) -> None:
        """Draw the curves of these quantities, and find their extrema."""
        self.names = list(names)
        self._refill()

    def _remember(self) -> None:
        query = link.address(self.state._replace(input=self.shown_input))
        ui.run_javascript(f'history.replaceState(null, "", "?{query}")')

    # --- poses ----------------------------------------------------------------------------------

    def draw(self) -> None:
        """Draw the pose in which the mechanism rests, or say why it has none."""
        pose = self.shown.pose(self.position)
        self.pose = pose if pose.status == OK else None
        self.no_pose = '' if self.pose else self._why_no_pose(pose.status)
        self.alarm.set_text(self.no_pose or self.problem)
        coordinate = self.shown.linkage.input_coordinate
        show(self.player, label=f'{coordinate.position} [{self.shown.input_unit}]',
             bounds=list(self.shown.bounds), at=self.shown_input,
             under=picture.traces_svg(self.shown, self.view) if 'curves' in self.layers else '',
             still=(picture.mechanism_svg(self.shown, pose, self.view, self.layers)
                    + picture.grips_svg(self.shown, pose, self.view)) if self.pose else '')
        drawn = self._drawn() if self.pose else {}
        for element in self._pose_elements():
            show(element, still=drawn[element](self.shown_input, pose) if element in drawn else '')

    def _why_no_pose(self, status: int) -> str:
        """Return a status with the input that has it, for the alarm of the page."""
        text = (f'{STATUS_NAMES[status]} at {self.shown.linkage.input_coordinate.position} '
                f'[{self.shown.input_unit}] {self.shown_input:.6g}')
        return text if status != INVALID_INPUT else (
            f'{text}, rate {self.shown.rate:.6g}, acceleration {self.state.acceleration:.6g}: too '
            'large, or unknown')

    def _pose_elements(self) -> list[PoseElement]:
        return [self.now, self.cursor, *self.polygons.values()]

    def _drawn(self) -> dict[PoseElement, picture.Drawn]:
        """Return the elements that show a pose in the open view, and how each draws it."""
        shown, view = self.shown, self.tabs.value
        drawn: dict[PoseElement, picture.Drawn] = {
            self.now: lambda _, pose: tables.now_html(shown, pose)}
        if view == 'Curves' and self.names:
            drawn[self.cursor] = lambda shown_input, _: charts.cursor_html(shown_input,
                                                                           *shown.bounds)
        if view == 'Polygons':
            drawn |= {element: picture.polygon_drawing(shown, name)
                      for name, element in self.polygons.items()}
        return drawn

    def fill(self) -> None:
        """Fill the view that is open, once for all that asked for it meanwhile."""
        background_tasks.create_lazy(self._fill(), name=f'view of {self.client.id}')

    async def _fill(self) -> None:
        """Fill the view that is open after the picture is on its way, then draw a cycle."""
        await asyncio.sleep(SOON)
        if self.refusal or self.client.is_deleted:
            return
        try:
            self._fill_view(self.tabs.value)
        except FourBarError as error:       # a search that is beyond the numbers
            self.problem = str(error)
        self.draw()
        await asyncio.sleep(LATER)
        shown = self.shown
        cycle = await run.io_bound(self._cycle, shown, self._drawn())
        # None: the server ends
        if cycle and self.shown is shown and not self.refusal and not self.client.is_deleted:
            for element, properties in cycle.items():
                show(element, **properties)

    def _cycle(self, shown: Shown, drawn: dict[PoseElement, picture.Drawn]
               ) -> dict[Element, dict[str, Any]]:
        """Return {element: its properties} for the frames of a cycle, the player last."""
        samples = shown.samples(FRAMES)
        inputs = [shown.shown_input(position) for position, _ in samples]
        properties: dict[Element, dict[str, Any]] = {
            element: {'frames': [draw(shown_input, pose)
                                 for shown_input, (_, pose) in zip(inputs, samples)]}
            for element, draw in drawn.items()}
        of_ranges = [[k for k, (position, _) in enumerate(samples) if low <= position <= high]
                     for low, high in shown.ranges]
        sense = -1 if shown.rate < 0.0 else 1
        properties[self.player] = {
            'inputs': inputs,
            'frames': [picture.mechanism_svg(self.shown, pose, self.view, self.layers)
                       for _, pose in samples],
            'joints': [picture.joints_of(shown, pose, self.view) for _, pose in samples],
            'ranges': [[frames[0], frames[-1]] for frames in of_ranges if frames],
            'turns': sense if shown.linkage.turns_fully else 0}
        return properties

    # --- views ----------------------------------------------------------------------------------

    def set_curves(self, options: charts.Options) -> None:
        """Give the chart of the curves other options."""
        self.curves.options.clear()
        self.curves.options.update(options)
        self.curves.update()

    def _fill_view(self, name: str) -> None:
        """Fill a view with what does not follow the pose."""
        shown = self.shown
        if name == 'Curves':
            self.set_curves(charts.over_input(shown, self.names, shown.extrema(self.names))
                            if self.names else {})
            self.curves.style(f'height:{charts.height(len(self.names))}px')
        elif name == 'Extrema':
            self.extrema.rows = tables.extrema_rows(shown, shown.extrema(self.names))
        elif name == 'Facts':
            rows = [*facts(shown.linkage), *tables.joint_rows(shown)]
            self.facts.rows = [{'name': name, 'text': text} for name, text in rows]


NOTHING: dict[str, Any] = {'under': '', 'still': '', 'label': '', 'bounds': [0.0, 1.0], 'at': 0.0,
                           'inputs': [], 'frames': [], 'joints': [], 'ranges': [], 'turns': 0}
BLANK: dict[str, Any] = {'under': '', 'still': '', 'frames': []}


def _panel(name: str) -> ui.tab_panel:
    return ui.tab_panel(name).classes('q-pa-none')


def _table(columns: list[dict[str, str]], key: str, props: str = '') -> ui.table:
    """Return an empty table without pages; ``key``: the column that tells rows apart."""
    return ui.table(columns=columns, rows=[], row_key=key).props(
        f'dense flat hide-pagination {props} :rows-per-page-options="[0]"').classes(
        'full-width fb-table')
