# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The search and the sample points for each quantity, chosen once per request.

quantity                       search                              proof
=============================  ==================================  ========================
omega4, alpha4 of a four-bar,  :mod:`.four_bar_rates.search`;      :mod:`.exact_count`
constant input rate            at a change point as the others
omega4 of it, any input        :mod:`.path_search`,                :mod:`.exact_count`
                               exact derivatives
others with a name             the same                            :mod:`.interval_proof`
functions                      the same, with differences          :mod:`.interval_proof`
=============================  ==================================  ========================
=======
=============================  ==================================================
quantity                       search
=============================  ==================================================
omega4, alpha4 of a four-bar,  :mod:`.four_bar_rates.search`; at a change point as
constant input rate            the others
others with a name             :mod:`.path_search`, exact derivatives
functions                      the same, with differences
=============================  ==================================================

The sample points are those of :mod:`.four_bar_rates.input_paths` for a four-bar, of
:mod:`.input_paths` for others.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import nan
from typing import TYPE_CHECKING

from fourbar_ros.extrema.difference_sampling import DifferenceSampler
from fourbar_ros.extrema.four_bar_rates.input_paths import input_paths as elliptic_paths
from fourbar_ros.extrema.four_bar_rates.paths import SAMPLES as RATE_SAMPLES
from fourbar_ros.extrema.four_bar_rates.search import at_rate, rate_extrema, RateExtrema
from fourbar_ros.extrema.input_paths import input_paths, InputPath
from fourbar_ros.extrema.path_search import PathExtremum, sampled_conditions, search_path
from fourbar_ros.extrema.sampling import Sampler, too_large
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quantities import Asked, Function, is_published
from fourbar_ros.numerics.roots import fold
import numpy as np

if TYPE_CHECKING:       # loaded when a proof is asked for
    from fourbar_ros.extrema.proof import Proof

SAMPLES = 256       # points of a full turn, at least
RATES = ('omega4', 'alpha4')


def has_fast_rates(linkage: Mechanism, names: Sequence[str], acceleration: float) -> bool:
    """Return whether :mod:`.batch` finds the extrema of these quantities of many linkages."""
    return isinstance(linkage, FourBar) and {*names} <= {*RATES} and not acceleration


