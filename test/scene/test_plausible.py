# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Values that are allowed but hardly meant; rods of rectangular section."""
import math
import warnings

from fourbar_ros import flat_bar
from fourbar_ros.cli.main import main
from fourbar_ros.errors import SceneWarning
from fourbar_ros.scene import from_values, load
from fourbar_ros.scene.files import folder
import pytest
from support.scenes import PAPER, RODS

BARS = {'bodies.rods.density': 7850.0, 'bodies.rods.width': 0.02, 'bodies.rods.thickness': 0.005}
LONG = {'linkage.a1': 50.0, 'linkage.a2': 150.0, 'linkage.a3': 100.0, 'linkage.a4': 125.0}
SMALL = {'linkage.a1': 0.04, 'linkage.a2': 0.12, 'linkage.a3': 0.08, 'linkage.a4': 0.1}
# from O1 to the end of the crank: 0.4 m long
SPRING = {'springs.back.second.link': 'crank', 'springs.back.second.along': 0.4,
          'springs.back.first.along': -0.4, 'springs.back.stiffness': 0.5}


@pytest.mark.parametrize(('changes', 'said'), [
    ({**LONG, **RODS}, ['linkage.a1 = 50 m: did you mean 0.05?']),
    (LONG, ['linkage.a1 = 50 m: did you mean 0.05? Lengths are in metres (and 3 more)']),
    ({'points.p.along': -50.0}, ['points.p.along = -50 m']),
    ({'bodies.rods.density': 7.75, 'bodies.rods.radius': 0.01}, ['did you mean 7750?']),
    ({'bodies.rods.density': 7750e3, 'bodies.rods.radius': 0.01}, ['did you mean 7750?']),
    ({'bodies.rods.density': 99.9, 'bodies.rods.radius': 0.01}, ['99.9 kg/m^3']),
    ({'bodies.rods.density': 25001.0, 'bodies.rods.radius': 0.01}, ['denser than any metal']),
    ({'bodies.rods.density': 7750.0, 'bodies.rods.radius': 10.0}, ['did you mean 0.01?']),
    ({**BARS, 'bodies.rods.width': 20.0}, ['bodies.rods.width = 20 m: ']),
    ({**BARS, 'bodies.rods.thickness': 5.0}, ['bodies.rods.thickness = 5 m: ']),
    ({'bodies.rods.density': 7750.0, 'bodies.rods.radius': 0.3},
     ['0.4 m: give the mass and inertia of such links']),
    ({**RODS, 'friction.A.coefficient': 1.2, 'friction.A.radius': 0.01},
     ['friction.A.coefficient = 1.2: dry friction is mostly below 1']),
    ({**RODS, 'friction.A.coefficient': 1.0, 'friction.A.radius': 0.01}, []),
    ({**RODS, 'friction.A.coefficient': 0.1, 'friction.A.radius': 8.0},
     ['friction.A.radius = 8 m: the pin is thicker than all is long: did you mean 0.008?']),
    ({**RODS, 'friction.A.coefficient': 0.1, 'friction.A.radius': 1.2}, []),
    ({'gravity.y': -9810.0}, ['gravity.y = -9810 m/s^2: did you mean -9810 mm/s^2?']),
    ({'gravity.y': '-9810 m/s^2'}, []), ({'gravity.y': -26.0}, []),
    ({**SMALL, 'points.p.along': 15.0}, ['points.p.along = 15 m: did you mean 0.015?']),
    ({**SMALL, 'points.p.along': 5.9}, []), ({**SMALL, 'points.p.along': '15m'}, []),
    ({**SMALL, 'frame.parent': 'world', 'frame.xyz': [15.0, 0.0, 0.0]}, []),
    ({**RODS, **SMALL, 'bodies.crank.mass': 1.5, 'bodies.crank.inertia': 1200.0},
     ['bodies.crank.inertia = 1200 kg m^2 is that of 1.5 kg at a distance of 28.3 m: did you mean '
      '1200 kg mm^2?']),
    ({**RODS, **SMALL, 'bodies.crank.mass': 1.5, 'bodies.crank.inertia': 215.0}, []),
    ({**RODS, **SMALL, 'bodies.crank.mass': 1.5, 'bodies.crank.inertia': '1200 kg m^2'}, []),
    ({**RODS, **SPRING, 'gravity.y': -9.81},
     ['springs.back.stiffness = 0.5 N/m: its force is at most 0.4 N']),
    ({**RODS, **SPRING}, []),
    ({**RODS, **SPRING, 'gravity.y': -9.81, 'springs.back.stiffness': 500.0}, []),
    ({**RODS, **SPRING, 'gravity.y': -9.81, 'springs.back.stiffness': 0.5,
      'springs.back.preload': 400.0, 'springs.back.free_length': 0.1}, []),
    ({**RODS, **SPRING, 'gravity.y': -9.81, 'springs.back.preload': 0.5,
      'springs.back.free_length': 0.1}, []),
    ({'drive.start': 90.0}, ['did you mean 90deg?']),
    ({'drive.start': -6.3}, ['drive.start = -6.3 rad is more than a turn']),
    ({'drive.start': '367.5deg'}, []),
    ({'drive.start': math.radians(-725.5)}, []),        # of a scene that was written in rad
    ({'drive.start': '7 rad', 'linkage.a1': '500m', 'linkage.a2': '1500m', 'linkage.a3': '1000m',
      'linkage.a4': '1250 m'}, []),
    ({'joint_states.offsets': [7.0, 0.0, 0.0, 0.0]}, ['joint_states.offsets = 7 rad']),
    ({'joint_states.offsets': ['400deg', '0deg', '0deg', '0deg']}, []),
    ({**RODS, 'base.topic': 'imu', 'base.rotation': [0.0, 90.0, 0.0]},
     ['base.rotation = 90 rad is more than a turn: did you mean 90deg?']),
    ({**RODS, 'base.topic': 'imu', 'base.rotation': ['0deg', '90deg', '0deg']}, []),
    ({'drive.start': 6.28, **RODS}, []),
    ({**RODS, **SPRING, 'springs.back.stiffness': 500.0, 'springs.back.preload': 40.0},
     ['springs.back.free_length = 0: its force grows with its whole length, up to 440 N, with']),
    ({**RODS, **SPRING, 'gravity.y': -9.81, 'springs.back.stiffness': 500.0,
      'bodies.output.mass': 14000.0, 'bodies.output.inertia': 1.0},
     ['did you mean 500 N/mm, or a mass of the output below 14000 kg?']),
    ({'linkage.a2': 0.5, 'drive.speed': '60rpm'}, ['drive.speed = 6.28319 rad/s: the input can']),
    ({'linkage.a2': 0.5, 'drive.speed': 2.0, 'drive.start': 3.0},
     ['drive.start = 3 rad is outside [-']),
    ({'linkage.range': [0.5, 1.0], 'drive.speed': 6.0}, []),
    ({'linkage.a2': 0.5, 'drive.speed': 0.0}, []),
    ({'linkage.a2': 0.5, 'drive.speed': 0.0, 'drive.start': 3.0},
     ['drive.start = 3 rad is outside [-']),
    ({'linkage.a2': 0.5}, []),
    ({'linkage.a2': 0.5, 'drive.speed': 6.0, 'drive.source': 'motion'}, []),
    ({'drive.start': '720deg', 'drive.jump': 7.0}, []),
    ({'linkage.range': [30.0, 60.0]}, ['linkage.range = 30 rad']),
    ({**RODS, 'torsion_springs.s.free_angle': 45.0, 'torsion_springs.s.stiffness': 1.0},
     ['torsion_springs.s.free_angle = 45 rad is more than a turn: did you mean 45deg?']),
    ({'frame.parent': 'world', 'frame.rpy': [0.0, 90.0, 180.0]},
     ['frame.rpy = 90 rad is more than a turn: did you mean 90deg? (and 1 more)']),
    ({'frame.parent': 'world', 'frame.rpy': ['90deg', 90.0, 0.0]},    # not all with a unit
     ['frame.rpy = 90 rad is more than a turn: did you mean 90deg?']),
    ({'frame.parent': 'world', 'frame.rpy': ['450deg', 0.0, '0']}, []),
    ({'linkage.a1': 5.0, 'linkage.a2': 10.0, 'linkage.a3': 8.0, 'linkage.a4': 9.0}, []),
    ({'bodies.rods.density': 100.0, 'bodies.rods.radius': 0.199}, []),
    ({'linkage.a1': 50.0, 'linkage.a2': 90.0, 'linkage.a3': 80.0, 'linkage.a4': 70.0,
      'drive.start': 45.0, **RODS}, ['linkage.a1', 'drive.start'])])
