"""Hardpoints found from curves, and what curves cannot tell."""

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from curve_files import at_inputs, measured, table, wheel_curves
from program import document
from scipy.spatial.transform import Rotation
from scipy.stats import norm, t

from pointcoord import Scene, designs_of
from pointcoord.numerics.arrays import Array
from validate import paper
from validate.cli import main
from validate.fitting.fit import Fit, fit_hardpoints
from validate.fitting.problem import Problem
from validate.fitting.report import report_of_fit
from validate.measured.mapping import Measured
from validate.paper.tables import TABLE_2, TABLE_3

CAR = Scene.load("double-wishbone")
ANGLES, ROWS = (1.40, 1.66), 9
FREE = ("upper_ball_joint.z", "tie_rod_outer.z")


def fitted(scene: Scene, data: Measured, free: Sequence[str], solves: int = 60, **limits: float) -> Fit:
    return fit_hardpoints(Problem.of(scene, data, free, **limits), solves)


def test_the_file_of_the_paper_s_tables_says_what_the_tables_say() -> None:
    rows = np.loadtxt(Path(paper.__file__).parent / "tables-2-and-3.csv", delimiter=",", skiprows=1)
    printed = [(r.input, 0.0, *r.wheel_centre) for r in TABLE_2]
    printed += [(90.0, r.input, *r.wheel_centre) for r in TABLE_3]
    assert rows.tolist() == [list(row) for row in printed]


def test_the_corrected_scene_is_read_back_and_leaves_what_the_fit_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, scene, found, rows = (str(tmp_path / name) for name in ("x.csv", "y.toml", "y.json", "y.csv"))
    other = designs_of(CAR, offsets={"upper_ball_joint.z": 1.0}).design(0)
    text = wheel_curves(other, ANGLES, digits=5)
    Path(data).write_text(text)
    words = ["--data", data, "--free", *FREE, "-o", scene, "--json", found, "--csv", rows]
    assert main(["fit", "double-wishbone", *words]) == 0
    said = capsys.readouterr()
    # It takes a while: something is said at once, and in the end what the scene can be held to.
    assert said.err.startswith("pointcoord: note: double-wishbone: fitting 2 coordinates to 18 numbers")
    assert said.out.splitlines()[-1].endswith(f"try: pointcoord validate --data {data} {scene}")
    again, told = Scene.load(scene), document(Path(found))
    assert again.inputs == CAR.inputs
    fit = fitted(again, measured(text, again), FREE)
    # What the file left to rounding of its inputs widens no difference: before is what was left.
    assert fit.rms["rad"][0] == pytest.approx(told["rms"][0]["after"], rel=1e-9)
    assert told["rms"][0]["before"] > 100.0 * told["rms"][0]["after"]
    table_of = csv.DictReader(Path(rows).read_text().splitlines())
    for row, own in zip(table_of, told["coordinates"], strict=True):
        point, _, axis = row["coordinate"].partition(".")
        place = again.mechanism.points[point]["xyz".index(axis)]
        assert float(row["corrected [mm]"]) == own["corrected"] == place
        assert float(row["correction [mm]"]) == own["correction"]
        assert own["low"] < own["correction"] < own["high"]


def linear_case() -> tuple[Array, dict[str, Array]]:
    """How a wheel centre moves with its place in the drawing, (rows, 3, 3): as the knuckle turns."""
    moved = at_inputs(CAR, {"arm_angle": (1.35, 1.7), "rack": (0.0, 20.0)}, ROWS)["position"]
    joints = ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer")
    drawn = np.array([CAR.mechanism.points[name] for name in joints])
    corners = np.stack([moved[name] for name in joints], axis=1)
    sides = [one - one.mean(axis=0) for one in (drawn, *corners)]
    turns = [Rotation.align_vectors(one, sides[0])[0].as_matrix() for one in sides[1:]]
    return np.array(turns), moved


def centre_table(places: Array) -> str:
    inputs = {
        "input.arm_angle [rad]": np.linspace(1.35, 1.7, ROWS),
        "input.rack [mm]": np.linspace(0.0, 20.0, ROWS),
    }
    return table(inputs | {f"position.wheel_centre.{a} [mm]": places[:, i] for i, a in enumerate("xyz")}, 12)


CENTRE = tuple(f"wheel_centre.{axis}" for axis in "xyz")


@pytest.mark.parametrize(("times", "settled"), [(0.9, False), (1.1, True)])
def test_what_a_prior_knows_better_than_the_file_is_not_known_from_the_file(
    times: float, settled: bool
) -> None:
    """q = R a with turns R: the file knows each direction to s / sqrt(N), all within the bounds."""
    turns, moved = linear_case()
    right, accuracy = np.array([3.0, -2.0, 1.0]), 5.0
    data = measured(centre_table(moved["wheel_centre"] + turns @ right), CAR)
    known = accuracy / math.sqrt(3.0) / math.sqrt(ROWS)
    fit = fitted(CAR, data, CENTRE, prior=times * known, accuracy=accuracy)
    assert [one.deviation for one in fit.combinations] == pytest.approx([known] * 3, rel=1e-9)
    assert (not fit.unseen) is settled
    assert ("determine every combination" in report_of_fit(fit, "x", "y").text) is settled


