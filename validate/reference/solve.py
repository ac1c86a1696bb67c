"""From points and inputs to a proven instant."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TypeVar

from flint import arb, ctx

from validate.reference.candidates import CLEAR_SIGN, choices_of_table, every_candidate
from validate.reference.design import Design, ball_vector, exact_vector, values_only
from validate.reference.errors import (
    AmbiguousAssemblyError,
    BadInputError,
    NotDecidedError,
    SingularPoseError,
)
from validate.reference.exact import as_ball, bits
from validate.reference.instant import Instant, prove_instant
from validate.reference.linkage import Candidate, Known
from validate.reference.suspensions import CLOSURE, SUSPENSION
from validate.reference.vectors import Vector, minus, times

MOST_DIGITS = 400  # of the arithmetic: enough for an arm 1e-100 rad from its dead point
LEAST_PROMISED, MOST_PROMISED = 15, 200  # leaves one doubling at least
DOUBLINGS = 5  # from 15 digits to 400
CLEARLY_NEARER = 0.5  # the wanted assembly must be at most half as far from the guess as the next one

Answer = TypeVar("Answer")
Points = Mapping[str, Sequence[object]]


def solve_reference(
    points: Points,
    inputs: Mapping[str, Sequence[object]],
    guess: Points | None = None,
    up: Sequence[object] = (0, 0, 1),
    right: Sequence[object] = (0, 1, 0),
    side: str = "left",
    digits: int = 60,
    closure: str = CLOSURE,
    clearness: float = CLEAR_SIGN,
    suspension: str = SUSPENSION,
) -> Instant:
    """Solve the car at one instant, with a proof of every digit.

    All numbers given (int, float, Fraction, mpf) are taken as exact. Without a guess the assembly
    is the one that the given points make: the same `Choices`, which is the assembly that a
    regular motion leads to from the design. With a guess it is the assembly nearest to the guess.
    The number of digits rises by itself where the pose is nearly singular.
    It sets the precision of python-flint, which is global: not for several threads at once.

    Args:
        points: the points by name, mm; they fix the lengths and need not be assembled. Some may be left out
            (see `Linkage.stand_ins` and `left_out`).
        inputs: "arm_angle" (rad), "rack" (mm), "heave" (mm), each (value, rate, acceleration).
        guess: some or all points by name, mm, near the wanted assembly.
        up: unit vector of the paper's z in the frame of the points.
        right: unit vector of the paper's y in the frame of the points.
        side: "left" or "right" wheel, for the effects.
        digits: digits of every number, relative to the greatest of its kind; 15 to 200.
        closure: "drawn" takes a suspension as it is drawn, a strut with its axis in the knuckle on the line
            of strut_lower and strut_top; "collinear" is the paper's strut, the ball joint on one line with
            it.
        clearness: how far the given points must be from where two assemblies meet, as a sine; 0 takes
            the exact sign, however small the product.
        suspension: its type, a name in `suspensions.SUSPENSIONS`.
    Returns:
        The instant, mm, s, rad.
    Raises:
        BadInputError: something given cannot be used.
        InfeasibleError: proven that no such assembly exists.
        AmbiguousAssemblyError: points or guess do not single out an assembly.
        SingularPoseError: no proof with 400 digits.

    >>> points = {  # two level arms of one length: the wheel keeps its camber
    ...     "lower_arm_front": (-100, 0, 0), "lower_arm_rear": (100, 0, 0), "lower_ball_joint": (0, -300, 0),
    ...     "upper_arm_front": (-100, 0, 200), "upper_arm_rear": (100, 0, 200),
    ...     "upper_ball_joint": (0, -300, 200),
    ...     "tie_rod_inner": (-90, 0, 100), "tie_rod_outer": (-90, -300, 100),
    ...     "wheel_axis_inner": (0, -300, 100), "wheel_centre": (0, -350, 100),
    ... }
    >>> inputs = {"arm_angle": (1.5, 0, 0), "rack": (0, 0, 0)}
    >>> instant = solve_reference(points, inputs, suspension="double_wishbone")
    >>> bool(abs(instant.effect("camber")) < 1e-60)
    True
    """
    design = Design.from_points(points, up, right, side, closure, suspension)
    if guess is None:
        return next(instants_of(design, (inputs,), digits, clearness))
    near, driven = _local(guess, design), design.driven(inputs)
    return prove_assembly(design, partial(design.known, driven), lambda known: _nearest(known, near), digits)


def instants_of(
    design: Design,
    inputs: Iterable[Mapping[str, Sequence[object]]],
    digits: int = 60,
    clearness: float = CLEAR_SIGN,
) -> Iterator[Instant]:
    """One car at many inputs, each by itself, on the assembly that its points make.

    Args:
        inputs: of each instant, as for `solve_reference`; also digits, clearness.
    Raises:
        BadInputError, InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """
    choices = choices_of_table(design.table, design.up, design.linkage, clearness)

    def choose(known: Known) -> Candidate:
        return design.linkage.candidate(known, choices)

    for one in inputs:
        yield prove_assembly(design, partial(design.known, design.driven(one)), choose, digits)


def prove_assembly(
    design: Design, given: Callable[[], Known], choose: Callable[[Known], Candidate], digits: int
) -> Instant:
    """The proven instant of the assembly chosen, with as many digits as it takes.

    Args:
        given: what the equations take as given, with rates, at the present precision.
        choose: the closed form to start from.
    Raises:
        InfeasibleError, AmbiguousAssemblyError, SingularPoseError: as `solve_reference`.
    """

    def attempt(working: int) -> Instant:
        known = given()
        still = values_only(known)
        chosen = choose(still)
        chosen.require_feasible(float(design.unit))
        start = design.linkage.unknown_of(chosen.points, still)
        return prove_instant(design, known, start, chosen.choices, digits, working)

    return with_enough_digits(attempt, digits)


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


def _local(guess: Points, design: Design) -> dict[str, Vector]:
    near = {}
    for name, place in guess.items():
        if name not in design.names:
            raise BadInputError("guess", name, f"names among {', '.join(design.names)}")
        absolute = exact_vector(place, f"guess[{name!r}]")
        near[name] = times(minus(absolute, design.origin), 1 / design.unit)
    return near


def _nearest(known: Known, near: Mapping[str, Vector]) -> Candidate:
    """The candidate nearest to the guess in the maximum norm; it may still be infeasible."""

    def distance(one: Candidate) -> arb:
        apart = [x for n, place in near.items() for x in minus(one.points[n], ball_vector(place))]
        if not all(x.is_finite() for x in apart):
            return arb.pos_inf()  # a closure divides by zero: nothing is near it
        return max((x.abs_upper() for x in apart), default=as_ball(0))

    measured = ((distance(one), i, one) for i, one in enumerate(every_candidate(known)))
    ranked = sorted(measured, key=lambda row: row[:2])
    first, second = ranked[0], ranked[1]
    if any(gap > 0 for gap in first[2].gaps.values()):
        return first[2]
    if not first[0] <= CLEARLY_NEARER * second[0]:
        if all(gap < 0 or gap > 0 for row in (first, second) for gap in row[2].gaps.values()):
            ratio = float(first[0].mid() / second[0].mid()) if second[0] > 0 else 1.0
            remedy = "name more points in the guess, or place them nearer the wanted assembly"
            what = "distance from the guess to the nearest assembly over that to the next"
            raise AmbiguousAssemblyError(what, ratio, CLEARLY_NEARER, remedy)
        raise NotDecidedError("which assembly is nearest to the guess", first[0], second[0])
    return first[2]