def test_what_is_hardly_meant_is_one_line_each(changes, said):
    found = from_values({**PAPER, **changes}).warnings
    assert len(found) == len(said)
    assert all(part in line and '\n' not in line for part, line in zip(said, found))


@pytest.mark.parametrize(('unit', 'size'), [('mm', 1e-3), ('m', 1.0), ('', 1.0), ('cm', 1e-2)])
def test_a_table_that_ends_too_early_says_so_in_its_unit(unit, size):
    """Exactly: a slider-crank of 40 and 160 mm goes from 120 to 200 mm."""
    scene = from_values({
        'linkage.kind': 'slider_crank', 'linkage.a1': 0.04, 'linkage.a2': 0.16, **RODS,
        'forces.cut.link': 'output', 'forces.cut.acts': 'x', 'forces.cut.over': 'slide',
        'forces.cut.places': [place / size for place in (0.185, 0.19, 0.195)],
        'forces.cut.values': [0.0, 5.0, 8.0], 'forces.cut.place_unit': unit,
        'outputs': ['state'], 'bodies.output.mass': 1.0})
    line, = scene.warnings
    first, last, low, high = (f'{place / size:.6g}' for place in (0.185, 0.195, 0.12, 0.2))
    assert f'goes from {first} to {last}, slide from {low} to {high} {unit or "m"}: ' in line


