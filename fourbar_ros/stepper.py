"""One linkage, one input after the other, with what the scene wants where it cannot be assembled."""
from __future__ import annotations

from math import nan, nextafter, pi, remainder, tau

from .core.status import INVALID_INPUT, OK, OUT_OF_RANGE, evaluate
from .records import PLACE

_RATES = [place for name, place in PLACE.items()
          if name.startswith(('omega', 'alpha', 'velocity_ratio', 'coupler_ratio', 'condition')) or place >= PLACE['f41_x']]


class Stepper:
    """
    Evaluates inputs of one linkage in order.

    Parameters
    ----------
    linkage : FourBar
    policy : str
        Out of range: 'nan' (nothing is known), 'hold' (the last good values again), or 'clamp' (the pose
        at the nearest limit; rates and loads are unbounded there, so NaN). The status says OUT_OF_RANGE
        in any case.

    """

    def __init__(self, linkage, policy='nan'):
        self.linkage, self._policy = linkage, policy
        self._good = None
        self._limits = None

    def step(self, theta1, omega1, alpha1, with_loads):
        """Return (status, values): values are (*Motion, *Loads)."""
        status, motion, loads = evaluate(self.linkage, theta1, omega1, alpha1, with_loads)
        values = (*motion, *loads)
        if self._policy == 'hold':
            if status == OK:
                self._good = values
            elif status in (OUT_OF_RANGE, INVALID_INPUT) and self._good:
                values = self._good
        elif self._policy == 'clamp' and status == OUT_OF_RANGE:
            values = self._at_limit(theta1)
        return status, values

    def _at_limit(self, theta1):
        if self._limits is None:
            self._limits = [_inside(self.linkage, end, toward) for low, high in self.linkage.input_ranges
                            for end, toward in ((low, high), (high, low))]
        nearest = min(self._limits, key=lambda limit: abs(remainder(theta1 - limit, tau)))
        _, motion, loads = evaluate(self.linkage, nearest, nan, nan, False)
        values = [*motion, *loads]
        for place in _RATES:
            values[place] = nan
        return tuple(values)


def _inside(linkage, end, toward):
    """Return the float nearest to the end of a range at which the linkage can be assembled."""
    while evaluate(linkage, end, 0.0, 0.0, False)[0] == OUT_OF_RANGE and abs(end) < 2.0 * pi:
        end = nextafter(end, toward)
    return end
