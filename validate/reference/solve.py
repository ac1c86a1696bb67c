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

    All numbers given (int, float, Fraction, mpf) are taken as exact. The assembly is the one that a way from
    the drawing leads to without meeting a singular pose: the drawing is closed, then its inputs go to the
    wanted ones (see `route`), and from each instant straight to the next, every step of it proven. The number
    of digits rises by itself where the pose is nearly singular. It sets the precision of python-flint, which
    is global: not for several threads at once.

    Args:
        design: of a car whose points fix the lengths and need not be assembled.
        inputs: of each instant by name, rad or mm, each (value, rate, acceleration) or with as many more of
            their derivatives; those that are not named rest at zero.
        digits: digits of every number, relative to the greatest of its kind; 15 to 200.
        clearness: how far another assembly must be from the drawing, in parts of the mechanism's size; 0
            where the drawing is exact.
        effects: names of those that are wanted, see `effects.registry`; each costs what it takes.
    Returns:
        The instants, mm, s, rad.
    Raises:
        NoReferenceError: something given cannot be used, or the drawing lies at a singular pose.
        InfeasibleError: proven that the ways from the drawing meet a fold.
        SingularPoseError: no proof with 400 digits.

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


def _proven(design: Design, here: Assembly, driven: Driven, digits: int, effects: Sequence[str]) -> Instant:
    """Tried with twice the digits until the proofs hold, the last time with 400.

    Raises:
        NoReferenceError: `digits` is not from 15 to 200.
        SingularPoseError: they do not hold with 400.
    """

    def attempt(_: int) -> Instant:
        return prove_instant(design, design.known(driven), here.pose, digits, effects)

    if not LEAST_PROMISED <= digits <= MOST_PROMISED:
        raise NoReferenceError("digits", f"is {digits}", f"{LEAST_PROMISED} to {MOST_PROMISED}")
    doubled = (digits << doublings for doublings in range(MOST_DIGITS))
    return with_more_digits(attempt, [*takewhile(lambda n: n < MOST_DIGITS, doubled), MOST_DIGITS])
