# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
MuJoCo: a tree of joints whose loop its connect constraint closes, the Runge-Kutta method.

Bodies without mass or inertia get the least that it takes.
"""
from common import problems, report
import mujoco
import numpy as np

LEAST = 1e-9        # kg, kg m^2


def link(name, at, joint, body, inside=''):
    mass, along, across, inertia = (max(value, LEAST) if i in (0, 3) else value
                                    for i, value in enumerate(body))
    axis = '1 0 0" type="slide' if joint == 'slide' else '0 0 1'
    return f"""
<body name="{name}" pos="{at!r} 0 0"><joint name="{name}" axis="{axis}"/>
  <inertial pos="{along!r} {across!r} 0" mass="{mass!r}"
            diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>{inside}
</body>"""


def site(name, along):
    return f'<site name="{name}" pos="{along!r} 0 0"/>'


def model_of(problem, dt, hardest):
    """Return the model of a problem for steps of a length [s]."""
    a1, a2, *others = problem.lengths
    crank, coupler, output = problem.bodies
    on_crank, on_coupler, k, free, damping = problem.spring or (0.0, 0.0, 0.0, 0.0, 0.0)
    is_slider = problem.kind == 'slider_crank'
    end = 0.0 if is_slider else others[0]
    tree = (link('crank', 0.0, 'hinge', crank, site('one', on_crank) + link(
        'coupler', a1, 'hinge', coupler, site('coupler', a2) + site('two', on_coupler)))
        + link('output', 0.0 if is_slider else others[1], 'slide' if is_slider else 'hinge',
               output, site('output', end)))
    tendon = (f'<tendon><spatial springlength="{free!r}" stiffness="{k!r}" damping="{damping!r}">'
              '<site site="one"/><site site="two"/></spatial></tendon>' if problem.spring else '')
    solver = f'solref="{2.0 * dt!r} 1" solimp="0.9999 0.9999 0.001 0.5 2"' if hardest else ''
    return mujoco.MjModel.from_xml_string(f"""
<mujoco><compiler angle="radian"/>
<option gravity="{problem.gravity[0]!r} {problem.gravity[1]!r} 0" timestep="{dt!r}"
        integrator="RK4" iterations="50" tolerance="0"/>
<worldbody>{tree}</worldbody>{tendon}
<equality><connect site1="coupler" site2="output" {solver}/></equality></mujoco>""")


def runs(problem, steps, hardest):
    """Return the function that takes so many steps and reads the watched coordinate."""
    model = model_of(problem, problem.until / steps, hardest)
    data = mujoco.MjData(model)
    (x, b, y), (dx, db, dy) = problem.start, problem.rates

    def run():
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = (x, b - x, y), (dx, db - dx, dy)
        for name, force in zip(('coupler', 'output'), problem.forces):
            data.xfrc_applied[model.body(name).id, :2] = force      # at its centre of gravity
        mujoco.mj_step(model, data, steps)
        warnings = data.warning[mujoco.mjtWarning.mjWARN_BADQACC]
        if warnings.number or not np.isfinite(data.qpos).all():
            raise RuntimeError('the simulation became unstable')
        q = data.qpos
        return (q[0], q[0] + q[1], q[2])[problem.watched]
    return run


for problem in problems():
    for steps in (500, 2000, 8000, 32000, 128000):
        for name, hardest in (('MuJoCo, default softness', False), ('MuJoCo, hardest', True)):
            report(problem, name, f'{steps} steps', runs(problem, steps, hardest))
