# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a kind states about its joints agrees with how its links move."""
from cmath import exp

from fourbar_ros import load_scene
from fourbar_ros.description.connections import connections_of
from fourbar_ros.mechanisms.curves import LinkMotion, point_of
from fourbar_ros.mechanisms.parts import GROUND
import numpy as np
from support import contract
from support.samples import more

EPS = 2.0**-52
STILL = LinkMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def errors(mechanism, given):
    """Yield |misfit| of angle [rad] and of place [m] at every joint."""
    motion = mechanism.motion(*given)
    links = {GROUND: STILL, **{link.name: mechanism.link_motion(motion, link.name)
                               for link in mechanism.LINKS}}
    for joint, its in zip(mechanism.JOINTS, connections_of(mechanism)):
        parent, child, q = links[its.parent], links[its.child], getattr(
            motion, joint.coordinate.position)
        turn = its.turn + (q if its.axis is None else 0.0)
        yield abs(complex(parent.cosine, parent.sine) * exp(1j * turn)
                  - complex(child.cosine, child.sine))
        along = np.array(its.on_parent) + (q * np.array(its.axis) if its.axis else 0.0)
        one, other = point_of(parent, *along), point_of(child, *its.on_child)
        yield np.hypot(one[0] - other[0], one[1] - other[1])


@contract.every_mechanism
def test_joints_connect_their_links(case, count=more(20, 200)):
    published = [(load_scene('andrews').linkage, (-0.06, 1.0, 0.0)),
                 (load_scene('jansen').linkage, (0.3, 1.0, 0.0))]
    for mechanism, given in [*contract.ordinary(case, 5, count),
                             *(published if case == contract.MACHINES else [])]:
        stages = len(getattr(mechanism, 'stages', [1]))
        assert len(connections_of(mechanism)) == len(mechanism.JOINTS)
        bound = 8.0 * EPS * max(1.0, mechanism.motion(*given).condition * max(
            1.0, *map(abs, mechanism.lengths))) * stages
        assert max(errors(mechanism, given)) <= bound, mechanism
