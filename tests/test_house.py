"""The rules of the house: who may import whom, and how the modules of a package are stacked."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = ("pointcoord", "absolute", "validate")
FORBIDDEN = {
    "pointcoord": {"absolute", "validate", "pinocchio", "pin"},
    "absolute": {"pointcoord", "validate"},
    "validate": set(),
}


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


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_imports_only_what_the_house_allows(package: str) -> None:
    found = modules(package)
    assert found
    for name, imported in found.items():
        roots = {module.split(".")[0] for module in imported}
        assert not roots & FORBIDDEN[package], f"{name} imports {roots & FORBIDDEN[package]}"


@pytest.mark.parametrize("package", PACKAGES)
def test_modules_of_a_package_form_layers(package: str) -> None:
    found = modules(package)
    # `from package import module` names the package too, which is no module of its own layer.
    inner = found.keys() - {package}
    below = {name: (found[name] & inner) - {name} for name in inner}
    placed: set[str] = set()
    while below:
        ready = {name for name, needs in below.items() if needs <= placed}
        assert ready, f"these modules of {package} import each other in a circle: {below}"
        placed |= ready
        for name in ready:
            del below[name]


def test_the_first_lines_of_the_program_need_nothing_but_python() -> None:
    for name in ("pointcoord/__main__.py", "validate/exit_status.py"):
        for node in ast.walk(ast.parse((ROOT / name).read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                roots = {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                roots = {(node.module or "").split(".")[0]}
            else:
                continue
            assert roots <= set(sys.stdlib_module_names), name
    program = "import pointcoord, sys; raise SystemExit('numpy' in sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)


def test_every_name_of_pointcoord_is_what_it_says_whatever_was_imported_first() -> None:
    program = (
        "import pkgutil, importlib, pointcoord\n"
        "for found in pkgutil.walk_packages(pointcoord.__path__, 'pointcoord.'):\n"
        "    importlib.import_module(found.name)\n"
        "for name in pointcoord.__all__:\n"
        "    assert getattr(pointcoord, name).__name__ == name, name\n"
        "    assert callable(getattr(pointcoord, name)), name\n"
        "assert set(pointcoord.__all__) <= set(dir(pointcoord))\n"
        "assert not hasattr(pointcoord, 'simulates')\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)


def test_pointcoord_works_without_pinocchio() -> None:
    program = (
        "import sys; sys.modules['pinocchio'] = None; sys.modules['absolute'] = None\n"
        "from pointcoord import Scene, simulate\n"
        "from validate.cli import main\n"
        "print(simulate(Scene.load('steer')).position['wheel_centre'].shape)\n"
        "raise SystemExit(main(['validate', 'steer']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert done.stdout.startswith("(81, 3)")
    assert done.returncode == 2
    assert "pip install 'pointcoord[validate]'" in done.stderr
    assert len(done.stderr.splitlines()) == 1
