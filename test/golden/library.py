# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Parts of the golden file that need no ROS: what is recorded, and how closely it must come again.

Each part has ``cases()``, ``columns(key)``, a dict of lists, and ``tolerances(old, new)``, a dict
that gives for each column of numbers one tolerance, or one for each number; others are exact.
"""
from contextlib import redirect_stdout
from dataclasses import replace
import hashlib
import io
import math
from math import isfinite
from pathlib import Path
import re
import tempfile

from fourbar_lab.export import generate
from fourbar_ros import find_extrema, load_scene
from fourbar_ros.scene import read_values, simulate_scene
import numpy as np
from support import ROOT
import yaml

EPS = 2.0**-52
SCENES = [path.relative_to(ROOT / 'config').with_suffix('').as_posix()
          for folder in ('config', 'config/classics')
          for path in sorted((ROOT / folder).glob('*.yaml'))]
COUNT = 20


def scene_of(key):
    """Return the scene of 'NAME' or 'NAME mode K', in that mode, and its linkage."""
    name, _, mode = key.partition(' mode ')
    scene = load_scene(ROOT / 'config' / f'{name}.yaml')
    return scene, scene.in_mode(int(mode)) if mode else scene.linkage


def with_modes():
    """Return 'NAME mode K' of all scenes in all modes that close."""
    return [f'{name} mode {mode}' for name in SCENES
            for mode in sorted(scene_of(name)[0].linkage.modes)]


def rate_of(scene):
    """Return a rate at which the scene may run: of its drive by a clock, else 1."""
    return scene.drive.speed if scene.drive.source == 'timer' else 1.0


def digest(text):
    """Return 16 digits of a hash."""
    return hashlib.sha256(text if isinstance(text, bytes) else text.encode()).hexdigest()[:16]


class Motion:
    """``step`` at 20 inputs: the same bits where the machine's libm is the recorded one."""

    cases = staticmethod(with_modes)

    @staticmethod
    def inputs(scene, linkage):
        """Return places all over the ranges of the input, never at their ends."""
        ranges = linkage.input_ranges
        count = COUNT // len(ranges)
        places = [low + (k + 0.37) / count * (high - low)
                  for low, high in ranges for k in range(count)]
        return [round(place, 6) for place in places], float(rate_of(scene)), 3.0

    def columns(self, key):
        """Return the inputs, all fields of the motion and, if they are known, of the loads."""
        scene, linkage = scene_of(key)
        places, rate, acceleration = self.inputs(scene, linkage)
        motions = [linkage.motion(place, rate, acceleration) for place in places]
        found = {'input': places} | columns_of(motions)
        if not linkage.has_loads:
            return found
        steps = [linkage.step(place, rate, acceleration) for place in places]
        assert [motion for motion, _ in steps] == motions, key
        loads = [linkage.loads(place, rate, acceleration) for place in places]
        assert [load for _, load in steps] == loads, key
        return found | columns_of(loads)

    @staticmethod
    def tolerances(old, new):
        """Return zero, or 64 eps of the condition and of the largest of its sort elsewhere."""
        return {} if are_bits_comparable() else loose(old)


class Batch(Motion):
    """The same by arrays: the values whose bits are not those of ``step``, and where."""

    def columns(self, key):
        """Return {field: values, None where they are those of Motion} of fields that differ."""
        alone, together = super().columns(key), self.together(key)
        found = {name: [None if repr(one) == repr(other) else other
                        for one, other in zip(alone[name], together[name])] for name in alone}
        return {name: column for name, column in found.items() if column != COUNT * [None]}

    def together(self, key):
        """Return the columns of Motion, computed at once."""
        scene, linkage = scene_of(key)
        places, rate, acceleration = self.inputs(scene, linkage)
        found = {'input': places} | linkage.motion(places, rate, acceleration)._asdict()
        if linkage.has_loads:
            found |= linkage.loads(places, rate, acceleration)._asdict()
        return {name: np.broadcast_to(column, len(places)).tolist()
                for name, column in found.items()}


def columns_of(records):
    """Return {field: values} of records."""
    return {name: list(column) for name, column in zip(records[0]._fields, zip(*records))}


def loose(columns):
    """Return {field: tolerances}: 64 eps times condition times the largest of the same letters."""
    sort = {name: re.match('[a-z]*', name)[0] for name in columns}
    largest = {}
    for name, column in columns.items():
        finite = [abs(value) for value in column if isfinite(value)]
        largest[sort[name]] = max([largest.get(sort[name], 0.0), *finite])
    return {name: [64 * EPS * (1.0 + condition) * largest[sort[name]]
                   for condition in columns['condition']] for name in columns}


