# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Torque-driven motion: error against CPU time beside MuJoCo, Exudyn and solve-dae."""
import json
from math import inf
from pathlib import Path
import subprocess
import sys
import tempfile

from fourbar_ros import Bodies, Body, SliderCrank
from fourbar_ros.dynamics.model.elements import Spring
from fourbar_ros.dynamics.model.system import System
import mpmath as mp
from support.dynamics_problems import (
    near_lock_up,
    one_window,
    one_window_exact,
    P2_POSITION,
    P4_POSITION,
    sundials_slider_crank,
)

from .pages import save
from .speed import clean, ENVIRONMENT, install

RUNNERS = Path(__file__).resolve().parent / 'moving'
OURS = 'fourbar_ros'
PEERS = {'MuJoCo': 'mujoco', 'Exudyn': 'exudyn', 'solve-dae': 'solve-dae'}
ASKED = (1e-3, 1e-6, 1e-9)
LONGEST = 1200.0       # seconds that a runner may take
FLYWHEEL = 1e9         # [kg m^2] keeps the crank of P5 at its speed to 1e-12
MARKERS = {'checked': '*', 'one run': 'o', 'default': 'x', 'hardest': 's', 'alpha': 'v',
           'trapezoidal': '^', 'Radau': 'D', 'BDF': 'd'}
COLORS = {OURS: 'C3', 'MuJoCo': 'C0', 'Exudyn': 'C1', 'solve-dae': 'C2'}


def rigid_limit():
    """P5: a slider-crank at 150 rad/s; its heavy flywheel drives it."""
    bodies = Bodies(Body(0.36, 0.075, 0.0, FLYWHEEL), Body(0.151104, 0.15, 0.0, 0.0011334),
                    Body(0.075552))
    return System(SliderCrank(0.15, 0.30, bodies=bodies), 0.0, 150.0)


def systems():
    """Yield (name, kind, System, end [s], watched coordinate, its exact value there)."""
    yield 'P2', 'slider_crank', sundials_slider_crank(), 10.0, 0, float(P2_POSITION)
    with mp.workdps(30):
        yield 'P3, N = 1', 'four_bar', one_window(), 20.0, 0, float(one_window_exact(mp.mpf(20)))
    yield 'P4', 'slider_crank', near_lock_up(), 4.99, 0, float(P4_POSITION)
    exact = SliderCrank(0.15, 0.30).motion(15.0, 150.0).beta
    yield 'P5, rigid', 'slider_crank', rigid_limit(), 0.1, 1, exact


def described(name, kind, system, until, watched, exact):
    """Return a problem as the runners read it."""
    mechanism = system.mechanism
    motion = mechanism.motion(*system.start[:2])
    links = [mechanism.link_motion(motion, link) for link in ('coupler', 'output')]
    is_slider = kind == 'slider_crank'
    lengths = mechanism.lengths[:2] if is_slider else mechanism.lengths
    return {
        'name': name, 'kind': kind, 'lengths': lengths,
        'bodies': [(b.mass, b.cg_along, b.cg_across, b.inertia) for b in mechanism.bodies],
        'gravity': mechanism.gravity, 'spring': spring_of(system.equation.elements),
        'forces': [(applied.force_x, applied.force_y) for applied in mechanism.external],
        'start': (motion.theta1, motion.beta, motion.slide if is_slider else motion.theta4),
        'rates': (motion.omega1, links[0].omega, links[1].v_x if is_slider else links[1].omega),
        'until': until, 'watched': watched, 'exact': exact}


def spring_of(elements):
    """Return the one spring between crank and coupler, None if there is none."""
    for element in elements:
        assert isinstance(element, Spring) and element.links == ('crank', 'coupler')
        return (element.first.along, element.second.along, element.stiffness,
                element.free_length, element.damping)
    return None


def measure():
    """Return what the runners printed, and {peer: why it is left out}."""
    installed = install(PEERS.values())
    left_out = {line: why for line, why in installed.items() if why}
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / 'problems.json'
        file.write_text(json.dumps([described(*one) for one in systems()]))
        for script in sorted(RUNNERS.glob('run_*.py')):
            python = (sys.executable if script.stem == f'run_{OURS}'
                      else str(ENVIRONMENT / 'bin' / 'python'))
            done = subprocess.run([python, str(script), str(file)], capture_output=True, text=True,
                                  cwd=folder, env=clean(), timeout=LONGEST, check=False)
            found = [json.loads(line) for line in done.stdout.splitlines() if line[:1] == '{']
            rows += found
            if not found:
                why = (done.stderr.strip().splitlines() or ['ended without a word'])[-1]
                left_out.setdefault(script.stem[4:], why)
    return rows, left_out


