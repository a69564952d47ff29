# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The ``fourbar`` command, one module a verb."""
import os

# Its systems of equations are small: threads of OpenBLAS only wait for each other, on a busy
# machine with numpy 1.26 for minutes.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
