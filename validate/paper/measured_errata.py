"""The paper's errata, numbered, each with what it measures: computed here, from the printed numbers.

What spoils a quantity of a scene, the factor of eq. (23) and the quotient for omega, is also measured scene
by scene, where the formulas as printed are solved (see `errata` and `comparison.findings`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import close_drawing
from validate.paper.tables import TABLE_2, TABLE_3, PaperRow

Array = NDArray[np.float64]


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
    return (
        Erratum(
            1,
            "Table 1",
            "its points are not assembled: the strut's parts are not in line, as eqs. (8) and (9) have them; "
            "it gives link lengths and a first guess",
            _table_1(),
        ),
        Erratum(
            2,
            "the rack's law",
            "S(t) = 0.15 t + 0.0025 t^2 is printed; Table 3's own column is 0.15 t + 0.025 t^2, and we take "
            "that",
            _law(),
        ),
        Erratum(3, "Table 2", 'the row "2.2 s" is of 2.4 s', _row_of_table_2()),
        Erratum(
            4, "Table 3", "its last row prints the height -60 where the sequence needs +60", _sign(table_3)
        ),
        Erratum(
            5,
            "eq. (23)",
            "rows 8 to 11 lack the factor 2 of a product's second derivative, and row 11 repeats the points "
            "7, 5",
            "see the wrong accelerations below",
        ),
        Erratum(6, "eq. (21)", "the columns of theta and of S are both the 14th; they are two columns", ""),
        Erratum(
            7,
            "omega and alpha",
            "the quotient v65 x v75 / (v65 . r75) is 0/0 where omega lies in the plane of points 5, 6, 7, as "
            "in all of Table 3, whose columns of rates are rounding noise",
            _noise(table_3),
        ),
        Erratum(
            8,
            "eqs. (8) to (11)",
            "only the x and y components of two cross products: they lose rank where the strut lies level",
            _rank(),
        ),
        Erratum(9, "section 2.2", "it refers to eqs. (5) and (8) where (19) and (22) are meant", ""),
    )


def _points() -> dict[str, Array]:
    return {name: np.array(place) for name, place in Scene.load("bounce").mechanism.points.items()}


def _table_1() -> str:
    points = _points()
    low = points["strut_lower"] - points["lower_ball_joint"]
    high = points["strut_top"] - points["strut_rod_end"]
    cosine = low @ high / (np.linalg.norm(low) * np.linalg.norm(high))
    mechanism = scene_mechanism(Scene.load("bounce"))
    places = mechanism.places(close_drawing(mechanism).y)
    moved = {
        name: float(np.linalg.norm(mechanism.origin + float(mechanism.unit) * places[name] - place))
        for name, place in points.items()
        if name in places
    }
    name = max(moved, key=lambda one: moved[one])
    return (
        f"5-7 and 8-4 are {math.degrees(math.acos(cosine)):.2f} degrees apart; closing them moves {name} by "
        f"{moved[name]:.1f} mm"
    )


def _law() -> str:
    times, printed = np.array([(row.time, row.input) for row in TABLE_3]).T
    apart = {
        factor: np.abs(150.0 * times + 1000.0 * factor * times**2 - printed).max()
        for factor in (0.0025, 0.025)
    }
    wrong, right = apart.values()
    return f"up to {wrong:.2f} mm from the column; the law with 0.025 up to {right:.3f} mm"


def _row_of_table_2() -> str:
    (row,) = (row for row in TABLE_2 if row.slip)
    scene = Scene.load("bounce")
    law = scene.functions["arm_angle"].series(np.array([2.2, row.time]), 0)[:, 0]
    apart = np.abs(np.degrees(law) - row.input)
    return f"its angle is {apart[0]:.1f} degrees from the law's at 2.2 s, and {apart[1]:.2f} at {row.time} s"


def _sign(rows: list[PaperRow]) -> str:
    last = rows[-1]
    height, ours = last.printed.wheel_centre[2], last.wheel_centre[2]
    wrong, mended = abs(-height - ours), abs(height - ours)
    return f"as printed {wrong:.1f} mm from the height computed, mended {mended:.1f} mm"


def _noise(rows: list[PaperRow]) -> str:
    printed, ours = (np.linalg.norm([of(row) for row in rows], axis=1) for of in (_printed_omega, _our_omega))
    return (
        f"printed |omega| between {printed.min():.2f} and {printed.max():.2f} rad/s; computed from "
        f"{ours.min():.2f} to {ours.max():.2f} rad/s"
    )


def _printed_omega(row: PaperRow) -> tuple[float, float, float]:
    return row.printed.omega


def _our_omega(row: PaperRow) -> tuple[float, float, float]:
    return row.omega


def _rank() -> str:
    """Rank of the gradient of the printed rows, and of all three components, by point 7 of a level strut."""
    level = np.array([300.0, 400.0, 0.0])
    # The gradient of (p7 - p5) x (p4 - p8) by p7, where p4 - p8 is the level direction.
    x, y, z = level
    gradient = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    printed, whole = np.linalg.matrix_rank(gradient[:2]), np.linalg.matrix_rank(gradient)
    return f"of a level strut the two printed rows have rank {printed}, all three components rank {whole}"
