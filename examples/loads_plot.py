# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The bearing loads of a crank-rocker over a turn; needs matplotlib.

You see them as curves in loads.png, the shaking force with its exact extrema as dots.
"""
import sys

from fourbar_ros import find_extrema, load_scene
import numpy as np

try:
    from matplotlib.figure import Figure
except ModuleNotFoundError:
    sys.exit('needs matplotlib: pip install matplotlib')

SPEED = 25.0                                    # of the crank [rad/s]
linkage = load_scene('paper').linkage
theta = np.linspace(0.0, 2.0 * np.pi, 721)
loads = linkage.loads(theta, SPEED)
figure = Figure(figsize=(7.0, 4.0), layout='constrained')
axes = figure.subplots()
for name in ('f41', 'f21', 'f32', 'f43', 'shaking_force'):
    axes.plot(np.degrees(theta), np.abs(getattr(loads, name)), label=name)
for found in find_extrema(linkage, ('shaking_force',), rate=SPEED):
    axes.plot(np.degrees(found.theta1), found.value, 'ko', ms=4)
axes.set(xlabel='crank angle [deg]', ylabel='force [N]')
axes.legend()
figure.savefig('loads.png', dpi=120)
print('loads.png')
