# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Proof on demand: what is proved, what is not, and that a missing extremum is noticed."""
from contextlib import suppress
from itertools import islice
import re
import sys

from fourbar_ros import (
    Bodies,
    Body,
    FourBar,
    InvertedSlider,
    JointFriction,
    load_scene,
    SliderCrank,
)
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import find_extrema, SAMPLES, Search
from fourbar_ros.extrema.proof import Enclosing, polynomial, slopes
from fourbar_ros.extrema.sampling import DIFFERENCE, Sampler
from fourbar_ros.mechanisms.elements import Attachment, PositionForce
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.quantities import positions, select
from fourbar_ros.numerics.arrays import EPS
import numpy as np
import pytest
from support.contract import with_rods
from support.random_machines import random_dyads, random_machines
from support.samples import more, record, some

from .test_pieces import elements_of, mechanism_of, scan_of

PAPER, TURN = (0.4, 1.2, 0.8, 1.0), 2.0 * np.pi
RATES = ('omega4', 'alpha4')
MASSES = Bodies(Body(1.0, cg_along=0.3, cg_across=0.1, inertia=0.02),
                Body(2.0, cg_along=0.4, cg_across=-0.1, inertia=0.03),
                Body(1.5, cg_along=0.2, cg_across=0.15, inertia=0.05))


def proofs(extrema):
    return {e.proof for e in extrema}


@pytest.mark.parametrize('lengths', [PAPER, (4.0, 2.0, 3.0, 5.5), (1.2, 0.5, 0.8, 1.0),
                                     (2.0, 4.0, 3.0, 5.0),
                                     (0.5, 0.9, 0.7, 0.5), (0.5, 0.4, 0.8, 0.5),
                                     (1.0, 0.3, 0.8, 1.0)])
@pytest.mark.parametrize('mode', [1, 2])
def test_rates_are_proved(lengths, mode):
    for text in proofs(find_extrema(FourBar(*lengths, mode=mode), RATES, 3.0, certify=True)):
        assert text.startswith('interval bounds')


@pytest.mark.parametrize('lengths, theta1',
                         [((1.0, 3.0, 5.0, 5.0), 0.0), ((3.0, 4.0, 5.0, 6.0), 0.0),
                          ((1.0, 3.0, 5.0, 3.0), np.pi)])
@pytest.mark.parametrize('mode', [1, 2])
def test_extrema_at_theta1_0_and_180_degrees_are_counted(lengths, theta1, mode):
    """There (a1 -+ a4)^2 = a3^2 - a2^2: the root lies at the end of the range of |A O4|."""
    linkage = FourBar(*lengths, mode=mode)
    found = find_extrema(linkage, 'omega4', certify=True)
    assert all(text.startswith('interval bounds') for text in proofs(found))
    assert sum(abs(np.remainder(e.theta1 - theta1 + 1.0, 2 * np.pi) - 1.0) < 1e-15
               for e in found) == round(linkage.period / (2 * np.pi))


@pytest.mark.parametrize('mechanism, quantity',
                         [(SliderCrank(0.1, 0.3, 0.02, bodies=MASSES), 'f43'),
                          (InvertedSlider(0.1, 0.3, 0.02, bodies=MASSES), 'f32')])
def test_magnitudes_of_forces_that_change_their_sense_are_proved(mechanism, quantity):
    """A force along one line: its magnitude has kinks where it is zero, all global minima."""
    found = find_extrema(mechanism, quantity, 3.0, 1.0, certify=True)
    assert proofs(found) == {'interval bounds'}
    zeros = [e for e in found if e.value == 0.0]
    assert len(zeros) == 2 and all(e.is_global and e.kind == 'minimum' for e in zeros)
    without = [e for e in find_extrema(mechanism, quantity, 3.0, 1.0, conditions=False)
               if e.value == 0.0]
    assert [e.is_global for e in without] == [True, True]


def test_no_proof_is_claimed_unless_asked():
    assert proofs(find_extrema(FourBar(*PAPER), RATES)) == {''}


def test_functions_are_proved_by_intervals():
    assert proofs(find_extrema(FourBar(*PAPER), lambda motion, loads: motion.theta4,
                               certify=True)) == {'interval bounds'}


