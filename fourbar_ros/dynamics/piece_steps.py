# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps that end where a piece of a force table does: in the input, not in time.

Between two ends of pieces (:mod:`fourbar_ros.mechanisms.pieces`) the equation of motion is smooth.
While the input q moves one way it can be the variable instead of the time,

    d time/dq = 1/w        dw/dq = (dw/dt) / w        dz/dq = (dz/dt) / w              (ST1)

w its rate, z the other states, and a step ends exactly at the end of a piece, without a search.
"""
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import copysign, floor, inf, nextafter
from typing import Any, NamedTuple

from fourbar_ros.dynamics.coordinate import MotionCoordinate
from fourbar_ros.dynamics.equation import REACH
from fourbar_ros.numerics.arrays import Array, EPS
import numpy as np

BESIDE = 1e-12         # [rad] distance from the ends of a piece, ...
ROUNDED = 8.0 * EPS    # ... and over the input: within it either side may be meant
FARTHEST = 1e6         # [rad] at most: an end of a piece is known to its rounding
MOST_CHANGED = 2.0     # rate over that at the start of a piece, or that over it, at most
ITERATIONS = 5         # of Newton's method to the input at a time between steps


class PieceAhead(NamedTuple):
    """What is left of a piece of the tables: inputs, all just beside its ends."""

    low: float         # between these it is smooth
    high: float
    beyond: float      # in the next one


class InputStep(NamedTuple):
    """A step in the input."""

    time: float                        # where it ends [s]
    state: Array                       # there
    begun: float                       # time at the start of its piece [s]
    scale: float                       # rate there
    between: Callable[[Any], Array]    # inputs -> ((time - begun) scale, the other states)


def piece_ahead(ends: Sequence[float], cycle: float, position: float, rate: float
                ) -> PieceAhead | None:
    """Return the piece to which an input that turns fully comes; None where none ends ahead."""
    # ends: of the pieces in a cycle, in order
    if not ends or not rate or abs(position) > FARTHEST:
        return None
    beside = BESIDE + ROUNDED * abs(position)
    ahead = position + copysign(2.0 * beside, rate)
    turn = cycle * floor((ahead - ends[0]) / cycle)
    if rate > 0.0:
        i = bisect_right(ends, ahead - turn)
        end = turn + (ends[i] if i < len(ends) else ends[0] + cycle)
        return PieceAhead(position + beside, end - beside, end + beside)
    i = bisect_left(ends, ahead - turn) - 1
    end = turn + (ends[i] if i >= 0 else ends[-1] - cycle)
    return PieceAhead(end + beside, position - beside, end - beside)


def steps_over_pieces(coordinate: MotionCoordinate, span: tuple[float, float], state: Array,
                      integrator: Callable[..., Any], tolerance: float, longest: float,
                      counted: Callable[..., Any]) -> Iterator[InputStep]:
    """
    Yield steps through one piece after the other, the last of each to just beyond its end.

    ``span``: time at the state, and a later one that is not reached [s]; ``integrator``: an
    explicit one of scipy; ``longest``: share of a piece, or of REACH, that a step goes at most;
    ``counted`` makes of (variable, state) -> rates a function that integrators take. The steps end
    where the rate changes so much that the time is the better variable, no step is short enough,
    or no piece ends ahead.
    """
    (time, last), solver = span, None
    mechanism, latest = coordinate.equation.mechanism, nextafter(last, -inf)
    ends, cycle = mechanism.pieces.ends if mechanism.pieces else (), mechanism.cycle
    derivative, begun, scale = coordinate.derivative, time, float(state[1])

    def slopes(position: float, values: Sequence[float]) -> list[float]:
        way, rate, *others = values
        inside = low if position < low else high if position > high else position
        _, *change = derivative(min(begun + way / scale, latest), (inside, rate, *others))
        return [scale / rate, *[each / rate for each in change]]                            # (ST1)

    while piece := piece_ahead(ends, cycle, *state[:2].tolist()):
        low, high, beyond = piece
        begun, scale = time, float(state[1])
        step = longest * min(abs(beyond - float(state[0])), REACH)
        if solver is None:
            # its variable is the input; its states are the way that it would have gone at the rate
            # at the start of the piece, which tells the time, and all after the input
            solver = integrator(
                counted(slopes, inf), float(state[0]), np.array([0.0, *state[1:]]),
                copysign(inf, scale), first_step=step, max_step=step,
                rtol=max(tolerance, 100.0 * EPS), atol=tolerance)
        else:           # in another piece slopes are others, and the time counts from its start
            solver.y[0], solver.h_abs, solver.max_step = 0.0, step, step
            solver.f = solver.fun(solver.t, solver.y)
        # by the acceleration at the start: w^2 + 2 (dw/dt) way at the end
        if not MOST_CHANGED**-2 < 1.0 + 2.0 * solver.f[1] * (beyond - solver.t) / scale < (
                MOST_CHANGED**2):
            return
        while True:
            solver.max_step = min(step, abs(beyond - solver.t))
            solver.step()
            before, time = time, begun + float(solver.y[0]) / scale
            if (solver.status == 'failed' or not before < time < last
                    or not 1.0 / MOST_CHANGED < solver.y[1] / scale < MOST_CHANGED):
                return
            state = np.array([solver.t, *solver.y[1:]])
            yield InputStep(time, state, begun, scale, solver.dense_output())
            if not low < solver.t < high:
                break


@dataclass(frozen=True)
class BetweenSteps:
    """Times -> states, (fields, times), between steps in the input."""

    times: Array             # at which they begin and end [s]
    steps: Sequence[InputStep]

    def __call__(self, times: Array) -> Array:
        columns = np.empty((self.steps[0].state.size, times.size))
        which = np.clip(np.searchsorted(self.times, times) - 1, 0, len(self.steps) - 1)
        for i in np.unique(which).tolist():
            there, (_, _, begun, scale, between) = which == i, self.steps[i]
            wanted = (times[there] - begun) * scale
            first, last = between.t_old, between.t
            position = first + (last - first) * (times[there] - self.times[i]) / (
                self.times[i + 1] - self.times[i])
            for _ in range(ITERATIONS):
                way, rate, *_ = between(position)
                position = position + (wanted - way) * rate / scale
            columns[:, there] = np.array([position, *between(position)[1:]])
        return columns
