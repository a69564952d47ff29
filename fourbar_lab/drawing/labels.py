# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Letters of joints, symbols of forces and rates, and numbers, for pictures; in mathtext."""
from collections.abc import Mapping, Sequence
from itertools import count
from math import degrees, hypot, pi, remainder
import re
from string import ascii_uppercase
from typing import NamedTuple

from fourbar_ros import Mechanism
from fourbar_ros.mechanisms import parts, picture
from fourbar_ros.numerics.arrays import Array
import numpy as np

LETTER = re.compile(r'[A-Z](_[^\W_])?')
# an index as in B_1 and F_{A1}, none in tip_left
INDEX = re.compile(r'(?<!\w)([A-Za-z])_(?:\{([^{}]*)\}|([^\W_])(?!\w))')
SYMBOLS = {'theta': r'\theta_', 'omega': r'\omega_', 'alpha': r'\alpha_'}
SAME = 1e-9      # joints nearer to each other than this share of the picture share a letter


class Labels(NamedTuple):
    """Names of joints and forces in a picture."""

    joints: Mapping[str, Array]         # {letter as mathtext: point}
    forces: Mapping[str, str]           # {field of the loads: symbol as mathtext}
    letters: Mapping[str, str]          # {joint: letter as it is written}, of textbooks: others
    are_by_links: bool = False          # forces are F_41 etc., as of textbooks


def as_mathtext(name: str) -> str:
    """Return mathtext that shows a name as it is written; of a letter the index is lowered."""
    if LETTER.fullmatch(name) or name.isalnum():
        return name
    return r'\text{' + re.sub(r'[\\$}]', r'\\\g<0>', name) + '}'


def without_math(text: str) -> str:
    """Return a text outside of formulas in which a dollar is a dollar."""
    return text.replace('$', r'\$')


def as_written(mathtext: str) -> str:
    """Return a label with its names as they are written, F_{tip_left1}."""
    return re.sub(r'\\text\{((?:\\.|[^}])*)\}', lambda match: re.sub(r'\\(.)', r'\1', match[1]),
                  mathtext)


def plain(words: str) -> str:
    """Return a label as it is written on one line: FA1 for F_{A1}."""
    return INDEX.sub(r'\1\2\3', words)


def labels_of(diagram: picture.Diagram) -> Labels:
    """
    Return the labels of a diagram.

    Joints named A, B, O_1, ... keep their names unless they are given others, with forces F_41
    etc. Other joints, as in a machine, get one letter for each point, its name if it has one;
    several joints at a point make forces F_A1, F_A2, at O beside O_1 F_O,1. A letter stays where
    another point takes a name.
    """
    if all(map(LETTER.fullmatch, diagram.joints)):
        return Labels({as_mathtext(diagram.names.get(joint, joint)): point
                       for joint, point in diagram.joints.items()},
                      {name: f'F_{{{name[1:]}}}' for name in diagram.forces}, diagram.names, True)
    size = max(np.ptp(np.array(list(diagram.joints.values())), axis=0))
    groups: list[list[str]] = []             # joints at one point
    for name, point in diagram.joints.items():
        here = [names for names in groups
                if hypot(*(point - diagram.joints[names[0]])) <= SAME * size]
        if here:
            here[0].append(name)
        else:
            groups.append([name])
    known, taken = diagram.names, set(diagram.names.values())
    # A, B, ..., A_1, B_1, ... without O, for pivots on the ground, and F, for forces
    letters_in_turn = ((letter, index) for index in count()
                       for letter in ascii_uppercase.replace('O', '').replace('F', ''))
    joints: dict[str, Array] = {}
    symbols: dict[str, str] = {}             # of the force at each joint
    letters: dict[str, str] = {}
    for names in groups:
        point = diagram.joints[names[0]]
        if not joints and not point.any():
            letter = 'O_1'
        else:
            first, start = next(letters_in_turn)
            letter = next(letter for index in count(start) if (
                letter := f'{first}_{index}' if index else first) not in taken)
        letter = next((known[name] for name in known if name in names), letter)
        joints[as_mathtext(letter)] = point
        taken.add(letter)               # A_1 may be the next free one after A, and come in turn
        letters.update(dict.fromkeys(names, letter))
    written = {name: plain(letter) for name, letter in letters.items()}
    for names in groups:
        marks = [str(index) for index in range(1, len(names) + 1)] if len(names) > 1 else ['']
        if any(mark and written[names[0]] + mark in written.values() for mark in marks):
            marks = [f',{mark}' for mark in marks]          # at O beside O_1
        symbols |= {name: f'F_{{{as_mathtext(written[name])}{mark}}}'
                    for name, mark in zip(names, marks)}
    forces = {force: symbols[joint] for force, joint in diagram.forces.items()}
    return Labels(joints, forces, letters)


