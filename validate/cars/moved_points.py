"""A base car with its points moved; what slides is put back onto its line.

The mechanism's own tables say what belongs on a line. A closure other than `drawn` puts points in place by
itself, so there they may lie anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from validate.cars.car import Array, Car

SHARE = 0.2  # of the car's size: how far points are moved in every coordinate
SLID, SLID_SHARE = 5.0, 0.15  # mm along a direction, parts of the way between two points
LEFT_OVER = 0.05  # mm, by which a drawn point may miss its line: half of what is warned of
HALVED = 8  # times: after that nothing is moved


@dataclass(frozen=True)
class Moves:
    """How a car differs from its base car.

    Attributes:
        points: how far each is moved, (3,), mm; not of what slides.
        slid: how far what slides is slid along its line, -1 to 1.
        beside: by how much it misses its line, (3,), mm.
        without: points that are left out, as others stand in for them.
        whole: whether moves are whole millimetres and slides whole millimetres or eighths of a line.
    """

    points: Mapping[str, Array] = field(default_factory=dict)
    slid: Mapping[str, float] = field(default_factory=dict)
    beside: Mapping[str, Array] = field(default_factory=dict)
    without: frozenset[str] = frozenset()
    whole: bool = False

    def part(self, share: float) -> Moves:
        """A part of them."""
        points = {name: share * move for name, move in self.points.items()}
        points = {name: np.trunc(move) for name, move in points.items()} if self.whole else points
        return replace(self, points=points, slid={name: share * slid for name, slid in self.slid.items()})


def with_every_point(base: Car) -> Car:
    """The base car with every point that its mechanism may have, where the one that stands in for it is."""
    left_out = {new: base.points[old] for new, old in base.structure.stand_ins.items() if old in base.points}
    return replace(base, points={**left_out, **base.points})


def sliding(base: Car) -> tuple[str, ...]:
    """The points that a drawing has to put on lines, which others make."""
    slides = base.structure.slides.values() if base.closure == "drawn" else ()
    return tuple(n for slide in slides for n in slide.points if n not in (slide.along, slide.through))


def moved(base: Car, moves: Moves) -> Car:
    """The base car with its points moved."""
    drawn = {name: place for name, place in base.array.items() if name not in moves.without}
    places = {name: place + moves.points.get(name, 0.0) for name, place in drawn.items()}
    # Slides of one input, as both ends of a rack, travel as far as the first of them.
    first = {
        slide: together[0]
        for one in base.structure.inputs.values()
        if len(together := one.named("slide")) > 1
        for slide in together
    }
    travels: dict[str, float] = {}
    for title, slide in base.structure.slides.items() if base.closure == "drawn" else ():
        if slide.through not in drawn:
            continue  # the sliding point stands in for it, and so is on its own line
        by_point = slide.along in drawn
        before, now = (
            p[slide.along] - p[slide.through] if by_point else base.direction(slide.along)
            for p in (drawn, places)
        )
        for name in {*slide.points} - {slide.along, slide.through}:
            travel = float((drawn[name] - drawn[slide.through]) @ before) / float(before @ before)
            travel += moves.slid.get(name, 0.0) * (SLID_SHARE if by_point else SLID)
            if moves.whole:
                travel = round(8.0 * travel) / 8.0 if by_point else float(round(travel))
            travel = travels.setdefault(first.get(title, name), travel)
            places[name] = places[slide.through] + travel * now
    return base.drawn_as({name: place + moves.beside.get(name, 0.0) for name, place in places.items()})


def drawn_back(base: Car, moves: Moves, is_accepted: Callable[[Car], bool]) -> Car:
    """The base car moved, by halves drawn back towards itself until it is accepted.

    Raises:
        AssertionError: the base car itself is not.
    """
    for halved in range(HALVED + 1):
        car = moved(base, moves.part(0.5**halved if halved < HALVED else 0.0))
        if is_accepted(car):
            return car
    raise AssertionError(f"the base car of {base.suspension!r} is refused")
