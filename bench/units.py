# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""FMUs in FMPy: size, start and step, beside a PythonFMU of the paper's linkage."""
import json
from pathlib import Path
import subprocess
import tempfile

from fourbar_ros import load_scene
from fourbar_ros.generated import generate
from fourbar_ros.scene.scene import from_values

from . import ROOT, speed
from .pages import table

PACKAGES = 'pythonfmu', 'fmpy'
SHAFT = {**load_scene('motor').values, 'shaft.stiffness': 1e9, 'shaft.damping': 1e3}
SLAVE = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

from fourbar_ros import load_scene

WANTED = 'theta4', 'omega4', 'alpha4', 'f41', 'f32', 'shaking_moment'


class Paper(Fmi2Slave):

    def __init__(self, **given):
        super().__init__(**given)
        self.linkage = load_scene('paper').linkage
        self.theta1, self.omega1, self.alpha1 = 1.0, 0.0, 0.0
        for name in ('theta1', 'omega1', 'alpha1'):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.do_step(0.0, 0.0)
        for name in WANTED:
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, time, step):
        motion, loads = self.linkage.step(self.theta1, self.omega1, self.alpha1)
        for name in WANTED:
            setattr(self, name, getattr(motion if name in motion._fields else loads, name))
        return True
"""


def main():
    """Print a table of the units, and how many values of the two of the paper differ."""
    missing = [why for why in speed.install(PACKAGES).values() if why]
    if missing:
        raise SystemExit(f'bench units: {missing[0]}')
    python = str(speed.ENVIRONMENT / 'bin' / 'python')
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / 'slave.py').write_text(SLAVE)
        environment = {**speed.clean(), 'PYTHONPATH': str(ROOT)}
        subprocess.run([python, '-m', 'pythonfmu', 'build', '-f', 'slave.py', '-d', name],
                       check=True, cwd=folder, env=environment, capture_output=True)
        scenes = {'paper': load_scene('paper'), 'sundials': load_scene('sundials'),
                  'paper with motor, shaft of 1e9 N m/rad': from_values(SHAFT)}
        paths = {what: generate(scene, folder / str(i), 'fmu2', name='unit').files[0]
                 for i, (what, scene) in enumerate(scenes.items())}
        paths['paper, a PythonFMU'] = next(folder.glob('*.fmu'))
        done = subprocess.run([python, str(speed.PEERS / 'run_units.py'),
                               *map(str, paths.values())],
                              check=True, cwd=folder, env=environment, stdout=subprocess.PIPE,
                              text=True)
        found = dict(zip(paths, map(json.loads, done.stdout.splitlines())))
        rows = [(what, f'{paths[what].stat().st_size / 1000:.0f}', f'{1e3 * begun:.2g}',
                 f'{1e6 * step:.3g}') for what, (begun, step, _) in found.items()]
    pairs = list(zip(*([value for row in found[what][2] for value in row]
                       for what in ('paper', 'paper, a PythonFMU'))))
    print('FMI 2.0, co-simulation, 2000 steps of 1 ms in FMPy: inputs set, up to six results '
          'read. Least of five.\n')
    table(('unit', 'size [kB]', 'start [ms]', 'step [us]'), rows)
    print(f'Of the two of the paper {sum(a != b for a, b in pairs)} of {len(pairs)} values '
          'differ. The PythonFMU needs a Python with this package in the master.')


if __name__ == '__main__':
    main()