class Methods:
    """The searches and proofs for some quantities of a mechanism at a rate and acceleration."""

    def __init__(self, linkage: Mechanism, quantities: Sequence[Asked],
                 rates: tuple[float, float]) -> None:
        """Sort the quantities: rates of a four-bar have a search and a proof of their own."""
        self._linkage, self._quantities, self._rates = linkage, quantities, rates
        self._is_four_bar = isinstance(linkage, FourBar)
        self._paths: dict[float, list[InputPath]] = {}
        countable = RATES[:1 if rates[1] else 2] if self._is_four_bar and rates[0] else ()
        self._exact = [row for row, quantity in enumerate(quantities)
                       if quantity.name in countable and is_published(quantity)]
        is_fast = len(countable) == 2 and linkage.change_point_margin > 0.0
        self._fast = self._exact if is_fast else []
        self._groups = self._samplers([row for row in range(len(quantities))
                                       if row not in self._fast])

    def paths(self, density: float = 1) -> list[InputPath]:
        """Return the paths of the input, with ``density`` times the usual number of points."""
        if density not in self._paths:
            linkage, count = self._linkage, int(density * SAMPLES)
            self._paths[density] = (elliptic_paths(linkage, count)
                                    if isinstance(linkage, FourBar) else
                                    input_paths(linkage, count))
        return self._paths[density]

    def _samplers(self, rows: list[int]) -> list[tuple[Sampler, list[int]]]:
        """Return samplers of the quantities ``rows``, by complex steps and by differences."""
        rough = [row for row, one in enumerate(self._quantities) if isinstance(one, Function)
                 and not one.is_smooth and row in rows]
        smooth = [row for row in rows if row not in rough]
        return [(self._sampler(kind, group), group)
                for kind, group in ((Sampler, smooth), (DifferenceSampler, rough)) if group]

    def _sampler(self, kind: type[Sampler], rows: list[int]) -> Sampler:
        return kind(self._linkage, [self._quantities[row] for row in rows], self._rates)

    def search(self, density: int = 1, with_conditions: bool = True,
               more: Sequence[float] = ()) -> list[list[PathExtremum]]:
        """
        Return the extrema of each quantity, with ``density`` times the usual samples.

        ``more``: inputs of further samples, in the unit of the input.
        """
        found: list[list[PathExtremum]] = [[] for _ in self._quantities]
        if self._fast:
            for part in self._rate_extrema(density, with_conditions):
                found[self._fast[part.row]].append(part)
        for sampler, rows in self._groups:
            for path in self.paths(density):
                for part in search_path(sampler, path, with_conditions, more):
                    found[rows[part.row]].append(part)
        return found

    def values_at(self, x: float) -> list[float]:
        """Return the quantities at an input in its unit, angles in the turn of the search."""
        found = [nan] * len(self._quantities)
        fast = [(self._sampler(Sampler, self._fast), self._fast)] if self._fast else []
        for sampler, rows in self._groups + fast:
            values = sampler.values(np.array([x]))[:, 0]
            if sampler.is_angle.any():
                beside = [sampler.along(path) for path in self.paths()]
                every = np.concatenate([samples.path.x for samples in beside])
                nearest = np.abs([self._linkage.distance(self._linkage.input_unit * one,
                                                         self._linkage.input_unit * x)
                                  for one in every.tolist()]).argmin()
                values = sampler.same_turn(
                    np.concatenate([samples.values for samples in beside], axis=1)[:, nearest],
                    values, np.arange(values.size))
            for row, value in zip(rows, values.tolist()):
                found[row] = value
        return found

    def _rate_extrema(self, density: int, with_conditions: bool) -> list[PathExtremum]:
        """
        Return the extrema of omega4 and alpha4 of a four-bar at constant input rate.

        It is the search that :mod:`.batch` uses for many linkages; ``row`` counts ``self._fast``.
        """
        assert isinstance(self._linkage, FourBar)
        both = rate_extrema(self._linkage, density * RATE_SAMPLES)   # at 1 rad/s
        orders = [RATES.index(self._quantities[row].name) for row in self._fast]
        parts = [both[order] for order in orders]
        found = RateExtrema(*map(np.concatenate, zip(*parts)))
        value, is_maximum = map(np.concatenate, zip(*[
            at_rate(part, self._rates[0], order) for part, order in zip(parts, orders)]))
        row = np.repeat(np.arange(len(parts)), [part.row.size for part in parts])
        inside = found.side == 0
        if np.isinf(value[inside]).any():
            raise too_large(self._rates)
        conditions = np.full((2, row.size), nan)
        if with_conditions:
            conditions[:, inside] = sampled_conditions(
                self._sampler(Sampler, self._fast), found.theta1[inside], row[inside],
                found.spacing[inside])
        columns = (row, fold(found.theta1), value, np.where(is_maximum, 1, -1), found.side,
                   np.zeros(row.size, bool), *conditions)
        return [PathExtremum(*fields) for fields in zip(*(v.tolist() for v in columns))]

    def proved(self, found: list[list[PathExtremum]], with_conditions: bool,
               check: Callable[[float], None], seconds: float
               ) -> tuple[list[list[PathExtremum]], list[str]]:
        """
        Return the extrema and the text of the proof of each quantity.

        Extrema that contradict their proof are searched once more: between the ends of the parts
        in which the proof says that they are.
        ``found``: results of the search for each quantity; others as for :meth:`prove`.
        """
        proofs = self.prove(found, check, seconds)

        verdicts = [proof.verdict(part) for proof, part in zip(proofs, found)]
        wrong = [row for row, verdict in enumerate(verdicts) if verdict.is_contradicted]
        if wrong:
            ends = [proofs[row].ends_of_parts for row in wrong]
            again = self.search(1, with_conditions, sum(ends, []))
            for row in wrong:
                verdict = proofs[row].verdict(again[row])
                if not verdict.is_contradicted:
                    found[row], verdicts[row] = again[row], verdict
        return found, [verdict.text for verdict in verdicts]

    def prove(self, found: list[list[PathExtremum]], check: Callable[[float], None],
              seconds: float) -> list[Proof]:
        """Return a proof of each quantity, see :func:`fourbar_ros.extrema.proof.prove`."""
        from fourbar_ros.extrema.proof import prove

        return prove(self._linkage, self._quantities, self._rates, self.paths(), found, check,
                     seconds)
