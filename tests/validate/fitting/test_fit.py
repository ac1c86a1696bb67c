"""Hardpoints found from curves, and what curves cannot tell."""

import csv
import json
import math
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from curve_files import at_inputs, measured, table
from scipy.stats import norm, t

from pointcoord import Scene, designs_of, simulate
from pointcoord.numerics.arrays import Array
from validate import paper
from validate.cli import main
from validate.exit_status import ExitStatus
from validate.fitting.fit import Fit, fit_hardpoints
from validate.fitting.problem import Problem
from validate.fitting.report import NOTHING, report_of_fit
from validate.measured.mapping import Measured
from validate.measured.poses import Driven
from validate.output.document import schema_text
from validate.paper.tables import TABLE_2, TABLE_3

CAR = Scene.load("double-wishbone")
ANGLES = np.linspace(1.40, 1.66, 9)
ROWS = len(ANGLES)
TOLD = ("camber", "toe")
FREE = ("upper_ball_joint.z", "tie_rod_outer.z")
# A ball joint 5 mm off where another car has it, beside coordinates that are right.
MISREAD = {"upper_ball_joint.y": 5.0, "tie_rod_outer.z": 0.0, "lower_arm_rear.z": 0.0}


def wheel_table(car: Scene, digits: int) -> str:
    """Camber and toe (deg) over the arm's angle."""
    wheel = at_inputs(car, {"arm_angle": (ANGLES[0], ANGLES[-1]), "rack": (0.0, 0.0)}, ROWS)["wheel"]
    columns = {"input.arm_angle [rad]": ANGLES, "input.rack [mm]": np.zeros(ROWS)}
    return table(columns | {f"wheel.{name} [deg]": np.degrees(wheel[name]) for name in TOLD}, digits)


def fitted(scene: Scene, data: Measured, free: Sequence[str], solves: int = 60, **limits: float) -> Fit:
    return fit_hardpoints(Problem.of(scene, data, free, **limits), solves)


def paper_data() -> str:
    return (Path(paper.__file__).parent / "tables-2-and-3.csv").read_text(encoding="utf-8")


def test_the_file_of_the_paper_s_tables_says_what_the_tables_say() -> None:
    rows = [[float(cell) for cell in line.split(",")] for line in paper_data().splitlines()[1:]]
    printed = [(r.input, 0.0, *r.wheel_centre) for r in TABLE_2] + [
        (90.0, r.input, *r.wheel_centre) for r in TABLE_3
    ]
    assert rows == [list(row) for row in printed]


def run(*words: str) -> ExitStatus:
    return ExitStatus(main(["fit", *words]))


def test_the_corrected_scene_is_read_back_and_leaves_what_the_fit_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data, scene, found, rows = (str(tmp_path / name) for name in ("x.csv", "y.toml", "y.json", "y.csv"))
    other = designs_of(CAR, offsets={"upper_ball_joint.z": 1.0}).design(0)
    text = wheel_table(other, 5)
    Path(data).write_text(text)
    words = ["double-wishbone", "--data", data, "--free", *FREE, "-o", scene, "--json", found, "--csv", rows]
    assert run(*words) is ExitStatus.AGREE
    said = capsys.readouterr()
    assert "the answer is unique nearby" in said.out
    # It takes a while: something is said at once, and in the end what the scene can be held to.
    assert said.err.startswith("pointcoord: note: double-wishbone: 2 coordinates are fitted to 18 numbers")
    try_this = said.out.splitlines()[-1].partition("try: ")[2]
    assert try_this == f"pointcoord validate --data {data} {scene}"
    again, told = Scene.load(scene), json.loads(Path(found).read_text())
    jsonschema.validate(told, json.loads(schema_text()))
    assert again.inputs == CAR.inputs
    fit = fitted(again, measured(text, again), FREE)
    # What the file left to rounding of its inputs widens no difference: before is what was left.
    assert fit.rms["rad"][0] == pytest.approx(told["rms"][0]["after"], rel=1e-9)
    assert told["rms"][0]["before"] > 100.0 * told["rms"][0]["after"]
    for row, own in zip(
        csv.DictReader(Path(rows).read_text().splitlines()), told["coordinates"], strict=True
    ):
        point, _, axis = row["coordinate"].partition(".")
        place = again.mechanism.points[point]["xyz".index(axis)]
        assert float(row["corrected [mm]"]) == own["corrected"] == place
        assert float(row["correction [mm]"]) == own["correction"]
        assert own["low"] < own["correction"] < own["high"]


