"""The numbers of a scene that can be shown, found by as few words as tell them apart."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, NotComputed, Samples, Scene
from pointcoord.effects.conventions import CONVENTIONS
from pointcoord.effects.effect import Effect, Quantity
from pointcoord.effects.registry import ALWAYS, EFFECTS, number_called, words_of
from pointcoord.wording import meant as hint
from validate.closed_drawing import closed_drawing
from validate.errors import UsageError
from validate.formulations.asked_numbers import is_force, per_second
from validate.formulations.protocol import Solution
from validate.plain_text import shown, some_of
from validate.tables.units import degrees_of

Array = NDArray[np.float64]

Sampled = Samples | Solution
"""Numbers of a motion or of another solution at instants."""
Read = Callable[[Motion | None, Sampled], Array]

TIME, TRAVEL = "time", "travel"
COMPONENTS = "xyz"
NAMED = 12  # numbers, in a message
PLACE = ALWAYS[0].quantities[0]


@dataclass(frozen=True)
class Number:
    """A number of a scene over time.

    Attributes:
        path: quantity, name and component, as far as it has them; what names it.
        words: for people.
        unit: of what `read` gives.
        sign: where it is positive, in words; empty if that goes without saying.
        read: its values at the instants of samples of a motion, (N,); KeyError where they do not have it.
        missing: why it is not there; None if the scene asks for it.
        minus: whether it counts the other way than our number of its path.
    """

    path: tuple[str, ...]
    words: str
    unit: str
    sign: str
    read: Read
    missing: NotComputed | None = None
    minus: bool = False

    @property
    def of_the_car(self) -> bool:
        """Whether it is an angle or another number that the whole car has once."""
        return len(self.path) == 2

    @property
    def panel(self) -> tuple[str, ...]:
        """Numbers of the same are drawn over the same axis."""
        if len(self.path) < 3:
            # The wheels of an axle share an axis.
            return (*self.path[:-1], self.path[-1].rpartition(".")[2])
        # Places lie far apart: on one axis nothing would be seen of how they change.
        return (PLACE.name, self.path[2]) if self.path[0] == PLACE.name else self.path[:1]

    @property
    def is_force(self) -> bool:
        """Whether it is a force of a rod, a joint or a slide."""
        return len(self.path) > 1 and is_force(self.path[0])

    @property
    def called(self) -> str:
        """Its name in tables: a number of the car's own, of others the whole path."""
        return self.path[-1] if len(self.path) < 3 and not self.is_force else ".".join(self.path)

    @property
    def short(self) -> str:
        """As few words as name it."""
        return ".".join(self.path[1:] if self.of_the_car or self.path[0] == PLACE.name else self.path)

    def shown(self, motion: Motion | None, samples: Sampled) -> Array:
        """Its values for people, (N,): an angle in degrees.

        Args:
            motion: may be None of a number of the car at poses, which have no motion.
        """
        return self.read(motion, samples) * self.in_degrees

    @property
    def in_degrees(self) -> float:
        """What its values are multiplied by for that."""
        return degrees_of(self.unit)[0]

    @property
    def unit_shown(self) -> str:
        """The unit of these."""
        return degrees_of(self.unit)[1]

    def negative(self) -> Number:
        """The same, counted the other way."""

        def read(motion: Motion | None, samples: Sampled) -> Array:
            return np.negative(self.read(motion, samples))

        sign = f"not {self.sign}" if self.sign else ""
        return replace(self, words=f"minus {self.words}", sign=sign, read=read, minus=True)


def numbers_of(scene: Scene) -> tuple[Number, ...]:
    """Time, travel of the wheel and inputs of a scene, and every number that it can ask for."""
    time = Number((TIME,), TIME, "s", "", lambda _, samples: samples.times)
    travel = [_travel(scene)] if scene.mechanism.topology.wheel_centre else []
    found: dict[tuple[str, ...], Number] = {}
    had = {*scene.mechanism.effects}
    for number in (n for effect in (*ALWAYS, *EFFECTS.values()) for n in _of_effect(effect, scene)):
        before = found.setdefault(number.path, number)
        # Two effects may give a number: it is there where one of them is asked for.
        if before.missing and not (number.missing and before.missing.effect in had):
            found[number.path] = number
    return (time, *travel, *_inputs(scene), *found.values())


