# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
512 crank-rockers of random lengths, with all extrema of the shaking force of each.

You see how many fulfil the constraints, and the design that shakes least.
"""
from fourbar_lab.studies import compute, study_of

LENGTHS = ('linkage.a1', 'linkage.a2', 'linkage.a3')
study = study_of({
    'scene': 'paper', 'method': 'sobol', 'rows': 512, 'seed': 1,
    'vary': {'linkage.a1': {'range': [0.2, 0.6]}, 'linkage.a2': {'range': [0.8, 1.6]},
             'linkage.a3': {'range': [0.6, 1.2]}},
    'constraints': {'class': ['crank-rocker'], 'least_transmission_angle': {'least': 0.5},
                    'swing': {'least': 0.6}},
    'quantities': ['shaking_force', 'swing'], 'objectives': {'shaking_force.max': 'minimize'}})
chunk = compute(study, 0)           # fourbar study runs all chunks on all processors
print(', '.join(f'{reason}: {count}' for reason, count in chunk.counts.items()))
peaks = chunk.columns['shaking_force.max']
best = peaks.argmin()
lengths = ', '.join(f'{name} {chunk.columns[name][best]:.4f} m' for name in LENGTHS)
print(f'row {chunk.columns["row"][best]}: {lengths}: at most {peaks[best]:.2f} N')
