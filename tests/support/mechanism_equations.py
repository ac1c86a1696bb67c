"""Any mechanism as quadratic equations: the witness of the tests, written apart from the packages.

The unknowns y are the place and the nine entries of the rotation matrix of each body, free points, places on
lines, and the cosine and sine of the lean of each wheel whose contact point is driven. Every row is

    U_i(y) . V_i(y) + W_i(y) = f_i(w),     U, V, W affine in y,

so its Jacobian is affine in y. Rows that say something twice are kept: a pose has to meet all of them, and
Gauss and Newton's method converges to such a pose as fast as Newton's does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from mpmath import cos, mp, mpf, sin, sqrt
from numpy.typing import NDArray

Array = NDArray[Any]
Law = tuple[Callable[[Any], Any], Callable[[Any], Any], Callable[[Any], Any]]
DIGITS = 45
# The smallest singular value at which a pose counts as singular; lengths are parts of the mechanism's size.
SINGULAR = 1e-5


def vector(values: Sequence[Any]) -> Array:
    """Numbers of many digits."""
    return np.array([mpf(value) for value in values], dtype=object)


def unit(v: Array) -> Array:
    """A vector's direction."""
    return v / sqrt(v @ v)


def with_the_ground(m: Mapping[str, Any]) -> dict[str, Any]:
    """The mechanism with a body that stands to the chassis as the ground does.

    The chassis is turned and then displaced as the ground sees it. The same joints lead back from the
    chassis, the first one first, with their lines reversed: each has the value of its input.
    """
    up, right = np.array(m["up"]), np.array(m["right"])
    axes = {"up": up, "right": right, "forward": np.cross(up, right)}
    axes |= {"down": -up, "left": -right, "rearward": -axes["forward"]}
    bodies, points = (
        {b: list(ps) for b, ps in m["bodies"].items()},
        {n: list(p) for n, p in m["points"].items()},
    )
    slides, inputs, ground = dict(m["slides"]), dict(m["inputs"]), "chassis"
    moving = [(n, d) for key in ("turns", "moves") for n, d in m["inputs"].items() if key in d]
    for name, drive in moving:
        before, ground, way = ground, f"ground by {name}", axes[drive["along"]]
        ends = [f"{ground} {k}" for k in range(2)]
        start = np.array(points[drive.get("about", bodies["chassis"][0])])
        points |= {end: (start - 100 * k * way).tolist() for k, end in enumerate(ends)}
        bodies[ground] = ends
        if "turns" in drive:
            bodies[before] = [*bodies[before], *ends]
            inputs[name] = {"angle": ground, "from": "drawing", "on": before}
            continue
        through = [f"{end} before" for end in ends]
        points |= {end: points[other] for end, other in zip(through, ends, strict=True)}
        bodies[before] = [*bodies[before], *through]
        line = {"body": before, "through": through[0], "along": through[1]}
        slides[f"slide of {ground}"] = {"points": ends, "turns": False, **line}
        inputs[name] = {"travel": [f"slide of {ground}"]}
    return {**m, "bodies": bodies, "points": points, "slides": slides, "inputs": inputs, "ground": ground}


def beside(axis: Array) -> Array:
    """A unit vector across a unit vector."""
    other = vector(np.eye(3)[np.argmin(np.abs(axis.astype(float)))])
    return unit(other - (other @ axis) * axis)


