# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The bag of a node, if one is being written: its contents and its state."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
import contextlib
import json
import os
from pathlib import Path
import platform
from typing import Any, TYPE_CHECKING

from fourbar_ros import __version__, optional
from fourbar_ros.errors import BagError, FourBarError, NameTaken
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import INPUTS
from rclpy.node import Node

if TYPE_CHECKING:      # only scenes that record need the mcap library
    from fourbar_ros.bag.recorder import BagWriter

Bag = tuple['BagWriter', dict[str, int]]     # its writer, {short name of a topic: its channel}
SOFTWARE = ('numpy', 'mcap', 'rclpy')       # whose versions a bag keeps, beside our own


class Recording:
    """
    The bag of one node, if one is being written.

    Starting a bag waits for the disk, so it has two parts: :meth:`open` makes the bag while steps
    go on, :meth:`attach` begins to record between two steps. So do :meth:`detach` and
    :meth:`close` at its end.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._bag: Bag | None = None     # that is being written
        self._refused = ''               # why the bag that the scene wants was not started

    @property
    def active(self) -> bool:
        bag = self._bag
        return bag is not None and not bag[0].error

    def begin(self, scene: Scene, start: Callable[[str], object]) -> None:
        """Start the bag that a scene wants, by ``start(name)``; if that fails the node runs on."""
        from fourbar_ros.bag.metadata import free_name
        log, wanted = self._node.get_logger(), scene.recording.name
        try:
            while not self._bag:
                name = free_name(directory_of(scene), wanted)
                with contextlib.suppress(NameTaken):     # by another node just now
                    start(name)
            if wanted and name != wanted:
                log.warning(f'{directory_of(scene) / wanted}: exists already; recording to {name}')
        except FourBarError as error:
            self._refused = f'not recording: {error}'
            log.error(self._refused)

    def open(self, scene: Scene, name: str = '') -> Bag:
        """
        Create a bag for the input and each output of a scene; do not record yet.

        Waits for the disk, so it must not run during a step. Raises BagError if another one is
        being recorded or this one cannot be written, MissingPackage without the mcap library.
        """
        try:
            from fourbar_ros.bag.recorder import BagWriter
        except ModuleNotFoundError as error:
            raise optional.MissingPackage('recording', error) from None
        from fourbar_ros.ros.schemas import channel

        if self._bag:
            if self.active:
                raise BagError(f'already recording to {self._bag[0].path}')
            with contextlib.suppress(BagError):      # it ended by an error, which was logged
                self._bag[0].close()
        topics = [*scene.recorded, *scene.pictures.values()]
        if scene.drive.source in INPUTS:
            topics.append(INPUTS[scene.drive.source])
        full_name = {topic.name: self._node.resolve_topic_name(topic.topic) for topic in topics}
        # A topic can be in a bag once. A relay, which adds passive joints to the joint states that
        # it hears, answers on the topic of its input: the answer is recorded, and the input as the
        # motion of the driven joint.
        answers = [full_name[topic.name] for topic in topics if topic not in INPUTS.values()]
        topics = [topic for topic in topics if topic not in INPUTS.values()
                  or full_name[topic.name] not in answers]
        names = {topic.name: full_name[topic.name] for topic in topics}
        about = about_of(scene, names, self._node.get_fully_qualified_name())
        if scene.dynamics:               # only the same version of the steps recomputes them
            from fourbar_ros.dynamics import node_step
            about[node_step.KEY] = node_step.NAME
        writer = BagWriter(directory_of(scene), name,
                           [channel(topic, names[topic.name]) for topic in topics], about,
                           scene.recording.split_size * 1e6, scene.recording.split_duration,
                           tell=self._node.get_logger().error)
        return writer, {topic.name: channel_id for channel_id, topic in enumerate(topics)}

    def attach(self, bag: Bag) -> Path:
        """Record into an opened bag from now on; return its path."""
        self._bag, self._refused = bag, ''
        path = bag[0].path
        self._node.get_logger().info(f'recording to {path}')
        return path

    def report(self) -> tuple[dict[str, Any], list[str]]:
        """Return (values, problems) for the diagnostics, of a bag that failed too."""
        bag = self._bag                  # another thread may stop the recording meanwhile
        if not bag:
            return {'recording': 'off'}, [self._refused] if self._refused else []
        writer, _ = bag
        problems = [writer.error] if writer.error else []
        if writer.dropped:
            problems.append(f'{writer.dropped} messages not recorded')
        return {'recording': str(writer.path), 'messages recorded': writer.accepted,
                'messages not recorded': writer.dropped}, problems

    def detach(self) -> BagWriter | None:
        """Stop recording; return the writer of the bag, None if there was none."""
        bag, self._bag = self._bag, None
        return bag and bag[0]

    def close(self, writer: BagWriter, why: str) -> Path:
        """Close a detached bag; return its path; BagError if it ended by an error before."""
        path = writer.close(why)
        self._node.get_logger().info(f'recorded {path}')
        return path

    def write(self, messages: Iterable[tuple[str, bytes]]) -> None:
        """Record messages, (short name of the topic, bytes), if a bag is open; never waits."""
        bag = self._bag                  # another thread may stop the recording meanwhile
        if bag:
            writer, channels = bag
            writer.write_all([(channels[topic], data) for topic, data in messages
                              if topic in channels])

    def note(self, key: str, text: str) -> None:
        """Let later files of a split bag keep another text under a key of their metadata."""
        bag = self._bag
        if bag:
            bag[0].note(key, text)


def about_of(scene: Scene, topics: Mapping[str, str], node: str) -> dict[str, str]:
    """Return the metadata of a bag, ``topics``: {short name: full name}; BagError if large."""
    from fourbar_ros.bag import sides
    from fourbar_ros.bag.origin import bounded
    from fourbar_ros.pipeline import joints, rate_estimator  # only bags need both
    bounded(scene.as_json)
    return {'scene': scene.as_json, 'topics': json.dumps(topics), 'node': node,
            'units': 'SI: m, kg, s, rad, N, N m', 'software': json.dumps(software()),
            rate_estimator.KEY: str(rate_estimator.VERSION), joints.KEY: joints.CONTINUOUS,
            sides.KEY: sides.BRANCHES}


def directory_of(scene: Scene) -> Path:
    """Return the absolute folder for bags; BagError if it is relative to a removed one."""
    try:
        return Path(os.path.expanduser(scene.recording.directory)).absolute()
    except FileNotFoundError:
        raise BagError(f'recording.directory = {scene.recording.directory!r}: the working '
                       'directory has been removed') from None


def software() -> dict[str, str]:
    from importlib.metadata import PackageNotFoundError, version  # 15 ms, and only bags ask

    versions = {'fourbar_ros': __version__, 'python': platform.python_version()}
    for name in SOFTWARE:
        for distribution in (name, f'ros-jazzy-{name}'):
            with contextlib.suppress(PackageNotFoundError):
                versions[name] = version(distribution)
    return versions
