# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A linkage on a body that moves, as an IMU or a simulator tells the node."""
from math import cos, isnan, nan, pi, sin, tau

from fourbar_msgs.msg import Base as BaseMessage
from fourbar_msgs.msg import DriveState, LinkageLoads, LinkageState
from fourbar_ros import Base
from fourbar_ros.errors import UnknownBaseMotion
from fourbar_ros.pipeline.wrenches import Imu
from fourbar_ros.ros.messages import to_stamp
from fourbar_ros.scene.scene import from_values
from geometry_msgs.msg import WrenchStamped
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from std_msgs.msg import Header
from support.harness import LATCHED, recomputed, recording_in
from support.scenes import PAPER, RODS

LOADED = {**PAPER, **RODS, 'outputs': ['state', 'loads', 'shaking_wrench'],
          'drive.source': 'motion', 'drive.timeout': 0.0}


def test_a_simulator_says_all_and_the_bag_recomputes(run_node, lockstep, tmp_path):
    given = {**LOADED, 'base.topic': 'motion_of_base', 'base.timeout': 0.0,
             **recording_in(tmp_path)}
    node, ask = run_node(given), lockstep('state', 'loads')
    linkage, rng = from_values(given).linkage, np.random.default_rng(5)
    for number in range(1, 31):
        base = Base(*rng.normal(0.0, 5.0, 4).tolist())
        answer = ask(0.001 * number, 0.1 * number, 2.0, 3.0, base)
        assert answer.loads.f43 == linkage.loads(0.1 * number, 2.0, 3.0, base=base).f43
    node.stop()
    assert recomputed(tmp_path / 'run').compared > 80


def test_what_is_late_silent_or_of_another_frame_does_not_act(run_node, client, lockstep):
    node = run_node({**LOADED, 'base.topic': 'motion_of_base', 'base.timeout': 2.0,
                     'base.frame_id': 'chassis'})
    ask = lockstep('state', 'loads')
    assert isnan(ask(0.001, 0.3, 2.0, 3.0).loads.f41)
    in_effect = client.hear(BaseMessage, '/fourbar/base', LATCHED)
    publisher = client.node.create_publisher(BaseMessage, '/fourbar/input_base', 100)
    client.until(lambda: in_effect and publisher.get_subscription_count(), 'the topics')

    def send(stamp, frame, force):
        publisher.publish(BaseMessage(force_y=force, header=Header(stamp=to_stamp(stamp),
                                                                   frame_id=frame)))
    send(10**9, 'chassis', 9.81)
    client.until(lambda: 9.81 in [its.force_y for its in in_effect], 'the base')
    send(10**9, 'chassis', 5.0)
    client.until(lambda: 'not newer than the one before' in node.said, 'late')
    send(2 * 10**9, 'fourbar', 5.0)
    client.until(lambda: "in the frame 'fourbar', this one is 'chassis'" in node.said,
                 'another frame')
    client.until(lambda: isnan(in_effect[-1].force_y), 'the silence')
    assert 5.0 not in [its.force_y for its in in_effect]
    answer = ask(0.002, 0.3, 2.0, 3.0)
    assert answer.state.status == LinkageState.STATUS_LOADS_UNKNOWN and isnan(answer.loads.f41)


