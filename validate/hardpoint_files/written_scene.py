"""A scene file of points from elsewhere: each with its source in a comment, and a bounce to begin with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import floor
from pathlib import Path
from typing import Any

from pointcoord import Scene, standing
from pointcoord.effects.registry import EFFECTS
from pointcoord.mechanism import mechanism_file
from pointcoord.results.closing import Closing
from validate.hardpoint_files.contents import FilePoint, Place
from validate.plain_text import shown
from validate.toml_written import value_of

# Part of the way from the drawing to the nearer end of the driven input that the bounce takes: far from where
# links lie in line, and still some 50 mm of wheel travel of a road car.
PART = 0.25
# A sine of nearly one period. No instant is one at which the input turns, an odd multiple of pi / 12 s: its
# rate is rounding alone there, and a comparison of rates would test nothing.
FREQUENCY, STOP, SAMPLES = 6.0, 1.05, 43
TOLERANCE = 1e-9


@dataclass(frozen=True)
class ScenePoint:
    """A point of the scene.

    Attributes:
        name: ours. place: x rearward, y right, z up, mm. source: where it comes from, in words.
        derived: whether it follows from others and is not in the file.
    """

    name: str
    place: Place
    source: str
    derived: bool = False

    @property
    def mirrored(self) -> ScenePoint:
        """The same point of the other wheel."""
        x, y, z = self.place
        return replace(self, place=(x, -y + 0, z))

    @property
    def written(self) -> str:
        """Its coordinates as TOML, with the digits they have."""
        numbers = (f"{number.normalize() + 0:f}" for number in self.place)
        return f"[{', '.join(numbers)}]"


@dataclass(frozen=True)
class Bounce:
    """The motion that a scene begins with: one input goes up and down, the others are held as drawn.

    Attributes:
        inputs: each as in a scene. words: the same for people.
        angles: of the closed drawing, rad. closing: how far it is from closing.
    """

    inputs: Mapping[str, Mapping[str, Any]]
    words: Mapping[str, str]
    angles: Mapping[str, float]
    closing: Closing

    def added_to(self, drawn: Scene) -> dict[str, Any]:
        """The content of a drawing's scene with this motion."""
        content = drawn.model_dump(exclude_none=True)
        return content | {"inputs": self.inputs, "time": {"start": 0.0, "stop": STOP, "samples": SAMPLES}}


def scene_of(source: str, kind: str, side: str, points: Iterable[ScenePoint]) -> Scene:
    """A scene of points that stands still; its inputs have no meaning yet.

    Raises:
        SceneError: the points make no car.
    """
    content: dict[str, Any] = {
        "title": shown(f"{kind} from {Path(source).name}"),
        "tolerance": TOLERANCE,
        "mechanism": {
            "type": kind,
            "side": side,
            "points": {point.name: [float(number) for number in point.place] for point in points},
        },
        "inputs": {},
        "time": {"start": 0.0, "stop": 0.0, "samples": 1},
    }
    topology = mechanism_file(kind).topology()
    content["inputs"] = {name: {"constant": 1.0} for name in topology.required_inputs}
    scene = Scene.from_mapping(content, source)
    part = scene.mechanism
    effects = [name for name, effect in EFFECTS.items() if not effect.refusal(part.topology, part.points)]
    return scene.model_copy(update={"effects": effects})


def bounce_of(scene: Scene) -> Bounce:
    """A bounce about the drawing, with the others held as drawn, well within what the linkage reaches.

    Raises:
        AssemblyError: the drawing cannot be closed.
    """
    stands = standing(scene)
    inputs: dict[str, Mapping[str, Any]] = {}
    words: dict[str, str] = {}
    for drive in scene.mechanism.topology.drives:
        name, unit, drawn = drive.input, drive.unit, stands.inputs[drive.input]
        # What pushes a point steers; what pushes none carries the wheel up and down.
        if drive.pushes:
            inputs[name] = {"constant": drawn}
            words[name] = f"{unit}, as drawn"
            continue
        low, high = (end.value for end in stands.reach[name])
        amplitude = floor(1e4 * PART * min(drawn - low, high - drawn)) / 1e4
        inputs[name] = {"sine": {"amplitude": amplitude, "angular_frequency": FREQUENCY, "offset": drawn}}
        words[name] = (
            f"{unit}; it reaches {low:.4f} to {high:.4f}, and this takes a quarter of the shorter way"
        )
    return Bounce(inputs, words, stands.angles, stands.closing)


def scene_text(
    source: str,
    format_words: str,
    drawn: Scene,
    points: Iterable[ScenePoint],
    bounce: Bounce,
    facts: Sequence[str],
    others: Sequence[FilePoint],
) -> str:
    """The scene as a file."""
    part = drawn.mechanism
    rows = [(point.name, point.written, point.source) for point in points]
    first, second = (max(len(row[i]) for row in rows) for i in (0, 1))
    lines = [
        f"# Imported from {shown(Path(source).name)}, a {format_words}.",
        *(f"# {shown(fact)}." for fact in facts),
        f"title = {value_of(drawn.title)}",
        f"effects = [{', '.join(map(value_of, drawn.effects))}]",
        f"tolerance = {drawn.tolerance:g}",
        "",
        "[mechanism]",
        f"type = {value_of(part.name)}",
        f"side = {value_of(part.side)}",
        "",
        "[mechanism.points]    # mm",
        *(f"{name.ljust(first)} = {place.ljust(second)}    # {shown(words)}" for name, place, words in rows),
        *(f"# not used: {shown(point.name)}, line {point.line}" for point in others),
        "",
        "[inputs]",
        *(f"{name} = {value_of(law)}    # {bounce.words[name]}" for name, law in bounce.inputs.items()),
        "",
        "[time]    # s",
        "start = 0.0",
        f"stop = {STOP}",
        f"samples = {SAMPLES}",
    ]
    return "\n".join(lines) + "\n"
