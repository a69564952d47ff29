# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Curves over the input with their extrema."""
from fourbar_lab.drawing.curves import curves_of, extrema_of, make_figure, marks_of
from fourbar_lab.drawing.record import properties_of
from fourbar_lab.drawing.tables import facts
from fourbar_ros import find_extrema, InvalidParameter
from fourbar_ros.mechanisms.quantities import select, UnknownQuantity
from fourbar_ros.scene.scene import from_values, load
import numpy as np
import pytest

# a change point that repeats after two turns
TWICE = {'linkage.a1': 0.1, 'linkage.a2': 0.5, 'linkage.a3': 0.2, 'linkage.a4': 0.4,
         'drive.speed': 3.0}


@pytest.mark.parametrize('name', ['paper', 'slider_crank', 'cylinder', 'jansen', TWICE],
                         ids=lambda name: 'twice' if name is TWICE else name)
def test_marks_of_extrema_lie_on_their_curves(name):
    """To half the largest second difference: what a polygon leaves at the kink of an amount."""
    scene = from_values(name) if name is TWICE else load(name)
    linkage, speed = scene.linkage, scene.drive.speed
    curves = curves_of(scene, linkage, [one.name for one in select((), linkage)], speed)
    marks = marks_of(linkage, [found for found in find_extrema(linkage, rate=speed)
                               if found.place == 'interior'])
    figure, seen = make_figure(curves, marks), 0
    for axis in figure.axes:
        lines = [line for line in axis.lines if line.get_marker() != 'o']
        for marked in set(axis.lines) - set(lines):
            off = [np.abs(marked.get_ydata() - np.interp(marked.get_xdata(), *line.get_data()))
                   / np.nanmax(np.abs(np.diff(line.get_ydata(), 2))) for line in lines
                   if line.get_color() == marked.get_color()]      # ten colours for more curves
            assert min(np.max(one) for one in off) <= 0.5
            seen += len(marked.get_xdata())
    # one at 0 is at the end of the cycle too
    assert seen == len(marks) + sum(x <= 1e-9 for _, x, _ in marks) > 0


def test_the_path_of_a_point_is_columns_with_extrema_and_not_part_of_all():
    """It was refused: of a point only speed and acceleration had names. Here it is a circle."""
    radius, along, across = 0.1, 0.2, 0.05
    scene = from_values({
        'linkage.a1': radius, 'linkage.a2': 0.3, 'linkage.a3': radius, 'linkage.a4': 0.3,
        'points.p.link': 'coupler', 'points.p.along': along, 'points.p.across': across})
    curves = curves_of(scene, scene.linkage, ['p.x', 'p.y'], 1.0)
    theta1 = np.radians(curves.values[0])
    assert curves.units == ('deg', 'm', 'm')
    assert np.allclose(curves.values[1:], [along + radius * np.cos(theta1),
                                           across + radius * np.sin(theta1)],
                       rtol=0.0, atol=8 * np.finfo(float).eps)
    extrema = extrema_of(scene, scene.linkage, ['p.x', 'p.y'], 1.0)
    assert [(one.quantity, one.kind) for one in extrema] == [
        ('p.x', 'maximum'), ('p.x', 'minimum'), ('p.y', 'maximum'), ('p.y', 'minimum')]
    assert [one.value for one in extrema] == pytest.approx(
        [along + radius, along - radius, across + radius, across - radius], rel=1e-14)
    assert np.allclose([one.theta1 for one in extrema], np.pi * np.array([0.0, 1.0, 0.5, 1.5]),
                       rtol=0.0, atol=1e-9)
    assert [one.name for one in select((), scene.linkage, scene.point_quantities)
            if one.name.startswith('p.')] == ['p.speed', 'p.acceleration']
    assert [name for name in curves_of(scene, scene.linkage, [], 1.0).names
            if name.startswith('p.')] == ['p.x', 'p.y', 'p.speed', 'p.acceleration']
    with pytest.raises(UnknownQuantity, match='there is no point A; a scene has them, of joints'):
        curves_of(scene, scene.linkage, ['A.height'], 1.0)


@pytest.mark.parametrize(('lengths', 'kinds'), [
    ((0.02, 0.04, 0.1, 0.06), 'minimum maximum'), ((0.1, 0.09, 0.08, 0.05), '')],
    ids=['swings over half a turn', 'turns on'])
