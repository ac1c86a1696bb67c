"""Rows of a study of cost that was never run: what must be found in them is known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from validate.cost.table import Row, frame

POSES = 100
RATES = ("velocity", "acceleration", "angular_velocity", "angular_acceleration")
RADIUS = 1e-20
WHERE: dict[str, Any] = {
    "program": "pointcoord 0.1.0",
    "machine": "a made machine, 2 cores",
    "python": "CPython 3.12.0",
    "packages": "numpy 2.0.0",
    "command": "pointcoord cost",
}


def measured(
    scene: str,
    way: str,
    setting: str,
    errors: Mapping[str, float],
    time: float,
    rates: float = 1e-6,
    *,
    value: float | None = None,
    spread: float = 0.02,
    dense: bool = False,
) -> list[Row]:
    """Rows of a way, one for each quantity; times are of one pose, s; rates come on top."""
    row = Row(scene, way, setting, value, dense, poses=POSES, set_up=1e-5, repeats=7, **WHERE)
    rows = []
    for quantity, largest in errors.items():
        each = time + (0.0 if quantity == "position" else rates)
        error = {"error": largest, "radius": RADIUS}
        quartiles = {"time": each, "lower": each * (1.0 - spread), "upper": each * (1.0 + spread)}
        rows.append(replace(row, quantity=quantity, **error, **quartiles))
    return rows


def alike(largest: float) -> dict[str, float]:
    """The same error of positions and of every rate."""
    return dict.fromkeys(("position", *RATES), largest)


TOLERANCES = tuple(10.0**-k for k in range(2, 14))


def dialled(scene: str, way: str, fastest: float, slope: float, floor: float, **more: Any) -> list[Row]:
    """A way that is as exact as its setting until its floor, and whose time goes with setting^-slope."""
    return [
        row
        for value in TOLERANCES
        for row in measured(
            scene,
            way,
            f"{value:.0e} mm",
            alike(max(0.3 * value, floor)),
            fastest * (value / TOLERANCES[0]) ** -slope,
            value=value,
            **more,
        )
    ]


def study() -> list[Row]:
    """A whole study: dials and single settings, a failure, an omission, exact zeros."""
    rows = []
    for scene, car in (("bounce", 1.0), ("double-wishbone", 1.6)):
        rows += dialled(scene, "series", 4e-6 * car, 0.05, 2e-13, dense=True, rates=3e-6)
        rows += dialled(scene, "newton", 6e-5 * car, 0.01, 1e-13, rates=2e-5)
        rows += measured(scene, "absolute", "", {**alike(3e-13), "angular_velocity": 0.0}, 4e-4 * car, 9e-5)
        rows += measured(scene, "relative", "", alike(4e-13), 5.4e-5 * car, 3e-5, spread=0.1)
        rows += measured(scene, "mujoco", "", {"position": 3e-13}, 3.7e-5 * car)
        rows += measured(scene, "scipy-root", "", {"position": 2e-8}, 5e-4 * car)
        rows.append(Row(scene, "exudyn", verdict="failed", reason="no convergence at 1.25 s", **WHERE))
    rows += measured("bounce", "printed", "", alike(2.5), 7e-7, 1e-7)
    reason = "the paper's formulas are of a strut"
    return [*rows, Row("double-wishbone", "printed", verdict="left out", reason=reason, **WHERE)]


def kept(path: Path, rows: Sequence[Row]) -> str:
    """A file of rows, which another machine has measured."""
    path.write_bytes(frame(rows).to_parquet())
    return str(path)
