# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
URDF, which is a tree, with the ways in which files say where its loops are cut.

They are ``<constraint>`` (proposed for urdfdom, and written by ``fourbar describe``), a
``<joint>`` in ``<gazebo>``, ``loop_closures.yaml`` of jsk's exporter, and frames that coincide.
"""
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from fourbar_ros.errors import nearest
from fourbar_ros.importing import robots
from fourbar_ros.importing.robots import pose_of, Refused
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.base import rotation_of
from fourbar_ros.scene.files import text_of
import numpy as np
import yaml

KINDS = {'revolute': robots.PIN, 'continuous': robots.PIN, 'prismatic': robots.SLIDE,
         'fixed': robots.FIXED, 'ball': robots.POINT, 'floating': robots.FREE,
         'planar': robots.FREE, 'universal': robots.BALL, 'spherical': robots.BALL}
MOMENTS = 'ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz'
GRAVITY = 0.0, 0.0, -9.80665                                # [m/s^2], as no URDF says
Element = ElementTree.Element
Poses = Mapping[str, Array]


def _word(element: Element, tag: str, attribute: str, default: str = '') -> str:
    below = element.find(tag)
    return default if below is None else below.get(attribute, default)


def _kind_of(joint: Element) -> str:
    type_ = joint.get('type', '')
    if type_ not in KINDS:
        raise Refused(f'joint {joint.get("name")}: type {type_!r}{nearest(type_, KINDS)}')
    return KINDS[type_]


def _floats(text: str, count: int = 3, where: str = 'in the URDF') -> list[float]:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not np.all(np.isfinite(values)):
        raise Refused(f'{text!r} {where}: must be {count} number{"s" * (count > 1)}')
    return values


def _float(element: Element, tag: str, attribute: str, default: str = '0') -> float:
    return _floats(_word(element, tag, attribute, default), 1)[0]


def _check_links(joint: str, ends: Sequence[str], links: Collection[str]) -> None:
    for side, link in zip(('parent', 'child'), ends):
        if link not in links:
            raise Refused((f'{joint}: its {side} {link} is no link of the file' if link else
                           f'{joint} has no {side}') + nearest(link, links))


def _pose(xyz: Sequence[float], rpy_or_quaternion: Sequence[float]) -> Array:
    """Return the pose of a frame in that in which it is stated."""
    return pose_of(np.array(rotation_of(rpy_or_quaternion)).T, xyz)


def _pose_in(element: Element, tag: str) -> Array:
    return _pose(_floats(_word(element, tag, 'xyz', '0 0 0')),
                 _floats(_word(element, tag, 'rpy', '0 0 0')))


def _add_inertial(robot: robots.Robot, name: str, element: Element) -> None:
    """Add the <inertial> of a link; products of inertia that it leaves out are 0."""
    mass, *moments = [
        _floats(_word(element, tag, word, '0' * (word in MOMENTS[3:])), 1,
                f'for {word} of {tag} in {name}')[0]
        for tag, word in (('mass', 'value'), *(('inertia', word) for word in MOMENTS))]
    inertia = np.zeros((3, 3))
    rows, columns = (['xyz'.index(word[index]) for word in MOMENTS] for index in (1, 2))
    inertia[rows, columns] = inertia[columns, rows] = moments
    robot.add_inertial(name, mass, robot.poses[name] @ _pose_in(element, 'origin'), inertia)


class _TreeJoint(NamedTuple):
    element: Element
    kind: str
    parent: str
    child: str
    axis: Array                 # in the frame of the child

    def moved(self, position: float) -> Array:
        """Return the pose of the child in the parent at a position [rad or m]."""
        move = np.eye(4)
        if self.kind == robots.SLIDE:
            move[:3, 3] = position * self.axis
        elif self.kind == robots.PIN:
            move = _pose((0.0, 0.0, 0.0), [*(np.sin(0.5 * position) * self.axis),
                                           np.cos(0.5 * position)])
        return _pose_in(self.element, 'origin') @ move


def read_urdf(path: Path, wishes: robots.Wishes) -> robots.Robot:
    """Return the robot of a URDF in its zero pose or that of a group_state; raises Refused."""
    text = text_of(path)
    if 'xmlns:xacro' in text:
        raise Refused(f'{path}: is xacro: write its URDF first, xacro FILE > robot.urdf')
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise Refused(f'{path}: is no XML: {error}') from None
    links, joints = dict[str, Element](), dict[str, _TreeJoint]()
    for element in root.findall('link'):
        name = element.get('name', '')
        if name in links:
            raise Refused(f'two links are called {name!r}')
        links[name] = element
    above = dict[str, str]()            # {link: the joint whose child it is}
    for element in root.findall('joint'):
        name, kind = element.get('name', ''), _kind_of(element)
        ends = _word(element, 'parent', 'link'), _word(element, 'child', 'link')
        _check_links(f'joint {name}', ends, links)
        if name in joints:
            raise Refused(f'two joints are called {name!r}')
        if (first := above.setdefault(ends[1], name)) != name:
            raise Refused(f'{ends[1]} is the child of {first} and of {name}, and URDF is a tree: '
                          'close the loop by frames that coincide (--close)')
        axis = np.array(_floats(_word(element, 'axis', 'xyz', '1 0 0')))
        joints[name] = _TreeJoint(element, kind, *ends, robots.unit_vector(name, axis)
                                  if kind in (robots.PIN, robots.SLIDE) else axis)
    if not links:
        raise Refused(f'{path}: has no <link>')
    roots = links.keys() - {joint.child for joint in joints.values()}
    if len(roots) != 1:
        raise Refused(f'{path}: has {len(roots)} roots, {", ".join(sorted(roots))}')

    # the pose
    states = {state.get('name', ''): state for state in root.findall('group_state')}
    positions = dict.fromkeys(joints, 0.0)
    if key := wishes.pose_of(states, 'group_state'):
        for element in states[key].findall('joint'):
            name = element.get('name', '')
            robots.check_name(f'group_state {key}: joint', name, joints, 'joint')
            positions[name] = _floats(element.get('value', '0'), 1)[0]
    positions |= wishes.positions({name: joint.kind for name, joint in joints.items()})
    poses, zero = ({root: np.eye(4) for root in roots} for _ in range(2))
    while len(poses) < len(links):
        new = {joint.child: (name, joint) for name, joint in joints.items()
               if joint.parent in poses and joint.child not in poses}
        if not new:
            raise Refused(f'{path}: no way from the root to {min(links.keys() - poses.keys())}')
        for link, (name, joint) in new.items():
            poses[link] = poses[joint.parent] @ joint.moved(positions[name])
            zero[link] = zero[joint.parent] @ joint.moved(0.0)

    robot = robots.Robot('URDF', min(roots), np.array(GRAVITY), poses)
    for name in links:
        if (inertial := links[name].find('inertial')) is not None:
            _add_inertial(robot, name, inertial)
    of_none = [name for name, (_, _, inertia) in robot.inertials.items()
               if 2.0 * np.linalg.norm(inertia, 2) > (1.0 + 1e-9) * np.trace(inertia)]
    if of_none:
        robot.notes.append(f'moments of inertia of {", ".join(of_none)}: the largest is more than '
                           'the two others together, as of no body')
    for name, joint in joints.items():
        pose, element = poses[joint.child], joint.element
        low, high = (_float(element, 'limit', end) for end in ('lower', 'upper'))
        robot.joints.append(robots.RobotJoint(
            name, joint.kind, joint.parent, joint.child, pose[:3, 3], pose[:3, 3],
            pose[:3, :3] @ joint.axis if joint.kind in (robots.PIN, robots.SLIDE) else None,
            positions[name],
            (low, high) if low != high and element.get('type') != 'continuous' else None))
        motor = _word(element, 'mimic', 'joint')
        if motor and motor not in joints:
            robot.notes.append(f'mimic of {name}: the file has no joint {motor}'
                               f'{nearest(motor, joints)}: left out')
        elif motor:
            robot.couplings.append(robots.Coupling(
                name, motor, _float(element, 'mimic', 'offset'),
                _float(element, 'mimic', 'multiplier', '1')))
    # (what says it, joint) of the motors
    motors = [(motor, element.get('name', '')) for motor, joint in (
        ('transmission', 'joint'), ('ros2_control', 'joint[command_interface]'))
        for element in root.findall(f'.//{motor}/{joint}')]
    _add_closing(robot, root, zero)
    for folder in (path.parent, path.parent.parent / 'config'):
        if (folder / 'loop_closures.yaml').is_file():
            independent, closures = _loop_closures(folder / 'loop_closures.yaml')
            motors += [('loop_closures.yaml', name) for name in independent]
            for ends, point, axis in closures:
                _check_links('loop_closures.yaml', ends, links)
                here, there = (poses[link] @ np.linalg.inv(zero[link]) @ pose_of(np.eye(3), point)
                               for link in ends)
                robot.add_closing('~'.join(ends), robots.PIN, ends, (here, there),
                                  here[:3, :3] @ axis)
    known = {joint.name for joint in robot.joints}
    robot.drives = [name for _, name in motors if name in known]
    robot.notes += [f'{motor} of {name}: the file has no such joint{nearest(name, joints)}'
                    for motor, name in motors if name not in known]
    for name, how, frames in _frames(wishes.close, poses):
        # a link's own name may have an @: closing_link@0/0/1_1, of a joint called after its point
        bodies, points = zip(*[(frame, '') if frame in poses else frame.partition('@')[::2]
                               for frame in frames])
        for link in bodies:
            robots.check_name('--close', link, poses, 'link')
        name += '_closing' * (name in joints)       # a joint of the tree may be called as its link
        if name not in known:
            robot.add_closing(name, how or robots.POINT, bodies, [
                poses[link] @ pose_of(np.eye(3), _floats(point.replace('/', ' ') or '0 0 0',
                                                         where=f'of --close {frame}'))
                for frame, link, point in zip(frames, bodies, points)])
    robot.add_fixed_bodies()
    return robot


def _loop_closures(path: Path) -> tuple[list[str], list[tuple[tuple[str, str], Array, Array]]]:
    """Return the driven joints and the closures of jsk's file; raises Refused."""
    # a closure: its two links; its point [m] and axis, in the root's frame at zero joints
    def vector(closure: Mapping[str, Sequence[float]], name: str) -> Array:
        return np.array(_floats(' '.join(map(str, closure[name])), where=f'for {name} in {path}'))

    try:
        tree = yaml.safe_load(text_of(path))
        return [*map(str, tree.get('independent', ()))], [
            ((str(closure['link_a']), str(closure['link_b'])),
             vector(closure, 'point'), vector(closure, 'axis'))
            for closure in tree['closures']]
    except (yaml.YAMLError, AttributeError, KeyError, TypeError):
        raise Refused(f'{path}: must be "independent", a list of joints, and "closures", a list '
                      'of link_a, link_b, point and axis') from None


