"""What can be asked for by name: searched for extremes, tabulated, plotted."""
from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

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


class Function(NamedTuple):
    """A number given as a function (Motion, Loads) -> value, for floats and arrays, real and complex."""

    name: str
    unit: str
    text: str
    of: Callable
    is_load: bool = False     # not known; without masses, loads raise MissingBodies when used


def coupler_point_speed(linkage, along, across=0.0):
    """Return the speed [m/s] of a point of the coupler, given in its frame (from A, towards B) [m]."""
    def speed(motion, loads):
        x, y = _from_a(motion, along, across)
        v_x = -linkage.a1 * motion.omega1 * motion.sin_x - motion.omega_beta * y
        v_y = linkage.a1 * motion.omega1 * motion.cos_x + motion.omega_beta * x
        return np.sqrt(v_x * v_x + v_y * v_y)
    return Function('coupler_point_speed', 'm/s', f'speed of the coupler point ({along:g}, {across:g}) m', speed)


def coupler_point_acceleration(linkage, along, across=0.0):
    """Return the magnitude of the acceleration [m/s^2] of a point of the coupler, as the speed."""
    def acceleration(motion, loads):
        x, y = _from_a(motion, along, across)
        square, other = motion.omega1 * motion.omega1, motion.omega_beta * motion.omega_beta
        a_x = (-linkage.a1 * (motion.alpha1 * motion.sin_x + square * motion.cos_x)
               - motion.alpha_beta * y - other * x)
        a_y = (linkage.a1 * (motion.alpha1 * motion.cos_x - square * motion.sin_x)
               + motion.alpha_beta * x - other * y)
        return np.sqrt(a_x * a_x + a_y * a_y)
    return Function('coupler_point_acceleration', 'm/s^2',
                    f'acceleration of the coupler point ({along:g}, {across:g}) m', acceleration)


def _from_a(motion, along, across):
    return along * motion.cos_b - across * motion.sin_b, along * motion.sin_b + across * motion.cos_b


QUANTITIES = {quantity.name: quantity for quantity in (
    Quantity('omega4', 'rad/s', 'angular velocity of the output link', False),
    Quantity('alpha4', 'rad/s^2', 'angular acceleration of the output link', False),
    Quantity('omega_beta', 'rad/s', 'angular velocity of the coupler', False),
    Quantity('alpha_beta', 'rad/s^2', 'angular acceleration of the coupler', False),
    Quantity('shaking_force', 'N', 'magnitude of the force on the ground', True),
    Quantity('shaking_moment', 'N m', 'moment on the ground about O1', True),
    Quantity('driving_torque', 'N m', 'torque of the drive on the crank', True),
    Quantity('f41', 'N', 'magnitude of the reaction at O1', True),
    Quantity('f21', 'N', 'magnitude of the reaction at A', True),
    Quantity('f32', 'N', 'magnitude of the reaction at B', True),
    Quantity('f43', 'N', 'magnitude of the reaction at O4', True),
)}


def is_published(quantity):
    """Return whether this is one of the quantities with a name."""
    return QUANTITIES.get(quantity.name) is quantity


def select(names=(), with_loads=True):
    """Return the quantities of these names, or all of them (without loads if there are no masses)."""
    unknown = [name for name in names if name not in QUANTITIES]
    if unknown:
        raise UnknownQuantity(unknown[0])
    if names:
        return [QUANTITIES[name] for name in names]
    return [quantity for quantity in QUANTITIES.values() if with_loads or not quantity.is_load]
