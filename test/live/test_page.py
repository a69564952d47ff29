# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The live page in a real browser, by real clicks and drags, beside the command line's numbers."""
import json
from math import cos, pi, radians, sin
import re
import urllib.error
import urllib.request

from fourbar_ros.cli.main import main
from fourbar_ros.report.poses import number
from fourbar_ros.scene.files import find, folder
from fourbar_ros.scene.scene import load
import pytest
from support.browser import live, needs_browser, Tab

pytestmark = needs_browser
SCENES = sorted(file.stem for file in folder().glob('*.yaml'))


@pytest.fixture(scope='module')
def address():
    with live('paper') as address:
        yield address


@pytest.fixture
def tab(driver, address):
    return Tab(driver, address)


def errors(driver):
    """Return what the console of the browser complains about on the present page."""
    here = driver.current_url.partition('?')[0]
    return [entry for entry in driver.get_log('browser')
            if entry['level'] == 'SEVERE' and here in entry['message']]


def at_of(tab):
    """Return the input [deg] in the address of the page."""
    found = re.search(r'[?&]at=([^&]+)', tab.driver.current_url)
    return float(found[1]) if found else None


@pytest.mark.parametrize('name', SCENES)
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
    assert now['omega4'] == number(motion.omega4) and now['alpha4'] == number(motion.alpha4)
    assert now['driving_torque'] == number(loads.driving_torque)


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


def test_an_impossible_length_takes_the_picture_away_and_says_why(tab):
    tab.write('linkage.a2', '9')
    tab.until(lambda: 'linkage.a2' in tab.alarm() and 'cannot close' in tab.alarm(), 'the reason')
    assert '<circle' not in tab.picture()
    tab.write('linkage.a2', '1.2')
    tab.until(lambda: '<circle' in tab.picture() and not tab.alarm(), 'the picture')


def test_the_other_assembly_mode(tab):
    before = tab.picture()
    tab.press('crossed')
    tab.until(lambda: 'linkage.mode=1' in tab.driver.current_url, 'the address')
    tab.until(lambda: tab.picture() != before, 'the other picture')


def test_a_joint_can_be_dragged(tab):
    from selenium.webdriver.common.action_chains import ActionChains
    picture = tab.by('the mechanism in its pose')
    pins = tab.driver.execute_script(
        "return [...arguments[0].querySelectorAll('circle.pin')].map(c => {const b = "
        'c.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]})', picture)
    (x1, y1), (xa, ya) = pins[:2]                # O1 and A at theta1 = 0
    arm = xa - x1
    actions = ActionChains(tab.driver, duration=50)
    actions.w3c_actions.pointer_action.move_to_location(int(xa), int(ya))
    actions.click_and_hold()
    for part in range(1, 7):                     # round to 90 degrees
        angle = part * pi / 12.0
        actions.w3c_actions.pointer_action.move_to_location(
            int(x1 + arm * cos(angle)), int(y1 - arm * sin(angle)))
    actions.release()
    actions.perform()
    # two pixels of the arm's length
    tab.until(lambda: at_of(tab) is not None
              and abs(at_of(tab) - 90.0) < 2.0 * 57.3 / arm + 1.0, 'the crank upright')


def test_layers_and_views(tab):
    tab.write('input value', '160')
    tab.until(lambda: tab.now().get('theta1') == '160', 'a pose with centres in view')
    for label, sign in (('instant centres', 'class="centre"'), ('forces', 'class="force"')):
        had = sign in tab.picture()
        tab.tick(label)
        tab.until(lambda: (sign in tab.picture()) != had, f'{label} switched')
    tab.open('Polygons')
    for name in ('velocity', 'acceleration'):
        tab.until(lambda: 'class="sum"' in tab.by(f'{name} polygon').get_attribute('innerHTML'),
                  f'{name} polygon')
    tab.open('Forces')
    tab.until(lambda: tab.by('polar diagram of the shaking force and reactions')
              .find_elements('css selector', 'canvas'), 'the polar diagram')
    assert not errors(tab.driver)


def test_a_click_on_an_extremum_goes_there(tab):
    tab.open('Extrema')
    tab.until(lambda: tab.rows('quantity'), 'extrema')
    row = next(row for row in tab.rows('quantity') if row[0] == 'omega4')
    tab.driver.execute_script(
        "[...document.querySelectorAll('tbody tr')].filter(r => r.innerText.includes("
        'arguments[0]))[0].click()', row[2])
    tab.until(lambda: abs(float(tab.now().get('omega4', 'nan')) - float(row[2])) < 1e-6,
              'the extremum')


def test_the_keyboard_moves_the_input(tab):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
    tab.driver.execute_script(
        'document.querySelector(\'[role=slider][aria-label="input"] [tabindex]\').focus()')
    before = tab.now()['theta1']
    ActionChains(tab.driver).send_keys(Keys.ARROW_RIGHT * 5).perform()
    tab.until(lambda: tab.now().get('theta1') not in (None, before), 'another pose')


def test_accessibility_by_the_rules_of_axe(tab):
    from axe_core_python.selenium import Axe
    tab.until(lambda: tab.count_series('curves over the input, extrema marked'), 'curves')
    found = Axe().run(tab.driver)['violations']
    serious = [(rule['id'], rule['nodes'][0]['html'][:200]) for rule in found
               if rule['impact'] in ('critical', 'serious')]
    assert not serious


def test_nothing_leaves_this_machine(tab):
    sent = [json.loads(entry['message'])['message'] for entry in
            tab.driver.get_log('performance')]
    urls = {message['params']['request']['url'] for message in sent
            if message['method'] == 'Network.requestWillBeSent'}
    local = re.compile(r'(http://127\.0\.0\.1:|data:|blob:|chrome:)')
    assert urls and all(map(local.match, urls))


@pytest.mark.parametrize(('headers', 'code'), [
    ({}, 200), ({'Host': 'example.org'}, 403), ({'Origin': 'http://example.org'}, 403)])
def test_other_hosts_and_origins_are_refused(address, headers, code):
    request = urllib.request.Request(address, headers=headers)
    try:
        with urllib.request.urlopen(request) as answer:
            got = answer.status
    except urllib.error.HTTPError as error:
        got = error.code
    assert got == code


def test_the_socket_refuses_another_origin(address):
    url = address + '/_nicegui_ws/socket.io/?EIO=4&transport=polling'
    request = urllib.request.Request(url, headers={'Origin': 'http://example.org'})
    with pytest.raises(urllib.error.HTTPError) as caught:
        urllib.request.urlopen(request)
    assert caught.value.code == 403


def test_narrow_windows_have_one_column(tab):
    tab.driver.set_window_size(800, 900)
    try:
        tab.until(lambda: len(tab.driver.execute_script(
            "return getComputedStyle(document.querySelector('.fb-columns'))"
            '.gridTemplateColumns').split()) == 1, 'one column')
        tab.until(lambda: tab.driver.execute_script(
            'return document.documentElement.scrollWidth - innerWidth') <= 0,
            'nothing to be cut off at the side')
    finally:
        tab.driver.set_window_size(1280, 1000)
