# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""MJCF as MuJoCo reads it: its defaults, includes, inertias and sites; meshes are not read."""
from itertools import count
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fourbar_ros.importing import robots
from fourbar_ros.importing.robots import pose_of, Refused
from fourbar_ros.scene.files import text_of
import numpy as np

WITHOUT = 'extension', 'plugin', 'visual', 'collision', 'gazebo', 'transmission', 'ros2_control'
LEAST = 2e-15       # [kg, kg m^2] of frames without mass: MuJoCo moves no body below 1e-15


def spec_of(path: Path) -> tuple[Any, list[str]]:
    """Return MuJoCo's specification of a file without meshes, and bodies of unknown mass."""
    # Their mass, or a part of it, is that of meshes, which are not read. Bodies and joints without
    # a name get one.
    import mujoco
    try:
        root = ElementTree.fromstring(text_of(path))
        _put_in_includes(root, path.parent, set())
        for model in root.iter('model'):        # text has no folder
            model.set('file', str((path.parent / model.get('file', '')).absolute()))
        if root.tag == 'robot':
            # as of balls, which MuJoCo always takes: mujoco_of() sets those of the file
            for inertia in root.iterfind('link/inertial/inertia'):
                mean = sum(float(inertia.get(name, '')) for name in ('ixx', 'iyy', 'izz')) / 3.0
                inertia.attrib = {'ixx': repr(mean), 'iyy': repr(mean), 'izz': repr(mean),
                                  'ixy': '0', 'ixz': '0', 'iyz': '0'}
            for old in root.findall('mujoco'):
                root.remove(old)
            ElementTree.SubElement(ElementTree.SubElement(root, 'mujoco'), 'compiler',
                                   fusestatic='false')
        for parent in list(root.iter()):        # what neither moves nor weighs
            for child in [each for each in parent if each.tag in WITHOUT]:
                parent.remove(child)
        spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding='unicode'))
    except (ValueError, ElementTree.ParseError) as error:
        raise Refused(f'{path}: MuJoCo cannot read it: {" ".join(str(error).split())}') from None
    lost = []
    for geom in list(spec.geoms):
        kinds = mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_HFIELD
        if geom.meshname or int(geom.type) in kinds:
            if _gives_mass(geom, spec.compiler) and geom.parent.name != 'world':
                lost.append(geom.parent)
            spec.delete(geom)
    if spec.compiler.settotalmass > 0.0 and lost:       # they have a share in all masses
        lost = [body for body in spec.bodies if body.name != 'world']
    for group in (spec.meshes, spec.hfields, spec.textures, spec.materials, spec.skins,
                  spec.pairs):
        for item in list(group):
            spec.delete(item)
    for item in (*spec.geoms, *spec.sites):
        item.material = ''
    for body in spec.bodies:        # it would take the least for what is below
        if body.explicitinertial and min(body.mass, *body.inertia) < 0.0:
            raise Refused(f'{body.name} has a negative mass or moment of inertia')
    compiler = spec.compiler
    compiler.boundmass, compiler.boundinertia = (
        max(bound, LEAST) for bound in (compiler.boundmass, compiler.boundinertia))
    for kind, items in (('body', spec.bodies), ('joint', spec.joints)):
        names = {item.name for item in items}
        for index, item in enumerate(items):
            item.name = item.name or next(name for name in (f'{kind}_{i}' for i in count(index))
                                          if name not in names)
            names.add(item.name)
    return spec, sorted({body.name for body in lost})


def _gives_mass(geom: Any, compiler: Any) -> bool:
    """Return whether MuJoCo would take a part of a body's mass from a shape."""
    import mujoco
    least, most = compiler.inertiagrouprange
    ways = mujoco.mjtInertiaFromGeom
    return (least <= geom.group <= most
            and (geom.density if np.isnan(geom.mass) else geom.mass) != 0.0
            and compiler.inertiafromgeom in (ways.mjINERTIAFROMGEOM_TRUE, *(
                [] if geom.parent.explicitinertial else [ways.mjINERTIAFROMGEOM_AUTO])))


