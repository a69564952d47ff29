# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors in eps times condition over ordinary and extreme cases, of naive formulas too."""
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from math import inf, nan, pi, sin

from fourbar_ros import Applied, Bodies, Body, External, FourBar, FourBarError, round_rod
from mechanisms.four_bar.test_accuracy import (
    closes,
    crank_lengths,
    draw,
    FAMILIES,
    ORDINARY,
    random_masses,
)
import mpmath as mp
import numpy as np
from rich.console import Console
from rich.progress import track
from support.reference import condition, EPS, free_bodies, loads_of, motion_of, pose, reactions

from . import naive, ROOT

# poses a family; one in 6 with loads; random: 4 times
SAMPLES, LOAD_SHARE, RANDOM_TIMES, WORKERS = 600, 6, 4, 2
MARGINS, TOGGLES, AROUND = [10.0**-k for k in range(2, 15, 2)], 6, 40
OURS, SYSTEM = 'fourbar_ros', '9x9'
FORMULAS = {'half angle': naive.half_angle, 'law of cosines': naive.law_of_cosines,
            'coordinates': naive.coordinates}
STREAMS, STEPS, MILLION = ((2.0, 4.0, 5.0, 3.01), (4.0, 3.5, 3.0, 2.0)), (3, 10, 360), 10**6
LARGEST_DRAWN = 1e20
COLORS = {OURS: '#d62728', 'half angle': '#1f77b4', 'law of cosines': '#2ca02c',
          'coordinates': '#ff7f0e',
          SYSTEM: '#7f7f7f'}
MARKERS = {OURS: '*', 'half angle': 'v', 'law of cosines': 's', 'coordinates': 'D', SYSTEM: 'X'}
PROGRESS = Console(stderr=True)


# --- one pose ------------------------------------------------------------------------------------

def ours(lengths, mode, x, omega):
    """
    Return theta4, theta4' and theta4'' times omega and its square.

    NaN where they are refused.
    """
    try:
        motion = FourBar(*lengths, mode=mode).motion(x, omega)
    except FourBarError:
        return nan, nan, nan
    return motion.theta4, motion.omega4, motion.alpha4


def others(formula, lengths, mode, x, omega):
    """Return the same by a naive formula."""
    with np.errstate(all='ignore'):
        y, _, dy, _, ddy, _ = formula([np.float64(a) for a in lengths], 2 * mode - 3,
                                      np.float64(x))
    return y, dy * omega, ddy * omega**2


WAYS = {OURS: ours, **{name: partial(others, formula) for name, formula in FORMULAS.items()}}


def in_eps(error, cond):
    """Return an error in eps cond; NaN if the result was no number."""
    return float(error / (EPS * cond)) if mp.isfinite(error) else nan


def motion_errors(rng, family):
    """Return {way: errors of theta4, theta4', theta4'' in eps cond, of theta4 in rad}."""
    case, mode, lengths = draw(rng, family)
    omega = case.speed * rng.normal()
    truth, cond = condition(
        lambda v: [motion_of(case.lengths(*v[2:]), 2 * mode - 3, v[0], v[1], 0)[i]
                   for i in (0, 2, 6)],
        [mp.mpf(v) for v in (case.theta1, omega, *case.parameters)])
    least = [1.0, 0.0, 0.0]
    if case.exact:     # the condition can vanish there; see test_accuracy.motion_errors
        a1, _, _, a4 = lengths
        factor = a1 * a4 * abs(sin(case.theta1)) / ((a1 - a4)**2 + 4.0 * a1 * a4
                                                    * sin(0.5 * case.theta1)**2)
        least = [1.0, abs(omega), omega**2 * (1.0 + factor * (a1 != a4))]
    cond = [max(c, mp.mpf(limit)) for c, limit in zip(cond, least)]
    rows = {}
    for way, function in WAYS.items():
        errors = [abs(mp.mpf(float(found)) - true)
                  for found, true in zip(function(lengths, mode, case.theta1, omega), truth)]
        errors[0] = (abs(mp.fmod(errors[0] + mp.pi, 2 * mp.pi) - mp.pi) if mp.isfinite(errors[0])
                     else errors[0])
        rows[way] = ([in_eps(e, c) for e, c in zip(errors, cond)]
                     + [float(errors[0]) if cond[0] <= ORDINARY else 0.0])
    return rows


