# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Exact derivatives of machines of dyads beside those of another formulation in fifty digits."""
from copy import copy

from flint import ctx
from fourbar_lab.studies.derivatives import Derivatives
from fourbar_lab.studies.design import Design
from fourbar_lab.studies.measures import Measures
from fourbar_ros import load_scene
from fourbar_ros.mechanics.bodies import Applied, Body, unchecked
from fourbar_ros.mechanisms.kinds import DIMENSIONS
from fourbar_ros.mechanisms.machine.describe.description import Cylinder, Point
from fourbar_ros.numerics.duals import derivatives_of, value_of
from fourbar_ros.scene.scene import from_values
import mpmath as mp
import numpy as np
import pytest
from support.cartesian import BITS, exact, values_of
from support.samples import some

STEP = mp.mpf(10)**-20           # of differences, whose error is its square
ZERO = mp.mpf(10)**-15           # beside outputs that are zero
BODY = ('mass', 'cg_along', 'cg_across', 'inertia')
# A yoke on a block that a crank turns, and two blocks on lines of both: dyads RPP and PRP.
SLIDES = {
    'linkage.kind': 'machine', 'linkage.dyads': ['yoke', 'blocks'],
    'dyads.yoke.kind': 'RPP', 'dyads.yoke.first.link': 'crank', 'dyads.yoke.first.along': 0.3,
    'dyads.yoke.second.link': 'ground', 'dyads.yoke.second.along': 0.1,
    'dyads.yoke.second.across': -0.2, 'dyads.yoke.links': ['block', 'frame'],
    'dyads.yoke.direction_2': 0.2, 'dyads.yoke.slot': 1.3,
    'dyads.blocks.kind': 'PRP', 'dyads.blocks.first.link': 'frame',
    'dyads.blocks.first.across': 0.4, 'dyads.blocks.second.link': 'crank',
    'dyads.blocks.second.along': 0.1, 'dyads.blocks.second.across': 0.25,
    'dyads.blocks.links': ['lower', 'upper'], 'dyads.blocks.direction_1': 0.5 * np.pi,
    'dyads.blocks.direction_2': 0.3, 'gravity.y': -9.81, 'drive.speed': 3.0,
    **{f'bodies.{link}.{field}': value + 0.1 * i
       for i, link in enumerate(('crank', 'block', 'frame', 'lower', 'upper'))
       for field, value in zip(BODY, (0.7, 0.05, -0.02, 0.01))},
    'external.frame.force_x': 12.0, 'external.upper.couple': 0.4,
    'external.upper.force_y': -5.0, 'external.upper.along': 0.3}


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(50):
        yield


def scene_of(name):
    return from_values(SLIDES) if name == 'slides' else load_scene(name)


def machine_of(scene, values):
    """Return the machine of a scene for other parameters, whose numbers may be of mpmath."""
    def number(name, otherwise=0.0):
        value = values.get(name, otherwise)
        return mp.mpf(otherwise if value != value else value)

    machine, stages = object.__new__(type(scene.linkage)), []     # unchecked
    machine.__dict__.update(scene.linkage.__dict__)
    for dyad in scene.linkage.stages:
        own = copy(dyad)
        where, ends = (('cylinder.', ('pin', 'base')) if dyad.name == 'cylinder' else
                       (f'dyads.{dyad.name}.', ('first', 'second')))
        for place, end in zip(('first', 'second'), ends):
            own.__dict__[place] = Point(getattr(dyad, place).link, number(f'{where}{end}.along'),
                                        number(f'{where}{end}.across'))
        own.__dict__.update({name: number(where + name, getattr(dyad, name))
                             for name in DIMENSIONS[dyad.kind]})
        stages.append(own)
    if machine.cylinder:
        pin, base = stages[0].first, stages[0].second
        machine.__dict__['cylinder'] = Cylinder(base, pin, machine.cylinder.links,
                                                machine.cylinder.mode)
    lengths = {f'{dyad.name}.{name}': getattr(dyad, name) for dyad in stages
               for name in ('length_1', 'length_2')}
    machine.__dict__.update(
        stages=tuple(stages), gravity=(number('gravity.x'), number('gravity.y')),
        bodies=machine.BODIES(*[body_of(link, lengths, number) for link in machine.LINKS]),
        external=machine.EXTERNAL(*[unchecked(Applied, *[
            number(f'external.{link}.{field}') for field in Applied.__dataclass_fields__])
            for link in machine.EXTERNAL._fields]))
    return machine


