"""The suspensions that cars are made of, by the type that a scene names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from validate.cars.car import Car, Closure
from validate.cars.double_wishbone import DOUBLE_WISHBONE
from validate.cars.macpherson import MACPHERSON
from validate.cars.suspension import Suspension

SUSPENSIONS: Mapping[str, Suspension] = {s.name: s for s in (MACPHERSON, DOUBLE_WISHBONE)}


@dataclass(frozen=True)
class Variant:
    """A suspension with what closes its drawing."""

    suspension: str
    closure: Closure

    @classmethod
    def of(cls, car: Car) -> Variant:
        """The one of a car."""
        return cls(car.suspension, car.closure)

    @property
    def base(self) -> Car:
        """A car to make others from."""
        return SUSPENSIONS[self.suspension].base[self.closure]

    @property
    def words(self) -> str:
        """In words; the closure only where there are several."""
        name = self.suspension.replace("_", " ")
        return name if len(SUSPENSIONS[self.suspension].closures) == 1 else f"{name}, {self.closure}"


VARIANTS: tuple[Variant, ...] = tuple(Variant(s.name, c) for s in SUSPENSIONS.values() for c in s.closures)


def suspension_of(car: Car) -> Suspension:
    """The suspension of a car."""
    return SUSPENSIONS[car.suspension]
