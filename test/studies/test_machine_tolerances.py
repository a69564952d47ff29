# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The first order and corners of a tolerance box of a machine beside machines drawn from it."""
from math import isnan, pi

from fourbar_lab.studies.derivatives import Derivatives
from fourbar_lab.studies.measures import LEAST_ANGLE, Measures, STROKE, SWING
from fourbar_lab.studies.parametric import constants_of
from fourbar_lab.studies.study import from_document
from fourbar_lab.studies.tolerance_analysis import box_of, tolerances
from fourbar_ros.numerics.number_types import ARRAY, columns_of
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest

pytest.importorskip('scipy')
MACHINES, SAMPLES = 600, 512
BOXES = {
    'jansen': ({'dyads.leg.first.along': 1e-4, 'dyads.lower.second.across': 1e-4,
                'bodies.foot.mass': 1e-2},
               ['driving_torque.peak', 'omega_foot.min', 'lower_inner.max',
                'least_transmission_angle']),
    'watt': ({'dyads.one.length_1': 1e-4, 'bodies.rods.radius': 5e-5, 'drive.speed': 0.1},
             ['swing', 'shaking_moment.peak', 'two_first.max']),
    'bucket': ({'cylinder.base.along': 1e-3, 'dyads.bucket.length_1': 1e-3,
                'external.bucket.force_x': 100.0},
               ['swing', 'driving_force.peak', 'bucket_first.max', 'least_transmission_angle']),
    'quick_return': ({'dyads.lever.second.across': 1e-4, 'dyads.ram.direction_2': 1e-3,
                      'dyads.ram.length_1': 1e-4},
                     ['slide_ram_velocity.span', 'shaking_force.max']),
}


def study_of(name, vary, quantities):
    return from_document({'scene': name, 'rows': 4, 'quantities': quantities,
                          'vary': {one: {'uniform': size} for one, size in vary.items()}})


def largest(values, is_turn):
    """Return the largest of samples along the last axis, by a parabola through three."""
    rows, i = np.arange(len(values)), values.argmax(axis=1)
    last = values.shape[1] - 1
    before, after = (values[rows, (i + way) % last if is_turn else np.clip(i + way, 0, last)]
                     for way in (-1, 1))
    top, bend = values[rows, i], before - 2.0 * values[rows, i] + after
    is_inside = np.ones_like(i, bool) if is_turn else (i > 0) & (i < last)
    return np.where(is_inside & (bend < 0.0), top - 0.125 * (after - before)**2 / bend, top)


def sampled(study, drawn):
    """Return {measure: its value in each machine}, by the formulas for columns on a grid."""
    scene = from_values(study.values)
    values = study.values | {name: column[:, None] for name, column in drawn.items()}
    constants, numbers = constants_of(scene, values), columns_of(ARRAY)
    linkage, (low, high) = scene.linkage, scene.linkage.input_ranges[0]
    x = np.linspace(low, high, SAMPLES + 1)
    fields = linkage.motion_formula(numbers, constants)(x, values['drive.speed'], 0.0)
    motion = linkage.MOTION(*fields)
    loads = linkage.LOADS(*linkage.loads_formula(numbers, constants)(fields))
    known, found = Measures(scene).quantities, {}
    for measure in study.measures:
        name = {SWING: linkage.outputs[0].coordinate.position, STROKE: '',
                LEAST_ANGLE: 'transmission_angle'}.get(measure.part, measure.quantity)
        rows = np.broadcast_to(known[name].of(motion, loads), (MACHINES, x.size))
        if known[name].unit == 'rad':
            rows = np.unwrap(rows)
        if measure.part == LEAST_ANGLE:
            rows = np.minimum(rows, pi - rows)
        most, least = (sign * largest(sign * rows, linkage.turns_fully) for sign in (1, -1))
        found[measure.name] = {
            'max': most, 'min': least, 'peak': np.maximum(abs(most), abs(least)),
            LEAST_ANGLE: least}.get(measure.part, most - least)
    return found


@pytest.mark.slow
@pytest.mark.parametrize('name', BOXES)
def test_random_machines_lie_within_the_first_order(name):
    study = study_of(name, *BOXES[name])
    rng = np.random.default_rng(11)
    drawn = {name: centre + size * rng.uniform(-1.0, 1.0, MACHINES)
             for name, (centre, size) in box_of(study).items()}
    values = sampled(study, drawn)
    for one in tolerances(study):
        value, size, part = one.sensitivity.value, one.first_order, values[
            one.sensitivity.measure.name]
        low, high = one.corners
        assert low < value < high and abs(high - value - size) < 0.05 * size, one
        assert value - 1.05 * size <= part.min() <= part.max() <= value + 1.05 * size, one
        assert part.max() - part.min() > size, one


def test_where_another_dyad_is_nearest_to_its_toggle_an_angle_has_a_kink():
    name = 'dyads.right.length_1'
    study = study_of('v_engine', {name: 1e-4}, ['transmission_angle.max'])
    # both cylinders of the V are alike at theta1 = 0
    moves = Derivatives(from_values(study.values), [name]).at_extremum('transmission_angle', 0.0)
    assert isnan(moves.value[name]) and isnan(moves.place[name])
