# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Generated C, compiled and called: to compare it with Python, sample by sample or recorded."""
from __future__ import annotations

from collections.abc import Sequence
import ctypes
import json
from math import nan
from pathlib import Path
import shutil
import subprocess
from tempfile import TemporaryDirectory
from typing import Any

from fourbar_lab.export.c_code import FLAGS
from fourbar_lab.export.model import GeneratedModel, NotGenerated
from fourbar_ros.dynamics.node_step import At, DriveValues, Mover, OK, SILENT
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.number_types import numbers_of
from fourbar_ros.pipeline.stepper import Evaluated
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.topics import TORQUE

HIDDEN = 1 + 6 + 1      # mode, place, given: numbers besides the fields of a state
COMPILERS = ('cc', 'gcc', 'clang')


class NoCompiler(FourBarError):
    """There is no C compiler on the path."""


def compiler() -> str:
    """Return the C compiler of this machine, or raise NoCompiler."""
    found = next(filter(None, map(shutil.which, COMPILERS)), None)
    if found is None:
        raise NoCompiler(f'no C compiler ({", ".join(COMPILERS)}) on the path')
    return found


def build(sources: Sequence[Path], library: Path, command: str = '',
          flags: Sequence[str] = tuple(FLAGS.split())) -> None:
    """Compile C into a shared library; NotGenerated with the compiler's first line."""
    done = subprocess.run([command or compiler(), *flags, '-shared', '-fPIC', '-o', str(library),
                           *map(str, sources), '-lm'], capture_output=True, text=True, check=False)
    if done.returncode:
        raise NotGenerated(f'{sources[0].name}: the C compiler refuses it: '
                           f'{(done.stderr.splitlines() or ["no message"])[0]}')


class Compiled:
    """
    The code of a folder that ``generate`` wrote, compiled for this machine.

    Parameters
    ----------
    directory : str or Path
        With one NAME.json and its NAME.c.

    Raises
    ------
    NoCompiler, NotGenerated

    """

    def __init__(self, directory: str | Path) -> None:
        """Read the scene from NAME.json, compile NAME.c, make arrays that C reads and fills."""
        self._directory = directory
        found = sorted(Path(directory).glob('*.json'))
        if len(found) != 1:
            raise NotGenerated(f'{directory}: expected one NAME.json of fourbar generate, found '
                               f'{len(found)}')
        try:
            given = json.loads(found[0].read_text(encoding='utf-8'))
            self.model = GeneratedModel(from_values(given['scene']), given['name'],
                                        given['outputs'], given['tunable'])
        except (ValueError, KeyError, TypeError):
            raise NotGenerated(f'{found[0]}: not of fourbar generate') from None
        with TemporaryDirectory() as folder:
            library = Path(folder) / 'generated.so'
            build([found[0].with_suffix('.c')], library)
            self.library = ctypes.CDLL(str(library))
        name, model = given['name'], self.model
        # name of a C function -> the function
        self._of = {part: getattr(self.library, f'{name}_{part}')
                    for part in ('prepare', 'motion_at', *(('step',) if model.loads else ()))}
        double = ctypes.c_double
        self._input, self._motion = (double * 3)(), (double * len(model.motion))()
        self._loads = (double * max(1, len(model.loads)))()
        self._parameters = (double * max(1, len(model.tunable)))()
        self._constants = (double * len(model.data + model.trace.steps))()
        self._data: list[float] = []             # of the mechanism that C is prepared for
        # results of the mechanism that the code was generated without
        self._lack = sorted({*model.mechanism.MOTION._fields} - {one.name for one in model.motion}
                            | ({*model.mechanism.LOADS._fields} if model.loads else set())
                            - {one.name for one in model.loads})

    def __reduce__(self) -> tuple[Any, ...]:
        return Compiled, (self._directory,)

    def evaluate(self, mechanism: Mechanism, position: float, rate: float, acceleration: float,
                 with_loads: bool) -> Evaluated:
        """
        Return (status, motion, loads) as :func:`fourbar_ros.pipeline.stepper.evaluate` does.

        NotGenerated where the code is not of this mechanism.
        """
        self._take(mechanism, with_loads)
        self._input[:] = [position, rate, acceleration]
        if with_loads:
            status = self._of['step'](self._constants, self._input, self._motion, self._loads)
        else:
            status = self._of['motion_at'](self._constants, self._input, self._motion)
        motion: Any = mechanism.MOTION
        loads: Any = mechanism.LOADS
        values = list(self._loads) if with_loads else [float('nan')] * len(loads._fields)
        return (status, motion._make(self._motion[:len(motion._fields)]), loads._make(values))

    def mover(self, scene: Scene, mode: int | None = None) -> Mover:
        """
        Return a mover of a scene by torque, like its own mover, in a mode beyond a toggle.

        NotGenerated where the code is not of this scene.
        """
        own = self.model.scene              # a limit that is NaN for none equals itself as text
        if ((scene.dynamics, scene.bare_linkage, repr(scene.drive))
                != (own.dynamics, own.bare_linkage, repr(own.drive))):
            raise NotGenerated(f'{self.model.name}: generated of another scene')
        return CompiledMover(scene, self.library, self.model.name, mode)

    def _take(self, mechanism: Mechanism, with_loads: bool) -> None:
        """Prepare for the numbers of a mechanism, if they are new."""
        model = self.model
        if self._lack:
            raise NotGenerated(f'{model.name}: generated without {", ".join(self._lack[:3])}')
        if with_loads and not model.loads:
            raise NotGenerated(f'{model.name}: generated without loads')
        constants = mechanism.constants
        if not model.mechanism.bodies:
            constants = constants._replace(bodies=None)
        if model.scene.elements:              # whose forces the node adds, and so does the code
            constants = constants._replace(external=model.mechanism.constants.external)
        data = numbers_of(constants)
        if data == self._data:
            return
        tuned = {one.place for one in model.tunable} | model.derived.keys()
        if (mechanism.structure != model.mechanism.structure
                or mechanism.stroke != model.mechanism.stroke
                or len(data) > len(model.data) or any(
                    mine != other for i, (mine, other) in enumerate(zip(model.data, data))
                    if i not in tuned)):
            raise NotGenerated(f'{model.name}: generated of another scene, or in another assembly '
                               'mode')
        values = [*data, *model.data[len(data):]]
        self._parameters[:] = [values[one.place] for one in model.tunable] or [0.0]
        self._of['prepare'](self._parameters, self._constants)
        self._data = data


