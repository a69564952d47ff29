# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What tests and benches share: references in many digits, scenes, bags, a harness for nodes."""
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]      # of the project
TEST = ROOT / 'test'                            # for sys.path of processes that import support
SUPPORT = TEST / 'support'
DATA = SUPPORT / 'data'
