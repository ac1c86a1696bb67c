"""The rules of the house: who may import whom, and how the modules of a package are stacked."""

import re
import subprocess
import sys

import pytest
from layers import PACKAGES, ROOT, arrows, floors, modules, room_of

FORBIDDEN = {
    "pointcoord": {"absolute", "validate", "pinocchio", "pin"},
    "absolute": {"pointcoord", "validate"},
    "validate": set(),
}
CONTRIBUTING = (ROOT / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")


def rooms(package: str) -> list[str]:
    """The rooms of a package as CONTRIBUTING lists them, the lowest first."""
    (table,) = re.findall(rf"^\| `{package}` \| \|\n\|---\|---\|\n((?:\|.*\n)+)", CONTRIBUTING, flags=re.M)
    return [
        room.strip("/") for row in table.splitlines() for room in re.findall("`(.+?)`", row.split("|")[1])
    ]


@pytest.mark.parametrize("package", FORBIDDEN)
def test_a_package_imports_only_what_the_house_allows(package: str) -> None:
    found = modules(ROOT, package)
    assert found
    for name, imported in found.items():
        roots = {module.split(".")[0] for module in imported}
        assert not roots & FORBIDDEN[package], f"{name} imports {roots & FORBIDDEN[package]}"


@pytest.mark.parametrize("package", PACKAGES)
def test_modules_of_a_package_form_layers(package: str) -> None:
    assert floors(modules(ROOT, package))


@pytest.mark.parametrize("package", ["pointcoord", "validate"])
def test_a_room_imports_only_from_the_rooms_that_contributing_lists_above_it(package: str) -> None:
    found, order = modules(ROOT, package), rooms(package)
    assert sorted({room_of(name) for name in found if "." in name}) == sorted(order)
    upward = {
        f"{upper} -> {lower}": count
        for (upper, lower), count in arrows(found).items()
        if order.index(lower) > order.index(upper)
    }
    assert not upward


def test_an_arrow_that_leads_up_is_seen() -> None:
    planted = {
        "house.low.a": {"house.high", "house.high.b"},
        "house.high": set(),
        "house.high.b": {"house.low.a.name"},
    }
    assert arrows(planted) == {("low", "high"): 1}
    with pytest.raises(ValueError, match="in a circle"):
        floors({"house.a": {"house.b"}, "house.b": {"house.a"}})


def test_the_first_lines_of_the_program_need_nothing_but_python() -> None:
    found = modules(ROOT, "pointcoord") | modules(ROOT, "validate")
    for name in ("pointcoord.__main__", "validate.exit_status"):
        assert {one.partition(".")[0] for one in found[name]} <= set(sys.stdlib_module_names), name
    program = "import pointcoord, sys; raise SystemExit('numpy' in sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)


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
