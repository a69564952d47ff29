# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The loop of two tree ends that must coincide: what a tree engine leaves to its user."""


def solve(matrix, right):
    """Solve 2x2 by Cramer; right: two numbers."""
    (a, b), (c, d) = matrix
    scale = 1.0 / (a * d - b * c)
    return (d * right[0] - b * right[1]) * scale, (a * right[1] - c * right[0]) * scale


def run_tree(engine, case, tolerance):
    """
    Return the function theta1 -> rows (theta4, omega4, alpha4, F41) for an engine.

    It needs
    ``gap(q)``: end of the output link minus end of the coupler (x, y), and its Jacobian (2 rows of
    3); ``bias(q, v)``: what the gap's acceleration is without joint accelerations;
    ``efforts(q, v, a)``: joint efforts of the open tree and its force on the crank. q: crank,
    coupler relative to it, output link.
    """
    (x0, b0, y0), (dx0, db0, dy0) = case.start()
    dt = case.step / case.omega

    def run(theta1):
        q = [x0, b0 - x0, y0]
        v = [dx0, db0 - dx0, dy0]
        a = [0.0, 0.0, 0.0]
        rows, moved = [], 0.0
        for x in theta1.tolist():
            q = [x] + [p + (r + 0.5 * s * moved) * moved for p, r, s in zip(q[1:], v[1:], a[1:])]
            for _ in range(10):
                gap, jacobian = engine.gap(q)
                if max(abs(gap[0]), abs(gap[1])) <= tolerance:
                    break
                passive = [row[1:] for row in jacobian]
                change = solve(passive, gap)
                q[1] -= change[0]
                q[2] -= change[1]
            passive = [row[1:] for row in jacobian]
            v = [case.omega, *solve(passive, [-row[0] * case.omega for row in jacobian])]
            bias = engine.bias(q, v)
            a = [0.0, *solve(passive, [-bias[0], -bias[1]])]
            effort, (fx, fy) = engine.efforts(q, v, a)
            px, py = solve(list(zip(*passive)), effort[1:])     # of the loop on the output link
            rows.append((q[2], v[2], a[2], (fx + px, fy + py)))
            moved = dt
        return rows
    return run


def read(rows):
    """Return the dict of arrays of rows."""
    return dict(zip(('theta4', 'omega4', 'alpha4', 'f41'), zip(*rows)))