@pytest.mark.parametrize("noise", [0.0, 4.0])
def test_columns_weigh_as_they_are_known_and_missing_numbers_do_not(noise: float) -> None:
    """The normal equations by hand: columns that contradict each other, of other accuracies, with gaps.

    Noise of 4 standard deviations is estimated from what is left: deviations are so much larger, and 95 in
    100 intervals that hold are Student's t of the degrees of freedom wide.
    """
    turns, moved = linear_case()
    off = np.array([0.4, -0.3, 0.2])
    accuracies = np.array([0.1, 1.0, 3.0])
    random = np.random.default_rng(5).standard_normal((ROWS, 3))
    right = off + noise / math.sqrt(3.0) * accuracies * random
    gaps = np.zeros((ROWS, 3), dtype=bool)
    gaps[[1, 4, 4, 7], [0, 1, 2, 2]] = True
    lines = [line.split(",") for line in centre_table(moved["wheel_centre"] + right).splitlines()]
    for row, axis in np.argwhere(gaps).tolist():
        lines[row + 1][2 + axis] = ""
    columns = {f"position.wheel_centre.{a}": {"accuracy": x} for a, x in zip("xyz", accuracies, strict=True)}
    text = "\n".join(map(",".join, lines))
    fit = fitted(CAR, measured(text, CAR, columns=columns), CENTRE, prior=2.0)
    weights = np.where(gaps, 0.0, 3.0 / np.square(accuracies))
    by_file = np.einsum("nij,ni,nik->jk", turns, weights, turns)
    prior = np.eye(3) / 2.0**2  # Tikhonov's: a prior of 2 mm draws corrections back
    expected = np.linalg.solve(by_file + prior, np.einsum("nij,ni,ni->j", turns, weights, right))
    left = float(np.sum(weights * (right - turns @ expected) ** 2))
    freedom = 3 * ROWS - 4 - 3
    factor = max(1.0, math.sqrt(left / freedom))
    found = [*fit.coordinates.values()]
    assert [one.correction for one in found] == pytest.approx(expected.tolist(), rel=1e-6)
    assert (fit.factor, fit.freedom) == (pytest.approx(factor, rel=1e-6), freedom)
    assert (factor > 2.0) == (noise > 0.0)
    deviations = np.sqrt(np.diag(np.linalg.inv(by_file / factor**2 + prior)))
    assert [one.deviation for one in found] == pytest.approx(deviations.tolist(), rel=1e-6)
    wide = 2.0 * deviations * (t.ppf(0.975, freedom) if noise else norm.ppf(0.975))
    assert [one.high - one.low for one in found] == pytest.approx(wide.tolist(), rel=1e-6)
    singular = np.sqrt(np.linalg.eigvalsh(by_file)[::-1])
    assert [one.singular_value for one in fit.combinations] == pytest.approx(singular.tolist(), rel=1e-6)
    assert [column.count for column in fit.columns] == [ROWS - 1, ROWS - 1, ROWS - 2]


def test_a_correction_ends_on_its_bound_and_the_others_are_fitted_to_it_there() -> None:
    misread = designs_of(CAR, offsets={"upper_ball_joint.z": 5.0}).design(0)
    data = measured(wheel_curves(CAR, ANGLES, digits=5), CAR)
    fit = fitted(misread, data, FREE, bounds=4.0)
    assert fit.converged
    assert [at for at, one in fit.coordinates.items() if one.on_bound] == ["upper_ball_joint.z"]
    assert fit.coordinates["upper_ball_joint.z"].correction == pytest.approx(-4.0, abs=1e-9)
    assert "on its bound" in report_of_fit(fit, "x", "y").text
    held = designs_of(misread, offsets={"upper_ball_joint.z": -4.0}).design(0)
    alone = fitted(held, data, FREE[1:], bounds=4.0)
    other, alone = fit.coordinates[FREE[1]], alone.coordinates[FREE[1]]
    assert other.correction == pytest.approx(alone.correction, abs=1e-4)
    assert other.deviation == pytest.approx(alone.deviation, rel=1e-4)
    for one in fit.coordinates.values():
        assert -4.0 <= one.low <= one.correction <= one.high <= 4.0


def test_a_force_is_fitted_to_in_its_own_unit() -> None:
    content = CAR.model_dump(exclude_none=True)
    content["mechanism"] |= {"wheel_radius": 270.0, "loads": {"force": [0.0, 0.0, 3000.0]}}
    scene = Scene.from_mapping(content, "loaded")
    text = "time [s],rod_force.tie_rod [N]\n0,100.0\n0.2,101.0\n0.4,103.0\n"
    assert [*fitted(scene, measured(text, scene), ["tie_rod_outer.z"], solves=2).rms] == ["N"]


def off_by_10_deg(stop: float) -> Measured:
    return measured(wheel_curves(CAR, (1.5, stop), rows=5, digits=3, camber=-10.0, toe=-10.0), CAR)


def test_a_search_that_is_stopped_by_designs_that_do_not_close_says_so() -> None:
    data = off_by_10_deg(1.8)
    fit = fitted(CAR, data, ["lower_ball_joint.y"], bounds=300.0, solves=20)
    assert not fit.converged
    (words,) = (
        words for words in report_of_fit(fit, "x", "y").warnings if "did not end at a minimum" in words
    )
    assert "cannot be assembled" in words


def test_designs_that_do_not_close_on_the_way_are_steps_too_far() -> None:
    """The best upper pivot lies where steps towards it leave the last row without a pose."""
    data = off_by_10_deg(2.23)
    fit = fitted(CAR, data, ["upper_arm_front.y"], bounds=300.0)
    assert fit.failures
    assert "line 6" in fit.failures[0]
    assert fit.converged
    problem = Problem.of(CAR, data, ("upper_arm_front.y",))
    best = fit.coordinates["upper_arm_front.y"].correction
    designs = (problem.solved(np.array([best + off])) for off in (-0.02, 0.0, 0.02))
    costs = [np.sum(problem.misfit(one) ** 2) for one in designs]
    assert costs[1] < costs[0]
    assert not costs[2] < costs[1]
