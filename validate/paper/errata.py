"""The paper's errata (see `errata.toml`): which quantities they spoil, and what they come to in numbers.

What spoils a quantity of a scene, the factor of eq. (23) and the quotient for omega, is also measured scene
by scene, where the formulas as printed are solved (see `comparison.findings`).
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pointcoord import Scene
from validate.closed_drawing import closed_drawing
from validate.paper.tables import TABLE_2, TABLE_3, PaperRow

Table3 = list[PaperRow]

_KNOWN = tomllib.loads(Path(__file__).with_name("errata.toml").read_text(encoding="utf-8"))["errata"]
CAUSES: Mapping[str, str] = {one["spoils"]: one["cause"] for one in _KNOWN if "spoils" in one}


def erratum_of(quantity: str, wrong: Collection[str]) -> str:
    """The erratum behind a wrong quantity; the knuckle's alpha inherits from what it is made of.

    Args:
        wrong: all the quantities that are wrong in a scene.
    """
    if quantity == "angular_acceleration":
        parts = [CAUSES[q] for q in ("acceleration", "angular_velocity") if q in wrong]
        return "; ".join(parts) or CAUSES["angular_velocity"].replace("omega", "alpha")
    return CAUSES.get(quantity, "no known erratum: look into it")


@dataclass(frozen=True)
class Erratum:
    """One erratum.

    Attributes:
        number: as the project counts them. where: in the paper. wrong: what is wrong there.
        measures: what it comes to, in numbers; empty of a slip that changes no number.
    """

    number: int
    where: str
    wrong: str
    measures: str


def errata(rows: Iterable[PaperRow]) -> tuple[Erratum, ...]:
    """All of them.

    Args:
        rows: Tables 2 and 3 beside what the paper's own equations give.
    """
    table_3 = [row for row in rows if row.printed.table == 3]
    return tuple(
        Erratum(
            number,
            one["where"],
            one["wrong"],
            MEASURED[one["measured"]](table_3) if "measured" in one else "",
        )
        for number, one in enumerate(_KNOWN, start=1)
    )


def _table_1(_: Table3) -> str:
    points = {name: np.array(place) for name, place in Scene.load("bounce").mechanism.points.items()}
    low = points["strut_lower"] - points["lower_ball_joint"]
    high = points["strut_top"] - points["strut_rod_end"]
    cosine = low @ high / (np.linalg.norm(low) * np.linalg.norm(high))
    moved = closed_drawing(Scene.load("bounce")).closing
    assert moved is not None  # the paper's car closes
    return (
        f"5-7 and 8-4 are {math.degrees(math.acos(cosine)):.2f} degrees apart; closing them moves "
        f"{moved.point} by {moved.largest:.1f} mm"
    )


def _law(_: Table3) -> str:
    times, printed = np.array([(row.time, row.input) for row in TABLE_3]).T
    wrong, right = (
        np.abs(150.0 * times + 1000.0 * factor * times**2 - printed).max() for factor in (0.0025, 0.025)
    )
    return f"up to {wrong:.2f} mm from the column; the law with 0.025 up to {right:.3f} mm"


def _row_of_table_2(_: Table3) -> str:
    (row,) = (row for row in TABLE_2 if row.slip)
    scene = Scene.load("bounce")
    law = scene.functions["arm_angle"].series(np.array([2.2, row.time]), 0)[:, 0]
    apart = np.abs(np.degrees(law) - row.input)
    return f"its angle is {apart[0]:.1f} degrees from the law's at 2.2 s, and {apart[1]:.2f} at {row.time} s"


def _sign(rows: Table3) -> str:
    last = rows[-1]
    height, ours = last.printed.wheel_centre[2], last.wheel_centre[2]
    wrong, mended = abs(-height - ours), abs(height - ours)
    return f"as printed {wrong:.1f} mm from the height computed, mended {mended:.1f} mm"


def _noise(rows: Table3) -> str:
    printed, ours = np.linalg.norm([(row.printed.omega, row.omega) for row in rows], axis=2).T
    return (
        f"printed |omega| between {printed.min():.2f} and {printed.max():.2f} rad/s; computed from "
        f"{ours.min():.2f} to {ours.max():.2f} rad/s"
    )


def _rank(_: Table3) -> str:
    """Rank of the gradient of the printed rows, and of all three components, by point 7 of a level strut."""
    level = np.array([300.0, 400.0, 0.0])
    # The gradient of (p7 - p5) x (p4 - p8) by p7, where p4 - p8 is the level direction.
    x, y, z = level
    gradient = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    printed, whole = np.linalg.matrix_rank(gradient[:2]), np.linalg.matrix_rank(gradient)
    return f"of a level strut the two printed rows have rank {printed}, all three components rank {whole}"


MEASURED: Mapping[str, Callable[[Table3], str]] = {
    "table_1": _table_1,
    "law": _law,
    "row_of_table_2": _row_of_table_2,
    "sign": _sign,
    "accelerations": lambda _: "see the wrong accelerations below",
    "noise": _noise,
    "rank": _rank,
}
