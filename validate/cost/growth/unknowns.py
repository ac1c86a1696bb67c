"""Chains of linkages of many unknowns, by point coordinates and by scipy on the same equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import TRUNCATION_SHARE
from pointcoord.solve.assembly import Pose, assemble, close_drawing
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.pointwise import InstantSolver, solve_instants, square_velocity_term
from pointcoord.solve.taylor import COARSEST, SOLVED, Settings, build_chain
from validate.cost.growth.chain import SWING, FourBarChain
from validate.cost.race import Found, NoNumbers, Runner
from validate.cost.row import Row
from validate.cost.ways.scipy_solvers import InScipy

Array = NDArray[np.float64]

INSTANTS = np.array([0.05, 0.1, 0.15, 0.2, 0.25])
"""Of a quarter of the swing, s; the longest chains take a second and more for each."""
TOLERANCE = 1e-9  # mm, of series and of Newton's method
NOT_RIGHT = 1e-3
"""Of the shortest rocker: an answer that far off is another assembly, or none."""
SOLVERS: Mapping[str, InstantSolver | None] = {
    "series": None,
    "newton": solve_instants,
    "scipy-root": InScipy("root", False, 1e-12),
    "scipy-root-jac": InScipy("root", True, 1e-12),
}
"""By the names that the ways have elsewhere. Scipy's steps are ended at 1e-12 of the coordinates, whose
rounding is 1e-16."""


@dataclass(frozen=True)
class LongChain:
    """A chain to be solved at `INSTANTS`.

    Attributes:
        way: one of `SOLVERS`. size: how many unknowns.
    """

    way: str
    size: int

    @property
    def smallest(self) -> LongChain:
        """Two rockers."""
        return replace(self, size=6)

    def runner(self, row: Row) -> Runner:
        """The way, and its errors against the closed form."""
        return Runner(row, self.prepare, self.check)

    def prepare(self) -> Callable[[], Array]:
        """Put the chain together and close its drawing; gives what finds every tip, (N, rockers, 3), mm.

        Putting it together checks that the drawing is a mechanism, which factorises its Jacobian once, for
        scipy too.
        """
        # A topology remembers its map, so it is a new one for each run.
        mechanism = FourBarChain.with_unknowns(self.size).mechanism()
        settings = Settings(TRUNCATION_SHARE * TOLERANCE / float(mechanism.unit), derivative=0)
        dense = SOLVERS[self.way] is None
        # As `simulate` allows it.
        allowed = SOLVED * settings.kept.tolerance if dense else min(settings.tolerance, COARSEST)
        closed = close_drawing(mechanism, tolerance=allowed)

        # Each but the series is given the first pose, and goes on from there.
        start = 0.0 if dense else float(INSTANTS[0])

        def solve() -> Array:
            pose = assemble(mechanism, {"arm_angle": SWING.series(start, 0)[..., 0]}, start, closed, allowed)
            u = _poses(mechanism, SOLVERS[self.way], pose, settings, allowed)
            return np.asarray(mechanism.origin + mechanism.unit * u.reshape(len(u), -1, 3))

        return solve

    def check(self, output: Array) -> Found:
        """The error of every tip against the closed form, mm.

        Raises:
            NoNumbers: this is another assembly, or none.
        """
        right = FourBarChain.with_unknowns(self.size).closed_form(INSTANTS)
        off = np.abs(output - right)
        if not (off <= NOT_RIGHT * np.min(np.abs(right[..., 1:]).max(axis=-1))).all():
            worst = np.unravel_index(int(np.argmax(np.where(np.isnan(off), np.inf, off))), off.shape)
            raise NoNumbers(f"tip_{worst[1]} is {off[worst]:.3g} mm from the closed form")
        columns = {
            "error": float(off.max()),
            "rms": float(np.sqrt(np.mean(off**2))),
            "radius": 0.5 * float(np.spacing(np.abs(right)).max()),
            "numbers": off.size,
        }
        return Found({"position": columns})


def _poses(
    mechanism: Mechanism, solver: InstantSolver | None, pose: Pose, settings: Settings, allowed: float
) -> Array:
    """Unknowns at `INSTANTS`, (N, unknowns), in the mechanism's units."""
    n, laws = mechanism.map.unknowns, {"arm_angle": SWING}
    if solver is not None:
        solved = solver(mechanism, laws, pose, INSTANTS, 0, square_velocity_term, allowed)
        _require(solved.status.error())
        return solved.states[0][:, :n]
    chain = build_chain(mechanism, laws, pose, 0.0, float(INSTANTS[-1]), settings)
    _require(chain.status.error())
    return np.asarray(evaluate(chain, [s.coefficients[..., :n] for s in chain.segments], INSTANTS, 0)[0])


def _require(error: Exception | None) -> None:
    if error is not None:
        raise error
