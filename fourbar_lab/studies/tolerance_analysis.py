# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
How bad tolerances make a design: by the first order, and in the corners of their box.

The box is centre +- size of every parameter that varies with ``uniform``, three deviations of
``normal``, all of a ``range``. The command draws designs from it besides: Monte Carlo.
"""
from collections import Counter
from dataclasses import replace
from itertools import product
from typing import NamedTuple

from fourbar_lab.studies.chunks import FEASIBLE, measured
from fourbar_lab.studies.derivatives import Derivatives, sensitivities, Sensitivity
from fourbar_lab.studies.measures import CLASS
from fourbar_lab.studies.results import Summary, summary
from fourbar_lab.studies.study import Study
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene.scene import from_values
import numpy as np

DEVIATIONS = 3.0
ALL_CORNERS = 8         # parameters; of more, only the corners where the first order is worst


class Toleranced(NamedTuple):
    """A measure in a box of tolerances."""

    sensitivity: Sensitivity            # in the middle of the box
    first_order: float                  # sum of |derivative| size; NaN if one is unknown
    corners: Summary                    # of those that can be built


def box_of(study: Study) -> dict[str, tuple[float, float]]:
    """Return {parameter: (centre, size)}; InvalidParameter for a list or a log_range."""
    box = {}
    for varied in study.vary:
        if varied.kind in ('list', 'log_range'):
            raise InvalidParameter(f'vary.{varied.name}', varied.kind,
                                   'is not a tolerance; use uniform, normal or range')
        low, high = centre, size = varied.values
        box[varied.name] = {'range': (0.5 * (low + high), 0.5 * (high - low)),
                            'uniform': (centre, size),
                            'normal': (centre, DEVIATIONS * size)}[varied.kind]
    return box


def tolerances(study: Study) -> tuple[list[Toleranced], dict[str, int]]:
    """
    Return a :class:`Toleranced` for each measure of a study but text, and {reason: corners}.

    Reasons of :mod:`.chunks`: feasible, cannot be built, failed. With many parameters (see
    :data:`ALL_CORNERS`) each measure with a first order has two corners: every parameter moves as
    its derivative rises, or the opposite way; if no measure has, all are largest, or least.
    InvalidParameter if the study has no box, or the design in its middle cannot be built or is a
    change point whose lengths vary: others are in another pose where it changes its side.
    """
    box = box_of(study)
    scene = from_values({**study.values, **{name: centre for name, (centre, _) in box.items()}})
    derivatives = Derivatives(scene, list(box), study.acceleration)
    for name, leaves in zip(box, derivatives.leaves_branch):
        if leaves and scene.linkage.change_point_margin == 0.0:
            raise InvalidParameter(f'vary.{name}', box[name][0], 'the middle is a change point, '
                                   'and with other lengths its mode is another branch')
    at_middle = sensitivities(derivatives, [measure for measure in study.measures
                                            if measure.part != CLASS])
    if len(box) <= ALL_CORNERS:
        signs = set(product((-1.0, 1.0), repeat=len(box)))
    else:
        worst = [tuple([1.0 if middle.by[name] >= 0.0 else -1.0 for name in box])
                 for middle in at_middle if not middle.why_unknown] or [(1.0,) * len(box)]
        signs = {*worst, *(tuple([-sign for sign in corner]) for corner in worst)}
    corners = {name: centre + size * sign for (name, (centre, size)), sign
               in zip(box.items(), np.array(sorted(signs)).T)}
    columns, reasons, _ = measured(replace(study, bounds=(), keeps_all=True), corners)
    is_known = np.array(reasons) == FEASIBLE
    return [Toleranced(
        middle, sum(abs(middle.by[name]) * size for name, (_, size) in box.items()),
        summary(middle.measure.name, middle.measure.unit, columns[middle.measure.name][is_known]))
        for middle in at_middle], dict(Counter(reasons))
