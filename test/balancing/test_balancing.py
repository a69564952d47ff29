# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Balancing beside closed forms, another optimiser, and the loads of the mechanism itself."""
from dataclasses import replace
from math import inf, nan, pi

from fourbar_lab.balancing import (
    BalanceError,
    changes,
    Counterweight,
    front,
    full_force_balance,
    least_peak,
    least_rms,
    Places,
)
from fourbar_lab.balancing.cone import peak
from fourbar_lab.balancing.loads import Loads, moments_of
from fourbar_lab.balancing.result import scene_values
from fourbar_ros import Bodies, FourBar
from fourbar_ros.cli.main import main
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema import OverInput
from fourbar_ros.mechanics.bodies import Body, NOT_APPLIED
from fourbar_ros.mechanisms.quadrature import nodes
from fourbar_ros.scene.scene import from_values, load
import numpy as np
import pytest
from support.samples import record, some
from support.scenes import file_of, PUSH

optimize = pytest.importorskip('scipy.optimize')
pytest.importorskip('clarabel')
EPS = 2.0**-52
SCENES = ('paper', 'slider_crank', 'scotch_yoke', 'cylinder')
MACHINES = ('watt', 'v_engine', 'bucket')


def loads_of(name):
    scene = load(name)
    return Loads(scene.linkage, scene.drive.speed)


def still(mechanism):
    """Return a mechanism without weight and forces from outside."""
    zero = [NOT_APPLIED] * len(mechanism.external)
    return replace(mechanism, gravity=(0.0, 0.0), external=type(mechanism.external)(*zero))


def places_of(loads, links=None, radius=None):
    radius = radius or 0.5 * max(map(abs, loads.mechanism.lengths))
    links = links or [link.name for link in loads.mechanism.LINKS if link.turns]
    return Places(loads, dict.fromkeys(links, radius))


@pytest.mark.parametrize('name', (*SCENES, 'watt'))
def test_loads_are_linear_in_masses_moments_and_inertias(name):
    loads, rng = loads_of(name), np.random.default_rng(1)
    x, _ = nodes(loads.mechanism, 64)
    matrices = {field: matrix for name, fields in loads.groups.items()
                for field, matrix in zip(fields, loads.matrices(x, name))}
    unit = max(loads.mechanism.lengths)
    for _ in range(3):
        # the mechanism's own formulas, with other bodies: J >= m r^2 holds by construction
        bodies = [record(Body, rng.uniform(0.1, 2.0), *(unit * rng.uniform(-0.5, 0.5, 2)),
                         rng.uniform(0.0, 1.0) * unit**2) for _ in loads.links]
        mechanism = replace(still(loads.mechanism), bodies=loads.mechanism.BODIES(*bodies))
        numbers = np.concatenate([moments_of(body) for body in bodies])
        expected = mechanism.loads(x, loads.rate)
        condition = float(np.max(mechanism.motion(x).condition))
        for field, matrix in matrices.items():
            terms = np.abs(matrix) @ np.abs(numbers)
            error = np.abs(matrix @ numbers - getattr(expected, field))
            assert (error <= 64 * EPS * condition * (terms.max() + 1e-300)).all(), field


@pytest.mark.parametrize(('name', 'links'), [
    ('paper', ('crank', 'output')), ('paper', None), ('slider_crank', ('crank', 'coupler')),
    ('cylinder', None)])
def test_full_balance_leaves_no_shaking_force(name, links):
    loads = loads_of(name)
    found = full_force_balance(places_of(loads, links))
    x, _ = nodes(loads.mechanism, 512)
    before = still(loads.mechanism).loads(x, loads.rate).shaking_force
    after = still(loads.balanced(found.moments)).loads(x, loads.rate)
    # as published by the node, from the bodies of the scene
    assert after.shaking_force.max() <= 1e-13 * before.max()
    assert found.bound <= found.value * (1.0 + 1e-12) and found.value <= found.bound * (1 + 1e-6)
    radius = 0.5 * max(loads.mechanism.lengths)
    for one in found.counterweights:
        assert np.hypot(one.along, one.across) <= radius * (1.0 + 1e-9) and one.mass > 0.0