def reaction_errors(rng, family):
    """Return {way: error of the worst reaction in eps cond}, with everything acting."""
    case, mode, lengths = draw(rng, family)
    bodies, applied, gravity = random_masses(rng, float(np.median(lengths)), case.speed)
    omega, alpha = case.speed * rng.normal(), case.speed**2 * rng.normal()
    n = len(case.parameters)

    def exact(v):
        split = v[3 + n:]
        return loads_of(case.lengths(*v[3:3 + n]), 2 * mode - 3, *v[:3],
                        [split[i:i + 4] for i in (0, 4, 8)],
                        [split[i:i + 5] for i in (12, 17)], split[22:])[:4]

    bodies, applied = [tuple(map(float, b)) for b in bodies], [tuple(map(float, a))
                                                               for a in applied]
    truth, cond = condition(exact, [mp.mpf(float(v)) for v in (
        case.theta1, omega, alpha, *case.parameters, *sum(bodies, ()), *sum(applied, ()),
        *gravity)])
    linkage = FourBar(*lengths, mode=mode, gravity=tuple(map(float, gravity)),
                      bodies=Bodies(*(Body(*b) for b in bodies)),
                      external=External(*(Applied(*a) for a in applied)))
    found = {OURS: forces_of(linkage, case.theta1, omega, alpha),
             SYSTEM: forces_by_system(linkage, case.theta1, omega, alpha, bodies, applied)}
    return {way: max((in_eps(abs(mp.mpc(*force) - true), c)
                      for force, true, c in zip(forces, truth, cond)),
                     key=lambda e: inf if e != e else e) for way, forces in found.items()}


def forces_of(linkage, x, omega, alpha):
    """Return F41, F21, F32, F43 as (x, y) by the package; NaN where they are refused."""
    try:
        loads = linkage.loads(x, omega, alpha)
    except FourBarError:
        return np.full((4, 2), nan)
    return np.array(loads[:8]).reshape(4, 2)


def forces_by_system(linkage, x, omega, alpha, bodies, applied=()):
    """Return the same by the 9x9 system, the motion by the law of cosines."""
    x = np.float64(x)
    lengths = [np.float64(a) for a in linkage.lengths]
    with np.errstate(all='ignore'):
        motion = naive.law_of_cosines(lengths, linkage.sign, x)
        try:
            solution = naive.nine_by_nine(lengths, motion, x, omega, alpha, bodies, applied,
                                          linkage.gravity)
        except np.linalg.LinAlgError:
            return np.full((4, 2), nan)
    return solution[:8].reshape(4, 2)


# --- families ------------------------------------------------------------------------------------

