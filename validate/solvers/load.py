"""A solver by where it stands, such as `package.module:Solver`; what it prints does not mix with results."""

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
from validate.plain_text import shown
from validate.solvers.plain import Solve, as_function, raised_at, said

FORM = "give MODULE:NAME, such as package.module:Solver"


def solver_at(place: str, with_traceback: bool = False) -> Solve:
    """A solver by its module and its name there; modules are looked for in the current directory first.

    Args:
        with_traceback: show on standard error where in its files it raises an error.
    Raises:
        UsageError: there is no such module or name, or the module cannot be imported.
    """
    what = f"the solver {shown(place)!r}"
    module_name, colon, name = place.partition(":")
    a_file = module_name.endswith(".py")
    words = (*module_name.split("."), *name.split("."))
    if a_file or not colon or not all(word.isidentifier() for word in words):
        as_module = module_name.removesuffix(".py").strip("./").replace("/", ".")
        hint = f"; try {as_module}:{name or 'NAME'}" if a_file else ""
        raise UsageError(f"{what} is not written as a module and a name in it; {FORM}{hint}")
    with what_it_prints_aside(), _told(with_traceback):
        found: object = _module(what, module_name)
        for word in name.split("."):
            if not hasattr(found, word):
                there = [one for one in dir(found) if not one.startswith("_")]
                remedy = f"there are: {', '.join(there)}" if there else "the module is empty"
                raise UsageError(f"{what} has no {word!r} in {module_name}{meant(word, there)}; {remedy}")
            found = getattr(found, word)
        function = as_function(found, what)

    def solve(given: Mapping[str, Any]) -> Mapping[str, Any]:
        with what_it_prints_aside(), _told(with_traceback):
            return function(given)

    return solve


def _module(what: str, name: str) -> ModuleType:
    """The module, as `python -m` would find it."""
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name is not None and (name == error.name or name.startswith(f"{error.name}.")):
            problem = f"{what} is in a module {error.name!r} that is not found"
            raise UsageError(f"{problem}; looked for in {here} and where Python's packages are") from error
        raise UsageError(f"{what} cannot be imported: {said(error)}{_at(error)}; install it") from error
    except (Exception, SystemExit) as error:
        raise UsageError(f"{what} cannot be imported: {said(error)}{_at(error)}; mend the module") from error


def _at(error: BaseException) -> str:
    where = raised_at(error)
    return f" at {where}" if where else ""


@contextmanager
def what_it_prints_aside() -> Iterator[None]:
    """Brings to standard error what is printed meanwhile, by Python or by a library below it."""
    kept = None
    with suppress(OSError, ValueError, AttributeError):
        sys.stdout.flush()
        kept = os.dup(1)
        os.dup2(2, 1)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        if kept is not None:
            os.dup2(kept, 1)
            os.close(kept)


@contextmanager
def _told(wanted: bool) -> Iterator[None]:
    try:
        yield
    except (Exception, SystemExit):
        if wanted:
            traceback.print_exc()
        raise
