# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The loads of a recorded run as a DataFrame: ``python bag_to_dataframe.py bags/run``; needs pandas.

You see its first rows, and loads.csv holds all of them.
"""
import sys

from fourbar_ros.bag import Bag
import numpy as np
import pandas

FIELDS = ('driving_torque', 'shaking_force', 'shaking_moment')
blocks = list(Bag(sys.argv[1]).columns(['/fourbar/loads']))     # arrays, block by block
columns = {'stamp': np.concatenate([block.stamps for block in blocks])}
for field in FIELDS:
    columns[field] = np.concatenate([block.records[field] for block in blocks])
frame = pandas.DataFrame(columns)
frame.to_csv('loads.csv', index=False)
print(frame.head())
