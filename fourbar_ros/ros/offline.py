# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The bag of a simulated run: the messages that its node would publish, without a node."""
from collections.abc import Callable, Iterator
from math import isnan
from pathlib import Path
import time

from fourbar_ros.bag import recorder
from fourbar_ros.dynamics import node_step
from fourbar_ros.errors import BagError
from fourbar_ros.mechanisms.parts import LARGEST_MODE
from fourbar_ros.pipeline.stepper import OK, Stepper, Wanted
from fourbar_ros.ros.messages import resolve, sec_nanosec, to_stamp
from fourbar_ros.ros.node import recording, stream
from fourbar_ros.ros.schemas import channel
from fourbar_ros.scene.files import NODE
from fourbar_ros.scene.simulated import SimulatedScene
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, full_name, SCENE, Topic, TORQUE
from rclpy.serialization import serialize_message

Messages = list[tuple[str, bytes]]      # (short name of the topic, bytes)
FULL = 20_000          # messages that may wait for the disk
# [ns] Stamp of time zero. Two runs of a scene have the same stamps, so "bag diff" compares them; a
# stamp of 0 would say that there is none.
BEGIN = 10**9


def write_bag(simulated: SimulatedScene, path: Path, progress: Callable[[int], None]) -> Path:
    """
    Write a simulated run as the bag that its node would have recorded; return its path.

    ``progress`` is called with the number of samples written so far. Raises BagError if the bag
    exists or cannot be written, or the run goes into a mode that messages cannot tell.
    """
    scene, run = simulated.scene, simulated.run
    changes = (run.modes != scene.linkage.mode).nonzero()[0]
    if changes.size and run.modes.max() > LARGEST_MODE:
        raise BagError(f'{path}: the motion goes into the other assembly mode at '
                       f'{run.time[changes[0]]:g} s, and messages cannot tell which: simulate '
                       'until then, or without a bag')
    topics = scene.recorded
    names = {topic.name: full_name(topic.topic, NODE) for topic in topics}
    how = f'{run.method}, tolerance {run.tolerance:g}, {run.status}, error {run.error:.3g}'
    about = {**recording.about_of(scene, names, NODE), node_step.KEY: how}
    now = BEGIN                         # log times are those of the run
    writer = recorder.BagWriter(
        str(path.parent), path.name, [channel(topic, names[topic.name]) for topic in topics],
        about, clock=lambda: now)
    channels = {topic.name: channel_id for channel_id, topic in enumerate(topics)}
    try:
        for done, (stamp, messages) in enumerate(_messages(simulated, topics), 1):
            now = stamp
            while writer.waiting > FULL and not writer.error:
                time.sleep(0.01)         # the disk is slower than we: do not fill the memory
            writer.write_all([(channels[name], data) for name, data in messages])
            progress(done)
    finally:
        writer.close()
    return writer.path


def _messages(simulated: SimulatedScene, topics: list[Topic]) -> Iterator[tuple[int, Messages]]:
    """Yield (time [ns], [(short name, bytes), ...]) of each sample, in the order of a node."""
    scene, stepper = simulated.scene, Stepper(simulated.scene)
    wanted, layout = Wanted.of(scene), scene.layout
    modes = [mode if mode <= LARGEST_MODE else stepper.mode
             for mode in simulated.run.modes.tolist()]
    layouts = {DRIVE_STATE.name: stream.drive_layout()}
    makers = {topic.name: stream.writer_of(topic, scene, layouts.get(topic.name, layout)).pack
              for topic in topics if topic not in (SCENE, TORQUE)}
    first = [(SCENE.name, serialize_message(resolve(SCENE.type)(data=scene.as_json)))]
    is_silent = scene.drive.source == TORQUE.name and isnan(simulated.torque)
    if scene.drive.source == TORQUE.name and not is_silent:
        command = resolve(TORQUE.type)()         # a torque [N m], or a force [N] of a slide
        command.header.stamp = to_stamp(BEGIN)
        if scene.linkage.is_driven_by_slide:
            command.wrench.force.x = simulated.torque
        else:
            command.wrench.torque.z = simulated.torque
        first.append((TORQUE.name, serialize_message(command)))
    inputs = [layout.index_of[name] for name in scene.linkage.input_coordinate]
    offsets = (simulated.run.time * 1e9).round().astype('int64').tolist()
    for offset, mode, drive_values in zip(offsets, modes, simulated.drive_values()):
        motion = drive_values.position, drive_values.velocity, drive_values.acceleration
        driven = list(layout.unknown)
        for index, value in zip(inputs, motion):
            driven[index] = value
        status, values = stepper.step(*motion, wanted, mode)
        outputs = [name for name in scene.topics
                   if status == OK or not any(isnan(values[index])
                                              for index in scene.needed_for(name))]
        drive_status = node_step.SILENT if is_silent else node_step.OK
        contents = {DRIVE_STATE.name: (drive_status, drive_values),
                    DRIVEN.name: (OK, driven), **dict.fromkeys(outputs, (status, values))}
        stamp = sec_nanosec(BEGIN + offset)
        yield BEGIN + offset, first + [
            (name, makers[name](stamp, status, mode, values))
            for name, (status, values) in contents.items()]
        first = []
