"""What a user would write: a solver of SciPy on the same equations, at every instant from the one before.

The equations and their Jacobian are pointcoord's, and so is what is read off the solved coordinates; the
rates are two linear solves with that Jacobian (the paper's eqs. 19 and 22). A solver that ends without
success, or on another side than the drawing's, raises: it is no answer.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, root

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.results.readout import Readout
from pointcoord.results.states import StatesAtInstants
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.pointwise import Solved
from validate.cost.way import Setting
from validate.formulations.outside_programs import linkage_in
from validate.formulations.protocol import Numbers
from validate.peers.linkage import Linkage

Array = NDArray[np.float64]

DIAL = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)
# Of a known coordinate on the way from the drawing to the scene's start, in sizes of the car: a solver that
# is sent farther at once may end in another assembly.
STRIDE = 0.05
# Of the equations, whose terms are up to 1: a thousand times what differences for a Jacobian leave.
NOISE = 1e-9


class SolverStopped(Exception):
    """A solver of SciPy ended without success, or on another side than is drawn."""

    def __init__(self, solver: str, where: str, problem: str) -> None:
        self.solver = solver
        self.where = where
        super().__init__(f"scipy.optimize.{solver} at {where}: {problem}")


@dataclass(frozen=True)
class Poses:
    """Coordinates at instants, and how often the equations and their Jacobian were evaluated for them.

    Attributes:
        states: y and, where they are solved for, its time derivatives, each (N, size).
    """

    times: Array
    states: tuple[Array, ...]
    residuals: int
    jacobians: int
    factorisations: int = 0


@dataclass(frozen=True)
class ScipyWay:
    """A solver of SciPy with its tolerances at the setting.

    Attributes:
        solver: `root` by its default method, Powell's hybrid one, or `least_squares` by its default method,
            a trust region.
        with_jacobian: whether it is told the Jacobian, or takes differences of the equations for it.
    """

    name: str
    solver: Literal["root", "least_squares"]
    with_jacobian: bool
    package: None = None
    dense: bool = False

    @property
    def words(self) -> str:
        """What it is, in a line."""
        told = "with their Jacobian" if self.with_jacobian else "with differences for their Jacobian"
        return f"scipy.optimize.{self.solver} on pointcoord's equations, {told}"

    @property
    def settings(self) -> tuple[Setting, ...]:
        """The solver's relative tolerance; of least_squares all three."""
        what = "xtol" if self.solver == "root" else "xtol, ftol, gtol"
        return tuple(Setting(f"{what} {value:.0e}", value) for value in DIAL)

    def prepare(self, scene: Scene, setting: Setting) -> ReadySolver:
        """The equations, solved for the drawing and on from there to where the scene starts.

        Raises:
            SceneError: the hardpoints make no mechanism.
            SolverStopped: the start is not reached.
        """
        mechanism = scene_mechanism(scene)
        tolerance = DIAL[-1] if setting.value is None else setting.value
        solver = Solver(self.solver, mechanism, self.with_jacobian, tolerance)
        ready = ReadySolver(scene, solver, linkage_in(scene), mechanism.drawn)
        return ready.started(np.array([scene.time.start]))


@dataclass(frozen=True)
class Solver:
    """A solver of SciPy on a mechanism's equations."""

    kind: Literal["root", "least_squares"]
    mechanism: Mechanism
    with_jacobian: bool
    tolerance: float

    def follow(self, start: Array, known: Array, where: Callable[[int], str]) -> tuple[Array, int, int]:
        """Solve at known coordinates (N, known), each from the one before; y, (N, size), and both counts.

        Raises:
            SolverStopped: the solver ends without success.
        """
        system = self.mechanism.map
        n, y = system.unknowns, start.copy()
        counted = [0, 0]

        def residual(u: Array) -> Array:
            counted[0] += 1
            y[:n] = u
            return system.residual(y)

        def jacobian(u: Array) -> Array:
            counted[1] += 1
            y[:n] = u
            return system.jacobian(y)

        solved = np.empty((len(known), system.size))
        u, size = start[:n], self.tolerance
        for i in range(len(known)):
            y[n:] = known[i]
            if self.kind == "root":
                slope = jacobian if self.with_jacobian else None
                found = root(residual, u, jac=slope, method="hybr", options={"xtol": size})
            else:
                told = jacobian if self.with_jacobian else "2-point"
                found = least_squares(residual, u, jac=told, xtol=size, ftol=size, gtol=size)
            if not found.success:
                raise SolverStopped(self.kind, where(i), " ".join(str(found.message).split()))
            left = float(np.abs(found.fun).max())
            if not left <= 10.0 * size + NOISE:
                # A least sum of squares may be none of the equations' roots.
                raise SolverStopped(self.kind, where(i), f"the equations are left at {left:.3g}")
            u = found.x
            solved[i, :n], solved[i, n:] = u, known[i]
        return solved, counted[0], counted[1]


