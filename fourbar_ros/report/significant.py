# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Numbers of a pose as lines of text: four digits, symbols in mathtext."""
from __future__ import annotations

from collections.abc import Collection
from math import degrees, pi, remainder

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.report.joint_labels import Labels

SYMBOLS = {'theta': r'\theta_', 'omega': r'\omega_', 'alpha': r'\alpha_'}


def significant(value: float) -> str:
    """Return a value as text with four digits, without an exponent where that is readable."""
    rounded = float(f'{value:.4g}') + 0.0
    return f'{rounded:.10g}' if 1e-3 <= abs(rounded) < 1e7 or rounded == 0.0 else f'{rounded:.4g}'


def symbol_of(name: str) -> str:
    """Return a position or a rate as mathtext: theta1, beta, omega_beta, slide, theta_crank."""
    for word, symbol in SYMBOLS.items():
        if name.startswith(word):
            index = name.removeprefix(word).removeprefix('_')
            words = index.replace('_', r'\ ')
            return symbol + (index if index.isdigit() else
                             {'beta': r'\beta'}.get(index, rf'{{\mathrm{{{words}}}}}'))
    words = name.removeprefix('slide_').replace('_', r'\ ')
    return {'beta': r'\beta', 'slide': 's'}.get(
        name, rf's_{{\mathrm{{{words}}}}}' if name.startswith('slide_')
        else rf'\mathrm{{{words}}}')


def motion_lines(mechanism: Mechanism, motion: NamedFields, unit: tuple[str, float]) -> list[str]:
    """Return a line for each absolute angle and slide: position, rate, acceleration."""
    lines, (text, size) = [], unit
    for coordinate in mechanism.DRAWN:
        position, rate, acceleration = (getattr(motion, name) for name in coordinate)
        if coordinate.unit == 'rad':
            symbol, omega, alpha = map(symbol_of, coordinate)
            lines.append(rf'${symbol}$ = {degrees(remainder(position, 2.0 * pi)):.2f}°,  '
                         rf'${omega}$ = {significant(rate)} rad/s,  '
                         rf'${alpha}$ = {significant(acceleration)} rad/s$^2$')
        else:
            symbol = symbol_of(coordinate.position)
            name = f'{coordinate.position} ' if symbol == 's' else ''
            slide, rate, acceleration = (significant(value / size)
                                         for value in (position, rate, acceleration))
            lines.append(rf'{name}${symbol}$ = {slide} {text},  $\dot {symbol}$ = {rate} '
                         rf'{text}/s,  '
                         rf'$\ddot {symbol}$ = {acceleration} {text}/s$^2$')
    return lines


def load_lines(loads: NamedFields, labels: Labels, drawn: Collection[str],
               torque: str) -> list[str]:
    """
    Return the lines of text about loads.

    ``drawn``: the forces that have an arrow; ``torque``: symbol of the driving torque.
    """
    lines = [' '.join(filter(None, (f'${symbol}$', labels.words.get(name),
                                    f'= {significant(getattr(loads, name))} N',
                                    '' if name in drawn or labels.words else '(not drawn)')))
             for name, symbol in labels.forces.items()]
    found = loads._asdict()
    force = found.get('driving_force', 0.0)
    lines.append(f'drive $P$ = {significant(force)} N' if force else
                 f'drive ${torque}$ = {significant(found["driving_torque"])} N m')
    if 'guide_force' in found:
        lines += [f'guide force {significant(found["guide_force"])} N',
                  f'guide couple {significant(found["guide_couple"])} N m']
    return lines + [f'shaking force {significant(found["shaking_force"])} N',
                    f'shaking moment {significant(found["shaking_moment"])} N m']
