# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page consists of: controls, picture and transport, curves and tables."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fourbar_lab.live.charts import CURSOR, GAP, Options, POLAR_SIZE, TOP
from fourbar_lab.live.controls import build, Field, Slider
from fourbar_lab.live.downloads import menu
from fourbar_lab.live.svg import HEIGHT, STYLE, WIDTH
from fourbar_lab.live.tables import EXTREMA_COLUMNS, now_columns
from nicegui import ui
from nicegui.elements.mixins.content_element import ContentElement

if TYPE_CHECKING:
    from fourbar_lab.live.page import Page

HEAD = f"""<style>{STYLE}
:root{{--fb-aspect:{WIDTH:g}/{HEIGHT:g};--fb-top:{TOP}px;--fb-gap:{GAP}px;--fb-cursor:{CURSOR}}}
{Path(__file__).with_name('page.css').read_text(encoding='utf-8')}</style>"""
CURVES, FORCES, POLYGONS, EXTREMA, FACTS = TABS = (
    'Curves', 'Forces', 'Polygons', 'Extrema', 'Facts')
LAYERS = {'curves': 'coupler curves', 'forces': 'forces', 'centres': 'instant centres',
          'axis': 'collineation axis'}


# A place in the table of extrema: a button, so that the keyboard reaches it.
GO_THERE = """<q-td :props="props"><q-btn flat dense no-caps :label="props.value"
  @click.stop="() => $parent.$emit('go', props.row.input)" /></q-td>"""


class Picture(ContentElement, component='picture.js'):  # type: ignore[call-arg]  # as NiceGUI asks
    """An SVG picture, whose grips can be dragged; ``under``: what rarely changes below it."""

    CONTENT_PROP = 'content'

    def __init__(self, label: str) -> None:
        super().__init__(content='')
        self._props.update({'size': [WIDTH, HEIGHT], 'under': ''})
        self.classes('fb-picture').props(f'role=img aria-label="{label}"')

    def draw_under(self, content: str) -> None:
        """Show the part that rarely changes."""
        self._props['under'] = content
        self.update()


