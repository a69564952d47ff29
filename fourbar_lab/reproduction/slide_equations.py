# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The input-output equations of loops with slides, RRRP and PRRP: the same equation, read otherwise.

Eq. (16) of the slides holds whatever of it varies. A slide at joint 4 fixes theta4, and a3 becomes
its variable: RRRP, a slider-crank. A slide at joint 1 fixes theta1, and a1 varies: with both,
PRRP, an elliptic trammel. Angles and the loop are those of
:mod:`fourbar_lab.reproduction.io_equations`, with x = theta1, y = theta4:

    (S1)  a1 e^{ix} + a2 e^{i(x + theta2)} = a4 + a3 e^{iy},   x + theta2 + theta3 = y + pi

Each pair of the four variables has its equation: |B - A| = a2 between 1 and 4, the distances O1 B
and O4 A between others with a length, and what is square to a slide where its variable drops out.
All are bilinear in (1, cos, sin) of an angle and (1, d, d^2) of a slide,

    (S2)  u^T M w = 0,   biquadratic in tan(theta/2) and d.

>>> import math
>>> lengths, slides = (0.3, 0.8, None, 0.1), {4: -0.5 * math.pi}        # offset 0.1 to the left
>>> equation = equation_of_slides(lengths, slides, 1, 4)
>>> [round(float(slide), 6) for slide in equation.solve(math.radians(60.0) - 0.5 * math.pi)]
[0.933876, -0.633876]
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import cos, sin
from typing import NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import Array, EPS, Values
from fourbar_ros.numerics.given import array, number
import numpy as np


class SlideEquation(NamedTuple):
    """One equation between the variables of joints i and j: angles [rad], slides [m]."""

    i: int
    j: int
    is_slide: tuple[bool, bool]     # whether i, j slide
    matrix: Array       # (3, 3), M of (S2) [m^2], [m] where a slide's variable drops out

    def position(self, vi: Values, vj: Values) -> Array:
        """Return :meth:`residual` times 1 + v^2 of each v = tan(theta/2), as in Eqs. (16)-(21)."""
        return self._form(_textbook(vi, self.is_slide[0]), _textbook(vj, self.is_slide[1]))

    def residual(self, ti: Values, tj: Values) -> Array:
        """Return u^T M w, (S2), for angles [rad] and slides [m]; zero for a pose."""
        return self._form(_basis(ti, self.is_slide[0])[0], _basis(tj, self.is_slide[1])[0])

    def ratio(self, ti: Values, tj: Values) -> Array:
        """Return d tj / d ti at a pose; infinite where ti stalls at a limit."""
        (u, du, _), (w, dw, _) = (_basis(t, its) for t, its in zip((ti, tj), self.is_slide))
        with np.errstate(divide='ignore', invalid='ignore'):
            found: Array = -self._form(du, w) / self._form(u, dw)
        return found

    def second_ratio(self, ti: Values, tj: Values) -> Array:
        """Return d^2 tj / d ti^2 at a pose: the second derivative of u^T M w = 0 by ti."""
        (u, du, ddu), (w, dw, ddw) = (_basis(t, its) for t, its in zip((ti, tj), self.is_slide))
        ratio = self.ratio(ti, tj)
        with np.errstate(divide='ignore', invalid='ignore'):
            bend = ratio * (2.0 * self._form(du, dw) + ratio * self._form(u, ddw))
            found: Array = -(self._form(ddu, w) + bend) / self._form(u, dw)
        return found

    def solve(self, ti: Values) -> tuple[Array, Array]:
        """
        Return both values of joint j, [rad] in [-pi, pi] or [m], at ti; NaN where no loop closes.

        Where the equation is linear in a slide, both are its one value.
        """
        c0, c1, c2 = np.tensordot(self.matrix.T, _basis(ti, self.is_slide[0])[0], 1)
        with np.errstate(divide='ignore', invalid='ignore'):
            if not self.is_slide[1]:        # c0 + c1 cos + c2 sin = 0
                size, middle = np.hypot(c1, c2), np.arctan2(c2, c1)
                away = np.arctan2(np.sqrt((size - c0) * (size + c0)), -c0)
                return _wrapped(middle + away), _wrapped(middle - away)
            if not self.matrix[:, 2].any():
                return -c0 / c1, -c0 / c1
            half = -0.5 * c1                # c0 + c1 d + c2 d^2 = 0
            far = half + np.where(half < 0.0, -1.0, 1.0) * np.sqrt(half * half - c0 * c2)
            one, other = far / c2, np.where(far == 0.0, 0.0, c0 / far)
            return np.maximum(one, other), np.minimum(one, other)

    def _form(self, u: Array, w: Array) -> Array:
        """
        Return u^T M w, (S2), with M this equation's ``matrix``; shape of the joints' values.

        ``u``, ``w``: of joints i and j the basis (1, cos, sin) or (1, d, d^2), or a derivative of
        it, shape (3, ...): see :func:`_basis`.
        """
        product: Array = sum(self.matrix[m, n] * u[m] * w[n] for m in range(3) for n in range(3)
                             if self.matrix[m, n])
        return product


