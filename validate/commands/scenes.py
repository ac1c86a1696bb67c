"""`pointcoord scenes`, `new`, `draw` and `plan`: a scene before its motion is solved."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pointcoord import AssemblyError, PointcoordError, Scene, UnknownName, built_in_scenes, standing
from pointcoord.drawing_stands import Standing
from pointcoord.effects.registry import ALWAYS, EFFECTS, Plan, plan_effects
from pointcoord.mechanism.file import MECHANISMS
from pointcoord.mechanism.structure import joints_in_words
from pointcoord.method import MAP
from pointcoord.results.closing import ALLOWED
from pointcoord.scene.scene_file import SCENES
from pointcoord.simulation import effort, scene_mechanism
from validate.closed_drawing import closed_drawing, warnings_of
from validate.commands.pages import Command, parts
from validate.commands.usage import named_scene, place_of_picture
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.files import require_writable
from validate.output.picture import svg
from validate.plain_text import shown, typed
from validate.toml_written import value_of

TYPE = re.compile(r'^(type *= *)"(\w+)"', re.MULTILINE)


def run_scenes(options: argparse.Namespace, console: Console) -> ExitStatus:
    """List the built-in scenes with their titles."""
    names = built_in_scenes()
    width = max(map(len, names))
    console.say("\n".join(f"{name.ljust(width)}  {Scene.load(name).title}" for name in names))
    return ExitStatus.AGREE


def run_new(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Write a copy of a built-in scene, and of its mechanism."""
    name, copied = options.name.removesuffix(".toml"), vars(options)["from"]
    if os.path.basename(name) in ("", "-"):
        raise UsageError(
            f"NAME is {shown(options.name)!r}, which names no file; allowed: the name of the new files, "
            "without .toml"
        )
    if copied not in built_in_scenes():
        raise UnknownName("built-in scene", copied, built_in_scenes())
    text, notes = (SCENES / f"{copied}.toml").read_text(encoding="utf-8"), parts("new-files")
    kind = value_of(f"{Path(name).name}-mechanism.toml")
    own = TYPE.sub(lambda found: found[1] + kind, text)
    files = {f"{name}.toml": f"{notes['scene'].replace('$name', shown(name))}\n{own}"}
    if (found := TYPE.search(text)) is not None:
        tables = (MECHANISMS / f"{found[2]}.toml").read_text(encoding="utf-8")
        files[f"{name}-mechanism.toml"] = f"{notes['mechanism']}\n{tables}"
    for target in files:
        if os.path.exists(target):
            raise UsageError(f"{shown(target)} exists already; allowed: the name of a new file")
        require_writable(target)
    for target, content in files.items():
        console.put(target, content, "the scene or its mechanism")
    console.say(
        f"{' and '.join(map(shown, files))} written, copied from {shown(copied)}\n"
        f"to copy another (pointcoord scenes): --from SCENE; try: pointcoord plan {typed(f'{name}.toml')}"
    )
    return ExitStatus.AGREE


