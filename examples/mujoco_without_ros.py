# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The motor of mujoco_motor.py without ROS: the library in the simulator's own loop.

You see the same figures, and how little they depend on the step.
"""
from pathlib import Path
from types import SimpleNamespace

from fourbar_ros import load_scene
from mujoco_motor import simulate

linkage = load_scene(Path(__file__).parent / 'nodes/mujoco_motor.yaml').linkage


def ask(_, angle, rate, acceleration):
    """Return what the node would answer."""
    return SimpleNamespace(equation=SimpleNamespace(
        inertia=linkage.inertia(angle), bias=linkage.bias(angle, rate)))


for step in (1e-3, 2.5e-4):
    rates = simulate(ask, step=step)[:, 1]
    late = rates[round(1.5 / step):]
    print(f'{1e3 * step:4.2f} ms: at the end {late.min():.2f} to {late.max():.2f} rad/s')
