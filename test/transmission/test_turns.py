# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Wrapped angles: turns from stamps and speeds, over messages of any cut, and what is refused."""
from math import pi

from fourbar_ros.ros.node.trajectories import count, Samples
from fourbar_ros.transmission import CannotFollow
import numpy as np
import pytest

WRAPS = {'[-pi, pi]': lambda x: (x + pi) % (2.0 * pi) - pi, '[0, 2 pi]': lambda x: x % (2.0 * pi)}


def motion(times, rng):
    """Return a smooth motion with turns: positions and rates."""
    speed, swing, rate = rng.uniform(-8.0, 8.0), rng.uniform(0.0, 1.0), rng.uniform(0.1, 2.0)
    return (speed * times + swing * speed / rate * np.sin(rate * times),
            speed * (1.0 + swing * np.cos(rate * times)))


def streamed(times, positions, rates, sizes):
    """Return the positions counted in messages of these sizes."""
    found, last, place = [], None, 0
    while place < len(times):
        cut = slice(place, place + sizes[len(found) % len(sizes)])
        last = count(Samples(times[cut], positions[cut], rates[cut]), last)
        found.append(last.positions)
        place = cut.stop
    return np.concatenate(found)


@pytest.mark.parametrize('sizes', [[1], [1, 7, 2], [1000]])
@pytest.mark.parametrize('wrap', WRAPS)
def test_wrapped_motions_are_unwrapped_whatever_the_messages(wrap, sizes):
    rng = np.random.default_rng(7)
    for _ in range(20):
        times = np.cumsum(rng.uniform(0.002, 0.05, 300))
        x, rates = motion(times, rng)
        found = streamed(times, WRAPS[wrap](x), rates, sizes)
        turns = (found - x) / (2.0 * pi)
        assert np.abs(turns - turns[0]).max() <= 1e-12


def test_turns_that_are_written_out_stay_and_none_are_added():
    """What leaves one turn counts its turns itself, in whatever steps and at whatever speeds."""
    rng = np.random.default_rng(8)
    for _ in range(200):
        positions = np.concatenate([[7.0, -7.0], rng.uniform(-50.0, 50.0, 20)])
        given = Samples(np.arange(22.0), positions, rng.normal(size=22))
        assert (count(given).positions == positions).all()


@pytest.mark.parametrize('rates', [(0.0, 0.0), (1e-17, 1e-17), (0.5, -0.5), (0.0, 3.0),
                                   (1e-3, 1e-3)])
@pytest.mark.parametrize('to', [-3.1, 0.1, 3.1])
def test_a_move_from_rest_to_rest_is_taken_as_it_says(rates, to):
    given = Samples(np.array([0.0, 1.0]), np.array([3.1, to]), np.array(rates))
    assert (count(given).positions == given.positions).all()


def test_a_wrap_between_coarse_points_is_counted_by_their_speeds():
    given = Samples(np.array([0.0, 1.0, 2.0]), np.array([0.5, -0.05, -0.6]), np.full(3, 12.0))
    assert count(given).turns.tolist() == [0.0, 2.0, 4.0]


@pytest.mark.parametrize('positions, rate', [([0.0, 3.0], 9.0), ([0.0, -0.5], 3.0),
                                             ([0.0, 2.5], -2.0)])
def test_what_fits_its_speeds_in_no_way_is_refused_with_the_way(positions, rate):
    given = Samples(np.array([0.0, 1.0]), np.array(positions), np.full(2, rate))
    with pytest.raises(CannotFollow, match=f'sample 1: from 0 to {positions[1]:g} rad in 1 s, at '
                                           f'{rate:g} and {rate:g} rad/s, .* about {rate:g} rad'):
        count(given)


def test_plans_that_overlap_go_on_where_the_last_one_stood_then():
    """A horizon of a second, planned anew ten times a second, over many turns."""
    wrap, speed, last = WRAPS['[-pi, pi]'], 5.0, None
    for k in range(100):
        times = 0.1 * k + np.linspace(0.0, 1.0, 21)
        last = count(Samples(times, wrap(speed * times), np.full(21, speed)), last)
        assert np.abs(last.positions - speed * times).max() <= 1e-12


def test_arrival_may_jitter_where_messages_have_no_stamps():
    rng, wrap, last, found = np.random.default_rng(9), WRAPS['[0, 2 pi]'], None, []
    times = np.arange(2000) * 0.005
    came = np.maximum.accumulate(times + rng.uniform(0.0, 0.05, 2000))
    for t, x in zip(came, 6.0 * times):
        last = count(Samples(np.array([t]), np.array([wrap(x)]), np.array([6.0])), last)
        found.append(last.positions[0])
    assert np.abs(found - 6.0 * times).max() <= 1e-11


def test_numbers_at_their_ends_neither_raise_nor_count():
    rng = np.random.default_rng(10)
    edges = [0.0, -0.0, 5e-324, 1e308, -1e308, pi, -pi, 1e-17, 3.0]
    for _ in range(2000):
        size = rng.integers(1, 5)
        given = Samples(*(rng.choice(edges, size) for _ in range(3)))
        try:
            found = count(given, count(Samples(*(rng.choice(edges, 1) for _ in range(3)))))
        except CannotFollow:
            continue
        assert np.isfinite(found.turns).all()
