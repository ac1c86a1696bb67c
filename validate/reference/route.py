"""From the drawing to given inputs: the drawing is closed, then its inputs change along a straight path.

An angle measured from the drawing changes in steps of less than a quarter turn, each linear in its sine and
cosine, because only their ratio matters in its row. The other inputs change linearly in the numbers w of the
equations (see `drives`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import chain, islice, pairwise, permutations
from math import ceil

from flint import arb, ctx

from validate.reference.design import Design, Driven, balls
from validate.reference.equations import equations_in
from validate.reference.errors import InfeasibleError, NoReferenceError, NotDecidedError
from validate.reference.exact import MOST_DIGITS, as_ball, bits, centre_of, with_more_digits
from validate.reference.fold import fold_ahead, pose_before
from validate.reference.jet import Jet
from validate.reference.path import Pose, StraightPath, bending, next_pose, start_pose

DIGITS = (7, 39, 103, MOST_DIGITS)  # of the arithmetic on a path: twice a double's bits, and twice that
FOLDS_FROM = 0.05  # share of a path: shorter steps lead into a fold, which is then searched for
TURN = Fraction(3, 2)  # rad, less than a quarter turn
# A path takes a few steps, and up to a hundred if it ends within 1e-12 of a fold, or meets a singular pose
# that is not a fold. No path has yet taken this many.
MOST_STEPS = 400
MOST_ORDERS = 6  # number of orders tried in which the inputs change one after the other
CLEAR = 1e-9  # drawings are rounded to floats and need not close: a smaller distance of assemblies is noise
REMEDY = "the points are drawn at a singular pose: draw the car at another pose"


@dataclass(frozen=True)
class Assembly:
    """A proven pose at the end of a path; inputs that are not in `driven` are as drawn."""

    driven: Driven
    pose: Pose


@lru_cache(maxsize=64)
def closed(design: Design, clearness: float = CLEAR) -> Assembly:
    """The drawing, closed at its own inputs.

    Args:
        clearness: least distance of a second assembly from the drawing, as a share of the mechanism's size.
    Raises:
        NoReferenceError: the drawing is at a singular pose, or nearly.
        InfeasibleError, SingularPoseError: it does not close without passing a fold or a singular pose.
    """

    def attempt() -> Assembly:
        equations, mechanism, clear = equations_in(design.mechanism), design.mechanism, 0.0
        drawn, numbers = mechanism.drawn_unknown, mechanism.drawn_numbers
        path = StraightPath(equations, numbers, numbers, equations.residual(drawn, numbers))
        try:
            pose = start_pose(path, drawn, arb(0))
            clear = 1.0 / bending(path, pose)
        except NotDecidedError:
            if ctx.prec < bits(MOST_DIGITS):
                raise
        if not 0.0 < clear >= clearness:
            what = "the distance of the drawing from another assembly"
            allowed = f"at least {clearness:.3g} of the mechanism's size; {REMEDY}"
            raise NoReferenceError(what, f"is {clear:.3g}", allowed, clear)
        return Assembly({}, _led(path, pose, design, "closing the drawing"))

    return with_more_digits(attempt, DIGITS)


def reached(design: Design, clearness: float, driven: Driven) -> Assembly:
    """The assembly at the end of a path from the closed drawing: straight, or else one input after another.

    Raises:
        NoReferenceError: the drawing is at a singular pose, or nearly.
        InfeasibleError: it is proven that each path meets a fold; the error describes the straight path.
        SingularPoseError: a path meets a singular pose, or comes so near that 400 digits cannot decide.
    """
    here = closed(design, clearness)
    try:
        return moved(design, here, driven)
    except InfeasibleError as straight:
        drawn, wanted = _numbers(design, {}), _numbers(design, driven)
        changed = [
            n for n in drawn if not all(a.overlaps(b) for a, b in zip(drawn[n], wanted[n], strict=True))
        ]
        for order in islice(permutations(changed), MOST_ORDERS if len(changed) > 1 else 0):
            try:
                there = here
                for k in range(1, len(order)):
                    there = moved(design, there, {name: driven[name] for name in order[:k]})
                return moved(design, there, driven)
            except InfeasibleError:
                continue
        raise straight from None


def moved(design: Design, here: Assembly, driven: Driven) -> Assembly:
    """The assembly at the end of the straight path to other inputs.

    Args:
        driven: the new values of inputs; the others are as drawn.
    Raises:
        InfeasibleError: it is proven that the path meets a fold before its end.
        SingularPoseError: the path meets a singular pose, or comes so near that 400 digits cannot decide.
    """

    def attempt() -> Assembly:
        pose = here.pose
        for begin, end in pairwise(_stops(design, here.driven, driven)):
            path = StraightPath(equations_in(design.mechanism), begin, end)
            start = start_pose(path, pose.unknown, arb(0))
            if not pose.holds(start.box):
                raise NotDecidedError("the start of the path", "another solution", "the pose followed")
            pose = _led(path, start, design, "the path to the inputs")
        return Assembly(driven, pose)

    return with_more_digits(attempt, DIGITS)


def _led(path: StraightPath, pose: Pose, design: Design, what: str) -> Pose:
    """The pose at the end of a path.

    Raises:
        NoReferenceError: the path takes more than `MOST_STEPS` steps.
    """
    longest, tried, steps = arb(1), FOLDS_FROM, 0
    while pose.t < 1:
        steps += 1
        if steps > MOST_STEPS:
            problem = (
                f"is given up after {MOST_STEPS} proven steps, at {float(pose.t):.3g} of its length (needed "
                "1): whether there is a pose is not known"
            )
            raise NoReferenceError(what, problem, "inputs nearer to those of the drawing", MOST_STEPS)
        there = next_pose(path, pose, longest)
        step = float(there.t - pose.t)
        pose, longest = there, arb(4 * step)
        if step < tried and pose.t < 1:
            tried = step * FOLDS_FROM
            fold = fold_ahead(path, pose)
            if fold is None:
                continue
            if fold.t < 1:
                raise InfeasibleError(what, float(fold.t.mid()), _inputs(design, path.numbers(fold.t)))
            if not fold.t > 1:
                raise NotDecidedError(
                    "the place of the fold, as a share of the path,", fold.t, "more or less than 1"
                )
            pose = pose_before(path, fold, arb(1))
    return pose


def _stops(design: Design, begin: Driven, end: Driven) -> list[list[arb]]:
    """The numbers w at the ends of the straight paths."""
    turns = {
        name: [Fraction(inputs[name].value) if name in inputs else Fraction(0) for inputs in (begin, end)]
        for name, one in design.mechanism.drives.items()
        if one.turns
    }
    count = max(1, ceil(max((abs(b - a) for a, b in turns.values()), default=Fraction(0)) / TURN))
    first, last = _numbers(design, begin), _numbers(design, end)
    between = []
    for k in range(1, count):
        driven = {name: Jet(a + Fraction(k, count) * (b - a)) for name, (a, b) in turns.items()}
        straight = {
            n: [x + (y - x) * k / count for x, y in zip(first[n], last[n], strict=True)] for n in first
        }
        between.append(straight | {name: _numbers(design, driven)[name] for name in turns})
    return [[*chain(*stop.values())] for stop in (first, *between, last)]


def _numbers(design: Design, driven: Driven) -> dict[str, list[arb]]:
    """The numbers w of each input; inputs that are not driven have their drawn values."""
    given = design.mechanism.drawn_inputs | {name: balls(jet) for name, jet in driven.items()}
    return {
        name: [jet.value for jet in one.numbers(given[name], given, as_ball)]
        for name, one in design.mechanism.drives.items()
    }


def _inputs(design: Design, numbers: Sequence[arb]) -> dict[str, Fraction]:
    left, drives = iter(numbers), design.mechanism.drives
    return {
        name: centre_of(drives[name].input_of([*islice(left, len(own))]))
        for name, own in _numbers(design, {}).items()
    }
