# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A proof that no extremum is missing, and a swing without any loss of energy.

You see the reason for each quantity, then the period of a pendulum of three links.
"""
from fourbar_ros import Bodies, find_extrema, FourBar, round_rod
from fourbar_ros.dynamics import free_period, System

rods = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods, gravity=(0.0, -9.81))
for found in find_extrema(linkage, ('omega4', 'shaking_force'), rate=25.0, certify=True):
    print(f'{found.quantity:14s} {found.kind:8s} {found.value:13.6f}  {found.proof}')

swing = System(linkage, position=-0.5)
print(f'period {free_period(swing):.12f} s')
