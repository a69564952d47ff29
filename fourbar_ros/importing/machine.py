# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A planar loop of a robot as a scene: what drives it, dyad after dyad, masses, joints, frame."""
from collections.abc import Mapping, Sequence
from math import tau
from typing import NamedTuple

from fourbar_ros.importing.loops import base_of, check_freedom, CLOSED, Loop, normal_of
from fourbar_ros.importing.plane import CYLINDER, Plane
from fourbar_ros.importing.robots import Coupling, Refused, RobotJoint, SLIDE, Wishes, word
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.base import rpy_of
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import ParameterValues
import numpy as np


class Imported(NamedTuple):
    """A loop as a scene: its values, its joints by the scene's name, and lines of a report."""

    loop: Loop
    values: ParameterValues
    scene: Scene
    joints: Mapping[str, RobotJoint]
    drive: RobotJoint
    report: list[str]
    off_parallel: float         # of the axes, at most [deg]
    unweighed: Sequence[str]    # bodies that lack the mass of their meshes


def drive_of(loop: Loop, base: str, wishes: Wishes) -> tuple[RobotJoint, Coupling | None]:
    """Return the driven joint of a loop, with the gear from a motor elsewhere; raises Refused."""
    # If the user names none, the motors of the file, or what is geared to one, say it.
    names = {joint.name: joint for joint in loop.joints}
    motors, gear = loop.robot.drives, None
    driven = [name for name in wishes.drive if name in names]
    if len(driven) > 1:
        raise Refused(f'--drive {" --drive ".join(driven)}: a loop has one; hold the others by '
                      '--lock')
    driven = driven or list(dict.fromkeys(name for name in motors if name in names))
    for coupling in loop.robot.couplings if not driven else ():
        joint, motor, offset, ratio = coupling
        if motor in names and joint in motors and joint not in names and ratio:
            joint, motor, offset, ratio = motor, joint, -offset / ratio, 1.0 / ratio
        if joint in names and motor in motors and motor not in names and ratio:
            driven, gear = [joint], Coupling(joint, motor, offset, ratio)
    if not driven:
        on_base = [joint.name for joint in loop.joints_of(base) if not joint.closes]
        raise Refused('the file does not say which joint of this loop is driven: give --drive, '
                      f'as of {", ".join(on_base)}')
    if len(driven) > 1:
        raise Refused(f'{len(driven)} joints of this loop are driven, {", ".join(driven)}: hold '
                      'all but one by --lock')
    if names[driven[0]].closes:
        of_tree = [name for name, joint in names.items() if not joint.closes]
        raise Refused(f'{driven[0]} closes the loop, so the file gives it no position: drive one '
                      f'of {", ".join(of_tree)}, or cut the loop elsewhere in the file')
    return names[driven[0]], gear


class LoopInput(NamedTuple):
    """How a drive moves a loop."""

    input: str              # as linkage.input of the scene has it
    carrier: str            # the base, or a moving link
    hinge: RobotJoint       # joins the driven link to the carrier
    # rod and tube, each with the joint at its far end: a dyad that the drive slides
    cylinder: Sequence[tuple[str, RobotJoint]] = ()


def _input_of(loop: Loop, drive: RobotJoint, base: str) -> LoopInput:
    """Return how a driven joint moves the loop; Refused where a scene has no such input."""
    ends = loop.ends(drive)
    if base in ends:
        return LoopInput('slide' if drive.kind == SLIDE else 'crank', base, drive)
    if drive.kind != SLIDE:
        return LoopInput('crank', ends[0], drive)
    # a cylinder: the link to which the tube is pinned carries the hinge of the link to which the
    # rod is pinned; which of both links is the tube decides the carrier, the base if it may be
    inputs = []
    for tube, rod in (ends, ends[::-1]):
        outer = [[joint for joint in loop.joints_of(body) if joint is not drive]
                 for body in (tube, rod)]
        if all(len(joints) == 1 and joints[0].kind != SLIDE for joints in outer):
            at_tube, at_rod = outer[0][0], outer[1][0]
            carrier, turned = loop.far(at_tube, tube), loop.far(at_rod, rod)
            inputs += [LoopInput(CYLINDER, carrier, hinge, ((rod, at_rod), (tube, at_tube)))
                       for hinge in loop.joints_of(turned)
                       if carrier in loop.ends(hinge) and hinge.kind != SLIDE]
    if not inputs:
        raise Refused(f'{drive.name} slides between the moving links '
                      f'{" and ".join(map(loop.name_of, ends))}, and is no cylinder that turns a '
                      'link against another to which that is pinned')
    return min(inputs, key=lambda each: each.carrier != base)


