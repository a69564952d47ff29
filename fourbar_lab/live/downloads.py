# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Downloads of a page: scene file, pictures, numbers, one page that needs no server."""
from __future__ import annotations

from collections.abc import Callable
from html import escape
import json
from typing import TYPE_CHECKING

from fourbar_lab.drawing.curves import rows_of
from fourbar_lab.live.model import Shown
from fourbar_lab.live.picture import document, mechanism_svg, traces_svg, USUAL
from fourbar_lab.live.svg import HEIGHT, PRINTED_STYLE, WIDTH
from fourbar_lab.live.tables import extrema_rows
from fourbar_ros.errors import FourBarError
from fourbar_ros.spreadsheet import CsvStyle
from nicegui import run, ui

if TYPE_CHECKING:
    from fourbar_lab.live.page import Page

FRAMES = 120             # pictures in a page that needs no server
# The browser paints the SVG file: no package of ours could.
PAINT = f"""(svg, name) => {{
const image = new Image();
image.onload = () => {{
  const canvas = document.createElement('canvas'), link = document.createElement('a');
  [canvas.width, canvas.height] = [{3 * WIDTH:g}, {3 * HEIGHT:g}];
  canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
  link.href = canvas.toDataURL('image/png');
  link.download = name;
  link.click();
}};
image.src = 'data:image/svg+xml,' + encodeURIComponent(svg);
}}"""


def menu(page: Page) -> None:
    """Build the menu of downloads."""
    kinds = {'scene file (YAML)': ('yaml', lambda: page.shown.scene.as_text),
             'picture (SVG)': ('svg', lambda: picture(page)),
             'picture (PNG)': ('png', lambda: picture(page)),
             'numbers of a cycle (CSV)': ('csv', lambda: cycle_csv(page.shown)),
             'page that needs no server (HTML)': ('html', lambda: html(page))}
    button = ui.button(icon='download').props('flat dense color=white aria-label="download"')
    with button, ui.menu():
        for text, (suffix, make) in kinds.items():
            ui.menu_item(text, lambda suffix=suffix, make=make: _send(page, suffix, make))


async def _send(page: Page, suffix: str, make: Callable[[], str]) -> None:
    """
    Make a file in a thread, so that the page goes on, and send it; or say why there is none.

    A mechanism that cannot be assembled has no file at all, one without a pose no picture.
    """
    why = page.refusal if page.refusal or suffix not in ('svg', 'png', 'html') else page.no_pose
    if why:
        ui.notify(f'nothing to save: {why}', type='warning')
        return
    try:
        content = await run.io_bound(make)
    except FourBarError as error:
        ui.notify(str(error), type='negative')
        return
    name = f'{page.state.title.rpartition("/")[2].removesuffix(".yaml")}.{suffix}'
    if suffix == 'png':
        ui.run_javascript(f'({PAINT})({json.dumps(content)}, {json.dumps(name)})')
    else:
        ui.download.content(content, name)


def picture(page: Page) -> str:
    """Return the present picture as an SVG file."""
    assert page.pose is not None, 'nobody asks where there is no pose'
    return document(traces_svg(page.shown, page.view) + mechanism_svg(
        page.shown, page.pose, page.view, page.layers))


def cycle_csv(shown: Shown) -> str:
    """Return the table of ``fourbar table`` as CSV: angles in degrees, all else in SI."""
    return CsvStyle().text(*rows_of(shown.curves()))


def html(page: Page) -> str:
    """Return a page that needs no server: the moving mechanism, its scene and its extrema."""
    shown, title = page.shown, escape(page.state.title)
    frames = [mechanism_svg(shown, pose, page.view, page.layers & USUAL)
              for _, pose in shown.samples(FRAMES)]
    rows = ''.join(f'<tr><td>{row["quantity"]}</td><td>{row["kind"]}</td><td>{row["value"]}</td>'
                   f'<td>{row["unit"]}</td><td>{row["at"]}</td></tr>'
                   for row in extrema_rows(shown, shown.extrema(page.names)))
    return f"""<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title>
<style>{PRINTED_STYLE}body{{font:16px sans-serif;max-width:60rem;margin:auto}}
td{{padding:0 .8em 0 0;font-variant-numeric:tabular-nums}}</style>
<h1>{title}</h1><p>{shown.linkage.description}</p>
<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="moving mechanism">
{traces_svg(shown, page.view)}
<g id="mechanism"></g></svg>
<p><button id="play">play or pause</button> <input id="at" type="range" min="0"
max="{len(frames) - 1}" value="0" aria-label="input" style="width:30rem"></p>
<h2>Extrema</h2><table>{rows}</table>
<h2>Scene</h2><pre>{escape(shown.scene.as_text)}</pre>
<script>const frames={json.dumps(frames)};let i=0,on=true;
const at=document.getElementById('at'),show=()=>{{document.getElementById('mechanism').innerHTML=
frames[i];at.value=i}};at.oninput=()=>{{on=false;i=+at.value;show()}};
document.getElementById('play').onclick=()=>{{on=!on}};
setInterval(()=>{{if(on){{i=(i+1)%frames.length;show()}}}},40);show()</script></html>"""
