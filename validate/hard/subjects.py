"""The mechanisms of the hard cases, shipped ones and the cars of `CARS`, and scenes in which they move."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.resources import files
from typing import Any

import numpy as np

from pointcoord import Scene, built_in_scenes
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.mechanism.inputs import Input
from validate.cars.car import Car, Law, any_rotation, content_of
from validate.formulations.reference_solution import reference_instant

Content = dict[str, Any]
ASKED = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster")
SQUARE = 1.5707963267948966  # rad: the arm is horizontal, and its rise nearly proportional to the angle


def scene_content(car: Car, arm_angle: Law = SQUARE, rack: Law = 0.0, **settings: Any) -> Content:
    """The scene of a car, which may be wrong on purpose, driven by these two inputs; see `content_of`."""
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
        suffix: what the names of its cases end with.
        car: the car as drawn.
        home: the value of each driven input about which motions are made, rad or mm.
        drawn: the value of each as drawn, rad or mm.
        effects: the effects that its scenes ask for.
    """

    name: str
    suffix: str
    car: Car
    home: Mapping[str, float]
    drawn: Mapping[str, float]
    effects: tuple[str, ...] = ASKED

    @property
    def driven(self) -> tuple[str, ...]:
        """The driven inputs."""
        return tuple(self.home)

    @cached_property
    def scene(self) -> Scene:
        """A scene of the mechanism at zero inputs, to read its structure from."""
        return Scene.from_mapping(self.absolute(dict.fromkeys(self.driven, 0.0)))

    @property
    def inputs(self) -> Mapping[str, Input]:
        """All inputs of the mechanism, by name."""
        return self.scene.mechanism.structure.inputs

    @property
    def plain(self) -> dict[str, Any]:
        """The mechanism as plain data."""
        return self.scene.mechanism.plain(self.driven)

    @cached_property
    def assembled(self) -> Car:
        """The car with a closed drawing: redrawn at its drawn inputs if it is not drawn closed, mm."""
        return self.car if self.car.closure == "drawn" else drawn_at(self.car, self.drawn)

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
            name: moved_by(mm, scale * home) if self.inputs[name].unit == "mm" else moved_by(rad, home)
            for name, home in self.home.items()
        }
        return self.absolute(inputs | ({} if heave is None else {"heave": heave}), **settings)

    def absolute(self, inputs: Mapping[str, Law], car: Car | None = None, **settings: Any) -> Content:
        """A scene with these laws as they are, not counted from home.

        Args:
            car: used instead of the car as drawn. It is not checked here, and may be wrong on purpose.
            settings: as for `content_of`.
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


def _shipped() -> Iterator[Subject]:
    """Every other shipped mechanism, with the drawing and the inputs of its first built-in scene."""
    seen = {car.suspension for car in CARS.values()}
    for scene in map(Scene.load, built_in_scenes()):
        name, inputs = scene.mechanism.name, scene.mechanism.structure.inputs
        if name not in seen:
            seen.add(name)
            drawn = drawn_inputs(scene)
            home = {n: drawn[n] for n in inputs if n in scene.inputs and not inputs[n].moves_the_chassis}
            yield Subject(name, f"-{hyphens(name)}", as_given(scene), home, home, tuple(scene.effects))


CARS: Mapping[str, Car] = _cars()
"""Cars by name."""
LEVEL = {"arm_angle": SQUARE, "rack": 0.0}
SUFFIXES = {"macpherson": "", "double_wishbone": "-wishbone"}
OF_CARS = {
    name: Subject(name, SUFFIXES[car.suspension], car, LEVEL, {"arm_angle": drawn_angle(car), "rack": 0.0})
    for name, car in CARS.items()
}
PAPER, BESIDE, WISHBONE = OF_CARS["paper"], OF_CARS["beside"], OF_CARS["wishbone"]
SHIPPED = {subject.name: subject for subject in _shipped()}
NAMED: Mapping[str, Subject] = {**OF_CARS, **SHIPPED}
# An axle takes thirty times the time of a corner. So axles are run only in families in which they do not
# repeat the answers of a corner, and mostly as the rolling axle, which includes all features of the others.
AXLES, ROLLING = (SHIPPED["axle"], SHIPPED["rolling_axle"]), SHIPPED["rolling_axle"]
OTHERS = tuple(subject for subject in SHIPPED.values() if subject not in AXLES)
SUBJECTS = (PAPER, WISHBONE, *OTHERS)
ALL = (*SUBJECTS, *AXLES)
HEAVING = tuple(subject for subject in SUBJECTS if "heave" in subject.inputs)
