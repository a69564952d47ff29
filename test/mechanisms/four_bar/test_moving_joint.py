# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Four-bars driven at A or B, against the loop and Newton-Euler in many digits.

The reference never inverts a linkage: it takes poses of the crank, and by the chain rule the
rates and accelerations for which the relative angle moves as given.
"""
from math import pi

from fourbar_lab.drawing.figure import make_figure
from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    find_extrema,
    FourBar,
    InvalidParameter,
    MovingJointFourBar,
    OutOfRange,
)
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.dynamics import simulate, System
from fourbar_ros.mechanisms.quantities import known
from fourbar_ros.scene.parameters import check
import mpmath as mp
import numpy as np
import pytest
from support import bags
from support.reference import cross, EPS, free_bodies, pose, random_lengths
from support.scans import check_against_scan

RATE, ACCELERATION, GRAVITY = 1.7, -0.6, (0.4, -9.8)
SHIFT = {'A': 1, 'B': 2}         # of theta2, theta3 among the joints


def bodies_of(rng):
    return Bodies(*(Body(*map(float, (rng.uniform(0.5, 2.0), rng.uniform(0.0, 1.0),
                                      rng.uniform(-0.3, 0.3), rng.uniform(0.1, 1.0))))
                    for _ in range(3)))


def crank_motion(lengths, sign, x, joint):
    """Return theta1's rate and acceleration for which the driven joint has RATE, ACCELERATION."""
    place = pose(lengths, sign, x)
    slope, bend = ((place.db - 1, place.ddb) if joint == 'A' else
                   (place.dy - place.db, place.ddy - place.ddb))
    omega = RATE / slope
    return place, omega, (ACCELERATION - bend * omega**2) / slope


