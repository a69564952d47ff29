# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A design picked from a study runs in a real node."""
import time

from fourbar_lab.studies.engine import encode, PART
from fourbar_lab.studies.results import Results
from fourbar_lab.studies.study import from_document
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import from_values
import pytest
from support.harness import Client, NodeProcess, PATIENCE

pytest.importorskip('pyarrow')


@pytest.mark.slow
def test_a_picked_design_runs_in_the_node(tmp_path):
    study = from_document({'scene': 'paper', 'rows': 4, 'objectives': {'omega4.peak': 'minimize'},
                           'vary': {'linkage.a1': {'range': [0.2, 0.3]}}})
    (tmp_path / PART.format(0)).write_bytes(encode(study, 0))
    results = Results(tmp_path)
    row = results.best()[0]
    file = tmp_path / 'best.yaml'
    file.write_text(results.scene_text(row))
    client, node = Client(), NodeProcess(read_values(file), tmp_path)
    try:
        client.listen(['state'])
        end = time.monotonic() + PATIENCE
        while not client.received['state'] and time.monotonic() < end:
            client.executor.spin_once(timeout_sec=0.05)
        state = client.received['state'][0]
        expected = from_values(study.scene_values(row)).linkage.motion(state.theta1, state.omega1)
        assert state.theta4 == expected.theta4 and state.omega1 == 25.0
    finally:
        client.close()
        assert node.stop() == 0, node.said
