"""Optional packages: imports them, and reports one that is missing or does not load."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from pointcoord.errors import MissingLibrary

OURS = ("pointcoord", "absolute", "validate")
EXTRAS = {
    **dict.fromkeys(("jinja2", "plotly"), "report"),
    **dict.fromkeys(("mujoco", "exudyn"), "peers"),
    **dict.fromkeys(("dask", "distributed"), "cluster"),
    "hypothesis": "strategies",
    "matplotlib": "plot",
    "pyarrow": "parquet",
}
"""The extra of this distribution that installs a package; the extra `validate` installs all others."""


@contextmanager
def needing(part: str) -> Iterator[None]:
    """Within this context, an import error names the package, and says how to install it.

    Args:
        part: the part of the program that needs the packages, such as a formulation's name.
    Raises:
        MissingLibrary: a package is not installed, or does not load.
    """
    try:
        yield
    except ImportError as error:
        if isinstance(error, MissingLibrary) or (error.name or "").partition(".")[0] in OURS:
            raise
        raise not_there(part, error) from error


def needed(part: str, module: str) -> Any:
    """Import a module, see `needing`."""
    with needing(part):
        return import_module(module)


def not_there(part: str, error: ImportError) -> MissingLibrary:
    """The error for a part of the program whose package is not installed or does not load."""
    package = error.name or part
    if isinstance(error, ModuleNotFoundError):
        extra = EXTRAS.get(package.partition(".")[0], "validate")
        return MissingLibrary(repr(part), (package,), extra=extra)
    # The cause, if the importing module has already replaced the message.
    why = " ".join(str(error.__cause__ or error).split())
    advice = "install the system package of the library named here, or reinstall the Python package"
    return MissingLibrary(repr(part), (package,), f"is installed but does not load ({why})", advice=advice)
