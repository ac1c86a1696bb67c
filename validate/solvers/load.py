"""Imports a user's solver, such as `package.module:Solver`, and keeps its output out of the results."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout, suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from pointcoord.wording import meant
from validate.errors import UsageError
from validate.plain_text import named, shown
from validate.solvers.plain import Solve, SolverFailed, as_function, raised_at


def solver_at(place: str, with_traceback: bool = False) -> Solve:
    """The solver at MODULE:NAME; modules are searched for in the current directory first.

    Args:
        with_traceback: print the traceback of errors of the solver on standard error.
    Raises:
        UsageError: the module or name does not exist, or the module cannot be imported.
    """
    what = f"the solver {shown(place)!r}"
    module_name, _, name = place.partition(":")
    words = (*module_name.split("."), *name.split("."))
    a_file = module_name.endswith(".py")
    if a_file or not all(word.isidentifier() for word in words):
        as_module = module_name.removesuffix(".py").strip("./").replace("/", ".")
        hint = f"; try {as_module}:{name or 'NAME'}" if a_file else ""
        allowed = "give MODULE:NAME, such as package.module:Solver"
        raise UsageError(f"{what} is not a module and a name in it; {allowed}{hint}")
    with _kept_aside(with_traceback):
        found: object = _module(what, module_name)
        for word in name.split("."):
            if not hasattr(found, word):
                there = [one for one in dir(found) if not one.startswith("_")]
                remedy = f"there are: {', '.join(there)}" if there else "the module is empty"
                raise UsageError(f"{what} has no {word!r} in {module_name}{meant(word, there)}; {remedy}")
            found = getattr(found, word)
        function = as_function(found, what)

    def solve(given: Mapping[str, Any]) -> Mapping[str, Any]:
        with _kept_aside(with_traceback):
            return function(given)

    return solve


def _module(what: str, name: str) -> ModuleType:
    """The module, searched for as by `python -m`."""
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)
    try:
        return import_module(name)
    except (Exception, SystemExit) as error:
        lost = error.name if isinstance(error, ModuleNotFoundError) else None
        if lost is not None and f"{name}.".startswith(f"{lost}."):
            problem = f"{what}: the module {lost!r} is not found"
            raise UsageError(f"{problem}; searched in {here} and in Python's packages") from error
        said = SolverFailed(named(error), raised_at(error))
        remedy = "fix the module" if lost is None else "install it"
        raise UsageError(f"{what} cannot be imported: {said}; {remedy}") from error


@contextmanager
def _kept_aside(with_traceback: bool) -> Iterator[None]:
    """Redirects standard output to standard error, for Python and for libraries that it calls.

    Args:
        with_traceback: print the traceback of an error too.
    """
    kept = None
    with suppress(OSError, ValueError, AttributeError):
        sys.stdout.flush()
        kept = os.dup(1)
        os.dup2(2, 1)
    try:
        with redirect_stdout(sys.stderr):
            yield
    except (Exception, SystemExit):
        if with_traceback:
            traceback.print_exc()
        raise
    finally:
        if kept is not None:
            os.dup2(kept, 1)
            os.close(kept)
