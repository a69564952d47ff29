# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""XML for robot descriptions: elements, numbers with all their digits, colours."""
from xml.etree import ElementTree

Element = ElementTree.Element
COLOURS = ((0.20, 0.45, 0.70), (0.80, 0.45, 0.15), (0.30, 0.60, 0.35), (0.60, 0.35, 0.65),
           (0.55, 0.50, 0.20), (0.25, 0.60, 0.65))
GROUND_COLOUR = (0.45, 0.45, 0.45)


def digits_of(*values: float) -> str:
    """Return numbers as text with all digits, '0.1 2 0'; no negative zeros."""
    return ' '.join(f'{value + 0.0!r}'.removesuffix('.0') for value in map(float, values))


def add(parent: Element, tag: str, text: str = '', /,
        **attributes: str | float | tuple[float, ...]) -> Element:
    """Add an element with a text and attributes, which may be numbers; return it."""
    element = ElementTree.SubElement(parent, tag, {
        name.rstrip('_'): value if isinstance(value, str) else
        digits_of(*(value if isinstance(value, tuple) else (value,)))
        for name, value in attributes.items()})
    element.text = text or None
    return element


def comment(parent: Element, text: str) -> None:
    parent.append(ElementTree.Comment(f' {text.replace("--", "-")} '))


def as_text(root: Element) -> str:
    ElementTree.indent(root)
    return ('<?xml version="1.0"?>\n'
            + ElementTree.tostring(root, encoding='unicode', short_empty_elements=True) + '\n')


def colour(index: int) -> tuple[float, float, float, float]:
    """Return the colour of the link of an index in the order of links; of the ground -1."""
    return (*(GROUND_COLOUR if index < 0 else COLOURS[index % len(COLOURS)]), 1.0)
