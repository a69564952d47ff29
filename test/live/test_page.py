# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The live page in a real browser, by real clicks, drags and keys, beside the core's numbers."""
import csv
import io
import json
from math import cos, degrees, pi, radians, sin
from pathlib import Path
import re
import urllib.error
import urllib.request

from fourbar_lab.drawing.collineation import collineation_axis
from fourbar_lab.drawing.curves import curves_of
from fourbar_ros import find_extrema, load_scene
from fourbar_ros.cli.main import main
from fourbar_ros.scene import from_values
from fourbar_ros.scene.files import folder, shipped
from fourbar_ros.scene.simulated import simulate_scene
import numpy as np
from PIL import Image
import pytest
import resvg_py
from support.browser import live, needs_browser, Tab

pytestmark = needs_browser
SCENES = sorted(file.stem for file in folder().glob('*.yaml'))
SIZES = (390, 844), (857, 1000), (1280, 800), (1920, 1080)


def errors(driver):
    """Return what the console of the browser complains about on the present page."""
    return [entry['message'] for entry in driver.get_log('browser') if entry['level'] == 'SEVERE']


@pytest.fixture(scope='module')
def file(tmp_path_factory):
    """Return a function: name of a scene -> the address of its page as a file."""
    place, made = tmp_path_factory.mktemp('files'), {}

    def file(name):
        if name not in made:
            path = place / f'{name}.html'
            assert main(['live', name, '-o', str(path)]) == 0
            made[name] = path.as_uri()
        return made[name]
    return file


@pytest.fixture
def window(driver):
    """Return a function that sets width and height of the window, without a frame."""
    def window(width, height, is_mobile=False):
        driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
            'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': is_mobile})
    yield window
    driver.execute_cdp_cmd('Emulation.clearDeviceMetricsOverride', {})


# --- numbers ---

def test_the_values_of_a_pose_are_those_of_python(tab):
    tab.open('Values')
    tab.write('input value', '60')
    motion, loads = load_scene('paper').linkage.step(radians(60.0), 25.0)
    tab.until(lambda: tab.now().get('theta1') == '60', 'the input')
    now = {name.partition(' ')[0]: float(value) for name, value in tab.now().items()}
    for name, value in (('omega4', motion.omega4), ('alpha4', motion.alpha4),
                        ('driving_torque', loads.driving_torque), ('f32', loads.f32)):
        assert now[name] == pytest.approx(value, rel=1e-9), name


def test_a_typed_length_changes_all_and_a_sent_address_shows_the_same(tab):
    before = tab.picture()
    tab.write('linkage.a2', '1.1')
    tab.until(lambda: tab.picture() != before, 'another picture')
    tab.until(lambda: tab.address().get('linkage.a2') == '1.1', 'the address')
    other = Tab(tab.driver, tab.driver.current_url)
    assert other.text('linkage.a2') == '1.1' and other.alarm() == ''
    assert other.state['scene']['linkage']['a2'] == 1.1
    other.open('Facts')
    other.until(lambda: any('a2 1.1' in row[1] for row in other.rows('Facts')), 'facts')
    assert not errors(other.driver)


def test_undo_and_redo_are_exact(tab):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
    first, texts = tab.state['scene'], ('1.1', '1.15', '1.23456789012345')
    for text in texts:
        tab.write('linkage.a2', text)
    last = tab.state['scene']
    tab.click('dark or light')
    ActionChains(tab.driver).key_down(Keys.CONTROL).send_keys('z').key_up(Keys.CONTROL).perform()
    assert tab.text('linkage.a2') == '1.15'
    while tab.by('undo').is_enabled():
        tab.click('undo')
    assert tab.state['scene'] == first and tab.text('linkage.a2') == '1.2'
    for text in texts:
        tab.click('redo')
        assert tab.state['scene']['linkage']['a2'] == float(text)
    assert tab.state['scene'] == last and not tab.by('redo').is_enabled()


@pytest.mark.parametrize(('name', 'typed', 'value'), [
    ('linkage.a2', '1150mm', 1.15), ('linkage.a3', '82 cm', 0.82),
    ('drive.speed', '60rpm', 2.0 * pi), ('linkage.a1', '15.5 in', 15.5 * 0.0254)])
def test_units_that_are_typed_count_as_in_scenes(tab, name, typed, value):
    tab.write(name, typed)
    group, last = name.split('.')
    typed = tab.state['scene'][group][last]
    assert typed == pytest.approx(value, rel=2e-16)
    tab.until(lambda: tab.is_answered(name, typed), 'the answer')
    assert not tab.wrong() and not tab.alarm()


@pytest.mark.parametrize(('typed', 'why'), [
    ('0,085', 'must be written 0.085'), ('30 kg', 'must be a number in m'),
    ('abc', 'must be a number in m'), ('1e400', 'must be a finite number')])
def test_what_is_no_number_is_refused_in_words_and_changes_nothing(tab, typed, why):
    before = tab.state['scene']
    tab.write('linkage.a3', typed)
    assert f"linkage.a3 = '{typed}': {why}" in tab.wrong()
    assert tab.state['scene'] == before and tab.text('linkage.a3') == typed
    tab.write('linkage.a3', '82 cm')
    assert tab.state['scene']['linkage']['a3'] == 0.82 and not tab.wrong()


