# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The page of a scene: picture and transport on the left, curves and tables on the right."""
from __future__ import annotations

from collections.abc import Callable
import contextlib
from math import isfinite
import time
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.live import address, charts, controls, downloads
from fourbar_ros.live.course import Course, OverInput
from fourbar_ros.live.dragging import Handle
from fourbar_ros.live.model import Shown
from fourbar_ros.live.model import shown as shown_of
from fourbar_ros.live.picture import (
    force_scale,
    HEIGHT,
    Layers,
    mechanism_svg,
    mechanism_view,
    polygon_svg,
    polygon_view,
    STYLE,
    traces_svg,
    WIDTH,
)
from fourbar_ros.live.tables import EXTREMA_COLUMNS, extrema_rows, NOW_COLUMNS, now_rows
from fourbar_ros.pipeline.status import OK, STATUS_NAMES
from fourbar_ros.report.tables import facts
from nicegui import ui

FRAME = 1.0 / 30.0          # [s]
CATCH_UP = 6                # frames: so many at most wait for a browser that is slower
PATIENCE = 10.0             # [s] ... and so long
TABLE_EVERY = 5             # frames: numbers that change faster cannot be read
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


class Page:
    """
    One tab of a browser: a scene, its state, and the elements that show it.

    Parameters
    ----------
    title : str
        Name of the scene, or what else is shown.
    values : dict
        Parameters of the scene by name.
    query : dict
        Of the address of the page.
    course : callable, optional
        Shown -> :class:`~fourbar_ros.live.course.Course`; not given: the input over a cycle.

    """

    def __init__(self, title: str, values: dict[str, Any], query: dict[str, str],
                 course: Callable[[Shown], Course] | None = None):
        link, self.problem = address.Link(title, values, values, None, 0.0), ''
        try:
            link = address.read(query, title, values)
            self.shown = shown_of(link.values, link.acceleration)
        except FourBarError as error:
            link, self.problem = link._replace(values=link.first, acceleration=0.0), str(error)
            self.shown = shown_of(link.values)
        self.title, self.first, self.values, at, self.acceleration = link
        self.course = (course(self.shown) if course
                       else OverInput(self.shown, self.shown.scene.drive.start))
        if at is not None:
            self.course.go(at)
        self.names = self.shown.usual_quantities
        self.layers, self.handle, self.is_possible = Layers(), None, False
        self.extrema: list[Extremum] = []
        self.last, self.frames, self.is_behind = time.monotonic(), 0, False

    # --- building -------------------------------------------------------------------------------

    def build(self) -> None:
        """Build the elements of the page and fill them."""
        ui.add_head_html(HEAD)
        ui.page_title(f'{self.title} - fourbar live')
        self.dark = ui.dark_mode(None)
        ui.colors(primary='#1f5f99')
        with ui.header(elevated=False).classes('items-center q-py-xs'):
            ui.button(icon='menu', on_click=lambda: drawer.toggle()).props(
                'flat dense color=white aria-label="parameters"')
            ui.label(self.title).classes('text-h6').props('role=heading aria-level=1')
            self.words = ui.label().classes('grow')
            downloads.menu(self)
            ui.button(icon='contrast', on_click=self._switch_dark).props(
                'flat dense color=white aria-label="dark or light"')
        with ui.left_drawer(value=True).props('width=330 bordered') as drawer:
            controls.build(self.shown, self.change)
            ui.number('acceleration of the input', value=self.acceleration,
                      on_change=lambda event: self._set_acceleration(event.value)).props(
                'dense aria-label="acceleration of the input"').classes('w-full')
        self.alarm = ui.label().classes('text-negative text-subtitle1 w-full').props('role=alert')
        with ui.element('main').classes('fb-columns'):
            with ui.column().classes('w-full'):
                self._build_picture()
            with ui.column().classes('w-full'):
                self._build_views()
        self.timer = ui.timer(FRAME, self._tick, active=False)
        self.rebuild(keep_problem=True)
        # the pictures are drawn over images of nothing, which readers of screens shall skip
        ui.run_javascript("document.querySelectorAll('img:not([alt])').forEach(i => {i.alt = ''})")

    def _build_picture(self) -> None:
        self.picture = ui.interactive_image(
            size=(WIDTH, HEIGHT), on_mouse=self._mouse, sanitize=False,
            events=['mousedown', 'mousemove', 'mouseup', 'mouseleave']).classes(
                'w-full fb-picture').props('role=img aria-label="the mechanism in its pose"')
        self.traces = self.picture.add_layer()
        with ui.row().classes('items-center w-full no-wrap'):
            self.play = ui.button(icon='play_arrow', on_click=self._play).props(
                'round dense aria-label="play or pause"')
            self.slider = ui.slider(min=0.0, max=1.0, step=0.001, value=0.0,
                                    on_change=lambda event: self._go(event.value)).classes(
                'grow').props('aria-label="input"')
            self.field = ui.number(value=0.0, format='%.6g',
                                   on_change=lambda event: self._go(event.value)).props(
                'dense debounce=200 aria-label="input value"').classes('fb-number')
        with ui.row().classes('items-center w-full'):
            ui.label('seconds a cycle')
            ui.slider(min=1.0, max=30.0, step=0.5, value=self.course.period,
                      on_change=lambda event: setattr(self.course, 'period', event.value)).classes(
                'w-32').props('label aria-label="seconds a cycle"')
            for name, text in (('curves', 'coupler curves'), ('forces', 'forces'),
                               ('centres', 'instant centres')):
                ui.checkbox(text, value=getattr(self.layers, name),
                            on_change=lambda event, name=name: self._layer(name, event.value))
        self.now = ui.table(columns=NOW_COLUMNS, rows=[], row_key='name').props(
            'dense flat hide-pagination :rows-per-page-options="[0]"').classes('w-full fb-table')

    def _build_views(self) -> None:
        with ui.tabs().props('dense no-caps align=left').classes('w-full') as tabs:
            for name in ('Curves', 'Forces', 'Polygons', 'Extrema', 'Facts'):
                ui.tab(name)
        self.tabs = tabs
        tabs.on_value_change(lambda: self.draw())
        with ui.tab_panels(tabs, value='Curves', animated=False, keep_alive=True).classes(
                'w-full bg-transparent'):
            with ui.tab_panel('Curves').classes('q-pa-none'):
                ui.select(list(self.shown.quantities), value=self.names, multiple=True,
                          label='quantities', on_change=lambda event: self._choose(event.value)
                          ).props('dense use-chips aria-label="quantities"').classes('w-full')
                self.curves = ui.echart({}).classes('w-full').props(
                    'role=img aria-label="curves over the input, extrema marked"')
            with ui.tab_panel('Forces').classes('q-pa-none'):
                self.polar = ui.echart({}).style('width:400px;height:380px').props(
                    'role=img aria-label="polar diagram of the shaking force and reactions"')
            with ui.tab_panel('Polygons').classes('q-pa-none'):
                self.polygons = []
                for name in ('velocity', 'acceleration'):
                    ui.label(f'{name} polygon')
                    self.polygons.append(ui.interactive_image(
                        size=(WIDTH, HEIGHT), sanitize=False).classes('w-full fb-picture').props(
                            f'role=img aria-label="{name} polygon"'))
            with ui.tab_panel('Extrema').classes('q-pa-none'):
                self.table = ui.table(columns=EXTREMA_COLUMNS, rows=[], row_key='key',
                                      on_select=None).props(
                    'dense flat hide-pagination :rows-per-page-options="[0]"').classes(
                    'w-full fb-table')
                self.table.on('rowClick', lambda event: self._go(event.args[1]['input']))
            with ui.tab_panel('Facts').classes('q-pa-none'):
                self.facts = ui.table(columns=[{'name': name, 'label': '', 'field': name,
                                                'align': 'left'} for name in ('name', 'text')],
                                      rows=[], row_key='name').props(
                    'dense flat hide-header hide-pagination wrap-cells '
                    ':rows-per-page-options="[0]"').classes('w-full')

    # --- what changes ---------------------------------------------------------------------------

    def change(self, name: str, value: Any) -> None:
        """Take a new value of a parameter, and show the mechanism that has it."""
        if value is None:
            return self._refuse(f'{name} must be given')
        if value != self.values.get(name):
            self.values = self.values | {name: value}
            self.rebuild()
        return None

    def _set_acceleration(self, value: float | None) -> None:
        if value is not None and isfinite(value):
            self.acceleration = value
            self.rebuild()

    def rebuild(self, keep_problem: bool = False) -> None:
        """Compute all that is shown again; what is impossible takes the picture away."""
        try:
            found = shown_of(self.values, self.acceleration)
            view, per_newton = mechanism_view(found), force_scale(found)
        except FourBarError as error:
            return self._refuse(str(error))
        self.problem = self.problem if keep_problem else ''
        self.shown, self.view, self.per_newton, self.is_possible = found, view, per_newton, True
        self.course.follow(found)
        self.words.set_text(found.linkage.description)
        self._set_input()
        self.velocity_view, self.acceleration_view = (
            polygon_view([polygon(motion) for motion, _ in found.poses])
            for polygon in (found.linkage.velocity_polygon, found.linkage.acceleration_polygon))
        self.traces.content = traces_svg(found, view) if self.layers.curves else ''
        self.facts.rows = [{'name': name, 'text': text} for name, text in facts(found.linkage)]
        self._draw_charts()
        self.draw()
        self._remember()
        return None

    def _refuse(self, why: str) -> None:
        """Show why there is nothing to show, and no old picture."""
        self.is_possible = False
        self.alarm.set_text(why)
        self.picture.content = self.traces.content = ''
        for polygon in self.polygons:
            polygon.content = ''
        for table in (self.now, self.table, self.facts):
            table.rows = []
        for chart in (self.curves, self.polar):
            chart.options.clear()
            chart.run_chart_method('clear')
        self.words.set_text('impossible')

    def _draw_charts(self) -> None:
        self.names = [name for name in self.names if name in self.shown.quantities]
        is_dark = bool(self.dark.value)
        self.extrema = self.shown.extrema(self.names)
        self._set_chart(self.curves, self.course.curves(self.names, self.extrema, is_dark))
        self.curves.style(f'height:{charts.height(len(self.names))}px')
        self.polar.set_visibility(self.shown.linkage.bodies is not None)
        if self.shown.linkage.bodies is not None:
            self._set_chart(self.polar, charts.polar(self.shown, is_dark))
        self.table.rows = extrema_rows(self.shown, self.extrema)

    @staticmethod
    def _set_chart(chart: Any, options: dict[str, Any]) -> None:
        chart.options.clear()
        chart.options.update(options)
        chart.update()

    def draw(self, with_table: bool = True) -> None:
        """Draw the present pose in every picture, and its numbers."""
        if not self.is_possible:
            return
        status, motion, loads = self.shown.pose(*self.course.state())
        self.alarm.set_text(self.problem if status == OK else
                            f'{STATUS_NAMES[status]} at {self.course.label} {self.course.at:.6g}')
        if status != OK:
            self.picture.content, self.now.rows = '', []
            return
        self.pose = motion, loads
        self.picture.content = mechanism_svg(self.shown, motion, loads, self.view,
                                             self.per_newton, self.layers)
        if with_table:
            self.now.rows = now_rows(self.shown, motion, loads)
        at = self.course.at
        if self.tabs.value == 'Curves':
            self.curves.run_chart_method('setOption', charts.cursors(len(self.names), at))
        elif self.tabs.value == 'Forces' and loads is not None:
            self.polar.run_chart_method('setOption', charts.polar_now(self.shown, loads))
        elif self.tabs.value == 'Polygons':
            linkage = self.shown.linkage
            self.polygons[0].content = polygon_svg(linkage.velocity_polygon(motion),
                                                   self.velocity_view, 'm/s')
            self.polygons[1].content = polygon_svg(linkage.acceleration_polygon(motion),
                                                   self.acceleration_view, 'm/s²')

    # --- transport ------------------------------------------------------------------------------

    def _set_input(self) -> None:
        low, high = self.course.bounds
        self.slider.props(f'min={low!r} max={high!r} step={(high - low) / 720.0!r}')
        self.field.props(f'label="{self.course.label}"')
        self._show_input()

    def _show_input(self) -> None:
        at = float(f'{self.course.at:.9g}')
        self.slider.value = self.field.value = at

    def _go(self, at: float | None) -> None:
        """Go to an input given in the unit of the page."""
        if at is None or not isfinite(at) or abs(at - self.course.at) <= 1e-8 * max(1.0, abs(at)):
            return
        self.course.go(at)
        self._show_input()
        self.draw()
        self._remember()

    def _play(self) -> None:
        if self.timer.active:
            self.timer.deactivate()
            self._show_input()
            self.draw()
            self._remember()
        else:
            self.last = time.monotonic()
            self.timer.activate()
        self.play.props(f'icon={"pause" if self.timer.active else "play_arrow"}')

    async def _tick(self) -> None:
        if self.is_behind:
            return
        self._advance()
        if self.frames % CATCH_UP == 0:
            self.is_behind = True
            with contextlib.suppress(TimeoutError):
                await ui.run_javascript('0', timeout=PATIENCE)
            self.is_behind = False

    def _advance(self) -> None:
        now = time.monotonic()
        self.course.advance(min(now - self.last, 0.2))
        self.last, self.frames = now, self.frames + 1
        self.draw(with_table=self.frames % TABLE_EVERY == 0)
        self._show_input()

    def _mouse(self, event: Any) -> None:
        pixel = event.image_x, event.image_y
        if event.type == 'mousedown':
            self.handle = (Handle(self.shown, self.pose[0], self.view, pixel)
                           if self.course.can_drag and self.is_possible else None)
        elif event.type == 'mousemove' and self.handle and self.handle.joint and event.buttons:
            self.course.go(self.shown.shown_input(
                self.handle.input_at(pixel, self.course.state().position)))
            self._show_input()
            self.draw()
        elif self.handle and event.type in ('mouseup', 'mouseleave'):
            self.handle = None
            self._remember()

    def _layer(self, name: str, value: bool) -> None:
        self.layers = self.layers._replace(**{name: value})
        self.traces.content = traces_svg(self.shown, self.view) if self.layers.curves else ''
        self.draw()

    def _choose(self, names: list[str]) -> None:
        self.names = list(names)
        self._draw_charts()
        self.draw()

    def _switch_dark(self) -> None:
        self.dark.set_value(not self.dark.value)
        self._draw_charts()
        self.draw()

    def _remember(self) -> None:
        """Put the state into the address of the page."""
        query = address.address(self.title, self.first, self.values, self.course.at,
                                self.acceleration)
        ui.run_javascript(f'history.replaceState(null, "", "?{query}")')
