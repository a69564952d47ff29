# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""MJCF as MuJoCo reads it: its defaults, includes, inertias and sites; meshes are not read."""
from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fourbar_ros.errors import nearest
from fourbar_ros.importing.robot import (
    angle_between,
    BALL,
    Coupling,
    FIXED,
    FREE,
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
import numpy as np

WITHOUT = 'extension', 'plugin', 'visual', 'collision', 'gazebo', 'transmission', 'ros2_control'


def spec_of(path: Path) -> tuple[Any, list[str]]:
    """
    Return MuJoCo's specification of an MJCF or URDF without shapes, and bodies of unknown mass.

    Their mass is that of meshes, which are not read.
    """
    import mujoco
    try:
        root = ElementTree.parse(path).getroot()
        if root.tag == 'robot':
            for old in root.findall('mujoco'):
                root.remove(old)
            ElementTree.SubElement(ElementTree.SubElement(root, 'mujoco'), 'compiler',
                                   fusestatic='false', balanceinertia='true')
        for parent in list(root.iter()):        # what neither moves nor weighs
            for child in [each for each in parent if each.tag in WITHOUT]:
                parent.remove(child)
        if root.find('.//include') is None:
            spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding='unicode'))
        else:
            spec = mujoco.MjSpec.from_file(str(path))
    except (ValueError, ElementTree.ParseError) as error:
        raise Refused(f'{path}: MuJoCo cannot read it: {" ".join(str(error).split())}') from None
    lost = set()
    for geom in list(spec.geoms):
        kinds = mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_HFIELD
        if geom.meshname or geom.type in kinds:
            if not geom.parent.explicitinertial and geom.parent.name != 'world' and geom.mass != 0:
                lost.add(geom.parent.name)
            spec.delete(geom)
    for group in (spec.meshes, spec.hfields, spec.textures, spec.materials, spec.skins,
                  spec.pairs):
        for item in list(group):
            spec.delete(item)
    for item in (*spec.geoms, *spec.sites):
        item.material = ''
    # it moves no body without
    spec.compiler.boundmass, spec.compiler.boundinertia = 1e-9, 1e-12
    return spec, sorted(lost)


def equality_name(model: Any, index: int) -> str:
    """Return the name of an equality constraint; of one without, those of its two bodies."""
    import mujoco
    kinds = mujoco.mjtObj
    name = mujoco.mj_id2name(model, kinds.mjOBJ_EQUALITY, index)
    if name or model.eq_obj2id[index] < 0:
        return name or f'equality_{index}'
    return '~'.join(mujoco.mj_id2name(model, int(model.eq_objtype[index]), int(item)) or str(item)
                    for item in (model.eq_obj1id[index], model.eq_obj2id[index]))