def imported(loop: Loop, wishes: Wishes) -> Imported:
    """Return a loop as a scene in which the node is a relay for the robot's passive joints."""
    # Raises Refused if the loop is not planar, has not one degree of freedom or no dyads, or if
    # the file leaves open what drives it or which mode it is in.
    normal, off = normal_of(loop)
    base = base_of(loop, wishes)
    check_freedom(loop)
    drive, gear = drive_of(loop, base, wishes)
    loop_input = _input_of(loop, drive, base)
    carrier, driven = loop_input.carrier, loop.far(loop_input.hinge, loop_input.carrier)

    # axes: the driven joint turns to the left; x along the driven slide, or y up
    origin = loop.point(loop_input.hinge, carrier)
    sense = 1.0 if loop.link_of[loop_input.hinge.child] == driven else -1.0
    up, axis = -loop.robot.gravity, loop_input.hinge.axis
    if loop_input.input == 'slide':
        assert axis is not None                             # a slide has one
        x = sense * axis
        origin = loop.point(drive, driven) - drive.position * x     # so x is the joint's position
    else:
        if axis is not None:
            normal = normal if sense * (axis @ normal) > 0.0 else -normal
        x = np.cross(up, normal)
        if np.linalg.norm(x) <= 1e-3 * np.linalg.norm(up):
            x = np.eye(3)[int(np.argmin(np.abs(normal)))]
    x = x - normal * (normal @ x)
    x /= np.linalg.norm(x)
    plane = Plane(loop, base, carrier, np.array([x, np.cross(normal, x), normal]), origin)

    # the driven link, the cylinder, dyad after dyad; the pose of each says its mode
    start = plane.pivot(loop_input.hinge, driven)
    if loop_input.input == 'slide':
        plane.add_link(driven, start, 1.0, 'slider')
    else:
        arms = [plane.pivot(joint, driven) - start for joint in loop.joints_of(driven)
                if joint is not loop_input.hinge and joint.kind != SLIDE]
        plane.add_link(driven, start, next((arm for arm in arms if abs(arm) > 1e-9), 1.0), 'crank')
    plane.add_joint('base', loop_input.hinge, driven, carrier, travel=drive.position)
    plane.values['linkage.input'] = loop_input.input
    turn = 0.0
    if loop_input.cylinder:
        plane.add_dyad(CYLINDER, loop_input.cylinder, drive)
        turn = plane.set_mode(CYLINDER, drive, (driven, loop_input.cylinder[1][0]), wishes)
    while left := [body for body in loop.links if body not in plane.links]:
        ends, inner = _next_dyad(loop, plane)
        if inner is None:
            might = [joint.name for joint in loop.joints_of(carrier)
                     if joint is not loop_input.hinge and not joint.closes]
            raise Refused(f'{", ".join(map(loop.name_of, left))} form no dyads with {drive.name} '
                          'driven: a group of a higher class' + (
                              f'; perhaps with {" or ".join(might)} (--drive)' if might else ''))
        name = f'd{len(plane.values["linkage.dyads"]) + 1}'
        plane.add_dyad(name, ends, inner)
        turn = max(turn, plane.set_mode(name, drive, [body for body, _ in ends], wishes))
    for name in wishes.mode:
        if name not in plane.modes:
            raise Refused(f'--mode {name}: no dyad, which are {", ".join(plane.modes)}')
    plane.set_ground()
    pivot = loop.joints_of(base)[0] if base != carrier else loop_input.hinge
    frame = pivot.parent if loop.link_of[pivot.parent] == base else pivot.child

    kinds = [value for key, value in plane.values.items() if key.startswith('dyads.')
             and key.endswith('.kind')]
    report = [f'base {frame}, driven {drive.name}'
              + (' (cylinder)' if loop_input.cylinder else '')
              + (f' against {loop.name_of(carrier)}' if carrier != base else '')
              + (f', dyads {" + ".join(kinds)}' if kinds else ''),
              f'axes parallel within {off:.2g} degrees']
    for joint in loop.joints:
        if joint.closes:
            away = joint.on_parent - joint.on_child
            report.append(f'closed at {joint.name}: gap {abs(plane.flat(away)):.3g} m in the '
                          f'plane, {abs(normal @ away):.3g} m square to it')
    if turn > 1e-3:
        report.append(f'note: open in the pose: links turn by up to {turn:.3g} degrees to close')
    if any(joint.limits and joint is not drive for joint in loop.joints):
        report.append('note: limits of passive joints are left out')
    report += plane.report
    has_masses, unweighed = _add_masses(plane, base, frame, report)
    has_points = _add_points(plane, base, report)

    # the robot's joints, each in the turn in which the file's pose has it
    scene = from_values(plane.values)
    motion = scene.linkage.motion(drive.coordinate, 0.0, 0.0)
    joints = {}
    for shown in scene.linkage.JOINTS:
        name = shown.name or shown.place
        joint = joints[name] = plane.joints[name]
        if joint.closes:                    # the tree has no such joint, which has a zero nowhere
            joint.ratio, joint.offset = 1.0, 0.0
        elif joint.kind != SLIDE:
            position = joint.ratio * getattr(motion, shown.coordinate.position) + joint.offset
            joint.offset += tau * round((joint.position - position) / tau)
    for name in plane.modes:
        report.append(f'loads of {name}: ' + ', '.join(
            f'{key} is at {joint.name}' for key, joint in joints.items()
            if key.startswith(f'{name}_')))
    start = drive.coordinate
    if drive.limits:
        lower, upper = drive.limits
        if lower > upper:
            raise Refused(f'{drive.name}: its lower limit, {lower:g}, is above the upper, '
                          f'{upper:g}')
        low, high = plane.values['linkage.range'] = sorted(
            (limit - drive.offset) / drive.ratio for limit in drive.limits)
        if not low <= start <= high:
            closed, start = scene.linkage.range_around(start), 0.5 * (low + high)
            report.append(f"note: the file's pose has {drive.name} outside its limits: "
                          'drive.start is in their middle')
            if not (scene.linkage.turns_fully or closed[0] <= start <= closed[1]):
                raise Refused(f"the loop opens between the file's pose and the limits of "
                              f'{drive.name}, so the mode there is not known: give a pose by --at '
                              'or --key')
    motor = gear or Coupling(drive.name, drive.name, 0.0, 1.0)
    if gear:
        report.append(f'{drive.name} is geared to {gear.motor}, which drives the scene')
    report += [f'note: the gear or mimic between {each.joint} and {each.motor} is left out'
               for each in loop.robot.couplings if each != gear
               and {each.joint, each.motor} & {joint.name for joint in loop.joints}]
    ground, turned = plane.links[base], loop.robot.poses[frame][:3, :3].T
    cosine, sine = ground.direction.real, ground.direction.imag
    axes = turned @ plane.axes.T @ [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]
    report.append(f'x of the scene is {_direction(axes[:, 0])} of {frame}, '
                  f'y is {_direction(axes[:, 1])}')
    # O1 on the ground, in the height of the driven joint
    moved = ground.origin - plane.flat(origin)
    origin = origin + plane.axes.T @ [moved.real, moved.imag, 0.0]
    frame_id = word(drive.name if drive.name in wishes.drive else loop.joints[0].name, 'loop')
    frame_id += '_plane'
    # a body of the file, as where describe wrote it, or the plane of another loop
    while frame_id in {*loop.robot.poses, *loop.robot.planes}:
        frame_id += '_2'
    loop.robot.planes.append(frame_id)
    values = {
        'frame_id': frame_id, 'frame.parent': frame,
        'frame.xyz': [*map(float, turned @ (origin - loop.robot.poses[frame][:3, 3]))],
        'frame.rpy': rpy_of(axes.T.tolist()),
        **plane.values,
        'drive.source': 'joint_state', 'drive.joint': motor.motor,
        'drive.joint_ratio': drive.ratio / motor.ratio,
        'drive.joint_offset': (drive.offset - motor.offset) / motor.ratio, 'drive.start': start,
        'joint_names': [joint.name for joint in joints.values()],
        'joint_states.ratios': [joint.ratio for joint in joints.values()],
        'joint_states.offsets': [joint.offset for joint in joints.values()],
        'joint_states.only_passive': gear is None,
        'joint_states.leave_out': [joint.name for joint in joints.values() if joint.closes],
        'outputs': ['joint_states', 'state', *['loads'] * has_masses, *['points'] * has_points]}
    scene = from_values(values)
    report += [f'note: {warning}' for warning in scene.warnings]
    return Imported(loop, values, scene, joints, drive, report, off, unweighed)


