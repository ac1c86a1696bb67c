"""Every shipped mechanism is what closed forms and other people's printed tables say, by the reference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from exact_states import exact_states
from many_digits import DIGITS, Array, vector
from mechanism_checks import CLOSED, EXACT, PRINTED, closed_form_check, farthest, right_form, table
from mechanism_files import MECHANISMS, SCENES, plain_scene, scene_file
from mpmath import mp, mpf

from pointcoord import Scene


def test_every_mechanism_has_a_scene_and_a_closed_form_or_a_printed_table() -> None:
    shown = {scene_file(scene)["mechanism"]["type"] for scene in SCENES}
    held = {scene_file(scene)["mechanism"]["type"] for scene in CLOSED} | set(PRINTED)
    assert shown == held == set(MECHANISMS)


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_is_read_as_its_tables_say(scene: str) -> None:
    """What is held to closed forms and printed tables below is what a scene's models are given."""
    asked = Scene.load(scene)
    read, tables = asked.mechanism.plain(tuple(asked.inputs)), plain_scene(scene)
    assert {name: [*map(float, place)] for name, place in tables.pop("points").items()} == read.pop("points")
    assert {**read, "name": ""} == {**tables, "name": ""}


@pytest.mark.parametrize("scene", CLOSED)
def test_the_poses_of_a_scene_are_those_of_the_closed_form(scene: str) -> None:
    check = closed_form_check(scene)
    found = check.deviations_of(check.plain())
    assert all(found[name] <= limit for name, limit in check.limits.items()), found


@pytest.mark.parametrize("mechanism", PRINTED)
def test_the_numbers_are_those_of_the_printed_table(mechanism: str) -> None:
    check = PRINTED[mechanism]()
    found = check.deviations_of(check.plain())
    assert set(found) == set(check.limits)
    assert all(found[name] <= limit for name, limit in check.limits.items()), found


def andrews_rates(inputs: Sequence[Any], order: int) -> Array:
    """First or second derivatives of the benchmark's seven angles; a second one of a mechanism at rest."""
    (states,) = exact_states(plain_scene("andrews-squeezer"), [{"crank": inputs}])
    with mp.workdps(DIGITS):
        p, moved = states[0], states[order]

        def turning(first: str, second: str) -> Any:
            arm, pull = p[second] - p[first], moved[second] - moved[first]
            return np.cross(arm, pull)[2] / (arm @ arm)

        beta, gamma, delta, epsilon = (turning(*ends) for ends in ("OF", "BE", "AG", "AH"))
        theta, phi, omega = (turning(*ends) for ends in ("EF", "GE", "HE"))
        found = [beta, theta - beta, gamma, phi - delta, delta, omega - epsilon, epsilon]
        return np.array(found).astype(float)


def test_andrews_angles_accelerate_from_rest_as_printed() -> None:
    printed = vector(table("andrews_squeezer")["a0"]).astype(float)
    # The drawing is rounded to doubles: 1e-16 of the rates, a hundred times amplified at most.
    assert andrews_rates((0, 0, printed[0]), 2) == pytest.approx(printed, abs=1e-14 * printed[0])


def test_andrews_angles_end_as_fast_as_printed() -> None:
    data = table("andrews_squeezer")
    start, end, printed = mpf(data["q0"][0]), mpf(data["q_t003"][0]), vector(data["v_t003"]).astype(float)
    # The printed velocities meet their own constraints to 2e-8 of the largest and no better.
    assert andrews_rates((end - start, printed[0], 0), 1) == pytest.approx(printed, abs=2e-8 * printed[0])


def test_parallel_cranks_stay_parallel_a_thousandth_of_a_radian_before_they_lie_in_line() -> None:
    path = [{"crank": mpf(angle)} for angle in ("-0.8", "-1.5697")]
    states = exact_states(plain_scene("n-four-bar"), [{"crank": (one["crank"], 0, 0)} for one in path])
    assert farthest([position for position, *_ in states], right_form("n-four-bar", path)) <= EXACT