def test_a_wrong_command_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data = tmp_path / "x.csv"
    data.write_text(wheel_table(CAR, 5))
    found = ["double-wishbone", "--data", str(data), "--free", "upper_ball_joint.z"]
    for wrong in (
        [*found, "--bounds", "0"],
        [*found, "--prior", "inf"],
        [*found, "--accuracy=-1"],
        [*found[:-1], "upper_ball_joint.q"],
        [str(tmp_path / "none.toml"), "--data", str(data)],
        [*found, "-o", "-", "--json", "-"],
        [*found, "--json", str(data)],
        [*found, "-o", str(tmp_path / "x.txt")],
    ):
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(tmp_path)
            assert run(*wrong) is ExitStatus.WRONG_INPUT, wrong
        assert len(capsys.readouterr().err.splitlines()) == 1
    assert run(*found, "--csv", "-", "--quiet") is ExitStatus.AGREE
    assert capsys.readouterr().out.startswith("coordinate,drawn [mm],")


@cache
def of_the_other_car() -> Mapping[str, tuple[str, Mapping[str, object]]]:
    """Its curves over whatever they can be over, each found another way than a fit does."""
    car = designs_of(CAR, offsets=MISREAD).design(0)
    angles = np.linspace(1.4, 1.65, 7)
    held = at_inputs(car, {"arm_angle": (1.4, 1.65), "rack": (0.0, 0.0)}, 7)
    travels = np.linspace(-40.0, 40.0, 7)
    text = table({"travel.wheel_centre [mm]": travels, "wheel.camber [deg]": travels}, 9)
    over = Driven.of(car, measured(text, car)).at([travels]).numbers["wheel"]
    motion = simulate(car)
    some = slice(0, 51, 5)
    speed = motion.numbers["velocity"]["wheel_centre"]
    return {
        "angle": (degrees({"input.arm_angle [rad]": angles}, held["wheel"]), {"held": {"rack": 0.0}}),
        "travel": (degrees({"travel.wheel_centre [mm]": travels}, over), {}),
        "time": (
            table(
                {"time [s]": motion.times[some]}
                | {f"velocity.wheel_centre.{a} [mm/s]": speed[some, i] for i, a in enumerate("xyz")},
                3,
            ),
            {},
        ),
    }


def degrees(over: Mapping[str, Array], wheel: Mapping[str, Array]) -> str:
    return table({**over, **{f"wheel.{name} [deg]": np.degrees(wheel[name]) for name in TOLD}}, 4)


@pytest.mark.parametrize("over", ["angle", "travel", "time"])
def test_a_hardpoint_misread_by_5_mm_is_found_to_the_noise(over: str) -> None:
    text, content = of_the_other_car()[over]
    fit = fitted(CAR, measured(text, CAR, **content), [*MISREAD])
    assert fit.converged
    for name, right in MISREAD.items():
        # Digits are spread evenly: their sums are within four deviations but for one in 10^4.
        assert abs(fit.coordinates[name].correction - right) < 4.0 * fit.coordinates[name].deviation, name
    assert fit.coordinates["upper_ball_joint.y"].deviation < 0.1


def test_what_angles_cannot_see_is_what_moves_no_angle_in_closed_form() -> None:
    """What leaves all angles over the lower arm's angle as they are, with the rack at rest: twelve moves.

    The car as a whole (3) and its scale (1), both points of the spin axis (3) and one along it (1), the
    pivots along their axes but for the one that the angle counts from (3), and drawing at another angle (1).
    """
    content = CAR.model_dump(exclude_none=True) | {"effects": ("wheel_angles", "toe", "caster")}
    car = Scene.from_mapping(content, "angles")
    inputs = {"arm_angle": (1.1, 1.9), "rack": (0.0, 0.0)}
    numbers = at_inputs(car, inputs, 31)
    wheel = {f"wheel.{name} [deg]": np.degrees(one) for name, one in numbers["wheel"].items()}
    text = table({"input.arm_angle [rad]": np.linspace(1.1, 1.9, 31), **wheel}, 6)
    problem = Problem.of(car, measured(text, car, held={"rack": 0.0}))
    assert problem.used.all()
    free, matrix = problem.free, problem.slopes(problem.start)
    points = {name: np.array(place) for name, place in car.mechanism.points.items() if f"{name}.x" in free}
    drawn = np.arccos(
        (points["lower_ball_joint"] - points["lower_arm_front"])[2]
        / np.linalg.norm(points["lower_ball_joint"] - points["lower_arm_front"])
    )
    moving = at_inputs(CAR, {"arm_angle": (float(drawn), float(drawn) + 0.1), "rack": (0.0, 0.0)}, 2)

    def vector(moves: Mapping[str, Array]) -> Array:
        return np.concatenate([moves.get(name, np.zeros(3)) for name in points])

    spin = points["wheel_centre"] - points["wheel_axis_inner"]
    closed = [vector(dict.fromkeys(points, row)) for row in np.eye(3)]
    closed.append(vector(points))
    closed += [vector({"wheel_centre": row, "wheel_axis_inner": row}) for row in np.eye(3)]
    closed.append(vector({"wheel_centre": spin}))
    for moved, other in (
        ("lower_arm_rear", "lower_arm_front"),
        ("upper_arm_rear", "upper_arm_front"),
        ("upper_arm_front", "upper_arm_rear"),
    ):
        closed.append(vector({moved: points[moved] - points[other]}))
    closed.append(vector({name: speed[0] for name, speed in moving["velocity"].items()}))
    basis = np.stack([one / np.linalg.norm(one) for one in closed])
    largest = np.linalg.norm(matrix, 2)
    # Derivatives are exact to rounding, times the condition of C_u, some 10, and sums of 30 coordinates.
    assert np.abs(matrix @ basis.T).max() < 1e-13 * largest
    singular = np.linalg.svd(matrix, compute_uv=False)
    assert np.linalg.matrix_rank(basis) == 12
    assert (singular < NOTHING * largest).sum() == 12


