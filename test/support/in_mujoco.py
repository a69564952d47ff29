# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes released in MuJoCo, whose loops are soft constraints: accelerations beside ours."""
from fourbar_ros.description.formats import describe
from fourbar_ros.dynamics.equation import Equation
import numpy as np

POSES = 12


def differences(scene, drive, impedance=0.9999):
    """
    Yield (largest difference, largest size) of joint accelerations, pose by pose, from rest.

    At rest, because MuJoCo leaves the rate of the constraints' Jacobian out. ``drive``: torque or
    force on the input. ``impedance``: of the constraints; what is missing to 1 is their softness.
    """
    import mujoco

    model = mujoco.MjModel.from_xml_string(describe(scene, 'mjcf'))
    model.eq_solimp[:, :2] = impedance
    data, equation = mujoco.MjData(model), Equation(scene.bare_linkage)
    low, high = scene.linkage.input_ranges[0]
    for share in (np.arange(POSES) + 0.5) / POSES:
        position = float(low + (high - low) * (0.1 + 0.8 * share))
        acceleration = equation.acceleration(position, 0.0, drive)
        motion = scene.linkage.motion(position, 0.0, acceleration)
        pairs = [(name, joint) for name, joint in zip(scene.joint_names, scene.linkage.JOINTS)
                 if _has(model, name)]
        mujoco.mj_resetData(model, data)
        for name, joint in pairs:
            data.joint(name).qpos[0] = getattr(motion, joint.coordinate.position)
        data.ctrl[0] = drive
        mujoco.mj_forward(model, data)
        ours = np.array([getattr(motion, joint.coordinate.acceleration) for _, joint in pairs])
        theirs = np.array([data.joint(name).qacc[0] for name, _ in pairs])
        yield float(np.abs(ours - theirs).max()), float(np.abs(ours).max())


def worst(scene, drive, impedance=0.9999):
    """Return the largest difference over the largest acceleration of its pose."""
    return max(error / size for error, size in differences(scene, drive, impedance))


def _has(model, name):
    return any(model.joint(i).name == name for i in range(model.njnt))
