# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A model as an FMU, FMI 2.0 or 3.0: description, sources, binary of this platform.

The input and, of links that topics load, the external forces are inputs; parameters are tunable.
A sample out of range is no error: its outputs are NaN, and ``status`` says why.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi
from pathlib import Path
import platform
import shutil
import subprocess
import sys
from tempfile import TemporaryDirectory
from typing import NamedTuple
import uuid
import zipfile

from fourbar_lab.export.c_code import Code, FLAGS, STATUS
from fourbar_lab.export.drive import DriveCode, STATUS_OF_DRIVE
from fourbar_lab.export.model import GeneratedModel, Named, NotGenerated
from fourbar_lab.export.statements import snippet
from fourbar_ros import __version__
from fourbar_ros.description.xml import add, as_text, Element

PLATFORMS = {'linux': ('linux64', '{}-linux', 'so'), 'darwin': ('darwin64', '{}-darwin', 'dylib'),
             'win32': ('win64', '{}-windows', 'dll')}
COMPILERS = ('cc', 'gcc', 'clang')
# types of which no variable is, and functions of what is not offered: by FMI they must be there
TYPES = {2: 'Integer Boolean String',
         3: 'Float32 Int8 UInt8 Int16 UInt16 Int32 UInt32 Int64 UInt64 Boolean String'}
NOT_OFFERED = {
    2: """SerializedFMUstateSize SerializeFMUstate
        DeSerializeFMUstate GetStatus GetRealStatus GetIntegerStatus GetBooleanStatus
        GetStringStatus CancelStep SetRealInputDerivatives GetRealOutputDerivatives
        GetDirectionalDerivative""",
    3: """SerializedFMUStateSize SerializeFMUState
        DeserializeFMUState EnterConfigurationMode ExitConfigurationMode EvaluateDiscreteStates
        EnterStepMode GetBinary SetBinary GetClock SetClock GetNumberOfVariableDependencies
        GetVariableDependencies GetAdjointDerivative GetOutputDerivatives GetIntervalDecimal
        SetIntervalDecimal GetShiftDecimal SetShiftDecimal GetIntervalFraction
        SetIntervalFraction GetShiftFraction SetShiftFraction ActivateModelPartition
        GetDirectionalDerivative"""}
STATE = {2: 'FMUstate', 3: 'FMUState'}
MADE = (1980, 1, 1, 0, 0, 0)     # of all files of the archive: the same scene, the same bytes
DRIVE_TEXT = ', '.join(f'{i} {text.replace("_", " ")}' for i, text in enumerate(STATUS_OF_DRIVE))
STATUS_TEXT = ', '.join(f'{i} {text.replace("_", " ")}' for i, text in enumerate(STATUS))


class Variable(NamedTuple):
    """
    A variable of an FMU.

    ``reference``: its place among the numbers of the instance; ``is_positive``: 0 or more.
    """

    name: str
    reference: int
    causality: str
    unit: str
    text: str
    start: float
    is_positive: bool = False


def write(model: GeneratedModel, directory: Path, version: int) -> tuple[Path, list[str], int]:
    """
    Write NAME.fmu; return it, notes for its user, and the operations per sample.

    Without a compiler it has sources alone, which many masters build.
    """
    if model.outputs is None:
        texts = model.units_and_texts
        model = replace(model, outputs=[one.name for one in (*model.motion, *model.loads)
                                        if texts.get(one.name, ('', ''))[0]])
    code = Code(model)
    variables = _variables(model, code.drive)
    text = _source(code, version)
    guid = str(uuid.uuid5(uuid.NAMESPACE_URL, text + repr(variables)))
    source = text.replace('GUID', f'{{{guid}}}')
    description = _description(model, variables, f'{{{guid}}}', version)
    inside = {'modelDescription.xml': as_text(description).encode(),
              f'sources/{model.name}.c': source.encode()}
    if version == 3:
        inside['sources/buildDescription.xml'] = as_text(_build_description(model)).encode()
    notes = []
    try:
        inside.update(_binary(model.name, source, version))
    except NotGenerated as error:
        notes.append(f'{error}: the FMU has sources alone')
    path = directory / f'{model.name}.fmu'
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, content in inside.items():
            archive.writestr(zipfile.ZipInfo(name, MADE), content, zipfile.ZIP_DEFLATED)
    return path, notes, max(code.operations.values())


