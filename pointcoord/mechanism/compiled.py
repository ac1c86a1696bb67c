r"""A structure and the inputs that are driven as a topology of points (see `linkage.topology`).

Unknown are the points where something is joined: those of two bodies, ends of rods, what slides and what
an input drives. At most three of a body are its triangle, whose sides are links; a further one is held in
the triangle, and what nothing needs is carried by it. A side whose two points another body holds already is
no link of its own: so a hinge of two shared points takes no row too many.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.contact_height import ContactHeight
from pointcoord.linkage.constraints.in_body import AxisInBody, Normal, PointInBody
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.constraints.scalar_product import ScalarProduct
from pointcoord.linkage.constraints.turn import Turn
from pointcoord.linkage.directions import DIRECTIONS, car_directions
from pointcoord.linkage.drives import ArmAngle, DistanceOf, Drive, Travel, TravelAlong, TurnedBy
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.structure import CHASSIS, Ends, Input, Slide, Structure

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
    than three, and where there are more, those that are drawn in one line are passed over.
    """
    needed = needed_points(structure, driven)
    found: dict[str, Triangle] = {}
    for body, names in structure.moving_bodies():
        first = [name for name in names if name in needed]
        paired = [name for pair in _held_pairs(structure, body) for name in pair if name in first]
        first = list(dict.fromkeys((*paired, *first)))
        others = [name for name in names if name not in first]
        if len(first) == 3:
            found[body] = (first[0], first[1], first[2])
        elif len(first) < 3:
            fixed, free = (
                (first, others) if len(first) == 2 else ([*first, *others][:2], [*first, *others][2:])
            )
            found[body] = _best([(fixed[0], fixed[1], third) for third in free], points)
        else:
            kept = first[:2] if len(paired) >= 2 else []
            tried = [
                (one, two, three)
                for one, two, three in combinations(first, 3)
                if not kept or kept == [one, two]
            ]
            found[body] = _best(tried, points)
    return found


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
    wheel_radius: float | None = None,
    puts_in_place: bool = False,
) -> Topology:
    """The topology of a structure whose inputs are driven.

    Args:
        driven: names of inputs; those that move the chassis may be among them.
        choices: what of the bodies stands for them.
        wheel_radius: mm; needed where the height of a contact point is driven.
        puts_in_place: whether closing a drawing moves points on purpose.
    """
    return _Compiler(structure, tuple(driven), choices, wheel_radius).topology(puts_in_place)


