"""Hardpoints found from curves, and what curves cannot tell."""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pointcoord import Scene, designs_of, simulate
from validate.cli import main
from validate.fitting.curves import Curves
from validate.fitting.fit import Fit, fit_hardpoints
from validate.fitting.words import combination, simplest, text_of, unseen_words
from validate.measured.mapping import Measured, understood
from validate.measured.reading import columns_of_text
from validate.paper.tables import TABLE_2, TABLE_3

CAR = Scene.load("double-wishbone")
ANGLES = np.linspace(1.40, 1.66, 9)
TOLD = ("camber", "toe")


def wheel_table(car: Scene, digits: int, noise: float = 0.0) -> str:
    """Camber and toe (deg) over the arm's angle, by the sweep's way: the motion at a table of inputs."""
    lines = ["input.arm_angle [rad]," + ",".join(f"wheel.{name} [deg]" for name in TOLD)]
    random = np.random.default_rng(5)
    stop = float(len(ANGLES) - 1)
    slope = (ANGLES[-1] - ANGLES[0]) / stop
    content = car.model_dump(exclude_none=True) | {
        "inputs": {"arm_angle": {"polynomial": [float(ANGLES[0]), float(slope)]}, "rack": {"constant": 0.0}},
        "time": {"start": 0.0, "stop": stop, "samples": len(ANGLES)},
    }
    wheel = simulate(Scene.from_mapping(content, "table")).numbers["wheel"]
    for i, angle in enumerate(ANGLES):
        cells = [math.degrees(wheel[name][i]) + noise * random.standard_normal() for name in TOLD]
        lines.append(",".join([f"{angle:.4f}", *(f"{cell:.{digits}f}" for cell in cells)]))
    return "\n".join(lines)


def measured(text: str, scene: Scene) -> Measured:
    exact = {name: {"printed": 0} for name in text.splitlines()[0].split(",") if name.startswith("input.")}
    columns = columns_of_text(text, "x.csv")
    content = {"columns": {name.partition(" ")[0]: part for name, part in exact.items()}, "held": {}}
    if "rack" not in text:
        content["held"] = {"rack": 0.0}
    return understood(columns, content, scene, "map.toml")


FREE = ("upper_ball_joint.z", "tie_rod_outer.z")


@pytest.mark.parametrize("digits", [2, 5])
def test_a_misread_hardpoint_is_found_to_what_the_digits_allow(digits: int) -> None:
    """The table is of the car as drawn; the scene has a ball joint 2 mm too high."""
    misread = designs_of(CAR, offsets={"upper_ball_joint.z": 2.0}).design(0)
    fit = fit_hardpoints(misread, measured(wheel_table(CAR, digits), CAR), FREE)
    assert fit.converged
    assert fit.unique
    for name, right in zip(FREE, (-2.0, 0.0), strict=True):
        # Rounding is no larger than sqrt(3) of its standard deviation; four of the correction's beside it.
        assert abs(fit.corrections[name] - right) < 4.0 * fit.deviations[name]
        assert fit.deviations[name] < 20.0 * 10.0**-digits + 1e-3
    _, after, _ = fit.rms("rad")
    # Rounded numbers are at most half a digit off, and least squares leave no more than the right car.
    assert math.degrees(after) <= 0.5 * 10.0**-digits


def test_noise_widens_what_is_known_by_as_much_as_it_is_larger_than_the_digits() -> None:
    fit = fit_hardpoints(CAR, measured(wheel_table(CAR, 4, noise=0.01), CAR), FREE)
    # 16 degrees of freedom: the root of chi^2 / 16 lies within 0.5 to 1.5 but for one in 500.
    expected = 0.01 / (0.5e-4 / math.sqrt(3.0))
    assert 0.5 < fit.factor / expected < 1.5
    for name in FREE:
        assert abs(fit.corrections[name]) < 4.0 * fit.deviations[name]


def test_a_coordinate_that_the_data_do_not_depend_on_is_said_and_left_alone() -> None:
    """The wheel's centre moved along the spin axis turns nothing; so does the axis's inner point."""
    free = ("upper_ball_joint.z", "wheel_centre.y")
    spin = np.subtract(CAR.mechanism.points["wheel_centre"], CAR.mechanism.points["wheel_axis_inner"])
    content = CAR.model_dump(exclude_none=True)
    level = dict(content["mechanism"]["points"])
    level["wheel_axis_inner"] = [
        level["wheel_centre"][0],
        level["wheel_centre"][1] - abs(spin[1]),
        level["wheel_centre"][2],
    ]
    scene = Scene.from_mapping(
        content | {"mechanism": content["mechanism"] | {"points": level}}, "level axis"
    )
    fit = fit_hardpoints(scene, measured(wheel_table(scene, 4), scene), free)
    assert not fit.unique
    assert unseen_words(fit) == ["wheel_centre.y: changes nothing"]
    # Least squares end where the prior changes less than 1e-6 of the sum, at most one of each number.
    assert abs(fit.corrections["wheel_centre.y"]) <= fit.prior * math.sqrt(1e-6 * 18.0)
    assert "not unique" in text_of(fit, "x", "y")


