# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""States of a drive as the columns that a bag gives of them."""
from types import SimpleNamespace

from fourbar_ros.dynamics.step.mover import DriveValues
import numpy as np

STEP = 5_000_000           # [ns]


def columns_of(rows, first=0):
    """Return what a bag gives of rows (status, mode, values); ``first``: number of the first."""
    values = np.array([values for *_, values in rows])
    records = {'status': np.array([status for status, *_ in rows]),
               'mode': np.array([mode for _, mode, _ in rows]),
               **dict(zip(DriveValues._fields, values.T))}
    places = np.arange(first, first + len(rows))
    return SimpleNamespace(places=places, headed=STEP * (1 + places), records=records)
