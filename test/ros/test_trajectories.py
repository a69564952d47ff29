# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trajectories of the output over the wire: there and back, gears, and refusals with a reason."""
from builtin_interfaces.msg import Duration
from fourbar_ros.scene.topics import TRAJECTORIES
import numpy as np
import pytest
from std_msgs.msg import String
from support.scenes import PAPER, RODS
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

GEARED = {**PAPER, **RODS, 'drive.source': 'motion', 'drive.start': 1.0, 'trajectories': True,
          'joint_names': ['motor', 'a', 'b', 'leg'], 'outputs': ['state'],
          'joint_states.ratios': [-3.0, 1.0, 1.0, 2.0],
          'joint_states.offsets': [0.2, 0.0, 0.0, -0.5]}


def message(joint, positions, **others):
    """Return a JointTrajectory of one joint beside another."""
    found = JointTrajectory(joint_names=['other', joint])
    for k, position in enumerate(positions):
        point = JointTrajectoryPoint(positions=[9.0, float(position)],
                                     velocities=[9.0, 0.3 * k], accelerations=[9.0, 1.0 - k],
                                     effort=[9.0, 2.0 * k], time_from_start=Duration(sec=k))
        for name, value in others.items():
            setattr(point, name, value)
        found.points.append(point)
    return found


class Asker:
    """Publishes trajectories and hears answers and refusals."""

    def __init__(self, client):
        self.client, self.heard = client, {}
        self._publishers = {}
        for name, topic in TRAJECTORIES.items():
            kind = String if topic.type.endswith('String') else JointTrajectory
            full = topic.topic.replace('~', '/fourbar')
            if name in ('output_trajectory', 'input_trajectory'):
                self._publishers[name] = client.node.create_publisher(kind, full, 10)
            else:
                client.node.create_subscription(
                    kind, full, self.heard.setdefault(name, []).append, 10)
        client.until(lambda: all(p.get_subscription_count() for p in self._publishers.values())
                     and all(client.node.count_publishers(t.topic.replace('~', '/fourbar'))
                             for n, t in TRAJECTORIES.items() if n in self.heard), 'the topics')

    def ask(self, name, what, answer):
        count = len(self.heard[answer])
        for _ in range(20):
            self._publishers[name].publish(what)
            try:
                self.client.until(lambda: len(self.heard[answer]) > count, answer, 3.0)
                return self.heard[answer][-1]
            except Exception:
                continue
        raise AssertionError(answer)


def column(trajectory, name):
    return np.array([getattr(point, name)[-1] for point in trajectory.points])


def test_a_wanted_output_becomes_a_drive_and_comes_back(run_node, client):
    run_node(GEARED)
    asker, wanted = Asker(client), message('leg', 2.0 * np.linspace(1.7, 2.2, 5) - 0.5)
    drive = asker.ask('output_trajectory', wanted, 'drive_trajectory')
    assert list(drive.joint_names) == ['motor']
    assert [p.time_from_start.sec for p in drive.points] == [0, 1, 2, 3, 4]
    back = asker.ask('input_trajectory', drive, 'followed_trajectory')
    assert list(back.joint_names) == ['leg']
    for name in ('positions', 'velocities', 'accelerations', 'effort'):
        want = column(wanted, name)
        assert np.abs(column(back, name) - want).max() <= 1e-12 * (1.0 + np.abs(
            column(drive, name)).max() + np.abs(want).max())


@pytest.mark.parametrize('wrong, why', [
    (message('leg', [20.0]), 'lies beyond the toggle'),
    (message('arm', [3.0]), 'must hold leg'),
    (message('leg', []), 'must not be empty'),
    (message('leg', [3.0], velocities=[]), 'must be given for leg in point 0'),
    (message('leg', [float('nan')]), 'must be finite'),
])
def test_what_cannot_be_followed_is_refused_with_its_reason(run_node, client, wrong, why):
    run_node({**GEARED, 'joint_states.ratios': [1.0, 1.0, 1.0, 7.0]})
    assert why in Asker(client).ask('output_trajectory', wrong, 'trajectory_refused').data
