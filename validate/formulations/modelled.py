"""Models that prove nothing: what they get of a scene, and bounds of their numbers by a stated accuracy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.errors import SceneError
from pointcoord.results.closing import ALLOWED
from pointcoord.scene.scene_file import Scene
from validate.formulations.asked_numbers import asked_numbers, is_force, per_second
from validate.formulations.input_rates import laws_of
from validate.formulations.protocol import AccuracyError, FormulationError, Numbers, Solution
from validate.formulations.stated_accuracy import accuracy_at, places_in
from validate.reference import NoReferenceError
from validate.spanning_tree.wheels import OF_CAR

Array = NDArray[np.float64]

SLOW = 2.0**-200  # rad/s and mm/s
LONGEST = 500  # s, as a power of two whose square is still a number


@dataclass(frozen=True)
class Problem:
    """A scene and its inputs.

    Attributes:
        laws: value and time derivatives of every input, (N, orders), rad or mm, and in the unit of time.
        unit: of time at each instant, (N,), s.
    """

    scene: Scene
    laws: Mapping[str, Array]
    unit: Array

    @classmethod
    def of(cls, scene: Scene) -> Problem:
        """The inputs per second; where all are so slow that squares of their rates are lost, per more."""
        laws = laws_of(scene, scene.instants)
        unit = _slow_unit(laws, len(scene.instants))
        laws = {name: law * unit[:, None] ** np.arange(law.shape[-1]) for name, law in laws.items()}
        return cls(scene, laws, unit)

    def solution(self, who: str, found: Numbers, accuracy: Array) -> Solution:
        """What the scene asks for, of all that was found at the first of its instants.

        Args:
            found: numbers of every point, and of the bodies and angles that the model has.
            accuracy: how exactly it says that it places points, mm, (N,): what is left of its equations, and
                what rounds lengths of the car's size. What that makes of each number is not its affair.
        Raises:
            AccuracyError: a pose is so near to a fold that the stated accuracy says nothing of it.
        """
        count = len(accuracy)
        laws = {name: law[:count] for name, law in self.laws.items()}
        try:
            stated = accuracy_at(self.scene, accuracy, found["position"], laws, solves_rates=True)
        except NoReferenceError as error:
            raise AccuracyError(
                "the car", f"has no equations to bound it by: {error}", "another car"
            ) from None
        if stated.blind is not None and stated.blind.any():
            # A model at fault may place points where there is no pose: it is held to that of the others.
            places = {name: place[:count] for name, place in self._places().items()}
            if places:
                stated = accuracy_at(self.scene, accuracy, places, laws, solves_rates=True)
        assert stated.blind is not None  # of a stated accuracy it is known
        if stated.blind.any():
            raise AccuracyError(
                f"the pose at t = {self.scene.instants[np.argmax(stated.blind)]:.10g} s",
                "leaves open on which side of a fold it is",
                "poses that a model's rounding cannot bring to another assembly",
            )
        numbers = self._per_second(asked_of(found, self.scene))
        claimed = replace(stated, claims=self._per_second(stated.claims), blind=None)
        return Solution(who, self.scene.instants[:count], numbers, claimed)

    def _places(self) -> Mapping[str, Array]:
        """Where pointcoord places every point; nothing of a scene that it refuses."""
        try:
            return places_in(self.scene)
        except (FormulationError, SceneError):
            return {}

    def _per_second(self, numbers: Numbers) -> Numbers:
        if (self.unit == 1.0).all():
            return numbers

        def divided(array: Array, order: int) -> Array:
            return np.asarray(
                array / (self.unit[: len(array)] ** order).reshape(-1, *(1,) * (array.ndim - 1))
            )

        return {q: {n: divided(array, per_second(q)) for n, array in of.items()} for q, of in numbers.items()}


def asked_of(found: Numbers, scene: Scene) -> Numbers:
    """What a scene asks for, of all that was found.

    Numbers of the car of a quantity that is not found by its name are taken from `OF_CAR`, but for forces: a
    rod may be called as a number of the car is.
    """
    asked: dict[str, dict[str, Array]] = {}
    for quantity, names in asked_numbers(scene).items():
        of_car = QUANTITIES[quantity].of == "car" and quantity not in found and not is_force(quantity)
        numbers = found.get(OF_CAR if of_car else quantity)
        if numbers is not None:
            asked[quantity] = {name: numbers[name] for name in names if name in numbers}
    return asked


def require_the_drawn_car(scene: Scene, movement: Mapping[str, float]) -> None:
    """Refuse a drawing that a model's own closing makes another car of, as pointcoord does with its own.

    Args:
        movement: by how much closing moves each point, mm.
    Raises:
        SceneError: a point moves by more than is allowed.
    """
    if scene.mechanism.closure != "drawn" or not movement:
        return
    point = max(movement, key=lambda name: movement[name])
    limit = ALLOWED * extent(scene)
    if movement[point] > limit:
        raise SceneError(
            scene.title or "scene",
            "mechanism.points",
            f"closing the drawing moves {point} by {movement[point]:.3g} mm: that is another car",
            f"at most {ALLOWED:.0%} of the car's size, {limit:.3g} mm; draw the points that miss where they "
            "belong",
        )


def extent(scene: Scene) -> float:
    """Size of the car: the longest side of the box around its points, mm."""
    with np.errstate(over="ignore"):
        return float(np.max(np.ptp(np.array(list(scene.mechanism.points.values())), axis=0)))


def _slow_unit(laws: Mapping[str, Array], count: int) -> Array:
    """A power of two at each instant, (N,), s: 1 unless all inputs are slower than SLOW."""
    fastest = np.zeros(count)
    for law in laws.values():
        for order in range(1, law.shape[-1]):
            fastest = np.maximum(fastest, np.abs(law[:, order]) ** (1.0 / order))
    slow = (fastest > 0.0) & (fastest < SLOW)
    exponent = np.minimum(-np.frexp(np.where(slow, fastest, 1.0))[1], LONGEST)
    return np.asarray(np.where(slow, np.ldexp(1.0, exponent), 1.0))
