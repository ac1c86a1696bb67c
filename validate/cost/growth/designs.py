"""Many designs of one car at the same instants: together, through batch dimensions, or in a loop.

A design is the car with every hardpoint moved at random and its drawing put together again, so that each is a
car that closes as drawn. Design number k is the same car in however large a batch.

Together means: one mechanism whose points have a leading dimension, its drawings closed and its first
poses assembled at once, then one chain of series whose segments all designs share, or a Newton iteration for
all at each instant. They are solved in blocks: what lies between a block's operations should stay in a cache.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, Scene, simulate
from pointcoord.linkage.carried_points import carried_series
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.simulation import TRUNCATION_SHARE
from pointcoord.solve.assembly import Path, blocked, close_drawing, follow
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.designs import solve_designs
from pointcoord.solve.status import Status
from pointcoord.solve.taylor import COARSEST, SOLVED, Settings
from validate.cost.growth.instants import ReadyRun, some_of
from validate.cost.growth.task import WrongNumber
from validate.cost.instants import study_instants
from validate.cost.row import QuantityError
from validate.cost.way import Setting, Way
from validate.cost.ways.point_coordinates import counted

Array = NDArray[np.float64]
Points = Mapping[str, Array]

INSTANTS = 101
MOVED = 2.0  # mm, at most, along each axis: what a designer tries, and no drawing turns into another one
SEED = 2026
BLOCK = 512  # designs
"""So many that an operation on all costs little beside its numbers, and their matrices fit in a cache."""


@lru_cache(maxsize=2)
def _moves(count: int, points: int) -> Array:
    """Moves of every point of every design, (designs, points, 3), mm; design 0 stays as drawn."""
    moves = np.random.default_rng(SEED).uniform(-MOVED, MOVED, (count, points, 3))
    moves[0] = 0.0
    return moves


def designs_of(scene: Scene, count: int) -> dict[str, Array]:
    """Points of so many designs of a scene's car, each (designs, 3), mm."""
    drawn = scene.mechanism.points
    moves = _moves(count, len(drawn))
    moved = {name: np.array(place) + moves[:, i] for i, (name, place) in enumerate(drawn.items())}
    closed: dict[str, list[Array]] = {name: [] for name in moved}
    for block in _blocks(count):
        mechanism = _mechanism(scene, {name: place[block] for name, place in moved.items()})
        unit = mechanism.unit[..., None]
        for name, place in mechanism.places(close_drawing(mechanism).y).items():
            closed[name].append(mechanism.origin + unit * place)
    return {name: np.concatenate(places) for name, places in closed.items()}


def design_scene(scene: Scene, designs: Points, number: int) -> Scene:
    """The scene of one design."""
    points = {name: tuple(float(x) for x in place[number]) for name, place in designs.items()}
    return scene.model_copy(update={"mechanism": scene.mechanism.model_copy(update={"points": points})})


@dataclass(frozen=True)
class DesignsInALoop:
    """Designs solved one by one by any way."""

    scene: Scene
    way: Way
    setting: Setting
    size: int

    @property
    def smallest(self) -> DesignsInALoop:
        """One design."""
        return replace(self, size=1)

    def give(self) -> None:
        """Make the designs."""
        _kept_designs(self.scene, self.size)

    def prepare(self) -> LoopRun:
        """Each design's set-up."""
        designs = _kept_designs(self.scene, self.size)
        scenes = (design_scene(self.scene, designs, number) for number in range(self.size))
        instants = study_instants(self.scene, INSTANTS)
        return LoopRun([ReadyRun(self.way.prepare(scene, self.setting), instants) for scene in scenes])

    def check(self, output: Sequence[Mapping[str, Points]]) -> Mapping[str, QuantityError]:
        """Hold some designs to their own motions.

        Raises:
            WrongNumber: one differs by more than both solvers may be off.
        """
        return _checked(self.scene, self.setting, self.size, lambda number: output[number]["position"])


@dataclass(frozen=True)
class LoopRun:
    """Designs made ready one by one."""

    runs: list[ReadyRun]

    def solve(self) -> list[Any]:
        """The positions of each."""
        return [run.solve() for run in self.runs]

    def rates(self, solved: list[Any]) -> list[Any]:
        """The rates of each, of which none are asked for."""
        return [run.rates(one) for run, one in zip(self.runs, solved, strict=True)]

    def output(self, solved: list[Any]) -> list[Any]:
        """Arrays of each."""
        return [run.output(one) for run, one in zip(self.runs, solved, strict=True)]

    def counts(self, solved: list[Any]) -> Mapping[str, int]:
        """Of all together."""
        total: dict[str, int] = {}
        for run, one in zip(self.runs, solved, strict=True):
            for what, count in run.counts(one).items():
                total[what] = total.get(what, 0) + count
        return total