# a force on the block of a slider-crank of 40 and 160 mm, which goes from 120 to 200 mm
@pytest.mark.parametrize(('changes', 'said'), [
    ({'places': [150.0, 190.0]}, 'from 150 to 190, slide from 0.12 to 0.2 m: did you mean mm?'),
    ({'places': ['20cm', '21cm'], 'values': [0.0, 5.0]},
     'from 0.2 to 0.21, slide from 0.12 to 0.2 m'),
    ({'places': [0.0, 0.15, 0.3], 'values': [0.0, 0.0, 0.0]}, ''),
    ({'places': [0.11, 0.13], 'values': [0.0, 0.0], 'factor': 1.0}, ''),
    ({'places': [0.11, 0.13], 'factor': 0.0}, ''),
    ({'places': ['199.9999mm', '200mm'], 'values': [0.0, 5.0]}, ''),
    ({'over': 'theta2', 'places': ['100deg', '120deg'], 'values': [0.0, 5.0]}, ''),
    ({'over': 'beta', 'places': ['20deg', '40deg'], 'values': [5.0, 0.0], 'when': 'backward'}, ''),
    ({'over': 'beta', 'places': ['20deg', '30deg', '40deg'], 'values': [0.0, 5.0, 0.0]},
     'from 0.349066 to 0.698132, beta from -0.25268 to 0.25268 rad'),
    ({'over': 'beta', 'places': ['20deg', '30deg', '40deg'], 'values': [0.0, 5.0, 0.0],
      'when': 'forward'}, 'a force from 0.349066 to 0.698132, beta from -0.25268 to 0.25268 rad'),
    ({'places': [0.0, 0.05, 0.1, 0.3], 'values': [5.0, 5.0, 0.0, 0.0]},
     'a force from 0 to 0.1, slide from 0.12 to 0.2 m'),
    ({'over': 'pin.y', 'places': [0.3, 0.4]}, 'from 0.3 to 0.4, pin.y from -0.04 to 0.04 m'),
    ({'over': 'pin.y', 'places': [30.0, 60.0], 'values': [5.0, 0.0]}, ''),
    ({'over': 'pin.y', 'places': [45.0, 60.0]},
     'from 45 to 60, pin.y from -0.04 to 0.04 m'),
    ({'places': ['150m', '190m']}, 'from 150 to 190, slide from 0.12 to 0.2 m'),
    ({'over': 'input', 'when': 'backward', 'places': ['0deg', '40deg', '360deg'],
      'values': [0.0, 5.0, 0.0], 'periodic': True},
     'input never goes backward where its table has a force'),
    ({'over': 'input', 'when': 'forward', 'places': ['0deg', '40deg', '360deg'],
      'values': [0.0, 5.0, 0.0], 'periodic': True}, ''),
    ({'acts': 'apart', 'over': 'distance', 'places': [0.3, 0.4], 'values': [0.0, 5.0]},
     'from 0.3 to 0.4, distance from 0.12 to 0.2 m')])