PROBE = Path(__file__).parent / 'probe.txt'


def probe():
    """Return digests of this machine's libm and numpy, on whose functions all bits hang."""
    places = [-6.0 + 0.0117 * k for k in range(1000)]
    alone = [(math.sin(x), math.cos(x), math.atan2(x, 1.5), math.hypot(x, 1.5)) for x in places]
    x = np.array(places)
    together = [column.tolist() for column in (np.sin(x), np.cos(x), np.arctan2(x, 1.5))]
    return [digest(repr(alone)), digest(repr(together))]


def are_bits_comparable(arrays=False):
    """Return whether libm, or numpy for arrays, is the one of the record."""
    return PROBE.read_text().split()[arrays] == probe()[arrays]


class Extrema:
    """All extrema of all quantities: kind, place, value; where and as what they count."""

    cases = staticmethod(with_modes)
    slow = tuple([f'classics/{name}' for name in (
        'gripper', 'peaucellier', 'coupling_rod', 'v8', 'radial_engine', 'scott_russell',
        'parallelogram', 'antiparallelogram')])

    def columns(self, key):
        """Return columns QUANTITY/WHAT, in the order of the input."""
        scene, linkage = scene_of(key)
        columns = {}
        for one in find_extrema(linkage, rate=rate_of(scene), acceleration=3.0):
            sort = one.kind[:3] + {'limit': ' at a limit', 'interior': ''}[one.place]
            row = {'what': sort + ' global' * one.is_global, 'side': one.side,
                   'input': one.input, 'value': one.value,
                   'condition': float(f'{one.condition:.1e}'),
                   'value_condition': float(f'{one.value_condition:.1e}')}
            for name, value in row.items():
                columns.setdefault(f'{one.quantity}/{name}', []).append(value)
        return columns

    @staticmethod
    def tolerances(old, new):
        """
        Return those of place and value: 1e3 eps of their condition, at least of one.

        Places of the general search are roots to about 1e-10 of the input. Conditions themselves
        are rough: a factor of two. Below 1e-9 they are nothing, beyond some 0.1 / eps the value is
        rounding and so is its condition.
        """
        found = {}
        for name in old:
            quantity, _, what = name.partition('/')
            if what == 'input':
                conditions = old[f'{quantity}/condition']
                found[name] = [1e-9 * (1.0 + abs(place)) + 1e3 * EPS * known(condition)
                               for place, condition in zip(old[name], conditions)]
            elif what == 'value':
                largest = max([abs(value) for value in old[name] if isfinite(value)], default=0.0)
                found[name] = [1e3 * EPS * (largest + abs(value) * known(condition))
                               for value, condition in zip(old[name],
                                                           old[f'{quantity}/value_condition'])]
            elif 'condition' in what:
                found[name] = [known(value) + 1e-9 if value < 0.1 / EPS else math.inf
                               for value in old[name]]
        return found


def known(value):
    """Return a finite number, zero for others."""
    return abs(value) if isfinite(value) else 0.0


class CText:
    """The C text of each scene: a hash, and its operations by kind."""

    def cases(self):
        """Return all scenes."""
        return SCENES

    def columns(self, key):
        """Return hash and counts of the source, which has neither version nor date."""
        with tempfile.TemporaryDirectory() as folder:
            made = generate(ROOT / 'config' / f'{key}.yaml', folder)
            text = next(path for path in made.files if path.suffix == '.c').read_text()
        code = re.sub(r'/\*.*?\*/|//[^\n]*|"[^"\n]*"|^#[^\n]*', '', text, flags=re.S | re.M)
        assert '_prepare' in code, 'the pattern took the text away'
        kinds = {'+': r' \+ ', '-': r' - ', '*': r' \* ', '/': r' / ', '?': r' \? ',
                 '<': ' <=? | >=? ', 'negated': r'[(=,] ?-[a-z(]'}
        kinds |= {name: rf'\b{name}\(' for name in ('sqrt', 'sin', 'cos', 'atan2', 'fabs', 'fma')}
        return {'hash': [digest(code)], 'most operations': [made.operations]} | {
            name: [len(re.findall(kind, code))] for name, kind in kinds.items()}


