# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What is given: every public function converts it to doubles or refuses it by name."""
import copy
from dataclasses import astuple, replace
from datetime import datetime
from decimal import Decimal
from fractions import Fraction
from math import inf, nan
import pickle

from fourbar_lab.drawing.figure import CannotDraw
from fourbar_ros import (
    Applied,
    Base,
    Body,
    flat_bar,
    FourBarError,
    InvalidParameter,
    load_scene,
    MissingBodies,
    OutOfRange,
    round_rod,
    Toggle,
)
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import BagError
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.elements import Attachment, Spring, TorsionSpring
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.quantities import (
    known_quantities,
    point_acceleration,
    point_speed,
    UnknownQuantity,
)
from fourbar_ros.scene.files import SceneError
from fourbar_ros.transmission import Transmission
import numpy as np
import pytest
from support import contract
from support.contract import every_input
from support.samples import record

FOUR_BAR = load_scene('paper').linkage
ODD = ['1.0', b'1', None, True, 1j, datetime(2020, 1, 1), np.datetime64('2020'), Decimal(1), [1.0],
       object(),
       np.array([1.0, 2.0]), np.ma.masked]
ARRAYS = [['1.0', '2.0'], [1.0, None], [None], [True, False], np.array(['2020'], 'M8[D]'),
          [[1.0], [1.0, 2.0]],
          [datetime(2020, 1, 1)], np.array([1, 2], 'm8[s]')]
WRONG = [
    ('gravity', -9.81), ('gravity', None), ('gravity', (0.0, nan)),
    ('gravity', 'xy'),
    ('bodies', [1, 2, 3]), ('bodies', 5), ('bodies', (Body(1.0), Body(1.0))), ('external', None),
    ('external', (1.0, 2.0)),
    ('mode', 3), ('mode', True), ('mode', None), ('mode', '2'), ('input', 'motor'),
    ('input', None), ('gravity', (0.0,))]
NUMBERS = (np.float32, np.float16, np.float64, np.longdouble, Fraction,
           lambda v: np.array(v, 'f4'))


def loaded(case, seed=600):
    """Return a mechanism with everything acting, and its input."""
    return next(contract.ordinary(case, seed, 1))


# --- numbers of other types ----------------------------------------------------------------------

@pytest.mark.parametrize('made', NUMBERS)
@every_input
def test_other_numbers_are_computed_with_as_doubles(case, made):
    """A float32 is the double it is equal to, not a precision to compute in."""
    rng = np.random.default_rng(600)
    lengths, given = contract.draw(rng, case)
    masses = contract.random_masses(rng, case, 1.0, 1.0)
    one, other = (case.make(map(to, lengths), {
        'bodies': [record(Body, *map(to, astuple(body))) for body in masses['bodies']],
        'external': [record(Applied, *map(to, astuple(push))) for push in masses['external']],
        'gravity': [*map(to, masses['gravity'])]}) for to in (made, lambda v: float(made(v))))
    assert one == other and all(type(v) is float
                                for v in (*one.lengths, *one.gravity, one.bodies.crank.mass))
    given = [made(v) for v in given]
    assert one.step(*map(float, given)) == other.step(*map(float, given))
    for part, expected in zip(one.step(*given), other.step(*map(float, given))):
        if isinstance(given[0], np.ndarray):       # an array without dimensions stays one
            assert all(value.shape == () and value.dtype == float for value in part)
            np.testing.assert_allclose(part, expected, rtol=1e-13, atol=1e-13)
        else:
            assert part == expected and all(type(value) is float for value in part)


@every_input
def test_other_arrays_are_computed_with_as_doubles(case):
    ones, larger = np.ones(3), (each.with_lengths([4.0 * length for length in each.lengths])
                                for each, _ in contract.ordinary(case, 600, 300))
    mechanism = next(each for each in larger
                     if any(low < 1.0 < high for low, high in each.input_ranges))
    expected = [field for part in mechanism.step(ones, 3.0) for field in part]
    for dtype in ('f2', 'f4', 'f8', 'i4', 'u1', '>f8', 'g'):
        found = [field for part in mechanism.step(ones.astype(dtype), 3.0) for field in part]
        for a, b in zip(found, expected):
            assert a.dtype == np.float64 and np.array_equal(a, b, equal_nan=True)


# --- refused -------------------------------------------------------------------------------------

