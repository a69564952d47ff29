# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""No number is cropped, whatever the width: cells are wrapped."""
import re
import subprocess

from fourbar_lab.drawing.tables import proofs_in_words
from fourbar_ros.extrema import Extremum
import pytest
from support import bags, ROOT
from support.samples import some
from support.scenes import PAPER, RODS
from support.terminals import numbers, python, shown

VERBS = {
    'show': ['show', 'config/paper.yaml', '--at', '60'],
    'show of a slide': ['show', 'config/cylinder.yaml', '--at', '1.5'],
    'scene check': ['scene', 'check', 'config/slider_crank.yaml'],
    'reproduce': ['reproduce'],
    'bag info': ['bag', 'info', '{bag}', '--check'],
    'bag recompute': ['bag', 'recompute', '{bag}'],
    'bag diff': ['bag', 'diff', '{bag}', '{other}'],
    'bag scene': ['bag', 'scene', '{bag}'],
}
RUN = ('import sys; from fourbar_ros.cli import main, scene; scene.step_cost = lambda scene: '
       '1e-5; sys.exit(main.main({}))')


@pytest.fixture(scope='module')
def files(tmp_path_factory):
    """Two bags: what differs between them has digits."""
    folder = tmp_path_factory.mktemp('bags')
    values = {**PAPER, **RODS, 'outputs': ['state', 'loads', 'joint_states']}
    return {name: str(bags.run(folder, name, values, [(0.1 * k + e, 25.0, 0.0) for k in range(5)],
                               paced=True))
            for name, e in (('bag', 0.0), ('other', 1e-9))}


@some('name', VERBS, 1)
def test_numbers_are_whole_and_nothing_is_cropped(name, files):
    command = python(RUN.format([word.format(**files) for word in VERBS[name]]))
    wide = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert 'Traceback' not in wide.stderr, wide.stderr
    assert numbers(wide.stdout)
    for width in (120, 60):
        text, code = shown(command, width)
        assert code == wide.returncode and '…' not in text
        assert sorted(re.sub(r'\s', '', text)) == sorted(re.sub(r'\s', '', wide.stdout)), width


def test_proofs_are_told_in_words_and_what_is_not_certain_without_being_asked():
    one = Extremum('omega4', 'rad/s', 2, 'minimum', 0.1, 1.0, True)
    assert not proofs_in_words([one])
    assert proofs_in_words([
        one._replace(proof='interval bounds'), one,
        one._replace(quantity='f41', proof='not certain: extrema are missing')]) == (
            'proved complete: omega4\nnot certain: extrema are missing: f41')
