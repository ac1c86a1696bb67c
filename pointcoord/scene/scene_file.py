"""The scene file: mechanism, inputs, instants, effects and tolerance.

A scene is checked when it is read. Every error names the file, the key, the value and what is allowed.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import IO, Annotated, Any, Self

from pydantic import Field

from pointcoord.effects.numbers import ConventionName
from pointcoord.effects.point_states import FIRST_NUMBERED, NAMED, STATES
from pointcoord.effects.registry import EFFECTS
from pointcoord.errors import MechanismError, SceneError
from pointcoord.mechanism.faults import TableFault, known_name, no_such
from pointcoord.mechanism.freedoms import Freedoms, askew_hinges
from pointcoord.mechanism.inputs import Names
from pointcoord.mechanism.structure import read
from pointcoord.numerics.arrays import Array
from pointcoord.results.even_instants import even_instants
from pointcoord.scene.input_part import LAWS, SWEEP, InputPart, kinds_of
from pointcoord.scene.mechanism_part import MechanismPart, by_dotted_name
from pointcoord.scene.reading import MM, UNITS, reading
from pointcoord.scene.scene_part import AS_LIST, Number, Part, Positive, Size, Text, Whole
from pointcoord.time_functions import TimeFunction
from pointcoord.toml_text import parsed, read_file, read_stream
from pointcoord.wording import meant, shown

# The built-in scenes. (Importing importlib.resources would take a fifth of numpy's import time.)
SCENES = Path(__file__).parents[1] / "scenes"

# Time of a scene that gives none, for a single pose and for a sweep; s.
ONE_POSE = {"start": 0.0, "stop": 0.0, "samples": 1}
PLAIN_TIME = {"start": 0.0, "stop": 1.0, "samples": 101}
# Seconds. The unit of time of a motion is at most 2^51, the power of two above 2e15 s. Its 20th power (the
# order of the series) stays below the largest double, 2^1024.
FARTHEST = 1e15
Instant = Annotated[Number, Field(ge=-FARTHEST, le=FARTHEST)]
# The axes of common chassis inputs that a mechanism file may define.
TURNS = {"roll": "forward", "pitch": "left"}
# Most instants of a scene: at this number, positions, velocities and accelerations of ten points take 7 GB.
MOST_SAMPLES = 10_000_000


class TimePart(Part):
    """The instants: `samples` evenly spaced instants from start to stop, both included; s."""

    start: Instant
    stop: Instant
    samples: Annotated[Whole, Field(ge=1, le=MOST_SAMPLES)]

    def agreed(self) -> Self:
        if not (self.start < self.stop if self.samples > 1 else self.start == self.stop):
            given = f"{self.samples} samples from {self.start} to {self.stop}"
            raise ValueError(f"{given}; allowed: start < stop, or one sample with start = stop")
        return self


class Scene(Part):
    """A checked scene; read one with `Scene.load` or make one with `Scene.from_mapping`.

    `points` names the points that are reported; all points by default. What neither these points nor the
    effects depend on is not solved for. `convention` chooses the convention in which tables, plots and result
    files give an angle asked for by its name; solving and comparing always use one definition.
    """

    title: Text = ""
    effects: Annotated[tuple[Text, ...], AS_LIST] = ()
    tolerance: Positive = 1e-9  # mm, once it is read
    convention: ConventionName = "iso"
    mechanism: MechanismPart
    inputs: dict[str, InputPart]
    time: TimePart
    points: Annotated[Names, AS_LIST] | None = None

    short_forms = ("units",)

    @classmethod
    def completed(cls, content: dict[str, Any]) -> dict[str, Any]:
        """The content with its lengths in mm, and the parts that later ones depend on read before these.

        Raises:
            SceneError: a file cannot be read.
            TableFault: a unit is unknown, or a part is wrong.
        """
        unit = content.pop("units", MM)
        if not isinstance(unit, str) or unit not in UNITS:
            raise TableFault(("units",), f"is {shown(unit)}", ", ".join(UNITS))
        with reading(unit=unit):
            for key, kind in (("tolerance", Size), ("mechanism", MechanismPart)):
                if key in content:
                    content[key] = read(kind, content[key], key)
            laws = by_dotted_name(content.get("inputs"), _is_no_part)
            if isinstance(laws, Mapping):
                kinds = set().union(*map(kinds_of, laws.values()))
                if SWEEP in kinds:
                    content.setdefault("time", PLAIN_TIME)
                elif kinds == {"constant"}:
                    content.setdefault("time", ONE_POSE)
                if "time" in content:
                    content["time"] = read(TimePart, content["time"], "time")
                if "mechanism" in content:
                    content["mechanism"] = content["mechanism"].driven_by(laws)
                content["inputs"] = {name: _law(name, law, content) for name, law in laws.items()}
        return content

    def agreed(self) -> Self:
        part = self.mechanism
        for name in self.effects:
            if name not in EFFECTS:
                raise _no_such_effect(name)
        for name in self.points or ():
            known_name("point of this car", name, part.structure.points, ("points",))
        for name in self.inputs:
            if name not in part.structure.inputs:
                fault = no_such("input", name, part.structure.inputs, ("inputs",))
                if name in TURNS:
                    turn = f'{name} = {{ turns = "chassis", about = "POINT", along = "{TURNS[name]}" }}'
                    fault.allowed += f"; to define it, write {turn} under [inputs] of your own mechanism file"
                raise fault
        self._inputs_hold_the_mechanism()
        start, stop = self.time.start, self.time.stop
        for name, law in self.inputs.items():
            for times in (table.times for table in law.tables):
                if not times[0] <= start <= stop <= times[-1]:
                    covers = f"the table of input {name!r} covers {times[0]} to {times[-1]} s"
                    raise TableFault(("inputs", name), covers, f"all of time, {start} to {stop} s")
        for name in self.effects:
            if problem := part.refusal(EFFECTS[name]):
                raise TableFault(("effects",), problem)
        return self

    def _inputs_hold_the_mechanism(self) -> None:
        """Check that as many inputs are driven as there are freedoms; building checks that they hold them.

        Raises:
            TableFault: too few or too many inputs, or points that make no mechanism.
        """
        part = self.mechanism
        try:
            topology = part.topology
            missing = topology.layout.unknowns - len(topology.labels)
            if not missing and not topology.fighting and topology.required_inputs:
                return
            freedoms = part.freedoms
        except MechanismError as error:
            of_points = ("points",) if set(error.names) <= set(part.points) else ()
            raise TableFault(("mechanism", *of_points), error.problem) from None
        known = {n: one for n, one in part.structure.inputs.items() if not one.moves_the_chassis}
        given = [name for name in known if name in self.inputs]
        others = ", ".join(name for name in known if name not in given) or "your own in [mechanism.inputs]"
        count = sum(known[name].holds for name in given)
        listed = f": {part.inputs_in_words(given)}" if given else ""
        words = (
            f"the {part.name} has {freedoms or 'no'} freedom{'' if freedoms == 1 else 's'}, and "
            f"{count} {'is' if count == 1 else 'are'} driven{listed}"
        )
        if not freedoms:
            askew = askew_hinges(part.structure, part.points)
            exact = f"; if the hinges {', '.join(askew)} are meant to be parallel, draw them exactly so"
            allowed = f"at least one freedom: leave out a rod or a slide{exact if askew else ''}"
            raise TableFault(("mechanism",), f"{words}; it is locked as drawn", allowed)
        allowed, more = "as many inputs as freedoms:", freedoms - count
        if more < 0:
            raise TableFault(("inputs",), words, f"{allowed} leave out {-more}")
        try:
            found = Freedoms.of(topology, part.points, part.directions)
            words += f"; free: {', '.join(found.free)}"
            words += f"; redundant: {', '.join(found.redundant)}" if found.redundant else ""
        except MechanismError:
            words += "; the drawing does not close"
        if more and missing:
            raise TableFault(
                ("inputs",), words, f"{allowed} drive {more} more of {others}, or add a missing rod"
            )
        same = f"; the inputs {', '.join(topology.fighting or given)} drive the same freedoms"
        raise TableFault(("inputs",), words + same, f"one of them less, and one of {others} instead")

    @property
    def reported_points(self) -> tuple[str, ...]:
        """The points that are reported, in the mechanism's order."""
        every = self.mechanism.topology.points
        return tuple(name for name in every if self.points is None or name in self.points)

    @property
    def unreported_points(self) -> tuple[str, ...]:
        reported = self.reported_points
        return tuple(name for name in self.mechanism.topology.points if name not in reported)

    @property
    def instants(self) -> Array:
        """The instants of the scene, shape (samples,), s."""
        return even_instants(self.time.start, self.time.stop, self.time.samples)

    @property
    def functions(self) -> dict[str, TimeFunction]:
        """Every input as a function of time."""
        return {name: law.function for name, law in self.inputs.items()}

    @classmethod
    def from_mapping(cls, content: Mapping[str, Any], source: str = "scene") -> Scene:
        """Check a scene given as plain data, as `tomllib` reads it.

        Raises:
            SceneError: the first fault, with its key, and the keys of further ones.
        """
        return cls.checked(content, source)

    @classmethod
    def load(cls, name: str | Path) -> Scene:
        """Read a built-in scene by name, or a scene file by path.

        Raises:
            SceneError: there is no such scene, its content is wrong, or the path is not a regular file of at
                most 64 MB.
        """
        allowed = f"a path, or one of {', '.join(built_in_scenes())}"
        if not isinstance(name, str | os.PathLike):
            problem = f"is of type {type(name).__name__}, not the name of a scene"
            raise SceneError(shown(name), "", problem, allowed)
        if str(name) in built_in_scenes():
            written = (SCENES / f"{name}.toml").read_bytes()
        else:
            written = read_file(name, f"{allowed}{meant(str(name), built_in_scenes())}")
        with reading(folder=Path(name).parent):
            return cls.from_mapping(parsed(written, str(name)), str(name))

    @classmethod
    def read(cls, stream: IO[bytes], source: str = "standard input") -> Scene:
        """Read a scene from an open binary stream, such as `sys.stdin.buffer`.

        Raises:
            SceneError: the content is wrong, or has no end within 64 MB.
        """
        return cls.from_mapping(parsed(read_stream(stream, source), source), source)


