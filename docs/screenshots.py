# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Take the pictures of the live page, in docs/images: ``python docs/screenshots.py [NAME]``."""
from pathlib import Path
import sys
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / 'test')]

from support.browser import browser, live, Tab  # noqa: E402, I100

HEIGHT = 1250                     # [px] with the first curves
PAGES = {                         # scene, width [px], address, tab, is dark
    'light': ('paper', 1280, '?at=-50', 'Curves', False),
    'dark': ('jansen', 1280, '?at=40', 'Extrema', True),
    'narrow': ('paper', 800, '?at=-50', 'Polygons', False)}


def take(name, scene, width, query, view, is_dark):
    """Take one picture."""
    with (TemporaryDirectory() as folder, live(scene) as address,
          browser(f'{folder}/browser', width) as driver):
        driver.set_window_size(width, HEIGHT)
        tab = Tab(driver, address + query)
        if is_dark:
            tab.by('dark or light').click()
        tab.open(view)
        tab.until(lambda: tab.rows('now'), 'the table')
        driver.implicitly_wait(2.0)
        driver.find_elements('css selector', '.no-such-thing')     # charts are drawn meanwhile
        if width < 1000:
            driver.execute_script("document.querySelector('.q-tabs').scrollIntoView()")
        driver.save_screenshot(str(ROOT / 'docs' / 'images' / f'live_{name}.png'))


if __name__ == '__main__':
    for name in sys.argv[1:] or PAGES:
        take(name, *PAGES[name])
