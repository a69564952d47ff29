# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The page of a scene: its state, and how it answers to its user.

Everything on the page is state of its elements, never a command to them: whatever arrives late,
twice or not at all, a browser ends with the newest state. The address of the page holds that
state, so that a link shows the same; it names shipped scenes and parameters, never a file.
"""
from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
import contextlib
from math import isfinite
import time
from typing import Any, NamedTuple
from urllib.parse import urlencode

from fourbar_lab.drawing.axis import AXIS_ANGLE
from fourbar_lab.drawing.mobility import octahedron_svg
from fourbar_lab.drawing.tables import facts
from fourbar_lab.live import charts
from fourbar_lab.live.model import Pose, Shown
from fourbar_lab.live.model import shown as shown_of
from fourbar_lab.live.picture import (
    force_scale,
    ghost_svg,
    grips_svg,
    Handle,
    Layers,
    mechanism_svg,
    mechanism_view,
    polygon_svg,
    polygon_view,
    traces_svg,
)
from fourbar_lab.live.playback import CyclePlayback, Playback
from fourbar_lab.live.tables import extrema_rows, joint_rows, now_rows
from fourbar_lab.live.widgets import CURVES, Elements, EXTREMA, FACTS, FORCES, POLYGONS, set_chart
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.pipeline.status import INVALID_INPUT, OK, OUT_OF_RANGE, STATUS_NAMES
from fourbar_ros.scene import files, parameters
from fourbar_ros.scene.settings import ParameterValues
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

    ``title`` is the name of the scene, or of what else is shown; ``values`` its parameters;
    ``query`` that of the page's address, which may change them; ``playback`` makes what moves the
    input, by default :class:`.CyclePlayback`.
    """

    def __init__(self, title: str, values: ParameterValues, query: dict[str, str],
                 playback: Callable[[Shown], Playback] | None = None):
        """Take the state from the query; of a bad one, say so and show the scene as it is."""
        link = Link(title, values, values, at=None, acceleration=0.0)
        self.problem = ''                       # why something was not done, for the alarm
        try:
            link = read(query, title, values)
            self.shown = shown_of(link.values, link.acceleration)
        except FourBarError as error:
            link, self.problem = link._replace(values=link.first, acceleration=0.0), str(error)
            self.shown = shown_of(link.values)
        self.title, self.acceleration = link.title, link.acceleration
        self.first, self.values = link.first, link.values       # of the scene, and as changed here
        self.playback = (playback(self.shown) if playback
                         else CyclePlayback(self.shown, self.shown.scene.drive.start))
        if link.at is not None:
            self.playback.go(link.at)
        self.names = self.shown.usual_quantities        # whose curves are drawn
        self.layers = Layers()                          # what is drawn beside the links
        self.handle: Handle | None = None               # the joint that is dragged
        self.pose: Pose | None = None                   # what is drawn now; None: nothing
        self.refusal = self.no_pose = ''         # why there is no mechanism, why it has no pose
        self.last, self.frames = time.monotonic(), 0        # of the playback: time, number of it
        self.is_behind = False                              # the browser, with its frames

    def build(self) -> None:
        """Build the elements of the page and fill them."""
        self.client = ui.context.client
        self.elements = Elements(self)
        self.views = Views(self)
        self.timer = ui.timer(FRAME, self._tick, active=False)
        ui.timer(0.0, self._ask_dark, once=True)
        self.rebuild(keep_problem=True)

    # --- what changes ---------------------------------------------------------------------------

    def change(self, name: str, value: float) -> Awaitable[None] | None:
        """Take a new value of a parameter, and show the mechanism that has it."""
        self.values = {**self.values, name: value}
        self.rebuild()
        return None

    def refuse(self, why: str) -> None:
        """Say why something is not done; the page stays as it is."""
        self.problem = why
        self.elements.alarm.set_text('; '.join(filter(None, (why, self.refusal))))

    def set_acceleration(self, value: float) -> None:
        """Take a new acceleration of the input."""
        self.acceleration = value
        self.rebuild()

    def rebuild(self, keep_problem: bool = False) -> None:
        """
        Compute and draw all that is shown again, after a change of parameters.

        Parameters that no mechanism can have take the picture away, with the reason.
        """
        try:
            shown = shown_of(self.values, self.acceleration, self.playback.speed)
            view = mechanism_view(shown, *(other for other, _ in self.playback.others()))
            per_newton = force_scale(shown)
        except FourBarError as error:
            return self._show_nothing(str(error))
        self.problem = self.problem if keep_problem else ''
        self.shown, self.view, self.per_newton, self.refusal = shown, view, per_newton, ''
        self.names = [name for name in self.names if name in shown.quantities]
        self.playback.follow(shown)
        self.elements.words.set_text(shown.linkage.description)
        self._set_input()
        self._draw_traces()
        self.views.expire()
        self.draw()
        self.show_view()
        self._remember()
        return None

    def _show_nothing(self, why: str) -> None:
        """Show why there is nothing to show, and no old picture."""
        self.refusal, self.pose = why, None
        self.elements.alarm.set_text(why)
        self.elements.clear_pose()
        self.elements.picture.draw_under('')
        self.views.clear()
        self.elements.words.set_text('impossible')

    def _draw_traces(self) -> None:
        """Draw the coupler curves, which lie below the mechanism and change seldom."""
        self.elements.picture.draw_under(traces_svg(self.shown, self.view)
                                         if self.layers.curves and not self.refusal else '')

    def draw(self, with_table: bool = True) -> None:
        """
        Draw the present pose in the picture and in the view that is open, and its numbers.

        Runs to compare with are drawn below it, pale, and their numbers stand beside.
        """
        if self.refusal:
            return
        status, pose = self.shown.pose(*self.playback.state())
        self.no_pose = '' if status == OK else self._why_no_pose(status)
        self.elements.alarm.set_text(self.no_pose or self.problem or self.playback.warning())
        if self.no_pose:
            self.pose = None
            self.elements.clear_pose()
            return
        self.pose = pose
        others: list[tuple[Shown, Pose | None]] = []        # in the other runs at this moment
        for shown, state in self.playback.others():
            status, its_pose = shown.pose(*state) if state else (OUT_OF_RANGE, None)
            others.append((shown, its_pose if status == OK else None))
        ghosts = ''.join(ghost_svg(shown, its_pose, self.view) for shown, its_pose in others
                         if its_pose)
        grips = grips_svg(self.shown, pose, self.view) if self.playback.can_drag else ''
        self.elements.picture.content = ghosts + mechanism_svg(
            self.shown, pose, self.view, self.per_newton, self.layers) + grips
        if with_table:
            self.elements.now.rows = now_rows(
                self.shown.values(pose),
                [shown.values(its_pose) if its_pose else {} for shown, its_pose in others],
                self.shown.labels.forces if self.shown.labels.words else {})
        self.views.show(pose)

    def _why_no_pose(self, status: int) -> str:
        """Return a status with the input that has it, for the alarm of the page."""
        text = f'{STATUS_NAMES[status]} at {self.playback.label} {self.playback.at:.6g}'
        _, rate, acceleration = self.playback.state()
        return text if status != INVALID_INPUT else (
            f'{text}, rate {rate:.6g}, acceleration {acceleration:.6g}: too large, or unknown')

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
        """Give slider and field the bounds, label and value of the playback."""
        low, high = self.playback.bounds
        self.elements.slider.set_range(low, high, (high - low) / 720.0)
        self.elements.field.props(f'label="{self.playback.label}"')
        self._show_input()

    def _show_input(self) -> None:
        self.elements.slider.value = self.elements.field.value = rounded(self.playback.at)

    def go(self, at: float) -> None:
        """Go to an input given in the unit of the page."""
        self.playback.go(rounded(at))
        self.problem = ''
        self._show_input()
        self.draw()
        self._remember()

    def play(self) -> None:
        """Let the playback go on, or stop it."""
        if self.timer.active:
            self.timer.deactivate()
            self.playback.go(rounded(self.playback.at))     # what the address can say
            self._show_input()
            self.draw()
            self._remember()
        else:
            self.last = time.monotonic()
            self.timer.activate()
        self.elements.play.props(f'icon={"pause" if self.timer.active else "play_arrow"}')

    async def _tick(self) -> None:
        """
        Draw the next frame while the playback goes on.

        Now and then the browser must answer before there is another: a slow one would else get
        frames faster than it shows them, and lag behind more and more.
        """
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
        """Move the playback on by the time that has passed, at most 0.2 s, and draw it."""
        now = time.monotonic()
        self.playback.advance(min(now - self.last, 0.2))
        self.last, self.frames = now, self.frames + 1
        self.draw(with_table=self.frames % TABLE_EVERY == 0)
        self._show_input()

    def take(self, pixel: tuple[float, float]) -> None:
        """Take the joint at a pixel of the picture."""
        self.handle = (Handle(self.shown, self.pose, self.view, pixel)
                       if self.playback.can_drag and self.pose else None)

    def drag(self, pixel: tuple[float, float]) -> None:
        """Bring the joint that is held to a pixel of the picture, as near as it gets."""
        if self.handle and self.handle.joint:
            self.playback.go(rounded(self.shown.shown_input(
                self.handle.input_at(pixel, self.playback.state().position))))
            self._show_input()
            self.draw()

    def leave(self) -> None:
        """Let go of the joint that is held."""
        self.handle = None
        self._remember()

    def set_layer(self, name: str, value: bool) -> None:
        """Show or hide one of :class:`~fourbar_lab.live.picture.Layers`."""
        self.layers = self.layers._replace(**{name: value})
        self._draw_traces()
        self.draw()
        if name == 'axis':      # with its angle beside the curves
            others = [quantity for quantity in self.names if quantity != AXIS_ANGLE]
            self.elements.chosen.set_value(others + [AXIS_ANGLE] * value)

    def choose(self, names: list[str]) -> None:
        """Draw the curves of these quantities, and find their extrema."""
        self.names = list(names)
        self._refill()

    def set_difference(self, value: bool) -> None:
        """Draw by how much the other run's curves are larger, or the curves of both."""
        self.playback.is_difference = value
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
        """
        Draw the open view anew, after another choice of what it shows or how.

        The other views are out of date too, and filled when they are opened. While no mechanism
        can be shown, they stay empty.
        """
        if not self.refusal:
            self.views.expire()
            self.show_view()

    def _remember(self) -> None:
        """Put the state into the address of the page."""
        query = address(self.title, self.first, self.values, self.playback.at,
                        self.acceleration)
        ui.run_javascript(f'history.replaceState(null, "", "?{query}")')


