# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A real browser in front of a real ``fourbar live``."""
from contextlib import contextmanager
import os
import re
import shutil
import subprocess
import sys

import pytest

PATIENCE = 120.0        # [s] a machine may be slow
CHROMIUM = shutil.which('chromium') or shutil.which('chromium-browser')
DRIVER = shutil.which('chromedriver')
HOW = ('no browser: apt-get install chromium chromium-driver, or the packages of that name '
       'elsewhere')
needs_browser = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason=HOW)


def start(*arguments):
    """Start ``fourbar live``; return the process and, as soon as it is said, its address."""
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
        found = re.search(r'http://\S+', line)
        if found:
            return process, found[0]
    stop(process)
    raise AssertionError(f'fourbar live ended: {"".join(said)}')


def stop(process):
    """End what :func:`start` started."""
    process.terminate()
    process.wait(PATIENCE)
    process.stdout.close()


@contextmanager
def live(*arguments):
    """Run ``fourbar live`` and give the address of its page."""
    process, address = start(*arguments)
    try:
        yield address
    finally:
        stop(process)


@contextmanager
def browser(folder, width=1280, height=1000):
    """Give a headless Chromium with an empty profile that asks nothing of the network."""
    from selenium import webdriver
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ('--headless=new', '--no-sandbox', '--disable-gpu', '--disable-quic',
                     '--no-first-run', '--disable-background-networking',
                     '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage',
                     f'--window-size={width},{height}', f'--user-data-dir={folder}'):
        options.add_argument(argument)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL', 'performance': 'ALL'})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    try:
        yield driver
    finally:
        driver.quit()


class Tab:
    """A page as a user sees it: elements by their labels, waits instead of sleeps."""

    def __init__(self, driver, address):
        self.driver = driver
        self.until(lambda: self._is_reached(address), address)
        self.until(lambda: '<circle' in self.picture(), 'a picture')

    def _is_reached(self, address):
        """Go there; the server says its address a moment before it listens."""
        from selenium.common.exceptions import WebDriverException
        try:
            self.driver.get(address)
        except WebDriverException:
            return False
        return True

    def by(self, label):
        """Return the element with this label."""
        return self.driver.find_element('css selector', f'[aria-label="{label}"]')

    def picture(self):
        """Return the SVG of the mechanism."""
        found = self.driver.find_elements('css selector',
                                          '[aria-label="the mechanism in its pose"]')
        return found[0].get_attribute('innerHTML') if found else ''

    def alarm(self):
        """Return the line that says what is wrong."""
        return self.driver.find_element('css selector', '[role=alert]').text

    def write(self, label, text):
        """Replace the text of a field."""
        from selenium.webdriver.common.keys import Keys
        field = self.driver.find_element('css selector', f'input[aria-label="{label}"]')
        field.send_keys(Keys.CONTROL, 'a')
        field.send_keys(text)

    def open(self, name):
        """Open one of the views."""
        for tab in self.driver.find_elements('css selector', '.q-tab'):
            if tab.text.strip() == name:
                tab.click()

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
            StaleElementReferenceException,
            TimeoutException,
        )
        from selenium.webdriver.support.ui import WebDriverWait
        try:
            WebDriverWait(self.driver, PATIENCE, 0.1, [StaleElementReferenceException]).until(
                lambda _: condition())
        except TimeoutException:
            raise AssertionError(f'waited in vain for {what}') from None
