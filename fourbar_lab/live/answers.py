# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The answers that a page asks for: the structure of a scene, its extrema, a check; as JSON."""
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from hashlib import sha256
from math import isfinite, tau
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fourbar_lab.drawing.animation import animate
from fourbar_lab.drawing.curves import extrema_of
from fourbar_lab.drawing.cycles import usual_points
from fourbar_lab.drawing.labels import plain
from fourbar_lab.drawing.record import counted, inputs_of
from fourbar_lab.drawing.tables import facts
from fourbar_lab.export.js_code import JsModule
from fourbar_lab.live.sketch import sketch_of
from fourbar_ros.errors import FourBarError, in_words, InvalidParameter
from fourbar_ros.extrema.find import CONSTANT, SIDES
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quantities import (
    is_position,
    Named,
    of_drive,
    OfDrive,
    positions,
    select,
)
from fourbar_ros.optional import MissingPackage
from fourbar_ros.scene.files import flatten, YamlTree
from fourbar_ros.scene.parameters import of_name, unit_in
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import FAMILIES, PARAMETERS
from fourbar_ros.scene.simulated import simulate_scene
import numpy as np

Answer = dict[str, Any]         # JSON
LONGEST = 20.0          # most time for a run [s]
TOLERANCE = 1e-4        # of a run: less than a tenth of a pixel
GROUPS = ('linkage', 'dyads', 'cylinder', 'drive', 'gravity', 'bodies', 'springs',
          'torsion_springs', 'forces', 'external', 'friction', 'points')      # with fields


def scene_of(tree: YamlTree) -> Scene:
    """Return the scene of nested parameters, as a page has them; InvalidParameter, SceneError."""
    if not isinstance(tree, dict):
        raise InvalidParameter('scene', type(tree).__name__, 'must be an object of parameters')
    values = flatten(tree)
    for name, value in values.items():      # JSON does not tell 1 from 1.0
        if type(value) is int and name.rpartition('.')[2] not in INTEGERS:
            values[name] = float(value)
        elif isinstance(value, list) and any(type(item) is float for item in value):
            values[name] = [float(item) if type(item) is int else item for item in value]
    return from_values(values)


INTEGERS = sorted({name.rpartition('.')[2] for table in (PARAMETERS, *FAMILIES.values())
                   for name, parameter in table.items() if parameter.type == 'integer'})


def answered(question: str, asked: Answer) -> Answer:
    """Return the answer to a question of a page; {problem, name}: why there is none."""
    try:
        scene = scene_of(asked.get('scene', {}))
        with_unit = frozenset(map(str, asked.get('withUnit', ())))      # as 7 rad: no doubt of it
        return ANSWERS[question](replace(scene, with_unit=with_unit), asked)
    except (FourBarError, KeyError, TypeError, ValueError) as error:
        return {'problem': str(error), 'name': getattr(error, 'name', '')}
    except ModuleNotFoundError as error:        # a server needs less than all of its answers
        if not MissingPackage.explains(error):
            raise
        return {'problem': str(MissingPackage(question, error)), 'name': ''}


def quantities_of(scene: Scene) -> dict[str, Named]:
    """Return {name: quantity} of all that a page draws over the input."""
    linkage, driven = scene.linkage, scene.linkage.input
    drive = {} if linkage.friction else of_drive(linkage, driven)
    return {**{quantity.name: quantity
               for quantity in select((), linkage, scene.point_quantities)},
            **positions(linkage, driven),
            **{quantity.name: quantity for quantity in scene.point_quantities
               if is_position(quantity)},
            **{name: quantity for name, quantity in drive.items()
               if linkage.has_loads or not quantity.is_load}}


def structure_of(scene: Scene, known: str = '') -> Answer:
    """
    Return a scene's module of JavaScript, and what a page shows of it.

    ``known``: the key of a module that the page has; if it is the same structure's it is not sent
    again.
    """
    linkage, coordinate = scene.linkage, scene.linkage.input_coordinate
    module = JsModule(scene, 'scene')
    key = sha256(module.body.encode()).hexdigest()[:16]
    quantities, output = quantities_of(scene), linkage.outputs[0].coordinate
    # a machine that is drawn has the points that were drawn
    points = dict(scene.points if hasattr(linkage, 'stages') else
                  usual_points(linkage, scene.points))
    sketch = sketch_of(scene, module.parameters, points)
    symbols = {name: symbol for load, symbol in sketch['symbols'].items() for name, symbol in (
        (load, symbol), *((f'{load}_{axis}', f'{symbol},{axis}') for axis in 'xy'))}
    shown = [*(name for part in linkage.PARTS for name in part), 'transmission_angle',
             *(name for name, quantity in quantities.items()
               if quantity.is_load and not isinstance(quantity, OfDrive))]
    return {
        'key': key, **({} if key == known else {'module': module.text}),
        'title': linkage.TITLE, 'description': linkage.description,
        'warnings': scene.warnings, 'lacks': lacks(linkage, scene),
        'hasLoads': linkage.has_loads, 'isMovedByTorque': scene.dynamics is not None,
        'values': {
            name: value if isfinite(value) else None for name, value in
            {**module.parameters, 'drive.speed': float(scene.drive.speed)}.items()},
        'input': {'name': coordinate.position, 'rate': coordinate.rate,
                  'acceleration': coordinate.acceleration, 'unit': coordinate.unit},
        'ranges': ([(0.0, tau * linkage.turns)] if linkage.turns_fully else linkage.input_ranges),
        'turns': linkage.turns if linkage.turns_fully else 0,
        'period': linkage.period if isfinite(linkage.period) else 0,
        'start': counted(linkage, float(scene.drive.start)),
        'drive': linkage.drive_load, 'outputRate': output.rate,
        'links': [link.name for link in linkage.LINKS], 'size': max(map(abs, linkage.lengths)),
        'guides': [reaction.magnitude for reaction in linkage.REACTIONS if reaction.couple],
        'quantities': {name: {'unit': quantity.unit, 'text': quantity.text,
                              'symbol': symbols.get(name)}
                       for name, quantity in quantities.items()},
        'usual': [name for name in (output.rate, output.acceleration, linkage.drive_load,
                                    'shaking_force') if name in quantities],
        'shown': [name for name in dict.fromkeys(shown) if name in module.units],
        'words': {name: f'{name} = {plain(symbol)}' for name, symbol in
                  sketch['symbols'].items() if name[1:] != plain(symbol)[1:]},
        'facts': [*facts(linkage), *_joints({joint: letter for joint, letter in
                                             sketch['letters'].items() if joint != letter})],
        'fields': _fields(scene, module), 'positive': [
            name for name in module.parameters if name.startswith('bodies.') or (
                not name.startswith('base.') and of_name(name).positive)],
        'sketch': sketch}


