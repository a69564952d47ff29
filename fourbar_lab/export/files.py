# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene as files: C, JavaScript, or an FMU."""
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from fourbar_lab.export.c_code import Code
from fourbar_lab.export.model import GeneratedModel, NotGenerated, word
from fourbar_ros.errors import InvalidParameter, one_of
from fourbar_ros.scene.scene import load, Scene

FORMATS = ('c', 'fmu2', 'js')
ENDINGS = {'c': ('.h', '.c'), 'fmu2': ('.fmu',), 'js': ('.js',)}


class Generated(NamedTuple):
    """The written files, with notes."""

    files: tuple[Path, ...]
    operations: int             # of the longest function, per sample
    notes: tuple[str, ...]      # for the user: a changed name, omissions; a line each


def paths_of(stem: str, directory: Path, as_: str) -> list[Path]:
    """Return the files that :func:`generate` writes in a format, under a name."""
    return [directory / (word(stem) + ending) for ending in ENDINGS[as_]]


def generate(scene: str | Path | Scene, directory: str | Path, as_: str = 'c',
             outputs: Sequence[str] | None = None, parameters: Sequence[str] | None = None,
             name: str = '') -> Generated:
    """
    Write a scene as code that has the bits of ``step``, or its digits; return what was written.

    ``scene`` may be its file or the name of a shipped one; ``directory`` is made if it is not
    there. ``as_`` is 'c' (NAME.h and NAME.c, C99, for C++ too), 'fmu2' (NAME.fmu of FMI 2.0) or
    'js' (NAME.js, a module whose parameters are the scene's, with the sines of its engine).
    ``name`` is the prefix of all names, by default that of the scene's file.

    ``outputs``: fields of motion and loads, and POINT.FIELD of points; by default all, of an FMU
    all with a unit. ``parameters``: what can be changed at run time, as ``a1`` and
    ``bodies.crank.mass``; by default all numbers that are not left out.

    NotGenerated of a scene, or what is asked of it, that cannot be generated; InvalidParameter of
    an output, a parameter or a format that is not known.
    """
    if as_ not in FORMATS:
        raise InvalidParameter('as', as_, one_of(FORMATS))
    loaded = scene if isinstance(scene, Scene) else load(scene)
    stem = name or ('linkage' if isinstance(scene, Scene) else loaded.name)
    model = GeneratedModel(loaded, word(stem), outputs, parameters)
    model.check()
    if as_ == 'js' and (outputs, parameters) != (None, None):
        raise NotGenerated(f'{model.name}: a module of JavaScript has all outputs and parameters')
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    notes = [f'{stem} is {model.name}'] if model.name != stem else []
    if not model.loads and outputs is None:
        notes.append(f'no loads: {loaded.linkage.why_no_loads}')
    paths = paths_of(stem, directory, as_)
    if as_ == 'js':
        from fourbar_lab.export.js_code import JsModule
        module = JsModule(loaded, model.name)
        paths[0].write_text(module.text, encoding='utf-8')
        return Generated(tuple(paths), module.operations, tuple(notes))
    if as_ != 'c':
        from fourbar_lab.export.fmu import write
        path, more, operations = write(model, directory)
        return Generated((path,), operations, (*notes, *more))
    code = Code(model)
    for path, text in zip(paths, (code.header(), code.source())):
        path.write_text(text, encoding='utf-8')
    return Generated(tuple(paths), max(code.operations.values()), tuple(notes))
