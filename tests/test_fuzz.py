"""Mutated files of every format that the program reads: each has an answer, or one line that says why not.

`mutation` makes the files by number, so a failing one can be made again. What once broke the program stays as
a named case.
"""

import contextlib
import io
import os
import resource
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from pathlib import Path
from types import FrameType
from typing import NamedTuple

import numpy as np
import pytest
from changed_scenes import scene_with
from foreign_files import CAR, FOUR_BAR, STRUT, chrono, lotus_report, table
from made_rows import study
from mutation import mutated, mutated_scene
from program import complaints

from pointcoord import KinematicMap, MapError, Scene, kinematic_map, simulate
from validate.cli import main
from validate.cost.table import frame

DEEP = os.environ.get("HYPOTHESIS_PROFILE") == "deep"
FILES, SCENES, BLOCK = 2_000 if DEEP else 4, 10_000 if DEEP else 60, 60
# Every so many scenes are solved by all formulations as well.
COMPARED = 10
# Processor time, s, so that a busy machine changes nothing; how much more memory the process may take, bytes.
LIMIT, MEMORY = 30.0, 1e9
# The largest resident set is counted in KiB on Linux, in bytes on macOS.
UNIT = 1 if sys.platform == "darwin" else 1024


class TooLong(BaseException):
    """Nothing but the test itself may catch this."""


class Run(NamedTuple):
    """What a user of the program sees."""

    status: int
    out: str
    err: str


