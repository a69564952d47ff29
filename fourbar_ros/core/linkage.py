"""The planar 4R linkage: lengths, assembly mode, masses; what it is, how far it moves, how it moves."""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import atan2, frexp, fsum, isfinite, ldexp, pi, remainder, sqrt
from numbers import Real
from typing import NamedTuple

import numpy as np

from .bodies import NOT_APPLIED, Applied, Body
from .errors import InvalidParameter, MissingBodies, OutOfRange, Toggle
from .factors import difference_of_squares
from .kinematics import Motion, make_motion
from .loads import Loads, make_loads

CROSSED, OPEN = 1, 2     # assembly modes: sin(theta4 - beta) < 0, > 0

# Samples a numpy evaluation takes at once: its temporaries then stay in the cache.
CHUNK = 8192

EPS = 2.0**-52
_new = tuple.__new__     # of a NamedTuple from a tuple: four times faster than its own constructor

# Signs of (a4 - a1 + a3 - a2, a4 - a1 - a3 + a2, a2 + a3 - a4 - a1) for the eight basic planar 4R
# linkages: McCarthy and Soh, Geometric Design of Linkages, whose first two are exchanged here. Of a
# non-Grashof linkage the name says through which of 0 and pi theta1 and theta4 swing.
_CLASSES = {
    (1, 1, 1): 'Grashof crank-rocker',
    (-1, -1, 1): 'Grashof double-crank',
    (-1, 1, -1): 'Grashof rocker-crank',
    (1, -1, -1): 'Grashof double-rocker',
    (-1, -1, -1): 'non-Grashof 0-0 double-rocker',
    (-1, 1, 1): 'non-Grashof pi-0 double-rocker',
    (1, -1, 1): 'non-Grashof pi-pi double-rocker',
    (1, 1, -1): 'non-Grashof 0-pi double-rocker',
}


class Bodies(NamedTuple):
    """Mass properties of the three moving links."""

    crank: Body
    coupler: Body
    output: Body


class External(NamedTuple):
    """What acts on coupler and output link from outside."""

    coupler: Applied = NOT_APPLIED
    output: Applied = NOT_APPLIED


class DeadPoint(NamedTuple):
    """Crank and coupler in line, one behind the other (stretched) or folded; angles in [rad]."""

    theta1: float
    theta4: float
    stretched: bool


def _squares_of_half(one, other, a3, a4):
    """Return 4 r a4 times (sin^2, cos^2) of half the angle at O1 of the triangle r = one + other, a3, a4."""
    return (fsum((a3, -one, -other, a4)) * fsum((a3, one, other, -a4)),
            fsum((one, other, a4, -a3)) * fsum((one, other, a4, a3)))


def _ranges(a1, a2, a3, a4):
    """Return the ranges of the angle at which a1 leaves the ground link; see FourBar.input_ranges."""
    exponent = frexp(max(a1, a2, a3, a4))[1]
    a1, a2, a3, a4 = (ldexp(length, -exponent) for length in (a1, a2, a3, a4))
    s1 = difference_of_squares(a2, a3, a1, a4)
    s2 = difference_of_squares(a1, -a4, a2, -a3)
    far = 2.0 * atan2(sqrt(difference_of_squares(a2, a3, a1, -a4)), sqrt(-s1)) if s1 < 0.0 else pi
    near = 2.0 * atan2(sqrt(-s2), sqrt(difference_of_squares(a1, a4, a2, -a3))) if s2 < 0.0 else 0.0
    if s1 >= 0.0:
        return ((-pi, pi),) if s2 >= 0.0 else ((near, 2.0 * pi - near),)
    return ((-far, far),) if s2 >= 0.0 else ((-far, -near), (near, far))


def _are_numbers(*values):
    return all(isinstance(value, Real) for value in values)


def _require_finite(theta1, omega1, alpha1):
    for name, value in (('theta1', theta1), ('omega1', omega1), ('alpha1', alpha1)):
        if not isfinite(value):
            raise InvalidParameter(name, value, 'must be a finite number')


