# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Polygons close and are to scale; pictures say what is in them."""
from dataclasses import replace
from itertools import combinations
from math import hypot
from string import printable

from fourbar_lab.drawing.figure import make_figure
from fourbar_lab.drawing.labels import as_mathtext, as_written, labels_of, plain, significant
from fourbar_lab.drawing.polygons import polygons_of, renamed, sides_of
from fourbar_lab.drawing.sheet import nice
from fourbar_ros import Bodies, Body, FourBar
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.machine.structure import BASE
from fourbar_ros.mechanisms.picture import Diagram, diagram_of
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.sliders import InvertedSlider, SliderCrank
from fourbar_ros.scene.files import shipped
from fourbar_ros.scene.scene import from_values, load
import numpy as np
import pytest
from support import contract
from support.samples import some


def cases(count):
    return contract.ordinary_of(('four_bar', 'slider_crank', 'inverted_slider'), 132, count)


def test_polygons_close():
    """Parts in a chain end where a sum from the pole ends; to 1e-12 of the longest arrow."""
    for mechanism, given in cases(8):
        motion = mechanism.motion(*given)
        for arrows in polygons_of(mechanism, motion):
            longest = max(hypot(*arrow.vector) for arrow in arrows)
            ends = [arrow.vector for arrow in arrows if arrow.is_sum]
            starts = [arrow.start for arrow in arrows]
            assert all(np.array_equal(arrow.start, (0.0, 0.0)) for arrow in arrows if arrow.is_sum)
            for arrow in arrows:
                end = arrow.start + arrow.vector
                assert min(hypot(*(end - other)) for other in ends
                           + starts) <= 1e-12 * longest, arrow.label


def test_sums_are_the_motion_of_the_joints():
    motion = SliderCrank(0.1, 0.3, 0.02).motion(0.7, 30.0, 4.0)
    velocity = {arrow.label: arrow.vector
                for arrow in polygons_of(SliderCrank(0.1, 0.3, 0.02), motion)[0]}
    assert velocity['V_B'] == pytest.approx((motion.slide_velocity, 0.0), abs=1e-14)
    inverted = InvertedSlider(0.1, 0.3, 0.02)
    motion = inverted.motion(0.7, 30.0, 4.0)
    arrows = {arrow.label: arrow.vector for arrow in polygons_of(inverted, motion)[1]}
    assert (hypot(*arrows['A_{Cor}'])
            == pytest.approx(abs(2.0 * motion.omega4 * motion.slide_velocity), rel=1e-14))
    assert hypot(*arrows['A_{rel}']) == pytest.approx(abs(motion.slide_acceleration), rel=1e-14)
    assert hypot(*arrows['A_A']) == pytest.approx(0.1 * hypot(30.0**2, 4.0), rel=1e-14)


def test_joints_keep_the_lengths():
    for mechanism, given in cases(3):
        places = diagram_of(mechanism, mechanism.motion(*given)).joints
        assert hypot(*(places['A'] - places['O_1'])) == pytest.approx(mechanism.a1, rel=1e-14)
        if hasattr(mechanism, 'a2'):
            assert hypot(*(places['B'] - places['A'])) == pytest.approx(mechanism.a2, rel=1e-12)


def test_a_crank_with_two_joints_beside_its_pivot_is_a_triangle():
    dyads = [Dyad(name, 'RRR', on_crank, Point('ground', along), (f'{name}_rod', f'{name}_rocker'),
                  length_1=1.0, length_2=0.8) for name, on_crank, along in (
                      ('one', Point('crank', 0.3), 1.0), ('two', Point('crank', 0.1, 0.3), -1.0))]
    machine = Machine(dyads)
    diagram = diagram_of(machine, machine.motion(0.5))
    corners = [diagram.joints[name] for name in (BASE, 'one_first', 'two_first')]
    for ends in combinations(corners, 2):
        assert any(np.allclose(sorted(map(tuple, bar[:2])), sorted(map(tuple, ends)))
                   for bar in diagram.bars)


