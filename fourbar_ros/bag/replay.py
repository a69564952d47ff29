"""
The messages of a bag at their original pace, without ROS: for notebooks, and for the replay node.

>>> for raw in play('bags/run', rate=10.0):
...     print(raw.topic, raw.time)
"""
from __future__ import annotations

import time
from math import inf

from . import BagError
from .reader import Bag

TICK = 0.05         # [s] longest sleep


def play(path, topics=None, rate=1.0, start=0.0, loop=False, follow=False, tick=None, period=TICK):
    """
    Yield every :class:`~fourbar_ros.bag.reader.Raw` message of a bag when it is due.

    Due is the time since the first message over ``rate``, on a monotonic clock: a late message does not
    make the next one late.

    Parameters
    ----------
    path : str, Path or Bag
        Bag; finished, cut, or still being written.
    topics : list of str, optional
        Only these.
    rate : float
        Times as fast; ``inf`` does not wait at all.
    start : float
        Leave out the first seconds of the bag.
    loop : bool
        Begin again at the end.
    follow : bool
        At the end of a bag that is being written, wait for more.
    tick : callable, optional
        Called with the time of the bag [ns] at least every ``period`` seconds, and before each message.
        Playing ends when it returns False.

    """
    bag = path if isinstance(path, Bag) else Bag(path)
    tick = tick or (lambda now: True)
    if not rate > 0.0 or not start >= 0.0:
        raise BagError(f'rate = {rate!r}, start = {start!r}: must be positive, and not negative')
    origin = next((raw.time for raw in bag.raw()), None)
    if origin is None:
        return
    origin += round(start * 1e9)
    while True:
        began, count = time.monotonic(), 0
        for raw in bag.raw(topics, origin if start else None, follow):
            if not _wait(began, raw.time - origin, rate, origin, tick, period):
                return
            yield raw
            count += 1
        if not loop or not count:
            return


def _wait(began, due, rate, origin, tick, period):
    """Wait until a message is due, ``due`` nanoseconds of the bag after its beginning; tick meanwhile."""
    while True:
        elapsed = due if rate == inf else (time.monotonic() - began) * rate * 1e9
        if elapsed >= due:
            return tick(origin + due) is not False
        if tick(origin + int(elapsed)) is False:
            return False
        time.sleep(min((due - elapsed) / rate * 1e-9, period))
