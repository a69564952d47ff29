# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Times FMUs of FMI 2.0 in FMPy: paths in, [start s, s a step, results] of each out."""
import json
import math
import sys
import time

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, COUNT, TIMES = 1e-3, 2000, 5
WANTED = 'theta4', 'omega4', 'alpha4', 'f41', 'f32', 'shaking_moment'


def measured(path):
    """Return the least times of an FMU, and the results of all steps of one run."""
    about, folder = read_model_description(path), extract(path, f'{path}.d')
    of = {one.name: one.valueReference for one in about.modelVariables}
    given = [one.valueReference for one in about.modelVariables if one.causality == 'input'][:3]
    wanted = [of[name] for name in WANTED if name in of]
    begun = passed = math.inf
    for _ in range(TIMES):
        start = time.perf_counter()
        unit = FMU2Slave(guid=about.guid, unzipDirectory=folder, instanceName='one',
                         modelIdentifier=about.coSimulation.modelIdentifier)
        unit.instantiate()
        unit.setupExperiment(startTime=0.0)
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        begun, rows = min(begun, time.perf_counter() - start), []
        start = time.perf_counter()
        for i in range(COUNT):
            if len(given) == 3:      # motion; where torque drives, the scene has the source
                unit.setReal(given, [0.025 * (i + 1), 25.0, 0.0])
            unit.doStep(i * STEP, STEP)
            rows.append(unit.getReal(wanted))
        passed = min(passed, time.perf_counter() - start)
        unit.terminate()
        unit.freeInstance()
    return begun, passed / COUNT, rows


for line in sys.argv[1:]:
    print(json.dumps(measured(line)), flush=True)
