"""Makes the parser of a command from its page in `help/`, which describes the command and its options."""

from __future__ import annotations

import argparse
import math
import re
from argparse import ArgumentParser
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from string import Template
from typing import Any

from validate.exit_status import HELP, ExitStatus
from validate.extras import needed
from validate.output.console import Console
from validate.output.files import require_known_ending
from validate.plain_text import shown

PAGES = Path(__file__).with_name("help")


def summary(name: str) -> str:
    """What a command does: the first line of its page."""
    return _read(name).partition("\n")[0]


def filled(name: str, words: Mapping[str, object]) -> str:
    """A page with each `$name` replaced by a word or a part of `shared.txt`, which may have further ones."""
    text, found = _read(name), {**parts("shared"), **words}
    while "$" in text:
        text = Template(text).substitute(found)
    return text


def parts(name: str) -> dict[str, str]:
    """The parts of a page by the names above them."""
    _, *found = re.split(r"\s*^\[(\w+)\]\n", _read(name).rstrip(), flags=re.M)
    return dict(zip(found[::2], found[1::2], strict=True))


def _read(name: str) -> str:
    return (PAGES / f"{name}.txt").read_text(encoding="utf-8")


def whole(least: int) -> Callable[[str], int]:
    """A reader of whole numbers that are not below `least`."""

    def read(word: str) -> int:
        if word.isascii() and word.isdigit() and int(word) >= least:
            return int(word)
        raise argparse.ArgumentTypeError(f"is {shown(word)!r}; allowed: a whole number, {least} or more")

    return read


def positive(word: str) -> float:
    """Read a positive, finite number."""
    with suppress(ValueError):
        if 0.0 < (value := float(word)) < math.inf:
            return value
    raise argparse.ArgumentTypeError(f"is {shown(word)!r}; allowed: a positive, finite number")


def number(word: str) -> float:
    """Read a number; its user checks the range."""
    with suppress(ValueError):
        return float(word)
    raise argparse.ArgumentTypeError(f"is {shown(word)!r}; allowed: a number, such as 1e-6")


def result_file(word: str, endings: Sequence[str]) -> str:
    """Read the name of a result, - for standard output; its ending selects the format.

    Raises:
        UsageError: the ending is unknown. MissingLibrary: Parquet needs pyarrow.
    """
    if word.strip() and word != "-":
        require_known_ending(word, endings)
        if word.endswith(".parquet"):
            needed(".parquet", "pyarrow.parquet")
    return word


TYPES: Mapping[str, Callable[[str], Any]] = {
    "N": whole(1),
    "K": whole(0),
    **dict.fromkeys(("S", "F", "MM"), positive),
    **dict.fromkeys(("A", "DEG"), number),
}
"""Reader of an option's value by its placeholder: counts, seconds, factors, accuracies, sizes."""


@dataclass(frozen=True)
class Command:
    """A command of the program. Its page in `help/` describes its options.

    An entry of an option begins at the start of a line: its names and the placeholder of its value (see
    `TYPES`), then two blanks and the help text. `NAME ...` may be given again, `NAME = 1` has a default, and
    `[NAME ...]` takes any number of values. The placeholder of a result has the endings that its file may
    have: `FILE.csv|.md`. A positional argument is `name=WORD`, an optional one `name=[WORD]`, and any number
    of them `name=[WORD ...]`.

    Attributes:
        run: the function that runs the command.
        words: the replacement of each `$name` in the page.
        more: further settings of an option for `argparse`, which an entry cannot express.
        inner: subcommands; the command then has no options itself.
    """

    run: Callable[[argparse.Namespace, Console], ExitStatus]
    words: Mapping[str, object] = field(default_factory=dict)
    more: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    inner: Mapping[str, Command] = field(default_factory=dict)

    def declare(self, parser: ArgumentParser, name: str) -> None:
        """Add the description and the options of the command to a parser."""
        head, _, options = filled(name, self.words).partition("\noptions:\n")
        parser.description, parser.epilog = head.partition("\n")[2].strip(), HELP
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        for entry in re.split(r"\n(?=\S)", options.strip()) if options else ():
            names, about = _argument(entry)
            parser.add_argument(*names, **{**about, **self.more.get(names[-1], {})})
        if self.inner:
            inner = parser.add_subparsers(required=True, metavar=name.upper(), dest=name)
            for one, command in self.inner.items():
                own = f"{name}-{one}"
                command.declare(inner.add_parser(one, help=summary(own)), own)
        parser.set_defaults(run=self.run)


def _argument(entry: str) -> tuple[list[str], dict[str, Any]]:
    """The names of an option or an argument, and its settings for `argparse`."""
    head, words = re.split(r"\s{2,}", entry, maxsplit=1)
    about: dict[str, Any] = {"help": " ".join(words.replace("%", "%%").split())}
    if not head.startswith("-"):
        name, _, value = head.partition("=")
        if value.startswith("["):
            about["nargs"] = "*" if value.endswith("...]") else "?"
        return [name], about | {"metavar": value.strip("[].").strip()}
    head, _, default = head.partition(" = ")
    names = [word for word in head.split() if word.startswith("-")]
    value = " ".join(word for word in head.split() if word not in names)
    if not value:
        return names, about | {"action": "store_true"}
    known = TYPES.get(value)
    if names[-1] in ("--output", "--mjcf"):
        known = partial(result_file, endings=value[value.index(".") :].split("|"))
    about |= {"type": known, "default": default or None, "metavar": value.strip("[].").strip()}
    if value.startswith("["):
        about |= {"nargs": "+", "default": []}
    elif value.endswith("..."):
        about |= {"action": "append", "default": []}
    return names, about
