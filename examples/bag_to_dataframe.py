# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The loads of a recorded run as a DataFrame; needs pandas.

``python examples/bag_to_dataframe.py bags/run``: you see the first rows, loads.csv holds all.
"""
import sys

from fourbar_ros.bag import Bag
import numpy as np

try:
    import pandas
except ModuleNotFoundError:
    sys.exit('needs pandas: pip install pandas')
if len(sys.argv) != 2:
    sys.exit('give the folder of a bag, for example bags/run')
FIELDS = ('driving_torque', 'shaking_force', 'shaking_moment')
blocks = list(Bag(sys.argv[1]).columns(['/fourbar/loads']))     # arrays, block by block
columns = {'stamp': np.concatenate([block.stamps for block in blocks])}
for field in FIELDS:
    columns[field] = np.concatenate([block.records[field] for block in blocks])
frame = pandas.DataFrame(columns)
frame.to_csv('loads.csv', index=False)
print(frame.head())
