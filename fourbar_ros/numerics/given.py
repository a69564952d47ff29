# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What callers give, as doubles.

Every public function converts or refuses here, with the name and what is allowed.
"""
from __future__ import annotations

from collections.abc import Iterable
from math import inf, isfinite
from numbers import Real
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import Array
import numpy as np


def number(name: str, value: Any, allowed: str = 'must be a finite number', least: float = -inf,
           above: float = -inf) -> float:
    """
    Return a finite number as a float, so that no other precision is computed with.

    Integers, fractions, numpy's numbers and arrays without dimensions are numbers; truth values,
    texts, times, complex numbers and None are not.

    Parameters
    ----------
    name, value
        Name and value of the parameter.
    allowed : str
        What is allowed, in words.
    least, above : float
        It must be at least, and more than that.

    Raises
    ------
    InvalidParameter

    """
    if type(value) is float and isfinite(value) and value >= least and value > above:
        return value                       # as most are; asking what else it may be takes longer
    is_masked: Any = np.ma.is_masked       # numpy gives it no types
    if isinstance(value, np.ndarray) and value.shape == () and not is_masked(value):
        value = value.item()
    if not isinstance(value, Real) or isinstance(value, bool):
        raise InvalidParameter(name, value, _of_a_type(value, allowed))
    try:
        result = float(value)
    except OverflowError:
        result = inf
    if not (isfinite(result) and result >= least and result > above):
        raise InvalidParameter(name, value, allowed)
    return result


def _of_a_type(value: Any, allowed: str) -> str:
    return f'{allowed}, not {"None" if value is None else "of type " + type(value).__name__}'


def array(name: str, value: Any, with_complex: bool = False) -> Array:
    """
    Return real numbers as an array of doubles; masked ones as NaN.

    With ``with_complex``, complex ones (of a complex step) as an array of complex doubles.

    Raises
    ------
    InvalidParameter

    """
    if isinstance(value, np.ma.MaskedArray):
        masked: Any = value
        value = (masked.astype(complex if value.dtype.kind == 'c' else float).filled(np.nan)
                 if value.dtype.kind in 'iufc' else value.data)
    try:
        given = np.asarray(value)
    except ValueError:     # rows of unlike length
        raise InvalidParameter(name, value, 'must be numbers in rows of equal length') from None
    if given.dtype.kind == 'c' and with_complex:
        return given.astype(np.complex128, copy=False)
    if given.dtype.kind not in 'iuf' and given.size:
        what = (f'of type {given.dtype}' if given.dtype.kind != 'O'
                else _first_that_is_no_number(given))
        raise InvalidParameter(name, value, f'must be real numbers, not {what}')
    return given.astype(np.float64, copy=False)


def _first_that_is_no_number(given: Array) -> str:
    """Return the type of an object in an array, as text: of the first that is no number."""
    for item in given.flat:
        if not isinstance(item, Real) or isinstance(item, bool):
            return 'None' if item is None else f'of type {type(item).__name__}'
    return 'of type object'


def records(name: str, value: Any, kind: type, whole: Any) -> Any:
    """
    Return several records of one kind as ``whole``, a NamedTuple of as many fields.

    Raises
    ------
    InvalidParameter

    """
    given = tuple(value) if isinstance(value, Iterable) else ()
    if len(given) != len(whole._fields) or not all(isinstance(item, kind) for item in given):
        raise InvalidParameter(name, value,
                               f'must be {whole.__name__}({", ".join(whole._fields)}), each of '
                               f'type {kind.__name__}')
    return whole(*given)
