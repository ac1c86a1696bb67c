"""What every command shares: options, where scenes come from, where results go."""

from __future__ import annotations

import argparse
import math
import os
import stat
import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from pointcoord import Scene, SceneError
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.files import require_known_ending, require_writable, write_content
from validate.plain_text import shown

Commands = Any
"""What `argparse` adds commands to; it has no public name for it."""

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
SCENE_HELP = "a built-in scene's name, the path of a scene file, or - for standard input"
TOML = (".toml",)


def whole(least: int) -> Callable[[str], int]:
    """Reads a whole number that is not below the least one."""

    def read(word: str) -> int:
        if word.isascii() and word.isdigit() and int(word) >= least:
            return int(word)
        raise argparse.ArgumentTypeError(f"{shown(word)} is no whole number; allowed: {least} or more")

    return read


def positive(what: str) -> Callable[[str], float]:
    """Reads a positive, finite number of what it is."""

    def read(word: str) -> float:
        with suppress(ValueError):
            if 0.0 < (value := float(word)) < math.inf:
                return value
        raise argparse.ArgumentTypeError(f"{shown(word)!r} is no {what}; allowed: a positive, finite number")

    return read


SHARED: Mapping[str, Mapping[str, Any]] = {
    "scene": {"metavar": "SCENE", "help": SCENE_HELP},
    "--data": {
        "metavar": "FILE",
        "help": "compare a file of results (CSV, whitespace table, Parquet) with the one SCENE's car, at the "
        "file's own times, inputs or travels, to the digits that it is written with",
    },
    "--map": {
        "metavar": "FILE.toml",
        "help": "what the columns of --data are; not needed for files that pointcoord simulate -o writes; "
        "one that is not there yet is written, to be filled in",
    },
    "--instants": {
        "metavar": "N",
        "type": whole(1),
        "help": "so many, evenly over the scene's time, instead of its own samples; they take no more memory",
    },
    "--report": {
        "metavar": "DIR",
        "help": "write a page of HTML that needs no network, with its data, into a folder",
    },
    "--timings": {
        "action": "store_true",
        "help": "write into the JSON when the run began and when it was written",
    },
    "--quiet": {"action": "store_true", "help": "print nothing but errors"},
}
"""Options and arguments of several commands, as `argparse` takes them."""


def share(parser: argparse.ArgumentParser, *names: str, **more: Any) -> None:
    """Add what commands share, by name; `more` is another word about it than in the others."""
    for name in names:
        short = ("-q",) if name == "--quiet" else ()
        parser.add_argument(*short, name, **{**SHARED[name], **more})


def add_json(parser: argparse.ArgumentParser, what: str) -> None:
    """Results for other programs."""
    parser.add_argument("--json", metavar="FILE", help=f"write {what} as JSON; - for standard output")


def add_output(parser: argparse.ArgumentParser, metavar: str, help: str) -> None:
    """Where the one result of a command goes."""
    parser.add_argument("-o", "--output", metavar=metavar, help=help)


def given(options: argparse.Namespace, *names: str) -> list[str]:
    """Those of some options that the command line gives."""
    values = ((name, getattr(options, name.lstrip("-").replace("-", "_"))) for name in names)
    return [name for name, value in values if value not in (None, False, [])]


def refuse(options: argparse.Namespace, names: Sequence[str], why: str) -> None:
    """Refuse options that a run has no use for.

    Raises:
        UsageError: one of them is given.
    """
    for name in given(options, *names):
        raise UsageError(f"{name} {why}")


