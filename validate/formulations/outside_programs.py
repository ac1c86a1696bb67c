r"""Other people's programs as formulations: outside witnesses, which share no mechanics with any of ours.

What they claim of their accuracy is an estimate. A program's roundings are taken as those of a car whose
hardpoints are off by a little: a place at the end of three joints is a chain of three turns and sums, some
60 roundings of numbers up to 1 in sizes of the car, of which 4 standard deviations are about 10 u; 16 u are
taken, and with them the square of Newton's last correction. What that does to each number is measured: cars
whose hardpoints are shifted at random are solved by the same program at the same inputs, themselves shifted
by what rounding may put them off, and a number is claimed to the mean square of how it changes. Rates are
claimed to as many roundings of the largest of their kind at least, for they are solved for together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, SceneError
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.results.closing import ALLOWED
from validate.formulations.asked_numbers import asked_numbers, per_second
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Accuracy, FormulationError, Numbers, Solution
from validate.peers.linkage import Linkage, PeerError, linkage_of
from validate.peers.motion import Poses, Rates

Array = NDArray[np.float64]

# Rad and car sizes: far above rounding, and its square far below. A correction that small leaves none.
TOLERANCE = 1e-10
ROUNDING = 16.0 * UNIT_ROUNDOFF  # of a hardpoint, car sizes
SHIFT = 2.0**-30  # by which hardpoints are shifted: so far above rounding as the change is far from curving
PROBES = 6  # with the three components of each number, an estimate to within a factor of two
SEED = 20261122


class Engine(Protocol):
    """A linkage in somebody's program."""

    def poses(self, driven: Array, tolerance: float) -> Poses:
        """Poses at turns of the arm and travels of the rack, (N, 2), each solved from the one before."""
        ...

    def rates(self, poses: Poses, rate: Array, bend: Array) -> Rates:
        """Their rates, from those of what is driven, each (N, 2)."""
        ...


@dataclass(frozen=True)
class Inputs:
    """What is told to a program, and how far it may be off by rounding; in its unit of length.

    Attributes:
        driven, doubt: turn of the arm and travel of the rack with two time derivatives, (N, 3, 2).
        chassis: displacement, velocity and acceleration of the chassis, (N, 3, 3), mm.
    """

    driven: Array
    doubt: Array
    chassis: Array


@dataclass(frozen=True)
class Car:
    """A scene's car as a linkage, and how its motion is reported.

    Attributes:
        asked: names by quantity.
    """

    scene: Scene
    linkage: Linkage
    asked: Mapping[str, tuple[str, ...]]

    @classmethod
    def of(cls, scene: Scene, shift: Mapping[str, Array] | None = None) -> Car:
        """The car of a scene, or one whose hardpoints are shifted, (3,), mm.

        Raises:
            PeerError: its points make no linkage.
        """
        part = scene.mechanism
        points = {
            n: np.array(place) + (0.0 if shift is None else shift[n]) for n, place in part.points.items()
        }
        linkage = linkage_of(part.type, points, part.up, part.right, part.closure)
        return cls(scene, linkage, asked_numbers(scene))

    def inputs(self, laws: Mapping[str, Array]) -> Inputs:
        """What drives the program, from the inputs' values, rates and accelerations, each (N, 3).

        Raises:
            PeerError: the arm does not reach what it is driven to.
        """
        turn, off = self.linkage.turns(laws["arm_angle"])
        travel = laws["rack"] / self.linkage.unit
        chassis = np.zeros((*turn.shape, 3))
        directions = {"up": self.scene.mechanism.up, "right": self.scene.mechanism.right}
        for name, direction in self.scene.mechanism.topology.chassis_motion.items():
            if name in laws:
                chassis += laws[name][..., None] * np.array(directions[direction])
        doubt = np.stack([off, UNIT_ROUNDOFF * np.abs(travel)], axis=-1)
        return Inputs(np.stack([turn, travel], axis=-1), doubt, chassis)

    def require_the_drawn_car(self, poses: Poses) -> None:
        """Refuse a drawing that the program's own closing makes another car of.

        Raises:
            SceneError: a point moves by more than is allowed.
        """
        if self.scene.mechanism.topology.puts_in_place:
            return
        corners = np.array(list(self.linkage.drawn.values()))
        limit = ALLOWED * float(np.max(np.ptp(corners, axis=0)))
        moved = {n: float(np.linalg.norm(place - self.linkage.drawn[n])) for n, place in poses.closed.items()}
        point = max(moved, key=lambda name: moved[name])
        if moved[point] > limit:
            unit = self.linkage.unit
            raise SceneError(
                self.scene.title or "scene",
                "mechanism.points",
                f"closing the drawing moves {point} by {moved[point] * unit:.3g} mm: that is another car",
                f"at most {ALLOWED:.0%} of the car's size, {limit * unit:.3g} mm; draw the points that miss "
                "where they belong",
            )

    def numbers(self, inputs: Inputs, poses: Poses, rates: Rates | None) -> Numbers:
        """What the scene asks for, in its axes and units; rates where they are there."""
        unit, linkage, asked = self.linkage.unit, self.linkage, self.asked
        near = linkage.with_chassis(poses.places)
        shift = linkage.origin + inputs.chassis[:, 0]
        found: dict[str, dict[str, Array]] = {
            "position": {name: near[name] * unit + shift for name in asked["position"]}
        }
        if "wheel" in asked:
            found["wheel"] = {name: self._angle(name, near) for name in asked["wheel"]}
        if rates is not None:
            for order, (quantity, moving) in enumerate(
                (("velocity", rates.velocity), ("acceleration", rates.acceleration)), 1
            ):
                added = inputs.chassis[:, order]
                found[quantity] = {
                    name: moving[name] * unit + added if name in moving else added
                    for name in asked.get(quantity, ())
                }
            for quantity, spin in (
                ("angular_velocity", rates.spin),
                ("angular_acceleration", rates.spin_rate),
            ):
                found[quantity] = dict.fromkeys(asked.get(quantity, ()), spin)
        return {quantity: arrays for quantity, arrays in found.items() if arrays}

    def _line(self, angle: str) -> tuple[str, str]:
        topology = self.scene.mechanism.topology
        return topology.wheel_axis if angle in ("camber", "toe") else topology.steering_axis

    def _angle(self, name: str, places: Mapping[str, Array]) -> Array:
        """A wheel angle by its definition, (N,), rad."""
        part = self.scene.mechanism
        up, outboard = np.array(part.up), part.outboard
        rearward = np.cross(np.array(part.right), up)
        start, end = (places[point] for point in self._line(name))
        line = end - start
        if name == "camber":
            return np.asarray(np.arctan2(-line @ up, line @ outboard))
        if name == "toe":
            return np.asarray(np.arctan2(-line @ rearward, line @ outboard))
        across = -outboard if name == "kingpin" else rearward
        return np.asarray(np.arctan2(line @ across, line @ up))


