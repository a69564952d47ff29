# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The live page in a real browser, by real clicks and drags, beside the command line's numbers."""
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
import json
from math import cos, pi, radians, sin
import re
import threading
import urllib.error
from urllib.parse import urlencode
import urllib.request

from fourbar_lab.drawing.poses import ten_digits
from fourbar_lab.live.svg import HEIGHT, WIDTH
from fourbar_ros.cli.main import main
from fourbar_ros.scene.files import find, folder
from fourbar_ros.scene.scene import load
import pytest
from support.browser import needs_browser, Tab

pytestmark = needs_browser
SCENES = sorted(file.stem for file in folder().glob('*.yaml'))


def errors(driver):
    """Return what the console of the browser complains about on the present page."""
    here = driver.current_url.partition('?')[0]
    return [entry for entry in driver.get_log('browser')
            if entry['level'] == 'SEVERE' and here in entry['message']]


def at_of(tab):
    """Return the input [deg] in the address of the page."""
    found = re.search(r'[?&]at=([^&]+)', tab.driver.current_url)
    return float(found[1]) if found else None


@pytest.mark.slow
@pytest.mark.parametrize('name', SCENES[::4])
def test_every_scene_shows_its_mechanism_and_its_extrema(driver, address, name, capsys,
                                                         monkeypatch):
    tab = Tab(driver, f'{address}/?scene={name}')
    tab.open('Extrema')
    tab.until(lambda: tab.rows('quantity'), 'extrema')
    monkeypatch.setenv('COLUMNS', '200')
    assert main(['show', name]) == 0
    shown = capsys.readouterr().out
    for row in tab.rows('quantity'):
        assert row[2] in shown, row          # the command line has every number of the page
    tab.open('Facts')
    tab.until(lambda: tab.rows('lengths'), 'facts')
    printed = ' '.join(shown.split())
    for name, text in tab.rows('lengths'):
        # the page adds which joints its letters stand for
        assert name.startswith('joint ') or f'{name} {" ".join(text.split())}' in printed
    assert any(name.startswith('transmission angle') for name, _ in tab.rows('lengths'))
    assert not errors(driver)


def test_play_turns_it_and_pause_keeps_it(tab):
    before = tab.picture()
    tab.click('play or pause')
    tab.until(lambda: tab.picture() != before, 'motion')
    tab.click('play or pause')
    tab.until(lambda: at_of(tab) not in (None, 0.0), 'the input in the address')
    linkage = load(find('paper')).linkage
    theta1 = at_of(tab)
    tab.until(lambda: tab.now() and float(tab.now()['theta1']) == pytest.approx(theta1, abs=1e-3),
              'the pose of the pause')
    omega4 = linkage.motion(radians(float(tab.now()['theta1'])), 25.0).omega4
    # the angle has ten digits, omega4 changes by up to alpha4 / omega1 = 43 rad/s per rad
    assert float(tab.now()['omega4']) == pytest.approx(omega4, abs=43.0 * 1e-8)


def test_the_input_field_goes_there(tab):
    tab.write('input value', '60')
    linkage = load(find('paper')).linkage
    motion, loads = linkage.step(radians(60.0), 25.0)
    tab.until(lambda: tab.now().get('theta1') == '60', 'the input')
    now = tab.now()
    assert now['omega4'] == ten_digits(motion.omega4)
    assert now['alpha4'] == ten_digits(motion.alpha4)
    assert now['driving_torque'] == ten_digits(loads.driving_torque)


def test_a_length_changes_picture_curves_facts_and_address(tab):
    before = tab.picture()
    tab.write('linkage.a2', '1.1')
    tab.until(lambda: 'linkage.a2=1.1' in tab.driver.current_url, 'the address')
    tab.until(lambda: tab.picture() != before, 'another picture')
    tab.open('Facts')
    tab.until(lambda: any('a2 1.1' in row[1] for row in tab.rows('lengths')), 'facts')
    other = Tab(tab.driver, tab.driver.current_url)         # a link someone sent
    assert tab.driver.find_element('css selector', 'input[aria-label="linkage.a2"]'
                                   ).get_attribute('value') == '1.1'
    assert other.alarm() == ''


