# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Downloads of a page: scene file, pictures, numbers, one page that needs no server."""
from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fourbar_ros.live.model import Shown
from fourbar_ros.live.picture import (
    document,
    HEIGHT,
    Layers,
    mechanism_svg,
    STYLE,
    traces_svg,
    WIDTH,
)
from nicegui import ui

FRAMES = 120             # pictures in a page of its own


def menu(page: Any) -> None:
    """Build the menu of downloads."""
    kinds = {'scene file (YAML)': ('yaml', lambda: page.shown.scene.as_text),
             'picture (SVG)': ('svg', lambda: picture(page)),
             'numbers of a cycle (CSV)': ('csv', lambda: cycle_csv(page.shown)),
             'page that needs no server (HTML)': ('html', lambda: html(page)),
             'animation (GIF)': ('gif', lambda: gif(page.shown))}
    button = ui.button(icon='download').props('flat dense color=white aria-label="download"')
    with button, ui.menu():
        for text, (suffix, make) in kinds.items():
            ui.menu_item(text, lambda suffix=suffix, make=make: _send(page, suffix, make))


def _send(page: Any, suffix: str, make: Any) -> None:
    content = make()
    ui.download.content(content, f'{page.title.rpartition("/")[2].removesuffix(".yaml")}.{suffix}')


def picture(page: Any) -> str:
    """Return the present picture as an SVG file."""
    return document(traces_svg(page.shown, page.view)
                    + mechanism_svg(page.shown, *page.pose, page.view, page.per_newton,
                                    page.layers))


def cycle_csv(shown: Shown) -> str:
    """Return every field of motion and loads over the ranges of the input, SI units."""
    text = io.StringIO()
    writer = csv.writer(text)
    for place, cycle in enumerate(shown.cycles):
        columns = dict(zip(cycle.motion._fields, cycle.motion))
        columns |= dict(zip(cycle.loads._fields, cycle.loads)) if cycle.loads else {}
        if place == 0:
            writer.writerow(columns)
        values = [value if getattr(value, 'shape', ()) else [value] * len(cycle.inputs)
                  for value in columns.values()]
        writer.writerows([repr(float(x)) for x in row] for row in zip(*values))
    return text.getvalue()


def html(page: Any) -> str:
    """Return a page of its own: the moving mechanism, its scene and its extrema, no server."""
    shown, frames = page.shown, []
    for cycle in shown.cycles:
        step = max(1, len(cycle.inputs) * len(shown.cycles) // FRAMES)
        for position in cycle.inputs[::step]:
            status, motion, loads = shown.pose(float(position))
            if status == 0:
                frames.append(mechanism_svg(shown, motion, loads, page.view, page.per_newton,
                                            Layers(page.layers.curves, page.layers.forces)))
    rows = ''.join(f'<tr><td>{row["quantity"]}</td><td>{row["kind"]}</td><td>{row["value"]}</td>'
                   f'<td>{row["unit"]}</td><td>{row["at"]}</td></tr>'
                   for row in page.elements.extrema.rows)
    return f"""<!doctype html><html lang="en"><meta charset="utf-8"><title>{page.title}</title>
<style>{STYLE}body{{font:16px sans-serif;max-width:60rem;margin:auto}}
td{{padding:0 .8em 0 0;font-variant-numeric:tabular-nums}}</style>
<h1>{page.title}</h1><p>{shown.linkage.description}</p>
<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="moving mechanism">
{traces_svg(shown, page.view)}
<g id="mechanism"></g></svg>
<p><button id="play">play or pause</button> <input id="at" type="range" min="0"
max="{len(frames) - 1}" value="0" aria-label="input" style="width:30rem"></p>
<h2>Extrema</h2><table>{rows}</table><h2>Scene</h2><pre>{shown.scene.as_text}</pre>
<script>const frames={json.dumps(frames)};let i=0,on=true;
const at=document.getElementById('at'),show=()=>{{document.getElementById('mechanism').innerHTML=
frames[i];at.value=i}};at.oninput=()=>{{on=false;i=+at.value;show()}};
document.getElementById('play').onclick=()=>{{on=!on}};
setInterval(()=>{{if(on){{i=(i+1)%frames.length;show()}}}},40);show()</script></html>"""


def gif(shown: Shown) -> bytes:
    """Return an animation of a cycle."""
    from fourbar_ros.report.animation import animate
    with TemporaryDirectory() as folder:
        path = Path(folder) / 'mechanism.gif'
        animate(shown.linkage, shown.rate, shown.points, path)
        return path.read_bytes()
