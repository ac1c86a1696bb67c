"""Files of what a map does not give: gradients, centres, ratios, derivatives, numbers of an axle, forces."""

from collections.abc import Callable, Mapping

import pytest
from changed_scenes import scene_with
from curve_files import compared, disagreeing, table

from pointcoord import Scene
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.arrays import Array
from validate.formulations.registry import formulation
from validate.tables.units import degrees_of

Change = Callable[[Array], Array]
LOADED = {"wheel_radius": 270.0, "loads": {"force": [0.0, 0.0, 3000.0]}}
RACK = {"arm_angle": {"constant": drawn_inputs(Scene.load("double-wishbone"))["arm_angle"]}}
RACK |= {"rack": {"sweep": [-20.0, 20.0]}}
OF_TRAVEL = (
    "wheel_angles",
    "toe_by_travel",
    "camber_by_rack",
    "roll_centre",
    "instant_centres",
    "motion_ratio",
)
# Instants that few digits give exactly.
EXACT = {"start": 0.0, "stop": 0.5, "samples": 17}
CASES: dict[str, tuple[Scene, str, dict[str, Change], tuple[str, ...]]] = {
    "gradients, centres and ratios over a travel": (
        scene_with("wheel-travel", effects=OF_TRAVEL, samples=9),
        "input.wheel_travel [mm]",
        {
            "angle_gradient.toe_by_travel": lambda x: -x,
            "dimension.roll_centre_height": lambda x: x + 2e-5,
            "dimension_gradient.damper_per_wheel": lambda x: 1.0 / x,
            "dimension.front_view_swing_arm": lambda x: x * 1.000001,
        },
        ("angle_gradient.camber_by_rack", "wheel.camber"),
    ),
    "what two wheels make over a rack, in per cent": (
        scene_with("axle-steer", effects=("steer_angle", "ackermann"), samples=10),
        "input.rack [mm]",
        {"ackermann.ackermann": lambda x: x + 1e-3},
        ("steer_error.ackermann_error",),
    ),
    "forces over a rack, by bounds of their own poses": (
        scene_with("double-wishbone", LOADED, effects=["loads"], inputs=RACK, samples=5),
        "input.rack [mm]",
        {"rod_force.tie_rod": lambda x: x + 2e-5},
        (),
    ),
    **{
        f"{name} over time": (
            scene_with("bounce-and-steer", effects=[name], time=EXACT),
            "time [s]",
            {f"{name}.wheel_centre.x": lambda x: 1.001 * x},
            (f"{name}.wheel_centre.z",),
        )
        for name in ("jerk", "derivative_12")
    },
}


def file_of(scene: Scene, over: str, changes: Mapping[str, Change]) -> str:
    """A table of the absolute model's numbers, each changed; five decimals, in m/s^n."""
    driven = over.partition(" ")[0].removeprefix("input.")
    columns = {
        over: scene.instants if driven == "time" else scene.functions[driven].series(scene.instants, 0)[:, 0]
    }
    solved = formulation("absolute").solve(scene).numbers
    for name, change in changes.items():
        quantity, part, *axis = name.split(".")
        factor, unit = degrees_of(QUANTITIES[quantity].unit)
        if axis:
            factor, unit = 1e-3, unit.removeprefix("m")
        numbers = solved[quantity][part]
        for one in axis:
            numbers = numbers[:, "xyz".index(one)]
        columns[f"{name} [{unit}]"] = change(factor * numbers)
    return table(columns, 5)


@pytest.mark.parametrize("case", CASES)
def test_numbers_of_every_kind_are_held_to_their_digits(case: str) -> None:
    scene, over, wrong, right = CASES[case]
    content = {"columns": {over.partition(" ")[0]: {"printed": 0}}}
    same = dict.fromkeys((*wrong, *right), lambda x: x)
    outcome = compared(file_of(scene, over, same), content, scene).outcome
    assert outcome.agreed
    # To half of the last digit and hardly more: our own bounds are far below it.
    for row in outcome.rows:
        if row.unit in ("mm", "rad", "rad/mm"):
            assert degrees_of(row.unit)[0] * row.tolerance == pytest.approx(5e-6, rel=0.1), row.name
    assert {*disagreeing(file_of(scene, over, same | wrong), content, scene)} == {*wrong}
