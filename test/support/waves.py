# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Random periodic functions, whose roots are known: sums of sines and cosines."""
from math import pi

import numpy as np
from scipy.optimize import brentq


def waves(rng, count, order):
    """Return coefficients (2, count, order) of cosines and sines, smaller for higher ones."""
    return rng.normal(size=(2, count, order)) / (1.0 + np.arange(order))


def value(coefficients, x, row):
    """Return the function of each row at x."""
    angles = x[..., None] * np.arange(coefficients.shape[2])
    return (coefficients[0, row] * np.cos(angles) + coefficients[1, row] * np.sin(angles)).sum(-1)


def slope(coefficients, x, row):
    """Return its derivative."""
    cosines, sines = coefficients * np.arange(coefficients.shape[2])
    return value(np.array((sines, -cosines)), x, row)


def roots_in_a_turn(function):
    """Return the roots of a function of arrays, between samples denser than any two of them."""
    x = np.linspace(0.0, 2.0 * pi, 4001)
    f = function(x)
    return np.array([brentq(lambda at: float(function(np.array(at))), x[k], x[k + 1], xtol=1e-15,
                            rtol=2.0**-50)
                     for k in np.flatnonzero((f[1:] >= 0.0) != (f[:-1] >= 0.0))])
