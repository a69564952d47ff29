# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The plane of a loop: its links and dyads, measured as a scene states them, and their modes.

Points and directions are complex numbers, x + iy, in the file's pose. Each link is measured within
itself, so its lengths and the zeros of its joints are right where the file leaves the loop open.
The pose says the assembly modes alone: of both, the nearest, if there is no doubt.
"""
from cmath import phase
from collections.abc import Sequence
from math import degrees, pi, tau
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError
from fourbar_ros.importing.loops import Loop
from fourbar_ros.importing.robots import Refused, RobotJoint, SLIDE, Wishes, word
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.scene import from_values
import numpy as np

OPEN = 20.0             # [deg] by which links may turn to close a loop, for its mode to be read
ROUNDING = 1e-9         # [deg], so that the limit itself may be
FLAT = 0.02             # [rad] from a dyad's flat position in which its mode is not read
BESIDE = 1e-6           # share of the size by which a cylinder may push beside its pins
TAKEN = 'ground', 'crank', 'slider', 'rods'     # names of links that mean something in a scene
KINDS = 'RRR', 'RRP', 'RPR', 'RPP', 'PRP'
CYLINDER = 'cylinder'


class PlaneLink(NamedTuple):
    """A link of the scene: its name, its first joint and its direction in the file's pose."""

    name: str
    origin: complex
    direction: complex              # a unit vector

    def of(self, point: complex) -> tuple[float, float]:
        """Return (along, across) of a point [m]."""
        local = (point - self.origin) * self.direction.conjugate()
        return local.real, local.imag


