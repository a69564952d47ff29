# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A linkage on a body that moves, as an IMU or a simulator tells the node."""
import math

from fourbar_lab.clients.node_client import name_on
from fourbar_msgs.msg import Base as BaseMessage
from fourbar_msgs.msg import DriveState, LinkageLoads, LinkageState, Motion
from fourbar_ros import Base, InvalidParameter
from fourbar_ros.pipeline.base import Imu
from fourbar_ros.ros.messages import to_stamp
from fourbar_ros.scene.scene import from_values
from fourbar_ros.scene.topics import BASE, BASES, OUTPUTS, wrench_topic
from geometry_msgs.msg import WrenchStamped
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import Imu as ImuMessage
from support.harness import recomputed, recording_in
from support.scenes import PAPER, RODS

MILLISECOND = 10**6
LOADED = {**PAPER, **RODS, 'outputs': ['state', 'loads', 'shaking_wrench'],
          'drive.source': 'motion', 'drive.timeout': 0.0}
NAN = math.nan


def imu(time, force, rate, frame=''):
    message = ImuMessage()
    message.header.stamp, message.header.frame_id = to_stamp(time), frame
    linear, angular = message.linear_acceleration, message.angular_velocity
    linear.x, linear.y, linear.z = force
    angular.x, angular.y, angular.z = rate
    return message


