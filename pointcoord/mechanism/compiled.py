r"""A structure and the inputs that are driven as a topology of points (see `linkage.topology`).

Unknown are the points where something is joined: those of two bodies, ends of rods, what slides and what
an input drives. At most three of a body are its triangle, whose sides are links; a further one is held in
the triangle, and what nothing needs is carried by it. A side whose two points another body holds already is
no link of its own: so a hinge of two shared points takes no row too many.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.contact_height import Displaced, Ground, TurnedBack
from pointcoord.linkage.constraints.in_body import AxisInBody, Normal, PointInBody
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.constraints.scalar_product import KeptTurn, link
from pointcoord.linkage.directions import DIRECTIONS, axis_along, car_directions
from pointcoord.linkage.drives import Drive, Travel, TurnedBy
from pointcoord.linkage.topology import Sliding, Topology
from pointcoord.mechanism.inputs import CHASSIS, LENGTHS, Ends, Moves, Turn, Turns
from pointcoord.mechanism.structure import Slide, Structure

Array = NDArray[np.float64]
Triangle = tuple[str, str, str]
Place = tuple[float, float, float]

# The sine of the angle of a triangle from which on it is taken for its body; of flatter ones the best is.
FLAT = 0.1
# Places round by u of the car's size; sines below this are none.
IN_LINE = 1e-13


@dataclass(frozen=True)
class Choices:
    """What of a drawing's bodies stands for them in the equations.

    Attributes:
        triangles: three points of each moving body.
        edges: by slide that keeps two bodies from turning, an edge of each.
    """

    triangles: Mapping[str, Triangle]
    edges: Mapping[str, tuple[Ends, Ends]]

    @property
    def key(self) -> Hashable:
        """The same, to look up by."""
        return tuple(self.triangles.items()), tuple(self.edges.items())


def choices_of(
    structure: Structure,
    driven: Collection[str],
    points: Mapping[str, Place],
    axes: Mapping[str, Place],
) -> Choices:
    """What stands for the bodies of a drawing.

    Args:
        axes: `up` and `right` of the car.
    """
    triangles = _triangles(structure, driven, points)
    still = {name: slide for name, slide in structure.slides.items() if not slide.turns}
    if not still:
        return Choices(triangles, {})
    up, right = (np.array(axes[name]) for name in ("up", "right"))
    vectors = {name: high for name, (high, _) in car_directions(up, right).items()}
    vectors |= {name: np.array(place, dtype=float) for name, place in points.items()}
    return Choices(
        triangles, {name: _edges(structure, slide, triangles, vectors) for name, slide in still.items()}
    )


def _edges(
    structure: Structure, slide: Slide, triangles: Mapping[str, Triangle], vectors: Mapping[str, Array]
) -> tuple[Ends, Ends]:
    """The edges of a slide's two bodies whose product changes most by a turn about its line."""
    other = next(body for body, names in structure.moving_bodies() if {*slide.points[:2]} <= {*names})
    line = vectors[slide.along] - (0.0 if slide.along in DIRECTIONS else vectors[slide.through])

    def edges(body: str) -> list[tuple[Ends, Array]]:
        pairs = [("up", ""), ("right", ""), ("forward", "")]
        if body != CHASSIS:
            pairs = list(combinations(triangles[body], 2))
        found = [(pair, vectors[pair[0]] - (vectors[pair[1]] if pair[1] else 0.0)) for pair in pairs]
        return [(pair, edge / max(float(np.linalg.norm(edge)), 1e-300)) for pair, edge in found]

    pairs = [(u, v) for u in edges(slide.body) for v in edges(other)]
    (one, _), (two, _) = max(pairs, key=lambda pair: abs(float(line @ np.cross(pair[0][1], pair[1][1]))))
    return one, two


def _triangles(
    structure: Structure, driven: Collection[str], points: Mapping[str, Place]
) -> dict[str, Triangle]:
    """The three points that stand for each moving body in a drawing.

    Those that something is joined to come first, in the order of the file; others only where there are fewer
    than three or all are drawn in one line, and where there are more, those in one line are passed over.
    """
    needed = needed_points(structure, driven)
    found: dict[str, Triangle] = {}
    for body, names in structure.moving_bodies():
        joined = [name for name in names if name in needed]
        paired = [name for pair in _held_pairs(structure, body) for name in pair if name in joined]
        order = list(dict.fromkeys((*paired, *joined, *names)))
        # Two are settled where a hinge holds them, or where no more are joined.
        settled = order[:2] if len(joined) < 3 or len(paired) >= 2 else []
        tried = [
            (one, two, three)
            for one, two, three in combinations(order, 3)
            if not settled or settled == [one, two]
        ]
        of_joined = [one for one in tried if {*one} <= {*joined}]
        if of_joined and (len(of_joined) == len(tried) or not _in_line(of_joined, points)):
            tried = of_joined
        found[body] = tried[0] if tried == of_joined and len(joined) == 3 else _best(tried, points)
    return found


