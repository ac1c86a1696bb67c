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


def vehicle(folder: Path, axles: Mapping[str, list[float]] = AHEAD, **changes: Any) -> Path:
    """Chrono's folder of data with a vehicle in it: a double wishbone ahead, a strut behind."""
    front = chrono("double_wishbone", WISHBONE.mechanism.points, 1)
    files = {
        "suspension/front.json": front.replace("DoubleWishbone", "DoubleWishboneReduced"),
        "suspension/rear.json": chrono("macpherson", STRUT.mechanism.points, -1, "-1.5", "0.25"),
        "steering.json": json.dumps({"Type": "Steering"}),
    }
    parts = [
        {"Suspension Input File": f"own/suspension/{name.rstrip('2')}.json", "Suspension Location": place}
        for name, place in axles.items()
    ]
    car = {"Type": "Vehicle", "Template": "WheeledVehicle", "Axles": parts} | changes
    for name, text in (files | {"vehicle/car.json": json.dumps(car)}).items():
        path = folder / "own" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return path


def test_an_imported_axle_agrees_in_all_models_and_says_where_its_points_are_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, target = vehicle(tmp_path), tmp_path / "car.toml"
    with pytest.raises(
        FileError, match=r"front .DoubleWishboneReduced., rear .MacPhersonStrut.; allowed: --part"
    ):
        import_hardpoints(path)
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
def test_a_broken_vehicle_is_refused(change: Mapping[str, Any], words: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match=words):
        import_hardpoints(vehicle(tmp_path, **change), part="front")
