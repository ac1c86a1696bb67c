"""The program `pointcoord`: parses the command line, runs the command, and maps exceptions to exit codes."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib import import_module
from typing import NoReturn

from pointcoord.wording import meant, shown
from validate.commands.pages import filled, summary
from validate.commands.usage import require_files
from validate.errors import NotFinished, NotSolved, UsageError
from validate.exit_status import HELP, ExitStatus, of_interruption
from validate.extras import needing
from validate.output.console import Console
from validate.output.document import program_version

COMMANDS: Mapping[str, str] = {
    "validate": "comparison",
    "simulate": "solved",
    "sweep": "sweep",
    "plan": "scenes",
    "scenes": "scenes",
    "new": "scenes",
    "draw": "scenes",
    "plot": "solved",
    "table": "solved",
    "sensitivity": "sweep",
    "hard": "hard",
    "cost": "cost",
    "import": "hardpoints",
    "export": "hardpoints",
    "report": "report",
    "fit": "fit",
    "study": "study",
    "help": "topics",
}
"""Every command, with its module in `validate.commands`."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit status. Any error is reported in one line on standard error.

    A defect of the program is reported in one line too; `python -X dev` shows its traceback.
    """
    console = Console()
    try:
        return _run(list(sys.argv[1:] if arguments is None else arguments), console)
    except BaseException as error:
        ending = _ending(error, console)
        if ending is None or (ending[0] is ExitStatus.NOT_FINISHED and sys.flags.dev_mode):
            raise
        status, message = ending
    # After the except block: memory that the exception kept alive is free here.
    console.complain(message)
    return status


def _ending(error: BaseException, console: Console) -> tuple[ExitStatus, str] | None:
    """Status and message of an exception; None for one that only ends the interpreter, such as SystemExit."""
    for one in _chain(error):
        if isinstance(one, KeyboardInterrupt):
            status = of_interruption(one)
            return status, f"{status.verdict}; {console.left or 'nothing is written'}"
    if not isinstance(error, Exception):
        return None
    # Imported here: most runs end without an error and do not need these modules.
    from pointcoord import PointcoordError
    from validate.comparison.examined import told_failure
    from validate.formulations.protocol import FormulationError

    if isinstance(error, UsageError | PointcoordError):
        return ExitStatus.WRONG_INPUT, str(error)
    if isinstance(error, FormulationError | NotSolved):
        return ExitStatus.NO_VERDICT, str(error)
    if isinstance(error, NotFinished):
        return ExitStatus.NOT_FINISHED, str(error)
    name = "" if isinstance(error, MemoryError) else f"{type(error).__name__}: "
    return ExitStatus.NOT_FINISHED, f"{name}{told_failure(error)}"


def _chain(error: BaseException) -> Iterator[BaseException]:
    """An error and its causes: Ctrl-C during the import of a library may surface as another error."""
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
    with needing(words[0]):
        require_files(options, console)
        return ExitStatus(options.run(options, console))


class Answer(Exception):
    """Raised with the text to print if only the help, the version or the schema is asked for."""


class Parser(argparse.ArgumentParser):
    """A parser that neither prints nor exits: it raises UsageError, or Answer with its help text."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see {self.prog} --help")

    def print_help(self, file: object = None) -> NoReturn:
        raise Answer(self.format_help())


def _overview() -> str:
    width = max(map(len, COMMANDS))
    listed = "\n".join(f"  {name.ljust(width)}  {summary(name)}" for name in COMMANDS)
    return filled("overview", {"commands": listed, "exit_status": HELP})


def _schema() -> str:
    # Imported here: it needs the classes of all results.
    from validate.commands.schema import schema_text

    return schema_text()


ANSWERS: Mapping[str, Callable[[], str]] = {
    "-h": _overview,
    "--help": _overview,
    "--version": lambda: f"pointcoord {program_version()}",
    "--schema": _schema,
}


def _parsed(words: Sequence[str]) -> argparse.Namespace:
    """The options of a command line; options and scene names may be in any order."""
    name = next(iter(words), "")
    if name in ANSWERS:
        raise Answer(ANSWERS[name]())
    if name not in COMMANDS:
        problem = "no command is given"
        if name:
            problem = f"no command is called {shown(name)}{_scene_instead(name) or meant(name, COMMANDS)}"
        raise UsageError(f"{problem}; there are: {', '.join(COMMANDS)}; see pointcoord --help")
    one = parser(name)
    # The second method allows options between names, and no subcommands.
    return one.parse_args(words[1:]) if name == "study" else one.parse_intermixed_args(words[1:])


def _scene_instead(name: str) -> str:
    """Advice if the word given as a command names a scene file or built-in scenes; empty if it does not."""
    from pointcoord import built_in_scenes

    plain = name.lower().replace("_", "-")
    if name.endswith(".toml"):
        return f" (give a command before the scene file: pointcoord simulate {shown(name)})"
    if named := [scene for scene in built_in_scenes() if f"-{plain}-" in f"-{scene}-"]:
        return f" (did you mean the scene {' or '.join(named)}? pointcoord simulate {named[0]})"
    return ""


def parser(name: str) -> Parser:
    """The parser of a command. Only its module is imported: importing all takes longer than a scene."""
    one = Parser(prog=f"pointcoord {name}")
    import_module(f"validate.commands.{COMMANDS[name]}").COMMANDS[name].declare(one, name)
    return one
