"""`pointcoord table` and `pointcoord sensitivity` print what the solved cars have."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from changed_scenes import scene_with
from every_number import loaded

from pointcoord import Scene, sensitivity, simulate
from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import EFFECTS
from pointcoord.scene.mechanism_part import MechanismPart
from validate.cli import main
from validate.curves.numbers import numbers_of


def rows_of(target: Path, words: str, status: int = 0) -> list[dict[str, str]]:
    """The rows of the table that a command writes."""
    assert main([*words.split(), "-o", str(target), "-q"]) == status
    with target.open(encoding="utf-8", newline="") as stream:
        return [*csv.DictReader(stream)]


def test_a_grid_has_each_cell_and_says_why_one_is_out_of_reach(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = "table wheel-travel --grid wheel_travel=-50:50:3 --grid rack=-30,500 --number toe"
    rows = rows_of(tmp_path / "grid.csv", f"{words} --number toe_by_travel", 3)
    said = "3 of 6 poses are out of reach, the first in row 2: the mechanism cannot be assembled"
    assert said in capsys.readouterr().err
    assert [float(row["wheel_travel [mm]"]) for row in rows] == [-50.0, -50.0, 0.0, 0.0, 50.0, 50.0]
    inputs = {"wheel_travel": {"sweep": [-50.0, 50.0]}, "rack": {"constant": -30.0}}
    effects = ("toe", "toe_by_travel")
    motion = simulate(scene_with("wheel-travel", laws=inputs, samples=3, effects=effects))
    gains = motion.angle_gradient["toe_by_travel"]
    for row, toe, gain in zip(rows[::2], motion.wheel["toe"], gains, strict=True):
        assert row["why there is none"] == ""
        # Two ways to one pose, each within 1e-13 mm of it; a line of 60 mm.
        assert abs(float(row["toe [deg]"]) - math.degrees(toe)) <= 1e-12
        assert abs(float(row["toe_by_travel [deg/mm]"]) - math.degrees(gain)) <= 1e-13
    for row in rows[1::2]:
        assert math.isnan(float(row["toe [deg]"] or "nan"))
        assert "assembly stopped at rack = " in row["why there is none"]


def test_a_car_is_asked_once_for_each_effect_however_many_numbers_it_has(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, asked, refusal = Scene.load("axle-roll"), list[str](), MechanismPart.refusal

    def counted(part: MechanismPart, effect: Effect) -> str:
        asked.append(effect.name)
        return refusal(part, effect)

    monkeypatch.setattr(MechanismPart, "refusal", counted)
    assert len(numbers_of(scene)) > len(EFFECTS)
    assert len(asked) == len(set(asked))


def test_hardpoints_are_ranked_by_the_first_number_and_their_tolerances_spread(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = "sensitivity five-link --number toe --tolerance 0.5"
    rows = rows_of(tmp_path / "toe.csv", words)
    found = [float(row["toe [deg/mm]"]) for row in rows]
    assert np.abs(found).tolist() == sorted(np.abs(found), reverse=True)
    own = sensitivity(scene_with("five-link", samples=11, effects=("toe",)))
    best = np.argmax(np.abs(own.largest("toe")))
    assert rows[0]["hardpoint"] == own.coordinates[best]
    assert found[0] == pytest.approx(math.degrees(own.largest("toe")[best]), rel=1e-12)
    assert main([*words.split(), "-o", str(tmp_path / "toe.svg")]) == 0
    assert "<svg" in (tmp_path / "toe.svg").read_text(encoding="utf-8")
    capsys.readouterr()
    assert main(words.split()) == 0
    (line,) = (one for one in capsys.readouterr().out.splitlines() if one.startswith("toe [deg] "))
    linear, drawn, worst = map(float, line.split()[2:])
    # The standard deviation of a sample of 400 is known to 1 / sqrt(800), here to three times that; what is
    # not linear in half a millimetre is less.
    assert abs(drawn / linear - 1.0) <= 3.0 / math.sqrt(800.0)
    assert linear < worst


def test_a_rod_that_is_called_as_an_angle_is_does_not_stand_for_it(tmp_path: Path) -> None:
    """The five-link's toe link has a force, and is called toe."""
    rows = rows_of(tmp_path / "car.csv", "table five-link --rows 5")
    scene = scene_with("five-link", samples=5, effects=("toe",))
    found = [float(row["toe [deg]"]) for row in rows]
    np.testing.assert_allclose(found, np.degrees(simulate(scene).wheel["toe"]), rtol=0, atol=1e-12)
    part = {"loads": {"force": (0.0, 0.0, 3000.0)}, "wheel_radius": 300.0}
    both = scene_with("five-link", part, samples=5, effects=("toe", "loads"))
    beside = sensitivity(both, ["toe", "rod_force.toe"], ["toe_inner.z"]).derivatives
    alone = sensitivity(scene, ["toe"], ["toe_inner.z"]).derivatives
    np.testing.assert_allclose(beside["toe"], alone["toe"], rtol=0, atol=1e-12)
    assert np.abs(beside["rod_force.toe"]).max() > 0.0


@pytest.mark.parametrize("grid", ["", "--grid wheel_travel=-50:50:3 --grid rack=5"])
def test_forces_that_a_scene_asks_for_stand_in_its_tables(grid: str, tmp_path: Path) -> None:
    inputs = {"wheel_travel": {"sweep": [-50.0, 50.0]}, "rack": {"constant": 5.0}}
    scene = tmp_path / "car.toml"
    scene.write_text(loaded("off-axis-strut", 3, ["camber", "loads"], inputs=inputs), encoding="utf-8")
    motion = simulate(str(scene))
    forces = {f"rod_force.{name} [N]": of for name, of in motion.rod_force.items()}
    for point, of in motion.joint_force.items():
        forces |= {f"joint_force.{point}.{axis} [N]": of[:, i] for i, axis in enumerate("xyz")}
    assert {"rod_force.damper [N]", "joint_force.strut_top.x [N]"} <= {*forces}
    rows = rows_of(tmp_path / "table.csv", f"table {scene} {grid}")
    for head, of in forces.items():
        # A grid's poses are solved from the drawing, not along the motion.
        assert [float(row[head]) for row in rows] == pytest.approx(of, rel=1e-9, abs=1e-7), head


@pytest.mark.parametrize(
    ("name", "convention", "said"),
    [
        # An input and a number of one name; a screw axis, whose pitch is in mm/deg; forces at joints.
        ("pushrod-by-damper", "iso", "94 numbers compared: 94 agree."),
        # Wheels that are not steered to the same side have no turning circle.
        ("axle-opposed", "iso", "165 numbers compared: 165 agree."),
        # The scene holds the arm elsewhere than drawn.
        ("steer", "paper", "arm_angle is held at 1.5708 rad: as in the scene"),
    ],
)
def test_a_table_of_all_that_a_car_has_agrees_with_the_car(
    name: str, convention: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, table = tmp_path / "car.toml", tmp_path / "table.csv"
    scene.write_text(loaded(name, 4, convention=convention), encoding="utf-8")
    assert main(["table", str(scene), "--all", "-o", str(table)]) == 0
    capsys.readouterr()
    assert main(["validate", str(scene), "--data", str(table)]) == 0
    out, err = capsys.readouterr()
    assert said in out
    assert [word for word in ("not tested", "ignored", "Warning") if word in out + err] == []
