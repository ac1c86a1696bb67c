"""A map of columns, ready to be filled in: what is known of each column, and a line for each that is not."""

from __future__ import annotations

from pointcoord import Scene
from validate.measured.mapping import CONTACT, PLACES, known_columns
from validate.measured.reading import read_columns
from validate.plain_text import shown
from validate.toml_written import key_of, value_of


def map_to_fill_in(file: str, scene: Scene) -> str:
    """The text of a map (TOML) of a file of results of a scene's car.

    Raises:
        FileError: the file cannot be read.
        MissingPackage: Parquet needs pyarrow.
    """
    columns = read_columns(file)
    known = known_columns(columns, scene)
    topology = scene.mechanism.topology
    inputs = ", ".join(f"input.{name}" for name in topology.inputs)
    lines = [
        f"# What the columns of {columns.source} are. Fill in what is missing, and take its # away.",
        f"# is: time, {inputs}, travel.POINT, travel.{CONTACT}, QUANTITY.NAME[.AXIS], ignore",
        f"#     such as {PLACES}.{topology.wheel_centre}.z, {', '.join(known.names[:5])}",
        "# unit: mm, deg, rad, s and the like. More keys: sign = -1, offset = 0.5, definition = 'arcsine',",
        "#     printed = 0.01 (the unit of the last digit; 0: exact as written), accuracy = 0.001",
        f"# rolling_radius = 300.0    # mm, of travel.{CONTACT}",
        "",
        "[columns]",
    ]
    for name, (words, unit) in known.columns.items():
        off = "" if words and unit else "# "
        lines.append(f"{off}{key_of(shown(name))} = {value_of({'is': words, 'unit': shown(unit)})}")
    return "\n".join(lines) + "\n"
