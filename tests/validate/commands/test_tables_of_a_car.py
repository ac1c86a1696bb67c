"""`pointcoord table --grid` and `pointcoord sensitivity` print what the solved cars have."""

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from changed_scenes import content_of, scene_with
from every_number import with_everything

from pointcoord import Scene, sensitivity, simulate
from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import EFFECTS
from pointcoord.scene.mechanism_part import MechanismPart
from validate.cli import main
from validate.curves.numbers import numbers_of
from validate.toml_written import written


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    status = main(words)
    seen = capsys.readouterr()
    return status, seen.out, seen.err


def rows_of(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))


def test_a_grid_has_each_cell_and_says_why_one_is_out_of_reach(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "grid.csv"
    words = "table wheel-travel --grid wheel_travel=-50:50:3 --grid rack=-30,500 --number toe"
    status, _, err = printed(capsys, *words.split(), "--number", "toe_by_travel", "-o", str(path))
    assert status == 3
    assert "3 of 6 poses are out of reach, the first in row 2: the mechanism cannot be assembled" in err
    rows = rows_of(path)
    assert [float(row["wheel_travel [mm]"]) for row in rows] == [-50.0, -50.0, 0.0, 0.0, 50.0, 50.0]
    changes = {
        "inputs": {"wheel_travel": {"sweep": [-50.0, 50.0]}, "rack": {"constant": -30.0}},
        "time": {"start": 0.0, "stop": 1.0, "samples": 3},
        "effects": ("toe", "toe_by_travel"),
    }
    motion = simulate(Scene.load("wheel-travel").model_copy(update=changes))
    reached, gains = rows[::2], motion.angle_gradient["toe_by_travel"]
    assert all(row["why there is none"] == "" for row in reached)
    for row, toe, gain in zip(reached, motion.wheel["toe"], gains, strict=True):
        # Two ways to one pose, each within 1e-13 mm of it; a line of 60 mm.
        assert abs(float(row["toe [deg]"]) - math.degrees(toe)) <= 1e-12
        assert abs(float(row["toe_by_travel [deg/mm]"]) - math.degrees(gain)) <= 1e-13
    for row in rows[1::2]:
        assert math.isnan(float(row["toe [deg]"] or "nan"))
        assert "assembly stopped at rack = " in row["why there is none"]


def test_a_car_is_asked_once_for_each_effect_however_many_numbers_it_has(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, asked = Scene.load("axle-roll"), list[str]()
    refusal = MechanismPart.refusal

    def counted(part: MechanismPart, effect: Effect) -> str:
        asked.append(effect.name)
        return refusal(part, effect)

    monkeypatch.setattr(MechanismPart, "refusal", counted)
    assert len(numbers_of(scene)) > len(EFFECTS)
    assert len(asked) == len(set(asked))


def test_hardpoints_are_ranked_by_the_first_number_and_their_tolerances_spread(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "toe.csv"
    words = ("sensitivity", "five-link", "--number", "toe", "--tolerance", "0.5")
    assert printed(capsys, *words, "-o", str(path))[0] == 0
    rows = rows_of(path)
    found = [abs(float(row["toe [deg/mm]"])) for row in rows]
    assert found == sorted(found, reverse=True)
    scene = Scene.load("five-link")
    time = {"start": scene.time.start, "stop": scene.time.stop, "samples": 11}
    own = sensitivity(scene.model_copy(update={"time": time, "effects": ("toe",)}))
    best = np.argmax(np.abs(own.largest("toe")))
    assert rows[0]["hardpoint"] == own.coordinates[best]
    assert float(rows[0]["toe [deg/mm]"]) == pytest.approx(math.degrees(own.largest("toe")[best]), rel=1e-12)
    assert printed(capsys, *words, "-o", str(tmp_path / "toe.svg"))[0] == 0
    assert "<svg" in (tmp_path / "toe.svg").read_text(encoding="utf-8")
    status, out, _ = printed(capsys, *words)
    assert status == 0
    (line,) = [line for line in out.splitlines() if line.startswith("toe [deg] ")]
    linear, drawn, worst = map(float, line.split()[2:])
    # The standard deviation of a sample of 400 is known to 1 / sqrt(800), here to three times that; what is
    # not linear in half a millimetre is less.
    assert abs(drawn / linear - 1.0) <= 3.0 / math.sqrt(800.0)
    assert linear < worst


def test_a_rod_that_is_called_as_an_angle_is_does_not_stand_for_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The five-link's toe link has a force, and is called toe."""
    path = tmp_path / "car.csv"
    assert main(["table", "five-link", "--rows", "5", "-o", str(path), "-q"]) == 0
    scene = Scene.load("five-link").model_copy(update={"effects": ("toe",)})
    motion = simulate(scene)
    toe = motion.at(np.linspace(motion.times[0], motion.times[-1], 5)).wheel["toe"]
    found = [float(row["toe [deg]"]) for row in rows_of(path)]
    np.testing.assert_allclose(found, np.degrees(toe), rtol=0, atol=1e-12)
    part = {"loads": {"force": (0.0, 0.0, 3000.0)}, "wheel_radius": 300.0}
    loaded = scene_with("five-link", part, effects=("toe", "loads"))
    both = sensitivity(loaded, ["toe", "rod_force.toe"], ["toe_inner.z"])
    alone = sensitivity(scene, ["toe"], ["toe_inner.z"])
    np.testing.assert_allclose(both.derivatives["toe"], alone.derivatives["toe"], rtol=0, atol=1e-12)
    assert np.abs(both.derivatives["rod_force.toe"]).max() > 0.0


def loaded(folder: Path, name: str, samples: int, effects: list[str] | None = None, **more: Any) -> Path:
    """A scene's car with loads, springs and a car about it, that asks for every number if none is said."""
    content = with_everything(content_of(name, samples=samples, **more), name)
    content |= {"effects": effects or content["effects"]}
    content.pop("points", None)
    path = folder / "car.toml"
    path.write_text("\n".join(written(json.loads(json.dumps(content)))), encoding="utf-8")
    return path


def test_forces_that_a_scene_asks_for_stand_in_its_tables(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    inputs = {"wheel_travel": {"sweep": [-50.0, 50.0]}, "rack": {"constant": 5.0}}
    scene = loaded(tmp_path, "off-axis-strut", 3, ["camber", "loads"], inputs=inputs)
    motion = simulate(str(scene))
    forces = {f"rod_force.{name} [N]": of for name, of in motion.rod_force.items()}
    for point, of in motion.joint_force.items():
        forces |= {f"joint_force.{point}.{axis} [N]": of[:, i] for i, axis in enumerate("xyz")}
    assert {"rod_force.damper [N]", "joint_force.strut_top.x [N]"} <= {*forces}
    grid = ("--grid", "wheel_travel=-50:50:3", "--grid", "rack=5")
    for options in ((), grid):
        target = tmp_path / "table.csv"
        assert printed(capsys, "table", str(scene), *options, "-o", str(target))[0] == 0
        rows = rows_of(target)
        for head, of in forces.items():
            # A grid's poses are solved from the drawing, not along the motion.
            assert [float(row[head]) for row in rows] == pytest.approx(of, rel=1e-9, abs=1e-7), head
    sensitive = ["sensitivity", str(scene), "--number", "rod_force.damper", "--point", "strut_top.z"]
    for more, said, other in (
        (["table", str(scene)], "forces: tension of a rod or damper: positive", "NaN"),
        (["table", str(scene), "--number", "spring_force"], "spring_force [N]", "joint_force"),
        (sensitive, "rod_force.damper [N/mm]", "joint_force"),
    ):
        status, out, _ = printed(capsys, *more)
        assert (status, said in out, other in out) == (0, True, False), more
    named = ("joint_force.strut_top.x", "velocity.wheel_centre.z", "camber")
    asked = [word for name in named for word in ("--number", name)]
    assert printed(capsys, "table", str(scene), *asked, "-o", str(target))[0] == 0
    head = [name.rpartition(" [")[0] for name in rows_of(target)[0]]
    assert head[-3:] == list(named)
    rates = simulate(Scene.load(scene).model_copy(update={"effects": ("velocity",)}))
    speeds = [float(row["velocity.wheel_centre.z [mm/s]"]) for row in rows_of(target)]
    assert speeds == pytest.approx(rates.velocity["wheel_centre"][:, 2], abs=1e-7)
    assert printed(capsys, "table", str(scene), *asked, *grid)[0] == 2


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
    scene, table = loaded(tmp_path, name, 4, convention=convention), tmp_path / "table.csv"
    assert printed(capsys, "table", str(scene), "--all", "-o", str(table))[0] == 0
    status, out, err = printed(capsys, "validate", str(scene), "--data", str(table))
    assert (status, "not tested" in out, "ignored" in out, "Warning" in err) == (0, False, False, False)
    assert said in out
