# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures on one HTML page that needs no other file."""
from __future__ import annotations

from collections.abc import Mapping
from html import escape
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

from fourbar_ros.errors import FourBarError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = """\
<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>{title}</title>
<style>body {{ font-family: sans-serif; margin: 2em auto; max-width: 60em }} svg {{ width: 100% }}
</style></head>
<body><h1>{title}</h1>
{body}
</body></html>
"""


class CannotWrite(FourBarError, ValueError):
    """A file cannot be written in the format of its suffix; the message says which ones are."""


def write_page(path: Path, title: str, figures: Mapping[str, Figure]) -> Path:
    """Write figures, {heading: figure}, as SVG in a page; return its path or raise CannotWrite."""
    parts = []
    for heading, figure in figures.items():
        text = StringIO()
        figure.savefig(text, format='svg')
        svg = text.getvalue().partition('<!DOCTYPE')[2].partition('>')[2]
        parts += [f'<h2>{escape(heading)}</h2>' if heading else '', svg]
    try:
        path.write_text(PAGE.format(title=escape(title), body='\n'.join(parts)), encoding='utf-8')
    except OSError as error:
        raise CannotWrite(f'{path}: {error.strerror or error}') from None
    return path
