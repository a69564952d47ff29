# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The services of the node: extrema, one evaluation, recording. Errors become responses."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from fourbar_ros.errors import FourBarError, InvalidParameter, OutOfRange
from fourbar_ros.mechanisms.parts import mode_number
from fourbar_ros.numerics.arguments import FARTHEST, rate_of_input
from fourbar_ros.pipeline import stepper
from fourbar_ros.ros.messages import filler, Message, resolve, set_constants, Stamp
from fourbar_ros.ros.node.entities import Worker
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import SERVICES

if TYPE_CHECKING:      # not needed by a node that only streams
    from fourbar_ros.extrema.find import Extremum
    from fourbar_ros.mechanisms.quantities import Named
    from fourbar_ros.ros.node.node import FourBarNode


def create(node: FourBarNode, stream: Stream, workers: Mapping[str, Worker]) -> None:
    """Create the services that the scene names; slow ones are answered in ``workers``."""
    def find_extrema(stream: Stream, request: Message, response: Message) -> Message:
        check = workers['proof' if request.certify else 'search'].check
        return search(stream.scene, request, check, response)

    handlers = {'find_extrema': find_extrema, 'evaluate': evaluate_one,
                'start_recording': start_recording, 'stop_recording': stop_recording}
    for name in stream.scene.values['services']:
        service = SERVICES[name]

        def worker_for(request: Message, names: Sequence[str] = service.workers) -> Worker:
            """Return the thread that answers: proofs have one, so nothing quick waits for them."""
            return workers[names[getattr(request, 'certify', False)]]
        node.create_service(resolve(service.type), service.service,
                            partial(handlers[name], stream),
                            worker_for if service.workers else None)


def evaluate_one(stream: Stream, request: Message, response: Message) -> Message:
    """Answer Evaluate, computed anew: state and loads at one input, or why there are none."""
    scene = stream.scene
    modes = scene.linkage.modes
    if request.mode and request.mode not in modes:
        response.result = response.RESULT_INVALID_REQUEST
        response.message = (f'mode = {request.mode}: must be 0 (of the '
                            f'scene){"".join(f" or {mode}" for mode in modes)}')
        return _with_values(scene, stream.now(), response, request.mode, stepper.INVALID_INPUT,
                            scene.layout.unknown)
    linkage = scene.in_mode(request.mode)
    response.has_loads = linkage.has_loads
    status, motion, loads = stepper.evaluate(linkage, request.position, request.velocity,
                                             request.acceleration, response.has_loads)
    _with_values(scene, stream.now(), response, mode_number(linkage.mode), status,
                 (*motion, *loads))
    driven = linkage.input_coordinate
    invalid = ('RESULT_INVALID_REQUEST', 'position, velocity, acceleration must be finite, an '
               f'angle less than {FARTHEST:.3g} rad in size, and the result finite')
    result, response.message = {
        stepper.OK: ('RESULT_OK', ''),
        stepper.OUT_OF_RANGE: ('RESULT_OUT_OF_RANGE', ''),
        stepper.INVALID_INPUT: invalid, stepper.RATES_UNKNOWN: invalid,
        stepper.TOGGLE: (
            'RESULT_TOGGLE', 'toggle position: rates and loads are unbounded; at the flat '
            'position of a change point the motion goes on, loads are not known'),
        stepper.LOCKED: (
            'RESULT_LOCKED', 'the mechanism locks itself by friction: no drive moves it'),
        stepper.LOADS_UNKNOWN: ('RESULT_OK', 'the ends of a spring meet there: it has no '
                                'direction, so no loads')}[status]
    response.result = getattr(response, result)
    if status == stepper.OUT_OF_RANGE:
        response.message = str(OutOfRange(driven.position, request.position, linkage.input_ranges,
                                          driven.unit))
    if status == stepper.LOADS_UNKNOWN:
        response.has_loads = False
    return response


def _with_values(scene: Scene, stamp: Stamp, response: Message, mode: int, status: int,
                 values: Sequence[float]) -> Message:
    """Fill state, loads and named values of a response to Evaluate; return it."""
    for output in ('state', 'loads'):
        message = getattr(response, output)
        set_constants(output, message, scene)
        filler(output, message, scene.layout)(stamp, status, mode, values)
    if hasattr(response, 'values'):      # messages of an older version may be installed
        from fourbar_ros.mechanisms.quantities import fields_of
        named_value, index_of = resolve('fourbar_msgs/msg/NamedValue'), scene.layout.index_of
        response.values = [named_value(name=name, unit=quantity.unit, value=values[index_of[name]])
                           for name, quantity in fields_of(scene.linkage).items()
                           if scene.linkage.bodies or not quantity.is_load]
    return response


