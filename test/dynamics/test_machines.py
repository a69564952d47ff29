# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines of dyads moved by a torque: Andrews' squeezer."""

from fourbar_ros import Bodies, Body, FourBar
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.run import LIMIT, REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import ConstantTorque, Drive
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np
import pytest
from support.machines import andrews, ANDREWS_ANGLE, ANDREWS_BETA, ANDREWS_RATE, UNTIL
from support.samples import some

pytest.importorskip('scipy')


def squeezer():
    machine, spring, torque = andrews()
    return System(machine.with_elements(spring), ANDREWS_BETA, 0.0, Drive(ConstantTorque(torque)))


def test_it_starts_as_published():
    """IVP Test Set: beta''(0) = 14222.4439199541, in its printed digits."""
    machine, spring, torque = andrews()
    found = Equation(machine.with_elements(spring)).acceleration(ANDREWS_BETA, 0.0, torque)
    assert abs(found - 14222.4439199541) <= 1e-10


@some('tolerance', [1e-7, 1e-9], (1e-9,))
def test_its_angle_after_30_ms(tolerance):
    run = simulate(squeezer(), UNTIL, tolerance)
    assert run.status == REACHED
    assert abs(run.position[-1] - float(ANDREWS_ANGLE)) <= tolerance
    assert abs(run.rate[-1] - float(ANDREWS_RATE)) <= 100.0 * tolerance
    # as published (PSIDE at 1e-14), whose ninth decimal is wrong by one
    assert abs(run.position[-1] - 15.81077119629904) <= 2e-9 + tolerance


def test_a_slide_that_no_dyad_limits_is_pushed_to_the_end_of_its_stroke():
    """A slider of 2 kg under 3 N from rest; the block and the bar on it have no mass."""
    machine = Machine([Dyad('d', 'RPR', Point('slider'), Point('ground', 0.0, 1.0),
                            ('block', 'bar'))], input='slide', stroke=(-1.0, 1.0),
                      bodies={'slider': Body(2.0)})
    run = simulate(System(machine, -0.5, 0.0, drive=Drive(ConstantTorque(3.0))), 5.0)
    assert run.status == LIMIT
    assert abs(run.position[-1] - 1.0) <= 1e-8
    assert abs(run.time[-1] - 2.0**0.5) <= 1e-7


def rocking(lengths, mirrored):
    """Return a released linkage of four rods, and as a machine, with a dyad without mass."""
    a1, a2, a3, a4 = lengths
    rods = [Body(length, cg_along=0.5 * length, cg_across=0.1,
                 inertia=0.1 * length**3) for length in (a1, a2, a3)]
    ends = [Point('crank', a1), Point('ground', a4)]
    names, sizes = ('coupler', 'output'), {'length_1': a2, 'length_2': a3}
    if mirrored:
        ends, names, sizes = ends[::-1], names[::-1], {'length_1': a3, 'length_2': a2}
    own = Dyad('d', 'RRR', *ends, names, **sizes, mode=1 if mirrored else 2)
    more = Dyad('e', 'RRR', Point('output', 0.4, 0.1), Point('ground', 2.5), ('rod', 'arm'),
                length_1=2.0, length_2=1.6)
    gravity = (0.5, -9.81)
    # the coupler of the kind starts at A and the output link at O4, as those of the dyad
    kind = FourBar(*lengths, bodies=Bodies(*rods), gravity=gravity)
    return kind, Machine([own, more], bodies=dict(zip(('crank', 'coupler', 'output'), rods)),
                         gravity=gravity)


ROCKING = {'no rod turns fully': ((1.0, 1.2, 0.8, 1.5), 1.0, 0.0),
           'a change point': ((2.0, 0.4, 0.8, 1.6), 0.4, -3.0)}


@some('name, mirrored', [(name, mirrored) for mirrored in (False, True) for name in ROCKING], 2)
def test_a_rocking_machine_swings_through_its_toggles_as_the_four_bar(name, mirrored):
    """Released from rest, or, of a change point, through its flat position."""
    lengths, start, rate = ROCKING[name]
    kind, machine = rocking(lengths, mirrored)
    assert not kind.turns_fully and machine.driven_otherwise()
    times = np.linspace(0.25, 5.0, 20).tolist()
    ours, theirs = (simulate(System(mechanism, start, rate), 5.0, 1e-8, times=times)
                    for mechanism in (machine, kind))
    assert ours.status == theirs.status == REACHED
    assert len(set(ours.modes.tolist())) == len(set(theirs.modes.tolist())) == 2
    assert np.abs(ours.position - theirs.position).max() <= 4e-8
    assert np.abs(ours.rate - theirs.rate).max() <= 4e-6
