# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page of a scene shows, and how it answers to its user; :mod:`elements` is its form."""
from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
import contextlib
from math import isfinite
import time
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.live import address
from fourbar_ros.live.address import rounded
from fourbar_ros.live.course import Course, OverInput
from fourbar_ros.live.dragging import Handle
from fourbar_ros.live.elements import Elements
from fourbar_ros.live.model import Shown
from fourbar_ros.live.model import shown as shown_of
from fourbar_ros.live.picture import (
    force_scale,
    ghost_svg,
    Layers,
    mechanism_svg,
    mechanism_view,
    traces_svg,
)
from fourbar_ros.live.tables import now_rows, pose_values
from fourbar_ros.live.views import Views
from fourbar_ros.pipeline.status import OK, OUT_OF_RANGE, STATUS_NAMES
from nicegui import background_tasks, ui

FRAME = 1.0 / 30.0          # [s]
PICTURE_FIRST = 0.005       # [s] within which what was drawn leaves for the browser
VIEW_EVERY = 0.1            # [s] charts are filled so often at most
CATCH_UP = 6                # frames: so many at most wait for a browser that is slower
PATIENCE = 10.0             # [s] ... and so long
LIKES_DARK = "matchMedia('(prefers-color-scheme: dark)').matches"
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
        self.layers = Layers()
        self.handle: Handle | None = None
        self.pose: tuple[Any, Any] | None = None            # motion and loads
        self.refusal = self.no_pose = ''         # why there is no mechanism, why it has no pose
        self.last, self.frames, self.is_behind = time.monotonic(), 0, False

    def build(self) -> None:
        """Build the elements of the page and fill them."""
        self.client = ui.context.client
        self.elements = Elements(self)
        self.views = Views(self)
        self.timer = ui.timer(FRAME, self._tick, active=False)
        ui.timer(0.0, self._ask_dark, once=True)
        self.rebuild(keep_problem=True)
        # the pictures are drawn over images of nothing, which screen readers must skip
        ui.run_javascript("document.querySelectorAll('img:not([alt])').forEach(i => {i.alt = ''})")

    # --- what changes ---------------------------------------------------------------------------

    def change(self, name: str, value: Any) -> Awaitable[None] | None:
        """Take a new value of a parameter, and show the mechanism that has it."""
        if value is None:
            self._refuse(f'{name} must be given')
        elif value != self.values.get(name) or self.refusal:
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
            found = shown_of(self.values, self.acceleration, self.course.speed)
            view = mechanism_view(found, *(other for other, _ in self.course.others()))
            per_newton = force_scale(found)
        except FourBarError as error:
            return self._refuse(str(error))
        self.problem = self.problem if keep_problem else ''
        self.shown, self.view, self.per_newton, self.refusal = found, view, per_newton, ''
        self.names = [name for name in self.names if name in found.quantities]
        self.course.follow(found)
        self.elements.words.set_text(found.linkage.description)
        self._set_input()
        self._draw_traces()
        self.views.expire()
        self.draw()
        self.show_view()
        self._remember()
        return None

    def _refuse(self, why: str) -> None:
        """Show why there is nothing to show, and no old picture."""
        self.refusal, self.pose = why, None
        self.elements.alarm.set_text(why)
        self.elements.clear_pose()
        self.elements.traces.content = ''
        self.views.clear()
        self.elements.words.set_text('impossible')

    def _draw_traces(self) -> None:
        self.elements.traces.content = (traces_svg(self.shown, self.view)
                                        if self.layers.curves and not self.refusal else '')

    def draw(self, with_table: bool = True) -> None:
        """Draw the present pose in every picture, and its numbers."""
        if self.refusal:
            return
        status, motion, loads = self.shown.pose(*self.course.state())
        self.no_pose = '' if status == OK else (
            f'{STATUS_NAMES[status]} at {self.course.label} {self.course.at:.6g}')
        self.elements.alarm.set_text(self.no_pose or self.problem or self.course.warning())
        if self.no_pose:
            self.pose = None
            self.elements.clear_pose()
            return
        self.pose = motion, loads
        beside = [(other, *(other.pose(*state) if state else (OUT_OF_RANGE, None, None)))
                  for other, state in self.course.others()]
        ghosts = ''.join(ghost_svg(other, its, self.view) for other, status, its, _ in beside
                         if status == OK)
        self.elements.picture.content = ghosts + mechanism_svg(
            self.shown, motion, loads, self.view, self.per_newton, self.layers)
        if with_table:
            self.elements.now.rows = now_rows(
                pose_values(self.shown, motion, loads),
                [pose_values(other, *pose) if status == OK else {}
                 for other, status, *pose in beside])
        self.views.pose(motion, loads)

    async def _fill_view(self) -> None:
        """Fill the view that is open, after the picture is on its way."""
        await asyncio.sleep(PICTURE_FIRST)
        if self.refusal or self.client.is_deleted:
            return
        try:
            self.views.fill()
        except FourBarError as error:       # a search that is beyond the numbers
            self.views.clear()
            self.problem = str(error)
        self.draw(with_table=False)
        await asyncio.sleep(VIEW_EVERY)

    def show_view(self) -> None:
        """Fill the view that is open, once for all that asked for it meanwhile."""
        background_tasks.create_lazy(self._fill_view(), name=f'view of {self.client.id}')

    # --- transport ------------------------------------------------------------------------------

    def _set_input(self) -> None:
        low, high = self.course.bounds
        self.elements.slider.set_range(low, high, (high - low) / 720.0)
        self.elements.field.props(f'label="{self.course.label}"')
        self._show_input()

    def _show_input(self) -> None:
        self.elements.slider.value = self.elements.field.value = rounded(self.course.at)

    def go(self, at: float | None) -> None:
        """Go to an input given in the unit of the page."""
        if at is None or not isfinite(at):
            self._show_input()              # instead of nothing
            return
        if abs(at - self.course.at) <= 1e-8 * max(1.0, abs(at)):
            return
        self.course.go(rounded(at))
        self._show_input()
        self.draw()
        self._remember()

    def play(self) -> None:
        """Let the course go on, or stop it."""
        if self.timer.active:
            self.timer.deactivate()
            self.course.go(rounded(self.course.at))     # what the address can say
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
            try:
                with contextlib.suppress(TimeoutError):
                    await ui.run_javascript('0', timeout=PATIENCE)
            finally:
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
                           if self.course.can_drag and self.pose else None)
        elif event.type == 'mousemove' and self.handle and self.handle.joint and event.buttons:
            self.course.go(rounded(self.shown.shown_input(
                self.handle.input_at(pixel, self.course.state().position))))
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
        self._refill()

    def set_difference(self, value: bool) -> None:
        """Draw by how much the other run's curves are larger, or the curves of both."""
        self.course.is_difference = value
        self._refill()

    def switch_dark(self) -> None:
        """Turn from light to dark or back."""
        self.elements.dark.set_value(not self.elements.dark.value)
        self._refill()

    async def _ask_dark(self) -> None:
        """Be dark if the browser's user likes it so: charts cannot find that out themselves."""
        with contextlib.suppress(TimeoutError):
            if (await ui.run_javascript(LIKES_DARK, timeout=PATIENCE)
                    and self.elements.dark.value is None):
                self.switch_dark()

    def _refill(self) -> None:
        """Fill the views again, where there is something to show."""
        if not self.refusal:
            self.views.expire()
            self.show_view()

    def _remember(self) -> None:
        """Put the state into the address of the page."""
        query = address.address(self.title, self.first, self.values, self.course.at,
                                self.acceleration)
        ui.run_javascript(f'history.replaceState(null, "", "?{query}")')