@dataclass(frozen=True)
class DesignsTogether:
    """Designs solved in batches by point coordinates.

    Attributes:
        method: one of `TOGETHER`.
    """

    scene: Scene
    method: str
    size: int

    @property
    def smallest(self) -> DesignsTogether:
        """One design."""
        return replace(self, size=1)

    def give(self) -> None:
        """Make the designs."""
        _kept_designs(self.scene, self.size)

    def prepare(self) -> BatchRun:
        """Mechanisms put together and their drawings closed."""
        designs = _kept_designs(self.scene, self.size)
        blocks = []
        for block in _blocks(self.size):
            mechanism = _mechanism(self.scene, {name: place[block] for name, place in designs.items()})
            settings = _settings(self.scene, mechanism)
            allowed = allowed_of_a_pose(self.method, settings)
            closed = close_drawing(mechanism, self.scene.time.start, allowed)
            blocks.append(Block(mechanism, closed, settings, allowed))
        return BatchRun(self.scene, TOGETHER[self.method], study_instants(self.scene, INSTANTS), blocks)

    def check(self, output: Points) -> Mapping[str, QuantityError]:
        """Hold some designs to their own motions.

        Raises:
            WrongNumber: one differs by more than both solvers may be off.
        """

        def design(number: int) -> Points:
            return {name: places[number] for name, places in output.items()}

        return _checked(self.scene, Setting(), self.size, design)


@dataclass(frozen=True)
class Block:
    """Some designs with their drawings closed.

    Attributes:
        settings: of a chain of series.
        allowed: how far a pose may be from the exact assembly, rounding apart, in units.
    """

    mechanism: Mechanism
    closed: Path
    settings: Settings
    allowed: float


Solver = Callable[[Block, Scene, Array], tuple[Array, Work]]
"""From closed drawings and instants to the unknowns, (designs, N, unknowns), and what it cost."""


@dataclass(frozen=True)
class Solved:
    """Positions of every point, by block of designs, each (designs, N, 3), mm, and what they cost."""

    blocks: list[dict[str, Array]]
    work: Work


@dataclass(frozen=True)
class BatchRun:
    """Blocks of designs with their drawings closed."""

    scene: Scene
    solver: Solver
    instants: Array
    blocks: list[Block]

    def solve(self) -> Solved:
        """The positions.

        Raises:
            AssemblyError: a design cannot follow the inputs.
        """
        found, work = [], Work()
        for block in self.blocks:
            u, done = self.solver(block, self.scene, self.instants)
            found.append(_places(block.mechanism, self.scene, self.instants, u))
            work += done
        return Solved(found, work)

    def rates(self, solved: Solved) -> Solved:
        """None are asked for."""
        return solved

    def output(self, solved: Solved) -> dict[str, Array]:
        """Every point of all designs, (designs, N, 3), mm."""
        return {name: np.concatenate([block[name] for block in solved.blocks]) for name in solved.blocks[0]}

    def counts(self, solved: Solved) -> Mapping[str, int]:
        """Each member of a batch counts."""
        return counted(solved.work)


@lru_cache(maxsize=2)
def _of_text(text: str, count: int) -> dict[str, Array]:
    return designs_of(Scene.from_mapping(json.loads(text)), count)


def _kept_designs(scene: Scene, count: int) -> dict[str, Array]:
    """The same, made once: making them is no part of solving them."""
    return _of_text(scene.model_dump_json(), count)


def _blocks(count: int) -> Iterator[slice]:
    return (slice(first, min(first + BLOCK, count)) for first in range(0, count, BLOCK))


def _mechanism(scene: Scene, points: Points) -> Mechanism:
    part = scene.mechanism
    return build_mechanism(part.topology, points, {"up": part.up, "right": part.right})


def _inputs(mechanism: Mechanism, scene: Scene, instant: float, order: int) -> dict[str, Array]:
    names = mechanism.topology.required_inputs
    return {name: scene.functions[name].series(instant, order) for name in names}


def _settings(scene: Scene, mechanism: Mechanism) -> Settings:
    """How a chain is cut for all designs of a batch, as finely as the largest of them asks."""
    return Settings(TRUNCATION_SHARE * scene.tolerance / float(mechanism.unit.max()), derivative=0)


