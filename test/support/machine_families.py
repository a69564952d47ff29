# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Random machines of one to six dyads: plain, near toggles, at and near change points, wide ratios.

Each is a :class:`Drawn`: the machine with everything acting, where to look at it, and, next to an
exact change point, that change point in many digits.
"""
from dataclasses import replace
from typing import NamedTuple

from flint import arb
from fourbar_ros import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.machine.describe.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np
from support.cartesian import BEGIN
from support.random_machines import random_dyads, random_machines, random_masses

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
    dyad: dict
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
    return Flat('crank', {'kind': 'RRR', 'p': p, 'q': q, 'length_1': float(lengths[0]),
                          'length_2': float(lengths[1])},
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
    return Flat('crank', {'kind': 'RRP', 'p': p, 'q': q, 'length_1': float(a1 - side * e),
                          'direction_2': quarter * np.pi / 2},
                lambda: arb(quarter + side) * PI() / 2 - _angle(p)())


def flat_rpr(rng):
    """|a1 - a4| = |h| at x = 0."""
    p, q = _point(rng, int(rng.integers(1, 10))), _point(rng, int(rng.integers(1, 10)))
    h = abs(round(np.hypot(*p)) - round(np.hypot(*q)))
    return Flat('crank', {'kind': 'RPR', 'p': p, 'q': q, 'offset': float(rng.choice((-h, h)))},
                lambda: _angle(q)() - _angle(p)())


def flat_rrr_on_a_slide(rng):
    """|r1 - r2| = |e| at sigma = 0."""
    p, q, r = rng.integers(-9, 10, 2), rng.integers(-9, 10, 2), int(rng.integers(1, 10))
    lengths = [r, r + abs(int(p[1] - q[1]))]
    rng.shuffle(lengths)
    return Flat('slide', {'kind': 'RRR', 'p': p, 'q': q, 'length_1': float(lengths[0]),
                          'length_2': float(lengths[1])}, lambda: arb(int(q[0] - p[0])))


def flat_rpr_on_a_slide(rng):
    """|h| = |e| at sigma = 0."""
    p, q = rng.integers(-9, 10, 2), rng.integers(-9, 10, 2)
    return Flat('slide', {'kind': 'RPR', 'p': p, 'q': q,
                          'offset': float(rng.choice((-1, 1)) * (p[1] - q[1]))},
                lambda: arb(int(q[0] - p[0])))


FLATS = (flat_rrr, flat_rrp, flat_rpr, flat_rrr_on_a_slide, flat_rpr_on_a_slide)


def of_flat(rng, flat, is_swapped, modes, gap=0.0):
    """Return the machine of a Flat, its links on the driven link and the ground or exchanged."""
    own = dict(flat.dyad)
    p, q, kind = own.pop('p'), own.pop('q'), own.pop('kind')
    driven = 'slider' if flat.driver == 'slide' else 'crank'
    ends = [Point(driven, float(p[0]), float(p[1])), Point('ground', float(q[0]), float(q[1]))]
    if is_swapped and kind != 'RRP':
        ends.reverse()
        if kind == 'RRR':
            own['length_1'], own['length_2'] = own['length_2'], own['length_1']
    name = 'offset' if kind == 'RPR' else 'length_1'
    own[name] *= 1.0 + gap
    return flat.driver, Dyad('flat', kind, *ends, ('one', 'two'), **own, mode=modes)


def at_change_points(rng, flats=FLATS, near=False):
    """Yield machines that begin with a dyad at a change point, or near one, without an end."""
    while True:
        flat = flats[rng.integers(len(flats))](rng)
        gap = 10.0**rng.uniform(-12, -3) * rng.choice((-1, 1)) if near else 0.0
        more = {}
        try:
            driver, first = of_flat(rng, flat, rng.random() < 0.5, int(rng.integers(1, 3)), gap)
            if driver == 'slide':
                more['stroke'] = (-40.0, 40.0)
            own = [first, *random_dyads(rng, 'slider' if driver == 'slide' else 'crank',
                                        int(rng.choice((0, 0, 1, 2, 3, 5))), before=(first,))]
            machine = Machine(own, input=driver, **more)
            machine = Machine(own, input=driver, **more, **random_masses(
                rng, machine.layout.moving, machine.EXTERNAL._fields))
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


def wide(rng, decades=2.0):
    """Yield machines whose lengths are scaled by 10^+-decades each, masses by 10^+-3."""
    while True:
        machine, _ = next(random_machines(int(rng.integers(2**32)), 1, dyads=(1, 4)))
        given = np.array(machine.lengths)
        lengths = given * 10.0**rng.uniform(-decades, decades, given.size)
        try:
            other = machine.with_lengths(lengths.tolist())
            bodies = {name: type(body)(body.mass * 10.0**rng.uniform(-3, 3), body.cg_along,
                                       body.cg_across, body.inertia * 10.0**rng.uniform(-3, 3))
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


def between_moving_links(seed, near_limit=False):
    """Yield machines with a cylinder between two moving links: any dyad's link stands still."""
    rng = np.random.default_rng(seed)
    for machine, given in random_machines(seed, 10**9, dyads=(1, 5), driver='cylinder',
                                          near_limit=near_limit):
        dyad = machine.dyads[int(rng.integers(len(machine.dyads)))]
        machine = standing_on(machine, dyad.links[int(rng.integers(2))])
        motion = machine.motion(*given)
        if max(abs(getattr(motion, f'{what}_{link}')) for link in machine.layout.moving
               for what in (('x', 'y') if near_limit else
                            ('x', 'y', 'dx', 'dy', 'ratio', 'ddx', 'ddy', 'bend'))) < 10.0:
            yield Drawn(machine, given)


def standing_on(machine, link):
    """Return a machine whose ground moves, as 'leg', and another link of which stands still."""
    names = {'ground': 'leg', link: 'ground'}

    def at(point):
        return point._replace(link=names.get(point.link, point.link))

    dyads = [replace(dyad, first=at(dyad.first), second=at(dyad.second),
                     links=tuple(names.get(own, own) for own in dyad.links))
             for dyad in machine.dyads]
    return Machine(dyads, 'cylinder', cylinder=machine.cylinder._replace(
        base=at(machine.cylinder.base)), bodies=tuple(machine.bodies), gravity=machine.gravity,
        external=tuple(machine.external))


FAMILIES = {
    'between moving links': between_moving_links,
    'plain': lambda seed: from_random(seed),
    'near a toggle': lambda seed: from_random(seed, True),
    'at a change point': lambda seed: at_change_points(np.random.default_rng(seed)),
    'near a change point': lambda seed: at_change_points(np.random.default_rng(seed), near=True),
    'wide ratios': lambda seed: wide(np.random.default_rng(seed)),
}
