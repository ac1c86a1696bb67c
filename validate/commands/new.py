"""`pointcoord new`: writes a scene and its mechanism file to start from."""

from __future__ import annotations

import argparse
import os
import re
from pathlib import Path

from pointcoord import UnknownName, built_in_scenes
from pointcoord.mechanism.file import MECHANISMS
from pointcoord.scene.scene_file import SCENES
from validate.commands.pages import Command, parts
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.files import require_writable
from validate.plain_text import shown, typed
from validate.toml_written import value_of

TYPE = re.compile(r'^(type *= *)"(\w+)"', re.MULTILINE)


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Write both files."""
    name, copied = options.name.removesuffix(".toml"), vars(options)["from"]
    if os.path.basename(name) in ("", "-"):
        raise UsageError(
            f"NAME is {shown(options.name)!r}, which names no file; allowed: the name of the new files, "
            "without .toml"
        )
    if copied not in built_in_scenes():
        raise UnknownName("built-in scene", copied, built_in_scenes())
    text = (SCENES / f"{copied}.toml").read_text(encoding="utf-8")
    kind = value_of(f"{Path(name).name}-mechanism.toml")
    notes, own = parts("new-files"), TYPE.sub(lambda found: found[1] + kind, text)
    files = {f"{name}.toml": f"{notes['scene'].replace('$name', shown(name))}\n{own}"}
    if (found := TYPE.search(text)) is not None:
        tables = (MECHANISMS / f"{found[2]}.toml").read_text(encoding="utf-8")
        files[f"{name}-mechanism.toml"] = f"{notes['mechanism']}\n{tables}"
    for target in files:
        if os.path.exists(target):
            raise UsageError(f"{shown(target)} exists already; allowed: the name of a new file")
        require_writable(target)
    for target, content in files.items():
        console.put(target, content, "the scene or its mechanism")
    console.say(f"{' and '.join(map(shown, files))} written, copied from {shown(copied)}")
    console.say(
        f"to copy another (pointcoord scenes): --from SCENE; try: pointcoord plan {typed(f'{name}.toml')}"
    )
    return ExitStatus.AGREE


COMMANDS = {"new": Command(run)}
