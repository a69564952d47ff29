# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes, messages, tables and pictures of every kind."""

import json
from math import tau

from fourbar_ros.cli.main import main
from fourbar_ros.mechanisms.quantities import known_quantities
from fourbar_ros.pipeline.joints import SceneJoints
from fourbar_ros.scene import scene as scenes
import numpy as np
import pytest
from support import bags, contract
from support.cartesian import EPS
from support.contract import CASES, every_case, name_of
from support.samples import some
from support.scenes import values_of

OUTER = ('state', 'loads')
NOT_SENT = {'slot_couple'}  # loads of one kind alone, without a field in LinkageLoads


@every_case
def test_a_scene_keeps_every_digit(case):
    """Parameters -> mechanism -> parameters as JSON -> mechanism."""
    for mechanism, given in contract.ordinary(case, 221, 5):
        scene = scenes.from_values(values_of(mechanism, case.name))
        assert scene.linkage == mechanism
        again = scenes.from_values(json.loads(scene.as_json))
        assert again.linkage == mechanism and again.linkage.step(*given) == mechanism.step(*given)


@every_case
def test_messages_are_complete(case):
    """Each number of a message has a source, each joint and load of a mechanism is in one."""
    for mechanism, given in contract.ordinary(case, 222, 2):
        scene = scenes.from_values(values_of(mechanism, case.name, outputs=[
            'state', 'output', 'joint_states', 'loads', 'shaking_wrench']))
        motion, loads = scene.linkage.step(*given)
        sample = (*motion, *loads, *SceneJoints(scene).of(motion + loads))
        sent = {output: scene.layout.expected(output, sample)
                for output in ('driven', *scene.outputs)}
        for output in OUTER:
            fields = {name for name, _ in bags.STORE.fielddefs[scene.topics[output].type][1]}
            assert fields - set(sent[output]) <= {'header', 'status', 'mode',
                                                  'change_point_margin'}
        for output, values in (('state', motion), ('loads', loads)):
            for name in set(sent[output]) & set(values._fields):
                assert sent[output][name] == getattr(values, name), name
        assert set(loads._fields) - set(sent['loads']) <= NOT_SENT
        assert sent['joint_states']['velocity'] == tuple(
            getattr(motion, c.rate) for c in contract.coordinates(case.kind)
        )
        assert tuple(sent['driven'].values()) == given
        for position, c in zip(sent['joint_states']['position'],
                               contract.coordinates(case.kind), strict=True):
            away = position - getattr(motion, c.position)       # joints of a pin count turns
            turns = round(away / tau) if c.unit == 'rad' else 0
            assert abs(away - tau * turns) <= 4.0 * EPS * abs(position)
        absent = set(sent['state']) - set(motion._fields) - {'velocity_ratio'}
        assert all(np.isnan(sent['state'][name]) for name in absent)
        for output in scene.topics:
            assert bags.output_message(output, 10**9, 0, sample, scene)


@some('case', CASES, [case for case in CASES if case.mode == 2][::5], ids=name_of)
def test_shown_and_drawn(case, tmp_path, capsys):
    pytest.importorskip('matplotlib')
    mechanism, given = next(contract.ordinary(case, 223, 1))
    scene = tmp_path / 'scene.yaml'
    scene.write_text(json.dumps({'/**': {'ros__parameters': values_of(mechanism, case.name)}}))
    at = str(np.degrees(given[0]) if case.turns else given[0])
    assert not main(['show', str(scene), '--at', at, '--speed', '3'])
    text = capsys.readouterr().out
    for name in known_quantities(case.kind, case.driven):
        assert name in text
    picture = tmp_path / 'pose.svg'
    assert not main(['draw', str(scene), '--at', at, '--speed', '3', '-o', str(picture)])
    assert picture.stat().st_size > 5_000
