# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Every control of the page on every kind of mechanism, by real keys, clicks and drags."""
from math import hypot, radians

from fourbar_lab.live import link as links
from fourbar_lab.live.model import shown
from fourbar_lab.live.picture import mechanism_view
from fourbar_lab.live.tables import now_rows
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.scene.files import find
from fourbar_ros.scene.scene import load
import pytest
from support.browser import needs_browser, open_last_closed, Tab

pytestmark = [needs_browser, pytest.mark.slow]
KINDS = ['paper', 'jansen', 'cylinder']
CURVES = 'curves over the input, extrema marked'


@pytest.fixture
def opened(driver, address):
    """Return a function: name of a scene -> its page."""
    def opened(name, **state):
        query = '&'.join(f'{key}={value}' for key, value in {'scene': name, **state}.items())
        return Tab(driver, f'{address}/?{query}')
    return opened


def expected(tab, name):
    """Return what the core computes for the state in the address: what is shown, pose, rows."""
    values = load(find(name)).values
    link = links.read(tab.query(), name, values)
    found = shown(link.values, link.acceleration)
    position = found.scene.drive.start
    if link.input is not None:
        position = link.input if found.linkage.is_driven_by_slide else radians(link.input)
    pose = found.pose(found.nearest_input(position))
    assert pose.status == 0
    return found, pose.motion, now_rows(found, pose)


def agrees(tab, name):
    """Return whether table and picture are those of the state in the address."""
    found, motion, rows = expected(tab, name)
    if tab.now() != {name: value for name, value, _ in rows}:
        return False
    view = mechanism_view(found)
    places = [view.pixel(place) for place in diagram_of(found.linkage, motion).joints.values()]
    pins = tab.pins()
    return len(pins) == len(places) and all(
        hypot(x - u, y - v) <= 0.08 for (x, y), (u, v) in zip(pins, places))


@pytest.mark.parametrize('name', KINDS)
def test_every_slider_changes_what_it_says(opened, name):
    from selenium.webdriver.common.keys import Keys
    tab = opened(name, at=load(find(name)).values.get('drive.start') or 1.3)
    tab.until(lambda: not open_last_closed(tab), 'all groups open')
    names = [label.removesuffix(' slider') for label in tab.labels('slider')
             if label.endswith(' slider')]
    values = load(find(name)).values
    assert {'drive.speed'} < set(names) <= set(values)
    for parameter in names:
        tab.focus_slider(f'{parameter} slider')
        tab.keys(Keys.ARROW_LEFT if values[parameter] > 0.0 else Keys.ARROW_RIGHT)
        tab.until(lambda: parameter in tab.query(), f'{parameter} in the address')
        changed = float(tab.query()[parameter])
        assert changed != values[parameter]
        tab.until(lambda: agrees(tab, name), f'table and picture with {parameter} = {changed}')
        tab.until(lambda: float(tab.text(parameter)) == pytest.approx(changed, 1e-11),
                  f'the field of {parameter} with {changed}')
        tab.keys(Keys.ARROW_RIGHT if values[parameter] > 0.0 else Keys.ARROW_LEFT)
    tab.until(lambda: not tab.alarm(), 'no complaint')


def is_empty(tab):
    """Return whether no strokes, rows, curves and cursor are on the page."""
    shown_svg = tab.driver.execute_script(
        "return [...document.querySelectorAll('.fb-picture')]"
        ".map(s => s.querySelectorAll('line, circle, polyline, polygon').length)")
    cursors = tab.driver.find_elements('css selector', '.fb-cursor')
    return not (any(shown_svg) or tab.now() or tab.rows('quantity') or tab.rows('lengths')
                or tab.count_series(CURVES)
                or any(cursor.is_displayed() for cursor in cursors))


def test_what_is_impossible_leaves_nothing_on_the_page(opened):
    tab = opened('paper', at=40)
    for view in ('Curves', 'Polygons', 'Extrema', 'Facts'):
        tab.open(view)
        tab.write('linkage.a2', '1.2')
        tab.until(lambda: not tab.alarm() and tab.now(), 'a mechanism')
        if view in ('Extrema', 'Facts'):
            head = {'Extrema': 'quantity', 'Facts': 'lengths'}[view]
            tab.until(lambda head=head: tab.rows(head), view)
        tab.write('linkage.a2', '9')
        tab.until(lambda: 'cannot close' in tab.alarm(), 'the reason')
        tab.until(lambda: is_empty(tab), f'nothing in any view, {view} open')