@dataclass(frozen=True)
class _Compiler:
    structure: Structure
    driven: tuple[str, ...]
    choices: Choices
    wheel_radius: float | None

    @property
    def triangles(self) -> Mapping[str, Triangle]:
        return self.choices.triangles

    def topology(self, puts_in_place: bool) -> Topology:
        structure = self.structure
        needed = needed_points(structure, self.driven)
        chassis = dict.fromkeys(structure.bodies[CHASSIS]).keys()
        solved = dict.fromkeys(
            name
            for body, names in structure.moving_bodies()
            for name in names
            # What rides on a body is carried by moving points; on others it is solved for.
            if name in needed or name in self.triangles[body] or not chassis.isdisjoint(self.triangles[body])
        )
        solved |= dict.fromkeys(name for name in needed if not structure.bodies_of(name))
        moving = tuple(name for name in solved if name not in chassis)
        carried = {
            name: self.triangles[body]
            for body, names in structure.moving_bodies()
            for name in names
            if name not in solved and name not in chassis
        }
        held = _Rods.of(structure, self.travels)
        constraints = [
            *self._bodies(solved),
            *(Link(*ends) for rod, ends in structure.rods.items() if rod not in held.on_axes),
            *self._points_in_bodies(solved),
            *self._slides(held),
        ]
        drives: list[Drive] = []
        for name in structure.inputs:
            if name in self.driven and not structure.inputs[name].moves_the_chassis:
                rows, own = self._input(name, structure.inputs[name])
                constraints += rows
                drives += own
        constraints += self._chassis_lines()
        roles = structure.roles
        knuckle = roles.get("knuckle", "")
        body = self.triangles.get(knuckle) if isinstance(knuckle, str) else None
        along = {name: one["along"] for name, one in structure.inputs.items() if one.kind == "moves"}
        turns = {
            name: (one["along"], one["about"])
            for name, one in structure.inputs.items()
            if one.kind == "turns"
        }
        directions = [*along.values(), *(line[0] for line in turns.values())]
        for name in self.driven:
            one = structure.inputs[name]
            directions += [
                one[key] for key in ("from", "along") if one.kind in ("arm", "height") and key in one.table
            ]
            directions += ["up"] if one.kind == "contact" else []
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
            moving=moving,
            bodies={str(knuckle): body} if body else {},
            carried=carried,
            directions=known,
            constraints=tuple(constraints),
            drives=tuple(drives),
            knuckle=str(knuckle),
            steering_axis=self._pair("steering_axis"),
            damper=self._pair("damper"),
            wheel_axis=self._pair("wheel_axis"),
            inboard=str(roles.get("inboard", "")),
            front_and_rear=self._pair("front_and_rear"),
            stand_ins=structure.stand_ins,
            chassis_motion=along,
            chassis_turns=turns,
            puts_in_place=puts_in_place,
        )

    def _pair(self, role: str) -> tuple[str, ...]:
        who = self.structure.roles.get(role, ())
        return () if isinstance(who, str) else who

    @property
    def travels(self) -> dict[str, str]:
        """By slide whose travel is driven, the input.

        Raises:
            MechanismError: two inputs drive one slide, whose travel has one coordinate.
        """
        found = dict[str, str]()
        for name, one in self.structure.inputs.items():
            if name not in self.driven or one.kind != "travel":
                continue
            for slide in one["travel"]:
                if found.setdefault(slide, name) != name:
                    raise MechanismError(
                        f"{found[slide]} and {name} both drive the travel of {slide}; allowed: one input for "
                        "a slide, so leave one of them out",
                        (found[slide], name),
                    )
        return found

    def _normal(self, body: str) -> Normal:
        return Normal(f"normal of the {body}", *self.triangles[body])

    def _bodies(self, solved: Collection[str]) -> Iterator[Constraint]:
        """The sides of each triangle that nothing before holds."""
        held = [frozenset(self.structure.bodies[CHASSIS])]
        for body, names in self.structure.moving_bodies():
            a, b, c = self.triangles[body]
            for start, end in ((b, a), (c, a), (c, b)):
                if not any({start, end} <= before for before in held):
                    yield Link(start, end)
            held.append(frozenset(name for name in names if name in solved))

    def _points_in_bodies(self, solved: Collection[str]) -> Iterator[Constraint]:
        """What else the bodies need: further points, and the normals of those with an axis of their own."""
        with_axis = {
            slide.body
            for name, slide in self.structure.slides.items()
            if slide.body != CHASSIS and not self._by_two_points(slide)
        }
        for name, one in self.structure.inputs.items():
            if name in self.driven and one.kind == "turn" and one["on"] != CHASSIS:
                with_axis.add(one["on"])
        for body, names in self.structure.moving_bodies():
            further = [n for n in names if n in solved and n not in self.triangles[body]]
            if further or body in with_axis:
                yield self._normal(body)
            yield from (PointInBody(name, body, self._normal(body)) for name in further)

    def _by_two_points(self, slide: Slide) -> bool:
        return slide.along in self.structure.bodies[slide.body]

    def _slides(self, held: _Rods) -> Iterator[Constraint]:
        """Lines of moving bodies, and what keeps bodies from turning about a line."""
        for name, slide in self.structure.slides.items():
            if slide.body != CHASSIS:
                yield from self._body_line(name, slide, held)
            if not slide.turns:
                yield self._kept_from_turning(name, slide)

    def _body_line(self, name: str, slide: Slide, held: _Rods) -> Iterator[Constraint]:
        if name in held.collinear:
            start, end = slide.points
            for point in (slide.through, slide.along):
                yield OnLine(
                    point,
                    start,
                    f"line {start} - {end}",
                    end,
                    f"place of {point} on the {name}",
                    between=True,
                )
            return
        axis = self._axis(name, slide)
        if axis is not None:
            yield axis
        for point in slide.points:
            line = self._sliding(name, slide, point)
            at = held.by_point.get(point)
            yield line if at is None else replace(line, origin=at, at="held")

    def _axis(self, name: str, slide: Slide) -> AxisInBody | None:
        """The axis of a body that a slide runs along, unless the line is one of two of the body's points."""
        if slide.body == CHASSIS or self._by_two_points(slide):
            return None
        tail, head = ("", slide.along) if slide.along in DIRECTIONS else (slide.through, slide.along)
        return AxisInBody(f"{name} axis", tail, head, self._normal(slide.body))

    def _sliding(self, name: str, slide: Slide, point: str) -> OnLine:
        """The rows of one point of a slide; the place of the first is what a travel drives."""
        input = self.travels.get(name) if point == slide.points[0] else None
        axis, line, between = self._axis(name, slide), name, False
        if axis is not None:
            line = head = axis.axis
        elif slide.body != CHASSIS:
            line, head, between = f"line {slide.through} - {slide.along}", slide.along, True
        else:
            head = slide.along if slide.along in DIRECTIONS else f"line of the {name}"
        place = f"place of {point} on the {line if axis is not None else name}"
        if input:
            # Slides along directions of the car have one travel in one coordinate.
            of_the_car = slide.body == CHASSIS and slide.along in DIRECTIONS
            place = f"{input} travel" if of_the_car else f"{input} travel along the {name}"
        return OnLine(point, slide.through, line, head, place, "driven" if input else "free", between, axis)

    def _chassis_lines(self) -> Iterator[Constraint]:
        for name, slide in self.structure.slides.items():
            if slide.body == CHASSIS:
                yield from (self._sliding(name, slide, point) for point in slide.points)

    def _kept_from_turning(self, name: str, slide: Slide) -> Constraint:
        """The pair of edges of the two bodies that change most by a turn about the line."""
        edges = self.choices.edges[name]
        return ScalarProduct(f"turn about the {name}", *edges, f"product of edges across the {name}")

    def _input(self, name: str, one: Input) -> tuple[list[Constraint], list[Drive]]:
        """Rows and drives of an input."""
        value = f"value of {name}"
        if one.kind == "arm":
            of, about, up = one["of"], one["about"], one["from"]
            value = f"{name} rise"
            rise = ScalarProduct(f"rise of {of} over {about}", (of, about), (up, ""), "", value)
            return [rise], [ArmAngle(value, name, about, of, up)]
        if one.kind == "height":
            point, along = one["height"], one["along"]
            drawn = f"drawn height of {point} {along}"
            height = ScalarProduct(f"height of {point}", (point, ""), (along, ""), drawn, value)
            return [height], [Travel(value, name, point, point, along, False)]
        if one.kind == "contact":
            inner, centre = one["contact"]
            assert self.wheel_radius is not None  # the scene is refused without
            rows = ContactHeight(inner, centre, "up", value, self.wheel_radius)
            return [rows], [Travel(value, name, centre, centre, "up", False)]
        if one.kind == "distance":
            start, end = ends = one["distance"]
            square = ScalarProduct(f"distance of {start} and {end}", ends, ends, "", value)
            return [square], [DistanceOf(value, name, start, end)]
        if one.kind == "turn":
            return self._turn(name, one)
        drives: list[Drive] = []
        for slide_name in one["travel"]:
            slide = self.structure.slides[slide_name]
            line = self._sliding(slide_name, slide, slide.points[0])
            if any(drive.coordinate == line.place for drive in drives):
                continue
            if slide.body == CHASSIS and slide.along in DIRECTIONS:
                drives.append(Travel(line.place, name, slide.through, slide.points[0], slide.along))
            else:
                drives.append(TravelAlong(line.place, name, line))
        return [], drives

    def _turn(self, name: str, one: Input) -> tuple[list[Constraint], list[Drive]]:
        body, other = one["angle"], one["on"]
        tail, head = self.structure.shared(body, other)
        point = next(p for p in self.triangles[body] if p not in (tail, head))
        cosine, sine = f"cosine of {name}", f"sine of {name}"
        carrier = None if other == CHASSIS else self._normal(other)
        turn = Turn(f"turn of {body} by {name}", point, tail, head, cosine, sine, carrier)
        return [turn], [TurnedBy(cosine, name, 0), TurnedBy(sine, name, 1)]


@dataclass(frozen=True)
class _Rods:
    """Rods between two points of one line of a body.

    Attributes:
        on_axes: rods whose second point is held on the line at the rod's length, and no link.
        by_point: by that point, the first one.
        collinear: slides by two points of the body whose two points are joined: these two make the line.
    """

    on_axes: frozenset[str]
    by_point: Mapping[str, str]
    collinear: frozenset[str]

    @classmethod
    def of(cls, structure: Structure, travels: Collection[str]) -> _Rods:
        on_axes: set[str] = set()
        by_point: dict[str, str] = {}
        collinear: set[str] = set()
        for name, slide in structure.slides.items():
            if slide.body == CHASSIS:
                continue
            for rod, ends in structure.rods.items():
                if not {*ends} <= {*slide.points}:
                    continue
                if slide.along in structure.bodies[slide.body]:
                    if len(slide.points) == 2 and name not in travels:
                        collinear.add(name)
                    continue
                first, second = sorted(ends, key=slide.points.index)
                if second not in by_point:
                    on_axes.add(rod)
                    by_point[second] = first
        return cls(frozenset(on_axes), by_point, frozenset(collinear))
