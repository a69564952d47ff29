# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of one source at a time: each body alone, gravity on it, each external load, of any size.

With everything acting the condition is large, and what cancels within one source does not show.
Of all forces the largest condition counts, and of all moments, as they add up to each other.
"""
from dataclasses import replace

from flint import ctx
from fourbar_ros import Applied, Body
from fourbar_ros.bag import recompute
from fourbar_ros.bag.origin import origin_of
import numpy as np
import pytest
from support import contract, DATA
from support.cartesian import BITS, conditions, EPS, exact, off
from support.samples import more

SOURCES = ([(what, link) for what in ('body', 'point mass', 'inertia', 'weight')
            for link in ('crank', 'coupler', 'output')]
           + [(what, link) for what in ('force', 'couple') for link in ('coupler', 'output')])
BOUND = 5.0               # eps cond


def with_source(rng, mechanism, what, link):
    """Return the mechanism with one source, of any size, acting."""
    lengths = mechanism.lengths
    size = (max(map(abs, lengths)) if rng.random() < 0.5
            else min(lengths[:2])) * 10.0**rng.uniform(-8.0, 1.0)
    along, across = (size * rng.normal(size=2)).tolist()
    mass, gravity = float(10.0**rng.uniform(-3.0, 3.0)), (0.0, 0.0)
    body, applied = Body(0.0), Applied()
    if what in ('body', 'weight'):
        body = Body(mass, cg_along=along, cg_across=across,
                    inertia=float(mass * size**2 * rng.uniform()))
    if what == 'weight':
        gravity = tuple(rng.normal(0.0, 10.0, 2).tolist())
    if what == 'point mass':
        body = Body(mass)
    if what == 'inertia':
        body = Body(0.0, inertia=mass)
    if what == 'force':
        applied = Applied(*rng.normal(0.0, 5.0, 2).tolist(), along=along, across=across)
    if what == 'couple':
        applied = Applied(couple=float(rng.normal(0.0, 5.0)))
    none = mechanism.BODIES(*[Body(0.0)] * len(mechanism.BODIES._fields))
    acting = {link: applied} if link in mechanism.EXTERNAL._fields else {}
    return replace(mechanism, gravity=gravity, bodies=none._replace(**{link: body}),
                   external=mechanism.EXTERNAL(**acting))


def errors(mechanism, given):
    """
    Return {name: error in eps times the largest condition of its sort}.

    A moment is a sum of moments and of forces at arms as long as the links.
    """
    with ctx.workprec(BITS):
        _, loads = conditions(exact(mechanism, given), given)
        ours, wrong = mechanism.loads(*given), {}
        most = max(condition for _, condition in loads.values())
        for name, (true, _) in loads.items():
            arm = max(map(abs, mechanism.lengths)) if is_moment(name) else 1.0
            largest = max(condition if is_moment(other) else arm * condition
                          for other, (_, condition) in loads.items()
                          if is_moment(name) or not is_moment(other))
            if largest > 1e-60 * most:
                wrong[name] = float(abs(off(name, ours, true))) / (EPS * largest)
    return wrong


def is_moment(name):
    """Return whether a load is a moment [N m]."""
    return name.endswith(('couple', 'moment', 'torque'))


@pytest.mark.parametrize('family', ['random', 'link ratios 1e8'])
@contract.every_case
def test_each_source_alone(case, family, request):
    """A third without acceleration, a fifth at rest."""
    contract.expect_lost_digits(request, case, family, more((), (('A', 1), ('A', 2))))
    rng, bad = np.random.default_rng(501), {}
    for _ in range(more(1, 5)):
        lengths, (position, rate, acceleration) = contract.draw(rng, case, family)
        moves = rng.random()
        given = position, rate * (moves > 0.2), acceleration * (moves > 0.5)
        for source in SOURCES:
            mechanism = with_source(rng, case.make(lengths), *source)
            for load, error in errors(mechanism, given).items():
                if not error <= BOUND:
                    bad[(*source, load)] = error
    assert bad == {}


def test_a_bag_recorded_with_other_sums_of_the_loads_recomputes_to_their_rounding():
    """Recorded before kinds were machines of one dyad; accelerations are about speed squared."""
    bag = str(DATA / 'paper')
    scene = origin_of(bag).scene
    loads = scene.linkage.loads(np.linspace(0.0, 2.0 * np.pi, 721), 25.0)
    force = max(np.abs(loads.f41).max(), np.abs(loads.f43).max())
    for topic, field, messages, largest in recompute(bag).differences:
        is_load = topic.endswith(('/loads', '/shaking_wrench')) or field == 'effort'
        size = 4.0 * force if is_load else 16.0 * 25.0**2
        assert messages > 200 and largest <= EPS * size, (topic, field)
