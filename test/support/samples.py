# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""How much of a sample ``make test`` takes; ``make test-all`` takes all of it. Random records."""
from dataclasses import fields

from hypothesis import settings
import pytest


def more(quick, long):
    """Return what this profile of hypothesis takes: the one of ``make test-all`` is long."""
    return long if settings.default.max_examples >= 100 else quick


def record(kind, *values):
    """Return a Body, Applied or Spring of values in the order of its fields."""
    return kind(**dict(zip([field.name for field in fields(kind)], values)))


def some(names, cases, quick, ids=None):
    """
    Return parametrize(names, cases) with all cases slow but the quick ones.

    quick: how many, from the beginning, or a collection of those that are.
    """
    cases = list(cases)
    assert isinstance(quick, int) or all(case in cases for case in quick), quick

    def marked(k, case):
        if k < quick if isinstance(quick, int) else case in quick:
            return case
        if hasattr(case, 'marks'):
            return case._replace(marks=(*case.marks, pytest.mark.slow))
        return pytest.param(*(case if ',' in names else (case,)), marks=pytest.mark.slow)
    return pytest.mark.parametrize(names, [marked(*each) for each in enumerate(cases)], ids=ids)