@some('name', MACHINES, 1)
def test_machines_are_balanced_and_written_as_scenes(name):
    scene = load(name)
    loads = Loads(scene.linkage, scene.drive.speed)
    found = full_force_balance(places_of(loads))
    again = Loads(from_values(scene_values(scene, found.moments)).linkage, scene.drive.speed)
    assert again.rms('force', again.unbalanced) <= 1e-12 * loads.rms('force', loads.unbalanced)
    assert found.bound <= found.value * (1.0 + 1e-12) and found.value <= found.bound * (1 + 1e-6)


def test_full_balance_of_a_4r_is_that_of_berkof_and_lowen():
    # Berkof and Lowen 1969: m1 r1 = m2 r2' a1/a2 and m3 r3 = m2 r2 a3/a2, opposite directions,
    # with r2, r2' from A and B to the coupler's centre of gravity; here it lies off the line.
    linkage = load('paper').linkage
    bodies = linkage.bodies
    coupler = Body(bodies.coupler.mass, cg_along=0.5, cg_across=0.1,
                   inertia=bodies.coupler.inertia)
    linkage = replace(linkage, bodies=bodies._replace(coupler=coupler))
    loads = Loads(linkage, 25.0)
    found = full_force_balance(places_of(loads, ('crank', 'output')))
    m, z = coupler.mass, complex(coupler.cg_along, coupler.cg_across) / linkage.a2
    expected = {0: -m * (1.0 - z) * linkage.a1, 2: -m * z * linkage.a3}
    for link, moment in expected.items():
        _, along, across, _ = found.moments[4 * link:4 * link + 4]
        assert abs(complex(along, across) - moment) <= 1e-12 * abs(moment)


def test_a_yoke_on_slides_cannot_be_force_balanced():
    loads = loads_of('scotch_yoke')
    with pytest.raises(BalanceError, match='remains at least, whatever their mass'):
        full_force_balance(places_of(loads))


@some('names', [('force',), ('moment',), ('torque',), ('f21',),
                ('force', 'moment', 'torque')], 2)
def test_the_least_rms_is_proven_and_no_other_optimiser_finds_less(names):
    loads = loads_of('paper')
    places, mass = places_of(loads), 3.0
    found = least_rms(places, names, mass)
    assert found.bound <= found.value <= found.bound * (1.0 + 1e-8)
    assert found.added <= mass * (1.0 + 1e-9)
    root = loads.root(names)
    assert np.linalg.norm(root @ found.moments) == pytest.approx(found.value, rel=1e-12)
    rng = np.random.default_rng(0)

    def value(free):
        """One counterweight on each link: masses from shares, places in polar coordinates."""
        share, r, angle = free.reshape(3, -1)
        masses = mass * share**2 / max(1.0, np.sum(share**2))
        return np.linalg.norm(root @ places.moments(
            Counterweight(link, m, d * np.cos(a), d * np.sin(a)) for link, m, d, a in
            zip(places.radii, masses, 0.6 * np.sin(r), angle)))

    best = min(optimize.minimize(value, rng.uniform(0.0, 2.0, 9), method='Nelder-Mead',
                                 options={'maxiter': 1500}).fun for _ in range(3))
    assert best >= found.bound * (1.0 - 1e-12)


def test_rms_is_that_of_the_mechanism():
    loads = loads_of('paper')
    found = least_rms(places_of(loads), ('moment',), 2.0)
    x = 2.0 * pi * np.arange(4096) / 4096
    moment = still(loads.balanced(found.moments)).loads(x, loads.rate).shaking_moment
    assert found.value == pytest.approx(np.sqrt(np.mean(moment**2)), rel=1e-10)


@some('name', ['force', 'moment', 'torque', 'f21'], 1)
def test_a_front_falls_is_convex_and_every_point_is_proven(name):
    loads = loads_of('paper')
    # up to masses that balance the linkage, where rounding is all that is left
    found = front(places_of(loads), (name,), np.geomspace(0.01, 100.0, 25))
    assert all(0.0 <= one.bound <= one.value for one in found)
    values = np.array([one.value for one in found])
    assert (np.diff(values) <= 1e-8 * values[0]).all()      # where the solver ends is nothing
    found = front(places_of(loads), (name,), np.linspace(0.0, 20.0, 30))
    values = np.array([one.value for one in found])
    size = values[0]
    assert values[0] == pytest.approx(loads.rms(name, loads.unbalanced), rel=1e-12)
    assert (np.diff(values) <= 1e-8 * size).all()
    assert (np.diff(values, 2) >= -1e-7 * size).all()
    assert all(one.bound <= one.value * (1.0 + 1e-12) for one in found)
    assert all(one.value - one.bound <= 1e-8 * size for one in found)


