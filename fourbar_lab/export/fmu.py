# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A model as an FMU of FMI 2.0: description, sources, binary of this platform.

The input and, of links that topics load, the external forces are inputs; parameters are tunable.
A sample out of range is no error: its outputs are NaN, and ``status`` says why.
"""
from collections import Counter
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

from fourbar_lab.export.c_code import Code, FLAGS, statuses_of
from fourbar_lab.export.drive import DriveCode, STATUS_OF_DRIVE
from fourbar_lab.export.model import GeneratedModel, Named, NotGenerated
from fourbar_lab.export.statements import snippet
from fourbar_ros import __version__
from fourbar_ros.description.xml import add, as_text, Element

PLATFORMS = {'linux': ('linux64', 'so'), 'darwin': ('darwin64', 'dylib'),
             'win32': ('win64', 'dll')}
COMPILERS = ('cc', 'gcc', 'clang')
# types of which no variable is, and functions of what is not offered: by FMI they must be there
TYPES = 'Integer Boolean String'
NOT_OFFERED = """SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate GetStatus
    GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus CancelStep
    SetRealInputDerivatives GetRealOutputDerivatives GetDirectionalDerivative"""
MADE = (1980, 1, 1, 0, 0, 0)     # of all files of the archive: the same scene, the same bytes
DRIVE_TEXT = ', '.join(f'{i} {text.replace("_", " ")}' for i, text in enumerate(STATUS_OF_DRIVE))


class Variable(NamedTuple):
    """A variable of an FMU."""

    name: str
    reference: int                  # index among the values of the instance
    causality: str
    unit: str
    text: str
    start: float
    is_positive: bool = False       # 0 or more


def write(model: GeneratedModel, directory: Path) -> tuple[Path, list[str], int]:
    """Write NAME.fmu; return its path, notes for its user, and the operations per sample."""
    # Without a compiler the FMU has sources alone, which many masters build.
    if model.outputs is None:
        texts = model.units_and_texts
        model = replace(model, outputs=[
            entry.name for entry in (*model.motion, *model.loads)
            if entry.name in texts and texts[entry.name][0]])
    code = Code(model)
    variables = _variables(model, code.drive)
    for name, count in Counter(variable.name for variable in variables).items():
        if count > 1:       # of a point called gravity
            raise NotGenerated(f'{model.name}: two variables would be called {name}; rename the '
                               'point or dyad')
    text = _source(code)
    guid = str(uuid.uuid5(uuid.NAMESPACE_URL, text + repr(variables)))
    source = text.replace('"GUID"', f'"{{{guid}}}"')       # which no name of the scene is
    description = _description(model, variables, f'{{{guid}}}')
    inside = {'modelDescription.xml': as_text(description).encode(),
              f'sources/{model.name}.c': source.encode()}
    notes = []
    machine = {'AMD64': 'x86_64'}.get(platform.machine(), platform.machine())
    try:
        if sys.platform not in PLATFORMS or machine != 'x86_64':
            raise NotGenerated(f'FMI 2.0 has no name for a binary of {machine} on {sys.platform}')
        folder_name, ending = PLATFORMS[sys.platform]
        with TemporaryDirectory() as folder:
            path, library = (Path(folder) / f'{model.name}.{suffix}' for suffix in ('c', ending))
            path.write_text(source, encoding='utf-8')
            build(path, library, flags=[*FLAGS.split(), '-fvisibility=hidden', '-s'])
            inside[f'binaries/{folder_name}/{library.name}'] = library.read_bytes()
    except NotGenerated as error:
        notes.append(f'{error}: the FMU has sources alone')
    path = directory / f'{model.name}.fmu'
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, content in inside.items():
            archive.writestr(zipfile.ZipInfo(name, MADE), content, zipfile.ZIP_DEFLATED)
    return path, notes, max(code.operations.values())


def _variables(model: GeneratedModel, drive: DriveCode | None) -> list[Variable]:
    """Return the variables of the FMU, in the order of the description."""
    # Value references: inputs from 0, then parameters, motion, loads, status and time. With a
    # drive its values follow, and no motion is prescribed: a torque, if commanded, is the input.
    position, *rates = model.inputs
    (start, _, _), _ = model.sample()       # the links close there
    groups: dict[str, Sequence[Named]] = {
        'input': [position._replace(value=start), *rates], 'parameter': model.tunable,
        'output': (*model.motion, *model.loads)}
    variables = list[Variable]()
    for causality, named in groups.items():
        for entry in named:
            is_topic = entry.name.rpartition('.')[0] in model.from_topics
            variables.append(Variable(
                entry.name, len(variables), 'input' if is_topic else causality, entry.unit,
                entry.text, entry.value, bool(model.bound_of(entry.name))))
    last = len(variables)
    status = Variable('status', last, 'output', '', ', '.join(
        f'{i} {text.replace("_", " ")}' for i, text in statuses_of(model.mechanism).items()), 0.0)
    if drive is None:
        inputs = {entry.name for entry in model.inputs}
        return [*(variable for variable in variables
                  if variable.causality != 'output' or variable.name not in inputs), status]
    signs = {f'sign_{i + 1}' for i in range(len(model.signs))} | {'sign'}
    first = last + 2                      # behind the time
    of_drive = [Variable(f'drive.{entry.name}', first + i, 'output', entry.unit, entry.text, 0.0)
                for i, entry in enumerate(drive.fields) if entry.name in drive.defined]
    last = first + len(drive.fields)
    command = drive.command
    commanded = [Variable(command.name, last + 1, 'input', command.unit, command.text,
                          command.value)] if command else []
    kept = [variable for variable in variables
            if variable.reference >= len(model.inputs) and variable.name not in signs]
    return [*commanded, *kept, status, *of_drive,
            Variable('drive.status', last, 'output', '', DRIVE_TEXT, 0.0)]


def _source(code: Code) -> str:
    """Return the C text of the FMU: the generated code, its settings, the functions of FMI."""
    model, name = code.model, code.name
    drive = code.drive
    command = drive.command if drive else None
    is_torque_given = bool(drive and drive.takes_torque)
    settings = {
        'INPUTS': len(model.inputs), 'PARAMETERS': len(model.tunable), 'LOADS': len(model.loads),
        'START': repr(model.sample()[0][0]),
        'HAS_DRIVE': int(bool(drive)), 'HAS_MODES': int(bool(drive and model.signs)),
        'DRIVE_NUMBERS': len(drive.fields) if drive else 0, 'HAS_COMMAND': int(bool(command)),
        'COMMAND': f'state->{f"drive.{command.field}" if command and command.field else "torque"}',
        'GIVEN_TORQUE': ', state->torque' if is_torque_given else '',
        'BEGIN': f'{name}_{"start" if is_torque_given else "complete"}'}
    defined = ''.join(f'#define {word} {meaning}\n' for word, meaning in settings.items())
    not_there = [*(f'NONE(fmi2{access}{kind})\n' for kind in TYPES.split()
                   for access in ('Get', 'Set')),
                 *(f'REFUSED(fmi2{function})\n' for function in NOT_OFFERED.split())]
    text = code.source().replace(f'#include "{name}.h"\n', code.header())
    return text + defined + snippet('fmu.c').replace('NAME', name) + ''.join(not_there)


def build(source: Path, library: Path, command: str = '',
          flags: Sequence[str] = tuple(FLAGS.split())) -> None:
    """Compile C to a shared library; NotGenerated without a compiler, or of its first error."""
    command = command or next(filter(None, map(shutil.which, COMPILERS)), '')
    if not command:
        raise NotGenerated(f'no C compiler ({", ".join(COMPILERS)}) on the path')
    done = subprocess.run([command, *flags, '-shared', '-fPIC', '-o', str(library), str(source),
                           '-lm'], capture_output=True, text=True, check=False)
    if done.returncode:
        lines = done.stderr.splitlines() or ['no message']
        first = next((line for line in lines if ' error: ' in line), lines[0])
        raise NotGenerated(f'{source.name}: the C compiler refuses it: {first}')


# --- descriptions --------------------------------------------------------------------------------

def _unit(unit: str) -> str:
    """Return a unit as FMI writes it: N.m, rad/s2."""
    return unit.replace(' ', '.').replace('^', '')


def _description(model: GeneratedModel, variables: list[Variable], guid: str) -> Element:
    """Return modelDescription.xml; dependencies name variables by their order, from 1."""
    root = Element('fmiModelDescription', {
        'fmiVersion': '2.0', 'modelName': model.name,
        'description': f'{model.mechanism.description}, mode {model.mechanism.mode}',
        'version': __version__, 'generationTool': f'fourbar_ros {__version__}',
        'variableNamingConvention': 'structured', 'guid': guid})
    # model exchange is for motion by its inputs, which has no state: it is solved with the model
    # around it, without the delay of a step; motion by torque has steps of its own
    for tag in ('CoSimulation',) if model.moves_by_torque else ('ModelExchange', 'CoSimulation'):
        kind = add(root, tag, modelIdentifier=model.name, canGetAndSetFMUstate='true')
        if tag == 'CoSimulation':
            kind.set('canHandleVariableCommunicationStepSize', 'true')
        add(add(kind, 'SourceFiles'), 'File', name=f'{model.name}.c')
    units = add(root, 'UnitDefinitions')
    for unit in sorted({variable.unit for variable in variables if variable.unit} | {'s'}):
        element = add(units, 'Unit', name=_unit(unit))
        if unit == 'rad':
            add(element, 'DisplayUnit', name='deg', factor=repr(180.0 / pi))
    step = 1.0 / model.scene.drive.rate if model.moves_by_torque else 0.001
    add(root, 'DefaultExperiment', startTime='0', stopTime='1', stepSize=repr(step))
    listed = add(root, 'ModelVariables')
    for variable in variables:
        element = add(listed, 'ScalarVariable', name=variable.name,
                      valueReference=variable.reference, causality=variable.causality,
                      variability='tunable' if variable.causality == 'parameter' else 'continuous')
        real = add(element, 'Real')
        if variable.text:
            element.set('description', variable.text)
        if variable.unit:
            real.set('unit', _unit(variable.unit))
        if variable.is_positive:
            real.set('min', '0')
        if variable.causality != 'output':
            real.set('start', repr(variable.start))
    structure = add(root, 'ModelStructure')
    order = {variable.name: i for i, variable in enumerate(variables, 1)}
    not_outputs = [variable for variable in variables if variable.causality != 'output']
    # on torque, voltage or speed of the motor outputs depend by steps alone, not at once
    inputs = [variable for variable in not_outputs if variable.causality == 'input'
              and variable.name != 'torque' and not variable.name.startswith('motor.')]
    for tag, known in (('Outputs', inputs), ('InitialUnknowns', not_outputs)):
        on = ' '.join(str(order[variable.name]) for variable in known)
        unknowns = add(structure, tag)
        for variable in variables:
            if variable.causality == 'output':
                add(unknowns, 'Unknown', index=order[variable.name], dependencies=on)
    return root
