"""A vehicle of Chrono becomes the car that its files make together, axle by axle."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign_files import STRUT, WISHBONE, chrono, drawn

from validate.cli import main
from validate.hardpoint_files.importing import import_hardpoints
from validate.tables.errors import FileError

AHEAD = {"front": [1.5, 0, 0.25], "rear": [-1.25, 0, 0.125]}
POINTS = WISHBONE.mechanism.points


def vehicle(
    folder: Path,
    rear: str | None = None,
    axles: Mapping[str, list[float]] = AHEAD,
    **changes: Any,
) -> Path:
    """Chrono's folder of data with a vehicle in it: a double wishbone ahead, a strut behind."""
    texts = {
        "front": chrono("double_wishbone", POINTS, 1),
        "rear": chrono("macpherson", STRUT.mechanism.points, -1, "-1.5", "0.25"),
    }
    if rear is not None:
        texts["rear"] = texts["rear"].replace("MacPhersonStrut", rear)
    whole = {
        "Type": "Vehicle",
        "Template": "WheeledVehicle",
        "Axles": [
            {"Suspension Input File": f"own/suspension/{name.rstrip('2')}.json", "Suspension Location": place}
            for name, place in axles.items()
        ],
    } | changes
    (folder / "own" / "suspension").mkdir(parents=True)
    (folder / "own" / "vehicle").mkdir()
    for name, text in texts.items():
        (folder / "own" / "suspension" / f"{name}.json").write_text(text)
    (folder / "own" / "steering.json").write_text(json.dumps({"Type": "Steering"}))
    path = folder / "own" / "vehicle" / "car.json"
    path.write_text(json.dumps(whole, indent=1))
    return path


def test_an_imported_axle_agrees_in_all_models_and_says_where_its_points_are_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, target = vehicle(tmp_path), tmp_path / "car.toml"
    assert main(["import", str(path), "-o", str(target)]) == 2
    asked = capsys.readouterr().err
    assert "front (DoubleWishbone), rear (MacPhersonStrut); allowed: --part front or --part rear" in asked
    assert main(["import", str(path), "--part", "rear", "-o", str(target)]) == 0
    told = capsys.readouterr().out
    assert str(tmp_path / "own" / "suspension" / "rear.json") in told
    assert "a straight rack across the car" in told
    assert main(["validate", str(target)]) == 0


def test_axles_are_front_and_rear_by_where_they_are_and_numbers_if_there_are_more(tmp_path: Path) -> None:
    turned = vehicle(tmp_path / "a", axles={"rear": AHEAD["rear"], "front": AHEAD["front"]})
    assert import_hardpoints(turned, part="rear").scene.mechanism.type == "macpherson"
    more = vehicle(tmp_path / "b", axles=AHEAD | {"rear2": [-2.5, 0, 0.125]})
    with pytest.raises(FileError, match="--part 1 or --part 2 or --part 3"):
        import_hardpoints(more)
    second, third = (drawn(import_hardpoints(more, part=part))["wheel_centre"] for part in "23")
    np.testing.assert_allclose(np.subtract(third, second), [1250, 0, 0], atol=1e-12)


def test_a_template_that_only_contains_a_known_name_is_not_it(tmp_path: Path) -> None:
    path, kind = tmp_path / "car.json", "MyDoubleWishbone"
    path.write_text(chrono("double_wishbone", POINTS, 1).replace("DoubleWishbone", kind))
    with pytest.raises(FileError, match=f"called '{kind}'"):
        import_hardpoints(path)
    path.write_text(chrono("double_wishbone", POINTS, 1).replace("DoubleWishbone", "DoubleWishboneReduced"))
    assert import_hardpoints(path).scene.mechanism.type == "double_wishbone"


def axle(file: str, y: int = 0) -> dict[str, Any]:
    return {"Axles": [{"Suspension Input File": f"own/{file}.json", "Suspension Location": [0, y, 0]}]}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"Axles": []}, "has no Axles"),
        ({"Axles": [{"Suspension Input File": "front.json"}]}, "Location of axle 1' has 'None'"),
        (axle("nothing"), "names 'own/nothing.json', which is in none of the folders above it"),
        (axle("suspension/front", 1), "has y 1, which is not the middle"),
        ({"Template": "TrackedVehicle", "Axles": None}, "Type 'Vehicle' and Template 'TrackedVehicle'"),
    ],
)
def test_a_broken_vehicle_is_told_in_one_line(
    change: Mapping[str, Any], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = vehicle(tmp_path, **change)
    with pytest.raises(FileError, match=words):
        import_hardpoints(path, part="front")
    assert main(["import", str(path), "--part", "front"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