def test_a_late_answer_keeps_what_was_refused(tab):
    tab.write('linkage.a2', '1.1')
    tab.write('linkage.a3', '30 kg')
    tab.script("page.refuse('what was clicked')")
    tab.select('linkage.a4')
    tab.until(lambda: tab.is_answered('linkage.a2', 1.1), 'the answer')
    assert tab.alarm() == 'what was clicked' and tab.text('linkage.a3') == '30 kg'
    assert "linkage.a3 = '30 kg': must be a number in m" in tab.wrong()
    tab.write('linkage.a4', '1.1')
    assert not tab.alarm()


def test_the_input_is_typed_with_a_unit_too(tab):
    tab.write('input value', '1 rad')
    assert tab.state['view']['at'] == 1.0
    tab.until(lambda: tab.address().get('at') == '57.2957795', 'a radian in degrees')


def test_an_input_without_a_pose_is_said_and_one_of_another_turn_is_found(driver, file):
    tab = Tab(driver, file('slides_7_6') + '#at=-300')
    for typed in ('', '420 deg'):
        if typed:
            tab.write('input value', typed)
        assert tab.script('return page.engine.x') == pytest.approx(np.radians(60.0), abs=1e-12)
        assert 'no pose' not in tab.text_of('pose')
    tab.write('input value', '200 deg')
    assert 'no pose at theta1 = 200 deg: the nearest is shown' in tab.text_of('pose')
    tab.driver.find_element('id', 'picture').send_keys('\ue013')       # the arrow upwards
    assert 'no pose' not in tab.text_of('pose')


def test_what_cannot_close_is_said_and_the_old_picture_is_pale(tab):
    tab.write('linkage.a2', '9')
    tab.until(tab.alarm, 'the reason')
    assert 'stale' in tab.script("return document.getElementById('picture').classList.value")
    tab.write('linkage.a2', '1.2')
    tab.until(lambda: not tab.alarm(), 'no complaint')


def test_what_is_allowed_but_hardly_meant_is_warned_of(tab):
    assert tab.text_of('warnings') == ''
    for name in ('a3', 'a1', 'a2', 'a4'):
        tab.write(f'linkage.{name}', '50')
    tab.until(lambda: 'did you mean 0.05?' in tab.text_of('warnings'), 'the warning')
    for name in ('a3', 'a1', 'a2', 'a4'):           # 50 m is meant, also as something else changes
        tab.write(f'linkage.{name}', '50 m')
    tab.write('drive.speed', '2')
    tab.until(lambda: tab.is_answered('drive.speed', 2.0) and not tab.text_of('warnings'),
              'no warning')


def test_extrema_are_those_of_show_and_a_click_goes_there(tab):
    tab.open('Extrema')
    tab.until(lambda: 'fourbar show' in tab.proof(), 'the proof')
    linkage = load_scene('paper').linkage
    force = max(find_extrema(linkage, linkage.reactions, 25.0), key=lambda one: one.value)
    assert tab.largest() == [force.quantity, pytest.approx(force.value, rel=1e-9)]
    assert tab.rows('Extrema')[0] == ['F_41', 'max\nlargest force of all joints',
                                      f'{force.value:.5g} N', f'{degrees(force.input):.6g}°']
    wanted = find_extrema(linkage, ['omega4'], 25.0)
    wanted.sort(key=lambda one: -abs(one.value))
    assert tab.digits('omega4') == [pytest.approx(one.value, rel=1e-9) for one in wanted]
    assert [row[1:] for row in tab.rows('Extrema') if row[0] == 'omega4'] == [
        [f'{one.kind[:3]}\nglobal', f'{one.value:.5g} rad/s', f'{degrees(one.input):.6g}°']
        for one in wanted]
    tab.script('document.querySelector(\'#view-Extrema button[aria-label*="of omega4"]\').click()')
    x = wanted[0].input
    assert tab.state['view']['at'] == pytest.approx(x, abs=1e-9) or tab.state['view'][
        'at'] == pytest.approx(x + 2.0 * pi, abs=1e-9)
    tab.until(lambda: 'imum of omega4' in tab.text_of('pose'), 'the extremum in words')
    assert 'imum of' not in tab.picture()
    tab.script('page.store.dispatch({ view: { at: page.engine.x + 0.03 } })')
    assert 'imum of' not in tab.text_of('pose')     # two degrees away it is none


@pytest.mark.parametrize('size', [(390, 844), (1280, 800)])
def test_the_table_of_extrema_is_read_without_scrolling_aside(window, driver, file, size):
    window(*size)
    tab = Tab(driver, file('jansen'))
    tab.script("page.store.dispatch({ view: { curves: ['leg_first', 'driving_torque', "
               "'transmission_angle', 'holding_torque', 'alpha_foot'] } })")
    tab.open('Extrema')
    wide, has, tallest = tab.script("""
const panel = document.getElementById('panel'), rows = [...panel.querySelectorAll('.extrema tr')];
return [panel.scrollWidth, panel.clientWidth,
        Math.max(...rows.map(row => row.getBoundingClientRect().height))]""")
    assert wide <= has and tallest < 80
    assert tab.script('return document.documentElement.scrollWidth') <= size[0]
    assert any(row[0] == 'F_hip' and row[2].endswith(' N') for row in tab.rows('Extrema'))
    titles = tab.script("return [...document.querySelectorAll('.curve .name')].map(e => "
                        "[e.firstChild.data, e.querySelector('title').textContent])")
    assert titles[0] == ['F_hip [N]', 'leg_first']
    assert 'hip' in tab.script("return [...document.querySelectorAll('#picture .letter')].map(e "
                               '=> e.textContent)')


