# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Forces over a position in scenes: tables beside them, what they mean, why others are refused."""
import json
from math import pi, radians

from fourbar_ros import Applied, point_motion
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.curves import FIXED
from fourbar_ros.mechanisms.elements import LinkAngle, PositionForce, Way
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.pipeline.stepper import Stepper, Wanted
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene import scene
from fourbar_ros.scene.elements import _coordinates
from fourbar_ros.scene.files import read_table, SceneError
from fourbar_ros.scene.simulated import simulate_scene
import numpy as np
import pytest
from support.scenes import PAPER, PUSH, RODS

TURN = 2.0 * pi
PUSHED = {**PAPER, **RODS, **PUSH, 'outputs': ['loads']}
ENGINE = scene.load('engine')


def engine(**changes):
    """Return the shipped engine, driven by its timer, with other parameters."""
    names = {name.replace('__', '.'): value for name, value in changes.items()}
    return scene.from_values({**ENGINE.values, 'drive.source': 'timer', 'drive.start_speed': 0.0,
                              **names})


def write(folder, text, **parameters):
    """Return the path of a scene beside a table."""
    (folder / 'gas.csv').write_text(text, encoding='utf-8')
    rest = {'link': 'output', 'acts': 'along', 'table': 'gas.csv', **parameters}
    lines = ''.join(f'        {name}: {value}\n' for name, value in rest.items())
    path = folder / 'pressed.yaml'
    path.write_text('/**:\n  ros__parameters:\n    linkage:\n      kind: slider_crank\n'
                    '      a1: 0.05\n      a2: 0.2\n    bodies:\n'
                    '      crank: {mass: 1.0, inertia: 0.01}\n'
                    '      coupler: {mass: 1.0, inertia: 0.01}\n      output: {mass: 1.0}\n'
                    '    outputs: [loads]\n    forces:\n      gas:\n' + lines)
    return path


def test_the_engine_holds_its_table_itself():
    """A scene that was read has the numbers, in the units of the file, and no file."""
    values = ENGINE.values
    assert values['forces.gas.table'] == '' and values['forces.gas.value_unit'] == 'bar'
    assert values['forces.gas.places'] == [5.0 * i for i in range(145)]
    gas, = ENGINE.linkage.elements
    assert gas.value.table.span == pytest.approx(2.0 * TURN) and gas.value.table.is_periodic
    assert gas.value(radians(380.0)) == pytest.approx(39.23e5)
    again = scene.from_values(json.loads(ENGINE.as_json))
    assert again.linkage == ENGINE.linkage and again.values.keys() == values.keys()


def test_loads_of_a_given_motion_have_the_force():
    """Statics of the piston and virtual work of the crank: driving torque = -F ds/dtheta."""
    there = engine()
    stepper, place = Stepper(there), there.layout.index_of
    gas, = there.linkage.elements
    for angle in (0.3, TURN + 0.3, 3 * TURN + 1.0, -2.0):
        _, found = stepper.step(angle, 0.0, 0.0, Wanted(with_loads=True))
        force = gas.factor * gas.value(angle)
        ratio = found[place['slide_ratio']]
        assert found[place['driving_torque']] == pytest.approx(-force * ratio, rel=1e-11, abs=1e-9)
        assert found[place['f32_x']] == pytest.approx(force, rel=1e-11)


def test_a_force_and_wrenches_of_a_topic_act_together():
    there = engine(external__output__from_topic=True)
    stepper, place = Stepper(there), there.layout.index_of
    gas, = there.linkage.elements
    stepper.act('output', Wrench(-70.0, 0.0, 0.0))
    _, found = stepper.step(0.3, 0.0, 0.0, Wanted(with_loads=True))
    force = gas.factor * gas.value(0.3) - 70.0
    assert found[place['f32_x']] == pytest.approx(force, rel=1e-11)


def test_the_peaks_of_a_simulated_engine_are_those_of_its_gas():
    peaks = {peak.name: peak for peak in simulate_scene(ENGINE, 0.1, 1e-6).peaks()}
    assert peaks['f43'].high > 500.0 and peaks['driving_torque'].low < -100.0


@pytest.mark.parametrize('name', ['paper', 'slider_crank', 'cylinder', 'scotch_yoke', 'v_engine',
                                  'quick_return', 'bucket', 'jansen', 'stephenson', 'lift_table'])
def test_coordinates_are_those_of_the_motion(name):
    """What a force is over, from the places of links, is the field of the motion: 1e-12."""
    linkage = scene.load(name).linkage
    low, high = linkage.input_ranges[0]
    known = _coordinates(linkage)
    assert known
    for q in np.linspace(low, high, 9)[1:-1].tolist():
        motion = linkage.motion(q, 1.0, 0.0)
        curves = {link.name: linkage.link_motion(motion, link.name) for link in linkage.LINKS}
        curves['ground'] = FIXED
        for field, over in known.items():
            element = PositionForce(_first(linkage), lambda s: 1.0, over)
            away = element.position(REAL, curves, q) - getattr(motion, field)
            turns = round(away / TURN) * TURN if isinstance(over, LinkAngle) else 0.0
            assert abs(away - turns) < 1e-12, field