class Simulated:
    """``simulate`` at 1e-10: states and energy at 20 times."""

    until = {'engine': 0.05, 'motor': 0.1, 'controlled': 0.3, 'released': 2.0, 'sundials': 2.0,
             'classics/door_closer': 1.0}

    def cases(self):
        """Return the scenes whose motion follows from torque."""
        return [name for name in SCENES if scene_of(name)[0].dynamics]

    def columns(self, key):
        """Return status, error, states by name, energy and mode."""
        scene, _ = scene_of(key)
        until = self.until[key]
        scene = replace(scene, drive=scene.drive._replace(rate=COUNT / until))
        run = simulate_scene(scene, until, 1e-10).run
        energy = run.system.equation.energy(run.position, run.rate)
        states = {**run.states._asdict(),
                  **{f'source_{i}': row for i, row in enumerate(run.states.source)}}
        return {'status': [run.status], 'error': [run.error], 'time': run.time.tolist(),
                'mode': run.modes.tolist(), 'energy': np.asarray(energy).tolist(),
                **{f'state {name}': states[name].tolist() for name in run.system.names}}

    @staticmethod
    def tolerances(old, new):
        """Return 100 times the tolerance, or the estimated error, of the largest of a column."""
        error = 100.0 * max(1e-10, *old['error'], *new['error'])
        found = {name: error * max(map(abs, column)) for name, column in old.items()
                 if name == 'energy' or name.startswith('state')}
        return found | {'error': float('inf'), 'time': 4 * EPS * old['time'][-1]}


class Studies:
    """Columns of three studies, 48 designs each."""

    def cases(self):
        """Return their names."""
        return ['crank_rockers', 'shaking', 'tolerances']

    def columns(self, key):
        """Return the columns and the reasons why designs are left out."""
        from fourbar_lab.studies import compute, study_of
        document = yaml.safe_load((ROOT / 'config' / 'studies' / f'{key}.yaml').read_text())
        done = compute(study_of({**document, 'rows': 48}), chunk=0)
        reasons = sorted(f'{reason}: {number}' for reason, number in done.counts.items())
        return {'designs': reasons} | {name: column.tolist()
                                       for name, column in done.columns.items()}

    @staticmethod
    def tolerances(old, new):
        """Return 1e-9 of the largest of a column: places of extrema are roots."""
        return {name: 1e-9 * max(map(abs, column), default=0.0) for name, column in old.items()
                if column and isinstance(column[0], float)}


class Balances:
    """Counterweights by ``fourbar balance``, as numbers of the scene that it writes."""

    slow = 'paper, full', 'slider_crank, full'
    commands = {
        'paper, full': ['paper'],
        'slider_crank, full': ['slider_crank'],
        'paper, moment': ['paper', '--minimize', 'moment', '--mass', '3'],
        'paper, three': ['paper', '--minimize', 'force', 'moment', 'torque', '--mass', '3',
                         '--radius', 'crank=0.2', 'output=0.3'],
        'paper, reaction': ['paper', '--minimize', 'f41', '--mass', '1'],
        'slider_crank, force': ['slider_crank', '--minimize', 'force', '--mass', '1'],
        'paper, peak': ['paper', '--minimize', 'force', '--mass', '2', '--peak'],
        'cylinder, torque': ['cylinder', '--minimize', 'torque', '--mass', '5'],
    }

    def cases(self):
        """Return the names of the cases."""
        return list(self.commands)

    def columns(self, key):
        """Return what is printed of the result, and the bodies afterwards."""
        from fourbar_ros.cli.main import main
        printed = io.StringIO()
        with tempfile.TemporaryDirectory() as folder, redirect_stdout(printed):
            file = Path(folder) / 'balanced.yaml'
            code = main(['balance', *self.commands[key], '-o', str(file)])
            assert code in (0, None), printed.getvalue()
            values = read_values(file)
        first = printed.getvalue().partition('\n\n')[0].replace('\n', ' ')
        numbers = re.findall(r'(?<![\w.])\d+\.?\d*(?:e-?\d+)?', first)
        bodies = {name: [float(value)] for name, value in sorted(values.items())
                  if name.startswith('bodies.') and not isinstance(value, str)}
        return {'printed': list(map(float, numbers))} | bodies

    @staticmethod
    def tolerances(old, new):
        """Return 1e-6 of values and 1e-4 of bodies: the optimum is flat in them."""
        largest = max(abs(*column) for name, column in old.items() if name != 'printed')
        return {name: 1e-6 * max(map(abs, column)) if name == 'printed' else 1e-4 * largest
                for name, column in old.items()}


PARTS = {'motion': Motion(), 'batch': Batch(), 'extrema': Extrema(),
         'c_text': CText(), 'simulated': Simulated(), 'studies': Studies(),
         'balances': Balances()}
