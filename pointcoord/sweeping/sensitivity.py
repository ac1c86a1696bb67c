r"""Sensitivity: exact derivatives of every number of the car by every hardpoint coordinate.

If a hardpoint moves, the lengths of its links change as drawn, and the inputs keep their values. Only the
drawn car is solved (see `hardpoint_slopes`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord.errors import UnknownName, WrongArgument
from pointcoord.numerics.arrays import Array
from pointcoord.results.read_only import ReadOnly
from pointcoord.results.samples import Channel
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene
from pointcoord.sweeping.designs import coordinates_of
from pointcoord.sweeping.hardpoint_slopes import slopes_of_motion
from pointcoord.sweeping.sweep import sweep


@dataclass(frozen=True)
class Sensitivity(ReadOnly):
    """Derivatives of numbers at the instants of a scene.

    Attributes:
        coordinates: hardpoint coordinates, such as lower_ball_joint.z.
        times: instants, (N,), s.
        derivatives: derivatives of each number, by its name, (coordinates, N), in its unit per mm; NaN where
            the number or the derivative does not exist.
        failures: why there is no derivative, by coordinate.
    """

    coordinates: tuple[str, ...]
    times: Array
    derivatives: Mapping[str, Array]
    failures: Mapping[str, str]

    def largest(self, number: str) -> Array:
        """The derivative of largest magnitude over all instants, with its sign, (coordinates,).

        NaN for a coordinate without a derivative.
        """
        found = self.derivatives[number]
        place = np.nan_to_num(np.abs(found), nan=-1.0).argmax(axis=1)
        return np.asarray(np.take_along_axis(found, place[:, None], axis=1)[:, 0])

    def spread(self, number: str, tolerance: float) -> tuple[float, float]:
        """Largest spread of a number over time, to first order, for one tolerance of all coordinates.

        Coordinates without a derivative are left out.

        Args:
            tolerance: tolerance of every coordinate, mm: a standard deviation, or a limit.
        Returns:
            The standard deviation for independent coordinates, and the worst case of all together.
        """
        sizes = tolerance * np.abs(np.nan_to_num(self.derivatives[number]))
        return float(np.sqrt((sizes**2).sum(axis=0)).max()), float(sizes.sum(axis=0).max())


def sensitivity(scene: Scene, numbers: Sequence[str] = (), coordinates: Sequence[str] = ()) -> Sensitivity:
    """Derivatives of the numbers that a scene's effects give, at the instants of the scene.

    Args:
        numbers: names of numbers of the car; other numbers as QUANTITY.NAME, and components of vectors as
            QUANTITY.NAME.AXIS, such as rod_force.tie_rod or velocity.wheel_centre.z; all numbers of the car
            unless given.
        coordinates: names such as lower_ball_joint.z, or a point for all three; all hardpoints unless given.
    Raises:
        SceneError, WrongArgument: see `sweep`.
        UnknownName: no point, axis or number has this name.

    >>> found = sensitivity(Scene.load("double-wishbone"), ["camber"], ["upper_ball_joint.y"])
    >>> found.derivatives["camber"].shape
    (1, 101)
    """
    require_scene(scene)
    named = tuple(dict.fromkeys(coordinates_of(scene, coordinates)))
    drawn = sweep(scene)
    every = numbers_named(drawn.numbers, numbers)
    if not every:
        allowed = "an effect such as wheel_angles"
        raise WrongArgument("the scene's effects", "give no number of the car", allowed)
    if drawn.failures:
        nothing = {name: np.full((len(named), len(drawn.times)), np.nan) for name in every}
        failures = dict.fromkeys(named, str(drawn.failures[0].error))
        return Sensitivity(named, drawn.times, nothing, failures)
    motion = drawn.motion(0)
    slopes, channels = slopes_of_motion(scene, motion.solved, motion.times, named), {}
    for quantity, channel in drawn.numbers.items():
        # Where a number is not finite its formula may still have a slope.
        own = slopes.numbers.get(quantity, {})
        arrays = {n: np.where(np.isfinite(values), own[n], np.nan) for n, values in channel.items()}
        channels[quantity] = channel.with_arrays(arrays)
    return Sensitivity(named, drawn.times, numbers_named(channels, numbers), slopes.failures)


def numbers_named(channels: Mapping[str, Channel], names: Sequence[str]) -> dict[str, Array]:
    """Numbers of many designs by name, each (designs, N); all numbers of the car unless names are given.

    Raises:
        UnknownName: no number has this name.
    """
    scalars = _scalars(channels)
    if not names:
        return scalars
    every = scalars.copy()
    for quantity, channel in channels.items():
        for name, values in channel.items():
            if channel.quantity.of == "car":
                every.setdefault(f"{quantity}.{name}", values)
            else:
                every |= {f"{quantity}.{name}.{axis}": values[..., i] for i, axis in enumerate("xyz")}
    for name in names:
        if name not in every:
            raise UnknownName("number of the scene's effects", name, scalars)
    return {name: every[name] for name in names}


def _scalars(numbers: Mapping[str, Channel]) -> dict[str, Array]:
    """Numbers of the car by name. A name that comes again, as a rod's may, becomes QUANTITY.NAME."""
    found: dict[str, Array] = {}
    for quantity, channel in numbers.items():
        for name, values in channel.items() if channel.quantity.of == "car" else ():
            found[f"{quantity}.{name}" if name in found else name] = values
    return found
