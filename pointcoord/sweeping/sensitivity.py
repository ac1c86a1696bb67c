r"""How much every number of the car changes by each coordinate of each hardpoint: exact derivatives.

What is drawn is what is solved, so that the links of a moved point have other lengths, and the inputs keep
their values. No car is solved but the one that is drawn (see `hardpoint_slopes`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import UnknownName, WrongArgument
from pointcoord.results.read_only import ReadOnly
from pointcoord.results.samples import Channel
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene
from pointcoord.sweeping.designs import coordinates_of
from pointcoord.sweeping.hardpoint_slopes import slopes_of_motion
from pointcoord.sweeping.sweep import sweep

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sensitivity(ReadOnly):
    """Derivatives of numbers at the instants of a scene.

    Attributes:
        coordinates: of hardpoints, such as lower_ball_joint.z.
        times: (N,), s.
        derivatives: by number, (coordinates, N), its unit per mm; NaN where there is none, or no such number.
        failures: by coordinate, why there is no derivative.
    """

    coordinates: tuple[str, ...]
    times: Array
    derivatives: Mapping[str, Array]
    failures: Mapping[str, str]

    def largest(self, number: str) -> Array:
        """The derivative where it is largest, with its sign, (coordinates,); 0 where there is none."""
        found = np.nan_to_num(self.derivatives[number])
        return np.asarray(np.take_along_axis(found, np.abs(found).argmax(axis=1)[:, None], axis=1)[:, 0])

    def spread(self, number: str, tolerance: float) -> tuple[float, float]:
        """What a tolerance of every coordinate makes of a number, to first order, where that is most.

        Args:
            tolerance: of every coordinate by itself, mm: its standard deviation, or a limit.
        Returns:
            The standard deviation of independent coordinates, and the worst case of all together.
        """
        sizes = tolerance * np.abs(np.nan_to_num(self.derivatives[number]))
        return float(np.sqrt((sizes**2).sum(axis=0)).max()), float(sizes.sum(axis=0).max())


def sensitivity(scene: Scene, numbers: Sequence[str] = (), coordinates: Sequence[str] = ()) -> Sensitivity:
    """Derivatives of the numbers of the car that a scene's effects give, at its instants.

    Args:
        numbers: of the car by their names, any other as QUANTITY.NAME or, of a vector, QUANTITY.NAME.AXIS,
            such as rod_force.tie_rod or velocity.wheel_centre.z; all of the car unless given.
        coordinates: such as lower_ball_joint.z, or a point's name for all three; all hardpoints unless given.
    Raises:
        SceneError, WrongArgument: as `sweep`.
        UnknownName: no point, axis or number is called so.

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
        # Where a number is none its formula may still have a slope.
        own = slopes.numbers.get(quantity, {})
        arrays = {n: np.where(np.isfinite(values), own[n], np.nan) for n, values in channel.items()}
        channels[quantity] = channel.with_arrays(arrays)
    return Sensitivity(named, drawn.times, numbers_named(channels, numbers), slopes.failures)


def numbers_named(channels: Mapping[str, Channel], names: Sequence[str]) -> dict[str, Array]:
    """Numbers of many designs by name, each (designs, N); all of the car unless names are given.

    Raises:
        UnknownName: none is called so.
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
    """Numbers of the car by name; of one that comes twice, as a rod's may, the later by its quantity."""
    found: dict[str, Array] = {}
    for quantity, channel in numbers.items():
        for name, values in channel.items() if channel.quantity.of == "car" else ():
            found[f"{quantity}.{name}" if name in found else name] = values
    return found