class Views:
    """
    What the views of a page show: curves, forces, polygons, extrema, facts.

    Filling one takes a search or a large message, so only the view that is open is filled, once
    for each mechanism.
    """

    def __init__(self, page: Page):
        """Begin with no view filled."""
        self.page, self.elements = page, page.elements
        self.extrema: list[Extremum] | None = None      # of the mechanism that is shown
        self.polar_bound = 1.0              # [N] at the edge of the polar diagram
        self._fresh: set[str] = set()       # names of views that show the present mechanism
        # {name of a view: what fills it}
        self._fill: dict[str, Callable[[], None]] = {
            CURVES: self._fill_curves, FORCES: self._fill_forces,
            POLYGONS: self._fill_polygons, EXTREMA: self._fill_extrema, FACTS: self._fill_facts}

    def expire(self) -> None:
        """Note that another mechanism is shown: all views must be filled again."""
        self.extrema = None
        self._fresh.clear()
        self.elements.clear_views(besides=self.elements.tabs.value)

    def clear(self) -> None:
        """Take away the pictures and numbers of all views."""
        self._fresh.clear()
        self.elements.clear_views()

    def fill(self) -> None:
        """Fill the view that is open, if it is out of date."""
        name = self.elements.tabs.value
        if name not in self._fresh:
            self._fresh.add(name)
            self._fill[name]()

    def show(self, pose: Pose) -> None:
        """Mark a pose in the view that is open: a cursor, dots or polygons."""
        page, elements, name = self.page, self.elements, self.elements.tabs.value
        if name not in self._fresh:
            return
        if name == CURVES:
            elements.cursor.style(charts.cursor_style(page.playback.at, *page.playback.bounds))
            elements.cursor.set_visibility(bool(page.names))
        elif name == FORCES and pose.loads is not None:
            elements.dots.content = charts.polar_now(page.shown, pose.loads, self.polar_bound,
                                                     elements.is_dark)
        elif name == POLYGONS:
            linkage = page.shown.linkage
            arrows = (linkage.velocity_polygon(pose.motion),
                      linkage.acceleration_polygon(pose.motion))
            for picture, drawn, view, unit in zip(elements.polygons, arrows, self.polygon_views,
                                                  ('m/s', 'm/s²')):
                picture.content = polygon_svg(drawn, view, unit, page.shown.labels.letters)

    @property
    def found(self) -> list[Extremum]:
        """Return the extrema of the quantities chosen, searched for once."""
        if self.extrema is None:
            self.extrema = self.page.shown.extrema(self.page.names)
        return self.extrema

    def _fill_curves(self) -> None:
        """Draw the curves of the chosen quantities, over the input with extrema, or over time."""
        page, elements = self.page, self.elements
        extrema = self.found if page.playback.has_extrema else []
        set_chart(elements.curves, page.playback.curves(page.names, extrema, elements.is_dark))
        elements.curves.style(f'height:{charts.height(len(page.names))}px')

    def _fill_forces(self) -> None:
        """Draw the polar diagram of the forces, or say why there are no loads."""
        why = self.page.shown.why_no_loads
        has_loads = not why
        self.elements.no_loads.set_visibility(bool(why))
        self.elements.no_loads.set_text(f'no loads: {why}')
        options = charts.polar(self.page.shown, self.elements.is_dark) if has_loads else {}
        set_chart(self.elements.polar, options)
        self.polar_bound = options['xAxis']['max'] if has_loads else 1.0

    def _fill_polygons(self) -> None:
        """Find a scale for each polygon that suits all poses; :meth:`show` draws them."""
        linkage = self.page.shown.linkage
        self.polygon_views = [
            polygon_view([polygon(pose.motion) for pose in self.page.shown.poses])
            for polygon in (linkage.velocity_polygon, linkage.acceleration_polygon)]

    def _fill_extrema(self) -> None:
        self.elements.extrema.rows = extrema_rows(self.page.shown, self.found)

    def _fill_facts(self) -> None:
        """Show type, ranges and letters of the mechanism, and where it is among all four-bars."""
        rows = [*facts(self.page.shown.scene.bare_linkage), *joint_rows(self.page.shown)]
        self.elements.octahedron.content = octahedron_svg(self.page.shown.linkage)
        self.elements.facts.rows = [{'name': name, 'text': text} for name, text in rows]


