r"""Whether the two points that draw a line are far enough apart to tell where others stand on it.

A slide's place along its line is p = p_start + R (p_end - p_start) (see `constraints.OnLine`). With R large,
p_end turns by 1 / R of what p goes, and R itself takes up the rest: X = C_u^-1 grows as R^2, X C_u bends as
R^3 and the tangent as R, so that a proven step, 1 / sqrt(2 omega q) of `assembly`, shrinks as 1 / R^2.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.constraints import OnLine
from pointcoord.errors import MechanismError
from pointcoord.topology import Topology

# A turn of the arm by 1 rad, from a drawing in the middle to an end of its range, takes 0.036 R^2 steps of a
# path in the paper's car; that is all of the 2000 that a path may have at R = 235.
FARTHEST = 235.0


def check_slides(topology: Topology, points: Mapping[str, ArrayLike]) -> None:
    """Refuse lines that are drawn by points too close together.

    Args:
        points: shape (..., 3), mm.
    Raises:
        MechanismError: a point stands more than FARTHEST lengths of its line along it. Points that coincide
            or are missing are left to `hardpoints`, which tells them by name.
    """
    for slide in topology.constraints:
        if not isinstance(slide, OnLine) or not {slide.point, slide.start, slide.end} <= points.keys():
            continue
        start, end, point = (
            np.asarray(points[n], dtype=float) for n in (slide.start, slide.end, slide.point)
        )
        with np.errstate(over="ignore", invalid="ignore"):
            apart = np.atleast_1d(np.linalg.norm(end - start, axis=-1))
            reach = np.atleast_1d(np.linalg.norm(point - start, axis=-1))
            far = (apart > 0.0) & (reach > FARTHEST * apart)
        if far.any():
            near, away = float(apart[far][0]), float(reach[far][0])
            raise MechanismError(
                f"{slide.start} and {slide.end} are {near:.3g} mm apart, and {slide.point} is {away:.3g} mm "
                f"along the line through them, {away / near:.3g} times as far, so that they do not tell its "
                f"direction well enough; allowed: at most {FARTHEST:g} times; draw {slide.end} at least "
                f"{away / FARTHEST:.2g} mm from {slide.start}",
                [slide.start, slide.end, slide.point],
            )
