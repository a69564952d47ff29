"""A scene: one linkage, what drives it, what it publishes. Read from a ROS 2 parameter file, without ROS."""
from __future__ import annotations

import json
from math import isnan
from pathlib import Path
from typing import NamedTuple

import yaml

from . import parameters
from .core import Applied, Bodies, Body, External, FourBar, FourBarError, InvalidParameter, round_rod
from .interfaces import OUTPUTS

LINKS = ('crank', 'coupler', 'output')


class SceneError(FourBarError, ValueError):
    """A scene file cannot be read; the message names the file and the reason."""


class Drive(NamedTuple):
    """What moves the crank: source 'timer', 'motion' or 'joint_state'; see the parameter table."""

    source: str
    speed: float
    start: float
    rate: float
    joint: str
    window: int
    jump: float
    timeout: float
    out_of_range: str


class Recording(NamedTuple):
    """Where bags go and whether to record from the start."""

    start: bool
    directory: str
    name: str


class Scene(NamedTuple):
    """Everything a node needs to know, checked."""

    linkage: FourBar
    drive: Drive
    outputs: tuple[str, ...]
    frame_id: str
    joint_names: tuple[str, ...]
    recording: Recording
    values: dict       # every parameter by name

    @property
    def as_json(self):
        """Return the given parameters as JSON (NaN stands for "not given", and is no JSON)."""
        return json.dumps({name: value for name, value in self.values.items() if value == value})

    @property
    def needs_loads(self):
        """Return whether any output is a load (the crank's torque in joint_states alone is not)."""
        return any(OUTPUTS[name].needs_loads for name in self.outputs)


def from_values(values):
    """
    Return the Scene of a flat dict of parameters, ``{'linkage.a1': 0.4, ...}``.

    Raises
    ------
    InvalidParameter
        Naming the parameter, what was given and what is allowed.

    """
    values = parameters.check(values)
    try:
        linkage = FourBar(*(values[f'linkage.a{i}'] for i in (1, 2, 3, 4)), values['linkage.mode'],
                          _bodies(values), (values['gravity.x'], values['gravity.y']), _external(values))
    except InvalidParameter as error:
        if error.name in values:
            raise
        raise InvalidParameter(f'linkage.{error.name}', error.value, error.allowed) from None
    scene = Scene(linkage, Drive(*(values[f'drive.{field}'] for field in Drive._fields)),
                  tuple(values['outputs']), values['frame_id'], tuple(values['joint_names']),
                  Recording(*(values[f'recording.{field}'] for field in Recording._fields)), values)
    _check_together(scene)
    return scene


def _check_together(scene):
    """Check what no parameter shows alone."""
    def refuse(name, why):
        raise InvalidParameter(name, scene.values[name], why)

    if scene.needs_loads and scene.linkage.bodies is None:
        loads = [name for name in scene.outputs if OUTPUTS[name].needs_loads]
        refuse('bodies.crank.mass', f'must be given (or bodies.rods): output {loads[0]} needs masses')
    if not scene.frame_id:
        refuse('frame_id', 'must not be empty')
    if len(scene.joint_names) != 4 or len(set(scene.joint_names)) != 4 or '' in scene.joint_names:
        refuse('joint_names', 'must be four different names: the joints at O1, A, B, O4')
    if len(set(scene.outputs)) != len(scene.outputs):
        refuse('outputs', 'names an output twice')
    if scene.drive.source == 'joint_state' and not scene.drive.joint:
        refuse('drive.joint', 'must name the joint that is the crank')


def _external(values):
    return External(*(Applied(*(values[f'external.{link}.{field}'] for field in Applied.__dataclass_fields__))
                      for link in External._fields))


def _bodies(values):
    """Return the Bodies, or None if the scene gives no mass at all."""
    def given(name):
        return not isnan(values[name])

    masses = [f'bodies.{link}.mass' for link in LINKS]
    if given('bodies.rods.density') or given('bodies.rods.radius'):
        for name in ('bodies.rods.density', 'bodies.rods.radius'):
            if not given(name):
                raise InvalidParameter(name, values[name], 'must be given: rods have density and radius')
        for link in LINKS:
            for field in ('mass', 'inertia', 'cg_along'):
                if given(f'bodies.{link}.{field}'):
                    raise InvalidParameter(f'bodies.{link}.{field}', values[f'bodies.{link}.{field}'],
                                           'give either bodies.rods or the bodies one by one, not both')
        return Bodies(*(round_rod(values[f'linkage.a{i}'], values['bodies.rods.density'],
                                  values['bodies.rods.radius']) for i in (1, 2, 3)))
    if not any(map(given, masses)):
        return None
    return Bodies(*(_body(values, link, values[f'linkage.a{i}'], given)
                    for i, link in enumerate(LINKS, 1)))


def _body(values, link, length, given):
    name = f'bodies.{link}.'
    for field in ('mass', 'inertia'):
        if not given(name + field):
            raise InvalidParameter(name + field, values[name + field],
                                   'must be given: loads need mass and inertia of every link')
    along = values[name + 'cg_along'] if given(name + 'cg_along') else 0.5 * length
    return Body(values[name + 'mass'], along, values[name + 'cg_across'], values[name + 'inertia'])


def load(path):
    """
    Return the Scene of a ROS 2 parameter file (``/**: ros__parameters: ...``).

    Raises
    ------
    SceneError
        The file cannot be read or is no parameter file of one node.
    InvalidParameter
        A value is not allowed.

    """
    return from_values(read_values(path))


def read_values(path):
    """Return the flat dict of parameters in a ROS 2 parameter file, unchecked."""
    try:
        document = yaml.safe_load(Path(path).read_text())
    except OSError as error:
        raise SceneError(f'{path}: {error.strerror}') from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise SceneError(f'{path}: not YAML: {" ".join(str(error).split())}') from None
    nodes = document if isinstance(document, dict) else {}
    found = [node['ros__parameters'] for node in nodes.values()
             if isinstance(node, dict) and isinstance(node.get('ros__parameters'), dict)]
    if len(found) != 1:
        raise SceneError(f'{path}: not a scene: expected "/**:" with "ros__parameters:" below it')
    return flatten(found[0])


def flatten(tree, prefix=''):
    """Return a nested dict with its keys joined by dots, as ROS does."""
    flat = {}
    for key, value in tree.items():
        if isinstance(value, dict):
            flat.update(flatten(value, f'{prefix}{key}.'))
        else:
            flat[f'{prefix}{key}'] = value
    return flat
