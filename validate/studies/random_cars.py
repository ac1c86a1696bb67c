"""`pointcoord study random`: random scenes, up to hundreds of thousands, solved by both models.

Every scene has one outcome: both models agree, both refuse, one refuses, they disagree, or one of them fails
with an error that is no refusal. Two models may agree on a wrong car, so of the scenes that agree one in
twenty is compared with the reference, in every quantity. The table at the end counts all scenes.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import pandas as pd

from pointcoord import Scene, SceneError
from pointcoord.effects.registry import QUANTITIES
from validate.cars.base_cars import variants
from validate.cars.random_scenes import KINDS, SEED, RandomScene, random_scene
from validate.comparison.compare import Outcome, compare_solutions
from validate.exit_status import ExitStatus
from validate.formulations.protocol import FormulationError, Solution, reason_of
from validate.formulations.reference_solution import (
    design_of,
    inputs_at,
    reference_instant,
    reference_solution,
    told_by,
)
from validate.formulations.refusals import same_reason, why_refused
from validate.hard.answer import solved
from validate.output.table import Part, Table
from validate.plain_text import counted_as
from validate.reference import InfeasibleError, NoReferenceError, instants_of
from validate.studies.study import Findings, Row, Study, Task

PART = "scenes"
OURS = "pointcoord"
OTHER = "absolute"
ALONE = 1.0 - 1e-9  # from this part up, one model's bound is the whole tolerance
NO_OBSTACLE = "no obstacle found"
NONE_WRONG = "none wrong by its own tolerance"
DIGITS = 15  # digits of the reference if only the existence of a pose matters
BETWEEN = 24  # number of instants between the first and the last at which a pose is looked for
HELD = 20  # of the scenes that agree, one in so many is compared with the reference
# Parts of outcomes that make the exit status 1, such as a wrong answer of the only model that answers.
FAULTY = ("disagreed", " fails: ", " wrong", "agreed, the reference: no such pose")
COLUMNS = dict.fromkeys(("suspension", "kind", "outcome", "reason", "scene", "shares"), "string")
# The beginnings of outcomes, in the order of the tables.
HEADS = ("agreed", "not tested", "not given", "both refuse", "only", "disagreed")


def random_cars(count: int = 20_000) -> Study:
    """The study of random scenes from number 0 up, solved by both models.

    A row is a scene: suspension, kind of scene and outcome; for some outcomes the reason and the scene as
    JSON; if both models agree, the shares as JSON: the largest share of its tolerance for each quantity.
    """
    tasks = [Task(PART, number) for number in range(count)]
    return Study("random", "scene", {"seed": SEED}, COLUMNS, tasks, scene_row, found)


def scene_row(task: Task) -> list[Row]:
    """The row of a scene, solved by both models."""
    car = random_scene(task.number)
    return [{"suspension": car.variant.words, "kind": car.kind, **examined(car)}]


def examined(car: RandomScene) -> Row:
    """Solve one scene by both models; returns the outcome and further columns of its row."""
    came = {name: solved(name, car.scene) for name in (OURS, OTHER)}
    for name, one in came.items():
        # Any other error is a defect of a model: it is recorded, and the run continues.
        if not isinstance(one, Solution | FormulationError | SceneError):
            return _kept(car, f"{name} fails: {type(one).__name__}", " ".join(str(one).split()))
    answers = [one for one in came.values() if isinstance(one, Solution)]
    refusals = {name: one for name, one in came.items() if isinstance(one, Exception)}
    if not refusals:
        return _compared(car, *answers)
    (who, first), reasons = next(iter(refusals.items())), [why_refused(one) for one in refusals.values()]
    message = " ".join(str(reason_of(first)).split())
    if answers:
        # Only one model answers: its positions are enough to decide which model is right.
        verdict = judged(car.scene.model_copy(update={"effects": ()}), *answers)
        if verdict == NONE_WRONG:
            verdict = f"answer right, {obstacle(car.scene)}"
        return _kept(car, f"only {who} refuses, {reasons[0]}: {verdict}", message)
    alike, why = "same reason" if same_reason(*reasons) else "different reasons", unanswered(car.scene)
    outcome = f"both refuse, {alike}: {' | '.join(dict.fromkeys(reasons))}: {why}"
    # The scene of an unexplained refusal is recorded for inspection, even if both models refuse.
    return _kept(car, outcome, message) if why == NO_OBSTACLE else {"outcome": outcome, "reason": message}


def _kept(car: RandomScene, outcome: str, reason: str | None = None) -> Row:
    """The columns of an outcome, with the whole scene for inspection."""
    content = car.scene.model_dump(mode="json", exclude_none=True)
    return {"outcome": outcome, "reason": reason or None, "scene": json.dumps(content)}


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


def judged(scene: Scene, *answers: Solution) -> str:
    """The solutions that the reference contradicts, in words, or why this is not known."""
    try:
        reference = reference_solution(scene)
    except NoReferenceError as error:
        return _unproven(error)
    asked = told_by(reference, scene)
    wrong = [
        one.formulation
        for one in answers
        if compare_solutions(scene, one, reference, "judged", asked).disagreements
    ]
    return f"{' and '.join(wrong)} wrong" if wrong else NONE_WRONG


def unanswered(scene: Scene) -> str:
    """Why a scene that all models refuse has no answer, as far as the reference can tell."""
    try:
        for time in scene.instants.tolist():
            reference_instant(scene, inputs_at(scene, time))
    except InfeasibleError:
        return "an instant has no pose"
    except NoReferenceError as error:
        return _unproven(error)
    return obstacle(scene)


def obstacle(scene: Scene) -> str:
    """Where between its drawing and its last instant a scene has no pose, so that a path cannot continue.

    The path from the drawing to the first instant is straight in the functions of the inputs that the
    reference's equations contain.
    """
    times = np.linspace(scene.time.start, scene.time.stop, BETWEEN + 2)
    instants = instants_of(design_of(scene), (inputs_at(scene, t) for t in times.tolist()), DIGITS)
    for where in ("on the way from the drawing to the start", *["between the instants"] * (len(times) - 1)):
        try:
            next(instants)
        except InfeasibleError:
            return f"no pose {where}"
        except NoReferenceError:
            return f"no provable pose {where}"
    return NO_OBSTACLE


def _unproven(error: NoReferenceError) -> str:
    return (
        "no such pose on the way from the drawing, proven"
        if isinstance(error, InfeasibleError)
        else f"not provable: {error.reason}"
    )


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
