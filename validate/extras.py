"""What the program needs besides the solver, and what to say where it is not there."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from pointcoord.errors import MissingLibrary


def not_there(part: str, error: ImportError, extra: str = "validate") -> MissingLibrary:
    """The error of a part of the program that needs a package that is not installed, or does not load.

    Args:
        part: the part, such as a formulation's name.
        error: what the import of the package raised.
        extra: of this distribution, that brings the package.
    """
    package = (error.name or part,)
    if isinstance(error, ModuleNotFoundError):
        return MissingLibrary(repr(part), package, extra=extra)
    # Its cause, where whoever imports the package has already said what to do.
    why = " ".join(str(error.__cause__ or error).split())
    advice = "install the system's package with the library that is named, or the package itself anew"
    return MissingLibrary(repr(part), package, f"is there and does not load ({why})", advice=advice)


def needed(part: str, module: str, extra: str = "validate") -> Any:
    """A module that needs packages that the solvers do without.

    Raises:
        MissingLibrary: they are not there.
    """
    try:
        return import_module(module)
    except MissingLibrary:
        raise
    except ImportError as error:
        raise not_there(part, error, extra) from None
