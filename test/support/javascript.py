# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Modules of JavaScript in Node."""
import json
from pathlib import Path
import shutil
import subprocess
from tempfile import TemporaryDirectory

from fourbar_lab.export.js_code import JsModule
import numpy as np
import pytest

NODE = shutil.which('node')
needs_node = pytest.mark.skipif(not NODE, reason='no node: apt-get install nodejs')
RUN = """
import { readFileSync } from 'node:fs';
const module = await import(process.argv[2]), { inputs, changed } = JSON.parse(readFileSync(0));
const k = module.prepare(changed), to = new Float64Array(module.names.length);
const rows = inputs.map(input => [module.step(k, ...input, to), ...to]);
process.stdout.write(JSON.stringify({ rows, check: module.selfCheck() }));
"""


def node(script, *arguments, given=''):
    """Return what a script prints; AssertionError with its words if it fails."""
    run = subprocess.run([NODE, '--input-type=module', '-e', script, '-', *arguments],
                         check=False, input=given, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr[-2000:]
    return run.stdout


def in_node(text, inputs, changed=None):
    """Return (status of each input, results, self-check) of a module."""
    with TemporaryDirectory() as folder:
        file = Path(folder, 'module.mjs')
        file.write_text(text)
        answer = json.loads(node(RUN, str(file), given=json.dumps(
            {'inputs': inputs, 'changed': changed or {}})))
    rows = np.array(answer['rows'], float)
    return rows[:, 0], rows[:, 1:], answer['check']


def on_the_page(scene, *inputs):
    """Return what a page has of a scene at an input with its rates: {name: value}."""
    module = JsModule(scene, 'scene')
    statuses, rows, _ = in_node(module.text, [inputs])
    return dict(zip(module.units, rows[0])) if statuses[0] == 0 else {}
