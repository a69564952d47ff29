# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page shows is what the core computes: cycles, pictures, charts, links, dragging."""
from math import degrees, hypot, pi, remainder
import re
from xml.etree import ElementTree

from fourbar_lab.drawing.collineation import instant_centre
from fourbar_lab.drawing.polygons import acceleration_polygon, velocity_polygon
from fourbar_lab.live import charts
from fourbar_lab.live import link as links
from fourbar_lab.live.model import shown
from fourbar_lab.live.picture import (
    document,
    joints_of,
    LAYERS,
    mechanism_svg,
    mechanism_view,
    polygon_svg,
    polygon_view,
    POLYGONS,
)
from fourbar_lab.live.svg import HEIGHT, WIDTH
from fourbar_ros.cli.main import main
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.picture import diagram_of, forces_of
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.scene.files import find, folder
from fourbar_ros.scene.scene import load
import numpy as np
import pytest
from support.samples import some

EPS = 2.0**-52
SVG = '{http://www.w3.org/2000/svg}'
SCENES = sorted(file.stem for file in folder().glob('*.yaml'))


def texts_of(svg):
    """Return the texts of a picture, indices beside their letters."""
    return [''.join(text.itertext()).replace('\u200b', '') for text in ElementTree.fromstring(
        document(svg)).iter('{http://www.w3.org/2000/svg}text')]


def shown_of(name):
    return shown(load(find(name)).values)


