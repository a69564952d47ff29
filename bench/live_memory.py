# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Memory of the live page's server while tabs come and go; MINUTES=60 for an hour.

Its tabs all turn, each with a picture some thirty times a second where the machine allows it.
"""
import os
import tempfile
import time

from .live import go, Server, SETTLE, watch

MINUTES = float(os.environ.get('MINUTES', '3'))
TABS = 10
SHARES = (0.25, 0.5, 0.75, 1.0)      # of the time at which the memory is printed


def tabs(driver, server, minutes):
    """Open ten tabs, let them turn, close them, again and again; return memory [(min, MB)]."""
    began, found, home = time.time(), [], driver.current_window_handle
    while time.time() - began < 60.0 * minutes:
        opened = []
        for _ in range(TABS):
            driver.switch_to.new_window('tab')
            opened.append(driver.current_window_handle)
            watch(driver)
            go(driver, server.address)
            driver.find_element('css selector', '[aria-label="play or pause"]').click()
        time.sleep(SETTLE)
        for handle in opened:
            driver.switch_to.window(handle)
            driver.close()
        driver.switch_to.window(home)
        found.append(((time.time() - began) / 60.0, server.memory()))
    return found


def main():
    """Print a table in Markdown."""
    from support.browser import browser, CHROMIUM, DRIVER, HOW
    if not (CHROMIUM and DRIVER):
        print(HOW)
        return
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder, browser(folder) as driver, \
            Server('paper') as server:
        watch(driver)
        go(driver, server.address)
        before = server.memory()
        found = tabs(driver, server, MINUTES)
    print(f'Load of the machine at the start: {load:.1f}.\n\nMemory of the server in MB, {TABS} '
          f'tabs that turn opened and closed again and again: {len(found) * TABS} tabs in '
          f'{found[-1][0]:.1f} min.\n\n| before | after the first | a quarter | half | three '
          'quarters | end |\n|' + ' --- |' * 6)
    places = [0, *(round(share * (len(found) - 1)) for share in SHARES)]
    print(f'| {before:.0f} | ' + ' | '.join(f'{found[i][1]:.0f}' for i in places) + ' |')


if __name__ == '__main__':
    main()
