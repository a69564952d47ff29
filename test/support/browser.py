# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A real browser in front of a real ``fourbar live``."""
from contextlib import contextmanager
import json
from math import inf
import os
import re
import shutil
import subprocess
import sys
import threading

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
        [sys.executable, '-m', 'fourbar_ros.cli.main', 'live', '--port', '0',
         *map(str, arguments), '--no-browser'], stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, env={**environment, 'PYTHONUNBUFFERED': '1'})
    said = []
    for line in process.stdout:
        said.append(line)
        found = re.search(r'http://\S+:\d+', line)
        if found:
            # all that it says is read: a full pipe would stop it
            process.reader = threading.Thread(target=process.stdout.read, daemon=True)
            process.reader.start()
            return process, found[0]
    process.wait(PATIENCE)
    raise AssertionError(f'fourbar live ended: {"".join(said)}')


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


class Tab:
    """A page as a user sees it: elements by their labels, waits instead of sleeps."""

    def __init__(self, driver, address):
        self.driver = driver
        driver.get('about:blank')           # another address of the same page is another visit
        self.until(lambda: self._is_reached(address), address)
        self.until(lambda: driver.execute_script(
            'return document.documentElement.dataset.ready'), 'the page')

    def _is_reached(self, address):
        """Go there, or return False: a machine may be too slow for the patience of a load."""
        from selenium.common.exceptions import WebDriverException
        try:
            self.driver.get(address)
        except WebDriverException:
            return False
        return True

    @property
    def state(self):
        """Return the state of the page: its scene, and its view."""
        return json.loads(self.driver.execute_script('return JSON.stringify(page.store.state)'))

    def script(self, text, *arguments):
        """Return what a script in the page returns."""
        return self.driver.execute_script(text, *arguments)

    def click(self, label):
        """Click on the element with this label, once nothing covers it."""
        self.until(lambda: self.by(label).click() or True, f'{label} to be clicked')

    def by(self, label):
        """Return the element with this label."""
        return self.driver.find_element('css selector', f'[aria-label="{label}"]')

    def picture(self):
        """Return the SVG of the mechanism."""
        return self.script('return document.querySelector("#picture .main").innerHTML')

    def place(self, joint):
        """Return where a joint is in the window [px]."""
        return self.script(
            'const b = document.getElementById("picture").getBoundingClientRect(), [x, y] = '
            'page.picture.pixels(page.engine.joint(arguments[0])); return [b.x + x, b.y + y]',
            joint)

    def text_of(self, name):
        """Return the text of an element by its id: alarm, said, warnings."""
        return self.driver.find_element('id', name).text

    def alarm(self):
        """Return the line that says what is wrong."""
        return self.text_of('alarm')

    def wrong(self):
        """Return what fields say of what was typed."""
        return self.script("return [...document.querySelectorAll('.wrong')].map(e => "
                           "e.textContent).join('')")

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
        """Open one of the views beside the picture."""
        self.driver.find_element('id', f'tab-{name}').click()

    def menu(self, name, words):
        """Open a menu by its label and click on what has these words."""
        self.script('document.querySelectorAll("details.menu").forEach(e => e.open = '
                    'e.innerText.includes(arguments[0]) || e.firstElementChild.ariaLabel === '
                    'arguments[0])', name)
        found = [element for element in self.driver.find_elements(
            'css selector', 'details[open] button, details[open] label')
            if element.text.strip() == words]
        found[0].click()
        self.script('document.querySelectorAll("details.menu").forEach(e => e.open = false)')

    def rows(self, view):
        """Return the rows of texts of the table in a view."""
        return self.script(
            'return [...document.querySelectorAll(`#view-${arguments[0]} tbody tr`)].map(r => '
            '[...r.children].map(c => c.innerText.trim()))', view)

    def is_answered(self, name, value):
        """Return whether the server has answered a scene with this value of a parameter."""
        return self.script('return page.structure().values[arguments[0]]', name) == value

    def proof(self):
        """Return what stands above the table of extrema."""
        return self.script("return document.querySelector('#view-Extrema .proof').textContent")

    def largest(self):
        """Return [load, force] that the table of extrema names the largest of all pins."""
        load, force, shown = self.script("""
const row = [...document.querySelectorAll('#view-Extrema tbody tr')].findLast(row =>
  row.querySelector('small').textContent.startsWith('largest force of all'));
return [row.children[0].title, row.children[2].title, row.children[2].textContent]""")
        return [load, inf if shown == 'unbounded' else float(force)]

    def digits(self, quantity):
        """Return the finite extrema of a quantity with all digits, as shown from above."""
        return self.script("""
return [...document.querySelectorAll('#view-Extrema tbody tr')].filter(row =>
  row.children[0].title === arguments[0] && row.children[2].title).map(row =>
  Number(row.children[2].title))""", quantity)

    def now(self):
        """Return {name: value as text} of the present pose; the view is open."""
        return {row[0]: row[1] for row in self.rows('Values')}

    def keys(self, *keys):
        """Press keys, real ones, in one go."""
        from selenium.webdriver.common.action_chains import ActionChains
        ActionChains(self.driver, duration=0).send_keys(*keys).perform()

    def drag(self, start, *places):
        """Press the mouse at a place of the window, move it over others, and let go."""
        from selenium.webdriver.common.action_chains import ActionChains
        actions = ActionChains(self.driver, duration=30)
        pointer = actions.w3c_actions.pointer_action
        pointer.move_to_location(*map(round, start))
        actions.click_and_hold()
        for place in places:
            pointer.move_to_location(*map(round, place))
        actions.release()
        actions.perform()

    def address(self):
        """Return the state in the address of the page, {name: text}."""
        from urllib.parse import parse_qsl, urlsplit
        return dict(parse_qsl(urlsplit(self.driver.current_url).fragment,
                              keep_blank_values=True))

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