def test_what_is_allowed_but_hardly_meant_is_warned_of_as_on_the_command_line(tab):
    assert tab.warnings() == ''
    tab.write('linkage.a3', '80')
    tab.until(tab.alarm, 'the alarm of what cannot close')
    assert tab.warnings() == ''
    for name in ('a1', 'a2', 'a4'):
        tab.write(f'linkage.{name}', '50')
    tab.until(lambda: tab.warnings() == 'linkage.a1 = 50 m: did you mean 0.05? Lengths are in '
              'metres (and 3 more)', 'the warning')


@pytest.mark.parametrize('query', ['linkage.a1=abc', 'bodies.rods.radius=30'])
def test_no_line_of_words_lies_on_the_picture(driver, address, query):
    tab = Tab(driver, f'{address}/?{query}')
    tab.until(lambda: tab.alarm() or tab.warnings(), 'words')
    words, picture = driver.execute_script(
        "return ['.fb-alarm, .fb-warnings', '.fb-stage .fb-picture'].map(s => [...document"
        '.querySelectorAll(s)].map(e => e.getBoundingClientRect()).map(b => [b.top, b.bottom]))')
    assert max(below for _, below in words) <= picture[0][0]


@pytest.mark.slow
def test_loads_with_a_force_have_extrema_in_their_table(driver, address):
    force = {'link': 'output', 'acts': 'along', 'over': 'input', 'place_unit': 'deg',
             'places': '[0.0, 180.0, 360.0]', 'values': '[8.0, 1.0, 8.0]', 'periodic': 'true'}
    query = urlencode({'scene': 'slider_crank',
                       **{f'forces.gas.{name}': value for name, value in force.items()}})
    tab = Tab(driver, f'{address}/?{query}')
    tab.open('Extrema')
    tab.until(lambda: {row[0] for row in tab.rows('quantity')} == {
        'slide_velocity', 'slide_acceleration', 'driving_torque', 'shaking_force'}, 'all of them')


@pytest.mark.slow
def test_the_other_assembly_mode(tab):
    before = tab.picture()
    tab.press('crossed')
    tab.until(lambda: 'linkage.mode=1' in tab.driver.current_url, 'the address')
    tab.until(lambda: tab.picture() != before, 'the other picture')


def crank(tab):
    """Return the places of O1 and A in the window, at theta1 = 0, once A can be dragged."""
    (left, top, scale), pins = tab.frame(), tab.pins()
    places = [(left + scale * x, top + scale * y) for x, y in pins[:2]]
    tab.until(lambda: tab.driver.execute_script(
        'return getComputedStyle(document.elementFromPoint(...arguments)).cursor',
        *places[1]) == 'grab', 'a joint to drag')
    return places


def upright(tab, arm):
    """Wait until the crank is upright, to two pixels of its arm."""
    tab.until(lambda: at_of(tab) is not None
              and abs(at_of(tab) - 90.0) < 2.0 * 57.3 / arm + 1.0, 'the crank upright')


def test_a_joint_is_dragged_also_where_the_pointer_leaves_the_picture(tab):
    from selenium.webdriver.common.action_chains import ActionChains
    (x1, y1), (xa, ya) = crank(tab)
    arm = xa - x1
    actions = ActionChains(tab.driver, duration=50)
    actions.w3c_actions.pointer_action.move_to_location(int(xa), int(ya))
    actions.click_and_hold()
    for part in range(1, 6):
        angle = part * pi / 12.0
        actions.w3c_actions.pointer_action.move_to_location(
            int(x1 + arm * cos(angle)), int(y1 - arm * sin(angle)))
    actions.w3c_actions.pointer_action.move_to_location(20, int(y1 - arm))       # far outside
    actions.w3c_actions.pointer_action.move_to_location(int(x1), 2)
    actions.release()
    actions.perform()
    upright(tab, arm)
    moved = tab.pins()
    ActionChains(tab.driver, duration=50).move_by_offset(40, 90).perform()      # let go
    assert tab.pins() == moved


@pytest.fixture
def touch(driver):
    """Return a function that sends a phase of a touch at a place, in a window of a phone."""
    driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
        'width': 390, 'height': 844, 'deviceScaleFactor': 1, 'mobile': True})
    driver.execute_cdp_cmd('Emulation.setTouchEmulationEnabled', {'enabled': True})

    def touch(phase, *place):
        points = [dict(zip('xy', place))] if place else []
        driver.execute_cdp_cmd('Input.dispatchTouchEvent', {'type': phase, 'touchPoints': points})
    yield touch
    driver.execute_cdp_cmd('Emulation.setTouchEmulationEnabled', {'enabled': False})
    driver.execute_cdp_cmd('Emulation.clearDeviceMetricsOverride', {})


