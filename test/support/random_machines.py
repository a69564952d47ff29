# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Random machines of one to six dyads: plain, near toggles, at and near change points, wide ratios.

Those of the families are each a :class:`Drawn`: the machine with everything acting, where to look
at it, and, next to an exact change point, that change point in many digits.
"""
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from flint import arb
from fourbar_ros import Applied, Body, FourBarError, InvalidParameter
from fourbar_ros.mechanisms.machine.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np
from support.cartesian import BEGIN
from support.samples import record

DIMENSIONS = {        # {kind of dyad: {dimension: its least and largest}}
    'RRR': {'length_1': (1.5, 3.0), 'length_2': (1.5, 3.0)},
    'RRP': {'length_1': (2.0, 4.0), 'direction_2': (-0.4, 0.4)}, 'RPR': {'offset': (-0.2, 0.2)},
    'RPP': {'direction_2': (-1.0, 1.0), 'slot': (0.8, 2.0)},
    'PRP': {'direction_1': (-0.3, 0.3), 'direction_2': (1.0, 2.0)}}


def random_dyads(rng, driven, count, structure=None, before=()):
    """
    Return dyads that hang on each other at random, or as (kind, first, second) of each say.

    ``before``: dyads that are there already.
    """
    links, dyads = ['ground', driven, *(link for dyad in before for link in dyad.links)], []
    for number in range(count):
        if structure:
            kind, *ends = structure[number]
            i, j = map(links.index, ends)
        else:
            kind = str(rng.choice(tuple(DIMENSIONS)))
            i, j = rng.choice(len(links), 2, replace=False).tolist()
        place = rng.uniform(-1.0, 1.0, 4)
        place[2] += 1.2 if not j else 0.0
        own = f'a{number}', f'b{number}'
        mode = 2 if kind in ('RPP', 'PRP') else int(rng.integers(1, 3))
        dyads.append(Dyad(f'd{number}', kind, Point(links[i], *place[:2].tolist()),
                          Point(links[j], *place[2:].tolist()), own,
                          **{name: float(rng.uniform(*ends))
                             for name, ends in DIMENSIONS[kind].items()}, mode=mode))
        links += own
    return dyads


def with_masses(rng, dyads, **options):
    """Return a machine with bodies, gravity and external loads, everything acting."""
    machine = Machine(dyads, **options)
    bodies = {name: record(Body, float(rng.uniform(0.5, 2.0)), *rng.uniform(-0.5, 0.5, 2).tolist(),
                           float(rng.uniform(0.1, 0.5))) for name in machine.layout.moving}
    external = {name: record(Applied, *rng.uniform(-5.0, 5.0, 2).tolist(),
                             *rng.uniform(-1.0, 1.0, 2).tolist(), float(rng.uniform(-5.0, 5.0)))
                for name in machine.EXTERNAL._fields}
    return Machine(dyads, **options, bodies=bodies, external=external,
                   gravity=tuple(rng.uniform(-10.0, 10.0, 2).tolist()))


def random_machines(seed, count, dyads=(1, 6), least_sine=0.0, near_limit=False, structure=None,
                    driver=None):
    """
    Yield (machine with everything acting, input) of machines that can be assembled.

    ``structure``, ``driver``: as :func:`random_dyads` takes them, and 'crank' or another drive.

    None has a link ten metres away, nor with derivatives above ten (m, rad): places and rates
    relative to another such link have lost a digit in absolute ones. ``near_limit``: the input is
    1e-1 to 1e-12 of its range from a toggle.
    """
    rng = np.random.default_rng(seed)
    while count:
        drive = driver or str(rng.choice(('crank', 'crank', 'slide', 'cylinder')))
        driven, more = 'slider' if drive == 'slide' else 'crank', {}
        if drive == 'slide':
            more['stroke'] = (-1.5, 1.5)
        if drive == 'cylinder':
            more['cylinder'] = Cylinder(Point('ground', *rng.uniform(-1.5, -0.5, 2).tolist()),
                                        Point('crank', float(rng.uniform(0.5, 1.0)), 0.1),
                                        mode=int(rng.integers(1, 3)))
        number = len(structure) if structure else int(rng.integers(*dyads))
        own = random_dyads(rng, driven, number, structure)
        try:
            machine = with_masses(rng, own, input=drive, **more)
        except InvalidParameter:
            continue
        low, high = machine.input_ranges[int(rng.integers(len(machine.input_ranges)))]
        share = 10.0**rng.uniform(-12.0, -1.0) if near_limit else rng.uniform(0.02, 0.98)
        if near_limit and (machine.turns_fully or machine.stroke):
            continue
        given = (float(low + (high - low) * (share if rng.random() < 0.5 else 1.0 - share)),
                 *rng.uniform(-3.0, 3.0, 2).tolist())
        motion = machine.motion(*given)
        if is_moderate(machine, motion, near_limit) and abs(
                machine.transmission_sine(motion)) > least_sine:
            count -= 1
            yield machine, given


def is_moderate(machine, motion, near_limit):
    """Return whether no link is ten metres away, nor, unless near a limit, moves as much."""
    kinds = 'x y' if near_limit else 'x y dx dy ratio ddx ddy bend'
    return max(abs(getattr(motion, f'{what}_{link}')) for link in machine.layout.moving
               for what in kinds.split()) < 10.0


# --- families ------------------------------------------------------------------------------------

TRIPLES = ((3, 4, 5), (5, 12, 13), (8, 15, 17))
PI = arb.pi


class Drawn(NamedTuple):
    """A machine and its input; ``flat``: () -> where it has an exact change point next to that."""

    machine: Machine
    given: tuple
    flat: object = None


class Flat(NamedTuple):
    """A first dyad with a change point, by whole numbers: its drive and where the point is."""

    driver: str
    kind: str
    p: tuple          # on the driven link: (along, across)
    q: tuple          # on the ground
    dimensions: dict
    at: object        # () -> arb


def _point(rng, size):
    """Return (along, across, (cosine, sine)) of a whole-number point at a distance."""
    turn = int(rng.integers(4))
    along, across = ((size, 0), (0, size), (-size, 0), (0, -size))[turn]
    if rng.random() < 0.4:
        x, y, r = TRIPLES[rng.integers(3)]
        along, across = along / r, across / r
        along, across = x * along - y * across, y * along + x * across
        if not (along.is_integer() and across.is_integer()):
            return _point(rng, size * r)
    return float(along), float(across)


def _angle(point):
    """Return the direction of a point in many digits."""
    return lambda: arb.atan2(arb(point[1]), arb(point[0]))


def pair_of(lengths):
    return {'length_1': float(lengths[0]), 'length_2': float(lengths[1])}


def flat_rrr(rng):
    """a1 + a4 = a2 + a3 at x = pi, or |a1 - a4| = |a2 - a3| at x = 0."""
    p, q = _point(rng, int(rng.integers(1, 10))), _point(rng, int(rng.integers(1, 10)))
    a1, a4 = (round(np.hypot(*at)) for at in (p, q))
    if rng.random() < 0.5 and a1 != a4:
        short = int(rng.integers(1, 12))
        lengths, half = [short, short + abs(a1 - a4)], 0
    else:
        a2 = int(rng.integers(1, a1 + a4))
        lengths, half = [a2, a1 + a4 - a2], 1
    rng.shuffle(lengths)
    return Flat('crank', 'RRR', p, q, pair_of(lengths),
                lambda: _angle(q)() - _angle(p)() + half * PI())


def flat_rrp(rng):
    """Draw r = a1 + |e| or a1 - |e|: the rod square to the slide, the crank too."""
    p, quarter = _point(rng, int(rng.integers(2, 10))), int(rng.integers(4))
    a1, e = round(np.hypot(*p)), int(rng.integers(0, 8))
    t = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarter]
    way = float(rng.integers(-9, 10))
    q = way * t[0] - e * t[1], way * t[1] + e * t[0]       # the line at e on the left of O1
    rocks = bool(e and e < a1 and rng.random() < 0.5)
    side = 1 if rocks else -1          # of the pin, left or right of O1 along the slide
    return Flat('crank', 'RRP', p, q, {'length_1': float(a1 - side * e),
                                       'direction_2': quarter * np.pi / 2},
                lambda: arb(quarter + side) * PI() / 2 - _angle(p)())


def flat_rpr(rng):
    """|a1 - a4| = |h| at x = 0."""
    p, q = _point(rng, int(rng.integers(1, 10))), _point(rng, int(rng.integers(1, 10)))
    h = abs(round(np.hypot(*p)) - round(np.hypot(*q)))
    return Flat('crank', 'RPR', p, q, {'offset': float(rng.choice((-h, h)))},
                lambda: _angle(q)() - _angle(p)())


def flat_rrr_on_a_slide(rng):
    """|r1 - r2| = |e| at sigma = 0."""
    p, q, r = rng.integers(-9, 10, 2), rng.integers(-9, 10, 2), int(rng.integers(1, 10))
    lengths = [r, r + abs(int(p[1] - q[1]))]
    rng.shuffle(lengths)
    return Flat('slide', 'RRR', p, q, pair_of(lengths), lambda: arb(int(q[0] - p[0])))


def flat_rpr_on_a_slide(rng):
    """|h| = |e| at sigma = 0."""
    p, q = rng.integers(-9, 10, 2), rng.integers(-9, 10, 2)
    return Flat('slide', 'RPR', p, q, {'offset': float(rng.choice((-1, 1)) * (p[1] - q[1]))},
                lambda: arb(int(q[0] - p[0])))


FLATS = (flat_rrr, flat_rrp, flat_rpr, flat_rrr_on_a_slide, flat_rpr_on_a_slide)


def dyad_of(flat, driven, is_swapped, mode, gap):
    """Return the dyad of a Flat, its ends perhaps exchanged, and wrong by a gap."""
    ends, own = [Point(driven, *map(float, flat.p)), Point('ground', *map(float, flat.q))], {
        **flat.dimensions}
    if is_swapped and flat.kind != 'RRP':
        ends.reverse()
        if flat.kind == 'RRR':
            own = {'length_1': own['length_2'], 'length_2': own['length_1']}
    own['offset' if flat.kind == 'RPR' else 'length_1'] *= 1.0 + gap
    return Dyad('flat', flat.kind, *ends, ('one', 'two'), **own, mode=mode)


def at_change_points(seed, near=False):
    """Yield machines that begin with a dyad at a change point, or near one, without an end."""
    rng = np.random.default_rng(seed)
    while True:
        flat = FLATS[rng.integers(len(FLATS))](rng)
        gap = 10.0**rng.uniform(-12, -3) * rng.choice((-1, 1)) if near else 0.0
        driven, more = ('slider', {'stroke': (-40.0, 40.0)}) if flat.driver == 'slide' else (
            'crank', {})
        try:
            first = dyad_of(flat, driven, rng.random() < 0.5, int(rng.integers(1, 3)), gap)
            own = [first, *random_dyads(rng, driven, int(rng.choice((0, 0, 1, 2, 3, 5))),
                                        before=(first,))]
            machine = with_masses(rng, own, input=flat.driver, **more)
        except FourBarError:
            continue
        place, side = float(flat.at()), float(rng.choice((-1, 1)))
        x = place + side * 10.0**rng.uniform(-12, -2)
        if closes(machine, x if near else place + side * BEGIN):
            yield Drawn(machine, (x, *rng.uniform(-3.0, 3.0, 2).tolist()),
                        None if near else flat.at)


def closes(machine, x):
    try:
        return machine.motion(x) is not None
    except FourBarError:
        return False


def wide(seed):
    """Yield machines whose lengths are scaled by 10^+-2 each, masses by 10^+-3."""
    rng = np.random.default_rng(seed)
    while True:
        machine, _ = next(random_machines(int(rng.integers(2**32)), 1, dyads=(1, 4)))
        given = np.array(machine.lengths)
        lengths = given * 10.0**rng.uniform(-2.0, 2.0, given.size)
        try:
            other = machine.with_lengths(lengths.tolist())
            bodies = {name: replace(body, mass=body.mass * 10.0**rng.uniform(-3, 3),
                                    inertia=body.inertia * 10.0**rng.uniform(-3, 3))
                      for name, body in machine.bodies._asdict().items()}
            stroke = (-150.0, 150.0) if machine.input == 'slide' else None
            machine = Machine(other.dyads, machine.input, cylinder=other.cylinder, bodies=bodies,
                              gravity=machine.gravity, external=machine.external._asdict(),
                              stroke=stroke)
            low, high = machine.input_ranges[int(rng.integers(len(machine.input_ranges)))]
        except InvalidParameter:
            continue
        yield Drawn(machine, (low + (high - low) * float(rng.uniform(0.05, 0.95)),
                              *rng.uniform(-3.0, 3.0, 2).tolist()))


def from_random(seed, near_limit=False):
    for machine, given in random_machines(seed, 10**9, dyads=(1, 7), near_limit=near_limit):
        yield Drawn(machine, given)


def between_moving_links(seed, near_limit=False, driver='cylinder'):
    """Yield machines driven between two moving links: any dyad's link stands still."""
    rng = np.random.default_rng(seed)
    for machine, given in random_machines(seed, 10**9, dyads=(1, 5), driver=driver,
                                          near_limit=near_limit):
        dyad = machine.dyads[int(rng.integers(len(machine.dyads)))]
        machine = standing_on(machine, dyad.links[int(rng.integers(2))])
        if is_moderate(machine, machine.motion(*given), near_limit):
            yield Drawn(machine, given)


def standing_on(machine, link):
    """Return a machine whose ground moves, as 'leg', and another link of which stands still."""
    names = {'ground': 'leg', link: 'ground'}

    def at(point):
        return point._replace(link=names.get(point.link, point.link))

    dyads = [replace(dyad, first=at(dyad.first), second=at(dyad.second),
                     links=tuple(names.get(own, own) for own in dyad.links))
             for dyad in machine.dyads]
    how = ({'carrier': 'leg'} if machine.input == 'crank' else
           {'cylinder': machine.cylinder._replace(base=at(machine.cylinder.base))})
    return Machine(dyads, machine.input, **how, bodies=tuple(machine.bodies),
                   gravity=machine.gravity, external=tuple(machine.external))


FAMILIES = {
    'between moving links': between_moving_links,
    'crank on a moving link': partial(between_moving_links, driver='crank'),
    'plain': from_random,
    'near a toggle': partial(from_random, near_limit=True),
    'at a change point': at_change_points,
    'near a change point': partial(at_change_points, near=True),
    'wide ratios': wide,
}
