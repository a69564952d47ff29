# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Stiff ordinary differential equations to many digits: Radau IIA of high order, with python-flint.

Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.5: collocation at the
zeros of P_s - P_{s-1}, of order 2 s - 1, L-stable; each step by simplified Newton iterations.
"""
from functools import lru_cache

from flint import arb, arb_mat, arb_series, ctx
import mpmath as mp


@lru_cache
def radau(stages, digits):
    """Return (c, A) of Radau IIA as lists of mpmath numbers."""
    with mp.workdps(2 * digits + stages):
        # P_s - P_{s-1} on [-1, 1], of which x = 1 is a zero
        high, low = (mp.taylor(lambda x, n=n: mp.legendre(n, x), 0, n)
                     for n in (stages, stages - 1))
        coefficients = [a - b for a, b in zip(high, [*low, mp.mpf(0)])]
        zeros = sorted(mp.re(z) for z in mp.polyroots(coefficients[::-1], maxsteps=500,
                                                      extraprec=400))
        nodes = [(1 + z) / 2 for z in zeros]
        nodes[-1] = mp.mpf(1)
        powers = mp.matrix(stages, stages)
        integrals = mp.matrix(stages, stages)
        for i, node in enumerate(nodes):
            for j in range(stages):
                powers[i, j] = node**j
                integrals[i, j] = node**(j + 1) / (j + 1)
        matrix = integrals * powers**-1
        return nodes, [[matrix[i, j] for j in range(stages)] for i in range(stages)]


def collocation(derivative, start, steps, stages=16, digits=50):
    """
    Return the state after steps of these lengths.

    ``derivative(states)`` takes and returns lists of power series in time, as for
    :func:`support.taylor.taylor`; ``start()`` the state in the precision in which it is called.
    """
    before = ctx.prec, ctx.cap
    ctx.dps = digits
    try:
        _, rows = radau(stages, digits)
        matrix = [[arb(mp.nstr(value, digits + 5)) for value in row] for row in rows]
        state = [arb(value) for value in start()]
        for step in steps:
            state = _one_step(derivative, state, arb(step), matrix, digits)
        return [mp.mpf(value.str(digits - 10, radius=False)) for value in state]
    finally:
        ctx.prec, ctx.cap = before


def _values(derivative, state):
    ctx.cap = 1
    return [change[0] for change in derivative([arb_series([value]) for value in state])]


def _jacobian(derivative, state):
    """Return columns of the Jacobian by power series of one further term."""
    ctx.cap = 2
    return [[change[1] for change in derivative(
        [arb_series([value, 1 if i == j else 0]) for i, value in enumerate(state)])]
        for j in range(len(state))]


def _one_step(derivative, state, step, matrix, digits):
    """Solve Z = h A f(x + Z) by Newton's method with the Jacobian at the start of the step."""
    size, stages = len(state), len(matrix)
    columns = _jacobian(derivative, state)
    system = arb_mat(size * stages, size * stages,
                     [(1 if (i, p) == (j, q) else 0) - (step * matrix[i][j] * columns[q][p]).mid()
                      for i in range(stages) for p in range(size)
                      for j in range(stages) for q in range(size)])
    inverse = system.inv(nonstop=True).mid()
    moved = [[arb(0)] * size for _ in range(stages)]
    least = arb(10)**(10 - digits)
    for _ in range(200):
        slopes = [_values(derivative, [a + b for a, b in zip(state, z)]) for z in moved]
        residual = [(step * sum((a * f[p] for a, f in zip(row, slopes)), arb(0)) - z[p]).mid()
                    for row, z in zip(matrix, moved) for p in range(size)]
        change = inverse * arb_mat(size * stages, 1, residual)
        change = [change[i, 0].mid() for i in range(size * stages)]
        moved = [[(z + change[size * i + p]).mid() for p, z in enumerate(row)]
                 for i, row in enumerate(moved)]
        if all(abs(value) < least for value in change):
            return [(a + b).mid() for a, b in zip(state, moved[-1])]
    raise ArithmeticError('Newton does not converge: a shorter step')
