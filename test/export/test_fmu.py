# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""FMUs: what they contain, their functions called as a master calls them."""
import ctypes
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_void_p
import math
import sys
from xml.etree import ElementTree
import zipfile

from fourbar_lab.export import fmu, generate
from fourbar_ros import load_scene
from fourbar_ros.dynamics.node_step import NOT_FINITE, OK
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.exported import COMPILERS
from support.scenes import PAPER, RODS

needs_compiler = pytest.mark.skipif(not COMPILERS or sys.platform != 'linux',
                                    reason='no C compiler, or a binary of another platform')


class Unit:
    """An FMU of FMI 2.0, its binary loaded."""

    def __init__(self, path, folder):
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        self.root = ElementTree.parse(folder / 'modelDescription.xml').getroot()
        variables = self.root.findall('ModelVariables/ScalarVariable')
        self.reference = {one.get('name'): int(one.get('valueReference')) for one in variables}
        self.causality = {one.get('name'): one.get('causality') for one in variables}
        self.library = ctypes.CDLL(str(next((folder / 'binaries' / 'linux64').iterdir())))
        self.library.fmi2Instantiate.restype = c_void_p
        self.instance = self.instantiate(self.root.get('guid').encode())

    def instantiate(self, guid, kind=1):
        return self.library.fmi2Instantiate(b'one', kind, guid, b'', None, 0, 0)

    def __call__(self, name, *arguments):
        """Call a function of FMI with the instance; fail unless it returns OK."""
        assert getattr(self.library, f'fmi2{name}')(c_void_p(self.instance), *arguments) == 0

    def of(self, names):
        references = (ctypes.c_uint * len(names))(*map(self.reference.get, names))
        return references, c_size_t(len(names)), (c_double * len(names))()

    def set(self, **values):
        references, count, room = self.of(list(values))
        room[:] = list(values.values())
        self('SetReal', references, count, room)

    def get(self, *names):
        references, count, room = self.of(names)
        self('GetReal', references, count, room)
        return list(room)


@pytest.fixture(scope='module')
def paper_file(tmp_path_factory):
    return generate('paper', tmp_path_factory.mktemp('paper'), 'fmu2').files[0]


@pytest.fixture
def paper(paper_file, tmp_path):
    return Unit(paper_file, tmp_path / 'paper')


DC = {'motor.kind': 'dc', 'motor.voltage': 24.0, 'motor.resistance': 0.5, 'motor.gear': 10.0,
      'motor.torque_constant': 0.3, 'motor.inductance': 0.005, 'shaft.stiffness': 400.0}
CONTROLLER = {'motor.kind': 'controller', 'motor.speed': 4.0, 'motor.proportional': 20.0,
              'motor.integral': 60.0, 'motor.torque_limit': 25.0}


@needs_compiler
@pytest.mark.parametrize('motor,given', [(DC, 'motor.voltage'), (CONTROLLER, 'motor.speed')],
                         ids=['voltage', 'speed'])
def test_voltage_and_speed_wanted_can_be_set_at_every_step(motor, given, tmp_path):
    scene = from_values({**PAPER, **RODS, **motor, 'drive.source': 'motor',
                         'motor.rotor_inertia': 0.1, 'outputs': ['state']})
    unit = Unit(generate(scene, tmp_path, 'fmu2', name='unit').files[0], tmp_path / 'unit')
    assert [given] == [name for name, cause in unit.causality.items() if cause == 'input']
    assert unit.root.find('ModelExchange') is None           # for co-simulation only
    assert unit.instantiate(unit.root.get('guid').encode(), kind=0) is None
    assert unit.get(given) == [scene.values[given]]
    unit('EnterInitializationMode')
    unit('ExitInitializationMode')
    names = [name for name in unit.causality if name.startswith('drive.')]
    rng, step, values = np.random.default_rng(3), 0.005, scene.mover.start()
    for _ in range(25):
        number = float(rng.uniform(-40.0, 40.0))
        mover = from_values({**scene.values, given: number}).mover       # a reference: anew
        unit.set(**{given: number})
        for _ in range(4):
            status, values = mover.next(values, step)
            unit('DoStep', c_double(0.0), c_double(step), 1)
            expected = {**values._asdict(), 'status': float(status)}
            assert unit.get(*names) == [expected[name[6:]] for name in names]
    end = unit.get(*names)
    for wrong in (-step, math.nan, math.inf):
        assert unit.library.fmi2DoStep(c_void_p(unit.instance), c_double(0.0), c_double(wrong), 1)
        assert unit.get(*names) == end
    for wrong in (math.nan, math.inf):            # held at rest, and goes on afterwards
        unit.set(**{given: wrong})
        unit('DoStep', c_double(0.0), c_double(step), 1)
        assert unit.get('drive.status', 'omega1') == [NOT_FINITE, 0.0]
    unit.set(**{given: 5.0})
    unit('DoStep', c_double(0.0), c_double(step), 1)
    assert unit.get('drive.status') == [OK] and unit.get('omega1')[0] > 0.0


@needs_compiler
def test_out_of_range_is_a_status_and_parameters_change(paper):
    paper.set(theta1=1.0, a1=5.0)
    status, theta4 = paper.get('status', 'theta4')
    assert status == 1.0 and math.isnan(theta4)
    paper.set(a1=-0.4)
    assert paper.get('status') == [2.0]
    paper.set(a1=0.37)
    other = load_scene('paper').linkage.with_lengths((0.37, 1.2, 0.8, 1.0))
    assert paper.get('status', 'theta4', 'f32') == [0.0, other.motion(1.0).theta4,
                                                    other.loads(1.0).f32]
    paper.set(theta1=math.inf)
    assert paper.get('status') == [2.0]