def test_a_short_arrow_keeps_its_value(driver, file):
    tab = Tab(driver, file('jansen'))
    shown, named = tab.script("""
page.picture.view.perNewton *= 1e-3; page.store.dispatch({ view: { at: 1.0 } });
return [document.querySelectorAll('#picture text.force').length,
        Object.keys(page.structure().sketch.forces).length]""")
    assert shown == named


def largest_of(scene):
    """Return [load, force] of the largest reaction by the search, at the speed of the scene."""
    reactions = [reaction.magnitude for reaction in scene.linkage.REACTIONS]
    one = max(find_extrema(scene.linkage, reactions, float(scene.drive.speed)),
              key=lambda one: one.value)
    return [one.quantity, pytest.approx(one.value, rel=1e-9)]


CHANGE_POINT = {'linkage.a1': 0.4, 'linkage.a2': 1.0, 'linkage.a3': 0.4, 'linkage.a4': 1.0,
                'linkage.mode': 1}


def test_the_largest_force_of_a_change_point_is_that_of_show(driver, address):
    """At the flat position, where no sample has loads, 3004 N; beside it 538 N were named."""
    scene = from_values({**load_scene('paper').values, **CHANGE_POINT})
    tab = Tab(driver, f'{address}/#' + '&'.join(f'{k}={v}' for k, v in CHANGE_POINT.items()))
    tab.until(lambda: 'fourbar show' in tab.proof(), 'the answer')
    assert tab.largest() == largest_of(scene)


@pytest.mark.parametrize('name', ['parallelogram', 'antiparallelogram'])
def test_samples_of_a_static_parallelogram_name_no_largest_force(driver, file, name):
    """Where all links lie in line reactions run away: no sample says how far."""
    tab = Tab(driver, f'{file(name)}#drive.speed=0')
    assert 'can be missed' in tab.proof()
    tab.open('Extrema')
    assert not [row for row in tab.rows('Extrema') if 'largest' in row[1] or 'global' in row[1]]
    # at 60 degrees, far from poles, arrows are of a size to be seen
    longest, size = tab.script("""
page.store.dispatch({ view: { at: Math.PI / 3 } });
return [Math.max(...[...document.querySelectorAll('#picture line.force')].map(
          line => line.getTotalLength())), page.engine.size * page.picture.scale]""")
    assert longest > 0.02 * size


@pytest.mark.parametrize('name', ['paper', 'parallelogram', 'door_closer', 'cylinder', 'bucket'])
def test_a_file_has_the_extrema_of_its_scene_as_it_is_written(driver, file, name):
    """The door closer has a peak of 15 kN between two samples of 0.3 kN."""
    scene, tab = load_scene(name), Tab(driver, file(name))
    assert 'fourbar show' in tab.proof() and tab.largest()[1] == largest_of(scene)[1]
    tab.script("page.store.dispatch({ set: { 'drive.speed': 0.5 } })")
    tab.until(lambda: 'can be missed' in tab.proof(), 'samples')
    tab.click('undo')
    tab.until(lambda: 'fourbar show' in tab.proof(), 'the scene as it was written')


def test_dots_of_motion_are_in_both_turns_of_a_four_stroke(driver, file):
    tab = Tab(driver, f'{file("engine")}#curves=slide_velocity')
    assert len(tab.script("return [...document.querySelectorAll('.curve .mark')]")) == 4
    for x in (1.300264039408852, 1.300264039408852 + 2.0 * pi):
        tab.script('page.store.dispatch({ view: { at: arguments[0] } })', x)
        assert 'minimum of slide velocity' in tab.text_of('pose')


def test_rounding_is_no_extremum(driver, file):
    """The usual curves of a coupling rod are constant; 611 rows were shown."""
    for address in (file('coupling_rod'), f'{file("coupling_rod")}#drive.speed=2'):
        tab = Tab(driver, address)
        tab.open('Extrema')
        rows, curves = tab.rows('Extrema'), tab.script('return page.structure().usual')
        assert {row[1].split('\n')[0] for row in rows} == {'constant'}
        assert len(rows) == 1 + len(curves)         # and the largest force
        assert max(tab.script("return [...document.querySelectorAll('.curve .line')].map(line => "
                              'line.getBBox().height)')) < 1.0      # [px]: no noise is drawn


def test_an_emptied_mass_is_taken_out_and_an_emptied_length_is_refused(driver, address):
    from selenium.webdriver.common.keys import Keys

    def empty(name):
        tab.script("document.querySelectorAll('#view-Numbers details').forEach(e => "
                   'e.open = true)')
        tab.select(name).send_keys(Keys.DELETE, Keys.ENTER)
    tab = Tab(driver, f'{address}/?scene=jansen')
    before = tab.state['scene']
    assert 'foot' in before['bodies']
    empty('bodies.foot.mass')
    assert 'foot' not in tab.state['scene']['bodies']
    assert 'bodies.foot is taken out' in tab.text_of('said')
    tab.until(lambda: tab.is_answered('bodies.foot.mass', None), 'the answer')
    assert tab.text('bodies.foot.mass') == tab.text('bodies.foot.inertia') == ''
    assert not tab.alarm() and not tab.wrong()          # it is a rod as the others are
    tab.click('undo')
    assert tab.state['scene'] == before
    tab.until(lambda: tab.text('bodies.foot.mass') == '0.6', 'the mass')
    empty('dyads.upper.length_1')
    assert "dyads.upper.length_1 = '': must be a number in m" in tab.wrong()
    assert tab.state['scene'] == before
    tab.keys(Keys.ESCAPE)
    assert not tab.wrong() and float(tab.text('dyads.upper.length_1')) == before[
        'dyads']['upper']['length_1']


