"""The mechanisms that cases are made of, and scenes in which their inputs move: shipped ones, and cars."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from pointcoord import Scene, built_in_scenes
from pointcoord.drawing_stands import drawn_inputs
from validate.cars.car import Car
from validate.cars.scene_content import Law, content_of
from validate.hard.cars import ASKED, CARS, SQUARE, as_given, drawn_angle

Content = dict[str, Any]


# angle: 0 to pi from a direction; turn: any number of turns from the drawing; length.
Kind = Literal["angle", "turn", "length"]
KINDS: Mapping[str, Kind] = {"arm": "angle", "turn": "turn"}


@dataclass(frozen=True, eq=False)
class Subject:
    """A mechanism as cases try it.

    Attributes:
        name: of its file, or of a car of `CARS`.
        car: as it is drawn.
        kinds: of each input that is driven.
        level: values of the inputs that motions are about, if not those of the drawing.
        heaves: whether the chassis can heave.
        effects: that are asked for.
        of_parts: whether other mechanisms are its parts.
    """

    name: str
    car: Car
    kinds: Mapping[str, Kind]
    level: Mapping[str, float] = field(default_factory=dict)
    heaves: bool = True
    effects: tuple[str, ...] = ASKED
    of_parts: bool = False

    @property
    def suffix(self) -> str:
        """What the names of its cases end with; nothing of the paper's strut."""
        return "" if self.name == "paper" else f"-{hyphens(self.name)}"

    @property
    def units(self) -> Mapping[str, str]:
        """Of each input."""
        return {name: "mm" if kind == "length" else "rad" for name, kind in self.kinds.items()}

    @cached_property
    def plain(self) -> Mapping[str, Any]:
        """The mechanism as plain data."""
        scene = Scene.from_mapping(self.absolute(dict.fromkeys(self.kinds, 0.0)))
        return scene.mechanism.plain(tuple(self.kinds))

    @cached_property
    def drawn(self) -> Mapping[str, float]:
        """The value of each input as drawn, rad or mm."""
        if self.level:
            return {"arm_angle": drawn_angle(self.car), "rack": 0.0}
        return drawn_inputs(Scene.from_mapping(self.absolute(dict.fromkeys(self.kinds, 0.0))))

    @property
    def home(self) -> Mapping[str, float]:
        """The value of each input that motions are about, rad or mm."""
        return self.level or self.drawn

    def content(
        self,
        rad: Law = 0.0,
        mm: Law = 0.0,
        heave: Law | None = None,
        *,
        car: Car | None = None,
        only: str = "",
        scale: float = 1.0,
        **settings: Any,
    ) -> Content:
        """A scene in which every input moves about home by the law of its unit.

        Args:
            rad, mm: laws of angles and of lengths, from home.
            car: in place of the mechanism as it is drawn.
            only: the one input that moves; the others rest at home.
            scale: of the car over the mechanism as it is drawn.
        """
        laws = {"rad": rad, "mm": mm}
        inputs = {
            name: moved_by(
                laws[unit] if only in ("", name) else 0.0, self.home[name] * (scale if unit == "mm" else 1.0)
            )
            for name, unit in self.units.items()
        }
        return self.absolute(inputs | ({} if heave is None else {"heave": heave}), car, **settings)

    def absolute(self, inputs: Mapping[str, Law], car: Car | None = None, **settings: Any) -> Content:
        """A scene with these laws, which are not counted from home."""
        return content_of(car or self.car, inputs, **{"effects": self.effects, **settings})


def hyphens(name: str) -> str:
    """A name as names of cases have it."""
    return name.replace("_", "-").replace(".", "-")


def moved_by(law: Law, home: float) -> Law:
    """A law counted from home."""
    if not home:
        return law
    if isinstance(law, Sequence):
        return [home + law[0], *law[1:]]
    if not isinstance(law, Mapping):
        return home + law
    if "sine" in law:
        wave = law["sine"]
        return {"sine": {**wave, "offset": home + wave.get("offset", 0.0)}}
    table = law["table"]
    return {"table": {**table, "values": [home + value for value in table["values"]]}}


ARM_AND_RACK: Mapping[str, Kind] = {"arm_angle": "angle", "rack": "length"}
LEVEL = {"arm_angle": SQUARE, "rack": 0.0}
OF_CARS = {name: Subject(name, car, ARM_AND_RACK, LEVEL) for name, car in CARS.items()}
PAPER, BESIDE, WISHBONE = OF_CARS["paper"], OF_CARS["beside"], OF_CARS["wishbone"]


def _of_scene(scene: Scene) -> Subject:
    """The mechanism of a scene, driven by the inputs that the scene drives."""
    part = scene.mechanism
    inputs = {name: one for name, one in part.structure.inputs.items() if name in scene.inputs}
    kinds = {n: KINDS.get(one.kind, "length") for n, one in inputs.items() if not one.moves_the_chassis}
    heaves = "heave" in part.structure.inputs
    parts = bool(part.file.mirrored)
    return Subject(part.name, as_given(scene), kinds, {}, heaves, tuple(scene.effects), parts)


def _others() -> Iterator[Subject]:
    """Every other mechanism that is shipped, as the first scene of it draws it."""
    seen = {subject.car.suspension for subject in OF_CARS.values()}
    for scene in map(Scene.load, built_in_scenes()):
        if scene.mechanism.name not in seen:
            seen.add(scene.mechanism.name)
            yield _of_scene(scene)


_EVERY = tuple(_others())
OTHERS = tuple(subject for subject in _EVERY if not subject.of_parts)
# Two corners on one rack take thirty times the time of one: families of which they would repeat each corner's
# answers leave them out.
OF_PARTS = tuple(subject for subject in _EVERY if subject.of_parts)
NAMED: Mapping[str, Subject] = {**OF_CARS, **{subject.name: subject for subject in _EVERY}}
SUBJECTS = (PAPER, WISHBONE, *OTHERS)
ALL = (*SUBJECTS, *OF_PARTS)
HEAVING = tuple(subject for subject in SUBJECTS if subject.heaves)