def _put_in_includes(parent: ElementTree.Element, folder: Path, read: set[Path]) -> None:
    """Replace each <include> by what its file holds, in any encoding; each file once."""
    for index, child in reversed([*enumerate(parent)]):
        if child.tag == 'include':
            file = folder / child.get('file', '')
            if file in read:
                raise ValueError(f'{file} is included twice')
            read.add(file)
            included = ElementTree.fromstring(text_of(file))
            _put_in_includes(included, folder, read)
            parent[index:index + 1] = included
        else:
            _put_in_includes(child, folder, read)


def compiled(spec: Any, path: Path) -> Any:
    try:
        return spec.compile()
    except ValueError as error:
        raise Refused(f'{path}: MuJoCo cannot read it: {" ".join(str(error).split())}') from None


def equality_name(model: Any, index: int) -> str:
    """Return the name of an equality constraint; of one without, those of its two ends."""
    import mujoco
    ends = model.eq_obj1id[index], model.eq_obj2id[index]
    if (name := model.equality(index).name) or ends[1] < 0:
        is_of_joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) >= 0
        return f'{name or f"equality_{index}"}{"_equality" * is_of_joint}'
    kind = {int(mujoco.mjtEq.mjEQ_JOINT): mujoco.mjtObj.mjOBJ_JOINT,
            int(mujoco.mjtEq.mjEQ_TENDON): mujoco.mjtObj.mjOBJ_TENDON,
            }.get(int(model.eq_type[index]), model.eq_objtype[index])
    return '~'.join(mujoco.mj_id2name(model, int(kind), int(end)) or str(end) for end in ends)


def read_mjcf(path: Path, wishes: robots.Wishes) -> robots.Robot:
    """Return the robot of an MJCF in its zero pose or that of a key; raises Refused."""
    import mujoco
    spec, lost = spec_of(path)
    model = compiled(spec, path)

    def names_of(kind: str, count: int) -> list[str]:
        return [getattr(model, kind)(index).name or f'{kind}_{index}' for index in range(count)]

    bodies, joints = names_of('body', model.nbody), names_of('joint', model.njnt)
    keys, data = names_of('key', model.nkey), mujoco.MjData(model)
    if key := wishes.pose_of(keys, 'key'):
        data.qpos[:] = model.key_qpos[keys.index(key)]
    kinds = [(robots.FREE, robots.BALL, robots.SLIDE, robots.PIN)[kind]
             for kind in model.jnt_type]
    for name, position in wishes.positions(dict(zip(joints, kinds))).items():
        data.qpos[model.jnt_qposadr[joints.index(name)]] = position
    mujoco.mj_kinematics(model, data)
    has_gravity = not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    robot = robots.Robot('MJCF', bodies[0], model.opt.gravity * has_gravity, unweighed=lost)
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
            robot.joints.append(robots.RobotJoint(f'{body} (fixed)', robots.FIXED, parent, body,
                                                  origin, origin))
        for joint in range(first, first + count):      # of several, with nothing between them
            child = body if joint == first + count - 1 else f'{body} ({joints[joint]})'
            robot.poses.setdefault(child, robot.poses[body])
            anchor, (low, high) = data.xanchor[joint].copy(), map(float, model.jnt_range[joint])
            robot.joints.append(robots.RobotJoint(
                joints[joint], kinds[joint], parent, child, anchor, anchor,
                data.xaxis[joint].copy() if kinds[joint] in (robots.PIN, robots.SLIDE) else None,
                float(data.qpos[model.jnt_qposadr[joint]]),
                (low, high) if model.jnt_limited[joint] else None))
            parent = child
    springs = [joints[index] for index in np.flatnonzero(model.jnt_stiffness)]
    left_out = [f'springs at {", ".join(springs)}'] if springs else []
    left_out += [text for text, values in (
        ('damping', model.dof_damping), ('friction', model.dof_frictionloss),
        ('armature', model.dof_armature)) if np.any(values)]
    if left_out:
        robot.notes.append(f'left out of the scenes: {"; ".join(left_out)} of joints')
    if np.any(model.body_gravcomp):
        robot.notes.append('left out of the scenes: gravcomp of bodies, which have their weight')
    closing = {site for index in range(model.neq)
               for site in _add_equality(robot, model, data, index, bodies, joints)}
    robot.add_fixed_bodies()
    for index in range(model.nsite):
        name = model.site(index).name
        if name and index not in closing:
            robot.frames[name] = bodies[model.site_bodyid[index]], data.site_xpos[index].copy()
    transmissions = mujoco.mjtTrn
    for index, name in enumerate(names_of('actuator', model.nu)):
        by, target = int(model.actuator_trntype[index]), int(model.actuator_trnid[index][0])
        if by in (transmissions.mjTRN_JOINT, transmissions.mjTRN_JOINTINPARENT):
            robot.drives.append(joints[target])
        elif by == transmissions.mjTRN_TENDON:
            start = model.tendon_adr[target]
            robot.drives += [joints[model.wrap_objid[wrap]]
                             for wrap in range(start, start + model.tendon_num[target])
                             if int(model.wrap_type[wrap]) == mujoco.mjtWrap.mjWRAP_JOINT]
        else:
            how = ('is a slider-crank without bodies' if by == transmissions.mjTRN_SLIDERCRANK
                   else 'acts on no joint')
            robot.notes.append(f'actuator {name} {how}: left out')
    return robot


