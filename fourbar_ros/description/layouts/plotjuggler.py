# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A layout for PlotJuggler, whose curves are named ``TOPIC/FIELD/OF/FIELD``."""
from __future__ import annotations

from fourbar_ros.description.elements import add, as_text, Element
from fourbar_ros.description.layouts.plots import NODE, plots_of
from fourbar_ros.scene.scene import Scene

COLOURS = ('#1f77b4', '#d62728', '#1ac938', '#ff7f0e', '#9467bd', '#17becf', '#bcbd22')
ROWS = 3               # plots below each other on a tab


def plotjuggler(scene: Scene, node: str = NODE) -> str:
    """Return the layout, XML."""
    root, plots = Element('root'), plots_of(scene, node)
    window = add(root, 'tabbed_widget', name='Main Window', parent='main_window')
    for first in range(0, len(plots), ROWS):
        part = plots[first:first + ROWS]
        tab = add(window, 'Tab', tab_name=part[0].title, containers='1')
        splitter = add(add(tab, 'Container'), 'DockSplitter', orientation='-',
                       count=str(len(part)),
                       sizes=';'.join([f'{1.0 / len(part):.6f}'] * len(part)))
        for plot in part:
            element = add(add(splitter, 'DockArea', name=plot.title), 'plot',
                          mode='TimeSeries', style='Lines')
            for number, curve in enumerate(plot.curves):
                add(element, 'curve', name=f'{curve.topic}/{curve.field.replace(".", "/")}',
                    color=COLOURS[number % len(COLOURS)])
    add(window, 'currentTabIndex', index='0')
    add(root, 'use_relative_time_offset', enabled='1')
    return as_text(root)