def test_letters_stay_where_a_point_takes_a_name():
    linkage = load('watt').linkage
    before, after = (labels_of(diagram_of(machine, machine.motion(1.0))).letters for machine in (
        linkage, replace(linkage, joint_names={'one_first': 'B', 'two_first': 'knee'})))
    assert before['one_inner'] == 'B' and after['one_first'] == 'B'
    assert after == {**before, 'one_first': 'B', 'one_inner': 'B_1', 'two_first': 'knee'}
    jansen = load('jansen').linkage
    assert {'pin', 'hip', 'knee'} <= {*labels_of(diagram_of(jansen, jansen.motion(1.0))).joints}


@pytest.mark.parametrize('name', ['andrews', 'peaucellier'])
def test_each_force_has_a_symbol_of_its_own(name):
    """O_1 is a letter, O1 was the first force at O too."""
    linkage = load(name).linkage
    low, high = linkage.input_ranges[0]
    symbols = labels_of(diagram_of(linkage, linkage.motion(0.5 * (low + high)))).forces.values()
    assert len({*map(as_written, symbols)}) == len(symbols)
    assert any(',1' in symbol for symbol in symbols)


def test_a_dyad_may_be_called_as_a_pivot_is():
    names = {'PRO_arm_inner': 'knee', 'base': 'hip'}
    machine = Machine([Dyad('PRO_arm', 'RRR', Point('crank', 0.4), Point('ground', 1.0),
                            ('coupler', 'rocker'), length_1=1.2, length_2=0.8)],
                      joint_names=names)
    assert diagram_of(machine, machine.motion(0.5)).names == names


def glyphs_of(mathtext):
    from matplotlib.mathtext import MathTextParser
    return ''.join(chr(glyph[2]) for glyph in MathTextParser('path').parse(f'${mathtext}$').glyphs)


def test_names_are_drawn_as_they_are_written():
    names = ['tip_left', 'P_2_3', '$P$', 'x^2', 'B__', 'a b', "knee'", 'Ärm', 'l\\mu', 'B_10',
             *(f'AB{sign}C' for sign in printable[:95])]
    for name in names:
        mathtext = as_mathtext(name)
        assert glyphs_of(mathtext) == name and as_written(mathtext) == name
    assert as_mathtext('B_1') == 'B_1' and plain('B_1') == 'B1' and plain('tip_left') == 'tip_left'
    assert plain('F_{A1}') == 'FA1'
    machine = replace(load('watt').linkage, joint_names={'one_first': 'a_b$', 'two_first': 'x^2'})
    labels = labels_of(diagram_of(machine, machine.motion(1.0)))
    assert {'a_b$', 'x^2'} <= {*map(as_written, labels.joints)}
    assert glyphs_of(labels.forces['two_first']) == 'Fx^2'


def test_a_title_and_a_legend_show_names_as_they_are_written():
    values = {**load('paper').values, 'points.my_tip.link': 'coupler', 'points.a_b.link': 'output'}
    scene = replace(from_values(values), name='x$y$z_1')
    axis = scene.plot('my_tip.speed', 'a_b.speed', width='200mm').axes[0]
    assert axis.get_title().startswith(r'x\$y\$z_1: ')
    assert {'my_tip.speed', 'a_b.speed'} <= {text.get_text() for text in axis.texts}
    assert scene.plot('my_tip.speed', title='$x$').axes[0].get_title() == '$x$'


@pytest.mark.parametrize('name, joint', [('paper', 'A'), ('paper', 'O_4'), ('watt', 'one_first'),
                                         ('jansen', 'lower_inner'), ('jansen', 'lower_first')])