def equation_of_slides(lengths: Sequence[float | None], slides: Mapping[int, float], i: int,
                       j: int) -> SlideEquation:
    """
    Return the :class:`SlideEquation` between the variables of joints i and j.

    Parameters
    ----------
    lengths : sequence of 4
        a1, a2, a3, a4 [m], of either sign; those that a slide varies are not read and may be None:
        a3 of a slide at joint 4, a1 of one at joint 1.
    slides : mapping
        {joint: direction of its slide from the ground line O1 O4 [rad]}, the fixed theta: of joint
        4 for RRRP, of 1 and 4 for PRRP. A slider-crank whose guide has the offset h has a4 = h, a
        slide at -pi/2, and theta1 from the y axis: its own angle - pi/2.
    i, j : int
        Two different of 1, 2, 3, 4, in any order.

    Raises
    ------
    InvalidParameter
        Other slides or joints, or a pair that has no equation: of PRRP 2, 3, as theta2 + theta3
        is constant there, and if its slides are parallel all but 1, 4.

    """
    if set(slides) not in ({4}, {1, 4}):
        raise InvalidParameter('slides', dict(slides), 'must be at joint 4 (RRRP), or at 1 and 4 '
                                                       '(PRRP)')
    low, high = min(i, j), max(i, j)
    if len({i, j} & {1, 2, 3, 4}) < 2 or (1 in slides and (low, high) == (2, 3)):
        raise InvalidParameter('pair', (i, j), 'must be two different of the joints 1 to 4, of '
                                               'PRRP not 2 and 3, whose sum is constant')
    y = number('slides[4]', slides[4])
    if len(lengths) != 4:
        raise InvalidParameter('lengths', lengths, 'must be four: a1, a2, a3, a4')
    a2, a4 = (number(f'a{n}', lengths[n - 1]) for n in (2, 4))
    if 1 in slides:
        x = number('slides[1]', slides[1])
        if (low, high) != (1, 4) and abs(sin(y - x)) <= EPS * max(1.0, abs(x), abs(y)):
            raise InvalidParameter('slides', dict(slides), 'must not be parallel: the angles are '
                                   'the same at every slide, so that the pair 1, 4 alone moves')
        matrix = _trammel(a2, a4, x, y, (low, high))
    else:
        matrix = _slider_crank(number('a1', lengths[0]), a2, a4, y, (low, high))
    kinds = low in slides, high in slides
    if i > j:
        matrix, kinds = matrix.T, (kinds[1], kinds[0])
    return SlideEquation(i, j, kinds, matrix)


