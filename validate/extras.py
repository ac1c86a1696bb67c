"""What the program needs besides the solver, and what to say where it is not there."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class MissingPackage(ImportError):
    """A part of the program needs a package that is not installed, or that does not load.

    Args:
        part: the part, such as a formulation's name.
        error: what the import of the package raised.
        extra: of this distribution, that brings the package.
    """

    def __init__(self, part: str, error: ImportError, extra: str = "validate") -> None:
        self.part = part
        self.package = error.name or part
        if "the absolute model needs Pinocchio" in str(error):
            # The part says it itself.
            super().__init__(str(error), name=error.name)
            return
        problem = "is not installed"
        advice = f"pip install 'pointcoord[{extra}]'"
        if not isinstance(error, ModuleNotFoundError):
            problem = f"does not load ({' '.join(str(error).split())})"
            advice += ", and the system's package with the library, if one is named"
        said = f"{part!r} needs the package {self.package!r}, which {problem}; try: {advice}"
        super().__init__(said, name=error.name)


def needed(part: str, module: str, extra: str = "validate") -> Any:
    """A module that needs packages that the solvers do without.

    Raises:
        MissingPackage: they are not there.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise MissingPackage(part, error, extra) from None
