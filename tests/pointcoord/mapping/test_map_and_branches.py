"""What a map covers is on the branch of the drawing, by the reference."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from pointcoord import NotCovered, Scene, kinematic_map
from pointcoord.drawing_stands import drawn_inputs
from validate.formulations.reference_solution import reference_instant
from validate.reference import InfeasibleError

# Half the ranges of arm angle and rack travel about the drawing: so wide that assemblies end inside.
WIDE = {"arm_angle": 0.625, "rack": 160.0}


def test_every_covered_pose_of_a_wide_range_is_on_the_branch_of_the_drawing() -> None:
    scene = Scene.load("off-axis-strut")
    drawn = {n: round(64.0 * value) / 64.0 for n, value in drawn_inputs(scene).items() if n in WIDE}
    map = kinematic_map(scene, {n: (drawn[n] - half, drawn[n] + half) for n, half in WIDE.items()}, 1e-6)
    assert 0.3 < map.share_covered < 1.0
    shares = np.random.default_rng(5).integers(-1024, 1025, (30, 2)) / 1024
    refused = 0
    for share in shares.tolist():
        value = {n: drawn[n] + s * half for s, (n, half) in zip(share, WIDE.items(), strict=True)}
        if not map.covers(value):
            refused += 1
            with pytest.raises(NotCovered):
                map(value)
            continue
        exact = reference_instant(scene, {n: (number, 0.0, 0.0) for n, number in value.items()}).position
        for point, place in map(value).position.items():
            error = max(abs(Fraction(float(a)) - b) for a, b in zip(place, exact[point], strict=True))
            assert error <= map.bound.position, (point, float(error))
    assert 0 < refused < len(shares)


def test_a_pose_that_the_reference_has_not_is_covered_by_no_map() -> None:
    scene = Scene.load("double-wishbone")
    value = {"arm_angle": 0.3, "rack": 0.0}
    with pytest.raises(InfeasibleError):
        reference_instant(scene, {n: (number, 0.0, 0.0) for n, number in value.items()})
    with pytest.raises(NotCovered):
        kinematic_map(scene, {"arm_angle": (0.25, 1.5), "rack": (-10.0, 10.0)}, 1e-6)(value)