# --- numbers -------------------------------------------------------------------------------------

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


def symbols_of(mechanism: Mechanism, names: Sequence[str]) -> tuple[str, ...]:
    """Return what a legend calls fields and quantities: symbols as in pictures, or words."""
    low, high = mechanism.input_ranges[0]        # any pose will do: the names are the same
    labels = labels_of(picture.diagram_of(mechanism, mechanism.motion(0.5 * (low + high), 1.0)))
    known = {'driving_torque': f'driving torque ${mechanism.TORQUE}$',
             'driving_force': 'driving force $P$'}
    for name, symbol in labels.forces.items():
        words = '' if labels.are_by_links else f' {name.replace("_", " ")}'
        known |= {name: f'${symbol}${words}',
                  **{f'{name}_{axis}': f'${symbol[:-1]},{axis}}}${words}' for axis in 'xy'}}
    for coordinate in mechanism.PARTS:
        known |= {name: f'{name.replace("_", " ") if coordinate.unit == "m" else ""} ${symbol}$'
                  .lstrip() for name, symbol in zip(coordinate, _symbols(coordinate))}
    return tuple([known.get(name, without_math(name) if '.' in name else name.replace('_', ' '))
                  for name in names])           # with a point: of a point, whose name stays


def _symbols(coordinate: parts.Coordinate) -> Sequence[str]:
    if coordinate.unit == 'rad':
        return [symbol_of(name) for name in coordinate]
    symbol = symbol_of(coordinate.position)
    return symbol, rf'\dot {symbol}', rf'\ddot {symbol}'


def _upright(name: str) -> str:
    words = name.replace('_', r'\ ')
    return rf'\mathrm{{{words}}}'


def motion_lines(mechanism: Mechanism, motion: parts.NamedFields, unit: tuple[str, float]
                 ) -> list[str]:
    """Return a line for each angle and slide; ``unit`` of lengths: (text, size in [m])."""
    lines = []
    for coordinate in mechanism.DRAWN:
        symbol, of_rate, of_acceleration = _symbols(coordinate)
        text, size = ('rad', 1.0) if coordinate.unit == 'rad' else unit
        position, rate, acceleration = (getattr(motion, name) / size for name in coordinate)
        value = (f'{degrees(remainder(position, 2.0 * pi)):.2f}°' if coordinate.unit == 'rad'
                 else f'{significant(position)} {text}')
        name = f'{coordinate.position} ' if symbol == 's' else ''
        lines.append(f'{name}${symbol}$ = {value},  ${of_rate}$ = {significant(rate)} {text}/s,  '
                     f'${of_acceleration}$ = {significant(acceleration)} {text}/s$^2$')
    return lines


def load_lines(mechanism: Mechanism, loads: parts.NamedFields, labels: Labels) -> list[str]:
    """Return lines of text: force at each joint, drive, guide, shaking."""
    lines = [f'${symbol}$ {"" if labels.are_by_links else name.replace("_", " ") + " "}'
             f'= {significant(getattr(loads, name))} N' for name, symbol in labels.forces.items()]
    values = {name: significant(value) for name, value in loads._asdict().items()}
    symbol, unit = ('P', 'N') if mechanism.is_driven_by_slide else (mechanism.TORQUE, 'N m')
    lines.append(f'drive ${symbol}$ = {values[mechanism.drive_load]} {unit}')
    if 'guide_force' in values:
        lines += [f'guide force {values["guide_force"]} N',
                  f'guide couple {values["guide_couple"]} N m']
    return lines + [f'shaking force {values["shaking_force"]} N',
                    f'shaking moment {values["shaking_moment"]} N m']