def test_names_given_to_a_figure_win(name, joint):
    scene = load(name)
    motion = scene.linkage.motion(1.0, 2.0)
    of_scene = labels_of(diagram_of(scene.linkage, motion))
    assert joint in of_scene.letters or joint in of_scene.joints
    figure = make_figure(scene.linkage, motion, names={joint: 'my_own'})
    shown = [[as_written(text.get_text()).strip('$') for text in axes.texts]
             for axes in figure.axes]
    assert 'my_own' in shown[0] and (joint == 'O_4' or 'V_{my_own}' in shown[1])
    letter = of_scene.letters.get(joint, joint)
    assert letter not in shown[0] and f'V_{{{letter}}}' not in shown[1]


def test_no_two_of_many_joints_share_a_letter():
    # more joints than letters: after A_1 for A, which a point is called, A_1 comes in turn too
    joints = {f'j{i}': np.array([1.0 + i, 0.0]) for i in range(60)}
    diagram = Diagram(joints, (), (), (), {}, {}, {'j59': 'A'})
    assert len({*labels_of(diagram).letters.values()}) == len(labels_of(diagram).joints) == 60


@pytest.mark.parametrize('value, expected', [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (4.9, 2.0),
                                             (73.0, 50.0), (0.3, 0.2),
                                             (9e-7, 5e-7)])
def test_scale_bars_are_round(value, expected):
    assert nice(value) == pytest.approx(expected, rel=1e-14)


CRANK = {'linkage.kind': 'machine', 'linkage.dyads': ['d'], 'linkage.points.A.link': 'crank',
         'linkage.points.A.along': 0.1, 'linkage.points.C.x': 0.3, 'linkage.points.C.y': 0.05,
         'dyads.d.links': ['one', 'two'], 'drive.speed': 10.0}


@pytest.mark.parametrize('dyad', [
    {'kind': 'RPR', 'first': 'C', 'second': 'A'}, {'kind': 'RPR', 'first': 'A', 'second': 'C'},
    {'kind': 'RRP', 'first': 'A', 'second': 'C', 'length_1': 0.3, 'direction_2': 0.2},
    {'kind': 'RRR', 'first': 'A', 'second': 'C', 'length_1': 0.3, 'length_2': 0.2},
    {'kind': 'RPP', 'first': 'A', 'second': 'C', 'slot': 1.2, 'direction_2': 0.2}],
    ids=lambda dyad: f'{dyad["kind"]} at {dyad["first"]}')
def test_velocities_have_the_letters_of_the_joints_that_have_them(dyad):
    """Against differences of positions: a bar in a block on the ground gave its pivot V_C."""
    machine = from_values({**CRANK, **{f'dyads.d.{name}': value
                                       for name, value in dyad.items()}}).linkage
    x, step, speed = 1.0, 1e-6, 10.0
    there, before, after = (diagram_of(machine, machine.motion(at, speed)).joints
                            for at in (x, x - step, x + step))
    diagram = diagram_of(machine, machine.motion(x, speed))
    letters = labels_of(diagram).letters
    sums = sides_of(polygons_of(machine, machine.motion(x, speed))[0], letters, 1e-9)
    velocities = {f'V_{{{letters[name]}}}': speed * (after[name] - before[name]) / (2.0 * step)
                  for name in there}
    moving = {label for label, velocity in velocities.items() if hypot(*velocity) > 1e-9}
    assert {arrow.label for arrow in sums if arrow.is_sum} == moving
    for arrow in sums:
        assert arrow.vector == pytest.approx(velocities[arrow.label], abs=1e-9 * speed)


BODIES = Bodies(Body(1.0, cg_along=0.1, inertia=0.01), Body(2.0, cg_along=0.2, inertia=0.02),
                Body(1.0, cg_along=0.1, inertia=0.01))


@some('mechanism, value', [
    (FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES), 1.0), (SliderCrank(0.4, 1.2, -0.1, bodies=BODIES),
                                                        1.0),
    (InvertedSlider(0.4, 1.2, 0.1, bodies=BODIES), 1.0),
    (SliderCrank(0.4, 1.2, input='slide', bodies=BODIES), 1.0)], 2)
