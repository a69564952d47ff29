# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Taylor models: functions over many pieces of the input at once, a number type that is certain.

About the middle m of a piece, x = m + radius t, a function is

    (T1)  f(t) = c_0 + c_1 t + ... + c_n t^n + r(t),   |r_0| + |r_1| + ... <= error

with numbers r_k of which only this is known. The sum of the sizes of all coefficients is a norm
with ||f g|| <= ||f|| ||g|| (Wiener's algebra). For approximations q and w it gives

    (T2)  1/g:      d = ||1 - q g||,     ||1/g - q|| <= ||q|| d / (1 - d)
    (T3)  sqrt(g):  d = ||1 - g w w||,   ||sqrt(g) - g w|| <= ||g w|| d / (2 (1 - d))

and for the angle of (x, y), turned by about itself to (u, v), arctan(v/u) has Taylor's series.
Arithmetic is that of doubles: what each operation rounds is added to its error, which itself is
raised by more than its own rounding. An error that is not finite says that nothing is known:
the piece is too wide, or reaches a pole.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from math import fsum
from typing import Any, Union

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import NumberType, Scalar
import numpy as np

ORDER = 10                    # n
# What a model is computed with: another one, or a number.
Operand = Union['Model', Scalar]
# What one operation on doubles rounds; more than errors round; than what underflows.
UNIT, UP, TINY = 2.0**-53, 1.0 + 2.0**-40, 1e-280
REACH = 1.25                  # of the disc |t| <= 1, over the piece
BITS = 120                    # of sines and cosines of middles, in whole numbers


class Model:
    """
    A function over n pieces, (T1); numpy functions like ``np.sqrt`` find its methods.

    ``c``: coefficients, shape (ORDER + 1, n), or (1, 1) of a constant; ``error``: (n,), or (1,).
    """

    def __init__(self, c: Array, error: Array) -> None:
        self.c, self.error = c, error

    @cached_property
    def tails(self) -> Array:
        """Return, for each k, the bound |c_k| + |c_k+1| + ... of the part from t^k on."""
        return np.cumsum(np.abs(self.c[::-1]), axis=0)[::-1]

    @cached_property
    def weight(self) -> Array:
        """Return the sum of (k + 1) |c_k|: each coefficient k of a product sums k + 1 terms."""
        return np.asarray(self.tails.sum(axis=0))

    @property
    def norm(self) -> Array:
        """Return a bound of the function on the disc |t| <= 1."""
        return np.asarray((self.tails[0] + self.error) * UP)

    @property
    def real(self) -> Middle:
        """Return the value in the middle, to choose between forms that are both right."""
        return Middle(self.c[0])

    @property
    def is_zero(self) -> bool:
        """Return whether it is zero everywhere, exactly."""
        return len(self.c) == 1 and not (self.c.any() or self.error.any())

    @property
    def is_one(self) -> bool:
        """Return whether it is one everywhere, exactly."""
        return len(self.c) == 1 and not ((self.c != 1.0).any() or self.error.any())

    def __array_ufunc__(self, ufunc: Any, method: str, *values: Any, **_: Any) -> Any:
        """Return np.sqrt(model) and the like, which numpy asks for by this method."""
        function = _OF_NUMPY.get(ufunc.__name__)
        return function(*map(model, values)) if function and method == '__call__' else (
            NotImplemented)

    def __lt__(self, other: Operand) -> bool:
        return bool((self - other)._alone() < 0.0)

    def __gt__(self, other: Operand) -> bool:
        return bool((self - other)._alone() > 0.0)

    def _alone(self) -> float:
        """Return the value of a constant; functions are compared by their middles, not whole."""
        if self.c.size > 1:
            raise TypeError('functions are not compared')
        return float(self.c[0, 0])

    def __neg__(self) -> Model:
        return Model(-self.c, self.error)

    def __add__(self, other: Operand) -> Model:
        """Return the sum; its error is that of both, and the rounding of the coefficients."""
        other = model(other)
        one, two = (self, other) if len(self.c) >= len(other.c) else (other, self)
        if two.is_zero:
            return one
        if len(two.c) == len(one.c):
            c = one.c + two.c
        else:
            c = one.c.copy()
            c[0] += two.c[0]
        return _rounded(c, one.error + two.error)

    __radd__ = __add__

    def __sub__(self, other: Operand) -> Model:
        return self + -model(other)

    def __rsub__(self, other: Operand) -> Model:
        return -self + other

    def __mul__(self, other: Operand) -> Model:
        """Return the product; its part beyond t^ORDER goes into the error, as does rounding."""
        other = model(other)
        if len(self.c) < len(other.c):
            return other * self
        if other.is_zero or self.is_zero:
            return ZERO
        error = (self.tails[0] * other.error + other.norm * self.error) * UP
        if len(other.c) == 1:
            return _rounded(other.c * self.c, error)
        lost = (np.abs(self.c[1:]) * other.tails[:0:-1]).sum(axis=0)
        # coefficient k is a sum of k + 1 products
        return _rounded(_product(self.c, other.c, ORDER + 1), error + lost,
                        self.weight * other.tails[0] + self.tails[0] * other.weight)

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> Model:
        return self if model(other).is_one else self * model(other).inverse()

    def __rtruediv__(self, other: Operand) -> Model:
        return self.inverse() * other

    def __pow__(self, exponent: int) -> Model:
        """Return a whole power, by repeated multiplication."""
        if not isinstance(exponent, int):
            raise TypeError(f'{exponent!r} is no whole exponent')
        if exponent < 0:
            return self.inverse()**-exponent
        power = ONE
        for _ in range(exponent):
            power = self * power
        return power

    def inverse(self) -> Model:
        """Return 1/g of a model g by Newton's method, with the error by (T2)."""
        q, count = 1.0 / self.c[:1], 1
        while count < len(self.c):
            count = min(2 * count, len(self.c))
            rest = -_product(self.c[:count], q, count)
            rest[0] += 2.0
            q = _product(q, rest, count)
        found = Model(q, np.zeros(1))
        return found._with_rest(found.tails[0], (ONE - self * found).norm)

    def sqrt(self) -> Root:
        """Return its root."""
        return Root(self)

    def root(self) -> Model:
        """Return sqrt(g) as g w, w near 1/sqrt(g) by Newton's method, with the error by (T3)."""
        if self.is_zero:
            return self
        w, count = 1.0 / np.sqrt(self.c[:1]), 1
        while count < len(self.c):
            count = min(2 * count, len(self.c))
            rest = -_product(self.c[:count], _product(w, w, count), count)
            rest[0] += 3.0
            w = 0.5 * _product(w, rest, count)
        inverse = Model(w, np.zeros(1))
        found = self * inverse
        return found._with_rest(0.5 * found.norm, (ONE - found * inverse).norm)

    def _with_rest(self, size: Array, d: Array) -> Model:
        """Return itself with size d / (1 - d) more error, as (T2) and (T3) say; inf if d > 1/2."""
        rest = np.where(d < 0.5, size * d / (1.0 - d), np.inf)
        return Model(self.c, (self.error + rest) * UP**2 + TINY)

    def sin(self) -> Model:
        """Return its sine."""
        return self._turned()[1]

    def cos(self) -> Model:
        """Return its cosine."""
        return self._turned()[0]

    def _turned(self) -> tuple[Model, Model]:
        """Return cosine and sine: of the middle, to 2^-53, turned by the series of the rest."""
        rest = self - Model(self.c[:1], np.zeros(1))
        cosine, sine = _cosine_and_sine(self.c[0])
        cos, sin = _series(rest * rest, _COSINE), rest * _series(rest * rest, _SINE)
        return cosine * cos - sine * sin, sine * cos + cosine * sin


class Later(Model):
    """A model made when it is calculated with."""

    def __init__(self, make: Callable[[], Model]) -> None:
        self._make = make

    @cached_property
    def _made(self) -> Model:
        return self._make()

    @property
    def c(self) -> Array:       # type: ignore[override]  # made when asked for
        """Return the coefficients."""
        return self._made.c

    @property
    def error(self) -> Array:   # type: ignore[override]  # made when asked for
        """Return the error."""
        return self._made.error


class Root(Later):
    """
    The root of a model.

    It has its extrema where its square has them: also where that is zero and the root has a kink,
    as the magnitude of a force along one line has where the force changes its sense.
    """

    def __init__(self, square: Model) -> None:
        super().__init__(square.root)
        self.square = square


class Middle:
    """Values in the middles of pieces: formulas compare them."""

    def __init__(self, at: Array) -> None:
        self.at = at

    def __lt__(self, other: Operand) -> Array:
        return np.asarray(self.at < _middle(other))

    def __gt__(self, other: Operand) -> Array:
        return np.asarray(self.at > _middle(other))


def _middle(value: Operand | Middle) -> Scalar | Array:
    return value.at if isinstance(value, Middle) else value.c[0] if isinstance(
        value, Model) else value


def constant(value: float, error: float = 0.0) -> Model:
    """Return a constant."""
    return Model(np.array([[float(value)]]), np.array([error]))


def model(value: Operand) -> Model:
    """Return a number as a model."""
    return value if isinstance(value, Model) else constant(value)


ZERO, ONE = constant(0.0), constant(1.0)


def inputs(low: Array, high: Array) -> tuple[Model, Array]:
    """
    Return the model of x over n pieces [low, high], and the radii of their discs, (n,).

    The discs are REACH times wider than the pieces: there errors of derivatives can be bounded.
    """
    middle = 0.5 * (low + high)
    radius = (np.maximum(high - middle, middle - low) + 2.0**-49 * np.abs(middle)) * REACH * UP
    c = np.zeros((ORDER + 1, middle.size))
    c[0], c[1] = middle, radius
    return Model(c, np.zeros(middle.size)), radius


def _rounded(c: Array, error: Array, size: Array | None = None) -> Model:
    """Return a model of new coefficients, their rounding of UNIT * ``size`` added to its error."""
    rounded = Model(c, error)
    rounded.error = (error + UNIT * (rounded.tails[0] if size is None else size)) * UP + TINY
    return rounded


def _product(a: Array, b: Array, count: int) -> Array:
    """Return the first ``count`` coefficients of a product of series, shape (count, n)."""
    product = np.zeros((count, max(a.shape[1], b.shape[1])))
    for k in range(min(count, len(a))):
        width = min(count - k, len(b))
        product[k:k + width] += a[k] * b[:width]
    return product


# Of cos(z), sin(z)/z and atan(z)/z in z^2; the last number bounds the next one.
_COSINE = [1.0]
_SINE = [1.0]
_ARCTAN = [(-1.0)**k / (2 * k + 1) for k in range(14)]
for _k in range(1, 12):
    _COSINE.append(-_COSINE[-1] / ((2 * _k - 1) * 2 * _k))
    _SINE.append(-_SINE[-1] / (2 * _k * (2 * _k + 1)))


def _series(square: Model, coefficients: Sequence[float]) -> Model:
    """
    Return a power series in ``square``, where the norm of that is below 1/2; else error inf.

    Later coefficients are no larger than the last one, so twice its term bounds what is left out.
    """
    *terms, last = coefficients
    total, size = ZERO, square.norm
    for term in reversed(terms):
        total = total * square + constant(term, 64 * UNIT * abs(term))
    rest = np.where(size < 0.5, 2.0 * abs(last) * size**len(terms), np.inf)
    return total + Model(ZERO.c, rest * UP)


def _cosine_and_sine(angles: Array) -> tuple[Model, Model]:
    """Return cosines and sines of floats, as constants of each piece."""
    rows = [_in_whole_numbers(angle) for angle in angles.tolist()]
    error = np.full(len(rows), 2.0**-53)
    cosine, sine = [Model(np.array([row]), error) for row in zip(*rows)]
    return cosine, sine


def _in_whole_numbers(angle: float) -> tuple[float, float]:
    """
    Return cosine and sine of a float, each wrong by 2^-53 at most: a proof needs such a bound.

    By Taylor's series in whole numbers of 120 binary places; libm promises nothing. NaN for an
    angle beyond 32 rad, where too many places would cancel.
    """
    if not abs(angle) < 32.0:
        return np.nan, np.nan
    over, under = angle.as_integer_ratio()
    x = (over << BITS) // under
    sums, term, k = [0, 0, 0, 0], 1 << BITS, 0
    while term:
        sums[k % 4] += term
        k += 1
        term = term * x // (k << BITS) if term * x >= 0 else -(-term * x // (k << BITS))
    return (sums[0] - sums[2]) / (1 << BITS), (sums[1] - sums[3]) / (1 << BITS)


def _angle(y: Operand, x: Operand) -> Model:
    """Return the angle of (x, y): continuous over a piece, near its value in the middle."""
    return Later(lambda: _angle_of(model(y), model(x)))


def _angle_of(y: Model, x: Model) -> Model:
    """Return the angle in the middle plus arctan(v/u) of the vector turned back by that."""
    middle = np.atleast_1d(np.arctan2(y.c[0], x.c[0]))
    cosine, sine = _cosine_and_sine(middle)
    u, v = x * cosine + y * sine, y * cosine - x * sine
    tangent = v * u.inverse()
    return tangent * _series(tangent * tangent, _ARCTAN) + Model(middle[None], np.zeros(1))


def _hypot(x: Operand, y: Operand) -> Root:
    return Root(model(x) * x + model(y) * y)


def _fabs(v: Operand) -> Model:
    """Return |v|; of a model by its middle, for forms that are right whatever the sign."""
    v = model(v)
    size: Model = _where(v.real < 0.0, -v, v)
    return size


def _where(condition: bool | Array, one: Any, other: Any) -> Any:
    """Return one of two models, piece by piece; of tuples, model by model."""
    if isinstance(condition, (bool, np.bool_)):
        return one if condition else other
    if isinstance(one, tuple):
        return tuple([_where(condition, a, b) for a, b in zip(one, other)])
    one, other = model(one), model(other)
    if condition.all():
        return one
    if not condition.any():
        return other
    zero = Model(np.zeros((ORDER + 1, condition.size)), np.zeros(condition.size))
    one, other = one + zero, other + zero      # constants as functions over all pieces
    return Model(np.where(condition, one.c, other.c), np.where(condition, one.error, other.error))


def _exact_sum(terms: Sequence[Operand]) -> Model:
    """Return the sum of constants, as lengths are, rounded once."""
    models = [model(term) for term in terms]
    return constant(value := fsum(one.c[0, 0] for one in models),
                    sum(float(one.error[0]) for one in models) * UP + 2.0**-52 * abs(value))


_OF_NUMPY: dict[str, Callable[..., Any]] = {
    'sqrt': Model.sqrt, 'sin': Model.sin, 'cos': Model.cos, 'arctan2': _angle, 'hypot': _hypot,
    'square': lambda v: v * v, 'negative': Model.__neg__, 'add': Model.__add__,
    'subtract': Model.__sub__, 'multiply': Model.__mul__, 'divide': Model.__truediv__}


class _Certain(NumberType):
    """Taylor models know nothing where they cannot tell which of several functions is least."""

    def least(self, pairs: Sequence[tuple[Any, Any]]) -> tuple[Any, Any]:
        """Return the pair whose first is least; error inf where another may be as small."""
        size, value = super().least(pairs)
        chosen = np.argmin(np.stack(np.broadcast_arrays(*[one.c[0] for one, _ in pairs])), axis=0)
        unsure = np.zeros(chosen.size)
        for i, (one, _) in enumerate(pairs):
            for other, _ in (*pairs[:i], *pairs[i + 1:]):
                apart = other - one
                unsure[(chosen == i) & ~(2.0 * apart.c[0] > apart.norm)] = np.inf
        return size, value + Model(ZERO.c, unsure)


TAYLOR_MODELS = _Certain(
    'Taylor models', lambda v: model(v).sin(), lambda v: model(v).cos(), lambda v: model(v).sqrt(),
    _angle, _hypot, _fabs, _where, _exact_sum, lambda *lengths: 1.0, 0.0)
