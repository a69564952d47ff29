# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""No number is cropped, whatever the width: cells are wrapped."""
import re
import subprocess

from fourbar_lab.drawing.tables import jumps_in_words, proofs_in_words
from fourbar_ros.extrema import Extremum, find_extrema
from fourbar_ros.scene import from_values
from fourbar_ros.scene.elements import element_names
from fourbar_ros.scene.files import read_values
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


PRESS = {**read_values('press'), 'forces.gas.link': 'crank',
         'forces.gas.acts': 'couple', 'forces.gas.periodic': True,       # without a jump
         'forces.gas.places': ['0deg', '90deg', '360deg'], 'forces.gas.values': [0.0, 2.0, 0.0]}
WAY = {'forces.cut.places': [120.0, 200.0], 'forces.cut.values': [-2.0, -2.0]}
LATCH = {'torsion_springs.latch.second': 'crank', 'torsion_springs.latch.stiffness': 1.0,
         'torsion_springs.latch.free_angle': 1.0}
FREE = {name: value for name, value in PRESS.items() if not name.startswith('friction')}
CUT = 'forces.cut steps at 326.8771 deg'
BOTH = CUT.replace('326', '33.1229 deg, 326')
TURNS = 'forces.cut begins or ends (when: forward) at 0.0000 deg'
RUBS = 'friction changes its direction at 0.0000 deg, 90.0000 deg, 180.0000 deg, 270.0000 deg'


@pytest.mark.parametrize(('values', 'words'), [
    (PRESS, f'{TURNS}; {CUT}; {RUBS}'), (FREE, f'{TURNS}; {CUT}'),
    ({**FREE, 'forces.cut.when': 'both'}, BOTH),
    ({**FREE, **WAY}, TURNS.replace(' deg', ' deg, 180.0000 deg')),
    ({**FREE, 'forces.cut.when': 'both', **LATCH},
     f'torsion_springs.latch comes round at 237.2958 deg; {BOTH}'),
    ({**FREE, 'forces.cut.when': 'both', **WAY}, '')])
def test_what_jumps_is_told_by_its_name_and_where(values, words):
    scene = from_values(values)
    extrema = find_extrema(scene.linkage, ('driving_torque', 'guide_force', 'f32'), 9.0)
    told = jumps_in_words(scene.linkage, element_names(scene.values), extrema, (9.0, 0.0))
    assert told.removeprefix('from below, from above: loads jump, both values count: ') == words
