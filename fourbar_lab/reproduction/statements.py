# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the two documents say in words and steps, as numbers: the method, its items, their questions.

Functions return a dict of numbers by name, as those of
:mod:`fourbar_lab.reproduction.published`; the rows of ``table.py`` say what each must be.
"""
from __future__ import annotations

from dataclasses import replace
from math import degrees, sqrt, tau

from fourbar_lab.drawing import collineation_axis
from fourbar_lab.reproduction import published
from fourbar_lab.reproduction.exact_count import count_extrema, rate_polynomials
from fourbar_lab.reproduction.io_equations import io_equation
from fourbar_lab.reproduction.moving_frames import rolling_contact
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanics.bodies import Bodies, Body, round_rod
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.numerics.arrays import Values
import numpy as np

STEP = 1e-30                                # of derivatives by a complex step
TURN = np.linspace(-3.0, 3.0, 61)           # theta1 of samples of a turn [rad]
DISC = {'radius': 0.3, 'w': 4.0, 'al': 2.0}      # of our own, on flat ground
FOUR_EXTREMA = (1, 2, 2, 2)                 # a crank-rocker whose alpha4 has four in each mode


def contact() -> dict[str, float]:
    """
    Return the symbols of the slides' Eqs. (12)-(15), on accelerations of links in contact.

    (12): angular ones of crank 2 and coupler 3 of Example 7.6. (13)-(15): a disc that rolls;
    ``c`` is its centre, ``rolling`` its contact, ``p2`` the same acceleration from the cycloid
    r (phi - sin phi, 1 - cos phi), phi clockwise, at phi = 0, and ``p1`` that of the ground.
    """
    motion = published.EXAMPLE_7_6.motion(*published.GIVEN_7_6)
    radius, rate, acceleration = DISC['radius'], DISC['w'], DISC['al']
    disc = rolling_contact(rate, acceleration, radius, (0.0, 1.0))
    (c_x, c_y), (rolling_x, rolling_y) = disc.centre_acceleration, disc.contact_acceleration
    return {**DISC, 'al2': motion.alpha1, 'al3': motion.alpha_beta, 'apparent': motion.alpha2,
            'p1_y': 0.0, 'p2_x': 0.0, 'p2_y': radius * rate**2,
            'c_x': float(c_x), 'c_y': float(c_y),
            'rolling_x': float(rolling_x), 'rolling_y': float(rolling_y)}


def method() -> dict[str, float]:
    """
    Return numbers that check the slides' steps 1 to 9 and items 1 to 15 of Example 7.7.

    Differences (``mirror``, ``at_rate``, ``step_...``, ``slope``) are relative, and should vanish;
    ``degree``, ``in_a_mode`` and ``most`` count extrema of alpha4.
    """
    linkage, speed = published.EXAMPLE_7_7, 10.0
    mirrored = linkage.in_mode(CROSSED).motion(-TURN, speed)
    motion = linkage.motion(TURN, speed)
    coefficients = rate_polynomials(*map(int, linkage.lengths))[-1].c
    # roots at zero are none of the condition: they do not count
    degree = len(coefficients) - 1 - next(i for i, c in enumerate(coefficients) if c)
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
    """Return how far theta4, omega4, alpha4 by the method's steps miss our motion, relative."""
    equation, motion = io_equation(linkage.lengths, 1, 4), linkage.motion(TURN, speed)
    theta4 = equation.solve(TURN)[linkage.mode - 1]                          # step 1
    omega4 = speed * equation.ratio(TURN, theta4)                            # step 2
    alpha4 = speed**2 * equation.second_ratio(TURN, theta4)                  # steps 3 and 4
    return {'step_1': _largest(np.sin(0.5 * (theta4 - motion.theta4))),
            'step_2': _largest(omega4 - motion.omega4) / _largest(omega4),
            'step_4': _largest(alpha4 - motion.alpha4) / _largest(alpha4)}


def _at_extrema(linkage: FourBar, quantity: str, speed: float) -> NamedFields:
    """Return the motion at all extrema of a quantity."""
    return linkage.motion([extremum.theta1 for extremum
                           in find_extrema(linkage, (quantity,), speed)], speed)


def _slope(linkage: FourBar, quantity: str, theta1: Values) -> float:
    """Return the largest |dQ/dtheta1| at these inputs over the largest |Q| of a turn."""
    of_turn, = linkage.motion(TURN, 1.0, fields=(quantity,))
    here, = linkage.motion(np.asarray(theta1) + 1j * STEP, 1.0, fields=(quantity,))
    return _largest(here.imag / STEP) / _largest(of_turn)


def _largest(values: Values) -> float:
    """Return the largest magnitude."""
    return float(np.max(np.abs(values)))


def axis() -> dict[str, float]:
    """
    Return numbers that check the collineation axis at every extremum of both documents.

    ``square_7_7``, ``square_paper``: the angle at the extrema of omega4 that is farthest from a
    right one [deg]; ``bend_...``: at those of alpha4 d(tan l)/d(theta1) + 2 R - 1, over its terms.
    """
    values: dict[str, float] = {}
    for name, linkage in (('7_7', published.EXAMPLE_7_7), ('paper', published.PAPER)):
        square, bend = [90.0], [0.0]
        for its in (linkage.in_mode(CROSSED), linkage.in_mode(OPEN)):
            for extremum in find_extrema(its, ('omega4', 'alpha4'), 1.0):
                motion = its.motion(np.array([extremum.theta1 + 1j * STEP]), 1.0)
                line = collineation_axis(its, motion)       # its direction along the coupler
                if extremum.quantity == 'omega4':
                    cotangent = float((line.along / line.across).real[0])
                    square.append(90.0 - degrees(np.arctan(cotangent)))
                else:
                    slope = float((line.across / line.along).imag[0]) / STEP
                    ratio = float(motion.omega4.real[0])
                    bend.append((slope + 2.0 * ratio - 1.0) / (abs(slope) + 1.0 + abs(ratio)))
        values |= {f'square_{name}': max(square, key=lambda angle: abs(angle - 90.0)),
                   f'bend_{name}': max(bend, key=abs)}
    return values


