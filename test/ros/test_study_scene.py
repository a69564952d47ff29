# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A design picked from a study runs in a real node."""
import time

from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import from_values
from fourbar_ros.studies.answers import Answers
from fourbar_ros.studies.parts import encode, Folder
from fourbar_ros.studies.rows import compute
from fourbar_ros.studies.study import from_document
import pytest
from support.harness import Client, NodeProcess, PATIENCE

pytest.importorskip('pyarrow')


def test_a_picked_design_runs_in_the_node(tmp_path):
    study = from_document({'scene': 'paper', 'rows': 4, 'objectives': {'omega4.peak': 'minimize'},
                           'vary': {'linkage.a1': {'range': [0.2, 0.3]}}})
    folder = Folder(tmp_path / 'study')
    folder.begin(study, False)
    folder.add(0, encode(study, compute(study, 0)))
    answers = Answers(folder.path)
    row = answers.best()[0]
    file = tmp_path / 'best.yaml'
    file.write_text(answers.scene_text(row))
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
