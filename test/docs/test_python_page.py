# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The examples of docs/python.md print what the page shows."""
import contextlib
import io
import re

from support import ROOT

PAGE = ROOT / 'docs' / 'python.md'
EXAMPLE = re.compile(r'(?<=```python\n)(.*?)```\n\n```text\n(.*?)```', re.S)


def printed():
    """Yield (expected, printed) of the examples, run one after the other in one namespace."""
    names = {}
    for code, expected in EXAMPLE.findall(PAGE.read_text(encoding='utf-8')):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(code, PAGE.name, 'exec'), names)
        yield expected, out.getvalue()


def test_the_examples_print_what_the_page_shows():
    examples = list(printed())
    assert len(examples) == PAGE.read_text(encoding='utf-8').count('```python') >= 6
    for expected, found in examples:
        assert found == expected
