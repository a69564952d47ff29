# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Once a second on /diagnostics: how the stream runs, how far the linkage is from trouble."""
from __future__ import annotations

from math import isnan
import time
from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from fourbar_ros.pipeline.stepper import OK, STATUS_NAMES
from fourbar_ros.ros.node.clock_input import ClockInput
from fourbar_ros.ros.node.entities import Troubles
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.ros.node.stream import Stream
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

if TYPE_CHECKING:      # imported where a scene needs it
    from fourbar_ros.ros.node.topic_input import TopicInput

PERIOD = 1.0               # [s]
NEAR_TOGGLE = 0.05         # |sin| of the transmission angle below which a warning is due
HARMLESS = ('received', 'torques', 'of_other_joints', 'trajectories')   # counters without trouble


class Diagnostics:
    """Publishes the health of a node."""

    def __init__(self, node: Node, stream: Stream, source: ClockInput | TopicInput,
                 recording: Recording, troubles: Troubles) -> None:
        self._node, self._stream, self._input = node, stream, source
        self._recording, self._troubles = recording, troubles
        self._publisher = node.create_publisher(DiagnosticArray, '/diagnostics', 10)
        # at the last report: time, steps, bad steps, counts of troubles
        self._before: tuple[float, int, int, dict[str, int]] = (time.monotonic(), 0, 0, {})
        node.create_timer(PERIOD, self._publish, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _publish(self) -> None:
        message = DiagnosticArray(status=[self.status()])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)

    def status(self) -> DiagnosticStatus:
        """Return level, problems and values since the last call; ERROR is a bag not written."""
        node, stream, source = self._node, self._stream, self._input
        scene, now = stream.scene, time.monotonic()
        input_values, problems = source.report()     # first: it brings its counts up to date
        before, steps, bad_steps, counts = self._before
        counted = dict(self._troubles.counts)
        self._before = (now, stream.steps, stream.bad_steps, counted)
        new_bad_steps, sine = stream.bad_steps - bad_steps, stream.transmission_sine()
        recorder_values, recorder_problems = self._recording.report()

        for name, count in counted.items():
            if count > counts.get(name, 0) and name not in HARMLESS:
                problems.append(f'{count - counts.get(name, 0)} {name.replace("_", " ")}')
        if node.get_node_names_and_namespaces().count(
                (node.get_name(), node.get_namespace())) > 1:
            problems.append('another node has this name, or was killed just now: services and '
                            'parameters reach either')
            self._troubles.log('name', f'{node.get_fully_qualified_name()}: {problems[-1]}')
        if new_bad_steps:
            problems.append(f'{new_bad_steps} steps not ok')
        if stream.status != OK:
            problems.append(STATUS_NAMES[stream.status])
        if sine < NEAR_TOGGLE:
            problems.append('near a toggle')
        problems += recorder_problems
        values = {
            'source': scene.drive.source,
            'rate [Hz]': f'{(stream.steps - steps) / max(now - before, 1e-9):.1f}',
            'steps': stream.steps, 'steps not ok': stream.bad_steps,
            'input age [s]': 'none' if isnan(source.age()) else f'{source.age():.3f}',
            **{name.replace('_', ' '): count for name, count in counted.items()},
            **input_values,
            'status': STATUS_NAMES[stream.status],
            'sin of transmission angle': 'unknown' if isnan(sine) else f'{sine:.6g}',
            'change-point margin': f'{scene.linkage.change_point_margin:.6g}',
            **recorder_values,
        }
        level = DiagnosticStatus.ERROR if recorder_problems else DiagnosticStatus.WARN
        return DiagnosticStatus(
            level=level if problems else DiagnosticStatus.OK,
            name=f'{node.get_fully_qualified_name()[1:]}: linkage',
            message=', '.join(problems) or 'ok', hardware_id=node.get_fully_qualified_name(),
            values=[KeyValue(key=key, value=str(value)) for key, value in values.items()])
