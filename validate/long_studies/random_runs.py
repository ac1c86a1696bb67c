"""Random scenes by the hundred thousand through both models: `pointcoord study random`.

Every scene has one outcome: both models agree, both refuse, one refuses, they disagree, or one of them fails
in a way it should not. Two models may agree on a wrong car, so where they agree one scene in twenty is held
to the reference, in every quantity. Nothing is folded away: the table at the end counts them all.
"""

from __future__ import annotations

import json
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from pointcoord import SceneError
from pointcoord.effects.registry import ALWAYS, EFFECTS, QUANTITIES
from validate.adjudication.verdicts import (
    NEITHER_WRONG,
    NO_OBSTACLE,
    judged,
    judged_alone,
    obstacle,
    unanswered,
)
from validate.cars.random_cars import KINDS
from validate.cars.random_scenes import SEED, RandomScene, random_scene
from validate.cars.registry import VARIANTS
from validate.comparison.compare import Outcome, compare_solutions
from validate.exit_status import ExitStatus
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.refusals import same_reason, why_refused
from validate.formulations.registry import formulation
from validate.long_studies.study import Findings, Kind, Number, Row, counted
from validate.output.terminal import Part, Table

PART = "scenes"
OURS = "pointcoord"
OTHER = "absolute"
METHODS = (OURS, "pointcoord-map", "pointcoord-newton")
ALONE = 1.0 - 1e-9  # a part of a tolerance that is all of it
HELD = 20  # every so many scenes are held to the reference although both models agree
# What makes the status 1; an answer that stands alone and is wrong is one of them.
FAULTY = (
    "disagreed",
    " fails: ",
    "agreed, the reference: pointcoord",
    "agreed, the reference: absolute",
    "agreed, the reference: no such pose",
    "answer wrong",
)

# What a share of a tolerance is told of: each quantity, and each number of the whole car.
SHARED = tuple(
    dict.fromkeys(
        name
        for effect in (*ALWAYS, *EFFECTS.values())
        for quantity, names in effect.gives_numbers.items()
        for name in (names or () if QUANTITIES[quantity].of == "car" else (quantity,))
    )
)
# How outcomes begin, in the order in which they are shown.
HEADS = ("agreed", "not tested", "not given", "both refuse", "only", "disagreed")


@dataclass(frozen=True)
class Result:
    """What came of one scene.

    Attributes:
        outcome: the class that it is counted in.
        reason: what there is to say of this scene alone; empty if nothing.
        shares: per quantity, the largest share of its tolerance, where both models answered.
        kept: whether the whole scene is recorded, to be looked into.
    """

    outcome: str
    reason: str
    shares: dict[str, float]
    kept: bool


def examine(car: RandomScene, ours: str = OURS) -> Result:
    """Solve one scene by both models and say what came of it.

    Args:
        ours: by which of pointcoord's methods.
    """
    answers: list[Solution | FormulationError] = []
    for name in (ours, OTHER):
        try:
            answers.append(_solved(name, car))
        except FormulationError as error:
            answers.append(error)
        # Any other error is a defect of a model: it is counted and written down, and the run goes on.
        except Exception as error:
            return Result(f"{name} fails: {type(error).__name__}", " ".join(str(error).split()), {}, True)
    first, second = answers
    if isinstance(first, Solution) and isinstance(second, Solution):
        return _compared(car, first, second)
    if isinstance(first, FormulationError) and isinstance(second, FormulationError):
        reasons = why_refused(first), why_refused(second)
        shown = reasons[0] if reasons[0] == reasons[1] else " | ".join(reasons)
        alike = "same reason" if same_reason(*reasons) else "different reasons"
        why = unanswered(car.scene)
        # A refusal that nothing explains is worth a look, even if both models agree in it.
        return Result(f"both refuse, {alike}: {shown}: {why}", _told(first), {}, why == NO_OBSTACLE)
    return _one_sided(car, answers)


def _solved(name: str, car: RandomScene) -> Solution:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return formulation(name).solve(car.scene)
        except SceneError as error:
            raise FormulationError(name, error) from error


