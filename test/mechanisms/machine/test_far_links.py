# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Bars on links that run to infinity, where the slides of a dyad PRP become parallel.

They turn smoothly, but their rates are differences of terms that grow with the distance: what that
costs is in docs/accuracy.md.
"""
from flint import ctx
from fourbar_ros import Body, find_extrema
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.quantities import known_quantities
import pytest
from support.cartesian import BITS, errors, exact, exact_values
from support.scans import check_against_scan

BOUND = 5.0        # in eps times condition, as of all motion


def slides(name, first, second, links, turned=(0.1, 1.0)):
    """Return a dyad PRP."""
    return Dyad(name, 'PRP', first, second, links, direction_1=turned[0], direction_2=turned[1])


def bar(name, first, second, offset=-0.16, mode=1):
    """Return a dyad RPR, a block on a bar."""
    return Dyad(name, 'RPR', first, second, (f'{name}_block', f'{name}_bar'), offset=offset,
                mode=mode)


GROUND, CRANK = Point('ground', -0.27, -0.41), Point('crank', 0.05, 0.34)
ON_GROUND = slides('far', Point('ground', 0.5, -0.15), Point('crank', 0.96, -0.05), ('a', 'b'))
RAIL = Dyad('rail', 'RRP', Point('ground', 0.1, 0.2), Point('crank', 0.9, -0.3), ('rod', 'block'),
            length_1=3.0, direction_2=-0.2)
OTHER = slides('other', Point('ground', -0.3, 0.2), Point('crank', 0.4, 0.3), ('c', 'd'),
               (0.7, 1.9))
MACHINES = {
    'from the ground': [ON_GROUND, bar('bar', GROUND, Point('a', -0.29, -0.06))],
    'from the crank': [ON_GROUND, bar('bar', CRANK, Point('a', -0.28, 0.74), 0.08, 2)],
    'pinned at the far link': [ON_GROUND, bar('bar', Point('a', -0.29, -0.06), GROUND)],
    'on the link that turns': [ON_GROUND, bar('bar', CRANK, Point('b', 0.2, 0.3))],
    'from the ground on the link that turns': [ON_GROUND, bar('bar', GROUND, Point('b', 0.2))],
    'on a bar': [ON_GROUND, bar('one', GROUND, Point('a', -0.29, -0.06)),
                 bar('bar', CRANK, Point('one_bar', 0.3, 0.1), 0.05)],
    'on a rod between both': [
        ON_GROUND, Dyad('rods', 'RRR', Point('a', 0.4, 0.1), Point('b', 0.3, 0.2), ('r', 's'),
                        length_1=0.9, length_2=0.8),
        bar('bar', GROUND, Point('s', 0.3, 0.1))],
    'in a frame that turns': [
        RAIL,
        slides('far', Point('crank', 0.3, 0.1), Point('rod', 0.5, 0.2), ('a', 'b'), (0.1, 0.3)),
        bar('bar', GROUND, Point('a', 0.2, 0.1))],
    'between two far ones': [ON_GROUND, OTHER, bar('bar', Point('c', 0.2, 0.1), Point('a', 0.1))],
}


def errors_of(machine, given):
    """Return {field: error in eps times condition}."""
    with ctx.workprec(BITS):
        return {field: error for field, error, _ in errors(machine, given, exact(machine, given))}


@pytest.mark.parametrize('name', MACHINES)
@pytest.mark.parametrize('side', [0, 1])
def test_bars_on_links_that_run_to_infinity(name, side):
    """Angles keep their digits; rates lose one, accelerations two, each time 10 times nearer."""
    machine, given = Machine(MACHINES[name]), (1.3, -0.7)
    end = next(bound for bound in machine.limits if bound[side].dyad == 'far')[side].x
    for distance in (1e-2, 1e-3, 1e-4):
        found = errors_of(machine, (end + (distance, -distance)[side], *given))
        bounds = {'theta': BOUND, 'omega': 0.5 / distance, 'alpha': 0.5 / distance**2}
        for what, bound in bounds.items():
            for field in (f'{what}_bar_block', f'{what}_bar_bar'):
                assert found[field] <= bound, (field, distance)


def test_what_slides_on_the_ground_beside_far_links_keeps_its_digits():
    """The ground is seen from a block on it, in the frame of which a rod and a bar are solved."""
    on_block = [Dyad('yoke', 'RPP', Point('crank', -0.14, 0.46), Point('ground', 1.56, -0.85),
                     ('slider', 'block'), direction_2=-0.22, slot=1.38),
                slides('far', Point('slider', 0.64, 0.43), Point('crank', 0.93, -0.25), ('a', 'b'),
                       (0.04, 1.96)),
                Dyad('rod', 'RRP', Point('ground', -0.64, -0.56), Point('block', 0.02, 0.19),
                     ('r', 's'), length_1=2.2, direction_2=-0.23, mode=1),
                bar('bar', Point('s', -0.53, -0.8), Point('ground', 0.69, -0.86), 0.025)]
    machine = Machine(on_block)
    low, high = machine.input_ranges[0]
    found = errors_of(machine, (low + 0.4 * (high - low), 1.3, -0.7))
    for field in ('omega_bar_bar', 'alpha_bar_bar', 'alpha_s'):
        assert found[field] <= BOUND, field


@pytest.mark.slow
def test_no_extrema_of_rounding_noise():
    """There were more than a hundred for each of these quantities, within 3e-6 of the limits."""
    dyads = MACHINES['from the ground']
    links = Machine(dyads).layout.moving
    machine = Machine(dyads, bodies=dict.fromkeys(links,
                                                  Body(1.5, cg_along=0.3, cg_across=-0.1,
                                                       inertia=0.4)),
                      gravity=(-4.0, -3.0))
    limits = [end.x for bound in machine.limits for end in bound]
    quantities = list(known_quantities(machine, machine.input).values())
    assert check_against_scan(machine, quantities, 1.3, -0.7, 4000, exact_values) > 40
    found = find_extrema(machine, ('omega_bar_block', 'alpha_bar_block', 'bar_inner_couple'), 1.3,
                         -0.7)
    inside = [e for e in found if e.place == 'interior']
    assert len(inside) > 6
    assert min(abs(machine.distance(e.theta1, x)) for e in inside for x in limits) > 1e-3
