"""The program `pointcoord`: its commands, and how it ends."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import NoReturn

from pointcoord.wording import meant, shown
from validate.door import guarded
from validate.errors import UsageError
from validate.exit_status import HELP, ExitStatus
from validate.output.console import Console
from validate.output.document import program_version, schema_text

DESCRIPTION = """\
Cross-validation of suspension kinematics: one mechanism is solved by two formulations that
share no code, and everything that they compute is compared. A mechanism and its motion are a
scene: `pointcoord scenes` lists those that are built in, and a file of your own has the same
form."""

COMMANDS = {
    "validate": "comparison",
    "simulate": "solved",
    "sweep": "sweep",
    "plan": "scenes",
    "scenes": "scenes",
    "new": "new",
    "draw": "scenes",
    "plot": "solved",
    "table": "solved",
    "hard": "hard",
    "cost": "cost",
    "import": "hardpoints",
    "report": "report",
    "fit": "fit",
    "study": "study",
    "help": "topics",
}
"""Every command, and the module of `validate.commands` that it is in."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; returns its exit status, see `exit_status`."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    return guarded(lambda console: _run(words, console))


def _run(words: list[str], console: Console) -> ExitStatus:
    try:
        options = _parsed(words)
    except Answer as answer:
        console.require("it is where the answer goes")
        console.say(str(answer).rstrip())
        return ExitStatus.AGREE
    options.command = ("pointcoord", *words)
    return ExitStatus(options.run(options, console))


def _parsed(words: list[str]) -> argparse.Namespace:
    """The options of a command line, whatever order they and the names of scenes stand in."""
    if words and not words[0].startswith("-") and words[0] not in COMMANDS:
        hint, known = meant(words[0], COMMANDS), ", ".join(COMMANDS)
        raise UsageError(
            f"no command is called {shown(words[0])}{hint}; there are: {known}; see pointcoord --help"
        )
    top = parser(words[:1])
    try:
        return top.parse_args(words)
    except UsageError:
        # Without options between names it is parsed by now; argparse has a second way for the rest, which
        # knows no commands of commands.
        found = _command(top, words)
        if found is None or "--" in words:
            raise
        try:
            return found.parse_intermixed_args(words[1:])
        except (UsageError, TypeError):
            pass
        raise


def _command(top: argparse.ArgumentParser, words: list[str]) -> argparse.ArgumentParser | None:
    """The parser of the command that the words begin with."""
    choices = (action.choices for action in top._actions if isinstance(action, argparse._SubParsersAction))
    return next((among[words[0]] for among in choices if words and words[0] in among), None)


class Answer(Exception):
    """The help, the version or the schema was asked for, and nothing else is to be done."""


class _Parser(argparse.ArgumentParser):
    """Says nothing itself and ends nothing itself."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see {self.prog} --help")

    def print_help(self, file: object = None) -> NoReturn:
        raise Answer(self.format_help())


class _Say(argparse.Action):
    """An option that answers with a text."""

    def __init__(self, option_strings: Sequence[str], dest: str, const: Callable[[], str], help: str) -> None:
        super().__init__(option_strings, dest, nargs=0, const=const, help=help)

    def __call__(self, *_: object) -> NoReturn:
        raise Answer(self.const())


def parser(first: Sequence[str] = ()) -> argparse.ArgumentParser:
    """The parser of the command line.

    Its `parse_args` raises UsageError, and Answer where only a text is asked for.

    Args:
        first: the first word of the command line. Where that is a command no other one's module is imported,
            for that takes longer than to solve a scene.
    """
    top = _Parser(
        prog="pointcoord",
        description=DESCRIPTION,
        epilog=HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument(
        "--version", action=_Say, const=lambda: f"pointcoord {program_version()}", help="print the version"
    )
    top.add_argument(
        "--schema", action=_Say, const=schema_text, help="print the JSON Schema of what --json writes"
    )
    commands = top.add_subparsers(required=True, metavar="COMMAND")
    asked = [word for word in first if word in COMMANDS]
    for module in dict.fromkeys(COMMANDS[name] for name in asked or COMMANDS):
        import_module(f"validate.commands.{module}").add(commands)
    for one in commands.choices.values():
        one.epilog = HELP
        one.formatter_class = argparse.RawDescriptionHelpFormatter
    return top


if __name__ == "__main__":
    sys.exit(main())
