# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What compiling the same formulas with numba would give, beside numpy: one core, one process."""
from __future__ import annotations

from dataclasses import replace
import time

from fourbar_ros import Bodies, FourBar, round_rod
from fourbar_ros.extrema.four_bar_rates.paths import SAMPLES, TOGETHER
from fourbar_ros.extrema.four_bar_rates.sines import make_sines, sine_constants
from fourbar_ros.mechanisms.four_bar.motion import make_motion
from fourbar_ros.mechanisms.half_angle import bilinear_factors
from fourbar_ros.numerics.exact_sums import exact_sum_of_four
from fourbar_ros.numerics.number_types import ARRAY
from fourbar_ros.numerics.straight_line import straight_line
import numpy as np

from .pages import best_time

LINKAGES, ROUNDS, RATE = 4096, 5, 25.0


def plain(numbers):
    """Return the number type without what a compiler does not know: exact sums, powers of two."""
    return replace(numbers, exact_sum=sum, power_of_two=lambda *lengths: 1.0)


def sines():
    """Return numpy's function, the formula as straight lines, and its arguments: make_sines."""
    rng = np.random.default_rng(0)
    lengths = [rng.uniform(*ends, LINKAGES) for ends in ((0.2, 0.4), (1.0, 1.2), (0.7, 0.9),
                                                         (1.0, 1.0))]
    factors = bilinear_factors(*lengths, exact_sum_of_four)
    constants = np.array(sine_constants(lengths, factors, np.ones(LINKAGES)))
    x = np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    sine, cosine = np.sin(x), np.cos(x)
    grid = [np.broadcast_to(v[:, None], (SAMPLES, LINKAGES))
            for v in (sine * sine, cosine * cosine, sine * cosine)]

    def formula(n):
        return lambda *given: make_sines(n, given[3:])(*given[:3])

    def with_numpy():       # in blocks that stay in the cache
        for start in range(0, LINKAGES, TOGETHER):
            part = slice(start, start + TOGETHER)
            make_sines(ARRAY, tuple(constants[:, part]))(*(v[:, part] for v in grid))

    columns = [*grid, *(np.broadcast_to(c, grid[0].shape) for c in constants)]
    return with_numpy, straight_line(formula, 20), columns


def loads():
    """Return the same for motion and all loads at one linkage a column."""
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=Bodies(*(round_rod(a, 7750.0, 0.01)
                                                          for a in (0.4, 1.2, 0.8))))
    rng = np.random.default_rng(0)
    lengths = [a * rng.uniform(0.98, 1.02, (LINKAGES, 1)) for a in linkage.lengths]
    x = np.broadcast_to(2.0 * np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES, (LINKAGES, SAMPLES))

    def formula(n):
        def state(x, *lengths):
            numbers = plain(n)
            motion = make_motion(numbers, *lengths, 1.0)(x, RATE, 0.0)
            of = linkage.loads_formula(numbers, linkage.constants._replace(lengths=lengths))
            return motion[10:12] + of(motion)
        return state

    def with_numpy():       # in blocks that stay in the cache, as a study computes
        for start in range(0, LINKAGES, 64):
            part = slice(start, start + 64)
            formula(ARRAY)(x[part], *[length[part] for length in lengths])
    return with_numpy, straight_line(formula, 5), [x, *(np.broadcast_to(a, x.shape)
                                                        for a in lengths)]


def compiled(line, count, numba):
    """Return a compiled loop over columns of numbers."""
    jit = numba.njit(error_model='numpy')
    inner = jit(line)
    given = ', '.join(f'c[{i}, j]' for i in range(count))
    names = {'inner': inner}
    exec(f'def loop(c, out):\n    for j in range(c.shape[1]):\n        r = inner({given})\n'
         '        for i in range(out.shape[0]):\n            out[i, j] = r[i]\n', names)
    return jit(names['loop'])


def main():
    """Print the table, or one line where numba is missing."""
    try:
        import numba
    except ImportError:
        print('numba is not installed here: pip install numba')
        return
    print(f'numba {numba.__version__}\n')
    print('| formula, for each sample of each linkage | numpy [ns] | numba [ns] | times as fast | '
          'compiling [s] |\n| --- | --- | --- | --- | --- |')
    for text, (with_numpy, line, columns) in (
            ('g, k and their slopes (search of the two rates)', sines()),
            ('motion and all loads', loads())):
        given = np.stack([column.ravel() for column in columns])
        out = np.empty((len(line(*given[:, 0].tolist())), given.shape[1]))
        loop, begun = compiled(line, len(given), numba), time.process_time()
        loop(given[:, :2], out[:, :2])
        taken = time.process_time() - begun
        one = best_time(with_numpy, ROUNDS) / given.shape[1]
        other = best_time(lambda: loop(given, out), ROUNDS) / given.shape[1]
        print(f'| {text} | {1e9 * one:.0f} | {1e9 * other:.0f} | {one / other:.1f} | '
              f'{taken:.1f} |')


if __name__ == '__main__':
    main()
