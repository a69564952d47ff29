# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Error against run time beside the engines a user would otherwise pick; ratios of one run."""
import json
from math import inf, pi
import os
from pathlib import Path
from statistics import median
import subprocess
import sys
import tempfile

from . import ROOT
from .pages import figure, save, table

PEERS = Path(__file__).resolve().parent / 'peers'
ENVIRONMENT = ROOT / '.venv-peers'
# the paper's, mode 2
LENGTHS, OMEGA, DENSITY, RADIUS = (0.4, 1.2, 0.8, 1.0), 25.0, 7750.0, 0.01
SAMPLES, ROUNDS = 1000, 5
ONE_THREAD = dict.fromkeys(('OMP_NUM_THREADS', 'OPENBLAS_NUM_THREADS', 'MKL_NUM_THREADS'), '1')
OURS = 'fourbar_ros'
SCALAR, SCALAR_MOTION = f'{OURS}, scalar', f'{OURS}, scalar, motion only'
BATCH, BATCH_MOTION = f'{OURS}, batch of 10000', f'{OURS}, batch of 10000, motion only'


# --- the case and the peers ----------------------------------------------------------------------

def write_case(file):
    """Write one revolution of the linkage with its true values for the runners."""
    from fourbar_ros import Bodies, FourBar, round_rod
    from support.cartesian import values
    rods = Bodies(*(round_rod(length, DENSITY, RADIUS) for length in LENGTHS[:3]))
    bodies = [(b.mass, b.cg_along, b.cg_across, b.inertia) for b in rods]
    linkage = FourBar(*LENGTHS, bodies=rods)
    theta1 = [2.0 * pi * k / SAMPLES for k in range(SAMPLES)]
    names = 'theta4', 'beta', 'omega4', 'omega_beta', 'alpha4'
    truth = {name: [] for name in (*names, 'f41')}
    for x in theta1:
        found = values(linkage, x, OMEGA)
        for name in names:
            truth[name].append(float(found[name]))
        truth['f41'].append((float(found['f41_x']), float(found['f41_y'])))
    file.write_text(json.dumps({'lengths': LENGTHS, 'omega': OMEGA, 'bodies': bodies,
                                'theta1': theta1,
                                'truth': truth}))


def install():
    """Return {peer: why not, or None}, each installed by itself into the environment for peers."""
    python = ENVIRONMENT / 'bin' / 'python'
    if not python.exists():
        subprocess.run([sys.executable, '-m', 'venv', str(ENVIRONMENT)], check=True)
    found = {}
    for line in (PEERS / 'requirements.txt').read_text().splitlines():
        if not line.startswith('#'):
            done = subprocess.run([str(python), '-m', 'pip', 'install', '--quiet',
                                   '--disable-pip-version-check', *line.split()],
                                  check=False, capture_output=True, text=True, env=clean())
            found[line] = ((done.stderr.strip().splitlines() or ['?'])[-1] if done.returncode
                           else None)
    return found


def clean():
    """Return the environment variables for a runner."""
    return {**{name: value for name, value in os.environ.items() if name != 'PYTHONPATH'},
            **ONE_THREAD}


class Runner:
    """A script of bench/peers in a process: it says what it is, then answers line by line."""

    def __init__(self, script, *arguments, python=sys.executable):
        self.name, self.log = script, tempfile.TemporaryFile('w+')
        self.process = subprocess.Popen([python, str(PEERS / f'{script}.py'), *arguments],
                                        text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=self.log, cwd=tempfile.gettempdir(), env=clean())
        self.about = self._read()

    def _read(self):
        """
        Return the next JSON line; engines may print others.

        Raise RuntimeError if there is none.
        """
        for line in self.process.stdout:
            if line.startswith('{'):
                return json.loads(line)
        self.log.seek(0)
        raise RuntimeError((self.log.read().strip().splitlines()
                            or ['ended without a word'])[-1])

    def ask(self, what=''):
        """Return the answer, {name: CPU time of one [s]}."""
        self.process.stdin.write(f'{what}\n')
        self.process.stdin.flush()
        return self._read()

    def close(self):
        self.process.stdin.close()
        self.process.wait(60)


def measure(rounds):
    """Return errors and times by method, {peer: why it was left out}, {runner: its numpy}."""
    left_out = {line: why for line, why in install().items() if why}
    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder) / 'case.json'
        write_case(case)
        runners = []
        for script in sorted(file.stem for file in PEERS.glob('run_*.py')):
            python = sys.executable if script.endswith(OURS) else ENVIRONMENT / 'bin' / 'python'
            try:
                runners.append(Runner(script, str(case), python=python))
            except RuntimeError as error:
                left_out.setdefault(script[4:], str(error))
        errors = {name: values for runner in runners
                  for name, values in runner.about['errors'].items()}
        times = {name: [] for name in errors}
        for _ in range(rounds):     # in turn, so that all see the same machine
            for runner in runners:
                for name, took in runner.ask().items():
                    times[name].append(took)
        for runner in runners:
            runner.close()
    return errors, times, left_out, {runner.name[4:]: runner.about['numpy'] for runner in runners}


