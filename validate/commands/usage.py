"""What every command shares: options, where scenes come from, where results go."""

from __future__ import annotations

import argparse
import math
import os
import re
import sys
from argparse import ArgumentParser
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from string import Template
from typing import Any

from pointcoord import Scene, SceneError
from validate.commands.pages import page
from validate.errors import NotFinished, UsageError
from validate.exit_status import HELP, ExitStatus
from validate.output.console import STANDARD_OUTPUT, Console
from validate.output.files import require_known_ending, require_writable, write_content
from validate.plain_text import one_line, shown

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
LONGEST_OF_A_FILE = 255  # letters of a name, on the usual systems
SCENE_HELP = "a built-in scene's name, the path of a scene file, or - for standard input"
TOML = (".toml",)


def whole(least: int) -> Callable[[str], int]:
    """Reads a whole number that is not below the least one."""

    def read(word: str) -> int:
        if word.isascii() and word.isdigit() and int(word) >= least:
            return int(word)
        raise argparse.ArgumentTypeError(f"{shown(word)} is no whole number; allowed: {least} or more")

    return read


def positive(word: str) -> float:
    """Reads a positive, finite number."""
    with suppress(ValueError):
        if 0.0 < (value := float(word)) < math.inf:
            return value
    raise argparse.ArgumentTypeError(f"{shown(word)!r} is none; allowed: a positive, finite number")


TYPES: Mapping[str, Callable[[str], Any]] = {
    "N": whole(1),
    "K": whole(0),
    "S": positive,
    "F": positive,
    "MM": positive,
    **dict.fromkeys(("A", "DEG"), float),
}
"""What stands for a number in the options of a command: counts, seconds, factors, accuracies, sizes."""


@dataclass(frozen=True)
class Command:
    """A command of the program, whose page in `help/` says what it takes.

    An entry of its options begins at the beginning of a line: names and what stands for the value, as `TYPES`
    reads it, then two blanks and what it does. `NAME ...` may be given again, `NAME = 1` has a default, and
    `[NAME ...]` takes any number of values. An argument is `name=WORD`, one that may be left out
    `name=[WORD]`, any number of them `name=[WORD ...]`.

    Attributes:
        run: does it.
        words: by name what stands for `$name` in its page.
        more: what an entry cannot say of an option, as `argparse` takes it.
        inner: commands of the command; it has no options itself then.
    """

    run: Callable[[argparse.Namespace, Console], ExitStatus]
    words: Mapping[str, object] = field(default_factory=dict)
    more: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    inner: Mapping[str, Command] = field(default_factory=dict)

    def declare(self, parser: ArgumentParser, name: str) -> None:
        """Declare what it takes."""
        _, description, options = (Template(text).substitute(self.words) for text in page(name))
        parser.description, parser.epilog = description, HELP
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        for entry in re.split(r"\n(?=\S)", options) if options else ():
            head, words = re.split(r"\s{2,}", entry, maxsplit=1)
            head, _, default = head.partition(" = ")
            names = [word for word in head.split() if word.startswith("-")]
            about: dict[str, Any] = {"help": " ".join(words.replace("%", "%%").split())}
            if not names:
                argument, _, value = head.partition("=")
                names = [argument]
                if value.startswith("["):
                    about["nargs"] = "*" if value.endswith("...]") else "?"
            elif value := " ".join(word for word in head.split() if word not in names):
                about |= {"type": TYPES.get(value), "default": default or None}
                if value.startswith("["):
                    about |= {"nargs": "+", "default": []}
                elif value.endswith("..."):
                    about |= {"action": "append", "default": []}
            else:
                about["action"] = "store_true"
            if value:
                about["metavar"] = value.strip("[].").strip()
            parser.add_argument(*names, **{**about, **self.more.get(names[-1], {})})
        if self.inner:
            inner = parser.add_subparsers(required=True, metavar=name.upper(), dest=name)
            for one, command in self.inner.items():
                own = f"{name}-{one}"
                command.declare(inner.add_parser(one, help=page(own)[0]), own)
        parser.set_defaults(run=self.run)


def given(options: argparse.Namespace, *names: str) -> list[str]:
    """Those of some options that the command line gives; one that the command does not have is not given."""
    values = ((name, getattr(options, name.lstrip("-").replace("-", "_"), None)) for name in names)
    return [name for name, value in values if value not in (None, False, [])]


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
        NotFinished: one cannot be written; or standard output is closed and wanted.
    """
    wanted = {option: target for option, target in results.items() if target is not None}
    places: dict[str, str] = {}
    for option, target in wanted.items():
        if not target.strip():
            raise UsageError(
                f"{option} {target!r} names no file; allowed: the path of a file, or - for standard output"
            )
        for file in read:
            if file and os.path.isfile(target) and os.path.isfile(file) and os.path.samefile(target, file):
                raise UsageError(
                    f"{option} {target} would overwrite the scene or file that is read; give another file"
                )
        other = places.setdefault(target if target == "-" else os.path.realpath(target), option)
        if other != option:
            raise UsageError(f"{other} and {option} are both {shown(target)}; give each a file of its own")
    console.quiet, console.mute = getattr(options, "quiet", False), "-" in wanted.values()
    if sys.stdout is None and ((says and not console.quiet) or console.mute):
        instead = "use --quiet, and name files for results" if says else f"use {next(iter(results))} FILE"
        raise NotFinished(STANDARD_OUTPUT, f"is closed; {instead}")
    for option, target in wanted.items():
        if target != "-":
            if endings and option in endings:
                require_known_ending(target, endings[option])
            require_writable(target)


def place_of_result(options: argparse.Namespace, endings: Collection[str], console: Console) -> str | None:
    """The file that `-o` names, found to be writable before anything is solved; None is standard output.

    Raises:
        UsageError, NotFinished: see `require_results`.
    """
    target: str = "-" if options.output is None else options.output
    require_results({"-o": target}, (options.scene,), options, console, {"-o": endings}, says=False)
    return None if target == "-" else target


def place_of_picture(options: argparse.Namespace, endings: Collection[str], console: Console) -> str | None:
    """The same of a picture; for a terminal, which shows none, a file of a name that is free, and says so.

    Raises:
        UsageError, NotFinished: see `require_results`.
    """
    if options.output is None and sys.stdout is not None and sys.stdout.isatty():
        stem = "picture" if options.scene == STANDARD_INPUT else Path(options.scene).stem
        names = (f"{stem}.svg" if number == 1 else f"{stem}-{number}.svg" for number in count(1))
        options.output = next(name for name in names if not os.path.lexists(name))
        console.note(f"the picture goes to {shown(options.output)}; -o FILE says another place")
    return place_of_result(options, endings, console)


def to_be_filled_in(target: str, text: str, console: Console) -> ExitStatus:
    """Write a file that an option names and that is not there yet, and say what to do.

    Raises:
        UsageError: it is not called .toml. NotFinished: it cannot be written.
    """
    require_known_ending(target, TOML)
    write_content(target, text)
    console.complain(f"{shown(target)} was not there: it is written; fill it in, and run this again")
    return ExitStatus.WRONG_INPUT


def name_of(scene: str) -> str:
    """What messages call a scene that the command line names; a name that no file can have is shortened."""
    if scene == STANDARD_INPUT:
        return STANDARD_INPUT_NAME
    of_a_file = all(len(part) <= LONGEST_OF_A_FILE for part in scene.split(os.sep))
    return shown(scene) if of_a_file else one_line(shown(scene))


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
