# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node of one linkage, driven by the clock or by messages; publishes, answers, records."""
from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future, wait
from math import copysign, inf, isnan
from pathlib import Path
import time
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.ros.node import clock_input, diagnostics, entities, rclpy_guard, stream
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene import settings, topics
from fourbar_ros.scene.parameters import find_parameter, of_name
from fourbar_ros.scene.scene import from_values, naming_nan, Scene
from rcl_interfaces import msg
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter

if TYPE_CHECKING:      # only the scenes that want it
    from fourbar_ros.ros.node.topic_input import TopicInput

PAUSE = 5e-5           # [s] between two pieces of a change
UNLIMITED = 1e9        # a limit of a parameter from here on is no slider's
LOOK = 0.1             # [s] between two looks whether the node stops
PATIENCE = 0.5         # [s] for a search to see that it is abandoned: it looks every milliseconds


class FourBarNode(rclpy_guard.GuardedNode):
    """
    The node of a scene; see docs/node.md for its topics, services and parameters.

    ``name`` may begin with a further namespace, below ``namespace``; ``arguments`` are those of
    the command line.
    """

    def __init__(self, name: str = 'fourbar', namespace: str = '', arguments: Sequence[str] = (),
                 **kwargs: Any) -> None:
        further, _, name = name.rpartition('/')
        if further:     # set here: a namespace on the command line would override it
            full = '/'.join(filter(None, (namespace.strip('/'), further)))
            kwargs['cli_args'] = ['--ros-args', '-r', f'__ns:=/{full}']
        super().__init__(name, automatically_declare_parameters_from_overrides=True,
                         enable_logger_service=True, **kwargs)
        scene = scene_of(self, arguments)
        # nothing is created before all is checked: a node that hears its own answers is refused
        self._check(scene)
        entities.check_qos_overrides(self, scene)
        for warning in scene.warnings:
            self.get_logger().warning(warning)
        # long answers have threads of their own; changes of parameters always, of any node
        wanted = {worker for service in scene.values['services']
                  for worker in topics.SERVICES[service].workers}
        self.workers = {worker: entities.Worker(worker, self.get_logger().error)
                        for worker in {*wanted, rclpy_guard.CHANGES}}
        self.troubles, recording = entities.Troubles(self), Recording(self)
        self.stream = stream.Stream(self, stream.RunningScene(scene), recording, self.troubles)
        self.input: clock_input.ClockInput | TopicInput
        if scene.drive.source == 'timer':
            self.input = clock_input.ClockInput(self, self.stream, self.troubles)
        elif scene.drive.source in settings.SOURCES:      # torque or motor
            from fourbar_ros.ros.node.torque_input import TorqueInput
            self.input = TorqueInput(self, self.stream, self.troubles)
        else:
            from fourbar_ros.ros.node import topic_input
            self.input = topic_input.TopicInput(self, self.stream, self.troubles)
        self.acting = self.trajectories = None
        if scene.acting:
            from fourbar_ros.ros.node.acting import ActingInputs  # where a scene needs it
            self.acting = ActingInputs(self, self.stream, self.troubles)
        if scene.values['trajectories']:
            from fourbar_ros.ros.node.trajectories import Trajectories  # and its messages
            self.trajectories = Trajectories(self, self.stream, self.troubles)
        self.add_on_set_parameters_callback(self._changed)
        if scene.values['services']:
            from fourbar_ros.ros.node import services  # and their messages
            services.create(self, self.stream, self.workers)
        diagnostics.Diagnostics(self, self.stream, self.input, recording, self.troubles)
        if scene.recording.start:
            recording.begin(scene, self.stream.start_recording)
        self.get_logger().info(f'{scene.linkage.classification}, mode {scene.linkage.mode}, '
                               f'driven by {scene.drive.source}')

    def _check(self, scene: Scene) -> None:
        """Refuse a scene that receives on a topic on which the node publishes its answers."""
        received = {self.resolve_topic_name(topic.topic): topic for topic in scene.received}
        for topic in scene.published:
            name = self.resolve_topic_name(topic.topic)
            if name not in received:
                continue
            is_joints = topic.name == 'joint_states' and received[name].name == 'joint_state'
            if is_joints and scene.drive.joint not in scene.names_shown:
                continue                # a joint that is another publisher's: no answer has it
            raise FourBarError(
                f'{topic.topic} and {received[name].topic} are one topic, {name}: the node would '
                'take its own answers for inputs' + (
                    f', which have {scene.drive.joint}; joint_states.only_passive leaves the '
                    'driven joint to its publisher' if is_joints else ''))

    def _changed(self, parameters: Sequence[RosParameter]) -> msg.SetParametersResult:
        """
        Take over a change of parameters, checked as a whole scene, or say why not.

        A refused change changes nothing, even if only :meth:`apply` finds out, or if an error is
        ours.
        """
        # The scene changes while rclpy asks whether it may: the callback after rclpy has set the
        # parameters cannot refuse any more. No other callback can refuse these parameters.
        before, changes = self.stream.scene, {}
        try:
            for parameter in parameters:
                name, value = parameter.name, parameter.value
                if find_parameter(name):
                    changes[name] = value
                elif value != self.get_parameter(name).value:    # of rclpy, as use_sim_time
                    raise InvalidParameter(name, value, 'only at start')
            if changes:
                with naming_nan(changes):
                    self.apply(before.with_values(changes, let_inputs_pass))
        except Exception as error:
            if self.stream.scene is not before:      # it failed after the scene was swapped
                self.apply(before)
            if not isinstance(error, FourBarError):
                raise                        # a fault of ours: the service says so
            return msg.SetParametersResult(successful=False, reason=str(error))
        return msg.SetParametersResult(successful=True)

    def apply(self, scene: Scene) -> None:
        """
        Take over a changed scene; raise FourBarError if it is invalid.

        All that takes long is made beside the stream; then the runs are swapped between two
        callbacks of the executor and two steps, so that no input waits.
        """
        self._check(scene)
        let_inputs_pass()
        before = self.stream.run
        run = stream.RunningScene(scene, before, before.stepper.acting, let_inputs_pass)
        let_inputs_pass()

        def swap() -> None:
            try:
                self.stream.swap(run)
                if self.acting:
                    self.acting.renew()
                done.set_result(None)
            except Exception as error:
                done.set_exception(error)
        worker, done = self.workers[rclpy_guard.CHANGES], Future[None]()
        if self.executor is None or not worker.is_this_thread:
            swap()
        else:
            self.executor.create_task(swap)
        while not wait([done], LOOK).done:
            worker.check()
        done.result()
        for warning in scene.warnings:
            if warning not in before.scene.warnings:
                self.get_logger().warning(warning)

    def close(self, why: str = 'the node ended') -> None:
        """Abandon searches, stop the stream, close the bag with ``why`` as reason, destroy all."""
        searches = [worker for name, worker in self.workers.items() if name != 'bag']
        for worker in searches:
            worker.abandon()                 # first: they hold up all that follows
        self.input.stop()
        if 'bag' in self.workers:            # a bag that it is opening or closing is closed there
            self.workers['bag'].stop()
        try:
            self.stream.stop_recording(why)
        except FourBarError:
            pass                             # the bag ended by an error before, which was logged
        finally:
            for worker in searches:
                worker.stop(PATIENCE)
            if self.trajectories:
                self.trajectories.stop(PATIENCE)
            self.destroy_node()


