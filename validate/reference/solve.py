"""From a description and inputs to proven instants."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import takewhile
from typing import Any

from flint import ctx

from validate.reference.design import Design, Known
from validate.reference.effects.registry import ANGLES
from validate.reference.errors import BadInputError, InfeasibleError, SingularPoseError
from validate.reference.exact import MOST_DIGITS, Answer, bits, centre_of, with_more_digits
from validate.reference.instant import Instant, prove_instant
from validate.reference.route import CLEAR, Assembly, closed, moved, reached

LEAST_PROMISED, MOST_PROMISED = 15, 200  # leaves one doubling at least

Inputs = Mapping[str, Sequence[object]]


def solve_reference(
    plain: Mapping[str, Any],
    inputs: Inputs,
    digits: int = 60,
    clearness: float = CLEAR,
    effects: Sequence[str] = ANGLES,
) -> Instant:
    """Solve the car at one instant, with a proof of every digit.

    All numbers given (int, float, Fraction, mpf) are taken as exact. The assembly is the one that a way from
    the drawing leads to without meeting a singular pose: the drawing is closed, then its inputs go to the
    wanted ones (see `route`), every step of it proven. The number of digits rises by itself where the pose is
    nearly singular. It sets the precision of python-flint, which is global: not for several threads at once.

    Args:
        plain: the description, see `Design.from_plain`, mm; the points fix the lengths and need not be
            assembled.
        inputs: by name, rad or mm, each (value, rate, acceleration).
        digits: digits of every number, relative to the greatest of its kind; 15 to 200.
        clearness: how far another assembly must be from the drawing, in parts of the mechanism's size; 0
            where the drawing is exact.
        effects: names of those that are wanted, see `effects.registry`; each costs what it takes.
    Returns:
        The instant, mm, s, rad.
    Raises:
        BadInputError: something given cannot be used.
        InfeasibleError: proven that the ways from the drawing meet a fold.
        AmbiguousAssemblyError: the drawing lies at a singular pose.
        SingularPoseError: no proof with 400 digits.

    >>> arm = {  # level, so that the wheel moves straight up at first
    ...     "name": "arm", "rods": {}, "slides": {}, "roles": {"wheel_axis": ["inner", "wheel"]},
    ...     "bodies": {"chassis": ["front", "rear"], "arm": ["front", "rear", "inner", "wheel"]},
    ...     "inputs": {"travel": {"height": "wheel", "along": "up"}},
    ...     "points": {"front": (-100, 0, 0), "rear": (100, 0, 0),
    ...                "inner": (0, -300, 0), "wheel": (0, -350, 0)},
    ...     "up": (0, 0, 1), "right": (0, 1, 0), "side": "left", "wheel_radius": None,
    ... }
    >>> float(solve_reference(arm, {"travel": (210, 0, 0)}).position["wheel"][1])
    -280.0
    """
    return next(instants_of(Design.from_plain(plain), (inputs,), digits, clearness, effects))


def instants_of(
    design: Design,
    inputs: Iterable[Inputs],
    digits: int = 60,
    clearness: float = CLEAR,
    effects: Sequence[str] = ANGLES,
) -> Iterator[Instant]:
    """A motion: the first instant reached from the drawing, each other one straight from the one before.

    Args:
        inputs: of each instant, as for `solve_reference`; also digits, clearness, effects.
    Raises:
        BadInputError, InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """
    here: Assembly | None = None
    for one in inputs:
        driven = design.driven(one)
        here = reached(design, clearness, driven) if here is None else moved(design, here, driven)
        yield _proven(design, here, partial(design.known, driven), digits, effects)


@dataclass(frozen=True)
class ClosedDrawing:
    """A car at its own drawn inputs, every link as long as drawn.

    Attributes:
        instant: the proven pose, at rest.
        inputs: as drawn, by name, rad or mm, without those that move the whole car.
    """

    instant: Instant
    inputs: Mapping[str, Fraction]


def closed_drawing(
    design: Design, digits: int = 60, clearness: float = CLEAR, effects: Sequence[str] = ANGLES
) -> ClosedDrawing:
    """Solve a drawing at its own inputs.

    They are taken from the drawing in the numbers that the equations take (see `drives`), without the way
    through an angle. A drawing that closes comes back within the radius.

    Raises:
        BadInputError, InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """
    instant = _proven(design, closed(design, clearness), design.known_as_drawn, digits, effects)
    with ctx.workprec(bits(instant.digits)):
        drives = design.mechanism.drives
        return ClosedDrawing(instant, {n: centre_of(one.input_of(one.drawn())) for n, one in drives.items()})


def pose_exists(design: Design, inputs: Inputs, clearness: float = CLEAR) -> bool:
    """Whether the assembly of the drawing comes to these inputs.

    A pose that is singular to 400 digits counts as existing: it is the end itself.
    """
    try:
        reached(design, clearness, design.driven(inputs))
    except InfeasibleError:
        return False
    except SingularPoseError:
        return True
    return True


def _proven(
    design: Design, here: Assembly, known: Callable[[], Known], digits: int, effects: Sequence[str]
) -> Instant:
    pose = here.pose
    return with_enough_digits(
        lambda working: prove_instant(design, known(), pose.unknown, pose.holds, digits, working, effects),
        digits,
    )


def with_enough_digits(attempt: Callable[[int], Answer], digits: int) -> Answer:
    """Repeat with twice the digits until the proofs hold, the last time with 400.

    Raises:
        BadInputError: `digits` is not from 15 to 200.
        SingularPoseError: they do not hold with 400.
    """
    if not LEAST_PROMISED <= digits <= MOST_PROMISED:
        raise BadInputError("digits", digits, f"{LEAST_PROMISED} to {MOST_PROMISED}")
    doubled = (digits << doublings for doublings in range(MOST_DIGITS))
    return with_more_digits(attempt, [*takewhile(lambda n: n < MOST_DIGITS, doubled), MOST_DIGITS])
