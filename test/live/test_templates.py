# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Templates of PMKS+ drawn from nothing in a real browser, by clicks at their coordinates."""
from math import hypot

from fourbar_ros.mechanisms.machine.from_points import read_drawing
from fourbar_ros.mechanisms.picture import diagram_of
from mechanisms.machine.test_from_points import PUBLIC
import pytest
from support.browser import live, needs_browser

from .test_draw import assert_as_shown, Paper

pytestmark = [needs_browser, pytest.mark.slow]
WIDTH, HEIGHT = 520.0, 380.0        # [px] of a linkage as it is clicked
TEMPLATES = ('4_bar', 'watt_i', 'watt_ii', 'stephenson_iii', 'slider_crank', 'jansen_leg',
             'chebyshev_straight_line', 'windshield_wiper', 'pedaling_leg', 'derrick_crane')


@pytest.fixture(scope='module')
def file(tmp_path_factory):
    return tmp_path_factory.mktemp('scenes') / 'drawn.yaml'


@pytest.fixture(scope='module')
def address(file):
    file.write_text('/**:\n  ros__parameters:\n    linkage: {a1: 0.4, a2: 1.2, a3: 0.8, '
                    'a4: 1.0}\n')
    with live(file) as address:
        yield address


def beside(paper, owner, link, place):
    """Give a link a point where a dyad hangs beside its line; `owner`: its ends [px]."""
    (x, y), (u, v) = owner[link]
    size = hypot(u - x, v - y)
    if abs((place[0] - x) * (v - y) - (place[1] - y) * (u - x)) > 14.0 * size:
        paper.tool('point')
        paper.drag(paper.at(x + 0.4 * (u - x), y + 0.4 * (v - y)), paper.at(*place))


@pytest.mark.parametrize('name', TEMPLATES)
def test_a_template_drawn_by_clicks_is_what_show_says(driver, address, file, name, capsys):
    paper, public = Paper(driver, address), PUBLIC[name]
    drawing, points = read_drawing(*public.given), public.given[0]
    machine = drawing.machine
    x, y = zip(*points.values())
    scale = min(WIDTH / (max(x) - min(x)), HEIGHT / (max(y) - min(y)))
    pivot = points[next(joint for joint in public.links.split()[0] if joint in public.ground)]

    def pixels(u, v):
        return (scale * (pivot[0] + u - (max(x) + min(x)) / 2),
                scale * (pivot[1] + v - (max(y) + min(y)) / 2))
    joints = {joint: pixels(*place) for joint, place in diagram_of(
        machine, machine.motion(drawing.start)).joints.items()}
    paper.begin()
    metre = paper.script('return page.picture.scale')       # [px] of the empty page
    paper.press(paper.at(*pixels(0.0, 0.0)))
    owner = {}
    for count, dyad in enumerate(machine.dyads, 1):
        first, inner, second = (joints[f'{dyad.name}_{end}']
                                for end in ('first', 'inner', 'second'))
        is_rods = dyad.kind == 'RRR'
        for end, place in ((dyad.first, first), (dyad.second, second)):
            if end.link in owner:
                beside(paper, owner, end.link, place)
        if count > 1:
            paper.tool('rods' if is_rods else 'slide')
        paper.press(paper.at(*first))
        if is_rods:
            paper.press(paper.at(*inner), paper.at(*second))
        else:
            paper.tool('slide')
            paper.drag(paper.at(*inner), paper.at(inner[0] + 60.0, inner[1]))
        paper.drawn(*(f'd{i}' for i in range(1, count + 1)))
        owner |= dict(zip(dyad.links, ((first, inner), (second, inner))))
    x0, y0 = pixels(0.0, 0.0)
    for i, dyad in enumerate(machine.dyads, 1):
        for end in ('first', 'inner', 'second'):
            (u, v), (a, b) = paper.joint(f'd{i}_{end}'), joints[f'{dyad.name}_{end}']
            # half a pixel of the click, half a step of the grid, half of a third digit
            assert hypot(a - x0 - u * metre, b - y0 - v * metre) < 0.5 + 2 * 5e-4 * metre, end
    paper.menu('files', 'save in its file')
    paper.until(lambda: 'saved' in paper.text_of('said'), 'the file')
    shown = assert_as_shown(paper, file, capsys)
    paper.until(lambda: 'fourbar show' in paper.proof(), 'the extrema')
    worst = shown['drive']['worst_pin']
    assert paper.largest() == [worst['load'], pytest.approx(float(worst['force']), rel=1e-9)]
