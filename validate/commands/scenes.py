"""`pointcoord plan` and `pointcoord scenes`: what a scene would compute, and which scenes there are."""

from __future__ import annotations

import argparse

from pointcoord import Scene, built_in_scenes
from pointcoord.effects import EFFECTS, plan_effects
from validate.commands.usage import SCENE_HELP, STANDARD_INPUT, STANDARD_INPUT_NAME, load_scene
from validate.exit_status import ExitStatus
from validate.output import Console, shown


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add both commands."""
    plan = commands.add_parser("plan", help="say what a scene would compute, what not, and why")
    plan.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
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
    name = STANDARD_INPUT_NAME if options.scene == STANDARD_INPUT else shown(options.scene)
    lines = [
        f"{name}: {shown(scene.title)}" if scene.title else name,
        f"mechanism: {scene.mechanism.type}, {scene.mechanism.side} side; inputs: {', '.join(scene.inputs)}",
        f"instants: {scene.time.samples} from {scene.time.start:g} to {scene.time.stop:g} s",
        "computed: position of every point, mm",
        *(f"computed: {EFFECTS[effect].gives} ({effect})" for effect in plan.effects),
        *(
            f"left out: {EFFECTS[effect].gives}; add {effect!r} to effects to have it"
            for effect in plan.left_out
        ),
        f"derivatives solved for: {plan.derivative}; evaluated for every point: {plan.derivative_of_points}, "
        f"for the knuckle's points: {plan.derivative_of_knuckle}",
    ]
    console.say("\n".join(lines))
    return ExitStatus.AGREE


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
