"""The program in its own process: pipes, full disks, closed streams, signals, no memory, no library."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import pytest
from junit_schema import checked
from program import ENVIRONMENT, PROGRAM, ROOT, complaints, in_shell, run, short_scene

LONG = "400000"  # samples that take far longer than any test waits


def only_line(err: str) -> str:
    (line,) = complaints(err)
    return line


def python(program: str, *options: str, **more: object) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, *options, "-c", program]
    return subprocess.run(
        words, capture_output=True, text=True, env=ENVIRONMENT, check=False, timeout=120, **more
    )


@pytest.mark.parametrize(
    ("line", "status", "said"),
    [
        # `head -0` has gone before the first line comes; that does not change the status.
        ("pointcoord validate short.toml --second printed | head -0; exit ${PIPESTATUS[0]}", 1, ""),
        ("pointcoord --help | head -0; exit ${PIPESTATUS[0]}", 0, ""),
        ("pointcoord --help >/dev/full", 4, "standard output: cannot be written (No space left on device)"),
        # Before anything is solved.
        ("pointcoord validate long.toml >&-", 4, "standard output: is closed; use --quiet"),
        ("pointcoord validate short.toml -q --json OUT >&-", 0, ""),
        # Nothing but JSON is on standard output.
        ("pointcoord validate short.toml no-such-scene --json - 2>&- >OUT", 2, ""),
        ("pointcoord plan - <&-", 2, "standard input: cannot be read"),
        ("pointcoord validate - -q --json OUT <short.toml", 0, ""),
        ("pointcoord simulate - <bad.toml", 2, "pointcoord: standard input: time.samples: "),
        ("ulimit -v 700000; pointcoord validate large.toml", 4, "try fewer samples"),
        # A module that is compiled here would be cut short for all that come later.
        (
            "ulimit -f 4; PYTHONDONTWRITEBYTECODE=1 pointcoord simulate bounce -o OLD.csv",
            4,
            "cannot be written (File too large)",
        ),
    ],
)
def test_what_happens_to_the_streams_of_a_run_is_a_status_and_at_most_one_line(
    line: str, status: int, said: str, tmp_path: Path
) -> None:
    for name, samples in (("short", "5"), ("bad", "0"), ("long", LONG), ("large", "10000000")):
        short_scene(tmp_path, f"{name}.toml", samples=samples)
    (tmp_path / "OLD.csv").write_text("old")
    done = in_shell(line, cwd=tmp_path)
    assert done.returncode == status, done.stderr
    if said:
        assert said in only_line(done.stderr)
    else:
        assert complaints(done.stderr) == []
    assert (tmp_path / "OLD.csv").read_text() == "old"
    assert not list(tmp_path.glob(".pointcoord-*"))
    if "OUT" in line:
        assert json.loads((tmp_path / "OUT").read_text())["exit_status"] == status


def test_a_terminal_of_ascii_shows_other_characters_as_escapes(tmp_path: Path) -> None:
    scene = short_scene(tmp_path, "é\x1b[31m.toml", title='"Größe \\u001b[2J \\u202e"')
    ascii_only = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    done = run("plan", scene, env=ENVIRONMENT | ascii_only)
    assert (done.returncode, complaints(done.stderr)) == (0, [])
    assert "Gr\\xf6\\xdfe \\x1b[2J \\u202e" in done.stdout.splitlines()[0]
    assert done.stdout.isascii()
    assert "\x1b" not in done.stdout


ENDS = [
    (signal.SIGINT, 130, "interrupted"),
    (signal.SIGTERM, 143, "terminated"),
    (signal.SIGKILL, -9, ""),
]


@pytest.mark.parametrize(("end", "status", "word"), ENDS)
def test_an_ended_run_is_one_line_and_what_is_finished_is_in_the_file(
    end: signal.Signals, status: int, word: str, tmp_path: Path
) -> None:
    target, xml, summary, baseline = (tmp_path / f"out.{ending}" for ending in ("json", "xml", "md", "npz"))
    scenes = [short_scene(tmp_path), short_scene(tmp_path, "long.toml", samples=LONG)]
    words = [*PROGRAM, "validate", *scenes, "--second", "absolute", "--json", str(target)]
    words += ["--junit", str(xml), "--summary", str(summary), "--save-baseline", str(baseline)]
    words += ["--report", str(tmp_path / "page")]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = subprocess.Popen(words, text=True, env=ENVIRONMENT, cwd=ROOT, **streams)
    late = time.monotonic() + 60
    while not target.exists() and time.monotonic() < late:
        time.sleep(0.01)
    going = json.loads(target.read_text())
    assert (going["complete"], going["exit_status"], going["verdict"]) == (False, None, None)
    process.send_signal(end)
    _, err = process.communicate(timeout=60)
    assert process.returncode == status
    left = json.loads(target.read_text())
    assert (left["complete"], [scene["verdict"] for scene in left["scenes"]]) == (False, ["agree"])
    assert not baseline.exists()
    if word:  # nobody hears of a kill
        *_, kept, page, ended = err.splitlines()
        for file, line in ((baseline, kept), (tmp_path / "page", page)):
            assert f"{file}: not written, because the run did not finish" in line
        assert ended.startswith(f"pointcoord: {word}; ")
        assert [f"{file} holds 1 of 2 scenes" in ended for file in (target, xml, summary)] == [True] * 3
        assert (left["exit_status"], left["verdict"]) == (status, word)
        suites = [suite.get("name") for suite in checked(xml.read_bytes())]
        assert suites == [f"{scenes[0]}: pointcoord and absolute", scenes[1]]
        assert f"**{word.capitalize()}**" in summary.read_text()


@pytest.mark.parametrize("module", ["validate.cli", "numpy"])
@pytest.mark.parametrize(("end", "status", "word"), ENDS[:2])
def test_ctrl_c_and_sigterm_while_the_program_starts_are_one_line(
    end: signal.Signals, status: int, word: str, module: str
) -> None:
    """They come as a module is imported: before the command line is there, and before the solver is."""
    done = python(
        "import os, sys\n"
        "from pointcoord.__main__ import main\n"
        "class Presses:\n"
        "    def find_spec(name, *_):\n"
        f"        if name == {module!r}: os.kill(os.getpid(), {int(end)})\n"
        "sys.meta_path.insert(0, Presses)\n"
        "sys.argv[1:] = ['validate']\n"
        "sys.exit(main())"
    )
    assert done.returncode == status
    assert only_line(done.stderr) == f"pointcoord: {word}; nothing is written"


def test_signals_are_handled_before_typing_or_any_library_is_imported() -> None:
    path = f"import sys; sys.path.insert(0, {str(ROOT)!r})"
    done = python(f"{path}; import pointcoord.__main__; print(*sys.modules)", "-I", "-S")
    assert "pointcoord.__main__" in done.stdout
    assert not {"typing", "numpy"} & {*done.stdout.split()}


GONE = "raise ModuleNotFoundError(name=__name__)\n"
NOT_LOADED = "libgomp.so.1: cannot open shared object file"


def with_files(folder: Path, files: Mapping[str, str], words: str) -> subprocess.CompletedProcess[str]:
    """Run the program with files in a folder that is first on the path."""
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    environment = ENVIRONMENT | {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"}
    return run(*words.split(), env=environment, cwd=folder)


def test_a_validate_of_another_distribution_is_named(tmp_path: Path) -> None:
    file = "validate/__init__.py"
    files = {
        file: "",
        "configthing-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: configthing\n",
        "configthing-1.0.dist-info/RECORD": f"{file},,\n",
    }
    done = with_files(tmp_path, files, "scenes")
    assert done.returncode == 2
    line = only_line(done.stderr)
    assert "'configthing'" in line
    assert "pip uninstall configthing, then pip install --force-reinstall --no-deps pointcoord" in line


NEEDS = "'absolute' needs the package 'pinocchio'"
INSTEAD = f"absolute is not available, {{0}} is used instead: {NEEDS}"


@pytest.mark.parametrize(
    ("hidden", "words", "status", "said"),
    [
        ("pinocchio", "validate steer --second absolute", 2, f"{NEEDS} | pip install 'pointcoord[validate]'"),
        ("pinocchio", "validate n-four-bar", 0, f"{INSTEAD.format('mujoco')} | 1 of 1 scene agrees"),
        (
            "pinocchio mujoco exudyn",
            "validate slider-crank n-four-bar",
            0,
            f"{INSTEAD.format('reference')} | pointcoord and reference; pointcoord-newton and reference: 2",
        ),
        # Hard cases are tried by the models that there are.
        (
            "pinocchio",
            "hard arm-hardly-moves",
            0,
            f"absolute is left out: {NEEDS} | relative is left out: | All as expected",
        ),
        # A library of the system is lacking.
        (
            "",
            "validate steer --second absolute",
            2,
            f"installed but does not load ({NOT_LOADED}) | install the system package",
        ),
    ],
)
def test_without_a_library_what_is_there_answers_and_that_is_said(
    hidden: str, words: str, status: int, said: str, tmp_path: Path
) -> None:
    files = {f"{name}.py": GONE for name in hidden.split()}
    files = files or {"pinocchio.py": f"raise ImportError({NOT_LOADED!r})\n"}
    done = with_files(tmp_path, files, words)
    assert done.returncode == status, done.stderr
    assert [part for part in said.split(" | ") if part not in done.stdout + done.stderr] == []
    assert ("pip install" in done.stderr) == bool(hidden)


def test_every_module_says_which_extra_it_lacks() -> None:
    done = python(
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
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) > 20  # the reference, the hard cases and the studies need them
    assert [line for line in lines if line.split()[1] != "True"] == []
