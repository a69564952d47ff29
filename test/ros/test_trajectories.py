# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trajectories of the output over the wire: there and back, gears, and refusals with a reason."""
from builtin_interfaces.msg import Duration
from fourbar_ros.ros.node.trajectories import FIELDS
from fourbar_ros.scene.topics import ANSWERS, TRAJECTORIES
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from support.harness import Client, NodeProcess, set_parameters
from support.scenes import PAPER, RODS
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

GEARED = {**PAPER, **RODS, 'drive.source': 'motion', 'drive.start': 1.0, 'trajectories': True,
          'joint_names': ['motor', 'a', 'b', 'leg'], 'outputs': ['state'],
          'joint_states.ratios': [-3.0, 1.0, 1.0, 2.0],
          'joint_states.offsets': [0.2, 0.0, 0.0, -0.5]}


def message(joint, way, **others):
    """Return a JointTrajectory of one joint beside another."""
    found = JointTrajectory(joint_names=['other', joint])
    for k, position in enumerate(way):
        point = JointTrajectoryPoint(positions=[9.0, float(position)],
                                     velocities=[9.0, 0.3 * k], accelerations=[9.0, 1.0 - k],
                                     effort=[9.0, 2.0 * k], time_from_start=Duration(sec=k))
        for name, value in others.items():
            setattr(point, name, value)
        found.points.append(point)
    return found


class Asker:
    """Publishes trajectories and hears answers and refusals."""

    def __init__(self, client, node='fourbar'):
        self.client, self.heard, self._publishers = client, {}, {}
        for name, topic in TRAJECTORIES.items():
            kind = String if topic.type.endswith('String') else JointTrajectory
            full = topic.topic.replace('~', f'/{node}')
            if name in ANSWERS:
                self._publishers[name] = client.node.create_publisher(kind, full, 1000)
            else:
                self.heard[name] = client.hear(kind, full)
        client.until(lambda: all(p.get_subscription_count() for p in self._publishers.values())
                     and all(client.node.count_publishers(t.topic.replace('~', f'/{node}'))
                             for n, t in TRAJECTORIES.items() if n in self.heard), 'the topics')
        self.client.until(self._is_discovered, 'an answer')

    def _is_discovered(self):
        """Send what is refused until it is, then forget the refusals."""
        for name in self._publishers:
            self.send(name, JointTrajectory())
        self.client.spin(0.2)
        return len(self.heard['trajectory_refused']) >= 2

    def send(self, name, what):
        self._publishers[name].publish(what)

    def ask(self, name, what, answer):
        count = len(self.heard[answer])
        self.send(name, what)
        self.client.until(lambda: len(self.heard[answer]) > count, answer)
        return self.heard[answer][-1]

    def refused(self, what, why):
        """Wait for the refusal; those of the discovery may still be on their way."""
        self.send('output_trajectory', what)
        self.client.until(lambda: any(why in said.data for said in
                                      self.heard['trajectory_refused']), why)


@pytest.fixture(scope='module')
def client():
    """Return the Client of all tests."""
    made = Client()
    yield made
    made.close()


@pytest.fixture(scope='module')
def geared(client, tmp_path_factory):
    """Return (Asker of a node behind gears, function that sets its parameters)."""
    node = NodeProcess({**GEARED, 'drive.timeout': 0.0}, tmp_path_factory.mktemp('geared'),
                       name='geared')

    def put(**values):
        assert set_parameters(client, {
            name.replace('__', '.'): value for name, value in values.items()},
            node='geared')[0].successful
    yield Asker(client, 'geared'), put
    assert node.stop() == 0 and 'Traceback' not in node.said, node.said


def column(trajectory, name):
    return np.array([getattr(point, name)[-1] for point in trajectory.points])


def test_an_answer_holds_what_is_asked_for_and_known(geared):
    """Without a word no effort, which joint_trajectory_controller would refuse."""
    (asker, put), wanted = geared, message('leg', [3.0, 3.2])
    plain = message('leg', [3.0, 3.2], accelerations=[], effort=[])
    for asked, given, has in ((None, wanted, FIELDS[:3]), (None, plain, FIELDS[:2]),
                              (['accelerations'], wanted, ('positions', 'accelerations')),
                              (['effort'], wanted, ('positions', 'effort'))):
        if asked is not None:
            put(trajectory_fields=asked)
        answer = asker.ask('output_trajectory', given, 'drive_trajectory')
        assert all(len(getattr(point, name)) == (name in has)
                   for point in answer.points for name in FIELDS), answer
    asker.refused(plain, 'accelerations: must be given for an effort')


