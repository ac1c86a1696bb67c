"""From a description and inputs to proven instants."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

from flint import ctx

from validate.reference.design import Design, Driven
from validate.reference.effects.registry import ANGLES
from validate.reference.errors import BadInputError, InfeasibleError, NotDecidedError, SingularPoseError
from validate.reference.exact import bits
from validate.reference.instant import Instant, prove_instant
from validate.reference.route import CLEAR, Assembly, moved, reached

MOST_DIGITS = 400  # of the arithmetic: enough for an arm 1e-100 rad from its dead point
LEAST_PROMISED, MOST_PROMISED = 15, 200  # leaves one doubling at least
DOUBLINGS = 5  # from 15 digits to 400

Answer = TypeVar("Answer")


def solve_reference(
    plain: Mapping[str, Any],
    inputs: Mapping[str, Sequence[object]],
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
    inputs: Iterable[Mapping[str, Sequence[object]]],
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
        yield proven(design, here, driven, digits, effects)


def proven(
    design: Design, here: Assembly, driven: Driven, digits: int, effects: Sequence[str] = ANGLES
) -> Instant:
    """The instant of an assembly that a route has come to.

    Raises:
        SingularPoseError: no proof with 400 digits.
    """
    return with_enough_digits(
        lambda working: prove_instant(
            design, design.known(driven), here.pose.unknown, here.pose.holds, digits, working, effects
        ),
        digits,
    )


def pose_exists(design: Design, inputs: Mapping[str, Sequence[object]], clearness: float = CLEAR) -> bool:
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


def with_enough_digits(attempt: Callable[[int], Answer], digits: int) -> Answer:
    """Repeat with twice the digits until the proofs hold: 15 digits or more are 400 after five doublings.

    Raises:
        BadInputError: `digits` is not from 15 to 200.
        SingularPoseError: they do not hold with 400.
    """
    if not LEAST_PROMISED <= digits <= MOST_PROMISED:
        raise BadInputError("digits", digits, f"{LEAST_PROMISED} to {MOST_PROMISED}")
    for working in (min(digits << doublings, MOST_DIGITS) for doublings in range(DOUBLINGS + 1)):
        try:
            with ctx.workprec(bits(working)):
                return attempt(working)
        except NotDecidedError as doubt:
            if working >= MOST_DIGITS:
                raise SingularPoseError(working, doubt) from doubt
    raise NotDecidedError("a proof, digits of the arithmetic", working, MOST_DIGITS)
