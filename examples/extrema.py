# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Every minimum and maximum of rate, acceleration and shaking force of a crank-rocker.

You see a line for each, to all digits, with the crank angle where it is.
"""
from math import degrees

from fourbar_ros import Bodies, find_extrema, FourBar, round_rod

lengths = (0.4, 1.2, 0.8)                       # crank, coupler, rocker [m]
rods = Bodies(*(round_rod(length, density=7750.0, radius=0.01) for length in lengths))
linkage = FourBar(*lengths, 1.0, bodies=rods)   # ground 1 m
for found in find_extrema(linkage, ('omega4', 'alpha4', 'shaking_force'), rate=25.0):
    best = '  of all' if found.is_global else ''
    print(f'{found.quantity:14s} {found.kind:8s} {found.value:13.6f} {found.unit:8s} '
          f'at {degrees(found.theta1):10.6f} deg{best}')
