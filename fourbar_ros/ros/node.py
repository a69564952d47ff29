"""fourbar_node: one linkage, driven by the clock or by messages; publishes, answers, records."""
from __future__ import annotations

import signal
import sys
import threading

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from .. import interfaces
from ..core import FourBarError
from ..core.status import OK, STATUS_NAMES, evaluate
from . import declare, services
from .drives import SimulatedTimerDrive, TimerDrive, TopicDrive
from .outputs import Output
from .recording import Recording

RCLError = rclpy_implementation.RCLError     # a scene file that rcl cannot parse, among others
SPIN = 0.2      # [s] the events executor must be given a finite time: endless, it can hang (see docs/node.md)


class FourBarNode(Node):
    """The node; see docs/node.md for its topics, services and parameters."""

    def __init__(self, **kwargs):
        super().__init__('fourbar', automatically_declare_parameters_from_overrides=True, **kwargs)
        self.scene = declare.scene(self)
        self.linkage = self.scene.linkage
        self._status = OK
        topics = [interfaces.OUTPUTS[name] for name in self.scene.outputs]
        source = self.scene.drive.source
        if source == 'timer':
            drive = SimulatedTimerDrive if self.get_parameter('use_sim_time').value else TimerDrive
            topics.insert(0, interfaces.INPUTS['motion'])
            self.topics = topics
        else:
            drive = TopicDrive
            self.topics = [interfaces.INPUTS[source], *topics]
        first = len(self.topics) - len(topics)
        self._outputs = [Output(self, topic, self.scene, i) for i, topic in enumerate(topics, first)]
        self.recording = Recording(self, self.scene, self.topics)
        self._services = services.create(self)
        if self.scene.recording.start:
            self.recording.start(self.scene.recording.name)
        self._drive = drive(self, self.scene.drive, self.step)
        self._drive.start()
        self.get_logger().info(f'{self.linkage.classification}, mode {self.linkage.mode}, driven by {source}')

    def step(self, stamp, theta1, omega1, alpha1, data=None):
        """Evaluate one input and send what is heard or recorded; ``data``: the input as it came."""
        recording = self.recording
        if data is not None:
            recording.write(0, bytes(data))
        recorded = recording.active
        wanted = [output for output in self._outputs if recorded or output.is_heard]
        if not wanted:
            return
        with_loads = any(output.needs_loads for output in wanted)
        status, motion, loads = evaluate(self.linkage, theta1, omega1, alpha1, with_loads)
        values = (*motion, *loads)
        for output in wanted:
            output.send(stamp, status, self.linkage.mode, values, recording)
        if status != self._status:                       # once per change, not per sample
            self._status = status
            self.get_logger().warning(f'theta1 = {theta1!r} rad: {STATUS_NAMES[status]}')

    def close(self):
        """Stop the stream, close the bag, leave the graph."""
        self._drive.stop()
        try:
            path = self.recording.stop()
            if path:
                self.get_logger().info(f'recorded {path}')
        finally:
            self.destroy_node()


def main(args=None):
    """Run the node until SIGINT or SIGTERM; exit code 0, or 2 for a scene that cannot be."""
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        node = FourBarNode()
    except (FourBarError, RCLError) as error:
        print(f'fourbar_node: {" ".join(str(error).split())}', file=sys.stderr)
        rclpy.try_shutdown()
        return 2
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        while not stop.is_set():
            executor.spin_once(timeout_sec=SPIN)
    finally:
        node.close()
        executor.shutdown()
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main())