def _compared(car: RandomScene, first: Solution, second: Solution) -> Result:
    outcome = compare_solutions(car.scene, first, second, car.scene.title)
    if outcome.agreed and car.number % HELD:
        return Result("agreed", "", _shares(outcome), False)
    if outcome.agreed:
        verdict = judged(car.scene, first, second)
        right = verdict == NEITHER_WRONG
        name = "agreed, and with the reference" if right else f"agreed, the reference: {verdict}"
        return Result(name, "", _shares(outcome), not right)
    worst = (*outcome.disagreements, *outcome.undecided)[0]
    reason = (
        f"{worst.quantity} of {worst.name} differs by {worst.difference:.3g} {worst.unit}, "
        f"tolerance {worst.tolerance:.3g}, at t = {worst.instant:.6g} s"
    )
    if worst.verdict != "disagrees":
        said = f", {worst.part:.6f} of it what {worst.rests_on} claims"
        return Result(f"{worst.verdict}: {worst.quantity}", reason + said, {}, True)
    kind = f"disagreed in {worst.quantity}: {judged(car.scene, first, second)}"
    return Result(kind, reason, {}, True)


def _one_sided(car: RandomScene, answers: Sequence[Solution | FormulationError]) -> Result:
    (error,) = (a for a in answers if isinstance(a, FormulationError))
    (answer,) = (a for a in answers if isinstance(a, Solution))
    verdict = judged_alone(car.scene, answer)
    if verdict == "answer right":
        verdict += f", {obstacle(car.scene)}"
    outcome = f"only {error.formulation} refuses, {why_refused(error)}: {verdict}"
    return Result(outcome, _told(error), {}, True)


def _told(error: FormulationError) -> str:
    return " ".join(str(error.reason).split())


def _shares(outcome: Outcome) -> dict[str, float]:
    """Largest share of each quantity, and of each wheel angle.

    Where one model claims nothing, as of a point at rest, a share says nothing of what both claim.
    """
    largest: dict[str, float] = {}
    for row in outcome.rows:
        if row.part < ALONE:
            what = row.name if QUANTITIES[row.quantity].of == "car" else row.quantity
            largest[what] = max(largest.get(what, 0.0), row.share)
    return largest


@dataclass(frozen=True)
class RandomStudy:
    """Random scenes of the numbers from 0 up through two models.

    A row of its records is a scene. Its columns: suspension, kind of scene, outcome, and where there is more
    to say reason and scene, as JSON; `share_...`, the largest part of its tolerance that each quantity used
    up, where both models agree.

    Attributes:
        count: of scenes.
        first: by which of pointcoord's methods.
    """

    count: int
    first: str = OURS

    name = "random"
    noun = "scene"
    chunk = 4
    columns: ClassVar[Mapping[str, Kind]] = {
        **dict.fromkeys(("suspension", "kind", "outcome", "reason", "scene"), "string"),
        **{f"share_{quantity}": "float64" for quantity in SHARED},
    }

    @property
    def settings(self) -> Mapping[str, str | int]:
        """The recipe of the scenes, and the method."""
        return {"seed": SEED, "first": self.first}

    @property
    def numbers(self) -> Sequence[Number]:
        """One for each scene."""
        return [Number(PART, number) for number in range(self.count)]

    def examine(self, number: Number) -> list[Row]:
        """Solve the scene by both models."""
        car = random_scene(number.number)
        result = examine(car, self.first)
        content = car.scene.model_dump(mode="json", exclude_none=True) if result.kept else None
        return [
            {
                "suspension": car.variant.words,
                "kind": car.kind,
                "outcome": result.outcome,
                "reason": result.reason or None,
                "scene": None if content is None else json.dumps(content),
                **{f"share_{quantity}": result.shares.get(quantity) for quantity in SHARED},
            }
        ]

    def findings(self, rows: Sequence[Row]) -> Findings:
        """Every outcome counted, and the largest share of each tolerance."""
        faulty = any(word in row["outcome"] for row in rows for word in FAULTY)
        return Findings(_parts(rows), self._data(rows), ExitStatus.DISAGREE if faulty else ExitStatus.AGREE)

    def _data(self, rows: Sequence[Row]) -> dict[str, Any]:
        return {
            **self.settings,
            "scenes": len(rows),
            "outcomes": [
                {"suspension": suspension, "kind": kind, "outcome": outcome, "scenes": count}
                for (suspension, kind, outcome), count in sorted(_counts(rows).items())
            ],
            "largest_shares": [
                {"quantity": quantity, "share": share, "scene": number}
                for quantity, (share, number) in _shares_of(rows).items()
            ],
            "written_down": [
                {name: row[name] for name in ("number", "suspension", "kind", "outcome", "reason")}
                | {"scene": json.loads(row["scene"])}
                for row in rows
                if row["scene"] is not None
            ],
        }


