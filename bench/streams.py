# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Long streams of samples of a rotating crank: what errors and assembly modes they keep."""
from math import pi, sin

from fourbar_ros import FourBar
import mpmath as mp
import numpy as np
from support.reference import condition, EPS, motion_of

from .pages import table

STREAMS, STEPS, MILLION = ((2.0, 4.0, 5.0, 3.01), (4.0, 3.5, 3.0, 2.0)), (3, 10, 360), 10**6


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
