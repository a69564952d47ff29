# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Studies: many designs of one scene, drawn, computed on an executor, kept as Parquet, ranked.

>>> from fourbar_lab.studies import compute, study_of
>>> study = study_of({'scene': 'paper', 'rows': 64, 'quantities': ['shaking_force.max'],
...                   'vary': {'linkage.a1': {'range': [0.3, 0.5]}}})
>>> found = compute(study, chunk=0).columns            # a chunk needs no folder
>>> best = found['shaking_force.max'].argmin()
>>> f"{found['shaking_force.max'][best]:.1f} N at {found['linkage.a1'][best]:.4f} m"
'1400.6 N at 0.3030 m'
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_lab.studies.chunks import Chunk, compute
    from fourbar_lab.studies.derivatives import Derivatives, sensitivities, Sensitivity
    from fourbar_lab.studies.duals import derivatives_of
    from fourbar_lab.studies.engine import cluster, processes, run
    from fourbar_lab.studies.many import Extrema, find_extrema_many
    from fourbar_lab.studies.results import Results, Summary
    from fourbar_lab.studies.study import from_document as study_of
    from fourbar_lab.studies.study import read as read_study
    from fourbar_lab.studies.study import Study, StudyError
    from fourbar_lab.studies.tolerance_analysis import Toleranced, tolerances

__getattr__, __dir__, __all__ = lazily(__name__)