def _counts(rows: Sequence[Row]) -> Counter[tuple[str, str, str]]:
    """How often each suspension, kind of scene and outcome was seen."""
    return Counter((row["suspension"], row["kind"], row["outcome"]) for row in rows)


def _shares_of(rows: Sequence[Row]) -> dict[str, tuple[float, int]]:
    """Per quantity, the largest share of its tolerance and the scene that used it."""
    found = {}
    for quantity in SHARED:
        name = f"share_{quantity}"
        given = [(row[name], row["number"]) for row in rows if row[name] is not None]
        if given:
            found[quantity] = max(given)
    return found


def _parts(rows: Sequence[Row]) -> tuple[Part, ...]:
    """Every outcome by suspension and by kind of scene, and the largest share of each tolerance."""
    total = _counts(rows)
    parts: list[Part] = [_summary(total)]
    for variant in VARIANTS:
        parts += ["", f"{variant.words}:", _outcomes(total, variant.words)]
    if shares := _shares_of(rows):
        lines = ((q.replace("_", " "), f"{share:.3g}", str(scene)) for q, (share, scene) in shares.items())
        head = ("quantity", "largest share of tolerance", "scene")
        parts += ["", "Where both agreed:", Table(head, tuple(lines))]
    written = sum(row["scene"] is not None for row in rows)
    seconds = sum(row["seconds"] for row in rows)
    parts += [
        "",
        f"{counted(len(rows), 'scene')} recorded, {written:,} of them as a whole scene, to be looked "
        f"into; {seconds:.0f} s of work, of all runs and processes.",
    ]
    return tuple(parts)


def _summary(total: Counter[tuple[str, str, str]]) -> Table:
    """A row for each suspension and closure."""
    rows = []
    for variant in VARIANTS:
        here = {outcome: 0 for _, _, outcome in total}
        for (suspension, _, outcome), count in total.items():
            here[outcome] += count * (suspension == variant.words)
        begun = [sum(n for outcome, n in here.items() if outcome.startswith(h)) for h in HEADS]
        faulty = sum(n for outcome, n in here.items() if any(word in outcome for word in FAULTY))
        rows.append((variant.words, *map(str, (sum(here.values()), *begun, faulty))))
    return Table(("suspension", "scenes", *HEADS, "of these wrong"), tuple(rows))


def _outcomes(total: Counter[tuple[str, str, str]], suspension: str) -> Table:
    outcomes = sorted({outcome for where, _, outcome in total if where == suspension}, key=_order)
    rows = []
    for outcome in outcomes:
        counts = [total[suspension, kind, outcome] for kind in KINDS]
        rows.append((outcome, str(sum(counts)), *(str(count) for count in counts)))
    tried = [sum(total[suspension, kind, outcome] for outcome in outcomes) for kind in KINDS]
    rows.append(("mechanisms tried", str(sum(tried)), *(str(n) for n in tried)))
    return Table(("outcome", "all", *KINDS), tuple(rows))


def _order(outcome: str) -> tuple[int, str]:
    return next((i for i, head in enumerate(HEADS) if outcome.startswith(head)), len(HEADS)), outcome
