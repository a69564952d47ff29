# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Counterweights that take the whole shaking force of a crank-rocker; needs scipy.

You see the weights, and what they do to shaking force, moment and driving torque.
"""
from fourbar_lab.balancing import changes, full_force_balance, Loads, Places
from fourbar_ros import load_scene

scene = load_scene('paper')
loads = Loads(scene.linkage, scene.drive.speed)
balance = full_force_balance(Places(loads, {'crank': 0.6, 'output': 0.6}))      # radii [m]
for weight in balance.counterweights:
    print(f'{weight.mass:.6f} kg on the {weight.link} at ({weight.along:.3f}, '
          f'{weight.across:.3f}) m')
for change in changes(loads, balance.moments):
    (rms, rms_after), (peak, peak_after) = change.rms, change.peak
    print(f'{change.name:8s} rms {rms:9.3f} -> {rms_after:9.3f}, '
          f'peak {peak:9.3f} -> {peak_after:9.3f} {change.unit}')
