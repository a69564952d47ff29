# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The closed loops of a robot: its rigid links, what joins them, and whether that is planar."""
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import asin, degrees

from fourbar_ros.errors import nearest
from fourbar_ros.importing import robots
from fourbar_ros.importing.robots import PIN, POINT, Refused, RobotJoint
from fourbar_ros.numerics.arrays import Array
import numpy as np

PARALLEL = 0.5          # [deg] by which an axis may be off the plane
ROUNDED = 1e-3          # [deg] by which digits of a file, as 1.5708, turn an axis
CLOSED = 1e-6           # [m, rad] by which a weld may be open
OUT_OF_PLANE = 1e-3     # share of the loop's size by which a point may be


@dataclass
class Loop:
    """Links that form closed loops with each other: one mechanism."""

    # a link: bodies that do not move to each other, called like the one nearest to the root
    robot: robots.Robot
    link_of: dict[str, str]             # {body: its link}
    joints: list[RobotJoint]

    @property
    def links(self) -> list[str]:
        return list(dict.fromkeys(link for joint in self.joints for link in self.ends(joint)))

    def ends(self, joint: RobotJoint) -> tuple[str, str]:
        return self.link_of[joint.parent], self.link_of[joint.child]

    def far(self, joint: RobotJoint, link: str) -> str:
        """Return the link at the far end of a joint of a link."""
        parent, child = self.ends(joint)
        return child if link == parent else parent

    def joints_of(self, link: str) -> list[RobotJoint]:
        return [joint for joint in self.joints if link in self.ends(joint)]

    def point(self, joint: RobotJoint, link: str) -> Array:
        """Return where a joint is on a link [m]."""
        return joint.on_parent if self.link_of[joint.parent] == link else joint.on_child

    def size(self) -> float:
        """Return the largest distance of two joints [m] along an axis of the root."""
        return float(np.max(np.ptp([joint.on_parent for joint in self.joints], axis=0)))

    def name_of(self, link: str) -> str:
        """Return the name of a link: that of its heaviest body, the nearest to the root of two."""
        inertials = self.robot.inertials
        return max((body for body in self.robot.poses if self.link_of[body] == link),
                   key=lambda body: inertials[body].mass if body in inertials else 0.0)

    def carried_by(self, link: str) -> set[str]:
        """Return a link and all links that hang on it beside this loop."""
        links = {*self.links}
        reached, new = {link}, {link}
        while new:
            ends = [{*self.ends(joint)} for joint in self.robot.joints]
            new = set().union(*(pair for pair in ends if pair & reached and not pair <= links)
                              ) - reached
            reached |= new
        return reached


def loops_of(robot: robots.Robot, lock: Sequence[str] = (), cut: Sequence[str] = ()) -> list[Loop]:
    """Return the loops of a robot; ``lock``: joints that are held, ``cut``: left out."""
    # Raises Refused for an unknown joint, a weld that is open, or if there is no loop.
    closing = [joint.name for joint in robot.joints if joint.closes]
    for name in cut:
        if name not in closing:
            raise Refused(f'--cut {name}: no joint that closes a loop{nearest(name, closing)}')
    for name in lock:
        robots.check_name('--lock', name, [joint.name for joint in robot.joints], 'joint')
    joints = [joint for joint in robot.joints if joint.name not in cut]
    robot = replace(robot, joints=joints)
    link_of = {body: body for body in robot.poses}
    for joint in joints:
        if joint.kind == robots.FIXED or joint.name in lock:
            if joint.closes and max(joint.gap, joint.turned) > CLOSED:
                raise Refused(f'the weld {joint.name} is open by {joint.gap:.3g} m and '
                              f'{degrees(joint.turned):.3g} degrees: give a pose that closes it '
                              f'by --at or --key, or --cut {joint.name}')
            kept, gone = link_of[joint.parent], link_of[joint.child]
            link_of.update((body, kept) for body, link in link_of.items() if link == gone)
    moving = _pins_of_two_points([joint for joint in joints if joint.kind != robots.FIXED
                                  and link_of[joint.parent] != link_of[joint.child]], link_of)

    # a tree of the joints, first of those that close none; each further one makes a circle with
    # those between its ends, and circles with a joint in common are one mechanism
    ways = dict.fromkeys(link_of.values(), frozenset[int]())    # joints up to the root of its tree
    root_of = {link: link for link in ways}
    circles: list[frozenset[int]] = []
    for index in sorted(range(len(moving)), key=lambda index: moving[index].closes):
        first, last = link_of[moving[index].parent], link_of[moving[index].child]
        circle, kept, gone = ways[first] ^ ways[last] ^ {index}, root_of[first], root_of[last]
        if kept != gone:                    # two trees become one
            for link in ways:
                if root_of[link] == gone:
                    ways[link], root_of[link] = ways[link] ^ circle, kept
            continue
        touching = [each for each in circles if each & circle]
        circles = [each for each in circles if not each & circle]
        circles.append(circle.union(*touching))
    idle = [f'{joint.name} closes no loop: {joint.parent} and {joint.child} are one link'
            for joint in joints if joint.closes and joint.kind != robots.FIXED
            and link_of[joint.parent] == link_of[joint.child]]
    robot.notes.extend(idle)
    if not circles:
        coupled = [coupling.joint for coupling in robot.couplings]
        raise Refused('no closed loop in the file' + ''.join(f'; {note}' for note in idle) + (
            f'; it has {len(coupled)} mimic or gear joints ({", ".join(coupled[:4])}), which are '
            'none' if coupled else '') + ''.join(
            f'; {note}' for note in robot.notes if note.startswith(('actuator ', 'equality '))) + (
            f'; name the frames that coincide by --close A,B{_might_close(robot, link_of)}'
            if robot.format == 'URDF' else ''))
    return [Loop(robot, link_of, [moving[index] for index in sorted(circle)])
            for circle in sorted(circles, key=min)]


