"""A mechanism for a program: the tree of its joints, the program's inputs, and the results read from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.errors import NoAnswer
from validate.spanning_tree.cut import CHASSIS, Place, SpanningTree, across, cut
from validate.spanning_tree.wheels import Wheels, knuckles

Array = NDArray[np.float64]

UNIT_ROUNDOFF = 0.5 * float(np.finfo(float).eps)
CHAIN = 6.0  # roundings on the way from the chassis to a point
# Range of an input: an angle is found from its cosine, and a rod of zero length has no direction.
BETWEEN = {
    "angle": (0.0, np.pi, "an angle from 0 to pi"),
    "distance": (np.nextafter(0.0, 1.0), np.inf, "a distance above 0"),
}


@dataclass(frozen=True)
class Inputs:
    """The inputs of a program.

    Attributes:
        series: of each drive its input with two time derivatives, (N, drives, 3), rad and the linkage's unit.
        laws: of every input, (N, 3), rad or mm per s^d.
    """

    series: Array
    laws: Mapping[str, Array]

    @property
    def values(self) -> Array:
        """(N, drives)."""
        return self.series[..., 0]

    def first(self, count: int) -> Inputs:
        """At the first instants."""
        laws = {name: law[:count] for name, law in self.laws.items()}
        return replace(self, series=self.series[:count], laws=laws)


@dataclass(frozen=True)
class Linkage:
    """A mechanism for a program.

    Attributes:
        plain: the flat mechanism. tree: its spanning tree.
        points: every moving point, as a place of a body.
        bodies: the bodies whose rotation is reported, by the name under which it is reported.
        wheels: data for the numbers of the wheels.
    """

    plain: Mapping[str, Any]
    tree: SpanningTree
    points: Mapping[str, Place]
    bodies: Mapping[str, str]
    wheels: Wheels

    @cached_property
    def frames(self) -> Mapping[str, tuple[Array, Array]]:
        """Origin of each body's frame as drawn, and its axes as columns; a rod's third axis is the rod's."""
        found = {CHASSIS: (np.zeros(3), np.eye(3))}
        for joint in self.tree.joints:
            rod = self.tree.rods.get(joint.body)
            found[joint.body] = joint.at, found[joint.parent][1] if rod is None else axes_along(rod)
        return found

    def local(self, place: Place) -> Array:
        """A place in its body's frame, (3,)."""
        start, axes = self.frames[place.body]
        return np.asarray(axes.T @ (place.at - start))

    @property
    def drawn_inputs(self) -> Array:
        """Inputs at the drawing, (drives,), rad and the unit."""
        return np.array([driven.drawn for driven in self.tree.driven])

    def coordinates(self, series: Array) -> Array:
        """Driven coordinates with two time derivatives, from the drives' inputs, (..., drives, 3) each."""
        found = [driven.coordinate(series[..., k, :]) for k, driven in enumerate(self.tree.driven)]
        return np.stack(found, axis=-2)

    def moved(self, places: Mapping[str, Array]) -> dict[str, float]:
        """Distance of each moving point from its place in the drawing, mm."""
        drawn = self.tree.drawn
        return {n: self.tree.unit * float(np.linalg.norm(place - drawn[n])) for n, place in places.items()}

    def accuracy(self, last_step: Array) -> Array:
        """Accuracy of a program's points after such a last correction of Newton's method, mm.

        Each joint of the chain from the chassis to a point adds one rounding of the point's coordinates from
        the linkage's origin; Newton's method leaves the square of its last correction.
        """
        far = max(1.0, *(float(np.abs(place).max()) for place in self.tree.drawn.values()))
        return np.asarray((CHAIN * UNIT_ROUNDOFF * far + last_step**2) * self.tree.unit)

    def inputs(self, laws: Mapping[str, Array]) -> Inputs:
        """The inputs of a program.

        Args:
            laws: every input's value and two time derivatives, (N, 3), rad or mm per s^d.
        Raises:
            NoAnswer: an input is missing, is not a number, or is outside its range.
        """
        for name, law in laws.items():
            _require(name, law, np.asarray(np.isfinite(law).all(axis=1)), "finite numbers and rates")
        found = []
        for driven in self.tree.driven:
            if driven.input not in laws:
                raise _refused(driven.input, "missing", "; ".join(one.input for one in self.tree.driven))
            law = laws[driven.input]
            if driven.kind in BETWEEN:
                least, most, words = BETWEEN[driven.kind]
                value = law[:, 0]
                _require(driven.input, law, np.asarray((value >= least) & (value <= most)), words)
            found.append(law if driven.is_angle else law * (driven.per_input / self.tree.unit))
        return Inputs(np.stack(found, axis=1), laws)


def _require(name: str, law: Array, right: NDArray[np.bool_], allowed: str) -> None:
    if not right.all():
        wrong = int(np.argmin(right))
        bad = law[wrong][~np.isfinite(law[wrong])]
        raise _refused(name, float(bad[0] if bad.size else law[wrong, 0]), allowed, wrong)


def _refused(name: str, value: float | str, allowed: str, instant: int | None = None) -> NoAnswer:
    """The error for an input whose value is refused."""
    where = "" if instant is None else f" at instant number {instant}"
    return NoAnswer(f"input {name!r}", f"is {value}{where}", allowed, name=name, value=value, instant=instant)


def linkage_of(plain: Mapping[str, Any]) -> Linkage:
    """The joints and loops of a flat mechanism.

    Raises:
        NoAnswer: it is not a mechanism.
    """
    tree = cut(plain)
    return Linkage(
        plain=plain,
        tree=tree,
        points={name: place for name, place in tree.points.items() if place.body != CHASSIS},
        bodies=knuckles(plain),
        wheels=Wheels.of(plain, tree),
    )


def axes_along(axis: Array) -> Array:
    """Right-handed axes as columns, of which the third lies along a unit vector."""
    return np.stack([*across(axis), axis], axis=-1)
