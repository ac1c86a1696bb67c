"""Drawings of every kind that the reference is tried with: shipped ones, and small ones by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, partial
from typing import Any

from mechanism_files import full_input, plain_scene, scene_file

from validate.reference import Design, Instant, instants_of

Points = Mapping[str, Sequence[Any]]
Inputs = Mapping[str, tuple[Any, ...]]


def described(
    points: Points,
    bodies: Mapping[str, Sequence[str]],
    inputs: Mapping[str, Mapping[str, Any]],
    slides: Mapping[str, Mapping[str, Any]] | None = None,
    **others: Any,
) -> dict[str, Any]:
    """A description of its own, what may be left out filled in."""
    default = {"body": "chassis", "turns": True}
    return {
        "name": "by hand",
        "points": points,
        "bodies": {name: list(names) for name, names in bodies.items()},
        "inputs": {name: full_input(spec) for name, spec in inputs.items()},
        "rods": {},
        "slides": {name: {**default, **spec} for name, spec in (slides or {}).items()},
        "roles": {},
        "up": (0, 0, 1),
        "right": (0, 1, 0),
        "side": "left",
        "wheel_radius": None,
        **others,
    }


@dataclass(frozen=True)
class ReferenceCar:
    """A shipped car that arm angle, rack and heave drive, and inputs near its drawing where it is regular.

    Attributes:
        last_rack: a rack travel at which there is no pose with its arm as drawn, mm; at half of it there is.
        moved: points in the place of its own.
    """

    scene: str
    inputs: Inputs
    last_rack: int
    moved: Points = field(default_factory=dict)

    @property
    def points(self) -> Points:
        """As drawn, mm."""
        return {**scene_file(self.scene)["mechanism"]["points"], **self.moved}

    @property
    def design(self) -> Design:
        return Design.from_plain(plain_scene(self.scene, self.inputs, points=self.points))

    @property
    def still(self) -> dict[str, tuple[Any, ...]]:
        """The inputs without motion."""
        return {name: (value, 0, 0) for name, (value, *_) in self.inputs.items()}

    def solve(self, inputs: Inputs, **settings: Any) -> Instant:
        """The reference at one instant; inputs that are not given are as drawn."""
        return next(instants_of(self.design, [inputs], **settings))


def _inputs(arm: tuple[Any, ...], rack: tuple[int, ...], heave: tuple[int, ...]) -> Inputs:
    triples = {"arm_angle": arm, "rack": rack, "heave": heave}
    return {name: tuple(map(Fraction, triple)) for name, triple in triples.items()}


# One for each closed form.
CARS = {
    "strut as drawn": ReferenceCar(
        "off-axis-strut", _inputs((1.625, 2, -3), (24, 150, -400), (5, -60, 700)), 300
    ),
    "collinear strut": ReferenceCar("bounce", _inputs((1.5, 0.25, 0.125), (20, 150, 50), (3, 100, 10)), 200),
    "double wishbone": ReferenceCar(
        "double-wishbone", _inputs((1.5, 0.5, -0.25), (10, -150, 50), (-4, 80, 20)), 300
    ),
}
# Two arms of 4 and 3 one on the other, each about z; the second is turned against the first.
DOUBLE_ARM = described(
    {"o": (0, 0, 0), "o2": (0, 0, 1), "e": (4, 0, 0), "e2": (4, 0, 2), "tip": (7, 0, 0)},
    {"chassis": ["o", "o2"], "upper": ["o", "o2", "e", "e2"], "fore": ["e", "e2", "tip"]},
    {
        "shoulder": {"angle": "upper", "from": "drawing"},
        "elbow": {"angle": "fore", "from": "drawing", "on": "upper"},
    },
)
# A block on a rail along (3, 4, 0) that may not turn.
BLOCK = described(
    {"rail": (0, 0, 0), "end": (30, 40, 0), "front": (3, 4, 0), "rear": (6, 8, 0), "side": (1, 2, 3)},
    {"chassis": ["rail", "end"], "block": ["front", "rear", "side"]},
    {"push": {"travel": "rail"}},
    {"rail": {"points": ["front", "rear"], "through": "rail", "along": "end", "turns": False}},
)
PLAIN: dict[str, Callable[[], Mapping[str, Any]]] = {
    **{
        name: partial(plain_scene, name)
        for name in ("five-link", "semi-trailing-arm", "slider-crank", "spatial-four-bar")
    },
    "double arm": lambda: DOUBLE_ARM,
    "block": lambda: BLOCK,
}
DRAWINGS = (*CARS, *PLAIN)


@cache
def drawing(name: str) -> Design:
    """One of `DRAWINGS`."""
    return CARS[name].design if name in CARS else Design.from_plain(PLAIN[name]())
