# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node of one linkage, driven by the clock or by messages; publishes, answers, records."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Future, wait
from traceback import format_exc
from typing import Any, TYPE_CHECKING, Union

from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.messages import Message
from fourbar_ros.ros.node import parameters
from fourbar_ros.ros.node.clock_input import ClockInput
from fourbar_ros.ros.node.diagnostics import Diagnostics
from fourbar_ros.ros.node.entities import log_of
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.ros.node.run import Run
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.ros.node.worker import answer_beside, both, WAITING, Worker
from fourbar_ros.scene.linkage import warnings_of
from fourbar_ros.scene.scene import check_for_node, Scene
from fourbar_ros.scene.settings import SOURCES
from fourbar_ros.scene.topics import SERVICES
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock

if TYPE_CHECKING:      # only the scenes that want it
    from fourbar_ros.ros.node.topic_input import TopicInput

CHANGES = 'changes'    # name of the thread that changes parameters, beside the stream
LOOK = 0.1             # [s] between two looks whether the node stops
PATIENCE = 0.5         # [s] for a search to see that it is abandoned: it looks every milliseconds


class FourBarNode(Node):
    """
    The node of a scene; see docs/node.md for its topics, services and parameters.

    ``name`` may begin with a namespace of its own, below ``namespace``; ``files`` are the
    parameter files of the command line. It survives requests that an rclpy node does not.
    """

    def __init__(self, name: str = 'fourbar', namespace: str = '', files: Sequence[str] = (),
                 **kwargs: Any) -> None:
        """Read and check the scene, make all parts of the node, begin to record and to drive."""
        own, _, name = name.rpartition('/')
        if own:     # set its namespace here: one on the command line would override it
            full = '/'.join(filter(None, (namespace.strip('/'), own)))
            kwargs['cli_args'] = ['--ros-args', '-r', f'__ns:=/{full}']
        super().__init__(name, automatically_declare_parameters_from_overrides=True, **kwargs)
        scene = parameters.scene(self, files)
        self._check(scene)
        for warning in warnings_of(scene):
            self.get_logger().warning(warning)
        wanted = {name for service in scene.values['services']
                  for name in SERVICES[service].workers}
        self.workers = {name: Worker(name, self.get_logger().error)
                        for name in {*wanted, CHANGES}}
        self.log, self.recording = log_of(self), Recording(self)
        self.stream = Stream(self, Run(scene), self.recording, self.log)
        self.input = self._input_of(scene.drive.source)
        self.wrenches = self.trajectories = None
        if scene.wrenches.links:
            from fourbar_ros.ros.node.wrenches import WrenchInputs  # and its messages
            self.wrenches = WrenchInputs(self, self.stream)
        if scene.values['trajectories']:
            from fourbar_ros.ros.node.trajectories import Trajectories  # and its messages
            self.trajectories = Trajectories(self, self.stream, self.log)
        parameters.watch(self, lambda: self.stream.scene, self.apply)
        if scene.values['services']:
            from fourbar_ros.ros.node import services  # and their messages
            services.create(self, self.stream, self.workers)
        counting = [part for part in (self.wrenches, self.trajectories) if part]
        Diagnostics(self, self.stream, self.input, counting, self.recording, self.log)
        if scene.recording.start:
            self.recording.begin(scene, self.stream.start_recording)
        self.get_logger().info(f'{scene.linkage.classification}, mode {scene.linkage.mode}, '
                               f'driven by {scene.drive.source}')

    def _input_of(self, source: str) -> Union[ClockInput, TopicInput]:
        """Return the input for a ``drive.source``; import only what it needs."""
        if source in SOURCES:                # torque or motor
            from fourbar_ros.ros.node.torque_input import TorqueInput
            return TorqueInput(self, self.stream, self.log)
        if source == 'timer':
            return ClockInput(self, self.stream, self.log)
        from fourbar_ros.ros.node.topic_input import TopicInput
        return TopicInput(self, self.stream, self.log)

    def _check(self, scene: Scene) -> None:
        """Refuse a scene that a node cannot run, or whose answers would be its own inputs."""
        check_for_node(scene)
        received = {self.resolve_topic_name(topic.topic): topic for topic in scene.received}
        for topic in scene.published:
            name = self.resolve_topic_name(topic.topic)
            if name in received and not (topic.name == 'joint_states'
                                         and scene.joint_states.only_passive):
                raise FourBarError(
                    f'{topic.topic} and {received[name].topic} are one topic, {name}: the node '
                    'would take its own answers for inputs' + (
                        '; joint_states.only_passive leaves the driven joint to its publisher'
                        if topic.name == 'joint_states' else ''))

    def apply(self, scene: Scene) -> None:
        """
        Take over a changed scene; raise FourBarError if it is invalid.

        All that takes long is made beside the stream; then the runs are swapped between two
        callbacks of the executor and two steps, so that no input waits.
        """
        self._check(scene)
        run = Run(scene, self.stream.run, self.stream.run.stepper.wrenches)

        def swap() -> None:
            self.stream.swap(run)
            if self.wrenches:
                self.wrenches.renew()
        self._between_callbacks(swap)

    def close(self, why: str = 'the node ended') -> None:
        """Abandon searches, stop the stream, close the bag with ``why`` as reason, destroy all."""
        others = [worker for name, worker in self.workers.items() if name != 'bag']
        for worker in others:
            worker.abandon()                 # first: they hold up all that follows
        self.input.stop()
        if 'bag' in self.workers:            # a bag that it is opening or closing is closed there
            self.workers['bag'].stop()
        try:
            self.stream.stop_recording(why)
        except FourBarError:
            pass                             # the bag ended by an error before, which was logged
        finally:
            for worker in others:
                worker.stop(PATIENCE)
            if self.trajectories:
                self.trajectories.stop(PATIENCE)
            self.destroy_node()

    # --- what rclpy's node does not survive ------------------------------------------------------

    def declare_parameters(self, namespace: str, parameters: Any,
                           ignore_override: bool = False) -> list[Parameter]:
        """Declare (name, value, ...); an empty list in a file comes as None, refused by rclpy."""
        return list(super().declare_parameters(
            namespace, [(name, [] if value is None else value, *rest)
                        for name, value, *rest in parameters], ignore_override))

    def set_parameters_atomically(self, parameter_list: Sequence[Parameter]
                                  ) -> SetParametersResult:
        """Set parameters; take 3 for a double, and an empty list for one of any type."""
        for parameter in parameter_list:
            if not self.has_parameter(parameter.name):   # rclpy overlooks an empty name
                raise ParameterNotDeclaredException(parameter.name)
        return super().set_parameters_atomically(
            list(map(parameters.as_declared, parameter_list)))

    def create_subscription(self, msg_type: type[Any], topic: str,
                            callback: Callable[..., object], *qos: Any, **options: Any) -> Any:
        """Create a subscription; of /clock it ignores times below zero, which end rclpy's node."""
        def guarded(message: Message) -> None:
            if message.clock.sec < 0:
                self.log('clock', f'/clock: {message.clock.sec} s is no time: ignored')
            else:
                callback(message)
        return super().create_subscription(
            msg_type, topic, guarded if msg_type is Clock else callback, *qos, **options)

    def create_service(self, srv_type: type[Any], srv_name: str,
                       callback: Callable[[Message, Message], Message], **options: Any) -> Any:
        """Create a service; an exception in its callback is logged and does not end the node."""
        def guarded(request: Message, response: Message) -> Message:
            try:
                return callback(request, response)
            except Exception:
                self.get_logger().error(f'a fault in {srv_name}: {format_exc()}')
                return response
        if srv_type not in (SetParameters, SetParametersAtomically):
            return super().create_service(srv_type, srv_name, guarded, **options)
        service = super().create_service(srv_type, srv_name, both, **options)
        answer_beside(service, guarded, _busy, lambda _: self.workers[CHANGES])
        return service

    def _between_callbacks(self, job: Callable[[], None]) -> None:
        """Do a job of the thread CHANGES between two callbacks of the executor; wait for it."""
        worker, done = self.workers[CHANGES], Future[None]()
        if self.executor is None or not worker.is_this_thread:
            job()
            return

        def run() -> None:
            try:
                job()
                done.set_result(None)
            except Exception as error:
                done.set_exception(error)
        self.executor.create_task(run)
        while not wait([done], LOOK).done:
            worker.check()
        done.result()


def _busy(request: Message, response: Message) -> Message:
    """Refuse to set parameters: too many changes wait."""
    refused = SetParametersResult(reason=f'{WAITING} changes wait already: try again later')
    if hasattr(response, 'results'):
        response.results = [refused] * len(request.parameters)
    else:
        response.result = refused
    return response
