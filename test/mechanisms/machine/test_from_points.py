# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines from the coordinates of joints: public linkages as published, and mistakes by name."""
from itertools import combinations
from math import cos, hypot, sin
import re
from typing import NamedTuple

from fourbar_lab.drawing.labels import labels_of
from fourbar_ros import FourBar
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.machine import Machine
from fourbar_ros.mechanisms.machine.from_points import read_drawing
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.mechanisms.points import point_motion
import numpy as np
import pytest


class Public(NamedTuple):
    """Joints 'A(x,y) ...', links 'AB BCD' with the crank first, ground 'AD', blocks on it."""

    points: str
    links: str
    ground: str
    slides: dict[str, float] = {}

    @property
    def given(self):
        """Return the arguments of Machine.from_points."""
        points = {name: (float(x), float(y)) for name, x, y in re.findall(
            r'(\w)\(([^,]+),([^)]+)\)', self.points)}
        return points, self.links.split(), self.ground, self.slides

    @property
    def options(self):
        """Return points, the crank's pivot first, and options of ``fourbar new --points``."""
        points, links, ground, slides = self.given
        texts = {name: f'{name} {x} {y}' + ' ground' * (name in ground)
                 + (f' slide {slides[name]}rad' if name in slides else '')
                 for name, (x, y) in points.items()}
        pivot = next(joint for joint in links[0] if joint in ground)
        return [texts.pop(pivot), *texts.values()], ['--links', *map('-'.join, links)]


# Templates of PMKS+ (PMKSWeb, template-linkages.ts) in its frame, as its addresses hold them, and
# the six-bar of its issue 92
PUBLIC = {
    '4_bar': Public(
        'A(-3.129,-2.014) B(-2.623,0.902) C(3.009,2.08) D(3.341,-1.646)',
        'AB BC CD', 'AD'),
    'watt_i': Public(
        'A(-1.707,-1.329) B(-2.561,0.62) C(2.397,1.359) D(-1.029,3.555) E(1.989,8.189) '
        'F(7.19,5.177) G(7.543,-2.62)',
        'AB BCD DE EF FCG', 'AG'),
    'watt_ii': Public(
        'A(-2.025,-2.023) B(-3.107,-0.522) C(-0.418,1.356) D(5.531,1.218) E(3.45,-2.882) '
        'F(11.046,1.165) G(11.246,-2.295)',
        'AB BC CDE DF FG', 'AEG'),
    'stephenson_iii': Public(
        'A(-2.201,-2.472) B(-2.458,-0.978) C(3.02,0.126) D(3.258,-1.921) E(-0.195,0.894) '
        'F(0.87,3.181) G(5.504,1.043)',
        'AB BCE CD EF FG', 'ADG'),
    'slider_crank': Public(
        'A(-3.082,-0.038) B(-2.231,2.388) C(2.863,1.15)',
        'AB BC', 'A', {'C': 0.0}),
    'radial_engine': Public(
        'O(0,0) A(1,0) B(0,2.828) C(-1.933,0.628) D(-1.353,-1.862) E(2.044,-2.813) F(3.743,1.216)',
        'OA AB AC AD AE AF', 'O', {'B': 1.571, 'C': 2.827, 'D': 4.02, 'E': 5.341, 'F': 6.597}),
    'chebyshev_straight_line': Public(
        'G(-2,0) A(-1,4.064) B(1,4.064) M(0,4.064) H(2,0)',
        'GB ABM AH', 'GH'),
    'windshield_wiper': Public(
        'O(-3.5,-2.828) A(-3.496,-1.328) B(0.879,-1.796) P(0,0) C(0.659,-1.347) '
        'T(-2.198,4.491) D(6.659,-1.347) Q(6,0) U(3.802,4.491)',
        'OA AB BCPT CD DQU', 'OPQ'),
    'jansen_leg': Public(
        'O(0,0) A(15,0) G(-38,-7.8) B(-24.014,31.272) C(-74.794,8.079) D(-26.952,-45.515) '
        'E(-59.232,-28.053) F(-43.16,-91.757)',
        'OA AB GBC AD GD CE DEF', 'OG'),
    'pedaling_leg': Public(
        'B(0,0) P(1.7,0) H(-1.5,5.8) K(2.437,4.338)',
        'HK KP BP', 'BH'),
    'pumpjack': Public(
        'A(-2.699,-3.218) M(-1.699,-3.201) P(-2.5,0) S(0,0) H(3.2,0) R(3.4,-2.592)',
        'PSH AM MP HR', 'AS', {'R': 1.571}),
    'derrick_crane': Public(
        'O(0,0) C(1.721,2.457) T(3.441,4.915) G(2.2,-0.6) K(1.459,0.072)',
        'GK CK OCT', 'OG'),
    'issue_92': Public(
        'A(-3.74,-2.41) B(-2.72,.91) C(1.58,.43) D(-.24,4.01) E(5.08,5.31) F(8.14,3.35) '
        'G(7.32,-3.51)', 'AB BCD DE CFG EF', 'AG'),
}


