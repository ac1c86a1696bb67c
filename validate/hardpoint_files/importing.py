"""Makes a scene from another program's file.

Nothing is guessed. Axes and units that contradict the points are refused, unknown points are listed, and
missing points are refused.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from pointcoord import Scene, standing
from pointcoord.drawing_stands import Standing
from pointcoord.toml_text import parsed, read_file
from validate.hardpoint_files.contents import OUR_AXES, Axes, Contents
from validate.hardpoint_files.format import MJCF, Format, format_of
from validate.hardpoint_files.mjcf import drawing_of
from validate.hardpoint_files.names_file import NO_NAMES, names_to_fill_in, read_names
from validate.hardpoint_files.one_wheel import AngleCheck, Choices, OneWheel, missing
from validate.hardpoint_files.written_scene import Drawing, scene_of, scene_text, travel_of
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
    angles: tuple[AngleCheck, ...] = ()


def import_hardpoints(path: str | Path, **said: Any) -> Imported:
    """Make a scene from a file of hardpoints; the arguments are those of `Choices`.

    Raises:
        SceneError: the file cannot be read.
        FileError: the file has a wrong format, or lacks something that is needed.
        UnknownName: no such format, suspension, side, part, unit or point.
        UsageError: `axes` are not valid.
        AssemblyError: the points cannot be assembled.
    """
    choices, source = Choices(**said), str(path)
    found, text = _opened(source, choices)
    if found.name == MJCF:
        return _imported(found, _whole_mechanism(source, choices))
    own = NO_NAMES if choices.names is None else read_names(choices.names)
    wheel = OneWheel(source, choices, found, found.read(text, source, own.table), own)
    imported = _imported(found, wheel.drawing())
    return replace(imported, angles=tuple(wheel.checked(imported.stands.angles)))


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
    one = OneWheel(source, choices, found, contents, NO_NAMES)
    kind = suspension or one.closest()[0]
    known, others = one.named(kind)
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
    axes, by = OUR_AXES, "the default of --axes"
    if choices.axes is not None:
        axes, by = Axes.of(choices.axes), "by --axes"
    if not axes.right_handed:
        raise FileError(source, 0, f"has left-handed axes {axes.words}", "right-handed ones")
    drawing = drawing_of(source, axes)
    turned = f"the file's axes are {axes.words}, {by}, in m; here x rearward, y right, z up, in mm"
    return replace(drawing, facts=(turned, *drawing.facts))


def _imported(found: Format, drawing: Drawing) -> Imported:
    """The scene of a drawing, and its file."""
    drawn = scene_of(drawing)
    stands = standing(drawn)
    text = scene_text(drawing, drawn, travel_of(drawn, stands), found.words)
    scene = Scene.from_mapping(parsed(text.encode(), drawing.source), drawn.title)
    return Imported(found, drawing, scene, text, stands)
