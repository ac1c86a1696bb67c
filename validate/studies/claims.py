"""Whether what a formulation claims of its accuracy holds, number by number, and how loose it is.

Random scenes by number (see `random_scenes`), a tenth of them close to a singular pose, each number of every
instant held against the reference:

    pointcoord study claims --formulation absolute --count 80
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from pointcoord import SceneError
from pointcoord.effects.registry import QUANTITIES
from validate.adjudication.reference_solution import DUST, as_solution, off_by, reference_motion, scales
from validate.cars.base_cars import variants
from validate.cars.random_scenes import SEED, RandomScene, random_scene
from validate.exit_status import ExitStatus
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import formulation
from validate.output.table import Table
from validate.reference import Instant, NoReferenceError
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
    return [{"suspension": car.variant.words, "kind": car.kind, **row} for row in _held(car, name) or [{}]]


def _held(car: RandomScene, formulation_name: str) -> list[Row]:
    scene = car.scene
    try:
        solution = formulation(formulation_name).solve(scene)
        instants = reference_motion(scene, scene.instants.tolist())
    except (FormulationError, SceneError, NoReferenceError):
        return []
    reference = as_solution(scene, instants)
    rows: list[Row] = []
    for quantity in asked_numbers(scene):
        # The reference's own error is that of numbers as large as the largest ones that a number is made of.
        dust = DUST * scales(reference.numbers)[quantity]
        for name in (n for n in solution.numbers[quantity] if n in reference.numbers[quantity]):
            numbers = solution.numbers[quantity][name].reshape(len(instants), -1)
            claimed = solution.accuracy.claims[quantity][name].reshape(len(instants), -1)
            for row, claim, instant in zip(numbers, claimed, instants, strict=True):
                errors = (off_by(a, b) for a, b in zip(row, _exact(instant, quantity, name), strict=True))
                rows += [
                    {"quantity": quantity, "error": e if e > dust else 0.0, "claim": float(c)}
                    for e, c in zip(errors, claim, strict=True)
                ]
    return rows


def _exact(instant: Instant, quantity: str, name: str) -> Sequence[Any]:
    of_the_car = QUANTITIES[quantity].of == "car"
    return [instant.effects[name]] if of_the_car else list(getattr(instant, quantity)[name])


def found(rows: Sequence[Row], settings: Mapping[str, str | int]) -> Findings:
    """By suspension and quantity: numbers, the largest error / claim, claim / error at levels."""
    held = [row for row in rows if row.get("quantity") is not None]
    data = [
        {"suspension": variant.words, "quantity": quantity, **_looseness(part)}
        for variant, quantity in itertools.product(variants(), QUANTITIES)
        if (part := [r for r in held if (r["suspension"], r["quantity"]) == (variant.words, quantity)])
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
    scenes = len({row["number"] for row in held})
    table = Table((*head, *(f"bound / error at {100 * level:g}%" for level in LEVELS)), tuple(lines))
    return Findings(
        (f"{scenes} scenes compared with the reference", table),
        {**settings, "scenes": scenes, "quantities": data},
        ExitStatus.AGREE if all(row["error"] <= row["claim"] for row in held) else ExitStatus.DISAGREE,
    )


def _looseness(rows: Sequence[Row]) -> dict[str, Any]:
    """What errors of one quantity come to, in parts of their claims; the scene is that of the largest."""
    off = [row for row in rows if row["error"] != 0.0]
    error, claim = np.array([(row["error"], row["claim"]) for row in off]).reshape(-1, 2).T
    with np.errstate(divide="ignore"):
        share, loose = error / claim, claim / error
    worst = off[int(share.argmax())] if off else rows[0]
    return {
        "numbers": len(rows),
        "exact": len(rows) - len(off),
        "largest_error_over_claim": float(share.max(initial=0.0)),
        "scene": worst["number"],
        "kind": worst["kind"],
        "claim_over_error": {f"{level:g}": float(np.quantile(loose, level)) for level in LEVELS}
        if off
        else {},
    }
