"""From a description and inputs to proven instants."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import takewhile

from validate.reference.design import Design
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

    All given numbers (int, float, Fraction, mpf) are taken as exact. A path without singular poses leads from
    the drawing to the assembly: the drawing is closed, its inputs change to those of the first instant (see
    `route`), and then straight to those of the next instants. Every step is proven. A nearly singular pose
    takes more digits. Not safe for several threads, because the precision of python-flint is global.

    Args:
        design: its points fix the lengths and need not be assembled.
        inputs: inputs of each instant by name, rad or mm: (value, rate, acceleration), perhaps with more
            derivatives; inputs that are not named are constantly zero.
        digits: digits of every number, relative to the greatest of its kind; 15 to 200.
        clearness: least distance of another assembly from the drawing, as a share of the mechanism's size; 0
            if the drawing is exact.
        effects: names of the requested effects, see `effects.registry`.
    Returns:
        The instants, mm, s, rad.
    Raises:
        NoReferenceError: an input cannot be used, or the drawing is at a singular pose.
        InfeasibleError: it is proven that the paths from the drawing meet a fold.
        SingularPoseError: the proofs fail with 400 digits.

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
    if not LEAST_PROMISED <= digits <= MOST_PROMISED:
        raise NoReferenceError("digits", f"is {digits}", f"{LEAST_PROMISED} to {MOST_PROMISED}")
    doubled = (digits << doublings for doublings in range(MOST_DIGITS))
    ladder = [*takewhile(lambda n: n < MOST_DIGITS, doubled), MOST_DIGITS]
    here: Assembly | None = None
    for one in inputs:
        driven = design.driven(one)
        here = reached(design, clearness, driven) if here is None else moved(design, here, driven)
        yield with_more_digits(partial(prove_instant, design, driven, here.pose, digits, effects), ladder)


def pose_exists(design: Design, inputs: Inputs, clearness: float = CLEAR) -> bool:
    """Whether the assembly of the drawing can reach these inputs.

    A pose that is singular to 400 digits counts as reached: it is the end of the range.
    """
    try:
        reached(design, clearness, design.driven(inputs))
    except InfeasibleError:
        return False
    except SingularPoseError:
        return True
    return True