def test_a_force_that_never_acts_is_one_line(changes, said):
    force = {'link': 'output', 'acts': 'x', 'over': 'slide', 'values': [0.0, 5.0], **changes}
    lines = [line for line in from_values({
        'linkage.kind': 'slider_crank', 'linkage.a1': 0.04, 'linkage.a2': 0.16, **RODS,
        'outputs': ['state'], 'bodies.output.mass': 1.0, 'points.pin.link': 'crank',
        'points.pin.along': 0.04,
        **{f'forces.cut.{name}': value for name, value in force.items()}}).warnings
        if 'never acts' in line]
    assert len(lines) == bool(said)
    assert all(line.startswith('forces.cut never acts: ') and line.endswith(said)
               for line in lines)


def test_a_block_has_a_mass_or_a_line_where_the_weight_of_rods_counts():
    press = {**dict(load('toggle_press').values), **RODS}
    assert from_values({**press, 'gravity.y': -9.81}).warnings == []
    press['bodies.ram.mass'] = 0.0
    assert from_values(press).warnings == []
    line, = from_values({**press, 'gravity.y': -9.81}).warnings
    assert line == ('bodies: ram without mass, as bodies.rods is of rods alone: give '
                    'bodies.ram.mass')
    # an inertia of what does not turn does nothing
    press |= {'gravity.y': -9.81, 'bodies.ram.inertia': 0.01}
    assert from_values(press).warnings == [line]


def test_the_offset_of_a_slide_is_a_length():
    values = dict(load('slider_crank').values)
    offsets = [0.0] * len(load('slider_crank').linkage.JOINTS)
    slide = [joint.coordinate.unit for joint in load('slider_crank').linkage.JOINTS].index('m')
    for offset, said in ((7.0, []), (50.0, ['joint_states.offsets = 50 m: did you mean 0.05? '
                                            'Lengths are in metres'])):
        offsets[slide] = offset
        assert from_values({**values, 'joint_states.offsets': offsets}).warnings == said


@pytest.mark.parametrize(('vary', 'said'), [
    ({'range': [-95, -85]}, '-95 rad is more than a turn: did you mean -95deg? (and 1 more)'),
    ({'range': [-1.6, 300]}, '300 rad is more than a turn'),       # not of the first designs alone
    ({'list': [-1.6, -90]}, '-90 rad is more than a turn'),
    ({'normal': [-90, 0.5]}, '-90 rad is more than a turn'),
    ({'range': ['-395.5deg', '-385deg']}, '')])
def test_a_study_over_degrees_without_a_unit_warns(vary, said):
    study = pytest.importorskip('fourbar_lab.studies.study')
    document = {'scene': 'toggle_press', 'rows': 2, 'quantities': ['stroke'],
                'vary': {'dyads.ram.direction_2': vary}}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter('always')
        study.from_document(document)
    lines = [str(each.message) for each in caught if each.category is SceneWarning]
    assert len(lines) == bool(said)
    assert all(f'vary: dyads.ram.direction_2 = {said}' in line for line in lines)


