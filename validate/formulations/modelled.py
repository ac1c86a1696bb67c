"""For models without proofs: their inputs from a scene, and error bounds from a stated accuracy."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from pointcoord.errors import SceneError
from pointcoord.results.closing import ALLOWED
from pointcoord.scene.scene_file import Scene
from validate.arrays import Array
from validate.formulations.asked_numbers import asked_numbers, is_force, per_second
from validate.formulations.input_rates import laws_of
from validate.formulations.protocol import AccuracyError, FormulationError, Numbers, Solution
from validate.formulations.stated_accuracy import accuracy_at, places_in
from validate.peers.motion import OF_CAR
from validate.reference import NoReferenceError

SLOW = 2.0**-200  # rad/s and mm/s: squares of slower rates would underflow
LONGEST = 500  # exponent of the longest unit of time, 2^500 s, whose square is still finite


@dataclass(frozen=True)
class Problem:
    """A scene and its inputs.

    Attributes:
        laws: value and time derivatives of every input, (N, orders), in rad or mm, and `unit` of time.
        unit: unit of time at each instant, (N,), s.
    """

    scene: Scene
    laws: Mapping[str, Array]
    unit: Array

    @classmethod
    def of(cls, scene: Scene) -> Problem:
        """The inputs of a scene; the unit of time is 1 s, or longer where squares of all rates underflow."""
        laws = laws_of(scene, scene.instants)
        unit = _slow_unit(laws, len(scene.instants))
        laws = {name: law * unit[:, None] ** np.arange(law.shape[-1]) for name, law in laws.items()}
        return cls(scene, laws, unit)

    def solution(self, who: str, found: Numbers, accuracy: Array) -> Solution:
        """The numbers that the scene asks for, with error bounds, at the first N of its instants.

        Args:
            found: the model's numbers of every point, and of the bodies and angles that it has.
            accuracy: accuracy of points that the model states, mm, (N,): from the residual of its equations
                and the rounding of lengths of the car's size. The error bounds are derived from it here.
        Raises:
            AccuracyError: the scene has no reference equations, or a pose is so near a fold that the stated
                accuracy gives no bound.
        """
        count = len(accuracy)
        laws = {name: law[:count] for name, law in self.laws.items()}
        try:
            stated = accuracy_at(self.scene, accuracy, found["position"], laws, solves_rates=True)
        except NoReferenceError as error:
            raise AccuracyError(
                "the car", f"cannot be bounded without reference equations: {error}", "another car"
            ) from None
        if stated.blind is not None and stated.blind.any():
            # A faulty model may place points where there is no pose: bounds at pointcoord's pose are used.
            with suppress(FormulationError, SceneError):
                places = {name: place[:count] for name, place in places_in(self.scene).items()}
                stated = accuracy_at(self.scene, accuracy, places, laws, solves_rates=True)
        assert stated.blind is not None  # always set for a stated accuracy
        if stated.blind.any():
            raise AccuracyError(
                f"the pose at t = {self.scene.instants[np.argmax(stated.blind)]:.10g} s",
                "does not determine on which side of a fold the pose is",
                "poses that rounding in the model cannot move to another assembly",
            )
        numbers = self._per_second(asked_of(found, self.scene))
        claimed = replace(stated, claims=self._per_second(stated.claims), blind=None)
        return Solution(who, self.scene.instants[:count], numbers, claimed)

    def _per_second(self, numbers: Numbers) -> Numbers:
        if (self.unit == 1.0).all():
            return numbers

        def divided(array: Array, order: int) -> Array:
            return np.asarray(
                array / (self.unit[: len(array)] ** order).reshape(-1, *(1,) * (array.ndim - 1))
            )

        return {q: {n: divided(array, per_second(q)) for n, array in of.items()} for q, of in numbers.items()}


def asked_of(found: Numbers, scene: Scene) -> Numbers:
    """The numbers in `found` that a scene asks for.

    If `found` has no such quantity, numbers of the car are taken from `OF_CAR`. Exception: forces, because a
    rod may have the name of a number of the car.
    """
    asked: dict[str, dict[str, Array]] = {}
    for quantity, names in asked_numbers(scene).items():
        of_car = QUANTITIES[quantity].of == "car" and quantity not in found and not is_force(quantity)
        numbers = found.get(OF_CAR if of_car else quantity)
        if numbers is not None:
            asked[quantity] = {name: numbers[name] for name in names if name in numbers}
    return asked


def require_the_drawn_car(scene: Scene, movement: Mapping[str, float]) -> None:
    """Refuse a drawing that becomes a different car when the model closes it; pointcoord does likewise.

    Args:
        movement: how far closing the drawing moves each point, mm.
    Raises:
        SceneError: a point moves by more than is allowed.
    """
    if scene.mechanism.closure != "drawn" or not movement:
        return
    point = max(movement, key=lambda name: movement[name])
    with np.errstate(over="ignore"):
        limit = ALLOWED * float(np.max(np.ptp(np.array(list(scene.mechanism.points.values())), axis=0)))
    if movement[point] > limit:
        raise SceneError(
            scene.title or "scene",
            "mechanism.points",
            f"closing the drawing moves {point} by {movement[point]:.3g} mm: that is another car",
            f"at most {ALLOWED:.0%} of the car's size, {limit:.3g} mm; correct the points that miss",
        )


def _slow_unit(laws: Mapping[str, Array], count: int) -> Array:
    """The unit of time at each instant, a power of two, (N,), s: 1 unless all inputs are slower than SLOW."""
    fastest = np.zeros(count)
    for law in laws.values():
        for order in range(1, law.shape[-1]):
            fastest = np.maximum(fastest, np.abs(law[:, order]) ** (1.0 / order))
    slow = (fastest > 0.0) & (fastest < SLOW)
    exponent = np.minimum(-np.frexp(np.where(slow, fastest, 1.0))[1], LONGEST)
    return np.asarray(np.where(slow, np.ldexp(1.0, exponent), 1.0))
