"""The table that Lotus' program printed, as a file: the first that was ever held to the built-in car."""

import re
from pathlib import Path
from typing import Any

import curve_files
import numpy as np
import pytest
from changed_scenes import scene_with
from curve_files import disagreeing, verdicts
from lotus_front import BUMP, ROLLING_RADIUS

from pointcoord import Scene
from validate.measured.comparing import DataOutcome, compare_results
from validate.measured.mapping import read_results

CAR = Scene.load("double-wishbone")
ANGLES = ("camber", "toe", "caster", "kingpin")
CSV = "bump [mm],camber [deg],toe [deg],caster [deg],kingpin [deg]\n" + "".join(
    f"{bump:.1f}," + ",".join(f"{angle:.4f}" for angle in angles) + "\n" for bump, *angles in BUMP
)
CONTENT: dict[str, Any] = {
    "rolling_radius": ROLLING_RADIUS,
    "columns": {
        "bump": {"is": "travel.contact", "printed": 0},
        **{name: {"is": name} for name in ANGLES},
    },
}


def compared(text: str, content: dict[str, Any] = CONTENT, scene: Scene = CAR) -> DataOutcome:
    return curve_files.compared(text, content, scene)


def test_the_printed_bump_table_agrees_to_its_four_digits_by_the_map_of_the_readme(tmp_path: Path) -> None:
    readme = (Path(__file__).parents[3] / "validate" / "measured" / "README.md").read_text(encoding="utf-8")
    (block,) = (b for b in re.findall(r"```toml\n(.*?)```", readme, flags=re.S) if "travel.contact" in b)
    data, map = tmp_path / "bump.csv", tmp_path / "map.toml"
    data.write_text(CSV)
    map.write_text(block)
    found = compare_results(read_results(str(data), str(map), CAR), CAR, "car")
    assert found.outcome.agreed
    assert verdicts(found) == dict.fromkeys(ANGLES, "agrees")
    for row in found.outcome.rows:
        # Half of the last digit; the rest is rounding in double precision and the map's bound.
        assert np.degrees(row.tolerance) == pytest.approx(0.5e-4, rel=1e-5)


def test_a_column_that_a_map_does_not_name_goes_along_by_its_own_name_or_is_told() -> None:
    content = CONTENT | {"columns": {name: CONTENT["columns"][name] for name in ("bump", "camber")}}
    assert verdicts(compared(CSV, content)) == dict.fromkeys(ANGLES, "agrees")
    # One that says no unit, that is nothing of ours, or what another is said to be, is left out and told.
    text = CSV.replace("kingpin [deg]", "w" * 10_000).replace("toe [deg]", "vorspur [deg]")
    text = text.replace("camber [deg]", "caster_deg", 1).replace("caster [deg]", "camber [deg]")
    found = compared(
        text, CONTENT | {"columns": {"bump": CONTENT["columns"]["bump"], "camber": {"is": "caster"}}}
    )
    assert verdicts(found) == {"caster": "agrees"}
    (note,) = (note for note in found.outcome.notes if note.startswith("ignored"))
    assert "caster_deg, vorspur, www" in note
    assert len(note) < 300


def test_sign_offset_and_unit_of_a_column_are_undone() -> None:
    lines = CSV.replace("camber [deg]", "camber [mrad]").splitlines()
    for i, (_, camber, *_) in enumerate(BUMP):
        cells = lines[i + 1].split(",")
        cells[1] = f"{5.0 - 1000.0 * np.radians(camber):.3f}"
        lines[i + 1] = ",".join(cells)
    camber = {"is": "camber", "sign": -1, "offset": 5.0}
    content = CONTENT | {"columns": {**CONTENT["columns"], "camber": camber}}
    text = "\n".join(lines)
    # The printed degrees are rounded before they are turned into mrad: 0.5e-4 degrees more.
    content["columns"]["camber"]["accuracy"] = 1000.0 * np.radians(0.5e-4)
    assert disagreeing(text, content, CAR) == []
    content["columns"]["camber"]["offset"] = -5.0
    assert disagreeing(text, content, CAR) == ["wheel.camber"]


def test_the_wheel_radius_of_the_scene_is_taken_where_the_map_has_none() -> None:
    for radius, wrong in ((ROLLING_RADIUS, []), (ROLLING_RADIUS + 30.0, ["wheel.camber"])):
        car = scene_with("double-wishbone", {"wheel_radius": radius})
        found = disagreeing(CSV, {"columns": CONTENT["columns"]}, car)
        assert [one for one in found if one == "wheel.camber"] == wrong
        # What the map says goes before it.
        assert disagreeing(CSV, CONTENT, car) == []
