"""From a description and inputs to proven instants."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import takewhile

from validate.reference.design import Design, Driven
from validate.reference.effects.registry import ANGLES
from validate.reference.errors import InfeasibleError, NoReferenceError, SingularPoseError
from validate.reference.exact import MOST_DIGITS, with_more_digits
from validate.reference.instant import Instant, prove_instant
from validate.reference.route import CLEAR, Assembly, moved, reached

LEAST_PROMISED, MOST_PROMISED = 15, 200  # leaves one doubling at least

Inputs = Mapping[str, Sequence[object]]


def instants_of(
    design: Design,
    inputs: Iterable[Inputs],
    digits: int = 60,
    clearness: float = CLEAR,
    effects: Sequence[str] = ANGLES,
) -> Iterator[Instant]:
    """A motion, with a proof of every digit.

    All given numbers (int, float, Fraction, mpf) are taken as exact. The assembly is the one at the end of a
    path from the drawing that meets no singular pose: the drawing is closed, then its inputs change to those
    of the first instant (see `route`), and from each instant straight to the next; every step is proven. The
    number of digits is raised automatically if the pose is nearly singular. The function sets the precision
    of python-flint, which is global, so it is not safe for several threads.

    Args:
        design: of a car whose points fix the lengths and need not be assembled.
        inputs: the inputs of each instant by name, rad or mm, each (value, rate, acceleration) or with more
            derivatives; inputs that are not named are constantly zero.
        digits: digits of every number, relative to the greatest of its kind; 15 to 200.
        clearness: least distance of another assembly from the drawing, as a share of the mechanism's size; 0
            if the drawing is exact.
        effects: names of the requested effects, see `effects.registry`; only these are computed.
    Returns:
        The instants, mm, s, rad.
    Raises:
        NoReferenceError: an input cannot be used, or the drawing is at a singular pose.
        InfeasibleError: it is proven that the paths from the drawing meet a fold.
        SingularPoseError: no proof succeeds with 400 digits.

    >>> arm = Design.from_plain({  # level, so that the wheel moves straight up at first
    ...     "name": "arm", "rods": {}, "slides": {}, "roles": {"wheel_axis": ["inner", "wheel"]},
    ...     "bodies": {"chassis": ["front", "rear"], "arm": ["front", "rear", "inner", "wheel"]},
    ...     "inputs": {"travel": {"height": "wheel", "along": "up"}},
    ...     "points": {"front": (-100, 0, 0), "rear": (100, 0, 0),
    ...                "inner": (0, -300, 0), "wheel": (0, -350, 0)},
    ...     "up": (0, 0, 1), "right": (0, 1, 0), "side": "left", "wheel_radius": None,
    ... })
    >>> instant = next(instants_of(arm, [{"travel": (210, 0, 0)}]))
    >>> float(instant.position["wheel"][1])
    -280.0
    """
    here: Assembly | None = None
    for one in inputs:
        driven = design.driven(one)
        here = reached(design, clearness, driven) if here is None else moved(design, here, driven)
        yield _proven(design, here, driven, digits, effects)


def pose_exists(design: Design, inputs: Inputs, clearness: float = CLEAR) -> bool:
    """Whether the assembly of the drawing can reach these inputs.

    A pose that is singular to 400 digits counts as existing: it is the end of the range itself.
    """
    try:
        reached(design, clearness, design.driven(inputs))
    except InfeasibleError:
        return False
    except SingularPoseError:
        return True
    return True


def _proven(design: Design, here: Assembly, driven: Driven, digits: int, effects: Sequence[str]) -> Instant:
    """The digits are doubled until the proofs succeed; the last attempt has 400.

    Raises:
        NoReferenceError: `digits` is not from 15 to 200.
        SingularPoseError: the proofs do not succeed with 400.
    """

    def attempt(_: int) -> Instant:
        return prove_instant(design, design.known(driven), here.pose, digits, effects)

    if not LEAST_PROMISED <= digits <= MOST_PROMISED:
        raise NoReferenceError("digits", f"is {digits}", f"{LEAST_PROMISED} to {MOST_PROMISED}")
    doubled = (digits << doublings for doublings in range(MOST_DIGITS))
    return with_more_digits(attempt, [*takewhile(lambda n: n < MOST_DIGITS, doubled), MOST_DIGITS])
