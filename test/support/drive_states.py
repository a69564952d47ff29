# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""States of a drive as the messages that a bag holds of them."""
from types import SimpleNamespace

STEP = 5_000_000           # [ns]


def take_all(states, rows, first=0):
    """Give rows (status, mode, values) to DriveStates; ``first``: number of the first."""
    for k, (status, mode, values) in enumerate(rows, first + 1):
        states.take(k * STEP, SimpleNamespace(status=status, mode=mode, **values._asdict()))
