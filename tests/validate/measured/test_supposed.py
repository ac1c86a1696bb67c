"""A file whose independent column is meant otherwise than it is said: that is what explains it, first."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from curve_files import compared, table
from numpy.typing import NDArray

from pointcoord import Scene, simulate, solve_poses

Array = NDArray[np.float64]
CAR = Scene.load("double-wishbone")
PLACES = CAR.mechanism.points


def drawn_angle() -> float:
    front, ball = (np.array(PLACES[name]) for name in ("lower_arm_front", "lower_ball_joint"))
    return float(np.arccos((ball - front) @ np.array(CAR.mechanism.up) / np.linalg.norm(ball - front)))


def at(angle: Array, rack: Array) -> dict[str, Array]:
    """Places and angles by hand, deg and mm, where the arm and the rack are so."""
    place = solve_poses(CAR, {"arm_angle": angle, "rack": rack}).position
    x, y, z = (place["wheel_centre"] - place["wheel_axis_inner"]).T
    numbers = {"camber [deg]": -np.degrees(np.arctan2(z, y)), "toe [deg]": -np.degrees(np.arctan2(x, y))}
    rise = place["wheel_centre"][:, 2] - PLACES["wheel_centre"][2]
    return numbers | {"position.wheel_centre.x [mm]": place["wheel_centre"][:, 0], "rise": rise}


def printed(over: dict[str, Array], numbers: dict[str, Array]) -> tuple[str, dict[str, Any]]:
    """A file and its map: numbers of five decimals, over columns that are exact as written."""
    columns = {**over, **numbers}
    lines = [",".join(columns)]
    for row in zip(*columns.values(), strict=True):
        lines.append(",".join(f"{v:.10f}" if i < len(over) else f"{v:.5f}" for i, v in enumerate(row)))
    digits = {name: 0.0 if name in over else 1e-5 for name in columns}
    parts: dict[str, Any] = {n.partition(" ")[0]: {"printed": last} for n, last in digits.items()}
    return "\n".join(lines), {"columns": parts}


RACKS = np.linspace(-40.0, 43.7, 18)
TURNS = drawn_angle() + np.linspace(-0.12, 0.1, 18)
HOME = drawn_angle()


@pytest.mark.parametrize(
    ("head", "change", "words"),
    [
        ("rack [mm]", lambda s: -s / 25.4, "rack is in in, not in mm, and has the other sign"),
        (
            "rack [mm]",
            lambda s: 4.0 - s,
            "rack has the other sign, and counts from another zero: +4 mm make ours",
        ),
    ],
)
def test_a_rack_that_is_meant_otherwise_is_told_first(
    head: str, change: Callable[[Array], Array], words: str
) -> None:
    numbers = at(np.full_like(RACKS, HOME), RACKS)
    del numbers["rise"]
    found = compared(*printed({head: change(RACKS)}, numbers), CAR)
    first = found.outcome.explanations[0]
    assert (first.words, first.kind) == (words, "input")
    assert first.leftover <= 1.0


@pytest.mark.parametrize(
    ("head", "change", "words"),
    [
        (
            "arm_angle [rad]",
            lambda a: np.pi - a,
            "arm_angle has the other sign, and counts from another zero: +180 deg make ours",
        ),
        (
            "arm_angle [rad]",
            lambda a: a - HOME + 1.2,
            "arm_angle counts from another zero: +17.77 deg make ours",
        ),
    ],
)
def test_an_angle_that_is_meant_otherwise_is_told_first(
    head: str, change: Callable[[Array], Array], words: str
) -> None:
    numbers = at(TURNS, np.zeros_like(TURNS))
    del numbers["rise"]
    found = compared(*printed({head: change(TURNS)}, numbers), CAR)
    assert found.outcome.explanations[0].words == words


def test_another_fault_is_no_other_zero() -> None:
    numbers = at(np.full_like(RACKS, HOME), RACKS)
    del numbers["rise"]
    numbers["toe [deg]"] = -numbers["toe [deg]"]
    found = compared(*printed({"rack [mm]": RACKS}, numbers), CAR)
    assert found.outcome.explanations[0].words == "toe: the other sign"
    assert not [one for one in found.outcome.explanations if one.kind == "input"]


def test_a_rack_of_the_other_sign_is_told_where_some_angles_hardly_change() -> None:
    """Four decimals say little of where a row's caster is."""
    racks = np.linspace(-20.0, 20.0, 21)
    content = CAR.model_dump(exclude_none=True)
    content["inputs"] = {"wheel_travel": {"constant": 0.0}, "rack": {"sweep": [-20.0, 20.0]}}
    content["time"] = {"start": 0.0, "stop": 1.0, "samples": len(racks)}
    content["effects"] = ["wheel_angles", "toe", "caster"]
    scene = Scene.from_mapping(content, "steered")
    angles = {f"wheel.{n} [deg]": np.degrees(a) for n, a in simulate(scene).numbers["wheel"].items()}
    found = compared(table({"input.rack [mm]": -racks, **angles}, 4), {}, scene)
    assert [one.words for one in found.outcome.explanations] == ["input.rack has the other sign"]


def test_a_long_name_of_a_column_that_is_ignored_is_shortened() -> None:
    numbers = {**at(TURNS, np.zeros_like(TURNS)), "w" * 10_000: TURNS}
    del numbers["rise"]
    file, said = printed({"arm_angle [rad]": TURNS}, numbers)
    del said["columns"]["w" * 10_000]
    found = compared(file, said, CAR)
    assert found.outcome.agreed
    assert max(map(len, found.outcome.notes)) < 200
