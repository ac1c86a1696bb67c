"""Rows of a study of cost that was never run: what must be found in them is known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from validate.cost.row import QuantityError, Row, Time
from validate.cost.store import Header, Key, Store

CONFIGURATIONS = 100
RATES = ("velocity", "acceleration", "angular_velocity", "angular_acceleration")
RADIUS = 1e-20


def time(median: float, spread: float = 0.02) -> Time:
    """A time whose quartiles lie so far below and above its median, of it."""
    return Time(median, median * (1.0 - spread), median * (1.0 + spread), 7)


def error(largest: float, radius: float = RADIUS, numbers: int = 900) -> QuantityError:
    """An error whose r.m.s. is half of its largest."""
    return QuantityError(largest, 0.5 * largest, radius, numbers)


def measured(
    scene: str,
    way: str,
    setting: str,
    errors: Mapping[str, float],
    solve: float,
    rates: float = 1e-6,
    output: float = 1e-7,
    *,
    value: float | None = None,
    spread: float = 0.02,
    dense: bool = False,
    set_up: float = 1e-5,
    counts: Mapping[str, int] | None = None,
) -> Row:
    """A row of the accuracy; times are of one configuration, s."""
    phases = {"set-up": set_up, "solve": solve, "rates": rates, "output": output}
    phases["first"] = 3.0 * sum(phases.values())
    return Row(
        "accuracy",
        scene,
        way,
        setting,
        value,
        configurations=CONFIGURATIONS,
        dense=dense,
        errors={quantity: error(largest) for quantity, largest in errors.items()},
        times={name: time(CONFIGURATIONS * each, spread) for name, each in phases.items()},
        counts=counts or {},
    )


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
    power: float = 1.0,
    *,
    set_up: float = 0.0,
    dense: bool = False,
    bytes_each: float = 0.0,
    largest: float | None = None,
) -> list[Row]:
    """Rows of a growth: solve takes fixed + each size^power, and the other phases nothing to speak of."""
    return [
        Row(
            "growth",
            scene,
            way,
            setting,
            configurations=size,
            dense=dense,
            errors={} if largest is None else {"position": error(largest), "acceleration": error(largest)},
            times={
                "set-up": time(set_up),
                "solve": time(fixed + each * size**power),
                "rates": time(0.0),
                "output": time(0.0),
            },
            against=against,
            size=size,
            peak_bytes=int(1000 + bytes_each * size) if bytes_each else None,
        )
        for size in sizes
    ]


TOLERANCES = tuple(10.0**-k for k in range(2, 14))


def dialled(scene: str, way: str, fastest: float, slope: float, floor: float, **more: Any) -> list[Row]:
    """A way that is as exact as its setting until its floor, and whose time goes with setting^-slope."""
    return [
        measured(
            scene,
            way,
            f"{value:.0e} mm",
            alike(max(0.3 * value, floor)),
            fastest * (value / TOLERANCES[0]) ** -slope,
            value=value,
            **more,
        )
        for value in TOLERANCES
    ]


def study() -> list[Row]:
    """A whole study: dials and single settings, a failure, an omission, exact zeros, growth, loading."""
    rows = []
    for scene, car in (("bounce", 1.0), ("double-wishbone", 1.6)):
        rows += dialled(scene, "series", 4e-6 * car, 0.05, 2e-13, dense=True, rates=3e-6)
        rows += dialled(scene, "newton", 6e-5 * car, 0.01, 1e-13, rates=2e-5)
        rows += dialled(scene, "chord", 4e-5 * car, 0.04, 3e-13, rates=2e-5)
        rows.append(measured(scene, "newton-cold", "", alike(1e-13), 3e-4 * car, 2e-5))
        rows.append(
            measured(scene, "absolute", "", {**alike(3e-13), "angular_velocity": 0.0}, 4e-4 * car, 9e-5)
        )
        rows.append(measured(scene, "relative", "", alike(4e-13), 5.4e-5 * car, 3e-5, spread=0.1))
        rows.append(measured(scene, "mujoco", "", {"position": 3e-13}, 3.7e-5 * car, 1e-8))
        rows.append(measured(scene, "scipy-root", "", {"position": 2e-8}, 5e-4 * car, 1e-8))
        rows.append(Row("accuracy", scene, "exudyn", status="failed", reason="no convergence at 1.25 s"))
    rows.append(measured("bounce", "printed", "", alike(2.5), 7e-7, 1e-7))
    reason = "the paper's formulas are of a strut"
    rows.append(Row("accuracy", "double-wishbone", "printed", status="left out", reason=reason))
    decades = [10**k for k in range(2, 8)]
    more: dict[str, Any] = {"dense": True, "set_up": 1e-2, "bytes_each": 240.0}
    rows += grown("bounce", "series", "1e-09 mm", "instants", decades, 1e-3, 4e-7, **more)
    rows += grown("bounce", "newton", "1e-09 mm", "instants", decades[:4], 0.0, 6e-5, bytes_each=900.0)
    rows += grown("bounce", "mujoco", "", "instants", decades[:4], 0.0, 3.7e-5, bytes_each=300.0)
    rows += grown("bounce", "series", "1e-09 mm", "designs", [1, 10, 100, 1000, 10000], 0.0, 2e-3)
    chains = [15, 50, 150, 500, 1500]
    rows += grown("chain", "series", "1e-09 mm", "unknowns", chains, 0.0, 2e-6, 1.1, bytes_each=9e3)
    rows += grown("chain", "relative", "", "unknowns", chains[:4], 0.0, 1e-8, 2.9, bytes_each=2e4)
    stopped = Row("growth", "chain", "relative", status="left out", reason="would take an hour")
    rows.append(replace(stopped, against="unknowns", size=1500))
    rows.append(Row("loading", "bounce", "scene", times={"load": time(2e-3)}))
    rows.append(Row("loading", "", "import pointcoord", times={"import": time(0.15)}))
    return rows


HEADER = Header(
    program="pointcoord 0.1.0, code 0123456789ab",
    machine="a made machine, 2 cores",
    python="CPython 3.12.0",
    packages={"numpy": "2.0.0"},
    threads={"OMP_NUM_THREADS": "1"},
    command="pointcoord cost",
)


def key(row: Row, digest: str = "0", quick: bool = False) -> Key:
    """Under which a row is kept."""
    return Key(row.part, row.scene, digest, row.way, row.setting, row.against, row.size, quick)


def kept(path: Path, rows: Sequence[Row], digest: str = "0", quick: bool = False) -> str:
    """Add rows to a file of rows, which another machine has measured."""
    store = Store(path, HEADER)
    for row in rows:
        store.write(key(row, digest, quick), row)
    return str(path)
