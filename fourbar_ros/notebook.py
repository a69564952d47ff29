# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""How objects of the library look at a prompt and in a notebook."""
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from textwrap import fill
from typing import Any

from fourbar_ros.optional import lab, MissingPackage

LONGEST = 790       # characters of a repr: ten lines of a terminal


def short_repr(name: str, fields: Mapping[str, Any]) -> str:
    """Return 'NAME(field=value, ...)' in at most ten lines, with the shape alone of arrays."""
    words = [f'{field}=array{shape}' if (shape := getattr(value, 'shape', ())) else
             f'{field}={value!r}' for field, value in fields.items()]
    text = ' '.join(f'{name}({", ".join(words)})'.split())
    return text if len(text) <= LONGEST else f'{text[:LONGEST - 5]} ...)'


def in_lines(text: str) -> str:
    """Return a long repr in lines of at most 100 characters, each but the first indented."""
    return fill(text, 100, subsequent_indent='    ', break_long_words=False,
                break_on_hyphens=False)


def html_table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table as HTML; empty ``heads``: without a line of heads."""
    lines = [[f'<td style="text-align:left">{escape(str(cell))}</td>' for cell in row]
             for row in rows]
    if any(heads):
        lines.insert(0, [f'<th style="text-align:left">{escape(head)}</th>' for head in heads])
    return f'<table>{"".join(f"<tr>{chr(10).join(line)}</tr>" for line in lines)}</table>'


def record_as_html(record: Any) -> str:
    """Return a motion or loads as HTML: name, value, unit and meaning of each field."""
    rows = []
    for field in record._shown:
        # each field says '[unit] meaning', see parts.documented()
        unit, _, meaning = getattr(type(record), field).__doc__.removeprefix('[').partition('] ')
        value = getattr(record, field)
        shape = getattr(value, 'shape', ())
        text = f'array{shape}' if shape else f'{value:.10g}'
        if shape and (not_nan := value[value == value].tolist()):
            text += f' from {min(not_nan):.6g} to {max(not_nan):.6g}'
        rows.append((field, text, unit, meaning))
    return html_table(('', 'value', 'unit', 'meaning'), rows)


def as_html(shown: object) -> str | None:
    """Return a mechanism or a scene as HTML by fourbar_lab; None without it: its repr is shown."""
    try:
        return str(from_lab('html', 'a notebook', shown))
    except MissingPackage:
        return None


def from_lab(view: str, purpose: str, /, *arguments: Any, **options: Any) -> Any:
    """Return what a function of fourbar_lab.drawing.views makes; MissingPackage says for what."""
    try:
        return getattr(lab('views'), view)(*arguments, **options)
    except ModuleNotFoundError as error:
        if not MissingPackage.explains(error):
            raise
        raise MissingPackage(purpose, error) from error
