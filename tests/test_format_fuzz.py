"""Mutated files of every format that the program reads: each has an answer, or one line that says why not.

`mutated` makes the files by number, so a failing one can be made again.
"""

import os
import resource
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import resources
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from foreign_files import CAR, FOUR_BAR, STRUT, chrono, lotus_report, table
from guarded import TooLong, run_within, wrong_words
from made_rows import kept, study
from mutation import mutated

from pointcoord import KinematicMap, MapError, Scene, kinematic_map, simulate

FILES = 2_000 if os.environ.get("HYPOTHESIS_PROFILE") == "deep" else 6
# Processor time, s, and how much more memory the process may have taken at most, bytes.
LIMIT, MEMORY = 30.0, 1e9
# The largest resident set is counted in KiB on Linux, in bytes on macOS.
UNIT = 1 if sys.platform == "darwin" else 1024


@dataclass(frozen=True)
class Format:
    """A kind of file.

    Attributes:
        name: of the file. sample: a good one. words: the command that reads it, {file} being its path and
            {folder} a folder that holds car.toml.
        compares: whether the command says what disagrees.
    """

    name: str
    sample: Callable[[], bytes]
    words: str
    compares: bool = False


def shipped(kind: str, name: str) -> bytes:
    """A file that comes with the package."""
    return resources.files("pointcoord").joinpath(kind, name).read_bytes()


def scene_with(old: str, new: str) -> bytes:
    """The wishbone with something else in its scene."""
    text = shipped("scenes", "wheel-travel.toml").decode("utf-8")
    assert text.count(old) == 1
    return text.replace(old, new).encode("utf-8")


@cache
def results() -> bytes:
    """What a right solver might have written of the off-axis strut over its time."""
    motion = simulate(Scene.load("off-axis-strut").model_copy(update={"time": SHORT}))
    columns = {"t": motion.times}
    columns |= {angle: np.degrees(motion.wheel[angle]) for angle in ("camber", "toe")}
    columns |= {f"centre_{x}": motion.position["wheel_centre"][:, i] for i, x in enumerate("xyz")}
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(f"{number:.6f}" for number in row) for row in rows)]
    return ("\n".join(lines) + "\n").encode("utf-8")


@cache
def swept() -> bytes:
    """Two designs at three instants as `sweep` writes them."""
    head = "design,lower_ball_joint.z [mm],time [s],wheel.camber [deg],status"
    rows = [f"{d},{95.0 + d},{0.5 * i},{0.1 * i - d:.17g},solved" for d in range(2) for i in range(3)]
    return ("\n".join([head, *rows]) + "\n").encode("utf-8")


@cache
def arrays_of_a_sweep() -> bytes:
    """The same as arrays."""
    stream, designs = BytesIO(), np.arange(2.0)
    camber = 0.05 * np.arange(3.0) - designs[:, None]
    columns = {"lower_ball_joint.z [mm]": 95.0 + designs, "time [s]": 0.5 * np.arange(3.0)}
    np.savez(stream, design=designs, **columns, **{"wheel.camber [deg]": camber}, allow_pickle=False)
    return stream.getvalue()


SHORT = {"start": 0.0, "stop": 0.7, "samples": 8}
MAP = b"""[columns]
t = { is = "time", unit = "s" }
camber = { is = "wheel.camber", unit = "deg" }
toe = { is = "wheel.toe", unit = "deg" }
centre_x = { is = "position.wheel_centre.x", unit = "mm" }
centre_y = { is = "position.wheel_centre.y", unit = "mm" }
centre_z = { is = "position.wheel_centre.z", unit = "mm" }
"""
NAMES = b"""[names]
lower_ball_joint = "UPRI_LowPnt"
upper_ball_joint = "UPRI_UppPnt"
"""
DESIGNS = b"lower_ball_joint.z,upper_ball_joint.y\n94.0,645.0\n95.5,646.0\n96.0,647.25\n"
BUMP = b"t [s],travel [mm]\n0,-50\n0.25,-20\n0.5,1.5\n0.75,30\n1,50\n"

