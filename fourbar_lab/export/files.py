# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene as files: C with a C++ wrapper, or an FMU."""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from fourbar_lab.export.c_code import Code
from fourbar_lab.export.model import GeneratedModel, word
from fourbar_lab.export.statements import filled, snippet
from fourbar_ros.errors import InvalidParameter, one_of
from fourbar_ros.scene.scene import load, Scene
from fourbar_ros.scene.topics import TORQUE

FORMATS = ('c', 'fmu2', 'fmu3')


class Generated(NamedTuple):
    """The written files, with notes."""

    files: tuple[Path, ...]
    operations: int             # of the longest function, per sample
    notes: tuple[str, ...]      # for the user: a changed name, omissions; a line each


def generate(scene: str | Path | Scene, directory: str | Path, as_: str = 'c',
             outputs: Sequence[str] | None = None, parameters: Sequence[str] | None = None,
             name: str = '') -> Generated:
    """
    Write a scene as C code or an FMU that has the bits of ``step``; return what was written.

    ``scene`` may be its file or the name of a shipped one; ``directory`` is made if it is not
    there. ``as_`` is 'c' (NAME.h and NAME.c, C99, and a wrapper NAME.hpp), 'fmu2' or 'fmu3'
    (NAME.fmu of FMI 2.0 or 3.0). ``name`` is the prefix of all names, by default that of the
    scene's file.

    ``outputs``: fields of motion and loads, and POINT.FIELD of points; by default all, of an FMU
    all with a unit. ``parameters``: what can be changed at run time, as ``a1`` and
    ``bodies.crank.mass``; by default all numbers that are not left out.

    NotGenerated of a scene, or what is asked of it, that cannot be generated; InvalidParameter of
    an output, a parameter or a format that is not known.
    """
    if as_ not in FORMATS:
        raise InvalidParameter('as', as_, one_of(FORMATS))
    found = scene if isinstance(scene, Scene) else load(scene)
    stem = name or ('linkage' if isinstance(scene, Scene) else Path(scene).stem)
    model = GeneratedModel(found, word(stem), outputs, parameters)
    model.check()
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    notes = [f'{stem} is {model.name}'] if model.name != stem else []
    if not model.loads and outputs is None:
        notes.append(f'no loads: {found.why_no_loads}')
    if as_ != 'c':
        from fourbar_lab.export.fmu import write
        path, more, operations = write(model, directory, int(as_[-1]))
        return Generated((path,), operations, (*notes, *more))
    code = Code(model)
    texts = {'.h': code.header(), '.c': code.source(), '.hpp': wrapper(model)}
    paths = [directory / (model.name + ending) for ending in texts]
    for path, text in zip(paths, texts.values()):
        path.write_text(text, encoding='utf-8')
    return Generated(tuple(paths), max(code.operations.values()), tuple(notes))


def wrapper(model: GeneratedModel) -> str:
    """Return the C++ header around a generated C header."""
    torque = 'double torque' * (model.scene.drive.source == TORQUE.name)
    drive = snippet('wrapper.hpp', 'drive') if model.moves_by_torque else ''
    drive = filled(drive, {'FIRST': torque, ' ARGUMENT': torque and f', {torque}',
                           ' PASSED': ', torque' if torque else '', 'NAME': model.name})
    return filled(snippet('wrapper.hpp'), {
        'USING_LOADS': f'using Loads = {model.name}_loads;\n' if model.loads else '',
        'OF_BOTH\n': filled(snippet('wrapper.hpp', 'loads'), {'NAME': model.name})
        if model.loads else '', 'DRIVE\n': drive, 'NAME': model.name,
        'GUARD': f'FOURBAR_{model.name.upper()}_HPP'})
