# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Motion of links and their points: against the reference, and in another coordinate."""
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.quantities import POINT_QUANTITIES
from fourbar_ros.numerics.number_types import REAL
import numpy as np
import pytest
from support import contract
from support.cartesian import EPS, exact
from support.contract import every_case, every_mechanism


@every_mechanism
def test_links_are_where_the_reference_has_them(case):
    """Place and direction of every link, motion of a point; conditions are some hundred."""
    for mechanism, given in contract.ordinary(case, 206, 20):
        motion = mechanism.motion(*given)
        near, size = exact(mechanism, given), max(map(abs, mechanism.lengths))
        for link in mechanism.BODIES._fields:
            at, point = (mechanism.link_motion(motion, link),
                         point_motion(mechanism, motion, link, 0.3, -0.2))
            places, directions = (np.array([complex(level[0]) for level in levels])
                                  for levels in near.link(link))
            assert abs(complex(at.x, at.y) - places[0]) <= 1e-13 * (size + abs(places[0])), link
            assert abs(complex(at.cosine, at.sine) - directions[0]) <= 1e-12, link
            scale = size + np.abs([*places, *directions]).max()
            for found, truth in zip((point.place, point.velocity, point.acceleration),
                                    places + (0.3 - 0.2j) * directions):
                assert abs(complex(*found) - truth) <= 1e-11 * scale, link


@every_mechanism
def test_ratios_are_rates_at_unit_rate(case):
    for mechanism, (value, *_) in contract.ordinary(case, 208, 6):
        motion = mechanism.motion(value, 1.0)._asdict()
        rates = [v for name, v in motion.items() if name.startswith('omega')
                 or name.endswith('velocity')]
        for name in motion:
            if name.endswith('_ratio'):
                assert min(abs(motion[name] - rate) for rate in rates) <= 4 * EPS * max(
                    1.0, *map(abs, rates)), name


@every_mechanism
def test_points_of_all_links(case):
    """Quantities of a point and its motion: one set of numbers."""
    for mechanism, given in contract.ordinary(case, 224, 5):
        state = mechanism.step(*given)
        for link in mechanism.BODIES._fields:
            point = point_motion(mechanism, state[0], link, 0.3, -0.2)
            x, y, speed, acceleration = (make(mechanism, link, 0.3, -0.2).of(*state)
                                         for make in POINT_QUANTITIES)
            assert (x, y) == (point.x, point.y)
            assert speed == pytest.approx(point.speed, rel=4 * EPS)
            assert acceleration == pytest.approx(
                np.hypot(point.acceleration_x, point.acceleration_y), rel=4 * EPS)


@every_case
def test_another_coordinate_gives_the_same_links_by_the_chain_rule(case):
    """X' = o' X_o and X'' = o'^2 X_oo + o'' X_o for every link, in one of its modes; and back."""
    for mechanism, (value, _, _) in contract.ordinary(case, 500, 20):
        curves = mechanism.make_coefficients(REAL)(value)
        others = mechanism.driven_otherwise()
        other, ratio, bend = others[0].read_coordinate(REAL, curves)
        place, *slopes = mechanism.read_coordinate(REAL, curves)
        assert abs(mechanism.distance(place, value)) <= 1e-13 * (1.0 + abs(value))
        assert slopes == pytest.approx((1.0, 0.0), abs=1e-11)
        errors = []
        for same in others:
            found = same.make_coefficients(REAL)(other)
            error = abs(mechanism.distance(mechanism.read_coordinate(REAL, found)[0], value))
            for (x, y, dx, dy, ddx, ddy, cosine, sine, turn, turn2), own in zip(found, curves):
                by_chain = (x, y, ratio * dx, ratio * dy, ratio**2 * ddx + bend * dx,
                            ratio**2 * ddy + bend * dy, cosine, sine, ratio * turn,
                            ratio**2 * turn2 + bend * turn)
                error = max(error, *(abs(a - b) / (1.0 + abs(b))
                                     for a, b in zip(by_chain, own)))
            errors.append(error)
        # next to its own limit the other coordinate has half of the digits
        assert min(errors) <= EPS**0.5, (mechanism, value)