def test_an_angle_goes_on_where_its_samples_come_round(lengths, kinds):
    """As its extrema do, which are dots on the curve; in a table it is as in messages."""
    scene = from_values(dict(zip(('linkage.a1', 'linkage.a2', 'linkage.a3', 'linkage.a4'),
                                 lengths)))
    linkage = scene.linkage
    curves = curves_of(scene, linkage, ['theta4'], 1.0, samples=1441)
    assert np.nanmax(np.abs(np.diff(curves.values[1]))) > 350.0
    marks = marks_of(linkage, find_extrema(linkage, 'theta4'))
    line, *dots = make_figure(curves, marks).axes[0].lines
    x, theta4 = line.get_data()
    assert np.nanmax(np.abs(np.diff(theta4))) < 90.0
    assert -180.0 < 0.5 * (np.nanmin(theta4) + np.nanmax(theta4)) <= 180.0
    assert np.allclose(np.cos(np.radians(theta4)), np.cos(np.radians(curves.values[1])),
                       rtol=0.0, atol=1e-12, equal_nan=True)
    assert {extremum.kind for extremum, *_ in marks} == set(kinds.split())
    for mark in dots:
        assert np.abs(mark.get_ydata() - np.interp(mark.get_xdata(), x, theta4)).max() <= (
            np.nanmax(np.abs(np.diff(theta4))))


def test_a_cycle_of_a_change_point_is_its_period():
    scene = from_values(TWICE)
    x, theta4, omega4 = curves_of(scene, scene.linkage, ('theta4', 'omega4'), 3.0).values
    assert (x[0], x[-1], x.size) == (0.0, 720.0, 721) and scene.linkage.period == 4.0 * np.pi
    # the second turn is the mirror image of the first one, backwards, and they are joined
    assert np.allclose(theta4, -theta4[::-1], rtol=0.0, atol=1e-12)
    assert np.ptp(omega4[360:] - omega4[:361]) > 3.0
    steps = np.abs(np.diff(theta4))
    assert steps.max() < 3.0 and abs(theta4[-1] - theta4[0]) < 1e-12
    swept, = (row['ranges'] for row in properties_of(scene.linkage)['outputs'])
    assert np.degrees(swept[0]) == pytest.approx([theta4.min(), theta4.max()], abs=0.01)
    assert dict(facts(scene.linkage))['change point'] == (
        'flat at theta1 0 deg, where the motion stays in mode 2; repeats after two turns')
    assert 'change point' not in dict(facts(load('paper').linkage))


@pytest.mark.parametrize('name', ['paper', 'cylinder', 'engine', 'jansen'])
def test_inertia_and_bias_are_the_drive_less_its_acceleration(name):
    """Of T = J alpha + b, with the forces of the scene."""
    scene = load(name)
    linkage = scene.linkage
    curves = curves_of(scene, linkage, ('inertia', 'bias', linkage.drive_load), 2.0, 3.0, 50)
    _, inertia, bias, drive = curves.values
    inside = np.isfinite(drive)
    assert inside.sum() > 40
    assert np.allclose((3.0 * inertia + bias)[inside], drive[inside], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(('name', 'quantity', 'inputs'), [
    ('chebyshev', 'transmission_angle', [36.869897646, 101.536959033]),
    ('engine', 'slide_velocity', [74.499641711, 285.500358289])])
def test_dots_are_at_the_ends_of_ranges_and_in_both_turns_of_a_four_stroke(name, quantity, inputs):
    """Ends where the transmission angle is 0 and 180 had none, nor had the second turn."""
    pytest.importorskip('matplotlib')
    scene = load(name)
    given = scene, scene.linkage, [quantity, 'shaking_force'], scene.drive.speed
    figure = make_figure(curves_of(*given), marks_of(scene.linkage, extrema_of(*given)))
    axis = next(axis for axis in figure.axes if 'force' not in axis.get_ylabel())
    dots = axis.lines[1].get_xdata()
    wanted = ([-x for x in inputs[::-1]] + inputs if name == 'chebyshev' else
              inputs + [x + 360.0 for x in inputs])
    assert sorted(dots) == pytest.approx(wanted, abs=1e-6)


def test_an_output_that_stands_still_is_no_matter_of_speed():
    scene = load('toddlerbot_knee')         # its last link is the rod of a parallelogram
    with pytest.raises(InvalidParameter, match='the output stands still at every input'):
        curves_of(scene, scene.linkage, ['mechanical_advantage'], 1.0)


def test_a_curve_that_is_infinite_at_dead_points_is_drawn_beyond_its_extrema_and_no_farther():
    pytest.importorskip('matplotlib')
    scene = load('scotch_yoke')
    names = ['mechanical_advantage', 'slide']
    curves = curves_of(scene, scene.linkage, names, 1.0)
    assert np.nanmax(np.abs(curves.values[1])) > 1e9
    found = extrema_of(scene, scene.linkage, names, 1.0)
    figure = make_figure(curves, marks_of(scene.linkage, found))
    drawn = figure.axes[0].lines[0].get_ydata()
    assert 20.0 < np.nanmax(drawn) < 1e3 and np.isnan(drawn).sum() < 40
    assert not np.isnan(figure.axes[1].lines[0].get_ydata()).any()
