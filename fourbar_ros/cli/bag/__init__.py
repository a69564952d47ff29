# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar bag``: inspect, repair, check and convert recorded runs; one module an action."""
from __future__ import annotations

from fourbar_ros.cli.bag import diff, export, info, plot, recompute, recover, scene
from fourbar_ros.cli.common import add_verb, Verbs

ACTIONS = (info, recover, recompute, export, plot, diff, scene)
DESCRIPTION = """\
Inspect, repair, check and convert recorded runs. BAG is the folder of a bag or its .mcap file:
finished, cut off by a crash, or still being written. No action changes a bag or overwrites a
file. info and recompute accept several bags and folders of bags, and process them in parallel.
"""
EPILOG = """\
examples:
  fourbar bag info bags/run --check
  fourbar bag recover bags/run                        writes bags/run_recovered
  fourbar bag recompute bags/run
  fourbar bag info bags --check                       all bags below a folder
  fourbar bag recompute bags --json                   one line of JSON per bag
  fourbar bag export bags/run -o run.npz
  fourbar bag plot bags/run state.theta4 loads.f41 -o run.png
  fourbar bag diff bags/run bags/other --tolerance 1e-12

exit codes: 0 good; 1 an error, reported in one line; 2 bad arguments; 130, 143 interrupted by
Ctrl-C or SIGTERM, with no partial output left; 3 done, but
  info       the bag is unfinished or damaged, or messages are missing
  recover    data were lost or damaged
  recompute  a value differs by more than the tolerance, an output is missing, duplicated or
             without its input, or nothing could be compared
  diff       the bags differ
"""


def add(verbs: Verbs) -> None:
    """Add the verb and its actions."""
    bag = add_verb(verbs, 'bag', 'info, recover, recompute, export, plot, diff, scene: work with '
                                 'recorded runs',
                   DESCRIPTION, EPILOG)
    actions = bag.add_subparsers(dest='action', required=True, metavar='ACTION')
    for action in ACTIONS:
        action.add(actions)
