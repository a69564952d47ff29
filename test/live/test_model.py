# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page shows is what the core computes: cycles, pictures, charts, links, dragging."""
from math import degrees, hypot, pi
import re
from xml.etree import ElementTree

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.live import address, charts
from fourbar_ros.live.course import OverInput
from fourbar_ros.live.dragging import Handle, nearest_input
from fourbar_ros.live.model import shown
from fourbar_ros.live.over_time import OverTime, Run
from fourbar_ros.live.picture import (
    document,
    force_scale,
    Layers,
    LONGEST_FORCE,
    mechanism_svg,
    mechanism_view,
    polygon_svg,
    polygon_view,
)
from fourbar_ros.mechanisms.points import instant_centre, link_motion, point_motion
from fourbar_ros.scene.files import find, folder, read_values
from fourbar_ros.scene.scene import load
import numpy as np
import pytest

EPS = 2.0**-52
SCENES = sorted(file.stem for file in folder().glob('*.yaml'))


def shown_of(name):
    return shown(load(find(name)).values)


@pytest.mark.parametrize('name', SCENES)
def test_a_cycle_is_that_of_the_mechanism(name):
    found = shown_of(name)
    assert len(found.cycles) == len(found.ranges)
    for cycle, (low, high) in zip(found.cycles, found.ranges):
        assert low <= cycle.inputs[0] < cycle.inputs[-1] <= high
        middle = float(cycle.inputs[100])
        status, motion, loads = found.pose(middle)
        assert status == 0
        for field, value in zip(motion._fields, motion):
            column = getattr(cycle.motion, field)
            here = column if np.ndim(column) == 0 else column[100]
            assert here == pytest.approx(value, rel=1e-9, abs=1e-9)
    assert set(found.usual_quantities) <= set(found.quantities)


@pytest.mark.parametrize('name', SCENES)
def test_pictures_are_svg_with_every_joint_where_it_is(name):
    found = shown_of(name)
    view, per_newton = mechanism_view(found), force_scale(found)
    for share in (0.1, 0.5, 0.9):
        inputs = found.cycles[0].inputs
        _, motion, loads = found.pose(float(inputs[int(share * (len(inputs) - 1))]))
        root = ElementTree.fromstring(document(mechanism_svg(
            found, motion, loads, view, per_newton, Layers(True, True, True))))
        pins = [(float(pin.get('cx')), float(pin.get('cy'))) for pin in root.iter(
            '{http://www.w3.org/2000/svg}circle') if pin.get('class') == 'pin']
        joints = found.linkage.diagram(motion).joints.values()
        assert len(pins) == len(joints)
        for pin, place in zip(pins, joints):
            assert np.allclose(pin, view.at(place), atol=0.051)      # one decimal of a pixel
        for polygon in (found.linkage.velocity_polygon, found.linkage.acceleration_polygon):
            ElementTree.fromstring(document(polygon_svg(
                polygon(motion), polygon_view([polygon(motion)]), 'm/s')))


def test_force_labels_have_the_values_of_the_core():
    found = shown_of('paper')
    seen = set()
    for position in found.cycles[0].inputs[::20]:
        _, motion, loads = found.pose(float(position))
        text = mechanism_svg(found, motion, loads, mechanism_view(found), force_scale(found))
        for number, value in re.findall(r'F(\d+) = (\S+) N', text):
            seen.add(number)        # four digits
            assert float(value) == pytest.approx(getattr(loads, f'f{number}'), rel=5e-4)
    assert seen == {'41', '21', '32', '43'}


def test_joints_with_words_for_names_have_one_letter_a_place():
    found = shown_of('jansen')
    _, motion, loads = found.pose(1.0)
    text = mechanism_svg(found, motion, loads, mechanism_view(found), force_scale(found))
    letters = re.findall(r'<text class="" [^>]*>([^<]+)<', text)
    places = {tuple(np.round(place, 9)) for place in found.linkage.diagram(motion).joints.values()}
    assert len(letters) == len(set(letters)) == len(places)
    symbols = dict(re.findall(r'>F([A-Z]\d?) = (\S+) N<', text))
    assert symbols and {symbol[0] for symbol in symbols} <= {letter[0] for letter in letters}
    for name, symbol in found.labels.forces.items():        # each has its own force
        value = symbols.get(re.sub('[F_{}]', '', symbol))
        if value:
            assert float(value) == pytest.approx(getattr(loads, name), rel=5e-4)
    arrows = found.linkage.velocity_polygon(motion)
    svg = polygon_svg(arrows, polygon_view([arrows]), 'm/s', found.labels.letters)
    assert '>VA = ' in svg and 'upper' not in svg