@dataclass(frozen=True)
class ReadySolver:
    """A scene's equations with a pose to start from.

    Attributes:
        linkage: the car, which tells the sides of an assembly.
        start: y that the first instant is solved from, (size,).
    """

    scene: Scene
    solver: Solver
    linkage: Linkage
    start: Array

    def started(self, instants: Array) -> ReadySolver:
        """The same with the pose at an instant to start from, (1,), reached from the drawing in strides."""
        mechanism = self.solver.mechanism
        first = mechanism.map.unknowns
        drawn, goal = mechanism.drawn[first:], self._known(instants, 0)[0, 0]
        count = 1 + int(np.ceil(np.abs(goal - drawn).max() / STRIDE))
        way = drawn + np.linspace(0.0, 1.0, count + 1)[:, None] * (goal - drawn)
        y, _, _ = self.solver.follow(self.start, way, lambda i: f"stride {i} to the start")
        self._require_the_drawn_side(y, lambda i: f"stride {i} to the start")
        return replace(self, start=y[-1])

    def solve(self, instants: Array) -> Poses:
        """Coordinates at instants.

        Raises:
            SolverStopped: the solver ends without success, or on another side than is drawn.
        """

        def where(i: int) -> str:
            return f"t = {instants[i]:.6g} s"

        y, residuals, jacobians = self.solver.follow(self.start, self._known(instants, 0)[:, 0], where)
        self._require_the_drawn_side(y, where)
        return Poses(instants, (y,), residuals, jacobians)

    def rates(self, solved: Poses) -> Poses:
        """Velocities and accelerations, where the scene asks for any: two linear solves at each instant."""
        if plan_effects(self.scene.effects).derivative == 0:
            return solved
        system, y = self.solver.mechanism.map, solved.states[0]
        known, n = self._known(solved.times, 2), system.unknowns
        matrices = system.jacobian(y)
        velocity, acceleration = np.zeros_like(y), np.zeros_like(y)
        velocity[:, n:], acceleration[:, n:] = known[:, 1], 2.0 * known[:, 2]
        driven = 2.0 * system.polar(y, velocity)
        velocity[:, :n] = -np.linalg.solve(matrices, driven[..., None])[..., 0]
        driven = 2.0 * system.polar(y, acceleration) + 2.0 * system.residual(velocity)
        acceleration[:, :n] = -np.linalg.solve(matrices, driven[..., None])[..., 0]
        count = len(y)
        return replace(
            solved,
            states=(y, velocity, acceleration),
            jacobians=solved.jacobians + count,
            factorisations=2 * count,
        )

    def output(self, solved: Poses) -> Numbers:
        """What the scene asks for, read off the coordinates as pointcoord does."""
        mechanism = self.solver.mechanism
        highest = len(solved.states) - 1
        asked = [name for name in self.scene.effects if EFFECTS[name].derivative <= highest]
        readout = Readout(
            mechanism=mechanism,
            plan=plan_effects(asked),
            chassis=ChassisMotion.of(mechanism, self.scene.functions),
            axes=CarAxes.of(mechanism.drawing, self.scene.mechanism.outboard),
        )
        # Nothing is proven of what a user's solver returns; only a proof would ask.
        unproven = np.full(len(solved.times), np.inf)
        states = StatesAtInstants(readout, Solved(solved.times, solved.states, unproven, Work()))
        numbers = readout.samples(solved.times, states.states(solved.times)).numbers
        return {quantity: dict(channel) for quantity, channel in numbers.items() if channel.computed}

    def counts(self, solved: Poses) -> Mapping[str, int]:
        """Evaluations of the equations, those for differences among them, Jacobians and linear solves."""
        return {
            "residuals": solved.residuals,
            "jacobians": solved.jacobians,
            "factorisations": solved.factorisations,
        }

    def _known(self, instants: Array, derivatives: int) -> Array:
        """Series of the known coordinates, (N, derivatives + 1, known)."""
        mechanism = self.solver.mechanism
        laws = {
            n: self.scene.functions[n].series(instants, derivatives)
            for n in mechanism.topology.required_inputs
        }
        return mechanism.known_series(laws)

    def _require_the_drawn_side(self, y: Array, where: Callable[[int], str]) -> None:
        mechanism, linkage = self.solver.mechanism, self.linkage
        scale = float(mechanism.unit) / linkage.unit
        shift = (mechanism.origin - linkage.origin) / linkage.unit
        places = {name: place * scale + shift for name, place in mechanism.places(y).items()}
        other = linkage.on_other_side(places)
        if other.any():
            i = int(np.argmax(other))
            raise SolverStopped(self.solver.kind, where(i), "it came to another assembly than is drawn")


WAYS = (
    ScipyWay("scipy-root", "root", with_jacobian=False),
    ScipyWay("scipy-root-jac", "root", with_jacobian=True),
    ScipyWay("least-squares", "least_squares", with_jacobian=False),
    ScipyWay("least-squares-jac", "least_squares", with_jacobian=True),
)
