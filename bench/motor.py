# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The paper's linkage with a real motor: speed ripple, and what it does to the shaking force."""
from typing import NamedTuple

from fourbar_ros import Bodies, FourBar, round_rod
from fourbar_ros.dynamics.flywheel import flywheel_for
from fourbar_ros.dynamics.model.drives import DCMotor, Drive
from fourbar_ros.dynamics.model.equation import Equation
from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve.simulate import REACHED, simulate
import numpy as np

from .pages import figure, save

RODS = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
LINKAGE = FourBar(0.4, 1.2, 0.8, 1.0, bodies=RODS)      # config/paper.yaml
SPEED = 25.0               # [rad/s] mean over time
# A servo motor of 1.5 kW on a gear of 12: winding 0.4 ohm and 2 mH, 0.5 N m/A, rotor 8e-4 kg m^2
GEAR, WINDING, INDUCTANCE, CONSTANT, ROTOR = 12.0, 0.4, 2e-3, 0.5, 8e-4 * 12.0**2
SETTLED = 14.0             # time constants of the motor until a turn repeats, which is checked
WANTED = (None, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
SAMPLES = 1441


class Turn(NamedTuple):
    """One turn in steady state: crank angle from 0, speed, shaking force, torque on the crank."""

    flywheel: float
    angle: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    repeats: float         # difference of the speed from the turn before [rad/s]

    @property
    def fluctuation(self):
        """Return (largest - least) / mean of the speed."""
        return float(np.ptp(self.rate)) / SPEED


def run_at(voltage, flywheel):
    """Return the last two turns at a voltage, and the mean speed of the last."""
    drive = Drive(DCMotor(voltage, WINDING, CONSTANT, INDUCTANCE, GEAR), ROTOR, flywheel)
    period = 2.0 * np.pi / SPEED
    # J R / (K N)^2, with the rotor and the linkage below 1 kg m^2 in the mean
    until = 1.5 + SETTLED * (1.0 + flywheel) * WINDING / (CONSTANT * GEAR)**2
    times = np.concatenate([[0.0], np.linspace(until - 3.3 * period, until, 4 * SAMPLES)])
    run = simulate(System(LINKAGE, 0.0, SPEED, drive=drive), until, 1e-7, times=times)
    assert run.status == REACHED
    end = run.position[-1]
    at_turns = np.interp([end - 4.0 * np.pi, end - 2.0 * np.pi, end], run.position, run.time)
    return run, 2.0 * np.pi / (at_turns[2] - at_turns[1])


def steady(flywheel):
    """Return the Turn with a flywheel, at the voltage at which the mean speed is SPEED."""
    voltage = CONSTANT * GEAR * SPEED
    for _ in range(4):      # the mean speed is all but in proportion to the voltage
        run, mean = run_at(voltage, flywheel)
        voltage *= SPEED / mean
    last = np.floor(run.position[-1] / (2.0 * np.pi)) * 2.0 * np.pi
    angle = np.linspace(0.0, 2.0 * np.pi, SAMPLES)
    rate, before, acceleration = (np.interp(place, run.position, values) for place, values in (
        (last - 2.0 * np.pi + angle, run.rate), (last - 4.0 * np.pi + angle, run.rate),
        (last - 2.0 * np.pi + angle, run.acceleration)))
    loads = LINKAGE.loads(angle, rate, acceleration)
    return Turn(flywheel, angle, rate, loads.shaking_force, loads.driving_torque,
                float(np.max(np.abs(rate - before))))


def draw(turns, constant):
    """Draw speed and shaking force over a turn, and the error of the assumption over ripple."""
    drawing, (left, middle, right) = figure(1, 3, figsize=(13.0, 4.0))
    for turn, color in zip((turns[0], turns[3], turns[5]), ('C3', 'C1', 'C0')):
        text = 'motor alone' if not turn.flywheel else f'flywheel {turn.flywheel:.2g} kg m²'
        left.plot(np.degrees(turn.angle), turn.rate, color, label=text)
        middle.plot(np.degrees(turn.angle), turn.force, color)
    left.axhline(SPEED, color='k', linewidth=0.8, linestyle='--', label='constant speed')
    middle.plot(np.degrees(turns[0].angle), constant.shaking_force, 'k--', linewidth=0.8)
    peak = np.max(constant.shaking_force)
    right.loglog([turn.fluctuation for turn in turns],
                 [abs(np.max(turn.force) / peak - 1.0) * 100.0 for turn in turns], 'ko-')
    left.set(xlabel='crank angle [deg]', ylabel='speed of the crank [rad/s]')
    left.legend(fontsize=8)
    middle.set(xlabel='crank angle [deg]', ylabel='shaking force [N]')
    right.set(xlabel='coefficient of speed fluctuation',
              ylabel='peak shaking force off constant speed [%]')
    for axis in (left, middle, right):
        axis.grid(alpha=0.3, which='both')
    save(drawing, 'motor')


def main():
    """Print a table in Markdown and draw the figure."""
    angle = np.linspace(0.0, 2.0 * np.pi, SAMPLES)
    constant = LINKAGE.loads(angle, SPEED, 0.0)
    equation = Equation(LINKAGE, extra_inertia=ROTOR)
    turns = [steady(0.0 if wanted is None else flywheel_for(equation, SPEED, wanted).inertia)
             for wanted in WANTED]
    peak, torque = np.max(constant.shaking_force), np.max(np.abs(constant.driving_torque))
    print('The crank-rocker of `config/paper.yaml` (a1 0.4, a2 1.2, a3 0.8, a4 1.0 m, steel rods '
          f'of 20 mm), at a mean of {SPEED:g} rad/s, driven by a servo motor of 1.5 kW on a gear '
          f'of {GEAR:g} ({WINDING:g} ohm, {1e3 * INDUCTANCE:g} mH, {CONSTANT:g} N m/A, '
          f'{ROTOR:.3f} kg m² at the crank) at constant voltage. Flywheels are those that '
          '`flywheel_for` gives for the fluctuation wanted.\n')
    print('| wanted fluctuation | flywheel [kg m²] | fluctuation | speed [rad/s] '
          '| peak shaking force [N] | off constant speed | peak torque on the crank [N m] |\n'
          '| --- | --- | --- | --- | --- | --- | --- |')
    print(f'| both documents | | 0 | {SPEED:g} | {peak:.1f} | | {torque:.1f} |')
    for wanted, turn in zip(WANTED, turns):
        print(f'| {wanted or "none: motor alone"} | {turn.flywheel:.3g} | {turn.fluctuation:.4f} '
              f'| {turn.rate.min():.2f} to {turn.rate.max():.2f} | {turn.force.max():.1f} '
              f'| {100.0 * (turn.force.max() / peak - 1.0):+.2f} % '
              f'| {np.max(np.abs(turn.torque)):.1f} |')
    worst = max(turn.repeats for turn in turns)
    mean = np.mean(Equation(LINKAGE).terms(angle[:-1]).inertia)
    print('\nBoth documents assume a crank at constant speed. Of this linkage, whose masses are '
          'those of its rods, a real motor alone makes the peak of the shaking force more than '
          'twice what they compute; the error falls with about the square of the fluctuation, to '
          'below 2 % where the fluctuation is 5 %. Constant speed is an assumption about the '
          f'flywheel, here of 10 kg m²; the linkage itself has {mean:.2f} kg m² in the mean.')
    print(f'\nFrom one turn to the next the speed differs by at most {worst:.0e} rad/s.')
    draw(turns, constant)
    print('\n![Speed, shaking force, and the error of the assumption](motor.svg)')


if __name__ == '__main__':
    main()
