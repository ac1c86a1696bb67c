"""Who makes rows: the program with its packages, in a process of this machine or of another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata

from validate.output.document import code_digest

# What a row follows from, of this distribution.
CODE = (
    "pointcoord",
    "absolute",
    "validate/adjudication",
    "validate/cars",
    "validate/comparison",
    "validate/formulations",
    "validate/hard",
    "validate/paper",
    "validate/reference",
    "validate/relative",
    "validate/long_studies",
)
PACKAGES = ("numpy", "scipy", "pin", "mpmath", "python-flint")


@dataclass(frozen=True)
class Maker:
    """What makes rows, as far as they depend on it.

    Attributes:
        program: version of pointcoord, and a digest of its code.
        packages: versions by name; `not installed` where one is not.
    """

    program: str
    packages: Mapping[str, str]

    @classmethod
    @cache
    def here(cls) -> Maker:
        """Of this process."""
        program = f"pointcoord {_version('pointcoord')}, code {code_digest(CODE)}"
        return cls(program, {name: _version(name) for name in PACKAGES})

    def differences(self, other: Maker) -> list[str]:
        """What is another in the other one: `what mine, there others`."""
        both = [("", self.program, other.program)]
        for name in dict.fromkeys((*self.packages, *other.packages)):
            mine, others = (one.packages.get(name, "not known") for one in (self, other))
            both.append((f"{name} ", mine, others))
        return [f"{name}{mine}, here {others}" for name, mine, others in both if mine != others]


def _version(distribution: str) -> str:
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return "not installed"
