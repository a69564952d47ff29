# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The elements of a page: picture and transport on the left, curves and tables on the right."""
from __future__ import annotations

from typing import Any

from fourbar_ros.live import controls, downloads
from fourbar_ros.live.charts import CURSOR, GAP, POLAR_SIZE, TOP
from fourbar_ros.live.owned import Field, Slider
from fourbar_ros.live.strokes import HEIGHT, STYLE, WIDTH
from fourbar_ros.live.tables import EXTREMA_COLUMNS, now_columns
from nicegui import ui

HEAD = f"""<style>{STYLE}
body{{--fb-paper:#ffffff;--fb-ink:#1c1c1c;--fb-link:#dfe5ec;--fb-point:#8a5200;--fb-force:#1e6b37;
--fb-part:#a02c2c;--fb-sum:#1f4e8c}}
body.body--dark{{--fb-paper:#161a1f;--fb-ink:#ececec;--fb-link:#3b4653;--fb-point:#e3a857;
--fb-force:#6fcf8e;--fb-part:#f08a8a;--fb-sum:#8ab8f0}}
.fb-columns{{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,1fr);gap:16px;width:100%}}
@media (max-width:1000px){{.fb-columns{{grid-template-columns:minmax(0,1fr)}}}}
.fb-middle{{align-items:center}} .fb-control{{gap:10px}}
.fb-number{{width:9.5rem;flex:none}}
.fb-picture{{background:var(--fb-paper);border:1px solid rgba(128,128,128,.35);touch-action:none}}
.fb-over{{position:relative;max-width:100%;overflow-x:auto;overflow-y:hidden}}
.fb-cursor{{position:absolute;top:{TOP}px;bottom:{GAP}px;width:0;
border-left:1.5px solid {CURSOR};pointer-events:none}}
.fb-dots{{position:absolute;top:0;left:0;pointer-events:none}}
.fb-table td,.fb-table th{{font-variant-numeric:tabular-nums;white-space:nowrap}}
.fb-table td,.fb-table th{{padding-left:8px;padding-right:8px}}
.fb-tight td,.fb-tight th{{padding-left:4px;padding-right:4px;font-size:12px}}
.fb-words td{{white-space:normal}} .fb-words td:first-child{{white-space:nowrap}}
</style>"""
CURVES, FORCES, POLYGONS, EXTREMA, FACTS = TABS = (
    'Curves', 'Forces', 'Polygons', 'Extrema', 'Facts')
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
        self.alarm = ui.label().classes('text-negative text-subtitle1 full-width').props(
            'role=alert')
        with ui.element('main').classes('fb-columns'):
            with ui.column().classes('full-width'):
                self._picture()
                self._transport()
                self.now = _table(now_columns(page.title, page.course.beside), 'name').classes(
                    'fb-tight' if page.course.beside else '')
            with ui.column().classes('full-width'):
                self._views()

    def _header(self) -> None:
        page = self.page
        drawer: ui.left_drawer          # made below
        with ui.header(elevated=False).classes('fb-middle q-py-xs'):
            ui.button(icon='menu', on_click=lambda: drawer.toggle()).props(
                'flat dense color=white aria-label="parameters"')
            ui.label(page.title).classes('text-h6').props('role=heading aria-level=1')
            self.words = ui.label().classes('col')
            downloads.menu(page)
            ui.button(icon='contrast', on_click=page.switch_dark).props(
                'flat dense color=white aria-label="dark or light"')
        with ui.left_drawer().props('width=330 bordered') as drawer:
            controls.build(page.shown, page.change)
            Field('acceleration of the input', page.acceleration,
                  lambda event: page.set_acceleration(event.value)).props(
                'dense aria-label="acceleration of the input"').classes('full-width')

    def _picture(self) -> None:
        self.picture = ui.interactive_image(
            size=(WIDTH, HEIGHT), on_mouse=self.page.on_mouse, sanitize=False,
            events=['mousedown', 'mousemove', 'mouseup', 'mouseleave']).classes(
                'full-width fb-picture').props('role=img aria-label="the mechanism in its pose"')
        self.traces = self.picture.add_layer()

    def _transport(self) -> None:
        page, pace = self.page, self.page.course.pace
        with ui.row().classes('fb-middle full-width no-wrap'):
            self.play = ui.button(icon='play_arrow', on_click=page.play).props(
                'round dense aria-label="play or pause"')
            self.slider = Slider(0.0, 1.0, 0.001, 0.0, lambda event: page.go(event.value)).classes(
                'col').props('aria-label="input"')
            self.field = Field('', 0.0, lambda event: page.go(event.value), digits=6).props(
                'dense aria-label="input value"').classes('fb-number')
        with ui.row().classes('fb-middle full-width'):
            if pace:
                ui.label(pace.label)
                Slider(pace.least, pace.most, pace.least / 2.0, pace.value).bind_value(
                    pace, 'value').style('width:8rem').props(f'label aria-label="{pace.label}"')
            for name, text in LAYERS.items():
                ui.checkbox(text, value=getattr(page.layers, name),
                            on_change=lambda event, name=name: page.set_layer(name, event.value))

    def _views(self) -> None:
        page = self.page
        with ui.tabs().props('dense no-caps align=left').classes('full-width') as self.tabs:
            for name in TABS:
                ui.tab(name)
        self.tabs.on_value_change(page.show_view)
        with ui.tab_panels(self.tabs, value=TABS[0], animated=False, keep_alive=True).classes(
                'full-width bg-transparent'):
            with _panel(CURVES):
                ui.select(list(page.shown.quantities), value=page.names, multiple=True,
                          label='quantities', on_change=lambda event: page.choose(event.value)
                          ).props('dense use-chips aria-label="quantities"').classes('full-width')
                if len(page.course.beside) == 1:
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
                self.polygons = [_polygon(name) for name in ('velocity', 'acceleration')]
            with _panel(EXTREMA):
                self.extrema = _table(EXTREMA_COLUMNS, 'key')
                self.extrema.on('rowClick', lambda event: page.go(event.args[1]['input']))
            with _panel(FACTS):
                columns = [{'name': name, 'label': '', 'field': name, 'align': 'left'}
                           for name in ('name', 'text')]
                self.facts = _table(columns, 'name', 'wrap-cells hide-header').classes('fb-words')

    @property
    def is_dark(self) -> bool:
        """Return whether the page is dark."""
        return bool(self.dark.value)

    def clear_pose(self) -> None:
        """Take away what shows one pose."""
        for picture in (self.picture, *self.polygons, self.dots):
            picture.content = ''
        self.cursor.set_visibility(False)
        self.now.rows = []

    def clear_views(self, besides: str | None = None) -> None:
        """Take away what shows a mechanism over its cycle, but for one view."""
        for name, chart in ((CURVES, self.curves), (FORCES, self.polar)):
            if name != besides and chart.options:
                set_chart(chart, {})
        for name, table in ((EXTREMA, self.extrema), (FACTS, self.facts)):
            if name != besides and table.rows:
                table.rows = []


def _panel(name: str) -> Any:
    return ui.tab_panel(name).classes('q-pa-none')


def _polygon(name: str) -> Any:
    ui.label(f'{name} polygon')
    return ui.interactive_image(size=(WIDTH, HEIGHT), sanitize=False).classes(
        'full-width fb-picture').props(f'role=img aria-label="{name} polygon"')


def _table(columns: list[dict[str, Any]], key: str, props: str = '') -> Any:
    return ui.table(columns=columns, rows=[], row_key=key).props(
        f'dense flat hide-pagination {props} :rows-per-page-options="[0]"').classes(
        'full-width fb-table')


def set_chart(chart: Any, options: dict[str, Any]) -> None:
    """Show other options in a chart."""
    chart.options.clear()
    chart.options.update(options)
    chart.update()
