# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Verbs of the ``fourbar`` command that a desk needs: an entry point for each in setup.py."""
from argparse import Namespace

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.scene.scene import load, Scene


def asked(arguments: Namespace) -> tuple[Scene, Mechanism, float]:
    """Return the scene, its linkage in the mode asked for, and the speed of the input."""
    from fourbar_lab.drawing.views import driven_linkage
    scene = load(arguments.scene)
    driven = driven_linkage(scene, arguments.speed, arguments.acceleration, arguments.mode,
                            getattr(arguments, 'at', None))
    return scene, driven.linkage, driven.rate