@every_input
def test_what_is_no_number_or_cannot_be_is_refused_by_name(case):
    lengths, given = contract.draw(np.random.default_rng(217), case)
    for i, (length, is_signed) in enumerate(zip(case.kind.LENGTHS,
                                                contract.are_signed(case.kind))):
        for value in (*ODD, nan, inf, *(() if is_signed else (0.0, -1.0))):
            with pytest.raises(InvalidParameter, match=f'^{length.name}'):
                case.make([*lengths[:i], value, *lengths[i + 1:]])
    for name, value in [*WRONG, *(('gravity', (0.0, value)) for value in ODD)]:
        if name == 'mode' or name in case.kind.__dataclass_fields__:   # no four-bar has an input
            options = {'mode': case.mode} | ({'input': case.driven} if len(case.kind.INPUTS) > 1
                                             else {}) | {name: value}
            with pytest.raises(InvalidParameter, match=f'^{name}'):
                case.kind(*lengths, **options)
    mechanism = case.make(lengths)
    with pytest.raises(MissingBodies, match='mass'):
        mechanism.loads(*given)
    with pytest.raises(InvalidParameter, match=f'^{mechanism.input_coordinate[2]} = '):
        mechanism.motion(*given[:2], inf)


@pytest.mark.parametrize('make, given, names', [
    (Body, {'mass': 1.0}, ('mass', 'cg_along', 'cg_across', 'inertia')),
    (Applied, {}, ('force_x', 'force_y', 'along', 'across', 'couple')),
    (round_rod, {'length': 1.0, 'density': 1.0, 'radius': 0.1}, ('length', 'density', 'radius'))])
def test_what_is_no_number_is_refused_in_bodies_and_loads(make, given, names):
    for value in ODD:
        for name in names:
            with pytest.raises(InvalidParameter, match=f'^{name}'):
                make(**{**given, name: value})


@every_input
def test_lists_are_as_good_as_tuples(case):
    one, _ = loaded(case)
    other = replace(one, bodies=list(one.bodies), gravity=np.array(one.gravity),
                    external=list(one.external))
    assert one == other and hash(one) == hash(other) and one.mode is not True


@every_input
def test_inputs_that_are_no_numbers_are_refused(case):
    mechanism, given = loaded(case)
    for value in (*ARRAYS, '1.0', None, True, datetime(2020, 1, 1), Decimal(1), object()):
        for i, name in enumerate(mechanism.input_coordinate):
            for call in (mechanism.motion, mechanism.loads, mechanism.step):
                with pytest.raises(InvalidParameter, match=f'^{name}'):
                    call(*given[:i], value, *given[i + 1:])


@every_input
def test_angles_at_which_floats_are_radians_apart_are_refused(case):
    mechanism, (position, *rates) = loaded(case)
    if mechanism.is_driven_by_slide:
        return
    for value in (2.0**54, -1e17, 1e300):
        for call in (mechanism.motion, mechanism.loads, mechanism.step):
            with pytest.raises(InvalidParameter, match=f'^{mechanism.input_coordinate.position} '
                                                       '.*4 rad apart$'):
                call(value, *rates)
        with pytest.raises(InvalidParameter, match='^position .*apart$'):
            System(mechanism, value)
    with pytest.raises(InvalidParameter, match='^within .*apart$'):
        find_extrema(mechanism, within=(2.0**54, 2.0**54 + 4.0))
    motion, loads = mechanism.step([2.0**54, position], *rates)
    assert np.isfinite(loads.shaking_moment).tolist() == [False, True] and motion[0].size == 2
    on_base = mechanism.loads([2.0**54, position], *rates, base=Base(0.0, 9.81))
    assert np.isfinite(on_base.shaking_moment).tolist() == [False, True]


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(InvalidParameter, match=r'^theta1, omega1, alpha1 .*broadcast'):
        FOUR_BAR.motion(np.zeros(3), np.zeros(2))


SPRING = TorsionSpring('crank', 'ground', 5.0)


def test_elements_are_taken_from_whatever_gives_them():
    """A generator gave none: its elements were looked at, and gone."""
    for elements in ((SPRING,), [SPRING], iter([SPRING])):
        linkage = replace(FOUR_BAR, elements=elements)
        assert linkage.elements == (SPRING,)
    with pytest.raises(InvalidParameter, match='^elements: must be Spring'):
        replace(FOUR_BAR, elements=None)


@pytest.mark.parametrize(('make', 'why'), [
    (lambda: FOUR_BAR.with_lengths([0.4, 1.2]), '^lengths = .*as many as a1, a2, a3, a4'),
    (lambda: FOUR_BAR.with_lengths([0.4, 1.2, 0.8, 1.0, 2.0]), '^lengths = .*as many as a1'),
    # two numbers are a field of gravity: a base has its specific force, of the other sign
    (lambda: FOUR_BAR.with_base((0.0, 9.81)), '^base = .*must be a Base'),
    (lambda: FOUR_BAR.loads(1.0, base=(0.0, 9.81)), '^base = .*must be a Base'),
    (lambda: FOUR_BAR.loads([1.0], base=(0.0, 9.81)), '^base = .*must be a Base'),
    (lambda: FOUR_BAR.with_external({'coupler': Applied()}), '^external = .*External'),
    (lambda: FOUR_BAR.with_external(Applied()), '^external = .*External'),
    (lambda: FOUR_BAR.with_friction(['A']), '^friction = .*must be a mapping'),
    (lambda: Spring(Point('crank'), Attachment(), 1.0), '^first = .*of type Attachment'),
    (lambda: Spring(Attachment('crank'), 'ground', 1.0), '^second = .*of type Attachment'),
    (lambda: FOUR_BAR.with_elements(TorsionSpring(Attachment('crank'), Attachment(), 1.0)),
     '^link = .*one of crank, coupler')])
