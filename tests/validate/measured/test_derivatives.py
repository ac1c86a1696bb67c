"""Derivatives by the independent column, and rates over inputs and travels by the inputs' own rates."""

from typing import Any

import numpy as np
import pytest
from curve_files import compared, disagreeing, verdicts
from lotus_front import ROLLING_RADIUS
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from pointcoord import Motion, Scene, simulate
from validate.measured.mapping import understood
from validate.measured.reading import columns_of_text
from validate.tables.errors import FileError

Array = NDArray[np.float64]
CAR = Scene.load("double-wishbone")
UP = np.array(CAR.mechanism.up)


def moved(**laws: list[float]) -> Motion:
    """The car by polynomials of time in its inputs, from 0 to 1 s."""
    content = CAR.model_dump(exclude_none=True)
    content["inputs"] = {name: {"polynomial": law} for name, law in laws.items()}
    content["time"] = {"start": 0.0, "stop": 1.0, "samples": 21}
    content["effects"] = ["velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe"]
    return simulate(Scene.from_mapping(content, "moved"))


BUMP = moved(arm_angle=[1.8, -0.4, 0.11], rack=[0.0])
BOTH = moved(arm_angle=[1.8, -0.4, 0.11], rack=[-20.0, 35.0, 9.0])


def rise(motion: Motion, order: int = 0) -> Array:
    quantity = ("position", "velocity", "acceleration")[order]
    height = motion.numbers[quantity]["wheel_centre"] @ UP
    return height - CAR.mechanism.points["wheel_centre"] @ UP if order == 0 else height


