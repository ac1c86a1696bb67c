"""`pointcoord study random`: random scenes, up to hundreds of thousands, solved by both models.

Every scene has one outcome: both models agree, both refuse, one refuses, they disagree, or one of them fails
with an error that is no refusal. Two models may agree on a wrong car, so of the scenes that agree one in
twenty is compared with the reference, in every quantity. The table at the end counts all scenes.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Sequence

import pandas as pd

from pointcoord import SceneError
from pointcoord.effects.registry import QUANTITIES
from validate.cars.base_cars import variants
from validate.cars.random_scenes import KINDS, SEED, RandomScene, random_scene
from validate.comparison.compare import Outcome, compare_solutions
from validate.exit_status import ExitStatus
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.refusals import same_reason, why_refused
from validate.formulations.registry import formulation
from validate.output.report import counted_as
from validate.output.table import Part, Table
from validate.studies.study import Findings, Row, Study, Task
from validate.studies.verdicts import NO_OBSTACLE, NONE_WRONG, judged, obstacle, unanswered

PART = "scenes"
OURS = "pointcoord"
OTHER = "absolute"
ALONE = 1.0 - 1e-9  # from this part up, one model's bound is the whole tolerance
HELD = 20  # of the scenes that agree, one in so many is compared with the reference
# Parts of outcomes that make the exit status 1, such as a wrong answer of the only model that answers.
FAULTY = ("disagreed", " fails: ", " wrong", "agreed, the reference: no such pose")
COLUMNS = dict.fromkeys(("suspension", "kind", "outcome", "reason", "scene", "shares"), "string")
# The beginnings of outcomes, in the order of the tables.
HEADS = ("agreed", "not tested", "not given", "both refuse", "only", "disagreed")


def random_cars(count: int = 20_000) -> Study:
    """The study of random scenes from number 0 up, solved by both models.

    A row is a scene: suspension, kind of scene and outcome; for some outcomes the reason and the scene as
        JSON; if
    both models agree, the shares as JSON: the largest share of its tolerance for each quantity.
    """
    tasks = [Task(PART, number) for number in range(count)]
    return Study("random", "scene", {"seed": SEED}, COLUMNS, tasks, scene_row, found, chunk=4)


def scene_row(task: Task) -> list[Row]:
    """The row of a scene, solved by both models."""
    car = random_scene(task.number)
    return [{"suspension": car.variant.words, "kind": car.kind, **examined(car)}]


def examined(car: RandomScene) -> Row:
    """Solve one scene by both models; returns the outcome and further columns of its row."""
    answers: list[Solution] = []
    refusals: list[FormulationError] = []
    for name in (OURS, OTHER):
        try:
            answers.append(_solved(name, car))
        except FormulationError as error:
            refusals.append(error)
        # Any other error is a defect of a model: it is recorded, and the run continues.
        except Exception as error:
            return _kept(car, f"{name} fails: {type(error).__name__}", " ".join(str(error).split()))
    if not refusals:
        return _compared(car, *answers)
    message, reasons = " ".join(str(refusals[0].reason).split()), [why_refused(one) for one in refusals]
    if answers:
        # Only one model answers: its positions are enough to decide which model is right.
        verdict = judged(car.scene.model_copy(update={"effects": ()}), *answers)
        if verdict == NONE_WRONG:
            verdict = f"answer right, {obstacle(car.scene)}"
        return _kept(car, f"only {refusals[0].formulation} refuses, {reasons[0]}: {verdict}", message)
    alike, why = "same reason" if same_reason(*reasons) else "different reasons", unanswered(car.scene)
    outcome = f"both refuse, {alike}: {' | '.join(dict.fromkeys(reasons))}: {why}"
    # The scene of an unexplained refusal is recorded for inspection, even if both models refuse.
    return _kept(car, outcome, message) if why == NO_OBSTACLE else {"outcome": outcome, "reason": message}


def _kept(car: RandomScene, outcome: str, reason: str | None = None) -> Row:
    """The columns of an outcome, with the whole scene for inspection."""
    content = car.scene.model_dump(mode="json", exclude_none=True)
    return {"outcome": outcome, "reason": reason or None, "scene": json.dumps(content)}


def _solved(name: str, car: RandomScene) -> Solution:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return formulation(name).solve(car.scene)
        except SceneError as error:
            raise FormulationError(name, error) from error


def _compared(car: RandomScene, first: Solution, second: Solution) -> Row:
    outcome = compare_solutions(car.scene, first, second, car.scene.title)
    if outcome.agreed:
        verdict = judged(car.scene, first, second) if car.number % HELD == 0 else None
        if verdict in (None, NONE_WRONG):
            name = "agreed" if verdict is None else "agreed, and with the reference"
            return {"outcome": name, "shares": _shares(outcome)}
        return _kept(car, f"agreed, the reference: {verdict}") | {"shares": _shares(outcome)}
    worst = (*outcome.disagreements, *outcome.undecided)[0]
    reason = (
        f"{worst.quantity} of {worst.name} differs by {worst.difference:.3g} {worst.unit}, "
        f"tolerance {worst.tolerance:.3g}, at t = {worst.instant:.6g} s"
    )
    if worst.verdict != "disagrees":
        limit = f", {worst.part:.6f} of it the error bound of {worst.rests_on}"
        return _kept(car, f"{worst.verdict}: {worst.quantity}", reason + limit)
    return _kept(car, f"disagreed in {worst.quantity}: {judged(car.scene, first, second)}", reason)


def _shares(outcome: Outcome) -> str:
    """The largest share of each quantity, and of each number of the car over all its wheels.

    Rows in which only one model has an error bound, as for a point at rest, are left out.
    """
    largest: dict[str, float] = {}
    for row in outcome.rows:
        if row.part < ALONE:
            own = row.name.rpartition(".")[2]
            name = own if QUANTITIES[row.quantity].of == "car" else row.quantity
            largest[name] = max(largest.get(name, 0.0), row.share)
    return json.dumps(largest)


def found(rows: Sequence[Row]) -> Findings:
    """The findings: counts of all outcomes, and the largest share of each tolerance."""
    table = pd.DataFrame(rows, columns=["number", "seconds", *COLUMNS])
    kept = [row for row in rows if row.get("scene") is not None]
    counts = table.groupby(["suspension", "kind", "outcome"]).size().reset_index(name="scenes")
    largest: dict[str, tuple[float, int]] = {}
    for row in rows:
        for name, share in json.loads(row.get("shares") or "{}").items():
            largest[name] = max(largest.get(name, (0.0, 0)), (share, row["number"]))
    names = ("number", "suspension", "kind", "outcome", "reason")
    data = {
        "seed": SEED,
        "scenes": len(table),
        "outcomes": counts.to_dict("records"),
        "largest_shares": [
            {"quantity": name, "share": share, "scene": scene} for name, (share, scene) in largest.items()
        ],
        "written_down": [
            {**{name: row.get(name) for name in names}, "scene": json.loads(row["scene"])} for row in kept
        ],
    }
    parts: list[Part] = [_summary(table), "", _outcomes(table)]
    if largest:
        lines = ((name.replace("_", " "), f"{one:.3g}", str(at)) for name, (one, at) in largest.items())
        head = ("quantity", "largest share of tolerance", "scene")
        parts += ["", "Where both agreed:", Table(head, tuple(lines))]
    last = (
        f"{counted_as(len(table), 'scene')} recorded, {len(kept):,} of them with the whole scene for "
        f"inspection; {table['seconds'].sum():.0f} s of work in all runs and processes."
    )
    status = ExitStatus.DISAGREE if table["outcome"].map(_is_faulty).any() else ExitStatus.AGREE
    return Findings((*parts, "", last), data, status)


def _is_faulty(outcome: str) -> bool:
    return any(word in outcome for word in FAULTY)


def _summary(table: pd.DataFrame) -> Table:
    """A row for each suspension and closure."""
    rows = []
    for variant in variants():
        here = list(table["outcome"][table["suspension"] == variant.words])
        begun = [sum(outcome.startswith(head) for outcome in here) for head in HEADS]
        rows.append((variant.words, *map(str, (len(here), *begun, sum(map(_is_faulty, here))))))
    return Table(("suspension", "scenes", *HEADS, "of these wrong"), tuple(rows))


def _outcomes(here: pd.DataFrame) -> Table:
    """Counts of the outcomes by kind of scene."""
    counts = pd.crosstab(here["outcome"], here["kind"]).reindex(columns=KINDS, fill_value=0)
    counts = counts.loc[sorted(counts.index, key=_order)]
    counts.loc["mechanisms tried"] = counts.sum()
    rows = ((outcome, str(sum(line)), *map(str, line)) for outcome, *line in counts.itertuples())
    return Table(("outcome", "all", *KINDS), tuple(rows))


def _order(outcome: str) -> tuple[int, str]:
    return next((i for i, head in enumerate(HEADS) if outcome.startswith(head)), len(HEADS)), outcome
