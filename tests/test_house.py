"""The rules of the house: who may import whom, and how the modules of a package are stacked."""

import ast
import re
import subprocess
import sys
from collections import Counter
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FORBIDDEN = {
    "pointcoord": {"absolute", "validate", "pinocchio", "pin"},
    "absolute": {"pointcoord", "validate"},
    "validate": set(),
}
CONTRIBUTING = (ROOT / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")


@cache
def modules(package: str) -> dict[str, set[str]]:
    """Every module of a package with the modules that it imports, at any depth of its code."""
    found = {}
    for path in (ROOT / package).rglob("*.py"):
        parts = path.relative_to(ROOT).with_suffix("").parts
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


def stacked(found: dict[str, set[str]]) -> list[str]:
    """The modules, each after those that it imports.

    Raises:
        CycleError: some of them import each other in a circle.
    """
    inner = {name for name in found if "." in name}
    return [*TopologicalSorter({name: (found[name] & inner) - {name} for name in inner}).static_order()]


def rooms(package: str) -> list[str]:
    """The rooms of a package as CONTRIBUTING lists them, the lowest first."""
    (table,) = re.findall(rf"^\| `{package}` \| \|\n\|---\|---\|\n((?:\|.*\n)+)", CONTRIBUTING, flags=re.M)
    return [
        room.strip("/") for row in table.splitlines() for room in re.findall("`(.+?)`", row.split("|")[1])
    ]


@pytest.mark.parametrize("package", FORBIDDEN)
def test_a_package_imports_only_what_the_house_allows(package: str) -> None:
    found = modules(package)
    assert found
    for name, imported in found.items():
        roots = {module.split(".")[0] for module in imported}
        assert not roots & FORBIDDEN[package], f"{name} imports {roots & FORBIDDEN[package]}"


@pytest.mark.parametrize("package", FORBIDDEN)
def test_modules_of_a_package_form_layers(package: str) -> None:
    assert stacked(modules(package))


@pytest.mark.parametrize("package", ["pointcoord", "validate"])
def test_a_room_imports_only_from_the_rooms_that_contributing_lists_above_it(package: str) -> None:
    found, order = modules(package), rooms(package)
    assert sorted({room_of(name) for name in found if "." in name}) == sorted(order)
    upward = {
        f"{upper} -> {lower}": count
        for (upper, lower), count in arrows(found).items()
        if order.index(lower) > order.index(upper)
    }
    assert not upward


def test_the_first_lines_of_the_program_need_nothing_but_python() -> None:
    found = modules("pointcoord") | modules("validate")
    for name in ("pointcoord.__main__", "validate.exit_status"):
        assert {one.partition(".")[0] for one in found[name]} <= set(sys.stdlib_module_names), name


def test_every_name_of_pointcoord_is_what_it_says_whatever_was_imported_first() -> None:
    program = (
        "import pkgutil, importlib, pointcoord\n"
        "same = dict.fromkeys(('MapError', 'OutsideMotion', 'SweepError'), 'WrongArgument')\n"
        "same |= dict.fromkeys(('MotionTooLong', 'MotionTooRough'), 'NotFollowed')\n"
        "same |= {'InputNotKnown': 'InputOutOfRange', 'MotionNotMapped': 'NotCovered'}\n"
        "for found in pkgutil.walk_packages(pointcoord.__path__, 'pointcoord.'):\n"
        "    importlib.import_module(found.name)\n"
        "for name in pointcoord.__all__:\n"
        "    assert getattr(pointcoord, name).__name__ == same.get(name, name), name\n"
        "    assert callable(getattr(pointcoord, name)), name\n"
        "assert set(pointcoord.__all__) <= set(dir(pointcoord))\n"
        "assert not hasattr(pointcoord, 'simulates')\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)