def test_axes_hold_what_can_be_read_of_curves_that_go_to_infinity():
    found = shown_of('slides_7_6')
    names = found.usual_quantities
    extrema = found.extrema(names)
    options = charts.over_input(found, names, extrema, False)
    for axis, name in zip(options['yAxis'], names):
        values = np.concatenate([values for _, values in found.curves(name)])
        assert axis['max'] < 0.1 * np.nanmax(values)
        for extremum in extrema:
            if extremum.quantity == name and extremum.place == 'interior':
                assert axis['min'] <= extremum.value <= axis['max']
    full = shown_of('paper')
    options = charts.over_input(full, ['omega4', 'shaking_force'], [], False)
    assert all(axis['min'] is None is axis['max'] for axis in options['yAxis'])


@pytest.mark.parametrize('name', ['paper', 'slider_crank', 'cylinder'])
def test_instant_centres_are_at_rest_and_obey_kennedy(name):
    found = shown_of(name)
    _, motion, _ = found.pose(float(found.cycles[0].inputs[120]))
    links = {link.name: link_motion(found.linkage, motion, link.name)
             for link in found.linkage.LINKS}
    size = max(map(abs, found.linkage.lengths))
    for link in found.linkage.LINKS:
        its = links[link.name]
        place = instant_centre(its)
        if not np.isfinite(place).all():
            assert its.omega == 0.0
            continue
        arm = place - (its.x, its.y)
        velocity = (its.v_x - its.omega * arm[1], its.v_y + its.omega * arm[0])
        speed = hypot(its.v_x, its.v_y) + abs(its.omega) * (size + hypot(*place))
        assert hypot(*velocity) <= 8.0 * EPS * speed
    one, other = (links[link.name] for link in found.linkage.LINKS[:2])
    p12, p13, p23 = instant_centre(one), instant_centre(other), instant_centre(other, one)
    if all(np.isfinite(p).all() for p in (p12, p13, p23)):          # on one line
        cross = np.linalg.det(np.stack([p13 - p12, p23 - p12]))
        assert abs(cross) <= 1e-9 * np.linalg.norm(p13 - p12) * np.linalg.norm(p23 - p12) + 1e-15


def test_charts_mark_the_extrema_of_the_core():
    found = shown_of('paper')
    names = found.usual_quantities
    extrema = found.extrema(names)
    assert [(e.quantity, e.value) for e in extrema] == [
        (e.quantity, e.value) for e in find_extrema(found.linkage, names, found.rate)]
    options = charts.over_input(found, names, extrema, False)
    marks = [mark for series in options['series']
             for mark in series.get('markPoint', {}).get('data', [])]
    assert sorted(mark['coord'][1] for mark in marks) == sorted(e.value for e in extrema)
    for series, name in zip(options['series'], names):
        source = options['dataset'][series['datasetIndex']]['source']
        points = np.array([p for p in zip(source['x'], source[series['encode']['y']])
                           if p[0] is not None], float)
        assert np.all(np.diff(points[:, 0]) > 0.0) and len(points) == 361
        for mark in series['markPoint']['data']:        # on the curve, within its spacing
            near = np.argmin(abs(points[:, 0] - mark['coord'][0]))
            span = np.ptp(points[:, 1])
            assert abs(points[near, 1] - mark['coord'][1]) <= 0.02 * span


@pytest.mark.parametrize('name', SCENES)
def test_a_dragged_joint_follows_the_pointer(name):
    found = shown_of(name)
    view = mechanism_view(found)
    inputs = found.cycles[0].inputs
    start, goal = float(inputs[100]), float(inputs[140])
    _, motion, _ = found.pose(start)
    joints = found.linkage.diagram(motion)
    joint = next(name for name in joints.joints if name not in joints.ground)
    handle = Handle(found, motion, view, view.at(joints.joints[joint]))
    assert handle.joint == joint
    _, there, _ = found.pose(goal)
    pixel = view.at(found.linkage.diagram(there).joints[joint])
    reached = nearest_input(found, handle.input_at(pixel, start))
    _, motion, _ = found.pose(reached)
    assert hypot(*np.subtract(view.at(found.linkage.diagram(motion).joints[joint]),
                              pixel)) <= 2.0        # [px]


def test_a_drag_from_nowhere_moves_nothing():
    found = shown_of('paper')
    assert Handle(found, found.pose(1.0)[1], mechanism_view(found), (1e4, 1e4)).joint == ''


