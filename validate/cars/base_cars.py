"""The base cars from which random cars are made: those of the first built-in scene of every mechanism and
closure, or of a user's scene file.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import combinations
from pathlib import Path

import numpy as np

from pointcoord import PointcoordError, Scene, built_in_scenes
from pointcoord.mechanism import shipped
from validate.cars.car import Car
from validate.cars.input_ends import condition, drawn_inputs, end

# Input sets may have a condition number up to this factor times that of the base car's inputs; above it, a
# set hardly constrains some degree of freedom.
ALIKE = 5.0
Names = tuple[str, ...]


@dataclass(frozen=True)
class Variant:
    """A mechanism with a closure.

    Attributes:
        suspension: the type, as in a scene.
        closure: how its drawing is closed, as in a scene.
        scene: name or path of the scene of its base car.
    """

    suspension: str
    closure: str
    scene: str = field(default="", compare=False)

    @cached_property
    def base_scene(self) -> Scene:
        """The scene of the base car."""
        return Scene.load(self.scene)

    @cached_property
    def base(self) -> Car:
        """The base car."""
        return Car.of(self.base_scene)

    @property
    def chassis_motions(self) -> Names:
        """Inputs that move the whole car."""
        return tuple(name for name, one in self.base.structure.inputs.items() if one.moves_the_chassis)

    @property
    def of_parts(self) -> bool:
        """Whether the mechanism consists of others, as an axle of two corners."""
        return bool(self.base_scene.mechanism.file.mirrored)

    @property
    def holds_its_shape(self) -> bool:
        """Whether equations are redundant as drawn, as for parallel hinges: then no point may move alone."""
        return bool(self.base_scene.mechanism.topology.left_out)

    @cached_property
    def input_sets(self) -> tuple[Names, ...]:
        """Sets of inputs that can drive the mechanism; the set of the base car's scene comes first."""
        own = tuple(name for name in self.base_scene.inputs if name not in self.chassis_motions)
        limit = ALIKE * condition(self.base, drawn_inputs(self.base, own))
        return own, *(one for one in _moving_sets(self.base, len(own), limit) if set(one) != set(own))

    @cached_property
    def ending_sets(self) -> tuple[Names, ...]:
        """The input sets in which some input of the base car has an end."""
        return tuple(names for names in self.input_sets if any(self._ends(names, one) for one in names))

    def _ends(self, inputs: Names, driven: str) -> bool:
        home = drawn_inputs(self.base, inputs)
        try:
            return any(end(self.base, home, driven, ahead) is not None for ahead in (False, True))
        except PointcoordError:
            return False

    @property
    def words(self) -> str:
        """The variant in words, with the closure if there are several."""
        name = self.suspension.replace("_", " ")
        closures = {variant.closure for variant in variants() if variant.suspension == self.suspension}
        return name if len(closures) <= 1 else f"{name}, {self.closure}"


@cache
def variants() -> tuple[Variant, ...]:
    """Every mechanism and closure with a shipped scene, in the order of the mechanisms' names."""
    found = (_of_scene(name) for name in built_in_scenes())
    known = [variant for variant in dict.fromkeys(found) if variant.suspension in shipped()]
    return tuple(sorted(known, key=lambda v: (v.suspension, v.closure != "drawn", v.closure)))


def variants_of(suspension: str | None = None, closure: str | None = None) -> list[Variant]:
    """The variants with a suspension and a closure.

    Args:
        suspension: the type, or the path of a scene file (.toml); any shipped one if not given.
        closure: any closure if not given.
    Raises:
        ValueError: there is no such variant.
        SceneError: the scene file cannot be read.
    """
    if suspension is not None and Path(suspension).suffix == ".toml":
        there: tuple[Variant, ...] = (_of_scene(suspension),)
    else:
        there = tuple(one for one in variants() if suspension in (None, one.suspension))
    found = [one for one in there if closure in (None, one.closure)]
    if not found:
        known = "; ".join(f"{one.suspension}: {one.closure}" for one in there or variants())
        raise ValueError(f"no car has suspension={suspension!r} and closure={closure!r}; there are: {known}")
    return found


@cache
def _of_scene(name: str) -> Variant:
    part = Scene.load(name).mechanism
    return Variant(part.name, part.closure, name)


def input_sets(car: Car) -> tuple[Names, ...]:
    """Sets of inputs that can drive a car; for a shipped mechanism the sets of its base car."""
    for variant in variants():
        if (variant.suspension, variant.closure, None) == (car.suspension, car.closure, car.tables):
            return variant.input_sets
    each = (_moving_sets(car, size) for size in range(1, len(car.structure.inputs) + 1))
    return next((sets for sets in each if sets), ())


def _moving_sets(car: Car, size: int, limit: float = np.inf) -> tuple[Names, ...]:
    """The sets of `size` inputs that drive all degrees of freedom of a car.

    Args:
        limit: upper limit of the condition number of the drawing.
    """

    def moves(inputs: Names) -> bool:
        try:
            home = drawn_inputs(car, inputs)
            return set(home) == set(inputs) and condition(car, home) < limit
        except PointcoordError:
            return False

    names = [name for name, one in car.structure.inputs.items() if not one.moves_the_chassis]
    return tuple(filter(moves, combinations(names, size)))
