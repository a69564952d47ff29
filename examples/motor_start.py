# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A motor with a falling torque line starts a heavy crank-rocker from rest.

You see how the speed rises, and by how much it still fluctuates at the end.
"""
from fourbar_ros import Bodies, FourBar, round_rod
from fourbar_ros.dynamics import Drive, MotorLine, simulate, System

rods = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods, gravity=(0.0, -9.81))
drive = Drive(MotorLine(stall_torque=400.0, free_speed=26.0), rotor=0.5, flywheel=2.0)
run = simulate(System(linkage, position=0.0, drive=drive), until=2.0, tolerance=1e-7)
for time in (0.1, 0.2, 0.5, 1.0, 2.0):
    state = run.at(time)
    print(f'{time:4.1f} s  {state.position:9.4f} rad  {state.rate:8.4f} rad/s')
late = run.rate[run.time > 1.5]
print(f'{run.status}; at the end {late.min():.3f} to {late.max():.3f} rad/s, '
      f'position known to {run.error:.0e} rad')
