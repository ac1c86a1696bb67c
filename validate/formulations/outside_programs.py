r"""Other people's programs as formulations: outside witnesses, which share no mechanics with any of ours.

What they claim of their accuracy is an estimate. A program's roundings are taken as those of a car whose
hardpoints are off by a little: a place at the end of three joints is a chain of three turns and sums, some
60 roundings of numbers up to 1 in sizes of the car, or as large as its coordinates from the linkage's origin
if that is farther away, of which 4 standard deviations are about 10 u. A scene
has thousands of numbers, of which one in 16,000 goes beyond four deviations and none beyond eight, and near a
singular pose all that is measured of a number is a few random ones: 32 u are taken, and with them the square
of Newton's last correction.

What that does to each number is measured: cars whose hardpoints are shifted at random are solved by the same
program at the same inputs, themselves shifted by what rounding may put them off, and a number is claimed to
the root of the mean square of its changes. Rates are claimed to as many roundings of the largest of their
kind at least, for they are solved for together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, SceneError
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.results.closing import ALLOWED
from validate.formulations.asked_numbers import asked_numbers, per_second
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Accuracy, FormulationError, Numbers, Solution
from validate.peers.errors import PeerError
from validate.peers.linkage import Inputs, Linkage, linkage_of
from validate.peers.motion import Poses, Rates
from validate.peers.motion import numbers as numbers_of

Array = NDArray[np.float64]

# Rad and car sizes: far above rounding, and its square far below. A correction that small leaves none.
TOLERANCE = 1e-10
ROUNDING = 32.0 * UNIT_ROUNDOFF  # of a hardpoint, car sizes
SHIFT = 2.0**-30  # by which hardpoints are shifted: so far above rounding as the change is far from curving
PROBES = 8  # the root of the mean square of so many is less than a third of what it should by one in 1,000
SEED = 20261122


class Engine(Protocol):
    """A linkage in somebody's program."""

    def closed(self, tolerance: float) -> Poses:
        """The drawing, closed: one pose."""
        ...

    def poses(self, driven: Array, tolerance: float, start: Poses) -> Poses:
        """Poses at driven coordinates, (N, drives), each solved from the one before."""
        ...

    def rates(self, poses: Poses, rate: Array, bend: Array) -> Rates:
        """Their rates, from those of what is driven, each (N, drives)."""
        ...


def linkage_in(scene: Scene, shift: Mapping[str, Array] | None = None) -> Linkage:
    """The car of a scene, or one whose hardpoints are shifted, (3,), mm.

    Raises:
        PeerError: its points make no linkage.
    """
    plain = scene.mechanism.plain(tuple(scene.inputs))
    if shift is not None:
        plain["points"] = {n: np.array(place) + shift[n] for n, place in plain["points"].items()}
    return linkage_of(plain)


def require_the_drawn_car(scene: Scene, linkage: Linkage, closed: Poses) -> None:
    """Refuse a drawing that the program's own closing makes another car of.

    Raises:
        SceneError: a point moves by more than is allowed.
    """
    if scene.mechanism.closure != "drawn" or not closed.places:
        return
    drawn = linkage.tree.drawn
    limit = ALLOWED * float(np.max(np.ptp(np.array(list(drawn.values())), axis=0)))
    moved = {n: float(np.linalg.norm(place - drawn[n])) for n, place in closed.places.items()}
    point = max(moved, key=lambda name: moved[name])
    if moved[point] > limit:
        raise SceneError(
            scene.title or "scene",
            "mechanism.points",
            f"closing the drawing moves {point} by {moved[point] * linkage.unit:.3g} mm: that is another car",
            f"at most {ALLOWED:.0%} of the car's size, {limit * linkage.unit:.3g} mm; draw the points that "
            "miss where they belong",
        )


def asked_of(found: Mapping[str, Mapping[str, Array]], scene: Scene) -> Numbers:
    """What a scene asks for, of all that was found."""
    return {
        quantity: {name: found[quantity][name] for name in names if name in found[quantity]}
        for quantity, names in asked_numbers(scene).items()
        if quantity in found
    }


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
            linkage = linkage_in(scene)
            inputs = linkage.inputs(laws)
            numbers, last_step = self._numbers(scene, linkage, inputs)
            accuracy = self._accuracy(scene, laws, numbers, last_step)
        except (PeerError, SceneError) as error:
            raise FormulationError(self.name, error) from error
        return Solution(self.name, scene.instants, numbers, accuracy)

    def _numbers(self, scene: Scene, linkage: Linkage, inputs: Inputs) -> tuple[Numbers, Array]:
        """What the scene asks for, and Newton's last correction at each instant, (N,)."""
        engine = self.engine(linkage)
        value, rate, bend = inputs.driven.swapaxes(0, 1)
        closed = engine.closed(TOLERANCE)
        require_the_drawn_car(scene, linkage, closed)
        poses = engine.poses(value, TOLERANCE, closed)
        found = numbers_of(linkage, inputs.chassis, poses, engine.rates(poses, rate, bend))
        return asked_of(found, scene), poses.last_step

    def _accuracy(
        self, scene: Scene, laws: Mapping[str, Array], numbers: Numbers, last_step: Array
    ) -> Accuracy:
        """How far each number may be off: see the top of this file."""
        rng = np.random.default_rng(SEED)
        linkage = linkage_in(scene)
        far = max(float(np.abs(place).max()) for place in linkage.tree.drawn.values())
        size = max(2.0, far) * linkage.unit  # in units the car is between one and two
        changes = {q: {n: np.zeros(len(last_step)) for n in arrays} for q, arrays in numbers.items()}
        for _ in range(PROBES):
            shift = {name: SHIFT * size * rng.standard_normal(3) for name in scene.mechanism.points}
            other = linkage_in(scene, shift)
            told = other.inputs(laws)
            off = rng.standard_normal(told.doubt.shape) * told.doubt * (SHIFT / ROUNDING)
            found, _ = self._numbers(scene, other, replace(told, driven=told.driven + off))
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
        places = next(q for q in changes if QUANTITIES[q].of == "point" and not per_second(q))
        return Accuracy(_largest(changes[places]) / size, claims)


def _largest(arrays: Mapping[str, Array]) -> Array:
    """The largest number of a quantity at each instant, (N,)."""
    return np.asarray(np.max([np.abs(a).reshape(len(a), -1).max(axis=-1) for a in arrays.values()], axis=0))


def _like(array: Array, widths: Array) -> Array:
    return np.broadcast_to(widths.reshape(-1, *(1,) * (array.ndim - 1)), array.shape)
