# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
URDF, which is a tree, with the ways in which files say where its loops are cut.

They are ``<constraint>`` (proposed for urdfdom, and written by ``fourbar describe``), a
``<joint>`` in ``<gazebo>``, ``loop_closures.yaml`` of jsk's exporter, and frames that coincide.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from fourbar_ros.errors import nearest
from fourbar_ros.importing.robot import (
    angle_between,
    BALL,
    Coupling,
    CUT,
    FIXED,
    PIN,
    POINT,
    pose_of,
    position_of,
    Refused,
    Robot,
    RobotJoint,
    SLIDE,
    START,
)
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.base import rotation_of
import numpy as np
import yaml

KINDS = {'revolute': PIN, 'continuous': PIN, 'prismatic': SLIDE, 'fixed': FIXED, 'ball': POINT}
GRAVITY = 0.0, 0.0, -9.80665                                # [m/s^2], as no URDF says
Element = ElementTree.Element
Poses = Mapping[str, Array]


def _word(element: Element, tag: str, attribute: str, default: str = '') -> str:
    below = element.find(tag)
    return default if below is None else below.get(attribute, default)


def _numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split()]
    except ValueError:
        raise Refused(f'{text!r} in the URDF are no numbers') from None


def _rotation(rpy_or_quaternion: Sequence[float]) -> Array:
    """Return the rotation from a frame to that in which it is stated."""
    return np.array(rotation_of(rpy_or_quaternion)).T


def _pose_in(element: Element, tag: str) -> Array:
    return pose_of(_rotation(_numbers(_word(element, tag, 'rpy', '0 0 0'))),
                   _numbers(_word(element, tag, 'xyz', '0 0 0')))


class _TreeJoint(NamedTuple):
    element: Element
    kind: str
    parent: str
    child: str
    axis: Array                 # in the frame of the child

    def moved(self, position: float) -> Array:
        """Return the pose of the child in the parent at a position [rad or m]."""
        move = np.eye(4)
        if self.kind == SLIDE:
            move[:3, 3] = position * self.axis
        elif self.kind == PIN:
            move[:3, :3] = _rotation([*(np.sin(0.5 * position) * self.axis),
                                      np.cos(0.5 * position)])
        return _pose_in(self.element, 'origin') @ move


