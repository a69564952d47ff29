# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
An imported loop beside MuJoCo: joints from its constraints, the drive from its inverse dynamics.

MuJoCo keeps constraints by springs when it simulates; here Newton's method solves them tightly, by
their own Jacobian, from beside the scene's answer. The drive follows by virtual work from the
forces that all joints of the tree need, at a rate and an acceleration.
"""
from collections.abc import Collection
from math import pi, tau
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros.importing import machine, mjcf, robots
from fourbar_ros.numerics.arrays import Array
import numpy as np

SAMPLES, RATE, ACCELERATION = 41, 2.0, 3.0      # over the range [rad/s or m/s, and per s]
MARGIN, STEP = 0.01, 1e-4                       # shares of the range: at its ends, of differences
BESIDE = 0.02                                   # [rad], and share of the size: where Newton begins
SAME_JOINT, SAME_DRIVE = 1e-6, 1e-5             # [rad, m] and share of the peak that are good


class Checked(NamedTuple):
    """The largest differences: of joints [rad, m] and which, of the drive as share of its peak."""

    low: float                  # of the driven joint [rad or m]
    high: float
    joint: float
    which: str
    drive: float | None         # None without masses
    peak: float                 # [N m or N]
    driven: str                 # joint
    peak_at: float              # of the driven joint, where the peak is [rad or m]
    is_slide: bool

    @property
    def is_good(self) -> bool:
        return self.joint < SAME_JOINT and (self.drive or 0.0) < SAME_DRIVE

    def __str__(self) -> str:
        unit, of_drive = ('m', 'N') if self.is_slide else ('rad', 'N m')
        loads = ('no masses' if self.drive is None else
                 f'drive within {self.drive * self.peak:.1e} {of_drive}, {self.drive:.1e} of its '
                 f'peak {self.peak:.4g} {of_drive} at {self.driven} = {self.peak_at:.4g} {unit}')
        return (f'beside MuJoCo from {self.low:.4g} to {self.high:.4g} {unit}: joints within '
                f'{self.joint:.1e} ({self.which}), {loads}')


def check(model: Any, qpos: Array, loop: machine.Imported, cut: Collection[str] = ()) -> Checked:
    """Return how far a loop's scene is from MuJoCo over its range, in motion."""
    # model: an MjModel in which equality constraints close the loops; qpos: the file's pose; cut:
    # equalities that are left out.
    import mujoco
    scene, drive, data = loop.scene, loop.drive, mujoco.MjData(model)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    model.opt.disableflags |= (mujoco.mjtDisableBit.mjDSBL_CONTACT
                               | mujoco.mjtDisableBit.mjDSBL_LIMIT)
    data.eq_active[:] = [
        int(model.eq_type[index]) in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD)
        and mjcf.equality_name(model, index) not in cut for index in range(model.neq)]
    mechanism, is_slide = scene.linkage, drive.kind == robots.SLIDE
    # (joint, name of its coordinate) of the passive joints that the file has; they stand in the
    # order of the mechanism's joints
    joints = [(joint, shown.coordinate.position) for joint, shown in zip(
        loop.joints.values(), mechanism.JOINTS) if not joint.closes and joint is not drive]
    turns = np.array([joint.kind != robots.SLIDE for joint, _ in joints])
    beside_answer = BESIDE * np.where(turns, 1.0, loop.loop.size())
    # where joints stand in qpos and among the degrees of freedom
    in_mujoco = [model.joint(joint.name) for joint, _ in joints]
    positions = [int(joint.qposadr[0]) for joint in in_mujoco]
    passive = [int(joint.dofadr[0]) for joint in in_mujoco]
    driven = model.joint(drive.name)

    def constraints() -> tuple[Array, Array]:
        """Return (Jacobian, residuals) of the constraints on the loop's joints, in qpos."""
        mujoco.mj_fwdPosition(model, data)
        equal = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        jacobian = data.efc_J.reshape(-1, model.nv)[equal]
        acts = np.any(np.abs(jacobian[:, passive]) > 1e-12, axis=1)
        return jacobian[acts], data.efc_pos[equal][acts]

    def expected(position: float) -> Array:
        """Return the passive joints as the scene has them."""
        motion = mechanism.motion(position, 0.0, 0.0)
        return np.array([joint.ratio * getattr(motion, name) + joint.offset
                         for joint, name in joints])

    def solved(position: float) -> tuple[Array, Array]:
        """Return (passive joints, rates of all degrees of freedom per that of the drive)."""
        # by Newton's method on MuJoCo's constraints, from beside what the scene says
        data.qpos[:] = qpos
        data.qpos[driven.qposadr] = drive.ratio * position + drive.offset
        data.qpos[positions] = expected(position) + beside_answer
        for _ in range(50):
            jacobian, residuals = constraints()
            step = np.linalg.lstsq(jacobian[:, passive], -residuals, rcond=1e-10)[0]
            data.qpos[positions] += step * min(1.0, 0.2 / max(np.max(np.abs(step)), 1e-12))
            if np.max(np.abs(step)) < 1e-15:
                break
        jacobian, _ = constraints()
        rates = np.zeros(model.nv)
        rates[driven.dofadr] = 1.0
        rates[passive] = np.linalg.lstsq(jacobian[:, passive], -jacobian[:, driven.dofadr[0]],
                                         rcond=1e-10)[0]
        return data.qpos[positions].copy(), rates

    start = scene.drive.start
    low, high = ((start - pi, start + pi) if mechanism.turns_fully else
                 mechanism.range_around(start))
    low, high = low + MARGIN * (high - low), high - MARGIN * (high - low)
    apart, far, peak, peak_at = [], [], 0.0, 0.0       # of joints and drive at each position
    step = STEP * (high - low)
    for position in map(float, np.linspace(low, high, SAMPLES)):
        away = solved(position)[0] - expected(position)
        away[turns] = (away[turns] + pi) % tau - pi
        apart.append(np.abs(away))
        if mechanism.bodies is None:
            continue
        # d rates / d (driven joint of the file), by a difference of fourth order
        beside = {shift: solved(position + shift * step)[1] for shift in (-2, -1, 1, 2)}
        bend = (8.0 * (beside[1] - beside[-1]) - (beside[2] - beside[-2])) / (
            12.0 * step * drive.ratio)
        _, rates = solved(position)
        rate = drive.ratio * RATE
        data.qvel[:] = rates * rate
        data.qacc[:] = bend * rate**2 + rates * drive.ratio * ACCELERATION
        mujoco.mj_fwdVelocity(model, data)
        forces = np.zeros(model.nv)
        mujoco.mj_rne(model, data, 1, forces)
        _, loads = mechanism.step(position, RATE, ACCELERATION)
        theirs = drive.ratio * float(rates @ forces)
        far.append(abs(theirs - getattr(loads, mechanism.drive_load)))
        if abs(theirs) > peak:
            peak, peak_at = abs(theirs), drive.ratio * position + drive.offset
    low, high = sorted(drive.ratio * end + drive.offset for end in (low, high))
    # the largest: NaN, if one is
    of_joints = np.max(apart, axis=0)
    which, worst = joints[int(np.argmax(of_joints))][0].name, float(np.max(of_joints))
    drive_off = float(np.max(far)) / (peak or 1.0) if far else None
    return Checked(low, high, worst, which, drive_off, peak, drive.name, peak_at, is_slide)


