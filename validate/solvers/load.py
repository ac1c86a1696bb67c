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
from validate.solvers.plain import Solve, as_function, raised_at

FORM = "give MODULE:NAME, such as package.module:Solver"


def solver_at(place: str, with_traceback: bool = False) -> Solve:
    """The solver at MODULE:NAME; modules are searched for in the current directory first.

    Args:
        with_traceback: print the traceback of errors of the solver on standard error.
    Raises:
        UsageError: the module or name does not exist, or the module cannot be imported.
    """
    what = f"the solver {shown(place)!r}"
    module_name, colon, name = place.partition(":")
    a_file = module_name.endswith(".py")
    words = (*module_name.split("."), *name.split("."))
    if a_file or not colon or not all(word.isidentifier() for word in words):
        as_module = module_name.removesuffix(".py").strip("./").replace("/", ".")
        hint = f"; try {as_module}:{name or 'NAME'}" if a_file else ""
        raise UsageError(f"{what} is not a module and a name in it; {FORM}{hint}")
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
    except ModuleNotFoundError as error:
        if error.name is not None and (name == error.name or name.startswith(f"{error.name}.")):
            problem = f"{what}: the module {error.name!r} is not found"
            raise UsageError(f"{problem}; searched in {here} and in Python's packages") from error
        raise UsageError(f"{what} cannot be imported: {named(error)}{_at(error)}; install it") from error
    except (Exception, SystemExit) as error:
        raise UsageError(f"{what} cannot be imported: {named(error)}{_at(error)}; fix the module") from error


def _at(error: BaseException) -> str:
    where = raised_at(error)
    return f" at {where}" if where else ""


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