def test_series_enclose_values_and_slopes_on_all_of_a_piece():
    """Against the formulas in floats, whose last bits are off by less than 1e-12."""
    for linkage in (with_rods(PAPER), load_scene('quick_return').linkage):
        quantities = select((), linkage)
        enclose, sampler = (kind(linkage, quantities, (3.0, 1.0)) for kind in (Enclosing, Sampler))
        for low, high in ((0.3, 0.31), (3.135, 3.145), (4.0, 4.01)):
            middle, series = enclose(low, high, range(len(quantities)))
            x = np.linspace(low, high, 9)
            for (i, c), value, slope in zip(series.items(), *sampler.sample(x)[:2]):
                if i in enclose.squares:
                    value, slope = value * value, 2.0 * value * slope
                for of_t, wanted in ((c, value), (slopes(c), slope)):
                    balls = [polynomial(of_t, at - middle) for at in x.tolist()]
                    off = np.abs([float(ball.mid()) for ball in balls] - wanted)
                    assert (off <= [float(ball.rad()) for ball in balls]
                            + 1e-11 * np.abs(wanted).max() + 1e-9).all(), quantities[i].name


def test_without_python_flint_nothing_is_proved_and_the_text_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, 'flint', None)
    found = find_extrema(with_rods(PAPER), ('omega4', 'f41'), 25.0, certify=True)
    assert proofs(found) == {'not proved: needs python-flint (pip install python-flint)'}


def test_what_cannot_be_proved_says_why():
    constant = find_extrema(with_rods((1.0, 2.0, 1.0, 2.0)), ('omega4', 'f41'), certify=True)
    assert all('not proved: constant in a range' in text for text in proofs(constant))


def test_a_function_without_enclosures_is_not_proved():
    text, = proofs(find_extrema(FourBar(*PAPER), lambda motion, loads: abs(motion.omega4),
                                certify=True))
    assert text.startswith('not proved: the function does not work on enclosures')


@pytest.mark.parametrize('quantity', ['alpha4', 'driving_torque'])
def test_a_missing_extremum_is_noticed(monkeypatch, quantity):
    search = Search.extrema
    monkeypatch.setattr(Search, 'extrema',
                        lambda *arguments: [part[1:] for part in search(*arguments)])
    number = len(find_extrema(with_rods(PAPER), (quantity,), 25.0)) + 1
    text, = proofs(find_extrema(with_rods(PAPER), (quantity,), 25.0, certify=True))
    assert text == f'not proved: {number - 1} found, {number} exist'


def test_only_what_is_missing_is_searched_for_again_where_the_proof_says_it_is(monkeypatch):
    """The search of one quantity forgets at first, that of the other the second time."""
    linkage, names = with_rods(PAPER), ('f41', 'f32')
    right, search, calls = find_extrema(linkage, names, 25.0), Search.extrema, []

    def forgetful(*arguments):
        found, row = search(*arguments), len(calls)
        calls.append(arguments)
        return [part[1:] if k == row else part for k, part in enumerate(found)]

    monkeypatch.setattr(Search, 'extrema', forgetful)
    found = find_extrema(linkage, names, 25.0, certify=True)
    assert len(calls) == 2 and proofs(found) == {'interval bounds'}
    assert [(e.quantity, e.kind) for e in found] == [(e.quantity, e.kind) for e in right]
    for part in ('theta1', 'value', 'condition', 'value_condition'):
        np.testing.assert_allclose([getattr(e, part) for e in found],
                                   [getattr(e, part) for e in right], 1e-6)


def beside_a_toggle():
    """Return a machine whose reactions have three extrema within 2 per mille of a toggle."""
    dyads = (Dyad('a', 'RPR', Point('ground', 4.0, 1.0), Point('crank', 0.2, 0.1), ('a0', 'b0'),
                  offset=0.07),
             Dyad('b', 'RRP', Point('b0', 0.91, 0.206), Point('crank', 0.52, -0.582),
                  ('a1', 'b1'), length_1=0.686, direction_2=2.95, mode=1),
             Dyad('c', 'PRP', Point('b0', 0.6, 0.4), Point('b1', -0.4, -0.4), ('a2', 'b2'),
                  direction_1=-2.22, direction_2=-2.3))
    return Machine(dyads, bodies={'b2': Body(2.0)})


