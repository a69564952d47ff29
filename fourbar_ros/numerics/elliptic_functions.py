# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Jacobi's elliptic functions by the descending Landen transformation.

Their argument is the complementary parameter, m1 = 1 - m.

Sources: NIST Digital Library of Mathematical Functions, section 22.7(i); Abramowitz and Stegun,
section 16.12.
Not scipy.special.ellipj: it takes the parameter m, and next to a change point, m -> 1, everything
depends on digits of 1 - m that m has lost.
"""
from __future__ import annotations

from collections.abc import Sequence

from fourbar_ros.numerics.arrays import Values
import numpy as np


def landen_steps(m1: Values) -> list[tuple[Values, Values]]:
    """
    Return the steps of the descending Landen transformation.

    ``m1`` = 1 - m, the complementary parameter, is a float or an array, in (0, 1]. Each step is
    the modulus k it leads to and that modulus' complement k' before it; the last step first, as
    :func:`jacobi` needs them. Written in the complementary modulus, with sums of positive terms
    only, it loses nothing for m1 -> 0. It ends where k' is 1 to 1e-3, and errors are of this size:
    the functions only place samples.
    """
    steps: list[tuple[Values, Values]] = []
    modulus, smallest = m1**0.5, float(np.min(m1))**0.5
    while not steps or smallest < 1.0 - 1e-3:
        next_one = 1.0 / (1.0 + modulus)
        steps.append(((1.0 - modulus) * next_one, 2.0 * modulus * next_one))
        modulus, smallest = 2.0 * modulus**0.5 * next_one, 2.0 * smallest**0.5 / (1.0 + smallest)
    return steps[::-1]


def jacobi(sine: Values, cosine: Values,
           steps: Sequence[tuple[Values, Values]]) -> tuple[Values, Values, Values]:
    """Return sn, cn, dn of u at the phase pi u/(2 K), given by its sine and cosine."""
    sn, cn, dn = sine, cosine, sine * sine + cosine * cosine
    for k, k1 in steps:
        square = sn * sn
        scale = 1.0 / (1.0 + k * square)
        sn, cn, dn = (1.0 + k) * sn * scale, cn * dn * scale, (k1 + k * cn * cn) * scale
    return sn, cn, dn
