# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A real browser in front of a real ``fourbar live``."""
from contextlib import contextmanager
import os
import re
import shutil
import socket
import subprocess
import sys
import threading
import time

import pytest

PATIENCE = 120.0        # [s] a machine may be slow
CHROMIUM = shutil.which('chromium') or shutil.which('chromium-browser')
DRIVER = shutil.which('chromedriver')
HOW = ('no browser: apt-get install chromium chromium-driver, or the packages of that name '
       'elsewhere')
needs_browser = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason=HOW)


def start(*arguments):
    """Start ``fourbar live``; return the process and, as soon as it listens, its address."""
    # to the page's server it would be a test of its own kind
    environment = {name: value for name, value in os.environ.items()
                   if name != 'PYTEST_CURRENT_TEST'}
    process = subprocess.Popen(
        [sys.executable, '-m', 'fourbar_ros.cli.main', 'live', *map(str, arguments),
         '--no-browser'], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env={**environment, 'PYTHONUNBUFFERED': '1'})
    said = []
    for line in process.stdout:
        said.append(line)
        found = re.search(r'http://(\S+):(\d+)', line)
        if found:
            # all that it says is read: a full pipe would stop it
            process.reader = threading.Thread(target=process.stdout.read, daemon=True)
            process.reader.start()
            _wait_for(found[1], int(found[2]))
            return process, found[0]
    process.wait(PATIENCE)
    raise AssertionError(f'fourbar live ended: {"".join(said)}')


