# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The equation of motion: against loads, against energies with many digits, power balance."""
from dataclasses import replace

from fourbar_ros import Bodies, Body, FourBar, InvalidParameter, MissingBodies
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.mechanics.bodies import External, NOT_APPLIED
from fourbar_ros.mechanisms.elements import Attachment, GROUND, Spring, TorsionSpring
import mpmath as mp
import numpy as np
import pytest
from support import contract
from support.cartesian import EPS
from support.machines import exact_inertia, exact_potential, exact_stretch, random_elements
from support.samples import more


def sizes(mechanism, position, rate, acceleration):
    """Return the sum of the sizes of all terms of the torque, of each body and load alone."""
    total, nothing = 0.0, mechanism.BODIES(*[Body(0.0)] * len(mechanism.BODIES._fields))
    no_load = mechanism.EXTERNAL(*[NOT_APPLIED] * len(mechanism.EXTERNAL._fields))
    for name, body in mechanism.bodies._asdict().items():
        for kept in (replace(body, inertia=0.0), Body(0.0, inertia=body.inertia)):
            alone = replace(mechanism, bodies=nothing._replace(**{name: kept}), external=no_load)
            terms = Equation(alone).terms(position)
            total += abs(terms.inertia * acceleration) + abs(terms.half_slope) * rate**2
            total += abs(terms.force)
            total += terms.inertia * rate**2        # of which the slope is a difference
    for name, applied in mechanism.external._asdict().items():
        for change in ({'couple': 0.0}, {'force_x': 0.0, 'force_y': 0.0}):
            external = no_load._replace(**{name: replace(applied, **change)})
            alone = replace(mechanism, bodies=nothing, external=external)
            total += abs(Equation(alone).terms(position).force)
    return total


@contract.every_mechanism
def test_its_torque_is_the_driving_torque_of_the_loads(case, count=more(10, 60)):
    """Two formulations: virtual work of curves at unit rate, and Newton-Euler joint by joint."""
    for mechanism, given in contract.ordinary(case, 200, count):
        loads = mechanism.loads(*given)
        theirs = sum(getattr(loads, name, 0.0) for name in ('driving_torque', 'driving_force'))
        condition = 1.0 + mechanism.motion(given[0]).condition / mechanism.input_unit
        bound = 32.0 * EPS * condition**2 * sizes(mechanism, *given)
        equation = Equation(mechanism)
        assert abs(equation.torque(*given) - theirs) <= bound
        missing = equation.acceleration(*given[:2], theirs) - given[2]
        assert abs(missing) * equation.terms(given[0]).inertia <= 2.0 * bound


@contract.every_mechanism
def test_terms_are_derivatives_of_energies(case, count=more(1, 10)):
    rng = np.random.default_rng(210)
    for mechanism, (position, *_) in contract.ordinary(case, 210, count):
        elements = random_elements(rng, mechanism)
        terms = Equation(mechanism.with_elements(*elements), 0.3).terms(position)
        with mp.workdps(40):
            q = mp.mpf(position)
            step = {'h': mp.mpf(10)**-12}
            inertia = exact_inertia(mechanism, q) + mp.mpf(0.3)
            slope = mp.diff(lambda x: exact_inertia(mechanism, x), q, **step) / 2
            force = -mp.diff(lambda x: exact_potential(mechanism, elements, x), q, **step)
            damping = sum(e.damping * stretch_rate(mechanism, e, q, **step)**2 for e in elements)
            for ours, exact in zip(terms, (inertia, slope, force, damping)):
                assert abs(ours - exact) <= 1e-12 * (1 + abs(exact) + inertia)


def stretch_rate(mechanism, element, q, **step):
    return mp.diff(lambda x: exact_stretch(mechanism, element, x), q, **step)


@contract.every_mechanism
def test_arrays_give_what_single_values_give(case):
    rng = np.random.default_rng(220)
    for mechanism, (position, *_) in contract.ordinary(case, 221, 2):
        equation = Equation(mechanism.with_elements(*random_elements(rng, mechanism)), 0.1)
        positions = position + np.linspace(-1e-3, 1e-3, 50).reshape(5, 10) * mechanism.input_unit
        many = equation.terms(positions)
        for place in np.ndindex(positions.shape):
            one = equation.terms(float(positions[place]))
            for column, value in zip(many, one):
                assert abs(column[place] - value) <= 64 * EPS * (abs(value) + one.inertia)
        values, one = equation.potential(positions), float(positions[2, 3])
        assert values.shape == positions.shape
        assert values[2, 3] == pytest.approx(equation.potential(one), rel=1e-12)


def test_a_spring_of_no_length_and_no_free_length_pulls_nothing():
    """Its ends meet at q = 0, up to an infinitesimal: the force is k r.r', not 0/0."""
    bodies = Bodies(Body(1.0, cg_along=0.2, inertia=0.1), Body(0.0), Body(0.0))
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies)
    spring = Spring(Attachment(GROUND, 0.4), Attachment('crank', 0.4), 5.0)
    assert abs(Equation(linkage.with_elements(spring)).terms(0.0).force) <= 1e-70


@pytest.mark.parametrize('make, name', [
    (lambda: Spring(Attachment('crank'), Attachment('crank', 1.0)), 'second'),
    (lambda: TorsionSpring('crank', 'crank'), 'second'),
    (lambda: Spring(Attachment('crank'), Attachment(), stiffness=-1.0), 'stiffness'),
    (lambda: TorsionSpring(GROUND, 'crank', damping=float('nan')), 'damping'),
    (lambda: Attachment('crank', along='x'), 'along'),
    (lambda: Spring(Attachment(), Attachment('crank'), 1.0, free_length=-0.1), 'free_length'),
    (lambda: Equation(FourBar(0.4, 1.2, 0.8, 1.0), extra_inertia=-10.0), 'extra_inertia'),
    (lambda: Equation(None), 'mechanism'), (lambda: Equation('paper'), 'mechanism'),
])
def test_what_is_wrong_is_refused_by_name(make, name):
    with pytest.raises(InvalidParameter) as caught:
        make()
    assert caught.value.name == name


def test_an_unknown_link_and_missing_masses_are_errors():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    with pytest.raises(MissingBodies):
        Equation(linkage)
    linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=Bodies(*[Body(1.0)] * 3))
    with pytest.raises(InvalidParameter, match='crank, coupler, output, ground'):
        linkage.with_elements(TorsionSpring('crank', 'rod', 1.0))


def test_couples_are_the_part_of_the_force_without_a_potential():
    """A couple M on a link whose angle turns by b' for each radian of the crank gives M b'."""
    bodies = Bodies(*[Body(1.0, cg_along=0.1, inertia=0.1)] * 3)
    plain = FourBar(0.4, 1.2, 0.8, 1.0, bodies=bodies, gravity=(0.0, -9.81))
    for link, rate in (('coupler', 'omega_beta'), ('output', 'omega4')):
        on_link = External(**{link: replace(NOT_APPLIED, couple=5.0, force_x=3.0, along=0.2)})
        one, other = Equation(replace(plain, external=on_link)), Equation(plain)
        for q in (0.3, 2.0, 4.5):
            turn = getattr(plain.motion(q, 1.0), rate)
            assert one.terms(q).couples == pytest.approx(5.0 * turn, rel=1e-13)
            assert other.terms(q).couples == 0.0
            # Q less its couples is minus the slope of the potential, by a central difference
            slope = (one.potential(q + 1e-6) - one.potential(q - 1e-6)) / 2e-6
            assert one.terms(q).force - one.terms(q).couples == pytest.approx(-slope, abs=1e-7)
