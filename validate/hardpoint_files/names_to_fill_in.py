"""A file of names, ready to be filled in: which of our points each point of a file is, as far as known."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from validate.hardpoint_files.contents import FilePoint
from validate.plain_text import shown
from validate.toml_written import value_of


def names_to_fill_in(
    source: str, kind: str, needed: Iterable[str], ours: Mapping[str, FilePoint], others: Iterable[FilePoint]
) -> str:
    """The text of a file of names (TOML).

    Args:
        needed: our names of the points that a car of this kind has.
        ours: the points of the file that are known. others: those that are not.
    """
    points = [f"#   {shown(p.name)}, line {p.line}" for p in others]
    lines = [f"# Which points of {shown(source)} are which of a {kind}. Fill in, and take the # away."]
    lines += ["# Points of the file that are not known:", *points] if points else []
    lines += ["", "[names]"]
    for name in needed:
        if name in ours:
            lines.append(f"{name} = {value_of(shown(ours[name].name))}")
        else:
            lines.append(f'# {name} = "its name", or [x, y, z] in the axes and unit of the file')
    table = ('name = "Point"', 'x = "X"', 'y = "Y"', 'z = "Z"')
    lines += ["", "# [table]    # columns of a table: their titles, or their numbers from 1"]
    return "\n".join([*lines, *(f"# {line}" for line in table)]) + "\n"
