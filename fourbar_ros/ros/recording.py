"""The bag of a node, if one is being written: what goes into it, and who asks for it."""
from __future__ import annotations

import json


class Recording:
    """
    Start and stop the bags of one node and hand them what is sent.

    Parameters
    ----------
    node : rclpy.node.Node
        For resolved names and the log.
    scene : Scene
    topics : list of Topic
        What is recorded; the first is the input. Its place in the list is its channel.

    """

    def __init__(self, node, scene, topics):
        self._node, self._scene, self._topics = node, scene, topics
        self._writer = None

    @property
    def active(self):
        """Return whether messages are being recorded."""
        return self._writer is not None

    def start(self, name=''):
        """Start a bag and return its path; raises BagError."""
        from ..bag.writer import BagError, BagWriter     # only scenes that record need the mcap library
        from .schemas import channel

        if self._writer:
            raise BagError(f'already recording to {self._writer.path}')
        resolved = {topic.name: self._node.resolve_topic_name(topic.topic) for topic in self._topics}
        channels = [channel(topic, resolved[topic.name]) for topic in self._topics]
        names = {'input' if topic is self._topics[0] else topic.name: resolved[topic.name]
                 for topic in self._topics}
        about = {'scene': json.dumps(self._scene.values), 'topics': json.dumps(names),
                 'units': 'SI: m, kg, s, rad, N, N m'}
        self._writer = BagWriter(self._scene.recording.directory, name, channels, about)
        self._node.get_logger().info(f'recording to {self._writer.path}')
        return self._writer.path

    def stop(self):
        """Close the bag and return its path, None if there was none; raises BagError."""
        writer, self._writer = self._writer, None
        return writer.close() if writer else None

    def write(self, channel, data):
        """Record the serialised message of a channel, if a bag is open; never waits for the disk."""
        writer = self._writer            # another thread may stop the recording meanwhile
        if writer:
            writer.write(channel, data)
