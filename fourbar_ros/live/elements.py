# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The elements of a page: picture and transport on the left, curves and tables on the right."""
from __future__ import annotations

from typing import Any

from fourbar_ros.live import controls, downloads
from fourbar_ros.live.picture import HEIGHT, STYLE, WIDTH
from fourbar_ros.live.tables import EXTREMA_COLUMNS, NOW_COLUMNS
from nicegui import ui

HEAD = f"""<style>{STYLE}
body{{--fb-paper:#ffffff;--fb-ink:#1c1c1c;--fb-link:#dfe5ec;--fb-point:#8a5200;--fb-force:#1e6b37;
--fb-part:#a02c2c;--fb-sum:#1f4e8c}}
body.body--dark{{--fb-paper:#161a1f;--fb-ink:#ececec;--fb-link:#3b4653;--fb-point:#e3a857;
--fb-force:#6fcf8e;--fb-part:#f08a8a;--fb-sum:#8ab8f0}}
.fb-columns{{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,1fr);gap:16px;width:100%}}
@media (max-width:1000px){{.fb-columns{{grid-template-columns:minmax(0,1fr)}}}}
.fb-number{{width:9.5rem;flex:none}} .fb-control{{gap:10px}}
.fb-picture{{background:var(--fb-paper);border:1px solid rgba(128,128,128,.35);touch-action:none}}
.fb-table td,.fb-table th{{font-variant-numeric:tabular-nums;white-space:nowrap}}
</style>"""
TABS = ('Curves', 'Forces', 'Polygons', 'Extrema', 'Facts')
LAYERS = {'curves': 'coupler curves', 'forces': 'forces', 'centres': 'instant centres'}


class Elements:
    """
    What a page consists of; what its user does goes to the page.

    Parameters
    ----------
    page : Page
        With ``title``, ``shown``, ``course``, ``names``, ``layers``, ``acceleration`` and the
        methods that answer to each control.

    """

    def __init__(self, page: Any):
        self.page = page
        ui.add_head_html(HEAD)
        ui.page_title(f'{page.title} - fourbar live')
        self.dark = ui.dark_mode(None)
        ui.colors(primary='#1f5f99')
        self._header()
        self.alarm = ui.label().classes('text-negative text-subtitle1 w-full').props('role=alert')
        with ui.element('main').classes('fb-columns'):
            with ui.column().classes('w-full'):
                self._picture()
                self._transport()
                self.now = _table(NOW_COLUMNS, 'name')
            with ui.column().classes('w-full'):
                self._views()

    def _header(self) -> None:
        page = self.page
        with ui.header(elevated=False).classes('items-center q-py-xs'):
            ui.button(icon='menu', on_click=lambda: drawer.toggle()).props(
                'flat dense color=white aria-label="parameters"')
            ui.label(page.title).classes('text-h6').props('role=heading aria-level=1')
            self.words = ui.label().classes('grow')
            downloads.menu(page)
            ui.button(icon='contrast', on_click=page.switch_dark).props(
                'flat dense color=white aria-label="dark or light"')
        with ui.left_drawer(value=True).props('width=330 bordered') as drawer:
            controls.build(page.shown, page.change)
            ui.number('acceleration of the input', value=page.acceleration,
                      on_change=lambda event: page.set_acceleration(event.value)).props(
                'dense aria-label="acceleration of the input"').classes('w-full')

    def _picture(self) -> None:
        self.picture = ui.interactive_image(
            size=(WIDTH, HEIGHT), on_mouse=self.page.on_mouse, sanitize=False,
            events=['mousedown', 'mousemove', 'mouseup', 'mouseleave']).classes(
                'w-full fb-picture').props('role=img aria-label="the mechanism in its pose"')
        self.traces = self.picture.add_layer()

    def _transport(self) -> None:
        page, pace = self.page, self.page.course.pace
        with ui.row().classes('items-center w-full no-wrap'):
            self.play = ui.button(icon='play_arrow', on_click=page.play).props(
                'round dense aria-label="play or pause"')
            self.slider = ui.slider(min=0.0, max=1.0, step=0.001, value=0.0,
                                    on_change=lambda event: page.go(event.value)).classes(
                'grow').props('aria-label="input"')
            self.field = ui.number(value=0.0, format='%.6g',
                                   on_change=lambda event: page.go(event.value)).props(
                'dense debounce=200 aria-label="input value"').classes('fb-number')
        with ui.row().classes('items-center w-full'):
            if pace:
                ui.label(pace.label)
                ui.slider(min=pace.least, max=pace.most, step=pace.least / 2.0,
                          value=pace.value).bind_value(pace, 'value').classes('w-32').props(
                    f'label aria-label="{pace.label}"')
            for name, text in LAYERS.items():
                ui.checkbox(text, value=getattr(page.layers, name),
                            on_change=lambda event, name=name: page.set_layer(name, event.value))

    def _views(self) -> None:
        page = self.page
        with ui.tabs().props('dense no-caps align=left').classes('w-full') as self.tabs:
            for name in TABS:
                ui.tab(name)
        self.tabs.on_value_change(lambda: page.draw())
        with ui.tab_panels(self.tabs, value=TABS[0], animated=False, keep_alive=True).classes(
                'w-full bg-transparent'):
            with _panel('Curves'):
                ui.select(list(page.shown.quantities), value=page.names, multiple=True,
                          label='quantities', on_change=lambda event: page.choose(event.value)
                          ).props('dense use-chips aria-label="quantities"').classes('w-full')
                self.curves = ui.echart({}).classes('w-full').props(
                    'role=img aria-label="curves over the input, extrema marked"')
            with _panel('Forces'):
                self.polar = ui.echart({}).style('width:400px;height:380px').props(
                    'role=img aria-label="polar diagram of the shaking force and reactions"')
            with _panel('Polygons'):
                self.polygons = [_polygon(name) for name in ('velocity', 'acceleration')]
            with _panel('Extrema'):
                self.extrema = _table(EXTREMA_COLUMNS, 'key')
                self.extrema.on('rowClick', lambda event: page.go(event.args[1]['input']))
            with _panel('Facts'):
                columns = [{'name': name, 'label': '', 'field': name, 'align': 'left'}
                           for name in ('name', 'text')]
                self.facts = _table(columns, 'name', 'wrap-cells hide-header')

    def clear(self) -> None:
        """Take away all pictures and numbers."""
        self.clear_pose()
        self.traces.content = ''
        for table in (self.extrema, self.facts):
            table.rows = []
        for chart in (self.curves, self.polar):
            chart.options.clear()
            chart.run_chart_method('clear')

    def clear_pose(self) -> None:
        """Take away what shows one pose."""
        for picture in (self.picture, *self.polygons):
            picture.content = ''
        self.now.rows = []


def _panel(name: str) -> Any:
    return ui.tab_panel(name).classes('q-pa-none')


def _polygon(name: str) -> Any:
    ui.label(f'{name} polygon')
    return ui.interactive_image(size=(WIDTH, HEIGHT), sanitize=False).classes(
        'w-full fb-picture').props(f'role=img aria-label="{name} polygon"')


def _table(columns: list[dict[str, Any]], key: str, props: str = '') -> Any:
    return ui.table(columns=columns, rows=[], row_key=key).props(
        f'dense flat hide-pagination {props} :rows-per-page-options="[0]"').classes(
        'w-full fb-table')


def set_chart(chart: Any, options: dict[str, Any]) -> None:
    """Show other options in a chart."""
    chart.options.clear()
    chart.options.update(options)
    chart.update()
