# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One browser and one server for the tests of a module."""
import pytest
from support.browser import browser, start, stop, Tab


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
