# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors in eps times condition over ordinary and extreme cases, of plain.py too."""
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from math import inf, nan, tau

from flint import acb, arb, ctx
from fourbar_ros import External, FourBar, FourBarError, plain
import numpy as np
from support.cartesian import beside, BITS, conditions, EPS, exact, kept_at, MANY_BITS
from support.contract import (
    at_change_point,
    CASES,
    draw,
    families_of,
    flat_positions,
    random_masses,
)

from .pages import table

SAMPLES, RANDOM_TIMES, WORKERS = 600, 4, 2      # poses a family; random: 4 times
OURS, PLAIN = 'fourbar_ros', 'plain'
CRANKS = [case for case in CASES if case.kind is FourBar]
AT_CHANGE_POINT = 'next to an exact change point'
FAMILIES = *families_of(CRANKS[0]), AT_CHANGE_POINT
ORDINARY = 6.0      # condition of theta4 up to which it is not in line within some degrees


# --- one pose ------------------------------------------------------------------------------------

def ours(linkage, given):
    """Return theta4, omega4 and alpha4, then F41, F21, F32, F43; NaN where they are refused."""
    try:
        motion, loads = linkage.step(*given)
    except FourBarError:
        return 3 * (nan,), np.full(4, nan)
    return ((motion.theta4, motion.omega4, motion.alpha4),
            np.array(loads[:8:2]) + 1j * np.array(loads[1:8:2]))


def by_plain(linkage, given):
    """Return the same by the equations of the paper."""
    # its mode is a side, that of the library a branch
    mode = 1 if np.sin(linkage.motion(*given).theta3) > 0.0 else 2
    m = plain.motion(linkage.lengths, *given, mode)
    try:
        forces = plain.loads(linkage.lengths, linkage.bodies, m, linkage.gravity)
    except np.linalg.LinAlgError:
        forces = np.full(8, nan)
    return (m.theta4, m.omega4, m.alpha4), np.array(forces[:8:2]) + 1j * np.array(forces[1:8:2])


def drawn(rng, family):
    """Return a four-bar with masses and weight, its input at constant rate, and its conditions."""
    case = CRANKS[rng.integers(2)]
    while True:
        lengths, (x, omega, _) = (draw(rng, case, family) if family != AT_CHANGE_POINT else
                                  (at_change_point(rng, case), (0.0, float(rng.normal()), 0.0)))
        masses = random_masses(rng, case, float(np.median(lengths)), abs(omega))
        # plain.py knows masses and weight, no other loads
        linkage = case.make(lengths, masses).with_external(External())
        if family != AT_CHANGE_POINT:
            given = x, omega, 0.0
            with ctx.workprec(BITS):
                return linkage, given, conditions(exact(linkage, given), given)
        with ctx.workprec(MANY_BITS):
            for flat in flat_positions(linkage):
                x = float(flat + float(rng.choice((-1.0, 1.0)) * 10.0**rng.uniform(-14.0, -2.0)))
                given = x, omega, 0.0
                found, = beside(linkage, flat, [arb(x) - flat], given[1:])
                return linkage, given, conditions(found, given, kept_at(found.machine, flat,
                                                                        found))


def in_eps(found, true, cond):
    """Return the error of a result in eps cond; NaN if it is no number."""
    found = complex(found)
    return (float(abs(acb(found.real, found.imag) - true)) / (EPS * cond) if np.isfinite(found)
            else nan)


def errors(rng, family):
    """
    Return {way: errors of theta4, theta4', theta4'' in eps cond, of theta4 in rad}.

    And {way: that of the worst reaction}.
    """
    linkage, given, (motion, loads) = drawn(rng, family)
    # the rates of a parallelogram are constant, so that no error is zero: at least the input's
    least = 1.0, abs(given[1]), given[1]**2
    motions, forces = {}, {}
    for way, function in ((OURS, ours), (PLAIN, by_plain)):
        found, its = function(linkage, given)
        true, cond = motion['theta4']
        turn = tau * round(float(true - found[0]) / tau) if np.isfinite(found[0]) else 0.0
        row = [in_eps(value, motion[name][0], max(motion[name][1], size))
               for value, name, size in zip((found[0] + turn, *found[1:]),
                                            ('theta4', 'omega4', 'alpha4'), least)]
        motions[way] = [*row, row[0] * EPS * max(cond, 1.0) if cond <= ORDINARY else 0.0]
        forces[way] = max((in_eps(force, *loads[name])
                           for force, name in zip(its, ('f41', 'f21', 'f32', 'f43'))),
                          key=lambda error: inf if error != error else error)
    return motions, forces


# --- families of poses ---------------------------------------------------------------------------

def family_errors(family, samples):
    """Return the errors of :func:`errors` by their ways: arrays (poses, 4) and (poses,)."""
    rng = np.random.default_rng(FAMILIES.index(family))
    samples *= RANDOM_TIMES if family == 'random' else 1
    return [{way: np.array([row[way] for row in rows]) for way in (OURS, PLAIN)}
            for rows in zip(*(errors(rng, family) for _ in range(samples)))]


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


def failing(errors):
    """Return the largest error and the share of failures as text."""
    share = np.isnan(errors).mean()
    return digits(largest(errors)) + (f' ({1000.0 * share:.0f})' if share else '')


def main(samples=SAMPLES):
    """Print both tables; ``samples``: poses a family."""
    with ProcessPoolExecutor(WORKERS) as pool:
        found = dict(zip(FAMILIES, pool.map(partial(family_errors, samples=samples), FAMILIES)))
    print('Errors of fourbar_ros in eps times condition: largest (99th percentile). First column '
          f'in rad, where the condition of theta4 is at most {ORDINARY:g}.\n')
    rows = []
    for family, (motion, loads) in found.items():
        its = motion[OURS]
        rows.append((family, len(its), f'{largest(its[:, 3]):.1e}' if its[:, 3].any() else '-',
                     *(both(its[:, i]) for i in range(3)), both(loads[OURS]),
                     np.isnan(its).any(axis=1).sum() + np.isnan(loads[OURS]).sum()))
    table(('family', 'poses', 'theta4 [rad]', 'theta4', "theta4'", "theta4''", 'worst reaction',
           'not finite'), rows)
    print('The same poses by the equations of the paper, fourbar_ros/plain.py: largest error in '
          'eps times condition; in brackets how many poses in 1000 have no finite result.\n')
    table(('family', 'theta4', "theta4''", 'worst reaction'),
          [(family, failing(motion[PLAIN][:, 0]), failing(motion[PLAIN][:, 2]),
            failing(loads[PLAIN])) for family, (motion, loads) in found.items()])
