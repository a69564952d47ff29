# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a kind states about its joints agrees with how its links move."""
from cmath import exp

from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.mechanisms.points import LinkMotion, point_of
import numpy as np
import pytest
from support import contract
from support.machines import andrews, jansen
from support.random_machines import random_machines
from support.samples import more

EPS = 2.0**-52
STILL = LinkMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def errors(mechanism, given):
    """Yield |misfit| of angle [rad] and of place [m] at every joint."""
    motion = mechanism.motion(*given)
    links = {GROUND: STILL, **{link.name: mechanism.link_motion(motion, link.name)
                               for link in mechanism.LINKS}}
    for joint, its in zip(mechanism.JOINTS, mechanism.connections):
        parent, child, q = links[its.parent], links[its.child], getattr(
            motion, joint.coordinate.position)
        turn = its.turn + (q if its.axis is None else 0.0)
        yield abs(complex(parent.cosine, parent.sine) * exp(1j * turn)
                  - complex(child.cosine, child.sine))
        along = np.array(its.on_parent) + (q * np.array(its.axis) if its.axis else 0.0)
        one, other = point_of(parent, *along), point_of(child, *its.on_child)
        yield np.hypot(one[0] - other[0], one[1] - other[1])


@pytest.mark.parametrize('case', contract.CASES, ids=contract.name_of)
def test_joints_connect_their_links(case):
    for mechanism, given in contract.ordinary(case, 5, 20):
        assert len(mechanism.connections) == len(mechanism.JOINTS)
        bound = 8.0 * EPS * mechanism.motion(*given).condition * max(
            1.0, *map(abs, mechanism.lengths))
        assert max(errors(mechanism, given)) <= max(bound, 8.0 * EPS)


def test_joints_of_machines_connect_their_links(count=more(20, 200)):
    kinds = set()
    for machine, given in [*random_machines(7, count), (andrews()[0], (-0.06, 1.0, 0.0)),
                           (jansen(), (0.3, 1.0, 0.0))]:
        motion = machine.motion(*given)
        kinds |= {dyad.kind for dyad in machine.stages}
        size = max(1.0, *map(abs, machine.lengths))
        bound = 64.0 * EPS * size * max(1.0, motion.condition) * len(machine.stages)
        assert len(machine.connections) == len(machine.JOINTS)
        assert max(errors(machine, given)) <= bound, machine
    assert kinds == {'RRR', 'RRP', 'RPR', 'RPP', 'PRP'}
