"""`pointcoord plan`, `draw` and `scenes`: what is known about a scene before its motion is solved."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np

from pointcoord import AssemblyError, PointcoordError, Scene, built_in_scenes, standing
from pointcoord.drawing_stands import Standing
from pointcoord.effects.registry import ALWAYS, EFFECTS, Plan, plan_effects
from pointcoord.mechanism.structure import joints_in_words
from pointcoord.method import MAP
from pointcoord.results.closing import ALLOWED
from pointcoord.simulation import effort, scene_mechanism
from validate.closed_drawing import closed_drawing, warnings_of
from validate.commands.pages import Command
from validate.commands.usage import named_scene, place_of_picture
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.picture import svg
from validate.plain_text import gathered, shown

# Names of the quantities by order of time derivative: positions, velocities and so on.
STATES = tuple(
    f"{effect.quantities[0].words}s".replace("ys", "ies")
    for effect in (*ALWAYS, *EFFECTS.values())
    if effect.reports_states
)


def run_scenes(options: argparse.Namespace, console: Console) -> ExitStatus:
    """List the built-in scenes with their titles."""
    names = built_in_scenes()
    width = max(map(len, names))
    console.say("\n".join(f"{name.ljust(width)}  {Scene.load(name).title}" for name in names))
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
    """What is computed, what is left out, and up to which time derivative the points are solved."""
    silent, topology = scene.unreported_points, scene.mechanism.topology
    yield f"instants: {scene.time.samples} from {scene.time.start:g} to {scene.time.stop:g} s"
    yield from (f"computed: {effect.gives}" for effect in ALWAYS)
    if silent:
        points, more = ", ".join(scene.reported_points), ", ".join(silent)
        yield f"points reported: {points}; to report {more}, add them to points"
    yield from (f"computed: {EFFECTS[effect].gives} ({effect})" for effect in plan.effects)
    if plan.left_out:
        plain = [effect for effect in plan.left_out if not EFFECTS[effect].base]
        made = [effect for effect in plan.left_out if EFFECTS[effect].base]
        more = f"; {len(made)} derivatives, such as {made[0]} and {made[-1]}" if made else ""
        how = "to compute one, name it under effects (pointcoord help effects)"
        yield f"left out: {', '.join(plain)}{more}; {how}"
    derivatives = sorted(plan.derivatives(topology).items(), key=lambda item: -item[1])
    groups = gathered((_up_to(order), name) for name, order in derivatives)
    every = len(derivatives) == len(topology.points) and len(groups) == 1
    yield f"solved for: {_up_to(plan.derivative)}"
    each = (f"{words} of {'every point' if every else ', '.join(names)}" for words, names in groups.items())
    yield f"evaluated: {'; '.join(each)}"


def _up_to(order: int) -> str:
    """Names of the position and its time derivatives up to an order, such as `positions and velocities`."""
    *first, last = STATES[: order + 1]
    return " and ".join(filter(None, (", ".join(first), last)))


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
        unknowns = [f"{found.unknowns} unknowns"]
        if found.not_needed:
            unknowns.append(f"the {found.not_needed} of {', '.join(task.unsolved)} are not needed")
        yield f"solved {'on each patch' if by_map else 'at each step'}: {'; '.join(unknowns)}"
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
    units = topology.input_units
    yield "as drawn:"
    for one, value in stands.inputs.items():
        ends = stands.reach[one]
        here = f"  {one} is {_in_unit(value, units[one])}; with the other inputs as drawn it"
        if all(np.isinf(end.value) for end in ends):
            yield f"{here} goes all the way round"
            continue
        yield f"{here} reaches"
        for word, end in zip(("from", "to  "), ends, strict=True):
            stop = f", stopped by {', '.join(end.limits[:3])}" if end.limits else ""
            yield f"    {word} {_in_unit(end.value, units[one])}{stop}"
    for angle, value in stands.angles.items():
        yield f"  {angle} is {round(float(np.degrees(value)), 3):zg} deg"
    if topology.wheel_axis:
        inner, centre = (f"{end}{_default(scene, end)}" for end in topology.wheel_axis)
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


def _default(scene: Scene, point: str) -> str:
    """A remark on a point that is used in place of one that the scene leaves out; empty for other points."""
    topology = scene.mechanism.topology
    names = [n for n, other in topology.stand_ins.items() if other == point and n not in topology.points]
    return f" (the default of {names[0]})" if names else ""


def _in_unit(value: float, unit: str) -> str:
    """A value with its unit; an angle also in degrees."""
    return f"{value:.6g} {unit}" + (f" ({np.degrees(value):.5g} deg)" if unit == "rad" else "")


COMMANDS = {"plan": Command(run_plan), "draw": Command(run_draw), "scenes": Command(run_scenes)}