@contextlib.contextmanager
def stopwatch(seconds: float) -> Iterator[None]:
    """End what takes more processor time."""

    def late(number: int, frame: FrameType | None) -> None:
        raise TooLong(f"more than {seconds} s of processor time")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def run(*arguments: str, seconds: float = LIMIT) -> Run:
    """Run the program; warnings are errors here, so one ends it as a traceback would."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), stopwatch(seconds):
        status = main(arguments)
    return Run(status, out.getvalue(), err.getvalue())


def wrong_words(seen: Run, compares: bool = False) -> str:
    """What is wrong with how a run ended: nothing if it has an answer, or says in one line why not.

    Args:
        compares: whether it may end with 1, or with 3 and the reason in its table.
    """
    if seen.status not in ((0, 1, 2, 3) if compares else (0, 2, 3)):
        return f"status {seen.status}: {seen.out}{seen.err}"
    told, least = len(complaints(seen.err)), int(seen.status in ((2,) if compares else (2, 3)))
    if not least <= told <= int(seen.status != 0):
        return f"status {seen.status} with {seen.err!r}"
    # Whatever a file calls things, its names do not steer the terminal.
    lines = seen.err.removesuffix("\n").split("\n")
    return "" if all(map(str.isprintable, lines)) else f"steers a terminal: {seen.err!r}"


def scene_fault(number: int, folder: Path) -> tuple[int, str]:
    """The status of a mutated scene, and what is wrong with how it is met; nothing if nothing is."""
    path, target, seen = folder / f"{number}.toml", folder / f"{number}.npz", Run(-1, "", "")
    path.write_bytes(mutated_scene(number))
    try:
        seen = run("simulate", str(path), "-o", str(target), seconds=10.0)
        found = wrong_words(seen) or wrong_motion(seen, target)
        if not found and number % COMPARED == 0:
            found = wrong_words(run("validate", str(path)))
    except (Exception, TooLong):
        found = traceback.format_exc()
    return seen.status, found


def wrong_motion(seen: Run, target: Path) -> str:
    if not target.exists():
        # A motion that stops on its way is kept as far as it went; one that does not begin leaves nothing.
        return "" if seen.status else "a motion was promised and none is there"
    with np.load(target) as motion:
        bad = [name for name in motion.files if not np.isfinite(motion[name]).all()]
        empty = len(motion["time [s]"]) == 0
    return "a motion of no instants" if empty else f"not finite: {bad}" if bad else ""


@pytest.mark.parametrize("first", range(0, SCENES, BLOCK))
def test_every_mutated_scene_gives_a_finite_motion_or_one_line(first: int, tmp_path: Path) -> None:
    seen = {number: scene_fault(number, tmp_path) for number in range(first, first + BLOCK)}
    assert not {number: found for number, (_, found) in seen.items() if found}
    # They are not all refused and not all solved.
    solved = [status for status, _ in seen.values()].count(0)
    assert 0.1 * BLOCK <= solved <= 0.9 * BLOCK


BOUNCE = resources.files("pointcoord").joinpath("scenes", "bounce.toml").read_text("utf-8")
RACK, ARM = "{ constant = 0.0 }", "{ polynomial = [0.8, 0.25, 0.0625] }"
# What once ended in a traceback, a warning, a hang or a wrong verdict: changes to the scene, exit status of
# `validate`, and words of its line.
BROKE: dict[str, tuple[dict[str, str], int, str]] = {
    "whole number of 5000 digits": ({RACK: f"{{ constant = {'1' * 5000} }}"}, 2, "too many digits"),
    "whole number of 5000 hexadecimal digits": (
        {"samples = 131": f"samples = 0x{'f' * 5000}"},
        2,
        "time.samples: Input should be less than or equal to 10000000, not something too long to show (int)",
    ),
    "up of 1e300": ({'"left"': '"left"\nup = [0.0, 1e300, 0.0]'}, 2, "allowed: at most 1e-12"),
    "byte order mark": ({"title = ": "\ufefftitle = "}, 0, ""),
    # Added to the angle, such a phase swallowed the time: values stood still while rates said they moved.
    "sine of a huge phase": (
        {RACK: "{ sine = { amplitude = 20.0, angular_frequency = 1.0, phase = -3e272 } }"},
        0,
        "",
    ),
    # The kingpin angles of a strut that hangs upside down were a whole turn apart.
    "car upside down": (
        {'"left"': '"right"\nup = [0.0, 0.6, -0.8]\nright = [0.0, -0.8, -0.6]'},
        0,
        "",
    ),
    # The series' unit of time was the motion's own, and its square was lost.
    "motion of 1e-200 s": ({"stop = 2.6": "stop = 1e-200"}, 0, ""),
    # Some instants lay after the stop.
    "motion of 1e-320 s": ({"stop = 2.6": "stop = 1e-320"}, 0, ""),
    "inputs held for 1e15 s": ({ARM: "{ constant = 1.5 }", "stop = 2.6": "stop = 1e15"}, 0, ""),
    # Their difference is one rounding, and the tolerance made of them was 0.
    "rates below the smallest normal number": ({ARM: "{ polynomial = [1.5, 1e-320] }"}, 0, ""),
    "inputs that overflow": (
        {RACK: f"{{ polynomial = {[1e-3] * 2000} }}"},
        3,
        "all its numbers must be finite",
    ),
}


@pytest.mark.parametrize("case", BROKE)
def test_what_once_broke_the_program_is_solved_and_agrees_or_is_refused(case: str, tmp_path: Path) -> None:
    changes, status, words = BROKE[case]
    text, path = BOUNCE, tmp_path / "scene.toml"
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    seen = run("validate", str(path), "--first", "absolute", "--second", "pointcoord")
    assert (seen.status, len(complaints(seen.err))) == (status, int(status > 0)), seen.out + seen.err
    assert words in seen.err


@cache
def results() -> bytes:
    """What a right solver might have written of the off-axis strut over its time."""
    time = {"start": 0.0, "stop": 0.7, "samples": 8}
    motion = simulate(scene_with("off-axis-strut", time=time))
    columns = {"t": motion.times}
    columns |= {angle: np.degrees(motion.wheel[angle]) for angle in ("camber", "toe")}
    columns |= {f"centre_{x}": motion.position["wheel_centre"][:, i] for i, x in enumerate("xyz")}
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(f"{number:.6f}" for number in row) for row in rows)]
    return ("\n".join(lines) + "\n").encode("utf-8")


MAP = """[columns]
t = { is = "time", unit = "s" }
camber = { is = "wheel.camber", unit = "deg" }
toe = { is = "wheel.toe", unit = "deg" }
""" + "".join(f'centre_{x} = {{ is = "position.wheel_centre.{x}", unit = "mm" }}\n' for x in "xyz")
NAMES = '[names]\nlower_ball_joint = "UPRI_LowPnt"\nupper_ball_joint = "UPRI_UppPnt"\n'
DESIGNS = "lower_ball_joint.z,upper_ball_joint.y\n94.0,645.0\n95.5,646.0\n96.0,647.25\n"
BUMP = "t [s],travel [mm]\n0,-50\n0.25,-20\n0.5,1.5\n0.75,30\n1,50\n"
PUSHROD = resources.files("pointcoord").joinpath("mechanisms", "double_wishbone_pushrod.toml")
DATA = "validate off-axis-strut --data {folder}/results.csv --map {folder}/map.toml"
IMPORT = "import {file} -o {folder}/out.toml"
# The file, a good one, the command that reads it, and whether that says what disagrees.
FORMATS: dict[str, tuple[str, Callable[[], str | bytes], str, bool]] = {
    "mechanism": ("pushrod.toml", PUSHROD.read_bytes, "plan {folder}/car.toml", False),
    "table of a law": ("bump.csv", lambda: BUMP, "table {folder}/car.toml", False),
    "results": ("results.csv", results, DATA, True),
    "map of columns": ("map.toml", lambda: MAP, DATA, True),
    "Lotus report": ("report.txt", lotus_report, IMPORT, True),
    "table of points": ("points.csv", lambda: table(CAR), IMPORT, True),
    "Chrono suspension": (
        "strut.json",
        lambda: chrono("macpherson", STRUT.mechanism.points, -1),
        IMPORT,
        True,
    ),
    "MuJoCo model": ("model.xml", lambda: FOUR_BAR, IMPORT, False),
    "names of points": (
        "names.toml",
        lambda: NAMES,
        "import {folder}/points.csv --names {file} -o {folder}/out.toml",
        True,
    ),
    "designs": ("designs.csv", lambda: DESIGNS, "sweep double-wishbone --designs {file}", False),
    "store of rows": (
        "rows.parquet",
        lambda: frame(study()).to_parquet(),
        "cost --from-rows --rows {file}",
        False,
    ),
}


def sample_of(kind: str) -> bytes:
    made = FORMATS[kind][1]()
    return made if isinstance(made, bytes) else made.encode("utf-8")


def placed(kind: str, folder: Path) -> None:
    """What a command reads beside the mutated file."""
    for beside in ("table of points", "results", "map of columns"):
        (folder / FORMATS[beside][0]).write_bytes(sample_of(beside))
    old, new = "{ polynomial = [-50.0, 100.0] }", '{ table = "bump.csv" }'
    if kind == "mechanism":
        old, new = 'type = "double_wishbone_pushrod"', 'type = "pushrod.toml"'
    text = resources.files("pointcoord").joinpath("scenes", "wheel-travel.toml").read_text("utf-8")
    assert text.count(old) == 1
    (folder / "car.toml").write_text(text.replace(old, new), encoding="utf-8")


@pytest.mark.parametrize("kind", FORMATS)
def test_every_mutated_file_has_an_answer_or_one_line(kind: str, tmp_path: Path) -> None:
    name, _, words, compares = FORMATS[kind]
    sample, faults = sample_of(kind), {}
    for number in range(-1, FILES):
        folder = tmp_path / str(number)
        folder.mkdir()
        placed(kind, folder)
        path = folder / name
        # The first is the sample itself, of which an answer is expected.
        path.write_bytes(sample if number < 0 else mutated(sample, number))
        before = UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        try:
            seen = run(*words.format(file=path, folder=folder).split())
            wrong = wrong_words(seen, compares) or ("" if number >= 0 or seen.status == 0 else seen.out)
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