@some('scene, name', [('paper', 'force'), ('paper', 'torque'),
                      ('slider_crank', 'f41'), ('cylinder', 'force')], 1)
def test_the_least_peak_is_that_of_the_extrema_and_is_proven(scene, name):
    loads = loads_of(scene)
    mass = 0.5 * float(loads.unbalanced[::4].sum())
    found = least_peak(places_of(loads), name, mass)
    assert found.bound <= found.value <= found.bound * (1.0 + 1e-5)
    assert found.added <= mass * (1.0 + 1e-9)
    assert found.value <= peak(loads, name, loads.unbalanced)[0]
    low, high = loads.mechanism.input_ranges[0]
    x = np.linspace(low, high, 5001)[1:-1]
    field = {'force': 'shaking_force', 'torque': 'driving_torque'}.get(name, name)
    scanned = getattr(still(loads.balanced(found.moments)).loads(x, loads.rate), field)
    assert np.abs(scanned).max() <= found.value * (1.0 + 1e-9)
    rms = least_rms(places_of(loads), (name,), mass)
    assert found.value <= peak(loads, name, rms.moments)[0] * (1.0 + 1e-9)


def rod(length):
    """Return a bar of 1 kg/m."""
    return Body(length, cg_along=0.5 * length, inertia=length**3 / 12.0)


CHANGE_POINTS = [(0.1, 0.1, 0.1, 0.1), (0.05, 0.05, 0.1, 0.1), (0.05, 0.1, 0.1, 0.05),
                 (0.1, 0.1, 0.05, 0.05), (0.1, 0.05, 0.1, 0.05), (0.05, 0.1, 0.05, 0.1)]


@pytest.mark.parametrize('lengths', CHANGE_POINTS, ids=str)
def test_at_a_change_point_every_root_mean_square_is_a_number(lengths):
    """Beside a mean of middles, whose error is of the second power of its step."""
    loads = Loads(FourBar(*lengths, bodies=Bodies(*map(rod, lengths[:3]))), 2.0 * pi)
    found = full_force_balance(places_of(loads))
    x = 2.0 * pi * (np.arange(2**16) + 0.5) / 2**16
    centrifugal = sum(lengths[:3]) * max(lengths) * loads.rate**2       # [N], at 1 kg/m
    for change in changes(loads, found.moments):
        for numbers, rms in zip((loads.unbalanced, found.moments), change.rms):
            load = loads.matrices(x, change.name) @ numbers
            expected = np.sqrt(np.mean(np.sum(load**2, axis=0)))
            assert abs(rms - expected) <= 1e-7 * expected + 64 * EPS * centrifugal


def test_a_counterweight_beside_the_coupler_has_no_finite_reactions_at_a_change_point():
    lengths = (0.05, 0.1, 0.05, 0.1)
    loads = Loads(FourBar(*lengths, bodies=Bodies(*map(rod, lengths[:3]))), 2.0 * pi)
    places = places_of(loads)
    added = places.moments([Counterweight('coupler', 0.1, 0.0, 0.01)])
    change = next(change for change in changes(loads, added) if change.name == 'f32')
    # a bar of 1 kg/m that moves on a circle as a whole: each pin bears half of it
    expected = 0.5 * lengths[1] * lengths[0] * loads.rate**2
    assert abs(np.array([change.rms[0], change.peak[0]]) - expected).max() <= 16 * EPS * expected
    assert change.rms[1] == change.peak[1] == inf
    for balanced in (lambda: least_rms(places, ['f32'], 1.0),
                     lambda: least_peak(places, 'f32', 1.0)):
        with pytest.raises(BalanceError, match='f32.* without bound at the flat positions'):
            balanced()


