"""Which few hardpoints explain a file, and which the file cannot tell apart."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from curve_files import measured, wheel_curves
from program import document

from pointcoord import Scene, designs_of
from validate.cli import main
from validate.fitting.fit import explains
from validate.fitting.problem import Problem
from validate.fitting.report import report_of_suspects, verdict
from validate.fitting.suspects import Suspects, suspected

# Arm angles (rad) and rack travels (mm) that the curves are over.
CARS = {"double-wishbone": ((1.40, 1.66), (0.0, 10.0)), "off-axis-strut": ((1.53, 1.73), (0.0, 10.0))}
ROWS = 12


def curves(name: str, offsets: Mapping[str, float], turned: float = 0.0) -> str:
    """Those of a car with its points moved; toe turned by an angle that no car has."""
    moved = designs_of(Scene.load(name), offsets=offsets).design(0)
    return wheel_curves(moved, *CARS[name], ROWS, toe=turned * (-1.0) ** np.arange(ROWS))


def found_in(name: str, text: str, among: Sequence[str] = ()) -> Suspects:
    car = Scene.load(name)
    return suspected(Problem.of(car, measured(text, car), among))


@pytest.mark.parametrize(
    ("name", "offsets", "among"),
    [
        ("double-wishbone", {"upper_ball_joint.y": 5.0}, ()),
        (
            "off-axis-strut",
            {"lower_ball_joint.z": -4.0},
            ("lower_ball_joint", "tie_rod_inner", "tie_rod_outer"),
        ),
        (
            "double-wishbone",
            {"upper_ball_joint.y": 3.0, "tie_rod_inner.z": -2.0},
            ("tie_rod_inner", "upper_ball_joint"),
        ),
        ("off-axis-strut", {"tie_rod_inner.z": 3.0, "strut_top.y": -4.0}, ("strut_top", "tie_rod_inner")),
    ],
)
def test_planted_faults_of_one_and_of_two_coordinates_are_found(
    name: str, offsets: Mapping[str, float], among: Sequence[str]
) -> None:
    found = found_in(name, curves(name, offsets), among)
    assert len(found.tried) == len(offsets)
    (fit,) = (one for one in found.equal if one.coordinates.keys() == offsets.keys())
    for at, right in offsets.items():
        # Digits are spread evenly: their sums are within four deviations but for one in 10^4.
        assert abs(fit.coordinates[at].correction - right) < 4.0 * fit.coordinates[at].deviation, at


def test_two_ends_of_the_spin_axis_explain_angles_equally_well() -> None:
    """An axis turns the same if its one end is raised or its other is lowered by as much."""
    name = "double-wishbone"
    found = found_in(name, curves(name, {"wheel_centre.z": 2.0}))
    moved = {at: one.correction for fit in found.equal for at, one in fit.coordinates.items()}
    assert {"wheel_centre.z", "wheel_axis_inner.z"} <= moved.keys()
    assert moved["wheel_centre.z"] == pytest.approx(-moved["wheel_axis_inner.z"], abs=1e-4)
    # They are named by their ranks: the first ones.
    assert all(one is other for one, other in zip(found.equal, found.explaining, strict=False))
    assert f" {len(found.equal)} explain it equally well" in verdict(found)


def test_what_no_hardpoints_explain_is_said_with_the_nearest_and_a_right_car_has_no_suspects() -> None:
    name, among = "double-wishbone", ("upper_ball_joint.y", "upper_ball_joint.z", "tie_rod_outer.z")
    found = found_in(name, curves(name, {}, turned=0.02), among)
    assert not found.explaining
    assert [one[1] for one in found.tried] == [3, 3, 1]
    assert [one.left for one in found.nearest] == sorted(one.left for one in found.nearest)
    assert verdict(found).startswith("No set explains the file; nearest is ")
    right = found_in(name, curves(name, {}))
    assert right.drawn
    assert not right.tried
    assert "no hardpoint is suspect" in report_of_suspects(right, "car", "x.csv").text


def test_rounding_leaves_as_much_as_explains_but_for_one_file_in_a_thousand() -> None:
    random = np.random.default_rng(3).uniform(-np.sqrt(3.0), np.sqrt(3.0), (4000, 20))
    assert np.mean([explains(one, 20) for one in random]) > 0.999
    assert not explains(np.full(20, 2.5), 20)
    assert not explains(np.array([3.6, *19 * [0.1]]), 20)
    assert not explains(np.zeros(1), 0)


def test_the_command_says_writes_and_corrects_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, said, rows = (str(tmp_path / name) for name in ("x.csv", "x.json", "y.csv"))
    Path(data).write_text(curves("double-wishbone", {"upper_ball_joint.y": 3.0}))
    words = ["--data", data, "--suspects", "--free", "upper_ball_joint", "tie_rod_outer.z"]
    assert main(["fit", "double-wishbone", *words, "--json", said, "--csv", rows]) == 0
    shown = capsys.readouterr().out
    assert "a diagnosis: nothing is corrected" in shown
    assert f"--data {data} --free upper_ball_joint.y -o corrected.toml" in shown
    (first,) = document(Path(said))["explaining"]
    assert [one["coordinate"] for one in first["coordinates"]] == ["upper_ball_joint.y"]
    with Path(rows).open() as file:
        row = next(csv.DictReader(file))
    assert (row["coordinate"], row["explains"]) == ("upper_ball_joint.y", "true")
