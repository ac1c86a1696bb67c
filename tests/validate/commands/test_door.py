"""The program in a process of its own: pipes, full disks, closed streams, signals, little memory."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from program import ENVIRONMENT, PAST_ITS_END, PROGRAM, ROOT, complaints, in_shell, run, short_scene

LONG = "400000"  # samples that take far longer than any test waits


def only_line(err: str) -> str:
    (line,) = complaints(err)
    return line


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["validate", "SHORT", "--second", "printed"], 1),
        (["validate", "SHORT", "--second", "printed", "--json", "-"], 1),
        (["simulate", "bounce"], 0),
        (["plan", "SHORT"], 0),
        (["draw", "SHORT"], 0),
        (["scenes"], 0),
        (["hard", "--list"], 0),
        (["--help"], 0),
    ],
)
def test_a_reader_that_goes_away_does_not_change_the_status(
    words: list[str], status: int, tmp_path: Path
) -> None:
    scene = short_scene(tmp_path)
    words = [scene if word == "SHORT" else word for word in words]
    # `head -0` has gone before the first line comes.
    done = in_shell('"$@" | head -0; exit ${PIPESTATUS[0]}', *words)
    assert (done.returncode, complaints(done.stderr)) == (status, [])


@pytest.mark.parametrize(
    "words",
    [["validate", "SHORT", "--second", "printed"], ["simulate", "SHORT"], ["--help"], ["hard", "--list"]],
)
def test_a_full_standard_output_is_one_line_and_status_4(words: list[str], tmp_path: Path) -> None:
    scene = short_scene(tmp_path)
    done = in_shell('"$@" >/dev/full', *(scene if word == "SHORT" else word for word in words))
    assert done.returncode == 4
    assert "standard output: cannot be written (No space left on device)" in only_line(done.stderr)


def test_a_closed_standard_output_is_found_before_anything_is_solved(tmp_path: Path) -> None:
    scene = short_scene(tmp_path, samples=LONG)
    done = in_shell('"$@" >&-', "validate", scene)
    assert done.returncode == 4
    assert "standard output: is closed; use --quiet" in only_line(done.stderr)


def test_a_closed_standard_output_does_not_matter_to_a_quiet_run(tmp_path: Path) -> None:
    target = tmp_path / "out.json"
    words = ["validate", short_scene(tmp_path), "--second", "printed", "--quiet", "--json", str(target)]
    done = in_shell('"$@" >&-', *words)
    assert (done.returncode, done.stderr) == (1, "")
    assert json.loads(target.read_text())["verdict"] == "disagree"


def test_nothing_but_json_is_on_standard_output_even_if_standard_error_is_closed(tmp_path: Path) -> None:
    words = ["validate", short_scene(tmp_path), "no-such-scene", "--json", "-"]
    done = in_shell('"$@" 2>&-', *words)
    assert done.returncode == 2
    assert len(json.loads(done.stdout)["scenes"]) == 2


def test_a_closed_standard_input_is_no_scene() -> None:
    done = in_shell('"$@" <&-', "plan", "-")
    assert done.returncode == 2
    assert "standard input: cannot be read" in only_line(done.stderr)


def test_a_scene_comes_from_standard_input(tmp_path: Path) -> None:
    scene = Path(short_scene(tmp_path))
    done = run("validate", "-", "--json", "-", input=scene.read_text())
    assert done.returncode == 0
    assert json.loads(done.stdout)["scenes"][0]["scene"] == "-"
    done = run("simulate", "-", input=scene.read_text().replace("samples = 5", "samples = 0"))
    assert done.returncode == 2
    assert only_line(done.stderr).startswith("pointcoord: standard input: time.samples: ")


def test_a_terminal_of_ascii_shows_other_characters_as_escapes(tmp_path: Path) -> None:
    scene = short_scene(tmp_path, "é\x1b[31m.toml", title='"Größe \\u001b[2J \\u202e"')
    for more in (
        {"PYTHONIOENCODING": "ascii"},
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    ):
        done = run("plan", scene, env=ENVIRONMENT | more)
        assert (done.returncode, complaints(done.stderr)) == (0, [])
        assert "Gr\\xf6\\xdfe \\x1b[2J \\u202e" in done.stdout.splitlines()[0]
        assert done.stdout.isascii()
        assert "\x1b" not in done.stdout


def test_memory_that_runs_out_is_one_line_and_status_4(tmp_path: Path) -> None:
    scene = short_scene(tmp_path, samples="10000000")
    done = in_shell('ulimit -v 700000; exec "$@"', "validate", scene)
    assert done.returncode == 4
    assert "out of memory" in only_line(done.stderr)
    assert "try fewer samples" in done.stderr


def test_a_file_that_grows_too_large_leaves_the_old_one_whole(tmp_path: Path) -> None:
    for name in ("out.csv", "out.npz"):
        target = tmp_path / name
        target.write_text("old")
        done = in_shell('ulimit -f 4; exec "$@"', "simulate", "bounce", "-o", str(target))
        assert done.returncode == 4
        assert f"{target}: cannot be written (File too large)" in only_line(done.stderr)
        assert target.read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.csv", "out.npz"]


def started(*words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*PROGRAM, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=ENVIRONMENT,
        cwd=ROOT,
    )


def waited_for(path: Path) -> None:
    late = time.monotonic() + 60
    while not path.exists() and time.monotonic() < late:
        time.sleep(0.01)


ENDS = [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]


@pytest.mark.parametrize(("end", "status", "word"), ENDS)
def test_ctrl_c_and_sigterm_are_one_line_and_what_is_finished_is_in_the_file(
    end: signal.Signals, status: int, word: str, tmp_path: Path
) -> None:
    target = tmp_path / "out.json"
    scenes = [short_scene(tmp_path), short_scene(tmp_path, "long.toml", samples=LONG)]
    process = started("validate", *scenes, "--json", str(target))
    waited_for(target)
    going = json.loads(target.read_text())
    assert (going["complete"], going["exit_status"], going["verdict"]) == (False, None, None)
    process.send_signal(end)
    _, err = process.communicate(timeout=60)
    assert process.returncode == status
    assert only_line(err) == f"pointcoord: {word}; {target} holds 1 of 2 scenes"
    left = json.loads(target.read_text())
    assert (left["complete"], left["exit_status"], left["verdict"]) == (False, status, word)
    assert [scene["verdict"] for scene in left["scenes"]] == ["agree"]


def test_a_kill_leaves_what_is_finished_in_the_file(tmp_path: Path) -> None:
    target = tmp_path / "out.json"
    scenes = [short_scene(tmp_path), short_scene(tmp_path, "long.toml", samples=LONG)]
    process = started("validate", *scenes, "--quiet", "--json", str(target))
    waited_for(target)
    process.kill()
    process.communicate(timeout=60)
    left = json.loads(target.read_text())
    assert (left["complete"], len(left["scenes"])) == (False, 1)


def test_ctrl_c_before_anything_is_finished_leaves_the_old_file_whole(tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    process = started("simulate", short_scene(tmp_path, samples=LONG), "-o", str(target))
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert only_line(err) == "pointcoord: interrupted; nothing is written"
    assert target.read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize(("end", "status", "word"), ENDS)
def test_ctrl_c_and_sigterm_while_the_program_starts_are_one_line(
    end: signal.Signals, status: int, word: str
) -> None:
    program = (
        "import os, signal, sys, threading, time\n"
        "from pointcoord.__main__ import main\n"
        "def press():\n"
        "    while 'numpy' not in sys.modules: time.sleep(0.001)\n"
        f"    os.kill(os.getpid(), {int(end)})\n"
        "threading.Thread(target=press, daemon=True).start()\n"
        "sys.argv[1:] = ['validate']\n"
        "sys.exit(main())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=ENVIRONMENT, check=False
    )
    assert done.returncode == status
    assert only_line(done.stderr) == f"pointcoord: {word}; nothing is written"


def test_a_refused_motion_on_standard_output_says_how_far_it_goes(tmp_path: Path) -> None:
    done = run("simulate", short_scene(tmp_path, samples="27", **PAST_ITS_END))
    assert done.returncode == 3
    times = [float(line.split(",")[0]) for line in done.stdout.splitlines()[1:]]
    assert np.allclose(np.diff(times), 0.1)
    said = only_line(done.stderr)
    assert said.endswith(f", {len(times)} instants up to t = {times[-1]:.10g} s, is on standard output")


@pytest.mark.parametrize("module", ["pointcoord", "validate", "validate.cli"])
def test_the_package_itself_is_the_program(module: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", module, "scenes"],
        capture_output=True, text=True, env=ENVIRONMENT, cwd=ROOT, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert "bounce" in done.stdout


def with_fake(folder: Path, *words: str, program: str = "pointcoord") -> subprocess.CompletedProcess[str]:
    """Run the program with a folder first on the path."""
    env = ENVIRONMENT | {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"}
    return subprocess.run(
        [sys.executable, "-m", program, *words],
        capture_output=True,
        text=True,
        env=env,
        cwd=folder,
        check=False,
    )


@pytest.mark.parametrize("kind", ["module", "package"])
def test_a_validate_of_another_distribution_is_told_by_name(kind: str, tmp_path: Path) -> None:
    if kind == "module":
        (tmp_path / "validate.py").write_text("")
        files = "validate.py,,\n"
    else:
        (tmp_path / "validate").mkdir()
        (tmp_path / "validate" / "__init__.py").write_text("")
        files = "validate/__init__.py,,\n"
    (tmp_path / "configthing-1.0.dist-info").mkdir()
    (tmp_path / "configthing-1.0.dist-info" / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: configthing\n"
    )
    (tmp_path / "configthing-1.0.dist-info" / "RECORD").write_text(files)
    done = with_fake(tmp_path, "scenes")
    assert done.returncode == 2
    line = only_line(done.stderr)
    assert "'configthing'" in line
    assert "pip uninstall configthing, then pip install --force-reinstall --no-deps pointcoord" in line


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ("pointcoord", ["hard", "--list"]),
        ("pointcoord", ["study", "random", "--records", "x"]),
    ],
)
def test_without_the_extra_one_line_names_it(program: str, words: list[str], tmp_path: Path) -> None:
    missing = 'raise ModuleNotFoundError("No module named \'flint\'", name="flint")\n'
    (tmp_path / "flint.py").write_text(missing)
    done = with_fake(tmp_path, *words, program=program)
    assert (done.returncode, done.stdout) == (2, "")
    line = only_line(done.stderr)
    assert "'flint'" in line
    assert "pip install 'pointcoord[validate]'" in line


@pytest.mark.parametrize(
    "words", [["simulate", "steer"], ["plan", "steer"], ["scenes"], ["draw", "steer"], ["sweep", "--help"]]
)
def test_solving_needs_no_extra(words: list[str], tmp_path: Path) -> None:
    for name in ("mpmath", "flint", "pinocchio", "threadpoolctl"):
        (tmp_path / f"{name}.py").write_text(f"raise ModuleNotFoundError(name={name!r})\n")
    done = with_fake(tmp_path, *words)
    assert done.returncode == 0, done.stderr


def test_every_module_says_which_extra_it_lacks() -> None:
    program = (
        "import importlib, pkgutil, sys\n"
        "missing = ('mpmath', 'flint', 'pinocchio', 'eigenpy', 'hypothesis', 'matplotlib')\n"
        "sys.modules.update(dict.fromkeys(missing))\n"
        "import validate\n"
        "for found in pkgutil.walk_packages(validate.__path__, 'validate.', onerror=lambda name: None):\n"
        "    try:\n"
        "        importlib.import_module(found.name)\n"
        "    except ImportError as error:\n"
        "        print(found.name, 'pip install' in str(error) and 'pointcoord[' in str(error), error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env=ENVIRONMENT,
        check=True,
        timeout=120,
    )
    lines = done.stdout.splitlines()
    assert len(lines) > 20  # the reference, the hard cases and the studies need them
    assert [line for line in lines if line.split()[1] != "True"] == []


def test_standard_output_by_another_name_is_not_written_twice(tmp_path: Path) -> None:
    scene, target = short_scene(tmp_path), tmp_path / "out.txt"
    for name in ("/dev/stdout", str(target)):
        done = in_shell(f'"$@" > {target}', "validate", scene, "--json", name)
        assert done.returncode == 2
        assert f"--json {name} is standard output; use --json - for that" in only_line(done.stderr)


def test_a_dash_is_standard_output_for_a_motion_too(tmp_path: Path) -> None:
    done = run("simulate", short_scene(tmp_path), "-o", "-")
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) == 6


@pytest.mark.parametrize("kind", ["/dev/zero", "pipe", "folder", "- of /dev/zero"])
def test_what_has_no_end_or_is_no_file_is_no_scene(kind: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    if kind.startswith("-"):
        done = in_shell('"$@" < /dev/zero', "validate", "-")
    else:
        done = run("validate", str(tmp_path / kind))
    assert done.returncode == 2
    assert "; allowed: " in only_line(done.stderr)