class Equations:
    """The equations of a mechanism in plain data; lengths are measured from a point of it, in its size."""

    def __init__(self, mechanism: Mapping[str, Any]) -> None:
        self.named = tuple(mechanism["points"])
        with mp.workdps(DIGITS):
            self._build(mechanism)

    def _build(self, m: Mapping[str, Any]) -> None:
        if any(drive.get("over") == "ground" for drive in m["inputs"].values()):
            m = with_the_ground(m)
        self.ground = m.get("ground", "chassis")
        up, right = vector(m["up"]), vector(m["right"])
        self.axes = {"up": up, "right": right, "down": -up, "left": -right}
        self.axes |= {"forward": np.cross(up, right), "rearward": np.cross(right, up)}
        places = {name: vector(place) for name, place in m["points"].items()}
        self.origin = next(iter(places.values()))
        self.unit = max(abs(c) for place in places.values() for c in place - self.origin)
        self.drawn = {name: (place - self.origin) / self.unit for name, place in places.items()}
        self._lines = {name: self._line(slide) for name, slide in m["slides"].items()}
        self.holders = {p: [body for body, ps in m["bodies"].items() if p in ps] for p in self.drawn}
        self.bodies, self.inputs = m["bodies"], m["inputs"]
        self._unknowns(m)
        # One row: U and V, each (3, unknowns + 1), W, (unknowns + 1,), and the law of its input.
        self._rows: list[tuple[Array, Array, Array, str, Law]] = []
        self._constrain(m)
        self._constraints, self.at_drawing = len(self._rows), {}
        for name, drive in self.inputs.items():
            if not {"moves", "turns"} & drive.keys():
                self.at_drawing[name] = self._drive(name, drive, m["wheel_radius"])
        exact = [np.stack([row[k] for row in self._rows]) for k in range(3)]
        self._exact = [(part, np.nonzero(part)) for part in exact]
        self._rounded = [part.astype(float) for part in exact]

    # Unknowns, and what is affine in them: arrays whose last axis has the coefficients and the constant.

    def _line(self, slide: Mapping[str, Any]) -> Array:
        along = slide["along"]
        start = self.drawn[slide["through"]]
        return self.axes[along] if along in self.axes else unit(self.drawn[along] - start)

    def _unknowns(self, m: Mapping[str, Any]) -> None:
        drawn, values, self._at = self.drawn, [], {}

        def add(key: Any, start: Sequence[Any]) -> None:
            self._at[key] = len(values)
            values.extend(start)

        for body, points in self.bodies.items():
            if body != "chassis":
                add(body, [*drawn[points[0]], *vector(np.eye(3).ravel())])
        for point, holders in self.holders.items():
            if not holders:
                add(point, drawn[point])
        for name, slide in m["slides"].items():
            for point in slide["points"]:
                add((name, point), [(drawn[point] - drawn[slide["through"]]) @ self._lines[name]])
        for drive in self.inputs.values():
            if "contact" in drive:
                lean = unit(drawn[drive["contact"][1]] - drawn[drive["contact"][0]]) @ self.axes["up"]
                add(tuple(drive["contact"]), [sqrt(1 - lean**2), lean])
        self.start = np.array(values, dtype=object)

    def _unknown(self, key: Any, width: int = 1) -> Array:
        return np.eye(len(self.start) + 1, dtype=int)[self._at[key] :][:width].astype(object)

    def _constant(self, v: Array) -> Array:
        form = np.zeros((len(v), len(self.start) + 1), dtype=object)
        form[:, -1] = v
        return form

    def turned(self, body: str, v: Array) -> Array:
        """A direction of the drawing, fixed in a body; (3, unknowns + 1)."""
        if body == "chassis":
            return self._constant(v)
        entries = self._unknown(body, 12)[3:]
        return np.stack([v @ entries[3 * i : 3 * i + 3] for i in range(3)])

    def point(self, name: str, body: str | None = None) -> Array:
        """A point, of a body that holds it; (3, unknowns + 1)."""
        if not self.holders[name]:
            return self._unknown(name, 3)
        body = body or self.holders[name][0]
        if body == "chassis":
            return self._constant(self.drawn[name])
        return self._unknown(body, 3) + self.turned(body, self.drawn[name] - self.drawn[self.bodies[body][0]])

    # Rows.

    def _row(self, u: Array, v: Array, w: Array, name: str = "", law: Law | None = None) -> None:
        zero = np.zeros((3 - len(u), u.shape[-1]), dtype=object)
        none = (lambda _: mpf(0),) * 3
        self._rows.append((np.concatenate([u, zero]), np.concatenate([v, zero]), w, name, law or none))

    def _product(self, u: Array, v: Array, value: Any = 0, name: str = "", law: Law | None = None) -> None:
        self._row(u, v, self._constant(np.array([-value]))[0], name, law)

    def _linear(self, w: Array, name: str = "", law: Law | None = None) -> None:
        self._row(self._constant(vector([0])), self._constant(vector([0])), w, name, law)

    def _constrain(self, m: Mapping[str, Any]) -> None:
        for body in self.bodies:
            if body != "chassis":
                columns = [self.turned(body, vector(e)) for e in np.eye(3)]
                for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
                    self._product(columns[i], columns[j], mpf(i == j))
        for name, holders in self.holders.items():
            for other in holders[1:]:
                for w in self.point(name, other) - self.point(name, holders[0]):
                    self._linear(w)
        for first, second in m["rods"].values():
            apart, drawn = self.point(second) - self.point(first), self.drawn[second] - self.drawn[first]
            self._product(apart, apart, drawn @ drawn)
        for name, slide in m["slides"].items():
            line = self.turned(slide["body"], self._lines[name])
            for point in slide["points"]:
                apart = self.point(point) - self.point(slide["through"], slide["body"])
                for k in range(3):
                    self._row(self._unknown((name, point)), -line[k : k + 1], apart[k])
            if not slide["turns"]:
                rider = next(b for b in m["bodies"] if set(slide["points"]) <= set(m["bodies"][b]))
                across = beside(self._lines[name])
                third = np.cross(self._lines[name], across)
                self._product(self.turned(slide["body"], across), self.turned(rider, third))
        for drive in self.inputs.values():
            if "contact" in drive:
                sides = self._unknown(tuple(drive["contact"]), 2)
                self._product(sides, sides, mpf(1))
                inner, centre = (self.drawn[p] for p in drive["contact"])
                axis = self.turned(self.holders[drive["contact"][1]][0], unit(centre - inner))
                self._row(self.turned(self._base(drive), self.axes["up"]), axis, -sides[1])

    def _base(self, drive: Mapping[str, Any]) -> str:
        """The body over which a height counts."""
        return self.ground if drive.get("over") == "ground" else "chassis"

    def _drive(self, name: str, drive: Mapping[str, Any], radius: float | None) -> Any:
        """The rows of an input; returns its value in the drawing."""
        drawn, linear = self.drawn, (lambda w: w / self.unit, lambda _: 1 / self.unit, lambda _: mpf(0))
        cosine = (cos, lambda w: -sin(w), lambda w: -cos(w))
        sine = (sin, cos, lambda w: -sin(w))
        if drive.get("from") == "drawing":
            body, other = drive["angle"], drive["on"]
            first, second = [p for p in self.bodies[body] if p in self.bodies[other]][:2]
            axis = unit(drawn[second] - drawn[first])
            across = beside(axis)
            for side, law in ((across, cosine), (np.cross(axis, across), sine)):
                self._product(self.turned(other, side), self.turned(body, across), name=name, law=law)
            return mpf(0)
        if "angle" in drive:
            of, about, up = drive["of"], drive["about"], self.axes[drive["from"]]
            arm = drawn[of] - drawn[about]
            long = sqrt(arm @ arm)
            self._linear(up @ (self.point(of) - self.point(about)) / long, name, cosine)
            return mp.acos(arm @ up / long)
        if "travel" in drive:
            for slide in drive["travel"]:
                key = next(key for key in self._at if isinstance(key, tuple) and key[0] == slide)
                self._linear(self._unknown(key)[0], name, linear)
            return self.start[self._at[key]] * self.unit
        if "distance" in drive:
            first, second = drive["distance"]
            apart = self.point(second) - self.point(first)
            square = (
                lambda w: (w / self.unit) ** 2,
                lambda w: 2 * w / self.unit**2,
                lambda _: 2 / self.unit**2,
            )
            self._product(apart, apart, name=name, law=square)
            return sqrt(sum((drawn[second] - drawn[first]) ** 2)) * self.unit
        along = self.axes[drive.get("along", "up")]
        point = drive["height"] if "height" in drive else drive["contact"][1]
        base, less = self._base(drive), 0 * self._constant(along)[0]
        place = self._constant(drawn[point])
        if base != "chassis":
            start = self.bodies[base][0]
            place = self._unknown(base, 3) + self.turned(base, drawn[point] - drawn[start])
        if "contact" in drive:
            side, radius = tuple(drive["contact"]), mpf(radius) / self.unit
            less = radius * self._unknown(side)[0]
            less[-1] -= radius * self.start[self._at[side]]
        self._row(self.turned(base, along), self.point(point) - place, -less, name, linear)
        return mpf(0)

    # Values.

    def targets(self, inputs: Mapping[str, Any], derivative: int = 0) -> Array:
        """f of the inputs, or its first or second derivative; (rows,)."""
        found = np.zeros(len(self._rows), dtype=object)
        for row, (*_, name, law) in enumerate(self._rows[self._constraints :], self._constraints):
            found[row] = law[derivative](mpf(inputs[name]))
        return found

    def residual(self, y: Array, targets: Array) -> Array:
        """The rows less their targets, in doubles."""
        u, v, w = (part @ np.append(y, 1.0) for part in self._rounded)
        return np.asarray((u * v).sum(axis=-1) + w - targets)

    def exact_residual(self, y: Array, targets: Any) -> Array:
        """The same in many digits: only coefficients that are not zero are worth their time."""
        parts, one = [], np.append(y, mpf(1))
        for coefficients, where in self._exact:
            part = np.zeros(coefficients.shape[:-1], dtype=object)
            np.add.at(part, where[:-1], coefficients[where] * one[where[-1]])
            parts.append(part)
        u, v, w = parts
        return np.asarray((u * v).sum(axis=-1) + w - targets)

    def jacobian(self, y: Array) -> Array:
        """(rows, unknowns)."""
        return self.change(np.append(y, 1.0)) + self._rounded[2][:, :-1]

    def change(self, step: Array) -> Array:
        """Of the Jacobian along a step, whose last entry is 0."""
        u, v, _ = self._rounded
        turned = np.einsum("rk,rkn->rn", u @ step, v) + np.einsum("rk,rkn->rn", v @ step, u)
        return np.asarray(turned[:, :-1])

    def per_row(self, inputs: Mapping[str, Any]) -> Array:
        """Numbers of the inputs at their rows, 0 at the others; (rows,)."""
        return np.array([inputs.get(row[3], 0) for row in self._rows], dtype=object)

    def freedoms(self) -> int:
        """Of the drawing, with no input driven."""
        constraints = self.jacobian(self.start.astype(float))[: self._constraints]
        return len(self.start) - int(np.sum(np.linalg.svd(constraints, compute_uv=False) > SINGULAR))

    def points(self, y: Array) -> dict[str, Array]:
        """Points of a pose in the chassis' frame, mm, (3,)."""
        with mp.workdps(DIGITS):
            y = np.append(y, 1)
            return {name: self.point(name) @ y * self.unit + self.origin for name in self.named}
