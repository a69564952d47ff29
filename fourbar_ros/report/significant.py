# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Motion and loads of a pose as lines of text: four digits, symbols in mathtext."""
from __future__ import annotations

from collections.abc import Collection
from math import degrees, pi, remainder

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.report.joint_labels import Labels

SYMBOLS = {'theta': r'\theta_', 'omega': r'\omega_', 'alpha': r'\alpha_'}


def significant(value: float) -> str:
    """Return a value as text with four digits: '12350', '0.001234', '1.234e-05'."""
    rounded = float(f'{value:.4g}') + 0.0
    return f'{rounded:.10g}' if 1e-3 <= abs(rounded) < 1e7 or rounded == 0.0 else f'{rounded:.4g}'


def symbol_of(name: str) -> str:
    r"""
    Return the symbol of a position or a rate as mathtext.

    It is \theta_1 for theta1, \omega_\beta for omega_beta, s for slide, and with words
    \theta_{\mathrm{crank}} for theta_crank, s_{\mathrm{rod}} for slide_rod.
    """
    for word, symbol in SYMBOLS.items():
        if name.startswith(word):
            index = name.removeprefix(word).removeprefix('_')
            if index.isdigit():
                return symbol + index
            return symbol + (r'\beta' if index == 'beta' else f'{{{_upright(index)}}}')
    if name.startswith('slide_'):
        return f's_{{{_upright(name.removeprefix("slide_"))}}}'
    return {'beta': r'\beta', 'slide': 's'}.get(name) or _upright(name)


def _upright(name: str) -> str:
    words = name.replace('_', r'\ ')
    return rf'\mathrm{{{words}}}'


def motion_lines(mechanism: Mechanism, motion: NamedFields, unit: tuple[str, float]) -> list[str]:
    """
    Return a line for each absolute angle and slide: position, rate, acceleration.

    ``unit`` of lengths: (text, size in [m]).
    """
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
    Return lines of text: a force at each joint, the drive, guide and shaking loads.

    ``drawn``: the forces that have an arrow; ``torque``: symbol of the driving torque.
    """
    lines = [' '.join(filter(None, (f'${symbol}$', labels.words.get(name),
                                    f'= {significant(getattr(loads, name))} N',
                                    '' if name in drawn or labels.words else '(not drawn)')))
             for name, symbol in labels.forces.items()]
    values = {name: significant(value) for name, value in loads._asdict().items()}
    lines.append(f'drive $P$ = {values["driving_force"]} N'
                 if getattr(loads, 'driving_force', 0.0) else
                 f'drive ${torque}$ = {values["driving_torque"]} N m')
    if 'guide_force' in values:
        lines += [f'guide force {values["guide_force"]} N',
                  f'guide couple {values["guide_couple"]} N m']
    return lines + [f'shaking force {values["shaking_force"]} N',
                    f'shaking moment {values["shaking_moment"]} N m']
