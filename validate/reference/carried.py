r"""Points that a body carries, placed by three of its points with the handedness of the drawing.

    p = p_a + x r_b + y r_c + z r_b x r_c,           r_i = p_i - p_a:

exact for the drawn x, y, z as long as the triangle a, b, c keeps the lengths of its sides.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from validate.reference.errors import BadInputError
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

Triangle = tuple[str, str, str]


def shape_on(triangle: Triangle, table: Mapping[str, Vector], carried: Iterable[str]) -> dict[str, Vector]:
    """(x, y, z) of each carried point that the drawing has, exact.

    Raises:
        BadInputError: the three points lie on one line.
    """
    a, b, c = (table[name] for name in triangle)
    r_b, r_c = minus(b, a), minus(c, a)
    normal = cross(r_b, r_c)
    area = dot(normal, normal)  # also the Gram determinant |r_b|^2 |r_c|^2 - (r_b . r_c)^2
    if area == 0:
        names = f"{', '.join(triangle[:2])} and {triangle[2]}"
        raise BadInputError("the knuckle", f"{names} on one line", "a triangle of these points")
    shape = {}
    for name in carried:
        if name in table:
            r = minus(table[name], a)
            shape[name] = (
                dot(cross(r, r_c), normal) / area,
                dot(cross(r_b, r), normal) / area,
                dot(r, normal) / area,
            )
    return shape


def carried_by(
    triangle: Triangle, points: Mapping[str, Vector], shape: Mapping[str, Vector]
) -> dict[str, Vector]:
    """The carried points where the triangle is."""
    a, b, c = (points[name] for name in triangle)
    r_b, r_c = minus(b, a), minus(c, a)
    places = {}
    for name, factors in shape.items():
        places[name] = a
        for vector, factor in zip((r_b, r_c, cross(r_b, r_c)), factors, strict=True):
            places[name] = plus(places[name], times(vector, factor))
    return places