def family_errors(family, samples):
    """Return {way: (poses, 4)} of motion_errors and {way: (poses,)} of reaction_errors."""
    rng = np.random.default_rng(list(FAMILIES).index(family))
    samples *= RANDOM_TIMES if family == 'random' else 1
    motion = [motion_errors(rng, family) for _ in range(samples)]
    loads = [reaction_errors(rng, family) for _ in range(max(1, samples // LOAD_SHARE))]
    return ({way: np.array([row[way] for row in motion]) for way in WAYS},
            {way: np.array([row[way] for row in loads]) for way in (OURS, SYSTEM)})


def largest(errors):
    """Return the largest error among the finite ones."""
    finite = errors[np.isfinite(errors)]
    return finite.max() if finite.size else nan


def digits(error):
    """Return an error in eps cond as text."""
    return f'{error:.2g}' if not error < 0.01 else '< 0.01'


def both(errors):
    """Return the largest error and the 99th percentile as text."""
    return f'{digits(largest(errors))} ({digits(np.nanquantile(errors, 0.99))})'


def table(head, rows):
    """Print a Markdown table and an empty line."""
    for line in (head, ['---'] * len(head), *rows):
        print('| ' + ' | '.join(map(str, line)) + ' |')
    print()


def print_ours(found):
    """Print errors and failures of the package by family."""
    print('Errors of fourbar_ros in eps times condition: largest (99th percentile). First column '
          f'in rad, where the condition of theta4 is at most {ORDINARY:g}; reactions at one pose '
          f'in {LOAD_SHARE}.\n')
    rows = []
    for family, (motion, loads) in found.items():
        errors = motion[OURS]
        rows.append((family, len(errors), f'{largest(errors[:, 3]):.1e}' if errors[:, 3].any()
                     else '-',
                     *(both(errors[:, i]) for i in range(3)), both(loads[OURS]),
                     np.isnan(errors).any(axis=1).sum() + np.isnan(loads[OURS]).sum()))
    table(('family', 'poses', 'theta4 [rad]', 'theta4', "theta4'", "theta4''", 'worst reaction',
           'not finite'), rows)


def print_others(found):
    """Print largest errors and failures of the naive formulas by family."""
    print('The same poses by naive formulas: largest error in eps times condition; in brackets '
          'how many poses in 1000 have no finite result.\n')
    head = ['family'] + [f'{what}: {name}' for what in ('theta4', "theta4''") for name in FORMULAS]
    rows = []
    for family, (motion, loads) in found.items():
        cells = [failing(motion[name][:, i]) for i in (0, 2) for name in FORMULAS]
        rows.append((family, *cells, failing(loads[SYSTEM])))
    table((*head, 'worst reaction: 9x9'), rows)


def failing(errors):
    """Return the largest error and the share of failures as text."""
    share = np.isnan(errors).mean()
    text = digits(largest(errors)) if share < 1.0 else '-'
    return f'{text} ({1000.0 * share:.0f})' if share else text


# --- near a toggle -------------------------------------------------------------------------------

def toggle_errors(margin):
    """
    Return {way: error of theta4'' over its peak}, {way: error of F41 over its peak}.

    Cranks that clear the toggle at theta1 = 0 by a margin, with rods, at poses around it.
    """
    rng = np.random.default_rng(round(-np.log10(margin)))
    second, force = dict.fromkeys(WAYS, 0.0), dict.fromkeys((OURS, SYSTEM), 0.0)
    for _ in range(TOGGLES):
        linkage = near_toggle(rng, margin)
        bodies = [(b.mass, b.cg_along, b.cg_across, b.inertia) for b in linkage.bodies]
        angles = [side * 10.0**power for side in (-1.0, 1.0)
                  for power in np.linspace(-9.0, 0.4, AROUND)]
        places = [pose(linkage.lengths, 1, mp.mpf(x)) for x in angles]
        true = np.array([float(place.ddy) for place in places])
        for way, function in WAYS.items():
            found = np.array([function(linkage.lengths, 2, x, 1.0)[2] for x in angles])
            second[way] = max(second[way], np.abs(found - true).max() / np.abs(true).max())
        true = np.array([complex(reactions(free_bodies(linkage.lengths, place, mp.mpf(x), 1, 0,
                                                       bodies, [(0,) * 5] * 2,
                                                       (0, 0)))[0])
                         for place, x in zip(places, angles)])
        for way, function in ((OURS, forces_of),
                              (SYSTEM, partial(forces_by_system, bodies=bodies))):
            found = np.array([complex(*function(linkage, x, 1.0, 0.0)[0]) for x in angles])
            force[way] = max(force[way], np.abs(found - true).max() / np.abs(true).max())
    return second, force


def near_toggle(rng, margin):
    """Return a crank-rocker with rods whose a2 clears the toggle at theta1 = 0 by a margin."""
    while True:
        a1, _, a3, a4 = crank_lengths(rng).tolist()
        lengths = (a1, a4 - a1 + a3 - margin * (a4 - a1), a3, a4)
        if closes(lengths) and FourBar(*lengths).classification == 'Grashof crank-rocker':
            return FourBar(*lengths, bodies=Bodies(*(round_rod(a, 7750.0, 0.01)
                                                     for a in lengths[:3])))


def print_toggles(found):
    """Print the errors by margin."""
    print(f"Near a toggle: largest error of theta4'' and of F41 over their peaks, {TOGGLES} "
          'crank-rockers a margin, '
          f'{2 * AROUND} poses each.\n')
    rows = [(f'{margin:.0e}', *(f'{second[way]:.1e}' for way in WAYS),
             *(f'{e:.1e}' for e in force.values()))
            for margin, (second, force) in found.items()]
    table(('margin', *(f"theta4'': {way}" for way in WAYS),
           *(f'F41: {way}' for way in (OURS, SYSTEM))), rows)


# --- streams -------------------------------------------------------------------------------------

def stream(lengths, steps):
    """Return poses, flips of the mode, poses not finite, largest errors and flips of a tracker."""
    count = MILLION * 3 if steps == 3 else MILLION
    theta1 = 0.1 + 2.0 * pi / steps * np.arange(count)
    motion = FourBar(*lengths).motion(theta1, 1.0)
    values = np.array((motion.theta4, motion.omega4, motion.alpha4))
    errors = []
    for k in np.linspace(0, count - 1, 60).astype(int).tolist():
        truth, cond = condition(lambda v: [motion_of(v[2:], 1, v[0], v[1], 0)[i]
                                           for i in (0, 2, 6)],
                                [mp.mpf(float(v)) for v in (theta1[k], 1.0, *lengths)])
        errors.append([float(abs(mp.mpf(float(v)) - t) / (EPS * max(c, 1 if i == 0 else 0)))
                       for i, (v, t, c) in enumerate(zip(values[:, k], truth, cond))])
    return (count, count // steps, int((np.sin(motion.theta4 - motion.beta) <= 0.0).sum()),
            int((~np.isfinite(values)).sum()), np.max(errors, axis=0),
            tracker_flips(lengths, theta1[:3000]))


def tracker_flips(lengths, theta1):
    """Return how often a pose that is the one nearest to the last pose changes its mode."""
    open_, crossed = (FourBar(*lengths, mode=mode).motion(theta1).theta4.tolist()
                      for mode in (2, 1))
    last, is_open, flips = open_[0], True, 0
    for one, other in zip(open_, crossed):
        nearest = min((one, other), key=lambda y: abs(sin(0.5 * (y - last))))
        flips += (nearest is one) != is_open
        is_open, last = nearest is one, nearest
    return flips


def print_streams():
    """Print what long streams of samples keep."""
    print('Streams of samples of one rotating crank (open mode), the angle counted on without '
          'wrapping; errors in eps cond at 60 samples of it. Beside it, over the first 3000 '
          'samples, the common rule "of two poses that nearest to the last".\n')
    rows = []
    for lengths in STREAMS:
        for steps in STEPS:
            count, turns, flips, failed, errors, tracker = stream(lengths, steps)
            rows.append((lengths, steps, count, turns, flips, failed,
                         *(f'{e:.2g}' for e in errors), tracker))
    table(('linkage', 'steps a turn', 'samples', 'turns', 'mode flips', 'not finite', 'theta4',
           "theta4'", "theta4''",
           'flips by the nearest pose'), rows)


# --- pictures ------------------------------------------------------------------------------------

def figure(**arguments):
    """Return matplotlib's figure and axes."""
    import matplotlib
    matplotlib.use('Agg')
    matplotlib.rcParams['svg.hashsalt'] = 'fourbar'
    from matplotlib import pyplot
    return pyplot.subplots(layout='constrained', **arguments)


def save(drawing, name, text):
    """Write a picture of docs/bench and show it."""
    for kind in ('svg', 'png'):
        drawing.savefig(ROOT / 'docs' / 'bench' / f'{name}.{kind}', dpi=100,
                        metadata={'Date': None} if kind == 'svg' else None)
    print(f'![{text}]({name}.svg)\n')


def draw_families(found):
    """Draw the largest errors by family."""
    drawing, axes = figure(ncols=3, figsize=(12.0, 6.6), sharey=True, sharex=True)
    names, rows = list(found), range(len(found))
    panels = (('θ4', 0), ("θ4''", 2), ('worst reaction', None))
    for axis, (title, i) in zip(axes, panels):
        for way in WAYS if i is not None else (OURS, SYSTEM):
            errors = [largest(motion[way][:, i] if i is not None else loads[way])
                      for motion, loads in found.values()]
            axis.plot(np.clip(errors, 0.1, LARGEST_DRAWN), rows, linestyle='none',
                      marker=MARKERS[way], color=COLORS[way],
                      markersize=11 if way == OURS else 6, label=way, alpha=0.9,
                      zorder=3 if way == OURS else 2)
        axis.axvline(5.0, color='0.6', linewidth=0.8, linestyle='--')
        axis.axvline(1.0 / EPS, color='0.8', linewidth=0.8)
        axis.set(xscale='log', xlim=(0.03, 20.0 * LARGEST_DRAWN), title=title,
                 xlabel='largest error [eps × condition]')
        axis.set_xticks([10.0**k for k in (0, 5, 10, 15)] + [LARGEST_DRAWN],
                        ['1', '$10^5$', '$10^{10}$', '$10^{15}$', r'$\geq10^{20}$'])
        axis.grid(True, axis='y', color='0.93')
    axes[0].set_yticks(list(rows), names)
    axes[0].set_ylim(len(found) - 0.4, -1.3)
    axes[0].text(7.0, -0.8, 'promised: 5', fontsize=8, color='0.4')
    axes[0].text(0.7 / EPS, -0.8, 'no digit left', fontsize=8, color='0.4', ha='right')
    lines = [*axes[0].get_lines()[:len(WAYS)], axes[2].get_lines()[1]]
    drawing.legend(handles=lines, loc='outside lower center', ncols=5, frameon=False)
    save(drawing, 'accuracy', 'Largest errors by family; where a mark is missing, no result was '
                              'finite')


def draw_toggles(found):
    """Draw the errors near a toggle."""
    drawing, axes = figure(ncols=2, figsize=(10.0, 4.2), sharey=True)
    for axis, which, title in zip(axes, (0, 1), ("θ4''", 'F41')):
        for way in next(iter(found.values()))[which]:
            axis.loglog(list(found), [row[which][way] for row in found.values()],
                        marker=MARKERS[way], color=COLORS[way],
                        label=way, markersize=11 if way == OURS else 6)
        axis.set(title=f'{title}: largest error over its peak',
                 xlabel='clearance of the toggle, relative')
        axis.grid(True, color='0.93')
        axis.legend()
    axes[0].invert_xaxis()
    axes[1].invert_xaxis()
    save(drawing, 'accuracy_toggle', 'Errors near a toggle')


def main(samples=SAMPLES):
    """Print all tables and draw; ``samples``: poses a family."""
    with ProcessPoolExecutor(WORKERS) as pool:
        families = pool.map(partial(family_errors, samples=samples), FAMILIES)
        toggles = pool.map(toggle_errors, MARGINS)
        found = dict(zip(FAMILIES, track(families, 'families', len(FAMILIES), console=PROGRESS,
                                         transient=True)))
        near = dict(zip(MARGINS, toggles))
    print_ours(found)
    draw_families(found)
    print_others(found)
    print_toggles(near)
    draw_toggles(near)
    print_streams()