class Elements:
    """What a page consists of. What its user does calls methods of the page, which changes it."""

    def __init__(self, page: Page):
        """Build all elements of the page, from top to bottom; the page fills them."""
        self.page = page
        ui.add_head_html(HEAD)
        ui.page_title(f'{page.title} - fourbar live')
        self.dark = ui.dark_mode(None)
        ui.colors(primary='#1f5f99')
        self._header()
        with ui.element('div').classes('fb-columns'):
            with ui.element('div').classes('fb-controls') as self.panel:
                self._controls()
            with ui.element('div').classes('fb-stage'):
                self.alarm = ui.label().classes('text-negative text-subtitle1 fb-alarm').props(
                    'role=alert')
                self._picture()
                self._transport()
            with ui.row().classes('fb-options fb-middle'):
                self._options()
            with ui.column().classes('fb-views'):
                self._views()
            with ui.column().classes('fb-now'):
                self.now = _table(now_columns(page.title, page.playback.beside), 'name').classes(
                    'fb-tight' if page.playback.beside else '')

    def _header(self) -> None:
        """Build the bar on top: title, description, downloads, dark or light."""
        page = self.page
        with ui.header(elevated=False).classes('fb-middle fb-head no-wrap'):
            # narrow windows show the controls after a click, wide ones until a click
            ui.button(icon='menu', on_click=lambda: self.panel.classes(toggle='fb-turned')).props(
                'flat dense color=white aria-label="parameters"')
            ui.label(page.title).classes('text-h6').props('role=heading aria-level=1')
            self.words = ui.label().classes('col ellipsis')
            menu(page)
            ui.button(icon='contrast', on_click=page.switch_dark).props(
                'flat dense color=white aria-label="dark or light"')

    def _controls(self) -> None:
        """Build the panel of all parameters."""
        page = self.page
        self.show_value = build(page.shown, page.change, page.refuse)
        Field('acceleration of the input', page.acceleration, page.set_acceleration,
              lambda why: page.refuse(f'acceleration of the input: {why}')).props(
            'dense aria-label="acceleration of the input"').classes('full-width')

    def _picture(self) -> None:
        """Build the picture of the mechanism, whose joints can be dragged."""
        page = self.page
        self.picture = Picture('the mechanism in its pose')
        self.picture.on('take', lambda event: page.take(event.args))
        self.picture.on('move', lambda event: page.drag(event.args))
        self.picture.on('leave', page.leave)

    def _transport(self) -> None:
        """Build what moves the input: play button, slider and field."""
        page = self.page
        with ui.row().classes('fb-middle full-width no-wrap q-pt-xs'):
            self.play = ui.button(icon='play_arrow', on_click=page.play).props(
                'round dense aria-label="play or pause"')
            self.slider = Slider(0.0, 1.0, 0.001, 0.0, page.go).classes('col').props(
                'aria-label="input"')
            self.field = Field('', 0.0, page.go, lambda why: page.refuse(
                f'{page.playback.label}: {why}'), digits=6).props(
                'dense aria-label="input value"').classes('fb-number')

    def _options(self) -> None:
        """Build the pace of the playback, and a box for each layer of the picture."""
        page, pace = self.page, self.page.playback.pace
        if pace:
            ui.label(pace.label)
            Slider(pace.least, pace.most, pace.least / 2.0, pace.value).bind_value(
                pace, 'value').style('width:8rem').props(f'label aria-label="{pace.label}"')
        for name, text in LAYERS.items():
            ui.checkbox(text, value=getattr(page.layers, name),
                        on_change=lambda event, name=name: page.set_layer(name, event.value)
                        ).set_visibility(name != 'axis' or page.shown.has_axis)

    def _views(self) -> None:
        """Build a tab for each view; they are filled when they are opened."""
        page = self.page
        with ui.tabs().props('dense no-caps align=left').classes('full-width') as self.tabs:
            for name in TABS:
                ui.tab(name)
        self.tabs.on_value_change(page.show_view)
        with ui.tab_panels(self.tabs, value=TABS[0], animated=False, keep_alive=True).classes(
                'full-width bg-transparent'):
            with _panel(CURVES):
                self.chosen = ui.select(
                    list(page.shown.quantities), value=page.names, multiple=True,
                    label='quantities', on_change=lambda event: page.choose(event.value)).props(
                    'dense use-chips aria-label="quantities"').classes('full-width')
                if len(page.playback.beside) == 1:
                    ui.checkbox('difference of the two runs',
                                on_change=lambda event: page.set_difference(event.value))
                with ui.element('div').classes('full-width fb-over'):
                    self.curves = ui.echart({}).classes('full-width').props(
                        'role=img aria-label="curves over the input, extrema marked"')
                    self.cursor = ui.element('div').classes('fb-cursor')
            with _panel(FORCES):
                self.no_loads = ui.label('no masses given, so no loads')
                width, height = POLAR_SIZE
                with ui.element('div').classes('fb-over'):
                    self.polar = ui.echart({}).style(f'width:{width}px;height:{height}px').props(
                        'role=img aria-label="polar diagram of the shaking force and reactions"')
                    self.dots = ui.html('', sanitize=False).classes('fb-dots').props(
                        'role=img aria-label="the forces of this pose"')
            with _panel(POLYGONS):
                self.polygons = []
                for name in ('velocity', 'acceleration'):
                    ui.label(f'{name} polygon')
                    self.polygons.append(Picture(f'{name} polygon'))
            with _panel(EXTREMA):
                self.extrema = _table(EXTREMA_COLUMNS, 'key')
                self.extrema.add_slot('body-cell-at', GO_THERE)
                self.extrema.on('go', lambda event: page.go(event.args))
                self.extrema.on('rowClick', lambda event: page.go(event.args[1]['input']))
            with _panel(FACTS):
                columns = [{'name': name, 'label': '', 'field': name, 'align': 'left'}
                           for name in ('name', 'text')]
                self.octahedron = ui.html('', sanitize=False).props(
                    'role=img aria-label="octahedron of four-bars, this one in it"')
                self.facts = _table(columns, 'name', 'wrap-cells hide-header').classes('fb-words')

    @property
    def is_dark(self) -> bool:
        """Return whether the page is dark."""
        return bool(self.dark.value)

    def clear_pose(self) -> None:
        """Take away the elements that show one pose."""
        for picture in (self.picture, *self.polygons, self.dots):
            picture.content = ''
        self.cursor.set_visibility(False)
        self.now.rows = []

    def clear_views(self, besides: str | None = None) -> None:
        """Empty the charts and tables of all views but one."""
        for name, chart in ((CURVES, self.curves), (FORCES, self.polar)):
            if name != besides and chart.options:
                set_chart(chart, {})
        for name, table in ((EXTREMA, self.extrema), (FACTS, self.facts)):
            if name != besides and table.rows:
                table.rows = []


def _panel(name: str) -> ui.tab_panel:
    return ui.tab_panel(name).classes('q-pa-none')


def _table(columns: list[dict[str, str]], key: str, props: str = '') -> ui.table:
    """Return an empty table without pages; ``key``: the column that tells rows apart."""
    return ui.table(columns=columns, rows=[], row_key=key).props(
        f'dense flat hide-pagination {props} :rows-per-page-options="[0]"').classes(
        'full-width fb-table')


def set_chart(chart: ui.echart, options: Options) -> None:
    """Show other options in a chart."""
    chart.options.clear()
    chart.options.update(options)
    chart.update()
