# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A page in the browser that shows a mechanism moving, with its curves, loads and extrema.

Its formulas are those of the core, as JavaScript (:mod:`fourbar_lab.export.js_code`). Only
:mod:`fourbar_lab.live.server` imports a server (starlette, uvicorn).
"""