def start_recording(stream: Stream, request: Message, response: Message) -> Message:
    """Answer StartRecording: the path of the new bag, or why there is none."""
    try:
        response.path = str(stream.start_recording(request.name))
        response.success = True
    except FourBarError as error:
        response.message = str(error)
    return response


def stop_recording(stream: Stream, _: object, response: Message) -> Message:
    """Answer Trigger: the message is the path of the bag, or the reason why there is none."""
    try:
        path = stream.stop_recording('stopped by ~/stop_recording')
        response.success = path is not None
        response.message = str(path or 'not recording')
    except FourBarError as error:
        response.message = str(error)
    return response


# --- extrema -------------------------------------------------------------------------------------

def search(scene: Scene, request: Message, check: Callable[[], None], response: Message
           ) -> Message:
    """Fill the response to FindExtrema; an error of ``check()``, called meanwhile, ends it."""
    from fourbar_ros.extrema.find import find_extrema
    from fourbar_ros.mechanisms.quantities import UnknownQuantity
    extrema: list[Extremum] = []
    try:
        quantities, modes, velocity = _checked(scene, request)
        for mode in modes:
            extrema += find_extrema(scene.linkage.in_mode(mode), quantities, velocity,
                                    request.acceleration, request.certify, check=check,
                                    within=tuple(request.range) or None)
        names = [quantity.name for quantity in quantities]
        extrema.sort(key=lambda extremum: (names.index(extremum.quantity), extremum.mode))
        response.extrema = [_message(extremum) for extremum in extrema]
        response.result = response.RESULT_OK
    except UnknownQuantity as error:
        response.result, response.message = response.RESULT_UNKNOWN_QUANTITY, str(error)
    except InvalidParameter as error:
        name = 'range' if error.name == 'within' else error.name
        response.result = response.RESULT_INVALID_REQUEST
        response.message = str(InvalidParameter(name, error.value, error.allowed))
    except FourBarError as error:
        response.result, response.message = response.RESULT_UNSUPPORTED, str(error)
    return response


def _checked(scene: Scene, request: Message) -> tuple[list[Named], tuple[int, ...], float]:
    """Return (quantities, modes, velocity [rad/s or m/s]) of the request, or raise."""
    from fourbar_ros.mechanisms.quantities import is_position, OfDrive, select
    linkage = scene.linkage
    timer_speed = scene.drive.speed if scene.drive.source == 'timer' else 0.0
    velocity = request.velocity if request.velocity != 0.0 else timer_speed
    modes = {request.MODE_OF_SCENE: (linkage.mode,), request.MODE_CROSSED: (1,),
             request.MODE_OPEN: (2,), request.MODE_BOTH: tuple(linkage.modes)}
    if request.mode not in modes:
        raise InvalidParameter('mode', request.mode,
                               'must be 0 (of the scene), 1, 2 or 3 (both)')
    if unknown := [mode for mode in modes[request.mode] if mode not in linkage.modes]:
        raise InvalidParameter('mode', unknown[0], 'must be 0 (of the scene)'
                               + ''.join(f' or {mode}' for mode in linkage.modes))
    names = list(dict.fromkeys(request.quantities))
    quantities = select(names, linkage, scene.point_quantities)
    needs_rate = any(quantity.rate is None if isinstance(quantity, OfDrive)
                     else not is_position(quantity) for quantity in quantities)
    if rate_of_input('velocity', velocity) == 0.0 and needs_rate:
        raise InvalidParameter('velocity', velocity, 'must not be zero but for holding torque and '
                               'positions (zero is the speed of a timer drive, if there is one)')
    rate_of_input('acceleration', request.acceleration)
    missing = [quantity.name for quantity in quantities if quantity.is_load]
    if missing and not linkage.has_loads:
        raise InvalidParameter(missing[0], None, linkage.why_no_loads)
    return quantities, modes[request.mode], velocity


def _message(extremum: Extremum) -> Message:
    """Return an extremum as a message fourbar_msgs/Extremum."""
    message = resolve('fourbar_msgs/msg/Extremum')()
    message.quantity, message.unit = extremum.quantity, extremum.unit
    message.mode = mode_number(extremum.mode)
    message.kind = getattr(message, f'KIND_{extremum.kind.upper()}')
    message.place = getattr(message, f'PLACE_{extremum.place.upper()}')
    message.side, message.is_global = int(extremum.side), bool(extremum.is_global)
    message.proof = extremum.proof
    for name in ('theta1', 'slide', 'value', 'condition', 'value_condition'):
        setattr(message, name, float(getattr(extremum, name)))
    return message
