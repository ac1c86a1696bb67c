"""Thousands of broken and odd scene files: each gives a motion, or exit status 2 and one line that says why.

`mutation` makes the files by number, so a failing one can be made again. Each defect that they
found stays as a named case.
"""

import os
import traceback
from pathlib import Path

import numpy as np
import pytest
from guarded import Run, TooLong, run_within, wrong_words
from mutation import mutated_scene
from program import complaints

import pointcoord

FILES = 10_000 if os.environ.get("HYPOTHESIS_PROFILE") == "deep" else 300
BLOCK = 60
# Every so many files are solved by all formulations as well.
COMPARED = 10
# Processor time, s, so that a busy machine changes nothing: a scene may take ten. A motion of the most
# segments that are allowed takes some three; a comparison solves a scene three times.
LIMIT = {"simulate": 10.0, "validate": 30.0}


def run(*arguments: str) -> Run:
    """Run the program within the time of its command."""
    return run_within(LIMIT[arguments[0]], *arguments)


def fault(number: int, folder: Path) -> tuple[int, str]:
    """The status of a mutated file, and what is wrong with how it is met; nothing if nothing is."""
    path, target, seen = folder / f"{number}.toml", folder / f"{number}.npz", Run(-1, "", "")
    path.write_bytes(mutated_scene(number))
    try:
        seen = run("simulate", str(path), "-o", str(target))
        found = _wrong_motion(seen, target)
        if not found and number % COMPARED == 0:
            found = wrong_words(run("validate", str(path)))
    except (Exception, TooLong):
        found = traceback.format_exc()
    return seen.status, found


def _wrong_motion(seen: Run, target: Path) -> str:
    if not target.exists():
        # A motion that stops on its way is kept as far as it went; one that does not begin leaves nothing.
        return wrong_words(seen) if seen.status else "a motion was promised and none is there"
    with np.load(target) as motion:
        bad = [name for name in motion.files if not np.isfinite(motion[name]).all()]
        empty = len(motion["time [s]"]) == 0
    return wrong_words(seen) or ("a motion of no instants" if empty else f"not finite: {bad}" if bad else "")


@pytest.mark.parametrize("first", range(0, FILES, BLOCK))
def test_every_mutated_file_gives_a_finite_motion_or_one_line(first: int, tmp_path: Path) -> None:
    seen = {number: fault(number, tmp_path) for number in range(first, first + BLOCK)}
    assert not {number: found for number, (_, found) in seen.items() if found}
    # They are not all refused and not all solved.
    solved = [status for status, _ in seen.values()].count(0)
    assert 0.1 * BLOCK <= solved <= 0.9 * BLOCK


BOUNCE = (Path(pointcoord.__file__).parent / "scenes" / "bounce.toml").read_text(encoding="utf-8")
RACK = "{ constant = 0.0 }"
ARM = "{ polynomial = [0.8, 0.25, 0.0625] }"
STEEP = "{ table = { times = [0, 1, 2, 3], values = [1e308, -1e308, 1e308, -1e308] } }"
CLOSE = "{ table = { times = [0, 5e-324, 2, 3], values = [0, 1, 2, 3] } }"
NO_SPLINE = "inputs.rack.table: the spline through the table is not finite; allowed: smaller values"

