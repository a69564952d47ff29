# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What no parameter of a scene shows alone: checks of the scene as a whole."""
from __future__ import annotations

from typing import Any, NoReturn

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.contract import Contract

IN_WORDS = {1: 'one', 2: 'two', 3: 'three', 4: 'four', 5: 'five', 6: 'six', 7: 'seven', 8: 'eight'}


def check_link(name: str, link: str, linkage: Contract) -> None:
    """Refuse a link that the linkage does not have."""
    known = [its.name for its in linkage.LINKS]
    if link not in known:
        raise InvalidParameter(name, link, f'must be one of {", ".join(known)}')


def check_together(scene: Any) -> None:
    """Check what no parameter shows alone."""
    def refuse(name: str, why: str) -> NoReturn:
        value = scene.values[name]
        # NaN: not given
        raise InvalidParameter(name, value if value == value else None, why)

    if scene.needs_loads and scene.linkage.bodies is None:
        loads = [name for name, topic in scene.topics.items() if topic.needs_loads]
        refuse('bodies.crank.mass', f'must be given (or bodies.rods): output {loads[0]} needs '
                                    'masses')
    if not scene.frame_id:
        refuse('frame_id', 'must not be empty')
    names, count = scene.joint_names, len(scene.linkage.JOINTS)
    if len(names) != count or len(set(names)) != count or scene.joint_states.prefix in names:
        refuse('joint_names', f'must be {IN_WORDS.get(count, count)} different names, one for '
                              'each joint')
    for name in ('ratios', 'offsets'):
        if len(getattr(scene.joint_states, name)) != count:
            refuse(f'joint_states.{name}', f'must be {IN_WORDS.get(count, count)} numbers, one '
                                           'for each joint')
    if 0.0 in scene.joint_states.ratios:
        refuse('joint_states.ratios', 'must not be zero')
    if scene.drive.joint_ratio == 0.0:
        refuse('drive.joint_ratio', 'must not be zero')
    if len(set(scene.outputs)) != len(scene.outputs):
        refuse('outputs', 'names an output twice')
    if 'points' in scene.outputs and not scene.points:
        refuse('outputs', 'points: the scene has none; give points.NAME.link, .along, .across')
    if scene.dynamics and scene.wrenches.links:
        refuse(f'external.{scene.wrenches.links[0]}.from_topic', 'motion that follows from torque '
               'takes constant external forces only')
    if scene.drive.source == 'joint_state' and not scene.drive.joint:
        refuse('drive.joint', 'must name the joint that is the input')
