"""A mechanism as plain data becomes a linkage: bodies, joints and inputs.

    one point of two bodies    a ball joint          rod     a distance
    two points of two bodies   a hinge               slide   a point on a line of a body

A free point, of no body, is a body of its own that does not turn against the one in which it slides, or
against the chassis. A wheel's contact point is the lowest one of a disc that turns about the wheel's axis and
has a level radius: its height is that of a point of a body.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from absolute.car import car_of
from absolute.description import Axis, Corner, Input, Joint, Load, Model, Vector
from absolute.errors import DescriptionError
from absolute.solution import Array

CHASSIS = "chassis"
# The product of three vectors between such points, mm^3, is far from the end of the floating-point range.
LARGEST_COORDINATE = 1e100
# `up` and `right` are axes of one car. 1e-6 rad lets rounded directions pass and stops wrong ones.
LARGEST_SKEW = 1e-6
# Which of these directions is outboard.
SIDES = ("left", "right")
# Pairs of points that effects ask for.
ROLES = ("wheel_axis", "steering_axis", "damper")


def compile(mechanism: Mapping[str, Any]) -> Model:
    """The linkage of a mechanism.

    Args:
        mechanism: plain data, mm and rad:
            bodies: name -> names of its points; `chassis` is one of them. rods: name -> two points.
            slides: name -> points, body, through, along, turns.
            inputs: those that are driven, name -> one of angle, travel, height, contact, distance; or
                turns, which turn the whole car. What displaces it is no part of the linkage.
            roles: knuckle, a body; wheel_axis, steering_axis and damper, two points each, if there are any.
            points: name -> (x, y, z). up, right: directions, at any length. side: "left" or "right".
            sides: of a mechanism with parts, part -> side; names of its roles and inputs begin with the part
                and a dot.
            wheel_radius: of the wheel, mm, or None where nothing needs it.
            loads: part, or "" -> force, N, and moment, N mm, of the ground on its wheel, where there are any.
            car: axle, wheelbase, centre_of_gravity_height, brake_share and drive_share, as far as given.
    Raises:
        DescriptionError: a name that does not exist, points that make no line, directions at no right angle,
            too few rows.
    """
    return _Compiler(mechanism).model()


class _Compiler:
    """A mechanism whose joints are being made."""

    def __init__(self, mechanism: Mapping[str, Any]) -> None:
        self.of = mechanism
        self.points = {name: point_of(name, value) for name, value in mechanism["points"].items()}
        bodies = mechanism["bodies"]
        _one_of("the ground", bodies, CHASSIS)
        order = sorted(bodies, key=lambda body: body != CHASSIS)
        self.bodies = {body: tuple(bodies[body]) for body in order}
        for body, names in self.bodies.items():
            _one_of(f"a point of body {body!r}", self.points, *names)
        self.rods = {name: tuple(ends) for name, ends in mechanism.get("rods", {}).items()}
        self.slides: Mapping[str, Mapping[str, Any]] = mechanism.get("slides", {})
        self.joints: dict[str, Joint] = {}
        self.inputs: dict[str, Input] = {}
        self.turns: dict[str, Axis] = {}
        self.aids: set[str] = set()
        self.directions = self._directions()
        self.radius = self._radius()
        self.corners = self._corners()

    def model(self) -> Model:
        """All joints, then all inputs."""
        self._shared_points()
        for name, slide in self.slides.items():
            self._slide(name, slide)
        for name, ends in self.rods.items():
            self._rod(name, ends)
        drive = {
            "angle": self._angle,
            "travel": self._travel,
            "height": self._height,
            "contact": self._contact,
            "distance": self._distance,
        }
        for name, given in self.of.get("inputs", {}).items():
            if "turns" in given:
                _one_of(f"the point of input {name!r}", self.points, given["about"])
                _one_of(f"`along` of input {name!r}", self.directions, given["along"])
                self.turns[name] = Axis(given["about"], self.directions[given["along"]])
            elif "moves" not in given:
                kind = next((kind for kind in drive if kind in given), "")
                _one_of(f"the kind of input {name!r}", drive, kind or str(list(given)))
                drive[kind](name, given)
        self._check()
        return Model(
            self.points,
            CHASSIS,
            self.bodies,
            self.joints,
            self.inputs,
            self.corners,
            self._loads(),
            self._ball_joints(),
            frozenset(self.aids),
            self.turns,
        )

    def _check(self) -> None:
        for body, names in self.bodies.items():
            if not names:
                raise DescriptionError(f"body {body!r} has no points; give it at least one", body)
        if loose := sorted(set(self.points).difference(*self.bodies.values())):
            raise DescriptionError(
                f"points {loose} belong to no body; add them to one or drop them", loose[0]
            )
        rows = sum(joint.rows for joint in self.joints.values()) + len(self.inputs)
        unknowns = 6 * (len(self.bodies) - 1)
        if not 0 < unknowns <= rows:
            raise DescriptionError(
                f"joints and inputs give {rows} rows for {unknowns} unknown velocities (6 for each of "
                f"{len(self.bodies) - 1} moving bodies), so {unknowns - rows} freedoms are left over: "
                "add an input or a joint",
                "rows",
                rows,
            )

    def _directions(self) -> dict[str, Vector]:
        up, right = (unit_of(name, vector_of(name, name, self.of[name])) for name in ("up", "right"))
        skew = float(up @ right)
        if abs(skew) > LARGEST_SKEW:
            raise DescriptionError(
                f"up and right are {np.degrees(np.arccos(skew)):.6g} degrees apart; a right angle is needed",
                "right",
                skew,
            )
        directions = {"up": up, "right": right, "forward": np.cross(up, right)}
        opposite = {"down": -up, "left": -right, "rearward": np.cross(right, up)}
        return {name: plain(direction) for name, direction in (directions | opposite).items()}

    def _corners(self) -> dict[str, Corner]:
        """The wheel of each part, whose names have its own in front; or the only one."""
        side, car = self.of.get("side"), car_of(self.of.get("car"))
        sides = self.of.get("sides") or {"": "left" if side is None else side}
        roles, rearward, up = self.of.get("roles", {}), self.directions["rearward"], self.directions["up"]
        corners = {}
        for part, side in sides.items():
            _one_of(f"side of {part!r}" if part else "side", SIDES, side)
            prefix = f"{part}." if part else ""
            own = {role: tuple(roles[prefix + role]) for role in ROLES if prefix + role in roles}
            for role, ends in own.items():
                _one_of(f"an end of the {prefix}{role}", self.points, *ends)
            knuckle = roles.get(f"{prefix}knuckle", "")
            if knuckle:
                _one_of(f"the {prefix}knuckle", self.bodies, knuckle)
            elif "wheel_axis" in own:
                knuckle = next(iter(self._holders(own["wheel_axis"][1])), "")
            corners[part] = Corner(side, self.directions[side], rearward, up, own, knuckle, self.radius, car)
        return corners

    def _loads(self) -> dict[str, Load]:
        loads = {}
        for part, given in self.of.get("loads", {}).items():
            _one_of("the part of a load", self.corners, part)
            vectors = (given["force"], given.get("moment", (0.0, 0.0, 0.0)))
            names = (f"{what} of load {part!r}" for what in ("force", "moment"))
            loads[part] = Load(*(vector_of(n, part, of) for n, of in zip(names, vectors, strict=True)))
        return loads

    def _ball_joints(self) -> dict[str, str]:
        """Points of ball joints whose force is determined, and the body on which it is given: the knuckle, or
        the first that moves."""
        bodies = {body: names for body, names in self.bodies.items() if body not in self.aids}
        sliding = {point for slide in self.slides.values() for point in slide["points"]}
        knuckles = {corner.knuckle for corner in self.corners.values()}
        reported = {}
        for point in self.of["points"]:
            held = [body for body in bodies if point in bodies[body]]
            if (
                len(held) == 2
                and point not in sliding
                and len(set(bodies[held[0]]) & set(bodies[held[1]])) == 1
            ):
                moving = [body for body in held if body != CHASSIS]
                reported[point] = next((body for body in moving if body in knuckles), moving[0])
        return reported

    def _radius(self) -> float | None:
        radius = self.of.get("wheel_radius")
        if radius is not None and not (isinstance(radius, int | float) and 0.0 < radius < math.inf):
            raise DescriptionError(
                f"wheel_radius is {radius!r}; a length above 0 is needed, in mm", "wheel_radius", radius
            )
        return radius

    def _shared_points(self) -> None:
        """Hinges, and ball joints of what these do not hold together; n - 1 for n bodies."""
        hinges: dict[frozenset[str], list[str]] = {}
        for first, second in combinations(self.bodies, 2):
            shared = [point for point in self.bodies[second] if point in self.bodies[first]]
            if len(shared) > 2:
                raise DescriptionError(
                    f"bodies {first!r} and {second!r} share the points {shared}: two make a hinge, "
                    "and more make the two one body; make them one, or give each points of its own",
                    second,
                    shared,
                )
            if len(shared) == 2:
                members = hinges.setdefault(frozenset(shared), [first])
                if second not in members:
                    members.append(second)
                    self._line(*shared)
                    axis = Axis(*shared)
                    self.joints[f"hinge of {second} on {members[0]}"] = Joint(
                        "revolute", members[0], second, axis, axis
                    )
        for point in self.points:
            apart = [[body] for body in self._holders(point)]
            for line, members in hinges.items():
                if point in line:
                    joined = [group for group in apart if set(group) & set(members)]
                    apart = [group for group in apart if group not in joined] + [
                        [body for group in joined for body in group]
                    ]
            apart.sort(key=lambda group: group[0] != CHASSIS)
            for number, group in enumerate(apart[1:], 1):
                name = f"ball joint {point}" + (f" of {group[0]}" if number > 1 else "")
                self.joints[name] = Joint("spherical", apart[0][0], group[0], Axis(point), Axis(point))

    def _slide(self, name: str, slide: Mapping[str, Any]) -> None:
        what, body, points = f"slide {name!r}", slide["body"], tuple(slide["points"])
        _one_of(f"the body of {what}", self.bodies, body)
        line, along = self._line_of(name)
        _one_of(f"a point of {what}", self.points, *points)
        for point in points:
            label = f"slide {name}" + (f" at {point}" if len(points) > 1 else "")
            held = self._holders(point)
            if held:
                second = self._other_than(body, point, what)
                kind = "on_line"
            else:
                second, kind = self._free(point), "prismatic"
            self.joints[label] = Joint(kind, body, second, line, Axis(point, along))
        if slide["turns"]:
            return
        for second, names in self.bodies.items():
            guided = [point for point in points if point in names]
            if second != body and len(guided) > 1:
                start, end = guided[:2]
                if float(self._line(start, end) @ np.array(along)) < 0.0:
                    start, end = end, start
                self.joints[f"slide {name} of {second}"] = Joint("key", body, second, line, Axis(start, end))
                return
        raise DescriptionError(
            f"{what} has turns = false, and no two of its points {list(points)} are of one body: "
            "leave `turns` out, or put a second point of the body on the line",
            name,
        )

    def _line_of(self, slide: str) -> tuple[Axis, Vector]:
        """The line of a slide and its direction."""
        through, along = self.slides[slide]["through"], self.slides[slide]["along"]
        _one_of(f"the point `through` of slide {slide!r}", self.points, through)
        _one_of(f"`along` of slide {slide!r}", (*self.directions, *self.points), along)
        if along in self.directions:
            return Axis(through, self.directions[along]), self.directions[along]
        return Axis(through, along), plain(self._line(through, along))

    def _rod(self, name: str, ends: Sequence[str]) -> None:
        if len(ends) != 2:
            raise DescriptionError(f"rod {name!r} has {len(ends)} points; two are needed", name, ends)
        _one_of(f"an end of rod {name!r}", self.points, *ends)
        for end in ends:
            if not self._holders(end):
                body = self._free(end)
                self.joints[f"free point {end}"] = Joint(
                    "parallel", CHASSIS, body, Axis(self.bodies[CHASSIS][0]), Axis(end)
                )
        self._line(*ends)
        first, second = self._two_bodies(f"rod {name!r}", *ends)
        self.joints[f"rod {name}"] = Joint("distance", first, second, Axis(ends[0]), Axis(ends[1]))

    def _angle(self, name: str, given: Mapping[str, Any]) -> None:
        body, start = given["angle"], given["from"]
        _one_of(f"the body of input {name!r}", self.bodies, body)
        _one_of(f"`from` of input {name!r}", (*self.directions, "drawing"), start)
        if start == "drawing":
            on = given.get("on", CHASSIS)
            _one_of(f"`on` of input {name!r}", self.bodies, on)
            shared = [point for point in self.bodies[body] if point in self.bodies[on]]
            if body == on or len(shared) != 2:
                raise DescriptionError(
                    f"input {name!r} turns {body!r} on {on!r}, which share the points {shared}; a hinge "
                    "of two is needed: name the body that it turns on",
                    name,
                    shared,
                )
            self.inputs[name] = Input(on, Axis(*shared), body, shared[0], "turn", 1.0, name)
            return
        of, about = given["of"], given["about"]
        _one_of(f"a point of input {name!r}", self.bodies[body], of, about)
        self._line(about, of)
        # Without the squares of a norm, which are zero for the smallest numbers.
        length = math.hypot(*(np.subtract(self.points[of], self.points[about])).tolist())
        ground = CHASSIS
        if about not in self.bodies[CHASSIS]:
            # The direction is the car's: a body that goes with the point and does not turn has it.
            ground = self._aid(f"{about} in the axes of the car", (about,))
            at = Axis(about)
            self.joints[f"place of {ground}"] = Joint("spherical", body, ground, at, at)
            self.joints[f"axes of {ground}"] = Joint(
                "parallel", CHASSIS, ground, Axis(self.bodies[CHASSIS][0]), at
            )
        axis = Axis(about, self.directions[start])
        self.inputs[name] = Input(ground, axis, body, of, "cosine", length, name)

    def _travel(self, name: str, given: Mapping[str, Any]) -> None:
        slides = given["travel"]
        _one_of(f"a slide of input {name!r}", self.slides, *slides)
        for slide in slides:
            body, point = self.slides[slide]["body"], self.slides[slide]["points"][0]
            second = self._other_than(body, point, f"slide {slide!r}")
            own = name if len(slides) == 1 else f"{name} of {slide}"
            line = self._line_of(slide)[0]
            self.inputs[own] = Input(body, line, second, point, "linear", 1.0, name, steers=True)

    def _height(self, name: str, given: Mapping[str, Any]) -> None:
        point, along = given["height"], given.get("along", "up")
        _one_of(f"the point of input {name!r}", self.points, point)
        _one_of(f"`along` of input {name!r}", self.directions, along)
        body = self._other_than(CHASSIS, point, f"input {name!r}")
        self._over_drawn(name, body, point, along)

    def _over_drawn(self, name: str, body: str, point: str, along: str) -> None:
        drawn = self._aid_point(f"{point} as drawn by {name}", self.points[point], CHASSIS)
        axis = Axis(drawn, self.directions[along])
        self.inputs[name] = Input(CHASSIS, axis, body, point, "linear", 1.0, name)

    def _contact(self, name: str, given: Mapping[str, Any]) -> None:
        inner, centre = given["contact"]
        _one_of(f"a point of input {name!r}", self.points, inner, centre)
        carrier = next((body for body in self._holders(centre) if inner in self.bodies[body]), None)
        radius = self.radius
        if carrier is None or radius is None:
            needed = "two points of one body" if carrier is None else "a wheel_radius above 0"
            found = [inner, centre] if carrier is None else radius
            raise DescriptionError(f"input {name!r} needs {needed}, not {found!r}", name, found)
        axis, up = self._line(inner, centre), np.array(self.directions["up"])
        level = np.cross(axis, up)
        if not np.any(level):
            raise DescriptionError(
                f"input {name!r}: {inner!r} - {centre!r} leads straight up, so the wheel has no lowest point",
                name,
            )
        level = level / np.linalg.norm(level)
        lowest = np.array(self.points[centre]) - radius * np.cross(level, axis)
        disc = self._aid(f"disc of {name}", (inner, centre))
        point = self._aid_point(f"contact of {name}", plain(lowest), disc)
        line = Axis(inner, centre)
        self.joints[f"axle of {name}"] = Joint("revolute", carrier, disc, line, line)
        self.joints[f"level of {name}"] = Joint(
            "level",
            CHASSIS,
            disc,
            Axis(self.bodies[CHASSIS][0], self.directions["up"]),
            Axis(centre, plain(level)),
        )
        self._over_drawn(name, disc, point, "up")

    def _distance(self, name: str, given: Mapping[str, Any]) -> None:
        ends = given["distance"]
        _one_of(f"a point of input {name!r}", self.points, *ends)
        self._line(*ends)
        first, second = self._two_bodies(f"input {name!r}", *ends)
        self.inputs[name] = Input(first, Axis(ends[0]), second, ends[1], "distance", 1.0, name)

    def _holders(self, point: str) -> list[str]:
        return [body for body, names in self.bodies.items() if point in names]

    def _other_than(self, body: str, point: str, what: str) -> str:
        others = [holder for holder in self._holders(point) if holder != body]
        if not others or (body == CHASSIS and CHASSIS in self._holders(point)):
            raise DescriptionError(
                f"{what} moves point {point!r} against body {body!r}, which holds it; name a point of "
                "another body",
                point,
            )
        return others[0]

    def _two_bodies(self, what: str, start: str, end: str) -> tuple[str, str]:
        """Bodies that hold one of two points each."""
        firsts, seconds = self._holders(start), self._holders(end)
        both = set(firsts) & set(seconds)
        if both or not firsts or not seconds:
            raise DescriptionError(
                f"{what} is between {start!r} and {end!r}, which keep their distance in {sorted(both)}; "
                "two points of different bodies are needed",
                start,
            )
        return firsts[0], seconds[0]

    def _free(self, point: str) -> str:
        return self._aid(f"free point {point}", (point,))

    def _aid(self, body: str, points: tuple[str, ...]) -> str:
        self.bodies[body] = points
        self.aids.add(body)
        return body

    def _aid_point(self, name: str, place: Vector, body: str) -> str:
        self.points[name] = place
        self.bodies[body] = (*self.bodies[body], name)
        self.aids.add(name)
        return name

    def _line(self, start: str, end: str) -> Array:
        """Unit vector from one drawn point to another."""
        where = self.points[start]
        line = np.subtract(self.points[end], where)
        if not np.any(line):
            raise DescriptionError(
                f"points {start!r} and {end!r} coincide at {where}; move one of them", start, where
            )
        return unit_of(start, plain(line))


def _one_of(what: str, allowed: Iterable[str], *values: object) -> None:
    names = list(allowed)
    for value in values:
        if value not in names:
            raise DescriptionError(f"{what} is {value!r}; it must be one of {names}", str(value), value)


def vector_of(what: str, name: str, value: object) -> Vector:
    """Three finite floats, or a DescriptionError that says what is wrong with `what`."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise DescriptionError(f"{what} is {value!r}; three finite numbers are needed", name, value)
    return plain(array)


def point_of(name: str, value: object) -> Vector:
    """Coordinates of a point, mm, or a DescriptionError that says what is wrong with them."""
    point = vector_of(f"point {name!r}", name, value)
    if max(map(abs, point)) > LARGEST_COORDINATE:
        raise DescriptionError(
            f"point {name!r} is {point}; products of such coordinates overflow: correct it or use a larger "
            f"unit of length, so that all are below {LARGEST_COORDINATE:g} mm",
            name,
            point,
        )
    return point


def unit_of(name: str, vector: Vector) -> Array:
    """The direction of a vector, or a DescriptionError where it is zero."""
    array = np.array(vector)
    largest = float(np.abs(array).max())
    if largest == 0:
        raise DescriptionError(f"{name} is {vector}; a direction must not be zero", name, vector)
    # Scaled before the norm: squares of the smallest and largest numbers are lost.
    array = array / largest
    return np.asarray(array / np.linalg.norm(array))


def plain(vector: Array) -> Vector:
    """Three numbers."""
    return (float(vector[0]), float(vector[1]), float(vector[2]))
