"""Chains of linkages of many unknowns, by point coordinates and by scipy on the same equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import TRUNCATION_SHARE
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.pointwise import solve_instants
from pointcoord.solve.taylor import Settings, build_chain
from validate.cost.growth.chain import SWING, FourBarChain
from validate.cost.growth.designs import allowed_of_a_pose
from validate.cost.growth.task import WrongNumber
from validate.cost.row import QuantityError
from validate.cost.way import Setting
from validate.cost.ways.point_coordinates import counted, short, tolerance_settings

Array = NDArray[np.float64]

INSTANTS = np.array([0.05, 0.1, 0.15, 0.2, 0.25])
"""Of a quarter of the swing, s; the longest chains take a second and more for each."""
TOLERANCE = 1e-9  # mm, of series and of Newton's method
SCIPY_TOLERANCE = 1e-12  # of scipy's steps, in parts of the coordinates: their rounding is 1e-16
NOT_RIGHT = 1e-3
"""Of the shortest rocker: an answer that far off is another assembly, or none."""


@dataclass(frozen=True)
class LongChain:
    """A chain to be solved at `INSTANTS`.

    Attributes:
        method: one of `METHODS`.
    """

    method: str
    size: int

    @property
    def smallest(self) -> LongChain:
        """Two rockers."""
        return LongChain(self.method, 6)

    @cached_property
    def chain(self) -> FourBarChain:
        """What is solved."""
        return FourBarChain.with_unknowns(self.size)

    def give(self) -> None:
        """Nothing: putting the chain together is a part of the work."""

    def prepare(self) -> ChainRun:
        """The mechanism put together, and what the method does before it knows the inputs.

        Putting it together checks that the drawing is a mechanism, which factorises its Jacobian once, for
        scipy too.
        """
        # A topology remembers its map, so it is a new one for each run.
        mechanism = FourBarChain.with_unknowns(self.size).mechanism()
        return ChainRun(mechanism, METHODS[self.method](mechanism))

    def check(self, output: Array) -> Mapping[str, QuantityError]:
        """The error of every tip against the closed form, mm.

        Raises:
            WrongNumber: this is another assembly, or none.
        """
        right = self.chain.closed_form(INSTANTS)
        off = np.abs(output - right)
        if not (off <= NOT_RIGHT * np.min(np.abs(right[..., 1:]).max(axis=-1))).all():
            worst = np.unravel_index(int(np.argmax(np.where(np.isnan(off), np.inf, off))), off.shape)
            raise WrongNumber(f"tip_{worst[1]} is {off[worst]:.3g} mm from the closed form")
        rounded = 0.5 * float(np.spacing(np.abs(right)).max())
        rms = float(np.sqrt(np.mean(off**2)))
        return {"position": QuantityError(float(off.max()), rms, rounded, off.size)}


@dataclass(frozen=True)
class Poses:
    """Unknowns at `INSTANTS`, (N, unknowns), in the mechanism's units, and what was done for them."""

    u: Array
    counts: Mapping[str, int]


@dataclass(frozen=True)
class ChainRun:
    """A chain made ready to be solved."""

    mechanism: Mechanism
    solver: Callable[[], Poses]

    def solve(self) -> Poses:
        """The positions."""
        return self.solver()

    def rates(self, solved: Poses) -> Poses:
        """None are asked for."""
        return solved

    def output(self, solved: Poses) -> Array:
        """Every tip, (N, rockers, 3), mm."""
        places = solved.u.reshape(len(solved.u), -1, 3)
        return np.asarray(self.mechanism.origin + self.mechanism.unit * places)

    def counts(self, solved: Poses) -> Mapping[str, int]:
        """What the method did."""
        return solved.counts


def _series(mechanism: Mechanism) -> Callable[[], Poses]:
    settings = Settings(TRUNCATION_SHARE * TOLERANCE / float(mechanism.unit), derivative=0)
    allowed = allowed_of_a_pose("series", settings)
    closed = close_drawing(mechanism, tolerance=allowed)

    def solve() -> Poses:
        start, stop = 0.0, float(INSTANTS[-1])
        pose = assemble(mechanism, {"arm_angle": SWING.series(start, 0)[..., 0]}, start, closed, allowed)
        chain = build_chain(mechanism, {"arm_angle": SWING}, pose, start, stop, settings)
        _require(chain.status.error())
        pieces = [segment.coefficients[..., : mechanism.map.unknowns] for segment in chain.segments]
        return Poses(evaluate(chain, pieces, INSTANTS, 0)[0], counted(pose.work + chain.work))

    return solve


def _newton(mechanism: Mechanism) -> Callable[[], Poses]:
    settings = Settings(TRUNCATION_SHARE * TOLERANCE / float(mechanism.unit), derivative=0)
    allowed = allowed_of_a_pose("newton", settings)
    closed = close_drawing(mechanism, tolerance=allowed)

    def solve() -> Poses:
        first = float(INSTANTS[0])
        pose = assemble(mechanism, {"arm_angle": SWING.series(first, 0)[..., 0]}, first, closed, allowed)
        solved = solve_instants(
            mechanism, {"arm_angle": SWING}, pose, INSTANTS, derivative=0, tolerance=allowed
        )
        _require(solved.status.error())
        return Poses(solved.states[0][:, : mechanism.map.unknowns], counted(pose.work + solved.work))

    return solve


def _require(error: Exception | None) -> None:
    if error is not None:
        raise error


def _root(mechanism: Mechanism, jacobian: bool) -> Callable[[], Poses]:
    """`scipy.optimize.root` as a user would call it, from the drawing and then from the instant before."""
    system, n = mechanism.map, mechanism.map.unknowns

    def residual(u: Array, w: Array) -> Array:
        return system.residual(np.concatenate([u, w]))

    def derivative(u: Array, w: Array) -> Array:
        return system.jacobian(np.concatenate([u, w]))

    def solve() -> Poses:
        known = mechanism.known_series({"arm_angle": SWING.series(INSTANTS, 0)})[:, 0]
        u, found = mechanism.drawn[:n], np.empty((len(INSTANTS), n))
        counts = {"residuals": 0, "jacobians": 0}
        for here, w in zip(found, known, strict=True):
            answer = scipy.optimize.root(
                residual, u, (w,), "hybr", derivative if jacobian else None, SCIPY_TOLERANCE
            )
            if not answer.success:
                raise WrongNumber(f"scipy.optimize.root gives up: {' '.join(answer.message.split())}")
            here[:] = u = answer.x
            counts["residuals"] += int(answer.nfev)
            counts["jacobians"] += int(answer.get("njev", 0))
        return Poses(found, counts)

    return solve


METHODS: Mapping[str, Callable[[Mechanism], Callable[[], Poses]]] = {
    "series": _series,
    "newton": _newton,
    "scipy-root": partial(_root, jacobian=False),
    "scipy-root-jac": partial(_root, jacobian=True),
}
"""By the names that the ways have elsewhere."""

SETTINGS: Mapping[str, Setting] = {
    "series": tolerance_settings((TOLERANCE,))[0],
    "newton": tolerance_settings((TOLERANCE,))[0],
    "scipy-root": Setting(f"xtol {short(SCIPY_TOLERANCE)}", SCIPY_TOLERANCE),
    "scipy-root-jac": Setting(f"xtol {short(SCIPY_TOLERANCE)}", SCIPY_TOLERANCE),
}