def test_a_wanted_output_becomes_a_drive_and_comes_back(geared):
    asker, put = geared
    put(trajectory_fields=list(FIELDS[1:]))
    wanted = message('leg', 2.0 * np.linspace(1.7, 2.2, 5) - 0.5)
    drive = asker.ask('output_trajectory', wanted, 'drive_trajectory')
    assert list(drive.joint_names) == ['motor']
    assert [p.time_from_start.sec for p in drive.points] == [0, 1, 2, 3, 4]
    back = asker.ask('input_trajectory', drive, 'followed_trajectory')
    assert list(back.joint_names) == ['leg']
    for name in FIELDS:
        want = column(wanted, name)
        assert np.abs(column(back, name) - want).max() <= 1e-12 * (1.0 + np.abs(
            column(drive, name)).max() + np.abs(want).max())


def backwards(trajectory):
    """Give the last point an earlier time than the one before."""
    trajectory.points[-1].time_from_start = Duration(nanosec=500_000_000)
    return trajectory


def twice(trajectory):
    """Name the second joint in place of the first too."""
    trajectory.joint_names = trajectory.joint_names[1:] * 2
    return trajectory


REFUSED = [
    (message('leg', [20.0]), 'lies beyond the toggle'),
    (message('arm', [3.0]), 'must hold leg'),
    (message('leg', []), 'must not be empty'),
    (message('leg', [3.0], velocities=[]), 'must be given for leg in point 0'),
    (message('leg', [float('nan')]), 'positions = nan: must be finite'),
    (message('leg', [3.0], positions=[9.0, 3.0, 3.1]),
     'points[0].positions = [9.0, 3.0, 3.1]: must be 2 numbers, one for each of joint_names'),
    (message('leg', [3.0], effort=[9.0, 1.0, 2.0]), 'points[0].effort = '),
    (message('leg', [3.0], velocities=[9.0]), 'points[0].velocities = [9.0]: must be 2 numbers'),
    (twice(message('leg', [3.0])), "joint_names = ['leg', 'leg']: must not name a joint twice"),
    (backwards(message('leg', [3.0, 3.1, 3.2])),
     'points[2].time_from_start = 0.5: must not decrease: the point before has 1 s'),
]


def test_what_cannot_be_followed_is_refused_with_its_reason(geared):
    asker, _ = geared
    for wrong, why in REFUSED:
        asker.refused(wrong, why)


TURNING = {'linkage.a1': 0.5, 'linkage.a2': 0.6, 'linkage.a3': 0.55, 'linkage.a4': 0.2,
           'drive.source': 'motion', 'drive.start': 0.5, 'trajectories': True,
           'outputs': ['state'], 'joint_names': ['motor', 'a', 'b', 'leg']}


def test_what_is_not_answered_is_counted(geared, diagnosed):
    asker, _ = geared

    def counted():
        values = diagnosed()[1]
        refused, answered = (len(asker.heard[name]) for name in (
            'trajectory_refused', 'drive_trajectory'))
        return (values.get('trajectories') == str(refused + answered + 1)       # one came back
                and values['trajectories refused'] == str(refused)
                and values['trajectories lost'] == '0')
    asker.client.until(counted, 'the counts')


WAITING = """
from pathlib import Path
import time
from fourbar_ros.transmission import Transmission
answer = Transmission.to_input
def wait_and_answer(self, wanted):
    print('at work', flush=True)
    while len(wanted.position) > 1000 and not Path('go').exists():
        time.sleep(0.01)
    return answer(self, wanted)
Transmission.to_input = wait_and_answer
"""


@pytest.mark.slow
def test_while_a_long_trajectory_is_answered_the_inputs_are(run_node, client, tmp_path):
    """In order of events, not by the clock: the answer may take as long as it likes."""
    node = run_node({**TURNING, 'drive.source': 'joint_state', 'drive.joint': 'motor',
                     'joint_states.only_passive': True, 'outputs': ['joint_states']},
                    first=WAITING)
    asker, states = Asker(client), client.hear(JointState, '/joint_states')
    motor = client.node.create_publisher(JointState, '/fourbar/input_joint_states', 1000)

    def moved(number):
        sent = JointState(name=['motor'], position=[0.1], velocity=[1.0])
        sent.header.stamp.sec = number
        motor.publish(sent)
        client.spin(0.1)
        return any(state.header.stamp.sec == number for state in states)
    client.until(lambda: moved(1), 'an answer')
    point = JointTrajectoryPoint(positions=[0.0], velocities=[0.0], accelerations=[0.0])
    asker.send('output_trajectory', JointTrajectory(joint_names=['leg'], points=[point] * 2_000))
    client.until(lambda: 'at work' in node.said, 'the worker')
    for number in range(2, 12):
        client.until(lambda number=number: moved(number), 'an answer')
    assert not asker.heard['drive_trajectory']
    (tmp_path / 'go').touch()
    client.until(lambda: asker.heard['drive_trajectory'], 'the answer')
    assert len(asker.heard['drive_trajectory'][0].points) == 2_000