def test_a_carried_inertia_with_which_the_rest_is_unstable_is_one_line():
    def said(carried):
        return from_values({**PAPER, **RODS, 'drive.carried_inertia': carried}).warnings
    line, = said(0.1)           # of 0.19 to 1.25 kg m^2
    assert 'unstable with a rotor lighter than 1.046; 0.7192 would do with any' in line
    assert said(0.0) == said(0.72) == []


def test_the_start_of_a_slide_is_no_angle_and_links_of_machines_have_names():
    values = dict(load('cylinder').values)
    assert from_values({**values, 'drive.start': 7.0}).warnings == []
    watt = dict(load('watt').values)
    line, = from_values({**watt, 'dyads.two.length_1': 20.4,
                         'dyads.two.length_2': 20.5}).warnings
    assert line.startswith('dyads.two.length_1 = 20.4 m: did you mean 0.0204?')


def test_no_shipped_scene_warns_about_itself():
    assert [line for below in ('.', 'classics') for path in (folder() / below).glob('*.yaml')
            for line in load(path).warnings] == []


@pytest.mark.parametrize('verb', [('scene', 'check'), ('show',)])
def test_verbs_warn_on_stderr_and_go_on(verb, tmp_path, capsys):
    file = tmp_path / 'my.yaml'
    file.write_text('/**: {ros__parameters: {linkage: {a1: 0.4, a2: 1.2, a3: 0.8, a4: 1.0}, '
                    'drive: {start: 90}}}')
    assert main([*verb, str(file)]) == 0
    out, err = capsys.readouterr()
    assert out
    assert err == (f'fourbar: warning: {file}: drive.start = 90 rad is more than a turn: '
                   'did you mean 90deg?\n')


def test_a_new_scene_in_millimetres_is_written_with_a_warning(tmp_path, capsys):
    lengths = ['--a1', '50', '--a2', '150', '--a3', '100', '--a4', '125']
    assert main(['new', str(tmp_path / 'my.yaml'), *lengths, '--rod', '8',
                 '--material', '7.85']) == 0
    lines = capsys.readouterr().err.splitlines()
    assert [line.split()[3] for line in lines] == ['linkage.a1', 'bodies.rods.density']


def test_a_direction_of_more_than_a_turn_is_written_within_one(tmp_path, capsys):
    directions = []
    for angle in ('-5.5deg', '-725.5deg'):
        file = tmp_path / f'my{angle}.yaml'
        assert main(['new', str(file), '--points', 'O1 0 0', 'A 10mm 0', 'B 60mm 5mm slide '
                     + angle, '--links', 'O1-A', 'A-B']) == 0
        directions.append(load(file).values['dyads.B.direction_2'])
    assert directions == [math.radians(-5.5)] * 2
    assert 'more than a turn' not in capsys.readouterr().err


def test_a_scene_is_looked_at_once_for_its_warnings(monkeypatch, tmp_path):
    looked = []
    monkeypatch.setattr('fourbar_ros.scene.scene.warnings_of',
                        lambda scene: looked.append(scene) or iter(()))
    file = tmp_path / 'rocks.yaml'
    file.write_text(from_values({**PAPER, 'linkage.a2': 0.5}).as_text)
    assert main(['scene', 'check', str(file)]) == 0
    assert len(looked) == 1


# --- rods of rectangular section -----------------------------------------------------------------

def test_bars_of_a_machine_are_flat_bars():
    values = {name: value for name, value in load('watt').values.items()
              if not name.startswith('bodies.')}
    bodies = from_values({**values, **BARS}).linkage.bodies._asdict()
    assert bodies['rocker'] == flat_bar(values['dyads.one.length_2'], 7850.0, 0.02, 0.005)


def test_a_study_computes_bars_as_a_scene_does():
    from fourbar_ros.scene.parametric import constants_of
    scene = from_values({**PAPER, **BARS})
    assert constants_of(scene, dict(scene.values)).bodies == scene.linkage.bodies
