r"""What a displaced and turned chassis does to the numbers of a mechanism that stands on it.

With R(t) and d(t) the chassis' turn and shift, made of all its inputs one after the other,

    p = R x + d,    p' = R x' + R' x + d',    p'' = R x'' + 2 R' x' + R'' x + d'',

and with W the angular velocity of R, w + W and so on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.spanning_tree.cut import car_directions

Array = NDArray[np.float64]

Numbers = Mapping[str, Mapping[str, Array]]


@dataclass(frozen=True)
class ChassisMotion:
    """The chassis' motion.

    Attributes:
        shift: d and two rates, (3, N, 3), mm and s. turn: R and two rates, (3, N, 3, 3).
    """

    shift: Array
    turn: Array

    @classmethod
    def of(cls, plain: Mapping[str, Any], inputs: Mapping[str, Array]) -> ChassisMotion | None:
        """The motion by a flat mechanism's inputs, None if none that is given moves the chassis.

        Args:
            inputs: value, rate and acceleration by name, (N, 3), rad or mm, and s.
        """
        directions = car_directions(plain)
        given_inputs = [(n, given) for n, given in plain["inputs"].items() if n in inputs]
        turns, moves = ([pair for pair in given_inputs if kind in pair[1]] for kind in ("turns", "moves"))
        if not turns and not moves:
            return None
        count = len(inputs[(turns + moves)[0][0]])
        shift, turn = np.zeros((3, count, 3)), np.zeros((3, count, 3, 3))
        turn[0] = np.eye(3)
        for name, given in turns:
            about = np.array(plain["points"][given["about"]], dtype=float)
            step = _rotation(directions[given["along"]], inputs[name])
            shift[0] -= about
            shift = np.stack([_rate(step, shift[..., None], k)[..., 0] for k in range(3)])
            shift[0] += about
            turn = np.stack([_rate(step, turn, k) for k in range(3)])
        for name, given in moves:
            shift += inputs[name].T[:, :, None] * directions[given["along"]]
        return cls(shift, turn)

    def moved(self, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Numbers of points and bodies, by quantity and name, (N, 3), on the moving chassis."""
        found, rates = {q: dict(arrays) for q, arrays in numbers.items()}, _point_rates(numbers)
        for name in numbers["position"]:
            x = [numbers[q][name] for q in rates]
            for k, q in enumerate(rates):
                found[q][name] = _rate(self.turn, x, k, vectors=True) + self.shift[k]
        for name, spin in numbers.get("angular_velocity", {}).items():
            own, faster = self._own()
            turned = self.directions(spin)
            found["angular_velocity"][name] = turned + own
            rate = self.directions(numbers["angular_acceleration"][name])
            found["angular_acceleration"][name] = rate + np.cross(own, turned) + faster
        return found

    def directions(self, vector: Array) -> Array:
        """A direction of a body, (N, 3)."""
        return _matrix_vector(self.turn[0], vector)

    def _own(self) -> tuple[Array, Array]:
        """Angular velocity and acceleration of the chassis, (N, 3) each."""
        r, r1, r2 = self.turn
        back = np.swapaxes(r, -1, -2)
        first, second = r1 @ back, r2 @ back + r1 @ np.swapaxes(r1, -1, -2)
        return _axial(first), _axial(second)


def _rotation(axis: Array, series: Array) -> Array:
    """A right-handed turn about an axis with two rates, (3, N, 3, 3), by Rodrigues' formula."""
    k = np.cross(axis, np.eye(3)).T
    phi, first, second = series.T[:, :, None, None]
    slope = np.cos(phi) * k + np.sin(phi) * (k @ k)
    bend = np.cos(phi) * (k @ k) - np.sin(phi) * k
    turn = np.eye(3) + np.sin(phi) * k + 2.0 * np.sin(0.5 * phi) ** 2 * (k @ k)
    return np.stack([turn, first * slope, second * slope + first * first * bend])


def _rate(turns: Array, rates: Any, order: int, vectors: bool = False) -> Array:
    """A time derivative of a product of matrices, or of a matrix and a vector."""
    times = _matrix_vector if vectors else np.matmul
    binomial = ((1,), (1, 1), (1, 2, 1))[order]
    parts = (c * times(turns[k], rates[order - k]) for k, c in enumerate(binomial))
    return np.asarray(sum(parts))


def _point_rates(numbers: Numbers) -> list[str]:
    return [q for q in ("position", "velocity", "acceleration") if q in numbers]


def _matrix_vector(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _axial(matrix: Array) -> Array:
    return np.stack([matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0]], axis=-1)
