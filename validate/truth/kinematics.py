"""Velocities, accelerations and turning of the bodies, by differentiating the equations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb, arb_mat

from validate.truth.certificate import jacobian_matrix
from validate.truth.design import Design, values_only
from validate.truth.equations import SIZE, Known, points_of, residual
from validate.truth.errors import NotDecidedError
from validate.truth.exact import as_ball
from validate.truth.jet import Jet
from validate.truth.vectors import Vector, cross, dot, minus, plus, times


def point_jets(enclosure: Sequence[arb], known: Known, design: Design) -> dict[int, Vector]:
    """Points 1 to 10 with rates, as jets of balls, local.

    C(y(t), t) = 0 differentiated once and twice gives  C' y' = -C_t  and  C' y'' = -rest, the paper's
    eqs. (19) and (22). The right-hand sides are C evaluated with jets whose unknown part is zero.

    Raises:
        NotDecidedError: the Jacobian over the enclosure may be singular.
    """
    try:
        inverse = jacobian_matrix(enclosure, values_only(known)).inv()
    except ZeroDivisionError:
        raise NotDecidedError("the inverse of the Jacobian for the rates", "0", "not 0") from None
    zero = arb(0)
    still = [Jet(value, zero, zero) for value in enclosure]
    velocity = inverse * _right_hand_side([row.rate for row in residual(still, known)])
    moving = [Jet(jet.value, velocity[i, 0], zero) for i, jet in enumerate(still)]
    acceleration = inverse * _right_hand_side([row.acceleration for row in residual(moving, known)])
    solved = [Jet(jet.value, jet.rate, acceleration[i, 0]) for i, jet in enumerate(moving)]
    points = points_of(solved, known)
    points[10] = wheel_centre(points, design)
    return points


def wheel_centre(points: Mapping[int, Vector], design: Design) -> Vector:
    """p10 = p5 + a r6 + b r7 + c r6 x r7: carried rigidly, with the handedness of the given table."""
    r6, r7 = minus(points[6], points[5]), minus(points[7], points[5])
    terms = zip((r6, r7, cross(r6, r7)), (as_ball(c) for c in design.wheel), strict=True)
    place = points[5]
    for vector, factor in terms:
        place = plus(place, times(vector, factor))
    return place


def body_rates(origin: Vector, first: Vector, second: Vector) -> tuple[Vector, Vector]:
    r"""Angular velocity and acceleration of the body that carries three points (jets), not on one line.

    With the frame e = (a, b, n), n = a x b, and its reciprocal g (g_i . e_j = 1 if i = j else 0),
    e_i' = omega x e_i gives  sum_i g_i x e_i' = 2 omega,  and
    e_i'' - omega x (omega x e_i) = alpha x e_i gives alpha in the same way.
    The only divisor is |n|^2. The printed quotient v65 x v75 / (v65 . r75) is 0/0 whenever omega lies
    in the plane of the points.

    Returns:
        omega, rad/s, and alpha, rad/s^2, as vectors of balls.
    """
    a, b = minus(first, origin), minus(second, origin)
    frame = (a, b, cross(a, b))
    e = [_part(vector, "value") for vector in frame]
    n2 = dot(e[2], e[2])
    reciprocal = [times(g, 1 / n2) for g in (cross(e[1], e[2]), cross(e[2], e[0]), e[2])]

    def half_curl(vectors: Sequence[Vector]) -> Vector:
        parts = [cross(g, vector) for g, vector in zip(reciprocal, vectors, strict=True)]
        return times(plus(plus(parts[0], parts[1]), parts[2]), arb(1) / 2)

    omega = half_curl([_part(vector, "rate") for vector in frame])
    centripetal = [cross(omega, cross(omega, vector)) for vector in e]
    second_rates = [_part(vector, "acceleration") for vector in frame]
    alpha = half_curl([minus(d, c) for d, c in zip(second_rates, centripetal, strict=True)])
    return omega, alpha


def wheel_angles(points: Mapping[int, Vector], design: Design, known: Known) -> tuple[arb, arb]:
    """Camber and kingpin angle, rad, eqs. (17) and (16), side aware; balls.

    kingpin = atan2((p7 - p5) . inboard, (p7 - p5) . up)
    camber  = atan2((p7 - p10) . up, (p10 - p7) . outboard)
    """
    p = {n: _part(points[n], "value") for n in (5, 7, 10)}
    outboard = times(known.right, design.outboard)
    axis, spin = minus(p[7], p[5]), minus(p[10], p[7])
    kingpin = arb.atan2(-dot(axis, outboard), dot(axis, known.up))
    camber = arb.atan2(-dot(spin, known.up), dot(spin, outboard))
    return camber, kingpin


def _right_hand_side(rows: Sequence[arb]) -> arb_mat:
    return arb_mat(SIZE, 1, [-row for row in rows])


def _part(vector: Vector, name: str) -> Vector:
    return getattr(vector[0], name), getattr(vector[1], name), getattr(vector[2], name)
