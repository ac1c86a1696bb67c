"""Hardpoints fitted to curves: the corrections, how well each is known, and what is left."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from program import document, pointcoord
from record import Fact, Facts, Record

GIVEN = Path(__file__).parent / "given"
RESULTS, SCENES = GIVEN / "results", GIVEN / "scenes"

# The car, the file, its map, and options.
CASES: dict[str, tuple[str, str, str, tuple[str, ...]]] = {
    "the paper's tables": ("bounce", "tables-2-and-3.csv", "", ()),
    "a misread hardpoint": (
        "misread-wishbone",
        "lotus-bump.csv",
        "lotus-bump.toml",
        ("--free", "upper_ball_joint.z", "tie_rod_outer.z"),
    ),
    "what steering cannot see": (
        "double-wishbone",
        "lotus-steering.csv",
        "lotus-steering.toml",
        ("--free", "tie_rod_outer", "tie_rod_inner.z"),
    ),
    "an unknown point": ("bounce", "tables-2-and-3.csv", "", ("--free", "gearbox.z")),
    "no such file": ("bounce", "nowhere.csv", "", ()),
}

# Least squares end where a step lessens the sum of squares by less than this part; no more is left then.
ENDS = 1e-9
# Figures that no iteration ends in hold to the scene's tolerance, 1e-9 mm of some mm.
SOLVED = 1e-9


def record(folder: Path) -> Record:
    """By fit: exit status, corrections, deviations, residual figures, what is unique and what is seen."""
    facts: Facts = {}
    for number, (case, (scene, data, columns, options)) in enumerate(CASES.items()):
        target = folder / f"{number}.json"
        of_map = ("--map", RESULTS / columns) if columns else ()
        more = (*of_map, *options, "-q", "--json", target)
        status = pointcoord("fit", SCENES / f"{scene}.toml", "--data", RESULTS / data, *more)
        facts[case] = {"exit status": status, **_of_fit(document(target))}
    return Record(facts)


def _of_fit(fit: dict[str, Any]) -> dict[str, Fact]:
    """What a fit came to.

    A step that changes the sum of squares S by d moves a coordinate by at most its standard deviation times
    the root of d, in units of S / freedom: with d = ENDS S that is deviation sqrt(ENDS freedom). The same
    moves a column's r.m.s. by at most what its numbers are known to, times that root. Deviations and what is
    left over change by less.
    """
    if "coordinates" not in fit:
        return {}
    ends = math.sqrt(ENDS * max(fit["freedom"], 1))
    found: dict[str, Fact] = {
        "converged": fit["converged"],
        "unique": fit["unique"],
        "freedom": fit["freedom"],
        "combinations seen": sum(one["seen"] for one in fit["combinations"]),
        "combinations": len(fit["combinations"]),
        "left over digits": [fit["left_over_digits"], ends * fit["left_over_digits"]],
    }
    for one in fit["coordinates"]:
        name, deviation = one["coordinate"], one["deviation"]
        off = SOLVED if deviation is None else deviation * ends
        found[f"correction of {name}"] = [one["correction"], off]
        found[f"{name} on its bound"] = one["on_bound"]
        if deviation is not None:
            found[f"deviation of {name}"] = [deviation, deviation * ends]
    for column in fit["columns"]:
        name = column["column"]
        found[f"{name}: numbers"] = column["count"]
        found[f"{name}: before"] = [column["before"], SOLVED]
        found[f"{name}: after"] = [column["after"], column["known_to"] * fit["left_over_digits"] * ends]
    return found