def _law(name: str, law: object, content: Mapping[str, Any]) -> InputPart:
    """The law of an input, read with the mechanism and the time in a scene's content."""
    part, time = content.get("mechanism"), content.get("time")
    changes: dict[str, Any] = {} if time is None else {"span": (time.start, time.stop)}
    if part is not None and name in part.structure.inputs:
        changes["drawn"] = partial(part.drawn_value, name)
        if part.structure.inputs[name].unit != MM:
            changes["unit"] = part.structure.inputs[name].unit
    with reading(**changes):
        found: InputPart = read(InputPart, law, "inputs", name)
        return found


def _no_such_effect(name: str) -> TableFault:
    of = next((one.name for one in EFFECTS.values() if name.rpartition(".")[2] in one.own_names), "")
    hint = f" ({of!r} gives it)" if of else meant(name, EFFECTS)
    if (order := name.removeprefix("derivative_")) in map(str, range(1, len(NAMED))):
        hint = f" ({STATES[int(order)]!r} is its name)"
    single = ", ".join(name for name, effect in EFFECTS.items() if not effect.base)
    allowed = f"{single}, {FIRST_NUMBERED} to {STATES[-1]}, and gradients"
    return TableFault(("effects",), f"no effect is called {shown(name)}{hint}", allowed)


def _is_no_part(table: Mapping[str, Any]) -> bool:
    """Whether a table of inputs is not a part's table: one of its entries is not an input."""
    return not all(isinstance(law, Mapping) and not law.keys().isdisjoint(LAWS) for law in table.values())


def built_in_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package."""
    return tuple(sorted(path.stem for path in SCENES.glob("*.toml")))
