r"""How much every number of the car changes by each coordinate of each hardpoint.

The car is drawn with the coordinate x moved to both sides, solved as any design is, and

    df/dx = sum_k c_k f(x + k h) / h,      c = 3/4, -3/20, 1/60 for k = 1, 2, 3 and minus that for -k

is exact for polynomials up to degree 6 (Fornberg, *Generation of finite difference formulas on arbitrarily
spaced grids*, Mathematics of Computation 51, 1988). What is drawn is what is solved, so that the links of a
moved point have other lengths, and the inputs keep their values.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import SweepError, UnknownName
from pointcoord.results.read_only import ReadOnly
from pointcoord.results.samples import Channel
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene
from pointcoord.sweeping.designs import Designs, coordinates_named
from pointcoord.sweeping.sweep import sweep

Array = NDArray[np.float64]

# Of the car's size: what is left out goes with its sixth power, and rounding of 1e-15 makes 1e-12.
STEP = 1e-3
PLACES = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
SIXTH = np.array([-1.0, 9.0, -45.0, 45.0, -9.0, 1.0]) / 60.0
FOURTH = np.array([0.0, 1.0, -8.0, 8.0, -1.0, 0.0]) / 12.0


@dataclass(frozen=True)
class Sensitivity(ReadOnly):
    """Derivatives of numbers at the instants of a scene.

    Attributes:
        coordinates: of hardpoints, such as lower_ball_joint.z.
        times: (N,), s.
        derivatives: by number, (coordinates, N), its unit per mm; NaN where a design cannot be solved or has
            no such number.
        doubts: what the formula of degree 4 differs by from the same designs, likewise.
        failures: by coordinate, why there is no derivative.
    """

    coordinates: tuple[str, ...]
    times: Array
    derivatives: Mapping[str, Array]
    doubts: Mapping[str, Array]
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
        SceneError, SweepError: as `sweep`.
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
    places = np.array(list(scene.mechanism.points.values()))
    step = STEP * float(np.ptp(places, axis=0).max())
    # Designs of one coordinate after those of another.
    moved = np.kron(np.eye(len(named)), step * PLACES[:, None])
    found = sweep(scene, offsets={name: moved[:, i] for i, name in enumerate(named)})
    every = numbers_named(found.numbers, numbers)
    if not every:
        raise SweepError("the scene's effects", "give no number of the car", "an effect such as wheel_angles")
    derivatives, doubts = {}, {}
    for name, array in every.items():
        values = array.reshape(len(named), len(PLACES), -1)
        sixth, fourth = (np.einsum("k,ckn->cn", weights, values) / step for weights in (SIXTH, FOURTH))
        derivatives[name], doubts[name] = sixth, np.abs(sixth - fourth)
    failures = {named[number // len(PLACES)]: str(one.error) for number, one in found.failures.items()}
    return Sensitivity(named, found.times, derivatives, doubts, failures)


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
