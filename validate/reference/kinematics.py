"""Velocities, accelerations and turning of the bodies, by differentiating the equations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from flint import arb, arb_mat

from validate.reference.design import Known
from validate.reference.errors import NotDecidedError
from validate.reference.jet import Jet, part_of
from validate.reference.krawczyk import column
from validate.reference.vectors import Scalar, Vector, cross, dot, minus, plus, times

Solved = Callable[[Sequence[Scalar]], Sequence[Scalar]]


def unknown_jets(enclosure: Sequence[arb], known: Known, inverse: arb_mat) -> list[Jet]:
    """The unknowns with rates, as jets of balls, local.

    C(y(t), t) = 0 differentiated once and twice gives  C' y' = -C_t  and  C' y'' = -rest, the paper's
    eqs. (19) and (22). The right-hand sides are C evaluated with jets whose unknown part is zero.

    Args:
        inverse: of the Jacobian over the enclosure.
    """
    return with_rates(enclosure, known, _solving(inverse))


def unknown_rates(enclosure: Sequence[arb], known: Known, inverse: arb_mat) -> Sequence[arb]:
    """The rates of the unknowns alone."""
    return _rates(enclosure, known, _solving(inverse))


def _solving(inverse: arb_mat) -> Solved:
    return lambda rows: (-(inverse * column(rows))).entries()


def _rates(values: Sequence[Scalar], known: Known, solved: Solved) -> Sequence[Scalar]:
    zero = values[0] * 0
    still = [Jet(value, zero, zero) for value in values]
    return solved([row.rate for row in known.residual(still)])


def with_rates(values: Sequence[Scalar], known: Known, solved: Solved) -> list[Jet]:
    """The same of any kind of number, where `solved` gives -C'^-1 times a column."""
    zero = values[0] * 0
    velocity = _rates(values, known, solved)
    moving = [Jet(value, rate, zero) for value, rate in zip(values, velocity, strict=True)]
    bend = solved([row.acceleration for row in known.residual(moving)])
    return [Jet(jet.value, jet.rate, second) for jet, second in zip(moving, bend, strict=True)]


def inverse_jacobian(enclosure: Sequence[arb], known: Known) -> arb_mat:
    """C'^-1 over the enclosure; `known` with the values of the jets.

    Raises:
        NotDecidedError: the Jacobian over the enclosure may be singular.
    """
    try:
        return known.matrix(enclosure).inv()
    except ZeroDivisionError:
        raise NotDecidedError("the inverse of the Jacobian for the rates", "0", "not 0") from None


def body_turns(solved: Sequence[Jet], known: Known) -> dict[str, tuple[Vector, Vector]]:
    """Angular velocity and acceleration of every moving body, rad/s, rad/s^2."""
    return {name: body_rates(*frame) for name, frame in known.frames_of(solved).items()}


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
    e = [part_of(vector, "value") for vector in frame]
    n2 = dot(e[2], e[2])
    reciprocal = [times(g, 1 / n2) for g in (cross(e[1], e[2]), cross(e[2], e[0]), e[2])]

    def half_curl(vectors: Sequence[Vector]) -> Vector:
        parts = [cross(g, vector) for g, vector in zip(reciprocal, vectors, strict=True)]
        x, y, z = plus(plus(parts[0], parts[1]), parts[2])
        return x / 2, y / 2, z / 2

    omega = half_curl([part_of(vector, "rate") for vector in frame])
    centripetal = [cross(omega, cross(omega, vector)) for vector in e]
    second_rates = [part_of(vector, "acceleration") for vector in frame]
    alpha = half_curl([minus(d, c) for d, c in zip(second_rates, centripetal, strict=True)])
    return omega, alpha
