# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Measurements of this project: each module has a ``main()`` that prints Markdown.

See ``python -m bench -h``.
"""
import os
from pathlib import Path
import sys

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / 'test')]      # the package itself and test/support

# The threads of a BLAS spin for a while after their work, which would count as CPU time of what
# comes next.
for _name in ('OMP_NUM_THREADS', 'OPENBLAS_NUM_THREADS', 'MKL_NUM_THREADS'):
    os.environ[_name] = '1'
