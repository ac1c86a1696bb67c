"""How the modules of a package lie on each other: who imports whom, in rooms and on floors."""

from __future__ import annotations

import ast
from collections import Counter
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("pointcoord", "absolute", "validate")


@cache
def modules(root: Path, package: str) -> dict[str, set[str]]:
    """Every module of a package with the modules that it imports, at any depth of its code."""
    found = {}
    for path in (root / package).rglob("*.py"):
        parts = path.relative_to(root).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        imported = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                assert node.level == 0, f"{name}: relative imports hide who is imported"
                imported |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        found[name] = imported
    return found


def room_of(module: str) -> str:
    """The package inside the package that a module lies in, or its own name if it lies in none."""
    return module.split(".")[1]


def arrows(found: dict[str, set[str]]) -> Counter[tuple[str, str]]:
    """How many imports lead from one room of a package to another."""
    count: Counter[tuple[str, str]] = Counter()
    for name, imported in found.items():
        targets = imported & found.keys()
        for target in targets:
            # `from package.room import module` names the room too, of which it takes nothing.
            taken = not any(other.startswith(f"{target}.") for other in targets)
            if "." in name and "." in target and taken:
                count[room_of(name), room_of(target)] += room_of(name) != room_of(target)
    return +count


def floors(found: dict[str, set[str]]) -> list[list[str]]:
    """The modules in layers: each imports only from those before its own.

    Raises:
        ValueError: some of them import each other in a circle.
    """
    inner = {name for name in found if "." in name}
    below = {name: (found[name] & inner) - {name} for name in inner}
    placed: set[str] = set()
    result = []
    while below:
        ready = sorted(name for name, needs in below.items() if needs <= placed)
        if not ready:
            raise ValueError(f"these modules import each other in a circle: {sorted(below)}")
        result.append(ready)
        placed |= set(ready)
        below = {name: needs for name, needs in below.items() if name not in placed}
    return result
