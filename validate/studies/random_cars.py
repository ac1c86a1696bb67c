"""Random scenes by the hundred thousand through both models: `pointcoord study random`.

Every scene has one outcome: both models agree, both refuse, one refuses, they disagree, or one of them fails
in a way it should not. Two models may agree on a wrong car, so where they agree one scene in twenty is held
to the reference, in every quantity. Nothing is folded away: the table at the end counts them all.
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
ALONE = 1.0 - 1e-9  # a part of a tolerance that is all of it
HELD = 20  # every so many scenes are held to the reference although both models agree
# What makes the status 1; an answer that stands alone and is wrong is one of them.
FAULTY = ("disagreed", " fails: ", " wrong", "agreed, the reference: no such pose")
COLUMNS = dict.fromkeys(("suspension", "kind", "outcome", "reason", "scene", "shares"), "string")
# How outcomes begin, in the order in which they are shown.
HEADS = ("agreed", "not tested", "not given", "both refuse", "only", "disagreed")


def random_cars(count: int = 20_000) -> Study:
    """Random scenes of the numbers from 0 up through two models.

    A row is a scene: suspension, kind of scene, outcome, and where there is more to say reason and scene, as
    JSON; where both models agree shares, as JSON: the largest part of its tolerance that each quantity used.
    """
    tasks = [Task(PART, number) for number in range(count)]
    return Study("random", "scene", {"seed": SEED}, COLUMNS, tasks, scene_row, found, chunk=4)


def scene_row(task: Task) -> list[Row]:
    """Solve the scene of a number by both models."""
    car = random_scene(task.number)
    return [{"suspension": car.variant.words, "kind": car.kind, **examined(car)}]


def examined(car: RandomScene) -> Row:
    """Solve one scene by both models and say what came of it: the outcome and what there is to say of it."""
    answers: list[Solution] = []
    refusals: list[FormulationError] = []
    for name in (OURS, OTHER):
        try:
            answers.append(_solved(name, car))
        except FormulationError as error:
            refusals.append(error)
        # Any other error is a defect of a model: it is counted and written down, and the run goes on.
        except Exception as error:
            return _kept(car, f"{name} fails: {type(error).__name__}", " ".join(str(error).split()))
    if not refusals:
        return _compared(car, *answers)
    told, reasons = " ".join(str(refusals[0].reason).split()), [why_refused(one) for one in refusals]
    if answers:
        # Of what stands alone the positions count: they say which of the two is right.
        verdict = judged(car.scene.model_copy(update={"effects": ()}), *answers)
        if verdict == NONE_WRONG:
            verdict = f"answer right, {obstacle(car.scene)}"
        return _kept(car, f"only {refusals[0].formulation} refuses, {reasons[0]}: {verdict}", told)
    alike, why = "same reason" if same_reason(*reasons) else "different reasons", unanswered(car.scene)
    outcome = f"both refuse, {alike}: {' | '.join(dict.fromkeys(reasons))}: {why}"
    # A refusal that nothing explains is worth a look, even if both models agree in it.
    return _kept(car, outcome, told) if why == NO_OBSTACLE else {"outcome": outcome, "reason": told}


def _kept(car: RandomScene, outcome: str, reason: str | None = None) -> Row:
    """An outcome whose whole scene is recorded, to be looked into."""
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
        said = f", {worst.part:.6f} of it the error bound of {worst.rests_on}"
        return _kept(car, f"{worst.verdict}: {worst.quantity}", reason + said)
    return _kept(car, f"disagreed in {worst.quantity}: {judged(car.scene, first, second)}", reason)


def _shares(outcome: Outcome) -> str:
    """Largest share of each quantity, and of each number of the car, whichever wheel it is of.

    Where one model claims nothing, as of a point at rest, a share says nothing of what both claim.
    """
    largest: dict[str, float] = {}
    for row in outcome.rows:
        if row.part < ALONE:
            own = row.name.rpartition(".")[2]
            name = own if QUANTITIES[row.quantity].of == "car" else row.quantity
            largest[name] = max(largest.get(name, 0.0), row.share)
    return json.dumps(largest)


def found(rows: Sequence[Row]) -> Findings:
    """Every outcome counted, and the largest share of each tolerance."""
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
        f"{counted_as(len(table), 'scene')} recorded, {len(kept):,} of them as a whole scene, to be looked "
        f"into; {table['seconds'].sum():.0f} s of work, of all runs and processes."
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
    """How often each outcome came, by kind of scene."""
    counts = pd.crosstab(here["outcome"], here["kind"]).reindex(columns=KINDS, fill_value=0)
    counts = counts.loc[sorted(counts.index, key=_order)]
    counts.loc["mechanisms tried"] = counts.sum()
    rows = ((outcome, str(sum(line)), *map(str, line)) for outcome, *line in counts.itertuples())
    return Table(("outcome", "all", *KINDS), tuple(rows))


def _order(outcome: str) -> tuple[int, str]:
    return next((i for i, head in enumerate(HEADS) if outcome.startswith(head)), len(HEADS)), outcome
