# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the runners of bench/engines share: the problems, the clock, what they print.

Runs in any environment that has numpy.
"""
from collections import namedtuple
import json
from pathlib import Path
import sys
from time import process_time

LEAST, LONG, MOST_TURNS = 0.2, 1.0, 20      # CPU seconds, and turns of a measurement

# A linkage that moves by itself. Coordinates: angle of the crank, angle of the coupler, slide or
# angle of the output link. Bodies: (mass, along, across, inertia), the crank's with a flywheel.
# Spring: along the crank, along the coupler, stiffness, free length, damping, or None. Forces
# (x, y): on the crank pin, on the output link's first joint. The coordinate ``watched`` is
# ``exact`` at the end.
Problem = namedtuple('Problem', 'name kind lengths bodies gravity spring forces start rates until '
                                'watched exact')


def problems():
    """Return the problems of the file on the command line."""
    return [Problem(**one) for one in json.loads(Path(sys.argv[1]).read_text())]


def report(problem, method, setting, run):
    """Measure run() -> the watched coordinate at the end, and print what came of it."""
    times, value = [], float('nan')
    try:
        # the first compiles and fills caches, and counts alone where it takes long
        while len(times) < 2 and sum(times) < LONG or (sum(times) < LEAST
                                                       and len(times) < MOST_TURNS):
            began = process_time()
            value = float(run())
            times.append(process_time() - began)
    except Exception as error:       # whatever an engine raises is its answer
        print(json.dumps({'problem': problem.name, 'method': method, 'setting': setting,
                          'why': f'{type(error).__name__}: {error}'.splitlines()[0]}), flush=True)
        return
    print(json.dumps({'problem': problem.name, 'method': method, 'setting': setting,
                      'error': abs(value - problem.exact), 'milliseconds': 1e3 * min(times)}),
          flush=True)
