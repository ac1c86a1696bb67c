"""Makes a scene from another program's file.

Nothing is guessed. Axes and units that contradict the points are refused, unknown points are listed, and
missing points are refused.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from pointcoord import Scene, standing
from pointcoord.drawing_stands import Standing
from pointcoord.toml_text import parsed, read_file
from validate.hardpoint_files.contents import OUR_AXES, Axes, Contents
from validate.hardpoint_files.format import MJCF, Format, format_of
from validate.hardpoint_files.identified import Choices, HardpointFile, Wheel, missing
from validate.hardpoint_files.mjcf import mechanism_of
from validate.hardpoint_files.names_file import NO_NAMES, names_to_fill_in, read_names
from validate.hardpoint_files.one_wheel import AngleCheck, angle_checks, drawing_of
from validate.hardpoint_files.written_scene import Drawing, scene_of, scene_text
from validate.tables.cells import text_of
from validate.tables.errors import FileError


@dataclass(frozen=True)
class Imported:
    """A scene from another program's file.

    Attributes:
        drawing: the points with their sources, the assumptions made, and points that are not recognised.
        scene: the checked scene, with wheel travel.
        text: the scene as a file, with a comment on each point.
        stands: the closed drawing.
        angles: static angles printed in the file, compared with the drawing.
    """

    format: Format
    drawing: Drawing
    scene: Scene
    text: str
    stands: Standing
    angles: tuple[AngleCheck, ...]


def import_hardpoints(path: str | Path, **said: Any) -> Imported:
    """Make a scene from a file of hardpoints; the arguments are those of `Choices`.

    Raises:
        SceneError: the file cannot be read.
        FileError: the file has a wrong format, or lacks something that is needed.
        UnknownName: no such format, suspension or point.
        UsageError: `axes` are not valid.
        AssemblyError: the points cannot be assembled.
    """
    choices, source = Choices(**said), str(path)
    found, text = _opened(source, choices)
    wheel = None
    if found.name == MJCF:
        drawing = _whole_mechanism(source, choices)
    else:
        own = NO_NAMES if choices.names is None else read_names(choices.names)
        wheel = Wheel.of(HardpointFile(source, choices, found, found.read(text, source, own.table), own))
        drawing = drawing_of(wheel)
    drawn = scene_of(drawing)
    stands = standing(drawn)
    text = scene_text(drawing, drawn, stands, found.words)
    scene = Scene.from_mapping(parsed(text.encode(), source), drawn.title)
    angles = tuple(angle_checks(wheel, stands.angles)) if wheel else ()
    return Imported(found, drawing, scene, text, stands, angles)


def names_of(path: str | Path, format: str | None = None, suspension: str | None = None) -> str:
    """A file of names (TOML) to fill in for a file of hardpoints, with the recognised points filled in.

    Raises:
        SceneError, FileError, UnknownName: as `import_hardpoints`.
    """
    choices, source = Choices(format, suspension), str(path)
    found, text = _opened(source, choices)
    if found.name == MJCF:
        raise _takes_no(source, "names")
    try:
        contents = found.read(text, source, {})
    except FileError:
        # Such as a table with unknown columns: the file of names can give them.
        contents = Contents(())
    file = HardpointFile(source, choices, found, contents, NO_NAMES)
    kind = suspension or file.closest()[0]
    known, others = file.named(kind)
    return names_to_fill_in(source, kind, missing(kind, ()), dict(known), others)


def _opened(source: str, choices: Choices) -> tuple[Format, str]:
    """The format and the text of a file."""
    text = text_of(read_file(source, "the path of a file of hardpoints"))
    if text is None:
        raise FileError(source, 0, "is not text", "a text file; for a workbook, save one sheet as CSV")
    return format_of(text, choices.format), text


def _takes_no(source: str, option: str) -> FileError:
    allowed = "--axes, the directions of x, y and z; names of sites become names of points"
    return FileError(source, 0, f"is a whole mechanism, for which --{option} has no meaning", allowed)


def _whole_mechanism(source: str, choices: Choices) -> Drawing:
    """The drawing of a file that contains a whole mechanism."""
    for one in fields(choices):
        if one.name not in ("format", "axes") and getattr(choices, one.name) != one.default:
            raise _takes_no(source, one.name)
    axes = OUR_AXES if choices.axes is None else Axes.of(choices.axes)
    if np.linalg.det(axes.matrix) < 0:
        raise FileError(source, 0, f"has left-handed axes {axes.words}", "right-handed ones")
    by = "the default of --axes" if choices.axes is None else "by --axes"
    turned = f"the file's axes are {axes.words}, {by}, in m; here x rearward, y right, z up, in mm"
    drawing = mechanism_of(source, axes)
    return replace(drawing, facts=(turned, *drawing.facts))
