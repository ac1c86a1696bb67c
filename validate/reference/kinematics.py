"""Velocities, accelerations and angular rates of the bodies, by differentiating the equations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import comb

from flint import arb

from validate.reference.design import Known
from validate.reference.errors import NotDecidedError
from validate.reference.jet import Jet, part_of
from validate.reference.krawczyk import column
from validate.reference.vectors import Scalar, Vector, cross, dot, minus, plus, times

Solved = Callable[[Sequence[Scalar]], Sequence[Scalar]]


def with_rates(values: Sequence[Scalar], known: Known, solved: Solved) -> list[Jet]:
    """The unknowns with as many time derivatives as the inputs, as jets of any kind of number, local.

    C(y(t), t) = 0 differentiated once and twice gives C' y' = -C_t and C' y'' = -rest, the paper's eqs. (19)
    and (22), and so on. The right-hand sides are C evaluated with jets whose unknown derivative is zero.

    Args:
        solved: gives -C'^-1 times a column.
    """
    zero, moving = values[0] * 0, [Jet(value) for value in values]
    for order in range(1, 1 + known.derivatives):
        rows = known.residual([Jet(*jet.parts, zero) for jet in moving])
        # A row that does not depend on time is a plain number.
        rest = [row.part(order) if isinstance(row, Jet) else zero for row in rows]
        moving = [Jet(*jet.parts, rate) for jet, rate in zip(moving, solved(rest), strict=True)]
    return moving


def by_balls(enclosure: Sequence[arb], known: Known) -> Solved:
    """Solves with the inverse of the Jacobian over the enclosure.

    Args:
        known: without derivatives.
    Raises:
        NotDecidedError: the Jacobian over the enclosure may be singular.
    """
    try:
        inverse = known.equations.matrix(enclosure, known.numbers).inv()
    except ZeroDivisionError:
        raise NotDecidedError("the inverse of the Jacobian for the rates", "0", "not 0") from None
    return lambda rows: (-(inverse * column(rows))).entries()


def body_turns(solved: Sequence[Jet], known: Known) -> dict[str, list[Vector]]:
    """Angular velocity, angular acceleration and so on of every moving body, rad/s, rad/s^2."""
    found = {}
    for name in known.equations.frames:
        a, b = known.equations.frame_of(solved, name)
        found[name] = body_rates(known.chassis.turned(a), known.chassis.turned(b), known.derivatives)
    return found


def body_rates(a: Vector, b: Vector, derivatives: int = 2) -> list[Vector]:
    r"""Angular velocity, acceleration and so on of a body, from two vectors fixed in it (jets), not parallel.

    With the frame e = (a, b, n), n = a x b, and its reciprocal g (g_i . e_j = 1 if i = j else 0),
    e_i' = omega x e_i gives sum_i g_i x e_i' = 2 omega. The derivatives of omega follow likewise from
    e_i^(n+1) - sum_{k<n} C(n, k) omega^(k) x e_i^(n-k) = omega^(n) x e_i.
    The only divisor is |n|^2. The paper's quotient v65 x v75 / (v65 . r75) is 0/0 whenever omega lies in the
    plane of the points.

    Returns:
        omega, rad/s, alpha, rad/s^2, and so on, `derivatives` vectors of balls.
    """
    frame = (a, b, cross(a, b))
    e = [part_of(vector, 0) for vector in frame]
    n2 = dot(e[2], e[2])
    reciprocal = [times(g, 1 / n2) for g in (cross(e[1], e[2]), cross(e[2], e[0]), e[2])]

    def half_curl(vectors: Sequence[Vector]) -> Vector:
        parts = [cross(g, vector) for g, vector in zip(reciprocal, vectors, strict=True)]
        x, y, z = plus(plus(parts[0], parts[1]), parts[2])
        return x / 2, y / 2, z / 2

    found: list[Vector] = []
    for order in range(derivatives):
        rates = [part_of(vector, order + 1) for vector in frame]
        for k, turn in enumerate(found):
            carried = [cross(turn, part_of(vector, order - k)) for vector in frame]
            rates = [
                minus(rate, times(part, comb(order, k))) for rate, part in zip(rates, carried, strict=True)
            ]
        found.append(half_curl(rates))
    return found
