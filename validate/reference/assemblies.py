"""How many assemblies a pose has: many starts, each find proven, and the number that can exist."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np
import numpy.typing as npt
from flint import arb

from validate.reference.candidates import every_candidate
from validate.reference.design import Design, Driven, values_only
from validate.reference.errors import BadInputError, InfeasibleError, SingularPoseError
from validate.reference.instant import Instant, prove_instant
from validate.reference.linkage import Known
from validate.reference.solve import Points, with_enough_digits
from validate.reference.suspensions import CLOSURE, SUSPENSION
from validate.reference.vectors import Vector, minus

Floats = npt.NDArray[np.float64]

STEPS = 60
SETTLED = 1e-9  # last Newton step in units of the mechanism: the next one would be at rounding level
SAME = 1e-7  # finds this near are proven once; a pose nearer to singular than that merges two in one
LARGEST_STEP = 0.5  # of the mechanism's size: keeps a far start from leaving it


@dataclass(frozen=True)
class Assemblies:
    """The assemblies of one pose.

    Attributes:
        found: distinct assemblies, each with its proof: there are at least so many.
        possible: how many combinations of the choices are proven feasible: exactly so many exist.
        starts: random starts tried.
        converged: starts that settled on a zero.
    """

    found: tuple[Instant, ...]
    possible: int
    starts: int
    converged: int

    def __str__(self) -> str:
        return (
            f"found at least {len(self.found)} assemblies, {self.converged} of {self.starts} starts settled; "
            f"the closed forms allow {self.possible}"
        )


def count_assemblies(
    points: Points,
    inputs: Mapping[str, Sequence[object]],
    starts: int = 1000,
    seed: int = 0,
    up: Sequence[object] = (0, 0, 1),
    right: Sequence[object] = (0, 1, 0),
    side: str = "left",
    digits: int = 60,
    closure: str = CLOSURE,
    suspension: str = SUSPENSION,
) -> Assemblies:
    """Search the assemblies of a pose from random starts and prove each find.

    Newton's method in float64 runs from all starts at once; every distinct end is refined in many
    digits and certified. The search knows nothing of the closed forms that count `possible`, so the
    two numbers check each other.

    Args:
        points: as for `solve_reference`, mm; also up, right, side, digits, closure, suspension.
        inputs: as for `solve_reference`.
        starts: number of random starts.
        seed: of the random numbers.
    Raises:
        BadInputError: something given cannot be used.
        SingularPoseError: `possible` cannot be decided with 400 digits.
    """
    if starts < 1:
        raise BadInputError("starts", starts, "at least 1")
    design = Design.from_points(points, up, right, side, closure, suspension)
    driven = design.driven(inputs)
    ends = _search(_as_floats(design, driven), starts, np.random.default_rng(seed))

    found: list[Instant] = []
    for end in _distinct(ends):

        def attempt(working: int, end: Floats = end) -> Instant:
            start = [arb(float(number)) for number in end]
            return prove_instant(design, design.known(driven), start, None, digits, working)

        try:
            instant = with_enough_digits(attempt, digits)
        except SingularPoseError:
            continue  # not proven, so not counted
        if not any(_same(instant, other) for other in found):
            found.append(instant)
    found.sort(key=lambda one: astuple(one.choices), reverse=True)
    possible = with_enough_digits(lambda _: _possible(design, driven), digits)
    return Assemblies(tuple(found), possible, starts, len(ends))


def _search(known: Known, starts: int, random: np.random.Generator) -> list[Floats]:
    """Newton's method in float64 from all starts at once; the unknowns of those that settle."""
    linkage = known.linkage
    points = linkage.coordinates
    corners = np.array(list(known.chassis.values()))
    reach = sum(float(squared) ** 0.5 for squared in known.squared_length.values())
    unknown = random.uniform(-1.0, 1.0, (linkage.size, starts))
    unknown[:points] *= 0.5 * reach
    unknown[:points] += np.tile(corners.mean(axis=0), points // 3)[:, None]
    unknown[points:] *= 2.0  # ratios and direction cosines of an assembly are of order one
    ends: list[Floats] = []
    for _ in range(STEPS):
        step = _newton_step(unknown, known)
        size = np.abs(step).max(axis=0)
        unknown = unknown - step * np.minimum(1.0, LARGEST_STEP / np.maximum(size, 1e-300))
        settled = size < SETTLED
        ends.extend(unknown[:, settled].T)
        unknown = unknown[:, ~settled & np.isfinite(size)]
    return [end for end in ends if linkage.handedness(list(end)) > 0]


def _newton_step(unknown: Floats, known: Known) -> Floats:
    """C'^-1 C for a batch of unknowns, shape (n, starts)."""
    linkage, starts = known.linkage, unknown.shape[1]
    rows = np.array([np.broadcast_to(row, starts) for row in linkage.residual(list(unknown), known)])
    # A shift far below the accuracy asked for: an exactly singular matrix must not stop the batch.
    matrix = np.tile(1e-14 * np.eye(linkage.size), (starts, 1, 1))
    for row, column, entry in linkage.jacobian(list(unknown), known):
        matrix[:, row, column] += entry
    step: Floats = np.linalg.solve(matrix, rows.T[:, :, None])[:, :, 0].T
    return step


def _distinct(ends: Sequence[Floats]) -> list[Floats]:
    """One of each group of ends that lie within `SAME` of it."""
    kept: list[Floats] = []
    for end in ends:
        if all(np.abs(end - other).max() > SAME for other in kept):
            kept.append(end)
    return kept


def _same(one: Instant, other: Instant) -> bool:
    """Two proofs of one assembly: it lies within both radii, so the answers are within their sum."""
    radius = one.radius + other.radius
    apart = (x for name in one.position for x in minus(one.position[name], other.position[name]))
    return all(abs(x) <= radius for x in apart)


def _possible(design: Design, driven: Driven) -> int:
    number = 0
    for one in every_candidate(values_only(design.known(driven))):
        try:
            one.require_feasible(float(design.unit))
        except InfeasibleError:
            continue
        number += 1
    return number


def _as_floats(design: Design, driven: Driven) -> Known:
    known = values_only(design.known(driven))

    def floats(vector: Vector) -> Vector:
        return float(vector[0]), float(vector[1]), float(vector[2])

    return replace(
        known,
        chassis={n: floats(p) for n, p in known.chassis.items()},
        up=floats(known.up),
        right=floats(known.right),
        squared_length={link: float(squared) for link, squared in known.squared_length.items()},
        driven={name: float(number) for name, number in known.driven.items()},
        knuckle={n: floats(numbers) for n, numbers in known.knuckle.items()},
    )
