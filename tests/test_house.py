"""The rules of the house: who may import whom, and how the modules of a package are stacked."""

import ast
import re
import subprocess
import sys
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
    """Every module of a package with the modules, and names of them, that it imports anywhere in its code."""
    found = {}
    for path in (ROOT / package).rglob("*.py"):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        imported: set[str] = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                assert node.level == 0, f"{name}: relative imports hide who is imported"
                imported |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        found[name] = imported
    return found


@pytest.mark.parametrize("package", FORBIDDEN)
def test_a_package_imports_only_what_the_house_allows_and_its_modules_form_layers(package: str) -> None:
    found = modules(package)
    for name, imported in found.items():
        assert not {module.split(".")[0] for module in imported} & FORBIDDEN[package], name
    inner = found.keys() - {package}
    # Raises CycleError where some of them import each other in a circle.
    assert [*TopologicalSorter({name: (found[name] & inner) - {name} for name in inner}).static_order()]


@pytest.mark.parametrize("package", ["pointcoord", "validate"])
def test_a_room_imports_only_from_the_rooms_that_contributing_lists_above_it(package: str) -> None:
    (table,) = re.findall(rf"^\| `{package}` \| \|\n\|---\|---\|\n((?:\|.*\n)+)", CONTRIBUTING, flags=re.M)
    order = [
        room.strip("/") for row in table.splitlines() for room in re.findall("`(.+?)`", row.split("|")[1])
    ]
    found = {name: imported for name, imported in modules(package).items() if name != package}
    assert sorted({name.split(".")[1] for name in found}) == sorted(order)
    for name, imported in found.items():
        for target in imported & found.keys():
            assert order.index(target.split(".")[1]) <= order.index(name.split(".")[1]), (name, target)


def test_the_first_lines_of_the_program_need_nothing_but_python() -> None:
    found = modules("pointcoord") | modules("validate")
    for name in ("pointcoord.__main__", "validate.exit_status"):
        assert {one.partition(".")[0] for one in found[name]} <= set(sys.stdlib_module_names), name


# Names under which an error is known as well.
ALIASES = {
    "pointcoord": {
        **dict.fromkeys(("MapError", "OutsideMotion", "SweepError"), "WrongArgument"),
        **dict.fromkeys(("MotionTooLong", "MotionTooRough"), "NotFollowed"),
        **{"InputNotKnown": "InputOutOfRange", "MotionNotMapped": "NotCovered"},
    },
    "validate": {},
}
PROGRAM = """
import importlib, pickle, pkgutil, sys
package = importlib.import_module({package!r})
loaded = {{name.partition(".")[0] for name in sys.modules}}
assert not {{"numpy", "scipy", "flint", "pinocchio", "pydantic_core"}} & loaded, loaded
assert set(package.__all__) <= set(dir(package))
assert not hasattr(package, "simulates")
for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
    if not found.name.endswith("__main__"):
        importlib.import_module(found.name)
exec(f"from {{package.__name__}} import *")
for name in package.__all__:
    found = globals()[name]
    assert found is getattr(package, name) and callable(found)
    assert found.__name__ == {aliases!r}.get(name, name), name
    assert pickle.loads(pickle.dumps(found)) is found
"""


@pytest.mark.parametrize("package", ALIASES)
def test_every_name_of_a_package_is_what_it_says_and_costs_nothing_before_it_is_used(package: str) -> None:
    program = PROGRAM.format(package=package, aliases=ALIASES[package])
    subprocess.run([sys.executable, "-W", "error", "-c", program], check=True, cwd=ROOT)