def cases(count, seed):
    """Yield (lengths, joint, MovingJointFourBar, input, sign of the dyad, x): random linkages."""
    rng = np.random.default_rng(seed)
    for n, lengths in enumerate(random_lengths(rng, count).tolist()):
        sign, joint = (-1) ** (n // 2), 'AB'[n % 2]
        base = FourBar(*lengths, mode=2 if sign > 0 else 1)
        low, high = base.input_ranges[-1]
        x = low + (high - low) * float(rng.uniform(0.05, 0.95))
        with mp.workdps(40):
            place = pose(lengths, sign, mp.mpf(x))
            if place is None:
                continue
            theta = {'A': place.b - x, 'B': place.y - place.b + mp.pi}[joint]
            opposite = mp.sin(place.y) if joint == 'A' else mp.sin(x)
            if abs(opposite) < 0.05 or base.change_point_margin < 1e-3:
                continue
        linkage = MovingJointFourBar(*lengths, mode=2 if opposite > 0 else 1, input=joint,
                                     bodies=bodies_of(rng), gravity=GRAVITY,
                                     external=External(Applied(3.0, -2.0, 0.3, 0.1, 0.7),
                                                       Applied(-1.0, 4.0, 0.2, 0.0, -0.4)))
        yield lengths, joint, linkage, theta, sign, x


def test_motion_is_that_of_the_same_pose_and_rates():
    seen = 0
    for lengths, joint, linkage, theta, sign, x in cases(120, 1):
        motion = linkage.motion(float(mp.fmod(theta + mp.pi, 2 * mp.pi) - mp.pi), RATE,
                                ACCELERATION)
        with mp.workdps(40):
            place, omega, alpha = crank_motion(lengths, sign, mp.mpf(x), joint)

            def moved(slope, bend):
                return slope * omega, slope * alpha + bend * omega**2      # noqa: B023
            angles = {'1': (mp.mpf(x), omega, alpha),
                      '2': (place.b - x, *moved(place.db - 1, place.ddb)),
                      '3': (place.y - place.b + mp.pi,
                            *moved(place.dy - place.db, place.ddy - place.ddb)),
                      '4': (place.y, *moved(place.dy, place.ddy)),
                      'beta': (place.b, *moved(place.db, place.ddb))}
            gain = 1 + max(abs(values[1]) for values in angles.values()) / RATE
        condition = float(gain) * motion.condition
        for name, (angle, rate, acceleration) in angles.items():
            fields = (('beta', 'omega_beta', 'alpha_beta') if name == 'beta' else
                      [f'{field}{name}' for field in ('theta', 'omega', 'alpha')])
            found = [getattr(motion, field) for field in fields]
            assert abs(np.sin(0.5 * (found[0] - float(angle)))) <= 8.0 * EPS * condition
            assert abs(found[1] - rate) <= 32.0 * EPS * condition**2
            assert abs(found[2] - acceleration) <= 128.0 * EPS * condition**4
        assert motion.crank_ratio == pytest.approx(motion.omega1 / RATE, rel=1e-14)
        assert motion.coupler_ratio == pytest.approx(motion.omega_beta / RATE, abs=1e-13)
        seen += 1
    assert seen > 60


def solved(links, joint):
    """Return (F41, F21, F32, F43, T) of nine equations with the torque between two links."""
    matrix, right = mp.zeros(9, 9), mp.zeros(9, 1)
    for i, link in enumerate(links):
        arms = [-link.centre, link.end - link.centre]
        if i == 2:
            arms.reverse()
        for column, sign, arm in zip((2 * i, 2 * i + 2), (1 if i == 0 else -1, 1), arms):
            matrix[3 * i, column] = matrix[3 * i + 1, column + 1] = sign
            matrix[3 * i + 2, column] = -sign * arm.imag
            matrix[3 * i + 2, column + 1] = sign * arm.real
        right[3 * i], right[3 * i + 1] = link.force.real, link.force.imag
        right[3 * i + 2] = link.moment
    first = SHIFT[joint] - 1
    matrix[3 * first + 2, 8], matrix[3 * first + 5, 8] = -1, 1
    f = mp.lu_solve(matrix, right)
    return [mp.mpc(f[2 * i], f[2 * i + 1]) for i in range(4)] + [f[8]]


def test_loads_solve_newton_and_euler_with_the_torque_between_two_links():
    seen = 0
    for lengths, joint, linkage, theta, sign, x in cases(80, 2):
        motion, loads = linkage.step(float(mp.fmod(theta + mp.pi, 2 * mp.pi) - mp.pi), RATE,
                                     ACCELERATION)
        with mp.workdps(40):
            place, omega, alpha = crank_motion(lengths, sign, mp.mpf(x), joint)
            bodies = [(b.mass, b.cg_along, b.cg_across, b.inertia) for b in linkage.bodies]
            applied = [(a.force_x, a.force_y, a.along, a.across, a.couple)
                       for a in (linkage.external.coupler, linkage.external.output)]
            links = free_bodies([mp.mpf(a) for a in lengths], place, mp.mpf(x), omega, alpha,
                                bodies, applied, GRAVITY)
            *forces, torque = solved(links, joint)
            moment = -sum(link.moment + cross(link.centre + at, link.force) for link, at in zip(
                links, (0, links[0].end, lengths[3])))
            size = float(max(map(abs, forces)) + abs(torque) + sum(
                abs(link.force) + abs(link.moment) for link in links))
        gain = 1.0 + max(abs(motion.omega1), abs(motion.omega_beta), abs(motion.omega4)) / RATE
        tolerance = 64.0 * EPS * size * (gain * motion.condition)**3
        for name, force in zip(('f41', 'f21', 'f32', 'f43'), forces):
            assert abs(getattr(loads, f'{name}_x') - force.real) <= tolerance, (joint, name)
            assert abs(getattr(loads, f'{name}_y') - force.imag) <= tolerance, (joint, name)
        assert abs(loads.driving_torque - torque) <= tolerance
        shaking = -forces[0] - forces[3]
        assert abs(complex(loads.shaking_force_x, loads.shaking_force_y) - complex(
            shaking)) <= tolerance
        assert abs(loads.shaking_moment - moment) <= tolerance
        seen += 1
    assert seen > 40


@pytest.mark.parametrize('joint', ['A', 'B'])
def test_ranges_end_where_its_own_dyad_is_in_line_and_extrema_are_those_of_a_scan(joint):
    full = 0
    for lengths in random_lengths(np.random.default_rng(4), 25).tolist():
        linkage = MovingJointFourBar(*lengths, input=joint)
        for low, high in linkage.input_ranges:
            x = np.linspace(low, high, 20001)[1:-1]
            motion = linkage.motion(x, 1.0)
            assert np.isfinite(motion.theta1).all()
            if linkage.turns_fully:
                full += 1
                found = list(find_extrema(linkage, ('omega4',), 1.0))
                changes = np.count_nonzero(np.diff(np.sign(np.diff(motion.omega4))))
                assert len(found) in (changes, changes + 1), lengths
                assert max(e.value for e in found) >= motion.omega4.max() * (1.0 - 1e-12)
            else:
                beyond = low - 1e-6 * (high - low)
                with pytest.raises(OutOfRange):
                    linkage.motion(beyond, 1.0)
    assert full


@pytest.mark.parametrize('joint', ['A', 'B'])
def test_a_bag_of_it_recomputes_without_a_difference(joint, tmp_path):
    values = check({'linkage.a1': 0.4, 'linkage.a2': 1.2, 'linkage.a3': 0.8, 'linkage.a4': 1.0,
                    'linkage.input': joint, 'bodies.rods.density': 7750.0,
                    'bodies.rods.radius': 0.01, 'drive.source': 'motion',
                    'outputs': ['state', 'output', 'joint_states', 'loads', 'shaking_wrench']})
    low, high = MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input=joint).input_ranges[0]
    inputs = [(float(x), 2.0, 0.5) for x in np.linspace(low, high, 50)[1:-1]]
    path = bags.run(tmp_path, 'run', values, inputs)
    found = recompute(path)
    assert not found.problems() and len(found.differences) > 60
    assert not any(difference.largest for difference in found.differences)


