# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Taylor models contain what they stand for: beside mpmath, and beside series of balls."""
from fourbar_ros import load_scene
from fourbar_ros.numerics.number_types import converted
from fourbar_ros.numerics.taylor_models import constant, inputs, Model, ORDER, TAYLOR_MODELS
import mpmath as mp
import numpy as np
import pytest

n, DIGITS = TAYLOR_MODELS, 40
MACHINES = ('andrews', 'bucket', 'jansen', 'quick_return', 'stephenson', 'v_engine', 'watt')


def off(value, piece, t, truth):
    """Return by how much a model misses the truth at t of a piece, over its error: at most 1."""
    c = value.c[:, min(piece, value.c.shape[1] - 1)]
    error = value.error[min(piece, value.error.size - 1)]
    if not np.isfinite(error) or not np.isfinite(c).all():
        return 0
    missed = abs(mp.polyval([mp.mpf(x) for x in c[::-1]], t) - truth)
    return missed / mp.mpf(error) if missed else 0


# Each: of models, of complex numbers of many digits.
UNARY = (('sin', n.sin, mp.sin), ('cos', n.cos, mp.cos), ('sqrt', n.sqrt, mp.sqrt),
         ('inverse', lambda v: 1.0 / v, lambda v: 1 / v), ('cube', lambda v: v**3, lambda v: v**3),
         ('negative', lambda v: -v, lambda v: -v), ('third', lambda v: v / 3.0, lambda v: v / 3))
BINARY = (('add', lambda a, b: a + b), ('sub', lambda a, b: a - b), ('mul', lambda a, b: a * b),
          ('div', lambda a, b: a / b))


def expression(rng, depth):
    """Return a random function of (functions, x), for both number types."""
    kind = rng.integers(5) if depth else rng.integers(2)
    if kind == 0:
        return lambda exact, x: x
    if kind == 1:
        value = float(rng.normal())
        return lambda exact, x: mp.mpf(value) if exact else constant(value)
    one = expression(rng, depth - 1)
    if kind in (2, 3):
        other, (_, function) = expression(rng, depth - 1), BINARY[rng.integers(len(BINARY))]
        return lambda exact, x: function(one(exact, x), other(exact, x))
    _, model_of, exact_of = UNARY[rng.integers(len(UNARY))]
    return lambda exact, x: (exact_of if exact else model_of)(one(exact, x))


def points(rng, middle, radius, count):
    """Return (t, x) of a disc, some at its edge."""
    for _ in range(count):
        t = mp.expjpi(rng.uniform(-1, 1)) * min(1.0, 1.3 * rng.random())
        yield t, mp.mpf(middle) + mp.mpf(radius) * t


def test_models_contain_random_expressions():
    """On the whole disc: what lies outside would make derivatives wrong."""
    rng, known, worst = np.random.default_rng(4), 0, 0
    with mp.workdps(DIGITS), np.errstate(all='ignore'):
        for _ in range(60):
            function = expression(rng, 5)
            low = rng.uniform(-3.0, 3.0, 3)
            x, radius = inputs(low, low + 10.0**rng.uniform(-9.0, 0.0, 3))
            try:
                value = function(False, x) + 0.0 * x
            except ZeroDivisionError:
                continue
            for piece in range(3):
                if value.error.size > 1 and np.isfinite(value.error[piece]):
                    known += 1
                    for t, at in points(rng, x.c[0, piece], radius[piece], 6):
                        worst = max(worst, off(value, piece, t, function(True, at)))
    assert known > 60 and worst <= 1