def test_escape_and_a_click_outside_close_what_is_open(tab):
    from selenium.webdriver.common.keys import Keys
    tab.script("page.useTool('flip')")
    menu = tab.driver.find_element('css selector', '#views details')
    menu.find_element('tag name', 'summary').click()
    top, bottom, height = tab.script(
        "const b = document.getElementById('chooser').getBoundingClientRect();"
        'return [b.top, b.bottom, innerHeight]')
    assert 0.0 <= top < bottom <= height
    tab.keys(Keys.ESCAPE)
    assert not menu.get_attribute('open') and tab.state['view']['tool'] == 'flip'
    tab.keys(Keys.ESCAPE)
    assert tab.state['view']['tool'] == 'pose'
    menu.find_element('tag name', 'summary').click()
    tab.driver.find_element('id', 'title').click()
    assert not menu.get_attribute('open')


def test_an_address_holds_the_curves_that_are_shown(tab):
    tab.script("page.store.dispatch({ view: { curves: ['f41', 'omega4'] } })")
    tab.until(lambda: tab.address().get('curves') == 'f41,omega4', 'the address')
    other = Tab(tab.driver, tab.driver.current_url)
    assert other.state['view']['curves'] == ['f41', 'omega4']


def test_fields_show_six_digits_and_all_of_them_where_one_types(tab):
    tab.write('linkage.a2', '1.23456789012')
    tab.select('linkage.a3')
    assert tab.text('linkage.a2') == '1.23457'
    tab.select('linkage.a2')
    assert tab.text('linkage.a2') == '1.23456789012'
    assert tab.state['scene']['linkage']['a2'] == 1.23456789012


def test_the_other_assembly_mode(tab):
    before = tab.picture()
    tab.script("const s = document.querySelector('select[aria-label=\"linkage.mode\"]');"
               "s.value = '1'; s.onchange()")
    tab.until(lambda: tab.picture() != before, 'the other picture')
    tab.until(lambda: tab.address().get('linkage.mode') == '1', 'the address')


# --- pointer and keys ---

def test_a_joint_is_dragged_also_where_the_pointer_leaves_the_picture(tab):
    (x, y), a = tab.place('O_1'), tab.place('A')
    arm = a[0] - x
    tab.drag(a, *((x + arm * cos(k * pi / 12), y - arm * sin(k * pi / 12)) for k in range(1, 6)),
             (20, y - arm), (x, 2))
    tab.until(lambda: abs(tab.state['view']['at'] - 0.5 * pi) < 2.0 / arm + 0.02, 'upright')
    at = tab.state['view']['at']
    tab.drag((x + 200, y + 5), (x + 210, y + 90))
    assert tab.state['view']['at'] == at


def test_play_turns_it_and_pause_keeps_it(tab):
    before = tab.state['view']['at']
    tab.click('play or pause')
    tab.until(lambda: tab.state['view']['at'] != before, 'motion')
    tab.click('play or pause')
    at = tab.state['view']['at']
    shown = pytest.approx(at * 180.0 / pi, rel=1e-8)
    tab.until(lambda: float(tab.address().get('at', 'nan')) == shown, 'the input in the address')
    assert tab.state['view']['at'] == at


def test_the_keyboard_alone_moves_it(tab):
    from selenium.webdriver.common.keys import Keys
    for _ in range(40):
        tab.keys(Keys.TAB)
        if tab.script('return document.activeElement.dataset?.joint'):
            break
    assert tab.script('return document.activeElement.dataset.joint') == 'A'
    tab.keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    assert tab.state['view']['at'] == pytest.approx(2.0 * 2.0 * pi / 180.0, rel=1e-12)
    tab.keys(Keys.END)
    assert tab.state['view']['at'] == pytest.approx(2.0 * pi)
    tab.keys(Keys.TAB)
    assert tab.script('return document.activeElement.dataset.joint') == 'B'


@pytest.fixture
def touch(driver, window):
    """Return a function that sends a phase of a touch at a place, in a window of a phone."""
    window(390, 844, True)
    driver.execute_cdp_cmd('Emulation.setTouchEmulationEnabled', {'enabled': True})

    def touch(phase, *place):
        points = [dict(zip('xy', place))] if place else []
        driver.execute_cdp_cmd('Input.dispatchTouchEvent', {'type': phase, 'touchPoints': points})
    yield touch
    driver.execute_cdp_cmd('Emulation.setTouchEmulationEnabled', {'enabled': False})


@pytest.mark.slow
def test_a_finger_drags_a_joint(touch, driver, address):
    tab = Tab(driver, address)
    (x, y), a = tab.place('O_1'), tab.place('A')
    arm = a[0] - x
    touch('touchStart', *a)
    for k in range(1, 7):
        touch('touchMove', x + arm * cos(k * pi / 12), y - arm * sin(k * pi / 12))
    touch('touchEnd')
    tab.until(lambda: abs(tab.state['view']['at'] - 0.5 * pi) < 2.0 / arm + 0.05, 'upright')
    assert driver.execute_script('return scrollY') == 0


VIEW = 'const { x, y, scale } = page.picture.view; return [x, y, scale]'


def wheel(tab, place, up):
    """Turn the wheel at a place of the window, by so many notches."""
    tab.driver.execute_cdp_cmd('Input.dispatchMouseEvent', {
        'type': 'mouseWheel', **dict(zip('xy', place)), 'deltaX': 0, 'deltaY': -100 * up})


