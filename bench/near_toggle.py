# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of accelerations and reactions near a toggle position, over their peaks."""
from fourbar_ros import Bodies, FourBar, InvalidParameter, round_rod
import numpy as np
from support.cartesian import values
from support.contract import crank_lengths

from .errors import (
    COLORS,
    forces_by_system,
    forces_of,
    MARKERS,
    OURS,
    SYSTEM,
    WAYS,
)
from .pages import figure, save, table

MARGINS, TOGGLES, AROUND = [10.0**-k for k in range(2, 15, 2)], 6, 40


def toggle_errors(margin):
    """
    Return {way: error of theta4'' over its peak}, {way: error of F41 over its peak}.

    Cranks that clear the toggle at theta1 = 0 by a margin, with rods, at poses around it.
    """
    rng = np.random.default_rng(round(-np.log10(margin)))
    second, force = dict.fromkeys(WAYS, 0.0), dict.fromkeys((OURS, SYSTEM), 0.0)
    for _ in range(TOGGLES):
        linkage = rods(near_toggle(rng, margin))
        angles = [side * 10.0**power for side in (-1.0, 1.0)
                  for power in np.linspace(-9.0, 0.4, AROUND)]
        places = [values(linkage, x) for x in angles]
        true = np.array([float(place['alpha4']) for place in places])
        for way, function in WAYS.items():
            found = np.array([function(linkage.lengths, 2, x, 1.0)[2] for x in angles])
            second[way] = max(second[way], np.abs(found - true).max() / np.abs(true).max())
        true = np.array([complex(place['f41_x'], place['f41_y']) for place in places])
        for way, function in ((OURS, forces_of), (SYSTEM, forces_by_system)):
            found = np.array([complex(*function(linkage, x, 1.0, 0.0)[0]) for x in angles])
            force[way] = max(force[way], np.abs(found - true).max() / np.abs(true).max())
    return second, force


def near_toggle(rng, margin):
    """Return lengths of a crank-rocker that clears the toggle at theta1 = 0 by a margin."""
    while True:
        a1, _, a3, a4 = crank_lengths(rng).tolist()
        lengths = (a1, a4 - a1 + a3 - margin * (a4 - a1), a3, a4)
        try:
            if FourBar(*lengths).classification == 'Grashof crank-rocker':
                return lengths
        except InvalidParameter:
            continue


def rods(lengths):
    """Return the linkage of these lengths with rods as links."""
    return FourBar(*lengths, bodies=Bodies(*(round_rod(a, 7750.0, 0.01) for a in lengths[:3])))


def print_toggles(found):
    """Print the errors by margin."""
    print(f"Near a toggle: largest error of theta4'' and of F41 over their peaks, {TOGGLES} "
          'crank-rockers a margin, '
          f'{2 * AROUND} poses each.\n')
    rows = [(f'{margin:.0e}', *(f'{second[way]:.1e}' for way in WAYS),
             *(f'{e:.1e}' for e in force.values()))
            for margin, (second, force) in found.items()]
    table(('margin', *(f"theta4'': {way}" for way in WAYS),
           *(f'F41: {way}' for way in (OURS, SYSTEM))), rows)


def draw_toggles(found):
    """Draw the errors near a toggle."""
    drawing, axes = figure(1, 2, figsize=(10.0, 4.2), sharey=True)
    for axis, which, title in zip(axes, (0, 1), ("θ4''", 'F41')):
        for way in next(iter(found.values()))[which]:
            axis.loglog(list(found), [row[which][way] for row in found.values()],
                        marker=MARKERS[way], color=COLORS[way],
                        label=way, markersize=11 if way == OURS else 6)
        axis.set(title=f'{title}: largest error over its peak',
                 xlabel='clearance of the toggle, relative')
        axis.grid(True, color='0.93')
        axis.legend()
    axes[0].invert_xaxis()
    axes[1].invert_xaxis()
    save(drawing, 'accuracy_toggle')
    print('![Errors near a toggle](accuracy_toggle.svg)\n')
