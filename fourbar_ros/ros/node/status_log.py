# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Log lines about the status of the stream."""
from __future__ import annotations

from fourbar_ros.errors import OutOfRange
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.pipeline.status import OK, OUT_OF_RANGE, STATUS_NAMES
from fourbar_ros.ros.node.quiet_log import QuietLog


class StatusLog:
    """
    Logs changes of the status.

    Parameters
    ----------
    log : QuietLog

    """

    def __init__(self, log: QuietLog) -> None:
        self._log = log

    def changed(self, status: int, position: float, linkage: Mechanism) -> None:
        """Log a new status, and the input that caused it."""
        if status == OK:
            self._log.info(status, 'input good again')
            return
        name, unit = linkage.input_coordinate.position, linkage.input_coordinate.unit
        self._log.warning(status, str(OutOfRange(name, position, linkage.input_ranges, unit))
                          if status == OUT_OF_RANGE else f'{name} = {position!r} {unit}: '
                                                         f'{STATUS_NAMES[status]}')

    def timeout(self, seconds: float) -> None:
        """Log that the input has stopped."""
        self._log.warning('timeout', f'no input for {seconds:g} s')
