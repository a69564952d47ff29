# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines that cannot be: each refused in one line that names what is wrong and where."""
from math import nan, pi

from fourbar_ros import Body, External, FourBar, InvalidParameter
from fourbar_ros.mechanisms.machine.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import pytest

LENGTHS = 0.4, 1.2, 0.8, 1.0
CRANK, GROUND = Point('crank', 0.4), Point('ground', 1.0)


def rrr(name='d', first=CRANK, second=GROUND, links=('coupler', 'rocker'), **changed):
    return Dyad(name, changed.pop('kind', 'RRR'), first, second, links,
                **{'length_1': 1.2, 'length_2': 0.8, **changed})


def second(first, **changed):
    """Return a machine of two dyads, the second from ``first`` to the ground."""
    return Machine([rrr(), rrr('e', first, Point('ground', 2.0), ('rod', 'arm'), **changed)])


def stephenson_2(*order):
    """Return a Stephenson II driven at its crank: its four other links are one group."""
    dyads = {'one': rrr('one', CRANK, Point('arm', 0.3, 0.1), ('coupler', 'ternary')),
             'two': rrr('two', Point('ground', 1.0), Point('coupler', 0.5), ('arm', 'rocker')),
             'behind': rrr('behind', Point('ternary', 0.2), GROUND, ('rod', 'lever'))}
    return Machine([dyads[name] for name in order])