def _direction(axis: Array) -> str:
    """Return a unit vector in words: -x, or (0.6, 0, 0.8)."""
    index = int(np.argmax(np.abs(axis)))
    if abs(axis[index]) > 1.0 - 1e-9:
        return ('+' if axis[index] > 0.0 else '-') + 'xyz'[index]
    return f'({", ".join(f"{round(share, 12) + 0.0:.3g}" for share in axis)})'


def _add_points(plane: Plane, base: str, report: list[str]) -> bool:
    """Add frames on moving links as points, what links are called; return if there are any."""
    loop, robot = plane.loop, plane.loop.robot
    points: list[str] = []
    for first, link in plane.links.items():
        if first == base:
            continue
        called = loop.name_of(first)
        report += [f'{called} is called {link.name}'] * (called != link.name)
        report += [f'{body} is part of {link.name}' for body in robot.inertials
                   if loop.link_of[body] == first and body != called]
        for name, (body, centre) in robot.frames.items():
            if loop.link_of[body] == first:
                point = word(name, 'point')
                while point in points:
                    point += '_'
                points.append(point)
                plane.set_point(f'points.{point}', first, plane.flat(centre))
                beside = float(plane.axes[2] @ centre) - plane.height
                report.append(f'point {point} on {link.name}'
                              + f', the frame {name} of the file' * (point != name)
                              + (f': {abs(beside):.3g} m beside the plane of the driven joint, '
                                 'laid into it' if abs(beside) > CLOSED else ''))
    return bool(points)


