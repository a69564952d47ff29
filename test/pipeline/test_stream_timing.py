# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Streams with drops, bursts, pauses, late samples and clocks that are set, against the true motion.

A rate that is answered with STATUS_OK must be right to what the estimator promises. For a fit with
weights w, of samples that are e off, of a motion whose third derivative is at most j:

    |slope error| <= sum |w| (e + j |t|^3 / 6),   e = |V| |d - d0| + dx

where d is the error of a stamp, V the largest velocity, dx the rounding of a position.
"""
from collections import Counter, defaultdict
from dataclasses import replace
from itertools import product
import math

from fourbar_ros.pipeline.joints import Scale
from fourbar_ros.pipeline.rate_estimator import estimator_of
from fourbar_ros.pipeline.stepper import evaluate, OK, RATES_UNKNOWN
from fourbar_ros.scene import scene
from hypothesis import given
import numpy as np
from support.scenes import PAPER
from support.strategies import seeds

EPS, NS = np.finfo(float).eps, 1e-9
PERIODS = 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.25       # [s] between samples
SAMPLES = 24
SCENE = scene.from_values({**PAPER, 'drive.source': 'motion'})
KINDS = list(product(('motion', 'joint_state'), ('never', 'always', 'sometimes'),
                     (('counted', 1.0), ('counted', 2.0), ('counted', -60.0), ('wrapped', 1.0),
                      ('wrapped', -1.0))))


class Truth:
    """A crank that turns and swings: x = start + speed t + sum of size sin(w t + phase)."""

    def __init__(self, rng):
        """Choose a motion; ``most``: bounds of the first, second and third derivative."""
        self._start = rng.uniform(-3.0, 3.0)
        self._speed = rng.choice([0.0, 1.0, -1.0]) * 10.0**rng.uniform(-1.0, 1.7)
        self._w = 10.0**rng.uniform(-1.0, 1.0, 2)
        self._size = rng.uniform(0.0, 1.0, 2) * rng.choice([0.0, 1.0]) / self._w
        self._phase = rng.uniform(0.0, math.tau, 2)
        self.most = [float(self._size @ self._w**k) + (abs(self._speed) if k == 1 else 0.0)
                     for k in (1, 2, 3)]

    def __call__(self, t):
        """Return position, velocity, acceleration at times, shape (n,)."""
        angle = self._w * np.asarray(t)[:, None] + self._phase
        sine, cosine = np.sin(angle) @ self._size, np.cos(angle)
        return (self._start + self._speed * t + sine,
                self._speed + cosine @ (self._size * self._w),
                -np.sin(angle) @ (self._size * self._w**2))


def timing(rng, seen):
    """Return true times [ns] and stamps [ns] of a stream, in the order in which they come."""
    h = rng.choice(PERIODS)
    steps = np.full(SAMPLES, h)
    error = np.zeros(SAMPLES)
    troubles = rng.random(7) < 0.3
    drops, bursts, pauses, jitter, late, clock, twice = troubles
    seen.update(np.flatnonzero(troubles).tolist())
    if drops:
        steps *= rng.geometric(0.7, SAMPLES)
    if bursts:
        steps[rng.random(SAMPLES) < 0.3] = rng.choice([1e-6, 1e-5, 1e-4])
    if pauses:
        steps[rng.integers(0, SAMPLES, 2)] = rng.uniform(0.02, 1.3, 2)
    times = np.rint(np.cumsum(steps) / NS).astype(np.int64)
    if jitter:
        error += rng.uniform(-1.0, 1.0, SAMPLES) * h * rng.choice([1e-4, 0.01, 0.3])
    if clock:
        error[rng.integers(SAMPLES):] += rng.choice([-1, 1]) * 10.0**rng.uniform(-3.0, 0.5)
    stamps = times + np.rint(error / NS).astype(np.int64)
    order = np.arange(SAMPLES, dtype=float)
    if late:
        order[rng.random(SAMPLES) < 0.15] += rng.choice([1.5, 3.5])
    order = np.argsort(order, kind='stable')
    if twice:
        order = np.repeat(order, 1 + (rng.random(SAMPLES) < 0.2))
    return times[order], stamps[order]


def bounds(ages, errors, most, degree):
    """
    Return bounds of the error of the highest derivatives at age 0, shape (m, degree).

    ``ages`` [s] and ``errors`` of the samples have shape (m, n); ``most``: largest derivative of
    order degree + 1 of what is fitted, shape (m,).
    """
    unit = np.abs(ages).max(axis=1, keepdims=True)
    powers = (ages / unit)[:, :, None]**np.arange(degree + 1)
    weights = np.abs(np.linalg.pinv(powers))[:, 1:]                  # of derivatives, scaled
    off = errors + most[:, None] * np.abs(ages)**(degree + 1) / math.factorial(degree + 1)
    order = np.arange(1, degree + 1)
    return (weights @ off[:, :, None])[:, :, 0] * np.array([1.0, 2.0])[:degree] / unit**order


class Answers:
    """The answers with STATUS_OK of many streams, beside the truth."""

    def __init__(self):
        self.seen = Counter()            # statuses, and numbers of troubles
        # by (degree of the fit, its points): [ages, errors], largest derivative, what is off
        self._cases = defaultdict(list)

    def run(self, rng, kind):
        """Feed one stream of a kind to the estimator of its scene."""
        source, given, (turns, ratio) = kind
        truth, ratio = Truth(rng), ratio if source == 'joint_state' else 1.0
        true_times, stamps = timing(rng, self.seen)
        top_speed = math.nan
        if turns == 'wrapped':
            top_speed = truth.most[0] * rng.choice([1.0, 3.0]) + 1e-9
        its_scene = replace(SCENE, drive=SCENE.drive._replace(
            source=source, joint_ratio=ratio, window=int(rng.choice([3, 5, 9])),
            top_speed=top_speed))
        estimator = estimator_of(its_scene)
        motion = np.array(truth(true_times * NS))
        joint = ratio * motion[0]
        if turns == 'wrapped':
            begin = rng.choice([0.0, math.pi])
            joint = (joint + begin) % math.tau - begin
        is_given = rng.random(len(stamps)) < {'never': 0.0, 'always': 1.0, 'sometimes': 0.5}[given]
        errors, first = (stamps - true_times) * NS, {}
        for k, stamp in enumerate(stamps.tolist()):
            sent = joint[k], ratio * motion[1, k] if is_given[k] else math.nan, math.nan
            x, v, _ = map(float, Scale(ratio, 0.0).to_input(*sent))
            if not estimator._samples or stamp != estimator._samples[-1].time:
                first[stamp] = k                 # of samples with one stamp the first counts
            found, at = estimator.update(stamp, x, v), first[stamp]
            status = RATES_UNKNOWN
            if np.isfinite(found).all():
                status = evaluate(its_scene.linkage, x, *found, False)[0]
                fitted = [first[sample.time] for sample in estimator._samples]
                if is_given[at]:
                    fitted = [i for i in fitted if is_given[i]]
                fitted = fitted[-estimator._fit._n:]
                self._take(truth, (stamps[fitted] - stamp) * NS, errors[fitted] - errors[at],
                           motion[:, at], found, is_given[at], kind)
            self.seen[status] += 1

    def _take(self, truth, ages, errors, true, found, from_rates, kind):
        """Keep one answer."""
        degree, speed = (1, truth.most[1]) if from_rates else (2, truth.most[0])
        digits = 16.0 * EPS * (truth.most[0] if from_rates else 10.0 + truth.most[0] * 60.0)
        off = [found[1] - true[2]] if from_rates else [found[0] - true[1], found[1] - true[2]]
        self._cases[degree, len(ages)].append(
            (ages, speed * np.abs(errors) + digits, truth.most[2], np.abs(off), kind))

    def wrong(self):
        """Return the kinds of answers that are further off than they may be, counted."""
        found = Counter()
        for (degree, _), cases in self._cases.items():
            ages, errors, most, off, kinds = zip(*cases)
            is_wrong = np.array(off) > bounds(np.array(ages), np.array(errors), np.array(most),
                                              degree)
            found.update(kinds[i] for i in np.flatnonzero(is_wrong.any(axis=1)))
        self._cases.clear()
        return found


@given(seeds)
def test_no_rate_with_status_ok_is_wrong_beyond_lag_and_noise(seed):
    rng, answers = np.random.default_rng(seed), Answers()
    for kind in KINDS:
        answers.run(rng, kind)
    assert not answers.wrong()
    assert answers.seen[OK] > answers.seen[RATES_UNKNOWN]