def test_pictures_have_equal_scales_and_all_labels(mechanism, value):
    pytest.importorskip('matplotlib')
    from fourbar_lab.drawing.figure import make_figure
    motion, loads = mechanism.step(value, 5.0, 1.0)
    figure = make_figure(mechanism, motion, loads, 'title')
    figure.canvas.draw()
    for axes in figure.axes:
        (left, bottom), (right, top) = axes.transData.transform([(0.0, 0.0), (1.0, 1.0)])
        assert (right - left) == pytest.approx(top - bottom, rel=1e-9)
    words = [[text.get_text() for text in axes.texts] for axes in figure.axes]
    assert {f'${name}$' for name in diagram_of(mechanism, motion).joints} <= set(words[0])
    assert any(f'{significant(loads.f41)} N' in text for text in words[0])
    for arrow in polygons_of(mechanism, motion)[0]:
        size = significant(hypot(*arrow.vector))
        assert f'${arrow.label}$' in words[1] and f'${arrow.label}$ = {size}' in words[1]


def test_an_arrow_is_as_long_as_its_scale_bar_says():
    pytest.importorskip('matplotlib')
    from fourbar_lab.drawing.figure import make_figure
    mechanism = FourBar(0.4, 1.2, 0.8, 1.0)
    figure = make_figure(mechanism, mechanism.motion(1.0, 25.0))
    velocities = figure.axes[1]
    bar, = (line for line in velocities.lines if len(line.get_xdata()) == 2)
    text, = (text.get_text() for text in velocities.texts if text.get_text().endswith(' m/s'))
    # axes in m/s
    assert np.ptp(bar.get_xdata()) == pytest.approx(float(text.split()[0]), rel=1e-12)


@some('name, at, texts', [
    ('paper', 1.0, (r'\theta_1', r'\theta_4', 'T_{41}', 'A', 'B', 'O_1', 'O_4')),
    ('slider_crank', 1.0, (r'\theta_1', r'\mathrm{middle}', 'T_{41}')),
    ('cylinder', 1.5, (r'\theta_1', r'\theta_4', r'\mathrm{tip}'))], 1)
def test_a_scene_is_drawn_with_all_that_it_has(name, at, texts):
    """Angles, rates, torque, points, centres of gravity, both scales; arrows over the pivots."""
    pytest.importorskip('matplotlib')
    from fourbar_lab.drawing.figure import make_figure
    from matplotlib.patches import Wedge
    its = load(name)
    motion, loads = its.linkage.step(at, its.drive.speed)
    figure = make_figure(its.linkage, motion, loads, 'title',
                         {n: tuple(p) for n, p in its.points.items()})
    axes = figure.axes[0]
    words = [text.get_text() for text in axes.texts]
    assert {f'${text}$' for text in texts} <= set(words)
    assert (any(word.endswith(' m') for word in words)
            and sum(word.endswith(' N') and word[0].isdigit() for word in words) == 1)
    assert any(f'{significant(motion.omega1)} rad/s' in word for word in words)
    assert any(word == f'shaking force {significant(loads.shaking_force)} N' for word in words)
    places = [point_motion(its.linkage, motion, link, body.cg_along, body.cg_across).place
              for link, body in its.linkage.bodies._asdict().items() if body.mass]
    drawn = {tuple(np.round(patch.center, 12)) for patch in axes.patches
             if isinstance(patch, Wedge)}
    assert drawn == {tuple(np.round(place, 12)) for place in places}
    pivots = max(line.get_zorder() for line in axes.lines)
    arrows = [text for text in axes.texts if getattr(text, 'arrow_patch', None)]
    assert len(arrows) >= 3 and all(arrow.get_zorder() > pivots for arrow in arrows)
    tips = [point_motion(its.linkage, motion, *point).place for point in its.points.values()]
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    assert all((low < tip).all() and (tip < high).all() for tip in [*tips, *places])