@pytest.mark.parametrize('name', PUBLIC)
def test_public_linkages_are_entered_without_a_calculation(name):
    """It is drawn as published, and no link changes its shape when it moves."""
    points, links, ground, slides = PUBLIC[name].given
    drawing = read_drawing(points, links, ground, slides)
    machine, origin = drawing.machine, np.array(points[next(
        joint for joint in links[0] if joint in ground)])
    drawn = {joint: np.array(place) - origin for joint, place in points.items()}
    size = max(hypot(*place) for place in drawn.values())

    def pose(x):
        motion = machine.motion(x)
        return {joint: np.array([along, across] if link == 'ground' else point_motion(
            machine, motion, link, along, across).place)
            for joint, (link, along, across) in drawing.joints.items()}
    for joint, place in pose(drawing.start).items():
        assert hypot(*(place - drawn[joint])) < 1e-9 * size, joint
    low, high = next(ends for ends in machine.closing_ranges
                     if ends[0] <= drawing.start <= ends[1])
    for x in low + (high - low) * np.linspace(0.01, 0.99, 9):
        moved = pose(x)
        for link in links:
            for one, two in combinations(link, 2):
                error = hypot(*(moved[one] - moved[two])) - hypot(*(drawn[one] - drawn[two]))
                assert abs(error) < 1e-9 * size, (link, one, two)
        for joint, angle in slides.items():
            way = moved[joint] - drawn[joint]
            assert abs(way @ (-sin(angle), cos(angle))) < 1e-9 * size, joint


@pytest.mark.parametrize('name', PUBLIC)
def test_pictures_have_the_letters_of_the_drawing(name):
    points, links, ground, slides = PUBLIC[name].given
    drawing = read_drawing(points, links, ground, slides)
    letters = labels_of(diagram_of(drawing.machine, drawing.machine.motion(drawing.start))).joints
    origin, = (points[joint] for joint in links[0] if joint in ground)
    size = max(map(hypot, *zip(*points.values())))
    assert {*letters} >= {joint for joint in points if sum(joint in link for link in links) > 1}
    for joint, place in letters.items():
        assert hypot(*(place + origin - points[joint])) < 1e-9 * size, joint


def test_their_ranges_are_the_published_ones():
    machine, leg = (Machine.from_points(*PUBLIC[name].given[:3])
                    for name in ('issue_92', 'jansen_leg'))
    assert machine.closing_ranges[1] == pytest.approx((1.174320968, 1.365792549), abs=5e-10)
    # two of his holy numbers, from coordinates of three digits behind the point
    assert [leg.dyads[0].length_1, leg.dyads[2].length_2] == pytest.approx([50.0, 36.7], abs=1e-3)


@pytest.mark.parametrize('mode', [1, 2])
def test_modes_are_read_from_the_drawing(mode):
    four_bar = FourBar(0.4, 1.2, 0.8, 1.0, mode=mode)
    theta1 = 0.7
    theta4 = four_bar.motion(theta1).theta4
    points = {'O1': (0.0, 0.0), 'A': (0.4 * cos(theta1), 0.4 * sin(theta1)), 'O4': (1.0, 0.0),
              'B': (1.0 + 0.8 * cos(theta4), 0.8 * sin(theta4))}
    links = [('O1', 'A'), ('A', 'B'), ('B', 'O4')]
    machine = Machine.from_points(points, links, ('O1', 'O4'))
    assert machine.dyads[0].mode == mode
    turned = {name: (3.0 - y, 2.0 + x) for name, (x, y) in points.items()}
    again = Machine.from_points(turned, links, ('O1', 'O4'))
    assert again.dyads[0].mode == mode and again.dyads[0].second[1:] == pytest.approx((0.0, 1.0))


