# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of one pose in eps times condition: the package, naive formulas, the 9x9 system."""
from dataclasses import astuple
from functools import partial
from math import inf, nan, tau

from flint import acb, arb, ctx
from fourbar_ros import Applied, FourBar, FourBarError
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

from . import naive

OURS, SYSTEM = 'fourbar_ros', '9x9'
CRANKS = [case for case in CASES if case.kind is FourBar]
AT_CHANGE_POINT = 'next to an exact change point'
FAMILIES = *families_of(CRANKS[0]), AT_CHANGE_POINT
ORDINARY = 6.0      # condition of theta4 up to which it is not in line within some degrees
# of the rates of a parallelogram, which are constant, by those of the input: no error is zero
LEAST = 1.0
FORMULAS = {'half angle': naive.half_angle, 'law of cosines': naive.law_of_cosines,
            'coordinates': naive.coordinates}
COLORS = {OURS: '#d62728', 'half angle': '#1f77b4', 'law of cosines': '#2ca02c',
          'coordinates': '#ff7f0e', SYSTEM: '#7f7f7f'}
MARKERS = {OURS: '*', 'half angle': 'v', 'law of cosines': 's', 'coordinates': 'D', SYSTEM: 'X'}


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


def drawn(rng, family):
    """Return a four-bar with everything acting, its input at constant rate, and its conditions."""
    case = CRANKS[rng.integers(2)]
    while True:
        lengths, (x, omega, _) = (draw(rng, case, family) if family != AT_CHANGE_POINT else
                                  (at_change_point(rng, case), (0.0, float(rng.normal()), 0.0)))
        masses = random_masses(rng, case, float(np.median(lengths)), abs(omega))
        linkage = case.make(lengths, masses)
        # the 9x9 system knows none on the crank
        linkage = linkage.with_external(linkage.external._replace(crank=Applied()))
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
    rows = {}
    for way, function in WAYS.items():
        found = [*function(linkage.lengths, linkage.mode, *given[:2])]
        true, cond = motion['theta4']
        found[0] += tau * round(float(true - found[0]) / tau) if np.isfinite(found[0]) else 0.0
        row = [in_eps(value, motion[name][0], max(motion[name][1], least))
               for value, name, least in zip(found, ('theta4', 'omega4', 'alpha4'),
                                             (1.0, LEAST * abs(given[1]), LEAST * given[1]**2))]
        rows[way] = [*row, row[0] * EPS * max(cond, 1.0) if cond <= ORDINARY else 0.0]
    forces = {OURS: forces_of(linkage, *given), SYSTEM: forces_by_system(linkage, *given)}
    return rows, {way: max((in_eps(complex(*force), *loads[name])
                            for force, name in zip(its, ('f41', 'f21', 'f32', 'f43'))),
                           key=lambda e: inf if e != e else e) for way, its in forces.items()}


def forces_of(linkage, x, omega, alpha):
    """Return F41, F21, F32, F43 as (x, y) by the package; NaN where they are refused."""
    try:
        loads = linkage.loads(x, omega, alpha)
    except FourBarError:
        return np.full((4, 2), nan)
    return np.array(loads[:8]).reshape(4, 2)


def forces_by_system(linkage, x, omega, alpha):
    """Return the same by the 9x9 system, the motion by the law of cosines."""
    x = np.float64(x)
    lengths = [np.float64(a) for a in linkage.lengths]
    with np.errstate(all='ignore'):
        motion = naive.law_of_cosines(lengths, linkage.sign, x)
        try:
            solution = naive.nine_by_nine(lengths, motion, x, omega, alpha,
                                          numbers_of(linkage.bodies), numbers_of(linkage.external),
                                          linkage.gravity)
        except np.linalg.LinAlgError:
            return np.full((4, 2), nan)
    return solution[:8].reshape(4, 2)


def numbers_of(records):
    """Return bodies or applied loads as tuples."""
    return [astuple(record) for record in records]
