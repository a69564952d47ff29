"""The bag of a node, if one is being written: what goes into it, and who asks for it."""
from __future__ import annotations

import json
from typing import NamedTuple

from .. import interfaces


class RecorderState(NamedTuple):
    """What the diagnostics say of the recorder."""

    values: dict
    problems: list


class Recording:
    """
    Start and stop the bags of one node and hand them what is sent.

    A bag holds, under the names in ``custom_data['topics']``: ``crank`` (Motion), the motion every output
    belongs to and is recomputed from, whatever the drive; ``scene`` (String), all parameters as JSON, at
    the start and again after every change, in force for what follows; the outputs of the scene; and the
    input as it came (``motion`` or ``joint_state``), if there is one. An output whose stamp is not that
    of the crank before it belongs to none: it says that the input has stopped.

    Parameters
    ----------
    node : rclpy.node.Node
        For resolved names and the log.

    """

    def __init__(self, node):
        self._node = node
        self._writer, self._channels = None, {}

    @property
    def active(self):
        """Return whether messages are being recorded."""
        return self._writer is not None

    def start(self, scene, name=''):
        """Start a bag of what a scene receives and publishes; return its path; raises BagError."""
        from ..bag.writer import BagError, BagWriter     # only scenes that record need the mcap library
        from .schemas import channel

        if self._writer:
            raise BagError(f'already recording to {self._writer.path}')
        topics = [interfaces.CRANK, interfaces.SCENE, *(interfaces.OUTPUTS[output] for output in scene.outputs)]
        if scene.drive.source in interfaces.INPUTS:
            topics.append(interfaces.INPUTS[scene.drive.source])
        resolved = {topic.name: self._node.resolve_topic_name(topic.topic) for topic in topics}
        about = {'scene': json.dumps(scene.values), 'topics': json.dumps(resolved),
                 'units': 'SI: m, kg, s, rad, N, N m'}
        writer = BagWriter(scene.recording.directory, name,
                           [channel(topic, resolved[topic.name]) for topic in topics], about)
        self._channels = {topic.name: number for number, topic in enumerate(topics)}
        self._writer = writer
        self._node.get_logger().info(f'recording to {writer.path}')
        return writer.path

    def state(self):
        """Return (values, problems) for the diagnostics."""
        writer = self._writer
        if not writer:
            return RecorderState({'recording': 'off'}, [])
        problems = [writer.error] if writer.error else []
        if writer.dropped:
            problems.append(f'{writer.dropped} messages not recorded')
        return RecorderState({'recording': str(writer.path), 'messages not recorded': writer.dropped}, problems)

    def stop(self):
        """Close the bag and return its path, None if there was none; raises BagError."""
        writer, self._writer = self._writer, None
        return writer.close() if writer else None

    def write(self, topic, data):
        """Record the serialised message of a topic, by its short name, if a bag is open; never waits."""
        writer = self._writer            # another thread may stop the recording meanwhile
        if writer:
            writer.write(self._channels[topic], data)
