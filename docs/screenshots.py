# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Take the pictures of the live page, in docs/images: ``python docs/screenshots.py [NAME]``."""
from pathlib import Path
import sys
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / 'test')]

from support.browser import browser, live, Tab  # noqa: E402, I100

PAGES = {                         # scene, width and height [px], address, view, is dark
    'light': ('paper', 1280, 1080, '#at=-50', 'Numbers', False),
    'dark': ('jansen', 1280, 1080, '#at=40', 'Extrema', True),
    'narrow': ('paper', 390, 844, '#at=-50', 'Extrema', False)}


def take(name, scene, width, height, query, view, is_dark):
    """Take one picture."""
    with (TemporaryDirectory() as folder, live(scene) as address,
          browser(f'{folder}/browser', width) as driver):
        driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
            'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': width < 600})
        tab = Tab(driver, address + query)
        if is_dark:
            tab.click('dark or light')
        tab.open(view)
        tab.until(lambda: 'fourbar show' in tab.script(
            "return document.querySelector('#view-Extrema .proof').textContent"), 'the extrema')
        driver.save_screenshot(str(ROOT / 'docs' / 'images' / f'live_{name}.png'))


if __name__ == '__main__':
    for name in sys.argv[1:] or PAGES:
        take(name, *PAGES[name])
