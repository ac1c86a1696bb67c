"""Whether what a formulation claims of its accuracy holds, number by number, and how loose it is.

Random scenes by number (see `random_scenes`), a tenth of them close to a singular pose, each number of every
instant held against the reference:

    pointcoord study claims --formulation absolute --count 80
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import pandas as pd

from pointcoord import SceneError
from pointcoord.effects.registry import QUANTITIES
from validate.cars.random_scenes import SEED, random_scene
from validate.exit_status import ExitStatus
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import DUST, as_solution, off_by, reference_motion, scales
from validate.formulations.registry import formulation
from validate.output.table import Table
from validate.reference import NoReferenceError
from validate.studies.study import Findings, Row, Study, Task

LEVELS = (0.5, 0.9, 0.99)
COLUMNS: Mapping[str, str] = {
    **dict.fromkeys(("suspension", "kind", "quantity"), "string"),
    **dict.fromkeys(("error", "claim"), "float64"),
}


def claims(count: int = 300, first: int = 0, formulation: str = "pointcoord", seed: int = SEED) -> Study:
    """Random scenes of the numbers from `first` up. A row is a number, with its error and what is claimed.

    A scene without an answer, or without a reference, has one row without a quantity.
    """
    settings: dict[str, str | int] = {"seed": seed, "formulation": formulation}
    tasks = [Task("scenes", number) for number in range(first, first + count)]
    examine, summary = partial(scene_rows, name=formulation), partial(found, settings=settings)
    return Study("claims", "scene", settings, COLUMNS, tasks, examine, summary, chunk=2)


def scene_rows(task: Task, name: str) -> list[Row]:
    """Every number of the scene of a number."""
    car = random_scene(task.number)
    scene, of_all = car.scene, {"suspension": car.variant.words, "kind": car.kind}
    try:
        solution = formulation(name).solve(scene)
        instants = reference_motion(scene, scene.instants.tolist())
    except (FormulationError, SceneError, NoReferenceError):
        return [of_all]
    reference = as_solution(scene, instants)
    rows: list[Row] = []
    for quantity in asked_numbers(scene):
        # The reference's own error is that of numbers as large as the largest ones that a number is made of.
        dust, of_car = DUST * scales(reference.numbers)[quantity], QUANTITIES[quantity].of == "car"
        for one in (n for n in solution.numbers[quantity] if n in reference.numbers[quantity]):
            numbers = solution.numbers[quantity][one].reshape(len(instants), -1)
            claimed = solution.accuracy.claims[quantity][one].reshape(len(instants), -1)
            for ours, claim, instant in zip(numbers, claimed, instants, strict=True):
                exact = [instant.effects[one]] if of_car else list(getattr(instant, quantity)[one])
                errors = [off_by(a, b) for a, b in zip(ours, exact, strict=True)]
                rows += [
                    {**of_all, "quantity": quantity, "error": e if e > dust else 0.0, "claim": float(c)}
                    for e, c in zip(errors, claim, strict=True)
                ]
    return rows or [of_all]


def found(rows: Sequence[Row], settings: Mapping[str, str | int]) -> Findings:
    """By suspension and quantity: numbers, the largest error / claim, claim / error at levels."""
    held = pd.DataFrame(rows, columns=["number", *COLUMNS]).dropna(subset="quantity")
    data: list[dict[str, Any]] = [
        {"suspension": suspension, "quantity": quantity, **_looseness(part)}
        for (suspension, quantity), part in held.groupby(["suspension", "quantity"], sort=False)
    ]
    lines = [
        (
            one["suspension"],
            QUANTITIES[one["quantity"]].words,
            *(str(one[name]) for name in ("numbers", "exact")),
            f"{one['largest_error_over_claim']:.7g}",
            f"{one['scene']} ({one['kind']})",
            *(f"{value:.3g}" for value in one["claim_over_error"].values()),
            *"-" * (len(LEVELS) - len(one["claim_over_error"])),
        )
        for one in data
    ]
    head = ("suspension", "quantity", "numbers", "exact", "largest error / bound", "scene")
    scenes = held["number"].nunique()
    table = Table((*head, *(f"bound / error at {100 * level:g}%" for level in LEVELS)), tuple(lines))
    return Findings(
        (f"{scenes} scenes compared with the reference", table),
        {**settings, "scenes": scenes, "quantities": data},
        ExitStatus.AGREE if (held["error"] <= held["claim"]).all() else ExitStatus.DISAGREE,
    )


def _looseness(rows: pd.DataFrame) -> dict[str, Any]:
    """What errors of one quantity come to, in parts of their claims; the scene is that of the largest."""
    off = rows[rows["error"] != 0.0]
    share = off["error"] / off["claim"]
    levels = LEVELS if len(off) else ()
    worst = rows.iloc[0] if off.empty else off.loc[share.idxmax()]
    return {
        "numbers": len(rows),
        "exact": len(rows) - len(off),
        "largest_error_over_claim": 0.0 if off.empty else float(share.max()),
        "scene": int(worst["number"]),
        "kind": worst["kind"],
        "claim_over_error": {f"{level:g}": float((1.0 / share).quantile(level)) for level in levels},
    }