@pytest.mark.parametrize('label, expected', [('V_A', 'V_{B}'), ('V_{B/A}', 'V_{C/B}'),
                                             ('A_{B/A}^n', 'A_{C/B}^n'), ('A', 'B'),
                                             ('A_{Cor}', 'A_{Cor}'), ('V_{rel}', 'V_{rel}'),
                                             ('O_1', 'O_2'), ('A_B^t', 'A_{C}^t')])
def test_letters_of_another_document(label, expected):
    assert renamed(label, {'O_1': 'O_2', 'A': 'B', 'B': 'C'}) == expected


@pytest.mark.parametrize('value, text', [(18123.4, '18120'), (0.25, '0.25'), (-0.0, '0'),
                                         (1e-5, '1e-05'), (3.14159, '3.142'),
                                         (123456789.0, '1.235e+08'), (0.0012346, '0.001235')])
def test_numbers_in_pictures_are_readable(value, text):
    assert significant(value) == text


QUICK = 'stephenson', 'watt'
POSES = 24
SHARE = 0.02           # of labels that may be crossed, covered or outside


def faults_of(axes, canvas):
    """Return how many labels axes have, and which are crossed, covered or outside."""
    from matplotlib.path import Path
    renderer, to_pixels = canvas.get_renderer(), axes.transData.transform
    labels = [text for text in axes.texts if text.get_text() and text.get_zorder() == 8]
    boxes = [text.get_window_extent(renderer).padded(-1.0) for text in labels]
    lines = [(to_pixels(line.get_xydata()), line.get_linewidth() * axes.figure.dpi / 144.0)
             for line in axes.lines if len(line.get_xdata()) > 1]
    lines += [(to_pixels([text.xyann, text.xy]), 1.0) for text in axes.texts
              if getattr(text, 'arrow_patch', None)]
    inside = axes.get_window_extent(renderer).padded(2.0)
    wrong = []
    for text, box in zip(labels, boxes):
        if (any(other is not box and box.overlaps(other) for other in boxes)
                or any(Path(points).intersects_bbox(box.padded(half), filled=False)
                       for points, half in lines)
                or not (inside.contains(*box.min) and inside.contains(*box.max))):
            wrong.append(text.get_text())
    return len(labels), wrong


def labels_over_a_cycle(name):
    """Return the number of labels of a mechanism with its forces, and those at fault."""
    from fourbar_lab.drawing.figure import new_figure
    from fourbar_lab.drawing.mechanism_panel import draw_pose
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    scene, count, wrong = load(name), 0, []
    low, high = max(scene.linkage.input_ranges, key=lambda ends: ends[1] - ends[0])
    for k in range(POSES):
        motion, loads = scene.linkage.motion_and_loads(
            low + (k + 0.5) / POSES * (high - low), scene.drive.speed)
        with new_figure(4.2, 3.74) as figure:
            canvas, axes = FigureCanvasAgg(figure), figure.add_axes((0.0, 0.0, 1.0, 1.0))
            labels = labels_of(diagram_of(scene.linkage, motion))
            draw_pose(axes, scene.linkage, motion, loads, scene.points, labels, ('m', 1.0), '')
            figure.draw_without_rendering()
            in_pose, at_fault = faults_of(axes, canvas)
        count += in_pose
        wrong += [(k, text) for text in at_fault]
    return count, wrong


@pytest.mark.parametrize('name', QUICK)
def test_labels_of_six_bars_are_free(name):
    pytest.importorskip('matplotlib')
    count, wrong = labels_over_a_cycle(name)
    assert len(wrong) < SHARE * count, wrong


@pytest.mark.slow
def test_labels_of_all_scenes_are_free():
    pytest.importorskip('matplotlib')
    faults = {name: labels_over_a_cycle(name) for name in shipped()}
    total, wrong = sum(count for count, _ in faults.values()), {
        name: (len(at_fault), count) for name, (count, at_fault) in faults.items() if at_fault}
    assert sum(at_fault for at_fault, _ in wrong.values()) < SHARE * total, (wrong, total)
