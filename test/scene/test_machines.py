# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines of dyads as scenes: the machine that was meant, and mistakes refused by name."""
from math import atan2, cos, pi, remainder, sin, tau

from fourbar_ros import FourBar, InvalidParameter
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.pipeline.stepper import LOADS_UNKNOWN, Stepper, Wanted
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.message_fields import DRIVE_WRENCH
import numpy as np
import pytest
from support.scenes import PAPER, RODS

WATT = read_values('watt')
BUCKET = read_values('bucket')


def without(*names, of=None):
    """Return a scene without parameters."""
    return {name: value for name, value in (of or WATT).items() if name not in names}


def test_the_four_bar_as_a_machine_has_its_motion_and_loads():
    values = {'linkage.kind': 'machine', 'linkage.dyads': ['d'], 'dyads.d.kind': 'RRR',
              'dyads.d.first.link': 'crank', 'dyads.d.first.along': 0.4,
              'dyads.d.second.link': 'ground', 'dyads.d.second.along': 1.0,
              'dyads.d.links': ['coupler', 'output'], 'dyads.d.length_1': 1.2,
              'dyads.d.length_2': 0.8, **RODS}
    crank = scene.from_values({**PAPER, **RODS}).linkage.bodies.crank
    values |= {f'bodies.crank.{field}': getattr(crank, field)
               for field in ('mass', 'inertia', 'cg_along')}
    machine = scene.from_values(values).linkage
    four_bar = FourBar(0.4, 1.2, 0.8, 1.0, bodies=machine.bodies)
    motion, loads = machine.step(0.7, 25.0, -3.0)
    expected, forces = four_bar.step(0.7, 25.0, -3.0)
    assert motion.omega_output == pytest.approx(expected.omega4, rel=1e-13)
    assert loads.driving_torque == pytest.approx(forces.driving_torque, rel=1e-12)
    # of the ground, of the crank, of the output link on the coupler
    for field, name, sign in (('base', 'f41', 1.0), ('d_first', 'f21', -1.0),
                              ('d_inner', 'f32', 1.0), ('d_second', 'f43', 1.0)):
        assert [getattr(loads, f'{field}_{axis}') for axis in 'xy'] == pytest.approx(
            [sign * getattr(forces, f'{name}_{axis}') for axis in 'xy'], rel=1e-12), field


def test_jansens_foot_has_the_published_distances():
    """All thirteen numbers, as distances of joints in the pose."""
    its = scene.load('jansen')
    machine = its.linkage
    for theta in np.linspace(0.0, 2.0 * pi, 7):
        motion = machine.motion(theta)

        def at(link, along=0.0, across=0.0, motion=motion):
            return point_motion(machine, motion, link, along, across).place

        pin, hip = np.array((0.15 * cos(theta), 0.15 * sin(theta))), at('hip')
        top, knee, ankle = at('j', 0.5), at('k', 0.619), at('f', 0.394)
        back, foot = at('hip', *machine.dyads[2].first[1:]), at(*its.points['foot'])
        lengths = [
            (hip, top, 41.5), (hip, knee, 39.3), (hip, back, 40.1), (top, back, 55.8),
            (back, ankle, 39.4), (knee, ankle, 36.7), (ankle, foot, 65.7), (knee, foot, 49.0),
            (pin, top, 50.0), (pin, knee, 61.9)]
        for one, other, expected in lengths:
            assert 100.0 * np.hypot(*(one - other)) == pytest.approx(expected, rel=1e-12)
        assert (100.0 * hip).tolist() == pytest.approx([-38.0, -7.8], rel=1e-14)


def test_a_cylinder_pushes_along_its_rod_and_a_wrench_acts_on_a_link_by_name():
    values = {**BUCKET, 'outputs': ['loads', 'drive_wrench'], 'drive.timeout': 0.0}
    for link in ('rod', 'tube'):
        values = without(*(f'bodies.{link}.{name}' for name in ('mass', 'inertia', 'cg_along')),
                         of=values)
    its = scene.from_values(values)
    _, found = Stepper(its).step(1.8, 0.3, -2.0, Wanted(with_loads=True))
    _, loads = its.linkage.step(1.8, 0.3, -2.0)
    # the cylinder has no mass: what the drive feels is what the crank does to the rod
    expected = loads.cylinder_first_x, loads.cylinder_first_y
    wrench = [found[its.layout.index_of[name]] for name in DRIVE_WRENCH]
    assert wrench[:2] == pytest.approx(expected, rel=1e-12) and wrench[2] == 0.0
    topic = scene.from_values({**values, 'external.bucket.from_topic': True,
                               'external.bucket.force_x': 0.0, 'external.bucket.force_y': 0.0})
    assert [each.topic for each in topic.recorded if 'bucket' in each.name] == [
        '~/external/bucket', '~/applied/bucket']
    stepper = Stepper(topic)
    assert stepper.step(1.8, 0.3, -2.0, Wanted(with_loads=True))[0] == LOADS_UNKNOWN
    stepper.act('bucket', Wrench(-40000.0, 60000.0, 0.0))
    assert stepper.step(1.8, 0.3, -2.0, Wanted(with_loads=True))[1] == found