def linear_case() -> tuple[Array, dict[str, Array]]:
    """How a wheel centre moves with its place in the drawing, (rows, 3, 3): as the knuckle turns.

    From the three joints as drawn and as moved, by the turn that takes one triangle into the other.
    """
    moved = at_inputs(CAR, {"arm_angle": (1.35, 1.7), "rack": (0.0, 20.0)}, ROWS)["position"]
    joints = ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer")
    drawn = np.array([CAR.mechanism.points[name] for name in joints])
    frames = []
    for corners in (drawn[None], np.stack([moved[name] for name in joints], axis=1)):
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        a = a / np.linalg.norm(a, axis=-1, keepdims=True)
        n = np.cross(a, b)
        n = n / np.linalg.norm(n, axis=-1, keepdims=True)
        frames.append(np.stack([a, n, np.cross(n, a)], axis=-1))
    return frames[1] @ frames[0].swapaxes(-1, -2), moved


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
    data = measured(wheel_table(CAR, 5), CAR)
    fit = fitted(misread, data, FREE, bounds=4.0)
    assert fit.converged
    assert [at for at, one in fit.coordinates.items() if one.on_bound] == ["upper_ball_joint.z"]
    assert fit.coordinates["upper_ball_joint.z"].correction == pytest.approx(-4.0, abs=1e-9)
    assert "on its bound" in report_of_fit(fit, "x", "y").text
    assert any("on the bound of" in words for words in report_of_fit(fit, "x", "y").warnings)
    held = designs_of(misread, offsets={"upper_ball_joint.z": -4.0}).design(0)
    alone = fitted(held, data, FREE[1:], bounds=4.0)
    other, alone = fit.coordinates[FREE[1]], alone.coordinates[FREE[1]]
    assert other.correction == pytest.approx(alone.correction, abs=1e-4)
    assert other.deviation == pytest.approx(alone.deviation, rel=1e-4)
    for one in fit.coordinates.values():
        assert -fit.bounds <= one.low <= one.correction <= one.high <= fit.bounds


def test_a_force_is_fitted_to_in_its_own_unit() -> None:
    content = CAR.model_dump(exclude_none=True)
    content["mechanism"] |= {"wheel_radius": 270.0, "loads": {"force": [0.0, 0.0, 3000.0]}}
    scene = Scene.from_mapping(content, "loaded")
    text = "time [s],rod_force.tie_rod [N]\n0,100.0\n0.2,101.0\n0.4,103.0\n"
    assert [*fitted(scene, measured(text, scene), ["tie_rod_outer.z"], solves=2).rms] == ["N"]


def off_by_10_deg(stop: float) -> str:
    wheel = at_inputs(CAR, {"arm_angle": (1.5, stop), "rack": (0.0, 0.0)}, 5)["wheel"]
    over = {"input.arm_angle [rad]": np.linspace(1.5, stop, 5)}
    return table(over | {f"wheel.{n} [deg]": np.degrees(wheel[n]) - 10.0 for n in TOLD}, 3)


def test_a_search_that_is_stopped_by_designs_that_do_not_close_says_so() -> None:
    data = measured(off_by_10_deg(1.8), CAR, held={"rack": 0.0})
    fit = fitted(CAR, data, ["lower_ball_joint.y"], bounds=300.0, solves=20)
    assert not fit.converged
    (words,) = (
        words for words in report_of_fit(fit, "x", "y").warnings if "did not end at a minimum" in words
    )
    assert "cannot be assembled" in words


def test_designs_that_do_not_close_on_the_way_are_steps_too_far() -> None:
    """The best upper pivot lies where steps towards it leave the last row without a pose."""
    data = measured(off_by_10_deg(2.23), CAR, held={"rack": 0.0})
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
