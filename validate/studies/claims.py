"""Tests whether the error bounds of a formulation hold, number by number, and how loose they are.

The scenes are random scenes by number (see `random_scenes`), a tenth of them close to a singular pose. Each
number at every instant is compared with the reference:

    pointcoord study claims --formulation absolute --count 80
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import pandas as pd

from pointcoord import SceneError
from pointcoord.effects.registry import QUANTITIES
from validate.cars.random_scenes import SEED, random_scene
from validate.exit_status import ExitStatus
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import (
    as_solution,
    exact_numbers,
    off_by,
    proven_error,
    reference_motion,
    told_by,
)
from validate.formulations.registry import formulation
from validate.output.table import Table
from validate.reference import NoReferenceError
from validate.studies.study import Findings, Row, Study, Task

COLUMNS: Mapping[str, str] = {
    **dict.fromkeys(("suspension", "kind", "quantity"), "string"),
    **dict.fromkeys(("error", "claim"), "float64"),
}


def claims(count: int = 300, first: int = 0, formulation: str = "pointcoord", seed: int = SEED) -> Study:
    """The study of random scenes from number `first` up. A row is a number, with its error and error bound
    (claim).

    A scene without an answer, or without a reference, has one row without a quantity.
    """
    settings: dict[str, str | int] = {"seed": seed, "formulation": formulation}
    tasks = [Task("scenes", number) for number in range(first, first + count)]
    examine, summary = partial(scene_rows, name=formulation), partial(found, settings=settings)
    return Study("claims", "scene", settings, COLUMNS, tasks, examine, summary)


def scene_rows(task: Task, name: str) -> list[Row]:
    """The rows of a scene: every component of every number at every instant."""
    car = random_scene(task.number)
    scene, of_all = car.scene, {"suspension": car.variant.words, "kind": car.kind}
    try:
        solution = formulation(name).solve(scene)
        instants = reference_motion(scene, scene.instants.tolist())
    except (FormulationError, SceneError, NoReferenceError):
        return [of_all]
    reference = as_solution(scene, instants)
    rows: list[Row] = []
    for quantity, names in told_by(reference, scene).items():
        proven = proven_error(instants, quantity)
        for one in (n for n in solution.numbers[quantity] if n in names):
            numbers = solution.numbers[quantity][one].reshape(len(instants), -1)
            claimed = solution.accuracy.claims[quantity][one].reshape(len(instants), -1)
            for ours, claim, instant in zip(numbers, claimed, instants, strict=True):
                exact = np.ravel(np.array(exact_numbers(instant, quantity)[one], dtype=object))
                errors = [off_by(a, b) for a, b in zip(ours, exact, strict=True)]
                rows += [
                    {**of_all, "quantity": quantity, "error": e if e > proven else 0.0, "claim": float(c)}
                    for e, c in zip(errors, claim, strict=True)
                ]
    return rows or [of_all]


def found(rows: Sequence[Row], settings: Mapping[str, str | int]) -> Findings:
    """By suspension and quantity: count of numbers, largest error / claim, and median claim / error."""
    held = pd.DataFrame(rows, columns=["number", *COLUMNS]).dropna(subset="quantity")
    held["share"] = (held["error"] / held["claim"]).where(held["error"] != 0.0, 0.0)
    held["loose"] = (1.0 / held["share"]).where(held["share"] > 0.0)
    groups = held.groupby(["suspension", "quantity"], sort=False)
    table = groups.agg(
        numbers=("share", "size"),
        largest_error_over_claim=("share", "max"),
        claim_over_error=("loose", "median"),
    )
    worst = held.loc[groups["share"].idxmax()]
    table["scene"], table["kind"] = worst["number"].to_list(), worst["kind"].to_list()
    lines = (
        (
            *(suspension, QUANTITIES[quantity].words, str(one.numbers)),
            *(f"{one.largest_error_over_claim:.7g}", f"{one.scene} ({one.kind})"),
            "-" if pd.isna(one.claim_over_error) else f"{one.claim_over_error:.3g}",
        )
        for (suspension, quantity), one in zip(table.index, table.itertuples(), strict=True)
    )
    head = ("suspension", "quantity", "numbers", "largest error / bound", "scene", "median bound / error")
    scenes = held["number"].nunique()
    return Findings(
        (f"{scenes} scenes compared with the reference", Table(head, tuple(lines))),
        {**settings, "scenes": scenes, "quantities": table.reset_index().to_dict("records")},
        ExitStatus.AGREE if (held["error"] <= held["claim"]).all() else ExitStatus.DISAGREE,
    )
