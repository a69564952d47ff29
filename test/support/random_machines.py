# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Random machines of dyads, with everything acting."""
from fourbar_ros import Applied, Body, InvalidParameter
from fourbar_ros.mechanisms.machine.describe.description import Cylinder, Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np

KINDS = 'RRR', 'RRP', 'RPR', 'RPP', 'PRP'


def random_dimensions(rng, kind):
    """Return the dimensions of a dyad by name."""
    draw = {'RRR': lambda: {'length_1': rng.uniform(1.5, 3.0), 'length_2': rng.uniform(1.5, 3.0)},
            'RRP': lambda: {'length_1': rng.uniform(2.0, 4.0),
                            'direction_2': rng.uniform(-0.4, 0.4)},
            'RPR': lambda: {'offset': rng.uniform(-0.2, 0.2)},
            'RPP': lambda: {'direction_2': rng.uniform(-1.0, 1.0), 'slot': rng.uniform(0.8, 2.0)},
            'PRP': lambda: {'direction_1': rng.uniform(-0.3, 0.3),
                            'direction_2': rng.uniform(1.0, 2.0)}}[kind]
    return {name: float(value) for name, value in draw().items()}


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
            kind = str(rng.choice(tuple(KINDS)))
            i, j = rng.choice(len(links), 2, replace=False).tolist()
        place = rng.uniform(-1.0, 1.0, 4)
        place[2] += 1.2 if not j else 0.0
        own = f'a{number}', f'b{number}'
        mode = 2 if kind in ('RPP', 'PRP') else int(rng.integers(1, 3))
        dyads.append(Dyad(f'd{number}', kind, Point(links[i], *place[:2].tolist()),
                          Point(links[j], *place[2:].tolist()), own,
                          **random_dimensions(rng, kind), mode=mode))
        links += own
    return dyads


def random_masses(rng, machine_links, loadable):
    """Return bodies, gravity and external loads, everything acting."""
    bodies = {name: Body(float(rng.uniform(0.5, 2.0)), *rng.uniform(-0.5, 0.5, 2).tolist(),
                         float(rng.uniform(0.1, 0.5))) for name in machine_links}
    external = {name: Applied(*rng.uniform(-5.0, 5.0, 2).tolist(),
                              *rng.uniform(-1.0, 1.0, 2).tolist(), float(rng.uniform(-5.0, 5.0)))
                for name in loadable}
    return {'bodies': bodies, 'external': external,
            'gravity': tuple(rng.uniform(-10.0, 10.0, 2).tolist())}


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
            machine = Machine(own, input=drive, **more)
            machine = Machine(own, input=drive, **more, **random_masses(
                rng, machine.layout.moving, machine.EXTERNAL._fields))
        except InvalidParameter:
            continue
        low, high = machine.input_ranges[int(rng.integers(len(machine.input_ranges)))]
        share = 10.0**rng.uniform(-12.0, -1.0) if near_limit else rng.uniform(0.02, 0.98)
        if near_limit and (machine.turns_fully or machine.stroke):
            continue
        given = (float(low + (high - low) * (share if rng.random() < 0.5 else 1.0 - share)),
                 *rng.uniform(-3.0, 3.0, 2).tolist())
        motion = machine.motion(*given)
        sizes = [abs(getattr(motion, f'{what}_{link}')) for link in machine.layout.moving
                 for what in (('x', 'y') if near_limit else
                              ('x', 'y', 'dx', 'dy', 'ratio', 'ddx', 'ddy', 'bend'))]
        if max(sizes) < 10.0 and abs(machine.transmission_sine(motion)) > least_sine:
            count -= 1
            yield machine, given