def mujoco_of(path: Path, robot: robots.Robot) -> tuple[Any, Array]:
    """Return MuJoCo's own model of a file and its joints in the robot's pose."""
    # MuJoCo reads URDF too, but for its loops: those get equality constraints.
    import mujoco
    spec = mjcf.spec_of(path)[0]
    for joint in robot.joints:
        if robot.format != 'URDF' or not joint.closes:
            continue
        is_weld = joint.kind == robots.FIXED
        equality = spec.add_equality(
            name=joint.name, objtype=mujoco.mjtObj.mjOBJ_SITE,
            type=mujoco.mjtEq.mjEQ_WELD if is_weld else mujoco.mjtEq.mjEQ_CONNECT)
        for body, point in ((joint.parent, joint.on_parent), (joint.child, joint.on_child)):
            pose, quaternion = robot.poses[body], np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, pose[:3, :3].T.ravel())
            spec.body(body).add_site(name=f'{joint.name} on {body}', quat=quaternion,
                                     pos=pose[:3, :3].T @ (point - pose[:3, 3]))
        equality.name1, equality.name2 = (f'{joint.name} on {body}'
                                          for body in (joint.parent, joint.child))
        if is_weld:
            equality.data[:11] = [0.0] * 6 + [1.0, 0.0, 0.0, 0.0, 1.0]
    model = mjcf.compiled(spec, path)
    model.opt.gravity[:] = robot.gravity
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    # MuJoCo up to 3.12 leaves out the rpy of inertias in URDF, its issue 3559, and takes neither
    # moments of 0, as of rods, nor those of no body
    for name, inertial in robot.inertials.items() if robot.format == 'URDF' else ():
        body, axes = model.body(name), robot.poses[name][:3, :3]
        body.inertia[:], turn = np.linalg.eigh(axes.T @ inertial.inertia @ axes)
        turn[:, 2] = np.cross(turn[:, 0], turn[:, 1])
        mujoco.mju_mat2Quat(body.iquat, turn.ravel())
        model.body_sameframe[body.id] = int(mujoco.mjtSameFrame.mjSAMEFRAME_NONE)
    pose = model.qpos0.copy()
    for joint in robot.joints:
        index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint.name)
        if index >= 0 and joint.kind in (robots.PIN, robots.SLIDE):
            pose[model.jnt_qposadr[index]] = joint.position
    return model, pose
