# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Points on which dyads hang, by name: they stand once, move every dyad, and mistakes are said."""
from math import hypot, nan

from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.study import from_document
from fourbar_ros import find_extrema
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.scene import from_values, read_values
from fourbar_ros.scene.files import flatten, parse
import numpy as np
import pytest

JANSEN = read_values('jansen')
POINTS = 'linkage.points.'
# b, d, e and g, h, i of Jansen [m]
SIDES = {POINTS + 'hip.distance_1': 0.401, POINTS + 'hip.distance_2': 0.558}


def changed(**values):
    """Return Jansen's leg with other values of named points; None: not given."""
    named = {name.replace('__', '.'): value for name, value in values.items()}
    named = {name if name.startswith('dyads') else POINTS + name: value
             for name, value in named.items()}
    return {name: value for name, value in {**JANSEN, **named}.items() if value is not None}


def by_links():
    """Return Jansen's leg as scenes were written before: each end with its link."""
    points = {'pin': ('crank', 0.15, 0.0), 'pivot': ('ground', -0.38, -0.078),
              'hip': ('hip', JANSEN[POINTS + 'hip.along'], JANSEN[POINTS + 'hip.across']),
              'knee': ('c', 0.393, 0.0)}
    values = {}
    for name, value in JANSEN.items():
        if name.endswith(('.first', '.second')):
            values |= {f'{name}.{field}': of for field, of in zip(
                ('link', 'along', 'across'), points[value])}
        elif not name.startswith(POINTS):
            values[name] = value
    return values


def test_named_points_are_those_of_links_to_the_last_bit():
    assert from_values(JANSEN).linkage == from_values(by_links()).linkage


def test_a_point_that_moves_takes_all_its_dyads_along():
    machine = from_values(changed(pivot__x=-0.37, dyads__lower__length_2=0.4)).linkage
    upper, lower, leg = machine.dyads
    assert upper.second == lower.second == ('ground', -0.37, -0.078)
    assert leg.second == ('c', 0.4, 0.0) and lower.length_2 == 0.4
    live = from_values(JANSEN).with_values({POINTS + 'pivot.x': -0.37,
                                            'dyads.lower.length_2': 0.4})
    assert live.linkage == machine
    assert from_values(live.values).linkage == machine
    text = flatten(parse(live.as_text)['/**']['ros__parameters'])
    assert from_values(text).linkage == machine


@pytest.mark.parametrize('side, sign', [('left', 1.0), ('right', -1.0)])
def test_a_triangle_is_given_by_its_three_sides(side, sign):
    values = changed(hip__along=None, hip__across=None, hip__side=side) | SIDES
    machine = from_values(values).linkage
    motion = machine.motion(0.4)
    start, end, point = (np.array(point_motion(machine, motion, 'hip', *place).place)
                         for place in ((0.0, 0.0), (0.415, 0.0), machine.dyads[2].first[1:]))
    assert hypot(*(point - start)) == pytest.approx(0.401, rel=1e-15)
    assert hypot(*(point - end)) == pytest.approx(0.558, rel=1e-15)
    assert sign * np.linalg.det([end - start, point - start]) > 0.0
    across = abs(machine.dyads[2].first.across)
    assert across == pytest.approx(JANSEN[POINTS + 'hip.across'], rel=4e-16)


def test_studies_vary_named_points_as_other_parameters(tmp_path):
    file = tmp_path / 'leg.yaml'
    file.write_text(from_values(changed(hip__along=None, hip__across=None, hip__side='left')
                                | SIDES).as_text, encoding='utf-8')
    study = from_document({
        'scene': str(file), 'method': 'random', 'rows': 3, 'quantities': ['omega_foot.max'],
        'vary': {POINTS + 'pivot.x': {'range': [-0.385, -0.375]},
                 POINTS + 'hip.distance_2': {'range': [0.55, 0.56]},
                 'dyads.lower.length_2': {'range': [0.39, 0.395]}}})
    drawn = study.drawn(0, 3)
    most = [max(extremum.value for extremum in find_extrema(
        from_values(study.values | {name: float(column[i]) for name, column in drawn.items()}
                    ).linkage, ('omega_foot',), rate=4.0)) for i in range(3)]
    assert compute(study, 0).columns['omega_foot.max'] == pytest.approx(most, rel=1e-12)


MISTAKES = [
    ({'dyads__leg__first': 'hop'}, 'dyads.leg.first = .hop.: .* did you mean hip'),
    ({'dyads__leg__first__along': 0.1}, 'dyads.leg.first.along = 0.1: stands twice'),
    ({'hip__link': 'foot'}, 'points.hip = .foot.: .*its own link .dyads.leg.first'),
    ({'hip__link': 'hop'}, 'points.hip = .hop.: there is no such link'),
    ({'pin__link': 'c'}, r'points.pin = .c.: is a link of dyad lower, .*\(dyads.upper.first'),
    ({'pin__x': 0.1}, 'points.pin: stands twice'),
    ({'hip__distance_1': 0.1}, 'points.hip: stands twice'),
    ({'pin__link': None}, 'points.pin.link: must be given'),
    ({'pivot__x': None, 'pivot__y': None, 'pivot__side': 'left'}, 'points.pivot.link: must be gi'),
    ({'knee__distance_1': 0.1}, 'points.knee.side: must be left or right'),
    ({'hip__side': 'left'}, 'points.hip.side = .left.: must be left or right, with'),
    ({'knee__distance_1': 0.1, 'knee__distance_2': 0.9, 'knee__side': 'left'},
     'knee.distance_2 = 0.9: makes no triangle with .* = 0.1 and dyads.lower.length_2 = 0.393'),
    ({'knee__distance_2': None, 'knee__distance_1': 0.1}, 'knee.distance_1: give along'),
    ({'pin__along': None, 'pin__distance_2': 0.1}, 'pin.distance_2: .*crank is no rod'),
    ({'ankle__x': 0.1}, 'points.ankle: no dyad hangs on this point'),
    ({'hip__alnog': 0.1}, 'points.hip.alnog = 0.1: .* did you mean along'),
    ({'pivot__x': 1e200}, 'points.pivot = 1e.200: must be between'),
    ({'pivot__x': nan, 'pivot__y': nan}, 'points.pivot.link: must be given'),
]


@pytest.mark.parametrize(('values', 'text'), MISTAKES)
def test_mistakes_are_said_in_one_line(values, text):
    with pytest.raises(InvalidParameter, match=text) as error:
        from_values(changed(**values))
    assert '\n' not in str(error.value)


def test_a_kind_has_no_such_points():
    with pytest.raises(InvalidParameter, match='linkage.kind machine alone has'):
        from_values({**read_values('paper'), POINTS + 'C.x': 0.1})