def test_a_flat_drawing_asks_for_the_mode():
    points = {'O1': (0.0, 0.0), 'A': (0.0, 0.2), 'B': (0.5, 0.2), 'O4': (0.9, 0.201)}
    links = [('O1', 'A'), ('A', 'B'), ('B', 'O4')]
    with pytest.raises(InvalidParameter, match='modes.B: must be given, 1 or 2: .* too flat'):
        Machine.from_points(points, links, ('O1', 'O4'))
    for mode in 1, 2:
        machine = Machine.from_points(points, links, ('O1', 'O4'), modes={'B': mode})
        assert machine.dyads[0].mode == mode


def test_a_parallelogram_is_read_on_both_sides_of_its_flat_position():
    for angle in (0.6, -0.6, 2.5, 4.0):
        at = np.array([cos(angle), sin(angle)])
        machine = Machine.from_points(
            {'O': (0, 0), 'A': 0.2 * at, 'B': 0.2 * at + (0.5, 0.0), 'C': (0.5, 0.0)},
            ['OA', 'AB', 'BC'], 'OC')
        assert machine.dyads[0].mode == 2


@pytest.mark.parametrize('links', [['O2A', 'AB', 'BO4'], ['O2-A', 'A-B', 'B-O4'],
                                   [('O2', 'A'), ['A', 'B'], ('B', 'O4')]])
def test_names_of_two_letters_are_told_apart(links):
    points = {'O2': (0, 0), 'A': (1, 2), 'B': (4, 3), 'O4': (5, 0)}
    machine = Machine.from_points(points, links, 'O2O4' if 'O2A' in links else ('O2', 'O4'))
    plain = {'P': (0, 0), 'A': (1, 2), 'B': (4, 3), 'Q': (5, 0)}
    same = Machine.from_points(plain, ['PA', 'AB', 'BQ'], 'PQ')
    assert [dyad.lengths for dyad in machine.dyads] == [dyad.lengths for dyad in same.dyads]


def test_a_point_may_have_the_letters_of_two_as_its_name():
    points = {'O': (0, 0), 'A': (1, 2), 'B': (4, 3), 'Q': (5, 0), 'AB': (2, 4)}
    machine = Machine.from_points(points, ['OA', 'A-B-AB', 'BQ'], 'OQ')
    assert machine == Machine.from_points(points, [('O', 'A'), ('A', 'B', 'AB'), 'BQ'], 'OQ')


PAPER = {'A': (0, 0), 'B': (1, 2), 'C': (4, 3), 'D': (5, 0)}


@pytest.mark.parametrize(('changes', 'text'), [
    ({'links': ['AB', 'BX', 'CD']}, 'points = .X.: there is no such point'),
    ({'points': {**PAPER, 'E': (1, 1)}}, 'points = .E.: no link has'),
    ({'links': ['AB', 'BC', 'CD', 'C']}, 'two points or more'),
    ({'links': ['BC', 'AB', 'CD']}, 'must be the crank, with one point of the ground'),
    ({'links': []}, 'points?|links'),
    ({'ground': 'A'}, 'links = .B-C, C-D.: form no dyads'),
    ({'points': {**PAPER, 'B': (0, 0)}}, 'points = .B.: must not be where A is'),
    ({'slides': {'X': 0.0}}, 'points = .X.: there is no such point'),
    ({'slides': {'B': 0.0}}, 'slides.B = 0.0: no block can slide there'),
    ({'slides': {'C': '0deg'}}, 'slides.C = .0deg.: must be a finite number'),
    ({'modes': {'B': 1}}, 'modes.B = 1: is the inner pin of no dyad: C'),
    ({'points': {**PAPER, 'C': (4, 3, 0)}}, 'points.C = .*must be two finite numbers'),
    ({'points': {**PAPER, 'A': (float('nan'), 0)}}, 'points.A = nan: must be'),
])
def test_mistakes_are_said_by_name(changes, text):
    given = {'points': PAPER, 'links': ['AB', 'BC', 'CD'], 'ground': 'AD', **changes}
    with pytest.raises(InvalidParameter, match=text):
        Machine.from_points(**given)
