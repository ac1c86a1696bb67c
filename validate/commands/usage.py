"""What commands share: scenes and values of the command line, and checks of the files that it names."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

import pointcoord as pc
from pointcoord import Scene, SceneError, WrongArgument
from validate.arrays import Array
from validate.errors import NotSolved, UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.files import require_known_ending, require_writable, write_content
from validate.plain_text import shown

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
SCENE_HELP = "a built-in scene's name, the path of a scene file, or - for standard input"
RESULTS = ("-o", "--mjcf", "--json", "--csv", "--junit", "--summary", "--save-baseline")
"""The options that name a result, of any command."""
READ = ("--scenes-dir", "--data", "--map", "--designs", "--baseline", "--names", "--hard", "--cost")
"""The options that name what a command reads, of any command."""
MOST_VALUES = 10_000_000
# The errors of a scene that is well written, and whose mechanism cannot follow its inputs.
STOPS = (
    *(pc.AssemblyError, pc.InputOutOfRange, pc.MechanismError),
    *(pc.NotCovered, pc.NotFollowed, pc.SingularConfiguration),
)


def value_of(options: argparse.Namespace, name: str) -> Any:
    """The value of an option or an argument; None if the command does not have it."""
    return getattr(options, {"-o": "output"}.get(name, name.lstrip("-").replace("-", "_")), None)


def given(options: argparse.Namespace, *names: str) -> list[str]:
    """The names, of `names`, that the command line gives."""
    return [name for name in names if value_of(options, name) not in (None, False, [])]


def require_files(options: argparse.Namespace, console: Console) -> None:
    """Check the files that a command line names, before the command runs.

    Each result needs a place of its own that can be written. Standard input can be one scene only. If a
    result goes to standard output, the console prints nothing else there.

    Raises:
        UsageError: an option names no file, a result names a file that is read, or two results are the same
            file; standard input is given twice, or as a file of results.
        NotFinished: a result cannot be written.
    """
    if (value_of(options, "scenes") or []).count(STANDARD_INPUT) > 1:
        raise UsageError("standard input (-) is given as a scene more than once; it can be read once")
    if STANDARD_INPUT in (value_of(options, "--data"), value_of(options, "--map")):
        raise UsageError("--data and --map read files; standard input (-) can be the scene only")
    for option in given(options, *READ):
        # As by the variable of a script that is not set; '' would be the current folder.
        if not (place := value_of(options, option)).strip():
            raise UsageError(f"{option} {place!r} names nothing to read; allowed: a path")
    # The rows of `cost` are measured, or read with --from-rows; those of `table` are a number.
    results = RESULTS if getattr(options, "from_rows", True) else (*RESULTS, "--rows")
    places: dict[str, str] = {}
    for option in given(options, *results):
        target = value_of(options, option)
        if not target.strip():
            raise UsageError(
                f"{option} {target!r} names no file; allowed: the path of a file, or - for standard output"
            )
        if _is_read(target, option, options):
            raise UsageError(
                f"{option} {target} would overwrite a scene or file that is read; give another file"
            )
        other = places.setdefault(target if target == "-" else os.path.realpath(target), option)
        if other != option:
            raise UsageError(f"{other} and {option} are both {shown(target)}; give each a file of its own")
    console.quiet, console.mute = getattr(options, "quiet", False), "-" in places
    for option in places.values():
        if (target := value_of(options, option)) != "-":
            require_writable(target)


def _is_read(target: str, option: str, options: argparse.Namespace) -> bool:
    """Whether the result of an option would overwrite a file that the run reads, or a scene of its folder."""
    # A new baseline may replace the one that the run is compared with.
    others = [one for one in READ if (one, option) != ("--baseline", "--save-baseline")]
    rows = ["--rows"] if getattr(options, "from_rows", False) else []
    for one in given(options, "scene", "scenes", "file", *others, *rows) if os.path.isfile(target) else ():
        value = value_of(options, one)
        for read in [value] if isinstance(value, str) else value:
            if os.path.isdir(read):
                same = target.endswith(".toml") and Path(read).resolve() in Path(target).resolve().parents
            else:
                same = os.path.isfile(read) and os.path.samefile(target, read)
            if same:
                return True
    return False


def place_of_picture(options: argparse.Namespace, console: Console) -> str:
    """The file of a picture, - for standard output.

    If none is given and standard output is a terminal, which shows no pictures, a new file name is chosen and
    printed.

    Raises:
        UsageError, NotFinished: see `require_files`.
    """
    if options.output is None:
        options.output = "-"
        if sys.stdout is not None and sys.stdout.isatty():
            stem = "picture" if options.scene == STANDARD_INPUT else Path(options.scene).stem
            names = (f"{stem}.svg" if number == 1 else f"{stem}-{number}.svg" for number in count(1))
            options.output = next(name for name in names if not os.path.lexists(name))
            console.note(f"the picture goes to {shown(options.output)}; -o FILE names another file")
        require_files(options, console)
    return str(options.output)


def to_be_filled_in(target: str, text: str, console: Console) -> ExitStatus:
    """Write a form for a file that an option names and that does not exist, and ask to fill it in.

    Raises:
        UsageError: its name does not end in .toml. NotFinished: it cannot be written.
    """
    require_known_ending(target, (".toml",))
    write_content(target, text)
    console.complain(
        f"{shown(target)} did not exist, so a form is written there: fill it in, and run this again"
    )
    return ExitStatus.WRONG_INPUT


def name_of(scene: str) -> str:
    """The name of a scene in messages."""
    return STANDARD_INPUT_NAME if scene == STANDARD_INPUT else shown(scene)


@contextmanager
def named_scene(given: str, read: Callable[[str], Scene] | None = None) -> Iterator[tuple[Scene, str]]:
    """A scene that the command line names, and its name in messages.

    Within this context, an error of the scene names it as the command line does, not by its title.
    A motion that cannot be solved ends the command without a verdict.

    Args:
        read: reads the scene; `load_scene` if not given.
    Raises:
        SceneError: there is no such scene, or it is wrong.
        NotSolved: its mechanism cannot follow its inputs.
    """
    scene, name = (read or load_scene)(given), name_of(given)
    try:
        yield scene, name
    except SceneError as error:
        raise error.of(name) from error
    except STOPS as error:
        raise NotSolved(f"{name}: {error}") from error


def load_scene(name: str) -> Scene:
    """Read a scene that the command line names.

    Raises:
        SceneError: there is no such scene, or its content is wrong.
    """
    if not name:
        raise SceneError("''", "", "names no scene", SCENE_HELP)
    if name != STANDARD_INPUT:
        return Scene.load(name)
    if sys.stdin is None:
        raise SceneError(STANDARD_INPUT_NAME, "", "cannot be read (it is closed)", SCENE_HELP)
    return Scene.read(sys.stdin.buffer, STANDARD_INPUT_NAME)


def values_of(what: str, text: str, examples: str) -> Array:
    """START:STOP:COUNT or A,B,C as finite numbers.

    Args:
        what: the option that gives them, for messages.
        examples: what is allowed, for messages.
    Raises:
        WrongArgument: the text is neither.
    """
    parts = text.split(":")
    if len(parts) == 1:
        return finite(what, text.split(","), examples)
    start, stop = finite(what, parts[:2], examples).tolist()
    number, least = parts[-1].strip(), 1 if start == stop else 2
    if len(parts) != 3 or not (number.isdecimal() and least <= int(number) <= MOST_VALUES):
        allowed = f"START:STOP:COUNT, with a COUNT of {least} to {MOST_VALUES}"
        raise WrongArgument(what, "is not a range", allowed)
    return np.linspace(start, stop, int(number))


def finite(what: str, texts: Sequence[str], examples: str) -> Array:
    """Finite numbers from their texts, see `values_of`.

    Raises:
        WrongArgument: a text is not a finite number.
    """
    found = []
    for text in texts:
        try:
            found.append(float(text))
        except ValueError:
            raise WrongArgument(what, f"has {shown(text)!r}, which is not a number", examples) from None
    if not np.isfinite(found).all():
        raise WrongArgument(what, "has a number that is not finite", examples)
    return np.array(found)
