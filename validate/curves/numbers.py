"""The numbers of a scene that can be drawn, found by as few words as tell them apart."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, NotComputed, Samples, Scene
from pointcoord.effects.conventions import CONVENTIONS, Convention
from pointcoord.effects.effect import Effect, Quantity
from pointcoord.effects.registry import ALWAYS, EFFECTS, number_called, words_of
from pointcoord.wording import meant as hint
from validate.closed_drawing import closed_drawing
from validate.errors import UsageError
from validate.formulations.asked_numbers import is_force
from validate.formulations.protocol import Solution
from validate.plain_text import gathered, shown
from validate.tables.units import degrees_of

Array = NDArray[np.float64]


Sampled = Samples | Solution
"""Numbers of a motion or of another solution at instants."""
Read = Callable[[Motion, Sampled], Array]

TIME, TRAVEL = "time", "travel"
COMPONENTS = "xyz"
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
    """

    path: tuple[str, ...]
    words: str
    unit: str
    sign: str
    read: Read
    missing: NotComputed | None = None

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
    def short(self) -> str:
        """As few words as name it."""
        return ".".join(self.path[1:] if self.of_the_car or self.path[0] == PLACE.name else self.path)

    def shown(self, motion: Motion, samples: Sampled, degrees: bool = True) -> Array:
        """Its values as a picture has them, (N,): an angle in degrees, or in radians."""
        values = self.read(motion, samples)
        return values * degrees_of(self.unit)[0] if degrees else values

    def unit_shown(self, degrees: bool = True) -> str:
        """The unit of these."""
        return degrees_of(self.unit)[1] if degrees else self.unit


def numbers_of(scene: Scene) -> tuple[Number, ...]:
    """Time, travel of the wheel and inputs of a scene, and every number that it can ask for."""
    time = Number((TIME,), TIME, "s", "", lambda _, samples: samples.times)
    travel = [_travel(scene)] if scene.mechanism.topology.wheel_centre else []
    found: dict[tuple[str, ...], Number] = {}
    for number in (n for effect in (*ALWAYS, *EFFECTS.values()) for n in _of_effect(effect, scene)):
        # Two effects may give a number: it is there where one of them is asked for.
        if number.path not in found or found[number.path].missing:
            found[number.path] = number
    return (time, *travel, *_inputs(scene), *found.values())


def asking_for(scene: Scene, numbers: Sequence[str]) -> Scene:
    """The scene with the effects that give some numbers, of the car or by their paths, beside its own."""
    topology, had = scene.mechanism.topology, reversed(scene.mechanism.effects)
    givers = {number: effect for effect in had for number in EFFECTS[effect].names(topology)}
    paths = by_path(scene)
    missing = {n: one.missing.effect for n, one in paths.items() if one.missing is not None}
    wanted = (givers[number] if number in givers else missing.get(number, "") for number in numbers)
    effects = tuple(dict.fromkeys((*scene.effects, *filter(None, wanted))))
    return scene.model_copy(update={"effects": effects})


def by_path(scene: Scene) -> dict[str, Number]:
    """Forces and vectors, by QUANTITY.NAME or QUANTITY.NAME.COMPONENT."""
    every = numbers_of(scene)
    return {".".join(n.path): n for n in every if len(n.path) == 3 or (n.of_the_car and is_force(n.path[0]))}


def as_meant(scene: Scene) -> tuple[Scene, tuple[Number, ...]]:
    """A scene that asks for what its numbers' names mean by its convention too, and all its numbers under the
    names and with the signs that they have there."""
    convention, part = CONVENTIONS[scene.convention], scene.mechanism
    asked = (n.path[-1] for n in numbers_of(scene) if n.missing is None and len(n.path) < 3)
    had = {number for effect in part.effects for number in EFFECTS[effect].names(part.topology)}
    scene = asking_for(scene, [number for number, _ in map(convention.number, asked) if number in had])
    numbers = numbers_of(scene)
    ours = {number.path[-1]: number for number in numbers if number.of_the_car}
    return scene, tuple(_meant(number, ours, convention) for number in numbers)