# --- exact change points -------------------------------------------------------------------------

# With input 0 flat: theta1 is there 0 for a drive at A, pi for one at B.
FLAT_AT_ZERO = [('A', (2.0, 3.5, 4.0, 1.5)), ('A', (2.0, 3.0, 2.0, 3.0)),
                ('B', (2.0, 3.0, 2.0, 3.0)), ('B', (2.0, 2.0, 3.0, 3.0)),
                ('B', (2.0, 4.0, 3.0, 5.0)), ('B', (1.0, 1.0, 1.0, 1.0))]


def beside_flat(lengths, joint, mode, ahead):
    """Return the reference's pose and slope of the joint at a small input, in a mode."""
    flat = 0 if joint == 'A' else mp.pi
    for sign in (1, -1):
        for side in (1, -1):
            x = flat + side * mp.mpf(ahead)
            for _ in range(9):           # Newton's iteration to the input
                place = pose(lengths, sign, x)
                theta, slope = ((place.b - x, place.db - 1) if joint == 'A' else
                                (place.y - place.b + mp.pi, place.dy - place.db))
                gap = mp.arg(mp.expj(theta - ahead))
                x -= gap / slope
            opposite = mp.sin(place.y) if joint == 'A' else mp.sin(x)
            if abs(gap) < mp.mpf(10)**-60 and (opposite > 0) == (mode == 2):
                return x, place, slope
    raise AssertionError('no pose')


@pytest.mark.parametrize('mode', [1, 2])
@pytest.mark.parametrize('joint, lengths', FLAT_AT_ZERO)
def test_a_flat_position_has_all_digits_and_the_limit_from_above(joint, lengths, mode):
    linkage = MovingJointFourBar(*lengths, mode=mode, input=joint)
    assert linkage.change_point_margin == 0.0 and linkage.is_flat_at_zero
    for at in (0.0, 1e-14, 1e-8, 1e-3):
        with mp.workdps(120):
            x, place, slope = beside_flat(lengths, joint, mode, mp.mpf(at or 1e-40))
            for motion in (linkage.motion(at, 1.0), linkage.motion(np.full(1, at), 1.0)):
                for ours, truth in ((motion.omega1, 1 / slope), (motion.omega4, place.dy / slope)):
                    assert abs(float(np.ravel(ours)[0] - truth)) <= 8 * EPS * max(1.0, abs(truth))
                for ours, truth in ((motion.theta1, x), (motion.theta4, place.y)):
                    turned = mp.arg(mp.expj(float(np.ravel(ours)[0]) - truth))
                    assert abs(turned) <= 4 * EPS


