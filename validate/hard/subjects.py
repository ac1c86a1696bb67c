"""The mechanisms of the hard cases, shipped ones and the cars of `CARS`, and scenes in which they move."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.resources import files
from typing import Any

import numpy as np

from pointcoord import Scene, built_in_scenes
from pointcoord.drawing_stands import drawn_inputs
from validate.cars.car import Car, Law, any_rotation, content_of
from validate.formulations.reference_solution import reference_instant

Content = dict[str, Any]
ASKED = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster")
SQUARE = 1.5707963267948966  # rad: the arm is horizontal, and its rise nearly proportional to the angle


def as_given(scene: Scene) -> Car:
    """The car of a scene, without points that only take the position of another (see `stand_ins`)."""
    car, others = Car.of(scene), scene.mechanism.structure.stand_ins
    given = {n: p for n, p in car.points.items() if p != car.points.get(others.get(n, ""))}
    return replace(car, points=given)


def _cars() -> dict[str, Car]:
    """The paper's strut, a double wishbone, and their variants in `cars.toml`."""
    paper = Scene.load("bounce").mechanism
    cars = {
        "paper": Car({n: paper.points[n] for n in paper.topology.points}, closure="collinear"),
        "wishbone": as_given(Scene.load("double-wishbone")),
    }
    rows = tomllib.loads(files("validate.hard").joinpath("cars.toml").read_text(encoding="utf-8"))
    for name, row in rows.items():
        points = {**cars[row["of"]].points, **{point: tuple(place) for point, place in row["points"].items()}}
        cars[name] = replace(cars[row["of"]], points=points, closure=row.get("closure", "drawn"))
    # The strut with its axis beside the ball joint, mirrored and turned about an oblique axis; and far away.
    other = cars["beside"].mirrored()
    cars["other"] = other.turned(any_rotation(1))
    cars["turned"] = other.turned(any_rotation(9)).moved(np.array([3e6, -2e6, 2e6]))
    return cars


CARS: Mapping[str, Car] = _cars()
"""Cars by name."""


def scene_content(car: Car, arm_angle: Law = SQUARE, rack: Law = 0.0, **settings: Any) -> dict[str, Any]:
    """The content of a scene of a car driven by arm angle and rack, rad and mm over s.

    The car is not checked here: it may be wrong on purpose, and is checked when the scene is read.

    Args:
        settings: as for `content_of`.
    """
    return content_of(car, {"arm_angle": arm_angle, "rack": rack}, **{"effects": ASKED, **settings})


def drawn_angle(car: Car) -> float:
    """The arm angle of a car as drawn, rad."""
    p = car.array
    arm = p["lower_ball_joint"] - p["lower_arm_front"]
    return math.acos(float(arm @ np.array(car.up)) / float(np.linalg.norm(arm)))


def drawn_at(car: Car, inputs: Mapping[str, float]) -> Car:
    """The car redrawn at the pose of some inputs, rad and mm, so that the new drawing is closed."""
    scene = Scene.from_mapping(content_of(car, inputs))
    pose = reference_instant(scene, {name: (value, 0.0, 0.0) for name, value in inputs.items()})
    return car.drawn_as({name: np.array(pose.position[name], dtype=float) for name in car.points})


