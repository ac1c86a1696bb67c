"""What every command shares: the mistakes of a command line, where scenes come from, where results go."""

from __future__ import annotations

import argparse
import math
import os
import stat
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress

from pointcoord import Scene, SceneError
from validate.ci.files import Files
from validate.errors import UsageError
from validate.output.console import Console
from validate.output.files import require_known_ending, require_writable
from validate.plain_text import shown

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
SCENE_HELP = "a built-in scene's name, the path of a scene file, or - for standard input"


def add_scene(parser: argparse.ArgumentParser) -> None:
    """The one scene that a command is about."""
    parser.add_argument("scene", metavar="SCENE", help=SCENE_HELP)


def add_quiet(parser: argparse.ArgumentParser) -> None:
    """Nothing but what was asked for."""
    parser.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")


def add_timings(parser: argparse.ArgumentParser) -> None:
    """When a run was; without it the same run writes the same bytes."""
    parser.add_argument(
        "--timings",
        action="store_true",
        help="write into the JSON when the run began and when it was written",
    )


def add_json(parser: argparse.ArgumentParser, what: str) -> None:
    """Results for other programs."""
    parser.add_argument("--json", metavar="FILE", help=f"write {what} as JSON; - for standard output")


def add_output(parser: argparse.ArgumentParser, metavar: str, help: str) -> None:
    """Where the one result of a command goes."""
    parser.add_argument("-o", "--output", metavar=metavar, help=help)


def leave_output_to(
    results: Collection[str | None], options: argparse.Namespace, console: Console, advice: str
) -> None:
    """Say nothing on standard output but the result that is to go there, if one is.

    Args:
        results: the targets of all results that may go there.
        advice: what to do where standard output is closed.
    Raises:
        OutputError: it is closed and wanted.
    """
    console.quiet, console.mute = options.quiet, "-" in results
    if not console.quiet or console.mute:
        console.require(advice)


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


def positive(what: str) -> Callable[[str], float]:
    """Reads a positive, finite number of what it is."""

    def read(word: str) -> float:
        with suppress(ValueError):
            if 0.0 < (value := float(word)) < math.inf:
                return value
        raise argparse.ArgumentTypeError(f"{shown(word)!r} is no {what}; allowed: a positive, finite number")

    return read


def name_of(scene: str) -> str:
    """What messages call a scene that the command line names."""
    return STANDARD_INPUT_NAME if scene == STANDARD_INPUT else shown(scene)


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


def place_of_result(options: argparse.Namespace, endings: Collection[str], console: Console) -> str | None:
    """The file that `-o` names, found to be writable before anything is solved; None is standard output.

    Raises:
        UsageError: the file has no name, or one that does not say how to write it.
        OutputError: it cannot be written.
    """
    target: str | None = None if options.output == "-" else options.output
    require_target(target, "-o", (options.scene,))
    if target is None:
        console.require("use -o FILE")
    else:
        require_known_ending(target, endings)
        require_writable(target)
    return target


def require_target(target: str | None, option: str, scenes: tuple[str, ...] = ()) -> None:
    """Refuse a target that is no name, that is one of the scenes, or that is standard output by another name.

    Raises:
        UsageError: it is.
    """
    if target is None:
        return
    if not target.strip():
        raise UsageError(
            f"{option} {target!r} names no file; allowed: the path of a file, or - for standard output"
        )
    if _is_standard_output(target):
        raise UsageError(f"{option} {target} is standard output; use {option} - for that")
    for scene in scenes:
        if os.path.isfile(target) and os.path.isfile(scene) and os.path.samefile(target, scene):
            raise UsageError(f"{option} {target} would overwrite the scene; give another file")


def result_files(options: argparse.Namespace, read: Sequence[str], console: Console) -> Files:
    """Where results go, each to a place of its own; standard output is left to one that is to go there.

    Args:
        read: the scenes and files that are read.
    Raises:
        UsageError: two of them, or a result and what is read, are the same file.
        OutputError: standard output is closed and wanted.
    """
    texts = {"--json": options.json, "--junit": options.junit, "--summary": options.summary}
    targets = {**texts, "--save-baseline": options.save_baseline}
    given = {option: target for option, target in targets.items() if target is not None}
    for option, target in given.items():
        require_target(target, option, tuple(read))
    if options.save_baseline == "-":
        raise UsageError("--save-baseline - is no file; a baseline is not text: give the path of a file")
    if options.baseline is not None:
        # A baseline may take the place of the one that it was compared with.
        given = {"--baseline": options.baseline, **given}
    by_place: dict[str, str] = {}
    for option, target in given.items():
        place = target if target == "-" else os.path.realpath(target)
        other = by_place.setdefault(place, option)
        if other != option and {other, option} != {"--baseline", "--save-baseline"}:
            raise UsageError(f"{other} and {option} are both {shown(target)}; give each a file of its own")
    leave_output_to(texts.values(), options, console, "use --quiet, or --quiet --json FILE")
    return Files(options.junit, options.summary, options.save_baseline)


def _is_standard_output(target: str) -> bool:
    """Whether a file or pipe is standard output by another name; a terminal or /dev/null may be both."""
    try:
        out, place = os.fstat(1), os.stat(target)
    except (OSError, ValueError):
        return False
    return os.path.samestat(out, place) and not stat.S_ISCHR(out.st_mode)
