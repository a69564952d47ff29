# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Memory of a large study does not grow with its size."""
from bench.large_study import run_study
from fourbar_lab.studies.results import Results
import pytest

pytest.importorskip('pyarrow')
MOST = 500.0        # [MB] of any process


@pytest.mark.slow
def test_ten_times_the_designs_take_no_more_memory(tmp_path):
    few, many = (run_study(tmp_path, rows, ['omega4', 'alpha4'], 2)
                 for rows in (100_000, 1_000_000))
    assert Results(many[0]).designs == 1_000_000
    assert many[2] <= 1.1 * few[2] < MOST, (few[2], many[2])
