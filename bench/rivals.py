# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Other ways to the extrema of theta4' and theta4'' of a crank-rocker at constant input rate.

Each takes the four lengths and returns two lists of theta1 [rad], of theta4' and of theta4''.
"""
from math import acos, pi

import numpy as np
from numpy.polynomial import chebyshev, Polynomial
from scipy.optimize import brentq

from .naive import ARRAY, coordinates, SCALAR

GRID = [2.0 * pi * i / 720 for i in range(721)]
IMAGINARY = 1e-6               # part of 1 + |root| up to which a root is taken for real


def slopes(lengths, x, m=SCALAR):
    """Return theta4'' and theta4''', from the loop differentiated three times."""
    a1, a2, a3, _ = lengths
    y, b, dy, db, ddy, ddb = coordinates(lengths, 1.0, x, m)
    sine, cosine = m.sin(y - b), m.cos(y - b)
    return (ddy, ((3.0 * a2 * db * ddb - a1 * m.sin(x - b)) / a3 - 3.0 * dy * ddy * cosine) / sine
            + dy * dy * dy)


# --- grids ---------------------------------------------------------------------------------------

def grid_with_formulas(lengths):
    """720 points in plain Python; theta4'' and theta4''' together from formulas."""
    return refined_pair(lengths, zip(*(slopes(lengths, x) for x in GRID)))


def grid_in_numpy(lengths, grid=GRID):
    """720 points in numpy, the same formulas."""
    return refined_pair(lengths, (v.tolist() for v in slopes(lengths, np.array(grid), ARRAY)),
                        grid)


def shifted_grid(lengths):
    """Shift the grid by half a step, off 0 and pi, where the change points are."""
    return grid_in_numpy(lengths, [x + pi / 720 for x in GRID])


def refined_pair(lengths, samples, grid=GRID):
    return [refined(lambda x, i=i: slopes(lengths, x)[i], f, grid) for i, f in enumerate(samples)]


def refined(function, f, grid=GRID):
    """Return the roots between samples of different sign."""
    return [brentq(function, xa, xb) for xa, xb, fa, fb in zip(grid, grid[1:], f, f[1:])
            if (fa >= 0.0) != (fb >= 0.0)]


# --- the polynomials -----------------------------------------------------------------------------

class Equations:
    """The polynomials of degree 6 and 11 in q = |A O4|^2, in doubles, times q^2 and q^3."""

    def __init__(self, lengths):
        a1, a2, a3, a4 = (length / max(lengths) for length in lengths)
        self.ends = (a1 - a4)**2, (a1 + a4)**2
        self.e, f, q = (a1 - a4) * (a1 + a4), (a2 - a3) * (a2 + a3), Polynomial((0.0, 1.0))
        self.S, self.T = (self.ends[1] - q) * (q - self.ends[0]), ((a2 + a3)**2
                                                                   - q) * (q - (a2 - a3)**2)
        dS, dT = self.S.deriv(), self.T.deriv()
        self.R = 0.5 * q * (q + f) * (dS * self.T - self.S * dT) - f * self.S * self.T
        self.W = 4.0 * self.S - q * dS
        self.M = 2.0 * q * self.T * self.R.deriv() - 4.0 * self.R * self.T - 3.0 * q * self.R * dT

    def of(self, order, q=lambda polynomial: polynomial):
        """
        Return the polynomial times q^2 (q^3).

        Or its value where ``q`` evaluates polynomials.
        """
        if order == 0:
            return self.e**2 * q(self.S) * q(self.T)**3 - q(self.R)**2
        return self.e**2 * q(self.W)**2 * q(self.T)**5 - q(self.S) * q(self.M)**2

    def angle(self, order, cosine):
        """
        Return the angle in mode 2 of a root.

        The one of the two with this cosine that solved the equation before squaring.
        """
        low, high = self.ends
        q = 0.5 * (low + high) - 0.5 * (high - low) * cosine
        factor = self.R(q) if order == 0 else -self.W(q) * self.M(q)
        return acos(cosine) if self.e * factor > 0.0 else -acos(cosine)


def chebyshev_colleague(lengths):
    """Eigenvalues of the colleague matrix in cos(theta1), then Newton."""
    equations = Equations(lengths)
    low, high = equations.ends
    found = []
    for order, degree, power in ((0, 6, 2), (1, 11, 3)):
        def value(c):
            q = 0.5 * (low + high) - 0.5 * (high - low) * c
            return equations.of(order, lambda polynomial: polynomial(q)) / q**power
        roots = chebyshev.chebroots(chebyshev.chebinterpolate(value, degree))
        cosines = real(roots[np.abs(roots.real) <= 1.0 + IMAGINARY])
        found.append(polished(lengths, order,
                              [equations.angle(order, min(1.0, max(-1.0, c))) for c in cosines]))
    return found


def real(roots):
    return roots.real[np.abs(roots.imag) <= IMAGINARY * (1.0 + np.abs(roots))].tolist()


def polished(lengths, order, angles):
    """Return the angles after Newton's method, each once."""
    found = []
    for x in angles:
        try:
            for _ in range(8):
                value, slope = third(lengths, x) if order else slopes(lengths, x)
                x -= value / slope
        except (ValueError, ZeroDivisionError):
            continue
        if all(abs(x - other) > 1e-10 for other in found):
            found.append(x)
    return found


def third(lengths, x, step=1e-7):
    """Return theta4''' and its slope."""
    low, value, high = (slopes(lengths, v)[1] for v in (x - step, x, x + step))
    return value, (high - low) / (2.0 * step)
