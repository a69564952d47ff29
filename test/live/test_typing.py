# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a user types and moves stays and holds, however busy or late the server is."""
from contextlib import contextmanager
from math import pi
import os
import signal

import pytest
from support.browser import needs_browser, open_last_closed

pytestmark = [needs_browser, pytest.mark.slow]
# Notes every text that a field shows, once each frame.
WATCH = """
window.seen = [];
const field = arguments[0];
const look = () => {
  if (window.seen.at(-1) !== field.value) window.seen.push(field.value);
  requestAnimationFrame(look);
};
look();
"""


def apart(one, other):
    """Return the difference of two angles [deg]."""
    return abs((one - other + 180.0) % 360.0 - 180.0)


@pytest.fixture
def held(server):
    """Return a context in which the server stands still: it answers afterwards."""
    @contextmanager
    def held():
        os.kill(server[0].pid, signal.SIGSTOP)
        try:
            yield
        finally:
            os.kill(server[0].pid, signal.SIGCONT)
    return held


def turn(tab):
    """Wait until the mechanism has moved on."""
    before = tab.picture()
    tab.until(lambda: tab.picture() != before, 'motion')


def test_the_browser_plays_and_scrubs_while_the_server_stands_still(tab, held):
    from selenium.webdriver.common.keys import Keys
    tab.until(lambda: tab.driver.execute_script(
        'return getElement(+arguments[0].parentElement.id.slice(1)).frames.length',
        tab.by('the mechanism in its pose')) > 100, 'the frames of a cycle')
    with held():
        tab.click('play or pause')
        for _ in range(5):
            before = tab.now()['theta1'], tab.picture()
            tab.until(lambda before=before: tab.now()['theta1'] != before[0]
                      and tab.picture() != before[1], 'motion')
        tab.click('play or pause')
        tab.focus_slider('input')
        tab.keys(*[Keys.ARROW_RIGHT] * 20)
        stands = float(tab.by('input').get_attribute('aria-valuenow'))
        tab.until(lambda: apart(float(tab.now()['theta1']), stands) < 2.0, 'the nearest pose')
    tab.until(lambda: apart(float(tab.query().get('at', 'nan')), stands) < 1e-6
              and tab.now()['theta1'] == tab.text('input value'), 'the pose where it rests')


def test_digits_typed_while_it_turns_stay_and_hold(tab):
    from selenium.webdriver.common.keys import Keys
    tab.click('play or pause')
    turn(tab)
    tab.select('input value')
    for digit in '160.5':
        turn(tab)
        tab.keys(digit)
    turn(tab)
    turn(tab)
    assert tab.text('input value') == '160.5'
    tab.keys(Keys.ENTER)
    tab.until(lambda: tab.query().get('at') == '160.5', 'the input that was typed')
    tab.until(lambda: tab.now().get('theta1') == '160.5', 'its pose, at rest')
    tab.keys(Keys.TAB)
    tab.click('play or pause')
    tab.until(lambda: tab.text('input value') != '160.5', 'the field to follow again')


def test_a_late_answer_never_brings_back_what_was_there_before(tab, held):
    from selenium.webdriver.common.keys import Keys
    tab.click('play or pause')
    turn(tab)
    with held():
        old = float(tab.text('input value'))
        there = round(old - 180.0 if old > 180.0 else old + 180.0)
        field = tab.select('input value')
        tab.keys(*str(there), Keys.TAB)
        tab.driver.execute_script(WATCH, field)
    tab.until(lambda: tab.query().get('at') == str(there), 'the input that was typed')
    tab.until(lambda: tab.now().get('theta1') == str(there), 'its pose')
    assert tab.driver.execute_script('return window.seen') == [str(there)]


def test_what_is_typed_is_kept_to_its_last_digit(tab):
    from selenium.webdriver.common.keys import Keys
    tab.select('input value')
    tab.keys(*'60.1234567', Keys.TAB)       # the field has room for six digits
    tab.until(lambda: tab.text('input value') == '60.1235', 'the field, left')
    tab.until(lambda: tab.query().get('at') == '60.1234567', 'the input')


def test_an_emptied_input_gives_way_to_what_it_is(tab):
    from selenium.webdriver.common.keys import Keys
    tab.write('input value', '60')
    tab.until(lambda: tab.query().get('at') == '60', 'the input')
    tab.select('input value')
    tab.keys(Keys.DELETE, Keys.TAB)
    tab.until(lambda: tab.text('input value') == '60', 'the input again')


