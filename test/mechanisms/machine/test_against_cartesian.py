# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Random machines beside Cartesian coordinates of all links in many digits.

What is beyond the bounds is printed: family, dyads, input, field, error in eps times condition.
"""
from itertools import islice

from flint import arb, ctx
from fourbar_ros import FourBarError
from fourbar_ros.mechanisms.quantities import known
import pytest
from support.cartesian import BITS, Cartesian, errors, exact, kept_at, MANY_BITS, NoWay, toward
from support.dyad_reference import exact_values
from support.machine_families import BEGIN, FAMILIES
from support.samples import some
from support.scans import check_against_scan

MOTION_BOUND, LOADS_BOUND = 5.0, 10.0       # in eps times condition
# What docs/limitations.md states of the motion of single machines: slides behind bars or behind
# five dyads, a bar with arms of 40 and 39, a bar behind three dyads near a toggle.
STATED = {'between moving links': 10.0, 'near a toggle': 10.0, 'wide ratios': 100.0,
          'near a change point': 25.0, 'at a change point': 33.0}
STATED_LOADS = {'wide ratios': 20.0}
UNKNOWN = 0.01         # of the machines may be out of the reference's reach


def worst_of(drawn):
    """Return {'motion': (error in bounds, field), 'loads': ...} of the library in one pose."""
    machine, given, flat = drawn
    worst = {'motion': (0.0, ''), 'loads': (0.0, '')}
    with ctx.workprec(MANY_BITS if flat else BITS):
        for name, error, is_load in errors(machine, given, *exact_pose(machine, given, flat)):
            kind = 'loads' if is_load else 'motion'
            share = error / (LOADS_BOUND if is_load else MOTION_BOUND)
            if not share <= worst[kind][0]:
                worst[kind] = share, name
    return worst


def exact_pose(machine, given, flat):
    """Return the reference in one column, and next to a change point how data move with it."""
    if flat is None:
        return exact(machine, given), None
    at = flat()
    begin = float(at) + (BEGIN if given[0] > at else -BEGIN)
    found = toward(exact(machine, (begin, 1.0, 0.0)), at, arb(given[0]))
    return Cartesian(machine, given, found.q[0][:, :, 0]), kept_at(machine, at, found)


def failures(family, seed, count):
    """Return a line for each of some machines of a family that is beyond a bound; print them."""
    lines, unknown = [], 0
    for number, drawn in enumerate(islice(FAMILIES[family](seed), count)):
        machine = drawn.machine
        what = (f'{family} {seed}:{number} {machine.input} {machine.classification} at '
                f'{drawn.given[0]!r}')
        try:
            found = worst_of(drawn)
            share, name = found['motion']
            found['motion'] = share * MOTION_BOUND / STATED.get(family, MOTION_BOUND), name
            share, name = found['loads']
            found['loads'] = share * LOADS_BOUND / STATED_LOADS.get(family, LOADS_BOUND), name
        except NoWay as error:
            print(f'{what}: {error}')
            unknown += 1
            continue
        except (FourBarError, ArithmeticError) as error:
            lines.append(f'{what}: {type(error).__name__}: {error}')
            continue
        lines += [f'{what}: {kind} {share:.2g} times its bound: {name}'
                  for kind, (share, name) in found.items() if not share <= 1.0]
    print(*lines, f'{len(lines)} beyond the bounds in {count} machines, {family}', sep='\n')
    assert unknown <= UNKNOWN * count
    return lines


@some('count', [3, 25], 1)
@pytest.mark.parametrize('family', FAMILIES)
def test_random_machines(family, count):
    assert not failures(family, 411, count)


@some('family', FAMILIES, ['at a change point'])
def test_extrema_of_all_quantities_against_a_scan(family):
    for drawn in islice(FAMILIES[family](413), 3):
        quantities = list(known(drawn.machine, drawn.machine.input).values())
        assert check_against_scan(drawn.machine, quantities, 1.3, -0.7, 4000, exact_values)
