# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion that follows from torque: drives, springs, forces over a position, statics, flywheels.

>>> from fourbar_ros import load_scene
>>> from fourbar_ros.dynamics import Drive, MotorLine, simulate, System
>>> linkage = load_scene('paper').linkage
>>> run = simulate(System(linkage, 0.0, drive=Drive(MotorLine(400.0, 26.0))), until=1.0)
>>> run.status, f'{run.at(1.0).rate:.4f} rad/s'
('reached the end', '18.2322 rad/s')
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.dynamics.equation import Equation
    from fourbar_ros.dynamics.flywheel import Flywheel, flywheel_for
    from fourbar_ros.dynamics.run import (
        EVENT,
        LIMIT,
        NOT_CHECKED,
        NOT_CONVERGED,
        REACHED,
        Run,
        RunState,
        STOPPED,
        Stuck,
    )
    from fourbar_ros.dynamics.simulation import simulate
    from fourbar_ros.dynamics.sources import (
        ConstantTorque,
        DCMotor,
        Drive,
        InductionMotor,
        MotorLine,
        Shaft,
        SpeedController,
        TorqueTable,
    )
    from fourbar_ros.dynamics.statics import equilibria, Equilibrium, free_period
    from fourbar_ros.dynamics.system import System
    from fourbar_ros.mechanisms.elements import (
        Attachment,
        Distance,
        LinkAngle,
        PositionForce,
        Spring,
        TorsionSpring,
        Way,
    )
    from fourbar_ros.mechanisms.force_table import ForceTable

__getattr__, __dir__, __all__ = lazily(__name__)
