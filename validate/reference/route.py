r"""From the drawing to wanted inputs: first the drawing is closed, then its inputs go there, straight.

An angle that is counted from the drawing goes in steps of less than a quarter turn, each straight in its sine
and cosine: only their ratio counts in its row. The other inputs go straight in the numbers that the equations
take of them (see `drives`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import islice, permutations
from math import ceil

from flint import arb, ctx
from mpmath import mpf

from validate.reference.design import Design, Driven, balls, values_only
from validate.reference.errors import (
    AmbiguousAssemblyError,
    InfeasibleError,
    NotDecidedError,
    SingularPoseError,
    TooManyStepsError,
)
from validate.reference.exact import centre_of
from validate.reference.fold import fold_ahead, pose_before
from validate.reference.jet import Jet
from validate.reference.way import Pose, Way, bending, next_pose, start_pose

# Bits of the arithmetic on the way: first three doubles' worth, at last 400 decimal digits, see `solve`.
PRECISIONS = (106, 212, 424, 1413)
FOLDS_FROM = 0.05  # of the way: shorter steps lead into a fold, which is then looked for
TURN = Fraction(3, 2)  # rad, less than a quarter turn
# Ways take one step or a few, however thin a body is, and up to a hundred where they end within 1e-12 of a
# fold, or meet a singular pose that is none: so many none has taken.
MOST_STEPS = 400
MOST_ORDERS = 6  # in which the inputs go there in turn
CLEAR = 1e-9  # a drawing is rounded to floats and need not close: where its assemblies are closer is noise


@dataclass(frozen=True)
class Assembly:
    """Where a route has come to: a proven pose, and which inputs are as driven there, the others as drawn."""

    driven: Driven | None
    which: frozenset[str]
    pose: Pose


@lru_cache(maxsize=64)
def closed(design: Design, clearness: float = CLEAR) -> Assembly:
    """The drawing, closed at its own inputs.

    Args:
        clearness: how far a second assembly must be from the drawing, in parts of the mechanism's size.
    Raises:
        AmbiguousAssemblyError: the drawing lies (nearly) at a singular pose.
        InfeasibleError, SingularPoseError: it does not close without passing one.
    """
    doubt: NotDecidedError | None = None
    for precision in PRECISIONS:
        with ctx.workprec(precision):
            drawn, known = design.drawn_unknown(), values_only(design.known_as_drawn())
            way = Way(known.equations, known.numbers, known.numbers, known.residual(drawn))
            try:
                pose = start_pose(way, drawn, arb(0))
            except NotDecidedError:
                continue
            clear = 1.0 / bending(way, pose)
            if clear < clearness:
                raise _ambiguous(clear, clearness)
            try:
                return Assembly(None, frozenset(), _led(way, pose, design, "closing the drawing"))
            except NotDecidedError as error:
                doubt = error
    if doubt is None:
        raise _ambiguous(0.0, clearness)
    raise SingularPoseError(400, doubt)


def reached(design: Design, clearness: float, driven: Driven) -> Assembly:
    """The assembly that a way from the closed drawing leads to: straight, or else input by input in turn.

    Raises:
        AmbiguousAssemblyError: the drawing lies (nearly) at a singular pose.
        InfeasibleError: proven that each of these ways meets a fold before its end; of the straight one.
        SingularPoseError: a way meets a singular pose, or one so near that 400 digits do not tell.
    """
    here = closed(design, clearness)
    try:
        return moved(design, here, driven)
    except InfeasibleError as straight:
        for order in islice(permutations(_changed(design, driven)), MOST_ORDERS):
            if len(order) == 1:
                break
            try:
                there = here
                for k in range(1, len(order)):
                    there = moved(design, there, driven, frozenset(order[:k]))
                return moved(design, there, driven)
            except InfeasibleError:
                continue
        raise straight from None


def moved(design: Design, here: Assembly, driven: Driven, which: frozenset[str] | None = None) -> Assembly:
    """The assembly that the straight way to other inputs leads to.

    Args:
        which: the inputs that go there, the others being as drawn; all unless given.
    Raises:
        InfeasibleError: proven that the way meets a fold before its end.
        SingularPoseError: the way meets a singular pose, or one so near that 400 digits do not tell.
    """
    which = frozenset(design.mechanism.drives) if which is None else which
    for precision in PRECISIONS:
        with ctx.workprec(precision):
            try:
                pose = here.pose
                for begin, end in _legs(design, here, driven, which):
                    way = Way(design.equations(), begin, end)
                    start = start_pose(way, pose.unknown, arb(0))
                    if not pose.holds(start.box):
                        raise NotDecidedError("the start of the way", "another solution", "the same")
                    pose = _led(way, start, design, "the way to the inputs")
                return Assembly(driven, which, pose)
            except NotDecidedError as error:
                doubt = error
    raise SingularPoseError(400, doubt)


def _led(way: Way, pose: Pose, design: Design, what: str) -> Pose:
    """Along a way to its end.

    Raises:
        TooManyStepsError: it takes more than `MOST_STEPS`.
    """
    longest, tried, steps = arb(1), FOLDS_FROM, 0
    while pose.t < 1:
        steps += 1
        if steps > MOST_STEPS:
            raise TooManyStepsError(what, float(pose.t), MOST_STEPS)
        there = next_pose(way, pose, longest)
        step = float(there.t - pose.t)
        longest = arb(4 * step)
        pose = there
        if step < tried and pose.t < 1:
            tried = step / 4
            fold = fold_ahead(way, pose)
            if fold is None:
                continue
            if fold.t < 1:
                raise InfeasibleError(what, float(fold.t.mid()), _inputs(design, way.numbers(fold.t)))
            if not fold.t > 1:
                raise NotDecidedError("the fold beyond the end of the way", fold.t, "1")
            return pose_before(way, fold, arb(1))
    return pose


def _legs(
    design: Design, here: Assembly, driven: Driven, which: frozenset[str]
) -> Iterator[tuple[Sequence[arb], Sequence[arb]]]:
    """The numbers w at the ends of each straight way."""
    drives = design.mechanism.drives
    begin, end = _numbers(design, here.driven, here.which), _numbers(design, driven, which)
    angles = {
        name: (_angle(here.driven, here.which, name), _angle(driven, which, name))
        for name, one in drives.items()
        if one.turns
    }
    count = max(1, ceil(max((abs(b - a) for a, b in angles.values()), default=Fraction(0)) / TURN))

    def at(k: int) -> list[arb]:
        found: list[arb] = []
        for name, one in drives.items():
            if k in (0, count):
                found += (end if k else begin)[name]
            elif one.turns:
                a, b = angles[name]
                found += [jet.value for jet in one.numbers(balls(Jet(a + Fraction(k, count) * (b - a))))]
            else:
                found += [x + (y - x) * k / count for x, y in zip(begin[name], end[name], strict=True)]
        return found

    for k in range(count):
        yield at(k), at(k + 1)


def _numbers(design: Design, driven: Driven | None, which: frozenset[str]) -> dict[str, Sequence[arb]]:
    return {
        name: one.drawn()
        if driven is None or name not in which
        else [jet.value for jet in one.numbers(balls(driven[name]))]
        for name, one in design.mechanism.drives.items()
    }


def _changed(design: Design, driven: Driven) -> list[str]:
    """The inputs that are not as drawn."""
    drawn, there = _numbers(design, None, frozenset()), _numbers(design, driven, frozenset(driven))
    return [n for n in drawn if not all(a.overlaps(b) for a, b in zip(drawn[n], there[n], strict=True))]


def _inputs(design: Design, numbers: Sequence[arb]) -> dict[str, mpf]:
    found, first = {}, 0
    for name, drive in design.mechanism.drives.items():
        count = len(drive.drawn())
        found[name] = centre_of(drive.input_of(numbers[first : first + count]))
        first += count
    return found


def _angle(driven: Driven | None, which: frozenset[str], name: str) -> Fraction:
    return Fraction(0) if driven is None or name not in which else Fraction(driven[name].value)


def _ambiguous(clear: float, clearness: float) -> AmbiguousAssemblyError:
    remedy = "the points are drawn at a singular pose: draw the car where it is wanted, off that pose"
    return AmbiguousAssemblyError("how far the drawing is from another assembly", clear, clearness, remedy)
