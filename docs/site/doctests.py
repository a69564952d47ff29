# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""An extension of griffe: sessions in docstrings are code, where Markdown reads >>> as quotes."""
import re

import griffe


class Doctests(griffe.Extension):
    """Fence the sessions of every docstring."""

    def on_instance(self, *, obj, **_):
        if obj.docstring:
            obj.docstring.value = re.sub(r'^>>> .*?(?=\n\n|\Z)', r'```pycon\n\g<0>\n```',
                                         obj.docstring.value, flags=re.M | re.S)
