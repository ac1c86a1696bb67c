"""What is counted is right: digits tried, starts, the condition; and everything ends by a count."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from off_axis_cars import BASE, closing

from validate.reference import (
    BadInputError,
    InfeasibleError,
    NotDecidedError,
    SingularPoseError,
    count_assemblies,
    solve_reference,
)
from validate.reference.branches import candidate
from validate.reference.closures import equations_for
from validate.reference.design import Design, Driven, values_only
from validate.reference.solve import with_enough_digits

DRAWN = closing(BASE, Fraction(1, 2), Fraction(230), (0, 1, 0))


@pytest.mark.parametrize(
    ("digits", "ladder"),
    [(15, [15, 30, 60, 120, 240, 400]), (60, [60, 120, 240, 400]), (200, [200, 400])],
)
def test_digits_are_doubled_up_to_400_and_then_the_pose_is_called_singular(
    digits: int, ladder: list[int]
) -> None:
    tried: list[int] = []

    def never(working: int) -> int:
        tried.append(working)
        raise NotDecidedError("a claim", "0", "not 0")

    with pytest.raises(SingularPoseError, match="400 digits"):
        with_enough_digits(never, digits)
    assert tried == ladder


def test_a_ladder_that_does_not_reach_its_top_ends_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("validate.reference.solve.MOST_DIGITS", 10**9)
    tried: list[int] = []

    def never(working: int) -> int:
        tried.append(working)
        raise NotDecidedError("a claim", "0", "not 0")

    with pytest.raises(NotDecidedError, match="digits of the arithmetic"):
        with_enough_digits(never, 60)
    assert len(tried) <= 6


@pytest.mark.parametrize("starts", [0, -1])
def test_a_search_needs_a_start(starts: int) -> None:
    with pytest.raises(BadInputError, match=f"starts is {starts}; allowed is at least 1"):
        count_assemblies(DRAWN, {"arm_angle": (1.5, 0, 0)}, starts=starts, closure="drawn")


@pytest.mark.parametrize("closure", ["drawn", "collinear"])
def test_one_start_is_a_search_of_one_start(closure: str) -> None:
    inputs = {"arm_angle": (1.5, 0, 0), "rack": (230, 0, 0)}
    for seed in range(8):
        listed = count_assemblies(DRAWN, inputs, starts=1, seed=seed, closure=closure)
        assert listed.starts == 1
        assert len(listed.found) == listed.converged <= 1


@pytest.mark.parametrize("closure", ["drawn", "collinear"])
@pytest.mark.parametrize("arm_angle", [1.3, 1.5, 1.7])
def test_the_condition_is_numpy_s_in_the_maximum_norm_of_the_scaled_rows(
    closure: str, arm_angle: float
) -> None:
    inputs = {"arm_angle": (arm_angle, 0, 0), "rack": (230, 0, 0)}
    reference = solve_reference(DRAWN, inputs, closure=closure)
    design = Design.from_points(DRAWN, (0, 0, 1), (0, 1, 0), "left", closure)
    known = values_only(design.known(Driven.from_mapping(inputs)))
    equations = equations_for(closure)
    y = equations.unknown_of(candidate(known, reference.choices).points, known)
    matrix = np.zeros((equations.SIZE, equations.SIZE))
    for row, column, entry in equations.jacobian(y, known):
        matrix[row, column] = float(entry)
    scaled = matrix / np.abs(matrix).sum(axis=1, keepdims=True)
    # numpy's inverse is off by about eps times the condition, which is below 1e4 here.
    assert reference.condition == pytest.approx(float(np.linalg.cond(scaled, np.inf)), rel=1e-10)


def test_the_condition_of_a_knuckle_near_its_dead_point_grows_as_the_inverse_root() -> None:
    def condition(rack: Fraction) -> float:
        inputs = {"arm_angle": (1.5, 0, 0), "rack": (rack, 0, 0)}
        return solve_reference(DRAWN, inputs, closure="drawn").condition

    near, beyond = Fraction(230), Fraction(600)
    for _ in range(100):
        middle = (near + beyond) / 2
        try:
            condition(middle)
            near = middle
        except InfeasibleError:
            beyond = middle
    far, close = (condition(near - Fraction(1, 10**n)) for n in (8, 12))
    assert close / far == pytest.approx(100, rel=0.05)
