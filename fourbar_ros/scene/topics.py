"""
Every topic and service of the node, once: names, types, quality of service. No ROS is imported here.

Names starting with ``~/`` live below the node's name, the others are relative to its namespace.
"""
from __future__ import annotations

from typing import NamedTuple

QUEUE_DEPTH = 10          # reliable, keep last: serves reliable and best-effort readers
INPUT_DEPTH = 100         # best effort, so that every kind of writer is heard; deep enough for a burst


LOADED_LINKS = ('coupler', 'output')     # those that forces from outside can act on


class Topic(NamedTuple):
    """A topic; ``needs_loads``: only for scenes with masses; ``latched``: late readers get the last message."""

    name: str
    topic: str
    type: str
    text: str
    needs_loads: bool = False
    latched: bool = False


class Service(NamedTuple):
    """A service of the node; ``worker``: the thread that answers if that may take longer than a step."""

    name: str
    service: str
    type: str
    text: str
    worker: str = ''


INPUTS = {topic.name: topic for topic in (
    Topic('motion', '~/input', 'fourbar_msgs/msg/Motion',
          'motion of the driven joint; a NaN rate or acceleration is estimated'),
    Topic('joint_state', '~/input_joint_states', 'sensor_msgs/msg/JointState',
          'the joint named by `drive.joint` is the driven one'),
)}

# Forces and couples from outside, on the links whose external.LINK.from_topic is true: as they come, and what acts.
WRENCHES = {link: Topic(f'external_{link}', f'~/external/{link}', 'geometry_msgs/msg/WrenchStamped',
                        f'force on the {link}, acting at the point external.{link}.along, .across, and couple')
            for link in LOADED_LINKS}
APPLIED = {link: Topic(f'applied_{link}', f'~/applied/{link}', 'geometry_msgs/msg/WrenchStamped',
                       f'what acts on the {link} from now on; NaN: not known; latched, sent at every change', latched=True)
           for link in LOADED_LINKS}

# Always there, whatever the scene names; they cost nothing until heard or recorded.
DRIVEN = Topic('driven', '~/driven', 'fourbar_msgs/msg/Motion',
               'the motion of the driven joint that the outputs belong to: from the clock, or the input completed')
SCENE = Topic('scene', '~/scene', 'std_msgs/msg/String',
              'all parameters as JSON; latched, sent again after every change', latched=True)

OUTPUTS = {topic.name: topic for topic in (
    Topic('state', '~/state', 'fourbar_msgs/msg/LinkageState',
          'angles, rates and accelerations of all joints, transmission angle, condition'),
    Topic('output', '~/output', 'fourbar_msgs/msg/Motion',
          'motion of the output: the input of a next node'),
    Topic('joint_states', 'joint_states', 'sensor_msgs/msg/JointState',
          'the four joints for robot_state_publisher, RViz, Foxglove; with loads also the effort of the driven one: torque or force'),
    Topic('loads', '~/loads', 'fourbar_msgs/msg/LinkageLoads',
          'joint reactions, driving torque or force, shaking force and moment', True),
    Topic('shaking_wrench', '~/shaking_wrench', 'geometry_msgs/msg/WrenchStamped',
          'force and moment of the linkage on the ground, about O1, the origin of the frame', True),
    Topic('drive_wrench', '~/drive_wrench', 'geometry_msgs/msg/WrenchStamped',
          'force and torque of the linkage on its drive, at the driven joint: minus driving force and torque', True),
    Topic('points', '~/points/NAME', 'fourbar_msgs/msg/PointMotion',
          'for each of the points.NAME of the scene: place, velocity, acceleration'),
)}


def topics_of(outputs, points):
    """Return {name: Topic} of the outputs of a scene; the points have a topic each, named points/NAME."""
    topics = {}
    for output in outputs:
        topic = OUTPUTS[output]
        if output == 'points':
            topics |= {f'points/{name}': topic._replace(name=f'points/{name}', topic=topic.topic.replace('NAME', name))
                       for name in points}
        else:
            topics[output] = topic
    return topics


SERVICES = {service.name: service for service in (
    Service('find_extrema', '~/find_extrema', 'fourbar_msgs/srv/FindExtrema',
            'all extremes of motion and loads over the input', 'search'),
    Service('evaluate', '~/evaluate', 'fourbar_msgs/srv/Evaluate',
            'state and loads for one input'),
    Service('start_recording', '~/start_recording', 'fourbar_msgs/srv/StartRecording',
            'start a bag of the input and of everything published', 'bag'),
    Service('stop_recording', '~/stop_recording', 'std_srvs/srv/Trigger',
            'close the bag; the message is its path', 'bag'),
)}

FIND_EXTREMA = Service('find_extrema', '~/find_extrema', 'fourbar_msgs/action/FindExtrema',
                       'the same search, quantity by quantity, with feedback; can be canceled', 'search')
