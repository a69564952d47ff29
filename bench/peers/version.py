# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Times one version of this package, in a folder: the name of a work in, its CPU time out."""
from collections import deque
import gc
from itertools import repeat
import json
import math
from pathlib import Path
import sys
import time

sys.path.insert(0, sys.argv[1])

from fourbar_ros import (  # noqa: E402, I100
    Bodies,
    find_extrema,
    FourBar,
    InvertedSlider,
    load_scene,
    round_rod,
    SliderCrank,
)
from fourbar_ros.pipeline import stepper as pipeline  # noqa: E402, I100

try:
    from fourbar_lab.studies import find_extrema_many
except ImportError:     # an older version
    from fourbar_ros import find_extrema_many
import numpy as np  # noqa: E402

CONFIG = Path(__file__).parents[2] / 'config'
LENGTHS, OMEGA, COUNT, TIMES = (0.4, 1.2, 0.8, 1.0), 25.0, 1000, 5
bodies = Bodies(*(round_rod(length, 7750.0, 0.01) for length in LENGTHS[:3]))
angles = [2.0 * math.pi * k / COUNT for k in range(COUNT)]
many = np.tile(angles, 10)
four_bars = [np.random.default_rng(0).uniform(low, high, 8192)
             for low, high in ((0.2, 0.4), (1.0, 1.2), (0.7, 0.9))]


def make(kind, lengths, **options):
    return kind(*lengths, mode=2, bodies=bodies, gravity=(0.0, -9.81), **options)


def each(function, samples=angles):
    return lambda: deque(map(function, samples, repeat(OMEGA), repeat(0.0)), 0)


def first_step():
    make(FourBar, LENGTHS).step(1.0, OMEGA, 0.0)


def steps_by_torque():
    values = mover.start()
    for _ in range(COUNT):
        _, values = mover.next(values, 0.001)


def steps_of_the_node():
    """Do the node's work at each input of the paper's scene, without messages."""
    for angle in angles:
        stepper.step(angle, OMEGA, 0.0, *wanted)


mover = load_scene(CONFIG / 'motor.yaml').mover
paper = load_scene(CONFIG / 'paper.yaml')
stepper = pipeline.Stepper(paper)
wanted = ((pipeline.Wanted(True, paper.topics),) if hasattr(pipeline.Wanted, 'of')
          else (True, True))                 # an older version
linkage = make(FourBar, LENGTHS)
WORK = {
    'sine': (lambda: deque(map(math.sin, angles), 0), COUNT),
    'one step': (each(linkage.step), COUNT),
    'one step, motion only': (each(linkage.motion), COUNT),
    'one step of a slider-crank': (each(make(SliderCrank, (0.4, 1.2, 0.1)).step), COUNT),
    'one step of a cylinder': (each(make(InvertedSlider, (0.4, 1.2, 0.1), input='slide').step,
                                    [0.9 + 0.6 * k / COUNT for k in range(COUNT)]), COUNT),
    'a new linkage and its step': (first_step, 1),
    'one step by torque': (steps_by_torque, COUNT),
    'one step of the node, without messages': (steps_of_the_node, COUNT),
    'a batch of 10000': (lambda: linkage.step(many, OMEGA, 0.0), len(many)),
    'a batch of 1000': (lambda: linkage.step(many[:COUNT], OMEGA, 0.0), COUNT),
    'extrema of omega4 and alpha4': (
        lambda: find_extrema(make(FourBar, LENGTHS), ('omega4', 'alpha4'), OMEGA), 1),
    'the same of one of 8192 four-bars': (
        lambda: find_extrema_many(*four_bars, 1.0, rate=OMEGA), len(four_bars[0]))}


def best(work, count, least=2e-3):
    """Return the least CPU time of one [s] in some turns of at least ``least``."""
    found = math.inf
    for _ in range(TIMES):
        done, start = 0, time.process_time()
        while (took := time.process_time() - start) < least:
            work()
            done += count
        found = min(found, took / done)
    return found


for work, _ in WORK.values():
    work()
gc.disable()
print(json.dumps({'names': list(WORK)}), flush=True)
for line in sys.stdin:
    print(json.dumps({line.strip(): best(*WORK[line.strip()])}), flush=True)
    gc.collect()
