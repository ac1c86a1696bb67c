"""Which assemblies exist, and which one is returned."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mpf
from reference_cars import CARS, ReferenceCar

from validate.reference import (
    AmbiguousAssemblyError,
    InfeasibleError,
    Instant,
    NoReferenceError,
    count_assemblies,
    solve_reference,
)
from validate.reference.macpherson import Choices
from validate.reference.vectors import minus

Table = dict[str, tuple[int, int, int]]


def same(one: Instant, other: Instant) -> bool:
    radius = one.radius + other.radius
    apart = (x for name in one.position for x in minus(one.position[name], other.position[name]))
    return all(abs(x) <= radius for x in apart)


def rounded(one: Instant) -> dict[str, tuple[float, float, float]]:
    """Its points as a guess."""
    return {name: one.position_as_float(name) for name in one.position}


def test_two_seeds_list_the_same_assemblies_and_as_many_as_can_exist(car: ReferenceCar) -> None:
    first, second = (car.count(car.inputs, seed=seed) for seed in (0, 1))
    assert len(first.found) == len(second.found) == first.possible >= 4
    assert all(same(a, b) for a, b in zip(first.found, second.found, strict=True))
    assert str(first).startswith(f"found at least {first.possible} assemblies")


def test_finds_that_differ_by_rounding_are_one_assembly(
    car: ReferenceCar, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("validate.reference.assemblies.SAME", 0.0)
    listed = car.count(car.inputs, starts=150)
    assert len(listed.found) <= listed.possible < listed.converged


def test_listed_assemblies_are_distinct_and_each_is_the_one_its_choices_name(car: ReferenceCar) -> None:
    listed = car.count(car.inputs).found
    assert len({one.choices for one in listed}) == len(listed)
    for one in listed:
        assert same(car.solve(car.inputs, guess=rounded(one)), one)


@pytest.mark.parametrize("name", CARS)
@given(data=st.data(), turn=st.floats(-0.6, 0.8), travel=st.floats(-60, 40))
@settings(max_examples=12, deadline=None)
def test_the_search_finds_no_assembly_that_the_closed_forms_do_not_allow(
    name: str, data: st.DataObject, turn: float, travel: float
) -> None:
    car = CARS[name]
    nudge = st.tuples(*[st.integers(-15, 15)] * 3)
    points = {
        n: tuple(x + d for x, d in zip(p, data.draw(nudge), strict=True)) for n, p in car.points.items()
    }
    theta, rack = float(car.inputs["arm_angle"][0]) + turn, float(car.inputs["rack"][0]) + travel
    inputs = {"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0)}
    listed = replace(car, points=points).count(inputs, starts=300)
    assert len(listed.found) <= listed.possible <= len(list(car.linkage.combinations(car.known())))
    assert listed.possible % 2 == 0  # the tie rod's two answers come together


def test_without_a_guess_the_assembly_is_the_one_reached_from_the_table_by_small_steps(table: Table) -> None:
    # Start at the table's own theta and S, from the table, and always guess the pose before.
    guess: dict[str, tuple[object, ...]] = dict(table)
    for step in range(33):
        t = Fraction(step, 32)
        theta = Fraction("1.6514") * (1 - t) + Fraction("2.6") * t
        inputs = {"arm_angle": (theta, 0, 0), "rack": (60 * t, 0, 0)}
        there = solve_reference(table, inputs, guess=guess, closure="collinear")
        guess = {name: there.position_as_float(name) for name in table}
        assert same(there, solve_reference(table, inputs, closure="collinear"))
    assert there.choices == Choices(arm=1, strut=1, rod=1, tie=-1)


def test_a_guess_picks_the_mirrored_tie_rod(car: ReferenceCar) -> None:
    design = car.solve(car.inputs)
    mirrored = replace(design.choices, tie=-design.choices.tie)
    other = next(one for one in car.count(car.inputs).found if one.choices == mirrored)
    guess = {name: tuple(round(x) for x in place) for name, place in rounded(other).items()}
    found = car.solve(car.inputs, guess=guess)
    assert same(found, other)
    assert not same(found, design)


def test_close_to_a_dead_point_the_guess_tells_two_assemblies_a_hair_apart(table: Table) -> None:
    theta = Fraction("2.653128692")  # within 1e-9 of the greatest
    inputs = {"arm_angle": (theta, 0, 0)}
    ahead = solve_reference(table, inputs, closure="collinear")
    twin_choices = replace(ahead.choices, arm=-1)
    twins = [
        one
        for one in count_assemblies(table, inputs, closure="collinear").found
        if one.choices == twin_choices
    ]
    assert len(twins) == 1
    apart = max(abs(x) for name in table for x in minus(ahead.position[name], twins[0].position[name]))
    assert mpf("1e-3") < apart < 1
    for one in (ahead, twins[0]):
        assert same(
            solve_reference(
                table, inputs, guess={k: one.position_as_float(k) for k in table}, closure="collinear"
            ),
            one,
        )


def test_a_guess_between_two_assemblies_is_refused(car: ReferenceCar) -> None:
    one, other = car.count(car.inputs).found[:2]
    middle = {
        name: tuple((a + b) / 2 for a, b in zip(one.position[name], other.position[name], strict=True))
        for name in car.points
    }
    with pytest.raises(AmbiguousAssemblyError, match=r"limit 0\.5"):
        car.solve(car.inputs, guess=middle)


def test_a_guess_that_leaves_a_choice_open_is_refused(car: ReferenceCar) -> None:
    lower = car.solve(car.inputs).position_as_float("lower_ball_joint")
    with pytest.raises(AmbiguousAssemblyError, match="name more points"):
        car.solve(car.inputs, guess={"lower_ball_joint": lower})


def test_a_guess_at_an_unreachable_pose_is_not_answered_by_a_far_assembly(table: Table) -> None:
    near = solve_reference(table, {"arm_angle": (1.5, 0, 0), "rack": (130, 0, 0)}, closure="collinear")
    guess = {name: near.position_as_float(name) for name in table}
    with pytest.raises(InfeasibleError):
        solve_reference(
            table, {"arm_angle": (1.5, 0, 0), "rack": (135, 0, 0)}, guess=guess, closure="collinear"
        )


def test_a_table_at_a_dead_point_needs_a_guess(car: ReferenceCar) -> None:
    level = {**car.points, "lower_arm_front": (0, 0, 0), "lower_arm_rear": (200, 0, 0)}
    level["lower_ball_joint"] = (0, 0, -300)
    with pytest.raises(AmbiguousAssemblyError, match="arm choice"):
        replace(car, points=level).solve({"arm_angle": (3.0, 0, 0)})


def test_a_guess_far_from_everything_is_called_ambiguous_and_not_singular(car: ReferenceCar) -> None:
    outboard = 50000 if car.side == "right" else -50000  # where the arm points in assemblies that exist
    far = {name: (x, y + outboard, z) for name, (x, y, z) in car.points.items()}
    for turn in (-0.2, 0, 0.2):
        theta = float(car.inputs["arm_angle"][0]) + turn
        with pytest.raises(AmbiguousAssemblyError):
            car.solve({**car.still, "arm_angle": (theta, 0, 0)}, guess=far)


@pytest.mark.parametrize("name", CARS)
@given(theta=st.floats(-10, 10), rack=st.floats(-1e3, 1e3), speed=st.floats(-1e3, 1e3))
@settings(max_examples=60, deadline=None)
def test_any_finite_input_gives_a_proven_instant_or_an_error_of_the_family(
    name: str, theta: float, rack: float, speed: float
) -> None:
    inputs = {"arm_angle": (theta, speed, 1), "rack": (rack, speed, 2), "heave": (speed, 3, 4)}
    try:
        reference = CARS[name].solve(inputs)
    except NoReferenceError:
        return
    assert reference.error_bound["position"] < reference.radius < mpf("1e-55")
