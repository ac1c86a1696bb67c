"""Every way out of the program: what an error means to the one who called it, in one line and a status."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator

from validate.exit_status import ExitStatus, of_interruption
from validate.output.console import Console


def guarded(action: Callable[[Console], ExitStatus]) -> int:
    """Run an action; whatever ends it, one line on standard error says so, and the status is documented.

    A defect is told in one line too; `python -X dev` shows where it came from.
    """
    console = Console()
    try:
        status = action(console)
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
    from validate.errors import UsageError
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
