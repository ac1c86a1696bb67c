"""A terminal is shown tables that fit it, in colours, and progress; elsewhere there is plain text."""

import os
import pty
import re
import struct
import subprocess
import sys
from fcntl import ioctl
from pathlib import Path
from termios import TIOCSWINSZ

import pytest
from program import ENVIRONMENT, PROGRAM, ROOT, run

from validate.output import table

SLOW = "import time\nfrom validate.output.console import Console\nconsole = Console()\n{more}\n"
COLOURS = re.compile(r"\x1b\[[0-9;]*m")


def on_terminal(
    words: list[str], columns: int = 120, both: bool = True, folder: Path = ROOT, **more: str
) -> str:
    """What a pseudo-terminal is shown of a program: both of its outputs, or its results only."""
    ours, theirs = pty.openpty()
    ioctl(theirs, TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    dropped = {"NO_COLOR", "COLUMNS", "LINES", "FORCE_COLOR"}
    kept = {name: value for name, value in ENVIRONMENT.items() if name not in dropped}
    environment = {**kept, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path]), "TERM": "xterm-256color"}
    process = subprocess.Popen(
        words,
        stdin=theirs,
        stdout=theirs,
        stderr=theirs if both else subprocess.DEVNULL,
        env={**environment, **more},
        cwd=folder,
    )
    os.close(theirs)
    shown = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # what Linux says at the end of a terminal
            piece = b""
        if not piece:
            break
        shown += piece
    os.close(ours)
    assert process.wait(timeout=60) == 0, shown
    return shown.decode()


def validated(
    scene: str = "semi-trailing-arm", columns: int = 120, both: bool = False, folder: Path = ROOT, **more: str
) -> str:
    return on_terminal([*PROGRAM, "validate", "-v", scene], columns, both, folder, **more)


@pytest.fixture(scope="module")
def piped() -> str:
    return run("validate", "-v", "semi-trailing-arm").stdout


def cells(text: str) -> list[str]:
    """The words of a text without lines, colours and blanks."""
    return re.sub(r"-{3,}", " ", COLOURS.sub("", text)).split()


def test_a_terminal_shows_the_same_words_in_colours_and_a_dumb_one_what_a_pipe_has(piped: str) -> None:
    assert "\x1b" not in piped
    assert validated(both=True, TERM="dumb").replace("\r\n", "\n") == piped
    assert "\x1b[3" not in validated(NO_COLOR="1")
    shown = validated(columns=150)
    assert "\x1b[32magrees" in shown
    assert cells(shown) == cells(piped)
    # A narrow one shows every cell in full.
    assert {*cells(piped)} <= {*cells(validated(columns=45))}


def test_progress_comes_after_two_seconds_in_lines_of_its_own() -> None:
    work = "with console.progress('cases', total=3) as told:\n    told('first', 1)\n    time.sleep({0})\n"
    work += "console.say('the end')"
    program = [sys.executable, "-c"]
    long = on_terminal([*program, SLOW.format(more=work.format(2.6))])
    assert re.fullmatch(r"pointcoord: note: after \d s: first, 1 of 3 done\r\nthe end\r\n", long)
    assert on_terminal([*program, SLOW.format(more=work.format(0.1))]) == "the end\r\n"


def test_a_table_is_columns_of_text() -> None:
    made = table.Table(("name", "size", "verdict"), (("a", "1.5", "agrees"), ("long one", "10", "no")), 2)
    assert made.lines() == [
        "  name      size  verdict",
        "  --------  ----  -------",
        "  a          1.5  agrees",
        "  long one    10  no",
    ]


def test_a_wide_table_is_shown_in_bands_that_fit_and_have_the_inputs_each() -> None:
    shown = on_terminal([*PROGRAM, "table", "wheel-travel", "--rows", "3"], columns=90, both=False)
    lines = shown.replace("\r", "").splitlines()
    # What is positive is said in words, which may be folded.
    assert max(len(line) for line in lines if ": positive" not in line) <= 90
    heads = [line for line in lines if line.startswith("wheel_travel [mm]")]
    assert len(heads) > 2
    # Every number once, as in a pipe.
    names = [word for line in heads for word in line.split() if not word.startswith("[")]
    whole = run("table", "wheel-travel", "--rows", "3").stdout.splitlines()[0].split()
    once = [name for name in names if name != "wheel_travel"]
    assert once == [word for word in whole if not word.startswith("[") and word != "wheel_travel"]


def test_a_picture_is_no_text_on_a_terminal_but_a_file_that_is_named(tmp_path: Path) -> None:
    for name in ("steer.svg", "steer-2.svg"):
        shown = on_terminal([*PROGRAM, "draw", "steer"], folder=tmp_path)
        assert f"the picture goes to {name}; -o FILE names another file" in shown
        assert "<svg" not in shown
        assert "<svg" in (tmp_path / name).read_text(encoding="utf-8")
