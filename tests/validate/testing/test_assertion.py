"""`assert_agrees` passes what is right, and says of what is wrong what, by how much, where and why."""

import numpy as np
import pytest
from plain_solvers import closed_form

from pointcoord import Scene
from validate import FormulationError, NotTested, assert_agrees
from validate.adjudication.reference_solution import reference_solution
from validate.solvers.plain import NoSolver, given_to_solver

SCENE = Scene.load("double-wishbone").model_copy(update={"title": "mine"})


@pytest.fixture(scope="module")
def states() -> dict[str, dict[str, np.ndarray]]:
    return closed_form(given_to_solver(SCENE))


def moved(states: dict[str, dict[str, np.ndarray]], instant: int, by: float) -> dict[str, object]:
    """The states with one coordinate of one point off at one instant."""
    place = states["position"]["tie_rod_outer"].copy()
    place[instant, 1] += by
    return states | {"position": states["position"] | {"tie_rod_outer": place}}


def test_closed_forms_agree_with_pointcoord_and_with_the_reference(states) -> None:
    for against in ("pointcoord", reference_solution(SCENE)):
        outcome = assert_agrees(states, SCENE, against=against)
        assert outcome.passed
        assert {row.verdict for row in outcome.rows} == {"agrees"}


def test_one_coordinate_off_at_one_instant_is_named_with_its_size_and_its_time(states) -> None:
    with pytest.raises(AssertionError) as caught:
        assert_agrees(moved(states, 17, 1e-3), SCENE)
    first, row, *rest = str(caught.value).splitlines()
    assert "in 'mine'" in first
    assert "1 of " in first
    assert "an accuracy of 1e-06 mm" in first
    assert row.strip().startswith("position of tie_rod_outer: difference 0.001 mm, tolerance ")
    assert f"at t = {SCENE.instants[17]:.9g} s" in row
    # A fault of one number has no explanation, and none is made up.
    assert not any("what would explain it" in line for line in rest)


@pytest.mark.parametrize(("by", "passes"), [(0.5, True), (3.0, False)])
def test_a_solver_is_held_to_the_accuracy_that_it_states(states, by: float, passes: bool) -> None:
    # A position may be off by the accuracy, and by as much as the missed lengths make of it.
    off = moved(states, 3, by * 1e-4)
    if passes:
        assert_agrees(off, SCENE, accuracy=1e-4)
    assert_agrees(off, SCENE, accuracy=1e-2)
    with pytest.raises(AssertionError, match="tie_rod_outer"):
        assert_agrees(off, SCENE, accuracy=1e-6)


def test_other_units_are_explained_and_long_lists_are_cut(states) -> None:
    every = {name: place / 1000.0 for name, place in states["position"].items()}
    with pytest.raises(AssertionError, match=r"what would explain it: .*\bm\b") as caught:
        assert_agrees({"position": every}, SCENE)
    assert len(str(caught.value).splitlines()) < 20


def test_states_that_hold_nothing_are_no_agreement() -> None:
    with pytest.raises(AssertionError, match="hold nothing that 'mine' asks for"):
        assert_agrees({}, SCENE)
    with pytest.raises(AssertionError, match=r"'positions'.*did you mean 'position'"):
        assert_agrees({"positions": {}}, SCENE)
    nan = np.full(len(SCENE.instants), np.nan)
    with pytest.raises(AssertionError, match="camber: difference"):
        assert_agrees({"camber": nan}, SCENE)


def test_an_accuracy_that_says_nothing_is_no_agreement_either(states) -> None:
    with pytest.raises(NotTested) as caught:
        assert_agrees(states, SCENE, accuracy=1e3)
    assert {"position of wheel_centre", "camber"} <= set(caught.value.numbers)


def test_what_is_no_mapping_and_no_accuracy_is_refused(states) -> None:
    with pytest.raises(FormulationError, match="it answers with a list"):
        assert_agrees([1.0], SCENE)
    with pytest.raises(NoSolver, match="give a length above 0"):
        assert_agrees(states, SCENE, accuracy=0.0)
