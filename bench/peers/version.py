# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Times one work of one version of this package, in a folder: its name in, its CPU time out."""
import contextlib
import io
import json
import os
from pathlib import Path
import sys
import tempfile
import time
import warnings

PROGRAM, FOLDER, *WORK = sys.argv
sys.path.insert(0, FOLDER)
warnings.simplefilter('ignore')
SCENES = Path(FOLDER) / 'config'
DYADS, RATE = 40, 25.0
# {scene of a study: what varies}
STUDIES = {
    'paper': {'linkage.a1': [0.2, 0.4], 'linkage.a2': [1.1, 1.3]},
    'watt': {'dyads.one.length_1': [1.15, 1.25], 'dyads.two.length_1': [0.75, 0.85]},
    'jansen': {'dyads.upper.length_1': [0.49, 0.51], 'dyads.leg.length_1': [0.385, 0.4]},
    'v8': {'dyads.L1.length_1': [0.14, 0.16], 'dyads.R1.length_1': [0.14, 0.16]}}
FEW, MANY, LEAST = 8, 4096, 0.5     # designs of a study, whose work takes so long at least [s]


def chain(is_star):
    """Return four-bars in a row, each driven by the rocker of the one before, or by the crank."""
    from fourbar_ros.machine import Dyad, Machine, Point, rods
    dyads = [Dyad(f'd{i}', 'RRR', Point('crank' if is_star or not i else f'r{i - 1}', 0.4),
                  Point('ground', 1.0 + 0.01 * i if is_star else 1.0 + i, 0.01 * i),
                  (f'c{i}', f'r{i}'), length_1=1.2, length_2=0.8) for i in range(DYADS)]
    return Machine(dyads, bodies=rods(dyads, 7750.0, 0.01))


def scene(name):
    """Return a scene that comes with this version."""
    from fourbar_ros import load_scene
    return load_scene(next(SCENES.rglob(f'{name}.yaml')))


def study(name):
    """Return the function that computes a study of a scene, and how many designs it has."""
    from fourbar_lab.studies.chunks import compute
    from fourbar_lab.studies.study import from_document

    def of(rows):
        return from_document({
            'scene': str(next(SCENES.rglob(f'{name}.yaml'))), 'rows': rows, 'keep': 'all',
            'vary': {what: {'range': bounds} for what, bounds in STUDIES[name].items()},
            'quantities': ['driving_torque.peak', 'shaking_force.max']})
    rows, took = FEW, 0.0
    compute(of(rows), 0)
    while rows < MANY and took < LEAST:
        rows *= 1 if not took else 8
        began = time.process_time()
        compute(of(rows), 0)
        took = time.process_time() - began
    return lambda: compute(of(rows), 0), rows


def arrays(count):
    """Return the function that computes samples of motion and loads, and how many."""
    import numpy as np
    linkage, x = scene('paper').linkage, np.linspace(0.0, 6.0, count)
    repeats = max(1, 10**6 // count)
    linkage.step(x, RATE, 0.0)

    def compute():
        for _ in range(repeats):
            linkage.step(x, RATE, 0.0)
    return compute, count * repeats


def construction(is_star):
    from fourbar_ros.machine import Machine  # noqa: F401
    return lambda: chain(is_star).input_ranges, 1


def first_array(linkage):
    import numpy as np
    linkage.step(1.0, RATE)
    return lambda: linkage.step(np.linspace(0.0, 6.0, 1000), RATE), 1


def first_extrema(linkage):
    from fourbar_ros import find_extrema
    return lambda: find_extrema(linkage, (), RATE), 1


def singular_inputs(linkage):
    return lambda: linkage.singular_inputs, 1


def run_of_engine():
    from fourbar_ros.scene.simulated import simulate_scene
    loaded = scene('engine')
    simulate_scene(loaded, 0.01, 1e-6)      # scipy is there then, as for the steps of the node
    return lambda: simulate_scene(loaded, 1.0, 1e-6), 1


def steps_of_node():
    mover = scene('engine').mover
    mover.next(mover.start(), 0.001)

    def step():
        values = mover.start()
        for _ in range(1000):
            _, values = mover.next(values, 0.001)
    return step, 1


def endless():
    """Return a run whose turns grow for ever: it cannot end within its evaluations."""
    from fourbar_ros import dynamics
    from fourbar_ros.dynamics.sources import ConstantTorque
    system = dynamics.System(scene('paper').linkage, -0.5,
                             drive=dynamics.Drive(ConstantTorque(0.1)))

    def run():
        with contextlib.suppress(Exception):
            dynamics.simulate(system, 600.0, evaluations=300_000)
    return run, 1


def loading():
    import fourbar_ros  # noqa: F401
    return lambda: scene('engine'), 1


def importing():
    return lambda: __import__('fourbar_ros'), 1


def verb(*arguments):
    """Return a call of the command, its imports too."""
    def call():
        from fourbar_ros.cli.main import main
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(
                io.StringIO()), contextlib.suppress(SystemExit):
            main([*arguments])
    return call, 1


# {what: (function -> (what is timed, how many it does), unit)}
WORKS = {
    'first array of V8': (lambda: first_array(scene('v8').linkage), 'ms'),
    f'first array of a star of {DYADS} dyads': (lambda: first_array(chain(True)), 'ms'),
    f'first array of a chain of {DYADS}': (lambda: first_array(chain(False)), 'ms'),
    'singular inputs of V8': (lambda: singular_inputs(scene('v8').linkage), 'ms'),
    f'singular inputs of a star of {DYADS}': (lambda: singular_inputs(chain(True)), 'ms'),
    f'singular inputs of a chain of {DYADS}': (lambda: singular_inputs(chain(False)), 'ms'),
    'first extrema of V8, all quantities': (lambda: first_extrema(scene('v8').linkage), 'ms'),
    'first extrema of watt, all quantities': (
        lambda: first_extrema(scene('watt').linkage), 'ms'),
    f'construction of a star of {DYADS}, its ranges': (lambda: construction(True), 'ms'),
    f'construction of a chain of {DYADS}, its ranges': (lambda: construction(False), 'ms'),
    'simulate engine, 1 s at 1e-6': (run_of_engine, 'ms'),
    'the same 1 s in steps of the node': (steps_of_node, 'ms'),
    'a run that will not end gives up, 300,000 evaluations': (endless, 'ms'),
    'load_scene("engine"), with its imports': (loading, 'ms'),
    'import fourbar_ros': (importing, 'ms'),
    'fourbar table, refused': (lambda: verb('table'), 'ms'),
    'fourbar show paper': (lambda: verb('show', 'paper'), 'ms'),
    'a sample of motion and loads, arrays of 1e4': (lambda: arrays(10**4), 'us'),
    '... of 1e6': (lambda: arrays(10**6), 'us'),
    **{f'a design of a study of {name}': (lambda name=name: study(name), 'us')
       for name in STUDIES}}


def main():
    """Print the works and their units as JSON; of one its CPU time [s]."""
    if not WORK:
        print(json.dumps({name: unit for name, (_, unit) in WORKS.items()}))
        return
    os.chdir(tempfile.gettempdir())
    make, _ = WORKS[WORK[0]]
    work, count = make()
    began = time.process_time()
    work()
    print(json.dumps((time.process_time() - began) / count))


if __name__ == '__main__':
    main()