@dataclass(frozen=True, eq=False)
class Subject:
    """A mechanism of hard cases.

    Attributes:
        name: name of its file, or of a car in `CARS`.
        car: the car as drawn.
        driven: the driven inputs.
        level: input values about which motions are made; empty: the drawn values.
        effects: the effects that its scenes ask for.
    """

    name: str
    car: Car
    driven: tuple[str, ...]
    level: Mapping[str, float] = field(default_factory=dict)
    effects: tuple[str, ...] = ASKED

    @property
    def suffix(self) -> str:
        """The suffix of the names of its cases; empty for the paper's strut."""
        return "" if self.name == "paper" else f"-{hyphens(self.name)}"

    @cached_property
    def scene(self) -> Scene:
        """A scene of the mechanism at zero inputs, to read its structure from."""
        return Scene.from_mapping(self.absolute(dict.fromkeys(self.driven, 0.0)))

    @cached_property
    def units(self) -> Mapping[str, str]:
        """The unit of each driven input: rad or mm."""
        return {name: self.scene.mechanism.structure.inputs[name].unit for name in self.driven}

    def is_a(self, kind: str, driven: str) -> bool:
        """Whether an input is of a kind: `arm`, an angle up to half a turn; `turn`, any number of turns."""
        return self.scene.mechanism.structure.inputs[driven].kind == kind

    @property
    def heaves(self) -> bool:
        """Whether the chassis can heave."""
        return "heave" in self.scene.mechanism.structure.inputs

    @property
    def of_parts(self) -> bool:
        """Whether the mechanism is composed of other mechanisms, as an axle is."""
        return bool(self.scene.mechanism.file.mirrored)

    @property
    def plain(self) -> dict[str, Any]:
        """The mechanism as plain data."""
        return self.scene.mechanism.plain(self.driven)

    @cached_property
    def drawn(self) -> Mapping[str, float]:
        """The drawn value of each input, rad or mm."""
        return {"arm_angle": drawn_angle(self.car), "rack": 0.0} if self.level else drawn_inputs(self.scene)

    @cached_property
    def assembled(self) -> Car:
        """The car with a closed drawing: redrawn at its drawn inputs if it is not drawn closed, mm."""
        return self.car if self.car.closure == "drawn" else drawn_at(self.car, self.drawn)

    @property
    def home(self) -> Mapping[str, float]:
        """The value of each input about which motions are made, rad or mm."""
        return self.level or self.drawn

    def content(
        self, rad: Law = 0.0, mm: Law = 0.0, heave: Law | None = None, *, scale: float = 1.0, **settings: Any
    ) -> Content:
        """A scene in which every input moves about home by the law of its unit.

        Args:
            rad, mm: laws of angles and of lengths, counted from home.
            scale: size of the car over the size as drawn.
            settings: as for `absolute`.
        """
        inputs = {
            name: moved_by(mm, scale * self.home[name]) if unit == "mm" else moved_by(rad, self.home[name])
            for name, unit in self.units.items()
        }
        return self.absolute(inputs | ({} if heave is None else {"heave": heave}), **settings)

    def absolute(self, inputs: Mapping[str, Law], car: Car | None = None, **settings: Any) -> Content:
        """A scene with these laws as they are, not counted from home.

        Args:
            car: used instead of the car as drawn. settings: as for `content_of`.
        """
        return content_of(car or self.car, inputs, **{"effects": self.effects, **settings})


def hyphens(name: str) -> str:
    """A name in the form of case names, with hyphens."""
    return name.replace("_", "-").replace(".", "-")


def moved_by(law: Law, home: float) -> Law:
    """A law with the value `home` added."""
    if not home:
        return law
    if isinstance(law, Sequence):
        return [home + law[0], *law[1:]]
    if not isinstance(law, Mapping):
        return home + law
    if "sine" in law:
        return {"sine": {**law["sine"], "offset": home + law["sine"].get("offset", 0.0)}}
    return {"table": {**law["table"], "values": [home + value for value in law["table"]["values"]]}}


def _others() -> Iterator[Subject]:
    """Every other shipped mechanism, with the drawing and the inputs of its first built-in scene."""
    seen = {car.suspension for car in CARS.values()}
    for scene in map(Scene.load, built_in_scenes()):
        name, inputs = scene.mechanism.name, scene.mechanism.structure.inputs
        if name not in seen:
            seen.add(name)
            driven = (n for n, one in inputs.items() if n in scene.inputs and not one.moves_the_chassis)
            yield Subject(name, as_given(scene), tuple(driven), {}, tuple(scene.effects))


LEVEL = {"arm_angle": SQUARE, "rack": 0.0}
OF_CARS = {name: Subject(name, car, tuple(LEVEL), LEVEL) for name, car in CARS.items()}
PAPER, BESIDE, WISHBONE = OF_CARS["paper"], OF_CARS["beside"], OF_CARS["wishbone"]
_EVERY = tuple(_others())
OTHERS = tuple(subject for subject in _EVERY if not subject.of_parts)
NAMED: Mapping[str, Subject] = {**OF_CARS, **{subject.name: subject for subject in _EVERY}}
# An axle takes thirty times the time of a corner. So axles are run only in families in which they do not
# repeat the answers of a corner, and mostly as the rolling axle, which includes all features of the others.
ROLLING = NAMED["rolling_axle"]
SUBJECTS = (PAPER, WISHBONE, *OTHERS)
ALL = (*SUBJECTS, *(subject for subject in _EVERY if subject.of_parts))
HEAVING = tuple(subject for subject in SUBJECTS if subject.heaves)