def test_gravity_and_loads_from_outside_stay_as_they_are():
    scene = load('cylinder')
    loads = Loads(scene.linkage, scene.drive.speed)
    found = full_force_balance(places_of(loads))
    balanced = loads.balanced(found.moments)
    assert balanced.gravity == scene.linkage.gravity and balanced.gravity != (0.0, 0.0)


def test_what_cannot_be_balanced_is_reported():
    with pytest.raises(BalanceError, match='no masses'):
        loads_of('slides_7_7')
    linkage = load('paper').linkage
    with pytest.raises(BalanceError, match='toggle'):
        Loads(replace(linkage, a1=0.9, a2=0.5), 25.0)
    loads = loads_of('paper')
    with pytest.raises(InvalidParameter, match='must be one of crank, coupler, output'):
        Places(loads, {'handle': 1.0})
    with pytest.raises(InvalidParameter, match='unknown'):
        least_rms(places_of(loads), ('noise',), 1.0)


def test_a_rocker_is_balanced_over_the_range_that_is_given():
    """The root mean square over samples of the range, by the mechanism itself."""
    rocker = replace(load('paper').linkage, a1=0.9, a2=0.5, gravity=(0.0, 0.0), stroke=(0.5, 0.9))
    loads = Loads(rocker, 25.0)
    x = 0.5 + 0.4 * (np.arange(20_000) + 0.5) / 20_000
    force = rocker.loads(x, 25.0).shaking_force
    assert loads.rms('force', loads.unbalanced) == pytest.approx(
        np.sqrt(np.mean(np.square(force))), rel=1e-7)
    with pytest.raises(BalanceError, match='toggle'):
        Loads(replace(rocker, stroke=(0.0, 0.9)), 25.0)


def test_the_command_writes_a_scene_that_is_balanced(tmp_path, capsys):
    file, picture = tmp_path / 'balanced.yaml', tmp_path / 'change.png'
    assert main(['balance', 'paper', '-o', str(file), '--plot', str(picture)]) == 0
    said = capsys.readouterr().out
    assert 'full force balance' in said and 'RMS before' in said
    scene = load(file)
    x = np.linspace(0.0, 6.2, 400)
    before = load('paper').linkage.loads(x, 25.0).shaking_force.max()
    assert scene.linkage.loads(x, 25.0).shaking_force.max() <= 1e-13 * before
    assert picture.read_bytes()[1:4] == b'PNG'
    assert main(['balance', 'paper', '--minimize', 'force', '--mass', '1', '--front',
                 str(tmp_path / 'front.svg'), '--points', '5', '--radius', 'crank=0.3']) == 0
    assert 'none below' in capsys.readouterr().out and (tmp_path / 'front.svg').exists()
    for radius, warned in (('300', '--radius = 300 m: did you mean 0.3?'), ('300m', '')):
        assert main(['balance', 'paper', '--radius', radius]) == 0
        assert warned in (err := capsys.readouterr().err) and bool(err) == bool(warned)
    for arguments, text in ((['--minimize', 'force'], '--minimize needs --mass'),
                            (['--minimize', 'force', 'force', '--mass', '1'], 'each once'),
                            (['--mass', '1'], 'go with --minimize'),
                            (['--radius', '0.3', 'crank=0.2'], 'one M for all links, or LINK=M'),
                            (['--radius', 'crank=0.3', 'crank=0.2'], 'once for each'),
                            (['--minimize', 'forse', '--mass', '1'], 'did you mean force')):
        assert main(['balance', 'paper', *arguments]) == 1
        assert text in capsys.readouterr().err


def test_what_takes_more_inertia_than_a_point_is_two_points_within_the_radius():
    places = places_of(loads_of('paper'), ['output'], 0.6)
    for part in ((0.3, 0.1, -0.2, 0.25), (0.5, 0.0, 0.0, 0.5), (0.2, 0.12, 0.16, 0.2)):
        weights = places.counterweights(np.array(part), 4.0)
        added = sum(moments_of(Body(one.mass, cg_along=one.along, cg_across=one.across))
                    for one in weights)
        assert np.allclose(added, 4.0 * np.array(part) * places.units, rtol=1e-12)
        assert len(weights) == 1 + (part[0] * part[3] > part[1]**2 + part[2]**2 + 1e-9)
        assert all(np.hypot(*one[2:]) <= 0.6 * (1.0 + 1e-12) for one in weights)