def print_all(rows, name):
    """Print every run of a problem: settings in rows, methods in columns."""
    methods = list(dict.fromkeys(row['method'] for row in rows if row['problem'] == name))
    print(f'\n## {name}\n\n| method | error, CPU time [ms] at each setting |\n| --- | --- |')
    for method in methods:
        cells = [f'{row["setting"]}: ' + ('gave up' if 'why' in row else
                                          f'{row["error"]:.0e}, {short(row["milliseconds"])}')
                 for row in rows if (row['problem'], row['method']) == (name, method)]
        print(f'| {method} | {"; ".join(cells)} |')
    reasons = dict.fromkeys(f'{row["method"]}: {row["why"]}' for row in rows
                            if row['problem'] == name and 'why' in row)
    print(''.join(f'\n- {reason}' for reason in reasons))


def short(number):
    """Return a number with two or three digits, never as a power of ten."""
    return f'{number:.0f}' if number >= 100.0 else f'{number:.2g}'


def cheapest(rows, name, engine, bound):
    """Return the cheapest run of an engine within an error, None if there is none."""
    good = [row for row in rows if row['problem'] == name and row['method'].startswith(engine)
            and row.get('error', inf) <= bound]
    return min(good, key=lambda row: row['milliseconds'], default=None)


def print_verdict(rows, names):
    """Print for errors asked for what each engine takes, times our checked run."""
    engines = [engine for engine in PEERS if any(row['method'].startswith(engine)
                                                 for row in rows)]
    print(f'\n## To reach an error\n\n| problem | error | {OURS}, checked [ms] | one run | '
          f'{" | ".join(engines)} |\n|{" --- |" * (4 + len(engines))}')
    for name in names:
        for bound in ASKED:
            ours = cheapest(rows, name, f'{OURS}, checked', bound)
            cells = []
            for engine in (f'{OURS}, one run', *engines):
                best = cheapest(rows, name, engine, bound)
                cells.append('not reached' if best is None or ours is None else
                             f'{short(best["milliseconds"] / ours["milliseconds"])} x')
            took = short(ours['milliseconds']) if ours else 'not reached'
            print(f'| {name} | {bound:.0e} | {took} | {" | ".join(cells)} |')


def draw(rows, names):
    """Draw error against CPU time for each problem."""
    import matplotlib
    matplotlib.use('Agg')
    matplotlib.rcParams['svg.hashsalt'] = 'fourbar'
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(1, len(names), figsize=(3.6 * len(names), 4.4), sharey=True,
                                   layout='constrained')
    for axis, name in zip(axes, names):
        for method in dict.fromkeys(row['method'] for row in rows):
            points = [(row['milliseconds'], max(row['error'], 1e-16)) for row in rows
                      if (row['problem'], row['method']) == (name, method) and 'error' in row]
            axis.loglog(*(zip(*points) if points else ([], [])), label=method, linewidth=0.9,
                        color=next(COLORS[engine] for engine in COLORS if engine in method),
                        marker=next(MARKERS[word] for word in MARKERS if word in method),
                        markersize=9 if 'checked' in method else 5)
        axis.set_title(name, fontsize=10)
        axis.set_xlabel('CPU time [ms]')
        axis.grid(alpha=0.3)
    axes[0].set_ylabel('error at the end [rad]')
    figure.legend(*axes[0].get_legend_handles_labels(), loc='outside lower center', ncols=4,
                  frameon=False)
    save(figure, 'engines')
    print('\n![Error against CPU time of engines](engines.svg)')


def main():
    """Print tables in Markdown and draw the figure."""
    rows, left_out = measure()
    names = list(dict.fromkeys(row['problem'] for row in rows))
    print('Problems of [reference_problems.md](../reference_problems.md), P5 with a flywheel of '
          f'{FLYWHEEL:.0e} kg m² in place of its drive. Error of the crank angle at the end, of '
          'P5 of the rod angle [rad]; CPU time of one integration called from Python, the least '
          'of up to 20 turns, without building the model. Engines with fixed steps ran with 500 '
          'to 128 000, the others with tolerances. MuJoCo takes no body without mass: it has '
          '1e-9 kg and kg m² there. solve-dae integrates two angles and a third coordinate with '
          'two multipliers, whose equations are in Python as those of '
          f'{OURS} are.')
    print_verdict(rows, names)
    for name in names:
        print_all(rows, name)
    for peer, why in left_out.items():
        print(f'\nLeft out: {peer}: {why}')
    draw(rows, names)


if __name__ == '__main__':
    main()
