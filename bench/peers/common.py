# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the runners share: the case, the clock and the score.

Runs in any environment that has numpy.
"""
from collections import namedtuple
import gc
import json
from pathlib import Path
import sys
from time import process_time

import numpy as np

LEAST = 0.15     # CPU seconds a measurement takes at least

# run(theta1) is timed; read(what it returned) -> dict of arrays, one value a sample, is not. Of
# two turns the second is scored.
Method = namedtuple('Method', 'name run read turns', defaults=(1,))


class Case:
    """The linkage, its motion and the true values, from the file on the command line."""

    def __init__(self):
        case = json.loads(Path(sys.argv[1]).read_text())
        self.lengths, self.omega, self.bodies = case['lengths'], case['omega'], case['bodies']
        self.theta1 = np.array(case['theta1'])
        self.truth = {name: np.array(values) for name, values in case['truth'].items()}
        self.step = float(self.theta1[1] - self.theta1[0])

    def start(self):
        """Return theta1, beta, theta4 and their rates at the first sample."""
        first = {name: values[0].tolist() for name, values in self.truth.items()}
        return (float(self.theta1[0]), first['beta'],
                first['theta4']), (self.omega, first['omega_beta'], first['omega4'])


def errors(case, found):
    """
    Return the largest errors.

    theta4 in rad, the others relative to the largest true magnitude.
    """
    repeat = len(found['theta4']) // len(case.theta1)
    result = {}
    for name, values in found.items():
        true = np.tile(case.truth[name], (repeat,) + (1,) * (case.truth[name].ndim - 1))
        error = np.asarray(values) - true
        if name == 'theta4':
            result[name] = float(np.abs(np.angle(np.exp(1j * error))).max())
        else:
            size = np.hypot(*true.T) if true.ndim > 1 else np.abs(true)
            error = np.hypot(*error.T) if true.ndim > 1 else np.abs(error)
            result[name] = float(error.max() / size.max())
    return result


def serve(case, methods):
    """Print the errors of all methods, then their CPU time per sample [s] for each line read."""
    repeats, first = {}, {}
    for method in methods:
        method.run(case.theta1)     # compiles, fills caches
        began = process_time()
        found = method.run(case.theta1)
        took = process_time() - began
        repeats[method.name] = max(1, round(LEAST / max(took, 1e-6)))
        first[method.name] = errors(case, method.read(found))
    print(json.dumps({'numpy': np.__version__, 'errors': first}), flush=True)
    gc.disable()
    for _ in sys.stdin:
        gc.collect()
        times = {}
        for method in methods:
            began = process_time()
            for _ in range(repeats[method.name]):
                found = method.run(case.theta1)
            took = (process_time() - began) / repeats[method.name]
            times[method.name] = took / (method.turns * len(method.read(found)['theta4']))
        print(json.dumps(times), flush=True)
