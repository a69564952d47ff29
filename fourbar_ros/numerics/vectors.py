# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Vectors in the plane of any numbers, so that formulas are written as in a book."""
from __future__ import annotations

from fourbar_ros.numerics.number_types import Scalar


class Vector:
    """
    A vector along the ground axes.

    Its components are numbers of one type, arrays too. A factor stands on its right: ``a * x``.
    """

    __slots__ = ('x', 'y')
    __array_ufunc__ = None       # arrays leave products with a vector to the vector

    def __init__(self, x: Scalar, y: Scalar) -> None:
        self.x, self.y = x, y

    def __repr__(self) -> str:
        return f'Vector({self.x!r}, {self.y!r})'

    def __add__(self, vector: Vector) -> Vector:
        return Vector(self.x + vector.x, self.y + vector.y)

    def __sub__(self, vector: Vector) -> Vector:
        return Vector(self.x - vector.x, self.y - vector.y)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y)

    def __mul__(self, factor: Scalar) -> Vector:
        return Vector(factor * self.x, factor * self.y)

    def __truediv__(self, divisor: Scalar) -> Vector:
        return Vector(self.x / divisor, self.y / divisor)

    @property
    def normal(self) -> Vector:
        """Return k x a: the vector turned by +90 degrees."""
        return Vector(-self.y, self.x)

    def dot(self, vector: Vector) -> Scalar:
        return self.x * vector.x + self.y * vector.y

    def cross(self, vector: Vector) -> Scalar:
        return self.x * vector.y - self.y * vector.x

    def along(self, direction: Vector) -> Vector:
        """Return on the ground axes a vector given along a unit vector (x) and to its left (y)."""
        return Vector(self.x * direction.x - self.y * direction.y,
                      self.x * direction.y + self.y * direction.x)
