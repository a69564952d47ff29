# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One browser and one server for the tests of a module."""
import time

import pytest
from support.browser import browser, PATIENCE, start, stop, Tab


@pytest.fixture(scope='module')
def driver(tmp_path_factory):
    with browser(tmp_path_factory.mktemp('profile')) as driver:
        yield driver


@pytest.fixture(scope='module')
def server():
    """Give (process, address)."""
    process, address = start('paper')
    yield process, address
    stop(process)


@pytest.fixture(scope='module')
def address(server):
    return server[1]


@pytest.fixture
def tab(driver, address):
    return Tab(driver, address)


@pytest.fixture
def download(driver, tmp_path):
    """Return a function: tab, words of the menu -> the file that was downloaded."""
    driver.execute_cdp_cmd('Browser.setDownloadBehavior', {
        'behavior': 'allow', 'downloadPath': str(tmp_path)})

    def download(tab, words, suffix, name='paper'):
        tab.menu('files', words)
        path, end = tmp_path / f'{name}.{suffix}', time.monotonic() + PATIENCE
        while not path.exists():
            assert time.monotonic() < end, f'no {path.name} among {list(tmp_path.iterdir())}'
            time.sleep(0.1)
        return path
    return download