@pytest.mark.parametrize('joint, lengths', FLAT_AT_ZERO[:1] + FLAT_AT_ZERO[4:5])
def test_extrema_at_change_points_are_those_of_a_scan(joint, lengths):
    linkage = MovingJointFourBar(*lengths, input=joint, bodies=bodies_of(np.random.default_rng(2)))
    quantities = [known(linkage, joint)[name] for name in ('omega1', 'alpha4', 'driving_torque')]
    assert check_against_scan(linkage, quantities, RATE, 0.0, 4000)


@pytest.mark.parametrize('lengths', [(2.0, 4.0, 3.0, 5.0), (2.0, 3.0, 2.0, 3.0)])
@pytest.mark.parametrize('joint, index', [('A', 3), ('B', 6)])
def test_a_free_linkage_passes_its_change_points_alike(joint, index, lengths):
    """Without loads it turns on through flat positions, as a function of theta1 and the joint."""
    bodies = bodies_of(np.random.default_rng(6))
    crank = FourBar(*lengths, bodies=bodies)
    start, times = crank.motion(0.7, 3.0), [0.1, 0.5, 1.0, 2.0, 3.0]
    assert start.sin_y > 0.0 and start.sin_x > 0.0          # mode 2 of both
    linkage = MovingJointFourBar(*lengths, input=joint, bodies=bodies)
    free, seen = (simulate(System(its, *given), times[-1], 1e-10, times=times) for its, given in (
        (crank, (0.7, 3.0)), (linkage, start[index:index + 2])))
    assert set(free.modes) == set(seen.modes) == {1, 2}
    for k, mode in enumerate(seen.modes):
        one = crank.in_mode(int(free.modes[k])).motion(float(free.position[k]),
                                                       float(free.rate[k]))
        other = linkage.in_mode(int(mode)).motion(float(seen.position[k]), float(seen.rate[k]))
        assert abs(np.sin(one.theta4 - other.theta4)) < 1e-8
        assert abs(one.omega1 - other.omega1) + abs(one.omega4 - other.omega4) < 1e-7 * 3.0


def test_what_it_cannot_do_is_refused():
    with pytest.raises(InvalidParameter, match='input'):
        MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input='crank')
    assert MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input='B').closing_ranges != ((-pi, pi),)


@pytest.mark.parametrize('joint, index', [('A', 3), ('B', 6)])
def test_a_free_linkage_moves_alike_whichever_joint_counts(joint, index):
    """The same masses under gravity, as a function of theta1, theta2 or theta3."""
    lengths, bodies = (0.4, 1.2, 0.8, 1.0), bodies_of(np.random.default_rng(6))
    crank = FourBar(*lengths, bodies=bodies, gravity=(0.0, -9.81))
    start, times = crank.motion(1.3, 9.0), [0.1, 0.3, 0.5, 1.0, 1.5]
    linkage = MovingJointFourBar(*lengths, input=joint, bodies=bodies, gravity=(0.0, -9.81))
    assert start.sin_y > 0.0 and start.sin_x > 0.0          # mode 2 of both
    free, seen = (simulate(System(its, *given), times[-1], 1e-10, times=times) for its, given in (
        (crank, (1.3, 9.0)), (linkage, start[index:index + 2])))
    # the crank turns fully; a drive at B passes toggles, from mode to mode
    assert (set(seen.modes) == {1, 2}) == (joint == 'B')
    for k, mode in enumerate(seen.modes):
        one = crank.motion(float(free.position[k]), float(free.rate[k]))
        other = linkage.in_mode(int(mode)).motion(float(seen.position[k]), float(seen.rate[k]))
        assert abs(np.sin(one.theta4 - other.theta4)) < 1e-8
        assert abs(one.omega4 - other.omega4) < 1e-7 * 9.0


def test_pictures_name_the_torque_by_its_links():
    pytest.importorskip('matplotlib')
    for joint, symbol in (('A', 'T_{12}'), ('B', 'T_{23}')):
        linkage = MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input=joint, bodies=bodies_of(
            np.random.default_rng(7)))
        words = [text.get_text() for text in make_figure(
            linkage, *linkage.step(2.0, 3.0)).axes[0].texts]
        assert f'${symbol}$' in words and any(f'drive ${symbol}$' in word for word in words)