def read_urdf(path: Path, close: Sequence[str], key: str, at: Mapping[str, str]) -> Robot:
    """
    Return the robot of a URDF in its zero pose or that of a group_state, joints of ``at`` moved.

    ``close``: FRAME,FRAME or FRAME,FRAME:fixed, frames that coincide. Raises Refused.
    """
    text = path.read_text(encoding='utf-8')
    if 'xmlns:xacro' in text:
        raise Refused(f'{path}: is xacro: write its URDF first, xacro FILE > robot.urdf')
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise Refused(f'{path}: is no XML: {error}') from None
    links = {link.get('name', ''): link for link in root.findall('link')}
    joints = {}
    for element in root.findall('joint'):
        axis = np.array(_numbers(_word(element, 'axis', 'xyz', '1 0 0')))
        joints[element.get('name', '')] = _TreeJoint(
            element, KINDS.get(element.get('type', ''), BALL), _word(element, 'parent', 'link'),
            _word(element, 'child', 'link'), axis / (np.linalg.norm(axis) or 1.0))
    roots = links.keys() - {joint.child for joint in joints.values()}
    if len(roots) != 1:
        raise Refused(f'{path}: has {len(roots)} roots, {", ".join(sorted(roots))}')

    # the pose
    states = {state.get('name', ''): state for state in root.findall('group_state')}
    key = key or START * (START in states)
    if key and key not in states:
        raise Refused(f'--key {key}: the file has no such group_state{nearest(key, states)}')
    positions = dict.fromkeys(joints, 0.0)
    for element in states[key].findall('joint') if key else ():
        positions[element.get('name', '')] = _numbers(element.get('value', '0'))[0]
    for name, position in at.items():
        if name not in joints:
            raise Refused(f'--at {name}: the file has no such joint{nearest(name, joints)}')
        positions[name] = position_of(name, joints[name].kind, position)
    poses, zero = ({root: np.eye(4) for root in roots} for _ in range(2))
    while len(poses) < len(links):
        new = {joint.child: (name, joint) for name, joint in joints.items()
               if joint.parent in poses and joint.child not in poses}
        if not new:
            raise Refused(f'{path}: no way from the root to {min(links.keys() - poses.keys())}')
        for link, (name, joint) in new.items():
            poses[link] = poses[joint.parent] @ joint.moved(positions[name])
            zero[link] = zero[joint.parent] @ joint.moved(0.0)

    robot = Robot('URDF', min(roots), np.array(GRAVITY), poses)
    for name in links:
        inertial = links[name].find('inertial')
        if inertial is not None:
            xx, yy, zz, xy, xz, yz = (
                _numbers(_word(inertial, 'inertia', axes, '0'))[0]
                for axes in ('ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz'))
            robot.add_inertial(name, _numbers(_word(inertial, 'mass', 'value', '0'))[0],
                               poses[name] @ _pose_in(inertial, 'origin'),
                               np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    for name, joint in joints.items():
        pose = poses[joint.child]
        low, high = (_numbers(_word(joint.element, 'limit', end, '0'))[0]
                     for end in ('lower', 'upper'))
        robot.joints.append(RobotJoint(
            name, joint.kind, joint.parent, joint.child, pose[:3, 3], pose[:3, 3],
            pose[:3, :3] @ joint.axis if joint.kind in (PIN, SLIDE) else None, positions[name],
            (low, high) if low < high and joint.element.get('type') != 'continuous' else None))
        if joint.element.find('mimic') is not None:
            robot.couplings.append(Coupling(name, _word(joint.element, 'mimic', 'joint'), *(
                _numbers(_word(joint.element, 'mimic', word, default))[0]
                for word, default in (('offset', '0'), ('multiplier', '1')))))
    robot.drives = [joint.get('name', '') for path_of_joint in (
        './/transmission/joint', './/ros2_control/joint[command_interface]')
        for joint in root.findall(path_of_joint)]
    robot.joints += [*_constraints(root, poses), *_of_gazebo(root, poses, zero)]
    for folder in (path.parent, path.parent.parent / 'config'):
        if (folder / 'loop_closures.yaml').is_file():
            tree = yaml.safe_load((folder / 'loop_closures.yaml').read_text(encoding='utf-8'))
            robot.drives += tree.get('independent', [])
            for closure in tree['closures']:        # point and axis in the zero pose of the root
                ends = closure['link_a'], closure['link_b']
                here, there = (poses[link] @ np.linalg.inv(zero[link]) @ pose_of(
                    np.eye(3), closure['point']) for link in ends)
                robot.joints.append(_closing('~'.join(ends), PIN, ends, (here, there),
                                             here[:3, :3] @ np.array(closure['axis'], float)))
    robot.joints += _frames(close, poses, {joint.name for joint in robot.joints})
    robot.add_fixed_bodies()
    return robot


def _closing(name: str, kind: str, links: tuple[str, str], poses: tuple[Array, Array],
             axis: Array | None = None) -> RobotJoint:
    """Return a joint that closes a loop: a link's pose each, and the axis in the root."""
    here, there = poses
    if axis is None and kind == PIN:
        kind = POINT
    return RobotJoint(
        name, kind, *links, here[:3, 3], there[:3, 3],
        axis / np.linalg.norm(axis) if axis is not None and kind in (PIN, SLIDE) else None,
        closes=True,
        turned=angle_between(here[:3, :3], there[:3, :3]) if kind == FIXED else 0.0)


def _constraints(root: Element, poses: Poses) -> Iterator[RobotJoint]:
    for element in root.findall('constraint'):
        links = _word(element, 'parent', 'link'), _word(element, 'child', 'link')
        here, there = (poses[link] @ _pose_in(element, f'{side}_origin')
                       for link, side in zip(links, ('parent', 'child')))
        axis = _word(element, 'parent_axis', 'xyz')
        yield _closing(element.get('name', ''), KINDS.get(element.get('type', ''), BALL), links,
                       (here, there), here[:3, :3] @ _numbers(axis) if axis else None)


def _of_gazebo(root: Element, poses: Poses, zero: Poses) -> Iterator[RobotJoint]:
    """Yield joints of SDF in ``<gazebo>``: in the frame of the child, in the zero pose."""
    for element in root.iterfind('gazebo/joint'):
        links = (element.findtext('parent', '').strip(), element.findtext('child', '').strip())
        local = _numbers(element.findtext('pose', '0 0 0 0 0 0'))
        pose = zero[links[1]] @ pose_of(_rotation(local[3:]), local[:3])
        here, there = (poses[link] @ np.linalg.inv(zero[link]) @ pose for link in links)
        axis = np.array(_numbers(element.findtext('axis/xyz', '0 0 1')))
        if element.findtext('axis/use_parent_model_frame', '').strip() in ('1', 'true'):
            axis = pose[:3, :3].T @ axis
        yield _closing(element.get('name', ''), KINDS.get(element.get('type', ''), BALL), links,
                       (here, there), here[:3, :3] @ axis)


def _frames(close: Sequence[str], poses: Poses, known: set[str]) -> Iterator[RobotJoint]:
    """Yield joints where frames coincide: as the user says, or named as cut frames are."""
    pairs = []
    for frame in poses:
        for end, far in (('_1', '_2'), ('_A', '_B')):
            name = frame.removesuffix(end)
            if CUT.match(frame) and name != frame and name + far in poses:
                pairs.append((name.removeprefix('closing_'), [frame, name + far], ''))
    for text in close:
        frames, _, how = text.partition(':')
        ends = frames.split(',')
        if len(ends) != 2 or how not in ('', FIXED):
            raise Refused(f'--close {text}: must be FRAME,FRAME or FRAME,FRAME:fixed')
        pairs.append((ends[0], ends, how))
    for name, ends, how in pairs:
        sides = []
        for frame in ends:
            link, _, point = frame.partition('@')
            if link not in poses:
                raise Refused(f'--close {frame}: the file has no such link{nearest(link, poses)}')
            local = _numbers(point.replace('/', ' ') or '0 0 0')
            sides.append((link, poses[link] @ pose_of(np.eye(3), local)))
        if name not in known:
            (first, here), (second, there) = sides
            yield _closing(name, how or POINT, (first, second), (here, there))