def _add_masses(plane: Plane, base: str, frame: str, report: list[str]
                ) -> tuple[bool, Sequence[str]]:
    """Add the masses that links carry, and weight; return (if there are any, bodies that lack)."""
    loop, has_masses, weighed, unweighed = plane.loop, False, 0, list[str]()
    robot, normal, root = loop.robot, plane.axes[2], loop.link_of[loop.robot.root]
    for first, link in plane.links.items():
        carried = loop.carried_by(first) if first != base else set()
        if root in carried:
            report.append(f'note: the root of the robot hangs on {link.name}: that is not counted '
                          f'as its mass, and loads are right only while {frame} stands still')
            carried = {first}
        bodies = [body for body in robot.inertials if loop.link_of[body] in carried]
        inertials = [robot.inertials[body] for body in bodies]
        hanging = [body for body in bodies if loop.link_of[body] != first]
        if hanging:
            report.append(f'{link.name} carries, held as in the file: {", ".join(hanging)}')
        mass = sum(inertial.mass for inertial in inertials)
        lost = [body for body in robot.unweighed if loop.link_of[body] in carried]
        unweighed += lost
        weighed += mass > 0.0 and not lost
        if mass > 0.0:
            has_masses = True
            centre = np.sum([each.mass * each.centre for each in inertials], axis=0) / mass
            along, across = link.of(plane.flat(centre))
            inertia = sum(normal @ each.inertia @ normal
                          + each.mass * abs(plane.flat(each.centre - centre))**2
                          for each in inertials)
            plane.values |= {f'bodies.{link.name}.{name}': float(value) for name, value in (
                ('mass', mass), ('cg_along', along), ('cg_across', across), ('inertia', inertia))}
    report.append(f'masses on {weighed} of {len(loop.links) - 1} links')
    if unweighed:
        report.append(f'warning: loads are without the mass of meshes, which are not read, of '
                      f'{", ".join(unweighed)}: give <inertial> in the file')
    weight = plane.flat(robot.gravity) * plane.links[base].direction.conjugate()
    square = abs(float(normal @ robot.gravity))
    plane.values |= {'gravity.x': weight.real, 'gravity.y': weight.imag}
    if square > 1e-6:
        report.append(f'note: {square:.4g} m/s^2 of gravity are square to the plane, which the '
                      'pins bear: left out')
    if base != root:
        report.append(f"note: the robot moves the base {frame}: gravity is that of the file's "
                      'pose (base.topic)')
    return has_masses, unweighed


def _next_dyad(loop: Loop, plane: Plane) -> tuple[list[tuple[str, RobotJoint]], RobotJoint | None]:
    """Return ((link, joint on a solved link) twice, joint between them) of a dyad, or no joint."""
    for inner in loop.joints:
        ends = list[tuple[str, RobotJoint]]()
        for body in loop.ends(inner):
            on_solved = [joint for joint in loop.joints_of(body)
                         if loop.far(joint, body) in plane.links and joint is not inner]
            if body not in plane.links and len(on_solved) == 1:
                ends.append((body, on_solved[0]))
        if len(ends) == 2:
            return ends, inner
    return [], None
