# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The root search in plain floats and on arrays.

Twins, compared directly, and against the roots themselves.
"""
from fourbar_ros.numerics.newton import newton_root, newton_roots
from fourbar_ros.numerics.roots import intervals_of_one, intervals_with_roots
import numpy as np
import pytest

EPS = 2.0**-52


@pytest.mark.parametrize('is_closed', [True, False])
@pytest.mark.parametrize('seed', range(40))
def test_both_name_the_same_intervals(seed, is_closed):
    """Random samples and slopes, with zeros, tiny and steep ones among them."""
    rng = np.random.default_rng(seed)
    f = rng.normal(size=24) * 10.0**rng.uniform(-6.0, 0.0, 24) * rng.choice([0.0, 1.0], 24,
                                                                            p=[0.1, 0.9])
    rise = rng.normal(size=24) * 10.0**rng.uniform(-6.0, 0.0, 24)
    i, _, is_plain = intervals_with_roots(f[:, None], rise[:, None], is_closed)
    assert intervals_of_one(f.tolist(), rise.tolist(),
                            is_closed) == list(zip(i.tolist(), is_plain.tolist()))


@pytest.mark.parametrize('power', [1, 3, 5])
def test_both_find_the_same_root_to_the_last_bits(power):
    """Steep and flat ones: Newton's method, and bisection where it fails."""
    rng = np.random.default_rng(power)
    at = np.concatenate((rng.uniform(0.1, 6.0, 40), 10.0**-rng.uniform(1.0, 9.0, 10)))
    xa, xb = at - rng.uniform(0.01, 0.1, 50), at + rng.uniform(0.01, 0.1, 50)

    def value_and_step(x, root):
        d = x - root
        return d**power + 0.1 * d, (d**power + 0.1 * d) / (power * d**(power - 1) + 0.1)

    fa = value_and_step(xa, at)[0]
    guess = xa + rng.uniform(0.0, 1.0, 50) * (xb - xa)
    many = newton_roots(lambda x, row: value_and_step(x, at[row]), np.arange(50), xa, xb, fa,
                        guess)
    for i in range(50):
        one, _ = newton_root(lambda x, root=at[i].item(): (*value_and_step(x, root), None),
                             xa[i].item(), xb[i].item(), fa[i].item(), guess[i].item())
        assert abs(one - many[i]) <= 2.0 * EPS * abs(one)
        assert abs(one - at[i]) <= 4.0 * EPS * max(abs(at[i]), 2.0**-12)