def numbers_asked(
    scene: Scene, name: str, named: Sequence[str] | None, first: Sequence[str] | None
) -> tuple[Number, ...]:
    """What a table of a car holds, by the scene's convention.

    Args:
        name: of the scene, for messages. named: by words, see `numbers_called`.
        first: without names, those that are taken of what the car has; of None every number by our names that
            does not hang on how fast the car moves.
    Raises:
        UsageError: the car has no such number, or none at all.
    """
    part, numbers, convention = scene.mechanism, numbers_of(scene), CONVENTIONS[scene.convention]
    had = {number for effect in part.effects for number in EFFECTS[effect].names(part.topology)}
    every = [n for n in numbers if n.of_the_car and not n.is_force and n.path[1] in had]
    every = [n for n in every if number_called(n.path[1])]
    if not every:
        raise UsageError(
            f"{name}: there is no number of a wheel: its mechanism names no wheel_axis under [roles]; "
            "pointcoord simulate writes what it gives"
        )
    if named:
        try:
            found = [number for words in named for number in numbers_called(words, scene)]
        except UsageError as error:
            raise UsageError(f"{name}: --number {error}") from None
    elif first is None:
        found = [number for number in every if not per_second(number.path[0])]
    else:
        found = []
        for own in first:
            called, sign = convention.number(own)
            wheels = [n for n in every if n.path[1].rpartition(".")[2] == called]
            found += wheels if sign > 0 else [n.negative() for n in wheels]
    return tuple({number.path: number for number in found}.values())


def numbers_called(words: str, scene: Scene) -> tuple[Number, ...]:
    """The numbers that some words name by the scene's convention, see `found`.

    Raises:
        UsageError: they fit none, or numbers of more than one name.
    """
    called, sign = CONVENTIONS[scene.convention].number(words)
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
    """The scene with the effects that give some numbers beside its own.

    Raises:
        NotComputed: it does not report the point of one.
    """
    wanted = []
    for number in numbers:
        if number.missing is not None and not number.missing.effect:
            raise number.missing
        wanted += [number.missing.effect] if number.missing else []
    return scene.model_copy(update={"effects": tuple(dict.fromkeys((*scene.effects, *wanted)))})


def _travel(scene: Scene) -> Number:
    """How far the wheel centre is above its place in the drawing as closed, against the chassis; mm."""
    up = np.array(scene.mechanism.up)

    def read(motion: Motion | None, samples: Sampled) -> Array:
        assert motion is not None  # nobody asks poses for it
        return np.asarray(movement(scene, motion, samples) @ up)

    missing = _missing(ALWAYS[0], PLACE, scene.mechanism.topology.wheel_centre, scene)
    return Number((TRAVEL,), "wheel travel", "mm", "up from the drawing", read, missing)


def movement(scene: Scene, motion: Motion, samples: Sampled) -> Array:
    """Of the wheel centre from its place in the drawing as closed, against the chassis, (N, 3), mm."""
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

    def reader(name: str) -> Read:
        return lambda _, samples: scene.functions[name].series(samples.times, 0)[:, 0]

    return [
        Number((name,), name.replace("_", " "), unit, signs.get(name, ""), reader(name))
        for name, unit in topology.input_units.items()
        if name in scene.functions
    ]


def _of_effect(effect: Effect, scene: Scene) -> Iterator[Number]:
    topology = scene.mechanism.topology
    gives = effect.gives_numbers(topology)
    for quantity in effect.quantities:
        every = topology.bodies if quantity.of == "body" else topology.points
        names = gives[quantity.name]
        for name in every if names is None else names:
            path, missing = (quantity.name, name), _missing(effect, quantity, name, scene)
            if quantity.of == "car":
                known = number_called(name)
                sign = known.sign if known else ""
                yield Number(path, words_of(name), quantity.unit, sign, _reader(quantity, name), missing)
                continue
            for i, axis in enumerate(COMPONENTS):
                along = _along(scene, i)
                sign = f"about {along}" if along and quantity.of == "body" else along
                words = f"{quantity.words} of {name.replace('_', ' ')}, {axis}"
                yield Number((*path, axis), words, quantity.unit, sign, _reader(quantity, name, i), missing)


