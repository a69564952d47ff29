# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene whose motion follows from torque, run without ROS: samples, extrema at them."""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import isnan, nan, tau
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.dynamics.sources import ConstantTorque
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.quantities import known_quantities
from fourbar_ros.numerics import arguments, arrays
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.settings import SOURCES
from fourbar_ros.scene.topics import TORQUE
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.dynamics.node_step import DriveValues
    from fourbar_ros.dynamics.run import Run


MOST = 10_000_000       # samples of a run, some GB


class Peak(NamedTuple):
    """Smallest and largest value of a quantity over a run, and when they are reached [s]."""

    name: str
    unit: str
    low: float
    low_at: float
    high: float
    high_at: float


class SimulatedScene(NamedTuple):
    """A scene and its Run at the samples of the node."""

    scene: Scene
    run: Run
    torque: float       # constant torque in place of the topic; NaN: none is given

    def drive_values(self) -> Iterator[DriveValues]:
        """Yield the DriveValues of each sample, as a node publishes them; evaluations are NaN."""
        # A node counts evaluations of its own steps, of which a simulated run has none.
        from fourbar_ros.dynamics.rosenbrock import StateVector
        modes, command = self.run.modes.tolist(), 0.0 if isnan(self.torque) else self.torque
        movers, before = {mode: self.scene.mover_in(mode) for mode in set(modes)}, nan
        for time, mode, state in zip(self.run.time.tolist(), modes, self.states.T.tolist()):
            step = 0.0 if isnan(before) else time - before
            mover = movers[mode]
            values = mover.values(mover.state_at(StateVector(*state)), step, command, 0)
            yield values._replace(evaluations=nan)
            before = time

    @property
    def states(self) -> arrays.Array:
        """
        Return the states of the samples as the node's Mover has them, shape (5, n).

        Input and its rate, twist of an elastic shaft and speed of the motor before it, state of
        the motor itself; 0 for parts that the drive does not have.
        """
        known, drive = self.run.states, self.run.system.drive
        states = np.zeros((5, self.run.time.size))
        states[:2] = known.position, known.rate
        if drive and drive.shaft:
            states[2:4] = known.motor_position - known.position, known.motor_rate
        if known.source:
            states[4] = known.source[0]
        return states

    def peaks(self) -> list[Peak]:
        """Return the extrema of speed, drive and, where they are known, loads at the samples."""
        run, mechanism = self.run, self.scene.linkage
        per_second = f'{mechanism.input_coordinate.unit}/s'
        force = 'N' if mechanism.is_driven_by_slide else 'N m'
        quantities = known_quantities(mechanism, mechanism.input)
        rows: list[tuple[str, str, arrays.Array]] = [
            ('speed of the input', per_second, run.rate),
            ('acceleration of the input', f'{per_second}^2', run.acceleration),
            ('torque on the input', force, run.torque),
            ('torque of the motor', force, run.motor_torque),
            *((name, quantities[name].unit, values)
              for name, values in run.loads._asdict().items() if name in quantities)]
        peaks = []
        for name, unit, values in rows:
            if not np.isnan(values).all():
                low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
                peaks.append(Peak(name, unit, float(values[low]), float(run.time[low]),
                                  float(values[high]), float(run.time[high])))
        return peaks

    def speeds_of_last_turn(self) -> tuple[float, float] | None:
        """Return (lowest, highest) of a crank [rad/s]; None if it made no turn or stopped."""
        run = self.run
        before_last_turn = np.flatnonzero(np.abs(run.position - run.position[-1]) >= tau)
        if self.scene.linkage.is_driven_by_slide or not before_last_turn.size:
            return None
        rates = run.rate[before_last_turn[-1]:]
        low, high = float(rates.min()), float(rates.max())
        return (low, high) if low * high > 0.0 else None


def simulate_scene(scene: Scene, until: float, tolerance: float = 1e-8, method: str = 'auto',
                   torque: float = nan, **limits: Any) -> SimulatedScene:
    """
    Run a scene with ``drive.source`` torque or motor from its start, sampled as by its node.

    ``until``: time at the end [s]; ``torque``: constant torque [N m] (force [N]) of a drive by
    topic, NaN for none; ``tolerance``, ``method`` and ``limits`` (``evaluations``, ``seconds``,
    ``progress``) as of :func:`fourbar_ros.dynamics.simulation.simulate`. Raises
    InvalidParameter, MissingPackage.
    """
    from fourbar_ros.dynamics.simulation import simulate
    if scene.dynamics is None:
        raise InvalidParameter('drive.source', scene.drive.source, 'the motion is given, there is '
                               f'nothing to simulate: must be {" or ".join(SOURCES)}')
    dynamics, source = scene.dynamics, scene.drive.source
    if not isnan(torque):
        if source != TORQUE.name:
            raise InvalidParameter('torque', torque, f'goes with drive.source: {TORQUE.name}; '
                                   f'this scene has {source}')
        dynamics = dynamics._replace(drive=replace(dynamics.drive, source=ConstantTorque(torque)))
    if scene.acting:
        name = scene.acting[0]
        raise InvalidParameter('base.topic' if name == 'base' else f'external.{name}.from_topic',
                               True, 'what acts by topic is known to the node alone')
    until = arguments.finite('until', until, 'must be a positive number', above=0.0)
    # of whole samples: 0.29 s * 100 Hz = 28.99... is 29, and the last may be rounded beyond until
    count = int(until * scene.drive.rate * (1.0 + 1e-12))
    if not 1 <= count <= MOST:
        raise InvalidParameter('until', until, 'is ' + (
            'less than one sample' if count < 1 else f'more than {MOST} samples')
            + f': drive.rate is {scene.drive.rate:g} Hz')
    times = np.arange(count + 1) / scene.drive.rate
    times[-1] = min(times[-1], until)
    run = simulate(dynamics.system(scene.linkage), until, tolerance, method, times.tolist(),
                   **limits)
    return SimulatedScene(scene, run, torque)