def _might_close(robot: robots.Robot, link_of: dict[str, str]) -> str:
    """Return a hint at frames without mass that nearly coincide, for --close; empty: none."""
    points = {joint.child: joint.on_child for joint in robot.joints
              if joint.kind == robots.FIXED and joint.child not in robot.inertials}
    frames = [name for name in points if 'clos' in name.lower()] or [*points]
    pairs = [(float(np.linalg.norm(points[first] - points[second])), first, second)
             for first, second in combinations(frames, 2) if link_of[first] != link_of[second]]
    if not pairs:
        return ''
    gap, first, second = min(pairs)
    return (f', of {", ".join(frames[:8])}: --close {first},{second} are {gap:.3g} m apart '
            "in the file's pose")


def _pins_of_two_points(joints: list[RobotJoint], link_of: dict[str, str]) -> list[RobotJoint]:
    """Return joints where two points that close the same two links are the pin through both."""
    pins: dict[frozenset[str], RobotJoint] = {}
    left = []
    for joint in joints:
        ends = frozenset((link_of[joint.parent], link_of[joint.child]))
        first = pins.setdefault(ends, joint) if joint.kind == POINT else joint
        if first is joint:
            left.append(joint)
            continue
        is_turned = link_of[first.parent] != link_of[joint.parent]
        away = (joint.on_child if is_turned else joint.on_parent) - first.on_parent
        if np.linalg.norm(away) <= CLOSED:
            continue                        # the same point once more
        if first.axis is None:
            first.kind, first.axis = PIN, away / np.linalg.norm(away)
        elif np.linalg.norm(np.cross(away, first.axis)) > CLOSED:
            left.append(joint)              # not in line with the two: they are no pin
    return left


def normal_of(loop: Loop) -> tuple[Array, float]:
    """Return the unit vector square to a loop's plane, and by how much an axis is off it [deg]."""
    # Raises Refused if the loop is not planar.
    pins = [joint for joint in loop.joints if joint.kind == PIN]
    if not pins:
        raise Refused('no pin of the loop states its axis')
    normal, worst = pins[0].axis, 0.0
    assert normal is not None
    for joint in loop.joints:
        if joint.kind == robots.FREE:
            raise Refused(f'{joint.name} is a free joint inside the loop')
        if joint.axis is None:
            off = abs(float(normal @ (joint.on_parent - joint.on_child)))
            if off > (limit := OUT_OF_PLANE * loop.size()):
                raise Refused(f'not planar: the points of {joint.name} are {off:.3g} m apart '
                              f'square to the plane, above {limit:.3g} m, {OUT_OF_PLANE:g} of the '
                              "loop's size")
            continue
        along = abs(float(normal @ joint.axis))
        off = degrees(asin(min(1.0, along if joint.kind == robots.SLIDE else float(
            np.linalg.norm(np.cross(normal, joint.axis))))))
        worst = max(worst, off)
        if off > PARALLEL:
            crossing = [pin.name for pin in pins if pin is not joint and pin.axis is not None
                        and np.linalg.norm(np.cross(pin.axis, joint.axis)) > 0.5
                        and np.linalg.norm(pin.on_parent - joint.on_parent) <= CLOSED]
            raise Refused(f'not planar: {joint.name} is {off:.3g} degrees off the plane square to '
                          f'{pins[0].name}' + (f'; with {", ".join(crossing)} it is a ball or '
                                               'universal joint' if crossing else ''))
    for link in loop.links:
        if all(joint.kind in (POINT, robots.BALL) for joint in loop.joints_of(link)):
            raise Refused(f'{loop.name_of(link)} is a rod on balls, which may leave the plane')
    for joint in loop.joints:
        if joint.kind in (POINT, robots.BALL) and not joint.closes:
            raise Refused(f'{joint.name} is a ball joint, whose position is not one number')
    return normal, worst


def base_of(loop: Loop, wishes: robots.Wishes) -> str:
    """Return the link that carries the loop: the one on which the robot's root hangs."""
    if wishes.base:
        robots.check_name('--base', wishes.base, loop.link_of, 'link')
        if loop.link_of[wishes.base] in loop.links:
            return loop.link_of[wishes.base]
        if wishes.loop:
            raise Refused(f'--base {wishes.base}: no link of this loop, which has '
                          f'{", ".join(map(loop.name_of, loop.links))}')
    root = loop.link_of[loop.robot.root]
    return next((link for link in loop.links if root in loop.carried_by(link)), loop.links[0])


def check_freedom(loop: Loop) -> None:
    """Raise Refused if a loop has not one degree of freedom, 3 (links - 1) - 2 joints."""
    links, joints = len(loop.links), len(loop.joints)
    freedom = 3 * (links - 1) - 2 * joints
    text = f'{links} links and {joints} joints have {freedom} degrees of freedom'
    if freedom > 1:
        driven = [joint.name for joint in loop.joints if joint.name in loop.robot.drives]
        passive = [joint.name for joint in loop.joints
                   if not joint.closes and joint.name not in driven]
        raise Refused(f'{text}: hold {freedom - 1} of the joints by --lock, as '
                      f'{", ".join([*driven[1:], *passive][:4])}')
    if freedom < 1:
        closing = [joint.name for joint in loop.joints if joint.closes] + [
            joint.name for joint in loop.robot.joints
            if joint.closes and joint.kind == robots.FIXED and {*loop.ends(joint)} & {*loop.links}]
        raise Refused(f'{text}: more joints than motion needs, as of the second rod of a '
                      f'parallelogram; leave out one by --cut, of {", ".join(closing)}')
