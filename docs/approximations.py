# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of approximations, for the tables of robots.md and node.md."""
from math import degrees, pi
from pathlib import Path

from fourbar_ros import load_scene
from fourbar_ros.transmission import ratio_of, trajectory, Transmission
import numpy as np

SAMPLES = 20001
SCENES = ('paper', 'slides_7_6', 'slides_7_7', 'cylinder', 'slider_crank', 'scotch_yoke')
RATES = (0.1, 1.0, 3.0, 10.0, 20.0)      # [rad/s] of the sine that the output follows
CHAINS = {'watt': ('four_bar', 'dyad'), 'quick_return': ('lever', 'ram')}
NODES = Path(__file__).parent.parent / 'examples' / 'nodes'
SAMPLED = (100.0, 200.0, 500.0, 1000.0, 2000.0)     # [Hz]


def output_over_input(linkage):
    """Return inputs over the first range, away from its ends, and the continuous output."""
    low, high = linkage.input_ranges[0]
    margin = 0.0 if linkage.turns_fully else 0.01 * (high - low)
    inputs = np.linspace(low + margin, high - margin, SAMPLES)
    name = linkage.outputs[0].coordinate
    output, = linkage.motion(inputs, fields=(name.position,))
    return inputs, np.unwrap(output) if name.unit == 'rad' else output


def mimic_rows():
    """Yield rows (scene, output, its travel, errors of line and cubic, error of the rate)."""
    for scene in SCENES:
        linkage = load_scene(scene).linkage
        inputs, output = output_over_input(linkage)
        is_angle = linkage.outputs[0].coordinate.unit == 'rad'
        ratio = ratio_of(linkage, inputs)
        line, cubic = (np.polynomial.Polynomial.fit(inputs, output, degree) for degree in (1, 3))
        errors = [np.abs(fit(inputs) - output).max() for fit in (line, cubic)]
        slope = np.abs(line.deriv()(inputs) - ratio).max() / np.abs(ratio).max()

        def text(value, is_angle=is_angle):
            return f'{degrees(value):.3g}°' if is_angle else f'{1e3 * value:.3g} mm'
        yield (f'`{scene}`', f'`{linkage.outputs[0].coordinate.position}`',
               text(np.ptp(output)), *map(text, errors), f'{100.0 * slope:.3g} %')


def static_rows():
    """Yield rows (rate, largest torques with links and of the static map, error of the map)."""
    linkage = load_scene('paper').linkage
    through = Transmission(linkage, 1.0)
    low, high = sorted(end.output for end in through.branch.ends)
    middle, size = 0.5 * (low + high), 0.35 * (high - low)
    for rate in RATES:
        phase = np.linspace(0.0, 2.0 * np.pi, 721)
        wanted = trajectory(middle + size * np.sin(phase), size * rate * np.cos(phase),
                            -size * rate**2 * np.sin(phase), 50.0)
        exact, static = through.to_input(wanted).effort, through.static_effort(wanted)
        error = np.abs(static - exact).max() / np.abs(exact).max()
        yield (f'{rate:g}', f'{np.abs(exact).max():.3g}', f'{np.abs(static).max():.3g}',
               f'{100.0 * error:.2g} %')


def chain_rows():
    """Yield rows (chain, its speed, how its load comes back; error of the drive by the rate)."""
    for name, nodes in CHAINS.items():
        first, second = (load_scene(f'{NODES / name}.yaml:{node}') for node in nodes)
        output, speed = first.linkage.outputs[0], first.drive.speed

        def step(time, first=first, second=second, output=output, speed=speed):
            """Return torque of the first drive, output ratio, couple of the second on it."""
            motion, loads = first.linkage.step(speed * time, speed, 0.0)
            given = [getattr(motion, field) for field in output.coordinate]
            couple = -second.linkage.loads(np.unwrap(given[0]), *given[1:]).driving_torque
            return loads.driving_torque, getattr(motion, output.ratio), couple
        time = np.linspace(0.0, 2.0 * pi / speed, SAMPLES)
        own, ratio, couple = step(time)
        peak = np.abs(own - ratio * couple).max()
        late, due = [], []
        for period in [1.0 / rate for rate in SAMPLED]:
            one, two = (step(time - count * period)[2] for count in (1, 2))
            for errors, comes in ((late, one), (due, 2.0 * one - two)):
                error = 100.0 * np.abs(ratio * (comes - couple)).max() / peak
                errors.append(f'{error:.2g} %')
        yield (f'`{name}`, {speed:g} rad/s: one sample late', *late)
        yield ('extrapolated', *due)
