"""The numbers that a scene requests, at some instants, read by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from pointcoord.effects.effect import Quantity
from pointcoord.effects.registry import Plan, number_called
from pointcoord.errors import NotComputed, UnknownName
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array
from pointcoord.results.read_only import ReadOnly


class Channel(Mapping[str, Array]):
    """The numbers of one quantity by name, read-only.

    If a number is missing because the scene does not request its effect, the error names the effect.
    """

    def __init__(
        self, quantity: Quantity, arrays: Mapping[str, Array], plan: Plan, topology: Topology
    ) -> None:
        self.quantity, self.plan, self.topology = quantity, plan, topology
        self._arrays = dict(arrays)
        for array in self._arrays.values():
            array.setflags(write=False)

    @property
    def computed(self) -> bool:
        """Whether the scene requests any number of the quantity."""
        return bool(self._arrays)

    def with_arrays(self, arrays: Mapping[str, Array]) -> Channel:
        return Channel(self.quantity, arrays, self.plan, self.topology)

    def __getitem__(self, name: str) -> Array:
        if name in self._arrays:
            return self._arrays[name]
        reported = {q for effect in self.plan.computed if effect.reports_states for q in effect.quantities}
        if self.quantity in reported and name in self.plan.unreported:
            raise NotComputed(f"{self.quantity.words} of {name}", "", f"add {name!r} to the scene's points")
        left_out = self.plan.lacking(self.quantity.name, self.topology)
        for effect, names in left_out.items():
            if names is None or name in names:
                raise NotComputed(f"{self.quantity.words} of {name}", effect)
        others = (name for names in left_out.values() for name in names or ())
        number = number_called(name)
        home = number.quantity.name if number else self.quantity.name
        hint = f"it stands under {home!r}" if home != self.quantity.name else ""
        raise UnknownName(self.quantity.words, name, dict.fromkeys((*self._arrays, *others)), hint)

    def __contains__(self, name: object) -> bool:
        return name in self._arrays

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        return f"<{self.quantity.words}: {', '.join(self) if self.computed else 'not computed'}>"

    def __reduce__(self) -> tuple[type[Channel], tuple[object, ...]]:
        # Arrays come back from a pickle writeable.
        return type(self), (self.quantity, self._arrays, self.plan, self.topology)


class Named(ReadOnly):
    """Numbers by quantity and name; every quantity is an attribute too, such as `position`."""

    numbers: Mapping[str, Channel]

    def __getattr__(self, name: str) -> Channel:
        numbers: Mapping[str, Channel] = self.__dict__.get("numbers", {})
        if name in numbers:
            return numbers[name]
        raise AttributeError(f"{type(self).__name__} has no {name!r}; its quantities: {', '.join(numbers)}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.numbers})

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self._quantities}>"

    def each(self, change: Callable[[Array, int], Array]) -> dict[str, Channel]:
        """The numbers with every array changed; `change` also gets the count of dimensions after instants."""
        return {
            quantity: channel.with_arrays(
                {name: change(array, channel.quantity.of != "car") for name, array in channel.items()}
            )
            for quantity, channel in self.numbers.items()
        }

    @property
    def _quantities(self) -> str:
        return ", ".join(c.quantity.words for c in self.numbers.values() if c.computed)


@dataclass(frozen=True, eq=False, repr=False)
class Samples(Named):
    """The numbers that a scene requests, at some instants.

    Attributes:
        times: instants, shape (N,), s.
        numbers: numbers by quantity and name, (N, 3) of points and bodies and (N,) of the car; see
            `effects.registry.QUANTITIES` for all quantities and their units.
    """

    times: Array
    numbers: Mapping[str, Channel]

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

    def shaped(self, shape: tuple[int, ...]) -> Samples:
        """The same samples with instants of another shape."""

        def reshaped(array: Array, after: int) -> Array:
            place = array.ndim - 1 - after
            return array.reshape((*array.shape[:place], *shape, *array.shape[place + 1 :]))

        return Samples(self.times.reshape(shape), self.each(reshaped))

    def part(self, first: int, last: int) -> Samples:
        """The samples at the instants from number `first` to before `last`; instants of shape (N,)."""
        some = slice(first, last)
        numbers = self.each(lambda array, after: array[..., some, :] if after else array[..., some])
        return Samples(self.times[some], numbers)