def test_a_narrow_pair_beside_a_toggle_is_found_without_a_proof():
    """Against samples, 1e-6 rad apart: a maximum is quadratic, so the value is off by little."""
    machine = beside_a_toggle()
    x = machine.input_ranges[0][0] + 1e-6 * np.arange(500, 20_000)
    base = machine.step(x, 1.0)[1].base
    turns = 1 + np.flatnonzero(np.diff(np.sign(np.diff(base))))
    found = [e for e in find_extrema(machine, ('base',)) if x[0] < e.theta1 < x[-1] and not e.side]
    assert len(found) == len(turns) == 4
    assert np.abs([e.theta1 for e in found] - x[turns]).max() <= 1e-6
    assert abs(found[1].value - base[turns[1]]) <= 1e-4 * found[1].value


@pytest.mark.parametrize('place', [-0.33, 0.5, 1.234, 2.0, 3.0])
def test_zeros_of_a_quantity_that_dips_below_zero_between_samples_are_no_extrema(place):
    """1 - cos(theta1 - place) - 1e-6 is least at the place; zeros 1.4e-3 rad away are none."""
    found = find_extrema(FourBar(*PAPER), lambda motion, loads: 1.0 - 1e-6 - np.cos(
        motion.theta1 - place))
    low, high = sorted(found, key=lambda e: e.value)
    assert len(found) == 2 and abs(low.value + 1e-6) < 4 * 2.0**-52
    # a slope has the rounding of two values over their distance; the second derivative is 1
    off = abs(np.remainder(low.theta1 - place + 1.0, 2.0 * np.pi) - 1.0)
    assert off < EPS / (DIFFERENCE * 2.0 * np.pi / SAMPLES)


@pytest.mark.slow
@pytest.mark.parametrize('seed', [1, 2, 3])
def test_searches_of_random_machines_find_what_their_proofs_find(seed):
    """Masses over six decades, up to three dyads."""
    rng, proved = np.random.default_rng(seed), 0
    for _ in range(12):
        machine = None
        while machine is None:
            dyads = random_dyads(rng, 'crank', int(rng.integers(1, 4)))
            bodies = {link: record(Body, 10.0**rng.uniform(-3.0, 3.0),
                                   *rng.uniform(-0.5, 0.5, 2).tolist(),
                                   10.0**rng.uniform(-4.0, 2.0)) for link in dyads[-1].links}
            with suppress(FourBarError):
                machine = Machine(dyads, bodies=bodies)
        methods = Search(machine, select((), machine), (1.0, 0.0))
        found = methods.extrema(False)
        for proof, part in zip(methods.prove(found, lambda share: None, 0.2), found):
            text = proof.verdict(part)
            proved += text.startswith('interval bounds')
            assert text.startswith('interval bounds') or proof.why_not, (machine, text)
    assert proved > 100


MACHINES = ('v_engine', 'andrews', 'bucket', 'jansen', 'quick_return', 'stephenson', 'watt')


def all_of(machine):
    """Return the methods for all quantities of a machine and what they find."""
    quantities = [*select((), machine), *[
        one for one in positions(machine, machine.input).values()
        if one.name != 'transmission_angle' or len(machine.stages) == 1]]   # a kink, else
    methods = Search(machine, quantities, (3.0, 0.0))
    return quantities, methods, methods.extrema(False)


@some('name', MACHINES, 1)
def test_quantities_of_machines_are_proved_and_wrong_lists_are_not(name):
    """One missing, one more, one of the other kind, at another place, of another value."""
    quantities, methods, found = all_of(load_scene(name).linkage)
    changed = 0
    for quantity, proof, parts in zip(quantities, methods.prove(found, lambda share: None, 60.0),
                                      found):
        text = proof.verdict(parts)
        if any(part.sense == 0 for part in parts):
            assert text == 'not proved: constant in a range'
        else:
            assert text.startswith('interval bounds'), (quantity.name, text)
            width = float(re.findall('places to (.*?) ', text + ', places to 2.4e-10 ')[0])
            for wrong in mutations(parts, width):
                changed += 1
                assert proof.verdict(wrong).startswith('not proved: '), quantity.name
                assert not proof.why_not
    assert changed > 50


