# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The search and the proof of some quantities, with the sample points made once per request.

Named quantities, and speeds and accelerations of points, are searched with exact derivatives,
functions of users by differences.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence

from fourbar_ros.extrema.difference_sampling import DifferenceSampler
from fourbar_ros.extrema.input_paths import input_paths, unresolved
from fourbar_ros.extrema.path_search import PathExtremum, search_path
from fourbar_ros.extrema.proof import NOT_PROVED, Proof, prove
from fourbar_ros.extrema.sampling import Sampler
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quantities import Asked, Function
from fourbar_ros.numerics.arrays import Array
import numpy as np

SAMPLES = 256       # points of a full turn, at least


class Search:
    """
    The search, and its proof, for some quantities of a mechanism at rate and acceleration.

    ``within``: lowest and highest input, see :func:`.input_paths`; ``paths``: those of the input;
    ``unresolved``: where their samples are not dense enough, in words.
    """

    def __init__(self, linkage: Mechanism, quantities: Sequence[Asked],
                 rates: tuple[float, float], within: tuple[float, float] | None = None) -> None:
        """Make samplers of the quantities, by complex steps and by differences."""
        self._linkage, self._quantities, self._rates = linkage, quantities, rates
        rough = [row for row, one in enumerate(quantities)
                 if isinstance(one, Function) and not one.is_smooth]
        smooth = [row for row in range(len(quantities)) if row not in rough]
        self._groups = [(kind(linkage, [quantities[row] for row in rows], rates), rows)
                        for kind, rows in ((Sampler, smooth), (DifferenceSampler, rough)) if rows]
        self.paths, self.unresolved = input_paths(linkage, SAMPLES, within), unresolved(linkage)

    def extrema(self, with_conditions: bool = True,
                more: Sequence[float] = ()) -> list[list[PathExtremum]]:
        """
        Return the extrema of each quantity, in the order of the quantities.

        ``with_conditions``: compute their condition numbers too, else NaN. ``more``: inputs of
        further samples, in the unit of the input.
        """
        found: list[list[PathExtremum]] = [[] for _ in self._quantities]
        for sampler, rows in self._groups:       # rows: where its quantities stand in the order
            for path in self.paths:
                for part in search_path(sampler, path, with_conditions, more):
                    found[rows[part.quantity]].append(part)
        return found

    def exact(self, quantity: int, x: Sequence[float]) -> Array:
        """Return a quantity at inputs, in the unit of the input, as :meth:`.Sampler.exact`."""
        sampler, rows = next(group for group in self._groups if quantity in group[1])
        return sampler.exact(np.array(x), np.full(len(x), rows.index(quantity)))

    def proved(self, found: list[list[PathExtremum]], with_conditions: bool,
               check: Callable[[float], None], seconds: float
               ) -> tuple[list[list[PathExtremum]], list[str], set[int]]:
        """
        Return the extrema and the text of the proof of each quantity, and whose are refuted.

        Extrema that contradict their proof are searched once more: between the ends of the parts
        in which the proof says that they are.
        ``found``: results of the search for each quantity; others as for :meth:`prove`.
        """
        proofs = self.prove(found, check, seconds)
        texts = [proof.verdict(part) for proof, part in zip(proofs, found)]
        wrong = {row for row, proof in enumerate(proofs)
                 if texts[row].startswith(NOT_PROVED) and not proof.why_not}
        if wrong:
            ends = [end for row in wrong for part in proofs[row].parts
                    for end in (part.low, part.high)]
            again = self.extrema(with_conditions, ends)
            for row in sorted(wrong):
                text = proofs[row].verdict(again[row])
                if not text.startswith(NOT_PROVED):
                    found[row], texts[row] = again[row], text
                    wrong.remove(row)
        return found, texts, wrong

    def prove(self, found: list[list[PathExtremum]], check: Callable[[float], None],
              seconds: float) -> list[Proof]:
        """Return a proof of each quantity, see :func:`fourbar_ros.extrema.proof.prove`."""
        return prove(self._linkage, self._quantities, self._rates, self.paths, found, check,
                     seconds)
