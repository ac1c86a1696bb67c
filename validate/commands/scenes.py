"""`pointcoord plan`, `draw` and `scenes`: what is known of a scene before it is solved."""

from __future__ import annotations

import argparse

import numpy as np

from pointcoord import AssemblyError, PointcoordError, Scene, built_in_scenes, standing
from pointcoord.drawing_stands import Standing
from pointcoord.effects.plan import Plan, plan_effects
from pointcoord.effects.registry import ALWAYS, EFFECTS
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.structure import bodies_in_words, joints_in_words
from pointcoord.results.closing import ALLOWED
from pointcoord.scene.scene_file import MechanismPart
from pointcoord.simulation import effort, scene_mechanism
from validate.closed_drawing import closed_drawing, warnings_of
from validate.commands.usage import Command, load_scene, name_of, place_of_picture, told_as
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.picture import svg
from validate.plain_text import shown

PICTURES = (".svg",)
# Positions, velocities and so on, by time derivative.
STATES = tuple(
    f"{effect.quantities[0].words}s".replace("ys", "ies")
    for effect in (*ALWAYS, *EFFECTS.values())
    if effect.reports_states
)


def run_scenes(options: argparse.Namespace, console: Console) -> ExitStatus:
    """List the built-in scenes with their titles."""
    console.require("it is where the list goes")
    names = built_in_scenes()
    width = max(map(len, names))
    console.say("\n".join(f"{name.ljust(width)}  {Scene.load(name).title}" for name in names))
    return ExitStatus.AGREE