def mutations(parts, width):
    """Yield lists of what was found, each with one thing wrong."""
    inside = [i for i, part in enumerate(parts) if part.side == 0]
    size = max((abs(part.value) for part in parts if np.isfinite(part.value)), default=0.0)
    for i in inside[:1] + inside[2:3]:
        before, part, after = parts[:i], parts[i], parts[i + 1:]
        yield before + after
        yield [*before, part, part, *after]
        yield [*before, part._replace(sense=-part.sense), *after]
        for x in (part.x + 3.0 * width, part.x - 3.0 * width, part.x + 0.5):
            yield [*before, part._replace(x=x), *after]
        if abs(part.value) > 0.05 * size:
            for value in (part.value * (1.0 + 1e-9), part.value * (1.0 - 1e-9), -part.value):
                yield [*before, part._replace(value=value), *after]


def test_the_least_of_several_angles_has_kinks_that_are_not_proved_smooth():
    """The transmission angle of the V engine is now that of one rod, now that of the other."""
    found = find_extrema(load_scene('v_engine').linkage, ('transmission_angle',), certify=True)
    text, = proofs(found)
    assert len(found) == 6 and text.startswith('not proved: a kink')


def test_a_proof_ends_when_its_time_is_over_and_says_where():
    text, = proofs(find_extrema(with_rods(PAPER), ('f41',), certify=True, seconds=1e-9))
    assert re.fullmatch(r'not proved: not decided in 1e-09 s, at theta1 = -?\d.*', text)


def test_a_proof_says_how_far_it_is_and_can_be_stopped():
    shares = []
    find_extrema(with_rods(PAPER), ('f41', 'f32'), certify=True, progress=shares.append)
    assert shares == sorted(shares) and shares[0] == 0.0 and shares[-1] == 1.0

    def stop():
        if calls.append(0) or len(calls) > 1:
            raise KeyboardInterrupt
    calls = []
    with pytest.raises(KeyboardInterrupt):
        find_extrema(with_rods(PAPER), ('f41',), certify=True, check=stop)


@some('seed', [3, 4], 1)
def test_proofs_of_random_machines_agree_with_scans(seed):
    """A scan may miss extrema, but has none that a proof has not."""
    proved, x = 0, np.linspace(-np.pi, np.pi, 20001)
    turning = (machine for machine, _ in random_machines(seed, 10**9, dyads=(1, 4), driver='crank')
               if machine.turns_fully)
    for machine in islice(turning, 1 if seed == 3 else 6):
        quantities, methods, found = all_of(machine)
        state = machine.motion(x, 3.0, 0.0), machine.step(x, 3.0, 0.0)[1]
        for quantity, proof, parts in zip(quantities, methods.prove(found, lambda _: None, 5.0),
                                          found):
            text = proof.verdict(parts)
            if text.startswith('not proved'):
                assert 'kink' in text or 'constant' in text, (quantity.name, text)
                continue
            proved += 1
            values = np.asarray(quantity.of(*state))
            values = np.unwrap(values) if quantity.unit == 'rad' else values
            rises = np.diff(values)
            clear = np.abs(rises) > 1e-11 * np.ptp(values) + 1e-13 * np.abs(values).max()
            signs = np.sign(rises[clear])
            count = int((signs != np.roll(signs, 1)).sum())
            assert count <= sum(part.sense != 0 for part in parts), quantity.name
    assert proved > 10


def with_couple(places, values, is_linear):
    """Return a four-bar of nearly no mass whose drive takes a couple over its input alone."""
    bodies = Bodies(*(Body(1e-12, inertia=1e-12),) * 3)
    return FourBar(*PAPER, bodies=bodies).with_elements(PositionForce(
        Attachment('crank'), ForceTable(places, values, True, is_linear), direction=None))