def _add_closing(robot: robots.Robot, root: Element, zero: Poses) -> None:
    """Add the joints of constraints and gazebo; ``zero``: poses of links at zero joints."""
    poses = robot.poses
    for element in root.findall('constraint'):
        links = _word(element, 'parent', 'link'), _word(element, 'child', 'link')
        _check_links(f'constraint {element.get("name")}', links, poses)
        here, there = (poses[link] @ _pose_in(element, f'{side}_origin')
                       for link, side in zip(links, ('parent', 'child')))
        axis = _word(element, 'parent_axis', 'xyz')
        robot.add_closing(element.get('name', ''), _kind_of(element),
                          links, (here, there), here[:3, :3] @ _floats(axis) if axis else None)
    for element in root.iterfind('gazebo/joint'):       # in the frame of the child
        if element.get('type') in ('screw', 'gearbox'):     # they couple joints, as a mimic does
            robot.notes.append(f'joint {element.get("name")} in gazebo is a '
                               f'{element.get("type")}: left out')
            continue
        links = (element.findtext('parent', '').strip(), element.findtext('child', '').strip())
        _check_links(f'joint {element.get("name")} in gazebo', links, poses)
        local = _floats(element.findtext('pose', '0 0 0 0 0 0'), 6)
        pose = zero[links[1]] @ _pose(local[:3], local[3:])
        here, there = (poses[link] @ np.linalg.inv(zero[link]) @ pose for link in links)
        along = np.array(_floats(element.findtext('axis/xyz', '0 0 1')))
        if element.findtext('axis/use_parent_model_frame', '').strip() in ('1', 'true'):
            along = pose[:3, :3].T @ along
        robot.add_closing(element.get('name', ''), _kind_of(element),
                          links, (here, there), here[:3, :3] @ along)


def _frames(close: Sequence[str], poses: Poses) -> Iterator[tuple[str, str, Sequence[str]]]:
    """Yield (name, kind or '', frames) that coincide: named as cut frames are, or as asked."""
    for frame in poses:
        for end, far in (('_1', '_2'), ('_A', '_B')):
            name = frame.removesuffix(end)
            if robots.CUT.match(frame) and name != frame and name + far in poses:
                yield name.removeprefix('closing_'), '', (frame, name + far)
    for text in close:
        frames, _, how = text.partition(':')
        ends = frames.split(',')
        if len(ends) != 2 or how not in ('', robots.FIXED):
            raise Refused(f'--close {text}: must be FRAME,FRAME or FRAME,FRAME:fixed')
        yield ends[0], how, ends
