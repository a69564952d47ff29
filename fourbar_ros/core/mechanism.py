"""
What the mechanisms of one crank and one dyad have in common: evaluation and its errors.

A mechanism says how one sample is computed (functions made by :func:`.dialects.dialects`); here it is
called for floats and arrays, with the same rules for all.
"""
from __future__ import annotations

from math import isfinite, pi, remainder
from numbers import Real

import numpy as np

from .errors import InvalidParameter, MissingBodies, OutOfRange, Toggle
from .linkage import CROSSED, OPEN

EPS = 2.0**-52
CHUNK = 8192             # samples a numpy evaluation takes at once: its temporaries stay in the cache
_new = tuple.__new__     # of a NamedTuple from a tuple: four times faster than its own constructor
_UNITS = {'theta1': 'rad', 'slide': 'm'}


class InputOutOfRange(OutOfRange):
    """The mechanism cannot be assembled at this input; ``name``, ``value`` and ``ranges`` are kept."""

    def __init__(self, name, value, ranges):
        super().__init__(value, ranges)
        self.name, self.value = name, value
        if name != 'theta1':
            self.args = (str(self).replace('theta1', name).replace(' rad', f' {_UNITS[name]}'),)


class InputToggle(Toggle):
    """The input is where the dyad is locked: rates and loads are unbounded; ``name`` and ``value`` are kept."""

    def __init__(self, name, value):
        super().__init__(value)
        self.name, self.value = name, value
        if name != 'theta1':
            self.args = (str(self).replace('theta1', name).replace(' rad', f' {_UNITS[name]}'),)


class Mechanism:
    """
    Base of a frozen dataclass with ``mode``, ``input``, ``bodies``, ``gravity``.

    A subclass has ``INPUTS`` (for each kind of input the names of its value, rate and acceleration),
    ``MOTION`` and ``LOADS`` (types of the results), ``input_ranges``, and ``_motion`` and ``_loads``,
    the :class:`~.dialects.Dialects` of its two functions as sequences.
    """

    def _check(self, lengths, signed=()):
        """Refuse what no mechanism can have: lengths by name positive, signed ones finite."""
        for name in lengths:
            if not (isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise InvalidParameter(name, getattr(self, name), 'a length must be a positive number')
        for name in signed:
            if not isfinite(getattr(self, name)):
                raise InvalidParameter(name, getattr(self, name), 'must be a finite number')
        if self.mode not in (CROSSED, OPEN):
            raise InvalidParameter('mode', self.mode, 'must be 1 or 2')
        if self.input not in self.INPUTS:
            raise InvalidParameter('input', self.input, f'must be one of {", ".join(self.INPUTS)}')
        if not (len(self.gravity) == 2 and all(map(isfinite, self.gravity))):
            raise InvalidParameter('gravity', self.gravity, 'must be two finite numbers')

    @property
    def sign(self):
        """Return the assembly mode as +1 (mode 2) or -1 (mode 1)."""
        return 1.0 if self.mode == OPEN else -1.0

    @property
    def turns_fully(self):
        """Return whether the input is a crank that makes full turns."""
        return self.input_ranges == ((-pi, pi),)

    def motion(self, position, rate=0.0, acceleration=0.0):
        """
        Return the motion for given input, its rate and acceleration.

        Parameters
        ----------
        position, rate, acceleration : float or array_like
            Crank angle [rad], [rad/s], [rad/s^2], or slide [m], [m/s], [m/s^2], as ``input`` says;
            arrays are broadcast. Three floats take the fast scalar path.

        Raises
        ------
        InvalidParameter, OutOfRange, Toggle
            For a single value that is not finite, out of range, at a toggle. In arrays such samples
            are NaN in every field that depends on it.

        """
        return self._evaluate(position, rate, acceleration, False)[0]

    def loads(self, position, rate=0.0, acceleration=0.0):
        """Return the loads; arguments and errors as in :meth:`motion`, or MissingBodies."""
        return self.step(position, rate, acceleration)[1]

    def step(self, position, rate=0.0, acceleration=0.0):
        """Return (motion, loads) together, at the cost of one; arguments as in :meth:`motion`."""
        if self.bodies is None:
            raise MissingBodies
        return self._evaluate(position, rate, acceleration, True)

    def _evaluate(self, position, rate, acceleration, with_loads):
        if not (type(position) is type(rate) is type(acceleration) is float):
            if not all(isinstance(value, Real) for value in (position, rate, acceleration)):
                return self._evaluate_arrays(position, rate, acceleration, with_loads)
            position, rate, acceleration = float(position), float(rate), float(acceleration)
        if (position + rate + acceleration) * 0.0 != 0.0:
            for name, value in zip(self.INPUTS[self.input], (position, rate, acceleration)):
                if not isfinite(value):
                    raise InvalidParameter(name, value, 'must be a finite number')
        try:
            motion = self._motion[0](position, rate, acceleration)
            return _new(self.MOTION, motion), _new(self.LOADS, self._loads[0](motion)) if with_loads else None
        except (ValueError, ZeroDivisionError):
            raise self._why_no_motion(position) from None

    def _why_no_motion(self, position):
        """Return the error for an input at which a square root was not real or a sine zero."""
        name = self.INPUTS[self.input][0]
        # A limit and the input compared with it are each rounded, and so is their distance.
        tolerance = 4.0 * EPS * abs(position)
        for end in (end for bounds in self.input_ranges for end in bounds):
            distance = position - end if name == 'slide' else remainder(position - end, 2.0 * pi)
            if abs(distance) <= tolerance:
                return InputToggle(name, position)
        return InputOutOfRange(name, position, self.input_ranges)

    def _evaluate_arrays(self, position, rate, acceleration, with_loads):
        kind = 2 if np.iscomplexobj(position) else 1
        dtype = np.complex128 if kind == 2 else np.float64
        inputs = np.broadcast_arrays(*(np.asarray(v, dtype) for v in (position, rate, acceleration)))
        shape = inputs[0].shape
        flat = [v.reshape(-1) for v in inputs]
        motions = np.empty((len(self.MOTION._fields), flat[0].size), dtype)
        loads = np.empty((len(self.LOADS._fields), flat[0].size), dtype) if with_loads else None
        with np.errstate(invalid='ignore', divide='ignore', over='ignore', under='ignore'):
            for start in range(0, flat[0].size, CHUNK):
                part = slice(start, start + CHUNK)
                motion = self._motion[kind](*(v[part] for v in flat))
                for row, values in zip(motions, motion):
                    row[part] = values
                if with_loads:
                    for row, values in zip(loads, self._loads[kind](motion)):
                        row[part] = values
        return (self.MOTION(*(row.reshape(shape) for row in motions)),
                self.LOADS(*(row.reshape(shape) for row in loads)) if with_loads else None)
