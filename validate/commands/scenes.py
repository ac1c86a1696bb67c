"""`pointcoord plan` and `pointcoord scenes`: what a scene would compute, and which scenes there are."""

from __future__ import annotations

import argparse

import numpy as np

from pointcoord import AssemblyError, Scene, built_in_scenes, standing
from pointcoord.drawing_stands import End, Standing
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import ALWAYS, EFFECTS
from pointcoord.results.closing import ALLOWED
from validate.closed_drawing import warnings_of
from validate.commands.usage import add_scene, load_scene, name_of, told_as
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.plain_text import shown


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add both commands."""
    plan = commands.add_parser("plan", help="say what a scene would compute, what not, and why")
    add_scene(plan)
    plan.set_defaults(run=run_plan)
    scenes = commands.add_parser("scenes", help="list the built-in scenes")
    scenes.set_defaults(run=run_scenes)


def run_plan(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Say what a scene would compute.

    Raises:
        SceneError: the scene is wrong.
        OutputError: standard output does not take it.
    """
    console.require("it is where a plan goes")
    scene = load_scene(options.scene)
    plan = plan_effects(scene.effects)
    evaluated = plan.derivatives(scene.mechanism.topology).values()
    name = name_of(options.scene)
    lines = [
        f"{name}: {shown(scene.title)}" if scene.title else name,
        f"mechanism: {scene.mechanism.type}, {scene.mechanism.side} side; inputs: {', '.join(scene.inputs)}",
        f"instants: {scene.time.samples} from {scene.time.start:g} to {scene.time.stop:g} s",
        *(f"computed: {effect.gives}" for effect in ALWAYS),
        *(f"computed: {EFFECTS[effect].gives} ({effect})" for effect in plan.effects),
        *(
            f"left out: {EFFECTS[effect].gives}; add {effect!r} to effects to have it"
            for effect in plan.left_out
        ),
        f"derivatives solved for: {plan.derivative}; evaluated for every point: {min(evaluated)}, "
        f"for some: {max(evaluated)}",
    ]
    console.say("\n".join(lines))
    return _say_where_it_stands(scene, name, console)


def _say_where_it_stands(scene: Scene, name: str, console: Console) -> ExitStatus:
    """The drawn inputs, how far each can go, the wheel's angles, and what closing the drawing moves."""
    try:
        with told_as(name):
            stands = standing(scene)
    except AssemblyError as error:
        console.complain(f"{name}: {error}")
        return ExitStatus.NO_VERDICT
    lines = [
        f"drawn {input_name} = {_told(input_name, value)}; from there, the others held, it can go from "
        f"{' to '.join(_end(input_name, end) for end in stands.reach[input_name])}"
        for input_name, value in stands.inputs.items()
    ]
    inner = "wheel_axis_inner" if "wheel_axis_inner" in scene.mechanism.points else "strut_lower (by default)"
    angles = ", ".join(f"{name} {_degrees(angle)} deg" for name, angle in stands.angles.items())
    lines.append(f"there: {angles}; the wheel turns about the line from {inner} to wheel_centre")
    lines.append(stands.closing.words)
    console.say("\n".join(lines))
    if stands.closing.changes_the_car and scene.mechanism.closure == "drawn":
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
    told = []
    for name, (low, high) in stands.reach.items():
        values = scene.functions[name].series(scene.instants, 0)[:, 0]
        least, most = float(values.min()), float(values.max())
        if least < low.value or most > high.value:
            told.append(
                f"the scene drives {name} from {_told(name, least)} to {_told(name, most)}, beyond what it "
                "reaches with the others as drawn"
            )
    return told


def _degrees(angle: float) -> str:
    """An angle to a thousandth of a degree, and zero without a sign."""
    return f"{round(float(np.degrees(angle)), 3) + 0.0:g}"


def _told(name: str, value: float) -> str:
    return f"{value:.6g} rad ({np.degrees(value):.5g} deg)" if name == "arm_angle" else f"{value:.6g} mm"


def _end(name: str, end: End) -> str:
    held = f" (limited by {end.limits[0]})" if end.limits else ""
    return _told(name, end.value) + held


def run_scenes(options: argparse.Namespace, console: Console) -> ExitStatus:
    """List the built-in scenes with their titles.

    Raises:
        OutputError: standard output does not take it.
    """
    console.require("it is where the list goes")
    names = built_in_scenes()
    width = max(len(name) for name in names)
    console.say("\n".join(f"{name.ljust(width)}  {Scene.load(name).title}" for name in names))
    return ExitStatus.AGREE