def read_mjcf(path: Path, key: str, at: Mapping[str, str]) -> Robot:
    """
    Return the robot of an MJCF in its zero pose or that of a key, joints of ``at`` moved.

    Raises Refused for a file that MuJoCo cannot read, or an unknown key or joint.
    """
    import mujoco
    spec, lost = spec_of(path)
    try:
        model = spec.compile()
    except ValueError as error:
        raise Refused(f'{path}: MuJoCo cannot read it: {" ".join(str(error).split())}') from None

    def name_of(kind: str, index: int) -> str:
        kinds = mujoco.mjtObj
        return (mujoco.mj_id2name(model, getattr(kinds, f'mjOBJ_{kind.upper()}'), index)
                or f'{kind}_{index}')

    bodies = [name_of('body', index) for index in range(model.nbody)]
    joints = [name_of('joint', index) for index in range(model.njnt)]
    data = mujoco.MjData(model)
    keys = [name_of('key', index) for index in range(model.nkey)]
    key = key or START * (START in keys)
    if key:
        if key not in keys:
            raise Refused(f'--key {key}: the file has no such key{nearest(key, keys)}')
        data.qpos[:] = model.key_qpos[keys.index(key)]
    kinds = {0: FREE, 1: BALL, 2: SLIDE, 3: PIN}
    for name, text in at.items():
        if name not in joints:
            raise Refused(f'--at {name}: the file has no such joint{nearest(name, joints)}')
        joint = joints.index(name)
        data.qpos[model.jnt_qposadr[joint]] = position_of(name, kinds[model.jnt_type[joint]], text)
    mujoco.mj_kinematics(model, data)
    robot = Robot('MJCF', bodies[0], model.opt.gravity.copy())
    if lost:
        robot.notes.append(f'mass of {", ".join(lost)} comes from meshes, which are not read')
    for index, name in enumerate(bodies):
        robot.poses[name] = pose_of(data.xmat[index].reshape(3, 3), data.xpos[index])
        if index:
            robot.add_inertial(name, float(model.body_mass[index]), pose_of(
                data.ximat[index].reshape(3, 3), data.xipos[index]),
                np.diag(model.body_inertia[index]))
    for index, body in enumerate(bodies[1:], 1):
        parent, first = bodies[model.body_parentid[index]], model.body_jntadr[index]
        count = model.body_jntnum[index]
        if not count:
            origin = data.xpos[index].copy()
            robot.joints.append(RobotJoint(f'{body} (fixed)', FIXED, parent, body, origin, origin))
        for joint in range(first, first + count):      # of several, with nothing between them
            child = body if joint == first + count - 1 else f'{body} ({joints[joint]})'
            robot.poses.setdefault(child, robot.poses[body])
            kind, anchor = kinds[int(model.jnt_type[joint])], data.xanchor[joint].copy()
            robot.joints.append(RobotJoint(
                joints[joint], kind, parent, child, anchor, anchor,
                data.xaxis[joint].copy() if kind in (PIN, SLIDE) else None,
                float(data.qpos[model.jnt_qposadr[joint]]), (
                    float(model.jnt_range[joint][0]), float(model.jnt_range[joint][1]))
                if model.jnt_limited[joint] else None))
            parent = child
    springs = [joints[index] for index in np.flatnonzero(model.jnt_stiffness)]
    left_out = [f'springs at {", ".join(springs)}'] if springs else []
    left_out += [text for text, values in (
        ('damping', model.dof_damping), ('friction', model.dof_frictionloss),
        ('armature', model.dof_armature)) if np.any(values)]
    if left_out:
        robot.notes.append(f'left out of the scenes: {"; ".join(left_out)} of joints')
    for index in range(model.neq):
        _equality(robot, model, data, index, name_of, bodies, joints)
    robot.add_fixed_bodies()
    closing = {site for index in range(model.neq)
               if int(model.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE)
               for site in (model.eq_obj1id[index], model.eq_obj2id[index])}
    for index in range(model.nsite):
        name = model.site(index).name
        if name and index not in closing:
            robot.frames[name] = bodies[model.site_bodyid[index]], data.site_xpos[index].copy()
    transmissions = mujoco.mjtTrn
    for index in range(model.nu):
        by, target = int(model.actuator_trntype[index]), int(model.actuator_trnid[index][0])
        if by in (transmissions.mjTRN_JOINT, transmissions.mjTRN_JOINTINPARENT):
            robot.drives.append(joints[target])
        elif by == transmissions.mjTRN_TENDON:
            start = model.tendon_adr[target]
            robot.drives += [joints[model.wrap_objid[wrap]]
                             for wrap in range(start, start + model.tendon_num[target])
                             if model.wrap_type[wrap] == mujoco.mjtWrap.mjWRAP_JOINT]
        else:
            how = ('is a slider-crank without bodies' if by == transmissions.mjTRN_SLIDERCRANK
                   else 'acts on no joint')
            robot.notes.append(f'actuator {name_of("actuator", index)} {how}: left out')
    return robot


def _equality(robot: Robot, model: Any, data: Any, index: int, name_of: Any, bodies: list[str],
              joints: list[str]) -> None:
    """Add an equality constraint of MuJoCo: a joint that closes a loop, a gear, or a note."""
    import mujoco
    kind, name = int(model.eq_type[index]), equality_name(model, index)
    first, second = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    numbers, equalities = model.eq_data[index], mujoco.mjtEq
    if not model.eq_active0[index]:
        robot.notes.append(f'equality {name} is not active: left out')
    elif kind == equalities.mjEQ_JOINT and second >= 0 and not np.any(numbers[2:5]):
        robot.couplings.append(Coupling(joints[first], joints[second], *map(float, numbers[:2])))
    elif kind in (equalities.mjEQ_CONNECT, equalities.mjEQ_WELD):
        if int(model.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE):
            points = [data.site_xpos[site].copy() for site in (first, second)]
            axes = [data.site_xmat[site].reshape(3, 3) for site in (first, second)]
            first, second = (int(model.site_bodyid[site]) for site in (first, second))
        else:                       # a weld has the point of the second body first
            near, far = numbers[0:3], numbers[3:6]
            if kind == equalities.mjEQ_WELD:
                near, far = far, near
            axes = [data.xmat[body].reshape(3, 3) for body in (first, second)]
            points = [data.xpos[body] + turned @ local
                      for body, turned, local in zip((first, second), axes, (near, far))]
            if kind == equalities.mjEQ_WELD:        # the second body's pose in the first
                relative = np.zeros(9)
                mujoco.mju_quat2Mat(relative, numbers[6:10])
                axes[0] = axes[0] @ relative.reshape(3, 3)
        robot.joints.append(RobotJoint(
            name, POINT if kind == equalities.mjEQ_CONNECT else FIXED, bodies[first],
            bodies[second], points[0], points[1], closes=True, turned=angle_between(*axes)))
    else:
        robot.notes.append(f'equality {name} is of another type: left out')
