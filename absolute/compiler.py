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

from absolute.description import corners_of, directions_of, is_number, loads_of, one_of, point_of
from absolute.errors import DescriptionError
from absolute.model import CHASSIS, Input, Model, Row
from absolute.vectors import EPS, Array, cross

# Squares of the lengths of a larger drawing, mm, are normal.
SMALLEST_SIZE = 1e-100
# In units of size: coordinates of two nearer points agree in half of their digits, so that the line between
# them has only the other half.
SHORTEST_AXIS = math.sqrt(EPS)
INPUTS = ("angle", "travel", "steers", "height", "contact", "distance", "turns", "moves")
# The body on which the car turns; no other body has an empty name.
GROUND = ""
NOTHING, AXES = np.zeros(3), np.eye(3)
# A body, and a point or a vector of it.
End = tuple[str, str | Array]


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
        self.corners = corners_of(mechanism, self.points, self.named, self.directions)
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
            self._input(name, given)
        self._check()
        numbers, anchors = {body: n for n, body in enumerate(self.bodies)}, [*self.anchors.values()]
        holders = {point: numbers[self._holders(point)[0]] for point in self.points}
        return Model(
            points=self.points,
            middle=self.middle,
            size=self.size,
            bodies=self.bodies,
            origins=(np.array(anchors) - self.middle) / self.size,
            holders=holders,
            arms={point: (self.points[point] - anchors[n]) / self.size for point, n in holders.items()},
            joints=tuple(self.joints),
            inputs=tuple(self.inputs),
            moves=self.moves,
            corners=self.corners,
            loads=loads_of(self.of.get("loads", {}), self.corners),
            dampers=self._dampers(),
            reported_joints=self.reported,
            reported=tuple(body for body in self.named if body != CHASSIS),
            unturned=frozenset(self.unturned),
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

    def _direction(self, what: str, given: Mapping[str, Any]) -> Array:
        along = given.get("along", "up")
        one_of(f"`along` of {what}", self.directions, along)
        return self.directions[along]

    def _dampers(self) -> dict[str, Row]:
        """Rows of the dampers' lengths, if there are loads."""
        rows = {}
        for part, corner in self.corners.items() if self.of.get("loads") else ():
            if "damper" in corner.given:
                name = f"{part}.damper" if part else "damper"
                if name in self.rods:
                    raise DescriptionError(f"a rod and a role are both called {name!r}: rename the rod", name)
                rows[part] = self._distance_row(f"rod {name}", *corner.need("damper"))[0]
        return rows

    def _felt_by(self, *bodies: str) -> str:
        """The body on which a joint's force is reported: the knuckle, or the first moving body of the two."""
        knuckles = {corner.given.get("knuckle") for corner in self.corners.values()}
        moving: list[str] = [body for body in self.named if body in bodies and body != CHASSIS]
        return next((body for body in moving if body in knuckles), moving[0])

    def _report(self, joint: str, first: str, second: str, *points: str) -> None:
        """Report the force of a ball joint or a hinge, which is determined if only two bodies share it."""
        if all(point not in self.guided and len(self._holders(point)) == 2 for point in points):
            body = self._felt_by(first, second)
            self.reported[tuple(point for point in self.named[body] if point in points)] = joint, body

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

    def _arm(self, body: str, point: str) -> Array:
        """Vector from the origin of a body to a point, in units of size."""
        return np.asarray((self.points[point] - self.anchors[body]) / self.size)

    def _row(self, owner: str, kind: str, first: End, second: End, along: Array = NOTHING) -> Row:
        """A row of points or vectors of two bodies."""
        (one, r1), (other, r2) = (
            ([*self.bodies].index(body), self._arm(body, of) if isinstance(of, str) else of)
            for body, of in (first, second)
        )
        return Row(owner, kind, one, other, along, r1, r2)

    def _meet(self, owner: str, first: End, second: End, along: Iterable[Array] = AXES) -> None:
        """Points of two bodies meet along some directions of the first body."""
        self.joints += [self._row(owner, "offset", first, second, way) for way in along]

    def _across(self, owner: str, first: str, second: str, one: Array, other: Array) -> None:
        """Directions of two bodies stay perpendicular. The reversed joint satisfies the row too, but small
        steps do not lead to it.
        """
        self.joints.append(self._row(owner, "angle", (first, NOTHING), (second, other), one))

    def _hinge(self, owner: str, first: str, second: str, point: str, axis: Array) -> None:
        x, y, z = frame = frame_about(axis)
        # Along the hinge's axes, so that a single row is redundant if hinges are parallel.
        self._meet(owner, (first, point), (second, point), frame)
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
        row = self._row(owner, "distance", (firsts[0], start), (seconds[0], end))
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
                if not driven & {first, second}:
                    self._report(name, first, second, *shared)
        for point in self.points:
            apart = [[body] for body in self._holders(point)]
            for members in (members for line, members in hinges.items() if point in line):
                joined = [group for group in apart if set(group) & set(members)]
                apart = [group for group in apart if group not in joined] + [[*chain(*joined)]]
            apart.sort(key=lambda group: group[0] != CHASSIS)
            for number, group in enumerate(apart[1:], 1):
                name = f"ball joint {point}" + (f" of {group[0]}" if number > 1 else "")
                self._meet(name, (apart[0][0], point), (group[0], point))
                self._report(name, apart[0][0], group[0], point)

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
            self._meet(label, (body, through), (held, point), frame[:2])
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

    def _input(self, name: str, given: Mapping[str, Any]) -> None:
        what = f"input {name!r}"
        match given:
            case {"angle": body}:
                self._angle(name, body, given)
            case {"travel": slides}:
                self._slides(name, slides, 1.0)
            case {"steers": slides}:
                self._slides(name, slides, self._travel_per_radian(name))
            case {"height": point}:
                one_of(f"the point of {what}", self.points, point)
                body = self._other_than(CHASSIS, point, what)
                way = self._direction(what, given)
                row = self._row(name, "offset", (CHASSIS, point), (body, point), way)
                self.inputs.append(Input(row, name, 1.0 / self.size, 0.0))
            case {"contact": ends}:
                self._contact(name, ends, given)
            case {"distance": ends}:
                one_of(f"a point of {what}", self.points, *ends)
                row, length = self._distance_row(what, *ends)
                self.inputs.append(Input(row, name, 1.0 / self.size, length))
            case {"turns": _, "about": point}:
                one_of(f"the point of {what}", self.points, point)
                axis, (on, car) = self._direction(what, given), self.carriers[name]
                self._hinge(f"line of {name}", on, car, point, axis)
                self._turn(name, on, car, axis, turns=given.get("along", "up"))
            case {"moves": _}:
                self.moves[name] = self._direction(what, given)
            case _:
                one_of(f"the kind of {what}", INPUTS, str(list(given)))

    def _turn(self, name: str, first: str, second: str, axis: Array, turns: str = "") -> None:
        """An input that is the rotation of one body against another, from the drawing."""
        x, y, _ = frame_about(axis)
        row = self._row(name, "turn", (first, NOTHING), (second, -y), x)
        self.inputs.append(Input(row, name, 1.0, 0.0, turns=turns))

    def _angle(self, name: str, body: str, given: Mapping[str, Any]) -> None:
        start = given["from"]
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
        row = self._row(name, "angle", (CHASSIS, NOTHING), (body, factor * along), way)
        self.inputs.append(Input(row, name, factor, drawn))

    def _travel_per_radian(self, name: str) -> float:
        """Travel of the rack per radian of the steering wheel, mm."""
        per_turn = self.of.get("rack_per_turn")
        if not is_number(per_turn) or not per_turn:
            raise DescriptionError(
                f"input {name!r} needs rack_per_turn, not {per_turn!r}; give the travel of the rack for a "
                "turn of the steering wheel, in mm",
                name,
                per_turn,
            )
        return float(per_turn) / math.tau

    def _slides(self, name: str, slides: Iterable[str], per_unit: float) -> None:
        """An input that drives slides, by `per_unit` mm per unit of its value."""
        one_of(f"a slide of input {name!r}", self.slides, *slides)
        for slide in slides:
            body, point = self.slides[slide]["body"], self.slides[slide]["points"][0]
            second, (through, way) = self._other_than(body, point, f"slide {slide!r}"), self._line_of(slide)
            row = self._row(name, "offset", (body, through), (second, point), way)
            drawn = float(way @ (self.points[point] - self.points[through])) / per_unit + 0.0
            self.inputs.append(Input(row, name, per_unit / self.size, drawn, steers=per_unit))

    def _contact(self, name: str, ends: Sequence[str], given: Mapping[str, Any]) -> None:
        inner, centre = ends
        one_of(f"a point of input {name!r}", self.points, *ends)
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
        # Added to the arms, because coordinates have fewer digits.
        down = -radius * np.cross(level, axis) / self.size
        drawn, lowest = ((body, self._arm(body, centre) + down) for body in (base, disc))
        row = self._row(name, "offset", drawn, lowest, up)
        self.inputs.append(Input(row, name, 1.0 / self.size, 0.0, over_ground=on_ground))


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
