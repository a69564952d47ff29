# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One scene, input by input, with its policy for inputs out of range."""
from __future__ import annotations

from functools import partial
from math import nan, nextafter
from typing import Any

from fourbar_ros.mechanisms.points import link_fields, LinkFields, make_point, PointMotion
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.pipeline import joints, wrenches
from fourbar_ros.pipeline.status import evaluate, INVALID_INPUT, LOADS_UNKNOWN, OK, OUT_OF_RANGE

# at a limit, besides omega and alpha
_UNBOUNDED = ('_ratio', 'condition', '_velocity', '_acceleration')
_NO_POINT, _NO_LINK = (nan,) * len(PointMotion._fields), (nan,) * len(LinkFields._fields)


class Stepper:
    """
    Evaluates inputs of one scene in order.

    Out of range its policy holds: 'none' (nothing is known), 'hold' (the last good values again),
    or 'clamp' (the pose at the nearest limit; rates and loads are unbounded there, so NaN). The
    status says OUT_OF_RANGE in any case.

    Parameters
    ----------
    scene : Scene
    acting : dict, optional
        A :class:`~fourbar_ros.pipeline.wrenches.Wrench` for each link that a topic loads; not
        given: as before the first.

    """

    def __init__(self, scene: Any, acting: Any = None) -> None:
        self._scene = scene
        self.linkage, self._policy = scene.linkage, scene.drive.out_of_range
        self._parts: list[Any] = [
            (f'points/{name}', make_point(REAL, scene.linkage, *point), _NO_POINT)
            for name, point in scene.points.items()]
        if 'links' in scene.outputs:
            self._parts += [(f'links/{link.name}',
                             partial(link_fields, scene.linkage, link=link.name), _NO_LINK)
                            for link in scene.linkage.LINKS]
        self._good: Any = None
        self._limits: list[float] | None = None
        self._joints = (None if scene.joint_states.are_plain
                        else joints.Joints(scene.layout, scene.joint_states))
        self._nothing = (nan,) * (len(scene.layout.place)
                                  - (len(joints.FIELDS) * len(scene.layout.joints) if self._joints
                                     else 0))
        self._drive_wrench = (wrenches.drive_wrench(scene.linkage, scene.layout.place)
                              if 'drive_wrench' in scene.outputs else None)
        self._loaded = scene.loaded
        self.acting: dict[str, Any] = {}
        self._loads_unknown = False
        for link in scene.wrenches.links:
            self.act(link, (acting or {}).get(link) or wrenches.in_silence(scene, link, None))

    def act(self, link: str, wrench: Any) -> None:
        """Apply a Wrench to a link from the next step on."""
        self.acting[link] = wrench
        external = wrenches.external(self._scene, self.acting)
        self._loads_unknown = external is None and self._scene.needs_loads
        if external is not None:
            self.linkage = self.linkage.with_external(external)

    def step(self, position: Any, rate: Any, acceleration: Any, with_loads: bool,
             with_parts: Any) -> Any:
        """
        Return (status, values).

        The values are (*motion, *loads, *motion of each point and link, *additions of the layout).
        ``with_parts``: the outputs points/NAME and links/NAME that are wanted; True: all.
        """
        linkage = self.linkage
        if self._loaded and with_loads:                  # with the forces of springs
            loaded = self._loaded(position, rate)
            linkage, with_loads = loaded or linkage, loaded is not None
        status, motion, loads = evaluate(linkage, position, rate, acceleration,
                                         with_loads and not self._loads_unknown)
        if self._loads_unknown and status == OK:
            status = LOADS_UNKNOWN
        values = self._completed((*motion, *loads, *self._of_parts(motion, with_parts)))
        if self._policy == 'hold':
            if status in (OK, LOADS_UNKNOWN):
                self._good = values
            elif status in (OUT_OF_RANGE, INVALID_INPUT) and self._good:
                values = self._good
        elif self._policy == 'clamp' and status == OUT_OF_RANGE:
            values = self._at_limit(position)
        return status, values

    def silence(self) -> tuple[float, ...]:
        """Return the values during a timeout: NaN, except for held joint positions."""
        return self._nothing + self._joints.of(self._nothing) if self._joints else self._nothing

    def _completed(self, values: Any) -> Any:
        if self._drive_wrench:
            values += self._drive_wrench(values)
        return values + self._joints.of(values) if self._joints else values

    def _of_parts(self, motion: Any, wanted: Any) -> Any:
        return [value for name, part, unknown in self._parts
                for value in (part(motion) if wanted is True or wanted and name in wanted
                              else unknown)]

    def _at_limit(self, position: Any) -> Any:
        if self._limits is None:
            self._limits = [_inside(self.linkage, end, toward)
                            for low, high in self.linkage.input_ranges
                            for end, toward in ((low, high), (high, low))]
        nearest = min(self._limits,
                      key=lambda limit: abs(float(self.linkage.distance(position, limit))))
        _, motion, loads = evaluate(self.linkage, nearest, nan, nan, False)
        motion = motion._replace(**{name: nan for name in motion._fields
                                    if name.startswith(('omega', 'alpha'))
                                    or name.endswith(_UNBOUNDED)})
        return self._completed((*motion, *loads, *self._of_parts(motion, True)))


def _inside(linkage: Any, end: float, toward: float) -> float:
    """Return the float nearest to the end of a range at which the linkage can be assembled."""
    while evaluate(linkage, end, 0.0, 0.0, False)[0] == OUT_OF_RANGE and end != toward:
        end = nextafter(end, toward)
    return end
