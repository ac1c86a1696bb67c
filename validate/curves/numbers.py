"""The numbers of a scene that can be shown, found by the shortest unique name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from pointcoord import Motion, NotComputed, Samples, Scene
from pointcoord.effects.effect import Effect, Quantity
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
PLACE = ALWAYS[0].quantities[0]


@dataclass(frozen=True)
class Number:
    """A number of a scene over time.

    Attributes:
        path: its name: quantity, name and component, as far as it has them.
        words: its name in words.
        unit: unit of the values from `read`.
        sign: the positive direction of its value before `minus`, in words; empty if it needs no statement.
        missing: why the scene does not give it; None if the scene asks for it.
        minus: whether it is shown with the opposite sign of pointcoord's number with this path.
    """

    path: tuple[str, ...]
    words: str
    unit: str
    sign: str
    scene: Scene = field(repr=False, compare=False)
    missing: NotComputed | None = None
    minus: bool = False

    @property
    def of_the_car(self) -> bool:
        """Whether it is a number of the whole car, such as an angle, and not of a point or a body."""
        return len(self.path) == 2

    @property
    def panel(self) -> tuple[str, ...]:
        """The panel in which it is drawn: numbers with an equal value here share an axis."""
        if len(self.path) < 3:
            # The wheels of an axle share an axis.
            return (*self.path[:-1], self.path[-1].rpartition(".")[2])
        # The components of a position differ much: on one axis their changes would not be visible.
        return (PLACE.name, self.path[2]) if self.path[0] == PLACE.name else self.path[:1]

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
    def short(self) -> str:
        """Its short name: without the quantity for numbers of the car and for positions."""
        return ".".join(self.path[1:] if self.of_the_car or self.path[0] == PLACE.name else self.path)

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

    def shown(self, motion: Motion | None, samples: Sampled) -> Array:
        """Its values as shown, (N,); see `read`."""
        return self.factor * self.read(motion, samples)

    @property
    def factor(self) -> float:
        """The factor from its values to those shown: from rad to degrees, with the shown sign."""
        return (-1.0 if self.minus else 1.0) * degrees_of(self.unit)[0]

    @property
    def mark(self) -> str:
        """The sign of a shown value where `sign` holds: + or -."""
        return "-" if self.minus else "+"

    @property
    def unit_shown(self) -> str:
        """The shown unit: degrees for an angle."""
        return degrees_of(self.unit)[1]

    def negative(self) -> Number:
        """This number, shown with the opposite sign."""
        return replace(self, words=f"minus {self.words}", minus=True)


def numbers_of(scene: Scene) -> tuple[Number, ...]:
    """Time, wheel travel and inputs of a scene, and every number that the scene can ask for."""
    topology, centre = scene.mechanism.topology, scene.mechanism.topology.wheel_centre
    time = Number((TIME,), TIME, "s", "", scene)
    missing = _missing(ALWAYS, PLACE, centre, scene)
    travel = Number((TRAVEL,), "wheel travel", "mm", "up from the drawing", scene, missing)
    givers = gathered(
        ((quantity, name), effect)
        for effect in (*ALWAYS, *EFFECTS.values())
        for quantity, names in names_of([effect], topology, tuple(topology.points)).items()
        for name in names
    )
    had = scene.mechanism.effects
    others = (number for path, effects in givers.items() for number in _called(*path, effects, scene, had))
    return (time, *([travel] if centre else []), *_inputs(scene), *others)


def numbers_asked(
    scene: Scene, name: str, named: Sequence[str] | None, first: Sequence[str] | None
) -> tuple[Number, ...]:
    """The numbers in a table of a car, by the scene's convention.

    Args:
        name: name of the scene, for messages.
        named: names of numbers, see `numbers_called`.
        first: used if `named` is empty: the numbers to take if the car has them. None: every number of the
            car, by pointcoord's names, that does not depend on the speed of the motion.
    Raises:
        UsageError: the car has no such number, or no numbers at all.
    """
    part, numbers = scene.mechanism, numbers_of(scene)
    had = {number for effect in part.effects for number in EFFECTS[effect].names(part.topology)}
    every = [n for n in numbers if n.of_the_car and not n.is_force and n.path[1] in had]
    every = [n for n in every if number_called(n.path[1])]
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
    for own in first:
        called, sign = meant_by(own, scene.convention)
        for number in every:
            if number.path[1].rpartition(".")[2] == called:
                found[number.path] = number if sign > 0 else number.negative()
    return tuple(found.values())


def numbers_chosen(named: Iterable[str], scene: Scene, where: str) -> tuple[Number, ...]:
    """The numbers with some names, each once, see `numbers_called`.

    Args:
        where: the scene and the option that names them, for messages.
    Raises:
        UsageError: a name fits no number, or numbers with different names.
    """
    try:
        found = [number for words in named for number in numbers_called(words, scene)]
    except UsageError as error:
        raise UsageError(f"{where} {error}") from None
    return tuple({number.path: number for number in found}.values())


def numbers_called(words: str, scene: Scene) -> tuple[Number, ...]:
    """The numbers with a given name in the scene's convention, see `found`.

    Raises:
        UsageError: the name fits no number, or numbers with different names.
    """
    called, sign = meant_by(words, scene.convention)
    own = called.rpartition(".")[2]
    try:
        numbers = found(called, numbers_of(scene))
    except UsageError:
        givers = [effect for effect in EFFECTS.values() if own in effect.own_names]
        if why := [reason for effect in givers if (reason := scene.mechanism.refusal(effect))]:
            raise UsageError(f"{shown(words)}: {why[0]}") from None
        raise
    return numbers if sign > 0 else tuple(number.negative() for number in numbers)


def asking_for(scene: Scene, numbers: Iterable[Number]) -> Scene:
    """The scene with the effects added that give some numbers.

    Raises:
        NotComputed: the scene does not report the point of a number.
    """
    wanted = []
    for number in numbers:
        if number.missing is not None and not number.missing.effect:
            raise number.missing
        wanted += [number.missing.effect] if number.missing else []
    return scene.model_copy(update={"effects": tuple(dict.fromkeys((*scene.effects, *wanted)))})


def movement(scene: Scene, motion: Motion, samples: Sampled) -> Array:
    """Displacement of the wheel centre from the closed drawing, relative to the chassis, (N, 3), mm."""
    centre = scene.mechanism.topology.wheel_centre
    readout, drawn = motion.solved.readout, closed_drawing(scene).places[centre]
    local = samples.numbers[PLACE.name][centre] - readout.mechanism.origin
    return readout.chassis.taken_back(samples.times, local) - (drawn - readout.mechanism.origin)


def _inputs(scene: Scene) -> list[Number]:
    topology = scene.mechanism.topology
    signs = {drive.input: drive.sign for drive in topology.drives}
    signs |= {
        name: f"right-handed about {along} through {about}" if about else f"{along}ward"
        for name, (along, about) in topology.chassis_inputs.items()
    }
    return [
        Number((name,), name.replace("_", " "), unit, signs.get(name, ""), scene)
        for name, unit in topology.input_units.items()
        if name in scene.functions
    ]


def _called(
    name_of_quantity: str, name: str, effects: Sequence[Effect], scene: Scene, had: Collection[str]
) -> Iterator[Number]:
    """A number of the car, or the three components of a vector, that some effects give.

    Args:
        had: names of the effects that the car has.
    """
    quantity = QUANTITIES[name_of_quantity]
    path, missing = (quantity.name, name), _missing(effects, quantity, name, scene, had)
    if quantity.of == "car":
        known = number_called(name)
        sign = known.sign if known else ""
        yield Number(path, words_of(name), quantity.unit, sign, scene, missing)
        return
    for i, axis in enumerate(COMPONENTS):
        along = _along(scene, i)
        sign = f"about {along}" if along and quantity.of == "body" else along
        words = f"{quantity.words} of {name.replace('_', ' ')}, {axis}"
        yield Number((*path, axis), words, quantity.unit, sign, scene, missing)


def _missing(
    effects: Sequence[Effect], quantity: Quantity, name: str, scene: Scene, had: Collection[str] = ()
) -> NotComputed | None:
    """Why a scene does not give a number that any of some effects gives; None if the scene gives it."""
    what = f"{quantity.words} of {name}"
    asked = [effect for effect in effects if effect in ALWAYS or effect.name in scene.effects]
    if not asked:
        return NotComputed(what, next((one for one in effects if one.name in had), effects[-1]).name)
    if asked[0].reports_states and name in scene.unreported_points:
        return NotComputed(what, "", f"add {name!r} to the scene's points")
    return None


def _along(scene: Scene, i: int) -> str:
    """The direction of an axis in the car, such as up, rearward or left; empty for an oblique axis."""
    up, right = np.array(scene.mechanism.up), np.array(scene.mechanism.right)
    named = (("up", "down", up), ("right", "left", right), ("rearward", "forward", np.cross(right, up)))
    for positive, negative, direction in named:
        if abs(direction[i]) > 1.0 - 1e-9:  # the axes of a scene are orthonormal to rounding
            return positive if direction[i] > 0.0 else negative
    return ""


def found(words: str, numbers: Sequence[Number]) -> tuple[Number, ...]:
    """The numbers that `words` names: one number, that of each wheel, or the components of one vector.

    `words` is QUANTITY.NAME.COMPONENT; parts at either end may be left out. Without a quantity the first one
    that fits is taken, position before velocity.

    Raises:
        UsageError: `words` fits no number, or numbers with different names.
    """
    # A number and a quantity may have the same name; the number is taken.
    fitting = [n for n in numbers if f".{'.'.join(n.path)}".endswith(f".{words}")]
    fitting = fitting or [n for n in numbers if f".{words}." in f".{'.'.join(n.path)}."]
    fitting = [n for n in fitting if n.path[0] == fitting[0].path[0]]
    if not fitting:
        known = dict.fromkeys(name for n in numbers for name in (n.short, ".".join(n.path), *n.path[:2]))
        own = dict.fromkeys(n.short.rpartition(".")[2] for n in numbers if len(n.path) < 3)
        there = f"there are: {some_of([*own], NAMED)}, and for points POINT.z or QUANTITY.POINT.z"
        raise UsageError(
            f"{shown(words)!r} names no number of this scene{hint(words, [*own, *known])}; {there}"
        )
    names = dict.fromkeys(n.path[:2] for n in fitting)
    own_names = {name[-1].rpartition(".")[2] for name in names} if fitting[0].of_the_car else names
    if len(own_names) > 1:
        some = ", ".join(".".join(name) for name in names)
        raise UsageError(f"{shown(words)!r} names more than one number; give one of: {some}")
    return tuple(fitting)


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
    return tuple(n for n in numbers_of(scene) if n.missing is None and n.of_the_car and n.unit == "rad")


def usual(scene: Scene, motion: Motion, angles: Sequence[Number]) -> Curves:
    """The curves that are drawn without --x and --y.

    If the wheel moves mainly up and down, the wheel angles over wheel travel, with travel on the vertical
    axis; otherwise the angles over the one input that moves, or over time. Without angles, the position of
    the wheel centre over time; without a wheel, the position of the first point that moves.
    """
    there = [n for n in numbers_of(scene) if n.missing is None]
    one: Mapping[str, Number] = {n.path[0]: n for n in there if len(n.path) == 1}
    if not angles:
        points = [n for n in there if len(n.path) == 3]
        name = scene.mechanism.topology.wheel_centre
        place = [n for n in points if n.path[1] == name]
        place = place or [n for n in points if np.ptp(n.read(motion, motion)) > 0.0] or points
        place = [n for n in points if n.path[:2] == place[0].path[:2]]
        return Curves((one[TIME],), tuple(place))
    if TRAVEL in one:
        moved = movement(scene, motion, motion)
        up = np.array(scene.mechanism.up)
        level = moved - (moved @ up)[:, None] * up
        if np.ptp(moved @ up) > np.ptp(level, axis=0).max():
            return Curves(tuple(angles), (one[TRAVEL],))
    moving = [n for n in there if n.path[0] in scene.functions and np.ptp(n.read(motion, motion)) > 0.0]
    return Curves((moving[0] if len(moving) == 1 else one[TIME],), tuple(angles))
