# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The summary of a simulated run."""
from __future__ import annotations

from typing import Any

from fourbar_ros.report.terminal import make_console, plain_table


def print_summary(simulated: Any, name: str, tolerance: float, took: float) -> None:
    """Print how a run ended, how well it is known, its ripple and its extrema."""
    run, console = simulated.run, make_console()
    unit = simulated.scene.linkage.input_coordinate.unit
    end = float(run.time[-1])
    console.print(f'{name}: {end:g} s in {took:.2g} s of CPU time ({end / took:.3g} times real '
                  f'time), {run.time.size} samples.')
    checked = (f'error of the position up to {run.error:.2g} {unit}, energy constant within '
               f'{run.drift:.2g}; asked for {tolerance:g}')
    console.print(f'{run.status}: {run.method}, {checked}.')
    console.print(f'At the end the input is at {run.position[-1]:.10g} {unit} with '
                  f'{run.rate[-1]:.10g} {unit}/s.')
    ripple = simulated.ripple()
    if ripple:
        console.print(f'Speed over the last turn: {ripple.low:.6g} to {ripple.high:.6g} {unit}/s, '
                      f'coefficient of fluctuation {ripple.coefficient:.4g}.')
    modes = sorted(set(run.modes.tolist()))
    if len(modes) > 1:
        console.print(f'The motion goes through both assembly modes, {modes[0]} and {modes[1]}.')
    console.print()
    table = plain_table('extrema over the run', ('quantity', 'unit', 'lowest>', 'at [s]>',
                                                 'highest>', 'at [s]>'))
    for peak in simulated.peaks():
        table.add_row(peak.name, peak.unit, f'{peak.low:.6g}', f'{peak.low_at:g}',
                      f'{peak.high:.6g}', f'{peak.high_at:g}')
    console.print(table)
