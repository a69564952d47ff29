# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Linear forms: sums of unknowns times coefficients, and a constant, as numbers of a formula.

A formula that is linear in a number gives its coefficients if it takes the unknown itself.
"""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

CONSTANT = ''      # in place of an unknown


class LinearForm:
    """A linear form by {unknown: coefficient}; coefficients are numbers of any type."""

    __slots__ = ('by_unknown',)
    __array_ufunc__ = None       # arrays leave products with a form to the form

    def __init__(self, by_unknown: Mapping[str, Any]) -> None:
        self.by_unknown = by_unknown

    def coefficient(self, unknown: str) -> Any:
        """Return the coefficient of an unknown, or the constant, 0.0 if it is none."""
        return self.by_unknown.get(unknown, 0.0)

    def with_known(self, unknown: str, value: Any) -> LinearForm:
        """Return the form with a number or a form in place of an unknown."""
        rest = {name: value for name, value in self.by_unknown.items() if name != unknown}
        if len(rest) == len(self.by_unknown):
            return self
        known: LinearForm = form_of(value) * self.by_unknown[unknown]
        return LinearForm(rest) + known

    def __add__(self, term: Any) -> LinearForm:
        total = dict(self.by_unknown)
        for name, value in form_of(term).by_unknown.items():
            total[name] = total[name] + value if name in total else value
        return LinearForm(total)

    def __neg__(self) -> LinearForm:
        return LinearForm({name: -value for name, value in self.by_unknown.items()})

    def __sub__(self, term: Any) -> LinearForm:
        return self + -form_of(term)

    def __rsub__(self, term: Any) -> LinearForm:
        return (-self).__add__(term)

    def __mul__(self, factor: Any) -> LinearForm:
        return LinearForm({name: factor * value for name, value in self.by_unknown.items()})

    def __truediv__(self, divisor: Any) -> LinearForm:
        return LinearForm({name: value / divisor for name, value in self.by_unknown.items()})

    __radd__, __rmul__ = __add__, __mul__


def form_of(value: Any) -> LinearForm:
    """Return a number as a form without unknowns, a form itself."""
    return value if isinstance(value, LinearForm) else LinearForm({CONSTANT: value})