SLIDER = Point('slider', 0.4)
BASE, PIN = Point('ground', 0.0, -0.5), Point('crank', 0.4)
MISTAKES = {
    'no dyad': (lambda: Machine([]), 'dyads = .*one Dyad or more'),
    'a dyad that is none': (lambda: Machine([('d', 'RRR')]), 'dyads = .*one Dyad or more'),
    'unknown kind': (lambda: rrr(kind='RPPR'), r'dyads.d.kind = .RPPR.: must be one of RRR'),
    'no name': (lambda: rrr(''), 'name of a dyad = .*letters'),
    'a name that is a word of Python': (lambda: rrr(links=('lambda', 'b')), 'dyads.d.links = .la'),
    'a link named as the ground': (lambda: Machine([rrr(links=('ground', 'b'))]),
                                   'dyads.d.links.*ground'),
    'two links of one name': (lambda: Machine([rrr(links=('rod', 'rod'))]),
                              'dyads.d.links = .*must be two names'),
    'a name of a dyad twice': (
        lambda: Machine([rrr(), rrr(links=('rod', 'arm'))]), 'name of a dyad = .d.: stands twice'),
    'a name of a link twice': (
        lambda: Machine([rrr(), rrr('e', links=('rod', 'rocker'))]),
        r'dyads.e.links = .rocker.: is a link of dyad d already'),
    'a link named as the driven one': (lambda: Machine([rrr(links=('crank', 'b'))]),
                                       'dyads.d.links = .crank.: is the driven link'),
    'a name of a result twice': (
        lambda: Machine([rrr(), rrr('e', Point('rocker', 0.8), Point('ground', 2.0),
                                    ('d_first', 'arm'), length_1=1.1)]),
        'dyads = .*theta_d_first.*name of two results'),
    'an unknown link': (lambda: second(Point('rokcer', 0.8)),
                        r'dyads.e.first.link = .rokcer.*did you mean rocker'),
    'the slider of a machine with a crank': (lambda: Machine([rrr(first=SLIDER)]),
                                             'dyads.d.first.link = .slider.: there is no such'),
    'a link of a later dyad': (
        lambda: Machine([rrr(first=Point('arm', 0.1)), rrr('e', links=('rod', 'arm'))]),
        'dyads.d.first.link = .arm.: is a link of dyad e, which must stand before this one: '
        'e, d works$'),
    'an order that cannot be, Stephenson II': (
        lambda: stephenson_2('one', 'two'),
        'dyads.one.second.link = .arm.: is a link of dyad two, but no order of dyads works: the '
        'links coupler, ternary, arm, rocker close only together, an Assur group of a higher '
        'class. Drive another link, or hang one of their dyads on links before it$'),
    'three dyads that hang on each other': (
        lambda: Machine([rrr(name, second=Point(f'{other}_1', 0.2), links=(f'{name}_1',
                                                                           f'{name}_2'))
                         for name, other in ('ab', 'bc', 'ca')]),
        'dyads.a.second.link = .b_1.: .*links a_1, a_2, b_1, b_2, c_1, c_2 close only'),
    'two ends on the ground': (
        lambda: Machine([rrr(), rrr('e', GROUND, Point('ground', 9.0), ('rod', 'arm'))]),
        'dyads.e: cannot close at any input: it hangs on ground alone, so no input moves'),
    'a link of its own': (lambda: Machine([rrr(second=Point('coupler', 0.1))]),
                          'dyads.d.second.link = .coupler.*own link'),
    'a point that is none': (lambda: rrr(first=3.0), 'dyads.d.first = 3.0: must be Point'),
    'a point that is not finite': (lambda: rrr(first=Point('crank', nan)),
                                   'dyads.d.first.along = nan'),
    'a length missing': (lambda: rrr(length_2=None), 'dyads.d.length_2: a dyad RRR needs it'),
    'a length too many': (lambda: rrr(offset=0.1),
                          'dyads.d.offset = 0.1: a dyad RRR has length_1, length_2 only'),
    'a length of zero': (lambda: rrr(length_1=0.0), 'dyads.d.length_1 = 0.0.*positive'),
    'a length whose square overflows': (lambda: rrr(length_1=1e200),
                                        r'dyads.d.length_1 = 1e\+200: must be between'),
    'a text for a length': (lambda: rrr(length_1='1.2'), 'dyads.d.length_1 = .1.2.*not a text'),
    'mode 3': (lambda: rrr(mode=3), 'dyads.d.mode = 3: must be 1 or 2'),
    'mode 1 of one that has one mode': (
        lambda: Dyad('d', 'PRP', CRANK, GROUND, ('a', 'b'), direction_1=0.0, direction_2=1.0,
                     mode=1), 'dyads.d.mode = 1: must be 2'),
    'a slot along the slide': (
        lambda: Dyad('d', 'RPP', CRANK, GROUND, ('a', 'b'), direction_2=0.3, slot=pi),
        'dyads.d.slot = 3.14.*not be parallel'),
    'parallel lines on one link': (
        lambda: Dyad('d', 'PRP', CRANK, Point('crank', 0.0, 1.0), ('a', 'b'), direction_1=0.2,
                     direction_2=0.2), 'dyads.d.direction_2 = 0.2.*parallel'),
    'rods that never reach': (
        lambda: second(Point('rocker', 0.8), length_1=0.1, length_2=0.1),
        'dyads.e: cannot close at any input at which those before it do'),
    'unknown input': (lambda: Machine([rrr()], input='motor'), 'input = .motor.: must be one of'),
    'an output that is no link': (lambda: Machine([rrr()], output='rokcer'),
                                  'output = .rokcer.*did you mean rocker'),
    'a cylinder of a driven crank': (lambda: Machine([rrr()], cylinder=Cylinder(BASE, PIN)),
                                     'cylinder = .*only then'),
    'no cylinder': (lambda: Machine([rrr()], input='cylinder'), 'cylinder: .*only then'),
    'a cylinder on the crank': (
        lambda: Machine([rrr()], input='cylinder', cylinder=Cylinder(PIN, PIN)),
        'cylinder.base = .*point of the ground'),
    'a cylinder pinned at O1': (
        lambda: Machine([rrr()], input='cylinder', cylinder=Cylinder(BASE, Point('crank'))),
        'cylinder.pin = .*away from O1'),
    'a stroke of a crank': (lambda: Machine([rrr()], stroke=(1.0, 0.0)),
                            'stroke = .*lowest, highest'),
    'a slide without end': (
        lambda: Machine([Dyad('d', 'RPR', Point('slider'), Point('ground', 0.0, 1.0),
                              ('block', 'bar'))], input='slide'),
        'stroke: must be given: no dyad limits the slide'),
    'a stroke outside': (
        lambda: Machine([rrr(first=Point('slider'))], input='slide', stroke=(10.0, 11.0)),
        'stroke = .*cannot close anywhere in it'),
    'a body of an unknown link': (lambda: Machine([rrr()], bodies={'rokcer': Body(1.0)}),
                                  'bodies.rokcer: there is no such link; did you mean rocker'),
    'a body that is none': (lambda: Machine([rrr()], bodies={'rocker': 1.0}),
                            'bodies.rocker = 1.0: must be of type Body'),
    'fewer bodies than links': (lambda: Machine([rrr()], bodies=[Body(1.0)] * 2),
                                'bodies = .*mapping .link: Body., or as many as crank, coupler'),
    'more bodies than links': (lambda: Machine([rrr()], bodies=[Body(1.0)] * 4), 'bodies = '),
    'bodies that are none': (lambda: Machine([rrr()], bodies=3), 'bodies = 3: must be a mapping'),
    'external loads of a kind': (lambda: Machine([rrr()]).with_external(External()),
                                 'external.output: there is no such link'),
    'lengths that are too few': (lambda: Machine([rrr()]).with_lengths([0.4, 1.0]),
                                 'lengths = .*as many as d.first.along, d.second.along, d.length'),
    'a length below zero': (lambda: Machine([rrr()]).with_lengths([0.4, 1.0, -1.2, 0.8]),
                            'dyads.d.length_1 = -1.2: a length must be a positive number'),
    'another length of zero': (lambda: Machine([rrr()]).with_lengths([0.4, 1.0, 0.0, 0.8]),
                               'dyads.d.length_1 = 0.0: a length must be'),
    'mode 0': (lambda: Machine([rrr()]).in_mode(0), 'mode = 0: must be 1 to 2'),
    'a mode beyond those of the dyads': (lambda: Machine([rrr()]).in_mode(5), 'mode = 5: must be'),
    'a name of no joint': (lambda: Machine([rrr()], joint_names={'O1': 'P'}),
                           'joint_names.O1 = .P.: there is no such joint.*base'),
    'no name of a joint': (lambda: Machine([rrr()], joint_names={'base': ''}),
                           'joint_names.base = '),
    'one name of two joints': (
        lambda: Machine([rrr()], joint_names={'d_first': 'P', 'd_inner': 'P'}),
        'joint_names.d_inner = .P.: names two joints .*, d_first and d_inner'),
    'a name of no joint of a kind': (lambda: FourBar(*LENGTHS, joint_names={'base': 'P'}),
                                     'joint_names.base = .P.: there is no such joint.*O1'),
    'no name of a joint of a kind': (lambda: FourBar(*LENGTHS, joint_names={'O1': ''}),
                                     'joint_names.O1 = '),
    'one name of two joints of a kind': (
        lambda: FourBar(*LENGTHS, joint_names={'A': 'P', 'B': 'P'}),
        'joint_names.B = .P.: names two joints .*, A and B'),
    'gravity that is no vector': (lambda: Machine([rrr()], gravity=9.81), 'gravity = 9.81'),
}


