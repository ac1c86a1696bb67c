r"""Tests whether pointcoord's proven bounds hold, and how loose they are, up to poses where a car locks.

The poses are random poses of every mechanism (see `near_singular`), reproducible by their numbers: cars held
close to the end of an input. Motions towards an end, and rates, are tested by `claims`.

    pointcoord study bounds --poses 10000

The error of a pose is its distance from the reference, whose own error is below 1e-40 of the car. It must
never exceed the bound, and a measure of lost digits must not grow towards the end:

    error <= bound,        loss = error / (eps (condition size + far)),

where size is the power of two in which the mechanism counts lengths, and far its distance from the origin.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TypeVar

import numpy as np
import pandas as pd

from pointcoord import PointcoordError, Scene, simulate
from pointcoord.numerics.rounding import EPS
from validate.cars.base_cars import variants
from validate.cars.car import content_of
from validate.cars.random_cars import NearPose, near_pose
from validate.exit_status import ExitStatus
from validate.formulations.reference_solution import inputs_at, off_by, reference_instant
from validate.output.table import Part, Table
from validate.reference import InfeasibleError, Instant, NoReferenceError
from validate.studies.study import Findings, Row, Study, Task

Answer = TypeVar("Answer")

DIGITS = 40  # digits of the reference: its error is 1e-20 of any error in double precision
PART = "held"

# Lengths in mm. A refused pose has only a suspension, a distance and a refusal.
COLUMNS: Mapping[str, str] = {
    **dict.fromkeys(("suspension", "driven", "refusal"), "string"),  # driven: of the `NearPose`
    "distance": "float64",  # from the end, in parts of the input's range
    "condition": "float64",  # of the Jacobian
    "size": "float64",  # of the mechanism, a power of two
    "far": "float64",  # largest coordinate of a point in the frame of the scene
    **dict.fromkeys(("error", "bound"), "float64"),  # of the solved points
    "share": "float64",  # the larger error / bound of the solved points and of the carried points
}


def bounds(poses: int = 2000, seed: int = 0) -> Study:
    """The study of poses held close to the end of an input."""
    tasks = [Task(PART, number) for number in range(poses)]
    examine, summary = partial(examined, seed=seed), partial(found, seed=seed)
    return Study("bounds", "pose", {"seed": seed}, COLUMNS, tasks, examine, summary)


def examined(task: Task, seed: int) -> list[Row]:
    """Compare the pose of a task with the reference."""
    return [held_pose(near_pose(task.number, seed))]


def held_pose(pose: NearPose) -> Row:
    """The row of a pose: its error against its bound, or the refusal."""
    where = {"suspension": pose.variant.words, "distance": pose.distance}
    scene = Scene.from_mapping(content_of(pose.car, pose.inputs, effects=()))
    # The inputs as rounded to double precision, because the bound is for these.
    inputs = {name: (value, 0.0, 0.0) for name, (value, *_) in inputs_at(scene, 0.0).items()}
    motion = _answer(lambda: simulate(scene))
    reference = _answer(lambda: reference_instant(scene, inputs, digits=DIGITS))
    if isinstance(motion, str) or (isinstance(reference, str) and reference != InfeasibleError.__name__):
        ours, theirs = (one if isinstance(one, str) else "answers" for one in (motion, reference))
        return {**where, "refusal": f"pointcoord: {ours}; reference: {theirs}"}
    proof = motion.proof()
    bound, carried = float(proof.bound[0]), float(proof.carried_bound[0])
    if not math.isfinite(bound):
        return {**where, "refusal": "pointcoord: no finite bound"}
    # The largest component of the error of each point, mm; infinite if the reference proves that there is no
    # pose.
    errors = dict.fromkeys(motion.position, math.inf)
    if isinstance(reference, Instant):
        for name, places in motion.position.items():
            pairs = zip(places[0], reference.position[name], strict=True)
            errors[name] = max(off_by(ours, exact) for ours, exact in pairs)
    others = set(scene.mechanism.topology.carried)
    solved = max(error for name, error in errors.items() if name not in others)
    shares = [solved / bound, *(errors[name] / carried for name in others)]
    return {
        **where,
        "driven": pose.driven,
        "condition": float(proof.condition[0]),
        "size": motion.unit,
        "far": max(float(np.abs(place).max()) for place in motion.position.values()),
        "error": solved,
        "bound": bound,
        "share": max(shares),
    }


def _answer(ask: Callable[[], Answer]) -> Answer | str:
    """The result of `ask`, or the name of its error."""
    try:
        return ask()
    except PointcoordError as error:
        return type(error).__name__
    except NoReferenceError as error:
        return error.reason


def measured(rows: Sequence[Row]) -> pd.DataFrame:
    """The rows of poses that were not refused, as a table.

    Returns:
        The table with further columns: `loss`, the error over the effect of rounding, eps (condition size +
            far);
        `loose`, bound / error of the solved points, infinite if the error is zero.
    """
    table = pd.DataFrame(rows, columns=list(dict.fromkeys(("part", "number", *COLUMNS))))
    table = table[table["refusal"].isna()].drop(columns="refusal").reset_index(drop=True)
    numbers = [name for name, kind in COLUMNS.items() if kind == "float64"]
    table[numbers] = table[numbers].astype(float)
    table["loss"] = table["error"] / (EPS * (table["condition"] * table["size"] + table["far"]))
    table["loose"] = table["bound"] / table["error"]
    return table


def found(rows: Sequence[Row], seed: int) -> Findings:
    """Whether every bound holds, and how loose they are."""
    checks, refusals = measured(rows), [row for row in rows if row.get("refusal") is not None]
    reasons = Counter(row["refusal"] for row in refusals).most_common()
    broken = checks[~(checks["share"] <= 1.0)]
    data = {
        "seed": seed,
        "checked": len(checks),
        "refusals": [{"reason": reason, "poses": count} for reason, count in reasons],
        "broken": broken.astype(object).where(broken.notna(), None).to_dict("records"),
    }
    parts: list[Part] = [
        _summary(checks, Counter(row["suspension"] for row in refusals)),
        "",
        f"{len(checks)} poses held close to the end of an input; medians, unless it says largest",
        _by_distance(checks),
        "",
        "loss = error / (eps (condition size + far)), far the distance from the scene's origin",
        f"refused: {len(refusals)}",
        *(f"  {count}  {reason}" for reason, count in reasons),
        f"bounds below the error: {len(broken)}",
        *(f"  number {row.number}, {row.suspension}: {row.share:.3g} times" for row in broken.itertuples()),
    ]
    return Findings(tuple(parts), data, ExitStatus.AGREE if broken.empty else ExitStatus.DISAGREE)


def _summary(checks: pd.DataFrame, refused: Mapping[str, int]) -> Table:
    """A row for each suspension and closure."""
    rows = []
    for words in (variant.words for variant in variants()):
        here = checks[checks["suspension"] == words]
        counts = (len(here), refused[words], int((~(here["share"] <= 1.0)).sum()))
        ends = f"{here['share'].max(skipna=False):.7g}", f"{here['loose'].median():.3g}"
        rows.append((words, *map(str, counts), *(("-", "-") if here.empty else ends)))
    head = ("suspension", "poses held", "refused", "bounds below the error")
    return Table((*head, "largest error / bound", "median bound / error"), tuple(rows))


def _by_distance(checks: pd.DataFrame) -> Table:
    """A row for each decade of the distance from the end."""
    forms = {
        **dict.fromkeys(("condition", "of_size"), ".1e"),
        **dict.fromkeys(("loss", "most"), ".2g"),
        **{"loose": ".3g", "share": ".2g"},
    }
    groups = checks.assign(of_size=checks["error"] / checks["size"], most=checks["loss"]).groupby(
        np.floor(np.log10(checks["distance"]))
    )
    found = groups.agg({name: "max" if name in ("most", "share") else "median" for name in forms})
    rows = (
        (f"1e{decade:.0f} to 1e{decade + 1:.0f}", str(count), *map(format, numbers, forms.values()))
        for (decade, *numbers), count in zip(found.itertuples(), groups.size(), strict=True)
    )
    head = ("distance / range", "poses", "condition", "error / size", "loss", "largest loss")
    return Table((*head, "bound / error", "largest error / bound"), tuple(rows))