def body_of(link, lengths, number):
    """Return the body of a link: as given, or that of a round rod."""
    mass, along, across, inertia = (number(f'bodies.{link.name}.{field}', mp.nan)
                                    for field in BODY)
    length = lengths.get(link.length)
    if mass == mass:
        along = along if along == along else length / 2 if length else 0
        return unchecked(Body, mass, along, across, inertia if inertia == inertia else mp.mpf(0))
    rho, r = number('bodies.rods.density', mp.nan), number('bodies.rods.radius', mp.nan)
    if length is None or rho != rho:
        return unchecked(Body, *[mp.mpf(0)] * 4)
    mass = rho * mp.pi * r * r * length
    return unchecked(Body, mass, length / 2, mp.mpf(0), mass * (3 * r * r + length**2) / 12)


def reference(scene, x, moved):
    """Return {field: value} of all that the reference knows, with one parameter moved."""
    values = dict(scene.values)
    values[moved[0]] = mp.mpf(values[moved[0]]) + moved[1]
    machine, given = machine_of(scene, values), (x, mp.mpf(values['drive.speed']), mp.mpf(0))
    near = [[getattr(scene.linkage.motion(float(x)), f'{what}_{link}') for what in
             ('x', 'y', 'theta')] for link in machine.layout.moving]
    with ctx.workprec(BITS):
        return values_of(exact(machine, given, near))


def slopes(function, step=STEP):
    """Return {name: derivative} of a function of a step that returns {name: value}."""
    after, before = function(step), function(-step)
    return {name: (after[name] - before[name]) / (2 * step) for name in after}


@some('name', ['jansen', 'watt', 'bucket', 'quick_return', 'v_engine',
               'slides'], ('slides',))
def test_every_output_has_the_derivatives_of_fifty_digits(name):
    scene, rng = scene_of(name), np.random.default_rng(7)
    found = Derivatives(scene)
    low, high = scene.linkage.input_ranges[0]
    for place in (low + (high - low) * rng.uniform(0.05, 0.95, 2)).tolist():
        motion, loads = found.state(np.array([place]))
        fields = motion._asdict() | loads._asdict()
        names = rng.choice(found.names, 8, replace=False).tolist()
        scales = {one: abs(scene.values[one]) or 1.0 for one in names}
        true = {one: slopes(lambda step: reference(
            scene, mp.mpf(place), (one, step * scales[one])))  # noqa: B023
            for one in names}
        for field in true[names[0]].keys() & fields.keys():
            by = derivatives_of(fields[field])
            # each beside the largest, in the unit of the output: what rounding can reach
            size = max(*(abs(true[one][field]) for one in names), ZERO,
                       *np.abs(np.ravel(value_of(fields[field]))))
            for one in names:
                mine = np.ravel(by.get(one, 0.0))[0] * scales[one]
                error = abs(mine - true[one][field])
                assert error <= 1e-12 * size, (field, one, mine, true[one][field])


EXTREMA = [('jansen', 'omega_foot', ('dyads.leg.first.along', 'dyads.lower.second.across')),
           ('jansen', 'driving_torque', ('dyads.upper.length_1', 'bodies.foot.cg_across')),
           ('watt', 'alpha_output', ('dyads.one.length_1', 'dyads.two.first.across')),
           ('bucket', 'omega_bucket', ('cylinder.base.along', 'dyads.bucket.length_2')),
           ('quick_return', 'slide_ram_velocity', ('dyads.lever.second.across',
                                                   'dyads.ram.direction_2')),
           ('quick_return', 'ram_inner', ('dyads.lever.first.along', 'bodies.ram.mass'))]


@some('name, quantity, names', EXTREMA, EXTREMA[2:3])
def test_extrema_move_as_in_fifty_digits(name, quantity, names):
    scene = scene_of(name)
    design, found = Design(scene), Derivatives(scene, names)
    measure, *_ = Measures(scene).named('quantities', quantity)
    design.search([measure])

    def value(x, moved):
        return reference(scene, x, moved)[quantity]

    def place(near, moved):
        def slope(x):
            return (value(x + STEP, moved) - value(x - STEP, moved)) / (2 * STEP)
        return mp.findroot(slope, (near, near + mp.mpf(10)**-9), tol=mp.mpf(10)**-50)

    extremum = next(one for one in (design.extreme(quantity, end) for end in ('max', 'min'))
                    if not one.side)
    near = extremum.input
    moves = found.at_extremum(quantity, near)
    small, true = mp.mpf(10)**-12, {}
    for one in names:
        ends = [(x, value(x, moved)) for moved in ((one, -small), (one, small))
                for x in [place(mp.mpf(near), moved)]]
        true[one] = [(b - a) / (2 * small) for a, b in zip(*ends)]
    for row, by, bound in ((0, moves.place, 1e-11), (1, moves.value, 1e-12)):
        scales = {one: abs(scene.values[one]) or 1.0 for one in names}
        size = max(abs((near, extremum.value)[row]),
                   *(abs(true[one][row]) * scales[one] for one in names))
        for one in names:
            error = abs(by[one] - true[one][row]) * scales[one]
            assert error <= bound * size, (one, by[one], true[one][row])