@needs_compiler
def test_the_first_error_of_a_compiler_is_said(tmp_path):
    (tmp_path / 'bad.c').write_text('#warning "a warning"\nint f(void) { return none; }\n')
    with pytest.raises(fmu.NotGenerated, match='bad.c: the C compiler refuses it: .* error: '):
        fmu.build(tmp_path / 'bad.c', tmp_path / 'bad.so')


@needs_compiler
def test_a_scene_may_be_called_like_a_word_of_the_source(tmp_path):
    """Of GUIDE it made {23dc...}E_step: no binary, and sources that nobody can build."""
    written = generate('paper', tmp_path, 'fmu2', name='GUIDE')
    unit = Unit(written.files[0], tmp_path / 'unit')
    unit.set(theta1=1.0)
    assert not written.notes
    assert unit.get('theta4') == [load_scene('paper').linkage.motion(1.0).theta4]


@needs_compiler
def test_states_are_kept_and_restored(paper):
    kept, first = c_void_p(), paper.get('theta1', 'a1', 'f41')
    paper.set(**{'theta1': 0.7, 'omega1': 3.0, 'bodies.crank.mass': 1.5})
    before = paper.get('f41', 'status')
    paper('GetFMUstate', byref(kept))
    paper.set(theta1=2.0, a1=0.3)
    assert paper.get('f41', 'status') != before
    paper('SetFMUstate', kept)
    assert paper.get('f41', 'status') == before
    paper('FreeFMUstate', byref(kept))
    assert kept.value is None
    paper('Reset')
    assert paper.get('theta1', 'a1', 'f41') == first


@needs_compiler
def test_what_is_not_there_is_refused(paper):
    assert paper.instantiate(b'{another}') is None
    references, room = (ctypes.c_uint * 1)(10_000), (c_double * 1)()
    for name in ('GetReal', 'SetReal'):
        function = getattr(paper.library, f'fmi2{name}')
        assert function(c_void_p(paper.instance), references, c_size_t(1), room) == 3
    text = c_char_p()
    assert paper.library.fmi2GetStringStatus(c_void_p(paper.instance), c_int(0),
                                             byref(text)) == 3
    paper.library.fmi2FreeInstance(c_void_p(paper.instance))


@pytest.fixture
def sources_alone(monkeypatch):
    """Let no unit be compiled."""
    monkeypatch.setattr(fmu, 'COMPILERS', ('no_such_compiler',))


def test_every_unit_has_a_definition_and_outputs_are_listed_once(tmp_path, sources_alone):
    path = generate('jansen', tmp_path, 'fmu2').files[0]
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read('modelDescription.xml'))
    units = {one.get('name') for one in root.findall('UnitDefinitions/Unit')}
    assert {'rad', 'rad/s2', 'N.m', 'kg.m2'} <= units
    assert {one.get('unit') for one in root.iter() if one.get('unit')} <= units
    variables = root.findall('ModelVariables/*')
    outputs = [i for i, one in enumerate(variables) if one.get('causality') == 'output']
    listed = root.findall('ModelStructure/Outputs/Unknown')
    assert len(outputs) == len(listed)
    assert {one.get('name').rpartition('.')[2].rstrip('12_') for one in variables
            if 'min' in one.attrib or 'min' in getattr(one.find('Real'), 'attrib', {})
            } == {'length', 'mass', 'inertia'}
    assert {'foot.x', 'status', 'driving_torque'} <= {one.get('name') for one in variables}
    names = [one.get('name').replace('.', '_') for one in variables]
    assert len(set(names)) == len(names)


def test_two_variables_of_one_name_are_refused(tmp_path, sources_alone):
    scene = from_values({**load_scene('paper').values, 'points.gravity.link': 'coupler'})
    with pytest.raises(fmu.NotGenerated, match='two variables would be called gravity.x'):
        generate(scene, tmp_path, 'fmu2', name='paper')
    assert not [*tmp_path.iterdir()]


def test_the_same_scene_gives_the_same_bytes(tmp_path):
    one, two = (generate('slides_7_6', tmp_path / name, 'fmu2').files[0] for name in 'ab')
    assert one.read_bytes() == two.read_bytes()


def test_without_a_compiler_it_has_sources_and_says_so(tmp_path, sources_alone):
    found = generate('paper', tmp_path, 'fmu2')
    assert any('no C compiler' in note for note in found.notes)
    with zipfile.ZipFile(found.files[0]) as archive:
        assert set(archive.namelist()) == {'modelDescription.xml', 'sources/paper.c'}


def test_forces_of_topics_are_inputs(tmp_path, sources_alone):
    values = {**load_scene('paper').values, 'external.output.from_topic': True}
    path = generate(from_values(values), tmp_path, 'fmu2', name='loaded').files[0]
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read('modelDescription.xml'))
    inputs = [one.get('name') for one in root.iter('ScalarVariable')
              if one.get('causality') == 'input']
    assert inputs[:3] == ['theta1', 'omega1', 'alpha1']
    assert 'external.output.force_x' in inputs and 'external.coupler.force_x' not in inputs
