# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""fourbar_node: one linkage, driven by the clock or by messages; publishes, answers, records."""
from __future__ import annotations

from collections.abc import Sequence
import contextlib
import gc
import sys
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.node import parameters, services
from fourbar_ros.ros.node.base import Base, CHANGES
from fourbar_ros.ros.node.circles import Circles
from fourbar_ros.ros.node.diagnostics import Diagnostics
from fourbar_ros.ros.node.drives import Drive, SimulatedTimerDrive, TimerDrive
from fourbar_ros.ros.node.quiet_log import QuietLog
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.ros.node.steady import SteadyTimers
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.ros.node.worker import Worker
from fourbar_ros.ros.stop import Stop
from fourbar_ros.scene.arguments import check_node_arguments, full_name, NODE_HELP, node_names
from fourbar_ros.scene.parameter_table import SOURCES
from fourbar_ros.scene.plausible import warnings_of
from fourbar_ros.scene.scene import check_for_node, Scene
from fourbar_ros.scene.topics import SERVICES
import rclpy
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.signals import SignalHandlerOptions

if TYPE_CHECKING:      # only the scenes that want them
    from fourbar_ros.ros.node.trajectories import Trajectories
    from fourbar_ros.ros.node.wrenches import WrenchInputs

UnknownArguments = rclpy_implementation.UnknownROSArgsError
# A file that rcl cannot parse, names that are not valid; another type for a parameter than rclpy
# has declared.
ROS_ERRORS = (rclpy_implementation.RCLError, UnknownArguments, NameValidationException,
              ParameterException)
SWITCH = 0.001  # [s] how long a busy thread may hold the interpreter (Python: 5 ms)
PATIENCE = 0.5  # [s] for a search to see that it is abandoned: it looks every few milliseconds
SPIN = 0.2      # [s] timeout of the executor: without one it can hang (see docs/node.md)


class FourBarNode(Base):
    """
    The node of a scene; see docs/node.md for its topics, services and parameters.

    ``arguments``: the command line, with the scene; ``name`` may begin with a namespace.
    """

    def __init__(self, arguments: Sequence[str] = (), name: str = 'fourbar', **kwargs: Any
                 ) -> None:
        """Read and check the scene, make all parts of the node, begin to record and to drive."""
        if '/' in name:      # set its namespace here: one on the command line would override it
            namespace, name = full_name(arguments, name).rsplit('/', 1)
            kwargs['cli_args'] = ['--ros-args', '-r', f'__ns:={namespace}']
        super().__init__(name, automatically_declare_parameters_from_overrides=True, **kwargs)
        scene = parameters.scene(self, arguments)
        check_for_node(scene)
        for warning in warnings_of(scene):
            self.get_logger().warning(warning)
        self.failure = None                  # a fault in any thread, raised by main
        self.steady_timers = SteadyTimers()
        self.log = QuietLog(self.get_logger())
        self.circles = Circles(self, scene)
        self.recording = Recording(self)
        self.stream = Stream(self, scene, self.recording)
        self.drive = self._drive_of(scene.drive.source)(self, self.stream, self.recording)
        self.wrenches = self._wrench_inputs(scene)
        self.trajectories = self._trajectories(scene)
        parameters.watch(self, lambda: self.stream.scene, self.apply)
        wanted = {name for service in scene.values['services']
                  for name in SERVICES[service].workers}
        self.workers = {name: Worker(name, self.get_logger().error)
                        for name in {*wanted, CHANGES}}
        services.create(self)
        self._diagnostics = Diagnostics(self)
        if scene.recording.start:
            self.recording.begin(scene, self.stream.start_recording)
        self.drive.start()
        self.get_logger().info(f'{scene.linkage.classification}, mode {scene.linkage.mode}, '
                               f'driven by {scene.drive.source}')

    def _drive_of(self, source: str) -> type[Drive]:
        """Return the class of the drive for a ``drive.source``; import only what it needs."""
        is_simulated = self.get_parameter('use_sim_time').value
        if source in SOURCES:                # torque or motor
            from fourbar_ros.ros.node.torque import SimulatedTorqueDrive, TorqueDrive
            return SimulatedTorqueDrive if is_simulated else TorqueDrive
        if source != 'timer':
            from fourbar_ros.ros.node.topic_drive import TopicDrive
            return TopicDrive
        return SimulatedTimerDrive if is_simulated else TimerDrive

    def _wrench_inputs(self, scene: Scene) -> WrenchInputs | None:
        """Return the topics of external forces, None if the scene has none."""
        if not scene.wrenches.links:
            return None
        from fourbar_ros.ros.node.wrenches import WrenchInputs  # and its messages
        return WrenchInputs(self, self.stream, self.recording)

    def _trajectories(self, scene: Scene) -> Trajectories | None:
        """Return the converter of trajectories, None if the scene wants none."""
        if not scene.values['trajectories']:
            return None
        from fourbar_ros.ros.node.trajectories import Trajectories  # and its messages
        return Trajectories(self, scene)

    def apply(self, scene: Scene) -> None:
        """
        Take over a changed scene; raise FourBarError if it is invalid.

        All that takes long is made beside the stream; then the scenes are swapped between two
        callbacks of the executor and two steps, so that no input waits.
        """
        check_for_node(scene)
        self.drive.prepare(scene)
        prepared = self.stream.prepare(scene)

        def swap() -> None:
            settings_changed = scene.drive != self.stream.scene.drive
            self.stream.apply(prepared)
            if self.wrenches:
                self.wrenches.apply(scene)
            if settings_changed or scene.dynamics:
                self.drive.apply(scene.drive)
        self.between_callbacks(swap)
        if self.trajectories:
            self.trajectories.apply(scene)

    def fail(self, error: Exception) -> None:
        """Have main raise an error."""
        self.failure = error

    def close(self, why: str = 'the node ended') -> None:
        """Abandon searches, stop the stream, close the bag with ``why`` as reason, destroy all."""
        others = [worker for name, worker in self.workers.items() if name != 'bag']
        for worker in others:
            worker.abandon()                 # first: they hold up all that follows
        self.drive.stop()
        if 'bag' in self.workers:            # a bag that it is opening or closing is closed there
            self.workers['bag'].stop()
        try:
            self.stream.stop_recording(why)
        except FourBarError:
            pass                             # the bag ended by an error before, which was logged
        finally:
            self.log.flush(0.0)
            for worker in others:
                worker.stop(PATIENCE)
            if self.trajectories:
                self.trajectories.stop(PATIENCE)
            self.destroy_node()