@pytest.mark.parametrize('name', SCENES)
def test_a_curve_passes_through_every_pose(name):
    found = shown_of(name)
    assert set(found.usual_quantities) <= set(found.quantities)
    names = [name for name in found.usual_quantities if '.' not in name]
    inputs, *columns = found.curves(names).values
    for position, pose in found.samples(37):
        here = np.flatnonzero(np.abs(inputs - found.shown_input(position)) <= 1e-9)
        assert here.size
        for name, column in zip(names, columns):
            value = getattr(pose.loads if hasattr(pose.loads, name) else pose.motion, name)
            assert column[here] == pytest.approx(value, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize('name', SCENES)
def test_pictures_are_svg_with_every_joint_where_it_is(name):
    found = shown_of(name)
    view = mechanism_view(found)
    for _, pose in found.samples(9)[1:-1:3]:
        root = ElementTree.fromstring(document(mechanism_svg(
            found, pose, view, LAYERS.keys())))
        pins = [(float(pin.get('cx')), float(pin.get('cy'))) for pin in root.iter(
            '{http://www.w3.org/2000/svg}circle') if pin.get('class') == 'pin']
        joints = diagram_of(found.linkage, pose.motion).joints.values()
        assert len(pins) == len(joints)
        for pin, place in zip(pins, joints):
            assert np.allclose(pin, view.pixel(place), atol=0.051)      # one decimal of a pixel
        for polygon in (velocity_polygon, acceleration_polygon):
            arrows = polygon(found.linkage, pose.motion)
            ElementTree.fromstring(document(polygon_svg(arrows, polygon_view([arrows]), 'm/s')))


def test_force_labels_have_the_values_of_the_core():
    found = shown_of('paper')
    seen = set()
    for _, pose in found.samples(19):
        text = mechanism_svg(found, pose, mechanism_view(found))
        for number, value in re.findall(r'F(\d+) = (\S+) N', ' '.join(texts_of(text))):
            seen.add(number)        # four digits
            assert float(value) == pytest.approx(getattr(pose.loads, f'f{number}'), rel=5e-4)
    assert seen == {'41', '21', '32', '43'}


def test_joints_with_words_for_names_have_one_letter_a_place():
    found = shown_of('jansen')
    pose = found.pose(1.0)
    text = mechanism_svg(found, pose, mechanism_view(found))
    texts = texts_of(text)
    letters = [text for text in texts if re.fullmatch(r'[A-Z]\d?', text)]
    joints = diagram_of(found.linkage, pose.motion).joints
    places = {tuple(np.round(place, 9)) for place in joints.values()}
    assert len(letters) == len(set(letters)) == len(places)
    symbols = dict(re.findall(r'F([A-Z]\d?) = (\S+) N', ' '.join(texts)))
    assert symbols and {symbol[0] for symbol in symbols} <= {letter[0] for letter in letters}
    for name, symbol in found.labels.forces.items():        # each has its own force
        value = symbols.get(re.sub('[F_{}]', '', symbol))
        if value:
            assert float(value) == pytest.approx(getattr(pose.loads, name), rel=5e-4)
    arrows = velocity_polygon(found.linkage, pose.motion)
    texts = texts_of(polygon_svg(arrows, polygon_view([arrows]), 'm/s', found.labels.letters))
    assert any(text.startswith('VA = ') for text in texts) and 'upper' not in ''.join(texts)
    assert len(texts) == len(set(texts))        # joints at one place have one arrow


def test_curves_that_go_to_infinity_are_cut_off_above_their_extrema():
    found = shown_of('slides_7_6')
    names = found.usual_quantities
    extrema, curves = found.extrema(names), found.curves(names)
    source = charts.over_input(found, names, extrema)['dataset'][0]['source']
    for name, values in zip(names, curves.values[1:]):
        kept = [abs(value) for value in source[name] if value is not None]
        assert max(kept) < 0.1 * np.nanmax(np.abs(values)) and len(kept) > 0.9 * len(values)
        assert all(abs(one.value) <= 1.01 * max(kept) for one in extrema
                   if one.quantity == name and one.place == 'interior')
    full = shown_of('paper')
    source = charts.over_input(full, ['omega4', 'shaking_force'], [])['dataset'][0]['source']
    assert all(None not in column for column in source.values())


@pytest.mark.parametrize('name', ['paper', 'slider_crank', 'cylinder'])
def test_instant_centres_are_at_rest_and_obey_kennedy(name):
    found = shown_of(name)
    motion = found.samples(4)[1][1].motion
    links = {link.name: found.linkage.link_motion(motion, link.name)
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
        (e.quantity, e.value) for e in find_extrema(found.linkage, names, found.rate,
                                                    conditions=False)]
    options = charts.over_input(found, names, extrema)
    marks = [mark for series in options['series']
             for mark in series.get('markPoint', {}).get('data', [])]
    assert sorted(mark['coord'][1] for mark in marks) == sorted(e.value for e in extrema)
    for series, name in zip(options['series'], names):
        source = options['dataset'][0]['source']
        points = np.array([p for p in zip(source['x'], source[series['encode']['y']])
                           if p[0] is not None], float)
        assert np.all(np.diff(points[:, 0]) > 0.0) and len(points) == 361
        for mark in series['markPoint']['data']:        # on the curve, within its spacing
            near = np.argmin(abs(points[:, 0] - mark['coord'][0]))
            span = np.ptp(points[:, 1])
            assert abs(points[near, 1] - mark['coord'][1]) <= 0.02 * span


@some('name', SCENES, ('paper', 'jansen', 'cylinder', 'scotch_yoke'))
def test_joints_that_can_be_dragged_are_those_that_move(name):
    found = shown_of(name)
    view = mechanism_view(found)
    places = np.array([joints_of(found, pose, view) for _, pose in found.samples(60)])
    assert places.shape[1] and (np.ptp(places, axis=0).max(axis=1) > 1.0).all()
    assert (places >= 0.0).all() and (places <= (WIDTH, HEIGHT)).all()


@some('name', SCENES, ('paper', 'jansen', 'cylinder', 'scotch_yoke'))
@pytest.mark.parametrize('kind', ['mechanism', 'velocity', 'acceleration'])
def test_no_arrow_and_no_label_leaves_the_picture_or_covers_another(name, kind):
    found = shown_of(name)
    view = mechanism_view(found)
    polygon, _ = POLYGONS.get(kind, (None, ''))
    covered = labels = 0
    view = view if polygon is None else polygon_view([
        polygon(found.linkage, pose.motion) for pose in found.poses])
    for pose in found.poses[::4]:
        svg = (mechanism_svg(found, pose, view) if polygon is None
               else polygon_svg(polygon(found.linkage, pose.motion), view, 'm/s',
                                found.labels.letters))
        boxes = []
        for text in ElementTree.fromstring(document(svg)).iter(f'{SVG}text'):
            # 0.64 em a letter of 15 px: digits of the widest serif fonts in use
            words = ''.join(text.itertext()).replace('\u200b', '')
            width, x, y = 9.6 * len(words), float(text.get('x')), float(text.get('y'))
            left = x - width if text.get('text-anchor') == 'end' else x
            assert 0.0 <= left and left + width <= WIDTH, words
            assert 14.0 <= y <= HEIGHT - 4.0, words
            boxes.append((left, y - 10.0, left + 0.85 * width, y))
        covered += sum(a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
                       for i, a in enumerate(boxes) for b in boxes[:i])
        labels += len(boxes)
    assert covered <= 0.02 * labels, f'{covered} of {labels} labels cover another'


def test_forces_of_every_pose_have_room():
    for name in ('paper', 'jansen', 'andrews', 'slider_crank'):
        found = shown_of(name)
        view = mechanism_view(found)
        scale = view.per_newton
        for pose in found.poses:
            for force in forces_of(diagram_of(found.linkage, pose.motion), pose.loads):
                tip = np.array(view.pixel(force.point + scale * force.vector))
                if hypot(*view.length(scale * force.vector)) <= 0.3 * HEIGHT:
                    assert (tip >= 0.0).all() and (tip <= (WIDTH, HEIGHT)).all(), (name, force)


@pytest.mark.parametrize('name', ['paper', 'jansen'])
def test_an_angle_is_the_same_after_any_number_of_turns(name):
    found = shown_of(name)
    for turns in (-1000, -93, -2, -1, 0, 1, 2, 3, 92, 1000):
        for angle in (-3.0, -0.5, 0.0, 1.0, 3.1):
            reached = found.nearest_input(angle + turns * 2.0 * pi)
            # the turns themselves are rounded
            assert 0.0 <= reached <= 2.0 * pi and abs(remainder(
                reached - angle, 2.0 * pi)) <= 8 * EPS * (1 + 7 * abs(turns))
    partly = shown_of('slides_7_6')
    low, high = partly.ranges[0]
    for turns in (-5, 0, 4):
        assert partly.nearest_input(0.5 * (low + high) + turns * 2.0 * pi) == pytest.approx(
            0.5 * (low + high), abs=64 * EPS * 30)


def test_a_full_turn_begins_at_0_as_in_plots():
    found, slide = shown_of('paper'), shown_of('cylinder')
    assert found.ranges == ((0.0, 2.0 * pi),)
    inputs = charts.over_input(found, ['theta4'], ())['dataset'][0]['source']['x']
    assert (inputs[0], inputs[-1]) == (0.0, 360.0) and slide.ranges == slide.linkage.input_ranges


def test_a_cycle_of_a_kite_is_two_turns():
    kite = shown({'linkage.a1': 0.2, 'linkage.a2': 0.5, 'linkage.a3': 0.5, 'linkage.a4': 0.2})
    assert kite.ranges == ((0.0, 4.0 * pi),) and kite.bounds == (0.0, 720.0)
    for angle, reached in ((7.0, 7.0), (-1.0, 4.0 * pi - 1.0), (4.0 * pi + 1.0, 1.0)):
        assert kite.nearest_input(angle) == pytest.approx(reached, abs=1e-14)
    assert kite.samples(91)[-1][0] > 12.4


def test_an_angle_below_a_range_beyond_half_a_turn_is_found_a_turn_later():
    evans = shown_of('evans')
    low, high = evans.ranges[0]
    assert low < pi < high - 1.0                     # 2.33 to 7.44
    for angle in (0.5, 0.9, 3.0, -1.0):
        later = angle if angle > low else angle + 2.0 * pi
        assert evans.nearest_input(angle) == pytest.approx(later, abs=16 * EPS)


@pytest.mark.parametrize('name', SCENES)
def test_frames_cover_the_ranges_and_every_one_is_a_pose(name):
    found = shown_of(name)
    inputs = np.array([position for position, _ in found.samples(181)])
    steps = []
    for low, high in found.ranges:
        inside = inputs[(inputs >= low) & (inputs <= high)]
        assert np.ptp(inside) >= 0.97 * (high - low)
        steps.append(np.diff(inside).max() / (high - low))
    assert max(steps) < 0.03 * len(found.ranges)
    assert len(inputs) <= 200 * found.linkage.turns
    assert all(found.pose(position)[0] == 0 for position in inputs)


def test_links_carry_the_state_and_read_back():
    values = load(find('paper')).values
    changed = values | {'linkage.a2': 1.1 + 2.0**-40, 'linkage.mode': 1}
    query = dict(part.split('=') for part in links.address(
        links.PageAddress('paper', values, changed, 61.5, 0.25)).split('&'))
    _, first, found, at, acceleration = links.read(query, 'paper', values)
    assert first == values
    assert (at, acceleration) == (61.5, 0.25)
    assert found['linkage.a2'] == changed['linkage.a2'] and found['linkage.mode'] == 1
    assert shown(found).linkage.a2 == changed['linkage.a2']


@pytest.mark.parametrize(('query', 'why'), [
    ({'scene': '/etc/passwd'}, 'this page shows paper'),
    ({'scene': '../paper'}, 'this page shows paper'),
    ({'linkage.a9': '1'}, 'unknown parameter'),
    ({'at': 'x'}, 'must be a finite number'),
    ({'acceleration': 'true'}, 'must be a finite number'),
    ({'at': '.nan'}, 'must be a finite number'), ({'at': 'nan'}, 'must be a finite number'),
    ({'at': '-.inf'}, 'must be a finite number'), ({'at': '1e999'}, 'must be a finite number'),
    ({'at': '9' * 400}, 'must be a finite number'), ({'at': '9' * 5000}, 'finite number'),
    ({'acceleration': '.inf'}, 'must be a finite number'),
    ({'nothing': '9' * 400}, 'unknown parameter'),
    ({'forces.g.link': 'output', 'forces.g.acts': 'couple', 'forces.g.table': '/dev/null'},
     'only the file of a scene names that of a table')])
def test_bad_links_are_refused_and_read_no_file(query, why):
    with pytest.raises(InvalidParameter, match=re.escape(why)):
        shown(links.read(query, 'paper', load(find('paper')).values).values)


@pytest.mark.parametrize('digits', [309, 400, 4000, 5000])
def test_a_number_of_many_digits_in_a_link_is_an_error_of_ours(digits):
    values = load(find('paper')).values
    for name in ('linkage.a1', 'linkage.mode', 'drive.speed', 'linkage.kind'):
        for sign in ('', '-'):
            with pytest.raises(FourBarError) as caught:
                shown(links.read({name: sign + '9' * digits}, 'paper', values).values)
            assert len(str(caught.value)) < 300


def test_a_link_to_another_shipped_scene_shows_that():
    link = links.read({'scene': 'cylinder'}, 'paper', load(find('paper')).values)
    assert link.title == 'cylinder' and link.values['linkage.kind'] == 'inverted_slider'


@pytest.mark.parametrize('port', [-1, 65536, 99999, 10**30])
def test_what_is_no_port_is_one_line(port, capsys):
    pytest.importorskip('nicegui')
    assert main(['live', 'paper', '--no-browser', '--port', str(port)]) == 1
    said = capsys.readouterr().err
    assert f'--port {port}: must be an integer from 0 to 65535' in said and said.count('\n') == 1


def test_inputs_are_shown_in_the_unit_of_the_page():
    crank, slide = shown_of('paper'), shown_of('cylinder')
    assert crank.shown_input(pi) == degrees(pi) and crank.input_unit == 'deg'
    assert slide.shown_input(1.5) == 1.5 and slide.input_unit == 'm'
    middle = point_motion(crank.linkage, crank.pose(1.0).motion, *crank.points['middle'])
    assert np.isfinite(middle.place).all()


def test_the_input_of_a_crank_with_a_range_goes_over_it_and_no_further():
    page = shown({**load('paper').values, 'linkage.range': [-3.0, -2.0], 'drive.start': -2.5})
    assert page.ranges == ((-3.0, -2.0),)
    inputs = [position for position, _ in page.samples(9)]
    assert -3.0 <= min(inputs) < -2.9 and -2.1 < max(inputs) <= -2.0
    for position, nearest in ((3.5, -2.783), (-2.5, -2.5), (0.0, -2.0), (-3.1, -3.0)):
        assert page.nearest_input(position) == pytest.approx(nearest, abs=1e-3)