def test_the_wheel_zooms_the_ground_is_pulled_and_a_key_shows_all_again(tab):
    first, a, b = tab.script(VIEW), tab.place('A'), tab.place('B')
    wheel(tab, a, 4)
    tab.until(lambda: tab.script(VIEW)[2] == pytest.approx(2.0 * first[2], rel=1e-9), 'twice')
    assert tab.place('A') == pytest.approx(a, abs=1.0)      # what is below the pointer stays
    assert tab.place('B')[0] - a[0] == pytest.approx(2.0 * (b[0] - a[0]), abs=2.0)
    x, y = tab.place('O_1')
    at = tab.state['view']['at']
    tab.drag((x - 90, y - 40), (x - 80, y - 50), (x - 50, y - 100))
    assert tab.place('O_1') == pytest.approx((x + 40, y - 60), abs=1.0)
    assert tab.state['view']['at'] == at
    xs = tab.script("return [...document.querySelectorAll('#picture .bar')].map(e => "
                    "Number(e.getAttribute('x1')))")
    assert min(abs(x1 - x - 40 + tab.script("return document.getElementById('picture')"
                                            '.getBoundingClientRect().x')) for x1 in xs) < 1.0
    view = tab.script(VIEW)
    for length in ('1.1', '1.2'):           # the picture is not fitted behind one's back
        tab.write('linkage.a2', length)
        tab.until(lambda: tab.is_answered('linkage.a2', float(length)), 'the answer')
        assert tab.script(VIEW) == view
    tab.script('page.picture.svg.focus({ preventScroll: true })')
    tab.keys('+', '-')
    assert tab.script(VIEW) == pytest.approx(view, rel=1e-12)
    tab.keys('0')
    assert tab.script(VIEW) == first
    wheel(tab, a, -4)
    tab.until(lambda: tab.script(VIEW) != first, 'half')
    tab.click('all of the picture')
    assert tab.script(VIEW) == first


def test_two_fingers_zoom_and_put_down_nothing(touch, driver, address):
    def fingers(phase, *places):
        driver.execute_cdp_cmd('Input.dispatchTouchEvent', {'type': phase, 'touchPoints': [
            {**dict(zip('xy', place)), 'id': i} for i, place in enumerate(places)]})
    tab = Tab(driver, address)
    for tool in ('pose', 'new'):
        tab.driver.find_element('css selector', f'[data-tool={tool}]').click()
        tab.until(lambda: (tab.state['view']['tool'] == 'rods') == (tool == 'new'), 'the tool')
        scale, before = tab.script(VIEW)[2], tab.state['scene']
        x, y, width, height = tab.script('const b = page.picture.svg.getBoundingClientRect(); '
                                         'return [b.x, b.y, b.width, b.height]')
        x, y = x + width / 2, y + height / 2
        fingers('touchStart', (x - 40, y))
        fingers('touchStart', (x - 40, y), (x + 40, y))
        for far in (50, 60, 80):
            fingers('touchMove', (x - far, y), (x + far, y))
        fingers('touchEnd')
        tab.until(lambda: tab.script(VIEW)[2] == pytest.approx(2.0 * scale, rel=0.02), 'twice')
        assert tab.state['scene'] == before
    assert 'ground pivot' in tab.text_of('said')        # no click was taken


def test_nothing_is_asked_of_what_was_begun_anew(tab):
    tab.driver.execute_async_script("""
        const done = arguments[0], ask = page.ask;
        page.asked = [];
        page.ask = (...all) => { page.asked.push(all[0]); return ask(...all); };
        page.store.dispatch({ set: { 'linkage.a2': 1.1 } });        // asks of it soon
        document.querySelector('[data-tool=new]').click();
        setTimeout(done, 1500);""")
    assert 'ground pivot' in tab.text_of('said') and not tab.alarm()
    assert tab.script('return page.asked') == []


# --- without a server ---

def test_a_file_needs_no_server_and_no_network(driver, file):
    driver.get_log('performance')
    tab = Tab(driver, file('paper'))
    before = tab.state['view']['at']
    (x, y), a = tab.place('O_1'), tab.place('A')
    arm = a[0] - x
    tab.drag(a, (x + 0.7 * arm, y - 0.7 * arm), (x, y - arm))
    assert tab.state['view']['at'] != before
    tab.write('linkage.a1', '350mm')
    assert tab.state['scene']['linkage']['a1'] == 0.35 and not tab.alarm()
    other = from_values({**load_scene('paper').values, 'linkage.a1': 0.35}).linkage
    tab.open('Extrema')
    torques = other.loads(np.radians(np.arange(361.0)), 25.0).driving_torque
    tab.until(lambda: tab.digits('driving_torque') == pytest.approx(
        sorted([torques.min(), torques.max()], key=lambda one: -abs(one)), rel=1e-9),
        'the samples of the new length')
    assert 'can be missed' in tab.proof() and 'of 361 samples' in str(tab.rows('Extrema'))
    assert not tab.script("return document.querySelector('.curve .mark')")
    sent = [json.loads(entry['message'])['message'] for entry in driver.get_log('performance')]
    urls = {message['params']['request']['url'] for message in sent
            if message['method'] == 'Network.requestWillBeSent'
            and message['params']['documentURL'].startswith('file:')}
    assert all(re.match('(file:|data:|blob:|about:|chrome)', url) for url in urls), urls
    assert not errors(driver)


