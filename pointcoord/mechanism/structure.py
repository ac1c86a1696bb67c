"""What a mechanism is made of, flat and by name: bodies, rods, slides, inputs and roles; no coordinates.

A closure is applied, parts are put in with their prefix, and every name means something (see
`mechanisms/README.md` for what the tables mean).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from pointcoord.linkage.directions import DIRECTIONS

CHASSIS = "chassis"
Ends = tuple[str, str]
Role = str | tuple[str, str]


@dataclass(frozen=True)
class Slide:
    """Points on a line of a body, through one of its points and along a direction or towards a point."""

    points: tuple[str, ...]
    body: str
    through: str
    along: str
    turns: bool = True

    @property
    def named(self) -> tuple[str, ...]:
        """Every point that it names."""
        return (*self.points, self.through, *(() if self.along in DIRECTIONS else (self.along,)))


@dataclass(frozen=True)
class Input:
    """Something that can be driven.

    Attributes:
        kind: arm, turn, travel, height, contact, distance, moves or turns.
        table: as written, with what may be left out filled in.
    """

    kind: str
    table: tuple[tuple[str, Any], ...]

    def __getitem__(self, key: str) -> Any:
        return dict(self.table)[key]

    @property
    def moves_the_chassis(self) -> bool:
        """Whether it moves the whole car, so that it holds no freedom of the mechanism."""
        return self.kind in ("moves", "turns")

    @property
    def unit(self) -> str:
        """Of its values."""
        return "rad" if self.kind in ("arm", "turn", "turns") else "mm"

    def named(self, what: str) -> tuple[str, ...]:
        """The names of points, bodies or slides that it mentions."""
        keys = NAMES[self.kind].get(what, ())
        values = [self[key] for key in keys]
        return tuple(n for value in values for n in (value if isinstance(value, tuple) else (value,)))

    def renamed(self, rename: Mapping[str, Mapping[str, str]]) -> Input:
        """With other names of points, bodies or slides."""
        table = dict(self.table)
        for what, names in rename.items():
            for key in NAMES[self.kind].get(what, ()):
                value = table[key]
                table[key] = (
                    tuple(names.get(n, n) for n in value)
                    if isinstance(value, tuple)
                    else names.get(value, value)
                )
        return replace(self, table=tuple(table.items()))


NAMES: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "arm": {"body": ("angle",), "point": ("of", "about")},
    "turn": {"body": ("angle", "on")},
    "travel": {"slide": ("travel",)},
    "height": {"point": ("height",)},
    "contact": {"point": ("contact",)},
    "distance": {"point": ("distance",)},
    "moves": {"body": ("moves",)},
    "turns": {"body": ("turns",), "point": ("about",)},
}
"""By kind of input, the keys that name points, bodies and slides."""


@dataclass(frozen=True)
class Structure:
    """A mechanism by name.

    Attributes:
        bodies: points of each body, the chassis among them.
        rods: the two ends of each. slides, inputs: by name.
        roles: a name or two of each role that the mechanism has.
        stand_ins: points that a drawing may leave out, each with the one that then stands in for it.
    """

    name: str
    bodies: Mapping[str, tuple[str, ...]]
    rods: Mapping[str, Ends]
    slides: Mapping[str, Slide]
    inputs: Mapping[str, Input]
    roles: Mapping[str, Role]
    stand_ins: Mapping[str, str]

    @cached_property
    def points(self) -> tuple[str, ...]:
        """Every point of a body, a rod or a slide."""
        found = dict.fromkeys(point for points in self.bodies.values() for point in points)
        found |= dict.fromkeys(end for ends in self.rods.values() for end in ends)
        found |= dict.fromkeys(point for slide in self.slides.values() for point in slide.points)
        return tuple(found)

    @property
    def required_points(self) -> tuple[str, ...]:
        """Points that must be drawn."""
        return tuple(name for name in self.points if name not in self.stand_ins)

    def bodies_of(self, point: str) -> tuple[str, ...]:
        """The bodies that have a point."""
        return tuple(body for body, points in self.bodies.items() if point in points)

    def shared(self, body: str, other: str) -> tuple[str, ...]:
        """Points of two bodies, as the first lists them."""
        return tuple(point for point in self.bodies[body] if point in self.bodies[other])

    def left_out(self, given: Collection[str]) -> dict[str, str]:
        """Points of moving bodies that a drawing leaves out, each with the one that does its work."""
        return {
            name: other
            for name, other in self.stand_ins.items()
            if name not in given and name not in self.bodies[CHASSIS]
        }

    def drawn_with(self, given: Collection[str]) -> Structure:
        """The mechanism of a drawing that gives these points: those that others do the work of are gone."""
        gone = self.left_out(given)
        return self.renamed(points=gone) if gone else self

    def renamed(
        self,
        points: Mapping[str, str] | None = None,
        bodies: Mapping[str, str] | None = None,
        slides: Mapping[str, str] | None = None,
    ) -> Structure:
        """With other names; a name that comes twice in a body comes once then."""
        p, b, s = points or {}, bodies or {}, slides or {}
        every = {**p, **b}
        return replace(
            self,
            bodies={
                b.get(body, body): tuple(dict.fromkeys(p.get(n, n) for n in names))
                for body, names in self.bodies.items()
            },
            rods={rod: (p.get(a, a), p.get(z, z)) for rod, (a, z) in self.rods.items()},
            slides={
                s.get(name, name): Slide(
                    tuple(p.get(n, n) for n in slide.points),
                    b.get(slide.body, slide.body),
                    p.get(slide.through, slide.through),
                    p.get(slide.along, slide.along),
                    slide.turns,
                )
                for name, slide in self.slides.items()
            },
            inputs={
                name: one.renamed({"point": p, "body": b, "slide": s}) for name, one in self.inputs.items()
            },
            roles={
                role: every.get(who, who)
                if isinstance(who, str)
                else (p.get(who[0], who[0]), p.get(who[1], who[1]))
                for role, who in self.roles.items()
            },
            stand_ins={p.get(a, a): p.get(z, z) for a, z in self.stand_ins.items() if a not in p},
        )

    def prefixed(self, prefix: str) -> Structure:
        """With a prefix before every name but the chassis'."""
        own = self.renamed(
            {n: prefix + n for n in self.points},
            {n: prefix + n for n in self.bodies if n != CHASSIS},
            {n: prefix + n for n in self.slides},
        )
        return replace(
            own,
            rods={prefix + n: ends for n, ends in own.rods.items()},
            inputs={prefix + n: one for n, one in own.inputs.items()},
            roles={prefix + n: who for n, who in own.roles.items()},
            stand_ins={prefix + a: prefix + z for a, z in self.stand_ins.items()},
        )

    def joined(self, other: Structure) -> Structure:
        """With another's tables beside its own, on one chassis."""
        chassis = dict.fromkeys((*self.bodies.get(CHASSIS, ()), *other.bodies.get(CHASSIS, ())))
        return replace(
            self,
            bodies={**self.bodies, **other.bodies, CHASSIS: tuple(chassis)},
            rods={**self.rods, **other.rods},
            slides={**self.slides, **other.slides},
            inputs={**self.inputs, **other.inputs},
            roles={**self.roles, **other.roles},
            stand_ins={**self.stand_ins, **other.stand_ins},
        )

    def moving_bodies(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """The bodies but the chassis, with their points."""
        return ((body, points) for body, points in self.bodies.items() if body != CHASSIS)

    def plain(self, driven: Collection[str]) -> dict[str, Any]:
        """Bodies, rods, slides, driven inputs and roles as plain data."""
        return {
            "name": self.name,
            "bodies": {body: list(points) for body, points in self.bodies.items()},
            "rods": {rod: list(ends) for rod, ends in self.rods.items()},
            "slides": {
                name: {
                    "points": list(slide.points),
                    "body": slide.body,
                    "through": slide.through,
                    "along": slide.along,
                    "turns": slide.turns,
                }
                for name, slide in self.slides.items()
            },
            "inputs": {
                name: {k: list(v) if isinstance(v, tuple) else v for k, v in one.table}
                for name, one in self.inputs.items()
                if name in driven
            },
            "roles": {r: list(who) if isinstance(who, tuple) else who for r, who in self.roles.items()},
        }
