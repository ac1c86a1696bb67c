"""Writes a scene file from imported points: each with its source in a comment, and with wheel travel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import floor, isinf
from pathlib import Path
from typing import Any

from pointcoord import Scene
from pointcoord.drawing_stands import Standing
from pointcoord.effects.car_number import BY_TRAVEL, Angle
from pointcoord.effects.registry import EFFECTS
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file
from pointcoord.mechanism.faults import TableFault
from pointcoord.mechanism.file import AS_DRAWN, MechanismFile
from pointcoord.mechanism.inputs import Height
from validate.hardpoint_files.contents import Point
from validate.plain_text import shown
from validate.toml_written import key_of, value_of

# Wheel travel up and down, mm, if both ends of its range are at least FAR_ENOUGH away from the drawing.
TRAVEL, FAR_ENOUGH = 30.0, 40.0
# Otherwise the input moves by this share of the way from the drawing to the nearer end.
PART = 0.25
TURN = 6.2831  # rad: the range of an input without ends
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Drawing:
    """The drawing in a file.

    Attributes:
        source: the file.
        kind: a shipped mechanism, or the name of the mechanism in `tables`.
        side: side of the wheel.
        points: points of the scene.
        facts: assumptions made, in words.
        others: points of the file that are not recognised, in words.
        tables: tables of a mechanism file, if the mechanism is not a shipped one.
    """

    source: str
    kind: str
    side: str
    points: tuple[Point, ...]
    facts: tuple[str, ...]
    others: tuple[str, ...] = ()
    tables: Mapping[str, Any] | None = None


def scene_of(drawing: Drawing) -> Scene:
    """A scene of a drawing at one instant; the values of its inputs are placeholders.

    Raises:
        SceneError: the points make no car, or the tables make no mechanism.
    """
    kind = drawing.kind
    places: dict[str, Any] = {point.name: tuple(map(float, point.place)) for point in drawing.points}
    try:
        file = mechanism_file(kind) if drawing.tables is None else MechanismFile.of(drawing.tables, kind)
        driven = _driven_inputs(file, file.topology(file.structures[AS_DRAWN].placed(places)))
    except TableFault as fault:
        raise fault.of_file(drawing.source) from None
    content = {
        "title": shown(f"{kind} from {Path(drawing.source).name}"),
        "tolerance": TOLERANCE,
        "mechanism": {**(drawing.tables or {"type": kind}), "side": drawing.side, "points": places},
        "inputs": {name: {"constant": 1.0} for name in driven},
        "time": {"start": 0.0, "stop": 0.0, "samples": 1},
    }
    scene = Scene.from_mapping(content, drawing.source)
    # Effects are angles of lines, rates and accelerations; files seldom have the wheel radius or a damper.
    plain = [
        effect
        for effect in map(EFFECTS.__getitem__, scene.mechanism.effects)
        if effect.derivative <= 2 and all(isinstance(one, Angle) for one in getattr(effect, "numbers", ()))
    ]
    parts = {e.name for e in plain for o in plain if e.own_names and {*e.own_names} < {*o.own_names}}
    return scene.model_copy(update={"effects": [e.name for e in plain if e.name not in parts]})


def _driven_inputs(file: MechanismFile, topology: Topology) -> tuple[str, ...]:
    """Inputs for all degrees of freedom, with wheel travel instead of the input that moves the wheel."""
    drawn, moving = file.structures[AS_DRAWN].inputs, topology.driven_along(BY_TRAVEL)
    travel = {one.height: name for name, one in drawn.items() if isinstance(one, Height)}
    if len(moving) != 1 or topology.wheel_centre not in travel:
        return topology.required_inputs
    return tuple(travel[topology.wheel_centre] if n in moving else n for n in topology.required_inputs)


def scene_text(drawing: Drawing, drawn: Scene, stands: Standing, format_words: str) -> str:
    """The text of the scene file, with the tables of a mechanism that is not shipped."""
    tables = drawing.tables or {}
    rows = [(key_of(point.name), point.written, shown(point.source)) for point in drawing.points]
    first, second = (max(len(row[i]) for row in rows) for i in (0, 1))
    lines = [
        f"# Imported from {shown(Path(drawing.source).name)}, a {format_words}.",
        *(f"# {shown(fact)}." for fact in drawing.facts),
        f"title = {value_of(drawn.title)}",
        f"effects = {value_of(drawn.effects)}",
        f"tolerance = {drawn.tolerance:g}",
        *("", "[mechanism]"),
        *([] if tables else [f"type = {value_of(drawing.kind)}"]),
        f"side = {value_of(drawing.side)}",
        *("", "[mechanism.points]    # mm"),
        *(f"{name.ljust(first)} = {place.ljust(second)}    # {source}" for name, place, source in rows),
        *(f"# not used: {shown(source)}" for source in drawing.others),
    ]
    for name, table in tables.items():
        if table:
            lines += ["", f"[mechanism.{name}]"]
            lines += [f"{key_of(key)} = {value_of(one)}" for key, one in table.items()]
    return "\n".join([*lines, "", "[inputs]", *_laws(drawn, stands)]) + "\n"


def _laws(drawn: Scene, stands: Standing) -> Iterator[str]:
    """Lines with the laws of wheel travel about the drawing; other inputs are held as drawn.

    The wheel moves from 30 mm below to 30 mm above. If it can move less than 40 mm, or if its input is not a
    travel, the input moves a quarter of the way to the nearer end on either side.
    """
    drives = drawn.mechanism.topology.drives
    for drive in {drive.input: drive for drive in drives}.values():
        name, unit, here = drive.input, drive.unit, stands.inputs[drive.input]
        # The travel of a slide is taken as steering; other inputs move the wheel up and down.
        if drive.of_slide and not all(other.of_slide for other in drives):
            yield f"{key_of(name)} = {value_of({'constant': here})}    # {unit}, as drawn"
            continue
        low, high = (end.value for end in stands.reach[name])
        nearer, words = min(here - low, high - here), f"{unit}; it reaches {low:.4f} to {high:.4f}"
        if isinf(nearer):
            nearer, words = TURN, f"{unit}; it goes all the way round"
        way = TRAVEL if unit == "mm" and nearer >= FAR_ENOUGH else floor(1e4 * PART * nearer) / 1e4
        yield f"{key_of(name)} = {value_of({'sweep': [here - way, here + way]})}    # {words}"
