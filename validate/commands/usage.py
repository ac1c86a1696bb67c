"""What commands share: reads scenes, and checks where results are written."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

from pointcoord import Scene, SceneError
from validate.errors import NotFinished, UsageError
from validate.exit_status import ExitStatus
from validate.extras import needed
from validate.output.console import STANDARD_OUTPUT, Console
from validate.output.files import require_known_ending, require_writable, write_content
from validate.plain_text import shown

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
SCENE_HELP = "a built-in scene's name, the path of a scene file, or - for standard input"
TOML = (".toml",)


def value_of(options: argparse.Namespace, name: str) -> Any:
    """The value of an option or an argument; None if the command does not have it."""
    return getattr(options, {"-o": "output"}.get(name, name.lstrip("-").replace("-", "_")), None)


def given(options: argparse.Namespace, *names: str) -> list[str]:
    """The names, of `names`, that the command line gives."""
    return [name for name in names if value_of(options, name) not in (None, False, [])]


def require_results(
    options: argparse.Namespace,
    console: Console,
    results: Sequence[str],
    read: Sequence[str | None] = (),
    endings: Collection[str] = (),
    says: bool = True,
) -> Any:
    """Check, before anything is solved, that every result has a place of its own that can be written.

    If a result goes to standard output, the console prints nothing else there. Returns the place of the first
    result, - for standard output; None if it is not given.

    Args:
        results: options that name a result file, or - for standard output; options not given are skipped.
        read: files and scenes that no result may overwrite.
        endings: allowed endings of the first result, which select its format; empty: any.
        says: whether the command prints on standard output in addition to its results.
    Raises:
        UsageError: a result names no file or a file that is read, two results are the same file, or an
            ending is unknown.
        MissingLibrary: Parquet needs pyarrow.
        NotFinished: a result cannot be written, or standard output is needed and closed.
    """
    found = {option: value_of(options, option) for option in results}
    wanted: dict[str, str] = {option: target for option, target in found.items() if target is not None}
    places: dict[str, str] = {}
    for option, target in wanted.items():
        if not target.strip():
            raise UsageError(
                f"{option} {target!r} names no file; allowed: the path of a file, or - for standard output"
            )
        for file in read:
            if file and os.path.isfile(target) and os.path.isfile(file) and os.path.samefile(target, file):
                raise UsageError(
                    f"{option} {target} would overwrite a scene or file that is read; give another file"
                )
        other = places.setdefault(target if target == "-" else os.path.realpath(target), option)
        if other != option:
            raise UsageError(f"{other} and {option} are both {shown(target)}; give each a file of its own")
    console.quiet, console.mute = getattr(options, "quiet", False), "-" in wanted.values()
    if sys.stdout is None and ((says and not console.quiet) or console.mute):
        instead = "use --quiet, and name files for results" if says else f"use {results[0]} FILE"
        raise NotFinished(STANDARD_OUTPUT, f"is closed; {instead}")
    for option, target in wanted.items():
        if target != "-":
            if endings and option == results[0]:
                require_known_ending(target, endings)
                if target.endswith(".parquet"):
                    needed(".parquet", "pyarrow.parquet")
            require_writable(target)
    return found[results[0]]


def place_of_picture(options: argparse.Namespace, endings: Collection[str], console: Console) -> str:
    """The file of a picture, - for standard output; checked to be writable.

    If none is given and standard output is a terminal, which shows no pictures, a new file name is chosen and
    printed.

    Raises:
        UsageError, NotFinished: see `require_results`.
    """
    if options.output is None:
        options.output = "-"
        if sys.stdout is not None and sys.stdout.isatty():
            stem = "picture" if options.scene == STANDARD_INPUT else Path(options.scene).stem
            names = (f"{stem}.svg" if number == 1 else f"{stem}-{number}.svg" for number in count(1))
            options.output = next(name for name in names if not os.path.lexists(name))
            console.note(f"the picture goes to {shown(options.output)}; -o FILE names another file")
    target: str = require_results(options, console, ("-o",), (options.scene,), endings, says=False)
    return target


def to_be_filled_in(target: str, text: str, console: Console) -> ExitStatus:
    """Write a form for a file that an option names and that does not exist, and ask to fill it in.

    Raises:
        UsageError: its name does not end in .toml. NotFinished: it cannot be written.
    """
    require_known_ending(target, TOML)
    write_content(target, text)
    console.complain(
        f"{shown(target)} did not exist, so a form is written there: fill it in, and run this again"
    )
    return ExitStatus.WRONG_INPUT


def name_of(scene: str) -> str:
    """The name of a scene in messages."""
    return STANDARD_INPUT_NAME if scene == STANDARD_INPUT else shown(scene)


def require_input_once(names: Sequence[str]) -> None:
    """Refuse standard input as more than one scene.

    Raises:
        UsageError: `-` is given more than once.
    """
    if names.count(STANDARD_INPUT) > 1:
        raise UsageError("standard input (-) is given as a scene more than once; it can be read once")


@contextmanager
def named_scene(given: str, read: Callable[[str], Scene] | None = None) -> Iterator[tuple[Scene, str]]:
    """A scene that the command line names, and its name in messages.

    Within this context, an error of the scene names it as the command line does, not by its title.

    Args:
        read: reads the scene; `load_scene` if not given.
    Raises:
        SceneError: there is no such scene, or it is wrong.
    """
    scene, name = (read or load_scene)(given), name_of(given)
    try:
        yield scene, name
    except SceneError as error:
        raise error.of(name) from error


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
