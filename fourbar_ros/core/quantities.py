"""What can be asked for by name: searched for extremes, tabulated, plotted."""
from __future__ import annotations

from typing import NamedTuple

from .errors import FourBarError


class UnknownQuantity(FourBarError, KeyError):
    """A quantity of this name does not exist; the message lists those that do."""

    def __init__(self, name):
        self.name = name
        super().__init__(f'unknown quantity {name!r}; known: {", ".join(QUANTITIES)}')

    def __str__(self):
        return self.args[0]


class Quantity(NamedTuple):
    """A number that a linkage has for each input: a field of Motion or, if ``is_load``, of Loads."""

    name: str
    unit: str
    text: str
    is_load: bool

    def of(self, motion, loads):
        """Return its value from what :meth:`FourBar.step` returns."""
        return getattr(loads if self.is_load else motion, self.name)


QUANTITIES = {quantity.name: quantity for quantity in (
    Quantity('omega4', 'rad/s', 'angular velocity of the output link', False),
    Quantity('alpha4', 'rad/s^2', 'angular acceleration of the output link', False),
    Quantity('shaking_force', 'N', 'magnitude of the force on the ground', True),
    Quantity('shaking_moment', 'N m', 'moment on the ground about O1', True),
    Quantity('driving_torque', 'N m', 'torque of the drive on the crank', True),
    Quantity('f41', 'N', 'magnitude of the reaction at O1', True),
    Quantity('f21', 'N', 'magnitude of the reaction at A', True),
    Quantity('f32', 'N', 'magnitude of the reaction at B', True),
    Quantity('f43', 'N', 'magnitude of the reaction at O4', True),
)}


def select(names=(), with_loads=True):
    """Return the quantities of these names, or all of them (without loads if there are no masses)."""
    unknown = [name for name in names if name not in QUANTITIES]
    if unknown:
        raise UnknownQuantity(unknown[0])
    if names:
        return [QUANTITIES[name] for name in names]
    return [quantity for quantity in QUANTITIES.values() if with_loads or not quantity.is_load]
