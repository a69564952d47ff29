# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The measured rounding errors of a mechanism: its formulas with floats beside many digits."""
from collections.abc import Sequence
from decimal import Decimal, localcontext
import re

from fourbar_ros.mechanisms.evaluation import formula_of, trace_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.digits import in_decimals, MANY_DIGITS
from fourbar_ros.numerics.number_types import numbers_of
from fourbar_ros.numerics.trace import flat


def rounding_errors(mechanism: Mechanism, positions: Sequence[float], rate: float,
                    acceleration: float, with_loads: bool) -> dict[str, float]:
    """Return {field of motion or loads: its largest rounding error at some inputs}."""
    # Each over the largest size of the fields of its sort (all forces, all rates). Data and inputs
    # count as exact. Angles are left out: they are arc tangents of fields that are not.
    formula = formula_of(mechanism, with_loads)
    trace = trace_of(formula)
    indices = flat(trace.results)
    names = mechanism.MOTION._fields + (mechanism.LOADS._fields if with_loads else ())
    errors, largest = dict[str, float](), dict[str, float]()
    with localcontext(MANY_DIGITS):
        exact = in_decimals(trace, numbers_of(formula.data), indices)
        for position in positions:
            inputs = position, rate, acceleration
            loads = mechanism.loads(*inputs) if with_loads else ()
            results = (*mechanism.motion(*inputs), *loads)
            for name, index, value, right in zip(names, indices, results,
                                                 exact(*map(Decimal, inputs))):
                if trace.steps[index].operation != 'atan2' and right.is_finite():
                    errors[name] = max(errors.get(name, 0.0), abs(float(Decimal(value) - right)))
                    sort = _sort_of(name)
                    largest[sort] = max(largest.get(sort, 0.0), abs(value))
    return {name: error / (largest[_sort_of(name)] or 1.0) for name, error in errors.items()}


def _sort_of(name: str) -> str:
    """Return the letters with which the name of a field begins: f of f41_x, omega of omega4."""
    match = re.match('[a-z]*', name)
    return match[0] if match else ''
