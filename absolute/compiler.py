"""Compiles a mechanism given as plain data to the rows of a linkage.

    one point of two bodies    a ball joint          rod     a distance
    two points of two bodies   a hinge               slide   a point on a line of a body

Joints consist of two kinds of rows: two points meet along some directions, and directions of two bodies stay
at right angles. A point of no body becomes a body that does not turn. A wheel's contact point is the lowest
point of a disc, a body that turns about the wheel's axis so that one of its radii stays level.

The chassis stands still, unless inputs turn it: then it is a body on a driven hinge. With several such
inputs, each hinge carries a body on which the next one turns. Everything moves with the car's displacement.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain, combinations
from typing import Any

import numpy as np

from absolute.description import car_of, directions_of, is_number, one_of, point_of, vector_of
from absolute.errors import DescriptionError
from absolute.model import CHASSIS, Corner, Drawing, Input, Load, Model, Row
from absolute.vectors import EPS, Array, cross

# Squares of the lengths of a larger drawing, mm, are normal.
SMALLEST_SIZE = 1e-100
# In units of size: coordinates of two nearer points agree in half of their digits, so that the line between
# them has only the other half.
SHORTEST_AXIS = math.sqrt(EPS)
SIDES = ("left", "right")
ROLES = ("wheel_axis", "steering_axis", "damper")
INPUTS = ("angle", "travel", "steers", "height", "contact", "distance", "turns", "moves")
# The body on which the car turns; no other body has an empty name.
GROUND = ""
NOTHING, AXES = np.zeros(3), np.eye(3)
# Two bodies, and a point in each: first body, its point, second body, its point.
Ends = tuple[str, str, str, str]


def compile(mechanism: Mapping[str, Any]) -> Model:
    """Compile the linkage of a mechanism.

    Args:
        mechanism: plain data, mm and rad:
            bodies: name -> names of its points; `chassis` is one of them. rods: name -> two points.
            slides: name -> points, body, through, along, turns.
            inputs: name -> one of angle, travel, steers, height, contact, distance; or of turns and moves,
                which turn and displace the whole car.
            roles: knuckle, a body; wheel_axis, steering_axis and damper, two points each, if they exist.
            points: name -> (x, y, z). up, right: directions, of any length. side: "left" or "right".
            sides: for a mechanism with parts, part -> side; names of its roles and inputs begin with the part
                and a dot.
            wheel_radius, rack_per_turn: radius of the wheel, and travel of the rack per turn of the steering
                wheel, mm, or None.
            car: some numbers of the car: axle, "front" or "rear"; wheelbase, mm; centre_of_gravity_height
                above the ground as drawn, mm; brake_share and drive_share, the parts of the braking and of
                the driving force that act at this axle, 0 to 1; spring_rate, N/mm, and spring_free_length,
                mm, of a spring between the ends of the damper.
            loads: part, or "" -> force, N, and moment, N mm, of the ground on its wheel.
    Raises:
        DescriptionError: an unknown name, points that do not define a line, directions that are not
            perpendicular, too few rows.
    """
    return _Compiler(mechanism).model()


class _Compiler:
    """A mechanism while its rows are made."""

    def __init__(self, mechanism: Mapping[str, Any]) -> None:
        self.of = mechanism
        self.points = {name: point_of(name, value) for name, value in mechanism["points"].items()}
        bodies = mechanism["bodies"]
        one_of("the ground", bodies, CHASSIS)
        for body, names in bodies.items():
            one_of(f"a point of body {body!r}", self.points, *names)
            if not names:
                raise DescriptionError(f"body {body!r} has no points; give it at least one", body)
        self.named = {body: tuple(bodies[body]) for body in sorted(bodies, key=lambda body: body != CHASSIS)}
        self.slides: Mapping[str, Mapping[str, Any]] = mechanism.get("slides", {})
        self.rods: Mapping[str, Sequence[str]] = mechanism.get("rods", {})
        self.driven: Mapping[str, Mapping[str, Any]] = mechanism.get("inputs", {})
        self.guided = [point for slide in self.slides.values() for point in slide["points"]]
        self.joints: list[Row] = []
        self.inputs: list[Input] = []
        self.moves: dict[str, Array] = {}
        self.reported: dict[tuple[str, ...], tuple[str, str]] = {}
        self.directions = directions_of(mechanism)
        self.middle, self.size = self._extent()
        self.corners = self._corners()
        # With free points and auxiliary bodies, which are added as rows need them.
        self.bodies: dict[str, tuple[str, ...]] = {}
        self.anchors: dict[str, Array] = {}
        self.unturned: set[str] = set()

    def model(self) -> Model:
        """Make all bodies and joints, then all inputs."""
        turning = [name for name, given in self.driven.items() if "turns" in given]
        if turning:
            self._add(GROUND, ())
        for body, names in self.named.items():
            self._add(body, names)
        carriers = [CHASSIS, *(self._add(f"car turned by {name}", ()) for name in turning[1:]), GROUND]
        self.carriers = {name: (carriers[n + 1], carriers[n]) for n, name in enumerate(turning)}
        self._shared_points()
        for name in self.slides:
            self._slide(name)
        for name, ends in self.rods.items():
            self._rod(name, tuple(ends))
        for name, given in self.driven.items():
            kind = next((kind for kind in INPUTS if kind in given), "")
            one_of(f"the kind of input {name!r}", INPUTS, kind or str(list(given)))
            getattr(self, f"_{kind}")(name, given)
        self._check()
        holders: dict[str, str] = {}
        for body, names in self.bodies.items():
            for point in names:
                holders.setdefault(point, body)
        numbers, anchors = {n: k for k, n in enumerate(self.bodies)}, np.array([*self.anchors.values()])
        return Model(
            self.bodies,
            Drawing(self.points, self.middle, self.size, numbers, anchors, holders),
            tuple(self.joints),
            tuple(self.inputs),
            self.moves,
            self.corners,
            self._loads(),
            self._dampers(),
            self.reported,
            tuple(body for body in self.named if body != CHASSIS),
            frozenset(self.unturned),
        )

    def _check(self) -> None:
        if loose := sorted(set(self.points).difference(*self.bodies.values())):
            raise DescriptionError(
                f"points {loose} belong to no body; add them to one or drop them", loose[0]
            )
        rows, points = len(self.joints) + len(self.inputs), len(self.unturned)
        bodies = len(self.bodies) - 1 - points
        unknowns = 6 * bodies + 3 * points
        if not 0 < unknowns <= rows:
            raise DescriptionError(
                f"joints and inputs give {rows} rows for {unknowns} unknown velocities (6 for each of "
                f"{bodies} moving bodies, 3 for each of {points} points), so {unknowns - rows} freedoms are "
                "left over: add an input or a joint",
                "rows",
                rows,
            )

    # Reading the description

    def _direction(self, name: str, given: Mapping[str, Any]) -> Array:
        along = given.get("along", "up")
        one_of(f"`along` of input {name!r}", self.directions, along)
        return self.directions[along]

    def _corners(self) -> dict[str, Corner]:
        """Part -> its wheel, whose names begin with the part; "" -> the only wheel."""
        radius = self.of.get("wheel_radius")
        if radius is not None and not (is_number(radius) and radius > 0.0):
            raise DescriptionError(
                f"wheel_radius is {radius!r}; a length above 0 is needed, in mm", "wheel_radius", radius
            )
        side, car, roles = self.of.get("side"), car_of(self.of.get("car")), self.of.get("roles", {})
        sides = self.of.get("sides") or {"": "left" if side is None else side}
        corners = {}
        for part, side in sides.items():
            one_of(f"side of {part!r}" if part else "side", SIDES, side)
            prefix = f"{part}." if part else ""
            own = {role: tuple(roles[prefix + role]) for role in ROLES if prefix + role in roles}
            for role, ends in own.items():
                one_of(f"an end of the {prefix}{role}", self.points, *ends)
            knuckle = roles.get(f"{prefix}knuckle", "")
            if knuckle:
                one_of(f"the {prefix}knuckle", self.named, knuckle)
            elif "wheel_axis" in own:
                knuckle = next((b for b, names in self.named.items() if own["wheel_axis"][1] in names), "")
            axes = np.array([self.directions[name] for name in (side, "rearward", "up")])
            corners[part] = Corner(side, axes, own, knuckle, radius, car)
        return corners

    def _loads(self) -> dict[str, Load]:
        loads = {}
        for part, given in self.of.get("loads", {}).items():
            one_of("the part of a load", self.corners, part)
            vectors = {"force": given.get("force"), "moment": given.get("moment", NOTHING)}
            loads[part] = Load(*(vector_of(f"{n} of load {part!r}", part, of) for n, of in vectors.items()))
        return loads

    def _dampers(self) -> dict[str, Row]:
        """Rows of the dampers' lengths, if there are loads."""
        rows = {}
        for part, corner in self.corners.items() if self.of.get("loads") else ():
            if "damper" in corner.roles:
                name = f"{part}.damper" if part else "damper"
                if name in self.rods:
                    raise DescriptionError(f"a rod and a role are both called {name!r}: rename the rod", name)
                rows[part] = self._distance_row(f"rod {name}", *corner.ends("damper"))[0]
        return rows

    def _felt_by(self, *bodies: str) -> str:
        """The body on which a joint's force is reported: the knuckle, or the first moving body of the two."""
        knuckles = {corner.knuckle for corner in self.corners.values()}
        moving: list[str] = [body for body in self.named if body in bodies and body != CHASSIS]
        return next((body for body in moving if body in knuckles), moving[0])

    def _are_shared(self, points: Iterable[str]) -> bool:
        """Whether exactly two bodies have these points, so that their force is determined."""
        return all(point not in self.guided and len(self._holders(point)) == 2 for point in points)

    def _extent(self) -> tuple[Array, float]:
        """Middle and size of the drawing."""
        places = np.array(list(self.points.values()))
        middle = places.mean(axis=0)
        size, largest = float(np.linalg.norm(places - middle, axis=1).max()), float(np.abs(places).max())
        least = max(SMALLEST_SIZE, SHORTEST_AXIS * largest)
        if not size > least:
            raise DescriptionError(
                f"the points lie within {size:.3g} mm at coordinates up to {largest:.3g} mm: too few digits "
                f"are left to tell them apart; more than {least:.3g} mm are needed: draw them farther apart, "
                "or nearer to the origin",
                "points",
                size,
            )
        return middle, size

    # Bodies and lines

    def _add(self, body: str, points: tuple[str, ...]) -> str:
        """Add a body. Its origin is the point with the shortest lines to the others, which rounding would
        turn most; the middle of the drawing for the chassis and the bodies on which it turns.
        """
        places = np.array([self.points[point] for point in points]).reshape(-1, 3)
        apart = np.linalg.norm(places[:, None] - places, axis=-1)
        # Rounding does not turn a line of length zero.
        nearness = np.log(np.where(apart > 0.0, apart, 1.0)).sum(axis=1)
        self.bodies[body] = points
        self.anchors[body] = places[nearness.argmin()] if points and body != CHASSIS else self.middle
        return body

    def _holders(self, point: str) -> list[str]:
        return [body for body, names in self.bodies.items() if point in names]

    def _held(self, point: str) -> list[str]:
        """The bodies with a point; a free point becomes a body that does not turn."""
        if not self._holders(point):
            self.unturned.add(self._add(f"free point {point}", (point,)))
        return self._holders(point)

    def _other_than(self, body: str, point: str, what: str) -> str:
        others = [holder for holder in self._holders(point) if holder != body]
        if not others or (body == CHASSIS and CHASSIS in self._holders(point)):
            raise DescriptionError(
                f"{what} moves point {point!r} against body {body!r}, which holds it; name a point of "
                "another body",
                point,
            )
        return others[0]

    def _line(self, what: str, start: str, end: str) -> tuple[Array, float]:
        """Unit vector from one drawn point to another, and their distance, mm."""
        line = self.points[end] - self.points[start]
        length = float(np.linalg.norm(line))
        if not length > SHORTEST_AXIS * self.size:
            raise DescriptionError(
                f"{what}: points {start!r} and {end!r} are {length:.3g} mm apart; a line needs more than "
                f"{SHORTEST_AXIS * self.size:.3g} mm: move one of them",
                start,
                length,
            )
        return line / length, length

    # Rows

    def _row(
        self, owner: str, kind: str, first: str, second: str, along: Array, one: Array, other: Array
    ) -> Row:
        bodies = [*self.bodies]
        return Row(owner, kind, bodies.index(first), bodies.index(second), along, one, other)

    def _between(
        self, owner: str, kind: str, ends: Ends, along: Array = NOTHING, beside: Array = NOTHING
    ) -> Row:
        """A row of places in two bodies; `beside` leads from the points to the places, mm. It is added to the
        arms, because coordinates have fewer digits."""
        first, start, second, end = ends
        one, other = (
            (self.points[point] - self.anchors[body]) / self.size + beside / self.size
            for body, point in ((first, start), (second, end))
        )
        return self._row(owner, kind, first, second, along, one, other)

    def _meet(self, owner: str, ends: Ends, along: Iterable[Array] = AXES) -> None:
        """Points of two bodies meet along some directions of the first body."""
        self.joints += [self._between(owner, "offset", ends, way) for way in along]

    def _across(self, owner: str, first: str, second: str, one: Array, other: Array) -> None:
        """Directions of two bodies stay perpendicular. The reversed joint satisfies the row too, but small
        steps do not lead to it.
        """
        self.joints.append(self._row(owner, "angle", first, second, one, NOTHING, other))

    def _hinge(self, owner: str, first: str, second: str, point: str, axis: Array) -> None:
        x, y, z = frame = frame_about(axis)
        # Along the hinge's axes, so that a single row is redundant if hinges are parallel.
        self._meet(owner, (first, point, second, point), frame)
        self._across(owner, first, second, y, z)
        self._across(owner, first, second, x, z)

    def _distance_row(self, owner: str, start: str, end: str) -> tuple[Row, float]:
        """The row of the distance of points of two bodies, and their drawn distance, mm."""
        firsts, seconds = self._holders(start), self._holders(end)
        both = set(firsts) & set(seconds)
        if both or not firsts or not seconds:
            raise DescriptionError(
                f"{owner} is between {start!r} and {end!r}, which keep their distance in {sorted(both)}; "
                "two points of different bodies are needed",
                start,
            )
        length = self._line(owner, start, end)[1]
        row = self._between(owner, "distance", (firsts[0], start, seconds[0], end))
        return row._replace(drawn=length / self.size), length

    # Joints

    def _shared_points(self) -> None:
        """Hinges, and ball joints between bodies that no hinge connects yet; n - 1 joints for n bodies."""
        hinges: dict[frozenset[str], list[str]] = {}
        driven = {given.get("angle") for given in self.driven.values()}
        for first, second in combinations(self.named, 2):
            shared = [point for point in self.named[second] if point in self.named[first]]
            if len(shared) > 2:
                raise DescriptionError(
                    f"bodies {first!r} and {second!r} share the points {shared}: two shared points make a "
                    "hinge, more make the two one body; join them, or give each body separate points",
                    second,
                    shared,
                )
            members = hinges.setdefault(frozenset(shared), [first]) if len(shared) == 2 else [second]
            if second not in members:
                members.append(second)
                name = f"hinge of {second} on {members[0]}"
                self._hinge(name, members[0], second, shared[0], self._line(name, *shared)[0])
                if self._are_shared(shared) and not driven & {first, second}:
                    body = self._felt_by(first, second)
                    self.reported[tuple(p for p in self.named[body] if p in shared)] = name, body
        for point in self.points:
            apart = [[body] for body in self._holders(point)]
            for members in (members for line, members in hinges.items() if point in line):
                joined = [group for group in apart if set(group) & set(members)]
                apart = [group for group in apart if group not in joined] + [[*chain(*joined)]]
            apart.sort(key=lambda group: group[0] != CHASSIS)
            for number, group in enumerate(apart[1:], 1):
                name = f"ball joint {point}" + (f" of {group[0]}" if number > 1 else "")
                self._meet(name, (apart[0][0], point, group[0], point))
                if self._are_shared((point,)):
                    self.reported[point,] = name, self._felt_by(apart[0][0], group[0])

    def _line_of(self, slide: str) -> tuple[str, Array]:
        """A point on the line of a slide, and the line's direction."""
        through, along = self.slides[slide]["through"], self.slides[slide]["along"]
        one_of(f"the point `through` of slide {slide!r}", self.points, through)
        one_of(f"`along` of slide {slide!r}", (*self.directions, *self.points), along)
        if along in self.directions:
            return through, self.directions[along]
        return through, self._line(f"slide {slide!r}", through, along)[0]

    def _slide(self, name: str) -> None:
        """Put points on a line; with `turns` false, a body with two of them does not turn about it."""
        slide, what = self.slides[name], f"slide {name!r}"
        body, points = slide["body"], tuple(slide["points"])
        one_of(f"the body of {what}", self.named, body)
        through, along = self._line_of(name)
        one_of(f"a point of {what}", self.points, *points)
        frame = frame_about(along)
        for point in points:
            label = f"slide {name}" + (f" at {point}" if len(points) > 1 else "")
            owners = self._holders(point)
            held = self._other_than(body, point, what) if owners else self._held(point)[0]
            self._meet(label, (body, through, held, point), frame[:2])
            # The force on a point of no body is reported if a rod at an angle to the slide pulls it.
            rods = [ends for ends in self.rods.values() if point in ends]
            felt = len(owners) == 1 or (not owners and any(not {*ends} <= {*points} for ends in rods))
            if felt and slide["turns"] and self.guided.count(point) == 1:
                self.reported[point,] = label, self._felt_by(held, body) if owners else held
        if slide["turns"]:
            return
        for second, names in self.named.items():
            guided = [point for point in points if point in names]
            if second != body and len(guided) > 1:
                own = self._line(what, *guided[:2])[0]
                own = -own if float(own @ along) < 0.0 else own
                x = turned_least(f"{what} of {second}", frame, own)[0]
                self._across(f"slide {name} of {second}", body, second, frame[1], x)
                return
        raise DescriptionError(
            f"{what} has turns = false, and no two of its points {list(points)} are of one body: "
            "leave `turns` out, or put a second point of the body on the line",
            name,
        )

    def _rod(self, name: str, ends: tuple[str, ...]) -> None:
        if len(ends) != 2:
            raise DescriptionError(f"rod {name!r} has {len(ends)} points; two are needed", name, ends)
        one_of(f"an end of rod {name!r}", self.points, *ends)
        for end in ends:
            self._held(end)
        self.joints.append(self._distance_row(f"rod {name}", *ends)[0])

    # Inputs

    def _over(self, name: str, ends: Ends, way: Array, beside: Array = NOTHING, **more: Any) -> None:
        """An input that is the offset of places in two bodies along a direction."""
        drawn, per_unit = float(way @ (self.points[ends[3]] - self.points[ends[1]])), more.get("steers", 1.0)
        row = self._between(name, "offset", ends, way, beside)
        self.inputs.append(Input(row, name, per_unit / self.size, drawn / per_unit + 0.0, **more))

    def _turn(self, name: str, first: str, second: str, axis: Array, **more: Any) -> None:
        """An input that is the rotation of one body against another, from the drawing."""
        x, y, _ = frame_about(axis)
        row = self._row(name, "turn", first, second, x, NOTHING, -y)
        self.inputs.append(Input(row, name, 1.0, 0.0, **more))

    def _angle(self, name: str, given: Mapping[str, Any]) -> None:
        body, start = given["angle"], given["from"]
        one_of(f"the body of input {name!r}", self.named, body)
        one_of(f"`from` of input {name!r}", (*self.directions, "drawing"), start)
        if start == "drawing":
            on = given.get("on", CHASSIS)
            one_of(f"`on` of input {name!r}", self.named, on)
            shared = [point for point in self.named[body] if point in self.named[on]]
            if body == on or len(shared) != 2:
                raise DescriptionError(
                    f"input {name!r} turns {body!r} on {on!r}, which share the points {shared}; a hinge "
                    "of two is needed: name the body that it turns on",
                    name,
                    shared,
                )
            self._turn(name, on, body, self._line(f"input {name!r}", *shared)[0])
            return
        of, about = given["of"], given["about"]
        one_of(f"a point of input {name!r}", self.named[body], of, about)
        along, length = self._line(f"input {name!r}", about, of)
        way, factor = self.directions[start], length / self.size
        drawn = math.acos(min(max(float(way @ (self.points[of] - self.points[about])) / length, -1.0), 1.0))
        row = self._row(name, "angle", CHASSIS, body, way, NOTHING, factor * along)
        self.inputs.append(Input(row, name, factor, drawn, cosine=True))

    def _travel(self, name: str, given: Mapping[str, Any]) -> None:
        self._slides(name, given["travel"], 1.0)

    def _steers(self, name: str, given: Mapping[str, Any]) -> None:
        per_turn = self.of.get("rack_per_turn")
        if not is_number(per_turn) or not per_turn:
            raise DescriptionError(
                f"input {name!r} needs rack_per_turn, not {per_turn!r}; give the travel of the rack for a "
                "turn of the steering wheel, in mm",
                name,
                per_turn,
            )
        self._slides(name, given["steers"], per_turn / math.tau)

    def _slides(self, name: str, slides: Iterable[str], per_unit: float) -> None:
        """An input that drives slides, by `per_unit` mm per unit of its value."""
        one_of(f"a slide of input {name!r}", self.slides, *slides)
        for slide in slides:
            body, point = self.slides[slide]["body"], self.slides[slide]["points"][0]
            second, (through, way) = self._other_than(body, point, f"slide {slide!r}"), self._line_of(slide)
            self._over(name, (body, through, second, point), way, steers=per_unit)

    def _height(self, name: str, given: Mapping[str, Any]) -> None:
        point = given["height"]
        one_of(f"the point of input {name!r}", self.points, point)
        body = self._other_than(CHASSIS, point, f"input {name!r}")
        self._over(name, (CHASSIS, point, body, point), self._direction(name, given))

    def _contact(self, name: str, given: Mapping[str, Any]) -> None:
        inner, centre = given["contact"]
        one_of(f"a point of input {name!r}", self.points, inner, centre)
        carrier = next((body for body in self._holders(centre) if inner in self.bodies[body]), None)
        radius = self.of.get("wheel_radius")
        if carrier is None or radius is None:
            needed = "two points of one body" if carrier is None else "a wheel_radius above 0"
            found = [inner, centre] if carrier is None else radius
            raise DescriptionError(f"input {name!r} needs {needed}, not {found!r}", name, found)
        axis, up = self._line(f"input {name!r}", inner, centre)[0], self.directions["up"]
        level = np.cross(axis, up)
        if not np.any(level):
            raise DescriptionError(
                f"input {name!r}: {inner!r} - {centre!r} leads straight up, so the wheel has no lowest point",
                name,
            )
        level = level / np.linalg.norm(level)
        over = given.get("over", CHASSIS)
        one_of(f"`over` of input {name!r}", (CHASSIS, "ground"), over)
        on_ground = over == "ground"
        base = next(iter(self.bodies)) if on_ground else CHASSIS
        disc = self._add(f"disc of {name}", (inner, centre))
        self._hinge(f"axle of {name}", carrier, disc, inner, axis)
        self._across(f"level of {name}", base, disc, up, level)
        down = -radius * np.cross(level, axis)
        self._over(name, (base, centre, disc, centre), up, beside=down, over_ground=on_ground)

    def _distance(self, name: str, given: Mapping[str, Any]) -> None:
        one_of(f"a point of input {name!r}", self.points, *given["distance"])
        row, length = self._distance_row(f"input {name!r}", *given["distance"])
        self.inputs.append(Input(row, name, 1.0 / self.size, length))

    def _turns(self, name: str, given: Mapping[str, Any]) -> None:
        one_of(f"the point of input {name!r}", self.points, given["about"])
        axis, (ground, car) = self._direction(name, given), self.carriers[name]
        self._hinge(f"line of {name}", ground, car, given["about"], axis)
        rolls = given["along"] in ("forward", "rearward")
        self._turn(name, ground, car, axis, turns=True, rolls=rolls)

    def _moves(self, name: str, given: Mapping[str, Any]) -> None:
        self.moves[name] = self._direction(name, given)


def frame_about(z: Array) -> Array:
    """Right-handed unit axes x, y, z as rows, with z given."""
    x = cross(AXES[int(np.argmin(np.abs(z)))], z)
    x = x / np.linalg.norm(x)
    return np.array([x, cross(z, x), z])


def turned_least(what: str, frame: Array, z: Array) -> Array:
    """Axes x, y, z as rows after the smallest rotation that brings their z to the given direction."""
    cosine = float(frame[2] @ z)
    if cosine <= 0:
        raise DescriptionError(
            f"{what}: its two lines are drawn {np.degrees(np.arccos(max(cosine, -1.0))):.1f} degrees apart; "
            "they become one line of the same sense, so less than 90 degrees is needed: swap the points of "
            "one line or correct the drawing",
            what,
            cosine,
        )
    axis = cross(frame[2], z)
    return np.asarray(frame + cross(axis, frame) + cross(axis, cross(axis, frame)) / (1.0 + cosine))
