# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ours: one equation of motion, scipy's integrators, with and without the check of a run."""
from pathlib import Path
import sys

from common import problems, report

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from fourbar_ros import Applied, Bodies, Body, External, FourBar, SliderCrank  # noqa: E402, I100
from fourbar_ros.dynamics.model.elements import Attachment, Spring  # noqa: E402
from fourbar_ros.dynamics.model.system import System  # noqa: E402
from fourbar_ros.dynamics.solve.simulate import REACHED, simulate  # noqa: E402

KINDS = {'slider_crank': SliderCrank, 'four_bar': FourBar}
FIELDS = ('theta1', 'beta', 'slide')


def system_of(problem):
    """Return the System of a problem."""
    push, pull = problem.forces
    linkage = KINDS[problem.kind](
        *problem.lengths, bodies=Bodies(*(Body(*body) for body in problem.bodies)),
        gravity=tuple(problem.gravity), external=External(Applied(*push), Applied(*pull)))
    springs = []
    if problem.spring:
        on_crank, on_coupler, *rest = problem.spring
        springs = [Spring(Attachment('crank', on_crank), Attachment('coupler', on_coupler), *rest)]
    return System(linkage, problem.start[0], problem.rates[0], springs)


def runs(problem, system, tolerance, check):
    """Return the function that simulates and reads the watched coordinate."""
    def run():
        done = simulate(system, problem.until, tolerance, times=[problem.until], check=check)
        if check and done.status != REACHED:
            raise RuntimeError(done.status)
        position = done.position[-1]
        if not problem.watched:
            return position
        return getattr(system.mechanism.motion(position), FIELDS[problem.watched])
    return run


for problem in problems():
    system = system_of(problem)
    for tolerance in (1e-3, 1e-6, 1e-8, 1e-10, 1e-12):
        for name, check in (('fourbar_ros, checked', True), ('fourbar_ros, one run', False)):
            report(problem, name, f'{tolerance:.0e}', runs(problem, system, tolerance, check))
