"""Tables over wheel travel or rack of a car with a fault: the fault is named, and nothing else is."""

from collections.abc import Callable
from typing import Any

import numpy as np
from curve_files import compared
from numpy.typing import NDArray

from pointcoord import Scene, simulate

Array = NDArray[np.float64]
Table = dict[str, Array]
Content = dict[str, Any]

RANGES = {"wheel_travel": (-50.0, 50.0), "rack": (-25.0, 25.0)}
COLUMNS = {"wheel_travel": "travel.wheel_centre", "rack": "input.rack"}
ROWS = 21


def asked(name: str, over: str) -> Scene:
    """A built-in car that stands as drawn but for what goes from end to end."""
    scene = Scene.load(name)
    content = scene.model_dump(exclude_none=True)
    steered = "rack" in scene.inputs
    content["inputs"] = {"wheel_travel": {"constant": 0.0}} | ({"rack": {"constant": 0.0}} if steered else {})
    content["inputs"][over] = {"sweep": list(RANGES[over])}
    content["time"] = {"start": 0.0, "stop": 1.0, "samples": ROWS}
    angles = ("wheel_angles", "toe", "caster")
    content["effects"] = [n for n in angles if n in scene.mechanism.effects] or ["camber", "toe"]
    return Scene.from_mapping(content, name)


def moved(scene: Scene, **coordinates: float) -> Scene:
    """The same car, drawn with some coordinates (point__axis) so much more."""
    content = scene.model_dump(exclude_none=True)
    points = {name: list(place) for name, place in content["mechanism"]["points"].items()}
    for name, amount in coordinates.items():
        point, _, axis = name.rpartition("__")
        points[point]["xyz".index(axis)] += amount
        if point == "tie_rod_inner":  # the rack is drawn where its end is
            points["rack_centre"]["xyz".index(axis)] += amount
    content["mechanism"]["points"] = points
    return Scene.from_mapping(content, "moved")


def explained(
    scene: Scene, solved: Scene, over: str, digits: int, change: Callable[[Table], Table]
) -> list[str]:
    """What explains the table of a solved car, of so many decimals, beside the scene's."""
    wheel = simulate(solved).numbers["wheel"]
    table = change({over: np.linspace(*RANGES[over], ROWS), **{n: np.degrees(a) for n, a in wheel.items()}})
    lines = [",".join(table)]
    for row in zip(*table.values(), strict=True):
        lines.append(",".join(f"{v:.1f}" if i == 0 else f"{v:.{digits}f}" for i, v in enumerate(row)))
    columns: Content = {n: {"is": f"wheel.{n}", "unit": "deg"} for n in wheel}
    columns[over] = {"is": COLUMNS[over], "unit": "mm"}
    found = compared("\n".join(lines), {"columns": columns}, scene).outcome
    assert not found.agreed
    return [one.words for one in found.explanations]


def toe_out(table: Table) -> Table:
    return table | {"toe": -table["toe"]}


def shuffled(table: Table) -> Table:
    order = np.random.default_rng(2).permutation(ROWS)
    return {name: values[order] for name, values in table.items()}


def test_a_misread_hardpoint_is_named_though_one_number_has_a_fault_of_its_own() -> None:
    """Over rows in any order."""
    scene = asked("bmw-e90-strut", "wheel_travel")
    moved_too = moved(scene, strut_top__x=6.0)
    hardpoint, sign = explained(scene, moved_too, "wheel_travel", 4, lambda table: shuffled(toe_out(table)))
    assert "strut_top.x drawn 6 mm too far back" in hardpoint
    assert sign == "toe: the other sign"


def test_a_fault_of_the_numbers_alone_is_named() -> None:
    scene = asked("double-wishbone", "wheel_travel")
    found = explained(scene, scene, "wheel_travel", 4, lambda t: t | {"toe": t["toe"] + 0.3})
    assert found == ["toe: a constant offset of 0.005236 rad"]


def test_noise_on_one_number_has_no_explanation() -> None:
    scene = asked("double-wishbone", "wheel_travel")
    noise = 1e-2 * np.random.default_rng(1).standard_normal(ROWS)
    assert explained(scene, scene, "wheel_travel", 4, lambda t: t | {"toe": t["toe"] + noise}) == []
