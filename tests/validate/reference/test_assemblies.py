"""Which assemblies exist, and which one is returned."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mpf

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
BENT = {"arm_angle": (1.5, 0.2, 0.1), "rack": (10, 20, 30)}


def same(one: Instant, other: Instant) -> bool:
    radius = one.radius + other.radius
    apart = (x for name in one.position for x in minus(one.position[name], other.position[name]))
    return all(abs(x) <= radius for x in apart)


def test_two_seeds_list_the_same_assemblies_and_as_many_as_can_exist(table: Table) -> None:
    first, second = (count_assemblies(table, BENT, seed=seed, closure="collinear") for seed in (0, 1))
    assert len(first.found) == len(second.found) == first.possible == 8
    assert all(same(a, b) for a, b in zip(first.found, second.found, strict=True))
    assert str(first).startswith("found at least 8 assemblies")


def test_finds_that_differ_by_rounding_are_one_assembly(
    table: Table, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("validate.reference.assemblies.SAME", 0.0)
    listed = count_assemblies(table, BENT, starts=150, closure="collinear")
    assert len(listed.found) <= 8 < listed.converged


def test_listed_assemblies_are_distinct_and_each_is_the_one_its_choices_name(table: Table) -> None:
    listed = count_assemblies(table, BENT, closure="collinear").found
    assert len({one.choices for one in listed}) == len(listed)
    for one in listed:
        guess = {name: one.position_as_float(name) for name in table}
        assert same(solve_reference(table, BENT, guess=guess, closure="collinear"), one)


@given(
    nudges=st.lists(st.integers(-15, 15), min_size=30, max_size=30),
    theta=st.floats(0.9, 2.3),
    rack=st.floats(-40, 60),
)
@settings(max_examples=12, deadline=None)
def test_the_search_finds_no_assembly_that_the_closed_forms_do_not_allow(
    table: Table, nudges: list[int], theta: float, rack: float
) -> None:
    points = {
        name: tuple(x + nudges[3 * i + k] for k, x in enumerate(p))
        for i, (name, p) in enumerate(table.items())
    }
    listed = count_assemblies(
        points, {"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0)}, starts=300, closure="collinear"
    )
    assert len(listed.found) <= listed.possible <= 16
    assert listed.possible % 4 == 0  # the rod's and the tie's two answers come together


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


def test_a_guess_picks_the_mirrored_tie_rod(table: Table) -> None:
    design = solve_reference(table, BENT, closure="collinear")
    other = next(
        one
        for one in count_assemblies(table, BENT, closure="collinear").found
        if one.choices == replace(design.choices, tie=1)
    )
    guess = {name: tuple(round(x) for x in other.position_as_float(name)) for name in table}
    found = solve_reference(table, BENT, guess=guess, closure="collinear")
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


def test_a_guess_between_two_assemblies_is_refused(table: Table) -> None:
    one, other = count_assemblies(table, BENT, closure="collinear").found[:2]
    middle = {
        name: tuple((a + b) / 2 for a, b in zip(one.position[name], other.position[name], strict=True))
        for name in table
    }
    with pytest.raises(AmbiguousAssemblyError, match=r"limit 0\.5"):
        solve_reference(table, BENT, guess=middle, closure="collinear")


def test_a_guess_that_leaves_a_choice_open_is_refused(table: Table) -> None:
    wheel = solve_reference(table, BENT, closure="collinear").position_as_float("wheel_centre")
    with pytest.raises(AmbiguousAssemblyError, match="name more points"):
        solve_reference(table, BENT, guess={"wheel_centre": wheel}, closure="collinear")


def test_a_guess_at_an_unreachable_pose_is_not_answered_by_a_far_assembly(table: Table) -> None:
    near = solve_reference(table, {"arm_angle": (1.5, 0, 0), "rack": (130, 0, 0)}, closure="collinear")
    guess = {name: near.position_as_float(name) for name in table}
    with pytest.raises(InfeasibleError):
        solve_reference(
            table, {"arm_angle": (1.5, 0, 0), "rack": (135, 0, 0)}, guess=guess, closure="collinear"
        )


def test_a_table_at_a_dead_point_needs_a_guess(table: Table) -> None:
    level = {**table, "lower_arm_front": (0, 0, 0), "lower_arm_rear": (200, 0, 0)}
    level["lower_ball_joint"] = (0, 0, -300)
    with pytest.raises(AmbiguousAssemblyError, match="arm choice"):
        solve_reference(level, {"arm_angle": (3.0, 0, 0)}, closure="collinear")


def test_a_guess_far_from_everything_is_called_ambiguous_and_not_singular(table: Table) -> None:
    far = {name: (x, y - 5000, z) for name, (x, y, z) in table.items()}
    for theta in (0.75, 1.5, 2.4):
        with pytest.raises(AmbiguousAssemblyError):
            solve_reference(
                table, {"arm_angle": (theta, 0, 0), "rack": (60, 0, 0)}, guess=far, closure="collinear"
            )


@given(theta=st.floats(-10, 10), rack=st.floats(-1e3, 1e3), speed=st.floats(-1e3, 1e3))
@settings(max_examples=60, deadline=None)
def test_any_finite_input_gives_a_proven_instant_or_an_error_of_the_family(
    table: Table, theta: float, rack: float, speed: float
) -> None:
    inputs = {"arm_angle": (theta, speed, 1), "rack": (rack, speed, 2), "heave": (speed, 3, 4)}
    try:
        reference = solve_reference(table, inputs, closure="collinear")
    except NoReferenceError:
        return
    assert reference.error_bound["position"] < reference.radius < mpf("1e-55")
