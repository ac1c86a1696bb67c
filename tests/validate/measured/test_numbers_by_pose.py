"""Files over travels and inputs of what a map does not give: gradients, roll centres, ratios, jerks."""

from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from curve_files import compared, disagreeing, table, verdicts

from pointcoord import Scene, solve_poses
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.effects.registry import QUANTITIES
from validate.formulations.registry import formulation
from validate.tables.units import degrees_of

OVER_TRAVEL = (
    "toe_by_travel",
    "camber_by_rack",
    "roll_centre_height",
    "front_view_swing_arm",
    "damper_per_wheel",
    "camber",
)
EFFECTS = (
    "wheel_angles",
    "toe_by_travel",
    "camber_by_rack",
    "roll_centre",
    "instant_centres",
    "motion_ratio",
)


def file_of(scene: Scene, over: str, numbers: tuple[str, ...], wrong: dict[str, Any] | None = None) -> str:
    """A table of the absolute model's numbers over an input, five decimals, and of what is done to some."""
    columns = {f"input.{over} [mm]": scene.functions[over].series(scene.instants, 0)[:, 0]}
    for quantity, part in formulation("absolute").solve(scene).numbers.items():
        factor, unit = degrees_of(QUANTITIES[quantity].unit)
        for name in (name for name in numbers if name in part):
            change = (wrong or {}).get(name, lambda x: x)
            columns[f"{name} [{unit}]"] = change(factor * part[name])
    return table(columns, 5)


def test_gradients_centres_and_ratios_over_a_travel_are_held_to_their_digits() -> None:
    scene = scene_with("wheel-travel", effects=EFFECTS, samples=9)
    found = compared(file_of(scene, "wheel_travel", OVER_TRAVEL), {}, scene)
    assert verdicts(found).items() >= dict.fromkeys(OVER_TRAVEL, "agrees").items()
    # To half of the last digit and hardly more: our own bounds are far below it.
    tolerances = {row.name: row.tolerance for row in found.outcome.rows}
    assert tolerances["roll_centre_height"] == pytest.approx(5e-6, rel=0.1)
    assert tolerances["toe_by_travel"] == pytest.approx(np.radians(5e-6), rel=0.1)
    wrong = {
        "toe_by_travel": lambda x: -x,
        "roll_centre_height": lambda x: x + 2e-5,
        "damper_per_wheel": lambda x: 1.0 / x,
        "front_view_swing_arm": lambda x: x * 1.000001,
    }
    disagree = disagreeing(file_of(scene, "wheel_travel", OVER_TRAVEL, wrong), {}, scene)
    assert sorted(words.rpartition(".")[2] for words in disagree) == sorted(wrong)


def test_what_two_wheels_make_over_a_rack_is_in_per_cent() -> None:
    numbers = ("ackermann", "ackermann_error")
    scene = scene_with("axle-steer", effects=("steer_angle", "ackermann"), samples=10)
    exact = {"columns": {"input.rack": {"printed": 0}}}
    found = compared(file_of(scene, "rack", numbers), exact, scene)
    assert {verdicts(found)[name] for name in numbers} == {"agrees"}
    off = file_of(scene, "rack", numbers, {"ackermann": lambda x: x + 1e-3})
    (wrong,) = disagreeing(off, exact, scene)
    assert wrong.endswith(".ackermann")


def test_forces_over_an_input_are_held_to_bounds_of_their_own_poses_and_rates_are_not_tested() -> None:
    loaded, racks = (
        {"wheel_radius": 270.0, "loads": {"force": [0.0, 0.0, 3000.0]}},
        np.linspace(-20.0, 20.0, 5),
    )
    scene = scene_with("double-wishbone", loaded, effects=["loads"])
    inputs = {"rack": racks, "arm_angle": drawn_inputs(scene)["arm_angle"]}
    forces = solve_poses(scene, inputs).numbers["rod_force"]["tie_rod"]
    for factor, verdict in ((1.0, "agrees"), (1.0 + 1e-8, "disagrees")):
        rows = (
            f"{x!r},{factor * force!r},1.0" for x, force in zip(racks.tolist(), forces.tolist(), strict=True)
        )
        text = "\n".join(["rack [mm],rod_force.tie_rod [N],velocity.wheel_centre.z [mm/s]", *rows, ""])
        found = {row.quantity: row for row in compared(text, {}, scene).outcome.rows}
        assert found["rod_force"].verdict == verdict
        assert (found["velocity"].verdict, found["velocity"].why) == (
            "not tested",
            "rates need a column of time",
        )


@pytest.mark.parametrize(("name", "order"), [("jerk", 3), ("derivative_12", 12)])
def test_derivatives_over_time_are_read_in_their_unit_and_a_wrong_one_is_seen(name: str, order: int) -> None:
    scene = scene_with("bounce-and-steer", effects=(name,), samples=21)
    motion = formulation("absolute").solve(scene)
    for factor, wrong in ((1.0, []), (1.001, [f"{name}.wheel_centre.x"])):
        numbers = motion.numbers[name]["wheel_centre"] * [factor, 1.0, 1.0]
        heads = ["time [s]", *(f"{name}.wheel_centre.{axis} [m/s^{order}]" for axis in "xyz")]
        rows = [[t, *(j * 1e-3)] for t, j in zip(scene.instants.tolist(), numbers, strict=True)]
        text = "\n".join([",".join(heads), *(",".join(f"{float(x):.9f}" for x in row) for row in rows), ""])
        assert disagreeing(text, {}, scene) == wrong
