# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The structure of a machine from its dyads, whose names and order are checked."""
from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from graphlib import CycleError, TopologicalSorter

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanisms.machine.describe.description import Dyad
from fourbar_ros.mechanisms.machine.solve.pairs import Joints
from fourbar_ros.mechanisms.machine.structure import (
    CRANK_LINK,
    CYLINDER,
    Layout,
    load_fields,
    motion_fields,
    SLIDER_LINK,
    Stage,
)
from fourbar_ros.mechanisms.parts import GROUND


def layout_of(driver: str, dyads: Sequence[Dyad], output: str | None = None,
              carrier: str = GROUND) -> Layout:
    """
    Return the :class:`Layout` of dyads, a cylinder's own first; ``carrier``: as of a Machine.

    Raises
    ------
    InvalidParameter
        A name twice, a link that is not there, or not yet: with the order of dyads that works, or
        the links that no order solves.

    """
    driven = SLIDER_LINK if driver == 'slide' else CRANK_LINK
    frame = dyads[0].second.link if driver == CYLINDER else carrier
    links, owners, stages = [frame, driven], {frame: '', driven: 'the driven link'}, []
    if frame != GROUND:
        owners[frame] = ('the link at the base of the cylinder' if driver == CYLINDER
                         else 'the link that carries the crank')
    names = set[str]()
    for dyad in dyads:
        where = f'dyads.{dyad.name}'
        if dyad.name in names:
            raise InvalidParameter('name of a dyad', dyad.name, 'stands twice')
        names.add(dyad.name)
        _require_new(where, dyad.links, owners)
        for end in ('first', 'second'):
            link = getattr(dyad, end).link
            if link in dyad.links:
                raise InvalidParameter(f'{where}.{end}.link', link, 'a dyad cannot hang on its '
                                       'own link')
            if link not in links:
                raise InvalidParameter(f'{where}.{end}.link', link,
                                       _why_not_there(dyads, link, links))
        stages.append(Stage(dyad.name, dyad.kind, links.index(dyad.first.link),
                            links.index(dyad.second.link), dyad.links, len(links)))
        links += dyad.links
        owners.update(dict.fromkeys(dyad.links, f'a link of dyad {dyad.name}'))
    if GROUND not in links:
        raise InvalidParameter('cylinder.base.link' if driver == CYLINDER else 'carrier', frame,
                               'a machine whose drive is on a link that moves has the ground '
                               'among the links of a dyad')
    joints = Joints(driver, stages, [dyad.lengths for dyad in dyads])
    layout = Layout(driver, tuple(links), tuple([
        stage if stage.name == CYLINDER else stage._replace(pair=joints.pair_of(stage))
        for stage in stages]), '')
    moving = layout.moving
    if output is not None and output not in moving:
        raise InvalidParameter('output', output,
                               f'there is no such link{nearest(output, moving)}')
    layout = layout._replace(output=output or (driven if names == {CYLINDER} else moving[-1]))
    _require_single(layout)
    return layout


def _why_not_there(dyads: Sequence[Dyad], link: str, known: Sequence[str]) -> str:
    """Return the text of an error for a link on which no dyad can hang yet, with what helps."""
    owner = next((dyad for dyad in dyads if link in dyad.links), None)
    if owner is None:
        return f'there is no such link{nearest(link, known)}'
    # {dyad: those on whose links it hangs}
    supports = {dyad.name: {support.name for support in dyads if support is not dyad
                            and {dyad.first.link, dyad.second.link} & {*support.links}}
                for dyad in dyads}
    try:
        order = ', '.join(TopologicalSorter(supports).static_order())
    except CycleError as error:
        in_cycle, *_ = error.args[1]
        for _ in dyads:             # then also those on which these hang, and so on
            supports = {name: known.union(*[supports[support] for support in known])
                        for name, known in supports.items()}
        group = [link for dyad in dyads for link in dyad.links
                 if in_cycle in supports[dyad.name] and dyad.name in supports[in_cycle]]
        return (f'is a link of dyad {owner.name}, but no order of dyads works: the links '
                f'{", ".join(group)} close only together, an Assur group of a higher class. '
                'Drive another link, or hang one of their dyads on links before it')
    return f'is a link of dyad {owner.name}, which must stand before this one: {order} works'


def _require_new(where: str, links: Sequence[str], owners: dict[str, str]) -> None:
    """Refuse names of links that are equal or taken; ``owners``: {link: what it is, in words}."""
    if links[0] == links[1]:
        raise InvalidParameter(f'{where}.links', tuple(links), 'must be two names')
    for link in links:
        if link == GROUND and not owners.get(GROUND, 'no frame'):
            raise InvalidParameter(f'{where}.links', tuple(links), 'the ground is no link of a '
                                   'dyad, unless cylinder.base is a point of a moving link, or '
                                   'linkage.carrier is one')
        if link in owners:
            raise InvalidParameter(f'{where}.links', link, f'is {owners[link]} already')


def _require_single(layout: Layout) -> None:
    """Refuse names that make two fields alike, as a link called d_inner and a pin of dyad d."""
    for fields in (motion_fields(layout), load_fields(layout)):
        name, count = Counter(fields).most_common(1)[0]
        if count > 1:
            raise InvalidParameter('dyads', name, 'would be the name of two results: change that '
                                                  'of a link or a dyad')

