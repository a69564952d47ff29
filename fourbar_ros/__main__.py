# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``python -m fourbar_ros`` is ``fourbar``."""
import sys

from fourbar_ros.cli.main import main

sys.exit(main())
