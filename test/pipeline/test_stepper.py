# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene input by input: status, and what its policy shows where nothing is known."""
from math import inf, isfinite, isnan, nan

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.pipeline.stepper import (
    INVALID_INPUT,
    LOADS_UNKNOWN,
    OK,
    OUT_OF_RANGE,
    RATES_UNKNOWN,
    Stepper,
    Wanted,
)
from fourbar_ros.pipeline.wrenches import UNKNOWN
from fourbar_ros.scene import from_values
import pytest
from support.scenes import RODS

ROCKER = {'linkage.a1': 1.2, 'linkage.a2': 0.4, 'linkage.a3': 0.8, 'linkage.a4': 1.0, **RODS,
          'outputs': ['state', 'loads'], 'external.output.from_topic': True,
          'external.when_silent': 'constant'}
INSIDE = 0.5, 2.0, 3.0


def made(policy='none', **more):
    """Return a scene, its stepper, and the function input -> (status, {name: value})."""
    scene = from_values({**ROCKER, 'drive.out_of_range': policy, **more})
    stepper = Stepper(scene)

    def step(*given):
        status, values = stepper.step(*given, Wanted(True, scene.topics))
        return status, {name: values[i] for name, i in scene.layout.index_of.items()}
    return scene, stepper, step


def plain(scene, *given):
    """Return the values of the library itself."""
    motion, loads = scene.linkage.step(*given)
    return motion._asdict() | loads._asdict()


def beyond(scene):
    """Return an input out of range, near its upper end."""
    return scene.linkage.input_ranges[0][1] + 0.1


def test_within_range_it_is_the_library():
    scene, _, step = made()
    status, values = step(*INSIDE)
    assert status == OK and values == plain(scene, *INSIDE)


@pytest.mark.parametrize(('given', 'expected'), [
    ((1e300, 1.0, 1.0), INVALID_INPUT), ((1e300, nan, 1.0), INVALID_INPUT),
    ((nan, 1.0, 1.0), INVALID_INPUT), ((inf, 1.0, 1.0), INVALID_INPUT),
    ((0.5, inf, 1.0), INVALID_INPUT), ((0.5, 1.0, -inf), INVALID_INPUT),
    ((0.5, nan, inf), INVALID_INPUT), ((0.5, -inf, nan), INVALID_INPUT),
    ((0.5, 1e160, 0.0), INVALID_INPUT),
    ((0.5, nan, 1.0), RATES_UNKNOWN), ((0.5, 1.0, nan), RATES_UNKNOWN)])
@pytest.mark.parametrize('policy', ['none', 'hold', 'clamp'])
def test_the_status_of_bad_inputs(policy, given, expected):
    scene, _, step = made(policy)
    status, values = step(*given)
    assert status == expected
    assert all(isnan(values[name]) for name in scene.linkage.LOADS._fields)
    known = scene.linkage.motion(0.5, 1.0, 0.0)
    if expected == INVALID_INPUT:
        assert isnan(values['theta4'])
    else:                # the pose does not hang on the rates, under any policy
        assert values['theta4'] == pytest.approx(known.theta4, rel=1e-14)
        assert isnan(values['alpha4'])
        assert values['omega4'] == pytest.approx(nan if isnan(given[1]) else known.omega4,
                                                 rel=1e-14, nan_ok=True)


def test_out_of_range_nothing_is_known():
    scene, _, step = made()
    status, values = step(beyond(scene), 1.0, 1.0)
    assert status == OUT_OF_RANGE and isnan(values['theta4']) and isnan(values['f41'])


def test_hold_shows_the_last_good_values():
    scene, stepper, step = made('hold')
    assert isnan(step(beyond(scene), 1.0, 1.0)[1]['theta4'])        # there are none yet
    good = step(*INSIDE)[1]
    for bad, expected in ((beyond(scene), OUT_OF_RANGE), (nan, INVALID_INPUT)):
        assert step(bad, 1.0, 1.0) == (expected, good)
    assert step(0.5, nan, 1.0)[0] == RATES_UNKNOWN
    assert step(beyond(scene), 1.0, 1.0)[1] == good                 # rates unknown are not good
    stepper.act('output', UNKNOWN)
    status, newer = step(0.4, 1.0, 1.0)
    assert status == LOADS_UNKNOWN and isnan(newer['f41'])
    assert newer['theta4'] == plain(scene, 0.4, 1.0, 1.0)['theta4']
    held = step(beyond(scene), 1.0, 1.0)[1]                         # a pose without loads is good
    assert held['theta4'] == newer['theta4'] and isnan(held['f41'])


def test_clamp_shows_the_pose_at_the_nearest_limit():
    scene, _, step = made('clamp')
    low, high = scene.linkage.input_ranges[0]
    for place, limit in ((high + 0.1, high), (low - 0.1, low)):
        status, values = step(place, 1.0, 1.0)
        near = scene.linkage.motion(limit + (-1e-9 if limit == high else 1e-9))
        assert status == OUT_OF_RANGE
        # next to a toggle the output moves as the root of the distance
        assert values['theta4'] == pytest.approx(near.theta4, abs=10.0 * 1e-9**0.5)
        assert all(isnan(values[name]) for name in ('omega4', 'alpha4', 'f41', 'condition'))


def test_what_a_simulator_carries_is_a_number_or_refused():
    heavy = {name: value for name, value in ROCKER.items() if not name.startswith('bodies')}
    heavy |= {f'bodies.{link}.{name}': value for link in ('crank', 'coupler', 'output')
              for name, value in (('mass', 1e300), ('cg_along', 1e5), ('inertia', 0.0))}
    with pytest.raises(InvalidParameter, match='base.carried.mean'):
        Stepper(from_values({**heavy, 'base.carried.mean': True}))
    scene = from_values({**heavy, 'outputs': ['state', 'inertia']})
    status, values = Stepper(scene).step(*INSIDE, Wanted(False, scene.topics))
    place = scene.layout.index_of
    assert status == OK and isfinite(values[place['theta4']])
    assert isnan(values[place['rigid inertia']]) and isnan(values[place['rigid mass']])
    _, _, step = made(**{'base.carried.mass': 1e300, 'base.carried.x': 1e150})
    status, values = step(*INSIDE)
    assert status == INVALID_INPUT and isnan(values['shaking_moment'])
    _, _, step = made(**{'base.carried.mean': True})
    status, values = step(*INSIDE)
    assert status == OK and isfinite(values['shaking_moment'])
