# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Ten thousand four-bars at once, as arrays of numpy.

You see the crank length of the lowest peak acceleration, and how fast they were computed.
"""
from time import perf_counter

from fourbar_lab.studies import find_extrema_many
from fourbar_ros import FourBar
import numpy as np

crank = np.linspace(0.2, 0.55, 10_000)                      # [m]
begin = perf_counter()
found = find_extrema_many(crank, 1.2, 0.8, 1.0, rate=25.0)['alpha4']
took = perf_counter() - begin
print(f'{found.value.size} extrema, {len(crank) / took:.0f} linkages a second')
best = found.is_global & found.is_maximum
lowest = found.value[best].argmin()
print(f'lowest peak {found.value[best][lowest]:.3f} rad/s^2 '
      f'with a crank of {crank[found.index[best][lowest]]:.6f} m')

angles = np.linspace(0.0, 2.0 * np.pi, 1_000_000)           # of one linkage
omega4 = FourBar(0.4, 1.2, 0.8, 1.0).motion(angles, 25.0, fields=('omega4',))
print(f'largest rate of {angles.size} samples {np.max(omega4):.6f} rad/s')