def _slider_crank(a1: float, a2: float, a4: float, y: float, pair: tuple[int, int]) -> Array:
    """Return M between two joints of RRRP; y: direction of the slide at joint 4 [rad]."""
    c, s = cos(y), sin(y)
    squares = a1 * a1 + a4 * a4 - a2 * a2
    across = a4 * s                                 # O4, square to the slide
    return np.array({
        # |a1 e^{ix} - a4 - d e^{iy}|^2 = a2^2: Eq. (16) in a3 = d
        (1, 4): [[squares, 2.0 * a4 * c, 1.0], [-2.0 * a1 * a4, -2.0 * a1 * c, 0.0],
                 [0.0, -2.0 * a1 * s, 0.0]],
        # |a1 + a2 e^{i theta2}|^2 = |a4 + d e^{iy}|^2
        (2, 4): [[a1 * a1 + a2 * a2 - a4 * a4, -2.0 * a4 * c, -1.0], [2.0 * a1 * a2, 0.0, 0.0],
                 [0.0, 0.0, 0.0]],
        # |a4 + d e^{iy} + a2 e^{i(y - theta3)}|^2 = a1^2
        (3, 4): [[a2 * a2 + a4 * a4 - a1 * a1, 2.0 * a4 * c, 1.0],
                 [2.0 * a2 * a4 * c, 2.0 * a2, 0.0], [2.0 * a2 * a4 * s, 0.0, 0.0]],
        # square to the slide: a1 sin(x - y) + a2 sin(beta - y) + a4 sin(y) = 0
        (1, 2): [[across, 0.0, 0.0], [-a1 * s, -a2 * s, a2 * c], [a1 * c, a2 * c, a2 * s]],
        (1, 3): [[across, 0.0, a2], [-a1 * s, 0.0, 0.0], [a1 * c, 0.0, 0.0]],
        (2, 3): [[across, 0.0, a2], [0.0, 0.0, a1], [0.0, a1, 0.0]],
    }[pair])


def _trammel(a2: float, a4: float, x: float, y: float, pair: tuple[int, int]) -> Array:
    """Return M between two joints of PRRP; x, y: directions of both slides [rad]."""
    turn, at_1, at_4 = sin(y - x), a4 * sin(x), a4 * sin(y)
    return np.array({
        # |c e^{ix} - a4 - d e^{iy}|^2 = a2^2: Eq. (16) in a1 = c and a3 = d
        (1, 4): [[a4 * a4 - a2 * a2, 2.0 * a4 * cos(y), 1.0],
                 [-2.0 * a4 * cos(x), -2.0 * cos(x - y), 0.0], [1.0, 0.0, 0.0]],
        # square to the slide of joint 4, with x + theta2 - y = pi - theta3
        (1, 2): [[at_4, -a2 * turn, a2 * cos(y - x)], [-turn, 0.0, 0.0], [0.0, 0.0, 0.0]],
        (1, 3): [[at_4, 0.0, a2], [-turn, 0.0, 0.0], [0.0, 0.0, 0.0]],
        # square to the slide of joint 1
        (2, 4): [[at_1, -turn, 0.0], [0.0, 0.0, 0.0], [a2, 0.0, 0.0]],
        (3, 4): [[at_1, -turn, 0.0], [-a2 * turn, 0.0, 0.0], [a2 * cos(y - x), 0.0, 0.0]],
    }[pair])


def _basis(value: Values, is_slide: bool) -> tuple[Array, Array, Array]:
    """Return (1, cos, sin) or, of a slide, (1, d, d^2), two derivatives; shapes (3, ...)."""
    t = array('joint', value)
    one, zero = np.ones_like(t), np.zeros_like(t)
    if is_slide:
        return (np.stack((one, t, t * t)), np.stack((zero, one, 2.0 * t)),
                np.stack((zero, zero, 2.0 * one)))
    c, s = np.cos(t), np.sin(t)
    return np.stack((one, c, s)), np.stack((zero, -s, c)), np.stack((zero, -c, -s))


def _textbook(value: Values, is_slide: bool) -> Array:
    """Return (1, cos, sin) times 1 + v^2 by v = tan(theta/2), or of a slide (1, d, d^2)."""
    v = array('v', value)
    if is_slide:
        return _basis(v, True)[0]
    return np.stack((1.0 + v * v, 1.0 - v * v, 2.0 * v))


def _wrapped(angle: Array) -> Array:
    """Return angles in [-pi, pi]."""
    return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))
