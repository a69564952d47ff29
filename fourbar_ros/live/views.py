# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The views beside the picture: each is filled when it is open and what it shows is out of date.

All that is on the page is state of its elements, never a command to them: whatever comes late,
twice or not at all, a browser ends with the newest state.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fourbar_ros.extrema.find import Extremum
from fourbar_ros.live import charts
from fourbar_ros.live.elements import CURVES, EXTREMA, FACTS, FORCES, POLYGONS, set_chart
from fourbar_ros.live.picture import polygon_svg, polygon_view
from fourbar_ros.live.tables import extrema_rows, joint_rows
from fourbar_ros.report.tables import facts


class Views:
    """
    What the views of a page show: curves, forces, polygons, extrema, facts.

    Parameters
    ----------
    page : Page
        With ``shown``, ``course``, ``names`` and ``elements``.

    """

    def __init__(self, page: Any):
        self.page, self.elements = page, page.elements
        self.extrema: list[Extremum] | None = None      # of the mechanism that is shown
        self.polar_bound = 1.0
        self._fresh: set[str] = set()
        self._fill: dict[str, Callable[[], None]] = {
            CURVES: self._fill_curves, FORCES: self._fill_forces,
            POLYGONS: self._fill_polygons, EXTREMA: self._fill_extrema, FACTS: self._fill_facts}

    def expire(self) -> None:
        """Another mechanism is shown: what is not open is emptied, all must be filled again."""
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

    def pose(self, motion: Any, loads: Any) -> None:
        """Show a pose in the view that is open."""
        page, elements, name = self.page, self.elements, self.elements.tabs.value
        if name not in self._fresh:
            return
        if name == CURVES:
            elements.cursor.style(charts.cursor_style(page.course.at, *page.course.bounds))
            elements.cursor.set_visibility(bool(page.names))
        elif name == FORCES and loads is not None:
            elements.dots.content = charts.polar_now(page.shown, loads, self.polar_bound)
        elif name == POLYGONS:
            linkage = page.shown.linkage
            arrows = linkage.velocity_polygon(motion), linkage.acceleration_polygon(motion)
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
        page, elements = self.page, self.elements
        extrema = self.found if page.course.has_extrema else []
        set_chart(elements.curves, page.course.curves(page.names, extrema, elements.is_dark))
        elements.curves.style(f'height:{charts.height(len(page.names))}px')

    def _fill_forces(self) -> None:
        has_loads = self.page.shown.linkage.bodies is not None
        self.elements.no_loads.set_visibility(not has_loads)
        options = charts.polar(self.page.shown, self.elements.is_dark) if has_loads else {}
        set_chart(self.elements.polar, options)
        self.polar_bound = options['xAxis']['max'] if has_loads else 1.0

    def _fill_polygons(self) -> None:
        linkage = self.page.shown.linkage
        self.polygon_views = [
            polygon_view([polygon(motion) for motion, _ in self.page.shown.poses])
            for polygon in (linkage.velocity_polygon, linkage.acceleration_polygon)]

    def _fill_extrema(self) -> None:
        self.elements.extrema.rows = extrema_rows(self.page.shown, self.found)

    def _fill_facts(self) -> None:
        rows = [*facts(self.page.shown.linkage), *joint_rows(self.page.shown)]
        self.elements.facts.rows = [{'name': name, 'text': text} for name, text in rows]