def _first(linkage):
    from fourbar_ros.mechanisms.elements import Attachment
    return Attachment(linkage.LINKS[-1].name)


@pytest.mark.parametrize(('over', 'kind'), [('input', str), ('theta1', str), ('theta4', LinkAngle),
                                            ('beta', LinkAngle), ('tip.x', Way), ('tip.y', Way)])
def test_a_force_is_over_a_coordinate_or_a_point(over, kind):
    values = {**PUSHED, 'points.tip.link': 'coupler', 'points.tip.along': 0.6,
              'forces.push.over': over, 'forces.push.periodic': False,
              'forces.push.values': [5.0, 80.0, -30.0, 5.0]}
    force, = scene.from_values(values).linkage.elements
    assert isinstance(force.over, kind)


@pytest.mark.parametrize('axis', ['x', 'y'])
def test_a_force_over_a_point_is_that_at_its_coordinate(axis):
    """A table that is a straight line, 100 N/m: the force is 100 times the coordinate."""
    there = scene.from_values({
        **PUSHED, 'points.tip.link': 'coupler', 'points.tip.along': 0.6, 'points.tip.across': 0.2,
        'forces.push.over': f'tip.{axis}', 'forces.push.periodic': False,
        'forces.push.interpolation': 'linear', 'forces.push.places': [-9.0, 9.0],
        'forces.push.values': [-900.0, 900.0]})
    plain, push = there.linkage.with_elements(), there.values
    for q in (0.3, 2.0, 4.4):
        at = getattr(point_motion(plain, plain.motion(q), 'coupler', 0.6, 0.2), axis)
        force = Applied(0.0, 100.0 * at, along=push['forces.push.along'],
                        across=push['forces.push.across'])
        loaded = plain.with_external(plain.external._replace(output=force))
        found = there.linkage.loads(q, 2.0, 3.0)
        expected = loaded.loads(q, 2.0, 3.0)
        for name, value in expected._asdict().items():
            assert getattr(found, name) == pytest.approx(value, rel=1e-11, abs=1e-9), name


def test_units_are_converted_once():
    other = {**PUSHED, 'forces.push.places': [0.0, 114.59155902616465, 229.1831180523293, 360.0],
             'forces.push.place_unit': 'deg', 'forces.push.value_unit': 'kN',
             'forces.push.values': [0.005, 0.08, -0.03, 0.005]}
    one, two = (scene.from_values(values).linkage.elements[0].value
                for values in (PUSHED, other))
    for q in (0.1, 1.3, 5.0):
        assert two(q) == pytest.approx(one(q), rel=1e-12)


WRONG_FILES = [
    ('', 'row 1: must be two headings with units'),
    ('0, 1\n1, 2\n', 'row 1: must be two headings with units'),
    ('slide [inch], force [N]\n0, 1\n', 'row 1: must be two headings with units'),
    ('slide [m], force [N], more [N]\n0, 1, 2\n', 'row 1: must be two headings with units'),
    ('slide [m], force [N]\n0, 1\n1\n', 'row 3: 1 columns, must be a place and a value'),
    ('slide [m], force [N]\n0, 1\n0.1, \n', "row 3: '' must be a number"),
    ('slide [m], force [N]\n0, 1\n# half\n\n0.1, nan\n', "row 5: 'nan' must be a finite number"),
    ('slide [m], force [N]\n0, 1\n0.1, 1e999\n', "row 3: '1e999' must be a finite number"),
    ('slide [m], force [N]\n0; 1\n', 'row 2: 1 columns, must be a place and a value'),
    ('slide [m], force [N]\n0,0, 1,5\n', 'row 2: 4 columns, must be a place and a value; write '
     'decimals with a point, or ; between columns'),
    ('slide [m]; force [N]\n0;1\n0.1;1.000,5\n', "row 3: '0.1' has a point, others a comma: "
     'write decimals in one way, and thousands without'),
    ('slide [m]; force [N]\n0;1.000\n0,1;2.000\n', "row 2: '1.000' has a point, others a comma"),
    ('slide [m], force [N]\n0, 1\n', 'gas.csv: places = 1: must be 2 to'),
    ('slide [mm]; force [kN]\n0;1\n# cut\n90,5;5\n80;1\n',
     'row 5: 80 mm must be larger than the one before, 90.5'),
    ('slide [mm], force [kN]\n3, 1\n2, 1\n2, 2\n2, 3\n1, 0\n',
     'row 5: 2 mm stands three times'),
    ('x' * 200_000, 'not a table as text in UTF-8'),
]


@pytest.mark.parametrize(('text', 'why'), WRONG_FILES, ids=range(len(WRONG_FILES)))
def test_a_wrong_file_is_refused_in_one_line_with_its_row(tmp_path, text, why):
    path = write(tmp_path, text)
    with pytest.raises(SceneError, match='gas.csv') as refused:
        scene.load(path)
    assert why in str(refused.value) and '\n' not in str(refused.value)