def _variables(model: GeneratedModel, drive: DriveCode | None) -> list[Variable]:
    """
    Return the variables of the FMU, in the order of the description.

    Value references: inputs from 0, then parameters, motion, loads, status and time. With a drive
    its values follow, and no motion is prescribed: a torque, if commanded, is the input.
    """
    position, *rates = model.inputs
    start = model.sample()[0][0]      # a pose that exists
    groups: dict[str, Sequence[Named]] = {
        'input': [position._replace(value=start), *rates], 'parameter': model.tunable,
        'output': (*model.motion, *model.loads)}
    found = list[Variable]()
    for causality, named in groups.items():
        for one in named:
            is_topic = one.name.rpartition('.')[0] in model.from_topics
            found.append(Variable(one.name, len(found), 'input' if is_topic else causality,
                                  one.unit, one.text, one.value, bool(model.bound_of(one.name))))
    last = len(found)
    status = Variable('status', last, 'output', '', STATUS_TEXT, 0.0)
    if drive is None:
        given = {one.name for one in model.inputs}
        return [*(one for one in found if one.causality != 'output' or one.name not in given),
                status]
    signs = {f'sign_{i + 1}' for i in range(len(model.signs))} | {'sign'}
    first = last + 2                      # behind the time
    of_drive = [Variable(f'drive.{one.name}', first + i, 'output', one.unit, one.text, 0.0)
                for i, one in enumerate(drive.numbers) if one.name in drive.there]
    last = first + len(drive.numbers)
    command = drive.command
    own_input = [Variable(command.name, last + 1, 'input', command.unit, command.text,
                          command.value)] if command else []
    kept = [one for one in found if one.reference >= len(model.inputs) and one.name not in signs]
    return [*own_input, *kept, status,
            *of_drive, Variable('drive.status', last, 'output', '', DRIVE_TEXT, 0.0)]


def _source(code: Code, version: int) -> str:
    """Return header, formulas and the functions of FMI as one file."""
    model, name = code.model, code.name
    header = code.header().replace('extern "C" {', '').replace('#ifdef __cplusplus\n}\n#endif\n',
                                                               '')
    drive = code.drive
    command = drive.command if drive else None
    is_torque_given = bool(drive and drive.takes_torque)
    settings = {
        'INPUTS': len(model.inputs), 'PARAMETERS': len(model.tunable), 'LOADS': len(model.loads),
        'START': repr(model.sample()[0][0]),
        'HAS_DRIVE': int(bool(drive)), 'HAS_MODES': int(bool(drive and model.signs)),
        'DRIVE_NUMBERS': len(drive.numbers) if drive else 0, 'HAS_COMMAND': int(bool(command)),
        'COMMAND': f'state->{f"drive.{command.field}" if command and command.field else "torque"}',
        'GIVEN_TORQUE': ', state->torque' * is_torque_given,
        'BEGIN': f'{name}_{"start" if is_torque_given else "complete"}'}
    defined = ''.join(f'#define {word} {meaning}\n' for word, meaning in settings.items())
    # the versions differ in the type of flags and in a letter of the state
    flag = '#include <stdbool.h>\ntypedef bool Flag;\n' if version == 3 else 'typedef int Flag;\n'
    shared = (snippet('fmu.c') + snippet(f'fmu{version}.c')).replace('FMI_', f'fmi{version}')
    shared = shared.replace(STATE[3], STATE[version])
    not_there = [*(f'NONE(fmi{version}{access}{kind})\n' for kind in TYPES[version].split()
                   for access in ('Get', 'Set')),
                 *(f'REFUSED(fmi{version}{what})\n' for what in NOT_OFFERED[version].split())]
    text = code.source().replace(f'#include "{name}.h"\n', header)
    return text + defined + flag + shared.replace('NAME', name) + ''.join(not_there)


def build(source: Path, library: Path, command: str = '',
          flags: Sequence[str] = tuple(FLAGS.split())) -> None:
    """Compile C into a shared library; NotGenerated without a compiler, or with its first line."""
    command = command or next(filter(None, map(shutil.which, COMPILERS)), '')
    if not command:
        raise NotGenerated(f'no C compiler ({", ".join(COMPILERS)}) on the path')
    done = subprocess.run([command, *flags, '-shared', '-fPIC', '-o', str(library), str(source),
                           '-lm'], capture_output=True, text=True, check=False)
    if done.returncode:
        raise NotGenerated(f'{source.name}: the C compiler refuses it: '
                           f'{(done.stderr.splitlines() or ["no message"])[0]}')


def _binary(name: str, source: str, version: int) -> dict[str, bytes]:
    """Return {place in the archive: bytes} of the library for this platform."""
    if sys.platform not in PLATFORMS:
        raise NotGenerated(f'FMI has no name for a binary of {sys.platform}')
    two, three, ending = PLATFORMS[sys.platform]
    machine = {'AMD64': 'x86_64', 'arm64': 'aarch64'}.get(platform.machine(), platform.machine())
    if version == 2 and machine != 'x86_64':
        raise NotGenerated(f'FMI 2.0 has no name for a binary of {machine}')
    with TemporaryDirectory() as folder:
        path, library = Path(folder) / f'{name}.c', Path(folder) / f'{name}.{ending}'
        path.write_text(source, encoding='utf-8')
        build(path, library, flags=[*FLAGS.split(), '-fvisibility=hidden', '-s'])
        where = two if version == 2 else three.format(machine)
        return {f'binaries/{where}/{library.name}': library.read_bytes()}


