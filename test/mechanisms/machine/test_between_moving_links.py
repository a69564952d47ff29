# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A drive between two moving links: the machine is solved from one, the ground is a dyad's link.

test_against_cartesian compares the family of random machines with coordinates of all links.
"""
from dataclasses import replace
from itertools import islice
import pickle

from flint import ctx
from fourbar_ros import Bodies, Body, InvalidParameter, MovingJointFourBar
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.system import System
from fourbar_ros.machine import Cylinder, Dyad, Machine, Point
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.pipeline.stepper import OK, OUT_OF_RANGE, Stepper, Wanted
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values
import numpy as np
import pytest
from support.cartesian import BITS, conditions, errors, exact, off
from support.random_machines import between_moving_links
from support.samples import more

EPS = 2.0**-52
A1, A2, A3, A4 = 0.4, 1.2, 0.8, 1.0
BODIES = [Body(mass, cg_along=along, cg_across=across, inertia=inertia)
          for mass, along, across, inertia in (
              (2.0, 0.15, 0.02, 0.04), (3.0, 0.5, -0.1, 0.3), (1.5, 0.3, 0.05, 0.1))]


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


# --- a crank on a moving link -------------------------------------------------------------------

def motor_at_a(mode, **more):
    """Return a four-bar with a motor at A, solved from its crank, here 'arm', that begins at A."""
    loop = Dyad('loop', 'RRR', Point('crank', A2), Point('arm', -A1), ('output', 'ground'),
                length_1=A3, length_2=A4, mode=mode)
    return Machine([loop], carrier='arm', output='output', **more)


@pytest.mark.parametrize('mode', [1, 2])
def test_a_motor_between_crank_and_coupler_is_that_of_the_kind(mode):
    """Every load, and the motion by torque; the output link is here seen from B."""
    crank, coupler, output = BODIES
    kind = MovingJointFourBar(A1, A2, A3, A4, mode, 'A', Bodies(crank, coupler, output),
                              (0.5, -9.81))
    bodies = {'arm': replace(crank, cg_along=crank.cg_along - A1), 'crank': coupler,
              'output': replace(output, cg_along=A3 - output.cg_along,
                                cg_across=-output.cg_across)}
    machine = motor_at_a(mode, bodies=bodies, gravity=(0.5, -9.81))
    assert machine.input_coordinate.position == 'theta_base'
    assert np.ravel(machine.input_ranges) == pytest.approx(np.ravel(kind.input_ranges), abs=1e-14)
    low, high = kind.input_ranges[0]
    x = low + (high - low) * np.linspace(0.05, 0.95, 9)
    (m, found), (of_kind, loads) = (each.step(x, 2.0, -3.0) for each in (machine, kind))
    error = 1e3 * EPS * of_kind.condition
    for name, of_machine in {'theta1': m.theta_arm, 'omega1': m.omega_arm,
                             'alpha4': m.alpha_output, 'theta2': m.theta_base}.items():
        np.testing.assert_array_less(np.abs(np.remainder(
            getattr(of_kind, name) - of_machine + np.pi, 2.0 * np.pi) - np.pi), error * 30.0)
    size = np.abs(loads.driving_torque) + sum(getattr(loads, name) for name in kind.reactions)
    for name, of_machine in {
            'driving_torque': found.driving_torque, 'shaking_force_x': found.shaking_force_x,
            'shaking_force_y': found.shaking_force_y, 'shaking_moment': found.shaking_moment,
            'f21': found.base, 'f32': found.loop_first, 'f43': found.loop_inner,
            'f41': found.loop_second}.items():
        np.testing.assert_array_less(np.abs(getattr(loads, name) - of_machine), error * size)
    start = float(x[4])
    runs = [simulate(System(each, start), 0.3) for each in (machine, kind)]
    assert runs[0].position[-1] == pytest.approx(float(np.interp(
        runs[0].time[-1], runs[1].time, runs[1].position)), abs=1e-3)


def test_the_torque_between_moving_links_does_the_work_of_the_energy():
    """T rate is the rate of kinetic and potential energy, from positions alone (Lagrange)."""
    machine = motor_at_a(2, gravity=(0.0, -9.81), bodies={
        'arm': BODIES[0], 'crank': BODIES[1], 'output': BODIES[2]})

    def energy(time):
        """Return the energy at x = 1 + sin(time)."""
        x, rate, total = 1.0 + np.sin(time), np.cos(time), 0.0
        moving = machine.link_motions(machine.motion(x, rate))
        for name, body in machine.bodies._asdict().items():
            c = point_motion(machine, machine.motion(x, rate), name, body.cg_along, body.cg_across)
            v_x, v_y = np.moveaxis(c.velocity, -1, 0)
            total = total + 0.5 * body.mass * (v_x * v_x + v_y * v_y) + (
                0.5 * body.inertia * moving[name].omega**2 + 9.81 * body.mass * c.place[..., 1])
        return total
    h, t = 1e-4, np.linspace(0.2, 1.0, 5)
    slope = (8.0 * (energy(t + h) - energy(t - h)) - energy(t + 2 * h) + energy(t - 2 * h)) / (
        12.0 * h)
    loads = machine.loads(1.0 + np.sin(t), np.cos(t), -np.sin(t))
    assert loads.driving_torque * np.cos(t) == pytest.approx(slope, rel=1e-8)


MOTOR_AT_A = {
    'linkage.kind': 'machine', 'linkage.dyads': ['loop'], 'linkage.carrier': 'arm',
    'dyads.loop.kind': 'RRR', 'dyads.loop.first.link': 'crank', 'dyads.loop.first.along': A2,
    'dyads.loop.second.link': 'arm', 'dyads.loop.second.along': -A1,
    'dyads.loop.links': ['output', 'ground'], 'dyads.loop.length_1': A3,
    'dyads.loop.length_2': A4, 'linkage.range': ['30deg', '60deg'], 'bodies.arm.mass': 2.0,
    'bodies.arm.inertia': 0.1, 'drive.start': '45deg',
    'outputs': ['state', 'links', 'loads', 'reactions', 'joint_states']}


def test_a_scene_has_it_and_its_range():
    its = scene.from_values(MOTOR_AT_A)
    assert its.linkage.carrier == 'arm' and its.linkage.bodies.arm.mass == 2.0
    assert its.linkage.input_ranges == (tuple(np.radians([30.0, 60.0])),)
    status, _ = Stepper(its).step(0.8, 1.0, 0.0, Wanted.of(its))
    assert (status, Stepper(its).step(1.2, 1.0, 0.0, Wanted.of(its))[0]) == (OK, OUT_OF_RANGE)
    assert diagram_of(its.linkage, its.linkage.motion(0.8)).angles['theta_base'] == 'base'


@pytest.mark.parametrize('given, why', [
    ({'linkage.carrier': 'ground'}, 'dyads.loop.links.*unless .* linkage.carrier is one'),
    ({'linkage.carrier': 'crank'}, 'linkage.carrier = .crank.'),
    ({'linkage.carrier': 'a b'}, 'linkage.carrier = .a b.: must be a name'),
    ({'linkage.input': 'slide', 'linkage.range': [], 'drive.start': 0.0},
     'linkage.carrier = .arm.: carries a driven crank'),
    ({'dyads.loop.links': ['output', 'rod']}, 'linkage.carrier = .arm.*ground among the links'),
])
def test_wrong_carriers_are_refused_by_name(given, why):
    with pytest.raises(InvalidParameter, match=why):
        scene.from_values({**MOTOR_AT_A, **given})


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
