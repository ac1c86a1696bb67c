"""Projects installed in an environment of their own, as an installer would leave them, without a network."""

import os
import shutil
import site
import subprocess
import sys
import sysconfig
import tomllib
from collections.abc import Sequence
from pathlib import Path


def settings() -> dict[str, str]:
    """What a program of it is told: nothing of this Python's and pytest's but where modules are compiled."""
    # Under CI pytest tells each error twice, the second time in its summary.
    dropped, kept = ("PYTHON", "PYTEST", "HYPOTHESIS", "CI", "BUILD_NUMBER"), ("PYTHONPYCACHEPREFIX",)
    return {k: v for k, v in os.environ.items() if k in kept or not k.startswith(dropped)}


class Environment:
    """A new virtual environment that also sees the packages of the running Python."""

    def __init__(self, folder: Path) -> None:
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
        self.python = folder / "bin" / "python"
        paths = {"base": str(folder), "platbase": str(folder)}
        self.site = Path(sysconfig.get_path("purelib", scheme="venv", vars=paths))
        self.scratch = folder
        # After its own packages: an older pointcoord that is installed there is not the one that is tried.
        others = dict.fromkeys([*site.getsitepackages(), *(p for p in sys.path if p.endswith("-packages"))])
        (self.site / "others.pth").write_text("\n".join(others) + "\n", encoding="utf-8")

    def install(self, project: Path) -> None:
        """Copy a project's packages, and write what its pyproject says of it beside them."""
        told = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))
        about = told["project"]
        for package in told["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]:
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(project / package, self.site / package, ignore=ignored)
        name = about["name"].replace("-", "_")
        folder = self.site / f"{name}-{about['version']}.dist-info"
        folder.mkdir()
        metadata = f"Metadata-Version: 2.1\nName: {about['name']}\nVersion: {about['version']}\n"
        (folder / "METADATA").write_text(metadata, encoding="utf-8")
        groups = [
            "\n".join([f"[{group}]", *(f"{key} = {value}" for key, value in entries.items())])
            for group, entries in about.get("entry-points", {}).items()
        ]
        (folder / "entry_points.txt").write_text("\n".join(groups) + "\n", encoding="utf-8")
        files = [p for p in self.site.rglob("*.py") if p.is_file()]
        record = "".join(f"{p.relative_to(self.site)},,\n" for p in files)
        (folder / "RECORD").write_text(record, encoding="utf-8")

    def run(self, *words: str, cwd: Path) -> "subprocess.CompletedProcess[str]":
        """Run its Python."""
        return subprocess.run(
            [str(self.python), *words], capture_output=True, text=True, check=False, cwd=cwd, env=settings()
        )


def reported(done: "subprocess.CompletedProcess[str]") -> Sequence[str]:
    """The lines of what a run said."""
    return (done.stdout + done.stderr).splitlines()