def _in_line(tried: list[Triangle], points: Mapping[str, Place]) -> bool:
    """Whether the corners of all of some triangles are drawn apart and in one line."""
    corners = [(points[a], points[b], points[c]) for a, b, c in tried]
    return all(len({*map(tuple, one)}) == len(one) and _sine(*one) <= IN_LINE for one in corners)


def _held_pairs(structure: Structure, body: str) -> Iterator[Ends]:
    """The hinges of a body with those before it, the chassis first."""
    bodies = [CHASSIS, *(name for name, _ in structure.moving_bodies())]
    for other in bodies[: bodies.index(body)]:
        shared = structure.shared(body, other)
        if len(shared) == 2:
            yield shared[0], shared[1]


def _best(tried: list[Triangle], points: Mapping[str, Place]) -> Triangle:
    """The first that is not flat, or the least flat."""
    sines = [_sine(*(points[name] for name in one)) for one in tried]
    good = next((one for one, sine in zip(tried, sines, strict=True) if sine > FLAT), None)
    # Where only the order of the points counts they are all in one place.
    drawn = len({*points.values()}) > 1
    if drawn and max(sines) <= IN_LINE:
        names = tuple(dict.fromkeys(name for one in tried for name in one))
        raise MechanismError(
            f"{', '.join(names)} lie in one line, and so cannot stand for a body; draw one off the line, or "
            "give the body a further point",
            names,
        )
    return good or max(zip(sines, tried, strict=True), key=lambda each: each[0])[1]


def _sine(base: Place, first: Place, second: Place) -> float:
    """Of the smallest angle of a triangle, about: twice its area by the squares of its longest side."""
    corners = np.array((base, first, second), dtype=float)
    # By a power of two, which rounds nothing: squares of huge coordinates have no number.
    a, b, c = np.ldexp(corners, -int(np.frexp(np.abs(corners).max())[1]) - 1)
    longest = max(float(np.sum((p - q) ** 2)) for p, q in ((a, b), (b, c), (a, c)))
    area = float(np.linalg.norm(np.cross(b - a, c - a)))
    return area / longest if longest > 0.0 else 0.0


def needed_points(structure: Structure, driven: Collection[str]) -> dict[str, None]:
    """The points that something is joined to or driven by, in the order of the bodies."""
    joined = {end for ends in structure.rods.values() for end in ends}
    for slide in structure.slides.values():
        joined |= {*slide.points, slide.through}
        if slide.along in structure.bodies[slide.body] and slide.body != CHASSIS:
            joined.add(slide.along)
    for name, one in structure.inputs.items():
        if name in driven:
            joined |= {*one.named("point")}
    return {
        point: None for point in structure.points if point in joined or len(structure.bodies_of(point)) != 1
    }


def compiled(
    structure: Structure,
    driven: Collection[str],
    choices: Choices,
    lengths: Mapping[str, float] | None = None,
    puts_in_place: bool = False,
) -> Topology:
    """The topology of a structure whose inputs are driven.

    Args:
        driven: names of inputs; those that move the chassis may be among them.
        choices: what of the bodies stands for them.
        lengths: that driven inputs need beside the points, by name, mm.
        puts_in_place: whether closing a drawing moves points on purpose.
    """
    return _Compiler(structure, tuple(driven), choices, lengths or {}).topology(puts_in_place)