def test_the_command_shows_no_rounding(capsys):
    for arguments in ([], ['--minimize', 'moment', '--mass', '3']):
        assert main(['balance', 'paper', *arguments]) == 0
        table = capsys.readouterr().out.split('loads of inertia')[0]
        assert 'e-1' not in table and '99999' not in table, table
    assert table.count('output') == 1


@pytest.mark.parametrize('make, name', [
    (lambda: Loads(None, 25.0), 'mechanism'), (lambda: Loads(load('paper'), 25.0), 'mechanism'),
    (lambda: least_rms(places_of(loads_of('paper')), [], 1.0), 'minimize'),
    *[(lambda mass=mass: least_rms(places_of(loads_of('paper')), ['force'], mass), 'mass')
      for mass in (-1.0, nan, inf)]])
def test_what_is_no_mechanism_load_or_mass_is_refused_by_name(make, name):
    with pytest.raises(InvalidParameter) as caught:
        make()
    assert caught.value.name == name


ACTING = {'springs.back.first.along': 1.5, 'springs.back.second.link': 'output',
          'springs.back.second.along': 0.5, 'springs.back.stiffness': 900.0,
          'springs.back.damping': 20.0, **PUSH}


def sprung(tmp_path):
    plain = {name: value for name, value in load('paper').values.items() if value == value}
    return load(file_of({**plain, 'drive.speed': 5.0, **ACTING}, tmp_path, 'with'))


def test_loads_with_springs_and_forces_are_those_of_the_mechanism(tmp_path):
    scene = sprung(tmp_path)
    loads = Loads(scene.linkage, 5.0)
    x, _ = nodes(loads.acting, 64)
    expected = still(scene.linkage).loads(x, 5.0)
    for name, fields in loads.groups.items():
        for field, matrix in zip(fields, loads.matrices(x, name)):
            terms = np.abs(matrix) @ loads.column(loads.unbalanced)
            error = np.abs(matrix @ loads.column(loads.unbalanced) - getattr(expected, field))
            assert (error <= 1e-12 * np.abs(terms).max()).all(), field


@pytest.mark.parametrize('is_peak', [False, True])
def test_the_torque_of_a_mechanism_with_springs_is_the_least_that_masses_leave(tmp_path, is_peak):
    """Counterweights that are best without springs leave more torque with them."""
    linkage = sprung(tmp_path).linkage
    figure = 'peak' if is_peak else 'rms'

    def balanced(mechanism):
        loads = Loads(mechanism, 5.0)
        sites = places_of(loads)
        found = (least_peak(sites, 'torque', 2.0) if is_peak
                 else least_rms(sites, ['torque'], 2.0))
        still_with = replace(still(linkage), bodies=loads.balanced(found.moments).bodies)
        return found, getattr(OverInput(still_with, 'driving_torque', 5.0), figure)

    (found, left), (_, beside) = balanced(linkage), balanced(linkage.with_elements())
    assert left == pytest.approx(found.value, rel=1e-9)
    assert found.bound * (1.0 - 1e-9) <= left < 0.999 * beside
    rng = np.random.default_rng(2)
    sites = places_of(Loads(linkage, 5.0))
    for _ in range(20):
        mass = rng.uniform(0.0, 2.0)
        weights = [Counterweight(link, share * mass, *(0.4 * rng.uniform(-0.7, 0.7, 2)))
                   for link, share in (('coupler', 0.5), ('output', 0.5))]
        other = replace(still(linkage), bodies=sites.loads.balanced(sites.moments(weights)).bodies)
        assert getattr(OverInput(other, 'driving_torque', 5.0), figure) >= found.bound


def test_full_force_balance_is_that_without_springs_and_says_so(tmp_path, capsys):
    scene = sprung(tmp_path)
    with_springs, without = (full_force_balance(places_of(Loads(linkage, 5.0)))
                             for linkage in (scene.linkage, scene.linkage.with_elements()))
    assert with_springs.counterweights == without.counterweights
    assert main(['balance', str(tmp_path / 'with.yaml')]) == 0
    said = capsys.readouterr().out
    assert 'no masses take away what springs and forces over a position do' in said
    assert 'loads of inertia, springs and forces' in said
