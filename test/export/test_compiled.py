# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded inputs through generated code: ``fourbar bag recompute --with``."""
import json
import math
import pickle

from fourbar_lab.export import Compiled, generate
from fourbar_lab.export.model import NotGenerated
from fourbar_ros import load_scene
from fourbar_ros.cli.main import main
from fourbar_ros.pipeline.stepper import evaluate
import numpy as np
import pytest
from support.bags import run
from support.exported import COMPILERS

pytestmark = pytest.mark.skipif(not COMPILERS, reason='no C compiler')


def recorded(directory, scene, count):
    """Return a bag of a scene, its input over more than its range, with unknown rates."""
    low, high = scene.linkage.input_ranges[0]
    inputs = [(float(x), 3.0 * math.sin(x), 0.5) for x in
              np.linspace(1.02 * low - 0.02 * high, 1.02 * high - 0.02 * low, count)]
    return run(directory, 'run', scene.values, inputs)


def recomputed(bag, folder, capsys):
    """Return the exit code and what is said as JSON."""
    code = main(['bag', 'recompute', str(bag), '--with', str(folder), '--json'])
    return code, json.loads(capsys.readouterr().out)


@pytest.mark.parametrize('name', ['paper', 'cylinder', 'jansen'])
def test_a_bag_recomputes_with_differences_of_0(name, tmp_path, capsys):
    scene = load_scene(name)
    bag = recorded(tmp_path, scene, 60)
    generate(scene, tmp_path / 'code', name=name)
    code, said = recomputed(bag, tmp_path / 'code', capsys)
    assert code == 0 and said['inputs'] == 60 and said['largest'] == 0.0


def test_code_of_another_scene_is_refused(tmp_path, capsys):
    bag = recorded(tmp_path, load_scene('paper'), 5)
    generate('slides_7_7', tmp_path / 'code')
    assert main(['bag', 'recompute', str(bag), '--with', str(tmp_path / 'code')]) == 1
    assert 'slides_7_7' in capsys.readouterr().err
    generate('paper', tmp_path / 'few', outputs=['theta4'])
    assert main(['bag', 'recompute', str(bag), '--with', str(tmp_path / 'few')]) == 1
    assert 'generated without' in capsys.readouterr().err
    with pytest.raises(NotGenerated, match='expected one'):
        Compiled(tmp_path)


def test_it_passes_from_process_to_process(tmp_path):
    generate('paper', tmp_path)
    found = pickle.loads(pickle.dumps(Compiled(tmp_path)))
    linkage = load_scene('paper').linkage
    given = linkage, 1.0, 2.0, 3.0, True
    assert found.evaluate(*given) == evaluate(*given)


@pytest.mark.parametrize('text', ['{', '{}', '[]', '{"scene": {}, "name": 1}'])
def test_a_folder_of_another_program_is_refused(text, tmp_path):
    (tmp_path / 'other.json').write_text(text)
    with pytest.raises(NotGenerated, match='other.json: not of fourbar generate'):
        Compiled(tmp_path)