def test_other_records_are_refused_in_one_line(make, why):
    with pytest.raises(InvalidParameter, match=why) as refused:
        make()
    assert '\n' not in str(refused.value)


def test_other_functions_refuse_what_is_no_number():
    linkage = FOUR_BAR
    for name in ('rate', 'acceleration'):
        for value in ('1', None, 1j, nan, 1e160, -1e300):
            with pytest.raises(InvalidParameter, match=f'^{name}'):
                find_extrema(linkage, ('omega4', 'shaking_force'), **{name: value})
    with pytest.raises(InvalidParameter, match=r'^start = nan'):
        Transmission(linkage, nan)
    with pytest.raises(InvalidParameter, match=r"^driven = 'foo': must be one of crank"):
        known_quantities(linkage, 'foo')
    for make in (lambda: round_rod(1.0, 1.0, 1e160), lambda: flat_bar(1.0, 1.0, 1e160, 1.0)):
        with pytest.raises(InvalidParameter, match=r'^length, density, .*1e\+160.* overflows'):
            make()
    with pytest.raises(InvalidParameter, match='^linkage'):
        find_extrema('linkage')
    with pytest.raises(InvalidParameter, match='^along'):
        point_motion(linkage, linkage.motion(1.0), 'coupler', '0.2')


# --- masks, no samples, complex steps, overflow --------------------------------------------------

@every_input
def test_masked_samples_are_nan(case):
    mechanism, (x, _, _) = loaded(case)
    values = np.ma.masked_array([x, x, 1.001 * x], [False, True, False])
    for masked, plain in zip(mechanism.step(values, 3.0), mechanism.step(values.data, 3.0)):
        for a, b in zip(masked, plain):
            # hypot has another form beside NaN
            assert a[[0, 2]] == pytest.approx(b[[0, 2]], rel=1e-15)
    for masked in (values, values.astype(object)):
        assert np.isnan(mechanism.loads(masked, 3.0).f41).tolist() == [False, True, False]


@every_input
def test_no_samples_give_none(case):
    for empty in ([], np.zeros(0), np.zeros((0, 3)), np.zeros((2, 0))):
        for field in sum(loaded(case)[0].step(empty, 1.0), ()):
            assert field.shape == np.shape(empty) and field.dtype == np.float64


@every_input
def test_too_long_is_reported(case):
    lengths = loaded(case)[0].lengths
    for power in (1000, 1022, 1023):
        with pytest.raises(InvalidParameter, match='^a1.*shorter than'):
            case.make([2.0**power, *lengths[1:]])


# --- copies -----------------------------------------------------------------------------------

ERRORS = [FourBarError('text'), InvalidParameter('mass', -1.0, 'must not be'),
          InvalidParameter('mass', None, 'is missing'),
          OutOfRange('theta1', 3.0, ((-1.0, 1.0),), 'rad'), Toggle('slide', 2.0, 'm'),
          MissingBodies(), UnknownQuantity('x', ('y', 'z')),
          BagError('no bag'), SceneError('no scene'), CannotDraw('no picture')]


@pytest.mark.parametrize('again', [lambda v: pickle.loads(pickle.dumps(v)), copy.copy,
                                   copy.deepcopy])
def test_errors_and_objects_are_the_same_after_a_copy(again):
    for error in ERRORS:
        same = again(error)
        assert type(same) is type(error) and str(same) == str(error) and vars(same) == vars(error)
    for case in (*contract.CASES, contract.MACHINES):
        mechanism, given = loaded(case)
        result = mechanism.step(*given), mechanism.step(np.array(given), 1.0)
        find_extrema(mechanism, (mechanism.outputs[0].coordinate.rate,))     # fills its caches
        mechanism.input_ranges, getattr(mechanism, 'classification', None)
        same = again(mechanism)
        assert same != mechanism.with_lengths([2.0 * v for v in mechanism.lengths])
        assert (same == mechanism and hash(same) == hash(mechanism) and same.step(*given)
                == result[0])
        assert again(result[0]) == result[0]
        assert again(result[1][0])._fields == mechanism.MOTION._fields
        for make in (point_speed, point_acceleration):
            quantity = make(mechanism, mechanism.BODIES._fields[1], 0.2)
            assert again(quantity).of(*result[0]) == quantity.of(*result[0])
    extrema = find_extrema(FOUR_BAR, ('omega4',))
    assert repr(again(extrema)) == repr(extrema)
