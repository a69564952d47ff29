# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
From a trajectory of the output to that of the drive and back, with what the links ask for.

x is the input, y the output, r = dy/dx their ratio, r' = dr/dx, all exact from one motion at rate
1 and acceleration 0:

    (T1)  y(x) = Y by bracketed Newton steps on a branch where y rises or falls
    (T2)  x' = Y'/r,   x'' = (Y'' - r' x'^2)/r
    (T3)  T = T_links(x, x', x'') + r M

T is the torque (force) of the drive, M the torque (force) that the output gives to what it moves,
and T_links what masses, gravity and external loads of the links ask for. The static force map of
robot controllers is r M alone.
"""
from __future__ import annotations

from math import pi
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.transmission.branches import branch_of, output_of, ratio_of
import numpy as np

STEPS = 100            # of Newton and halving; six or so do
EPS = 2.0**-52


class CannotFollow(FourBarError):
    """The output cannot follow a trajectory; the message names the sample and the toggle."""


class Trajectory(NamedTuple):
    """
    Samples of one joint, arrays of one shape (n,).

    Positions [rad or m], their rates and accelerations, and the effort [N m or N]: of the drive
    on the mechanism, or of the output on what it moves.
    """

    position: Any
    rate: Any
    acceleration: Any
    effort: Any


def trajectory(position: Any, rate: Any = 0.0, acceleration: Any = 0.0,
               effort: Any = 0.0) -> Trajectory:
    """Return a :class:`Trajectory` of numbers and arrays, which are broadcast; all finite."""
    given = np.broadcast_arrays(*(np.atleast_1d(np.asarray(values, float))
                                  for values in (position, rate, acceleration, effort)))
    for name, values in zip(Trajectory._fields, given):
        if not np.isfinite(values).all():
            raise InvalidParameter(name, values[~np.isfinite(values)][0],
                                   'must be finite in every sample')
    return Trajectory(*given)


class Transmission:
    """
    A mechanism between a drive and an output.

    Parameters
    ----------
    mechanism : Mechanism
        Without masses, efforts are those of massless links.
    start : float
        An input: it chooses the branch, as one position of the output belongs to several inputs.

    """

    def __init__(self, mechanism: Any, start: float):
        self.mechanism, self.branch = mechanism, branch_of(mechanism, start)
        self._start, self._output = start, mechanism.outputs[0].coordinate
        drive = mechanism.input_coordinate
        self._drive_effort = 'driving_torque' if drive.unit == 'rad' else 'driving_force'

    def to_input(self, wanted: Trajectory) -> Trajectory:
        """
        Return the trajectory of the drive that moves the output as wanted, (T1) to (T3).

        Raises
        ------
        CannotFollow
            A position of the output lies beyond a toggle, or in it, where rates are unbounded.

        """
        targets = self._on_branch(wanted.position)
        inputs = self._solve(targets)
        ratio, slope = self._ratio(inputs)
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            rate = wanted.rate / ratio                                                    # (T2)
            acceleration = (wanted.acceleration - slope * rate * rate) / ratio
        bad = np.flatnonzero(~np.isfinite(rate + acceleration))
        if len(bad):
            raise CannotFollow(self._why_not(bad[0], wanted.position[bad[0]], targets[bad[0]],
                                             'at'))
        effort = self._links(inputs, rate, acceleration) + ratio * wanted.effort          # (T3)
        return Trajectory(inputs, rate, acceleration, effort)

    def to_output(self, driven: Trajectory) -> Trajectory:
        """
        Return the trajectory of the output of a driven one; effort from (T3).

        Raises
        ------
        CannotFollow
            The drive leaves the range of the input, or moves the output through a toggle.

        """
        self._check_inputs(driven.position)
        names = self._output
        motion = self.mechanism.motion(*driven[:3], fields=tuple(names))
        ratio = ratio_of(self.mechanism, driven.position)
        effort = (driven.effort - self._links(*driven[:3])) / ratio
        position = self._unwrapped(driven.position, motion[0])
        return Trajectory(position, motion[1], motion[2], effort)

    def static_effort(self, wanted: Trajectory) -> Any:
        """Return r M, the effort of the drive without what the links ask for."""
        ratio, _ = self._ratio(self._solve(self._on_branch(wanted.position)))
        return ratio * wanted.effort

    # --- positions ------------------------------------------------------------------------------

    def _on_branch(self, positions: Array) -> Array:
        """Return targets on the branch: angles by whole turns; CannotFollow beyond its ends."""
        outputs = self.branch.outputs
        low, high = min(outputs[0], outputs[-1]), max(outputs[0], outputs[-1])
        targets = np.array(positions, float)
        if self._output.unit == 'rad':
            targets = np.unwrap(targets)
            near = 0.5 * (low + high) if self.branch.ends else float(
                np.interp(self._start, self.branch.inputs, outputs))
            targets = targets + 2.0 * pi * np.round((near - targets[0]) / (2.0 * pi))
        if self.branch.ends:
            slack = 4.0 * EPS * max(abs(low), abs(high))
            outside = np.flatnonzero((targets < low - slack) | (targets > high + slack))
            if len(outside):
                first = outside[0]
                raise CannotFollow(self._why_not(first, positions[first], targets[first],
                                                 'beyond'))
        return targets

    def _why_not(self, sample: int, position: float, target: float, where: str) -> str:
        """Return which sample lies beyond (or at) which end of the branch."""
        coordinate = self.mechanism.input_coordinate
        if self.branch.ends is None:
            return f'sample {sample}: the rates of {coordinate.position} overflow'
        end = min(self.branch.ends, key=lambda end: abs(end.output - target))
        unit, its = self._output.unit, coordinate.unit
        return (f'sample {sample}: {self._output.position} = {position:.8g} {unit} lies {where} '
                f'the toggle {end.output:.8g} {unit}, where {end.why}, at {coordinate.position} = '
                f'{end.input:.8g} {its}')

    def _solve(self, targets: Array) -> Array:
        """Return the inputs of targets on the branch, (T1)."""
        branch, turns = self.branch, np.zeros(len(targets))
        sense = branch.sense
        if branch.ends is None:                  # whole turns of input and output together
            first = sense * branch.outputs[0]
            turns = np.floor((sense * targets - first) / (2.0 * pi))
            targets = targets - sense * 2.0 * pi * turns
        rising = sense * branch.outputs
        place = np.clip(np.searchsorted(rising, sense * targets) - 1, 0, len(rising) - 2)
        low, high = branch.inputs[place], branch.inputs[place + 1]
        x = np.interp(sense * targets, rising, branch.inputs)
        for _ in range(STEPS):
            error = sense * (self._continuous(x) - targets)
            low, high = np.where(error <= 0.0, x, low), np.where(error >= 0.0, x, high)
            with np.errstate(divide='ignore', invalid='ignore'):
                new = x - error / (sense * ratio_of(self.mechanism, x))
            good = (new >= low) & (new <= high)
            new = np.where(error == 0.0, x, np.where(good, new, 0.5 * (low + high)))
            if (np.abs(new - x) <= 2.0 * EPS * np.maximum(np.abs(x), 1e-300)).all():
                break
            x = new
        return new + 2.0 * pi * turns

    def _continuous(self, inputs: Array) -> Array:
        """Return the output at inputs of the branch, an angle by the turns of its samples."""
        outputs = output_of(self.mechanism, inputs)
        if self._output.unit != 'rad':
            return outputs
        near = np.interp(inputs, self.branch.inputs, self.branch.outputs)
        return outputs + 2.0 * pi * np.round((near - outputs) / (2.0 * pi))

    def _unwrapped(self, inputs: Array, outputs: Array) -> Array:
        """Return outputs of inputs that may be turns away, without jumps."""
        return np.unwrap(outputs) if self._output.unit == 'rad' else outputs

    def _check_inputs(self, inputs: Array) -> None:
        """Raise CannotFollow for an input outside of the branch."""
        if self.branch.ends is None:
            return
        low, high = self.branch.ends
        outside = np.flatnonzero(~((inputs >= low.input) & (inputs <= high.input)))
        if len(outside):
            value = inputs[outside[0]]
            end = min(self.branch.ends, key=lambda end: abs(end.input - value))
            name, unit = (getattr(self.mechanism.input_coordinate, what)
                          for what in ('position', 'unit'))
            raise CannotFollow(f'sample {outside[0]}: {name} = {value:.8g} {unit} lies beyond '
                               f'{end.input:.8g} {unit}, where {end.why}, at '
                               f'{self._output.position} = {end.output:.8g} {self._output.unit}')

    # --- rates and efforts ----------------------------------------------------------------------

    def _ratio(self, inputs: Array) -> tuple[Any, Any]:
        """Return r and r'."""
        return self.mechanism.motion(inputs, 1.0, 0.0, fields=(self._output.rate,
                                                               self._output.acceleration))

    def _links(self, *driven: Any) -> Any:
        """Return the effort that masses, gravity and external loads of the links ask for."""
        if self.mechanism.bodies is None:
            return np.zeros(len(driven[0]))
        return self.mechanism.step(*driven, fields=(self._drive_effort,))[0]