def main(args: list[str] | None = None, stop: Stop | None = None) -> int:
    """Run the nodes of the command line until a signal; return 0, or 2 for an invalid scene."""
    given = sys.argv[1:] if args is None else args[1:]
    if given in (['-h'], ['--help']):
        print(NODE_HELP, end='')
        return 0
    stop, nodes = stop or Stop().catch(), []
    try:
        check_node_arguments(given)
        begin_ros(args)
        for name in node_names(given):
            nodes.append(FourBarNode(given, name))
    except (FourBarError, *ROS_ERRORS) as error:
        print(f'fourbar_node: {in_one_line(error)}', file=sys.stderr)
        close(nodes)
        rclpy.try_shutdown()
        return 2
    warn_of_shared_frames(nodes)
    sys.setswitchinterval(SWITCH)
    gc.freeze()          # else each full collection stops the stream for 20 ms over the imports
    try:
        spin(nodes, stop)
    finally:
        close(nodes, f'the node ended by {stop.name}' if stop.name else 'the node ended')
        rclpy.try_shutdown()
        stop.ignore()
    for node in nodes:
        if node.failure:
            raise node.failure
    return 0


def begin_ros(args: list[str] | None) -> None:
    """Begin ROS; raise FourBarError if the file of its log cannot be written."""
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    except ROS_ERRORS:
        raise
    except RuntimeError as error:
        raise FourBarError(f'no log (ROS_LOG_DIR): {error}') from None


def warn_of_shared_frames(nodes: Sequence[FourBarNode]) -> None:
    """Warn where two nodes publish a TF frame of one name: it would jump between two poses."""
    publishers = [node for node in nodes if 'tf' in node.stream.scene.outputs]
    if len(publishers) < 2:
        return
    from fourbar_ros.ros.node.transforms import frames_of
    owners: dict[str, str] = {}              # {frame: node}
    for node in publishers:
        frames = frames_of(node.stream.scene)
        shared = sorted(frames & owners.keys())
        if shared:
            node.get_logger().warning(
                f'frames {", ".join(shared)}: also of {owners[shared[0]]}; a prefix keeps them '
                'apart: joint_states.prefix')
        owners.update(dict.fromkeys(frames, node.get_name()))


def close(nodes: Sequence[FourBarNode], why: str = 'the node ended') -> None:
    """Close all nodes, even if one of them raises; ``why`` goes into their bags."""
    with contextlib.ExitStack() as stack:
        for node in nodes:
            stack.callback(node.close, why)


def in_one_line(error: Exception) -> str:
    """Return the message of an error at start, in one line."""
    if isinstance(error, UnknownArguments):
        return f'ROS 2 knows no argument {error}'
    return ' '.join(str(error).split())


def spin(nodes: Sequence[FourBarNode], stop: Stop) -> None:
    """
    Handle messages and timers of all nodes until a signal has come or a node has failed.

    An exception of a callback is kept as failure of the first node, for main to raise.
    """
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
        node.steady_timers.start(executor, node.fail)
    try:
        while not stop.requested and not any(node.failure for node in nodes):
            executor.spin_once(timeout_sec=SPIN)
    except Exception as error:
        nodes[0].failure = error
    finally:
        for node in nodes:
            node.steady_timers.stop()
        executor.shutdown()


if __name__ == '__main__':
    sys.exit(main())
