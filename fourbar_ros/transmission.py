# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
From a trajectory of the output to that of the drive and back, with the loads of the links.

>>> from fourbar_ros import load_scene
>>> from fourbar_ros.transmission import trajectory, Transmission
>>> joint = Transmission(load_scene('paper').linkage, start=0.5)     # on the branch about 0.5 rad
>>> wanted = trajectory([1.0, 1.1], rate=[0.5, 0.5])                 # of the output [rad, rad/s]
>>> drive = joint.to_input(wanted)
>>> [f'{angle:.6f}' for angle in drive.position]
['0.696313', '0.971878']

x is the input, y the output, r = dy/dx their ratio, r' = dr/dx, all exact from one motion at rate
1 and acceleration 0:

    (U1)  y(x) = Y by bracketed Newton steps on a branch where y rises or falls
    (U2)  x' = Y'/r,   x'' = (Y'' - r' x'^2)/r
    (U3)  T = T_links(x, x', x'') + r M

T is the torque (force) of the drive, M the torque (force) that the output gives to what it moves,
and T_links what masses, gravity and external loads of the links ask for. The static force map of
robot controllers is r M alone. Dry friction of joints grows with M, so that (U3) does not hold:
with it efforts are refused, but for M = 0. A branch lies between two inputs at which the output
turns back (or the range of the input ends): each of its positions belongs to one input.

Positions mean what they say: an angle counts its turns, and is never taken the short way.
"""
from math import ceil, inf, tau
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.extrema.over_input import turning_points
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array, EPS
import numpy as np
from numpy.typing import ArrayLike

__all__ = ['Branch', 'CannotFollow', 'Trajectory', 'Transmission', 'trajectory']

STEPS = 100            # at most, of Newton's method and halving; about six are taken
COARSEST = 1e-6        # [rad] where floats lie farther apart than this, angles mean nothing


class CannotFollow(FourBarError):
    """The output cannot follow a trajectory; the message names the sample and the toggle."""


class Trajectory(NamedTuple):
    """Samples of one joint, arrays of one shape (n,); None for what is not asked for."""

    position: Array                 # [rad or m]
    rate: Array
    acceleration: Array | None
    effort: Array | None            # [N m or N], of the drive, or of the output on what it moves

    def __repr__(self) -> str:
        return short_repr('Trajectory', self._asdict())


def trajectory(position: ArrayLike, rate: ArrayLike = 0.0,
               acceleration: ArrayLike | None = 0.0, effort: ArrayLike | None = 0.0) -> Trajectory:
    """Return a :class:`Trajectory` of numbers and arrays, broadcast, finite; None stays None."""
    columns = {name: np.atleast_1d(np.asarray(values, float))
               for name, values in zip(Trajectory._fields, (position, rate, acceleration, effort))
               if values is not None}
    arrays = dict(zip(columns, np.broadcast_arrays(*columns.values())))
    for name, values in arrays.items():
        if not np.isfinite(values).all():
            raise InvalidParameter(name, float(values[~np.isfinite(values)][0]),
                                   'must be finite in every sample')
    return Trajectory(arrays['position'], arrays['rate'], arrays.get('acceleration'),
                      arrays.get('effort'))


class Transmission:
    """
    A mechanism between a drive and an output; without masses, efforts are of massless links.

    The input ``start`` chooses the branch, as one position of the output belongs to several
    inputs. There an angle of the output is between -pi and pi: from there its turns count.
    Errors are those of :func:`branch_of`.
    """

    def __init__(self, mechanism: Mechanism, start: float):
        self.mechanism, self.branch = mechanism, branch_of(mechanism, start)
        self._input, self._output = mechanism.input_coordinate, mechanism.outputs[0].coordinate

    def to_input(self, wanted: Trajectory) -> Trajectory:
        """Return the drive's trajectory for a wanted output, (U1) to (U3); or CannotFollow."""
        if wanted.effort is not None and wanted.effort.any():
            self._require_sum_of_efforts()
        outputs = self._within_branch(wanted.position, self._output)
        inputs = self._solve(outputs)
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            ratio, slope = self.mechanism.motion(                   # r and r', at unit rate
                inputs, 1.0, 0.0, fields=(self._output.rate, self._output.acceleration))
            # so near to a toggle that rounding of the input leaves no digit of the ratio
            at_toggle = ratio * ratio <= EPS * np.abs(slope) * np.abs(self.branch.outputs).max()
            ratio = np.where(at_toggle, 0.0, ratio)

            def over_ratio(values: Array) -> Array:     # a rest in a toggle asks for nothing
                return np.where(at_toggle & (values == 0.0), 0.0, values / ratio)
            rate = over_ratio(wanted.rate)                                                # (U2)
            acceleration = (None if wanted.acceleration is None
                            else over_ratio(wanted.acceleration - slope * rate * rate))
            effort = (None if wanted.effort is None else                                  # (U3)
                      self._effort_of_links(inputs, rate, acceleration)
                      + ratio * wanted.effort)
        return self._require_finite(Trajectory(inputs, rate, acceleration, effort), self._input,
                                    at_toggle, outputs)

    def to_output(self, driven: Trajectory) -> Trajectory:
        """Return the output's trajectory for one of the drive, effort by (U3); or CannotFollow."""
        if driven.effort is not None:
            self._require_sum_of_efforts()
        inputs = self._within_branch(driven.position, self._input)
        driven_acceleration = 0.0 if driven.acceleration is None else driven.acceleration
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            position, rate, acceleration = self.mechanism.motion(
                inputs, driven.rate, driven_acceleration, fields=self._output)
            ratio = ratio_of(self.mechanism, inputs)
            effort = (None if driven.effort is None else (
                driven.effort - self._effort_of_links(inputs, driven.rate, driven.acceleration)
            ) / ratio)
        position = self._with_turns(inputs, position)
        return self._require_finite(
            Trajectory(position, rate, None if driven.acceleration is None else acceleration,
                       effort), self._output, ratio == 0.0, position)

    # --- what cannot be followed ----------------------------------------------------------------

    def _within_branch(self, positions: Array, coordinate: Coordinate) -> Array:
        """Return positions of the input or output, in the turn of the branch, or CannotFollow."""
        is_angle = coordinate.unit == 'rad'
        spacing = np.spacing(np.abs(positions))
        if is_angle and (spacing > COARSEST).any():
            first = np.argmax(spacing > COARSEST)
            raise CannotFollow(f'sample {first}: {coordinate.position} = {positions[first]:.8g} '
                               'rad tells no angle: numbers of this size are '
                               f'{spacing[first]:.2g} rad apart')
        if self.branch.ends is None:
            return positions
        low, high = sorted(end.of(coordinate == self._output) for end in self.branch.ends)
        # drives may count an angle that swings from another turn: all are moved as the first is
        turn = self.mechanism.period if coordinate == self._input else tau
        if is_angle and not low <= positions[0] <= high:
            positions = positions + turn * np.round((0.5 * (low + high) - positions[0]) / turn)
        slack = 4.0 * EPS * np.maximum(max(abs(low), abs(high)), np.abs(positions))
        outside = np.flatnonzero((positions < low - slack) | (positions > high + slack))
        if len(outside):
            first = outside[0]
            raise CannotFollow(self._why_not(first, coordinate, positions[first], 'beyond'))
        return np.clip(positions, low, high)

    def _require_finite(self, result: Trajectory, coordinate: Coordinate, at_toggle: Array,
                        outputs: Array) -> Trajectory:
        """Return a result of an input or output, or raise CannotFollow if it is not finite."""
        is_finite = {name: np.isfinite(values) for name, values in result._asdict().items()
                     if values is not None}
        bad = np.flatnonzero(~np.all([*is_finite.values()], axis=0))
        if not len(bad):
            return result
        first = bad[0]
        if self.branch.ends and at_toggle[first]:
            raise CannotFollow(self._why_not(first, self._output, outputs[first], 'at'))
        field = next(name for name, finite in is_finite.items() if not finite[first])
        raise CannotFollow(f'sample {first}: the {field} of {coordinate.position} overflows')

    def _why_not(self, sample: int, coordinate: Coordinate, position: float, where: str) -> str:
        """Return in words that a sample lies ``where``, beyond or at, the nearest end it meets."""
        assert self.branch.ends
        of_output = coordinate == self._output
        second = self._input if of_output else self._output
        end = min(self.branch.ends, key=lambda end: abs(end.of(of_output) - position))
        toggle = 'the toggle ' if of_output else ''
        return (f'sample {sample}: {coordinate.position} = {position:.8g} {coordinate.unit} lies '
                f'{where} {toggle}{end.of(of_output):.8g} {coordinate.unit}, where {end.why}, at '
                f'{second.position} = {end.of(not of_output):.8g} {second.unit}')

    # --- positions ------------------------------------------------------------------------------

    def _solve(self, targets: Array) -> Array:
        # (U1) by Newton's method from samples of the branch, all targets at once, halving where
        # a step leaves the bracket, until no input moves by more than two of its last bits; a
        # toggle, where roots are double, is met exactly.
        branch, periods = self.branch, np.zeros(len(targets))
        sense = branch.sense
        if branch.ends is None:                  # solve in the one period that has samples
            first = sense * branch.outputs[0]
            periods = np.floor((sense * targets - first) / branch.advance)
            targets = targets - sense * branch.advance * periods
        rising = sense * branch.outputs
        # the samples before and after a target bracket its input
        before = np.clip(np.searchsorted(rising, sense * targets) - 1, 0, len(rising) - 2)
        low, high = branch.inputs[before], branch.inputs[before + 1]
        x = np.interp(sense * targets, rising, branch.inputs)
        for _ in range(STEPS):
            error = sense * (self._with_turns(x, output_of(self.mechanism, x)) - targets)
            low, high = np.where(error <= 0.0, x, low), np.where(error >= 0.0, x, high)
            with np.errstate(divide='ignore', invalid='ignore'):
                new = x - error / (sense * ratio_of(self.mechanism, x))
            in_bracket = (new >= low) & (new <= high)
            new = np.where(error == 0.0, x, np.where(in_bracket, new, 0.5 * (low + high)))
            if (np.abs(new - x) <= 2.0 * EPS * np.maximum(np.abs(x), 1e-300)).all():
                break
            x = new
        inputs: Array = new if branch.ends else new + self.mechanism.period * periods
        return inputs

    def _with_turns(self, inputs: Array, outputs: Array) -> Array:
        """Return outputs in [-pi, pi] with the whole turns that the branch has at the inputs."""
        if self._output.unit != 'rad':
            return outputs
        branch = self.branch
        near: Array = np.zeros(len(inputs))
        if branch.ends is None:
            period = self.mechanism.period
            periods: Array = np.floor((inputs - branch.inputs[0]) / period)
            inputs, near = inputs - period * periods, branch.sense * branch.advance * periods
        near = near + np.interp(inputs, branch.inputs, branch.outputs)
        return outputs + tau * np.round((near - outputs) / tau)

    # --- rates and efforts ----------------------------------------------------------------------

    def _require_sum_of_efforts(self) -> None:
        """Refuse efforts that are no sum of those of links and output: InvalidParameter."""
        from fourbar_ros.mechanisms.friction import dry_joints  # few mechanisms have any
        if dry := dry_joints(self.mechanism):
            raise InvalidParameter('effort', None, 'must be left out, in a scene of '
                                   f'trajectory_fields: dry friction at {", ".join(dry)} grows '
                                   'with what the output bears')

    def _effort_of_links(self, position: Array, rate: Array,
                         acceleration: Array | None) -> Array:
        """Return the drive's effort for masses, gravity and external loads of the links alone."""
        if self.mechanism.bodies is None:
            return np.zeros(len(position))
        if acceleration is None:
            raise InvalidParameter('acceleration', None, 'must be given for an effort: the links '
                                   'have masses')
        effort: Array = self.mechanism.step(position, rate, acceleration,
                                            fields=(self.mechanism.drive_load,))[0]
        return effort


SAMPLES = 4097         # over a range of the input, to see where the output turns back


class BranchEnd(NamedTuple):
    """An end of a branch: the input there, the output, and why it ends."""

    input: float
    output: float
    why: str        # 'the output turns back' (a toggle of it), or 'the range of the input ends'

    def of(self, is_output: bool) -> float:
        """Return the position of the output, or else of the input, at this end."""
        return self.output if is_output else self.input


class Branch(NamedTuple):
    """A branch, as samples from which roots start."""

    inputs: Array       # rising [rad or m]
    outputs: Array      # the continuous output at each
    ends: tuple[BranchEnd, BranchEnd] | None    # None: input and output turn on and on

    @property
    def sense(self) -> float:
        """Return 1 if the output rises with the input, else -1."""
        return 1.0 if self.outputs[-1] > self.outputs[0] else -1.0

    @property
    def advance(self) -> float:
        """Return by how much an output that turns on moves in a period of the input [rad]."""
        return tau * round(abs(float(self.outputs[-1] - self.outputs[0])) / tau)


def ratio_of(mechanism: Mechanism, inputs: ArrayLike) -> Any:
    """Return d output / d input at inputs, for the first output of a mechanism."""
    coordinate = mechanism.outputs[0].coordinate
    return mechanism.motion(inputs, 1.0, 0.0, fields=(coordinate.rate,))[0]


def output_of(mechanism: Mechanism, inputs: ArrayLike) -> Any:
    """Return the position of the output at inputs, angles in [-pi, pi]."""
    return mechanism.motion(inputs, fields=(mechanism.outputs[0].coordinate.position,))[0]


def branch_of(mechanism: Mechanism, start: float) -> Branch:
    """
    Return the branch that contains ``start`` [rad or m]: up to where the output turns back.

    Raises OutOfRange where the mechanism does not close at ``start``, InvalidParameter where the
    output turns back just there or stands still.
    """
    coordinate = mechanism.input_coordinate
    start = finite('start', start)
    low, high = mechanism.range_around(start)
    inputs = np.linspace(low, high, SAMPLES)
    ends = _turning_points(mechanism, low, high)
    if mechanism.turns_fully and not mechanism.stroke:
        if not ends:
            branch = Branch(inputs, _continuous(mechanism, inputs, start), None)
            if branch.advance == 0.0:       # a kite whose crank turns about the pin at B
                raise InvalidParameter(coordinate.position, start, 'the output stands still')
            return branch
        # no end of the range ends the branch: the next turning point may lie a period away
        period = mechanism.period
        ends = [x + turn for x in ends for turn in (-period, 0.0, period)]
        low, high = -inf, inf
    if start in ends:
        raise InvalidParameter(coordinate.position, start,
                               'the output turns back there: start on one side of it')
    low = max([low, *(x for x in ends if x < start)])
    high = min([high, *(x for x in ends if x > start)])
    inputs = np.linspace(low, high, SAMPLES)
    outputs = _continuous(mechanism, inputs, start)     # NaN where rounding leaves the range
    closes = ~np.isnan(outputs)
    inputs, outputs = inputs[closes], outputs[closes]
    first, last = (BranchEnd(float(inputs[i]), float(outputs[i]),
                             'the output turns back' if inputs[i] in ends
                             else 'the range of the input ends') for i in (0, -1))
    return Branch(inputs, outputs, (first, last))


def _turning_points(mechanism: Mechanism, low: float, high: float) -> list[float]:
    """Return the inputs in a range where the output turns back: the extrema of its position."""
    turn = mechanism.period if mechanism.input_coordinate.unit == 'rad' else 0.0
    inputs = [point.input + turn * ceil((low - point.input) / turn) if turn else point.input
              for point in turning_points(mechanism)]
    return sorted(x for x in inputs if low < x < high)


def _continuous(mechanism: Mechanism, inputs: Array, start: float) -> Array:
    """Return the output along rising inputs: an angle has no jumps, and at start |angle| <= pi."""
    outputs = np.array(output_of(mechanism, inputs))
    if mechanism.outputs[0].coordinate.unit == 'rad':
        closes = ~np.isnan(outputs)
        outputs[closes] = np.unwrap(outputs[closes])
        outputs -= tau * np.round(np.interp(start, inputs[closes], outputs[closes]) / tau)
    return outputs