# What once ended in a traceback, a warning or a hang: the changes to the scene, and words of the line.
REFUSED: dict[str, tuple[dict[str, str], str]] = {
    "whole number of 5000 digits": ({RACK: f"{{ constant = {'1' * 5000} }}"}, "too many digits"),
    "whole number of 5000 hexadecimal digits": (
        {"samples = 131": f"samples = 0x{'f' * 5000}"},
        "time.samples: Input should be less than or equal to 10000000, not something too long to show (int)",
    ),
    "up of 1e300": ({'"left"': '"left"\nup = [0.0, 1e300, 0.0]'}, "not unit vectors"),
    "lists 200 deep": ({"[450, -330, -40]": "[" * 200 + "]" * 200}, "mechanism.points.lower_ball_joint"),
    "table of values too far apart": ({RACK: STEEP}, NO_SPLINE),
    "table of times too close": ({RACK: CLOSE}, NO_SPLINE),
    "key that steers a terminal": (
        {"samples = 131": 'samples = 131\n"\\u001b[31m\\u202e\\n" = 1'},
        r"time.\x1b[31m\u202e\n: there is no such key; allowed: start, stop, samples",
    ),
    "stop at 1e308 s": ({"stop = 2.6": "stop = 1e308"}, "time: stop is 1e+308 s; allowed: -1e+15 to 1e+15 s"),
}
# What once ended in a warning, a hang or a wrong verdict of the comparison.
SOLVED: dict[str, dict[str, str]] = {
    "byte order mark": {"title = ": "\ufefftitle = "},
    # Added to the angle, such a phase swallowed the time: values stood still while rates said they moved.
    "sine of a huge phase": {
        RACK: "{ sine = { amplitude = 20.0, angular_frequency = 1.0, phase = -3e272 } }"
    },
    # The kingpin angles of a strut that hangs upside down were a whole turn apart.
    "car upside down": {'"left"': '"right"\nup = [0.0, 0.6, -0.8]\nright = [0.0, -0.8, -0.6]'},
    # The series' unit of time was the motion's own, and its square was lost.
    "motion of 1e-200 s": {"stop = 2.6": "stop = 1e-200"},
    # Some instants lay after the stop.
    "motion of 1e-320 s": {"stop = 2.6": "stop = 1e-320"},
    "inputs held for 1e15 s": {ARM: "{ constant = 1.5 }", "stop = 2.6": "stop = 1e15"},
    # Their difference is one rounding, and the tolerance made of them was 0.
    "rates below the smallest normal number": {ARM: "{ polynomial = [1.5, 1e-320] }"},
}


def _bounce_with(folder: Path, changes: dict[str, str]) -> str:
    text = BOUNCE
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("case", REFUSED)
def test_files_that_once_broke_the_program_are_refused(case: str, tmp_path: Path) -> None:
    changes, words = REFUSED[case]
    seen = run("simulate", _bounce_with(tmp_path, changes), "-o", str(tmp_path / "motion.npz"))
    assert (seen.status, len(seen.err.splitlines())) == (2, 1)
    assert words in seen.err


@pytest.mark.parametrize("case", SOLVED)
def test_files_that_once_broke_the_program_are_solved_and_agree(case: str, tmp_path: Path) -> None:
    seen = run("validate", _bounce_with(tmp_path, SOLVED[case]))
    assert (seen.status, complaints(seen.err)) == (0, []), seen.out


def test_inputs_that_overflow_are_refused_by_the_absolute_model_as_well(tmp_path: Path) -> None:
    path = _bounce_with(tmp_path, {RACK: f"{{ polynomial = {[1e-3] * 2000} }}"})
    seen = run("validate", path, "--first", "absolute", "--second", "pointcoord")
    assert (seen.status, len(seen.err.splitlines())) == (3, 1)
    assert "all its numbers must be finite" in seen.err


def test_a_strut_that_lies_flat_defeats_the_printed_formulas_only(tmp_path: Path) -> None:
    flat = {
        "[460, -180, 470]": "[460, 200, 20]",
        "[456, -250, 246]": "[456, -50, 20]",
        "strut_lower      = [452, -320, 20]": "strut_lower = [451, -270, 20]",
        "[450, -330, -40]": "[450, -330, 20]",
        ARM: "{ polynomial = [1.4, 0.1] }",
        "stop = 2.6": "stop = 0.1",
    }
    path = _bounce_with(tmp_path, flat)
    seen = run("validate", path)
    assert (seen.status, complaints(seen.err)) == (0, [])
    assert "1 of 1 scene agrees" in seen.out
    seen = run("validate", path, "--second", "printed")
    assert (seen.status, len(seen.err.splitlines())) == (3, 1)
    assert "; refused by printed (" in seen.err
    assert seen.err.endswith("; solved by pointcoord\n")