# --- parameters: declared as the table says, read as a scene -------------------------------------

# Parameters of rclpy.
SWITCHES = ('use_sim_time', 'start_type_description_service')
BUILT_IN = (*SWITCHES, entities.OVERRIDES)

_ROS_TYPES = {kind: getattr(msg.ParameterType, f'PARAMETER_{name}') for kind, name in (
    ('double', 'DOUBLE'), ('integer', 'INTEGER'), ('string', 'STRING'), ('bool', 'BOOL'),
    ('strings', 'STRING_ARRAY'), ('doubles', 'DOUBLE_ARRAY'))}


def scene_of(node: Node, arguments: Sequence[str] = ()) -> Scene:
    """
    Return the Scene of a node, from the parameters that files and command line gave it.

    rclpy has declared them as they came. They are read and declared again with type and text from
    the table: so an unknown name is an error instead of being ignored, and ``3`` and ``40mm`` are
    good for a double. ``arguments``: of the command line, with the parameter files, beside which
    the tables of forces stand. Raises InvalidParameter for a value that is not allowed.
    """
    every = {name: parameter.value
             for name, parameter in node.get_parameters_by_prefix('').items()}
    for name in SWITCHES:
        if type(every.get(name, True)) is not bool:
            raise InvalidParameter(name, every[name], 'must be a bool')
    parameters = {name: value for name, value in every.items() if not name.startswith(BUILT_IN)}
    if arguments:
        from fourbar_ros.scene.files import overrides
        last = overrides(arguments, node.get_fully_qualified_name())
        parameters |= {name: last[name] for name in parameters if name in last}
    files = [file for option, file in zip(arguments, arguments[1:]) if option == '--params-file']
    values: settings.ParameterValues = parameters
    if any(name.startswith('forces.') for name in parameters):
        from fourbar_ros.scene.files import with_tables  # where a scene needs it
        values = with_tables(parameters, [Path(), *(Path(file).parent for file in files)])
    with naming_nan(parameters):
        scene = from_values(values)
    for name in parameters:
        node.undeclare_parameter(name)
    for name, value in scene.values.items():
        node.declare_parameter(name, value, descriptor(of_name(name)), ignore_override=True)
    return scene


def let_inputs_pass() -> None:
    """Let inputs go first that came while a piece of a change was made."""
    time.sleep(PAUSE)


def descriptor(parameter: settings.Parameter) -> msg.ParameterDescriptor:
    """
    Return the ROS descriptor of a parameter: type, text with unit, limits, whether fixed.

    What may be left out, as NaN, has no limits there: rclpy finds NaN beyond them.
    """
    unit = f' [{parameter.unit}]' if parameter.unit else ''
    low, high = (limit if abs(limit) < UNLIMITED else copysign(inf, limit) for limit in (
        max(parameter.low, 0.0) if parameter.positive else parameter.low, parameter.high))
    integers, floats = [], []
    if parameter.type == 'integer' and high < inf:
        integers = [msg.IntegerRange(from_value=int(low), to_value=int(high))]
    elif parameter.type == 'double' and max(low, -high) > -inf and not isnan(parameter.default):
        floats = [msg.FloatingPointRange(from_value=low, to_value=high)]
    return msg.ParameterDescriptor(
        name=parameter.name, type=_ROS_TYPES[parameter.type], read_only=not parameter.live,
        integer_range=integers, floating_point_range=floats, description=parameter.text + unit,
        dynamic_typing=parameter.type in ('strings', 'doubles'),  # an empty list is one of bytes
        additional_constraints=parameter.allowed)
