# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the two documents say in words and steps, as numbers: the method, its items, their questions.

Each function returns a dict by name for published.yaml, as those of
:mod:`fourbar_lab.reproduction.published`.
"""
from __future__ import annotations

from math import degrees

from fourbar_lab.reproduction import published
from fourbar_ros.extrema import collineation_axis
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.extrema.four_bar_rates.exact_count import count_extrema, rate_polynomials
from fourbar_ros.mechanics.moving_frames import rolling_contact
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.four_bar.io_equations import io_equation
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.numerics.arrays import Values
import numpy as np

STEP = 1e-30                                # of derivatives by the complex step
DISC = {'radius': 0.3, 'w': 4.0, 'al': 2.0}      # of our own, on flat ground
FOUR_EXTREMA = (1, 2, 2, 2)                 # a crank-rocker whose alpha4 has four in each mode


def contact() -> dict[str, float]:
    """
    Return the symbols of Eqs. (12)-(15) of the slides.

    (12): crank 2, coupler 3 of Example 7.6. (13)-(15): the rolling disc, ``p2`` the acceleration
    of its contact from the cycloid r (phi - sin phi, 1 - cos phi), phi clockwise, at phi = 0.
    """
    m = published.EXAMPLE_7_6.motion(*published.GIVEN_7_6)
    radius, w, al = DISC.values()
    found = rolling_contact(w, al, radius, (0.0, 1.0))
    (c_x, c_y), (rolling_x, rolling_y) = found.centre_acceleration, found.contact_acceleration
    return {**DISC, 'al2': m.alpha1, 'al3': m.alpha_beta, 'apparent': m.alpha2, 'p1_y': 0.0,
            'p2_x': 0.0, 'p2_y': radius * w**2, 'c_x': float(c_x), 'c_y': float(c_y),
            'rolling_x': float(rolling_x), 'rolling_y': float(rolling_y)}


def method() -> dict[str, float]:
    """Return what the slides' steps 1 to 9 and items 1 to 15 of Example 7.7 say."""
    linkage, speed = published.EXAMPLE_7_7, 10.0
    theta1 = np.linspace(-3.0, 3.0, 61)
    mirrored = linkage.in_mode(CROSSED).motion(-theta1, speed)
    motion = linkage.motion(theta1, speed)
    polynomial = rate_polynomials(*map(int, linkage.lengths))[-1]
    degree = len(polynomial.c) - 1 - next(i for i, c in enumerate(polynomial.c) if c)
    by_rate, by_acceleration = (_at_extrema(linkage, name, speed)
                                for name in ('omega4', 'alpha4'))
    return {'turns': float(linkage.turns_fully),
            'mirror': _largest(motion.omega4 - mirrored.omega4) / _largest(motion.omega4),
            'mirror_bend': _largest(motion.alpha4 + mirrored.alpha4) / _largest(motion.alpha4),
            'degree': 2.0 * degree,      # theta1 and -theta1 for each root
            'in_a_mode': float(count_extrema(linkage.lengths)[1] or 0),
            'most': float(count_extrema(FOUR_EXTREMA)[1] or 0),
            'at_rate': _largest(by_rate.alpha4) / _largest(motion.alpha4),
            **_steps(linkage, speed), 'slope': _slope(linkage, 'alpha4', by_acceleration.theta1)}


def algorithms() -> dict[str, float]:
    """Return the paper's two algorithms on its linkage, step by step."""
    linkage, speed = published.PAPER, published.PAPER_SPEED
    by_rate, by_acceleration = (_at_extrema(linkage, name, speed)
                                for name in ('omega4', 'alpha4'))
    return {**_steps(linkage, speed), 'rate_slope': _slope(linkage, 'omega4', by_rate.theta1),
            'slope': _slope(linkage, 'alpha4', by_acceleration.theta1),
            'position_slope': _largest(by_acceleration.omega4) / speed}


def _steps(linkage: FourBar, speed: float) -> dict[str, float]:
    """Return how far the method's theta4, omega4, alpha4 of theta1 alone miss our motion."""
    theta1 = np.linspace(-3.0, 3.0, 61)
    equation, motion = io_equation(linkage.lengths, 1, 4), linkage.motion(theta1, speed)
    theta4 = equation.solve(theta1)[linkage.mode - 1]                          # step 1
    omega4 = speed * equation.ratio(theta1, theta4)                            # step 2
    alpha4 = speed**2 * equation.second_ratio(theta1, theta4)                  # steps 3 and 4
    return {'step_1': _largest(np.sin(0.5 * (theta4 - motion.theta4))),
            'step_2': _largest(omega4 - motion.omega4) / _largest(omega4),
            'step_4': _largest(alpha4 - motion.alpha4) / _largest(alpha4)}


def _at_extrema(linkage: FourBar, quantity: str, speed: float) -> NamedFields:
    found = [extremum.theta1 for extremum in find_extrema(linkage, (quantity,), speed)]
    return linkage.motion(found, speed)


def _slope(linkage: FourBar, quantity: str, theta1: Values) -> float:
    """Return the largest slope over theta1 of a quantity there, over its largest in the turn."""
    turn, = linkage.motion(np.linspace(-3.0, 3.0, 61), 1.0, fields=(quantity,))
    complex_, = linkage.motion(np.asarray(theta1) + 1j * STEP, 1.0, fields=(quantity,))
    return _largest(complex_.imag / STEP) / _largest(turn)


def _largest(values: Values) -> float:
    return float(np.max(np.abs(values)))


def axis() -> dict[str, float]:
    """
    Return what the collineation axis says at every extremum of both documents.

    ``square_7_7``, ``square_paper``: the angle at the extrema of omega4 that is farthest from a
    right one [deg]; ``bend_...``: at those of alpha4 d(tan l)/d(theta1) + 2 R - 1, over its terms.
    """
    found: dict[str, float] = {}
    for name, linkage in (('7_7', published.EXAMPLE_7_7), ('paper', published.PAPER)):
        square, bend = [90.0], [0.0]
        for mode in (CROSSED, OPEN):
            its = linkage.in_mode(mode)
            for extremum in find_extrema(its, ('omega4', 'alpha4'), 1.0):
                motion = its.motion(np.array([extremum.theta1 + 1j * STEP]), 1.0)
                seen = collineation_axis(its, motion)
                if extremum.quantity == 'omega4':
                    tilt = float((seen.along / seen.across).real[0])
                    square.append(90.0 - degrees(np.arctan(tilt)))
                else:
                    slope = float((seen.across / seen.along).imag[0]) / STEP
                    ratio = float(motion.omega4.real[0])
                    bend.append((slope + 2.0 * ratio - 1.0) / (abs(slope) + 1.0 + abs(ratio)))
        found |= {f'square_{name}': max(square, key=lambda angle: abs(angle - 90.0)),
                  f'bend_{name}': max(bend, key=abs)}
    return found
