# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A cylinder between two moving links: the machine is solved from one, the ground is a dyad's link.

test_against_cartesian compares the family of random machines with coordinates of all links.
"""
from dataclasses import replace
from itertools import islice
import pickle

from flint import ctx
from fourbar_ros import Body, InvalidParameter
from fourbar_ros.machine import Cylinder, Dyad, Machine, Point
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values
import numpy as np
import pytest
from support.cartesian import BITS, conditions, errors, exact, off
from support.random_machines import between_moving_links
from support.samples import more

EPS = 2.0**-52
A1, A2, A3, A4 = 0.4, 1.2, 0.8, 1.0


def test_near_toggles_small_loads_keep_their_digits(count=more(3, 10)):
    """As differences of what the frame sees, they had errors of 4e10 eps times their condition."""
    for machine, given, _ in islice(between_moving_links(412, near_limit=True), count):
        with ctx.workprec(BITS):
            near = exact(machine, given)
            assert max(error for _, error, is_load in errors(machine, given, near)
                       if not is_load) <= 5.0
            _, found = conditions(near, given)
            loads = machine.step(*given)[1]
            for name, (truth, condition) in found.items():
                assert float(abs(off(name, loads, truth))) <= 10.0 * EPS * condition, name


# --- the shipped lift table ----------------------------------------------------------------------

def lift():
    return scene.from_values(read_values('lift_table')).linkage


def test_a_lift_table_rises_level():
    machine = lift()
    motion = machine.motion(np.linspace(*machine.input_ranges[0], 7), 1.0)
    assert (np.diff(motion.y_table) > 0.05).all() and (motion.dy_table > 0.5).all()
    assert np.abs(motion.theta_table).max() <= 100 * EPS


def test_the_force_of_a_lift_does_not_depend_on_where_the_load_stands():
    machine = replace(lift(), bodies={'table': Body(0.0)}, gravity=(0.0, 0.0))
    loads = []
    for along in (0.1, 0.5, 0.9):
        load = replace(machine.external.table, along=along)
        loads.append(replace(machine, external={'table': load}).step(0.6, 0.05)[1])
    expected = 5000.0 * machine.motion(0.6, 1.0).dy_table
    for its in loads:
        assert its.driving_force == pytest.approx(expected, rel=1000 * EPS)
        assert its.shaking_force_y == pytest.approx(-5000.0, rel=100 * EPS)
    assert loads[0].top_first < loads[1].top_first < loads[2].top_first


def test_it_is_pickled_and_takes_other_lengths():
    machine = lift()
    for other in (pickle.loads(pickle.dumps(machine)), machine.with_lengths(machine.lengths)):
        assert other.step(0.6, 0.05) == machine.step(0.6, 0.05)


# --- what cannot be ------------------------------------------------------------------------------

def four_bar(base='leg', pin='crank', links=('output', 'ground'), own=('rod', 'tube')):
    dyad = Dyad('loop', 'RRR', Point('crank', A2), Point(base, A1), links, length_1=A3,
                length_2=A4)
    return Machine([dyad], 'cylinder', cylinder=Cylinder(Point(base, 0.3), Point(pin, 0.5), own))


@pytest.mark.parametrize('given, why', [
    ({'pin': 'output'}, 'cylinder.pin = .*no pin joins .* Assur group of a higher class'),
    ({'base': 'crank'}, 'cylinder.base = .*point of the ground, or of a moving link'),
    ({'base': 'rod'}, 'cylinder.base = .*point of the ground, or of a moving link'),
    ({'base': 'a b'}, 'cylinder.base.link = .*letters'),
    ({'links': ('output', 'swing')}, 'cylinder.base.link = .leg.*ground among the links'),
    ({'links': ('leg', 'ground')}, 'dyads.loop.links = .leg.: is the link at the'),
    ({'base': 'ground'}, 'dyads.loop.links.*unless cylinder.base'),
])
def test_mistakes_are_refused_by_name(given, why):
    assert four_bar().input_ranges
    with pytest.raises(InvalidParameter, match=why):
        four_bar(**given)


def test_a_scene_with_a_cylinder_from_crank_to_output_is_refused_with_the_reason():
    with pytest.raises(InvalidParameter, match='cylinder.pin.*Assur group of a higher class'):
        scene.from_values({**read_values('lift_table'), 'cylinder.pin.link': 'table'})