def _add_equality(robot: robots.Robot, model: Any, data: Any, index: int, bodies: list[str],
                  joints: list[str]) -> tuple[int, ...]:
    """Add an equality of MuJoCo: a closing joint, a gear, or a note; return the sites it has."""
    import mujoco
    kind, name, kinds = int(model.eq_type[index]), equality_name(model, index), mujoco.mjtEq
    first, second = ends = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    values, is_weld = model.eq_data[index], kind == kinds.mjEQ_WELD
    has_sites = int(model.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE)
    off = mujoco.mjtDisableBit
    are_off = model.opt.disableflags & (off.mjDSBL_EQUALITY | off.mjDSBL_CONSTRAINT)
    if are_off or not model.eq_active0[index]:
        robot.notes.append(f'equality {name} is not active: left out')
    elif kind == kinds.mjEQ_JOINT and second >= 0 and not np.any(values[2:5]):
        # MuJoCo counts both from the positions that the file calls ref
        of_first, of_second = model.qpos0[model.jnt_qposadr[[first, second]]]
        offset, ratio = values[:2]
        robot.couplings.append(robots.Coupling(
            joints[first], joints[second], float(of_first + offset - ratio * of_second),
            float(ratio)))
    elif is_weld or kind == kinds.mjEQ_CONNECT:
        if has_sites:
            poses = [pose_of(data.site_xmat[site].reshape(3, 3), data.site_xpos[site])
                     for site in ends]
            first, second = (int(model.site_bodyid[site]) for site in ends)
        else:                       # a weld has the point of the second body first
            relative = np.zeros(9)
            mujoco.mju_quat2Mat(relative, values[6:10])     # the second body's pose in the first
            points = (values[3:6], values[0:3]) if is_weld else (values[0:3], values[3:6])
            poses = [robot.poses[bodies[body]] @ pose_of(turn, point)
                     for body, turn, point in zip(ends, (
                         relative.reshape(3, 3) if is_weld else np.eye(3), np.eye(3)), points)]
        robot.add_closing(name, robots.FIXED if is_weld else robots.POINT,
                          (bodies[first], bodies[second]), poses)
    else:
        robot.notes.append(f'equality {name} is of another type: left out')
    return ends if has_sites else ()
