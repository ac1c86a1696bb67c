r"""The paper's formulas exactly as printed, so that a reader can see which of them fail.

Three formulas differ from ours:

- the rows (8)-(11) that hold the strut's points on one line: see `PrintedParallel`.
- eq. (23): the rows (8)-(11) lack the factor 2 of a product's second derivative, and row (11) repeats
  row (9), with the points 7, 5 where 7, 4 belong.
- omega = v65 x v75 / (v65 . r75) and alpha = a^65 x a^75 / (a^65 . r75), a^ = a - omega x (omega x r),
  which are 0/0 whenever omega (or alpha) lies in the plane of the points 5, 6, 7.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pointcoord import Scene
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES, BodyRates, Edges, States
from pointcoord.linkage.constraints.constraint import Constraint, Equation, Term
from pointcoord.linkage.layout import Layout
from pointcoord.linkage.topology import Topology
from pointcoord.method import Method
from pointcoord.numerics.quadratic import QuadraticMap, Row
from pointcoord.solve.pointwise import square_velocity_term
from validate.arrays import Array

# If a quotient loses more than two digits, the formula is at fault, not its rounding.
MOST_LOST = 100.0


@dataclass(frozen=True)
class PrintedParallel(Constraint):
    r"""Two lines parallel as the paper prints it, eqs. (8), (9) and again (10), (11):

    the x and y components only of (p_end - p_start) x (p_head - p_tail) = 0, with z as the preferred
    axis. The rows lose rank where the line tail - head is horizontal. Two rows.
    """

    @classmethod
    def of(cls, start: str, end: str, tail: str, head: str) -> PrintedParallel:
        """The line from start to end, and that from tail to head."""
        name = f"{start} - {end} parallel to {tail} - {head}"
        return cls(name, (Equation(name, (Term(1.0, (end, start), (head, tail), cross=True),)),))

    @property
    def labels(self) -> tuple[str, ...]:
        """The two rows are distinguished by their coordinate planes."""
        return tuple(f"{self.name} ({plane})" for plane in ("yz", "xz"))

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """(y_e - y_s)(z_h - z_t) - (z_e - z_s)(y_h - y_t), then the same with x for y: -1 times theirs."""
        x, (first, second), _ = super().rows(layout)
        y = tuple(replace(product, coefficient=-product.coefficient) for product in (second, first))
        return x, y


_ROWS = (
    PrintedParallel.of("lower_ball_joint", "strut_lower", "strut_top", "strut_rod_end"),  # (8), (9)
    PrintedParallel.of("strut_top", "strut_lower", "strut_top", "strut_rod_end"),  # (10), (11)
)


_PAPERS = Scene.load("bounce").mechanism.topology


def as_printed(topology: Topology) -> Topology | None:
    """The paper's strut with its cross-product rows (8)-(11), and no coordinates of sliding points.

    No other linkage is accepted: the points and the lines on which they slide must be those of the paper.
    """
    sliding = [constraint for constraint in topology.constraints if constraint.aligned]
    own = [constraint for constraint in _PAPERS.constraints if constraint.aligned]
    if topology.moving != _PAPERS.moving or sliding != own:
        return None
    first = topology.constraints.index(sliding[0])
    others = tuple(one for one in topology.constraints if one not in sliding)
    rows = (*others[:first], *_ROWS, *others[first:])
    return replace(topology, name="macpherson, as printed", constraints=rows)


TOPOLOGY = as_printed(_PAPERS)
assert TOPOLOGY is not None  # it is the paper's
_PARALLEL = [i for i, label in enumerate(TOPOLOGY.labels) if "parallel" in label]


def printed_square_velocity_term(system: QuadraticMap, velocity: Array) -> Array:
    """Eq. (23) as printed, shape (..., rows)."""
    term = square_velocity_term(system, velocity)
    row_8, row_9, row_10, row_11 = _PARALLEL
    term[..., [row_8, row_9, row_10]] *= 0.5
    term[..., row_11] = term[..., row_9]
    return term


class PrintedQuotients(BodyRates):
    """The printed quotients for omega and alpha."""

    def rates(self, position: States, velocity: States, acceleration: States) -> tuple[Array, Array]:
        """Omega and alpha; not finite where their denominator is zero.

        Args:
            position, velocity, acceleration: of the points 5, 6, 7 in this order, shape (..., 3).
        """
        r_65, r_75 = _from_first(position)
        v_65, v_75 = _from_first(velocity)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            omega = _quotient(v_65, v_75, r_75)
            hat_65, hat_75 = (
                a - np.cross(omega, np.cross(omega, r))
                for a, r in zip(_from_first(acceleration), (r_65, r_75), strict=True)
            )
            return omega, _quotient(hat_65, hat_75, r_75)

    def loss(self, edges: Edges, rates: Edges) -> Array:
        """Factor by which the quotient may lose more digits than least squares, shape (..., 1), <= MOST_LOST.

        The error of a product a x b or a . r is about |a| |b| times the relative error of its factors, so
        the quotient's error is |a| |b| / |a x b| and |a| |r| / |a . r| times that of its factors.
        """
        a, b, r = *rates, edges[1]
        length = np.linalg.norm(a, axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            above = length * np.linalg.norm(b, axis=-1) / np.linalg.norm(np.cross(a, b), axis=-1)
            below = length * np.linalg.norm(r, axis=-1) / np.abs(np.sum(a * r, axis=-1))
            return np.asarray(np.fmin(above + 2.0 * below, MOST_LOST)[..., None])


QUOTIENTS = PrintedQuotients(
    **{**vars(KNUCKLE_RATES), "no_number": "the printed quotient divides by zero there"}
)


def _from_first(states: States) -> tuple[Array, Array]:
    first, second, third = states.values()
    return second - first, third - first


def _quotient(a: Array, b: Array, r: Array) -> Array:
    return np.asarray(np.cross(a, b) / np.sum(a * r, axis=-1, keepdims=True))


PRINTED = Method(
    name="printed",
    linkage=as_printed,
    only="the strut that the paper prints, type = macpherson with closure = collinear",
    square_velocity_term=printed_square_velocity_term,
    effects={KNUCKLE_RATES.name: QUOTIENTS},
)
"""The paper's algorithm with its formulas as printed."""
