"""How many assemblies of a pose a search finds: many starts, each find proven."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from flint import arb

from validate.reference.design import Design, Driven
from validate.reference.errors import BadInputError, SingularPoseError
from validate.reference.in_doubles import equations_in_doubles, jacobian_of
from validate.reference.instant import Instant, prove_instant
from validate.reference.solve import with_enough_digits
from validate.reference.vectors import minus

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
        starts: random starts tried.
    """

    found: tuple[Instant, ...]
    starts: int


def count_assemblies(
    design: Design,
    inputs: Mapping[str, Sequence[object]],
    starts: int = 1000,
    seed: int = 0,
    digits: int = 60,
) -> Assemblies:
    """Search the assemblies of a pose from random starts and prove each find.

    Newton's method in float64 runs from all starts at once; every distinct end is refined in many
    digits and certified. It is no proof that there are no others.

    Args:
        inputs: as for `solve_reference`; also digits.
        starts: number of random starts.
        seed: of the random numbers.
    Raises:
        BadInputError: something given cannot be used.
    """
    if starts < 1:
        raise BadInputError("starts", starts, "at least 1")
    driven = design.driven(inputs)
    tried: list[Floats] = []
    found: list[Instant] = []
    for end in _search(design, driven, starts, np.random.default_rng(seed)):
        if any(np.abs(end - other).max() <= SAME for other in tried):
            continue
        tried.append(end)
        start = [arb(float(number)) for number in end]

        def attempt(working: int, start: Sequence[arb] = start) -> Instant:
            return prove_instant(design, design.known(driven), start, lambda _: True, digits, working)

        try:
            instant = with_enough_digits(attempt, digits)
        except SingularPoseError:
            continue  # not proven, so not counted
        if not any(_same(instant, other) for other in found):
            found.append(instant)
    return Assemblies(tuple(found), starts)


def _search(design: Design, driven: Driven, starts: int, random: np.random.Generator) -> list[Floats]:
    """Newton's method in float64 from all starts at once; the unknowns of those that settle."""
    mechanism, equations = design.mechanism, equations_in_doubles(design)
    numbers = [float(jet.value) for jet in design.known(driven).numbers]
    corners = np.array([[float(x) for x in place] for place in design.table.values()])
    lengths = np.array(mechanism.lengths)
    unknown = random.uniform(-2.0, 2.0, (mechanism.size, starts))  # shares and cosines are of order one
    unknown[lengths] = corners.mean() + unknown[lengths] * np.ptp(corners, axis=0).max()
    ends: list[Floats] = []
    for _ in range(STEPS):
        values = list(unknown)
        rows = np.array(np.broadcast_arrays(*equations.residual(values, numbers), unknown[0])[:-1])
        # A shift far below the accuracy asked for: an exactly singular matrix must not stop the batch.
        matrix = jacobian_of(values, numbers, equations) + 1e-14 * np.eye(equations.size)
        step = np.linalg.solve(matrix, rows.T[:, :, None])[:, :, 0].T
        size = np.abs(step).max(axis=0)
        unknown = unknown - step * np.minimum(1.0, LARGEST_STEP / np.maximum(size, 1e-300))
        settled = size < SETTLED
        ends.extend(unknown[:, settled].T)
        unknown = unknown[:, ~settled & np.isfinite(size)]
        if not unknown.size:
            break
    return [end for end in ends if min(mechanism.handed(list(end), numbers, float), default=1.0) > 0.0]


def _same(one: Instant, other: Instant) -> bool:
    """Two proofs of one assembly: it lies within both radii, so the answers are within their sum."""
    radius = one.radius + other.radius
    apart = (x for name in one.position for x in minus(one.position[name], other.position[name]))
    return all(abs(x) <= radius for x in apart)
