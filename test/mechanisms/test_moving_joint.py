# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Four-bars driven at A or B: bags, change points, free motion, pictures."""

from fourbar_lab.drawing.figure import make_figure
from fourbar_ros import Bodies, Body, FourBar, MovingJointFourBar
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.dynamics import simulate, System
from fourbar_ros.scene.parameters import check
import numpy as np
import pytest
from support import bags, contract


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


CHANGE_POINTS = [(2.0, 4.0, 3.0, 5.0), (2.0, 3.0, 2.0, 3.0)]


@pytest.mark.parametrize('lengths', [(0.4, 1.2, 0.8, 1.0), *CHANGE_POINTS])
@pytest.mark.parametrize('joint, index', [('A', 3), ('B', 6)])
def test_a_free_linkage_moves_alike_whichever_joint_counts(joint, index, lengths):
    """The same masses, as a function of theta1, theta2 or theta3; also on through flat poses."""
    def mode_at(motion):        # of the moving joint
        modes = [m for m in (1, 2) if abs(np.sin(
            linkage.in_mode(m).motion(motion[index]).theta4 - motion.theta4)) < 1e-9]
        assert len(modes) == 1
        return modes[0]
    has_flat = lengths in CHANGE_POINTS
    acting = {'bodies': contract.random_bodies(np.random.default_rng(6)),
              'gravity': (0.0, 0.0 if has_flat else -9.81)}
    given, times = ((0.7, 3.0) if has_flat else (1.3, 9.0)), [0.1, 0.3, 0.5, 1.0, 1.5, 3.0]
    crank = FourBar(*lengths, **acting)
    start, linkage = crank.motion(*given), MovingJointFourBar(*lengths, input=joint, **acting)
    linkage = linkage.in_mode(mode_at(start))
    free, seen = (simulate(System(its, *begin), times[-1], 1e-10, times=times)
                  for its, begin in ((crank, given), (linkage, start[index:index + 2])))
    # flat poses are passed in the mode; a drive at B passes toggles too, from mode to mode
    assert set(free.modes) == {2}
    assert (set(seen.modes) == {1, 2}) == (joint == 'B' and lengths != CHANGE_POINTS[1])
    for k, mode in enumerate(seen.modes):
        one = crank.in_mode(int(free.modes[k])).motion(float(free.position[k]),
                                                       float(free.rate[k]))
        other = linkage.in_mode(int(mode)).motion(float(seen.position[k]), float(seen.rate[k]))
        assert abs(np.sin(one.theta4 - other.theta4)) < 1e-8
        assert abs(one.omega1 - other.omega1) + abs(one.omega4 - other.omega4) < 1e-7 * given[1]


def test_pictures_name_the_torque_by_its_links():
    pytest.importorskip('matplotlib')
    bodies = contract.random_bodies(np.random.default_rng(7))
    for joint, symbol in (('A', 'T_{12}'), ('B', 'T_{23}')):
        linkage = MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input=joint, bodies=bodies)
        words = [text.get_text() for text in make_figure(
            linkage, *linkage.step(2.0, 3.0)).axes[0].texts]
        assert f'${symbol}$' in words and any(f'drive ${symbol}$' in word for word in words)


@pytest.mark.parametrize('joint', ['A', 'B'])
def test_a_flywheel_on_a_pin_of_the_ground_leaves_all_but_that_pin_as_it_is(joint):
    """Its weight is borne there; in the sum of forces it cost 5e8 eps of f21 and f32."""
    rod, rng = Body(1.0, cg_along=0.3, cg_across=0.1, inertia=0.1), np.random.default_rng(2)
    for _ in range(20):
        lengths = rng.uniform(0.7, 1.2, 4).tolist()
        low, high = MovingJointFourBar(*lengths, input=joint).input_ranges[0]
        given = float(low + rng.uniform(0.2, 0.8) * (high - low)), 2.0, 1.0
        for bodies, at_pin in ((Bodies(Body(1e6), rod, Body(0.0)), 'f41'),
                               (Bodies(Body(0.0), rod, Body(1e6)), 'f43')):
            light = Bodies(Body(0.0), rod, Body(0.0))
            heavy, without = [MovingJointFourBar(
                *lengths, input=joint, bodies=masses, gravity=(0.0, -9.81)).loads(*given)
                for masses in (bodies, light)]
            for name in {'f41', 'f21', 'f32', 'f43', 'driving_torque'} - {at_pin}:
                assert getattr(heavy, name) == getattr(without, name)
            assert getattr(heavy, f'{at_pin}_y') == pytest.approx(
                getattr(without, f'{at_pin}_y') + 9.81e6, rel=2.0**-51)
