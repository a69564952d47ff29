# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The paper in numpy (plain.py) and the library, which share no formula, beside each other."""
import subprocess
import sys

from fourbar_ros import CROSSED, find_extrema, FourBar, OPEN, plain, Toggle
import numpy as np
import pytest
from support.cartesian import EPS
from support.contract import crank_lengths, random_bodies, random_lengths

GRAVITY = (1.5, -9.5)
# of how many conditions an error of each order is a product: one for each division by sin(mu)
ORDERS = {'theta': 1, 'beta': 1, 'omega': 2, 'alpha': 3}


def differences(fields, ours, theirs):
    """Return {field: difference}; that of angles modulo a turn."""
    return {name: (np.angle(np.exp(1j * (getattr(ours, name) - getattr(theirs, name))))
                   if name.startswith(('theta', 'beta'))
                   else getattr(ours, name) - getattr(theirs, name)) for name in fields}


def test_motion_and_loads_are_those_of_the_library():
    """
    Random lengths, inputs, masses and weight, both modes, and theta1 = 0, +-pi/2, pi.

    Errors are some roundings times a condition, 1 + that of theta4, for each division by sin(mu):
    2.3 at most when this was written.
    """
    rng, compared = np.random.default_rng(8), 0
    for k, lengths in enumerate(random_lengths(rng, 400).tolist()):
        linkage = FourBar(*lengths, mode=(CROSSED, OPEN)[k % 2], gravity=GRAVITY,
                          bodies=random_bodies(rng))
        for theta1 in (rng.uniform(-9.0, 9.0), 0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi):
            given = theta1, rng.normal(), rng.normal()
            try:
                motion, loads = linkage.step(*given)
            except (ValueError, Toggle):
                assert not np.isfinite(plain.motion(lengths, *given, linkage.mode).omega4)
                continue
            if motion.condition > 100.0:
                continue
            compared += 1
            m = plain.motion(lengths, *given, linkage.mode)
            speed = max(abs(m.omega1), abs(m.omega4), abs(m.omega_beta))
            change = speed**2 + max(abs(m.alpha1), abs(m.alpha4), abs(m.alpha_beta))
            scale = {'theta': 1.0, 'beta': 1.0, 'omega': speed, 'alpha': change}
            for name, error in differences(m._fields, motion, m).items():
                order = name.split('_')[0].rstrip('1234')
                power = (1.0 + motion.condition)**ORDERS[order]
                assert abs(error) <= 16.0 * EPS * power * scale[order], (name, lengths, given)
            x = plain.loads(lengths, linkage.bodies, m, GRAVITY)
            reach, force = max(lengths), max(abs(each) for each in x[:8])
            for name, error in differences(x._fields, loads, x).items():
                arm = reach if name in ('driving_torque', 'shaking_moment') else 1.0
                assert abs(error) <= 16.0 * EPS * (1.0 + motion.condition)**3 * arm * force, name
    assert compared > 700


def test_arrays_are_single_values_side_by_side():
    lengths, theta1 = (0.4, 1.2, 0.8, 1.0), np.linspace(0.0, 6.0, 7)
    together = plain.motion(lengths, theta1, 25.0, 3.0)
    for k, x in enumerate(theta1):
        alone = plain.motion(lengths, float(x), 25.0, 3.0)
        assert all(np.broadcast_to(field, 7)[k] == value
                   for field, value in zip(together, alone))


@pytest.mark.parametrize('name', ['omega4', 'alpha4'])
def test_extrema_are_those_of_find_extrema(name):
    rng = np.random.default_rng(3)
    for lengths in [(0.4, 1.2, 0.8, 1.0), (2.0, 6.0, 7.0, 5.0),
                    *(crank_lengths(rng) for _ in range(20))]:
        for mode in (CROSSED, OPEN):
            library = find_extrema(FourBar(*lengths, mode=mode), (name,), 25.0)
            by_steps = plain.extrema(lengths, name, 25.0, mode)
            assert len(by_steps) == len(library)
            for (theta1, value), extremum in zip(by_steps, library):
                assert theta1 == pytest.approx(extremum.theta1,
                                               abs=64.0 * EPS * max(extremum.condition, 10.0))
                assert value == pytest.approx(extremum.value,
                                              rel=64.0 * EPS * max(extremum.value_condition, 10.0))


def test_extrema_of_other_results_are_refused_not_empty():
    with pytest.raises(ValueError, match="'omega4' or 'alpha4'"):
        plain.extrema((0.4, 1.2, 0.8, 1.0), 'theta4', 25.0)


def test_it_needs_numpy_alone():
    program = ('import sys, fourbar_ros.plain; '
               'print(*sorted(name for name in sys.modules if name.startswith(("fourbar_ros.", '
               '"scipy", "yaml", "rich"))))')
    printed = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True,
                             check=True).stdout.split()
    assert printed == ['fourbar_ros.errors', 'fourbar_ros.optional', 'fourbar_ros.plain']