@pytest.mark.parametrize('places, values, is_linear, extrema', [
    # level at 2 and 4, the least between
    ([0.0, 2.0, 4.0, TURN], [0.0, 30.0, 30.0, 0.0], False, None),
    # jumps at 3: the largest torque is one-sided
    ([0.0, 2.0, 3.0, 3.0, 5.0, TURN], [0.0, 20.0, 50.0, -10.0, 5.0, 0.0], True,
     {-50.0, -20.0, 10.0}),
    ([0.0, 1.0, 2.5, TURN], [0.0, 40.0, -30.0, 0.0], True, {-40.0, 30.0})])
def test_peaks_of_tables_at_points_and_jumps_are_proved_and_wrong_ones_are_not(
        places, values, is_linear, extrema, monkeypatch):
    linkage = with_couple(places, values, is_linear)
    right = find_extrema(linkage, 'driving_torque', 1.0, certify=True)
    if extrema is None:         # on a plateau the mass alone tells, and a level side nothing
        assert proofs(right) == {text for text in proofs(right) if text.startswith('not proved')}
        return
    assert proofs(right) == {'interval bounds, except 9e-10 rad where pieces end, by both sides'}
    assert {min(extrema), max(extrema)} == {
        round(pick(one.value for one in right), 6) for pick in (min, max)}
    search = Search.extrema
    for k in range(len(right)):         # none of them may miss, nor have another value
        for change in ((lambda one: []), (lambda one: [one._replace(value=one.value + 1e-3)]),
                       (lambda one: [one._replace(sense=-one.sense)])):
            monkeypatch.setattr(Search, 'extrema', lambda *arguments: [
                part[:k] + change(part[k]) + part[k + 1:] for part in search(*arguments)])
            wrong = find_extrema(linkage, 'driving_torque', 1.0, certify=True)
            assert all(text.startswith('not proved') for text in proofs(wrong))


def test_the_largest_torque_between_two_points_of_a_table_is_proved():
    """A parabola of the mass on the straight lines of a table: no point of it is the peak."""
    linkage = with_rods(PAPER).with_elements(PositionForce(
        Attachment('crank'), ForceTable([0.0, 2.0, 4.0, TURN], [0.0, 3.0, -2.0, 0.0], True, True),
        direction=None))
    found = find_extrema(linkage, 'driving_torque', 25.0, certify=True)
    most = max(found, key=lambda one: one.value)
    assert min(abs(most.theta1 - point) for point in (0.0, 2.0, 4.0, TURN)) > 0.1
    x = np.linspace(0.0, TURN, 200_001)
    assert most.value >= linkage.loads(x, 25.0).driving_torque.max() * (1.0 - 1e-12)
    assert not most.proof.startswith('not proved')


@pytest.mark.parametrize('seed', range(more(5, 200)))
def test_proofs_of_random_tables_and_springs_agree_with_scans(seed):
    rng = np.random.default_rng(seed)
    mechanism = mechanism_of(rng)
    mechanism = mechanism.with_elements(*elements_of(rng, mechanism))
    names = ('shaking_force', mechanism.drive_load)
    extrema = find_extrema(mechanism, names, 3.0, certify=True, seconds=1.0)
    for name in names:
        of_name = [one for one in extrema if one.quantity == name]
        if any(one.proof.startswith('not proved') for one in of_name):
            continue
        low, high = (pick(one.value for one in of_name) for pick in (min, max))
        for _, values in scan_of(mechanism, name, 3.0):
            room = 1e-9 * (np.ptp(values) + np.abs(values).max())
            assert low - room <= values.min() and values.max() <= high + room


def test_what_is_not_enclosed_of_forces_says_so():
    linkage = with_rods(PAPER)
    user = linkage.with_elements(PositionForce(Attachment('output'), np.cos))
    rubbing = linkage.with_friction({'A': JointFriction(0.1, radius=0.01)})
    for mechanism, why in ((user, 'functions over a position are not enclosed'),
                           (rubbing, 'friction is not enclosed')):
        texts = proofs(find_extrema(mechanism, 'driving_torque', 3.0, certify=True))
        assert texts == {f'not proved: {why}'}
