# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Cases in which formulas that are good on an ordinary linkage lose their digits.

The errors of the same outputs.
"""
from __future__ import annotations

from math import pi

import numpy as np

from .textbook import FIELDS, textbook

# [rad/s]; part of the input's rate or its square below which no value counts
OMEGA, LEAST = 25.0, 1e-3
SHOWN = ('theta4', 'omega4', 'alpha4', 'f41')
AROUND = 10.0**np.linspace(-9.0, 0.4, 40)
NEAR_ZERO, NEAR_PI = (np.concatenate((-AROUND[::-1], AROUND)),
                      pi + np.concatenate((-AROUND[::-1], AROUND)))
EVENLY = 2.0 * pi * (np.arange(200) + 0.5) / 200


def cases():
    """Return {name: (lengths, samples of theta1)}, mode 2."""
    a1, a3, a4 = 0.4, 0.8, 1.0
    return {'the ordinary linkage': ((a1, 1.2, a3, a4), EVENLY),
            **{f'a crank that clears a toggle by {margin:.0e}': ((a1, (a4 - a1) * (1.0 - margin)
                                                                  + a3, a3, a4), NEAR_ZERO)
               for margin in (1e-4, 1e-8, 1e-12)},
            **{f'{gap:.0e} from a change point': ((a1, 0.9, 0.6, (0.9 + 0.6 - a1) * (1.0 - gap)),
                                                  NEAR_PI)
               for gap in (1e-4, 1e-8, 1e-12)},
            'a parallelogram': ((a1, 1.0, a1, 1.0), NEAR_ZERO),
            **{f'crank and output link {ratio:.0e} of the others': ((ratio, 1.0, 2.0 * ratio, 1.0),
                                                                    EVENLY)
               for ratio in (1e-2, 1e-4, 1e-6)}}


def truth_of(linkage, x):
    """Return (theta4, omega4, alpha4, F41) to many digits, rounded."""
    from support.cartesian import values
    found = values(linkage, x, OMEGA)
    return (*(float(found[name]) for name in ('theta4', 'omega4', 'alpha4')),
            complex(found['f41_x'], found['f41_y']))


def errors(lengths, samples):
    """
    Return two rows of errors, the package's and the textbook's.

    theta4 [rad], the others of the sample's own value.
    """
    from fourbar_ros import Bodies, FourBar, round_rod
    rods = [round_rod(length, 7750.0, 0.01) for length in lengths[:3]]
    bodies = [(rod.mass, rod.cg_along, rod.cg_across, rod.inertia) for rod in rods]
    linkage = FourBar(*lengths, bodies=Bodies(*rods))
    truth = [np.array(column)
             for column in zip(*(truth_of(linkage, x) for x in samples.tolist()))]
    with np.errstate(all='ignore'):
        found = (linkage.step(samples, OMEGA, fields=FIELDS),
                 textbook(lengths, 1.0, bodies, samples, OMEGA, 0.0))
    rows = []
    for values in found:
        fields = dict(zip(FIELDS, values))
        fields['f41'] = fields['f41_x'] + 1j * fields['f41_y']
        wrong = [np.abs(np.angle(np.exp(1j * (fields['theta4'] - truth[0]))))]
        with np.errstate(all='ignore'):
            wrong += [np.abs(fields[name] - true) / np.maximum(np.abs(true), least)
                      for name, true, least in zip(SHOWN[1:], truth[1:],
                                                   (LEAST * OMEGA, LEAST * OMEGA**2, 0.0))]
        rows.append([error.max() if np.isfinite(error).all() else np.inf for error in wrong])
    return rows


def print_errors():
    """Print the table."""
    print('Where digits are lost: the largest errors of the textbook script and of ours at the '
          'same samples, theta4 in rad, the others each of its own value (rates and '
          f'accelerations of at least {LEAST:g} of those of the input). What the rounded data '
          'allow at all is in [accuracy](accuracy.md).\n')
    print('| linkage | method | ' + ' | '.join(('theta4 [rad]', "theta4'", "theta4''", 'F41'))
          + ' |\n' + '| --- ' * 6 + '|')
    for name, (lengths, samples) in cases().items():
        for method, row in zip(('fourbar_ros', 'textbook'), errors(lengths, samples)):
            print(f'| {name} | {method} | ' + ' | '.join('not finite' if error == np.inf
                                                         else f'{error:.1e}' for error in row)
                  + ' |')
    print()