def test_an_open_cycle_is_refused_with_file_row_and_unit(tmp_path):
    path = write(tmp_path, 'theta1 [deg], force [kN]\n0, 1\n100, 5\n360, 1.5\n', periodic='true')
    with pytest.raises(SceneError, match='gas.csv, row 4: 1.5 kN must be the first value again, '
                                         '1.0: .* last row 360.0, 1.0 says so'):
        scene.load(path)


def test_files_that_are_none_are_refused_in_one_line(tmp_path):
    path = write(tmp_path, '', table='other.csv')
    with pytest.raises(SceneError, match='other.csv: No such file'):
        scene.load(path)
    (tmp_path / 'binary.csv').write_bytes(b'\xff\xfe\x00')
    with pytest.raises(SceneError, match='is no text in UTF-8'):
        read_table(tmp_path / 'binary.csv')


def test_a_table_of_another_program_is_read(tmp_path):
    """With a byte order mark, DOS line ends, comments, blanks, quotes."""
    (tmp_path / 'own.csv').write_bytes(b'\xef\xbb\xbf# made elsewhere\r\n'
                                       b'"theta1 [deg]","p [bar]"\r\n'
                                       b'0,1e0\r\n\r\n 360 , +2.5\r\n')
    table = read_table(tmp_path / 'own.csv')
    assert (*table.values(),) == ([0.0, 360.0], 'deg', [1.0, 2.5], 'bar')


def test_a_german_spreadsheet_is_read(tmp_path):
    """With ; and decimal commas, spellings of units, falling places: a table that is turned."""
    text = 'Weg [mm]; Kraft [daN]\n200;-200\n192;-200\n192;0\n0,5;0,25\n'
    path = write(tmp_path, text, over='slide', acts='x', interpolation='linear')
    force, = scene.load(path).linkage.elements
    assert force.value.table == ForceTable([0.0005, 0.192, 0.192, 0.2],
                                           [2.5, 0.0, -2000.0, -2000.0], is_linear=True)
    (tmp_path / 'own.csv').write_text('"Winkel [°]";"Moment [Nm]"\n0;1,5e0\n360;1,5\n', 'utf-8')
    table = read_table(tmp_path / 'own.csv')
    assert (*table.values(),) == ([0.0, 360.0], 'deg', [1.5, 1.5], 'N m')


def test_texts_with_units_are_the_numbers_in_si():
    """In a list of texts; a number among them, in Python, has the unit of all, else SI."""
    values = [5.0, 80.0, -30.0, 5.0]
    plain = {'places': [0.0, 0.5 * pi, pi, TURN], 'values': values}
    table = ForceTable(**plain, is_periodic=True)
    for texts in ({'places': ['0deg', '90°', '0.5 turn', '360 deg']},
                  {'places': [0, '90deg', 180, '1turn'], 'place_unit': 'deg'},
                  {'places': ['360', '180', '90', '0'], 'place_unit': 'deg',
                   'values': values[::-1]},
                  {'values': ['5', '8daN', '-0.03 kN', '5N']},
                  {'values': ['50', '800Pa', '-300 Pa', '5e-4bar'], 'factor': 0.1}):
        scene_of_texts = scene.from_values({**PUSHED, **{
            f'forces.push.{name}': value for name, value in {**plain, **texts}.items()}})
        for there in (scene_of_texts, scene.from_values(json.loads(scene_of_texts.as_json))):
            force, = there.linkage.elements
            for q in (0.3, 2.0, 4.0):
                assert force.factor * force.value(q) == pytest.approx(table(q), rel=1e-12), texts


def test_a_table_given_twice_is_refused(tmp_path):
    path = write(tmp_path, 'slide [m], force [N]\n0, 1\n1, 2\n', places='[0.0, 1.0]', over='slide')
    with pytest.raises(InvalidParameter, match='is in the file already'):
        scene.load(path)


def test_a_scene_that_is_no_file_opens_none(tmp_path):
    """Neither in Python nor from a bag, a link or a live change."""
    (tmp_path / 'gas.csv').write_text('theta1 [deg], couple [N m]\n0, 1\n360, 1\n')
    values = {**PUSHED, 'forces.push.places': [], 'forces.push.values': [],
              'forces.push.acts': 'couple', 'forces.push.table': str(tmp_path / 'gas.csv')}
    with pytest.raises(InvalidParameter, match='only the file of a scene names that of a table'):
        scene.from_values(values)


def test_files_are_found_beside_the_scene_from_anywhere(tmp_path, monkeypatch):
    path = write(tmp_path, 'slide [mm], force [kN]\n0, 1\n300, -2\n', over='slide')
    (tmp_path / 'elsewhere').mkdir()
    monkeypatch.chdir(tmp_path / 'elsewhere')
    for name in (path, '../pressed.yaml', str(path)):
        force, = scene.load(name).linkage.elements
        table = force.value.table
        assert table.places == (0.0, 0.3) and table.values == (1e3, -2e3)
