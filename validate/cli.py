"""The program `pointcoord`: its commands, and every way out: what an error means to whoever called it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from typing import NoReturn

from pointcoord.wording import meant, shown
from validate.commands.pages import summary
from validate.errors import NotFinished, UsageError
from validate.exit_status import HELP, ExitStatus, of_interruption
from validate.output.console import Console
from validate.output.document import program_version, schema_text

DESCRIPTION = """\
Cross-validation of suspension kinematics: one mechanism is solved by two formulations that
share no code, and everything that they compute is compared. A mechanism and its motion are a
scene: `pointcoord scenes` lists those that are built in, and a file of your own has the same
form."""

COMMANDS: Mapping[str, str] = {
    "validate": "comparison",
    "simulate": "solved",
    "sweep": "sweep",
    "plan": "scenes",
    "scenes": "scenes",
    "new": "new",
    "draw": "scenes",
    "plot": "solved",
    "table": "table",
    "sensitivity": "sensitivity",
    "hard": "hard",
    "cost": "cost",
    "import": "hardpoints",
    "export": "export",
    "report": "report",
    "fit": "fit",
    "study": "study",
    "help": "topics",
}
"""Every command: the module of `validate.commands` that it is in."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; whatever ends it, one line on standard error says so, and its status is documented.

    A defect is told in one line too; `python -X dev` shows where it came from.
    """
    console = Console()
    try:
        status = _run(list(sys.argv[1:] if arguments is None else arguments), console)
        console.flush()
        return status
    except BaseException as error:
        ending = _ending(error, console)
        if ending is None or (ending[0] is ExitStatus.NOT_FINISHED and sys.flags.dev_mode):
            raise
        status, message = ending
    # Outside of the handler: memory that the error held on to is free here.
    console.complain(message)
    return status


def _ending(error: BaseException, console: Console) -> tuple[ExitStatus, str] | None:
    """Status and message of an error; None for the end that the interpreter itself was asked for."""
    for one in _chain(error):
        if isinstance(one, KeyboardInterrupt):
            status = of_interruption(one)
            return status, f"{status.verdict}; {console.left or 'nothing is written'}"
    if not isinstance(error, Exception):
        return None
    # Imported here: most runs end without an error, and need not have all that can raise one.
    from pointcoord import PointcoordError
    from validate.comparison.examined import told_failure
    from validate.formulations.protocol import FormulationError

    if isinstance(error, UsageError | PointcoordError):
        return ExitStatus.WRONG_INPUT, str(error)
    if isinstance(error, FormulationError):
        return ExitStatus.NO_VERDICT, str(error)
    if isinstance(error, NotFinished):
        return ExitStatus.NOT_FINISHED, str(error)
    name = "" if isinstance(error, MemoryError) else f"{type(error).__name__}: "
    return ExitStatus.NOT_FINISHED, f"{name}{told_failure(error)}"


def _chain(error: BaseException) -> Iterator[BaseException]:
    """An error and those that it came from: Ctrl-C in the import of a library may end as another error."""
    one: BaseException | None = error
    while one is not None:
        yield one
        one = one.__cause__ or one.__context__


def _run(words: list[str], console: Console) -> ExitStatus:
    try:
        options = _parsed(words)
    except Answer as answer:
        console.say(str(answer).rstrip())
        return ExitStatus.AGREE
    options.command = ("pointcoord", *words)
    return ExitStatus(options.run(options, console))


class Answer(Exception):
    """The help, the version or the schema was asked for, and nothing else is to be done."""


class Parser(argparse.ArgumentParser):
    """Says nothing itself and ends nothing itself: raises UsageError, or Answer of its help."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see {self.prog} --help")

    def print_help(self, file: object = None) -> NoReturn:
        raise Answer(self.format_help())


def _overview() -> str:
    width = max(map(len, COMMANDS))
    return "\n".join(
        (
            "usage: pointcoord COMMAND ...\n",
            DESCRIPTION,
            "\ncommands, each with --help:",
            *(f"  {name.ljust(width)}  {summary(name)}" for name in COMMANDS),
            "\noptions:",
            "  -h, --help  print this",
            "  --version   print the version",
            "  --schema    print the JSON Schema of what --json writes\n",
            HELP,
        )
    )


ANSWERS: Mapping[str, Callable[[], str]] = {
    "-h": _overview,
    "--help": _overview,
    "--version": lambda: f"pointcoord {program_version()}",
    "--schema": schema_text,
}


def _parsed(words: Sequence[str]) -> argparse.Namespace:
    """The options of a command line, whatever order they and the names of scenes stand in."""
    name = next(iter(words), "")
    if name in ANSWERS:
        raise Answer(ANSWERS[name]())
    if name not in COMMANDS:
        problem = "no command is given"
        if name:
            problem = f"no command is called {shown(name)}{_scene_instead(name) or meant(name, COMMANDS)}"
        raise UsageError(f"{problem}; there are: {', '.join(COMMANDS)}; see pointcoord --help")
    one = parser(name)
    try:
        return one.parse_args(words[1:])
    except UsageError:
        # argparse has a second way for options between names, which knows no commands of commands.
        with suppress(UsageError, TypeError):
            return one.parse_intermixed_args(words[1:])
        raise


def _scene_instead(name: str) -> str:
    """What to write where a word that is no command names a scene or some; empty if it does not."""
    from pointcoord import built_in_scenes

    plain = name.lower().replace("_", "-")
    if name.endswith(".toml"):
        return f" (a scene's file stands after a command: pointcoord simulate {shown(name)})"
    if named := [scene for scene in built_in_scenes() if f"-{plain}-" in f"-{scene}-"]:
        return f" (there is {' and '.join(named)} among the scenes: pointcoord simulate {named[0]})"
    return ""


def parser(name: str) -> Parser:
    """The parser of a command. No other one's module is imported: that takes longer than to solve a scene."""
    one = Parser(prog=f"pointcoord {name}")
    import_module(f"validate.commands.{COMMANDS[name]}").COMMANDS[name].declare(one, name)
    return one


if __name__ == "__main__":
    sys.exit(main())