def _wait_for(host, port):
    """Wait until the server listens: it says its address a moment before."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return socket.create_connection((host, port), PATIENCE).close()
        except OSError:
            assert time.monotonic() < end, f'nothing listens on {host}:{port}'
            time.sleep(0.05)


def stop(process):
    """End what :func:`start` started."""
    process.terminate()
    process.wait(PATIENCE)
    process.reader.join(PATIENCE)
    process.stdout.close()


@contextmanager
def live(*arguments):
    """Run ``fourbar live`` and give the address of its page."""
    process, address = start(*arguments)
    try:
        yield address
    finally:
        stop(process)


def _chromium(folder, width, height):
    """Return a driver of a browser with a profile in this folder."""
    from selenium import webdriver
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ('--headless=new', '--no-sandbox', '--disable-gpu', '--disable-quic',
                     '--no-first-run', '--disable-background-networking',
                     '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage',
                     f'--window-size={width},{height}', f'--user-data-dir={folder}'):
        options.add_argument(argument)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL', 'performance': 'ALL'})
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))


def _started(folder, width, height):
    """Start a browser, again if it does not come up: the driver waits only 60 s."""
    from selenium.common.exceptions import SessionNotCreatedException
    for attempt in range(4):
        try:
            return _chromium(f'{folder}/{attempt}', width, height)
        except SessionNotCreatedException:
            pass
    return _chromium(f'{folder}/last', width, height)


@contextmanager
def browser(folder, width=1280, height=1000):
    """Give a headless Chromium with an empty profile that asks nothing of the network."""
    driver = _started(folder, width, height)
    try:
        driver.set_script_timeout(PATIENCE)
        driver.set_page_load_timeout(PATIENCE / 2.0)        # Tab loads again after it
        yield driver
    finally:
        driver.quit()


def open_last_closed(tab):
    """Open a group from below, as what opens moves others; return whether one was closed."""
    closed = tab.driver.find_elements('css selector', '.q-expansion-item--collapsed .q-item')
    if closed:
        closed[-1].click()
    return bool(closed)


class Tab:
    """A page as a user sees it: elements by their labels, waits instead of sleeps."""

    def __init__(self, driver, address):
        self.driver = driver
        self.until(lambda: self._is_reached(address), address)
        self.until(lambda: '<circle' in self.picture(), 'a picture')
        self.until(lambda: driver.execute_script('return window.did_handshake'), 'a connection')
        self.until(lambda: self._height() > 100, 'the place of the picture')    # else all moves

    def _is_reached(self, address):
        """Go there, or return False: a machine may be too slow for the patience of a load."""
        from selenium.common.exceptions import WebDriverException
        try:
            self.driver.get(address)
        except WebDriverException:
            return False
        return True

    def _height(self):
        """Return the height of the picture of the mechanism [px]."""
        return self.by('the mechanism in its pose').size['height']

    def click(self, label):
        """Click on the element with this label, once nothing covers it."""
        self.until(lambda: self.by(label).click() or True, f'{label} to be clicked')

    def by(self, label):
        """Return the element with this label."""
        return self.driver.find_element('css selector', f'[aria-label="{label}"]')

    def picture(self):
        """Return the SVG of the mechanism."""
        found = self.driver.find_elements('css selector',
                                          '[aria-label="the mechanism in its pose"]')
        return found[0].get_attribute('innerHTML') if found else ''

    def frame(self):
        """Return where the picture begins in the window [px], and how much it is enlarged."""
        return self.driver.execute_script(
            'const m = arguments[0].getScreenCTM(); return [m.e, m.f, m.a]',
            self.by('the mechanism in its pose'))

    def alarm(self):
        """Return the line that says what is wrong."""
        return self.driver.find_element('css selector', '[role=alert]').text

    def warnings(self):
        """Return the lines that say what is probably not meant."""
        return self.driver.find_element('css selector', '.fb-warnings').text

    def select(self, label):
        """Put the keyboard's focus on a field and select its text; return it."""
        from selenium.webdriver.common.keys import Keys
        field = self.driver.find_element('css selector', f'input[aria-label="{label}"]')
        field.send_keys(Keys.CONTROL, 'a')
        return field

    def write(self, label, text):
        """Replace the text of a field and press Enter: it holds."""
        from selenium.webdriver.common.keys import Keys
        self.select(label).send_keys(text, Keys.ENTER)

    def text(self, label):
        """Return what a field shows."""
        return self.driver.find_element('css selector', f'input[aria-label="{label}"]'
                                        ).get_attribute('value')

    def open(self, name):
        """Open one of the views."""
        self.until(lambda: self._is_clicked('.q-tab', name), f'{name} among the views')

    def tick(self, words):
        """Click on the checkbox that has these words."""
        self.until(lambda: self._is_clicked('.q-checkbox', words), f'{words} to be clicked')

    def press(self, words):
        """Press the button of a choice that has these words."""
        self.until(lambda: self._is_clicked('.q-btn-toggle button', words), f'{words} to press')

    def choose(self, words):
        """Click on the item of an open menu that has these words."""
        self.until(lambda: self._is_clicked('.q-item', words), f'{words} in a menu')

    def _is_clicked(self, selector, words):
        """Click on the first of these elements that has these words, if there is one."""
        found = [element for element in self.driver.find_elements('css selector', selector)
                 if element.is_displayed() and words in element.text]
        if found:
            found[0].click()
        return bool(found)

    def rows(self, label):
        """Return the rows of texts of the table in whose head this stands."""
        return self.driver.execute_script(
            "return [...document.querySelectorAll('table')].filter(t => t.offsetParent && "
            't.innerText.startsWith(arguments[0])).flatMap(t => [...t.querySelectorAll('
            "'tbody tr')].map(r => [...r.children].map(c => c.innerText.trim())))", label)

    def now(self):
        """Return {name: value as text} of the present pose."""
        return {row[0]: row[1] for row in self.rows('now') if len(row) >= 3}

    def keys(self, *keys):
        """Press keys, real ones, in one go."""
        from selenium.webdriver.common.action_chains import ActionChains
        ActionChains(self.driver, duration=0).send_keys(*keys).perform()

    def focus_slider(self, label):
        """Put the keyboard's focus on a slider."""
        self.driver.execute_script(
            "document.querySelector(`[role=slider][aria-label='${arguments[0]}']`)"
            ".querySelector('[tabindex]').focus()", label)

    def labels(self, role):
        """Return the labels of all controls of a role."""
        return self.driver.execute_script(
            'return [...document.querySelectorAll(`[role=${arguments[0]}]`)]'
            ".map(e => e.getAttribute('aria-label'))", role)

    def query(self):
        """Return the state in the address of the page, {name: text}."""
        from urllib.parse import parse_qsl, urlsplit
        return dict(parse_qsl(urlsplit(self.driver.current_url).query))

    def pins(self, kind='pin'):
        """Return the places of all joints in the picture, in its own pixels."""
        found = re.findall(rf'class="{kind}" cx="([^"]+)" cy="([^"]+)"', self.picture())
        return [(float(x), float(y)) for x, y in found]

    def count_series(self, label):
        """Return how many curves a chart has; 0 when it is empty."""
        chart = self.driver.find_elements('css selector', f'[aria-label="{label}"]')
        return self.driver.execute_script(
            'return getElement(+arguments[0].id.slice(1)).chart.getOption()?.series?.length || 0',
            chart[0]) if chart else 0

    def until(self, condition, what):
        """Wait until a condition holds."""
        from selenium.common.exceptions import (
            ElementClickInterceptedException,
            ElementNotInteractableException,
            StaleElementReferenceException,
            TimeoutException,
        )
        from selenium.webdriver.support.ui import WebDriverWait
        try:
            WebDriverWait(self.driver, PATIENCE, 0.1, [
                ElementClickInterceptedException, ElementNotInteractableException,
                StaleElementReferenceException]).until(lambda _: condition())
        except TimeoutException:
            raise AssertionError(f'waited in vain for {what}') from None