class Carried:
    """A node on a base that a test moves, and its answers."""

    def __init__(self, run_node, client, topic='imu', node='fourbar', remaps=(), **parameters):
        self.client = client
        values = {**LOADED, 'base.topic': topic, 'base.timeout': 60.0,
                  **{name.replace('__', '.'): value for name, value in parameters.items()}}
        self.node = run_node(values, name=node, remaps=remaps)
        self.linkage, self.in_effect, self.time = from_values(values).bare_linkage, [], 10**9
        client.node.create_subscription(
            BaseMessage, name_on(node, BASE), self.in_effect.append,
            QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self.received = {'state': [], 'loads': []}
        for name, inbox in self.received.items():
            client.subscribe(OUTPUTS[name], inbox.append, node, 100)
        self.publisher = client.node.create_publisher(
            ImuMessage if topic == 'imu' else BaseMessage, name_on(node, BASES[topic]), 100)
        self._drive = client.publisher(node=node)
        is_driven = '~/input:=' not in ' '.join(remaps)
        client.until(lambda: self.publisher.get_subscription_count() and self.in_effect and (
            self._drive.get_subscription_count() or not is_driven), 'the topics')
        assert math.isnan(self.in_effect[0].rate)       # before a message
        while is_driven and not all(self.received.values()):
            self._drive.publish(Motion(position=0.1))
            client.spin(0.1)

    def send(self, message):
        """Send a message of the base until it is in effect."""
        stamp = message.header.stamp
        self.publisher.publish(message)
        self.client.until(lambda: self.in_effect[-1].header.stamp == stamp, 'the base')
        its = self.in_effect[-1]
        return Base(its.force_x, its.force_y, its.rate, its.acceleration)

    def answer(self, position, rate=2.0, acceleration=3.0):
        """Return (state, loads) of an input."""
        self.time += MILLISECOND
        message = Motion(position=position, velocity=rate, acceleration=acceleration)
        message.header.stamp = stamp = to_stamp(self.time)
        self._drive.publish(message)
        return self.received_at(stamp)

    def received_at(self, stamp):
        """Return (state, loads) of a stamp."""
        inboxes = self.received.values()
        self.client.until(lambda: all(inbox and inbox[-1].header.stamp == stamp
                                      for inbox in inboxes), 'an answer')
        return tuple(inbox[-1] for inbox in inboxes)


def test_loads_are_those_on_the_base_that_the_imu_tells(run_node, client):
    carried = Carried(run_node, client)
    state, loads = carried.answer(0.3)
    assert state.status == LinkageState.STATUS_LOADS_UNKNOWN and math.isnan(loads.f41)
    carried.send(imu(MILLISECOND, (0.0, 9.81, 0.0), (0.0, 0.0, 1.0)))
    assert carried.answer(0.3)[0].status == LinkageState.STATUS_LOADS_UNKNOWN    # one rate alone
    base = carried.send(imu(2 * MILLISECOND, (1.5, 9.0, 0.2), (0.0, 0.0, 1.25)))
    assert base == Base(1.5, 9.0, 1.25, pytest.approx(250.0, rel=1e-9))
    state, loads = carried.answer(0.3)
    assert state.status == LinkageState.STATUS_OK
    due = carried.linkage.loads(0.3, 2.0, 3.0, base=base)
    assert (loads.f41, loads.shaking_moment) == (due.f41, due.shaking_moment)


def test_a_simulator_says_all_and_the_bag_recomputes(run_node, client, tmp_path):
    carried = Carried(run_node, client, 'motion_of_base', **recording_in(tmp_path))
    rng = np.random.default_rng(5)
    for number in range(30):
        base = Base(*rng.normal(0.0, 5.0, 4).tolist())
        message = BaseMessage(**base._asdict())
        message.header.stamp = to_stamp((number + 1) * MILLISECOND)
        assert carried.send(message) == base
        _, loads = carried.answer(0.1 * number)
        assert loads.f43 == carried.linkage.loads(0.1 * number, 2.0, 3.0, base=base).f43
    carried.node.stop()
    assert recomputed(tmp_path / 'run').compared > 80


def test_what_is_late_silent_or_of_another_frame_does_not_act(run_node, client):
    carried = Carried(run_node, client, 'motion_of_base', base__timeout=2.0,
                      base__frame_id='chassis')
    good = BaseMessage(force_y=9.81)
    good.header.stamp, good.header.frame_id = to_stamp(9 * MILLISECOND), 'chassis'
    carried.send(good)
    assert carried.answer(0.3)[0].status == LinkageState.STATUS_OK
    carried.publisher.publish(BaseMessage(header=good.header, force_y=5.0))
    client.until(lambda: 'not newer than the one before' in carried.node.said, 'late')
    other = BaseMessage(force_y=5.0)
    other.header.stamp, other.header.frame_id = to_stamp(10 * MILLISECOND), 'fourbar'
    carried.publisher.publish(other)
    client.until(lambda: "in the frame 'fourbar', this one is 'chassis'" in carried.node.said,
                 'another frame')
    client.until(lambda: math.isnan(carried.in_effect[-1].force_y), 'the silence')
    assert [its.force_y for its in carried.in_effect if its.force_y == 5.0] == []
    state, loads = carried.answer(0.3)
    assert state.status == LinkageState.STATUS_LOADS_UNKNOWN and math.isnan(loads.f41)


def test_two_nodes_on_one_base_pass_their_loads_on(run_node, client, tmp_path):
    """The output of one drives the crank of the other, whose drive wrench acts on the first."""
    second = Carried(run_node, client, 'motion_of_base', node='two',
                     remaps=('~/input:=/fourbar/output',),
                     outputs=['state', 'loads', 'drive_wrench'])
    first = Carried(run_node, client, 'motion_of_base', outputs=['state', 'loads', 'output'],
                    remaps=('~/external/output:=/two/drive_wrench',),
                    external__output__from_topic=True, **recording_in(tmp_path))
    while not second.received['loads']:         # until the nodes have found each other
        first.answer(0.0)
        client.spin(0.1)
    base = Base(1.0, 9.0, 2.0, -3.0)
    for number in range(1, 21):
        message = BaseMessage(**base._asdict())
        message.header.stamp = to_stamp(number * MILLISECOND)
        first.send(message)
        second.send(message)
        state, loads = first.answer(0.01 * number)
        _, its = second.received_at(state.header.stamp)
        due = second.linkage.loads(state.theta4, state.omega4, state.alpha4, base=base)
        assert its.driving_torque == due.driving_torque
    assert state.status == LinkageState.STATUS_OK
    first.node.stop()
    assert recomputed(tmp_path / 'run').compared > 40


def test_a_motion_by_torque_feels_base_and_payload_and_recomputes(run_node, client, tmp_path):
    values = {**LOADED, 'drive.source': 'torque', 'drive.rate': 500.0, 'drive.when_silent': 'hold',
              'base.topic': 'motion_of_base', 'base.timeout': 60.0,
              'external.timeout': 60.0, 'external.output.from_topic': True,
              'external.output.along': 0.5, 'outputs': ['state', 'loads'],
              **recording_in(tmp_path)}
    node = run_node(values)
    states = client.hear(DriveState, '/fourbar/drive_state')
    loads = client.hear(LinkageLoads, '/fourbar/loads')
    base = client.node.create_publisher(BaseMessage, name_on('fourbar', BASES['motion_of_base']),
                                        100)
    payload = client.node.create_publisher(WrenchStamped, name_on('fourbar',
                                                                  wrench_topic('output')), 100)
    client.until(lambda: base.get_subscription_count() and payload.get_subscription_count()
                 and states, 'the topics')
    assert states[-1].status == DriveState.STATUS_FAILED         # it stands: nothing is known
    wrench = WrenchStamped()
    wrench.wrench.force.y = -40.0
    for number in range(1, 60):
        message = BaseMessage(force_x=math.sin(number), force_y=9.81, rate=0.3, acceleration=0.1)
        message.header.stamp = to_stamp(number * MILLISECOND)
        base.publish(message)
        payload.publish(wrench)
        client.spin(0.01)
    assert states[-1].status == DriveState.STATUS_SILENT and states[-1].velocity != 0.0
    # no torque acts: the loads of this acceleration, base and payload ask for none
    assert abs(loads[-1].driving_torque) <= 1e-9 * (1.0 + abs(loads[-1].f41))
    assert node.stop() == 0
    assert recomputed(tmp_path / 'run').stepped > 100


@pytest.mark.parametrize('angles', [(), (0.4, -0.9, 2.0), (math.pi / 2, 0.0, 0.0)])
def test_an_imu_is_turned_into_the_plane(angles):
    turned = Rotation.from_euler('xyz', angles or (0.0, 0.0, 0.0))
    force, rate = np.array([1.0, -2.0, 9.0]), np.array([0.1, 0.2, 0.3])
    for rotation in (angles, turned.as_quat().tolist()):
        base = Imu(rotation, 2, 1.0).update(1, force.tolist(), rate.tolist())
        ours, about = turned.inv().apply(force), turned.inv().apply(rate)
        assert np.allclose(base[:3], [*ours[:2], about[2]], atol=1e-14)


def test_angular_acceleration_is_the_slope_of_the_rates():
    reading = Imu((), 3, 0.3)
    bases = [reading.update(time, (0, 0, 0), (0, 0, 2.0 * time * 1e-9))
             for time in (10**7, 2 * 10**7, 3 * 10**7, 5 * 10**8, 4 * 10**8)]
    assert math.isnan(bases[0].acceleration)
    assert [base.acceleration for base in bases[1:3]] == pytest.approx([2.0, 2.0])
    assert all(math.isnan(base.acceleration) for base in bases[3:])     # a pause, a step back
    assert math.isnan(reading.update(4 * 10**8 + 1, (0, 0, 0), (0, 0, NAN)).rate)


@given(st.lists(st.sampled_from((1, 1, 1, 2, 3, 7, 40)), min_size=3, max_size=60),
       st.floats(0.2, 3.0))
def test_no_acceleration_is_wrong_beyond_its_lag(steps, frequency):
    """Of a base that swings, through pauses: what is told is the slope of one step or two."""
    reading, time, step = Imu((), 2, 1.0), 10**9, 10**7
    for place, number in enumerate(steps):
        time += number * step
        rate = math.sin(math.tau * frequency * time * 1e-9)
        found = reading.update(time, (0.0, 9.81, 0.0), (0.0, 0.0, rate)).acceleration
        is_pause = place > 1 and number > 2.5 * steps[place - 1]
        assert math.isnan(found) == (place == 0 or is_pause)
        if math.isnan(found):
            continue
        true = math.tau * frequency * math.cos(math.tau * frequency * time * 1e-9)
        late = 0.5 * number * step * 1e-9 * (math.tau * frequency)**2
        assert abs(found - true) <= late + 1e-6


def test_loads_without_the_base_are_refused():
    scene = from_values({**LOADED, 'base.topic': 'imu'})
    with pytest.raises(InvalidParameter, match='motion of the base comes from a topic'):
        scene.loads(0.3)