@dataclass(frozen=True, eq=False)
class _Compiler:
    structure: Structure
    driven: tuple[str, ...]
    choices: Choices
    lengths: Mapping[str, float]

    def topology(self, puts_in_place: bool) -> Topology:
        structure, triangles = self.structure, self.choices.triangles
        needed = needed_points(structure, self.driven)
        chassis = dict.fromkeys(structure.bodies[CHASSIS]).keys()
        solved = dict.fromkeys(
            name
            for body, names in structure.moving_bodies()
            for name in names
            # What rides on a body is carried by moving points; on others it is solved for.
            if name in needed or name in triangles[body] or not chassis.isdisjoint(triangles[body])
        )
        solved |= dict.fromkeys(name for name in needed if not structure.bodies_of(name))
        carried = {
            name: triangles[body]
            for body, names in structure.moving_bodies()
            for name in names
            if name not in solved and name not in chassis
        }
        slides = {name: list(self._slide(name)) for name in structure.slides}
        constraints: list[Constraint] = [
            *self._bodies(solved),
            *self._points_in_bodies(solved),
            *(one for own in slides.values() for one in own),
        ]
        drives: list[Drive] = []
        for name, one in structure.inputs.items():
            rows, own = one.made(name, self) if name in self.driven else ([], [])
            constraints += rows
            drives += own
        inputs = structure.inputs.items()
        roles = {role: (who,) if isinstance(who, str) else who for role, who in structure.roles.items()}
        roles |= {role: triangles[body] for role, body in structure.knuckles.items()}
        along = {name: one.along for name, one in inputs if isinstance(one, Moves)}
        turns = {name: (one.along, one.about) for name, one in inputs if isinstance(one, Turns)}
        directions = [*along.values(), *(axis_along(line[0]) for line in turns.values())]
        directions += [way for name in self.driven for way in structure.inputs[name].directions]
        directions += [slide.along for slide in structure.slides.values() if slide.along in DIRECTIONS]
        directions += [head for edges in self.choices.edges.values() for head, tail in edges if not tail]
        known = {name: ("", name) for name in directions}
        known |= {
            f"line of the {name}": (slide.through, slide.along)
            for name, slide in structure.slides.items()
            if slide.body == CHASSIS and slide.along not in DIRECTIONS
        }

        return Topology(
            name=structure.name,
            chassis=tuple(chassis),
            moving=tuple(name for name in solved if name not in chassis),
            bodies={body: triangles[body] for body in structure.knuckles.values()},
            carried=carried,
            directions=known,
            # Several heights may be over one ground.
            constraints=tuple(dict.fromkeys(constraints)),
            drives=tuple(dict.fromkeys(drives)),
            roles=roles,
            sides=structure.sides,
            rods=structure.rods,
            joints=structure.joints(self.driven),
            sliding={
                point: Sliding(
                    tuple(
                        one.name
                        for one in slides[slide]
                        if isinstance(one, OnLine) and point in (one.point, one.origin, one.head)
                    ),
                    of_line,
                )
                for point, (slide, of_line) in structure.sliding().items()
            },
            stand_ins=structure.stand_ins,
            chassis_motion=along,
            chassis_turns=turns,
            rolling=tuple(n for n in turns if n in self.driven and turns[n][0] in ("forward", "rearward")),
            puts_in_place=puts_in_place,
        )

    @cached_property
    def travels(self) -> dict[str, str]:
        """By slide whose travel is driven, the input.

        Raises:
            MechanismError: two inputs drive one slide, whose travel has one coordinate.
        """
        found = dict[str, str]()
        for name, one in self.structure.inputs.items():
            for slide in one.named("slide") if name in self.driven else ():
                if found.setdefault(slide, name) != name:
                    raise MechanismError(
                        f"{found[slide]} and {name} both drive the travel of {slide}; allowed: one input for "
                        "a slide, so leave one of them out",
                        (found[slide], name),
                    )
        return found

    @cached_property
    def ground(self) -> tuple[Ground, list[Drive]]:
        """The ground as the driven chassis sees it, and what drives it.

        Raises:
            MechanismError: the chassis is turned about a point that it does not carry.
        """
        chassis, before = self.structure.bodies[CHASSIS], "up"
        turns, moves, made = list[TurnedBack](), list[tuple[str, str]](), list[Drive]()
        driven = [(name, one) for name, one in self.structure.inputs.items() if name in self.driven]
        for name, one in reversed(driven):
            if isinstance(one, Turns):
                if one.about not in chassis:
                    raise MechanismError(
                        f"{name} turns the chassis about {one.about}, which it does not carry, and a height "
                        f"over the ground is driven; allowed: about one of {', '.join(chassis)}",
                        (name, one.about),
                    )
                pair = f"cosine of {name}", f"sine of {name}"
                turns.append(TurnedBack(name, before, axis_along(one.along), one.about, *pair))
                made += [TurnedBy(place, name, quarter) for quarter, place in enumerate(pair)]
                before = turns[-1].name
            elif isinstance(one, Moves):
                value = f"value of {name}"
                moves.append((value, one.along))
                made.append(Travel(value, name, chassis[0], chassis[0], one.along, False))
        return Ground(tuple(turns), (Displaced(tuple(moves)),) if moves else ()), made

    def length(self, name: str, input: str) -> float:
        """A length that an input needs, mm.

        Raises:
            MechanismError: the scene does not say it.
        """
        if name not in self.lengths:
            what, usual = LENGTHS[name]
            raise MechanismError(
                f"input {input!r} is {what}, and the mechanism has no {name}; allowed: {name} in mm, such as "
                f"{name} = {usual}",
                (input,),
            )
        return self.lengths[name]

    def shared(self, body: str, other: str) -> tuple[str, ...]:
        return self.structure.shared(body, other)

    def driven_line(self, slide: str) -> OnLine:
        return self._on_line(slide, self.structure.slides[slide].points[0])

    def normal(self, body: str) -> Normal:
        return Normal(f"normal of the {body}", *self.choices.triangles[body])

    def _bodies(self, solved: Collection[str]) -> Iterator[Constraint]:
        """The sides of each triangle that nothing else holds, and the rods that are links."""
        moving = self.structure.moving_bodies()
        bodies = [(self.choices.triangles[body], {*names} & {*solved}) for body, names in moving]
        before = [{*self.structure.bodies[CHASSIS]}]
        for triangle, points in bodies:
            a, b, c = triangle
            for start, end in ((b, a), (c, a), (c, b)):
                side = {start, end}
                # A body that has one of the two as a further point holds their distance, first or last.
                further = any(side <= others and not side <= {*corners} for corners, others in bodies)
                if not further and not any(side <= others for others in before):
                    yield link(start, end)
            before.append(points)
        for ends in self.structure.rods.values():
            if ends not in self._on_axes.values():
                yield link(*ends)

    def _points_in_bodies(self, solved: Collection[str]) -> Iterator[Constraint]:
        """What else the bodies need: further points, and the normals of those with an axis of their own."""
        inputs = self.structure.inputs.items()
        with_axis = {one.on for name, one in inputs if name in self.driven and isinstance(one, Turn)}
        with_axis |= {axis.normal.normal for axis in map(self._axis, self.structure.slides) if axis}
        for body, names in self.structure.moving_bodies():
            normal = self.normal(body)
            further = [n for n in names if n in solved and n not in self.choices.triangles[body]]
            if further or body in with_axis or normal.normal in with_axis:
                yield normal
            yield from (PointInBody(name, body, normal) for name in further)

    @cached_property
    def _on_axes(self) -> dict[str, Ends]:
        """By point that a rod holds on an axis of a body, at its length from another there: the rod's ends.

        The first rod of a point is no link, but holds it.
        """
        found: dict[str, Ends] = {}
        for name, slide in self.structure.slides.items():
            for ends in self.structure.rods.values() if self._axis(name) else ():
                if {*ends} <= {*slide.points}:
                    found.setdefault(max(ends, key=slide.points.index), ends)
        return found

    def _slide(self, name: str) -> Iterator[Constraint]:
        """The points of a slide, and what keeps bodies from turning about its line."""
        slide = self.structure.slides[name]
        by_two = slide.body != CHASSIS and self._axis(name) is None
        joined = any({*ends} == {*slide.points} for ends in self.structure.rods.values())
        if by_two and joined and name not in self.travels:
            # Two points that a rod joins make the line, and the two of the body are on it.
            start, end = slide.points
            for point in (slide.through, slide.along):
                place = f"place of {point} on the {name}"
                yield OnLine(point, start, f"line {start} - {end}", end, place, between=True)
        else:
            axis = self._axis(name)
            if axis is not None:
                yield axis
            yield from (self._on_line(name, point) for point in slide.points)
        if not slide.turns:
            edges = self.choices.edges[name]
            line = (slide.along, "" if slide.along in DIRECTIONS else slide.through)
            own = (slide.points[1], slide.points[0])
            what, product = f"turn about the {name}", f"product of edges across the {name}"
            yield KeptTurn(what, *edges, product, line=line, own=own)

    def _axis(self, name: str) -> AxisInBody | None:
        """The axis of a body that a slide runs along, unless the line is one of two of the body's points."""
        slide = self.structure.slides[name]
        if slide.body == CHASSIS or slide.along in self.structure.bodies[slide.body]:
            return None
        tail = "" if slide.along in DIRECTIONS else slide.through
        return AxisInBody(f"{name} axis", tail, slide.along, self.normal(slide.body))

    def _on_line(self, name: str, point: str) -> OnLine:
        """The rows of one point of a slide; the place of the first is what a travel drives."""
        slide, axis = self.structure.slides[name], self._axis(name)
        input = self.travels.get(name) if point == slide.points[0] else None
        line, head, between = name, slide.along, slide.body != CHASSIS and axis is None
        if axis is not None:
            line = head = axis.axis
        elif between:
            line = f"line {slide.through} - {slide.along}"
        elif slide.along not in DIRECTIONS:
            head = f"line of the {name}"
        if axis is not None and point in self._on_axes:
            (at,) = {*self._on_axes[point]} - {point}
            return OnLine(point, at, line, head, f"place of {point} on the {line}", "held", axis=axis)
        place = f"place of {point} on the {line if axis is not None else name}"
        if input:
            # Slides along directions of the car have one travel in one coordinate.
            place = f"{input} travel" if head in DIRECTIONS else f"{input} travel along the {name}"
        return OnLine(point, slide.through, line, head, place, "driven" if input else "free", between, axis)