def run_draw(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Draw a scene's hardpoints."""
    target = place_of_picture(options, console)
    with named_scene(options.scene) as (scene, name):
        drawing = closed_drawing(scene)
    console.warn(*warnings_of(scene, drawing.closing), of=name)
    console.put(target, svg(drawing), "the picture")
    return ExitStatus.AGREE


def run_plan(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print what a scene computes, its drawn inputs and their ranges."""
    with named_scene(options.scene) as (scene, name):
        scene_mechanism(scene)
        plan = plan_effects(scene.effects, unreported=scene.unreported_points)
        console.say("\n".join([*_mechanism(scene, name), *_computed(scene, plan), *_effort(scene, plan)]))
        try:
            stands = standing(scene)
        except AssemblyError as error:
            console.complain(f"{name}: {error}")
            return ExitStatus.NO_VERDICT
    console.say("\n".join(_where_it_stands(scene, stands)))
    if stands.closing.changes_the_car and not scene.mechanism.topology.puts_in_place:
        limit = f"{ALLOWED:.0%} of the car's size, {ALLOWED * stands.closing.size:.3g} mm"
        console.complain(
            f"{name}: mechanism.points: {stands.closing.words}: that is another car, and the drawing is "
            f"refused; allowed: {limit}; correct the points that miss"
        )
        return ExitStatus.WRONG_INPUT
    console.warn(*warnings_of(scene, stands.closing), *_out_of_reach(scene, stands), of=name)
    return ExitStatus.AGREE


def _mechanism(scene: Scene, name: str) -> Iterator[str]:
    """Bodies, joints, degrees of freedom and possible inputs."""
    part, structure, topology = scene.mechanism, scene.mechanism.structure, scene.mechanism.topology
    side = f", {part.side} side" if structure.knuckles.get("knuckle") else ""
    yield f"{name}: {shown(scene.title)}" if scene.title else name
    yield f"mechanism: {part.name}{side}; inputs: {', '.join(scene.inputs)}"
    bodies = (f"{body}: {', '.join(points)}" for body, points in structure.moving_bodies.items())
    yield f"bodies: {'; '.join(bodies)}"
    yield from ("joints:", *(f"  {joint}" for joint in joints_in_words(structure)))
    inputs = structure.inputs.items()
    others = [n for n, one in inputs if n not in (part.driven or ()) and not one.moves_the_chassis]
    could = f"; could be driven instead: {', '.join(others)}" if others else ""
    held = part.inputs_in_words(topology.holding_inputs) or "no input"
    yield f"degrees of freedom: {part.freedoms}, driven by {held}{could}"
    if topology.left_labels:
        labels, why = ", ".join(topology.left_labels), "as drawn, each follows from the other equations"
        yield f"redundant: {labels}; {why}; each is checked at every solution"


def _computed(scene: Scene, plan: Plan) -> Iterator[str]:
    """The instants, what is computed, and what is left out."""
    yield f"instants: {scene.time.samples} from {scene.time.start:g} to {scene.time.stop:g} s"
    yield from (f"computed: {effect.gives}" for effect in ALWAYS)
    if silent := scene.unreported_points:
        points, more = ", ".join(scene.reported_points), ", ".join(silent)
        yield f"points reported: {points}; to report {more}, add them to points"
    yield from (f"computed: {EFFECTS[effect].gives} ({effect})" for effect in plan.effects)
    if plan.left_out:
        plain = [effect for effect in plan.left_out if not EFFECTS[effect].base]
        made = [effect for effect in plan.left_out if EFFECTS[effect].base]
        more = f"; {len(made)} derivatives, such as {made[0]} and {made[-1]}" if made else ""
        how = "to compute one, name it under effects (pointcoord help effects)"
        yield f"left out: {', '.join(plain)}{more}; {how}"


def _effort(scene: Scene, plan: Plan) -> Iterator[str]:
    """The method, the accuracy and the number of terms that the solver needs."""
    try:
        found = effort(scene)
    except PointcoordError as error:
        yield f"effort: not known, because the scene cannot be solved: {error}"
        return
    task, solved, orders = found.task, found.solved, found.solved.orders
    by_map = task.method is MAP
    few_needed = "solved by series in time: few are needed, so no map of the inputs is built"
    yield solved.notes[0] if by_map else few_needed
    rates = f", rates to {found.part:.2g} of their size" if plan.derivative else ""
    yield f"accuracy: positions to {found.tolerance:.3g} mm{rates}"
    if orders:
        few, many = min(orders), max(orders)
        yield f"solved {'on each patch' if by_map else 'at each step'}: {found.unknowns} unknowns"
        series = "1 power series" if len(orders) == 1 else f"{len(orders)} power series"
        series += " in the inputs, each proven on a patch of their path," if by_map else ""
        yield (
            f"effort: {series} of {f'order {few}' if few == many else f'orders {few} to {many}'}, "
            f"{sum(orders)} orders in all; {found.work.factorisations} factorisations, "
            f"{task.start.work.factorisations} of them to assemble the start"
        )
    if not solved.status.complete:
        yield f"up to t = {max(solved.stop, scene.time.start):.6g} s, where the motion stops"


def _where_it_stands(scene: Scene, stands: Standing) -> Iterator[str]:
    """The drawn inputs, the range of each, the wheel angles, and how far closing moves the points."""
    topology = scene.mechanism.topology
    yield "as drawn:"
    for one, value in stands.inputs.items():
        ends, unit = stands.reach[one], topology.input_units[one]
        here = f"  {one} is {_in_unit(value, unit)}; with the other inputs as drawn it"
        if all(np.isinf(end.value) for end in ends):
            yield f"{here} goes all the way round"
            continue
        yield f"{here} reaches"
        for word, end in zip(("from", "to  "), ends, strict=True):
            stop = f", stopped by {', '.join(end.limits[:3])}" if end.limits else ""
            yield f"    {word} {_in_unit(end.value, unit)}{stop}"
    for angle, value in stands.angles.items():
        yield f"  {angle} is {round(float(np.degrees(value)), 3):zg} deg"
    if topology.wheel_axis:
        left_out = {n: point for n, point in topology.stand_ins.items() if n not in topology.points}
        defaults = {point: f"{point} (the default of {n})" for n, point in reversed(left_out.items())}
        inner, centre = (defaults.get(end, end) for end in topology.wheel_axis)
        yield f"  the wheel turns about the line from {inner} to {centre}"
    yield f"  {stands.closing.words}"


def _out_of_reach(scene: Scene, stands: Standing) -> Iterator[str]:
    """Inputs that the scene drives beyond their range with the other inputs as drawn."""
    for name, (low, high) in stands.reach.items():
        values = scene.functions[name].series(scene.instants, 0)[:, 0]
        least, most = float(values.min()), float(values.max())
        if least < low.value or most > high.value:
            unit = scene.mechanism.topology.input_units[name]
            driven = f"the scene drives {name} from {_in_unit(least, unit)} to {_in_unit(most, unit)}"
            yield f"{driven}, beyond its range with the other inputs as drawn"


def _in_unit(value: float, unit: str) -> str:
    """A value with its unit; an angle also in degrees."""
    return f"{value:.6g} {unit}" + (f" ({np.degrees(value):.5g} deg)" if unit == "rad" else "")


COMMANDS = {
    "scenes": Command(run_scenes),
    "new": Command(run_new),
    "draw": Command(run_draw),
    "plan": Command(run_plan),
}