@pytest.mark.parametrize('name', SCENES)
def test_playing_covers_the_range_and_stays_in_it(name):
    found = shown_of(name)
    course = OverInput(found, float(found.cycles[0].inputs[10]))
    low, high = found.ranges[0]
    reached = []
    for _ in range(700):
        course.advance(0.01 * course.pace.value)
        reached.append(course.state().position)
        assert low <= reached[-1] <= high
        assert found.pose(*course.state())[0] == 0
    assert max(reached) - min(reached) >= 0.97 * (high - low)


def test_links_carry_the_state_and_read_back():
    values = load(find('paper')).values
    changed = values | {'linkage.a2': 1.1 + 2.0**-40, 'linkage.mode': 1}
    query = dict(part.split('=') for part in address.address(
        'paper', values, changed, 61.5, 0.25).split('&'))
    _, first, found, at, acceleration = address.read(query, 'paper', values)
    assert first == values
    assert (at, acceleration) == (61.5, 0.25)
    assert found['linkage.a2'] == changed['linkage.a2'] and found['linkage.mode'] == 1
    assert shown(found).linkage.a2 == changed['linkage.a2']


@pytest.mark.parametrize(('query', 'why'), [
    ({'scene': '/etc/passwd'}, 'the link is to the scene /etc/passwd'),
    ({'scene': '../paper'}, 'the link is to the scene ../paper'),
    ({'linkage.a9': '1'}, 'unknown parameter linkage.a9'), ({'at': 'x'}, 'no number'),
    ({'acceleration': 'true'}, 'no number')])
def test_bad_links_are_refused_and_read_no_file(query, why):
    with pytest.raises(address.BadLink, match=re.escape(why)):
        address.read(query, 'paper', load(find('paper')).values)


def test_a_link_to_another_shipped_scene_shows_that():
    link = address.read({'scene': 'cylinder'}, 'paper', load(find('paper')).values)
    assert link.title == 'cylinder' and link.values['linkage.kind'] == 'inverted_slider'


def test_impossible_values_say_why():
    values = load(find('paper')).values
    with pytest.raises(InvalidParameter, match='cannot close'):
        shown(values | {'linkage.a2': 9.0})
    with pytest.raises(FourBarError):
        shown(values | {'linkage.a2': 'long'})


def test_a_run_is_shown_at_its_own_samples():
    found = shown_of('paper')
    times = np.linspace(0.0, 2.0, 401)
    run = Run(times, np.stack([25.0 * times, np.full(401, 25.0), np.zeros(401)]))
    course = OverTime(found, run)
    course.go(1.0012)
    assert course.state() == (25.0 * times[200], 25.0, 0.0)
    options = course.curves(['omega4'], [], False)
    source = options['dataset'][0]['source']
    values = dict(zip(source['x'], source['omega4']))
    motion = found.linkage.motion(25.0 * times[37], 25.0)
    assert values[times[37]] == pytest.approx(motion.omega4, rel=64 * EPS)
    course.go(99.0)
    assert course.at == 2.0


def test_forces_of_a_run_have_room_whatever_speed_the_scene_names():
    values = {**load(find('paper')).values, 'drive.speed': 1.0}
    times = np.linspace(0.0, 0.5, 200)
    rates = np.stack([0.3 + 25.0 * times, np.full(200, 25.0), np.zeros(200)])
    rates[1:, 0] = np.nan                            # not known yet
    course = OverTime(shown(values), Run(times, rates))
    found = shown(values, 0.0, course.speed)
    scale = force_scale(found)
    for at in times[1:]:
        course.go(float(at))
        _, _, loads = found.pose(*course.state())
        for force in (loads.f41, loads.f21, loads.f32, loads.f43):
            assert 0.0 < scale * force < 1.2 * LONGEST_FORCE


def test_scene_files_of_pages_read_back(tmp_path):
    for name in SCENES:
        scene = load(find(name))
        file = tmp_path / f'{name}.yaml'
        file.write_text(scene.as_text)
        again = load(file)
        assert again.linkage == scene.linkage
        assert read_values(file).items() <= scene.values.items()


def test_inputs_are_shown_in_the_unit_of_the_page():
    crank, slide = shown_of('paper'), shown_of('cylinder')
    assert crank.shown_input(pi) == degrees(pi) and crank.input_unit == 'deg'
    assert slide.shown_input(1.5) == 1.5 and slide.input_unit == 'm'
    middle = point_motion(crank.linkage, crank.pose(1.0)[1], *crank.points['middle'])
    assert np.isfinite(middle.place).all()
