# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags without ROS: messages made by rosbags, which also decodes them for the reader."""
import json

from fourbar_ros.bag import sides
from fourbar_ros.bag.metadata import Channel
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.mechanisms.parts import mode_number
from fourbar_ros.pipeline import joints
from fourbar_ros.pipeline.stepper import joints_of, Stepper, Wanted
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene import scene as scenes
from fourbar_ros.scene.topics import (
    applied_topic,
    DRIVE_STATE,
    DRIVEN,
    SCENE,
    TORQUE,
    wrench_topic,
)
import numpy as np
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
from support import ROOT

STORE = get_typestore(Stores.ROS2_JAZZY)
for _file in (ROOT / 'msg_defs/msg').glob('*.msg'):
    STORE.register(get_types_from_msg(_file.read_text(), f'fourbar_msgs/msg/{_file.stem}'))


def text_of(type_name):
    """Return the schema of a type as a bag holds it."""
    text = STORE.generate_msgdef(type_name, ros_version=2)[0]
    package, _, name = type_name.split('/')
    if package == 'fourbar_msgs':           # with its comments, as from the package
        text = (ROOT / f'msg_defs/msg/{name}.msg').read_text() + text[text.index('=' * 80):]
    return text


def channel(topic, type_name, depth=10, latched=False):
    """Return the Channel of a topic."""
    return Channel(topic, type_name, text_of(type_name), STORE.hash_rihs01(type_name), depth,
                   latched)


MOTION = channel('/fourbar/driven', 'fourbar_msgs/msg/Motion')


def stamp(nanoseconds, frame='fourbar'):
    """Return a Header."""
    time = STORE.types['builtin_interfaces/msg/Time'](nanoseconds // 10**9, nanoseconds % 10**9)
    return STORE.types['std_msgs/msg/Header'](time, frame)


def motion(number):
    """Return a serialised Motion that carries a number."""
    return encode('fourbar_msgs/msg/Motion', header=stamp(number), position=float(number),
                  velocity=0.5,
                  acceleration=-0.25)


def encode(type_name, **values):
    """Return a serialised message."""
    return bytes(STORE.serialize_cdr(STORE.types[type_name](**values), type_name))


def zero(type_name):
    """Return a message of zeros and empty texts."""
    values = {}
    for name, (kind, what) in STORE.fielddefs[type_name][1]:
        if kind == 1:
            base = what[0]
            values[name] = '' if base == 'string' else False if base == 'bool' else 0
        elif kind == 2:
            values[name] = zero(what)
        else:
            values[name] = [] if kind == 4 and what[0][1][0] == 'string' else np.zeros(0)
    return STORE.types[type_name](**values)


def output_message(name, when, status, values, scene):
    """Return the bytes of one output as the node would send it."""
    topic = DRIVEN if name == 'driven' else scene.topics[name]
    message = zero(topic.type)
    message.header = stamp(when)
    if hasattr(message, 'status'):
        message.status, message.mode = status, mode_number(scene.linkage.mode)
    if name == 'state':
        message.change_point_margin = float(scene.linkage.change_point_margin)
    if name == 'joint_states':
        message.name = scene.names_shown
    for field, value in scene.layout.expected(name, values).items():
        *path, last = field.split('.')
        place = message
        for step in path:
            place = getattr(place, step)
        setattr(place, last, np.array(value) if isinstance(value, tuple) else value)
    return bytes(STORE.serialize_cdr(message, topic.type))


def wrench(number, given, frame=''):
    """Return a serialised WrenchStamped of (force_x, force_y, couple)."""
    message = zero('geometry_msgs/msg/WrenchStamped')
    message.header = stamp(number, frame)
    message.wrench.force.x, message.wrench.force.y, message.wrench.torque.z = given
    return bytes(STORE.serialize_cdr(message, 'geometry_msgs/msg/WrenchStamped'))


def copy(bag, directory, name, change):
    """
    Write a bag again, the data of every message as ``change(raw)`` returns them.

    Return the new bag's path.
    """
    old = Bag(bag)
    writer = BagWriter(directory, name, [channel(*topic) for topic in old.types.items()],
                       old.about)
    numbers = {topic: i for i, topic in enumerate(old.types)}
    for raw in Bag(bag).raw():
        writer.write(numbers[raw.topic], bytes(change(raw)))
    return writer.close()


def with_old_memory(data, texts, rng):
    """Return a message with random bytes in the padding, as Fast CDR leaves it."""
    data = bytearray(data)
    for text in texts:
        end = data.index(text.encode() + b'\0') + len(text) + 1
        padding = -(end - 4) % 4
        data[end:end + padding] = rng.bytes(padding)
    return bytes(data)


def run(directory, name, values, cranks, changes=(), step_ns=10**6, paced=False, loads=(),
        is_wrapped=False, **kwargs):
    """
    Record a run as the node does and return the closed bag's path.

    ``cranks``: (theta1, omega1, alpha1) of every step; ``changes``: {step: parameters} set before
    it; ``loads``: {step: {link: (force_x, force_y, couple)}} received before it. Stamps begin at
    step_ns: 0 stands for an unstamped message. ``paced``: log times step_ns apart, whatever the
    clock says. ``is_wrapped``: as the node did before joints were continuous.
    """
    scene = scenes.from_values(values)
    topics = [topic for topic in scene.recorded if topic not in (DRIVE_STATE, TORQUE)]
    resolved = {topic.name: f'/{topic.topic.replace("~", "fourbar")}' for topic in topics}
    about = {'scene': json.dumps(scene.values), 'topics': json.dumps(resolved), 'node': '/fourbar'}
    if not is_wrapped:
        about[joints.KEY] = joints.CONTINUOUS
    about[sides.KEY] = sides.BRANCHES
    channels = [channel(resolved[t.name], t.type, latched=t is SCENE) for t in topics]
    writer = BagWriter(directory, name, channels, about, **kwargs)
    number = {topic.name: i for i, topic in enumerate(topics)}

    def say_scene():
        writer.write(number['scene'], encode('std_msgs/msg/String', data=json.dumps(scene.values)))
        return Stepper(scene, joints=joints_of(scene, last, is_wrapped))
    last = None                              # angles of the joints, which go on
    stepper, changes, begun = say_scene(), dict(changes), writer.clock()
    for k, crank in enumerate(cranks):
        if paced:
            writer.clock = lambda k=k: begun + k * step_ns
        if k in changes:
            scene = scenes.from_values({**scene.values, **changes[k]})
            last = stepper.joints and stepper.joints.angles
            stepper = say_scene()
        for link, given in dict(loads).get(k, {}).items():
            stepper.act(link, Wrench(*given))
            for topic, frame in ((wrench_topic(link), ''), (applied_topic(link), scene.frame_id)):
                writer.write(number[topic.name], wrench(k, given, frame))
        status, found = stepper.step(*crank, Wanted.of(scene))
        writer.write(number['driven'], output_message('driven', (k + 1) * step_ns, 0,
                                                      scene.linkage.unknown(*crank), scene))
        for output in scene.topics:
            writer.write(number[output], output_message(output, (k + 1) * step_ns, status, found,
                                                        scene))
    return writer.close()
