"""
Which number goes into which field of which message, once, for the node and for recomputing a bag.

A value is named by its field in Motion or Loads.
"""
from __future__ import annotations

from math import nan
from operator import attrgetter

from .core import Loads, Motion

STATE_FIELDS = tuple(name for name in Motion._fields[:Motion._fields.index('condition') + 1]
                     if name != 'coupler_ratio')       # omega_beta says it
JOINTS = ('theta1', 'theta2', 'theta3', 'theta4')      # the order of the scene's joint_names
PASSIVE_EFFORT = 0.0                                   # frictionless joints

FIELDS = {
    'crank': {'position': 'theta1', 'velocity': 'omega1', 'acceleration': 'alpha1'},
    'output': {'position': 'theta4', 'velocity': 'omega4', 'acceleration': 'alpha4'},
    'state': {name: name for name in STATE_FIELDS},
    'loads': {name: name for name in Loads._fields},
    'shaking_wrench': {'wrench.force.x': 'shaking_force_x', 'wrench.force.y': 'shaking_force_y',
                       'wrench.torque.z': 'shaking_moment'},
    'joint_states': {'position': JOINTS,
                     'velocity': tuple(name.replace('theta', 'omega') for name in JOINTS),
                     'effort': ('driving_torque', None, None, None)},
}

# Where a value stands in the tuple (*Motion, *Loads).
PLACE = {name: i for i, name in enumerate(Motion._fields + Loads._fields)}


def expected(output, values):
    """Return {field: number or tuple of numbers} of one output message for values (*Motion, *Loads)."""
    def pick(source):
        if isinstance(source, tuple):
            return tuple(map(pick, source))
        return PASSIVE_EFFORT if source is None else values[PLACE[source]]

    return {field: pick(source) for field, source in FIELDS[output].items()}


def found(output, message):
    """Return the same fields as :func:`expected`, read from a message."""
    def plain(value):
        return tuple(value) if hasattr(value, '__len__') else value

    return {field: plain(attrgetter(field)(message)) for field in FIELDS[output]}


def crank_of(message, joint=''):
    """
    Return (position, velocity, acceleration) of the crank from a Motion or of a joint of a JointState.

    NaN for what the message does not have; None if it does not have the joint.
    """
    if not hasattr(message, 'name'):
        return message.position, message.velocity, message.acceleration
    try:
        i = message.name.index(joint)
        position = message.position[i]
    except (ValueError, IndexError):
        return None
    return position, message.velocity[i] if i < len(message.velocity) else nan, nan
