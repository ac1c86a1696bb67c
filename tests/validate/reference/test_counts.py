"""What is counted is right: digits tried, starts, the condition; and everything ends by a count."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from reference_cars import OFF_AXIS, ReferenceCar

from validate.reference import (
    BadInputError,
    InfeasibleError,
    NotDecidedError,
    SingularPoseError,
    count_assemblies,
)
from validate.reference.candidates import every_candidate
from validate.reference.solve import with_enough_digits


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
        count_assemblies(OFF_AXIS, {"arm_angle": (1.5, 0, 0)}, starts=starts, closure="drawn")


def test_one_start_is_a_search_of_one_start(car: ReferenceCar) -> None:
    for seed in range(8):
        listed = car.count(car.still, starts=1, seed=seed)
        assert listed.starts == 1
        assert len(listed.found) == listed.converged <= 1


@pytest.mark.parametrize("turn", [Fraction(-1, 5), Fraction(0), Fraction(1, 5)])
def test_the_condition_is_numpy_s_in_the_maximum_norm_of_the_scaled_rows(
    car: ReferenceCar, turn: Fraction
) -> None:
    angle = car.inputs["arm_angle"][0] + turn
    reference = car.solve({**car.still, "arm_angle": (angle, 0, 0)})
    known, linkage = car.known(arm_angle=angle), car.linkage
    y = linkage.unknown_of(linkage.candidate(known, reference.choices).points, known)
    matrix = np.zeros((linkage.size, linkage.size))
    for row, column, entry in linkage.jacobian(y, known):
        matrix[row, column] = float(entry)
    scaled = matrix / np.abs(matrix).sum(axis=1, keepdims=True)
    # numpy's inverse is off by about eps times the condition, which is below 1e4 here.
    assert reference.condition < 1e4
    assert reference.condition == pytest.approx(float(np.linalg.cond(scaled, np.inf)), rel=1e-10)


def test_the_condition_of_a_knuckle_near_its_dead_point_grows_as_the_inverse_root(car: ReferenceCar) -> None:
    def condition(rack: Fraction) -> float:
        return car.solve({**car.still, "rack": (rack, 0, 0)}).condition

    near, beyond = car.inputs["rack"][0], car.last_rack
    for _ in range(100):
        middle = (near + beyond) / 2
        try:
            condition(middle)
            near = middle
        except InfeasibleError:
            beyond = middle
    far, close = (condition(near - Fraction(1, 10**n)) for n in (8, 12))
    assert close / far == pytest.approx(100, rel=0.05)


def test_a_search_finds_assemblies_and_the_closed_forms_count_those_that_exist(car: ReferenceCar) -> None:
    listed = car.count(car.still, starts=150)
    feasible = {c.choices for c in every_candidate(car.known()) if max(c.gaps.values()) < 0}
    assert listed.possible == len(feasible)
    found = [one.choices for one in listed.found]
    assert len(set(found)) == len(found) >= 2
    assert set(found) <= feasible
    assert len(found) <= listed.converged <= listed.starts == 150