def text(**columns: Array) -> str:
    lines = [",".join(columns)]
    lines += [",".join(repr(float(value)) for value in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join(lines)


def angle_rate(motion: Motion, name: str) -> Array:
    """Of an angle of the wheel, rad/s: by how it changes in 2 microseconds."""
    h = 1e-6
    inner = motion.times[1:-1]
    after, before = motion.at(inner + h), motion.at(inner - h)
    return np.asarray((after.wheel[name] - before.wheel[name]) / (2.0 * h))


@pytest.mark.parametrize(
    ("name", "unit", "factor"),
    [
        ("toe", "deg/mm", 1.0),
        ("dtoe/dbump", "rad/in", 25.4 * np.pi / 180.0),
    ],
)
def test_a_gradient_by_any_name_and_unit_is_how_toe_changes_with_travel(
    name: str, unit: str, factor: float
) -> None:
    # Another way to it: by time, both as the motion has them.
    slope = factor * np.degrees(angle_rate(BUMP, "toe") / rise(BUMP, 1)[1:-1])
    map = {"columns": {"bump": {"is": "travel.wheel_centre"}, name: {"accuracy": factor * 2e-7}}}
    table = text(**{"bump [mm]": rise(BUMP)[1:-1], f"{name} [{unit}]": slope})
    (row,) = compared(table, map, CAR).outcome.rows
    assert (row.name, row.unit, row.verdict) == ("toe per travel.wheel_centre", "rad/mm", "agrees")
    # What the file states, and little of ours.
    assert 2e-7 <= np.degrees(row.tolerance) < 2.2e-7
    slope[7] += factor * 3e-6
    table = text(**{"bump [mm]": rise(BUMP)[1:-1], f"{name} [{unit}]": slope})
    assert disagreeing(table, map, CAR) == ["d(wheel.toe)/d(travel.wheel_centre)"]
    slope[7] -= factor * 3e-6
    # The same of a travel that counts downward: the gradient is by that.
    down = text(**{"bump [mm]": -rise(BUMP)[1:-1], f"{name} [{unit}]": -slope})
    map["columns"]["bump"] |= {"sign": -1}
    assert disagreeing(down, map, CAR) == []


def test_gradients_by_the_contacts_travel_are_those_of_its_lowest_point() -> None:
    spin = BUMP.position["wheel_centre"] - BUMP.position["wheel_axis_inner"]
    lean = (spin @ UP) / np.linalg.norm(spin, axis=-1)
    height = BUMP.position["wheel_centre"] @ UP - ROLLING_RADIUS * np.sqrt(1.0 - lean**2)
    place = CAR.mechanism.points
    spin0 = np.subtract(place["wheel_centre"], place["wheel_axis_inner"])
    lean0 = spin0 @ UP / np.linalg.norm(spin0)
    drawn = place["wheel_centre"] @ UP - ROLLING_RADIUS * np.sqrt(1.0 - lean0**2)
    # By the slopes of splines through 21 points, as a spreadsheet's user would have it.
    order = np.argsort(height)
    slope = CubicSpline(height[order], BUMP.wheel["camber"][order])(height, 1)[2:-2]
    table = text(**{"bump [mm]": (height - drawn)[2:-2], "camber [deg/mm]": np.degrees(slope)})
    bump = {"is": "travel.contact"}
    map = {"rolling_radius": ROLLING_RADIUS, "columns": {"bump": bump, "camber": {"accuracy": 2e-6}}}
    assert disagreeing(table, map, CAR) == []
    bump["is"] = "travel.wheel_centre"
    assert disagreeing(table, map, CAR) == ["d(wheel.camber)/d(travel.wheel_centre)"]


def test_points_by_an_input_and_both_by_a_map_of_two() -> None:
    inputs = {"arm_angle [rad]": 1.8 - 0.4 * BOTH.times + 0.11 * BOTH.times**2}
    inputs["rack [mm]"] = -20.0 + 35.0 * BOTH.times + 9.0 * BOTH.times**2
    columns: dict[str, Array] = {}
    for name, unit, step in (("rack", "mm", 1e-3), ("arm_angle", "rad", 1e-5)):
        changes = []
        for a, s in zip(*(values[::5].tolist() for values in inputs.values()), strict=True):
            law = {"arm_angle": [a], "rack": [s]}
            law[name] = [law[name][0] - step, 2.0 * step]
            x = moved(**law).position["wheel_centre"][:, 0]
            changes.append((x[-1] - x[0]) / (2.0 * step))
        columns[f"d(position.wheel_centre.x)/d({name}) [mm/{unit}]"] = np.array(changes)
    table = text(**{n: v[::5] for n, v in inputs.items()}, **columns)
    found = compared(table, {}, CAR, accuracy=1e-5)
    assert verdicts(found) == {
        "wheel_centre per input.rack": "agrees",
        "wheel_centre per input.arm_angle": "agrees",
    }


def rates_of(motion: Motion) -> dict[str, Array]:
    """All rates of the wheel's centre and of the knuckle, as a file has them."""
    columns = {}
    for quantity, name, unit in (
        ("velocity", "wheel_centre", "mm/s"),
        ("acceleration", "wheel_centre", "mm/s^2"),
        ("angular_velocity", "knuckle", "rad/s"),
        ("angular_acceleration", "knuckle", "rad/s^2"),
    ):
        for i, axis in enumerate("xyz"):
            columns[f"{quantity}.{name}.{axis} [{unit}]"] = motion.numbers[quantity][name][:, i]
    return columns


def over_travel(*left_out: str) -> tuple[str, dict[str, Any]]:
    """Rates of a bump, over its travel with the rates of that."""
    columns = {"bump [mm]": rise(BUMP), "v [mm/s]": rise(BUMP, 1), "a [mm/s^2]": rise(BUMP, 2)}
    named = {
        "bump": "travel.wheel_centre",
        "v": "travel.wheel_centre.rate",
        "a": "wheel_centre.acceleration",
    }
    named["a"] = f"travel.{named['a']}"
    kept = {
        n: values for n, values in (columns | rates_of(BUMP)).items() if n.partition(" ")[0] not in left_out
    }
    return text(**kept), {"columns": {n: {"is": word} for n, word in named.items() if n not in left_out}}


def test_rates_over_travel_are_held_to_those_of_the_same_motion() -> None:
    table, map = over_travel()
    found = compared(table, map, CAR)
    assert len(found.outcome.rows) == 4
    assert {row.verdict for row in found.outcome.rows} == {"agrees"}
    # Points to 1e-9 mm, as which digits in full are taken: what that makes of some 200 mm/s.
    assert max(row.tolerance for row in found.outcome.rows if row.unit == "mm/s") < 1e-6
    lines = table.splitlines()
    column = lines[0].split(",").index("acceleration.wheel_centre.z [mm/s^2]")
    cells = lines[4].split(",")
    cells[column] = repr(float(cells[column]) * (1.0 + 1e-6))
    spoiled = "\n".join([*lines[:4], ",".join(cells), *lines[5:]])
    assert disagreeing(spoiled, map, CAR) == ["acceleration.wheel_centre.z"]


def test_rates_over_two_inputs_are_held_to_those_of_the_same_motion() -> None:
    t = BOTH.times
    columns = {
        "arm_angle [rad]": 1.8 - 0.4 * t + 0.11 * t**2,
        "rack [mm]": -20.0 + 35.0 * t + 9.0 * t**2,
        "arm_angle.rate [rad/s]": -0.4 + 0.22 * t,
        "rack.rate [m/s]": 0.035 + 0.018 * t,
        "input.arm_angle.acceleration [rad/s^2]": np.full_like(t, 0.22),
        "input.rack.acceleration [mm/s^2]": np.full_like(t, 18.0),
    }
    found = compared(text(**columns, **rates_of(BOTH)), {}, CAR)
    assert [row.verdict for row in found.outcome.rows] == ["agrees"] * 4
    # As if the rack stood still.
    columns["rack.rate [m/s]"] = np.zeros_like(t)
    wrong = disagreeing(text(**columns, **rates_of(BOTH)), {}, CAR)
    assert {words.partition(".")[0] for words in wrong} == {row.quantity for row in found.outcome.rows}


def test_rates_that_do_not_follow_say_which_column_they_lack() -> None:
    found = compared(*over_travel("v"), CAR)
    rows = {row.quantity: row for row in found.outcome.rows}
    assert rows["velocity"].verdict == rows["acceleration"].verdict == "not tested"
    why = "rates need a column of time, or travel.wheel_centre.rate: a column, or held by a map"
    assert rows["velocity"].why == why
    assert any(note.endswith(f"is not tested: {why}") for note in found.outcome.notes)
    found = compared(*over_travel("a"), CAR)
    verdict = {row.quantity: row.verdict for row in found.outcome.rows}
    assert (verdict["velocity"], verdict["acceleration"]) == ("agrees", "not tested")
    assert verdict["angular_acceleration"] == "not tested"


def test_a_rate_that_every_row_has_is_held_by_the_map() -> None:
    motion = moved(arm_angle=[1.8, -0.4], rack=[0.0])
    columns = {"arm_angle [rad]": 1.8 - 0.4 * motion.times, **rates_of(motion)}
    held = {"arm_angle.rate": -0.4, "input.arm_angle.acceleration": 0.0}
    with pytest.raises(FileError, match=r"no input or travel is called 'arm_angle\.rate'"):
        compared(text(**columns), {"held": held}, CAR)
    held["input.arm_angle.rate"] = held.pop("arm_angle.rate")
    assert {row.verdict for row in compared(text(**columns), {"held": held}, CAR).outcome.rows} == {"agrees"}
    held["input.arm_angle.rate"] = 0.4
    assert "velocity.wheel_centre.z" in disagreeing(text(**columns), {"held": held}, CAR)


def test_of_two_columns_that_a_gradient_may_be_by_its_name_says_which() -> None:
    table = "bump [mm],rack [mm],{} [deg/mm]\n0,0,0.01\n10,1,0.02\n"
    bump = {"bump": {"is": "travel.wheel_centre"}}
    with pytest.raises(FileError, match="may be by bump or by rack") as caught:
        compared(table.format("toe"), {"columns": {**bump, "rack": {}, "toe": {}}}, CAR)
    assert 'is = "d(wheel.toe)/d(bump)" in a map' in str(caught.value)
    named = {"columns": {**bump, "rack": {}, "toe": {"is": "d(wheel.toe)/d(bump)"}}}
    (toe,) = understood(columns_of_text(table.format("toe"), "mine.csv"), named, CAR, "map.toml").numbers
    assert toe.meaning.per == "travel.wheel_centre"