@pytest.mark.parametrize('name', MISTAKES)
def test_a_mistake_is_refused_in_one_line(name):
    make, text = MISTAKES[name]
    with pytest.raises(InvalidParameter, match=f'^{text}') as caught:
        make()
    assert '\n' not in str(caught.value)
    assert len(str(caught.value)) < 300


def test_a_length_of_a_point_may_become_zero():
    """Then it is none any more: names and lengths are still as many."""
    machine = Machine([rrr(second=Point('ground', 1.0, 0.1))])
    other = machine.with_lengths([0.4, 1.0, 0.0, 1.2, 0.8])
    assert other.length_names == Machine([rrr()]).length_names
    assert other.lengths == Machine([rrr()]).lengths
    assert other.motion(0.5, 2.0) == Machine([rrr()]).motion(0.5, 2.0)


def test_the_same_without_a_mistake():
    machine = second(Point('rocker', 0.8), length_1=1.4, length_2=0.9)
    assert machine.turns_fully
    assert Machine([rrr(first=Point('slider'))], input='slide').input_ranges
    assert Machine([rrr()], input='cylinder', cylinder=Cylinder(BASE, PIN)).input_ranges
    assert FourBar(*LENGTHS, joint_names={'O4': 'P', 'A': 'Q'}).joint_names
