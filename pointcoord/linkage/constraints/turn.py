"""The driven rotation of a body about a hinge, measured from the drawing."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import ONE, Constraint, Equation, Names, Term
from pointcoord.linkage.constraints.in_body import (
    Triangle,
    by_component,
    held_in_body,
    weights_in_body,
)
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import per_axis
from pointcoord.numerics.double_double import PAIRS, pair_cross, pair_dot, pair_quotient, pair_root


def turn(
    name: str,
    point: str,
    hinge: tuple[str, str],
    driven: tuple[str, str],
    carrier: tuple[str, Triangle] | None = None,
) -> Constraint:
    r"""A body rotated about a hinge from its tail to its head, right-handed, with v = p - p_tail.

    Two vectors fixed to the other body are normal to the hinge. In the drawing, with d along the hinge, they
    are N = d x v and M = N x d / |d|. Both have one length, and M is along v's part normal to the hinge. Then

        alpha - v . N = 0,    beta - v . M = 0,    cosine alpha - sine beta = 0,

    so that (beta, alpha) points along (cosine, sine), which are driven. There are three rows if the other
    body is the chassis, since N and M are constants then. Another body holds N and M in its triangle, with
    six more rows.

    Args:
        hinge: tail and head. driven: cosine and sine.
        carrier: the other body and its triangle; None for the chassis.
    """
    vectors, (cosine, sine) = (f"across {name}", f"along {name}"), driven
    parts = tuple(f"part {vector}" for vector in vectors)
    held = [held_in_body(vector, (vector, ""), *carrier) for vector in vectors] if carrier else []
    constants = [own for _, own in held] or [per_axis(vector) for vector in vectors]
    equations = [
        Equation(f"{name}: {side}", (Term(1.0, (hinge[0], point), (vector, "")), Term(1.0, part, ONE)))
        for side, vector, part in zip(("across", "along"), vectors, parts, strict=True)
    ]
    equations.append(Equation(name, (Term(1.0, cosine, parts[0]), Term(-1.0, sine, parts[1]))))
    return Constraint(
        name,
        (*equations, *(equation for equation, _ in held)),
        partial(_placed, name, point, hinge, carrier, tuple(zip(vectors, parts, constants, strict=True))),
        vectors=vectors if carrier else (),
        slides=parts,
        constants=tuple(constant for own in constants for constant in own),
    )


def _placed(
    name: str,
    point: str,
    hinge: tuple[str, str],
    carrier: tuple[str, Triangle] | None,
    own: tuple[tuple[str, str, Names], ...],
    drawing: Drawing,
) -> Mapping[str, Placed]:
    """The drawn vectors and parts.

    Raises:
        MechanismError: the point is drawn on the hinge.
    """
    tail, head = hinge
    axis, scale = drawing.axis(tail, head), drawing.scale(tail, point)[..., None]
    high, low = drawing.edge(point, tail)
    v = high * scale, low * scale
    across = pair_cross(axis, v)
    if not (np.sum(across[0] ** 2, axis=-1) > 1e-24).all():
        raise MechanismError(
            f"{point} is drawn on the hinge {tail} - {head}, so the rotation of its body cannot be measured "
            "at it; draw it off the hinge",
            (point, tail, head),
        )
    length = pair_root(pair_dot(axis, axis))
    along = pair_quotient(pair_cross(across, axis), (length[0][..., None], length[1][..., None]))
    found: dict[str, Placed] = {}
    for (vector, part, constants), pair in zip(own, (across, along), strict=True):
        found[part] = Placed(np.sum(v[0] * pair[0], axis=-1))
        # Products of vectors of length at most 1, and a quotient.
        numbers = Placed(*pair, np.full_like(pair[0], 8.0 * PAIRS))
        if carrier:
            found[vector] = Placed(pair[0])
            numbers = weights_in_body(drawing, pair, carrier[1], name)
        found |= by_component(constants, numbers)
    return found