def _missing(effect: Effect, quantity: Quantity, name: str, scene: Scene) -> NotComputed | None:
    """Why a number of an effect is not there; None if it is."""
    what = f"{quantity.words} of {name}"
    if effect not in ALWAYS and effect.name not in scene.effects:
        return NotComputed(what, effect.name)
    if effect.reports_states and name in scene.unreported_points:
        return NotComputed(what, "", f"add {name!r} to the scene's points")
    return None


def _reader(quantity: Quantity, name: str, component: int | None = None) -> Read:
    def read(_: Motion | None, samples: Sampled) -> Array:
        values = samples.numbers[quantity.name][name]
        return values if component is None else values[..., component]

    return read


def _along(scene: Scene, i: int) -> str:
    """Where an axis of the points points in the car: up, rearward, left; empty where it is between these."""
    up, right = np.array(scene.mechanism.up), np.array(scene.mechanism.right)
    named = (("up", "down", up), ("right", "left", right), ("rearward", "forward", np.cross(right, up)))
    for positive, negative, direction in named:
        if abs(direction[i]) > 1.0 - 1e-9:  # the axes of a scene are orthonormal to rounding
            return positive if direction[i] > 0.0 else negative
    return ""


def found(words: str, numbers: Sequence[Number]) -> tuple[Number, ...]:
    """The numbers that some words name: one, that of each wheel, or the components of one vector.

    The words, with dots between them, are a quantity, a name and a component, without those at either end
    that are not needed; without a quantity the first that fits is meant, position before velocity.

    Raises:
        UsageError: they fit none, or numbers of more than one name.
    """
    # A number may be called as a quantity is, and stands before it then.
    fitting = [n for n in numbers if f".{'.'.join(n.path)}".endswith(f".{words}")]
    fitting = fitting or [n for n in numbers if f".{words}." in f".{'.'.join(n.path)}."]
    fitting = [n for n in fitting if n.path[0] == fitting[0].path[0]]
    if not fitting:
        known = dict.fromkeys(name for n in numbers for name in (n.short, ".".join(n.path), *n.path[:2]))
        own = dict.fromkeys(n.short.rpartition(".")[2] for n in numbers if len(n.path) < 3)
        there = f"there are: {some_of([*own], NAMED)}, and of points POINT.z or QUANTITY.POINT.z"
        raise UsageError(
            f"{shown(words)!r} names no number that is here{hint(words, [*own, *known])}; {there}"
        )
    names = dict.fromkeys(n.path[:2] for n in fitting)
    own_names = {name[-1].rpartition(".")[2] for name in names} if fitting[0].of_the_car else names
    if len(own_names) > 1:
        some = ", ".join(".".join(name) for name in names)
        raise UsageError(f"{shown(words)!r} is more than one number; say which, such as {some}")
    return tuple(fitting)


@dataclass(frozen=True)
class Curves:
    """What is drawn over what: one number over several, or several over one."""

    across: tuple[Number, ...]
    up: tuple[Number, ...]

    @property
    def pairs(self) -> tuple[tuple[Number, Number], ...]:
        """Each curve's two numbers."""
        return tuple(product(self.across, self.up))


def angles_of(scene: Scene) -> tuple[Number, ...]:
    """The angles of its wheels that a scene asks for."""
    return tuple(n for n in numbers_of(scene) if n.missing is None and n.of_the_car and n.unit == "rad")


def usual(scene: Scene, motion: Motion, angles: Sequence[Number]) -> Curves:
    """What an engineer wants to see first.

    The angles of the wheel against its travel, which goes upward on the paper, where the wheel goes mostly up
    and down; else against the one input that moves, or time. The wheel centre's place over time where there
    are no angles; without a wheel that of the first point that moves.
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
