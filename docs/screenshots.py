# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Take the pictures of the live page, in docs/images: ``python docs/screenshots.py [NAME]``."""
from pathlib import Path
import sys
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / 'test')]

from support import bags  # noqa: E402, I100
from support.browser import browser, live, Tab  # noqa: E402
from support.scenes import PAPER, RODS  # noqa: E402

HEIGHT = 1250                     # [px] with the first curves
STEPS = 500                       # of a run, 1 ms each
PAGES = {                         # scene, width [px], address, tab, is dark
    'light': ('paper', 1280, '?at=-50', 'Curves', False),
    'dark': ('jansen', 1280, '?at=40', 'Forces', True),
    'narrow': ('paper', 800, '?at=-50', 'Polygons', False),
    'two_runs': ('', 1280, '', 'Curves', False)}


def two_runs(folder):
    """Return the bags of two runs: the paper's linkage, and with a longer output link."""
    values = {**PAPER, **RODS, 'outputs': ['state', 'loads']}
    cranks = [(25.0 * k * 1e-3, 25.0, 0.0) for k in range(STEPS)]
    return [bags.run(folder, name, {**values, 'linkage.a3': length}, cranks, paced=True)
            for name, length in (('nominal', 0.8), ('longer', 0.9))]


def take(name, scene, width, query, view, is_dark):
    """Take one picture."""
    with TemporaryDirectory() as folder:
        shown = [scene] if scene else two_runs(Path(folder))
        with live(*shown) as address, browser(f'{folder}/browser', width) as driver:
            driver.set_window_size(width, HEIGHT)
            tab = Tab(driver, address + query)
            if is_dark:
                tab.by('dark or light').click()
            tab.open(view)
            tab.until(lambda: tab.rows('now'), 'the table')
            if not scene:
                tab.write('input value', '0.05')
            driver.implicitly_wait(2.0)
            driver.find_elements('css selector', '.no-such-thing')     # charts are drawn meanwhile
            if width < 1000:
                driver.execute_script("document.querySelector('.q-tabs').scrollIntoView()")
            driver.save_screenshot(str(ROOT / 'docs' / 'images' / f'live_{name}.png'))


if __name__ == '__main__':
    for name in sys.argv[1:] or PAGES:
        take(name, *PAGES[name])