@pytest.mark.slow
def test_a_finger_drags_a_joint_and_scrolls_the_page_beside_it(touch, driver, address):
    tab = Tab(driver, address)
    (x1, y1), (xa, ya) = crank(tab)
    arm = xa - x1
    touch('touchStart', xa, ya)
    for part in range(1, 7):
        angle = part * pi / 12.0
        touch('touchMove', x1 + arm * cos(angle), y1 - arm * sin(angle))
    touch('touchEnd')
    upright(tab, arm)
    assert driver.execute_script('return scrollY') == 0
    left, top, scale = tab.frame()
    place = left + 690.0 * scale, top + 390.0 * scale       # a corner, without joints
    touch('touchStart', *place)
    for part in range(1, 9):
        touch('touchMove', place[0], place[1] - 20.0 * part)
    touch('touchEnd')
    tab.until(lambda: driver.execute_script('return scrollY') > 50, 'the page to scroll')


@pytest.mark.slow
def test_on_a_phone_the_picture_stays_beside_the_sliders(touch, driver, address):
    tab = Tab(driver, address)
    tab.click('parameters')
    tab.until(lambda: tab.by('linkage.a3 slider').is_displayed(), 'the controls')
    driver.execute_script("arguments[0].scrollIntoView({block: 'end'})",
                          tab.by('linkage.a3 slider'))
    place = driver.execute_script(
        'const b = arguments[0].getBoundingClientRect(); return [b.x + b.width / 2, '
        'b.y + b.height / 2, b.height, b.top]', tab.by('the mechanism in its pose'))
    assert driver.execute_script(
        "return !!document.elementFromPoint(...arguments).closest('.fb-picture')", *place[:2])
    assert place[2] > 150 and place[3] >= 0
    before = tab.picture()
    tab.write('linkage.a3', '0.83')
    tab.until(lambda: tab.picture() != before, 'the effect')


@pytest.fixture
def laptop(driver):
    driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
        'width': 1280, 'height': 800, 'deviceScaleFactor': 1, 'mobile': False})
    yield
    driver.execute_cdp_cmd('Emulation.clearDeviceMetricsOverride', {})


@pytest.mark.slow
@pytest.mark.parametrize('name', ['paper', 'andrews'])
def test_the_picture_takes_half_of_a_window_and_crops_nothing(laptop, driver, address, name):
    tab = Tab(driver, f'{address}/?scene={name}')
    box = driver.execute_script(
        'const b = arguments[0].getBoundingClientRect(); return [b.x, b.y, b.right, b.bottom]',
        tab.by('the mechanism in its pose'))
    assert (box[2] - box[0]) * (box[3] - box[1]) >= 0.5 * 1280 * 800 and box[3] <= 800
    for at in range(30, 360, 60):
        tab.write('input value', str(at))
        tab.until(lambda at=at: at_of(tab) == at, f'{at} deg')
        texts = driver.execute_script(
            "return [...arguments[0].querySelectorAll('text')].map(t => {const b = "
            't.getBBox(); return [b.x, b.y, b.x + b.width, b.y + b.height, t.textContent]})',
            tab.by('the mechanism in its pose'))
        for left, above, right, below, words in texts:
            assert left >= 0.0 and right <= WIDTH and above >= -4.0 and below <= HEIGHT, words


@pytest.mark.slow
def test_layers_and_views(tab):
    tab.click('dark or light')
    tab.write('input value', '160')
    tab.until(lambda: tab.now().get('theta1') == '160', 'a pose with centres in view')
    for label, sign in (('instant centres', 'class="centre"'), ('forces', 'class="force"'),
                        ('collineation axis', 'class="through"')):
        had = sign in tab.picture()
        tab.tick(label)
        tab.until(lambda: (sign in tab.picture()) != had, f'{label} switched')
    tab.open('Polygons')
    for name in ('velocity polygon', 'acceleration polygon'):
        tab.until(lambda name=name: 'class="sum"' in tab.by(name).get_attribute('innerHTML'), name)
    assert 'body--dark' in tab.driver.find_element('tag name', 'body').get_attribute('class')
    assert not errors(tab.driver)


