"""Rows of a study of cost that was never run: what must be found in them is known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from validate.cost.table import Row, frame, read_rows

POSES = 100
RATES = ("velocity", "acceleration", "angular_velocity", "angular_acceleration")
RADIUS = 1e-20
WHERE: dict[str, Any] = {
    "program": "pointcoord 0.1.0, code 0123456789ab",
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
    set_up: float = 1e-5,
) -> list[Row]:
    """Rows of the accuracy, one for each quantity; times are of one pose, s; rates come on top."""
    row = Row("accuracy", scene, way, setting, value, dense, poses=POSES, digest="0", **WHERE)
    rows = []
    for quantity, largest in errors.items():
        each = time + (0.0 if quantity == "position" else rates)
        error = {"error": largest, "rms": 0.5 * largest, "radius": RADIUS, "numbers": 900}
        quartiles = {"time": each, "lower": each * (1.0 - spread), "upper": each * (1.0 + spread)}
        more: dict[str, Any] = {
            **error,
            **quartiles,
            "repeats": 7,
            "set_up": set_up,
            "first": 3.0 * POSES * each,
        }
        rows.append(replace(row, quantity=quantity, **more))
    return rows


def alike(largest: float) -> dict[str, float]:
    """The same error of positions and of every rate."""
    return dict.fromkeys(("position", *RATES), largest)


def grown(
    scene: str,
    way: str,
    setting: str,
    against: str,
    sizes: Sequence[int],
    fixed: float,
    each: float,
    **more: Any,
) -> list[Row]:
    """Rows of a growth: a run takes fixed + each size^power, power 1 unless given."""
    power, bytes_each = more.get("power", 1.0), more.get("bytes_each", 0.0)
    return [
        Row(
            "growth",
            scene,
            way,
            setting,
            dense=way == "series",
            poses=size,
            quantity="position",
            error=1e-10,
            radius=RADIUS,
            time=(fixed + each * size**power) / size,
            set_up=more.get("set_up", 0.0),
            against=against,
            size=size,
            peak_bytes=int(1000 + bytes_each * size) if bytes_each else None,
            digest="0",
            **WHERE,
        )
        for size in sizes
    ]


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
    """A whole study: dials and single settings, a failure, an omission, exact zeros, growth."""
    rows = []
    for scene, car in (("bounce", 1.0), ("double-wishbone", 1.6)):
        rows += dialled(scene, "series", 4e-6 * car, 0.05, 2e-13, dense=True, rates=3e-6)
        rows += dialled(scene, "newton", 6e-5 * car, 0.01, 1e-13, rates=2e-5)
        rows += measured(scene, "absolute", "", {**alike(3e-13), "angular_velocity": 0.0}, 4e-4 * car, 9e-5)
        rows += measured(scene, "relative", "", alike(4e-13), 5.4e-5 * car, 3e-5, spread=0.1)
        rows += measured(scene, "mujoco", "", {"position": 3e-13}, 3.7e-5 * car)
        rows += measured(scene, "scipy-root", "", {"position": 2e-8}, 5e-4 * car)
        rows.append(
            Row("accuracy", scene, "exudyn", verdict="failed", reason="no convergence at 1.25 s", **WHERE)
        )
    rows += measured("bounce", "printed", "", alike(2.5), 7e-7, 1e-7)
    reason = "the paper's formulas are of a strut"
    rows.append(Row("accuracy", "double-wishbone", "printed", verdict="left out", reason=reason, **WHERE))
    decades = [10**k for k in range(2, 8)]
    rows += grown(
        "bounce", "series", "1e-09 mm", "instants", decades, 1e-3, 4e-7, set_up=1e-2, bytes_each=240.0
    )
    rows += grown("bounce", "newton", "1e-09 mm", "instants", decades[:4], 0.0, 6e-5, bytes_each=900.0)
    rows += grown("bounce", "series", "1e-09 mm", "designs", [1, 10, 100, 1000, 10000], 0.0, 2e-3)
    chains = [15, 50, 150, 500, 1500]
    rows += grown("chain", "series", "1e-09 mm", "unknowns", chains, 0.0, 2e-6, power=1.1, bytes_each=9e3)
    rows += grown("chain", "relative", "", "unknowns", chains[:4], 0.0, 1e-8, power=2.9, bytes_each=2e4)
    stopped = Row("growth", "chain", "relative", verdict="left out", reason="would take an hour", **WHERE)
    rows.append(replace(stopped, against="unknowns", size=1500))
    return [replace(row, digest="0") for row in rows]


def kept(path: Path, rows: Sequence[Row], **changed: Any) -> str:
    """Add rows to a file of rows, which another machine has measured."""
    before = read_rows(path) if path.exists() else []
    path.write_bytes(frame([*before, *(replace(row, **changed) for row in rows)]).to_parquet())
    return str(path)
