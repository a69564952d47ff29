"""Extremes of the output's rate and acceleration of many linkages at once: :mod:`.rates` on arrays."""
from __future__ import annotations

from math import pi
from types import FunctionType
from typing import NamedTuple

import numpy as np

from . import factors
from .elliptic import half_turn
from .extrema import INTERIOR, MINIMUM, RATES, find_extrema
from .linkage import CROSSED, OPEN, FourBar
from .errors import FourBarError, InvalidParameter
from .rates import POINTS_PER_FEATURE, sine_constants, sines
from .roots import EPS, bracketed_roots, brackets, dips
from .search import fold

SAMPLES = 32
# Linkages taken at a time: their samples stay in the cache.
CHUNK = 2048


class Extrema(NamedTuple):
    """
    Extremes of one quantity of many linkages, by linkage, then theta1; arrays of shape (extremes,).

    Parameters
    ----------
    index : ndarray of int
        Which linkage.
    theta1, value : ndarray
        Input angle [rad], in [0, 2 pi), and the quantity there; +-inf at toggles.
    is_maximum, is_global : ndarray of bool
    side : ndarray of int
        0 inside the input range; at an end of it +1 (-1): approached from above (below).

    """

    index: np.ndarray
    theta1: np.ndarray
    value: np.ndarray
    is_maximum: np.ndarray
    is_global: np.ndarray
    side: np.ndarray


def _exact_sum(terms):
    """Return the sum of four arrays as math.fsum would: two exact pairs, their exact sum, the errors."""
    a, b, c, d = terms
    (one, e1), (other, e2) = _two_sum(a, b), _two_sum(c, d)
    total, e3 = _two_sum(one, other)
    return total + (e3 + (e1 + e2))


def _two_sum(a, b):
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


_FACTORS = {**vars(factors), 'fsum': _exact_sum}
_FACTORS.update({name: FunctionType(function.__code__, _FACTORS)
                 for name, function in vars(factors).items() if isinstance(function, FunctionType)})
_constants = FunctionType(sine_constants.__code__, {**sine_constants.__globals__, **{
    name: _FACTORS[name] for name in ('half_angle_coefficients', 'difference_of_squares')}})


def find_extrema_many(a1, a2, a3, a4, mode=OPEN, omega1=1.0, progress=None):
    """
    Return all extremes of omega4 and alpha4 of many linkages at constant input rate.

    Parameters
    ----------
    a1, a2, a3, a4 : array_like
        Lengths [m]; broadcast to one dimension. Linkages that cannot be assembled have no extremes.
    mode, omega1 : array_like
        Assembly mode (1 or 2) and input rate [rad/s], not zero.
    progress : callable, optional
        Called with the part done so far, from 0 to 1, some ten times a second.

    Returns
    -------
    dict of str to Extrema
        For 'omega4' and 'alpha4'.

    """