DATA = "validate off-axis-strut"
IMPORT = "import {file} -o {folder}/out.toml"
IMPORTED = "import {folder}/points.csv --names {file} -o {folder}/out.toml"
FORMATS = {
    "mechanism": Format(
        "pushrod.toml",
        lambda: shipped("mechanisms", "double_wishbone_pushrod.toml"),
        "plan {folder}/car.toml",
    ),
    "table of a law": Format("bump.csv", lambda: BUMP, "table {folder}/car.toml"),
    "results": Format("results.csv", results, f"{DATA} --data {{file}} --map {{folder}}/map.toml", True),
    "map of columns": Format(
        "map.toml", lambda: MAP, f"{DATA} --data {{folder}}/results.csv --map {{file}}", True
    ),
    "Lotus report": Format("report.txt", lambda: lotus_report().encode("utf-8"), IMPORT, True),
    "table of points": Format("points.csv", lambda: table(CAR).encode("utf-8"), IMPORT, True),
    "Chrono suspension": Format(
        "strut.json", lambda: chrono("macpherson", STRUT.mechanism.points, -1).encode("utf-8"), IMPORT, True
    ),
    "MuJoCo model": Format("model.xml", lambda: FOUR_BAR.encode("utf-8"), IMPORT),
    "names of points": Format("names.toml", lambda: NAMES, IMPORTED, True),
    "table of a sweep": Format("sweep.csv", swept, "plot {file} -o {folder}/out.svg"),
    "arrays of a sweep": Format("sweep.npz", arrays_of_a_sweep, "plot {file} -o {folder}/out.svg"),
    "designs": Format("designs.csv", lambda: DESIGNS, "sweep double-wishbone --designs {file}"),
}


def placed(kind: str, folder: Path) -> None:
    """What a command reads beside the mutated file."""
    points = table(CAR).encode("utf-8")
    (folder / "points.csv").write_bytes(points)
    (folder / "results.csv").write_bytes(results())
    (folder / "map.toml").write_bytes(MAP)
    if kind == "mechanism":
        car = scene_with('type = "double_wishbone_pushrod"', 'type = "pushrod.toml"')
    else:
        car = scene_with("{ polynomial = [-50.0, 100.0] }", '{ table = "bump.csv" }')
    (folder / "car.toml").write_bytes(car)


@pytest.mark.parametrize("kind", FORMATS)
def test_every_mutated_file_has_an_answer_or_one_line(kind: str, tmp_path: Path) -> None:
    made = FORMATS[kind]
    faults = {}
    for number in range(-1, FILES):
        folder = tmp_path / str(number)
        folder.mkdir()
        placed(kind, folder)
        path = folder / made.name
        # The first is the sample itself, of which an answer is expected.
        path.write_bytes(made.sample() if number < 0 else mutated(made.sample(), number))
        words = made.words.format(file=path, folder=folder).split()
        before = UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        try:
            seen = run_within(LIMIT, *words)
            wrong = wrong_words(seen, made.compares) or ("" if number >= 0 or seen.status == 0 else seen.out)
        except (Exception, TooLong):
            wrong = traceback.format_exc()
        if UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before > MEMORY:
            wrong = "took more memory than it may"
        if wrong:
            faults[number] = wrong
    assert not faults


def test_every_mutated_map_is_read_or_refused_by_its_own_error(tmp_path: Path) -> None:
    path, ranges = tmp_path / "car.npz", {"arm_angle": (1.0, 1.05), "rack": (-1.0, 1.0)}
    kinematic_map(Scene.load("bounce"), ranges).save(path)
    sample, read = path.read_bytes(), 0
    for number in range(10 * FILES):
        path.write_bytes(mutated(sample, number))
        try:
            found = KinematicMap.load(path)
        except MapError as error:
            told = str(error)
        else:
            told, read = repr(found), read + 1
            assert found.inputs == ("arm_angle", "rack")
        assert "\n" not in told
    # A change that leaves the arrays as they are leaves the map; nearly all others are seen.
    assert read < 2 * FILES


def test_every_mutated_store_of_rows_is_told_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "rows.parquet"
    kept(path, study())
    sample = path.read_bytes()
    for number in range(FILES):
        path.write_bytes(mutated(sample, number))
        seen = run_within(LIMIT, "cost", "--from-rows", str(path))
        assert not wrong_words(seen), number
