r"""Whether pointcoord's proven bounds hold, and how loose they are, up to the poses where a car locks.

Two sets of random poses of every suspension (see `near_singular`), each reproducible by its number: cars held
close to the end of an input, and motions that run towards such an end, at random instants between. Each
instant is proven alone and among many that are close to it; the lesser bound counts.

    pointcoord study bounds --poses 10000

The error of a pose is its distance from the reference, whose own is below 1e-40 of the car. It must never
exceed the bound:

    error <= bound,    and    loss = error / (eps (condition size + far))    must not grow to the end,

with size the power of two in which the mechanism counts lengths and far its distance from the origin.
Near the end of an input the condition number grows as distance^(-1/2), because the end is a fold, so an
error that follows condition eps has slope 1 over that rounding and -1/2 over the distance in
double-logarithmic scales.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.numerics.rounding import EPS
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.near_singular import NearPose, near_pose
from validate.cars.registry import VARIANTS, Variant
from validate.cars.scene_content import scene_content
from validate.exit_status import ExitStatus
from validate.long_studies.study import Findings, Kind, Number, Row
from validate.output.terminal import Part, Table
from validate.reference import InfeasibleError, Instant, NoReferenceError
from validate.reference.exact import as_fraction

Array = NDArray[np.float64]
Answer = TypeVar("Answer")

DIGITS = 40  # of the reference: its error is 1e-20 of any error in double precision
INSTANTS = 4  # per motion
COMPANY = 63  # instants beside each
CLOSE, NEARER = 1e-4, 1e-2  # s, and parts of the time that is left: how near they are to it
LEVELS = (0.0, 0.01, 0.1, 0.5, 0.9, 0.99, 1.0)
HELD, MOVING = "held", "moving"
# Of a check, in the order of its attributes.
NUMBERS = (
    *("distance", "instant", "condition", "size", "far"),
    *("error", "bound", "carried_error", "carried_bound"),
)
FOLD = 1e-3  # nearer to the end than this part of the range, its fold is all that matters


@dataclass(frozen=True)
class Check:
    """One pose of pointcoord held against the reference; lengths in mm.

    Attributes:
        number, driven, lock, distance: of the `NearPose`; distance of the instant, for a motion.
        variant: the kind of suspension.
        instant: s, for a motion; a held pose has the instant 0.
        condition: of the Jacobian.
        size: of the mechanism, a power of two.
        far: largest coordinate of a point in the frame of the scene.
        error, bound: of the solved points. carried_error, carried_bound: of those carried.
    """

    number: int
    variant: Variant
    driven: str
    lock: str
    distance: float
    instant: float
    condition: float
    size: float
    far: float
    error: float
    bound: float
    carried_error: float
    carried_bound: float

    @property
    def share(self) -> float:
        """The larger error in parts of its bound: above 1 the bound is broken."""
        return max(self.error / self.bound, self.carried_error / self.carried_bound)

    @property
    def rounding(self) -> float:
        """What rounding may do: eps (condition size + far), mm."""
        return EPS * (self.condition * self.size + self.far)

    @property
    def loss(self) -> float:
        """Error in parts of that rounding."""
        return self.error / self.rounding


@dataclass(frozen=True)
class Refusal:
    """A pose without an answer: who refused it, and the kind of reason."""

    number: int
    variant: Variant
    distance: float
    reason: str


@dataclass(frozen=True)
class FoundBounds:
    """What a study found; `held` are poses at the end of an input, `moving` instants of motions."""

    seed: int
    held: tuple[Check, ...]
    moving: tuple[Check, ...]
    refusals: tuple[Refusal, ...]

    @property
    def broken(self) -> tuple[Check, ...]:
        """Where the bound is below the error."""
        return tuple(check for check in (*self.held, *self.moving) if not check.share <= 1.0)


def held_pose(pose: NearPose) -> list[Check | Refusal]:
    """The check of a car whose inputs are constant."""
    laws = {name: [value] for name, value in pose.inputs.items()}
    return _checked(pose, laws, np.zeros(1), stop=0.0)


def moving_instants(number: int, seed: int) -> list[Check | Refusal]:
    """Checks at random instants of a motion from the drawing towards the end of an input.

    All inputs run at constant rates for one second; half the instants lie anywhere, half towards the end.
    """
    pose = near_pose(number, seed, nearest=1e-8)
    rng = np.random.default_rng([seed, number, 1])
    laws = {name: [pose.home[name], value - pose.home[name]] for name, value in pose.inputs.items()}
    late = 1.0 - 10.0 ** rng.uniform(-8.0, 0.0, INSTANTS // 2)
    return _checked(pose, laws, np.concatenate([rng.uniform(0.0, 1.0, INSTANTS - len(late)), late]), stop=1.0)


def _checked(
    pose: NearPose, laws: Mapping[str, Sequence[float]], instants: Array, stop: float
) -> list[Check | Refusal]:
    samples = 1 if stop == 0.0 else 2
    scene = Scene.from_mapping(
        scene_content(
            pose.car, laws["arm_angle"], laws["rack"], laws["heave"], stop=stop, samples=samples, effects=()
        )
    )
    motion = _answer(lambda: simulate(scene))
    return [_check(pose, scene, float(t), motion) for t in instants]


def _check(pose: NearPose, scene: Scene, instant: float, motion: Motion | str) -> Check | Refusal:
    # The distance of a motion shrinks with the part of its way that is left.
    rate = (*(scene.inputs[pose.driven].polynomial or ()), 0.0)[1]
    distance = pose.distance + abs(rate) * (1.0 - instant) / pose.reach
    reference = _answer(lambda: _reference(scene, instant))
    if isinstance(motion, str) or (isinstance(reference, str) and reference != InfeasibleError.__name__):
        return Refusal(
            pose.number,
            Variant.of(pose.car),
            distance,
            f"pointcoord: {motion if isinstance(motion, str) else 'answers'}; "
            f"reference: {reference if isinstance(reference, str) else 'answers'}",
        )
    company, place = _company(motion, instant)
    together = motion.at(company)
    samples = together.part(place, place + 1)
    # Neighbours share an inverse; what is proven among them must hold as well as what is proven alone.
    proof, among = motion.proof_of(samples), motion.proof_of(together)
    bound, carried = (
        min(float(getattr(proof, name)[0]), float(getattr(among, name)[place]))
        for name in ("bound", "carried_bound")
    )
    if not math.isfinite(bound):
        return Refusal(pose.number, Variant.of(pose.car), distance, "pointcoord: no finite bound")
    error = carried_error = math.inf  # where the reference has no such assembly
    if isinstance(reference, Instant):
        each = {name: _error(reference, name, place[0]) for name, place in samples.position.items()}
        carried_error = max(each.pop(name) for name in scene.mechanism.topology.carried)
        error = max(each.values())
    return Check(
        number=pose.number,
        variant=Variant.of(pose.car),
        driven=pose.driven,
        lock=pose.lock,
        distance=distance,
        instant=instant,
        condition=float(proof.condition[0]),
        size=motion.unit,
        far=max(float(np.abs(place).max()) for place in samples.position.values()),
        error=error,
        bound=bound,
        carried_error=carried_error,
        carried_bound=carried,
    )


def _company(motion: Motion, instant: float) -> tuple[Array, int]:
    """An instant of a motion among many that are close to it, and its place among them."""
    first, last = float(motion.times[0]), float(motion.times[-1])
    # Closer where an end is near, in whose last part everything changes as fast as in all that is before.
    near = min(CLOSE, NEARER * (last - instant))
    company = np.unique(np.clip(instant + near * np.linspace(-1.0, 1.0, COMPANY), first, last))
    company = np.unique(np.append(company, instant))
    return company, int(np.searchsorted(company, instant))


def _answer(ask: Callable[[], Answer]) -> Answer | str:
    """What is asked for, or the name of the error that refuses it."""
    try:
        return ask()
    except (PointcoordError, NoReferenceError) as error:
        return type(error).__name__


def _reference(scene: Scene, instant: float) -> Instant:
    """The reference for the values that the laws have in double precision, as the bound is for these."""
    inputs = {name: (value, 0.0, 0.0) for name, (value, *_) in inputs_at(scene, instant).items()}
    return reference_instant(scene, inputs, digits=DIGITS)


def _error(reference: Instant, name: str, place: Array) -> float:
    """Largest component of the distance of a computed point from the true one, mm."""
    pairs = zip(reference.position[name], place, strict=True)
    return max(float(abs(as_fraction(exact, name) - Fraction(float(found)))) for exact, found in pairs)


@dataclass(frozen=True)
class BoundsStudy:
    """Poses close to the end of an input, and instants of motions towards one, held against the reference.

    A row of its records is a check or a refusal: the columns of `Check`, its variant called suspension, and
    refusal, the reason of one. Part is held or moving.

    Attributes:
        poses: how many cars are held close to the end of an input.
        motions: how many motions run towards one.
        seed: of both.
    """

    poses: int
    motions: int
    seed: int = 0

    name = "bounds"
    noun = "pose"
    chunk = 8
    columns: ClassVar[Mapping[str, Kind]] = {
        **dict.fromkeys(("suspension", "driven", "lock", "refusal"), "string"),
        **dict.fromkeys(NUMBERS, "float64"),
    }

    @property
    def settings(self) -> Mapping[str, str | int]:
        """The seed."""
        return {"seed": self.seed}

    @property
    def numbers(self) -> Sequence[Number]:
        """One for each car that is held, and for each motion."""
        held = (Number(HELD, number) for number in range(self.poses))
        return [*held, *(Number(MOVING, number) for number in range(self.motions))]

    def examine(self, number: Number) -> list[Row]:
        """Hold a pose, or the instants of a motion, against the reference."""
        if number.part == HELD:
            found = held_pose(near_pose(number.number, self.seed))
        else:
            found = moving_instants(number.number, self.seed)
        return [_row(one) for one in found]

    def findings(self, rows: Sequence[Row]) -> Findings:
        """Whether every bound holds, and how loose they are."""
        found = found_in(rows, self.seed)
        status = ExitStatus.DISAGREE if found.broken else ExitStatus.AGREE
        return Findings(bounds_parts(found), bounds_data(found), status)


def _row(one: Check | Refusal) -> Row:
    if isinstance(one, Refusal):
        return {"suspension": one.variant.words, "distance": one.distance, "refusal": one.reason}
    names = ("driven", "lock", *NUMBERS)
    return {"suspension": one.variant.words, **{name: getattr(one, name) for name in names}}


def found_in(rows: Sequence[Row], seed: int) -> FoundBounds:
    """What the rows of a study say."""
    variants = {variant.words: variant for variant in VARIANTS}
    checks: dict[str, list[Check]] = {HELD: [], MOVING: []}
    refusals = []
    for row in rows:
        number, variant = row["number"], variants[row["suspension"]]
        if row["refusal"] is not None:
            refusals.append(Refusal(number, variant, row["distance"], row["refusal"]))
            continue
        given = {name: row[name] for name in ("driven", "lock", *NUMBERS)}
        checks[row["part"]].append(Check(number=number, variant=variant, **given))
    return FoundBounds(seed, tuple(checks[HELD]), tuple(checks[MOVING]), tuple(refusals))


@dataclass(frozen=True)
class Fit:
    """log10 y = slope log10 x + constant by least squares.

    Attributes:
        slope: its value.
        scatter: root mean square of what is left, in decades.
        poses: how many were fitted; errors of zero have no logarithm and are left out.
    """

    slope: float
    scatter: float
    poses: int


def fitted(x: Sequence[float], y: Sequence[float]) -> Fit:
    """Fit a power law; NaN with fewer than three different x."""
    pairs = [(math.log10(a), math.log10(b)) for a, b in zip(x, y, strict=True) if 0.0 < b < math.inf]
    if len({a for a, _ in pairs}) < 3:
        return Fit(math.nan, math.nan, len(pairs))
    u, v = np.array(pairs).T
    slope, constant = np.polyfit(u, v, 1)
    return Fit(float(slope), float(np.sqrt(np.mean((v - slope * u - constant) ** 2))), len(pairs))


def error_over_rounding(checks: Sequence[Check]) -> Fit:
    """Error over eps (condition size + far): slope 1 where rounding alone makes it."""
    return fitted([c.rounding / c.size for c in checks], [c.error / c.size for c in checks])


def error_over_distance(checks: Sequence[Check]) -> Fit:
    """The same over the distance from the end, near it, of cars near their origin: slope -1/2 at a fold."""
    near = [c for c in checks if c.distance < FOLD and c.far < 10.0 * c.size]
    return fitted([c.distance for c in near], [c.error / c.size for c in near])


def looseness(checks: Sequence[Check]) -> dict[str, Array]:
    """Bound over error, which is infinite where the error is zero, for both kinds of points."""
    with np.errstate(divide="ignore"):
        return {
            "solved points": np.array([c.bound for c in checks]) / [c.error for c in checks],
            "carried points": np.array([c.carried_bound for c in checks]) / [c.carried_error for c in checks],
        }


def of_variant(checks: Sequence[Check], variant: Variant) -> tuple[Check, ...]:
    """The checks of one kind of suspension."""
    return tuple(check for check in checks if check.variant == variant)


def decades(checks: Sequence[Check]) -> list[tuple[int, list[Check]]]:
    """Checks by the decade of their distance from the end, nearest first."""
    found: dict[int, list[Check]] = {}
    for check in checks:
        found.setdefault(math.floor(math.log10(check.distance)), []).append(check)
    return sorted(found.items())


def bounds_parts(study: FoundBounds) -> tuple[Part, ...]:
    """The whole study."""
    sets = (
        (study.held, "poses", ", held close to the end of an input"),
        (study.moving, "instants of motions", " that run towards the end of an input"),
    )
    return (
        _summary(study),
        "",
        *(
            part
            for checks, what, how in sets
            for variant in VARIANTS
            for part in _set_parts(f"{what} of cars ({variant.words}){how}", of_variant(checks, variant))
        ),
        f"refused: {len(study.refusals)}",
        *(f"  {count}  {reason}" for reason, count in _reasons(study)),
        f"bounds below the error: {len(study.broken)}",
        *(f"  {_case(check)}" for check in study.broken),
    )


def _summary(study: FoundBounds) -> Table:
    """A row for each suspension and closure."""
    rows = []
    for variant in VARIANTS:
        held, moving = of_variant(study.held, variant), of_variant(study.moving, variant)
        checks = (*held, *moving)
        refused = sum(refusal.variant == variant for refusal in study.refusals)
        counts = (len(held), len(moving), refused, sum(not check.share <= 1.0 for check in checks))
        share = f"{max(c.share for c in checks):.7g}" if checks else "-"
        loose = f"{np.median(looseness(checks)['solved points']):.3g}" if checks else "-"
        rows.append((variant.words, *map(str, counts), share, loose))
    head = ("suspension", "poses held", "instants of motions", "refused", "bounds below the error")
    return Table((*head, "largest error / bound", "median bound / error"), tuple(rows))


def _set_parts(name: str, checks: Sequence[Check]) -> tuple[Part, ...]:
    if not checks:
        return (f"{name}: none",)
    by_rounding, by_distance = error_over_rounding(checks), error_over_distance(checks)
    rows = [
        (
            f"1e{decade} to 1e{decade + 1}",
            str(len(part)),
            f"{np.median([c.condition for c in part]):.1e}",
            f"{np.median([c.error / c.size for c in part]):.1e}",
            f"{np.median([c.loss for c in part]):.2g}",
            f"{max(c.loss for c in part):.2g}",
            f"{np.median(looseness(part)['solved points']):.3g}",
            f"{max(c.share for c in part):.2g}",
        )
        for decade, part in decades(checks)
    ]
    head = (
        *("distance / range", "poses", "condition", "error / size", "loss", "largest loss"),
        *("bound / error", "largest error / bound"),
    )
    quantiles = [
        (points, *(f"{np.quantile(ratio, level, method='nearest'):.3g}" for level in LEVELS))
        for points, ratio in looseness(checks).items()
    ]
    worst, most = max(checks, key=lambda c: c.share), max(checks, key=lambda c: c.loss)
    return (
        f"{len(checks)} {name}; medians, unless it says largest",
        "loss = error / (eps (condition size + far)), far the distance from the scene's origin",
        Table(head, tuple(rows)),
        Table(("bound / error at", *(f"{100 * level:g}%" for level in LEVELS)), tuple(quantiles)),
        f"error over eps (condition size + far): slope {by_rounding.slope:.3f} (rounding alone: 1), "
        f"scatter {by_rounding.scatter:.2f} decades",
        f"error over distance below {FOLD:g}: slope {by_distance.slope:.3f} (fold: -1/2), "
        f"scatter {by_distance.scatter:.2f} decades",
        f"nearest to its bound: {_case(worst)}",
        f"largest loss: {_case(most)}",
        "",
    )


def _case(check: Check) -> str:
    return (
        f"number {check.number}, {check.variant.words}, "
        f"{check.driven} {check.distance:.2e} from the end ({check.lock}), "
        f"t = {check.instant!r} s: error / bound {check.share:.3g}, error {check.error:.2e} mm, "
        f"carried points {check.carried_error:.2e} mm, condition {check.condition:.2e}, loss {check.loss:.2g}"
    )


def _reasons(study: FoundBounds) -> list[tuple[str, int]]:
    return Counter(refusal.reason for refusal in study.refusals).most_common()


def bounds_data(study: FoundBounds) -> dict[str, Any]:
    """The study as numbers, words, lists and mappings; None where a number is not finite."""
    return {
        "seed": study.seed,
        "refusals": [{"reason": reason, "poses": count} for reason, count in _reasons(study)],
        "broken": [_plain(asdict(check)) for check in study.broken],
        "held": {v.words: _set_data(of_variant(study.held, v)) for v in VARIANTS},
        "moving": {v.words: _set_data(of_variant(study.moving, v)) for v in VARIANTS},
    }


def _set_data(checks: Sequence[Check]) -> dict[str, Any]:
    ratios = looseness(checks)
    return {
        "count": len(checks),
        "bound_over_error": {
            points.replace(" ", "_"): {
                f"{level:g}": _finite(float(np.quantile(ratio, level, method="nearest"))) for level in LEVELS
            }
            for points, ratio in ratios.items()
            if len(ratio)
        },
        "error_over_rounding": _plain(asdict(error_over_rounding(checks))),
        "error_over_distance": _plain(asdict(error_over_distance(checks))),
        "largest_loss": max((c.loss for c in checks), default=None),
        "largest_error_over_bound": max((c.share for c in checks), default=None),
        "checks": [_plain(asdict(check)) for check in checks],
    }


def _plain(fields: dict[str, Any]) -> dict[str, Any]:
    return {key: _finite(value) if isinstance(value, float) else value for key, value in fields.items()}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