@dataclass(frozen=True)
class OutsideProgram:
    """A program as a formulation.

    Attributes:
        name: as a formulation.
        engine: makes a linkage one of the program's own models.
    """

    name: str
    engine: Callable[[Linkage], Engine]

    def solve(self, scene: Scene) -> Solution:
        """Solve a scene at its instants.

        Raises:
            FormulationError: a pose is not reached, or the drawing is no such car.
        """
        laws = {name: rates(law, scene.instants) for name, law in scene.inputs.items()}
        try:
            car = Car.of(scene)
            inputs = car.inputs(laws)
            numbers, last_step = self._numbers(car, inputs)
            accuracy = self._accuracy(car, inputs, laws, numbers, last_step)
        except (PeerError, SceneError) as error:
            raise FormulationError(self.name, error) from error
        return Solution(self.name, scene.instants, numbers, accuracy)

    def _numbers(self, car: Car, inputs: Inputs) -> tuple[Numbers, Array]:
        """What the scene asks for, and Newton's last correction at each instant, (N,)."""
        engine = self.engine(car.linkage)
        poses = engine.poses(inputs.driven[:, 0], TOLERANCE)
        car.require_the_drawn_car(poses)
        moving = engine.rates(poses, inputs.driven[:, 1], inputs.driven[:, 2])
        return car.numbers(inputs, poses, moving), poses.last_step

    def _accuracy(
        self, car: Car, inputs: Inputs, laws: Mapping[str, Array], numbers: Numbers, last_step: Array
    ) -> Accuracy:
        """How far each number may be off: see the top of this file."""
        rng, scene = np.random.default_rng(SEED), car.scene
        changes = {q: {n: np.zeros(len(last_step)) for n in arrays} for q, arrays in numbers.items()}
        for _ in range(PROBES):
            size = SHIFT * car.linkage.unit
            shift = {name: size * rng.standard_normal(3) for name in scene.mechanism.points}
            other = Car.of(scene, shift)
            told = other.inputs(laws)
            off = rng.standard_normal(told.doubt.shape) * told.doubt * (SHIFT / ROUNDING)
            found, _ = self._numbers(other, replace(told, driven=told.driven + off))
            for quantity, arrays in numbers.items():
                for name, array in arrays.items():
                    change = (found[quantity][name] - array).reshape(len(array), -1) / (SHIFT * PROBES**0.5)
                    for component in change.T:  # by hypot: the square of a very slow rate would be nothing
                        changes[quantity][name] = np.hypot(changes[quantity][name], component)
        rounding = ROUNDING + last_step**2
        claims: dict[str, dict[str, Array]] = {}
        for quantity, arrays in numbers.items():
            least = rounding * _largest(arrays) if per_second(quantity) else np.zeros_like(rounding)
            claims[quantity] = {
                name: _like(array, np.maximum(rounding * changes[quantity][name], least))
                + 2.0 * UNIT_ROUNDOFF * np.abs(array)
                for name, array in arrays.items()
            }
        condition = _largest(changes["position"]) / car.linkage.unit
        return Accuracy(condition, claims)


def _largest(arrays: Mapping[str, Array]) -> Array:
    """The largest number of a quantity at each instant, (N,)."""
    return np.asarray(np.max([np.abs(a).reshape(len(a), -1).max(axis=-1) for a in arrays.values()], axis=0))


def _like(array: Array, widths: Array) -> Array:
    return np.broadcast_to(widths.reshape(-1, *(1,) * (array.ndim - 1)), array.shape)
