# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which points of the unit cube a study takes: any rows of a design, without those before.

``grid``               all combinations of the levels, the last parameter the fastest
``sobol``              Sobol's sequence, scrambled (Owen) with the seed: the best cover of a box
``latin_hypercube``    each parameter's values spread evenly; drawn whole, so at most
                       :data:`WHOLE` rows
``random``             independent: for tolerances, where percentiles are wanted

Row i is the same whoever computes it, and in whatever order: studies are cut into chunks.
"""
from __future__ import annotations

from functools import lru_cache
import warnings

from fourbar_ros.numerics.arrays import Array
import numpy as np

METHODS = ('grid', 'sobol', 'latin_hypercube', 'random')
WHOLE = 2**20
# Bits of Sobol's numbers, and rows of a sequence: scipy cannot begin at a row of a longer one.
BITS = 32
LONGEST = 2**BITS


def unit_points(method: str, rows: tuple[int, int], seed: int, levels: tuple[Array, ...],
                count: int) -> Array:
    """
    Return some rows of a design, shape (rows, parameters), in [0, 1].

    Parameters
    ----------
    method : str
        One of :data:`METHODS`.
    rows : (first, after last)
    seed : int
    levels : tuple of ndarray
        Levels of each parameter on a grid.
    count : int
        Rows of the whole design.

    """
    start, stop = rows
    if method == 'grid':
        return _grid(levels, np.arange(start, stop))
    if method == 'random':
        generator = np.random.Philox(key=seed)
        # one block of four 64-bit numbers a row and four parameters
        blocks = -(-len(levels) // 4)
        generator.advance(start * blocks)
        points = np.random.Generator(generator).random((stop - start, 4 * blocks))
        return points[:, :len(levels)]
    if method == 'latin_hypercube':
        return _latin_hypercube(len(levels), count, seed)[start:stop]
    from scipy.stats.qmc import Sobol
    sequence = Sobol(len(levels), scramble=True, bits=BITS, seed=np.random.default_rng(seed))
    if start:
        sequence.fast_forward(start)
    with warnings.catch_warnings():         # that only powers of two are balanced: a user's choice
        warnings.simplefilter('ignore', UserWarning)
        return np.asarray(sequence.random(stop - start))


def _grid(levels: tuple[Array, ...], rows: Array) -> Array:
    """Return the combinations of levels with these numbers."""
    columns = []
    for values in reversed(levels):
        rows, place = np.divmod(rows, values.size)
        columns.append(values[place])
    return np.stack(columns[::-1], axis=1)


@lru_cache(maxsize=1)
def _latin_hypercube(parameters: int, count: int, seed: int) -> Array:
    from scipy.stats.qmc import LatinHypercube
    return np.asarray(LatinHypercube(parameters, seed=np.random.default_rng(seed)).random(count))
