"""Files of curves as a test writes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pointcoord import Scene, simulate
from pointcoord.numerics.arrays import Array
from validate.measured.comparing import DataOutcome, compare_results
from validate.measured.mapping import Measured, understood
from validate.measured.poses import Driven
from validate.measured.reading import columns_of_text
from validate.measured.tolerances import held_of


def measured(text: str, scene: Scene, **content: object) -> Measured:
    """A file whose independent columns are exact as written."""
    first = text.splitlines()[0].split(",")
    exact = {
        name.partition(" ")[0]: {"printed": 0}
        for name in first
        if name.startswith(("input.", "travel.", "time"))
    }
    columns = dict(exact)
    own = content.pop("columns", {})
    assert isinstance(own, Mapping)
    for name, part in own.items():
        columns[name] = {**columns.get(name, {}), **part}
    return understood(columns_of_text(text, "x.csv"), {"columns": columns, **content}, scene, "map.toml")


def compared(text: str, content: Mapping[str, Any], scene: Scene, **more: Any) -> DataOutcome:
    """What comes of a file by a map as plain data."""
    columns = columns_of_text(text, "mine.csv")
    return compare_results(understood(columns, content, scene, "map.toml"), scene, "car", **more)


def disagreeing(text: str, content: Mapping[str, Any], scene: Scene) -> list[str]:
    """What a column that disagrees is, before anything is judged or explained."""
    data = understood(columns_of_text(text, "mine.csv"), content, scene, "map.toml")
    held, _ = held_of(Driven.of(scene, data).at(), None)
    return [h.series.meaning.words for h in held if np.nanmax(h.share) > 1.0]


def verdicts(found: DataOutcome) -> dict[str, str]:
    """By the name of each number."""
    return {row.name: row.verdict for row in found.outcome.rows}


def at_inputs(car: Scene, inputs: Mapping[str, Sequence[float]], samples: int) -> dict[str, dict[str, Array]]:
    """A car's numbers, by a motion through inputs that go evenly from one value to another."""
    content = car.model_dump(exclude_none=True) | {
        "inputs": {name: {"polynomial": [a, b - a] if b != a else [a]} for name, (a, b) in inputs.items()},
        "time": {"start": 0.0, "stop": 1.0, "samples": samples},
    }
    content.pop("points", None)
    motion = simulate(Scene.from_mapping(content, "inputs"))
    return {quantity: dict(part) for quantity, part in motion.numbers.items()}


def table(columns: Mapping[str, Array], digits: int) -> str:
    """Columns by their headings; independent ones with twelve digits."""
    lines = [",".join(columns)]
    for row in zip(*columns.values(), strict=True):
        cells = (
            f"{value:.12g}" if name.startswith(("input.", "travel.", "time")) else f"{value:.{digits}f}"
            for name, value in zip(columns, row, strict=True)
        )
        lines.append(",".join(cells))
    return "\n".join(lines)


def wheel_curves(
    car: Scene,
    angles: tuple[float, float],
    racks: tuple[float, float] = (0.0, 0.0),
    rows: int = 9,
    digits: int = 4,
    **more: Array | float,
) -> str:
    """Camber and toe, deg, over the arm's angle and the rack; `more` is added to them."""
    wheel = at_inputs(car, {"arm_angle": angles, "rack": racks}, rows)["wheel"]
    over = {"input.arm_angle [rad]": np.linspace(*angles, rows), "input.rack [mm]": np.linspace(*racks, rows)}
    told = {f"wheel.{one} [deg]": np.degrees(wheel[one]) + more.get(one, 0.0) for one in ("camber", "toe")}
    return table(over | told, digits)
