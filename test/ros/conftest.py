# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the ROS tests: a client, and nodes that must end well."""
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from fourbar_ros import clients
import pytest
from support.harness import Client, NodeProcess, PATIENCE


@pytest.fixture
def client():
    """Return a Client, closed afterwards."""
    made = Client()
    yield made
    made.close()


@pytest.fixture
def diagnosed(client):
    """Return the function of the newest diagnostics, (status, values); all: its ``messages``."""
    messages = client.hear(DiagnosticArray, '/diagnostics')

    def newest():
        status = messages[-1].status[0] if messages else DiagnosticStatus()
        return status, {pair.key: pair.value for pair in status.values}
    newest.messages = messages
    return newest


@pytest.fixture
def lockstep(monkeypatch):
    """Return the function that makes a LockStep for some outputs; all are closed afterwards."""
    made = []
    monkeypatch.setattr(clients, 'FIRST', PATIENCE)

    def make(*outputs, patience=PATIENCE):
        made.append(clients.LockStep(outputs=outputs, patience=patience))
        return made[-1]
    yield make
    for each in made:
        each.close()


@pytest.fixture
def run_node(tmp_path):
    """Return the function that starts a NodeProcess; each must exit with 0 when it is stopped."""
    started = []

    def run(parameters, **kwargs):
        started.append(NodeProcess(parameters, tmp_path, **kwargs))
        return started[-1]
    yield run
    for node in started:
        running = node.process.poll() is None
        code = node.stop()
        assert not running or code == 0, node.said
        assert 'Traceback' not in node.said, node.said     # nor a fault that it went on from