# The rack goes along with its tie rod; of the rod's end the paper's wheel does not depend.
ALONG = ("rack_centre", "strut_rod_end")


def paper_data() -> str:
    axes = [f"position.wheel_centre.{axis} [mm]" for axis in "xyz"]
    lines = [",".join(["input.arm_angle [deg]", "input.rack [mm]", *axes])]
    for row in (*TABLE_2, *TABLE_3):
        inputs = (row.input, 0.0) if row.table == 2 else (90.0, row.input)
        lines.append(",".join([*map(repr, inputs), *(f"{place:g}" for place in row.wheel_centre)]))
    return "\n".join(lines)


@cache
def paper_fit(*free: str) -> Fit:
    scene = Scene.load("bounce")
    return fit_hardpoints(scene, measured(paper_data(), scene), free, solves=9)


def test_the_papers_tables_come_from_moved_hardpoints_and_not_from_one_choice_of_them_only() -> None:
    """The reading of the paper: 10.3 mm r.m.s. as drawn, 0.3 mm with hardpoints moved, which is rounding."""
    points = [name for name in Scene.load("bounce").mechanism.points if name not in ALONG]
    fit = paper_fit(*points)
    before, after, count = fit.rms("mm")
    assert count == 54
    assert abs(before - 10.3) < 0.05
    assert after < 0.35
    assert not fit.unique
    assert "not unique" in text_of(fit, "bounce", "the paper's tables")
    # Hardpoints 5 mm away along what changes nothing to first order, and the tables are met as well.
    scene = Scene.load("bounce")
    data = measured(paper_data(), scene)
    curves = Curves(scene, data, tuple(fit.corrections))
    theirs = np.concatenate([s.values for s in data.numbers])
    unseen = np.array(list(fit.unseen[-1].parts.values()))
    elsewhere = np.array(list(fit.corrections.values())) + 5.0 * unseen
    apart = curves.at(elsewhere) - theirs
    assert float(np.sqrt(np.mean(apart**2))) < 0.35


def test_combinations_are_told_by_few_coordinates() -> None:
    fit = paper_fit("strut_rod_end", "wheel_centre.y")
    every = [f"strut_rod_end.{axis}" for axis in "xyz"]
    assert sorted(unseen_words(fit)) == [f"{one}: changes nothing" for one in every]
    assert sorted(combination(parts) for parts in simplest(fit.unseen)) == every


def test_the_program_writes_the_corrected_scene_and_says_what_is_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, target = tmp_path / "x.csv", tmp_path / "y.toml"
    data.write_text(wheel_table(CAR, 5))
    misread = tmp_path / "misread.toml"
    found = ["fit", "double-wishbone", "--data", str(data), "--free", "upper_ball_joint.z"]
    assert main([*found, "-o", str(target)]) == 0
    said = capsys.readouterr().out
    assert "upper_ball_joint.z" in said
    assert "unique" in said
    again = Scene.load(str(target))
    assert again.mechanism.type == CAR.mechanism.type
    assert again.inputs == CAR.inputs
    assert main([*found, "--bounds", "0"]) == 2
    assert main([*found[:-1], "upper_ball_joint.q"]) == 2
    assert main(["fit", str(misread), "--data", str(data)]) == 2
    assert all(line.count("allowed") <= 1 for line in capsys.readouterr().err.splitlines())


def test_slopes_are_how_the_motion_of_moved_cars_changes() -> None:
    """A difference over 0.5 mm to either side: its truncation is some (0.5 / 100)^2 / 6 of the slope."""
    data = measured(wheel_table(CAR, 4), CAR)
    slopes = Curves(CAR, data, FREE).slopes(np.zeros(2), np.ones(18, dtype=bool))
    for i, name in enumerate(FREE):
        more, less = (
            measured(wheel_table(designs_of(CAR, offsets={name: move}).design(0), 13), CAR)
            for move in (0.5, -0.5)
        )
        change = np.concatenate(
            [a.values - b.values for a, b in zip(more.numbers, less.numbers, strict=True)]
        )
        assert np.abs(slopes[:, i] - change).max() < 1e-3 * np.abs(change).max()