def require_results(
    results: Mapping[str, str | None],
    read: Sequence[str | None],
    options: argparse.Namespace,
    console: Console,
    endings: Mapping[str, Collection[str]] | None = None,
    says: bool = True,
) -> None:
    """See, before anything is solved, that each result has a place of its own that can be written.

    Standard output is left to the one that is to go there.

    Args:
        results: by option the file, - for standard output, None of what is not asked for.
        read: files and scenes that no result may be written over.
        endings: by option those that say how to write a file.
        says: whether the command says something on standard output beside its results.
    Raises:
        UsageError: a result names no file or one that is read, two are the same, or the ending is not known.
        OutputError: one cannot be written; or standard output is closed and wanted.
    """
    wanted = {option: target for option, target in results.items() if target is not None}
    places: dict[str, str] = {}
    for option, target in wanted.items():
        if not target.strip():
            raise UsageError(
                f"{option} {target!r} names no file; allowed: the path of a file, or - for standard output"
            )
        if target != "-" and _is_standard_output(target):
            raise UsageError(f"{option} {target} is standard output; use {option} - for that")
        for file in read:
            if file and os.path.isfile(target) and os.path.isfile(file) and os.path.samefile(target, file):
                raise UsageError(
                    f"{option} {target} would overwrite the scene or file that is read; give another file"
                )
        other = places.setdefault(target if target == "-" else os.path.realpath(target), option)
        if other != option:
            raise UsageError(f"{other} and {option} are both {shown(target)}; give each a file of its own")
    console.quiet, console.mute = getattr(options, "quiet", False), "-" in wanted.values()
    if (says and not console.quiet) or console.mute:
        console.require(
            "use --quiet, and name files for results" if says else f"use {next(iter(results))} FILE"
        )
    for option, target in wanted.items():
        if target != "-":
            if endings and option in endings:
                require_known_ending(target, endings[option])
            require_writable(target)


def place_of_result(options: argparse.Namespace, endings: Collection[str], console: Console) -> str | None:
    """The file that `-o` names, found to be writable before anything is solved; None is standard output.

    Raises:
        UsageError, OutputError: see `require_results`.
    """
    target: str = "-" if options.output is None else options.output
    require_results({"-o": target}, (options.scene,), options, console, {"-o": endings}, says=False)
    return None if target == "-" else target


def write_result(target: str | None, content: str | bytes, holds: str, console: Console) -> None:
    """Write a result whole to its file, or to standard output for None or -.

    Args:
        holds: what it is, for the one who interrupts the program.
    Raises:
        OutputError: it cannot be written.
    """
    console.put(target or "-", content)
    if target not in (None, "-"):
        console.written.append(f"{target} holds {holds}")


def to_be_filled_in(target: str, text: str, console: Console) -> ExitStatus:
    """Write a file that an option names and that is not there yet, and say what to do.

    Raises:
        UsageError: it is not called .toml. OutputError: it cannot be written.
    """
    require_known_ending(target, TOML)
    write_content(target, text)
    console.complain(f"{shown(target)} was not there: it is written; fill it in, and run this again")
    return ExitStatus.WRONG_INPUT


def name_of(scene: str) -> str:
    """What messages call a scene that the command line names."""
    return STANDARD_INPUT_NAME if scene == STANDARD_INPUT else shown(scene)


def require_input_once(names: Sequence[str]) -> None:
    """Refuse standard input as more than one scene.

    Raises:
        UsageError: it is.
    """
    if names.count(STANDARD_INPUT) > 1:
        raise UsageError("standard input (-) is given as a scene more than once; it can be read once")


@contextmanager
def told_as(name: str) -> Iterator[None]:
    """Gives faults of a scene the name that the command line gives it, and not its title.

    Raises:
        SceneError: the scene is wrong.
    """
    try:
        yield
    except SceneError as error:
        raise SceneError(name, error.key, error.problem, error.allowed) from error


def load_scene(name: str) -> Scene:
    """Read a scene as the command line names it.

    Raises:
        SceneError: there is none, or it is not written as it must be.
    """
    if not name:
        raise SceneError("''", "", "names no scene", SCENE_HELP)
    if name != STANDARD_INPUT:
        return Scene.load(name)
    if sys.stdin is None:
        raise SceneError(STANDARD_INPUT_NAME, "", "cannot be read (it is closed)", SCENE_HELP)
    return Scene.read(sys.stdin.buffer, STANDARD_INPUT_NAME)


def _is_standard_output(target: str) -> bool:
    """Whether a file or pipe is standard output by another name; a terminal or /dev/null may be both."""
    try:
        out, place = os.fstat(1), os.stat(target)
    except (OSError, ValueError):
        return False
    return os.path.samestat(out, place) and not stat.S_ISCHR(out.st_mode)
