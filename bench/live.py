# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The live page in a browser: first picture, slider to picture, pictures a second.

All times are the browser's: from a real input event to the picture that answers it.
"""
import os
from pathlib import Path
import tempfile
import time

from .processes import percentile

STARTS = 5
TURNING = 10.0          # [s]
SETTLE = 2.0            # [s]
SLIDERS = {'paper': 'linkage.a2', 'jansen': 'dyads.upper.length_1', 'cylinder': 'linkage.a1'}
TICKS = os.sysconf('SC_CLK_TCK')
# Notes when the picture changes and, as a frame later it is on the screen, when it is shown;
# which key or pointer event came before; the first picture after the start.
WATCH = """
window.fb = {changes: 0, asked: null, answers: [], first: null};
document.addEventListener('keydown', e => { fb.asked = e.timeStamp; }, true);
const look = () => {
  const box = document.querySelector('[aria-label="the mechanism in its pose"]');
  const group = box && box.querySelector('svg g:last-of-type');
  if (!group || !box.querySelector('circle.pin')) return requestAnimationFrame(look);
  fb.first = performance.timeOrigin + performance.now();
  new MutationObserver(() => {
    fb.changes += 1;
    const asked = fb.asked;
    if (asked === null) return;
    fb.asked = null;
    requestAnimationFrame(() => fb.answers.push(performance.now() - asked));
  }).observe(box, {childList: true, subtree: true});
};
requestAnimationFrame(look);
"""


class Server:
    """``fourbar live`` of a scene."""

    def __init__(self, *arguments):
        from support import browser
        self._stop = browser.stop
        self.began = time.time()
        self.process, self.address = browser.start(*arguments)
        self._stat = Path(f'/proc/{self.process.pid}/stat')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._stop(self.process)

    def cpu(self):
        """Return the CPU time used so far, by all its threads [s]."""
        user, system = self._stat.read_text().rpartition(')')[2].split()[11:13]
        return (int(user) + int(system)) / TICKS

    def memory(self):
        """Return the resident memory [MB]."""
        pages = int(Path(f'/proc/{self.process.pid}/statm').read_text().split()[1])
        return pages * os.sysconf('SC_PAGE_SIZE') / 1e6


def watch(driver):
    """Let each page of the present tab note what changes."""
    driver.execute_cdp_cmd('Page.addScriptToEvaluateOnNewDocument', {'source': WATCH})


def go(driver, address, patience=60.0):
    """Open a page and wait for its first picture."""
    from selenium.common.exceptions import WebDriverException
    end = time.monotonic() + patience
    while time.monotonic() < end:
        try:
            driver.get(address)
            break
        except WebDriverException:       # the server says its address a moment before it listens
            time.sleep(0.01)
    wait(driver, 'return fb.first !== null', patience)


def wait(driver, condition, patience=60.0):
    """Wait until JavaScript returns what is true."""
    end = time.monotonic() + patience
    while not driver.execute_script(condition):
        if time.monotonic() > end:
            raise RuntimeError(f'in vain: {condition}')
        time.sleep(0.005)


def first_picture(driver, scene):
    """Return [s] from the start of the process to its address, and to the first picture."""
    with Server(scene) as server:
        said = time.time() - server.began
        go(driver, server.address)
        return said, driver.execute_script('return fb.first') / 1e3 - server.began


def latencies(driver, label, count):
    """Return [ms] from each arrow key on a slider to the picture on the screen."""
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
    driver.execute_script(
        f'document.querySelector(\'[role=slider][aria-label="{label}"]\')'
        '.querySelector("[tabindex]").focus(); fb.answers = []')
    for number in range(count):
        key = Keys.ARROW_RIGHT if number // 5 % 2 == 0 else Keys.ARROW_LEFT
        ActionChains(driver, duration=0).send_keys(key).perform()
        wait(driver, f'return fb.answers.length > {number}')
        time.sleep(0.06)                 # beyond the throttle of a slider: each is its own event
    return driver.execute_script('return fb.answers')


def turning(driver, server):
    """Return (pictures a second, CPU of the server in cores) while the mechanism turns."""
    button = driver.find_element('css selector', '[aria-label="play or pause"]')
    button.click()
    time.sleep(SETTLE)
    changes, cpu, began = driver.execute_script('return fb.changes'), server.cpu(), time.time()
    time.sleep(TURNING)
    seconds = time.time() - began
    found = ((driver.execute_script('return fb.changes') - changes) / seconds,
             (server.cpu() - cpu) / seconds)
    button.click()
    return found


def main(samples=200):
    """Print tables in Markdown."""
    from support.browser import browser, CHROMIUM, DRIVER, HOW
    if not (CHROMIUM and DRIVER):
        print(HOW)
        return
    print(f'Load of the machine at the start: {os.getloadavg()[0]:.1f}.\n')
    with tempfile.TemporaryDirectory() as folder, browser(folder) as driver:
        watch(driver)
        print_starts(driver)
        print_motion(driver, samples)


def print_starts(driver):
    """Print the times to the first picture."""
    print(f'From the start of the process, in s (median of {STARTS}, largest); the browser is '
          'open already.\n\n| scene | address printed | first picture |\n| --- | --- | --- |')
    for scene in SLIDERS:
        said, first = zip(*[first_picture(driver, scene) for _ in range(STARTS)])
        cells = [f'{percentile(found, 0.5):.2f}, {max(found):.2f}' for found in (said, first)]
        print(f'| {scene} | {" | ".join(cells)} |')


def print_motion(driver, samples):
    """Print the time from slider to picture, and what turning costs."""
    print(f'\nFrom a key on a slider to the picture on the screen, in ms, {samples} keys each; '
          f'then {TURNING:g} s of turning.\n\n| scene | input p50 | p95 | length p50 | p95 | '
          'pictures/s | CPU of the server |\n|' + ' --- |' * 7)
    for scene, length in SLIDERS.items():
        with Server(scene) as server:
            go(driver, server.address)
            time.sleep(SETTLE)
            cells = []
            for label in ('input', f'{length} slider'):
                found = latencies(driver, label, samples)
                cells += [f'{percentile(found, share):.0f}' for share in (0.5, 0.95)]
            rate, cores = turning(driver, server)
            print(f'| {scene} | {" | ".join(cells)} | {rate:.1f} | {100.0 * cores:.0f} % |')


if __name__ == '__main__':
    main()
