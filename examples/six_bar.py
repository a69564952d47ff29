# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Watt's six-bar, built as a machine of two dyads: a four-bar whose rocker drives a second one.

You see the swing of the output, its forces at 60 degrees, and the largest torque of a turn.
"""
from math import degrees, radians

from fourbar_ros import find_extrema
from fourbar_ros.machine import Dyad, Machine, Point, rods

one = Dyad('one', 'RRR', Point('crank', 0.4), Point('ground', 1.0), ('coupler', 'rocker'),
           length_1=1.2, length_2=0.8)
two = Dyad('two', 'RRR', Point('rocker', 0.5, -0.4), Point('ground', 2.2),
           ('connector', 'output'), length_1=0.8, length_2=0.7)
machine = Machine([one, two], bodies=rods([one, two], 7750.0, 0.01), gravity=(0.0, -9.81))

angles = [found.value for found in find_extrema(machine, ('theta_output',), rate=10.0)]
print(f'the output swings through {degrees(max(angles) - min(angles)):.4f} deg')
motion, loads = machine.step(radians(60.0), 10.0)
print(f'at 60 deg: {motion.omega_output:.4f} rad/s, inner pin {loads.two_inner:.3f} N')
torques = [found.value for found in find_extrema(machine, ('driving_torque',), rate=10.0)]
print(f'largest torque {max(map(abs, torques)):.3f} N m')