def test_the_axis_of_collineation_goes_through_its_poles(tab):
    linkage = load_scene('paper').linkage
    axis = collineation_axis(linkage, linkage.motion(1.0))
    tab.script('page.store.dispatch({ view: { at: 1, layers: { centres: true } } })')
    start, end, scale = tab.script("""
const line = document.querySelector('#picture .axis'), { x, y, scale } = page.picture.view;
return [...['1', '2'].map(i => [x + line.getAttribute(`x${i}`) / scale,
                                y - line.getAttribute(`y${i}`) / scale]), scale]""")
    along = np.subtract(end, start) / np.hypot(*np.subtract(end, start))
    for pole in (axis.p13, axis.p24):
        x, y = max(map(abs, linkage.lengths)) * pole[:2] / pole[2] - start
        # the ends are at hundredths of a pixel
        assert abs(x * along[1] - y * along[0]) < 0.02 / scale


def test_a_second_scene_and_the_scene_as_it_was_are_drawn_in_pale(driver, file, tmp_path):
    bars = ("return [...document.querySelectorAll('#picture .%s .bar')].map(e => "
            "['x1', 'y1', 'x2', 'y2'].map(n => Number(e.getAttribute(n))))")
    tab = Tab(driver, file('paper'))
    before = tab.script(bars % 'main')
    assert not tab.script(bars % 'behind')
    tab.write('linkage.a2', '1.1')
    tab.menu('what is shown', 'as it was, pale')
    tab.until(lambda: tab.script(bars % 'behind') == before, 'the bars before')
    assert tab.script(bars % 'main') != before
    two = tmp_path / 'two.html'
    assert main(['live', 'jansen', 'klann', '-o', str(two)]) == 0
    tab = Tab(driver, two.as_uri())
    assert len(tab.script(bars % 'behind')) >= 5 and tab.script(
        "return document.querySelectorAll('.curve .pale').length") == 2     # torque, shaking force
    width, height = tab.script('return [page.picture.width, page.picture.height]')
    for x1, y1, x2, y2 in tab.script(bars % 'behind'):
        assert 0 < min(x1, x2) <= max(x1, x2) < width
        assert 0 < min(y1, y2) <= max(y1, y2) < height
    pale = "return document.querySelector('.curve .pale').getAttribute('d')"
    without = tab.script(pale)
    tab.script('page.store.dispatch({ view: { acceleration: 500 } })')
    tab.until(lambda: tab.script(pale) != without, 'the torque of both at the acceleration')


def test_one_input_does_not_move_a_crank_and_a_slide(tmp_path, capsys):
    assert main(['live', 'paper', 'lift_table', '-o', str(tmp_path / 'two.html')]) == 1
    assert 'one input moves both' in capsys.readouterr().err