# --- what is printed -----------------------------------------------------------------------------

def ratios(times, name, other):
    """Return the ratio of two methods in each round."""
    return [a / b for a, b in zip(times[name], times[other])]


def print_methods(errors, times):
    """Print error and run time of every method, ours first, then by time."""
    rows = []
    for name in sorted(errors, key=lambda n: (not n.startswith(OURS), median(times[n]))):
        ratio = ratios(times, name, SCALAR)
        rows.append((name, f'{median(times[name]) * 1e6:.3g}', f'{median(ratio):.3g}',
                     f'{min(ratio):.3g} to {max(ratio):.3g}',
                     *(f'{errors[name][key]:.1e}' if key in errors[name] else '-'
                       for key in ('theta4', 'alpha4', 'f41'))))
    table(('method', 'CPU time [us/sample]', 'times ours, scalar', '(lowest to highest round)',
           'theta4 [rad]', "theta4''", 'F41'), rows)


def print_verdict(errors, times):
    """Print for accuracies the cheapest engine that reaches them: forces, and motion only."""
    engines = [name for name in errors if not name.startswith((OURS, 'plain.py', 'textbook'))]
    rows = []
    for what, key, single, batch in (('F41', 'f41', SCALAR, BATCH),
                                     ("theta4''", 'alpha4', SCALAR_MOTION, BATCH_MOTION)):
        for bound in (1e-12, 1e-4, 1e-2):
            good = [name for name in engines if errors[name].get(key, inf) <= bound]
            if good:
                best = min(good, key=lambda name: median(times[name]))
                rows.append((f'{what} to {bound:.0e}', best,
                             f'{median(ratios(times, best, single)):.3g}',
                             f'{median(ratios(times, best, batch)):.3g}'
                             if best.startswith(IN_BATCH) else '-'))
    table(('to reach', 'cheapest engine', 'times our scalar', 'times our batch of 10000'), rows)


# many samples in one call: fair beside our batch
IN_BATCH = ('MuJoCo connect', 'pylinkage', 'Exudyn')

GROUPS = ((OURS, '#d62728', '*'), ('textbook', '#000000', 'd'), ('plain.py', '#7f7f7f', 's'),
          ('fourbarhinge', '#8c564b', 'D'),
          ('pylinkage', '#e377c2', 'v'), ('MuJoCo tree', '#1f77b4', 'o'),
          ('MuJoCo connect, default', '#17becf', 'x'), ('MuJoCo connect, hardest', '#9467bd', 'o'),
          ('Pinocchio tree', '#2ca02c', '^'),
          ('Exudyn generalized', '#ff7f0e', 'P'), ('Exudyn trapezoidal', '#bcbd22', 'X'))


def draw(errors, times):
    """Draw error against run time."""
    drawing, axes = figure(1, 2, figsize=(11.0, 5.2), sharex=True, sharey=True)
    for axis, key, title in zip(axes, ('alpha4', 'f41'), ("θ4''", 'F41')):
        for group, color, marker in GROUPS:
            points = sorted((median(times[name]) * 1e6, errors[name][key]) for name in errors
                            if name.startswith(group) and key in errors[name])
            if points or key == 'f41':
                is_stepper = group.startswith(('Exudyn', 'MuJoCo connect, hardest'))
                axis.loglog(*(zip(*points) if points else ([], [])), marker=marker, color=color,
                            label=group, linestyle='-' if is_stepper else 'none', linewidth=0.8,
                            markersize=14 if group == OURS else 8,
                            zorder=3 if group == OURS else 2)
        axis.set_title(f'{title}: largest error over one revolution, of its peak')
        axis.set_xlabel('CPU time per sample [µs]')
        axis.grid(True, which='major', color='0.9')
    axes[0].set_ylabel('error')
    axes[0].annotate('better', (0.02, 0.2), (0.12, 0.3), xycoords='axes fraction',
                     textcoords='axes fraction',
                     arrowprops={'arrowstyle': '->', 'color': '0.4'}, color='0.4')
    drawing.legend(*axes[0].get_legend_handles_labels(), loc='outside lower center', ncols=4,
                   frameon=False)
    save(drawing, 'speed')


def main():
    """Print all tables and draw."""
    errors, times, left_out, versions = measure(ROUNDS)
    print(f'Linkage {LENGTHS} m with its rods, mode 2, {OMEGA:g} rad/s, {SAMPLES} samples of one '
          f'revolution. One thread, CPU time, {ROUNDS} rounds in turn: medians, ratios within the '
          'same round. Errors against many digits: theta4 absolute, the others of the largest '
          'magnitude. Engines are called from Python, as a Python project would; steppers start '
          'exactly, the second of two turns is scored.\n')
    print('numpy of the runners: ' + ', '.join(f'{name} {version}'
                                               for name, version in versions.items())
          + '. Garbage collection is off while timing.\n')
    print_methods(errors, times)
    print_verdict(errors, times)
    for peer, why in left_out.items():
        print(f'Left out: {peer}: {why}')
    draw(errors, times)
    print('![Error against run time](speed.svg)')