def test_the_counterweight_of_the_v_engine_balances_the_first_order():
    machine = scene.load('v_engine').linkage
    speed = 628.0
    turn = np.arange(256) * 2.0 * pi / 256
    _, loads = machine.step(turn, speed)
    force = np.fft.fft(loads.shaking_force_x + 1j * loads.shaking_force_y) / 256
    size = abs(force).max()
    assert abs(force[1]) < 1e-12 * size and abs(force[-1]) < 1e-12 * size
    assert size > 1000.0


def test_the_quick_return_has_the_ratio_of_times_of_its_geometry():
    machine = scene.load('quick_return').linkage
    turn = np.linspace(-pi, pi, 20001)
    velocity = machine.motion(turn, 10.0).slide_ram_velocity
    share = np.count_nonzero(velocity > 0.0) / len(turn)
    ratio = max(share, 1.0 - share) / min(share, 1.0 - share)
    arc = 2.0 * np.arcsin(0.4)
    assert ratio == pytest.approx((pi + arc) / (pi - arc), rel=1e-3)


def test_a_scene_of_a_cylinder_without_dyads_is_the_inverted_slider():
    body = {'mass': 800.0, 'inertia': 900.0, 'cg_along': 2.0}
    load = {'force_x': 300.0, 'force_y': -5000.0, 'along': 3.7, 'across': 0.1, 'couple': -700.0}
    boom = {'linkage.input': 'slide', 'linkage.range': [1.0, 1.8], 'gravity.y': -9.81,
            **{f'bodies.crank.{name}': value for name, value in body.items()},
            **{f'external.crank.{name}': value for name, value in load.items()}}
    one = scene.from_values({**boom, 'linkage.kind': 'inverted_slider', 'linkage.a1': 1.2,
                             'linkage.a4': 1.6, 'bodies.coupler.mass': 40.0,
                             'bodies.coupler.inertia': 4.0, 'bodies.output.mass': 60.0,
                             'bodies.output.inertia': 8.0, 'bodies.output.cg_along': 0.5}).linkage
    other = scene.from_values({**boom, 'linkage.kind': 'machine', 'linkage.input': 'cylinder',
                               'linkage.dyads': [], 'cylinder.base.along': 1.6,
                               'cylinder.pin.along': 1.2, 'bodies.rod.mass': 40.0,
                               'bodies.rod.inertia': 4.0, 'bodies.tube.mass': 60.0,
                               'bodies.tube.inertia': 8.0, 'bodies.tube.cg_along': 0.5}).linkage
    assert other.outputs[0].coordinate.position == 'theta_crank'
    motion, loads = one.step(1.4, -2.0, 7.0)
    own, by_dyads = other.step(1.4, -2.0, 7.0)
    assert own.theta_crank == pytest.approx(motion.theta1, rel=1e-14)
    for field in ('driving_force', 'shaking_force_x', 'shaking_force_y', 'shaking_moment'):
        assert getattr(by_dyads, field) == pytest.approx(getattr(loads, field), rel=1e-13), field


@pytest.mark.parametrize('name', ['jansen', 'bucket', 'hart'])
def test_joints_stand_in_the_order_and_count_the_angles_of_the_page_about_robots(name):
    machine = scene.load(name)
    linkage, values = machine.linkage, machine.values
    low, high = linkage.input_ranges[0]
    motion = linkage.motion(0.6 * low + 0.4 * high)
    dyads = ['cylinder'] * (linkage.input == 'cylinder') + values['linkage.dyads']
    joints = [f'{dyad}_{place}' for dyad in dyads for place in ('first', 'inner', 'second')]
    assert machine.joint_names == ('base', *joints)

    def angle(link):
        if link == 'ground':
            return 0.0
        turned = linkage.link_motion(motion, link)
        return atan2(turned.sine, turned.cosine)
    for dyad in values['linkage.dyads']:
        if values[f'dyads.{dyad}.kind'] == 'RRR':
            one, two = values[f'dyads.{dyad}.links']
            ends = next(stage for stage in linkage.stages if stage.name == dyad)
            expected = (angle(one) - angle(ends.first.link), angle(two) - angle(one),
                        angle(two) - angle(ends.second.link))
            place = machine.joint_names.index(f'{dyad}_first')
            for joint, value in zip(linkage.JOINTS[place:], expected):
                error = getattr(motion, joint.coordinate.position) - value
                assert abs(remainder(error, tau)) < 1e-12


@pytest.mark.parametrize('name, changes, joints', [
    ('jansen', {'linkage.pivot': 'knee'}, 'base and '),
    ('jansen', {'dyads.lower.inner': 'pivot'}, ''),
    ('watt', {'linkage.pivot': 'T', 'dyads.one.inner': 'T'}, 'base and one_inner'),
    ('watt', {'dyads.one.inner': 'T', 'dyads.two.inner': 'T'}, 'one_inner and two_inner')])
def test_one_name_for_joints_at_two_points_is_refused(name, changes, joints):
    values = scene.load(name).values
    with pytest.raises(InvalidParameter) as error:
        scene.from_values({**values, **changes})
    parameter, name = error.value.name, [*changes.values()][0]
    assert {**values, **changes}[parameter] == name     # it is one that the scene has
    assert f"= '{name}': names two joints that are not at one point, {joints}" in str(error.value)
    scene.from_values({**values, 'linkage.pivot': 'Z'})       # jansen's knee is several joints
