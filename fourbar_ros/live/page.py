# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page of a scene shows, and how it answers to its user; :mod:`elements` is its form."""
from __future__ import annotations

from collections.abc import Callable
import contextlib
from math import isfinite
import time
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.live import address, charts
from fourbar_ros.live.course import Course, OverInput
from fourbar_ros.live.dragging import Handle
from fourbar_ros.live.elements import Elements, set_chart
from fourbar_ros.live.model import Shown
from fourbar_ros.live.model import shown as shown_of
from fourbar_ros.live.picture import (
    force_scale,
    Layers,
    mechanism_svg,
    mechanism_view,
    polygon_svg,
    polygon_view,
    traces_svg,
)
from fourbar_ros.live.tables import extrema_rows, now_rows
from fourbar_ros.pipeline.status import OK, STATUS_NAMES
from fourbar_ros.report.tables import facts
from nicegui import ui

FRAME = 1.0 / 30.0          # [s]
CATCH_UP = 6                # frames: so many at most wait for a browser that is slower
PATIENCE = 10.0             # [s] ... and so long
TABLE_EVERY = 5             # frames: numbers that change faster cannot be read


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
        Query of the address of the page.
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

    def build(self) -> None:
        """Build the elements of the page and fill them."""
        self.elements = Elements(self)
        self.timer = ui.timer(FRAME, self._tick, active=False)
        self.rebuild(keep_problem=True)
        # the pictures are drawn over images of nothing, which readers of screens shall skip
        ui.run_javascript("document.querySelectorAll('img:not([alt])').forEach(i => {i.alt = ''})")

    # --- what changes ---------------------------------------------------------------------------

    def change(self, name: str, value: Any) -> None:
        """Take a new value of a parameter, and show the mechanism that has it."""
        if value is None:
            return self._refuse(f'{name} must be given')
        if value != self.values.get(name):
            self.values = self.values | {name: value}
            self.rebuild()
        return None

    def set_acceleration(self, value: float | None) -> None:
        """Take a new acceleration of the input."""
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
        self.elements.words.set_text(found.linkage.description)
        self._set_input()
        self.polygon_views = [
            polygon_view([polygon(motion) for motion, _ in found.poses])
            for polygon in (found.linkage.velocity_polygon, found.linkage.acceleration_polygon)]
        self._draw_traces()
        self.elements.facts.rows = [{'name': name, 'text': text}
                                    for name, text in facts(found.linkage)]
        self._draw_charts()
        self.draw()
        self._remember()
        return None

    def _refuse(self, why: str) -> None:
        """Show why there is nothing to show, and no old picture."""
        self.is_possible = False
        self.elements.alarm.set_text(why)
        self.elements.clear()
        self.elements.words.set_text('impossible')

    def _draw_traces(self) -> None:
        self.elements.traces.content = (traces_svg(self.shown, self.view) if self.layers.curves
                                        else '')

    def _draw_charts(self) -> None:
        self.names = [name for name in self.names if name in self.shown.quantities]
        is_dark = bool(self.elements.dark.value)
        self.extrema = self.shown.extrema(self.names)
        set_chart(self.elements.curves, self.course.curves(self.names, self.extrema, is_dark))
        self.elements.curves.style(f'height:{charts.height(len(self.names))}px')
        self.elements.polar.set_visibility(self.shown.linkage.bodies is not None)
        if self.shown.linkage.bodies is not None:
            set_chart(self.elements.polar, charts.polar(self.shown, is_dark))
        self.elements.extrema.rows = extrema_rows(self.shown, self.extrema)

    def draw(self, with_table: bool = True) -> None:
        """Draw the present pose in every picture, and its numbers."""
        if not self.is_possible:
            return
        status, motion, loads = self.shown.pose(*self.course.state())
        self.elements.alarm.set_text(
            self.problem if status == OK else
            f'{STATUS_NAMES[status]} at {self.course.label} {self.course.at:.6g}')
        if status != OK:
            self.elements.clear_pose()
            return
        self.pose = motion, loads
        self.elements.picture.content = mechanism_svg(self.shown, motion, loads, self.view,
                                                      self.per_newton, self.layers)
        if with_table:
            self.elements.now.rows = now_rows(self.shown, motion, loads)
        self._draw_view(motion, loads)

    def _draw_view(self, motion: Any, loads: Any) -> None:
        """Draw the present pose in the tab that is open."""
        elements, linkage = self.elements, self.shown.linkage
        if elements.tabs.value == 'Curves':
            elements.curves.run_chart_method('setOption',
                                             charts.cursors(len(self.names), self.course.at))
        elif elements.tabs.value == 'Forces' and loads is not None:
            elements.polar.run_chart_method('setOption', charts.polar_now(self.shown, loads))
        elif elements.tabs.value == 'Polygons':
            arrows = linkage.velocity_polygon(motion), linkage.acceleration_polygon(motion)
            for picture, *drawn in zip(elements.polygons, arrows, self.polygon_views,
                                       ('m/s', 'm/s²')):
                picture.content = polygon_svg(*drawn)

    # --- transport ------------------------------------------------------------------------------

    def _set_input(self) -> None:
        low, high = self.course.bounds
        self.elements.slider.props(f'min={low!r} max={high!r} step={(high - low) / 720.0!r}')
        self.elements.field.props(f'label="{self.course.label}"')
        self._show_input()

    def _show_input(self) -> None:
        at = float(f'{self.course.at:.9g}')
        self.elements.slider.value = self.elements.field.value = at

    def go(self, at: float | None) -> None:
        """Go to an input given in the unit of the page."""
        if at is None or not isfinite(at) or abs(at - self.course.at) <= 1e-8 * max(1.0, abs(at)):
            return
        self.course.go(at)
        self._show_input()
        self.draw()
        self._remember()

    def play(self) -> None:
        """Let the course go on, or stop it."""
        if self.timer.active:
            self.timer.deactivate()
            self._show_input()
            self.draw()
            self._remember()
        else:
            self.last = time.monotonic()
            self.timer.activate()
        self.elements.play.props(f'icon={"pause" if self.timer.active else "play_arrow"}')

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

    def on_mouse(self, event: Any) -> None:
        """Drag a joint of the picture."""
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

    def set_layer(self, name: str, value: bool) -> None:
        """Show or hide one of :class:`~fourbar_ros.live.picture.Layers`."""
        self.layers = self.layers._replace(**{name: value})
        self._draw_traces()
        self.draw()

    def choose(self, names: list[str]) -> None:
        """Draw the curves of these quantities, and find their extrema."""
        self.names = list(names)
        self._draw_charts()
        self.draw()

    def switch_dark(self) -> None:
        """Turn from light to dark or back."""
        self.elements.dark.set_value(not self.elements.dark.value)
        self._draw_charts()
        self.draw()

    def _remember(self) -> None:
        """Put the state into the address of the page."""
        query = address.address(self.title, self.first, self.values, self.course.at,
                                self.acceleration)
        ui.run_javascript(f'history.replaceState(null, "", "?{query}")')
