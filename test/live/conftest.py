# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One browser for the tests of a module."""
import pytest
from support.browser import browser


@pytest.fixture(scope='module')
def driver(tmp_path_factory):
    with browser(tmp_path_factory.mktemp('profile')) as driver:
        yield driver
