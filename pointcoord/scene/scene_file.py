"""The scene file: mechanism, inputs, instants, effects and tolerance.

A scene is checked when it is read. Every error names the file, the key, the value and what is allowed.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import IO, Annotated, Any

from pydantic import Field, ValidationInfo, field_validator

from pointcoord.effects.numbers import ConventionName
from pointcoord.effects.point_states import FIRST_NUMBERED, NAMED, STATES
from pointcoord.effects.registry import EFFECTS
from pointcoord.errors import MechanismError, SceneError
from pointcoord.mechanism.faults import TableFault, no_such
from pointcoord.mechanism.file import is_path, whole_tables
from pointcoord.mechanism.freedoms import Freedoms, askew_hinges
from pointcoord.mechanism.inputs import Names
from pointcoord.numerics.arrays import Array
from pointcoord.results.even_instants import even_instants
from pointcoord.scene.input_part import LAWS, SWEEP, InputPart, kinds_of, read_in, swept, with_drawn
from pointcoord.scene.mechanism_part import MechanismPart, by_dotted_name
from pointcoord.scene.own_units import MM, law_scaled, mm_of, scaled
from pointcoord.scene.scene_part import AS_LIST, Number, Part, Positive, Text, Whole
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

    def agree(self) -> None:
        if self.samples == 1 and self.start != self.stop:
            raise ValueError(
                f"one sample from {self.start} to {self.stop}; allowed: start = stop, or at least 2 samples"
            )
        if self.samples > 1 and not self.start < self.stop:
            raise ValueError(f"start {self.start} is not before stop {self.stop}; allowed: start < stop")


class Scene(Part):
    """A checked scene; read one with `Scene.load` or make one with `Scene.from_mapping`.

    `points` names the points that are reported; all points by default. What neither these points nor the
    effects depend on is not solved for. `convention` chooses the convention in which tables, plots and result
    files give an angle asked for by its name; solving and comparing always use one definition.
    """

    title: Text = ""
    effects: Annotated[tuple[Text, ...], AS_LIST] = ()
    tolerance: Positive = 1e-9
    convention: ConventionName = "iso"
    mechanism: MechanismPart
    inputs: dict[str, InputPart]
    time: TimePart
    points: Annotated[Names, AS_LIST] | None = None

    short_forms = ("units",)

    @classmethod
    def completed(cls, content: dict[str, Any]) -> dict[str, Any]:
        """The content in mm, with inputs by dotted names (they may be in a table for each part), and sweeps
        as polynomials.

        Raises:
            SceneError: a table's file cannot be read.
            TableFault: a sweep is not a pair of numbers or has no time span; a unit is unknown.
        """
        units, inputs = content.pop("units", MM), content.pop("inputs", None)
        if inputs is not None:
            inputs = read_in(by_dotted_name(inputs, _is_no_part), units)
        if (factor := mm_of(units)) != 1.0:
            content = scaled(content, factor)
        if inputs is None:
            return content
        if not isinstance(inputs, Mapping):
            return {**content, "inputs": inputs}
        # Checked here and taken as it is by the scene's own checks, which report an invalid one.
        part = _part_of(content.get("mechanism"))
        if part is not None:
            content["mechanism"] = part = part.driven_by(inputs)
        known = {} if part is None else part.structure.inputs
        kinds = set().union(*map(kinds_of, inputs.values()))
        if SWEEP in kinds:
            content.setdefault("time", PLAIN_TIME)
        elif kinds == {"constant"}:
            content.setdefault("time", ONE_POSE)
        content["inputs"] = laws = {}
        for name, law in inputs.items():
            if name in known and known[name].unit == "mm":
                law = law_scaled(law, factor)
            law = with_drawn(law, float if part is None else partial(part.drawn_value, name))
            laws[name] = swept(law, content.get("time"), ("inputs", name))
        return content

    @field_validator("effects")
    @classmethod
    def _known_effects(cls, effects: tuple[str, ...]) -> tuple[str, ...]:
        for name in effects:
            if name not in EFFECTS:
                givers = [
                    effect.name for effect in EFFECTS.values() if name.rpartition(".")[2] in effect.own_names
                ]
                if (order := name.removeprefix("derivative_")) in map(str, range(1, len(NAMED))):
                    hint = f" ({STATES[int(order)]!r} is its name)"
                else:
                    hint = f" ({givers[0]!r} gives it)" if givers else meant(name, EFFECTS)
                allowed = [name for name, effect in EFFECTS.items() if not effect.base]
                more = f"{FIRST_NUMBERED} to {STATES[-1]}, and gradients"
                raise TableFault(
                    (),
                    f"no effect is called {shown(name)}{hint}",
                    ", ".join((*allowed, more)),
                )
        return effects

    @field_validator("points")
    @classmethod
    def _points_of_the_car(
        cls, points: tuple[str, ...] | None, others: ValidationInfo
    ) -> tuple[str, ...] | None:
        if points is None or "mechanism" not in others.data:
            return points
        there = others.data["mechanism"].structure.points
        for name in points:
            if name not in there:
                raise no_such("point of this car", name, there)
        return points

    def agree(self) -> None:
        self._inputs_fit()
        self._effects_have_a_meaning()

    def _effects_have_a_meaning(self) -> None:
        for name in self.effects:
            problem = self.mechanism.refusal(EFFECTS[name])
            if problem:
                raise TableFault(("effects",), problem)

    def _inputs_fit(self) -> None:
        known = self.mechanism.structure.inputs
        for name in self.inputs:
            if name not in known:
                fault = no_such("input", name, known, ("inputs",))
                if name in TURNS:
                    turn = f'{name} = {{ turns = "chassis", about = "POINT", along = "{TURNS[name]}" }}'
                    fault.allowed += f"; to define it, write {turn} under [inputs] of your own mechanism file"
                raise fault
        self._inputs_hold_the_mechanism()
        for name, law in self.inputs.items():
            for table in law.tables:
                if table.times[0] <= self.time.start and self.time.stop <= table.times[-1]:
                    continue
                raise TableFault(
                    ("inputs", name),
                    f"the table of input {name!r} covers {table.times[0]} to {table.times[-1]} s",
                    f"all of time, {self.time.start} to {self.time.stop} s",
                )

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
        names = [name for name, one in part.structure.inputs.items() if not one.moves_the_chassis]
        given = [name for name in names if name in self.inputs]
        count = sum(part.structure.inputs[name].holds for name in given)
        listed = f": {part.inputs_in_words(given)}" if given else ""
        driven = f"and {count} {'is' if count == 1 else 'are'} driven{listed}"
        if not freedoms:
            askew = askew_hinges(part.structure, part.points)
            exact = f"; if the hinges {', '.join(askew)} are meant to be parallel, draw them exactly so"
            raise TableFault(
                ("mechanism",),
                f"the {part.name} is locked: it has no freedom as drawn, "
                f"{driven if given else 'a structure that nothing moves'}",
                f"at least one freedom: leave out a rod or a slide{exact if askew else ''}",
            )
        words = f"the {part.name} has {freedoms} freedom{'' if freedoms == 1 else 's'}, {driven}"
        more = freedoms - count
        if more < 0:
            raise TableFault(("inputs",), words, f"as many inputs as freedoms: leave out {-more}")
        others = (
            ", ".join(name for name in names if name not in given)
            or "your own, to be written in [mechanism.inputs]"
        )
        try:
            found = Freedoms.of(topology, part.points, part.directions)
            free, lost = ", ".join(found.free), ", ".join(found.redundant)
        except MechanismError:
            free, lost = "unknown, since the drawing does not close", ""
        if more and missing:
            allowed = f"as many inputs as freedoms: drive {more} more of {others}, or add a missing rod"
            raise TableFault(("inputs",), f"{words}; free: {free}", allowed)
        same = ", ".join(topology.fighting or given)
        words = (
            f"the inputs {same} drive the same freedoms of the {part.name}, so that others stay free: {free}"
        )
        if lost:
            words += f"; redundant in the drawing: {lost}"
        raise TableFault(("inputs",), words, f"one of them less, and one of {others} instead")

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
        if not isinstance(name, str | os.PathLike):
            allowed = f"a path, or one of {', '.join(built_in_scenes())}"
            raise SceneError(
                shown(name), "", f"is of type {type(name).__name__}, not the name of a scene", allowed
            )
        if str(name) in built_in_scenes():
            written = (SCENES / f"{name}.toml").read_bytes()
        else:
            hint = meant(str(name), built_in_scenes())
            written = read_file(name, f"a path, or one of {', '.join(built_in_scenes())}{hint}")
        return cls.from_mapping(_found_beside(parsed(written, str(name)), Path(name).parent), str(name))

    @classmethod
    def read(cls, stream: IO[bytes], source: str = "standard input") -> Scene:
        """Read a scene from an open binary stream, such as `sys.stdin.buffer`.

        Raises:
            SceneError: the content is wrong, or has no end within 64 MB.
        """
        return cls.from_mapping(parsed(read_stream(stream, source), source), source)


def _part_of(mechanism: object) -> MechanismPart | None:
    """A scene's mechanism; None if it is invalid, which the scene's checks report."""
    try:
        return MechanismPart.checked(mechanism, "scene")
    except SceneError:
        return None


def _is_no_part(table: Mapping[str, Any]) -> bool:
    """Whether a table of inputs is not a part's table: one of its entries is not an input."""
    return not all(
        isinstance(law, Mapping) and not law.keys().isdisjoint((*LAWS, SWEEP)) for law in table.values()
    )


def _found_beside(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A scene's content with paths of mechanism files counted from a folder, and its tables read."""
    if "inputs" in content:
        content = {**content, "inputs": read_in(content["inputs"], content.get("units", MM), folder)}
    mechanism = content.get("mechanism")
    if not isinstance(mechanism, dict):
        return content
    if is_path(mechanism.get("type")):
        return {**content, "mechanism": {**mechanism, "type": str(folder / mechanism["type"])}}
    return {**content, "mechanism": whole_tables(mechanism, folder)}


def built_in_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package."""
    return tuple(sorted(path.stem for path in SCENES.glob("*.toml")))
