"""The program in a process of its own: pipes, full disks, closed streams, signals, little memory."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import pytest
from program import ENVIRONMENT, PROGRAM, ROOT, complaints, in_shell, run, short_scene

LONG = "400000"  # samples that take far longer than any test waits


def only_line(err: str) -> str:
    (line,) = complaints(err)
    return line


@pytest.mark.parametrize(
    ("words", "status", "script", "said"),
    [
        # `head -0` has gone before the first line comes; that does not change the status.
        *(
            (words, status, '"$@" | head -0; exit ${PIPESTATUS[0]}', "")
            for words, status in (
                ("validate SHORT --second printed", 1),
                ("--help", 0),
            )
        ),
        ("--help", 4, '"$@" >/dev/full', "standard output: cannot be written (No space left on device)"),
        # Before anything is solved.
        ("validate LONG", 4, '"$@" >&-', "standard output: is closed; use --quiet"),
        ("validate SHORT -q --json OUT", 0, '"$@" >&-', ""),
        # Nothing but JSON is on standard output.
        ("validate SHORT no-such-scene --json -", 2, '"$@" 2>&- >OUT', ""),
        ("plan -", 2, '"$@" <&-', "standard input: cannot be read"),
        ("validate - -q --json OUT", 0, '"$@" <short.toml', ""),
        ("simulate -", 2, '"$@" <bad.toml', "pointcoord: standard input: time.samples: "),
        ("validate LARGE", 4, 'ulimit -v 700000; exec "$@"', "try fewer samples"),
        # A module that is compiled here would be cut short for all that come later.
        (
            "simulate bounce -o OLD.csv",
            4,
            'ulimit -f 4; PYTHONDONTWRITEBYTECODE=1 exec "$@"',
            "cannot be written (File too large)",
        ),
    ],
)
def test_what_happens_to_the_streams_of_a_run_is_a_status_and_at_most_one_line(
    words: str, status: int, script: str, said: str, tmp_path: Path
) -> None:
    places = {
        "SHORT": short_scene(tmp_path),
        "BAD": short_scene(tmp_path, "bad.toml", samples="0"),
        "LONG": short_scene(tmp_path, "long.toml", samples=LONG),
        "LARGE": short_scene(tmp_path, "large.toml", samples="10000000"),
        **{name: str(tmp_path / name) for name in ("OUT", "OLD.csv")},
    }
    (tmp_path / "OLD.csv").write_text("old")
    done = in_shell(script, *(places.get(word, word) for word in words.split()), cwd=tmp_path)
    assert done.returncode == status, done.stderr
    if said:
        assert said in only_line(done.stderr)
    else:
        assert complaints(done.stderr) == []
    if "ulimit -f" in script:
        assert (tmp_path / "OLD.csv").read_text() == "old"
    assert not list(tmp_path.glob(".pointcoord-*"))
    if "OUT" in words + script:
        assert json.loads((tmp_path / "OUT").read_text())["exit_status"] == status


def test_a_terminal_of_ascii_shows_other_characters_as_escapes(tmp_path: Path) -> None:
    scene = short_scene(tmp_path, "é\x1b[31m.toml", title='"Größe \\u001b[2J \\u202e"')
    done = run(
        "plan", scene, env=ENVIRONMENT | {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    )
    assert (done.returncode, complaints(done.stderr)) == (0, [])
    assert "Gr\\xf6\\xdfe \\x1b[2J \\u202e" in done.stdout.splitlines()[0]
    assert done.stdout.isascii()
    assert "\x1b" not in done.stdout


def started(*words: str) -> subprocess.Popen[str]:
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen([*PROGRAM, *words], text=True, env=ENVIRONMENT, cwd=ROOT, **streams)


ENDS = [
    (signal.SIGINT, 130, "interrupted"),
    (signal.SIGTERM, 143, "terminated"),
    (signal.SIGKILL, -9, ""),
]


@pytest.mark.parametrize(("end", "status", "word"), ENDS[1:])
def test_an_ended_run_is_one_line_and_what_is_finished_is_in_the_file(
    end: signal.Signals, status: int, word: str, tmp_path: Path
) -> None:
    target = tmp_path / "out.json"
    scenes = [short_scene(tmp_path), short_scene(tmp_path, "long.toml", samples=LONG)]
    process = started("validate", *scenes, "--json", str(target))
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
    if word:  # nobody hears of a kill
        assert only_line(err) == f"pointcoord: {word}; {target} holds 1 of 2 scenes"
        assert (left["exit_status"], left["verdict"]) == (status, word)


def test_ctrl_c_before_anything_is_finished_leaves_the_old_file_whole(tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    target.write_text("old")
    words = ("--method", "newton-cold", "-o", str(target))  # each instant by itself
    process = started("simulate", short_scene(tmp_path, samples=LONG), *words)
    # It solves after a second of work: time on a clock would tell what else the machine does.
    stat, worked = Path(f"/proc/{process.pid}/stat"), 0.0
    while worked < 1.5 and process.poll() is None:
        worked = sum(map(int, stat.read_text().split()[13:15])) / os.sysconf("SC_CLK_TCK")
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert only_line(err) == "pointcoord: interrupted; nothing is written"
    assert target.read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize(("end", "status", "word"), ENDS[:2])
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


def test_signals_are_handled_before_typing_or_any_library_is_imported() -> None:
    program = (
        f"import sys; sys.path.insert(0, {str(ROOT)!r}); import pointcoord.__main__; print(*sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", program], capture_output=True, text=True, check=True
    )
    assert not {"typing", "numpy"} & set(done.stdout.split())


GONE = "raise ModuleNotFoundError(name=__name__)\n"
NOT_LOADED = "libgomp.so.1: cannot open shared object file"


def with_files(folder: Path, files: Mapping[str, str], *words: str) -> subprocess.CompletedProcess[str]:
    """Run the program with files in a folder that is first on the path."""
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    return run(*words, env=ENVIRONMENT | {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"}, cwd=folder)


def test_a_validate_of_another_distribution_is_told_by_name(tmp_path: Path) -> None:
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
STANDS_IN = f"absolute is not available, {{0}} is used instead: {NEEDS}"


@pytest.mark.parametrize(
    ("hidden", "words", "status", "said"),
    [
        # A library of the system is lacking.
        (
            {"pinocchio": f"raise ImportError({NOT_LOADED!r})\n"},
            "validate steer --second absolute",
            2,
            [f"installed but does not load ({NOT_LOADED})", "install the system package"],
        ),
        ("pinocchio", "validate n-four-bar", 0, [STANDS_IN.format("mujoco"), "1 of 1 scene agrees"]),
        (
            "pinocchio mujoco exudyn",
            "validate slider-crank n-four-bar",
            0,
            [
                STANDS_IN.format("reference"),
                "pointcoord and reference; pointcoord-newton and reference: 2 scenes",
            ],
        ),
        ("pinocchio", "validate steer --second absolute", 2, [NEEDS, "pip install 'pointcoord[validate]'"]),
        # Hard cases are tried by what is there.
        (
            "pinocchio",
            "hard arm-hardly-moves",
            0,
            [f"absolute is left out: {NEEDS}", "relative is left out: ", "All as expected"],
        ),
    ],
)
def test_without_a_library_what_is_there_answers_and_that_is_said(
    hidden: str | dict[str, str], words: str, status: int, said: list[str], tmp_path: Path
) -> None:
    modules = dict.fromkeys(hidden.split(), GONE) if isinstance(hidden, str) else hidden
    done = with_files(tmp_path, {f"{name}.py": text for name, text in modules.items()}, *words.split())
    assert done.returncode == status, done.stderr
    assert [part for part in said if part not in done.stdout + done.stderr] == []
    assert ("pip install" in done.stderr) != (NOT_LOADED in done.stderr)


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
