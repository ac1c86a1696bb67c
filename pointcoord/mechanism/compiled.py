r"""Compiles a structure, its drawn points and its driven inputs to a topology of points (`linkage.topology`).

The unknowns are the points where something is joined: points of two bodies, ends of rods, sliding points and
driven points. At most three points of a body are its triangle, whose sides are links. Further points are held
in the triangle; those that nothing is joined to are only carried. A side whose two points another body holds
already is not made a link again, so a hinge of two shared points adds no redundant row.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage import drives
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.contact_height import Ground, contact_height
from pointcoord.linkage.constraints.in_body import (
    Axis,
    Triangle,
    axis_in_body,
    normal_of,
    point_in_body,
)
from pointcoord.linkage.constraints.on_line import Line, on_line
from pointcoord.linkage.constraints.scalar_product import kept_turn, link, scalar_product
from pointcoord.linkage.constraints.turn import turn
from pointcoord.linkage.directions import DIRECTIONS, axis_along, car_directions
from pointcoord.linkage.drives import Drive
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.inputs import (
    CHASSIS,
    LENGTHS,
    Arm,
    Contact,
    Distance,
    Ends,
    Height,
    Input,
    Moves,
    Slide,
    Steers,
    Travel,
    Turn,
    Turns,
)
from pointcoord.mechanism.structure import Structure
from pointcoord.numerics.arrays import Array

Place = tuple[float, float, float]
Made = Constraint | Drive

# Sine of the smallest angle of a triangle. The first triangle above this stands for its body; if all are
# flatter, the least flat one does.
FLAT = 0.1
# Directions about which a turn of the car is roll.
LENGTHWISE = ("forward", "rearward")
# Coordinates are rounded by u of the car's size; smaller sines count as zero.
IN_LINE = 1e-13


@dataclass(frozen=True, eq=False)
class Compiler:
    """Compiles the linkage of a car.

    Attributes:
        driven: names of the driven inputs, which may include chassis inputs.
        points: drawn places, mm.
        axes: `up` and `right` of the car.
        lengths: further lengths that inputs need, by name, mm.
    """

    structure: Structure
    driven: tuple[str, ...]
    points: Mapping[str, Place]
    axes: Mapping[str, Place]
    lengths: Mapping[str, float]

    @property
    def key(self) -> Hashable:
        """Everything that the topology depends on: equal keys give one topology for all such cars."""
        needed = {self.structure.inputs[name].length for name in self.driven}
        lengths = tuple((name, length) for name, length in self.lengths.items() if name in needed)
        chosen = (*self.triangles.items(), *self.edges.items())
        return self.driven, tuple(self.structure.points), chosen, lengths

    def topology(self, name: str, puts_in_place: bool) -> Topology:
        """The topology.

        Args:
            puts_in_place: whether closing a drawing moves points on purpose.
        """
        structure, triangles, chassis = self.structure, self.triangles, self.chassis
        made: list[Made] = [*self._bodies(), *self._points_in_bodies()]
        made += [row for slide in structure.slides for row in self._slide(slide)]
        made += [part for name in self.driven for part in self._input(name, structure.inputs[name])]
        roles = {role: structure.role(role) for role in structure.roles}
        roles |= {role: triangles[body] for role, body in structure.knuckles.items()}
        moves = {name: (one.along, "") for name, one in structure.inputs.items() if isinstance(one, Moves)}
        turns = {n: (one.along, one.about) for n, one in structure.inputs.items() if isinstance(one, Turns)}
        return Topology(
            name=name,
            chassis=chassis,
            moving=tuple(point for point in self.solved if point not in chassis),
            bodies={body: triangles[body] for body in structure.knuckles.values()},
            carried={
                point: triangles[body]
                for body, names in structure.moving_bodies.items()
                for point in names
                if point not in self.solved and point not in chassis
            },
            directions=self._directions(),
            # Several heights may be measured from one ground.
            constraints=tuple(dict.fromkeys(part for part in made if isinstance(part, Constraint))),
            drives=tuple(dict.fromkeys(part for part in made if isinstance(part, Drive))),
            roles=roles,
            sides=structure.sides,
            rods=structure.rods,
            joints=structure.joints(self.driven),
            sliding=structure.sliding,
            stand_ins=structure.stand_ins,
            chassis_inputs=moves | turns,
            rolling=tuple(n for n, (along, _) in turns.items() if n in self.driven and along in LENGTHWISE),
            puts_in_place=puts_in_place,
        )

    def _directions(self) -> dict[str, tuple[str, str]]:
        """Directions fixed to the chassis: directions of the car, and drawn lines of the chassis' slides."""
        slides, inputs = self.structure.slides.items(), self.structure.inputs.items()
        asked = [one for name, one in inputs if name in self.driven or one.moves_the_chassis]
        names = [direction for one in asked for direction in one.directions]
        names += [slide.along for _, slide in slides if slide.along in DIRECTIONS]
        names += [head for edges in self.edges.values() for head, tail in edges if not tail]
        lines = {
            f"line of the {name}": (slide.through, slide.along)
            for name, slide in slides
            if slide.body == CHASSIS and slide.along not in DIRECTIONS
        }
        return {name: ("", name) for name in names} | lines

    # Points that represent the bodies.

    @cached_property
    def chassis(self) -> tuple[str, ...]:
        return self.structure.bodies[CHASSIS]

    @cached_property
    def needed(self) -> frozenset[str]:
        """The points that something is joined to or driven by."""
        structure = self.structure
        shared = (point for point in structure.points if len(structure.bodies_of(point)) != 1)
        driven = (point for name in self.driven for point in structure.inputs[name].named("point"))
        lines = (
            slide.along
            for slide in structure.slides.values()
            if slide.body != CHASSIS and slide.along in structure.bodies[slide.body]
        )
        return structure.attached.union(shared, driven, lines)

    @cached_property
    def solved(self) -> tuple[str, ...]:
        """The points that are solved for, including those of the chassis among them.

        A point that is fixed to a body is carried where the body's triangle moves; where the triangle has a
        point of the chassis, the point is solved for.
        """
        structure, found = self.structure, list[str]()
        for body, points in structure.moving_bodies.items():
            held = not {*self.chassis}.isdisjoint(self.triangles[body])
            found += [p for p in points if held or p in self.needed or p in self.triangles[body]]
        free = (point for point in structure.points if not structure.bodies_of(point))
        return tuple(dict.fromkeys((*found, *free)))

    @cached_property
    def triangles(self) -> dict[str, Triangle]:
        """The three points that stand for each moving body.

        Points that something is joined to come first, in the file's order. Others are used only where fewer
        than three are joined or all joined ones are in one line. Triangles in one line are passed over.
        """
        found: dict[str, Triangle] = {}
        bodies = self.structure.moving_bodies
        for number, (body, names) in enumerate(bodies.items()):
            joined = [name for name in names if name in self.needed]
            hinges = [self.structure.shared(body, other) for other in (CHASSIS, *[*bodies][:number])]
            paired = [p for hinge in hinges if len(hinge) == 2 for p in hinge if p in self.needed]
            order = list(dict.fromkeys((*paired, *joined, *names)))
            # Two corners are fixed where a hinge holds them, or where fewer than three points are joined.
            settled = order[:2] if len(joined) < 3 or len(paired) >= 2 else []
            tried = [one for one in combinations(order, 3) if not settled or settled == [*one[:2]]]
            of_joined = [one for one in tried if {*one} <= {*joined}]
            if of_joined and (len(of_joined) == len(tried) or not self._in_line(of_joined)):
                tried = of_joined
            found[body] = tried[0] if tried == of_joined and len(joined) == 3 else self._best(tried)
        return found

    def _in_line(self, tried: list[Triangle]) -> bool:
        """Whether each of these triangles has three distinct corners in one line."""
        corners = [[self.points[name] for name in one] for one in tried]
        return all(len({*map(tuple, one)}) == 3 and _sine(one) <= IN_LINE for one in corners)

    def _best(self, tried: list[Triangle]) -> Triangle:
        """The first triangle that is not flat, or the least flat one."""
        sines = [_sine([self.points[name] for name in one]) for one in tried]
        good = next((one for one, sine in zip(tried, sines, strict=True) if sine > FLAT), None)
        if max(sines) <= IN_LINE:
            names = tuple(dict.fromkeys(name for one in tried for name in one))
            raise MechanismError(
                f"{', '.join(names)} lie in one line, so they do not fix a body's orientation; move one of "
                "them off the line, or give the body another point",
                names,
            )
        return good or tried[sines.index(max(sines))]

    @cached_property
    def edges(self) -> dict[str, tuple[Ends, Ends]]:
        """Slide that keeps two bodies from turning -> one edge of each body.

        The edges are chosen so that their scalar product changes most with a turn about the slide's line.
        """
        still = {name: slide for name, slide in self.structure.slides.items() if not slide.turns}
        if not still:
            return {}
        up, right = (np.array(self.axes[name]) for name in ("up", "right"))
        vectors = {name: high for name, (high, _) in car_directions(up, right).items()}
        vectors |= {name: np.array(place, dtype=float) for name, place in self.points.items()}
        found = {}
        for name, slide in still.items():
            bodies = self.structure.moving_bodies.items()
            other = next(body for body, names in bodies if {*slide.points[:2]} <= {*names})
            line = vectors[slide.along] - (0.0 if slide.along in DIRECTIONS else vectors[slide.through])
            pairs = [
                (abs(float(line @ np.cross(u, v))), one, two)
                for one, u in self._unit_edges(slide.body, vectors)
                for two, v in self._unit_edges(other, vectors)
            ]
            _, one, two = max(pairs, key=lambda pair: pair[0])
            found[name] = one, two
        return found

    def _unit_edges(self, body: str, vectors: Mapping[str, Array]) -> Iterator[tuple[Ends, Array]]:
        """Unit vectors along the edges of a body's triangle; for the chassis, along the car's axes."""
        axes = [("up", ""), ("right", ""), ("forward", "")]
        for p, q in axes if body == CHASSIS else combinations(self.triangles[body], 2):
            edge = vectors[p] - (vectors[q] if q else 0.0)
            yield (p, q), edge / max(float(np.linalg.norm(edge)), 1e-300)

    # Rows of bodies, rods and slides

    def _bodies(self) -> Iterator[Constraint]:
        """Links for the triangle sides that nothing else holds, and for rods."""
        moving = self.structure.moving_bodies.items()
        bodies = [({*self.triangles[body]}, {*names} & {*self.solved}) for body, names in moving]
        before = [{*self.chassis}]
        for (a, b, c), (_, points) in zip(self.triangles.values(), bodies, strict=True):
            for start, end in ((b, a), (c, a), (c, b)):
                side = {start, end}
                # A body that has one of the two as a further point fixes their distance, wherever listed.
                further = any(side <= others and not side <= corners for corners, others in bodies)
                if not further and not any(side <= others for others in before):
                    yield link(start, end)
            before.append(points)
        for ends in self.structure.rods.values():
            if ends not in self._on_axes.values():
                yield link(*ends)

    def _points_in_bodies(self) -> Iterator[Constraint]:
        """Rows of the bodies' further points, and of the normals of bodies that need one."""
        turned = [one for one in map(self.structure.inputs.get, self.driven) if isinstance(one, Turn)]
        with_axis = {one.on for one in turned} | {
            line.axis.body for line in self._lines.values() if line.axis
        }
        for body, names in self.structure.moving_bodies.items():
            triangle = self.triangles[body]
            further = [n for n in names if n in self.solved and n not in triangle]
            if further or body in with_axis:
                yield normal_of(body, triangle)
            yield from (point_in_body(name, body, triangle) for name in further)

    @cached_property
    def _lines(self) -> dict[str, Line]:
        """Slide -> its line: of the chassis, through two points of a body, or along a body-fixed axis."""
        return {name: self._line(name, slide) for name, slide in self.structure.slides.items()}

    def _line(self, name: str, slide: Slide) -> Line:
        start, head, by_direction = slide.through, slide.along, slide.along in DIRECTIONS
        if slide.body == CHASSIS:
            return Line(name, start, head if by_direction else f"line of the {name}", slide=name)
        if head in self.structure.bodies[slide.body]:
            return Line(f"line {start} - {head}", start, head, between=True, slide=name)
        axis = Axis(f"{name} axis", "" if by_direction else start, head, slide.body)
        return Line(axis.name, start, axis.name, axis=axis, slide=name)

    @cached_property
    def _on_axes(self) -> dict[str, Ends]:
        """Point that a rod holds on a body's axis, at its length from another point there -> the rod's ends.

        The first rod at such a point is not made a link; it places the point on the axis.
        """
        found: dict[str, Ends] = {}
        for name in (name for name, line in self._lines.items() if line.axis):
            points = self.structure.slides[name].points
            for ends in self.structure.rods.values():
                if {*ends} <= {*points}:
                    found.setdefault(max(ends, key=points.index), ends)
        return found

    def _slide(self, name: str) -> Iterator[Constraint]:
        """Rows of the points of a slide, and the row that keeps two bodies from turning about its line."""
        slide, along = self.structure.slides[name], self._lines[name]
        joined = any({*ends} == {*slide.points} for ends in self.structure.rods.values())
        if along.between and joined and name not in self.travels:
            # The rod's two ends define the line, and the body's two points lie on it.
            start, end = slide.points
            line = Line(f"line {start} - {end}", start, end, between=True, slide=name)
            for point in (slide.through, slide.along):
                yield on_line(point, line, f"place of {point} on the {name}")
        else:
            if along.axis:
                yield axis_in_body(along.axis, self.triangles[slide.body])
            yield from (self._on_line(name, point) for point in slide.points)
        if not slide.turns:
            one, other = self.edges[name]
            line_of = (slide.along, "" if slide.along in DIRECTIONS else slide.through)
            own = (slide.points[1], slide.points[0])
            what, product = f"turn about the {name}", f"product of edges across the {name}"
            yield kept_turn(what, one, other, product, line_of, own)

    def _on_line(self, name: str, point: str) -> Constraint:
        """The rows of one point of a slide."""
        line, place = self._lines[name], self._travel_of(name)
        if line.axis and point in self._on_axes:
            (at,) = {*self._on_axes[point]} - {point}
            line = line._replace(origin=at)
            return on_line(point, line, f"place of {point} on the {line.name}", "held")
        if place and point == self.structure.slides[name].points[0]:
            return on_line(point, line, place, "driven")
        return on_line(point, line, f"place of {point} on the {line.name if line.axis else name}")

    def _travel_of(self, slide: str) -> str:
        """Name of the coordinate of a slide's first point along it, if an input drives it; else empty."""
        input = self.travels.get(slide, "")
        # Slides along directions of the car share one coordinate per input.
        along = "" if self._lines[slide].head in DIRECTIONS else f" along the {slide}"
        return input and f"{input} travel{along}"

    # Rows and drives of inputs

    def _input(self, name: str, one: Input) -> Iterator[Made]:
        """Rows and drives of a driven input; none for a chassis input."""
        value, cosine, sine = (f"{what} {name}" for what in ("value of", "cosine of", "sine of"))
        match one:
            case Arm(of=of, about=about, from_=direction):
                rise = f"{name} rise"
                yield scalar_product(f"rise of {of} over {about}", (of, about), (direction, ""), "", rise)
                yield drives.arm_angle(rise, name, about, of, direction)
            case Turn(angle=body, on=on):
                tail, head = self.structure.shared(body, on)
                point = next(corner for corner in self.triangles[body] if corner not in (tail, head))
                carrier = None if on == CHASSIS else (on, self.triangles[on])
                yield turn(f"turn of {body} by {name}", point, (tail, head), (cosine, sine), carrier)
                yield from (drives.turned_by(cosine, name, 0), drives.turned_by(sine, name, 1))
            case Travel(travel=slides):
                yield from self._travels(name, slides)
            case Steers(steers=slides):
                per_turn = self._length(one.length, name)
                yield from (drives.steered(each, per_turn) for each in self._travels(name, slides))
            case Height(height=point, along=along):
                drawn, what = f"drawn height of {point} {along}", f"height of {point}"
                yield scalar_product(what, (point, ""), (along, ""), drawn, value)
                yield drives.travel(value, name, point, point, along, slides=False)
            case Contact(contact=(inner, centre), over=over):
                ground, moves = self._ground if over == "ground" else (Ground(), [])
                yield from ground.constraints
                yield contact_height(inner, centre, value, self._length(one.length, name), ground)
                yield drives.travel(value, name, centre, centre, "up", slides=False)
                yield from moves
            case Distance(distance=edge):
                yield scalar_product(f"distance of {edge[0]} and {edge[1]}", edge, edge, "", value)
                yield drives.distance_of(value, name, *edge)

    def _travels(self, name: str, slides: Collection[str]) -> Collection[Drive]:
        found: dict[str, Drive] = {}
        for slide in slides:
            point, place = self.structure.slides[slide].points[0], self._travel_of(slide)
            # Several slides along one direction of the car share one travel.
            found.setdefault(place, drives.travel_along(place, name, self._lines[slide], point))
        return found.values()

    @cached_property
    def travels(self) -> dict[str, str]:
        """Slide whose travel is driven -> the input.

        Raises:
            MechanismError: two inputs drive one slide, whose travel has one coordinate.
        """
        found = dict[str, str]()
        for name in self.driven:
            for slide in self.structure.inputs[name].named("slide"):
                if found.setdefault(slide, name) != name:
                    raise MechanismError(
                        f"{found[slide]} and {name} both drive the travel of {slide}; allowed: one input per "
                        "slide, so leave one of them out",
                        (found[slide], name),
                    )
        return found

    @cached_property
    def _ground(self) -> tuple[Ground, list[Drive]]:
        """The ground as seen from the driven chassis, and the drives of the chassis.

        Raises:
            MechanismError: the chassis turns about a point that does not belong to it.
        """
        chassis, ground, moves, made = [*self.chassis], Ground(), list[tuple[str, str]](), list[Drive]()
        for name in reversed(self.driven):
            one = self.structure.inputs[name]
            if isinstance(one, Turns):
                if one.about not in chassis:
                    raise MechanismError(
                        f"{name} turns the chassis about {one.about}, which is not a chassis point, while a "
                        f"height over the ground is driven; allowed: about one of {', '.join(chassis)}",
                        (name, one.about),
                    )
                pair = f"cosine of {name}", f"sine of {name}"
                ground = ground.turned_back(name, axis_along(one.along), one.about, *pair)
                made += [drives.turned_by(place, name, quarter) for quarter, place in enumerate(pair)]
            elif isinstance(one, Moves):
                value = f"value of {name}"
                moves.append((value, one.along))
                made.append(drives.travel(value, name, chassis[0], chassis[0], one.along, slides=False))
        return ground.displaced(tuple(moves)) if moves else ground, made

    def _length(self, name: str, input: str) -> float:
        """A length that an input needs, mm.

        Raises:
            MechanismError: the scene does not give this length.
        """
        if name not in self.lengths:
            usual = f"{name} = {LENGTHS[name]} in a scene in mm"
            problem = f"input {input!r} needs the mechanism's {name}, which is not given"
            raise MechanismError(f"{problem}; allowed: {name} under [mechanism], such as {usual}", (input,))
        return self.lengths[name]


def _sine(corners: list[Place]) -> float:
    """Approximate sine of a triangle's smallest angle: twice its area over the square of its longest side."""
    places = np.array(corners, dtype=float)
    # Scaled by a power of two, which is exact, since squares of huge coordinates overflow.
    a, b, c = np.ldexp(places, -int(np.frexp(np.abs(places).max())[1]) - 1)
    longest = max(float(np.sum((p - q) ** 2)) for p, q in ((a, b), (b, c), (a, c)))
    area = float(np.linalg.norm(np.cross(b - a, c - a)))
    return area / longest if longest > 0.0 else 0.0
