# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A bare rclpy node to compare with.

The same messages, nothing computed, nothing filled but the stamp; one parameter, ``gravity.y``.
"""
import signal
import sys
import threading
import time

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene.topics import OUTPUTS
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions


def messages_of(node, outputs):
    """Return (message, publisher) of each output, with as many bytes as the real ones."""
    messages = []
    for name in outputs:
        kind_of = resolve(OUTPUTS[name].type)
        message = kind_of()
        message.header.frame_id = 'fourbar'
        if name == 'joint_states':
            message.name = ['crank', 'coupler', 'coupler_output', 'output']
            message.position = message.velocity = message.effort = [0.0] * len(message.name)
        messages.append((message, node.create_publisher(kind_of, f'~/{name}', 10)))
    return messages


def run(kind, rate, outputs):
    """Publish these outputs at ``rate`` Hz ('timer'), or for each Motion that comes ('echo')."""
    stop = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stop.set())
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('bare')
    node.declare_parameter('gravity.y', -9.81)
    messages = messages_of(node, outputs)

    def send(stamp):
        for message, publisher in messages:
            message.header.stamp = stamp
            publisher.publish(message)

    began = time.time_ns()

    def tick():
        sample = round((time.time_ns() - began) * 1e-9 * rate)
        now = began + round(sample * 1e9 / rate)             # when it was due
        send(Time(sec=now // 10**9, nanosec=now % 10**9))

    if kind == 'timer':
        node.create_timer(1.0 / rate, tick)
    else:
        qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
        node.create_subscription(Motion, '~/input',
                                 lambda message: send(message.header.stamp), qos)
    executor = EventsExecutor()
    executor.add_node(node)
    while not stop.is_set():
        executor.spin_once(timeout_sec=0.2)
    executor.shutdown()
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    run(sys.argv[1], float(sys.argv[2]), sys.argv[3:])
