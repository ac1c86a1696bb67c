"""The program `pointcoord`: its commands, and every way out: what an error means to whoever called it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from typing import NoReturn

from pointcoord.wording import meant, shown
from validate.errors import UsageError
from validate.exit_status import HELP, ExitStatus, of_interruption
from validate.output.console import Console
from validate.output.document import program_version, schema_text

DESCRIPTION = """\
Cross-validation of suspension kinematics: one mechanism is solved by two formulations that
share no code, and everything that they compute is compared. A mechanism and its motion are a
scene: `pointcoord scenes` lists those that are built in, and a file of your own has the same
form."""

COMMANDS: Mapping[str, tuple[str, str]] = {
    "validate": ("comparison", "solve scenes by two formulations and compare them"),
    "simulate": ("solved", "solve a scene by point coordinates and write its motion"),
    "sweep": ("sweep", "solve many designs of a suspension together"),
    "plan": ("scenes", "say what a scene would compute, and where its drawing stands"),
    "scenes": ("scenes", "list the built-in scenes"),
    "new": ("new", "write a scene and its mechanism file to start from"),
    "draw": ("scenes", "make a picture of a scene's hardpoints (SVG)"),
    "plot": ("solved", "draw curves of a scene's motion (SVG, PNG)"),
    "table": ("table", "print a car's angles and dimensions over travel"),
    "sensitivity": ("sensitivity", "rank hardpoints by what they change, and spread their tolerances"),
    "hard": ("hard", "try the cases that are known to be hard"),
    "cost": ("cost", "measure and show what accuracy costs in time"),
    "import": ("hardpoints", "make a scene from another program's hardpoints"),
    "export": ("export", "write a car as another program's model"),
    "report": ("report", "validate scenes and write a page of HTML about it"),
    "fit": ("fit", "fit hardpoints to measured curves"),
    "study": ("study", "long studies, by several processes or a cluster"),
    "help": ("topics", "print a page on a topic"),
}
"""Every command: the module of `validate.commands` that it is in, and what it does."""


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
    from validate.extras import MissingPackage
    from validate.formulations.protocol import FormulationError
    from validate.output.files import OutputError
    from validate.solvers.plain import NoSolver
    from validate.studies.study import StudyStopped

    if isinstance(error, UsageError | PointcoordError | MissingPackage | NoSolver):
        return ExitStatus.WRONG_INPUT, str(error)
    if isinstance(error, FormulationError):
        return ExitStatus.NO_VERDICT, str(error)
    if isinstance(error, OutputError | StudyStopped):
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
        console.require("it is where the answer goes")
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
            *(f"  {name.ljust(width)}  {words}" for name, (_, words) in COMMANDS.items()),
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
    """What to write where a word that is no command has to do with scenes; empty if it does not.

    It is a scene's file, or a whole word or several of the name of a built-in scene or a shipped mechanism.
    """
    from pointcoord import Scene, built_in_scenes
    from pointcoord.mechanism import shipped

    plain, scenes = name.lower().replace("_", "-"), built_in_scenes()

    def within(one: str) -> bool:
        return f"-{plain}-" in f"-{one.replace('_', '-')}-"

    named = [plain] if plain in scenes else [scene for scene in scenes if within(scene)]
    if name.endswith(".toml"):
        what, named = "a scene's file stands after a command", [shown(name)]
    elif plain in named:
        what = f"{plain} is a scene"
    elif named:
        what = f"there is {' and '.join(named)} among the scenes"
    else:
        types = [type for type in shipped() if within(type)]
        named = [scene for scene in scenes if types and Scene.load(scene).mechanism.type in types]
        what = f"{' and '.join(types)} is a mechanism, of {', '.join(named)}"
    return f" ({what}: pointcoord simulate {named[0]})" if named else ""


def parser(name: str) -> Parser:
    """The parser of a command. No other one's module is imported: that takes longer than to solve a scene."""
    one, (module, _) = Parser(prog=f"pointcoord {name}"), COMMANDS[name]
    import_module(f"validate.commands.{module}").COMMANDS[name].declare(one, name)
    return one


if __name__ == "__main__":
    sys.exit(main())
