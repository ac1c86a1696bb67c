"""Optional packages: imports them, and reports one that is missing or does not load."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from pointcoord.errors import MissingLibrary


def not_there(part: str, error: ImportError, extra: str = "validate") -> MissingLibrary:
    """The error for a part of the program whose package is not installed or does not load.

    Args:
        part: the part, such as a formulation's name.
        error: what the import of the package raised.
        extra: the extra of this distribution that installs the package.
    """
    package = (error.name or part,)
    if isinstance(error, ModuleNotFoundError):
        return MissingLibrary(repr(part), package, extra=extra)
    # The cause, if the importing module has already replaced the message.
    why = " ".join(str(error.__cause__ or error).split())
    advice = "install the system package of the library named here, or reinstall the Python package"
    return MissingLibrary(repr(part), package, f"is installed but does not load ({why})", advice=advice)


def needed(part: str, module: str, extra: str = "validate") -> Any:
    """Import a module that needs packages that the solvers do not need.

    Raises:
        MissingLibrary: a package is not installed, or does not load.
    """
    try:
        return import_module(module)
    except MissingLibrary:
        raise
    except ImportError as error:
        raise not_there(part, error, extra) from None