@pytest.mark.parametrize('by', ['click', pytest.param('keyboard', marks=pytest.mark.slow)])
def test_click_and_keyboard_go_to_an_extremum(tab, by):
    from selenium.webdriver.common.keys import Keys
    tab.open('Extrema')
    tab.until(lambda: tab.rows('quantity'), 'extrema')
    row = next(row for row in tab.rows('quantity') if row[0] == 'omega4')
    find = '[...document.querySelectorAll("tbody {}")].filter(e => e.innerText.includes({!r}))[0]'
    if by == 'click':
        tab.driver.execute_script(find.format('tr', row[2]) + '.click()')
    else:
        tab.driver.execute_script(find.format('button', row[4]) + '.focus()')
        tab.keys(Keys.ENTER)
    tab.until(lambda: abs(float(tab.now().get('omega4', 'nan')) - float(row[2])) < 1e-6,
              'the extremum')


@pytest.mark.slow
def test_accessibility_by_the_rules_of_axe(tab):
    from axe_core_python.selenium import Axe
    for view in ('Curves', 'Polygons', 'Extrema', 'Facts'):
        tab.open(view)
        tab.until(lambda view=view: view != 'Curves' or tab.count_series(
            'curves over the input, extrema marked'), 'curves')
        tab.until(lambda view=view: view != 'Extrema' or tab.rows('quantity'), 'extrema')
        found = Axe().run(tab.driver)['violations']
        assert not [(rule['id'], rule['nodes'][0]['html'][:200]) for rule in found
                    if rule['impact'] in ('critical', 'serious')], view
        assert not [rule for rule in found if 'landmark' in rule['id']], view


def test_nothing_leaves_this_machine(tab):
    sent = [json.loads(entry['message'])['message'] for entry in
            tab.driver.get_log('performance')]
    urls = {message['params']['request']['url'] for message in sent
            if message['method'] == 'Network.requestWillBeSent'}
    local = re.compile(r'(http://127\.0\.0\.1:|data:|blob:|chrome:|chrome-untrusted:)')
    assert urls and all(map(local.match, urls))


@pytest.mark.parametrize(('headers', 'code'), [
    ({}, 200), ({'Host': 'example.org'}, 400), ({'Origin': 'http://example.org'}, 403),
    ({'Origin': 'null'}, 403)])
def test_other_hosts_and_origins_are_refused(address, headers, code):
    answer = asked(address, headers)
    assert answer.status == code
    assert "frame-ancestors 'none'" in answer.headers['Content-Security-Policy']
    assert answer.headers['X-Frame-Options'] == 'DENY'


def asked(address, headers=None):
    """Return the answer to a request, refused or not."""
    try:
        return urllib.request.urlopen(urllib.request.Request(address, headers=headers or {}))
    except urllib.error.HTTPError as error:
        return error


@pytest.mark.slow
@pytest.mark.parametrize('query', [
    'at=.nan', 'acceleration=1e308', f'linkage.a1={"9" * 400}'])
def test_no_link_stops_the_server(driver, address, query):
    assert asked(f'{address}/?{query}').status == 200
    driver.get(f'{address}/?{query}')
    tab = Tab(driver, address)
    tab.write('input value', '60')
    tab.until(lambda: tab.now().get('theta1') == '60', 'an answer')


@pytest.mark.slow
def test_another_site_shows_no_frame_and_stops_nothing(driver, address, tmp_path):
    (tmp_path / 'index.html').write_text(
        f'<img src="{address}/?at=.nan"><iframe src="{address}"></iframe><p>there</p>')
    with serving(tmp_path) as other:
        driver.get(other)
        driver.switch_to.frame(driver.find_element('tag name', 'iframe'))
        assert not driver.find_elements('css selector', '.fb-picture, #app')
        driver.switch_to.default_content()
    assert '<circle' in Tab(driver, address).picture()


@contextmanager
def serving(folder):
    """Serve a folder as another site; give its address."""
    server = ThreadingHTTPServer(('localhost', 0), partial(SimpleHTTPRequestHandler,
                                                           directory=folder))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f'http://localhost:{server.server_port}/index.html'
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def test_the_socket_refuses_another_origin(address):
    url = address + '/_nicegui_ws/socket.io/?EIO=4&transport=polling'
    request = urllib.request.Request(url, headers={'Origin': 'http://example.org'})
    with pytest.raises(urllib.error.HTTPError) as caught:
        urllib.request.urlopen(request)
    assert caught.value.code == 403