@pytest.mark.parametrize(('name', 'typed', 'value'), [
    ('linkage.a2', '1150mm', 1.15), ('bodies.rods.radius', '30 mm', 0.03),
    ('drive.speed', '60rpm', 2.0 * pi), ('bodies.rods.density', '2.7 g/cm^3', 2700.0)])
def test_units_that_are_typed_count_as_on_the_command_line(tab, name, typed, value):
    tab.until(lambda: not open_last_closed(tab), 'all groups open')
    tab.write(name, typed)
    tab.until(lambda: float(tab.query().get(name, 'nan')) == pytest.approx(value, 1e-15), name)
    assert float(tab.text(name)) == pytest.approx(value, 1e-11) and not tab.alarm()


@pytest.mark.parametrize(('typed', 'why'), [
    ('0,085', 'must be written 0.085'), ('30 kg', 'must be a number in m'),
    ('abc', 'must be a number in m'), ('-', 'must be a number in m'),
    ('1e400', 'must be a finite number')])
def test_what_is_no_number_is_refused_in_words_and_changes_nothing(tab, typed, why):
    before = tab.picture()
    tab.write('linkage.a3', typed)
    tab.until(lambda: f'linkage.a3 = {typed!r}: {why}' in tab.alarm(), 'the reason')
    assert tab.text('linkage.a3') == typed and 'linkage.a3' not in tab.query()
    assert tab.picture() == before
    tab.write('linkage.a3', '82 cm')
    tab.until(lambda: tab.query().get('linkage.a3') == '0.82' and not tab.alarm(), 'the next')


def test_an_emptied_field_takes_back_what_it_had(tab):
    from selenium.webdriver.common.keys import Keys
    before = tab.text('linkage.a2')
    tab.select('linkage.a2')
    tab.keys(Keys.DELETE, Keys.ENTER)
    tab.until(lambda: tab.text('linkage.a2') == before, 'what was there')
    tab.write('linkage.a2', '115e-2')
    tab.until(lambda: tab.query().get('linkage.a2') == '1.15', 'the next')


def test_the_input_is_typed_with_a_unit_too(tab):
    tab.write('input value', '1 rad')
    tab.until(lambda: tab.query().get('at') == '57.2957795', 'a radian in degrees')
    tab.write('input value', '60,5')
    tab.until(lambda: tab.alarm() == "theta1 = '60,5': must be written 60.5: a comma is no "
              'decimal point', 'the reason')
    assert tab.query().get('at') == '57.2957795'
    tab.until(lambda: tab.text('input value') == '57.2958', 'what it was')
    tab.write('acceleration of the input', '100 rpm/s')
    tab.until(lambda: float(tab.query().get('acceleration', 'nan')) == pytest.approx(
        100.0 * pi / 30.0, 1e-5), 'the acceleration')


def test_home_and_end_move_a_slider_to_its_ends(tab):
    from selenium.webdriver.common.keys import Keys
    for key, end in ((Keys.END, 360.0), (Keys.HOME, 0.0)):
        tab.focus_slider('input')
        tab.keys(key)
        tab.until(lambda end=end: float(tab.query().get('at', 'nan')) == end, str(end))


def test_every_step_of_a_slider_counts(tab, held):
    from selenium.webdriver.common.keys import Keys
    tab.focus_slider('linkage.a2 slider')
    first = float(tab.text('linkage.a2'))
    tab.keys(Keys.ARROW_RIGHT)
    tab.until(lambda: 'linkage.a2' in tab.query(), 'a step')
    step = float(tab.query()['linkage.a2']) - first
    with held():
        tab.keys(*[Keys.ARROW_RIGHT] * 3, *[Keys.ARROW_LEFT] * 3)
    tab.keys(*[Keys.ARROW_RIGHT] * 6)
    tab.until(lambda: float(tab.query()['linkage.a2']) == pytest.approx(first + 7 * step, 1e-9),
              'seven steps')
    tab.until(lambda: float(tab.text('linkage.a2')) == pytest.approx(first + 7 * step, 1e-9),
              'the field')
    tab.write('linkage.a2', str(first))
    tab.until(lambda: 'linkage.a2' not in tab.query(), 'the first value, typed')


def test_a_click_on_the_slider_of_the_input_goes_there(tab):
    from selenium.webdriver.common.action_chains import ActionChains
    slider = tab.driver.find_element('css selector', '[role=slider][aria-label="input"]')
    ActionChains(tab.driver).move_to_element_with_offset(
        slider, slider.size['width'] // 4, 0).click().perform()
    tab.until(lambda: abs(float(tab.query().get('at', 0.0)) - 270.0) < 5.0, 'three quarters')
