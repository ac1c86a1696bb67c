"""Makes the parser of a command from its page in `help/`, which describes the command and its options."""

from __future__ import annotations

import argparse
import math
import re
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


def reader(
    allowed: str, kind: Callable[[str], Any], least: float, most: float = math.inf
) -> Callable[..., Any]:
    """A reader of numbers between `least` and `most`; `allowed` says what they are."""

    def read(word: str) -> Any:
        with suppress(ValueError):
            if least <= (value := kind(word)) <= most:
                return value
        raise argparse.ArgumentTypeError(f"is {shown(word)!r}; allowed: {allowed}")

    return read


# Readers of an option's value by its placeholder: counts, seconds, factors, sizes, accuracies.
_positive = reader(
    "a positive, finite number", float, math.nextafter(0.0, 1.0), math.nextafter(math.inf, 0.0)
)
_number = reader("a number, such as 1e-6", float, -math.inf)
TYPES: Mapping[str, Callable[[str], Any]] = {
    "N": reader("a whole number, 1 or more", int, 1),
    "K": reader("a whole number, 0 or more", int, 0),
    **dict.fromkeys(("S", "F", "MM"), _positive),
    **dict.fromkeys(("A", "DEG"), _number),
}


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


@dataclass(frozen=True)
class Command:
    """A command of the program. Its page in `help/` describes its options.

    An entry of an option begins at the start of a line: its names and the placeholder of its value (see
    `TYPES`), then two blanks and the help text. `NAME ...` may be given again, `NAME = 1` has a default,
    `NAME!` is required, `{A,B}` are the values to choose from, and `[NAME ...]` takes any number of values.
    The placeholder of a result has the endings that its file may have: `FILE.csv|.md`. A positional argument
    is `name=WORD`, an optional one `name=[WORD]`, and any number of them `name=[WORD ...]`.

    Attributes:
        run: the function that runs the command.
        words: the replacement of each `$name` in the page.
        inner: subcommands; the command then has no options itself.
    """

    run: Callable[[argparse.Namespace, Console], ExitStatus]
    words: Mapping[str, object] = field(default_factory=dict)
    inner: Mapping[str, Command] = field(default_factory=dict)

    def declare(self, parser: argparse.ArgumentParser, name: str) -> None:
        """Add the description and the options of the command to a parser."""
        head, _, options = filled(name, self.words).partition("\noptions:\n")
        parser.description, parser.epilog = head.partition("\n")[2].strip(), HELP
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        for entry in re.split(r"\n(?=\S)", options.strip()) if options else ():
            head, words = re.split(r"\s{2,}", entry, maxsplit=1)
            names, settings = _option(head) if head.startswith("-") else _positional(head)
            settings["help"] = " ".join(words.replace("%", "%%").split())
            parser.add_argument(*names, **settings)
        if self.inner:
            inner = parser.add_subparsers(required=True, metavar=name.upper(), dest=name)
            for one, command in self.inner.items():
                own = f"{name}-{one}"
                command.declare(inner.add_parser(one, help=summary(own)), own)
        parser.set_defaults(run=self.run)


def _positional(head: str) -> tuple[list[str], dict[str, Any]]:
    """The name of a positional argument, and its settings for `argparse`."""
    name, _, value = head.partition("=")
    many = {"nargs": "*" if value.endswith("...]") else "?"} if value.startswith("[") else {}
    return [name], {**many, "metavar": value.strip("[].").strip()}


def _option(head: str) -> tuple[list[str], dict[str, Any]]:
    """The names of an option, and its settings for `argparse`."""
    head, _, default = head.partition(" = ")
    names = [word for word in head.split() if word.startswith("-")]
    value = " ".join(word for word in head.split() if word not in names)
    if not value:
        return names, {"action": "store_true"}
    if value.startswith("{"):
        return names, {"choices": value.strip("{}").split(","), "default": default or None}
    read = TYPES.get(value)
    if names[-1] in ("--output", "--mjcf"):
        read = partial(result_file, endings=value[value.index(".") :].split("|"))
    about: dict[str, Any] = {"type": read, "default": default or None, "metavar": value.strip("[].!").strip()}
    if value.startswith("["):
        about |= {"nargs": "+", "default": []}
    elif value.endswith("..."):
        about |= {"action": "append", "default": []}
    return names, about | {"required": value.endswith("!")}
