# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of one source at a time.

Each body alone, gravity on it alone, each external load alone, of any size.

With everything acting the condition is large, and what cancels within one source does not show.
The condition counts all that is given: lengths, input with its rate and acceleration, masses,
centres of gravity, inertias, gravity and external loads. The largest of all forces counts, and of
all moments, as they add up to each other.
"""

from fourbar_ros import Applied, Bodies, Body, External, FourBar, FourBarError
from fourbar_ros.bag import recompute
from fourbar_ros.bag.origin import origin_of
import mpmath as mp
import numpy as np
import pytest
from support import DATA, reference, slider_reference
from support.reference import condition, EPS
from support.samples import some
from support.slider_reference import pieces

KINDS = {'four-bar': FourBar, **{f'{kind.__name__} driven at its {driven}': (kind, driven)
                                 for kind, driven in slider_reference.KINDS}}
LINKS = {'crank': 0, 'coupler': 1, 'output': 2}
SOURCES = ([(what, link) for what in ('body', 'point mass', 'inertia', 'weight') for link in LINKS]
           + [(what, link) for what in ('force', 'couple') for link in ('coupler', 'output')])
BOUND = 5.0               # eps cond
POWERS = (0.5, 2.0, 8.0)  # of ten, of the ratio of the longest to the shortest link
# a condition below this part of the largest: zero but for the reference's rounding
NOTHING = mp.mpf(10)**-60


def lengths_of(rng, kind, power):
    """Return random lengths that close: four, or two and an offset of either sign or none."""
    while True:
        lengths = 10.0**rng.uniform(-0.5 * power, 0.5 * power, 4 if kind is FourBar else 3)
        if kind is FourBar:
            order = np.argsort(lengths)
            if rng.random() < 0.7:
                lengths[order[2]] = (lengths[order[3]]
                                     + rng.uniform(-1.0, 1.0) * lengths[order[:2]].sum())
            if lengths.min() > 0.0 and 2.0 * lengths.max() < lengths.sum():
                return tuple(lengths.tolist())
        elif lengths[2] < lengths[0] + lengths[1]:
            lengths[2] *= rng.choice((-1.0, 0.0, 1.0), p=(0.4, 0.2, 0.4))
            return tuple(lengths.tolist())


def draw(rng, kind, power):
    """
    Return lengths, mode and input of a mechanism that closes.

    A third without acceleration, a fifth at rest.
    """
    while True:
        lengths, mode = lengths_of(rng, kind, power), int(rng.integers(1, 3))
        mechanism = built(kind, lengths, mode, np.zeros(24).tolist())
        low, high = mechanism.input_ranges[rng.integers(len(mechanism.input_ranges))]
        position = float(rng.uniform(low, high) if rng.random() < 0.8 else
                         rng.choice((-1.0, 1.0)) * 10.0**rng.uniform(-power, 0.0))
        given = (position, *(0.0, 0.0)) if rng.random() < 0.2 else (
            position, float(rng.normal()), float(rng.normal()) * (rng.random() < 0.7))
        try:
            mechanism.motion(*given)
        except FourBarError:
            continue
        return lengths, mode, given


def values_of(rng, what, link, lengths):
    """Return 24 numbers for :func:`pieces` with one source, of any size, acting."""
    i, values = LINKS[link], [0.0] * 24
    size = (max(map(abs, lengths)) if rng.random() < 0.5
            else min(lengths[:2])) * 10.0**rng.uniform(-8.0, 1.0)
    if what in ('body', 'point mass', 'weight'):
        values[4 * i] = 10.0**rng.uniform(-3.0, 3.0)
    if what in ('body', 'weight'):
        values[4 * i + 1:4 * i + 4] = [*(size * rng.normal(size=2)),
                                       values[4 * i] * size**2 * rng.uniform()]
    if what == 'weight':
        values[22:24] = rng.normal(0.0, 10.0, 2)
    if what == 'inertia':
        values[4 * i + 3] = 10.0**rng.uniform(-3.0, 3.0)
    if what == 'force':
        values[7 + 5 * i:11 + 5 * i] = [*rng.normal(0.0, 5.0, 2), *(size * rng.normal(size=2))]
    if what == 'couple':
        values[11 + 5 * i] = rng.normal(0.0, 5.0)
    return [float(value) for value in values]


def built(kind, lengths, mode, values):
    if kind is not FourBar:
        return slider_reference.build(kind, lengths, mode, values)
    bodies, applied, gravity = pieces(values)
    return FourBar(*lengths, mode=mode, gravity=tuple(gravity),
                   bodies=Bodies(*(Body(*b) for b in bodies)),
                   external=External(*(Applied(*a) for a in applied)))


def truth_of(kind, lengths, mode, given, values):
    """Return the names of the loads, their values to many digits, and their conditions."""
    sign = 2 * mode - 3
    if kind is FourBar:
        names, angle = reference.LOAD_NAMES, []

        def exact(v):
            return reference.loads_of(v[3:7], sign, *v[:3], *pieces(v[7:]))
    else:
        # the first value of condition() is an angle, counted modulo full turns: of a driven slide
        # there is none
        names, angle = slider_reference.LOADS, [] if kind[1] == 'crank' else [0.0]
        k = len(angle)

        def exact(v):
            return slider_reference.loads_of(kind, v[k + 3:k + 6], sign, v[k:k + 3],
                                             *pieces(v[k + 6:]))
    return names, *condition(exact, [mp.mpf(v) for v in (*angle, *given, *lengths, *values)])


def errors(kind, lengths, mode, given, values):
    """
    Return {name: error in eps times the largest condition of its sort}.

    A moment is a sum of moments and of forces at arms as long as the links.
    """
    loads, found = built(kind, lengths, mode, values).loads(*given), {}
    names, truth, conditions = truth_of(kind, lengths, mode, given, values)
    is_slide = kind is not FourBar and kind[1] == 'slide'
    for name, true in zip(names, truth):
        value = (mp.mpc(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
                 if isinstance(true, mp.mpc) else
                 mp.mpf(loads.driving_torque + loads.driving_force if name == 'drive'
                        else getattr(loads, name)))
        arm = max(map(abs, lengths)) if is_moment(name, is_slide) else 1
        largest = max(cond if is_moment(other, is_slide) else arm * cond
                      for other, cond in zip(names, conditions)
                      if is_moment(name, is_slide) or not is_moment(other, is_slide))
        if largest > NOTHING * max(conditions):
            found[name] = float(abs(value - true) / (EPS * largest))
    return found


def is_moment(name, is_slide):
    """Return whether a load of a reference is a moment [N m]."""
    return (name.endswith(('couple', 'moment', 'torque')) or name == 'drive' and not is_slide)


def check(name, power, seed, count):
    kind, rng, bad = KINDS[name], np.random.default_rng(seed), {}
    for _ in range(count):
        lengths, mode, given = draw(rng, kind, power)
        for source in SOURCES:
            for load, error in errors(kind, lengths, mode, given,
                                      values_of(rng, *source, lengths)).items():
                if not error <= BOUND:
                    bad[(*source, load)] = error
    assert bad == {}


@some('power', POWERS, 1)
@pytest.mark.parametrize('name', KINDS)
def test_each_source_alone(name, power):
    check(name, power, 501, 1)


def test_a_bag_recorded_with_other_sums_of_the_loads_recomputes_to_their_rounding():
    """
    Recorded before the kinds were machines of one dyad: all differs by rounding.

    Accelerations are of the size of the squared speed of the crank.
    """
    bag = str(DATA / 'paper')
    scene = origin_of(bag).scene
    loads = scene.linkage.loads(np.linspace(0.0, 2.0 * np.pi, 721), 25.0)
    force = max(np.abs(loads.f41).max(), np.abs(loads.f43).max())
    for topic, field, messages, largest in recompute(bag).differences:
        is_load = topic.endswith(('/loads', '/shaking_wrench')) or field == 'effort'
        size = 4.0 * force if is_load else 16.0 * 25.0**2
        assert messages > 200 and largest <= EPS * size, (topic, field)
