"""A solved scene, read by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.bounds.proof import Proof
from pointcoord.errors import NotComputed, UnknownName
from pointcoord.numerics.counters import Work
from pointcoord.results.closing import Closing
from pointcoord.solve.assembly import Pose

Array = NDArray[np.float64]


class Channel(Mapping[str, Array]):
    """Arrays by name, read-only; knows which effect makes it when the scene did not ask for it."""

    def __init__(self, quantity: str, effect: str, arrays: Mapping[str, Array] | None) -> None:
        self.quantity = quantity
        self.effect = effect
        self._arrays = None if arrays is None else dict(arrays)
        for array in (self._arrays or {}).values():
            array.setflags(write=False)

    @property
    def computed(self) -> bool:
        """Whether the scene asked for it."""
        return self._arrays is not None

    def __getitem__(self, name: str) -> Array:
        if self._arrays is None:
            raise NotComputed(f"{self.quantity} of {name}", self.effect)
        if name not in self._arrays:
            raise UnknownName(self.quantity, name, self._arrays)
        return self._arrays[name]

    def __contains__(self, name: object) -> bool:
        return self._arrays is not None and name in self._arrays

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays or {})

    def __len__(self) -> int:
        return len(self._arrays or {})

    def __repr__(self) -> str:
        return f"<{self.quantity}: {', '.join(self) if self.computed else 'not computed'}>"

    def __reduce__(self) -> tuple[type[Channel], tuple[str, str, Mapping[str, Array] | None]]:
        # Arrays come back from a pickle as arrays that can be written.
        return type(self), (self.quantity, self.effect, self._arrays)


@dataclass(frozen=True, repr=False)
class Samples:
    """What a scene asked for, at some instants.

    Attributes:
        times: shape (N,), s.
        position: of every point, (N, 3), mm; velocity mm/s; acceleration mm/s^2.
        angular_velocity, angular_acceleration: of the bodies, (N, 3), rad/s and rad/s^2, world axes.
        wheel: `camber` and `kingpin`, (N,), rad.
    """

    times: Array
    position: Channel
    velocity: Channel
    acceleration: Channel
    angular_velocity: Channel
    angular_acceleration: Channel
    wheel: Channel

    def __post_init__(self) -> None:
        self.times.setflags(write=False)

    def __reduce__(self) -> tuple[type[Samples], tuple[object, ...]]:
        return type(self), tuple(getattr(self, field.name) for field in fields(self))

    def __repr__(self) -> str:
        return f"<Samples: {self._span}; {self._quantities}>"

    @property
    def _span(self) -> str:
        if not self.times.size:
            return "no instants"
        if self.times.ndim == 0:
            return f"at {self.times:.6g} s"
        count = "1 instant" if self.times.size == 1 else f"{self.times.size} instants"
        return f"{count} from {self.times.min():.6g} to {self.times.max():.6g} s"

    @property
    def _quantities(self) -> str:
        channels = (getattr(self, field.name) for field in fields(self))
        return ", ".join(c.quantity for c in channels if isinstance(c, Channel) and c.computed)


Prover = Callable[[Samples, bool], Proof]


@dataclass(frozen=True, repr=False)
class Motion(Samples):
    """A solved scene; it can be pickled, with all that it can still be asked for.

    Attributes:
        method: how it was solved: series, newton or printed.
        start: the assembled pose at the first instant, with its condition number and proven bound.
        closing: how far the drawing's points moved to close.
        work: what it cost.
        notes: numbers that have no meaning, and why, and where it was not solved as the scene asks; empty
            if there is nothing to note.
        unit: the mechanism's size as a power of two, mm; scales of its coordinates.
        resample: evaluates the motion at other instants, if the method allows it.
        prover: proves samples of the motion; called by `proof`.
    """

    method: str
    start: Pose
    closing: Closing
    work: Work
    notes: tuple[str, ...]
    unit: float
    resample: Callable[[Array], Samples] | None
    prover: Prover

    def __repr__(self) -> str:
        count = len(self.notes)
        noted = f"; {count} note{'s' if count > 1 else ''}" if count else ""
        return f"<Motion by {self.method}: {self._span}; {self._quantities}{noted}>"

    def proof(self, rates: bool = False) -> Proof:
        """Proven error bound, condition number and sensitivity of the pose at each of the times.

        Args:
            rates: prove every reported number by itself, rates and angles too (`Proof.proven`), and say what
                the method loses at most where nothing is wrong (`Proof.expected`); takes some times as long.
        """
        return self.prover(self, rates)

    def at(self, instants: ArrayLike) -> Samples:
        """The same results at any instants inside the motion, without a new solve.

        Args:
            instants: a number or an array of them, s.
        Returns:
            Arrays of the instants' shape, vectors with a last dimension of 3.
        Raises:
            OutsideMotion: an instant before the start, after the stop, or not a number.
            NotComputed: the method knows the motion at the scene's instants only.
        """
        if self.resample is None:
            raise NotComputed(
                f"a motion between its instants, by the method {self.method!r},",
                "",
                "solve the scene by the method 'series'",
            )
        asked = np.asarray(instants, dtype=float)
        samples = self.resample(asked.ravel())
        return samples if asked.ndim == 1 else _reshaped(samples, asked.shape)


def _reshaped(samples: Samples, shape: tuple[int, ...]) -> Samples:
    def reshape(channel: Channel, rank: int) -> Channel:
        arrays = {}
        for name, array in channel.items():
            batch, vector = array.shape[: array.ndim - 1 - rank], array.shape[array.ndim - rank :]
            arrays[name] = array.reshape((*batch, *shape, *vector))
        return Channel(channel.quantity, channel.effect, arrays if channel.computed else None)

    return Samples(
        times=samples.times.reshape(shape),
        position=reshape(samples.position, 1),
        velocity=reshape(samples.velocity, 1),
        acceleration=reshape(samples.acceleration, 1),
        angular_velocity=reshape(samples.angular_velocity, 1),
        angular_acceleration=reshape(samples.angular_acceleration, 1),
        wheel=reshape(samples.wheel, 0),
    )