def allowed_of_a_pose(method: str, settings: Settings) -> float:
    """How far a pose may be from the exact assembly, as `simulate` allows it, in units."""
    return SOLVED * settings.kept.tolerance if method == "series" else min(settings.tolerance, COARSEST)


def _by_series(block: Block, scene: Scene, instants: Array) -> tuple[Array, Work]:
    """Unknowns at instants, (designs, N, unknowns), as `sweep` finds them."""
    mechanism = block.mechanism
    start, stop = scene.time.start, scene.time.stop
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    solved = solve_designs(mechanism, functions, start, stop, block.settings, block.allowed)
    for status in solved.failures.values():
        _require_whole(status)
    if solved.chain is None:
        raise ValueError("no designs")
    n = mechanism.map.unknowns
    pieces = [segment.coefficients[..., :n] for segment in solved.chain.segments]
    return evaluate(solved.chain, pieces, instants, 0)[0], solved.chain.work


def _by_newton(block: Block, scene: Scene, instants: Array) -> tuple[Array, Work]:
    """The same by Newton's method for all designs, at each instant from the one before."""
    mechanism, closed = block.mechanism, block.closed
    n = mechanism.map.unknowns
    found = np.empty((len(closed.y), len(instants), n))
    here, factors, work = closed.y, closed.factors, closed.work
    for i, instant in enumerate(instants.tolist()):
        known = mechanism.known_series(_inputs(mechanism, scene, instant, 0))[..., 0, :]
        path = follow(mechanism.map, here, known, factors, block.allowed)
        work += path.work
        if (path.done < 1.0).any():
            problem = "a design cannot be assembled"
            raise blocked(mechanism, problem, path, known, path.done < 1.0, instant).error()
        here, factors = path.y, path.factors
        found[:, i] = here[:, :n]
    return found, work


TOGETHER: Mapping[str, Solver] = {"series": _by_series, "newton": _by_newton}
"""By the names that the ways have elsewhere."""


def _require_whole(status: Status) -> None:
    error = status.error()
    if error is not None:
        raise error


def _places(mechanism: Mechanism, scene: Scene, instants: Array, u: Array) -> dict[str, Array]:
    """Every point from the unknowns, (designs, N, 3), mm, in the user's axes."""
    topology, layout = mechanism.topology, mechanism.layout
    vectors = mechanism.drawing.vectors
    shape = (*u.shape[:2], 3)
    found = {name: np.broadcast_to(vectors[name][..., None, :], shape) for name in topology.chassis}
    found |= {name: u[..., list(layout.vector(name))] for name in topology.moving}
    for name, carriers in topology.carried.items():
        weights = mechanism.carrier_weights[name][..., None, :]
        found[name] = carried_series(weights, *(found[c][..., None, :] for c in carriers))[..., 0, :]
    unit, offset = mechanism.unit[..., None, None], mechanism.origin[..., None, :]
    shifts = ChassisMotion.of(mechanism, scene.functions).states(instants, 0)
    if shifts:
        offset = offset + shifts[0]
    return {name: unit * found[name] + offset for name in topology.points}


def _checked(
    scene: Scene, setting: Setting, size: int, positions: Callable[[int], Points]
) -> dict[str, QuantityError]:
    designs, instants = _kept_designs(scene, size), study_instants(scene, INSTANTS)
    for number in some_of(size):
        motion, found = simulate(design_scene(scene, designs, number)), positions(number)
        allowed = allowed_difference(motion, scene, setting)
        for name, places in motion.at(instants).position.items():
            difference = np.abs(found[name] - places)
            if not (difference <= allowed).all():
                raise WrongNumber(
                    f"{name} of design {number} is {float(np.max(difference)):.3g} mm from where the design "
                    f"has it when it is solved by itself; allowed: {allowed:.3g} mm"
                )
    return {}


def allowed_difference(motion: Motion, scene: Scene, setting: Setting) -> float:
    """How far a solution of a design may lie from the motion that checks it, mm.

    The motion is within the scene's tolerance. What is checked is within the tolerance that it is set to, or,
    where it has none, as good as the scene asks; twice the sum, because a tolerance is of what a step leaves
    out, and a carried point lies up to some lengths of its carriers away. And both are rounded, by what is
    proven of the motion.
    """
    proof = motion.proof()
    rounded = float((proof.bound + proof.carried_bound).max())
    return 2.0 * (scene.tolerance + max(setting.value or 0.0, scene.tolerance) + rounded)