def test_a_run_from_torque_is_played_along_its_time_line(driver, file, address):
    linkage, run = load_scene('released').linkage, simulate_scene(
        load_scene('released'), 5.0, 1e-4).run
    for page in (file('released'), f'{address}?scene=released'):
        tab = Tab(driver, page)
        if page.startswith('http'):
            until, button = (tab.driver.find_element('id', name) for name in ('until', 'simulate'))
            for typed in ('5 kg', '5000 ms'):
                until.clear()
                until.send_keys(typed)
                button.click()
                assert typed != '5 kg' or "'5 kg': must be a number in" in tab.text_of('runWords')
        tab.until(lambda: tab.driver.find_element('id', 'time').is_displayed(), 'the run')
        tab.script("page.play(false); const time = document.getElementById('time'); "
                   "time.value = 300; time.dispatchEvent(new Event('input'))")
        sample = 300 * (1 + run.time.size // 1000)
        motion = run.position[sample], run.rate[sample], run.acceleration[sample]
        assert tab.state['view']['at'] == motion[0]
        f21, torque = tab.script("return ['f21', 'driving_torque'].map(n => page.engine.get(n))")
        assert f21 == pytest.approx(linkage.loads(*motion).f21, rel=1e-12)
        assert abs(torque) < 1e-9 and f'{run.time[sample]:.4g} s' in tab.text_of('pose')
        tab.click('play or pause')
        tab.until(lambda: tab.state['view']['moment'] > 300, 'the next moments')
        tab.write('input value', '30 deg')
        assert tab.state['view']['moment'] is None


def test_a_file_refuses_another_structure_in_words(driver, file):
    tab = Tab(driver, file('paper'))
    tab.script("page.store.dispatch({ set: { 'linkage.kind': 'slider_crank' } })")
    assert 'needs fourbar live' in tab.alarm()
    tab.click('undo')
    assert not tab.alarm()


# --- files ---

def test_the_scene_file_loads_again(tab, download):
    tab.write('linkage.a2', '1.1')
    path = download(tab, 'scene (YAML)', 'yaml')
    scene = load_scene(path)
    assert scene.values == {**load_scene('paper').values, 'linkage.a2': 1.1}
    assert main(['scene', 'check', str(path)]) == 0


@pytest.mark.parametrize('name', sorted(shipped()))
def test_every_scene_is_written_as_it_was_read(name, driver, file, tmp_path):
    if name not in ('engine', 'bucket', 'motor', 'door_closer'):
        pytest.skip('these four have all kinds of values')
    tab = Tab(driver, file(name))
    (tmp_path / 'again.yaml').write_text(tab.script("""
const text = document.getElementById('data').textContent, seen = [];
const made = URL.createObjectURL;
URL.createObjectURL = blob => { seen.push(blob); return 'data:,'; };
page.files['scene (YAML)'](); URL.createObjectURL = made;
return seen[0].text()"""))
    assert load_scene(tmp_path / 'again.yaml').values == load_scene(name).values


def test_the_curves_as_csv_are_those_of_table(driver, file):
    """Angles too, which come round at half a turn in both."""
    scene, tab = load_scene('jansen'), Tab(driver, file('jansen'))
    header, *rows = csv.reader(io.StringIO(tab.script("""
const seen = [], made = URL.createObjectURL;
URL.createObjectURL = blob => { seen.push(blob); return 'data:,'; };
page.files['curves (CSV, mm and degrees)'](); URL.createObjectURL = made;
return seen[0].text()""")))
    table = curves_of(scene, scene.linkage, [name.split()[0] for name in header],
                      float(scene.drive.speed))
    for name, unit, here, column in zip(*table[1:3], zip(*rows), table.values):
        unit, column = ('mm', 1000.0 * column) if unit == 'm' else (unit, column)
        assert f'{name} [{unit.replace("^2", "²")}]' in header
        assert np.array(here, float) == pytest.approx(column, abs=1e-10 * np.abs(column).max())
    turning = table.values[[unit == 'deg' for unit in table.units]]
    assert np.abs(np.diff(turning)).max() > 300.0


@pytest.mark.slow
def test_pictures_and_numbers_are_files_of_their_kinds(tab, download):
    tab.write('input value', '60')
    svg = download(tab, 'picture (SVG)', 'svg')
    assert 'var(' not in svg.read_text() and 'class="pin"' in svg.read_text()
    picture = Image.open(io.BytesIO(resvg_py.svg_to_bytes(svg_path=str(svg)))).convert('RGB')
    colours = picture.getcolors(2**24)
    assert len(colours) > 50 and max(colours)[1] == (255, 255, 255)
    png = Image.open(download(tab, 'picture (PNG)', 'png')).convert('RGB')
    assert png.width >= 1500 and max(png.getcolors(2**24))[1] == (255, 255, 255)
    moving = Image.open(download(tab, 'moving picture (GIF)', 'gif'))
    assert moving.format == 'GIF' and moving.n_frames > 80
    with download(tab, 'curves (CSV, mm and degrees)', 'csv').open() as text:
        rows = list(csv.DictReader(text))
    assert len(rows) == 361 and float(rows[90]['theta1 [deg]']) == pytest.approx(90.0)
    motion = load_scene('paper').linkage.motion(radians(90.0), 25.0)
    assert float(rows[90]['theta4 [deg]']) == pytest.approx(motion.theta4 * 180.0 / pi, rel=1e-12)
    page = download(tab, 'page without a server (HTML)', 'html')
    scene = tab.state['scene']
    other = Tab(tab.driver, page.as_uri())
    assert other.state['scene'] == scene and "connect-src 'none'" in page.read_text()
    assert 'fourbar show' in other.proof()


def test_a_scene_is_saved_in_its_file_and_a_shipped_one_is_not(driver, tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text(load_scene('paper').as_text)
    with live(path) as address:
        tab = Tab(driver, address)
        tab.write('linkage.a2', '1.1')
        tab.menu('files', 'save in its file')
        tab.until(lambda: 'saved' in tab.text_of('said'), 'the answer')
    assert load_scene(path).linkage.a2 == 1.1
    with live('paper') as address:
        answer = json.loads(asked(f'{address}/save', body={}).read())
        assert 'not written over' in answer['problem']


def test_one_of_several_nodes_in_a_file_has_its_name_and_is_not_written_over(tmp_path):
    path = tmp_path / 'two.yaml'
    path.write_text(''.join(
        f'/{node}:\n  ros__parameters:\n    linkage: {{a1: {a1}, a2: 1.2, a3: 0.8, a4: 1.0}}\n'
        for node, a1 in (('left', 0.4), ('right', 0.3))))
    with live(f'{path}:left') as address:
        html = asked(address).read().decode()
        answer = json.loads(asked(f'{address}/save', body={}).read())
    assert re.search(r'"name": ?"two_left"', html) and re.search(r'"canSave": ?false', html)
    assert 'one of several in its file' in answer['problem']
    assert [file.name for file in tmp_path.iterdir()] == ['two.yaml']


def test_a_page_without_curves_and_forces_goes_on(driver):
    with live('slides_7_6') as address:
        tab = Tab(driver, address)
        tab.script('page.store.dispatch({ view: { curves: [] } })')
        tab.until(lambda: tab.address().get('curves') == '', 'the address')
        assert not [text for text in errors(driver) if 'TypeError' in text]


# --- looks ---

@pytest.mark.slow
@pytest.mark.parametrize('size', SIZES)
@pytest.mark.parametrize('name', ['paper', 'jansen'])
def test_the_picture_is_the_hero_and_nothing_overflows(window, driver, file, size, name):
    window(*size, is_mobile=size[0] < 600)
    tab = Tab(driver, file(name))
    width, box = tab.script('const b = document.getElementById("picture").getBoundingClientRect();'
                            'return [document.documentElement.scrollWidth, [b.width, b.height]]')
    assert width <= size[0]
    if size in ((1280, 800), (1920, 1080)):
        assert box[0] * box[1] >= 0.5 * size[0] * size[1]
    if size[0] < 600:
        assert box[0] >= 0.95 * size[0]
        assert tab.script("return [...document.querySelectorAll('.curve')].filter(e => "
                          'e.clientHeight).length') == 1
    small = tab.script("""
return [...document.querySelectorAll('button, summary, select, input, .tabs label')]
  .filter(e => e.offsetParent && e.type !== 'checkbox')
  .map(e => [e.getBoundingClientRect(), e.outerHTML.slice(0, 80)])
  .filter(([b]) => b.height < 44).map(([, text]) => text)""")
    assert not [text for text in small if 'class="go"' not in text]


LABELS = Path(__file__).with_name('labels.js').read_text()


@pytest.mark.slow
@pytest.mark.parametrize('width', [390, 1280])
def test_few_labels_are_crossed_covered_or_outside(window, driver, file, width):
    """Over 24 poses of every scene: below 2 % of all labels."""
    window(width, 800, is_mobile=width < 600)
    total = dict.fromkeys(('labels', 'crossed', 'covered', 'outside'), 0)
    for name in SCENES:
        for key, value in Tab(driver, file(name)).script(LABELS).items():
            total[key] += value
    print(total)
    assert total['labels'] > 1000
    assert total['crossed'] + total['covered'] + total['outside'] < 0.02 * total['labels'], total


@pytest.mark.slow
@pytest.mark.parametrize('is_dark', [False, True])
def test_accessibility_by_the_rules_of_axe(tab, is_dark):
    from axe_core_python.selenium import Axe
    tab.script('document.documentElement.dataset.theme = arguments[0]',
               'dark' if is_dark else 'light')
    for view in ('Extrema', 'Values', 'Numbers', 'Facts'):
        tab.open(view)
        found = Axe().run(tab.driver)['violations']
        assert not [(rule['id'], rule['nodes'][0]['html'][:200]) for rule in found
                    if rule['impact'] in ('critical', 'serious')], view


# --- guards ---

def asked(url, headers=None, body=None):
    """Return the answer to a request, refused or not."""
    data = body if isinstance(body, (bytes, type(None))) else json.dumps(body).encode()
    try:
        return urllib.request.urlopen(urllib.request.Request(url, data, headers or {}))
    except urllib.error.HTTPError as error:
        return error


@pytest.mark.parametrize(('headers', 'code'), [
    ({}, 200), ({'Host': 'example.org'}, 400), ({'Origin': 'http://example.org'}, 403),
    ({'Origin': 'null'}, 403)])
@pytest.mark.parametrize('body', [None, {'scene': {}}])
def test_other_hosts_and_origins_are_refused(address, headers, code, body):
    answer = asked(address + ('' if body is None else '/structure'), headers, body)
    assert answer.status == code
    assert "frame-ancestors 'none'" in answer.headers['Content-Security-Policy']
    assert answer.headers['X-Frame-Options'] == 'DENY'


def test_what_is_too_large_or_no_question_is_refused(address):
    assert asked(f'{address}/structure', body=b'{"scene":"' + b'x' * 1_100_000 + b'"}'
                 ).status == 413
    assert asked(f'{address}/structure', body=b'[' * 100_000).status == 400
    assert asked(f'{address}/nothing', body={}).status == 404
    assert asked(f'{address}/?scene=nothing').status == 404
    assert json.loads(asked(f'{address}/structure', body={'scene': {'a': 1}}).read())['problem']


def test_an_address_of_a_megabyte_is_refused_in_words(driver, file):
    tab = Tab(driver, f'{file("paper")}#linkage.a2={"1" * 1_000_000}')
    assert 'the address has' in tab.alarm() and tab.text('linkage.a2') == '1.2'


@pytest.mark.parametrize('text', ['at=.nan', 'acceleration=1e999', 'linkage.a1=%3Cscript%3E',
                                  '__proto__.x=1', 'linkage=3'])
def test_no_address_stops_the_page(driver, address, text):
    tab = Tab(driver, f'{address}/#{text}')
    assert tab.alarm() or '__proto__' in text
    Tab(driver, f'{address}/?scene=jansen')


def test_markup_in_names_is_inert(driver, tmp_path):
    path = tmp_path / '<img src=x onerror=window.evil=1>.yaml'
    path.write_text(load_scene('jansen').as_text)
    out = tmp_path / 'page.html'
    assert main(['live', str(path), '-o', str(out)]) == 0
    tab = Tab(driver, f'{out.as_uri()}#points.%3Cscript%3Ewindow.evil=1%3C/script%3E.link=foot')
    assert tab.script('return window.evil') is None
    assert tab.script("return document.getElementById('title').textContent").startswith('<img')


def test_a_server_that_has_ended_is_told(driver):
    with live('paper') as address:
        tab = Tab(driver, address)
    tab.write('linkage.a2', '1.1')      # the page computes it alone; the extrema are asked for
    said = driver.find_element('id', 'said')
    tab.until(lambda: 'fourbar live does not answer any more' in said.text, 'the words')
    assert tab.state['scene']['linkage']['a2'] == 1.1
    assert not [text for text in errors(driver) if 'Uncaught' in text]


@pytest.mark.slow
@pytest.mark.parametrize('name', SCENES)
def test_every_scene_opens_without_a_complaint(driver, file, name):
    driver.get('about:blank')
    errors(driver)          # of the page before, whose server may have ended
    tab = Tab(driver, file(name))
    assert not tab.alarm() and 'class="bar"' in tab.picture()
    assert not errors(driver)
    scene = load_scene(name)
    values = tab.script('return [...page.engine.to]')
    units = tab.script('return page.engine.module.names')
    motion = scene.linkage.motion(tab.state['view']['at'], float(scene.drive.speed))
    for field in motion._fields:
        if field in units and np.isfinite(getattr(motion, field)):
            assert values[units.index(field)] == pytest.approx(getattr(motion, field), rel=1e-9,
                                                               abs=1e-9)
