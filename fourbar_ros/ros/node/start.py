# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Entry point of fourbar_node: catches signals, then imports the node, which takes a while."""
from __future__ import annotations

import sys

from fourbar_ros.ros.stop import Stop


def main(args: list[str] | None = None) -> int:
    """Run the node; return its exit code."""
    stop = Stop().catch()
    from fourbar_ros.ros.node import node

    return node.main(args, stop)


if __name__ == '__main__':
    sys.exit(main())
