"""`pointcoord new`: writes a scene and its mechanism file to start from."""

from __future__ import annotations

import argparse
import os
import re
from pathlib import Path

from pointcoord import UnknownName, built_in_scenes
from pointcoord.mechanism.file import MECHANISMS
from pointcoord.scene.scene_file import SCENES
from validate.commands.pages import Command
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.files import require_writable
from validate.plain_text import shown

TYPE = re.compile(r'^(type *= *)"(\w+)"', re.MULTILINE)
SCENE_NOTE = """\
# A scene: mechanism, points as drawn (mm), inputs over time, instants, effects.
# Try: pointcoord plan {name}.toml, pointcoord draw {name}.toml -o {name}.svg, pointcoord validate {name}.toml
"""
MECHANISM_NOTE = """\
# A mechanism: which points make a body, what joins the bodies, what can be driven.
#   [bodies]     a point common to two bodies is a ball joint, two common points are a hinge;
#                chassis is the ground, every other body has three points or more
#   [rods]       two points, which keep their drawn distance
#   [slides]     a point stays on a line of a body, along up, right, down, left, forward, rearward or a point
#   [inputs]     angle, travel, steers, height, contact, distance, or what moves or turns the chassis
#   [roles]      knuckle, wheel_axis, steering_axis, inboard, front_and_rear, damper: needed by effects
#   [stand_ins]  points that a drawing may leave out, and the points used in their place
#   [closures]   entries that replace entries of the same name if the scene gives this closure
#   [parts]      other mechanisms; their names are prefixed with the part's name, such as left.wheel_centre
# A scene drives as many inputs as there are degrees of freedom; pointcoord plan prints their number.
"""


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Write both files."""
    name, copied = options.name.removesuffix(".toml"), vars(options)["from"]
    if not name:
        raise UsageError("NAME is empty; allowed: the name of the new files, without .toml")
    if copied not in built_in_scenes():
        raise UnknownName("built-in scene", copied, built_in_scenes())
    text = (SCENES / f"{copied}.toml").read_text(encoding="utf-8")
    own = f"{Path(name).name}-mechanism.toml"
    found = TYPE.search(text)
    files = {f"{name}.toml": SCENE_NOTE.format(name=name) + text}
    if found is not None:
        files[f"{name}.toml"] = SCENE_NOTE.format(name=name) + TYPE.sub(rf'\1"{own}"', text)
        tables = (MECHANISMS / f"{found[2]}.toml").read_text(encoding="utf-8")
        files[f"{name}-mechanism.toml"] = MECHANISM_NOTE + tables
    for target in files:
        if os.path.exists(target):
            raise UsageError(f"{shown(target)} exists already; allowed: the name of a new file")
        require_writable(target)
    for target, content in files.items():
        console.put(target, content, "the scene or its mechanism")
    console.say(f"{' and '.join(map(shown, files))} written, copied from {shown(copied)}")
    console.say(f"to copy another (pointcoord scenes): --from SCENE; try: pointcoord plan {shown(name)}.toml")
    return ExitStatus.AGREE


COMMANDS = {"new": Command(run)}