class CompiledMover(Mover):
    """
    A mover whose steps and values are those of generated code.

    Parameters
    ----------
    scene : Scene
    library : ctypes.CDLL
    name : str
        Prefix of its functions.

    """

    def __init__(self, scene: Scene, library: ctypes.CDLL, name: str, mode: int | None) -> None:
        """Set up a mover of the scene in an assembly mode; C keeps a drive in ``_drive``."""
        assert scene.dynamics is not None
        linkage = scene.bare_linkage
        if mode in linkage.modes_passed:
            linkage = linkage.in_mode(mode)
        super().__init__(scene.dynamics.system(linkage), scene.drive.tolerance,
                         scene.drive.budget, scene.drive.source == TORQUE.name)
        self._of = {what: getattr(library, f'{name}_{what}') for what in ('complete', 'advance')}
        self._drive = (ctypes.c_double * (len(DriveValues._fields) + HIDDEN))()
        getattr(library, f'{name}_start')(self._drive, *self._torques(0.0))
        self._latest: DriveValues | None = None

    def next(self, values: DriveValues, step: float, command: float = 0.0,
             is_silent: bool = False, mode: int | None = None) -> tuple[int, DriveValues]:
        """Return (status, values) after a time [s]."""
        if values is not self._latest:
            self._set(values, self.at(self.state(values), mode).mode, command)
        status = self._of['advance'](self._drive, ctypes.c_double(step), *self._torques(command))
        return SILENT if status == OK and is_silent else status, self._taken()

    def values(self, at: At, step: float, command: float, evaluations: float) -> DriveValues:
        """Return the values of a state in the input."""
        position, rate, twist, speed, own = at.state
        self._set(DriveValues(step, command, position, rate, nan, twist, nan, speed, nan, nan,
                              own, own, evaluations), at.mode, command)
        return self._taken()

    def _set(self, values: DriveValues, mode: int, command: float) -> None:
        size = len(values)
        self._drive[:size] = list(values)
        if self.passes:
            self._drive[size] = mode
        self._of['complete'](self._drive, *self._torques(command))

    def _taken(self) -> DriveValues:
        size = len(DriveValues._fields)
        self.mode = int(self._drive[size]) if self.passes else self.mode
        self._latest = DriveValues(*self._drive[:size])
        return self._latest

    def _torques(self, command: float) -> list[ctypes.c_double]:
        return [ctypes.c_double(command)] * self._takes_commands
