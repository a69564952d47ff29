# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""All extrema of a scene, for the service at one go, for the action piece by piece."""
from __future__ import annotations

from collections.abc import Callable, Sequence
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


class Canceled(FourBarError):
    """Whoever asked has asked to stop."""


class Search:
    """
    The search for extrema that a request of FindExtrema, service or action, asks for.

    ``check()`` is called between pieces of the work; an error that it raises ends the search.
    """

    def __init__(self, scene: Scene, request: Message, check: Callable[[], None]) -> None:
        self._scene, self._request, self._check = scene, request, check

    def answer(self, response: Message,
               progress: Callable[[str, int, int, int, int], None] | None = None) -> Message:
        """
        Fill and return a response or result; errors are answers too.

        With ``progress`` the quantities are searched one by one; it is called before each with its
        name, the mode, the numbers of searches done and of all, and that of extrema so far.
        """
        extrema: list[Extremum] = []
        names: list[str] = []
        try:
            quantities, modes, velocity = self._checked()
            names = [quantity.name for quantity in quantities]
            searches = ([(mode, [quantity]) for quantity in quantities for mode in modes]
                        if progress else [(mode, quantities) for mode in modes])
            for done, (mode, its_quantities) in enumerate(searches):
                if progress:
                    progress(its_quantities[0].name, mode, done, len(searches), len(extrema))
                extrema += self._find(mode, its_quantities, velocity)
            response.result = response.RESULT_OK
        except Canceled as error:
            response.result, response.message = response.RESULT_CANCELED, str(error)
        except UnknownQuantity as error:
            response.result, response.message = response.RESULT_UNKNOWN_QUANTITY, str(error)
        except (_BadRequest, InvalidParameter) as error:
            response.result, response.message = response.RESULT_INVALID_REQUEST, str(error)
        except FourBarError as error:
            response.result, response.message = response.RESULT_UNSUPPORTED, str(error)
        extrema.sort(key=lambda extremum: (names.index(extremum.quantity), extremum.mode))
        response.extrema = [_message(extremum) for extremum in extrema]
        return response

    def _find(self, mode: int, quantities: Sequence[Asked], velocity: float) -> list[Extremum]:
        """Return the extrema of quantities in one assembly mode."""
        from fourbar_ros.extrema.find import find_extrema  # not needed by a node that only streams

        within = tuple(self._request.range) or None
        try:
            return find_extrema(self._scene.linkage.in_mode(mode), quantities, velocity,
                                self._request.acceleration, self._request.certify,
                                check=self._check, within=within)
        except InvalidParameter as error:
            if error.name != 'within':
                raise
            raise InvalidParameter('range', error.value, error.allowed) from None

    def _checked(self) -> tuple[list[Asked], tuple[int, ...], float]:
        """
        Return (quantities, modes, velocity [rad/s or m/s]) of the request.

        A velocity of zero stands for the speed of the timer drive. Raises _BadRequest or
        UnknownQuantity, for :meth:`answer` to report.
        """
        scene, request, linkage = self._scene, self._request, self._scene.linkage
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
