# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A page in the browser that shows a mechanism moving, with its curves, loads and extrema.

Formulas stay in the core: this package turns results into pictures and pictures into a page.
Only :mod:`fourbar_lab.live.page` and :mod:`fourbar_lab.live.server` import the user-interface
server (NiceGUI).
"""
