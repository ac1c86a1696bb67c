"""`assert_agrees` passes what is right, and says of what is wrong what, by how much, where and why."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from plain_solvers import closed_form

from validate import NotTested, assert_agrees
from validate.formulations.reference_solution import reference_solution
from validate.solvers.plain import given_to_solver

SCENE = scene_with("double-wishbone", title="mine", samples=21)
TIMES = SCENE.instants
States = dict[str, Any]


@pytest.fixture(scope="module")
def states() -> States:
    return closed_form(given_to_solver(SCENE))


def changed(states: States, quantity: str, name: str, place: Any, value: float) -> States:
    """The states with a number changed at some instants."""
    array = states[quantity][name].copy()
    array[place] += value
    return states | {quantity: states[quantity] | {name: array}}


def test_what_is_right_passes_against_pointcoord_and_the_reference(states: States) -> None:
    for name, against in (("pointcoord", "pointcoord"), ("reference", reference_solution(SCENE))):
        outcome = assert_agrees(states, SCENE, against=against, needed=("position", "camber", "wheel"))
        assert outcome.passed
        assert outcome.solutions[1].formulation == name
        # The closed forms give no dimensions of the wheel.
        assert {row.verdict for row in outcome.rows if row.quantity != "dimension"} == {"agrees"}
    # What is no misspelt name of ours is nobody's business.
    assert assert_agrees(states | {"iterations": 3, "seconds": [0.1]}, SCENE).passed
    assert assert_agrees({"camber": states["wheel"]["camber"]}, SCENE, needed=("camber",)).passed


def camber(states: States) -> States:
    return {"camber": states["wheel"]["camber"]}


# What is given, what is needed of it, and parts of what is said.
WRONG: list[tuple[Callable[[States], States], str, str]] = [
    (
        lambda s: changed(s, "position", "tie_rod_outer", (17, 1), 1e-3),
        "",
        "in 'mine' | 1 of | an accuracy of 1e-06 mm | tie_rod_outer: difference 0.001 mm, tolerance | "
        f"at {TIMES[17]:.9g} s | "
        # No cause is made up for a fault of one number: only its place is given.
        f"possible explanation: position of tie_rod_outer: disagrees at {TIMES[17]:g} s only, 1 of 21 ",
    ),
    (
        lambda s: {"position": {n: x / 1000.0 for n, x in s["position"].items()}},
        "",
        "possible explanation: |  m",
    ),
    (lambda _: {}, "", "the answer gives no verdict for 'mine': no number is given; asked for: position, "),
    (lambda _: {"positions": {}}, "", "'positions' | did you mean 'position'"),
    (
        lambda s: changed(s, "wheel", "camber", [4, 9], np.nan),
        "",
        f"camber: not a number at {TIMES[4]:.9g} s | not a number at 2 of 21 instants",
    ),
    # A comparison leaves out what it cannot compare and says so; nobody reads that of a test that passes.
    (lambda s: s | {"camber": np.zeros(3)}, "", "camber has the shape (3,); needed: (21,)"),
    (lambda s: s | {"cambre": TIMES}, "", "does not ask for (did you mean 'camber'?)"),
    (camber, "velocity", "velocity is needed, but the answer gives none of lower_arm_front, "),
    (camber, "toe", "toe is needed, but the answer gives none"),
    (camber, "wheel", "wheel is needed, but the answer gives none of kingpin"),
    (camber, "tow", "'tow' is needed, but the scene does not ask for it (did you mean 'toe'?)"),
    (
        lambda s: {"position": {n: x for n, x in s["position"].items() if n != "wheel_centre"}},
        "position",
        "position is needed, but the answer gives none of wheel_centre",
    ),
]


@pytest.mark.parametrize(("given", "needed", "said"), WRONG)
def test_what_is_wrong_is_said_in_few_lines(
    given: Callable[[States], States], needed: str, said: str, states: States
) -> None:
    with pytest.raises(AssertionError) as caught:
        assert_agrees(given(states), SCENE, needed=(needed,) if needed else ())
    assert [part for part in said.split(" | ") if part not in str(caught.value)] == [], caught.value
    assert len(str(caught.value).splitlines()) < 20
    assert str(caught.value).count("possible explanation: position of tie_rod_outer") <= 1


def test_an_accuracy_that_says_nothing_is_no_agreement_either(states: States) -> None:
    with pytest.raises(NotTested) as caught:
        assert_agrees(states, SCENE, accuracy=1e3)
    assert {"position of wheel_centre", "camber"} <= set(caught.value.numbers)
