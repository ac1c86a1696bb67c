"""`assert_agrees` passes what is right, and says of what is wrong what, by how much, where and why."""

import numpy as np
import pytest
from changed_scenes import scene_with
from plain_solvers import closed_form

from validate import NotTested, assert_agrees
from validate.formulations.reference_solution import reference_solution
from validate.solvers.plain import given_to_solver

SCENE = scene_with("double-wishbone", title="mine", samples=21)


@pytest.fixture(scope="module")
def states() -> dict[str, dict[str, np.ndarray]]:
    return closed_form(given_to_solver(SCENE))


def moved(states: dict[str, dict[str, np.ndarray]], instant: int, by: float) -> dict[str, object]:
    """The states with one coordinate of one point off at one instant."""
    place = states["position"]["tie_rod_outer"].copy()
    place[instant, 1] += by
    return states | {"position": states["position"] | {"tie_rod_outer": place}}


def test_closed_forms_agree_with_pointcoord_and_with_the_reference(states) -> None:
    for name, against in (("pointcoord", "pointcoord"), ("reference", reference_solution(SCENE))):
        outcome = assert_agrees(states, SCENE, against=against)
        assert outcome.passed
        assert outcome.solutions[1].formulation == name
        # The closed forms give no dimensions of the wheel.
        assert {row.verdict for row in outcome.rows if row.quantity != "dimension"} == {"agrees"}


def test_one_coordinate_off_at_one_instant_is_named_with_its_size_and_its_time(states) -> None:
    with pytest.raises(AssertionError) as caught:
        assert_agrees(moved(states, 17, 1e-3), SCENE)
    first, row, *rest = str(caught.value).splitlines()
    assert [words for words in ("in 'mine'", "1 of ", "an accuracy of 1e-06 mm") if words not in first] == []
    assert row.strip().startswith("position of tie_rod_outer: difference 0.001 mm, tolerance ")
    assert f"at {SCENE.instants[17]:.9g} s" in row
    # No cause is made up for a fault of one number: only its place is given.
    said = [line.strip() for line in rest if "possible explanation" in line]
    where = f"at {SCENE.instants[17]:g} s only, 1 of {len(SCENE.instants)} instants"
    assert said == [f"possible explanation: position of tie_rod_outer: disagrees {where}"]


def test_other_units_are_explained_and_long_lists_are_cut(states) -> None:
    every = {name: place / 1000.0 for name, place in states["position"].items()}
    with pytest.raises(AssertionError, match=r"possible explanation: .*\bm\b") as caught:
        assert_agrees({"position": every}, SCENE)
    assert len(str(caught.value).splitlines()) < 20


def test_states_that_hold_nothing_are_no_agreement() -> None:
    with pytest.raises(AssertionError, match="contain nothing that 'mine' asks for"):
        assert_agrees({}, SCENE)
    with pytest.raises(AssertionError, match=r"'positions'.*did you mean 'position'"):
        assert_agrees({"positions": {}}, SCENE)


def test_a_nan_is_told_with_its_time_and_how_many_there_are(states) -> None:
    camber = states["wheel"]["camber"].copy()
    camber[[4, 9]] = np.nan
    with pytest.raises(AssertionError) as caught:
        assert_agrees({"camber": camber}, SCENE)
    said = str(caught.value)
    assert f"camber: not a number at {SCENE.instants[4]:.9g} s" in said
    assert f"not a number at 2 of {len(SCENE.instants)} instants" in said


def test_a_number_that_cannot_be_compared_fails_the_test_whatever_the_others_are(states) -> None:
    """A comparison leaves it out and says so; a test would pass, and nobody would read that."""
    good, instants = {"acceleration": states["acceleration"]}, len(SCENE.instants)
    for wrong, words in (
        ({"camber": np.zeros(3)}, f"camber has the shape (3,); needed: ({instants},)"),
        ({"cambre": np.zeros(instants)}, "which the scene does not ask for (did you mean 'camber'?)"),
    ):
        with pytest.raises(AssertionError) as caught:
            assert_agrees(good | wrong, SCENE)
        assert words in str(caught.value)
    # What is no misspelt name of ours is nobody's business.
    assert assert_agrees(good | {"iterations": 3, "seconds": [0.1]}, SCENE).passed


def test_what_is_needed_must_be_there_all_of_it(states) -> None:
    assert assert_agrees(states, SCENE, needed=("position", "camber", "wheel")).passed
    alone = {"camber": states["wheel"]["camber"]}
    assert assert_agrees(alone, SCENE, needed=("camber",)).passed
    for needed, words in (
        ("velocity", "velocity is needed, but the states give none of lower_arm_front, "),
        ("toe", "toe is needed, but the states give none"),
        ("wheel", "wheel is needed, but the states give none of kingpin"),
        ("tow", "'tow' is needed, but the scene does not ask for it (did you mean 'toe'?)"),
    ):
        with pytest.raises(AssertionError) as caught:
            assert_agrees(alone, SCENE, needed=(needed,))
        assert words in str(caught.value)
    most = {name: place for name, place in states["position"].items() if name != "wheel_centre"}
    with pytest.raises(AssertionError, match="position is needed, but the states give none of wheel_centre"):
        assert_agrees({"position": most}, SCENE, needed=("position",))


def test_an_accuracy_that_says_nothing_is_no_agreement_either(states) -> None:
    with pytest.raises(NotTested) as caught:
        assert_agrees(states, SCENE, accuracy=1e3)
    assert {"position of wheel_centre", "camber"} <= set(caught.value.numbers)
