# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
From a move of the pointer to the picture in a real Chromium: ``python -m bench.page [SCENE]``.

A window of 1280 by 800. A joint is dragged around a circle with Move, and a pin or a pivot with
Shape, which makes lengths, ranges, curves and extrema anew.
"""
from pathlib import Path
from statistics import median
import sys
import tempfile

from bench.pages import table

MOVES, FIRST = 150, 10          # the first ones are not counted: the formulas are compiled
MEASURE = """
const [tool, moves, done] = arguments, svg = page.picture.svg, times = [], work = [];
const box = svg.getBoundingClientRect(), joint = svg.querySelector('.grip').dataset.joint;
const ground = Object.values(page.store.state.scene.linkage.points ?? {}).find(p => !p.link);
const from = tool === 'pose' || !ground ? page.engine.joint(joint) : [ground.x, ground.y];
const radius = tool === 'pose' ? Math.hypot(...from) : 60 / page.picture.scale;
const phase = tool === 'pose' ? Math.atan2(from[1], from[0]) : Math.PI / 2;
const centre = [from[0] - radius * Math.cos(phase), from[1] - radius * Math.sin(phase)];
const placeAt = i => [centre[0] + radius * Math.cos(phase + 0.04 * i),
                      centre[1] + radius * Math.sin(phase + 0.04 * i)];
const send = (target, type, place) => {
  const [x, y] = page.picture.pixels(place);
  target.dispatchEvent(new PointerEvent(type, { bubbles: true, pointerId: 1, button: 0,
    buttons: 1, clientX: box.left + x, clientY: box.top + y }));
};
svg.setPointerCapture = () => {};
page.useTool(tool);
send(tool === 'pose' ? svg.querySelector('.grip') : svg, 'pointerdown', from);
let i = 0;
const move = () => {
  if (i++ >= moves) return done([times, work]);
  const begin = performance.now(), painted = new MessageChannel();
  send(svg, 'pointermove', placeAt(i));
  work.push(performance.now() - begin);
  painted.port1.onmessage = () => {
    times.push(performance.now() - begin);
    setTimeout(move, 5);
  };
  requestAnimationFrame(() => painted.port2.postMessage(0));
};
setTimeout(move, 50);
"""


def main(scene='jansen'):
    """Print one row for each tool."""
    from fourbar_lab.live.page import page
    from fourbar_ros.scene.scene import load
    from support.browser import browser, Tab
    rows = []
    with tempfile.TemporaryDirectory() as folder, browser(f'{folder}/profile') as driver:
        driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
            'width': 1280, 'height': 800, 'deviceScaleFactor': 1, 'mobile': False})
        file = Path(folder, 'page.html')
        file.write_text(page(Path(scene).stem, load(scene)), encoding='utf-8')
        for tool in ('pose', 'shape'):
            times, work = Tab(driver, file.as_uri()).driver.execute_async_script(
                MEASURE, tool, MOVES)
            rows.append((tool, *(f'{value:.1f}' for values in (times, work) for value in (
                median(values[FIRST:]), sorted(values[FIRST:])[int(0.95 * (MOVES - FIRST))]))))
    table(('tool', 'to the picture: median [ms]', '95 % [ms]', 'work: median [ms]', '95 % [ms]'),
          rows)


if __name__ == '__main__':
    main(*sys.argv[1:])