@pytest.mark.parametrize('width', [1e-6, 0.05, 0.4])
def test_models_of_angles_lengths_and_sums(width):
    rng, worst = np.random.default_rng(7), 0
    low = np.array((-3.0, -0.2, 2.8, 0.7))
    with mp.workdps(DIGITS):
        x, radius = inputs(low, low + width)
        length, angle = n.hypot(n.cos(x), 2.0 * n.sin(x)), n.atan2(2.0 * n.sin(x), n.cos(x))
        total = n.exact_sum((constant(0.1), constant(0.2), -0.3)) + 0.0 * x
        for piece in range(4):
            middle = mp.mpf(x.c[0, piece])
            base = mp.atan2(2 * mp.sin(middle), mp.cos(middle))
            for t, at in points(rng, middle, radius[piece], 20):
                c, s = mp.cos(at), 2 * mp.sin(at)
                turned = (c + 1j * s) * mp.expj(-base), (c - 1j * s) * mp.expj(base)
                truth = base + (mp.log(turned[0]) - mp.log(turned[1])) / 2j
                worst = max(worst, off(length, piece, t, mp.sqrt(c * c + s * s)),
                            off(angle, piece, t, truth), off(total, piece, t, mp.mpf(0.1)
                                                             + mp.mpf(0.2) - mp.mpf(0.3)))
    assert worst <= 1 and np.isfinite(angle.error).all()


@pytest.mark.parametrize('name', MACHINES)
def test_models_contain_motion_and_loads_of_machines(name):
    """Beside Taylor's coefficients in balls of 200 bits, at points of the pieces."""
    flint = pytest.importorskip('flint')
    from fourbar_lab.studies.boxes import precision
    from support.arb_series import ARB_SERIES, Series, series_of
    machine = load_scene(name).linkage
    (low, high), rng = machine.stroke or (-3.0, 3.0), np.random.default_rng(1)
    at = rng.uniform(low, high - 0.02 * (high - low), 8)
    x, radius = inputs(at, at + 0.01 * (high - low))
    with_loads = machine.bodies is not None

    def fields(numbers, number, position):
        constants = converted(machine.constants, number)
        motion = machine.motion_formula(numbers, constants)(position, number(3.0), number(2.0))
        loads = with_loads and machine.loads_formula(numbers, constants)
        return [*motion, *(loads(motion) if loads else ())]

    with np.errstate(all='ignore'):
        models = fields(n, constant, x)
    names = [*machine.MOTION._fields, *(machine.LOADS._fields if with_loads else ())]
    with precision(200):
        for piece, t in enumerate(rng.uniform(-0.8, 0.8, at.size).tolist()):
            place = flint.arb(x.c[0, piece]) + flint.arb(radius[piece]) * flint.arb(t)
            for field, one, other in zip(names, models, fields(
                    ARB_SERIES, flint.arb, Series(flint.arb_series([place, 1])))):
                one = one if isinstance(one, Model) else constant(one)
                error = float(one.error[piece % one.error.size])
                if 'theta' in field or 'angle' in field or not np.isfinite(error):
                    continue        # angles are left out of the series
                value, truth = flint.arb(0), series_of(other)[0]
                for c in one.c[::-1, piece % one.c.shape[1]].tolist():
                    value = value * flint.arb(t) + flint.arb(c)
                assert abs(value - truth).upper() <= flint.arb(error), (field, piece)


def test_where_nothing_is_known_the_error_is_infinite():
    x, _ = inputs(np.array((-0.1, 0.5)), np.array((0.2, 0.6)))
    with np.errstate(all='ignore'):
        for value in (1.0 / x, x.root(), (1.0 / x) * x, n.atan2(x, 0.0 * x)):
            assert not np.isfinite(value.error[0]) and np.isfinite(value.error[1])
        assert not np.isfinite((0.0 / x).error[0]) or (0.0 / x).is_zero


def test_the_least_of_several_is_known_only_where_it_is_one_of_them():
    x, _ = inputs(np.array((-0.5, 0.05, 0.5)), np.array((-0.4, 0.2, 0.6)))
    size, value = n.least([(0.1 + 0.0 * x, 1.0 * x), (x * 1.0, 2.0 * x)])
    assert np.isfinite(value.error).tolist() == [True, False, True]
    assert value.c[1] == pytest.approx([2.0 * x.c[1, 0], value.c[1, 1], x.c[1, 2]])


def test_models_refuse_what_has_no_derivative():
    x, _ = inputs(np.array((0.5,)), np.array((0.6,)))
    for refused in (lambda: abs(x), lambda: x > 0.0, lambda: x**0.5, lambda: np.tan(x),
                    lambda: np.maximum(x, 1.0)):
        with pytest.raises(TypeError):
            refused()
    assert len((np.float64(2.0) * np.sqrt(x) + 1).c) == ORDER + 1
