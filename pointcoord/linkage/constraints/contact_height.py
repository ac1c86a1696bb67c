"""The driven height of a wheel over the ground, seen from a moved chassis.

The mechanism is solved in the chassis' own frame (see `chassis`). There a rotation of the chassis by a about
k through P rotates the direction up by -a, and the height of a place x over the ground is

    x . u_0 + sum_i P_i . (u_i - u_(i-1)) + up . d,      u_m = up,   u_(i-1) = u_i turned by -a_i about k_i

after the rotations 1 to m and a displacement d.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import NamedTuple

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import ONE, Constraint, Edge, Equation, Names, Term
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.numerics.double_double import (
    PAIRS,
    exact_square,
    minus_pair,
    pair_dot,
    pair_product,
    pair_quotient,
    pair_root,
    pair_sum,
    two_product,
)
from pointcoord.numerics.vectors import cross

UP: Edge = ("up", "")


class Ground(NamedTuple):
    """Terms of heights over the ground; without terms for a chassis that stands still.

    Attributes:
        up: name of the upward direction in the chassis' frame.
        lifts: terms that a height over the ground has in addition to the place's component along `up`.
        pivots: centres of rotation of the chassis. constraints: constraints that define these vectors.
    """

    up: str = "up"
    lifts: tuple[Term, ...] = ()
    pivots: Names = ()
    constraints: tuple[Constraint, ...] = ()

    def turned_back(self, turn: str, axis: str, about: str, cosine: str, sine: str) -> Ground:
        r"""The ground before a rotation of the chassis by the angle a about the unit vector k. Nine rows.

            t - e x k = 0,    w - k x t = 0,    u - e - sin(a) t + (1 - cos(a)) w = 0,

        with the upward direction e after the rotation and u before it; w is the part of e normal to k. Cosine
        and sine are driven. The rows are bilinear: in direction and axis, and in cosine or sine and t or w.

        Args:
            about: P, a point of the chassis.
        """
        across, aside, before = f"across {turn}", f"aside of {turn}", f"up before {turn}"
        t, w, e, k = ((name, "") for name in (across, aside, self.up, axis))
        equations = (
            Equation(across, (Term(1.0, t, ONE), Term(-1.0, e, k, cross=True))),
            Equation(aside, (Term(1.0, w, ONE), Term(-1.0, k, t, cross=True))),
            Equation(
                before,
                (Term(1.0, (before, self.up), ONE), Term(-1.0, sine, t), Term(1.0, ONE, w, less=cosine)),
            ),
        )
        names = across, aside, before
        made = Constraint(before, equations, partial(_turned_back, names, axis), vectors=names)
        lift = Term(1.0, (about, ""), (self.up, before))
        return Ground(before, (*self.lifts, lift), (*self.pivots, about), (*self.constraints, made))

    def displaced(self, along: tuple[tuple[str, str], ...]) -> Ground:
        """The ground with a displacement d of the chassis, d - sum_i h_i e_i = 0; it adds up . d. Three rows.

        Args:
            along: pairs of a driven coordinate h_i and its direction e_i.
        """
        name = "displacement of the chassis"
        ways = (Term(-1.0, value, (direction, "")) for value, direction in along)
        equation = Equation(name, (Term(1.0, (name, ""), ONE), *ways))
        made = Constraint(name, (equation,), partial(_displaced, name), vectors=(name,))
        lift = Term(1.0, UP, (name, ""))
        return Ground(self.up, (*self.lifts, lift), self.pivots, (*self.constraints, made))


def contact_height(inner: str, centre: str, rise: str, radius: float, ground: Ground) -> Constraint:
    r"""The lowest point of a thin disc of radius r about the axis from `inner` to `centre`. Three rows.

    With the axis w = p_centre - p_inner of drawn length L, a = w . e and q the part of w normal to e,

        a - w . e = 0,    q^2 + a^2 - L^2 = 0,    p_centre . e - (r / L) q - k - rise = 0,

    since the lowest point lies r q / L below the centre. k is the height in the drawing. For heights over the
    ground, e is the ground's `up`, and the last row also has the ground's `lifts`.

    Args:
        rise: the driven coordinate. radius: mm.
        ground: the ground from which the height is measured; by default along the chassis' own up.
    """
    lean, reach = f"rise of the axis to {centre}", f"reach of the axis to {centre}"
    what = ("squared length of the axis", "radius by the length of the axis", "drawn contact height")
    constants = tuple(f"{each} of {centre}" for each in what)
    square, share, drawn = constants
    up, name = (ground.up, ""), f"height of the contact point of {centre}"
    height = Term(1.0, (centre, ""), up), *ground.lifts, Term(-1.0, share, reach)
    return Constraint(
        name,
        (
            Equation(f"lean of {centre}", (Term(1.0, (inner, centre), up), Term(1.0, lean, ONE))),
            Equation(
                f"length of the axis to {centre}",
                (Term(1.0, lean, lean), Term(1.0, reach, reach), Term(-1.0, square, ONE)),
            ),
            Equation(name, (*height, Term(-1.0, drawn, ONE), Term(-1.0, rise, ONE))),
        ),
        partial(_contact, inner, centre, radius, (lean, reach, *constants)),
        slides=(lean, reach),
        constants=constants,
        pivots=ground.pivots,
    )


def _turned_back(names: Names, axis: str, drawing: Drawing) -> Mapping[str, Placed]:
    """The drawn vectors, before any rotation."""
    up, k = drawing.vectors["up"], drawing.vectors[axis]
    across = cross(up, k)
    vectors = across, cross(k, across), up
    return {name: Placed(vector) for name, vector in zip(names, vectors, strict=True)}


def _displaced(name: str, drawing: Drawing) -> Mapping[str, Placed]:
    return {name: Placed(0.0 * drawing.vectors["up"])}


def _contact(inner: str, centre: str, radius: float, names: Names, drawing: Drawing) -> Mapping[str, Placed]:
    """The drawn lean and the constants, with their rounding errors.

    Raises:
        MechanismError: the axis has no length, or is drawn upright.
    """
    place, e = drawing.vectors[centre], drawing.edge(*UP)
    square = exact_square(place, drawing.vectors[inner])
    lean = pair_dot(drawing.edge(centre, inner), e)
    reach2 = pair_sum(square, minus_pair(pair_product(lean, lean)))
    if not (reach2[0] > 1e-12 * square[0]).all() or not (square[0] > 0.0).all():
        raise MechanismError(
            f"the wheel's axis from {inner} to {centre} has no length or is drawn upright, so "
            "the wheel has no lowest point; draw it across the car",
            (inner, centre),
        )
    reach = pair_root(reach2)
    size = two_product(np.asarray(radius / drawing.unit), np.ones_like(square[0]))
    share = pair_quotient(size, pair_root(square))
    drop = pair_product(share, reach)
    drawn = pair_sum(pair_dot((place, np.zeros_like(place)), e), minus_pair(drop))
    # The square root loses the digits that cancel in the difference under it. Roots, quotients and products
    # of pairs round a few times as much as one product of pairs.
    lost = 8.0 * PAIRS * (1.0 + square[0] / reach2[0])
    sum_of = np.sum(np.abs(place * e[0]), axis=-1) + np.abs(drop[0])
    numbers = (
        Placed(lean[0]),
        Placed(reach[0]),
        Placed(*square, PAIRS * square[0]),
        Placed(*share, 8.0 * PAIRS * share[0]),
        Placed(*drawn, lost * sum_of),
    )
    return dict(zip(names, numbers, strict=True))
