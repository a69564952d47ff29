# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
From a trajectory of the output to that of the drive and back, with what the links ask for.

>>> from fourbar_ros import load_scene
>>> from fourbar_ros.transmission import trajectory, Transmission
>>> joint = Transmission(load_scene('paper').linkage, start=0.5)     # on the branch about 0.5 rad
>>> wanted = trajectory([1.0, 1.1], rate=[0.5, 0.5])                 # of the output [rad, rad/s]
>>> drive = joint.to_input(wanted)
>>> [f'{angle:.6f}' for angle in drive.position]
['0.696313', '0.971878']

x is the input, y the output, r = dy/dx their ratio, r' = dr/dx, all exact from one motion at rate
1 and acceleration 0:

    (T1)  y(x) = Y by bracketed Newton steps on a branch where y rises or falls
    (T2)  x' = Y'/r,   x'' = (Y'' - r' x'^2)/r
    (T3)  T = T_links(x, x', x'') + r M

T is the torque (force) of the drive, M the torque (force) that the output gives to what it moves,
and T_links what masses, gravity and external loads of the links ask for. The static force map of
robot controllers is r M alone. A branch lies between two places at which the output turns back (or
the range of the input ends): each of its positions belongs to one input.

Positions mean what they say: an angle counts its turns, and is never taken the short way. Wrapped
angles are for :mod:`fourbar_ros.ros.node.trajectories`.
"""
from __future__ import annotations

from math import inf, pi, tau
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter, OutOfRange
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.numerics.arrays import Array, EPS
import numpy as np
from numpy.typing import ArrayLike

__all__ = ['Branch', 'CannotFollow', 'Trajectory', 'Transmission', 'trajectory']

STEPS = 100            # of Newton and halving; six or so do
FINEST = 1e-6          # [rad] an angle whose neighbouring float is farther off tells no pose


class CannotFollow(FourBarError):
    """The output cannot follow a trajectory; the message names the sample and the toggle."""


class Trajectory(NamedTuple):
    """
    Samples of one joint, arrays of one shape (n,).

    Positions [rad or m], their rates and accelerations, and the effort [N m or N]: of the drive
    on the mechanism, or of the output on what it moves. None for accelerations and efforts that
    are not asked for.
    """

    position: Array
    rate: Array
    acceleration: Array | None
    effort: Array | None


def trajectory(position: ArrayLike, rate: ArrayLike = 0.0,
               acceleration: ArrayLike | None = 0.0, effort: ArrayLike | None = 0.0) -> Trajectory:
    """
    Return a :class:`Trajectory` of numbers and arrays, which are broadcast; all finite.

    Where acceleration or effort is None, what answers it has none.
    """
    given = {name: np.atleast_1d(np.asarray(values, float))
             for name, values in zip(Trajectory._fields, (position, rate, acceleration, effort))
             if values is not None}
    arrays = dict(zip(given, np.broadcast_arrays(*given.values())))
    for name, values in arrays.items():
        if not np.isfinite(values).all():
            raise InvalidParameter(name, float(values[~np.isfinite(values)][0]),
                                   'must be finite in every sample')
    return Trajectory(arrays['position'], arrays['rate'], arrays.get('acceleration'),
                      arrays.get('effort'))


class Transmission:
    """
    A mechanism between a drive and an output.

    Parameters
    ----------
    mechanism : Mechanism
        Without masses, efforts are those of massless links.
    start : float
        An input: it chooses the branch, as one position of the output belongs to several inputs.
        There an angle of the output is between -pi and pi: from there its turns count.

    """

    def __init__(self, mechanism: Mechanism, start: float):
        self.mechanism, self.branch = mechanism, branch_of(mechanism, start)
        self._input, self._output = mechanism.input_coordinate, mechanism.outputs[0].coordinate
        self._drive_effort = 'driving_torque' if self._input.unit == 'rad' else 'driving_force'

    def to_input(self, wanted: Trajectory) -> Trajectory:
        """
        Return the trajectory of the drive that moves the output as wanted, (T1) to (T3).

        Raises
        ------
        CannotFollow
            A position of the output lies beyond a toggle, or in it, where rates are unbounded; or
            a number overflows.

        """
        targets = self._within(wanted.position, self._output)
        inputs = self._solve(targets)
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            ratio, slope = self._ratio(inputs)
            # nearer to a toggle the input, and with it the ratio, has no digit
            is_flat = ratio * ratio <= EPS * np.abs(slope) * np.abs(self.branch.outputs).max()
            ratio = np.where(is_flat, 0.0, ratio)

            def over_ratio(values: Array) -> Array:
                return np.where(is_flat & (values == 0.0), 0.0, values / ratio)
            rate = over_ratio(wanted.rate)                                                # (T2)
            acceleration = (None if wanted.acceleration is None
                            else over_ratio(wanted.acceleration - slope * rate * rate))
            effort = (None if wanted.effort is None                                       # (T3)
                      else self._links(inputs, rate, acceleration) + ratio * wanted.effort)
        return self._checked(Trajectory(inputs, rate, acceleration, effort), self._input, wanted,
                             is_flat, targets)

    def to_output(self, driven: Trajectory) -> Trajectory:
        """
        Return the trajectory of the output of a driven one; effort from (T3).

        Raises
        ------
        CannotFollow
            The drive leaves the range of the input; an effort is asked for in a toggle; or a
            number overflows.

        """
        inputs = self._within(driven.position, self._input)
        names = self._output[:2 if driven.acceleration is None else 3]
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            position, rate, *more = self.mechanism.motion(
                inputs, driven.rate, 0.0 if driven.acceleration is None else driven.acceleration,
                fields=tuple(names))
            ratio = ratio_of(self.mechanism, inputs)
            effort = (None if driven.effort is None else
                      (driven.effort - self._links(inputs, *driven[1:3])) / ratio)
        position = self._counted(inputs, position)
        return self._checked(Trajectory(position, rate, more[0] if more else None, effort),
                             self._output, driven, ratio == 0.0, position)

    def static_effort(self, wanted: Trajectory) -> Array:
        """Return r M, the effort of the drive without what the links ask for."""
        return self._ratio(self._solve(self._within(wanted.position, self._output)))[0] * (
            wanted.effort)

    # --- what cannot be followed ----------------------------------------------------------------

    def _within(self, positions: Array, coordinate: Coordinate) -> Array:
        """
        Return positions of the input or the output on the branch.

        An angle that swings may count from another turn: all are moved by the turns of the first.
        CannotFollow beyond an end, or for numbers that tell no angle.
        """
        is_angle = coordinate.unit == 'rad'
        if is_angle:
            self._check_angles(positions, coordinate)
        if self.branch.ends is None:
            return positions
        low, high = sorted(end.at(coordinate == self._output) for end in self.branch.ends)
        if is_angle and not low <= positions[0] <= high:
            positions = positions + tau * np.round((0.5 * (low + high) - positions[0]) / tau)
        slack = 4.0 * EPS * np.maximum(max(abs(low), abs(high)), np.abs(positions))
        outside = np.flatnonzero((positions < low - slack) | (positions > high + slack))
        if len(outside):
            first = outside[0]
            raise CannotFollow(self._why_not(first, coordinate, positions[first], 'beyond'))
        return np.clip(positions, low, high)

    @staticmethod
    def _check_angles(positions: Array, coordinate: Coordinate) -> None:
        apart = np.spacing(np.abs(positions))
        coarse = np.flatnonzero(apart > FINEST)
        if len(coarse):
            first = coarse[0]
            raise CannotFollow(f'sample {first}: {coordinate.position} = {positions[first]:.8g} '
                               f'rad tells no angle: numbers of this size are {apart[first]:.2g} '
                               'rad apart')

    def _checked(self, found: Trajectory, coordinate: Coordinate, given: Trajectory,
                 is_flat: Array, places: Array) -> Trajectory:
        """Return what was found, all finite; CannotFollow at a toggle, and for an overflow."""
        numbers = {name: values for name, values in zip(found._fields, found)
                   if values is not None}
        bad = np.flatnonzero(~np.isfinite([*numbers.values()]).all(axis=0))
        if not len(bad):
            return found
        first = bad[0]
        if self.branch.ends and is_flat[first]:
            raise CannotFollow(self._why_not(first, self._output, places[first], 'at'))
        what = next(name for name, values in numbers.items() if not np.isfinite(values[first]))
        its = ', '.join(f'{name} {values[first]:.8g}'
                        for name, values in zip(given._fields, given) if values is not None)
        raise CannotFollow(f'sample {first}: the {what} of {coordinate.position} overflows, for '
                           f'{its}')

    def _why_not(self, sample: int, coordinate: Coordinate, place: float, where: str) -> str:
        """Return which sample lies beyond (or at) which end of the branch."""
        assert self.branch.ends
        its = coordinate == self._output
        other = self._input if its else self._output
        end = min(self.branch.ends, key=lambda end: abs(end.at(its) - place))
        toggle = 'the toggle ' if its else ''
        return (f'sample {sample}: {coordinate.position} = {place:.8g} {coordinate.unit} lies '
                f'{where} {toggle}{end.at(its):.8g} {coordinate.unit}, where {end.why}, at '
                f'{other.position} = {end.at(not its):.8g} {other.unit}')

    # --- positions ------------------------------------------------------------------------------

    def _solve(self, targets: Array) -> Array:
        """Return the inputs of targets on the branch, (T1)."""
        branch, turns = self.branch, np.zeros(len(targets))
        sense = branch.sense
        if branch.ends is None:                  # whole turns of input and output together
            first = sense * branch.outputs[0]
            turns = np.floor((sense * targets - first) / tau)
            targets = targets - sense * tau * turns
        rising = sense * branch.outputs
        place = np.clip(np.searchsorted(rising, sense * targets) - 1, 0, len(rising) - 2)
        low, high = branch.inputs[place], branch.inputs[place + 1]
        x = np.interp(sense * targets, rising, branch.inputs)
        for _ in range(STEPS):
            error = sense * (self._counted(x, output_of(self.mechanism, x)) - targets)
            low, high = np.where(error <= 0.0, x, low), np.where(error >= 0.0, x, high)
            with np.errstate(divide='ignore', invalid='ignore'):
                new = x - error / (sense * ratio_of(self.mechanism, x))
            good = (new >= low) & (new <= high)
            new = np.where(error == 0.0, x, np.where(good, new, 0.5 * (low + high)))
            if (np.abs(new - x) <= 2.0 * EPS * np.maximum(np.abs(x), 1e-300)).all():
                break
            x = new
        found: Array = new + tau * turns
        return found

    def _counted(self, inputs: Array, outputs: Array) -> Array:
        """Return outputs at inputs, angles by the turns that the branch has there."""
        if self._output.unit != 'rad':
            return outputs
        branch, turns = self.branch, np.zeros(len(inputs))
        if branch.ends is None:
            turns = np.floor((inputs - branch.inputs[0]) / tau)
        near = np.interp(inputs - tau * turns, branch.inputs, branch.outputs)
        near = near + branch.sense * tau * turns
        return outputs + tau * np.round((near - outputs) / tau)

    # --- rates and efforts ----------------------------------------------------------------------

    def _ratio(self, inputs: Array) -> tuple[Array, Array]:
        """Return r and r'."""
        return self.mechanism.motion(inputs, 1.0, 0.0, fields=(self._output.rate,
                                                               self._output.acceleration))

    def _links(self, position: Array, rate: Array, acceleration: Array | None) -> Array:
        """Return the effort that masses, gravity and external loads of the links ask for."""
        if self.mechanism.bodies is None:
            return np.zeros(len(position))
        if acceleration is None:
            raise InvalidParameter('acceleration', None, 'must be given for an effort: the links '
                                   'have masses')
        effort: Array = self.mechanism.step(position, rate, acceleration,
                                            fields=(self._drive_effort,))[0]
        return effort


SAMPLES = 4097         # over a range of the input, to see where the output turns back
HALVINGS = 64          # of an interval, down to neighbouring floats


class End(NamedTuple):
    """
    An end of a branch: the input there, the output, and why it ends.

    ``why``: 'the output turns back' (a toggle of the mechanism driven by its output), or 'the
    range of the input ends'.
    """

    input: float
    output: float
    why: str

    def at(self, is_output: bool) -> float:
        """Return the position of the output, or of the input, there."""
        return self.output if is_output else self.input


class Branch(NamedTuple):
    """
    A branch, as samples from which roots start.

    Parameters
    ----------
    inputs, outputs : numpy.ndarray
        Rising inputs, and the continuous output at each [rad or m].
    ends : tuple of 2 End, optional
        None: the input turns on and on, and the output with it.

    """

    inputs: Array
    outputs: Array
    ends: tuple[End, End] | None

    @property
    def sense(self) -> float:
        """Return 1 if the output rises with the input, else -1."""
        return 1.0 if self.outputs[-1] > self.outputs[0] else -1.0


def ratio_of(mechanism: Mechanism, inputs: ArrayLike) -> Any:
    """Return d output / d input at inputs."""
    coordinate = mechanism.outputs[0].coordinate
    return mechanism.motion(inputs, 1.0, 0.0, fields=(coordinate.rate,))[0]


def output_of(mechanism: Mechanism, inputs: ArrayLike) -> Any:
    """Return the position of the output at inputs, angles in [-pi, pi]."""
    return mechanism.motion(inputs, fields=(mechanism.outputs[0].coordinate.position,))[0]


def branch_of(mechanism: Mechanism, start: float) -> Branch:
    """
    Return the :class:`Branch` with an input in it.

    Raises
    ------
    OutOfRange
        The mechanism does not close at ``start``.
    InvalidParameter
        The output turns back just there.

    """
    coordinate = mechanism.input_coordinate
    around = _range(mechanism, start)
    if around is None:
        raise OutOfRange(coordinate.position, start, mechanism.input_ranges, coordinate.unit)
    low, high = around
    # From the start on, so that a full turn has no seam in the branch.
    inputs = np.linspace(low, high, SAMPLES)
    ratios = ratio_of(mechanism, inputs)
    turning = [_turn(mechanism, *pair) for pair in _changes(inputs, ratios)]
    if mechanism.turns_fully and not turning:
        return Branch(inputs, _continuous(mechanism, inputs, start), None)
    if mechanism.turns_fully:
        turning = sorted(turn + k * 2.0 * pi for turn in turning for k in (-1, 0, 1))
    below = max((turn for turn in turning if turn < start), default=-inf)
    above = min((turn for turn in turning if turn > start), default=inf)
    if start in turning:
        raise InvalidParameter(coordinate.position, start,
                               'the output turns back there: start on one side of it')
    inside = np.linspace(max(below, low if not mechanism.turns_fully else -inf),
                         min(above, high if not mechanism.turns_fully else inf), SAMPLES)
    outputs = _continuous(mechanism, inside, start)
    good = ~np.isnan(outputs)
    inside, outputs = inside[good], outputs[good]
    ends = [End(float(at), float(out), 'the output turns back' if at in turning else
                'the range of the input ends')
            for at, out in ((inside[0], outputs[0]), (inside[-1], outputs[-1]))]
    return Branch(inside, outputs, (ends[0], ends[1]))


def _range(mechanism: Mechanism, start: float) -> tuple[float, float] | None:
    """Return the range of the input around a start; a whole turn has the start in its middle."""
    if mechanism.turns_fully:
        return start - pi, start + pi
    for low, high in mechanism.input_ranges:
        for turn in (0.0,) if mechanism.is_driven_by_slide else (0.0, 2.0 * pi, -2.0 * pi):
            if low + turn <= start <= high + turn:
                return low + turn, high + turn
    return None


def _changes(inputs: Array, ratios: Array) -> list[tuple[float, float]]:
    """Return the intervals in which the ratio changes its sign, where it exists."""
    known = np.flatnonzero(~np.isnan(ratios) & np.isfinite(ratios))
    one, other = known[:-1], known[1:]
    found = np.flatnonzero((ratios[one] < 0.0) != (ratios[other] < 0.0))
    return [(float(inputs[one[i]]), float(inputs[other[i]])) for i in found]


def _turn(mechanism: Mechanism, low: float, high: float) -> float:
    """Return where the ratio is zero between two inputs, by halving."""
    is_negative = ratio_of(mechanism, low) < 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if (ratio_of(mechanism, middle) < 0.0) == is_negative:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _continuous(mechanism: Mechanism, inputs: Array, start: float) -> Array:
    """Return the output along rising inputs, an angle without jumps, in [-pi, pi] at a start."""
    outputs = np.array(output_of(mechanism, inputs))
    if mechanism.outputs[0].coordinate.unit == 'rad':
        good = ~np.isnan(outputs)
        outputs[good] = np.unwrap(outputs[good])
        near = np.interp(start, inputs[good], outputs[good])
        outputs -= 2.0 * pi * np.round(near / (2.0 * pi))
    return outputs
