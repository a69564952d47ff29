# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A real node with a force over a position, whose motion is given or follows; bags recompute."""
from math import pi

from fourbar_msgs.msg import DriveState
from fourbar_ros.scene.files import folder
import numpy as np
from support.harness import in_bag, nanoseconds, recomputed, recording_in, set_parameters

TURN = 2.0 * pi
GIVEN = {'linkage.kind': 'slider_crank', 'linkage.a1': 0.043, 'linkage.a2': 0.143,
         'bodies.crank.mass': 4.0, 'bodies.crank.inertia': 0.006, 'bodies.coupler.mass': 0.55,
         'bodies.coupler.inertia': 0.0017, 'bodies.output.mass': 0.4,
         'forces.gas.link': 'output', 'forces.gas.acts': 'along', 'forces.gas.table': 'gas.csv',
         'forces.gas.periodic': True, 'forces.gas.factor': -0.0058, 'outputs': ['state', 'loads']}
ENGINE = {**GIVEN, 'drive.source': 'motor', 'motor.stall_torque': 60.0, 'motor.free_speed': 200.0,
          'flywheel.inertia': 0.2, 'drive.start_speed': 60.0, 'drive.rate': 500.0}


def test_an_engine_turns_by_its_gas_and_is_stepped_again(run_node, client, tmp_path):
    (tmp_path / 'gas.csv').write_text((folder() / 'engine.csv').read_text())
    node = run_node({**ENGINE, **recording_in(tmp_path)})
    heard = client.hear(DriveState, '/fourbar/drive_state')
    client.until(lambda: heard and heard[-1].position > 3.0 * TURN, 'three turns')
    assert set_parameters(client, {'forces.gas.factor': -0.003})[0].successful
    refused, = set_parameters(client, {'forces.gas.values': [1.0, 2.0]})
    assert not refused.successful and 'forces.gas.values' in refused.reason
    refused, = set_parameters(client, {'forces.gas.acts': 'up'})
    assert not refused.successful and 'forces.gas.acts' in refused.reason
    mark = len(heard)
    client.until(lambda: len(heard) > mark + 50, 'states after the change')
    assert node.stop() == 0
    found = recomputed(tmp_path / 'run')
    stamps = [nanoseconds(state) for state in in_bag(tmp_path / 'run', '/fourbar/drive_state')]
    # a node that the machine keeps more than a second late leaves samples out
    gaps = int((np.diff(stamps) > 1.5e9 / ENGINE['drive.rate']).sum())
    assert found.stepped == found.inputs - 1 - gaps > 10 * gaps
