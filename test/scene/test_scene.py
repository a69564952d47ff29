# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scene files and the parameter table."""
import json
import math
import re

from fourbar_ros import FourBarError, InvalidParameter
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values, shipped
from fourbar_ros.scene.parameters import check_value, find_parameter
from fourbar_ros.scene.settings import MOTORS, of_motor, PARAMETERS, REQUIRED
from hypothesis import given
from hypothesis import strategies as st
import pytest
from support import ROOT
from support.scenes import PAPER, RODS
from support.strategies import parameters

CONFIG = ROOT / 'config'


@pytest.mark.parametrize('name', shipped())
def test_the_values_and_the_text_of_a_shipped_scene_are_the_same_scene(name, tmp_path):
    file, first = tmp_path / 'scene.yaml', scene.load(name)
    file.write_text(first.as_text)
    assert read_values(file).items() <= first.values.items()
    for again in (scene.from_values(first.values), scene.load(file)):
        assert (again.linkage, again.outputs) == (first.linkage, first.outputs)


def test_defaults_are_themselves_allowed():
    for parameter in PARAMETERS.values():
        if parameter.default is not REQUIRED:
            value = check_value(parameter, parameter.default, {})
            assert value == parameter.default or math.isnan(value)


def test_groups_of_parameters_have_the_fields_of_the_table():
    groups = {'drive': 'drive', 'base': 'base', 'base.carried': 'base.carried',
              'external': 'wrenches', 'joint_states': 'joint_states', 'recording': 'recording'}
    checked = scene.from_values(PAPER)
    for group, attribute in groups.items():
        record = checked
        for name in attribute.split('.'):
            record = getattr(record, name)
        of_table = {name.removeprefix(f'{group}.') for name in PARAMETERS
                    if name.startswith(f'{group}.')}
        assert set(record._fields) - {'links', 'carried'} == {
            name for name in of_table if '.' not in name}


def test_json_of_a_scene_is_strict_and_gives_the_same_scene():
    first = scene.from_values({**PAPER, 'outputs': ['state']})
    values = json.loads(first.as_json,
                        parse_constant=lambda name: pytest.fail(f'{name} is no JSON'))
    assert scene.from_values(values).linkage == first.linkage and 'bodies.crank.mass' not in values


def test_bodies_one_by_one():
    bodies = {f'bodies.{link}.{field}': value for link in ('crank', 'coupler', 'output')
              for field, value in (('mass', 2.0), ('inertia', 0.5), ('cg_across', 0.01))}
    linkage = scene.from_values({**PAPER, **bodies, 'bodies.coupler.cg_along': 0.9}).linkage
    assert (linkage.bodies.crank.cg_along, linkage.bodies.coupler.cg_along) == (0.2, 0.9)
    assert linkage.bodies.output.cg_across == 0.01
    rods = scene.from_values({**PAPER, **RODS}).linkage.bodies
    own = {name: value for name, value in bodies.items() if 'coupler' in name}
    mixed = scene.from_values({**PAPER, **RODS, **own}).linkage.bodies
    assert mixed.coupler.mass == 2.0 and mixed == rods._replace(coupler=mixed.coupler)
    with pytest.raises(InvalidParameter, match='bodies.crank.cg_along.*needs the mass'):
        scene.from_values({**PAPER, **RODS, 'bodies.crank.cg_along': 0.1})


def test_external_loads_and_gravity_reach_the_linkage():
    linkage = scene.from_values({**PAPER, **RODS, 'external.output.couple': -50.0,
                                 'external.coupler.force_y': 7.0,
                                 'external.coupler.along': 0.6, 'gravity.y': -9.81}).linkage
    assert (linkage.external.output.couple, linkage.external.coupler.force_y) == (-50.0, 7.0)
    assert (linkage.external.coupler.along, linkage.gravity) == (0.6, (0.0, -9.81))


def test_scene_check_explains(capsys):
    from fourbar_ros.cli.main import main
    assert main(['scene', 'check', str(CONFIG / 'paper.yaml')]) == 0
    said = capsys.readouterr().out
    assert '25.0' in said and '~/shaking_wrench' in said and 'motion and loads' in said
    assert main(['scene', 'check', str(CONFIG / 'slides_7_6.yaml')]) == 0
    said = capsys.readouterr().out
    assert 'motion alone' in said and 'needs loads' not in said and 'not created: loads' in said
    assert main(['scene', 'check', str(CONFIG / 'released.yaml')]) == 0     # it has masses
    assert 'computes motion alone: no output needs loads' in capsys.readouterr().out


def test_scene_check_lists_what_was_given_in_units_of_what_is_driven(tmp_path, capsys):
    from fourbar_ros.cli.main import main
    file = tmp_path / 'scene.yaml'
    file.write_text((CONFIG / 'cylinder.yaml').read_text().replace('source: motion ',
                                                                   'source: timer '))
    assert main(['scene', 'check', str(file)]) == 0
    said = capsys.readouterr().out
    name = 'inverted slider-crank, Grashof crank-rocker, driven at its slide, mode 2'
    assert name in ' '.join(said.split())
    assert 'drive.start = 0 m is outside [1, 1.8] m' in said
    rows = dict(line.split(maxsplit=1) for line in said.splitlines()
                if line.startswith(('linkage.', 'drive.speed')))
    assert (rows['linkage.a1'].split() == ['1.2', 'm'] and rows['drive.speed'].split()
            == ['0.2', 'm/s'])


@pytest.mark.parametrize('values', [{'linkage.a1': 1e300}, {'bodies.rods.radius': 1e160}])
def test_numbers_that_overflow_are_refused(values):
    with pytest.raises(InvalidParameter, match='too far apart|overflow'):
        scene.from_values({'linkage.kind': 'slider_crank', 'linkage.a1': 0.1, 'linkage.a2': 0.3,
                           **RODS,
                           'bodies.output.mass': 1.0, **values})


def test_a_folder_of_the_name_of_a_scene_does_not_hide_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'motor').mkdir()
    assert scene.load('motor').values == scene.load(CONFIG / 'motor.yaml').values


def test_kinds_of_motors_share_no_parameter_that_differs():
    found = {}
    for kind in MOTORS:
        for parameter in of_motor(kind).values():
            same = found.setdefault(parameter.name, parameter)
            assert (same.unit, same.default) == (parameter.unit, parameter.default), parameter.name


@pytest.mark.parametrize('file', sorted(CONFIG.glob('*.yaml')), ids=lambda file: file.stem)
@given(st.data())
def test_a_live_change_is_taken_or_refused_as_the_whole_scene_would_be(file, data):
    now = scene.load(file)
    live = [key for key in now.values if find_parameter(key) and find_parameter(key).live]
    for name, value in data.draw(st.lists(parameters(live), max_size=8)):
        try:
            whole = scene.from_values({**now.values, name: value})
        except FourBarError as error:
            assert '\n' not in str(error)
            with pytest.raises(type(error), match=re.escape(str(error))):
                now.with_values({name: value})
        else:
            now = now.with_values({name: value})
            assert now.as_json == whole.as_json and repr(now.linkage) == repr(whole.linkage)
