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
from pointcoord.sweeping.designs import AXES, Designs, coordinates_named, designs_of
from pointcoord.sweeping.hardpoint_slopes import ByHardpoints
from pointcoord.sweeping.sweep import sweep

Array = NDArray[np.float64]

# Numbers that the coordinates of poses, their derivatives and all slopes of these have at a time: 30 MB.
ROOM = 4e6
# Of what an equation between coordinates below 1 changes by where a hardpoint moves by the mechanism's size:
# one that goes on to follow from others by rounding, 5e-16 in bricard, and another by 0.1 and more.
HELD = 1e-9
LOCKS = (
    "as drawn, the equation {} follows from the others, and where this coordinate moves it does not: the "
    "mechanism locks"
)


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
    named = _coordinates(scene, coordinates)
    if not coordinates:
        # A rack that goes along with the tie rod's end has no coordinates of its own.
        following = Designs(scene, 1, {}).following
        named = tuple(name for name in named if name.rpartition(".")[0] not in following)
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
    slopes, failures = _slopes(ByHardpoints(motion.solved, _moves(scene, named)), motion.times, named)
    lost = np.array([name in failures for name in named])
    channels = {}
    for quantity, channel in drawn.numbers.items():
        # Where a number is none its formula may still have a slope.
        arrays = {
            n: np.where(np.isfinite(values), slopes[quantity][n], np.nan) for n, values in channel.items()
        }
        for array in arrays.values():
            array[lost] = np.nan
        channels[quantity] = channel.with_arrays(arrays)
    return Sensitivity(named, drawn.times, numbers_named(channels, numbers), failures)


def _slopes(
    by_hardpoints: ByHardpoints, times: Array, coordinates: Sequence[str]
) -> tuple[dict[str, dict[str, Array]], dict[str, str]]:
    """What every number changes by, (K, N) or (K, N, 3), and why some coordinates have no derivative."""
    plan, topology = by_hardpoints.solved.readout.plan, by_hardpoints.mechanism.topology
    each = len(coordinates) * topology.layout.size * (plan.derivative + 1 + 2 * len(plan.ways(topology)))
    together = max(int(ROOM // each), 1)
    parts, violated = [], np.zeros((len(coordinates), len(topology.left_out)))
    for low in range(0, len(times), together):
        poses = by_hardpoints.poses(times[low : low + together])
        parts.append(by_hardpoints.numbers(poses))
        violated = np.maximum(violated, np.abs(poses.violated).max(axis=1))
    found = {
        quantity: {name: np.concatenate([part[quantity][name] for part in parts], axis=1) for name in of}
        for quantity, of in parts[0].items()
    }
    worst = {
        name: int(np.argmax(rows))
        for name, rows in zip(coordinates, violated, strict=True)
        if (rows > HELD).any()
    }
    return found, {name: LOCKS.format(topology.left_labels[row]) for name, row in worst.items()}


def _moves(scene: Scene, coordinates: Sequence[str]) -> dict[str, Array]:
    """By hardpoint, what its place changes by with each coordinate, (K, 3)."""
    points = scene.mechanism.points
    found = {name: np.zeros((len(coordinates), 3)) for name in points}
    for i, coordinate in enumerate(coordinates):
        point, _, axis = coordinate.rpartition(".")
        found[point][i, AXES.index(axis)] = 1.0
    following = designs_of(scene, offsets=dict.fromkeys(coordinates, 0.0)).following
    return found | {name: found[other] for name, other in following.items()}


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


def _coordinates(scene: Scene, asked: Sequence[str]) -> tuple[str, ...]:
    """Coordinates by name, those of a point that is named whole in their order."""
    points = scene.mechanism.points
    return tuple(dict.fromkeys(one for name in asked or points for one in coordinates_named(name, points)))