def _joints(letters: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return (letter, names of the joints there) where pictures have letters for words."""
    joints: dict[str, list[str]] = {}
    for name, letter in letters.items():
        joints.setdefault(f'joint {plain(letter)}', []).append(name)
    return [(letter, ', '.join(names)) for letter, names in joints.items()]


def lacks(linkage: Mechanism, scene: Scene) -> str:
    """Return why there are no forces, or no extrema of them; empty: there are."""
    if why := linkage.why_no_loads:
        return f'no forces: {why}'
    locked = linkage.locked_ranges(float(scene.drive.speed))
    return ('no extrema of forces: it locks itself by friction in '
            + in_words(locked, linkage.input_coordinate.unit) if locked else '')


def _fields(scene: Scene, module: JsModule) -> list[Answer]:
    """Return the parameters that get a field on the page: a mass, value None, not given too."""
    masses = {f'bodies.{link.name}.{field}' for link in scene.linkage.LINKS
              for field in ('mass', 'cg_along', 'cg_across', 'inertia')[:4 if link.turns else 3]}
    fields, known = [], {*module.parameters, 'drive.speed'}
    for name, value in {**scene.values, **dict.fromkeys(masses - known)}.items():
        group = name.partition('.')[0]
        if group not in GROUPS or name not in known | masses:
            continue
        parameter = of_name(name)
        field = {'name': name, 'unit': unit_in(parameter, scene.values), 'value': value,
                 'text': parameter.text.partition('; for the sliders')[0]}
        if name.endswith('.mode'):
            modes = scene.linkage.modes if name == 'linkage.mode' else {1: '1', 2: '2'}
            if len(modes) < 2:
                continue
            field['choices'] = {str(mode): text for mode, text in modes.items()}
        fields.append(field)
    return sorted(fields, key=lambda field: GROUPS.index(field['name'].partition('.')[0]))


def run_answer(scene: Scene, until: float) -> Answer:
    """Return some thousand samples of a run from torque, simulated until a time [s]."""
    simulated = simulate_scene(scene, until, TOLERANCE, seconds=LONGEST)
    run = simulated.run
    last = run.time.size - 1
    every = [*range(0, last, 1 + run.time.size // 1000), last]
    words = f'{run.status}: {run.reason or f"{run.time[-1]:g} s, error up to {run.error:.2g}"}'
    if np.ptp(run.modes):
        raise InvalidParameter('drive.source', scene.drive.source, 'the run goes through both '
                               'assembly modes: see fourbar simulate')
    return {'words': words, 'input': run.position[every].tolist(), **{
        name: getattr(run, name)[every].tolist() for name in ('time', 'rate', 'acceleration')}}


def gif_answer(scene: Scene) -> Answer:
    """Return the moving picture of ``fourbar draw --animate``, in base 64."""
    with TemporaryDirectory() as folder:
        file = Path(folder, 'moving.gif')
        animate(scene.linkage, float(scene.drive.speed), scene.points, file)
        return {'gif': b64encode(file.read_bytes()).decode()}


def extrema_answer(scene: Scene, names: Sequence[str], acceleration: float) -> Answer:
    """Return the extrema of quantities by name, as ``fourbar show`` finds them, and the names."""
    linkage = scene.linkage
    extrema = extrema_of(scene, linkage, list(names), float(scene.drive.speed), acceleration)
    rows = [{'quantity': extremum.quantity, 'kind': extremum.kind,
             'value': extremum.value if isfinite(extremum.value) else
             str(extremum.value).replace('inf', 'Infinity'),
             'inputs': inputs_of(linkage, extremum), 'isGlobal': extremum.is_global,
             'proof': extremum.proof, 'note': ' '.join(filter(None, (
                 'global' if extremum.is_global and extremum.kind != CONSTANT else '',
                 extremum.place if extremum.place != 'interior' else '', SIDES[extremum.side],
                 'not certain' if extremum.proof else '')))} for extremum in extrema]
    return {'quantities': list(names), 'extrema': rows,
            'proof': 'Found by the search of fourbar show, all there are.'}


ANSWERS: dict[str, Callable[[Scene, Answer], Answer]] = {       # {question: answer}
    'structure': lambda scene, asked: structure_of(scene, str(asked.get('known', ''))),
    'extrema': lambda scene, asked: extrema_answer(scene, asked['quantities'],
                                                   float(asked['acceleration'])),
    'run': lambda scene, asked: run_answer(scene, float(asked['until'])),
    'gif': lambda scene, asked: gif_answer(scene),
    'check': lambda scene, asked: {'warnings': scene.warnings}}
