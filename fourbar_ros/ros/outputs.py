"""Publishers: a message is filled once and serialised once, for the wire and for the bag."""
from __future__ import annotations

from math import isnan

from rclpy.serialization import serialize_message

from .. import interfaces
from .messages import filler, resolve, set_constants


class Output:
    """One published topic."""

    def __init__(self, node, topic):
        self.name, self._topic = topic.name, topic
        self.is_point = topic.type == interfaces.OUTPUTS['points'].type
        self._node = node
        message_type = resolve(topic.type)
        self._message = message_type()
        self._publisher = node.create_publisher(message_type, topic.topic, interfaces.QUEUE_DEPTH)

    def apply(self, scene):
        """Take over a scene."""
        set_constants(self.name, self._message, scene)
        self._positions = _needed(self.name, scene)
        self._fill = filler(self.name, self._message, scene.layout)
        self.needs_loads = self._topic.needs_loads or (self.name == 'joint_states' and scene.needs_loads)

    @property
    def is_heard(self):
        """Return whether anybody listens."""
        return self._publisher.get_subscription_count() > 0

    def has_something(self, values):
        """Return whether there is anything to send: joint_states may be silent where a position is not known."""
        return not any(isnan(values[place]) for place in self._positions)

    def send(self, stamp, status, mode, values, recording):
        """Fill and publish; when a bag is open, serialise once for both."""
        self._fill(stamp, status, mode, values)
        if recording.active:
            data = serialize_message(self._message)
            self._publisher.publish(data)
            recording.write(self.name, data)
        else:
            self._publisher.publish(self._message)

    def destroy(self):
        """Leave the graph."""
        self._node.destroy_publisher(self._publisher)


def _needed(name, scene):
    """Return the places of values without which a message is not sent."""
    if name != 'joint_states' or scene.joint_states.when_unknown != 'skip':
        return ()
    return [scene.layout.place[position] for position in scene.layout.fields[name]['position']]