def test_two_nodes_on_one_base_pass_their_loads_on(run_node, client, lockstep, tmp_path):
    """The output of one drives the crank of the other, whose drive wrench acts on the first."""
    both = {**LOADED, 'base.topic': 'motion_of_base', 'base.timeout': 60.0}
    node = run_node({**both, 'outputs': ['state', 'loads', 'output'],
                     'external.output.from_topic': True, **recording_in(tmp_path)},
                    remaps=('~/external/output:=/two/drive_wrench',))
    run_node({**both, 'outputs': ['loads', 'drive_wrench']}, name='two',
             remaps=('~/input:=/fourbar/output',))
    base, ask = Base(1.0, 9.0, 2.0, -3.0), lockstep('state', 'loads')
    in_effect = client.hear(BaseMessage, '/two/base', LATCHED)
    tell = client.node.create_publisher(BaseMessage, '/two/input_base', 100)
    client.until(lambda: tell.get_subscription_count() and in_effect, 'the topics')
    tell.publish(BaseMessage(**base._asdict(), header=Header(stamp=to_stamp(10**6))))
    client.until(lambda: in_effect[-1].rate == base.rate, 'the base')
    linkage, due, answers = from_values(both).linkage, {}, client.hear(
        LinkageLoads, '/two/loads')

    def chained():
        number = 1 + len(due)
        state = ask(0.001 * number, 0.01 * number, 2.0, 3.0, base).state
        due[number * 10**6] = linkage.loads(state.theta4, state.omega4, state.alpha4,
                                            base=base).driving_torque
        return len(answers) >= 20
    client.until(chained, 'twenty answers of the second')
    for its in answers:
        assert its.driving_torque == due[its.header.stamp.sec * 10**9 + its.header.stamp.nanosec]
    node.stop()
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
    base = client.node.create_publisher(BaseMessage, '/fourbar/input_base', 100)
    payload = client.node.create_publisher(WrenchStamped, '/fourbar/external/output', 100)
    client.until(lambda: base.get_subscription_count() and payload.get_subscription_count()
                 and states, 'the topics')
    assert states[-1].status == DriveState.STATUS_FAILED         # it stands: nothing is known
    wrench = WrenchStamped()
    wrench.wrench.force.y = -40.0
    for number in range(1, 60):
        message = BaseMessage(force_x=sin(number), force_y=9.81, rate=0.3, acceleration=0.1)
        message.header.stamp = to_stamp(number * 10**6)
        base.publish(message)
        payload.publish(wrench)
        client.spin(0.01)
    assert states[-1].status == DriveState.STATUS_SILENT and states[-1].velocity != 0.0
    # no torque acts: the loads of this acceleration, base and payload ask for none
    assert abs(loads[-1].driving_torque) <= 1e-9 * (1.0 + abs(loads[-1].f41))
    assert node.stop() == 0
    assert recomputed(tmp_path / 'run').stepped > 100


@pytest.mark.parametrize('angles', [(), (0.4, -0.9, 2.0), (pi / 2, 0.0, 0.0)])
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
    assert isnan(bases[0].acceleration)
    assert [base.acceleration for base in bases[1:3]] == pytest.approx([2.0, 2.0])
    assert all(isnan(base.acceleration) for base in bases[3:])     # a pause, a step back
    assert isnan(reading.update(4 * 10**8 + 1, (0, 0, 0), (0, 0, nan)).rate)


@given(st.lists(st.sampled_from((1, 1, 1, 2, 3, 7, 40)), min_size=3, max_size=60),
       st.floats(0.2, 3.0))
def test_no_acceleration_is_wrong_beyond_its_lag(steps, frequency):
    """Of a base that swings, through pauses: what is told is the slope of one step or two."""
    reading, time, step = Imu((), 2, 1.0), 10**9, 10**7
    for place, number in enumerate(steps):
        time += number * step
        rate = sin(tau * frequency * time * 1e-9)
        found = reading.update(time, (0.0, 9.81, 0.0), (0.0, 0.0, rate)).acceleration
        is_pause = place > 1 and number > 2.5 * steps[place - 1]
        assert isnan(found) == (place == 0 or is_pause)
        if isnan(found):
            continue
        true = tau * frequency * cos(tau * frequency * time * 1e-9)
        late = 0.5 * number * step * 1e-9 * (tau * frequency)**2
        assert abs(found - true) <= late + 1e-6


def test_loads_without_the_base_are_refused():
    scene = from_values({**LOADED, 'base.topic': 'imu'})
    with pytest.raises(UnknownBaseMotion, match='motion of the base comes from a topic'):
        scene.linkage.loads(0.3)
