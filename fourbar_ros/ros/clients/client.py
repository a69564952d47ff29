"""Talk to a running node from the command line."""
from __future__ import annotations

import time

import rclpy

from fourbar_ros.scene import topics as interfaces
from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.messages import resolve

PATIENCE = 5.0      # [s] for the node to be found and to answer; discovery takes 4 s at its worst


class NoAnswer(FourBarError):
    """A node was not found, did not answer, or refused."""


def call(service_name, node_name, patience=PATIENCE, **request):
    """Return the answer of a service of a node."""
    service = interfaces.SERVICES[service_name]
    kind, name = resolve(service.type), service.service.replace('~', node_name.rstrip('/'))
    rclpy.init()
    node = rclpy.create_node('fourbar_command')
    try:
        client = node.create_client(kind, name)
        end = time.monotonic() + patience
        if not client.wait_for_service(patience):
            raise NoAnswer(f'{name}: not there; is the node running? (waited {patience:g} s)')
        future = client.call_async(kind.Request(**request))
        rclpy.spin_until_future_complete(node, future, timeout_sec=max(end - time.monotonic(), 1.0))
        if not future.done():
            raise NoAnswer(f'{name}: no answer')
        return future.result()
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


def record(what, name, node_name):
    """Start or stop the bag of a node; return its path."""
    node_name = node_name if node_name.startswith('/') else f'/{node_name}'
    if what == 'start':
        answer = call('start_recording', node_name, name=name)
    else:
        answer = call('stop_recording', node_name)
    if not answer.success:
        raise NoAnswer(answer.message)
    return answer.path if what == 'start' else answer.message