class Plane:
    """Links, dyads and joints of a loop, each link by its body in the file; the scene's values."""

    def __init__(self, loop: Loop, base: str, carrier: str, axes: Array, origin: Array) -> None:
        self.loop, self.base, self.axes = loop, base, axes
        self.links = {carrier: PlaneLink(GROUND, self.flat(origin), 1.0)}
        self.height = float(axes[2] @ origin)           # of the plane along its normal [m]
        self.joints: dict[str, RobotJoint] = {}         # by their names in the scene
        self.modes: dict[str, str] = {}                 # {dyad: its parameter}
        self.report: list[str] = []
        self.values: dict[str, Any] = {'linkage.kind': 'machine', 'linkage.dyads': []}

    def flat(self, vector: Array) -> complex:
        return complex(self.axes[0] @ vector, self.axes[1] @ vector)

    def pivot(self, joint: RobotJoint, body: str) -> complex:
        return self.flat(self.loop.point(joint, body))

    def slide(self, joint: RobotJoint, body: str) -> complex:
        """Return the unit vector along which a link slides at a joint as its position grows."""
        assert joint.axis is not None
        along = self.flat(joint.axis)
        return along / abs(along) * self.sense(joint, body)

    def sense(self, joint: RobotJoint, body: str) -> float:
        return 1.0 if self.loop.link_of[joint.child] == body else -1.0

    def add_link(self, body: str, origin: complex, direction: complex, name: str = '') -> str:
        """Add a link, called like its body; return its name."""
        if not direction:
            raise Refused(f'{self.loop.name_of(body)} has its joints in one point: a loop needs '
                          'them apart')
        name = name or word(self.loop.name_of(body), 'link')
        while name in {link.name for link in self.links.values()} or (
                name in TAKEN and len(self.links) > 1):
            name += '_link'
        self.links[body] = PlaneLink(name, origin, direction / abs(direction))
        return name

    def add_joint(self, name: str, joint: RobotJoint, body: str, carrier: str,
                  along: complex = 1.0, travel: float = 0.0) -> None:
        """Add a joint of the link ``body``: its slide ``along``, or its angle from a carrier's."""
        # name: in the scene; travel: how far it has slid in the file's pose [m]
        self.joints[name] = joint
        if joint.kind == SLIDE:
            joint.ratio = 1.0 if (self.slide(joint, body) * along.conjugate()).real > 0.0 else -1.0
            joint.offset = joint.position - joint.ratio * travel
            return
        ratio = self.sense(joint, body) * (
            1.0 if joint.axis is None or joint.axis @ self.axes[2] > 0.0 else -1.0)
        angle = phase(self.links[body].direction / self.links[carrier].direction)
        # from the ground counts what hangs on it, whichever of both is the dyad's link
        joint.ratio = -ratio if body == self.base else ratio
        joint.offset = joint.position - ratio * angle

    def set_point(self, name: str, body: str, point: complex) -> None:
        link = self.links[body]
        if not name.startswith(CYLINDER):
            self.values[f'{name}.link'] = link.name
        self.values[f'{name}.along'], self.values[f'{name}.across'] = link.of(point)

    def add_dyad(self, name: str, ways: Sequence[tuple[str, RobotJoint]], inner: RobotJoint
                 ) -> None:
        """Add the links of a dyad or the cylinder, with the joints that hang them on others."""
        # ways: (link, joint) at first and second. In machines.md stands what a kind measures.
        kinds = ['P' if joint.kind == SLIDE else 'R' for joint in (ways[0][1], inner, ways[1][1])]
        if ''.join(kinds) not in KINDS:
            ways, kinds = ways[::-1], kinds[::-1]
        (u, at_u), (v, at_v) = ways
        kind = ''.join(kinds)
        if kind not in KINDS:
            raise Refused(f'{self.loop.name_of(u)} and {self.loop.name_of(v)} form a dyad {kind}, '
                          'which there is none of')
        on_u, on_v = self.loop.far(at_u, u), self.loop.far(at_v, v)
        first, second = self.pivot(at_u, on_u), self.pivot(at_v, on_v)        # where they hang
        start_u, start_v = self.pivot(at_u, u), self.pivot(at_v, v)
        inner_u, inner_v = self.pivot(inner, u), self.pivot(inner, v)
        along_u, along_v = inner_u - start_u, inner_v - start_v     # the directions of the links
        travel, along = 0.0, 1.0 + 0.0j                 # of the inner joint, if that slides
        sizes = {}
        if inner.kind == SLIDE:
            along_u = along_v = along = self.slide(inner, u)
        if at_v.kind == SLIDE:
            along_v = self.slide(at_v, v)
            sizes['direction_2'] = phase(along_v / self.links[on_v].direction)
        if kind == 'RRR':
            sizes = {'length_1': abs(along_u), 'length_2': abs(along_v)}
        elif kind == 'RRP':
            sizes['length_1'] = abs(along_u)
            start_v = second = inner_v
        elif kind == 'RPR':
            between = (start_u - start_v) * along.conjugate()
            if name == CYLINDER and between.real < 0.0:
                along_u = along_v = along = -along
                between = -between
            travel, sizes['offset'] = between.real, between.imag
        elif kind == 'RPP':
            sizes['slot'] = phase(along / along_v)
            start_v = second = start_u
        else:
            along_u = self.slide(at_u, u)
            sizes['direction_1'] = phase(along_u / self.links[on_u].direction)
            start_u, start_v, first, second = inner_u, inner_v, inner_u, inner_v
        if name == CYLINDER:
            if (off := abs(sizes.pop('offset'))) > BESIDE * self.loop.size():
                raise Refused(f'the cylinder {inner.name} pushes {off:.3g} m beside the line of '
                              'its two pins')
            group, names, ends = CYLINDER, ('rod', 'tube'), ('pin', 'base')
        else:
            group, names, ends = f'dyads.{name}', ('', ''), ('first', 'second')
            self.values['linkage.dyads'].append(name)
            self.values[f'{group}.kind'] = kind
        self.modes[name] = f'{group}.mode'
        self.set_point(f'{group}.{ends[0]}', on_u, first)
        self.set_point(f'{group}.{ends[1]}', on_v, second)
        self.values[f'{group}.links'] = [self.add_link(u, start_u, along_u, names[0]),
                                         self.add_link(v, start_v, along_v, names[1])]
        self.values |= {f'{group}.{size}': value for size, value in sizes.items()}
        self.add_joint(f'{name}_first', at_u, u, on_u, self.links[u].direction)
        self.add_joint(f'{name}_second', at_v, v, on_v, self.links[v].direction)
        body, carrier = (u, v) if inner.kind == SLIDE else (v, u)
        self.add_joint(f'{name}_inner', inner, body, carrier, along, travel)

    def set_ground(self) -> None:
        """Call the base the ground, where the machine is solved from a moving link."""
        carrier = next(iter(self.links))
        if carrier == self.base:
            return
        names = {GROUND: self.add_link(carrier, *self.links.pop(carrier)[1:]),
                 self.links[self.base].name: GROUND}
        for body in self.links.keys() - {carrier}:
            link = self.links[body]
            self.links[body] = link._replace(name=names.get(link.name, link.name))
        for key, value in self.values.items():
            if key.endswith('.link'):
                self.values[key] = names.get(value, value)
            elif key.endswith('.links'):
                self.values[key] = [names.get(name, name) for name in value]
        self.values['cylinder.base.link' if 'cylinder.mode' in self.values
                    else 'linkage.carrier'] = names[GROUND]

    def set_mode(self, name: str, drive: RobotJoint, bodies: Sequence[str], wishes: Wishes
                 ) -> float:
        """Set the mode of the newest dyad, in which its loop closes nearest to the file's pose."""
        # Returns by how much its links turn to that [deg]; raises Refused if it leaves a doubt.
        key, links = self.modes[name], [self.links[body] for body in bodies]
        before = np.array([phase(link.direction) for link in links])
        away: dict[int, Array] = {}     # {mode: how far each link turns [rad]}
        why = ''
        for mode in (1, 2):
            try:
                motion = from_values({**self.values, key: mode}).linkage.motion(
                    drive.coordinate, 0.0, 0.0)
            except FourBarError as error:
                why = str(error)
                continue
            angles = [getattr(motion, f'theta_{link.name}', angle)
                      for link, angle in zip(links, before)]        # what only slides has none
            away[mode] = (np.array(angles) - before + pi) % tau - pi
        turns = {mode: float(degrees(np.max(np.abs(angles)))) for mode, angles in away.items()}
        has_one = self.values.get(f'dyads.{name}.kind') in ('RPP', 'PRP')
        mode = self.values[key] = 2 if has_one else wishes.mode.get(name) or min(
            turns, key=turns.__getitem__, default=2)
        turn = turns.get(mode, 0.0)
        if name in wishes.mode:
            if turn <= OPEN + ROUNDING:
                return turn
            instead = f'by {turns[3 - mode]:.3g}' if 3 - mode in turns else 'does not close'
            self.report.append(f'warning: --mode {name}={mode} turns links by {turn:.3g} '
                               f"degrees from the file's pose, mode {3 - mode} {instead}")
            return 0.0
        names = [joint.name for joint in self.loop.joints if not joint.closes]
        missing = [each for each in names if each not in wishes.at]
        is_asked = len(missing) < len(names)
        pose = 'the pose of --at' if is_asked else "the file's pose"
        ask = 'give a pose by --at' + (
            f', of {", ".join(missing)}{" too" * is_asked},' if missing else '') + ' or --key' + (
            '' if has_one else f', or the mode by --mode {name}=1 or {name}=2')
        whose = ', '.join(link.name for link in links)
        if mode not in turns:
            raise Refused(f'{whose}: the loop does not close with the drive where the file has it '
                          f'({why}); {ask}')
        if turn > OPEN + ROUNDING:
            raise Refused(f'{whose}: the loop is open in {pose}, links would turn by {turn:.3g} '
                          f'degrees to close it, above {OPEN:g}, too far to read the mode; {ask}')
        if len(turns) == 2 and not has_one:
            apart = float(np.max(np.abs((away[1] - away[2] + pi) % tau - pi)))
            if apart < 2.0 * FLAT or turns[3 - mode] < 2.0 * turn:
                raise Refused(f'{whose}: flat in {pose}, the modes are '
                              f'{degrees(apart):.3g} degrees apart, too near to read which; {ask}')
        return turn