def small_share(e: float) -> FourBar:
    """
    Return the family whose shaking force at its largest alpha4 is a share sqrt(e) of its peak.

    The paper's rods, 1, 2 - 1.5 e, 1 m long, on a ground of e: a double-crank near a change point.
    With theta4 = theta1 + pi - u its loop gives, as e goes to 0,

        (Q1)  u = sqrt(e) g,   g = 2 sqrt(3/2 - cos(theta1))

    and the rods, 7750 kg/m^3 and l kg/m, their shaking force at unit rate

        (Q2)  F = 3/2 l sqrt(e) (2 g' + i (g - g'')) e^{i theta1}

    alpha4 = -u'' is largest at theta1 = 0. There g' = 0 and g = g'' = sqrt(2), so F vanishes in
    this order; the next one leaves 15/4 l e. F peaks at pi: 18/sqrt(10) l sqrt(e). The share is

        (Q3)  5 sqrt(10)/24 sqrt(e)
    """
    lengths = (1.0, 2.0 - 1.5 * e, 1.0)
    return FourBar(*lengths, e, bodies=Bodies(*(round_rod(length, 7750.0, 0.01)
                                                for length in lengths)))


def last_question() -> dict[str, float]:
    """
    Return numbers that test the paper's claim that extreme alpha4 implies extreme shaking.

    ``share`` over sqrt(e), with its limit (Q3), and ``weighted``: shaking force at the largest
    alpha4 over its peak, which may be next to nothing. ``point_...``: about this point the peak of
    the shaking moment is least, ``bound`` a proof of it; ``at_...``: the moment at the largest
    alpha4 and omega4 over that peak.
    """
    e = 1e-6                # ground of small_share: the share is near its limit
    thin, speed = published.THIN, published.PAPER_SPEED
    point, peak, bound = least_moment(thin, speed)
    at_alpha4, at_omega4 = (
        abs(_moment_about(point, thin.loads(largest(thin, quantity), speed))) / peak
        for quantity in ('alpha4', 'omega4'))
    return {'share': force_share(small_share(e)) / sqrt(e), 'share_limit': 5.0 * sqrt(10.0) / 24.0,
            'weighted': force_share(counterweighted(thin)), 'peak': peak, 'bound': bound,
            'point_x': point[0], 'point_y': point[1], 'at_alpha4': at_alpha4,
            'at_omega4': at_omega4}


def force_share(linkage: FourBar) -> float:
    """Return the shaking force at the largest alpha4 over its peak."""
    peak = max(extremum.value for extremum in find_extrema(linkage, ('shaking_force',), 1.0))
    return float(linkage.loads(largest(linkage, 'alpha4'), 1.0).shaking_force) / peak


def largest(linkage: FourBar, quantity: str) -> float:
    """Return theta1 [rad] where a quantity is largest, of either sign."""
    return max(find_extrema(linkage, (quantity,), 1.0),
               key=lambda extremum: abs(extremum.value)).theta1


def counterweighted(linkage: FourBar) -> FourBar:
    """
    Return a linkage with 5 kg on its crank that cancel the shaking force at its largest alpha4.

    At unit rate a first moment s on the crank adds the force s e^{i theta1}.
    """
    assert linkage.bodies is not None
    crank, mass, theta1 = linkage.bodies.crank, 5.0, largest(linkage, 'alpha4')
    loads = linkage.loads(theta1, 1.0)
    force = complex(loads.shaking_force_x, loads.shaking_force_y)
    moment = crank.mass * complex(crank.cg_along, crank.cg_across) - force * np.exp(-1j * theta1)
    total = crank.mass + mass
    body = Body(total, moment.real / total, moment.imag / total, crank.inertia)
    return replace(linkage, bodies=linkage.bodies._replace(crank=body))


def least_moment(linkage: FourBar, speed: float, samples: int = 1440
                 ) -> tuple[tuple[float, float], float, float]:
    """
    Return the point [m] about which the largest shaking moment over a turn is least.

    With that peak [N m], and a bound that no point's peak is below, both of evenly spaced poses.
    The moment about (x, y) is M - x F_y + y F_x; a linear programme minimizes the largest |.|, and
    its dual, which weighs the poses, is the bound.
    """
    from scipy.optimize import linprog
    theta1 = np.linspace(0.0, tau, samples, endpoint=False)
    x, y, moment = linkage.step(theta1, speed, 0.0, fields=(
        'shaking_force_x', 'shaking_force_y', 'shaking_moment'))
    force, size = np.hypot(x, y).max(), np.abs(moment).max()
    of_point, ones = np.stack((y, -x), axis=-1) / force, np.ones((samples, 1))
    limits = np.concatenate((-moment, moment)) / size
    solution = linprog([0.0, 0.0, 1.0], np.block([[-of_point, -ones], [of_point, -ones]]), limits,
                       bounds=[(None, None), (None, None), (0.0, None)])
    point_x, point_y = (solution.x[:2] * size / force).tolist()
    return ((point_x, point_y), solution.fun * size,
            float(solution.ineqlin.marginals @ limits) * size)


def _moment_about(point: tuple[float, float], loads: NamedFields) -> float:
    """Return the shaking moment about a point [N m]."""
    return float(loads.shaking_moment - (point[0] * loads.shaking_force_y
                                         - point[1] * loads.shaking_force_x))
