"""From the drawing to given inputs: the drawing is closed, then its inputs change along a straight path.

The inputs change linearly in the numbers w of the equations (see `drives`). If an angle measured from the
drawing turns far, the way is divided into straight paths on which it turns by less than a quarter turn: they
are linear in its sine and cosine, and only their ratio matters in its row.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import islice, pairwise, permutations
from math import ceil

from flint import arb, ctx

from validate.reference.design import Design, Driven, balls, equations_in
from validate.reference.errors import InfeasibleError, NoReferenceError, NotDecidedError
from validate.reference.exact import MOST_DIGITS, as_ball, bits, centre_of, with_more_digits
from validate.reference.fold import fold_ahead, pose_before
from validate.reference.jet import Jet
from validate.reference.path import Pose, StraightPath, bending, next_pose, start_pose

DIGITS = (7, 39, 103, MOST_DIGITS)  # of the arithmetic on a path: twice a double's bits, and twice that
FOLDS_FROM = 0.05  # share of a path: shorter steps lead into a fold, which is then searched for
TURN = 1.5  # rad, less than a quarter turn
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
        drawn, wanted = _inputs(design, {}), _inputs(design, driven)
        changed = [name for name in design.mechanism.drives if not drawn[name].overlaps(wanted[name])]
        for order in islice(permutations(changed), MOST_ORDERS if len(changed) > 1 else 0):
            there = here
            try:
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
                raise InfeasibleError(what, float(fold.t.mid()), _inputs_of(design, path.numbers(fold.t)))
            if not fold.t > 1:
                raise NotDecidedError(
                    "the place of the fold, as a share of the path,", fold.t, "more or less than 1"
                )
            pose = pose_before(path, fold, arb(1))
    return pose


def _stops(design: Design, begin: Driven, end: Driven) -> list[list[arb]]:
    """The numbers w at the ends of the straight paths."""
    mechanism, first, last = design.mechanism, _inputs(design, begin), _inputs(design, end)
    turns = [abs(float(last[name] - first[name])) for name, one in mechanism.drives.items() if one.turns]
    count = max(1, ceil(max(turns, default=0.0) / TURN))
    stops = ({n: Jet(x + (last[n] - x) * k / count) for n, x in first.items()} for k in range(count + 1))
    return [[w.value for w in mechanism.numbers(stop, as_ball)] for stop in stops]


def _inputs(design: Design, driven: Driven) -> dict[str, arb]:
    """All inputs; those that are not driven have their drawn values."""
    given = {name: balls(jet) for name, jet in driven.items()}
    return {name: jet.value for name, jet in (design.mechanism.drawn_inputs | given).items()}


def _inputs_of(design: Design, numbers: Sequence[arb]) -> dict[str, Fraction]:
    """The inputs, without those that move the chassis, from the numbers w."""
    left, drawn = iter(numbers), design.mechanism.drawn_inputs
    return {
        name: centre_of(one.input_of([*islice(left, len(one.numbers(drawn[name], drawn, as_ball)))]))
        for name, one in design.mechanism.drives.items()
    }
