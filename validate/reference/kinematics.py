"""Velocities, accelerations and turning of the bodies, by differentiating the equations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb, arb_mat

from validate.reference.certificate import jacobian_matrix
from validate.reference.design import values_only
from validate.reference.errors import NotDecidedError
from validate.reference.jet import Jet
from validate.reference.linkage import Known
from validate.reference.vectors import Vector, cross, dot, minus, plus, times


def unknown_jets(enclosure: Sequence[arb], known: Known) -> list[Jet]:
    """The unknowns with rates, as jets of balls, local.

    C(y(t), t) = 0 differentiated once and twice gives  C' y' = -C_t  and  C' y'' = -rest, the paper's
    eqs. (19) and (22). The right-hand sides are C evaluated with jets whose unknown part is zero.

    Raises:
        NotDecidedError: the Jacobian over the enclosure may be singular.
    """
    residual, inverse = known.linkage.residual, inverse_jacobian(enclosure, values_only(known))
    zero = arb(0)
    still = [Jet(value, zero, zero) for value in enclosure]
    velocity = inverse * _right_hand_side([row.rate for row in residual(still, known)])
    moving = [Jet(jet.value, velocity[i, 0], zero) for i, jet in enumerate(still)]
    acceleration = inverse * _right_hand_side([row.acceleration for row in residual(moving, known)])
    return [Jet(jet.value, jet.rate, acceleration[i, 0]) for i, jet in enumerate(moving)]


def inverse_jacobian(enclosure: Sequence[arb], known: Known) -> arb_mat:
    """C'^-1 over the enclosure.

    Raises:
        NotDecidedError: the Jacobian over the enclosure may be singular.
    """
    try:
        return jacobian_matrix(enclosure, known).inv()
    except ZeroDivisionError:
        raise NotDecidedError("the inverse of the Jacobian for the rates", "0", "not 0") from None


def body_turns(
    solved: Sequence[Jet], points: Mapping[str, Vector], known: Known
) -> dict[str, tuple[Vector, Vector]]:
    """Angular velocity and acceleration of the knuckle and the arms, rad/s, rad/s^2."""
    turns = {"knuckle": body_rates(*known.linkage.knuckle_frame(solved, known))}
    for body, (a, b, c) in known.linkage.arms.items():
        turns[body] = body_rates(minus(points[b], points[a]), minus(points[c], points[a]))
    return turns


def body_rates(a: Vector, b: Vector) -> tuple[Vector, Vector]:
    r"""Angular velocity and acceleration of the body that carries two vectors (jets), not parallel.

    With the frame e = (a, b, n), n = a x b, and its reciprocal g (g_i . e_j = 1 if i = j else 0),
    e_i' = omega x e_i gives  sum_i g_i x e_i' = 2 omega,  and
    e_i'' - omega x (omega x e_i) = alpha x e_i gives alpha in the same way.
    The only divisor is |n|^2. The printed quotient v65 x v75 / (v65 . r75) is 0/0 whenever omega lies
    in the plane of the points.

    Returns:
        omega, rad/s, and alpha, rad/s^2, as vectors of balls.
    """
    frame = (a, b, cross(a, b))
    e = [_part(vector, "value") for vector in frame]
    n2 = dot(e[2], e[2])
    reciprocal = [times(g, 1 / n2) for g in (cross(e[1], e[2]), cross(e[2], e[0]), e[2])]

    def half_curl(vectors: Sequence[Vector]) -> Vector:
        parts = [cross(g, vector) for g, vector in zip(reciprocal, vectors, strict=True)]
        x, y, z = plus(plus(parts[0], parts[1]), parts[2])
        return x / 2, y / 2, z / 2

    omega = half_curl([_part(vector, "rate") for vector in frame])
    centripetal = [cross(omega, cross(omega, vector)) for vector in e]
    second_rates = [_part(vector, "acceleration") for vector in frame]
    alpha = half_curl([minus(d, c) for d, c in zip(second_rates, centripetal, strict=True)])
    return omega, alpha


def _right_hand_side(rows: Sequence[arb]) -> arb_mat:
    return arb_mat(len(rows), 1, [-row for row in rows])


def _part(vector: Vector, name: str) -> Vector:
    return getattr(vector[0], name), getattr(vector[1], name), getattr(vector[2], name)