@dataclass(frozen=True)
class FourBar:
    """
    Planar four-bar linkage O1-A-B-O4 with four revolute joints.

    O1 = (0, 0), O4 = (a4, 0). Angles are counter-clockwise, theta1 and theta4 absolute at the ground
    pivots (theta4 is the direction from O4 to B), beta the absolute direction from A to B.

    Parameters
    ----------
    a1, a2, a3, a4 : float
        Lengths of input link, coupler, output link and ground [m], positive; the longest must be
        shorter than the other three together.
    mode : int
        Assembly mode: 2 (open) has sin(theta4 - beta) > 0, 1 (crossed) < 0. It is part of the linkage,
        never guessed from an earlier pose.
    bodies : Bodies, optional
        Masses; without them there are no loads.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on coupler and output link.

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and what is allowed.

    """

    a1: float
    a2: float
    a3: float
    a4: float
    mode: int = OPEN
    bodies: Bodies | None = None
    gravity: tuple[float, float] = (0.0, 0.0)
    external: External = External()

    def __post_init__(self):
        lengths = self.lengths
        for name, value in zip(('a1', 'a2', 'a3', 'a4'), lengths):
            if not (isfinite(value) and value > 0.0):
                raise InvalidParameter(name, value, 'a length must be a positive number')
        longest = max(lengths)
        if fsum(lengths + (-longest, -longest)) <= 0.0:
            raise InvalidParameter(f'a{lengths.index(longest) + 1}', longest,
                                   'the links cannot close: it must be shorter than the other three '
                                   f'together ({fsum(lengths + (-longest,))!r})')
        if self.mode not in (CROSSED, OPEN):
            raise InvalidParameter('mode', self.mode, 'must be 1 (crossed) or 2 (open)')
        if not (len(self.gravity) == 2 and all(map(isfinite, self.gravity))):
            raise InvalidParameter('gravity', self.gravity, 'must be two finite numbers')

    @property
    def lengths(self):
        """Return (a1, a2, a3, a4) [m]."""
        return (self.a1, self.a2, self.a3, self.a4)

    @property
    def sign(self):
        """Return the sign of sin(theta4 - beta): the assembly mode as +1 or -1."""
        return 1.0 if self.mode == OPEN else -1.0

    def in_mode(self, mode):
        """Return the same linkage in another assembly mode."""
        return self if mode == self.mode else replace(self, mode=mode)

    # --- what it is -----------------------------------------------------------------------------

    @cached_property
    def change_point_margin(self):
        """
        Return the smallest of |a1+a4-a2-a3|, |a1+a2-a3-a4|, |a1+a3-a2-a4| over the perimeter.

        Zero: a change point, where both assembly modes meet and the linkage can leave its mode.
        """
        return min(map(abs, self._margins)) / fsum(self.lengths)

    @cached_property
    def _margins(self):
        a1, a2, a3, a4 = self.lengths
        return (fsum((a4, -a1, a3, -a2)), fsum((a4, -a1, -a3, a2)), fsum((a2, a3, -a4, -a1)))

    @cached_property
    def classification(self):
        """Return the Grashof type by name; 'change point' where the sums of two links are equal."""
        if 0.0 in self._margins:
            return 'change point'
        return _CLASSES[tuple(1 if margin > 0.0 else -1 for margin in self._margins)]

    @cached_property
    def input_ranges(self):
        """
        Return the ranges of theta1 in which the linkage can be assembled [rad].

        Tuple of (low, high): one range (-pi, pi) when the crank turns fully, one through 0 or one
        through pi (high > pi), or two. At an end that is no full turn, coupler and output link are in
        line (toggle).
        """
        return _ranges(*self.lengths)

    @cached_property
    def output_ranges(self):
        """
        Return the ranges of theta4 over all poses of both modes, as :attr:`input_ranges`.

        At an end that is no full turn, crank and coupler are in line: a dead point of the output.
        """
        ranges = []
        for low, high in _ranges(self.a3, self.a2, self.a1, self.a4):     # seen from O4, of pi - theta4
            low, high = pi - high, pi - low
            turn = 2.0 * pi if low >= pi else 0.0
            ranges.append((low - turn, high - turn))
        return ((-pi, pi),) if ranges == [(0.0, 2.0 * pi)] else tuple(sorted(ranges))

    @cached_property
    def dead_points(self):
        """
        Return where theta4 turns back in this mode: its rate is zero at any speed of the crank.

        Tuple of up to two :class:`DeadPoint`, in the order of theta1. Between theirs lie the theta4 of
        a crank-rocker.
        """
        points = []
        for stretched, r in ((True, (self.a1, self.a2)), (False, (self.a1, -self.a2))):
            inner, outer = _squares_of_half(*r, self.a3, self.a4)
            # |A B| and r count negative together where B lies behind O1
            if inner * outer > 0.0:
                side = self.sign if stretched else -self.sign
                theta1 = side * 2.0 * atan2(sqrt(abs(inner)), sqrt(abs(outer)))
                side = side if sum(r) > 0.0 else -side
                theta4 = side * 2.0 * atan2(sqrt(difference_of_squares(self.a3, self.a4, *r)),
                                            sqrt(difference_of_squares(*r, self.a4, -self.a3)))
                points.append(DeadPoint(theta1, theta4, stretched))
        return tuple(sorted(points))

    @property
    def turns_fully(self):
        """Return whether the input link can make full turns."""
        return self.input_ranges == ((-pi, pi),)

    # --- how it moves ---------------------------------------------------------------------------

    @cached_property
    def _motion(self):
        return [make(*self.lengths, self.sign) for make in make_motion]

    @cached_property
    def _loads(self):
        if self.bodies is None:
            raise MissingBodies
        return [make(*self.lengths, self.bodies, self.gravity, self.external) for make in make_loads]

    def motion(self, theta1, omega1=0.0, alpha1=0.0):
        """
        Return the :class:`Motion` for given input angle, rate and acceleration.

        Parameters
        ----------
        theta1, omega1, alpha1 : float or array_like
            Input angle [rad] (any number of turns), rate [rad/s] and acceleration [rad/s^2]; arrays
            are broadcast. Three floats take the fast scalar path.

        Raises
        ------
        InvalidParameter, OutOfRange, Toggle
            For a single value that is not finite, out of range, at a toggle. In arrays such samples
            are NaN in every field that depends on it.

        """
        if not (type(theta1) is type(omega1) is type(alpha1) is float):
            if _are_numbers(theta1, omega1, alpha1):
                return self.motion(float(theta1), float(omega1), float(alpha1))
            return self._evaluate_arrays(theta1, omega1, alpha1, False)[0]
        if (theta1 + omega1 + alpha1) * 0.0 != 0.0:
            _require_finite(theta1, omega1, alpha1)
        try:
            return _new(Motion, self._motion[0](theta1, omega1, alpha1))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(theta1) from None

    def loads(self, theta1, omega1=0.0, alpha1=0.0):
        """Return the :class:`Loads`; arguments and errors as in :meth:`motion`, or MissingBodies."""
        return self.step(theta1, omega1, alpha1)[1]

    def step(self, theta1, omega1=0.0, alpha1=0.0):
        """Return (Motion, Loads) together, at the cost of one; arguments as in :meth:`motion`."""
        if not (type(theta1) is type(omega1) is type(alpha1) is float):
            if _are_numbers(theta1, omega1, alpha1):
                return self.step(float(theta1), float(omega1), float(alpha1))
            return self._evaluate_arrays(theta1, omega1, alpha1, True)
        if (theta1 + omega1 + alpha1) * 0.0 != 0.0:
            _require_finite(theta1, omega1, alpha1)
        loads = self._loads[0]
        try:
            motion = self._motion[0](theta1, omega1, alpha1)
            return _new(Motion, motion), _new(Loads, loads(motion))
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(theta1) from None

    def _why_no_motion(self, theta1):
        """Return the error for an angle at which a square root was not real or a sine zero."""
        # A limit and the angle compared with it are each rounded, and so is their distance.
        tolerance = 4.0 * EPS * abs(theta1)
        for end in (end for bounds in self.input_ranges for end in bounds):
            if abs(remainder(theta1 - end, 2.0 * pi)) <= tolerance:
                return Toggle(theta1)
        return OutOfRange(theta1, self.input_ranges)

    def _evaluate_arrays(self, theta1, omega1, alpha1, with_loads):
        kind = 2 if np.iscomplexobj(theta1) else 1
        dtype = np.complex128 if kind == 2 else np.float64
        inputs = np.broadcast_arrays(*(np.asarray(v, dtype) for v in (theta1, omega1, alpha1)))
        shape = inputs[0].shape
        flat = [v.reshape(-1) for v in inputs]
        motions = np.empty((len(Motion._fields), flat[0].size), dtype)
        loads = np.empty((len(Loads._fields), flat[0].size), dtype) if with_loads else None
        with np.errstate(invalid='ignore', divide='ignore', over='ignore', under='ignore'):
            for start in range(0, flat[0].size, CHUNK):
                part = slice(start, start + CHUNK)
                motion = self._motion[kind](*(v[part] for v in flat))
                for row, values in zip(motions, motion):
                    row[part] = values
                if with_loads:
                    for row, values in zip(loads, self._loads[kind](motion)):
                        row[part] = values
        return (Motion(*(row.reshape(shape) for row in motions)),
                Loads(*(row.reshape(shape) for row in loads)) if with_loads else None)
