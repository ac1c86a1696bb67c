"""The numbers of a scene that can be shown, found by the shortest unique name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from pointcoord import Motion, Samples, Scene
from pointcoord.effects.numbers import meant_by
from pointcoord.effects.registry import ALWAYS, EFFECTS, QUANTITIES, number_called, words_of
from pointcoord.wording import meant as hint
from validate.arrays import Array
from validate.closed_drawing import closed_drawing
from validate.errors import UsageError
from validate.formulations.asked_numbers import is_force, per_second
from validate.formulations.asked_numbers import numbers_of as names_of
from validate.formulations.protocol import Solution
from validate.plain_text import gathered, shown, some_of
from validate.tables.units import degrees_of

Sampled = Samples | Solution
"""Numbers of a motion, or of another solution, at instants."""

TIME, TRAVEL = "time", "travel"
COMPONENTS = "xyz"
NAMED = 12  # largest number of names listed in a message
PLACE = ALWAYS[0].quantities[0].name


@dataclass(frozen=True)
class Number:
    """A number of a scene over time.

    Attributes:
        path: its name: quantity, name and component, as far as it has them.
        words: its name in words.
        unit: unit of the values from `read`.
        sign: the positive direction of its value before `minus`, in words; empty if it needs no statement.
        effect: the effect that gives it; empty if the scene asks for it.
        minus: whether it is shown with the opposite sign of pointcoord's number with this path.
    """

    path: tuple[str, ...]
    words: str
    unit: str
    sign: str
    scene: Scene = field(repr=False, compare=False)
    effect: str = ""
    minus: bool = False

    @property
    def of_the_car(self) -> bool:
        """Whether it is a number of the whole car, such as an angle, and not of a point or a body."""
        return len(self.path) == 2

    @property
    def is_force(self) -> bool:
        """Whether it is a force of a rod, a joint or a slide."""
        return len(self.path) > 1 and is_force(self.path[0])

    @property
    def called(self) -> str:
        """Its name in tables: for a number of the car its own name, for others the whole path."""
        return self.path[-1] if len(self.path) < 3 and not self.is_force else ".".join(self.path)

    def headed(self, per: str = "", name: str = "") -> str:
        """Its heading in a table: its name, or `name`, with a minus sign if it is reversed, and its unit."""
        return f"{'-' if self.minus else ''}{name or self.called} [{self.unit_shown}{per}]"

    @property
    def unit_shown(self) -> str:
        """The shown unit: degrees for an angle."""
        return degrees_of(self.unit)[1]

    @property
    def mark(self) -> str:
        """The sign of a shown value where `sign` holds: + or -."""
        return "-" if self.minus else "+"

    @property
    def factor(self) -> float:
        """The factor from its values to those shown: from rad to degrees, with the shown sign."""
        return (-1.0 if self.minus else 1.0) * degrees_of(self.unit)[0]

    def shown(self, motion: Motion | None, samples: Sampled) -> Array:
        """Its values as shown, (N,); see `read`."""
        return self.factor * self.read(motion, samples)

    def read(self, motion: Motion | None, samples: Sampled) -> Array:
        """Its values at the N instants of samples, (N,).

        Args:
            motion: None for a number of the car at poses without a motion.
        Raises:
            KeyError: the samples lack it.
        """
        name = self.path[0]
        if len(self.path) > 1:
            array = samples.numbers[name][self.path[1]]
            return array[..., COMPONENTS.index(self.path[2])] if len(self.path) > 2 else array
        if name in self.scene.functions:
            return self.scene.functions[name].series(samples.times, 0)[:, 0]
        if name == TIME:
            return samples.times
        assert motion is not None  # poses without a motion are not asked for the travel
        return np.asarray(movement(self.scene, motion, samples) @ np.array(self.scene.mechanism.up))


def movement(scene: Scene, motion: Motion, samples: Sampled) -> Array:
    """Displacement of the wheel centre from the closed drawing, relative to the chassis, (N, 3), mm."""
    centre = scene.mechanism.topology.wheel_centre
    readout, drawn = motion.solved.readout, closed_drawing(scene).places[centre]
    local = samples.numbers[PLACE][centre] - readout.mechanism.origin
    return readout.chassis.taken_back(samples.times, local) - (drawn - readout.mechanism.origin)


def numbers_of(scene: Scene) -> tuple[Number, ...]:
    """Time, wheel travel and inputs of a scene, and every number that its car has."""
    part, topology = scene.mechanism, scene.mechanism.topology
    found = [Number((TIME,), TIME, "s", "", scene)]
    if topology.wheel_centre:
        found.append(Number((TRAVEL,), "wheel travel", "mm", "up from the drawing", scene))
    signs = {drive.input: drive.sign for drive in topology.drives}
    for name, (along, about) in topology.chassis_inputs.items():
        signs[name] = f"right-handed about {along} through {about}" if about else f"{along}ward"
    for name, unit in topology.input_units.items():
        if name in scene.functions:
            found.append(Number((name,), name.replace("_", " "), unit, signs.get(name, ""), scene))
    givers = gathered(
        ((quantity, name), effect)
        for effect in (*ALWAYS, *(EFFECTS[name] for name in part.effects))
        for quantity, names in names_of([effect], topology, tuple(topology.points)).items()
        for name in names
    )
    directions = _directions(scene)
    for path, effects in givers.items():
        quantity, name = QUANTITIES[path[0]], path[1]
        asked = any(effect in ALWAYS or effect.name in scene.effects for effect in effects)
        more = scene, "" if asked else effects[0].name
        if quantity.of == "car":
            known = number_called(name)
            found.append(Number(path, words_of(name), quantity.unit, known.sign if known else "", *more))
            continue
        for axis, along in zip(COMPONENTS, directions, strict=True):
            words = f"{quantity.words} of {name.replace('_', ' ')}, {axis}"
            sign = f"about {along}" if along and quantity.of == "body" else along
            found.append(Number((*path, axis), words, quantity.unit, sign, *more))
    return tuple(found)


def _directions(scene: Scene) -> list[str]:
    """The direction of each axis in the car, such as up, rearward or left; empty for an oblique axis."""
    up, right = np.array(scene.mechanism.up), np.array(scene.mechanism.right)
    found = ["", "", ""]
    for positive, negative, along in (
        ("up", "down", up),
        ("right", "left", right),
        ("rearward", "forward", np.cross(right, up)),
    ):
        i = int(np.argmax(np.abs(along)))
        if abs(along[i]) > 1.0 - 1e-9:  # the axes of a scene are orthonormal to rounding
            found[i] = positive if along[i] > 0.0 else negative
    return found


def asking_for(scene: Scene, numbers: Iterable[Number]) -> Scene:
    """The scene with all points, and with the effects added that give some numbers."""
    effects = dict.fromkeys((*scene.effects, *(number.effect for number in numbers if number.effect)))
    return scene.model_copy(update={"effects": tuple(effects), "points": None})


def numbers_asked(
    scene: Scene, name: str, named: Sequence[str] | None, first: Sequence[str] | None
) -> tuple[Number, ...]:
    """The numbers in a table of a car, by the scene's convention.

    Args:
        name: name of the scene, for messages.
        named: names of numbers, see `numbers_chosen`.
        first: used if `named` is empty: the numbers to take if the car has them. None: every number of the
            car, by pointcoord's names, that does not depend on the speed of the motion.
    Raises:
        UsageError: the car has no such number, or no numbers at all.
    """
    every = [n for n in numbers_of(scene) if n.of_the_car and not n.is_force and number_called(n.path[1])]
    if not every:
        raise UsageError(
            f"{name}: there is no number of a wheel: its mechanism names no wheel_axis under [roles]; "
            "pointcoord simulate writes the numbers that the scene asks for"
        )
    if named:
        return numbers_chosen(named, scene, f"{name}: --number")
    if first is None:
        return tuple(number for number in every if not per_second(number.path[0]))
    found = {}
    for called, sign in (meant_by(own, scene.convention) for own in first):
        for number in every:
            if number.path[1].rpartition(".")[2] == called:
                found[number.path] = _signed(number, sign)
    return tuple(found.values())


def numbers_chosen(named: Iterable[str], scene: Scene, where: str) -> tuple[Number, ...]:
    """The numbers with some names in the scene's convention, each once, see `found`.

    Args:
        where: the scene and the option that names them, for messages.
    Raises:
        UsageError: a name fits no number, or numbers with different names.
    """
    every, chosen = numbers_of(scene), dict[tuple[str, ...], Number]()
    for words in named:
        called, sign = meant_by(words, scene.convention)
        try:
            chosen |= {number.path: _signed(number, sign) for number in found(called, every)}
        except UsageError as error:
            own = called.rpartition(".")[2]
            givers = [effect for effect in EFFECTS.values() if own in effect.own_names]
            lacks = [reason for effect in givers if (reason := scene.mechanism.refusal(effect))]
            why = f"{shown(words)}: {lacks[0]}" if lacks else error
            raise UsageError(f"{where} {why}") from None
    return tuple(chosen.values())


def _signed(number: Number, sign: int) -> Number:
    """A number, or the same shown with the opposite sign."""
    return number if sign > 0 else replace(number, words=f"minus {number.words}", minus=True)


def found(words: str, numbers: Sequence[Number]) -> tuple[Number, ...]:
    """The numbers that `words` names: one number, that of each wheel, or the components of one vector.

    `words` is QUANTITY.NAME.COMPONENT; parts at either end may be left out. Without a quantity the first one
    that fits is taken, position before velocity.

    Raises:
        UsageError: `words` fits no number, or numbers with different names.
    """
    names = fitting(words, [".".join(number.path) for number in numbers])
    fits = [number for number in numbers if ".".join(number.path) in names]
    if not fits:
        known = dict.fromkeys(name for n in numbers for name in (n.called, ".".join(n.path), *n.path[:2]))
        own = dict.fromkeys(n.path[-1].rpartition(".")[2] for n in numbers if len(n.path) < 3)
        there = f"there are: {some_of([*own], NAMED)}, and for points POINT.z or QUANTITY.POINT.z"
        raise UsageError(
            f"{shown(words)!r} names no number of this scene{hint(words, [*own, *known])}; {there}"
        )
    fits = [number for number in fits if number.path[0] == fits[0].path[0]]
    paths = dict.fromkeys(number.path[:2] for number in fits)
    # The wheels of an axle have the same number.
    if len({path[-1].rpartition(".")[2] for path in paths} if fits[0].of_the_car else paths) > 1:
        some = ", ".join(map(".".join, paths))
        raise UsageError(f"{shown(words)!r} names more than one number; give one of: {some}")
    return tuple(fits)


def fitting(words: str, names: Iterable[str]) -> list[str]:
    """The names, of parts between dots, that end with the parts in `words`, or else contain them.

    >>> fitting("toe", ["wheel.toe", "toe.x"]), fitting("toe", ["toe.x", "toe.y"])
    (['wheel.toe'], ['toe.x', 'toe.y'])
    """
    every = [*names]
    ends = [name for name in every if f".{name}".endswith(f".{words}")]
    return ends or [name for name in every if f".{words}." in f".{name}."]


@dataclass(frozen=True)
class Curves:
    """The numbers of the two axes: one number against several, or several against one."""

    across: tuple[Number, ...]
    up: tuple[Number, ...]

    @property
    def pairs(self) -> tuple[tuple[Number, Number], ...]:
        """The horizontal and the vertical number of each curve."""
        return tuple(product(self.across, self.up))


def angles_of(scene: Scene) -> tuple[Number, ...]:
    """The angles of its wheels that a scene asks for."""
    return tuple(n for n in numbers_of(scene) if not n.effect and n.of_the_car and n.unit == "rad")


def usual(scene: Scene, motion: Motion, angles: Sequence[Number]) -> Curves:
    """The curves that are drawn without --x and --y.

    If the wheel moves mainly up and down, the wheel angles over wheel travel, with travel on the vertical
    axis; otherwise the angles over the one input that moves, or over time. Without angles, the position of
    the wheel centre over time; without a wheel, the position of the first point that moves.
    """
    numbers, centre = numbers_of(scene), scene.mechanism.topology.wheel_centre
    one, reported = {n.path[0]: n for n in numbers if len(n.path) == 1}, scene.reported_points
    if not angles:
        places = [n for n in numbers if n.path[0] == PLACE and n.path[1] in reported]
        moving = [n.path[1] for n in places if np.ptp(n.read(motion, motion)) > 0.0]
        point = centre if centre in reported else [*moving, reported[0]][0]
        return Curves((one[TIME],), tuple(n for n in places if n.path[1] == point))
    if centre in reported:
        moved, up = movement(scene, motion, motion), np.array(scene.mechanism.up)
        level = moved - (moved @ up)[:, None] * up
        if np.ptp(moved @ up) > np.ptp(level, axis=0).max():
            return Curves(tuple(angles), (one[TRAVEL],))
    driven = [n for name, n in one.items() if name in scene.functions]
    moved_by = [n for n in driven if np.ptp(n.read(motion, motion)) > 0.0]
    return Curves((moved_by[0] if len(moved_by) == 1 else one[TIME],), tuple(angles))