def _meant(number: Number, ours: Mapping[str, Number], convention: Convention) -> Number:
    called, sign = convention.number(number.path[-1])
    same = called == number.path[-1] and sign > 0
    if same or called not in ours or len(number.path) > 2:
        return number
    own = ours[called]
    if sign > 0:
        return replace(own, path=number.path)
    words, opposite = f"minus {own.words}", f"not {own.sign}" if own.sign else ""
    return replace(
        own, path=number.path, words=words, sign=opposite, read=lambda *of: np.negative(own.read(*of))
    )


def _travel(scene: Scene) -> Number:
    """How far the wheel centre is above its place in the drawing as closed, against the chassis; mm."""
    up = np.array(scene.mechanism.up)

    def read(motion: Motion, samples: Sampled) -> Array:
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
    signs |= {name: f"{along}ward" for name, along in topology.chassis_motion.items()}
    turns = topology.chassis_turns.items()
    signs |= {name: f"right-handed about {along} through {about}" for name, (along, about) in turns}

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
    def read(_: Motion, samples: Sampled) -> Array:
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
    """The numbers that some words name: one, or the components of one vector.

    The words, with dots between them, are a quantity, a name and a component, of which those may be missing
    that are not needed; without a quantity the first that fits is meant, position before velocity.

    Raises:
        UsageError: they fit none, or numbers of more than one name.
        NotComputed: the scene does not ask for it; the message says how to.
    """
    parts = tuple(words.split("."))
    fitting = [n for n in numbers if _in_order(parts, n.path)]
    fitting = [n for n in fitting if n.path[0] == fitting[0].path[0]]
    if not fitting:
        known = dict.fromkeys(name for n in numbers for name in (n.short, ".".join(n.path), *n.path[:2]))
        raise UsageError(
            f"{shown(words)!r} names no number that is here{hint(words, known)}; {_there(numbers)}"
        )
    if len({n.path[:2] for n in fitting}) > 1:
        some = ", ".join(dict.fromkeys(".".join(n.path[:2]) for n in fitting))
        raise UsageError(f"{shown(words)!r} is more than one number; say which, such as {some}")
    for number in fitting:
        if number.missing is not None:
            raise number.missing
    return tuple(fitting)


def _in_order(parts: Sequence[str], path: Sequence[str]) -> bool:
    rest = iter(path)
    return all(part in rest for part in parts)


def _there(numbers: Sequence[Number]) -> str:
    """What can be asked for, in as few words as a line holds."""
    single = [n.short for n in numbers if len(n.path) < 3]
    vectors = gathered((n.path[0], n.path[1]) for n in numbers if n.path[2:] == ("x",))
    groups = gathered((", ".join(names), quantity) for quantity, names in vectors.items())
    told = [f"{' or '.join(q)} with a name and x, y or z, of {names}" for names, q in groups.items()]
    return f"there are: {'; '.join([', '.join(single), *told])}"


@dataclass(frozen=True)
class Curves:
    """What is drawn over what: one number over several, or several over one."""

    across: tuple[Number, ...]
    up: tuple[Number, ...]

    @property
    def pairs(self) -> tuple[tuple[Number, Number], ...]:
        """Each curve's two numbers."""
        return tuple(product(self.across, self.up))


def usual(scene: Scene, numbers: Sequence[Number], motion: Motion) -> Curves:
    """What an engineer wants to see first.

    The angles of the wheel against its travel, which goes upward on the paper, where the wheel goes mostly up
    and down; else against the one input that moves, or time. The wheel centre's place over time where there
    are no angles; without a wheel that of the first point that moves.
    """
    there = [n for n in numbers if n.missing is None]
    one: Mapping[str, Number] = {n.path[0]: n for n in there if len(n.path) == 1}
    angles = tuple(n for n in there if n.of_the_car and n.unit == "rad")
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
            return Curves(angles, (one[TRAVEL],))
    moving = [n for n in there if n.path[0] in scene.functions and np.ptp(n.read(motion, motion)) > 0.0]
    return Curves((moving[0] if len(moving) == 1 else one[TIME],), angles)
