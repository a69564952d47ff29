# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""All extrema of a scene, as the service answers them."""
from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quantities import Asked, select, UnknownQuantity
from fourbar_ros.numerics.given import rate_of_input
from fourbar_ros.ros.messages import Message, resolve
from fourbar_ros.scene.message_fields import mode_number
from fourbar_ros.scene.scene import Scene

if TYPE_CHECKING:      # not needed by a node that only streams
    from fourbar_ros.extrema.find import Extremum


def search(scene: Scene, request: Message, check: Callable[[], None], response: Message
           ) -> Message:
    """
    Fill and return the response to a request of FindExtrema; errors are answers too.

    ``check()`` is called between pieces of the work; an error that it raises ends the search.
    """
    from fourbar_ros.extrema.find import find_extrema  # not needed by a node that only streams
    extrema: list[Extremum] = []
    try:
        quantities, modes, velocity = _checked(scene, request)
        for mode in modes:
            extrema += find_extrema(scene.linkage.in_mode(mode), quantities, velocity,
                                    request.acceleration, request.certify, check=check,
                                    within=tuple(request.range) or None)
        names = [quantity.name for quantity in quantities]
        extrema.sort(key=lambda extremum: (names.index(extremum.quantity), extremum.mode))
        response.result = response.RESULT_OK
    except UnknownQuantity as error:
        response.result, response.message = response.RESULT_UNKNOWN_QUANTITY, str(error)
    except InvalidParameter as error:
        name = 'range' if error.name == 'within' else error.name
        response.result = response.RESULT_INVALID_REQUEST
        response.message = str(InvalidParameter(name, error.value, error.allowed))
    except _BadRequest as error:
        response.result, response.message = response.RESULT_INVALID_REQUEST, str(error)
    except FourBarError as error:
        response.result, response.message = response.RESULT_UNSUPPORTED, str(error)
    response.extrema = [_message(extremum) for extremum in extrema]
    return response


def _checked(scene: Scene, request: Message) -> tuple[list[Asked], tuple[int, ...], float]:
    """
    Return (quantities, modes, velocity [rad/s or m/s]) of the request.

    A velocity of zero stands for the speed of the timer drive. Raises _BadRequest or
    UnknownQuantity, for :func:`search` to report.
    """
    linkage = scene.linkage
    timer_speed = scene.drive.speed if scene.drive.source == 'timer' else 0.0
    velocity = request.velocity or timer_speed
    modes = _modes(request, linkage)
    if rate_of_input('velocity', velocity) == 0.0:
        raise _BadRequest(f'velocity = {velocity!r}: must not be zero '
                          '(zero stands for the speed of the timer drive, if there is one)')
    rate_of_input('acceleration', request.acceleration)
    names = list(dict.fromkeys(request.quantities))
    quantities = select(names, linkage, scene.point_quantities)
    missing = [quantity.name for quantity in quantities
               if quantity.is_load and linkage.bodies is None]
    if missing:
        raise _BadRequest(f'{missing[0]}: {scene.why_no_loads}')
    return quantities, modes, velocity


def _modes(request: Message, linkage: Mechanism) -> tuple[int, ...]:
    """Return the assembly modes that a request means; raise _BadRequest for one not there."""
    modes = {request.MODE_OF_SCENE: (linkage.mode,), request.MODE_CROSSED: (1,),
             request.MODE_OPEN: (2,), request.MODE_BOTH: tuple(linkage.modes)}
    if request.mode not in modes:
        raise _BadRequest(f'mode = {request.mode}: must be 0 (of the scene), 1, 2 or 3 (both)')
    if missing := [mode for mode in modes[request.mode] if mode not in linkage.modes]:
        raise _BadRequest(f'mode = {missing[0]}: must be 0 (of the scene)'
                          + ''.join(f' or {mode}' for mode in linkage.modes))
    return modes[request.mode]


def _message(extremum: Extremum) -> Message:
    """Return an extremum as a message; its words are the constants KIND_ and PLACE_ there."""
    message = resolve('fourbar_msgs/msg/Extremum')()
    message.quantity, message.unit = extremum.quantity, extremum.unit
    message.mode = mode_number(extremum.mode)
    message.kind = getattr(message, f'KIND_{extremum.kind.upper()}')
    message.place = getattr(message, f'PLACE_{extremum.place.upper().replace("-", "_")}')
    message.side, message.is_global = int(extremum.side), bool(extremum.is_global)
    message.proof = extremum.proof
    for name in ('theta1', 'slide', 'value', 'condition', 'value_condition'):
        setattr(message, name, float(getattr(extremum, name)))
    return message


class _BadRequest(FourBarError):
    pass
