# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of one pose in eps times condition: the package, naive formulas, the 9x9 system."""
from dataclasses import astuple
from functools import partial
from math import inf, nan

from fourbar_ros import FourBar, FourBarError
import mpmath as mp
import numpy as np
from support.four_bar_families import draw, least_conditions, loaded, ORDINARY
from support.reference import condition, EPS, motion_of

from . import naive

OURS, SYSTEM = 'fourbar_ros', '9x9'
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
    least = least_conditions(case, lengths, omega)
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
    linkage, given, truth, cond = loaded(rng, family)
    found = {OURS: forces_of(linkage, *given), SYSTEM: forces_by_system(linkage, *given)}
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