# --- descriptions --------------------------------------------------------------------------------

def _unit(unit: str) -> str:
    """Return a unit as FMI writes it: N.m, rad/s2."""
    return unit.replace(' ', '.').replace('^', '')


def _units(root: Element, variables: list[Variable]) -> None:
    """Add all units in use, by name."""
    units = add(root, 'UnitDefinitions')
    for unit in sorted({one.unit for one in variables if one.unit} | {'s'}):
        own = add(units, 'Unit', name=_unit(unit))
        if unit == 'rad':
            add(own, 'DisplayUnit', name='deg', factor=repr(180.0 / pi))


def _description(model: GeneratedModel, variables: list[Variable], guid: str,
                 version: int) -> Element:
    """
    Return modelDescription.xml.

    Dependencies name variables by their order, from 1, in FMI 2.0, by value references in 3.0.
    """
    is_2 = version == 2
    root = Element('fmiModelDescription', {
        'fmiVersion': f'{version}.0', 'modelName': model.name,
        'description': f'{model.mechanism.description}, mode {model.mechanism.mode}',
        'version': __version__, 'generationTool': f'fourbar_ros {__version__}',
        'variableNamingConvention': 'structured', 'guid' if is_2 else 'instantiationToken': guid})
    # model exchange is for motion by its inputs, which has no state: it is solved with the model
    # around it, without the delay of a step; motion by torque has steps of its own
    for tag in ('CoSimulation',) if model.moves_by_torque else ('ModelExchange', 'CoSimulation'):
        kind = add(root, tag, modelIdentifier=model.name,
                   **{f'canGetAndSet{STATE[version]}': 'true'})
        if tag == 'CoSimulation':
            kind.set('canHandleVariableCommunicationStepSize', 'true')
        if is_2:
            add(add(kind, 'SourceFiles'), 'File', name=f'{model.name}.c')
    _units(root, variables)
    step = 1.0 / model.scene.drive.rate if model.moves_by_torque else 0.001
    add(root, 'DefaultExperiment', startTime='0', stopTime='1', stepSize=repr(step))
    listed = add(root, 'ModelVariables')
    if not is_2:
        status = next(one for one in variables if one.name == 'status')
        add(listed, 'Float64', name='time', valueReference=status.reference + 1,
            causality='independent', variability='continuous', unit='s')
    for one in variables:
        variability = 'tunable' if one.causality == 'parameter' else 'continuous'
        variable = add(listed, 'ScalarVariable' if is_2 else 'Float64', name=one.name,
                       valueReference=one.reference, causality=one.causality,
                       variability=variability)
        number = add(variable, 'Real') if is_2 else variable
        if one.text:
            variable.set('description', one.text)
        if one.unit:
            number.set('unit', _unit(one.unit))
        if one.is_positive:
            number.set('min', '0')
        if one.causality != 'output':
            number.set('start', repr(one.start))
    structure = add(root, 'ModelStructure')
    numbers = {one.name: i if is_2 else one.reference for i, one in enumerate(variables, 1)}
    not_outputs = [one for one in variables if one.causality != 'output']
    # on torque, voltage or speed of the motor outputs depend by steps alone, not at once
    inputs = [one for one in not_outputs if one.causality == 'input' and one.name != 'torque'
              and not one.name.startswith('motor.')]
    for tag, given in (('Output', inputs), ('InitialUnknown', not_outputs)):
        on = ' '.join(str(numbers[one.name]) for one in given)
        under, name, key = ((add(structure, f'{tag}s'), 'Unknown', 'index') if is_2
                            else (structure, tag, 'valueReference'))
        for one in variables:
            if one.causality == 'output':
                add(under, name, **{key: numbers[one.name]}).set('dependencies', on)
    return root


def _build_description(model: GeneratedModel) -> Element:
    """Return buildDescription.xml of FMI 3.0: which C file is compiled, and how."""
    root = Element('fmiBuildDescription', fmiVersion='3.0')
    own = add(root, 'BuildConfiguration', modelIdentifier=model.name)
    files = add(own, 'SourceFileSet', language='C99', compiler='gcc', compilerOptions=FLAGS)
    add(files, 'SourceFile', name=f'{model.name}.c')
    return root