def run_draw(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Draw a scene's hardpoints."""
    target = place_of_picture(options, PICTURES, console)
    scene, name = load_scene(options.scene), name_of(options.scene)
    with told_as(name):
        drawing = closed_drawing(scene)
    for warning in warnings_of(scene, drawing.closing):
        console.warn(f"{name}: {warning}")
    console.put(target, svg(drawing), "the picture")
    return ExitStatus.AGREE


def run_plan(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Say what a scene would compute, and where its drawing stands."""
    console.require("it is where a plan goes")
    scene = load_scene(options.scene)
    plan = plan_effects(scene.effects, unreported=scene.unreported_points)
    part, name, silent = scene.mechanism, name_of(options.scene), scene.unreported_points
    with told_as(name):
        scene_mechanism(scene)
    side = f", {part.side} side" if part.structure.knuckles.get("knuckle") else ""
    lines = [
        f"{name}: {shown(scene.title)}" if scene.title else name,
        f"mechanism: {part.name}{side}; inputs: {', '.join(scene.inputs)}",
        *_mechanism(part),
        f"instants: {scene.time.samples} from {scene.time.start:g} to {scene.time.stop:g} s",
        *(f"computed: {effect.gives}" for effect in ALWAYS),
    ]
    if silent:
        lines.append(
            f"of the points: {', '.join(scene.reported_points)}; add {', '.join(silent)} to points to have "
            "them"
        )
    lines += [f"computed: {EFFECTS[effect].gives} ({effect})" for effect in plan.effects]
    if plan.left_out:
        plain = [effect for effect in plan.left_out if not EFFECTS[effect].base]
        made = [effect for effect in plan.left_out if EFFECTS[effect].base]
        more = f"; derivatives of these, such as {made[0]} and {made[-1]}, {len(made)} in all" if made else ""
        names = ", ".join(plain)
        lines.append(f"left out: {names}{more}; name one under effects to have it (pointcoord help effects)")
    console.say("\n".join([*lines, *_work(plan, part.topology), *_effort(scene, plan)]))
    return _say_where_it_stands(scene, name, console)


def _mechanism(part: MechanismPart) -> list[str]:
    """Bodies, joints, freedoms and what can be driven."""
    structure, topology = part.structure, part.topology
    count = part.freedoms
    others = [
        name
        for name, one in structure.inputs.items()
        if name not in (part.driven or ()) and not one.moves_the_chassis
    ]
    lines = [f"bodies: {'; '.join(bodies_in_words(structure))}", "joints:"]
    lines += [f"  {joint}" for joint in joints_in_words(structure)]
    lines.append(
        f"freedoms: {count}, held by {', '.join(topology.holding_inputs) or 'no input'}"
        + (f"; could be driven as well: {', '.join(others)}" if others else "")
    )
    left_out = topology.left_labels
    if left_out:
        lines.append(
            f"redundant: {', '.join(left_out)}; each follows from the other equations as drawn and is "
            "held to at every answer"
        )
    return lines


def _up_to(order: int) -> str:
    """Positions and their time derivatives up to an order, in words."""
    *first, last = STATES[: order + 1]
    return " and ".join(filter(None, (", ".join(first), last)))


def _work(plan: Plan, topology: Topology) -> list[str]:
    """To which time derivative points are solved and evaluated for that."""
    derivatives = plan.derivatives(topology)
    groups = [
        (_up_to(order), [name for name, highest in derivatives.items() if highest == order])
        for order in sorted(set(derivatives.values()), reverse=True)
    ]
    each = (f"{words} of {', '.join(names)}" for words, names in groups)
    every = len(derivatives) == len(topology.points) and len(groups) == 1
    evaluated = f"{groups[0][0]} of every point" if every else "; ".join(each)
    return [f"solved for: {_up_to(plan.derivative)}", f"evaluated: {evaluated}"]


def _effort(scene: Scene, plan: Plan) -> list[str]:
    """What the accuracy that is asked for makes the solver do."""
    try:
        found = effort(scene)
    except PointcoordError as error:
        return [f"takes: not known, because it cannot be solved: {error}"]
    rates = f", rates to {found.part:.2g} of their size" if plan.derivative else ""
    way = found.why or "solved by series in time, which are few enough; a map of the inputs is not needed"
    lines = [way, f"accuracy: positions to {found.tolerance:.3g} mm{rates}"]
    if found.orders:
        few, many = min(found.orders), max(found.orders)
        order = f"order {few}" if few == many else f"orders {few} to {many}"
        series = "1 power series" if len(found.orders) == 1 else f"{len(found.orders)} power series"
        if found.method == "map":
            series += " in the inputs, each proven on a patch of their way,"
        unknowns = [f"{found.moving} unknowns"]
        if found.still:
            unknowns.append(f"{found.still} more stand still and are solved once")
        if found.not_needed:
            unknowns.append(f"the {found.not_needed} of {', '.join(found.points_not_needed)} are not needed")
        where = "on each patch" if found.method == "map" else "at each step"
        lines.append(f"solved {where}: {'; '.join(unknowns)}")
        lines.append(
            f"takes: {series} of {order}, {sum(found.orders)} orders in all; {found.work.factorisations} "
            f"factorisations, {found.start.factorisations} of them to assemble the start"
        )
    if not found.status.complete:
        lines.append(f"up to t = {found.stop:.6g} s, where the motion stops")
    return lines


def _say_where_it_stands(scene: Scene, name: str, console: Console) -> ExitStatus:
    """The drawn inputs, how far each can go, the wheel's angles, and what closing the drawing moves."""
    try:
        with told_as(name):
            stands = standing(scene)
    except AssemblyError as error:
        console.complain(f"{name}: {error}")
        return ExitStatus.NO_VERDICT
    units, topology = scene.mechanism.topology.input_units, scene.mechanism.topology
    lines = ["as drawn:"]
    for one, value in stands.inputs.items():
        here = f"  {one} is {_told(value, units[one])}; the other inputs held, it"
        ends = stands.reach[one]
        if all(np.isinf(end.value) for end in ends):
            lines.append(f"{here} goes all the way round")
            continue
        low, high = (
            _told(end.value, units[one])
            + (f", where it is held by {', '.join(end.limits[:3])}" if end.limits else "")
            for end in ends
        )
        lines += [f"{here} reaches", f"    from {low}", f"    to   {high}"]
    lines += [f"  {angle} is {_degrees(value)} deg" for angle, value in stands.angles.items()]
    if topology.wheel_axis:
        inner, centre = (f"{end}{_default(scene, end)}" for end in topology.wheel_axis)
        lines.append(f"  the wheel turns about the line from {inner} to {centre}")
    lines.append(f"  {stands.closing.words}")
    console.say("\n".join(lines))
    if stands.closing.changes_the_car and not topology.puts_in_place:
        limit = f"{ALLOWED:.0%} of the car's size, {ALLOWED * stands.closing.size:.3g} mm"
        console.complain(
            f"{name}: mechanism.points: {stands.closing.words}: that is another car, which is refused; "
            f"allowed: {limit}; draw the points that miss where they belong"
        )
        return ExitStatus.WRONG_INPUT
    for warning in (*warnings_of(scene, stands.closing), *_out_of_reach(scene, stands)):
        console.warn(f"{name}: {warning}")
    return ExitStatus.AGREE


def _out_of_reach(scene: Scene, stands: Standing) -> list[str]:
    """Inputs that the scene drives farther than they go with the others as drawn."""
    told, units = [], scene.mechanism.topology.input_units
    for name, (low, high) in stands.reach.items():
        values = scene.functions[name].series(scene.instants, 0)[:, 0]
        least, most = float(values.min()), float(values.max())
        if least < low.value or most > high.value:
            told.append(
                f"the scene drives {name} from {_told(least, units[name])} to {_told(most, units[name])}, "
                "beyond what it reaches with the others as drawn"
            )
    return told


def _default(scene: Scene, point: str) -> str:
    """A word on a point that stands in for one that the scene leaves out."""
    left_out = (name for name, other in scene.mechanism.topology.stand_ins.items() if other == point)
    names = [name for name in left_out if name not in scene.mechanism.topology.points]
    return f" (the default of {names[0]})" if names else ""


def _degrees(angle: float) -> str:
    """An angle to a thousandth of a degree, and zero without a sign."""
    return f"{round(float(np.degrees(angle)), 3) + 0.0:g}"


def _told(value: float, unit: str) -> str:
    """A value in its unit, and an angle in degrees too."""
    return f"{value:.6g} {unit}" + (f" ({np.degrees(value):.5g} deg)" if unit == "rad" else "")


COMMANDS = {"plan": Command(run_plan), "draw": Command(run_draw), "scenes": Command(run_scenes)}