AT, ACCELERATION, SCENE = 'at', 'acceleration', 'scene'


class BadLink(FourBarError, ValueError):
    """The address of a page names something that does not exist; the message says what."""


class Link(NamedTuple):
    """What an address asks for."""

    title: str                      # of the scene
    first: ParameterValues          # the scene's own
    values: ParameterValues         # with those that the link changes
    at: float | None                # the input in the unit of the page; None: not given
    acceleration: float             # of the input


def rounded(at: float) -> float:
    """Return an input as the page and its address have it: with nine digits."""
    return float(f'{at:.9g}')


def address(title: str, first: ParameterValues, values: ParameterValues, at: float,
            acceleration: float) -> str:
    """Return the query of the state: the scene by name, the input, and each changed parameter."""
    changed = {name: repr(value) if isinstance(value, float) else value
               for name, value in values.items()
               if value != first.get(name, value) and value == value}
    return urlencode({SCENE: title, AT: f'{rounded(at):.9g}', **changed,
                      **({ACCELERATION: f'{acceleration:g}'} if acceleration else {})})


def read(query: Mapping[str, str], title: str, values: ParameterValues) -> Link:
    """
    Return the :class:`Link` of a query to a page that serves a scene.

    BadLink if it is to another scene, unless that comes with this software; if it names an unknown
    parameter; or if input or acceleration is no number.
    """
    first, scene = dict(values), query.get(SCENE, title)
    if scene != title:
        shipped = {file.stem: file for file in files.folder().glob('*.yaml')}
        if scene not in shipped:
            raise BadLink(f'the link is to the scene {scene}, this page shows {title}: '
                          f'fourbar live {scene}')
        first = parameters.check(files.read_values(shipped[scene]))
    numbers: dict[str, float] = {}
    changed: dict[str, Any] = {}
    for name, text in query.items():
        value = files.parse(text)
        if name in (AT, ACCELERATION):
            if (isinstance(value, bool) or not isinstance(value, (int, float))
                    or not isfinite(value)):
                raise BadLink('the link has '
                              f'{InvalidParameter(name, text, "must be a finite number")}')
            numbers[name] = float(value)
        elif name != SCENE:
            if parameters.find(name) is None:
                raise BadLink(f'the link has the unknown parameter {name}')
            changed[name] = value
    return Link(scene, first, {**first, **changed}, numbers.get(AT),
                numbers.get(ACCELERATION, 0.0))
