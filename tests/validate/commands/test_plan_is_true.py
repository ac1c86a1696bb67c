"""What `pointcoord plan` says of a scene is so, of its effort too."""

import re

import numpy as np
import pytest
from changed_scenes import scene_with

from pointcoord import Motion, Scene, simulate
from pointcoord.simulation import Effort, effort
from validate.cli import main

TAKES = re.compile(
    r"accuracy: positions to (?P<tolerance>\S+) mm(?:, rates to (?P<part>\S+) of their size)?\n"
    r"solved at each step: .*\n"
    r"effort: (?P<segments>\d+) power series of orders? (?P<few>\d+)(?: to (?P<many>\d+))?, "
    r"(?P<orders>\d+) orders in all; (?P<all>\d+) factorisations, (?P<start>\d+) of them to assemble "
    r"the start\n"
)


def solved_as_planned(scene: Scene) -> tuple[Effort, Motion]:
    """The planned and the real effort, which are the same."""
    planned, motion = effort(scene), simulate(scene)
    work = motion.work
    assert (len(planned.solved.orders), sum(planned.solved.orders)) == (work.segments, work.series_orders)
    assert planned.work.factorisations == work.factorisations
    assert planned.work.residuals == work.residuals
    return planned, motion


@pytest.mark.parametrize("name", ["bounce", "five-link", "axle-roll", "bricard"])
def test_the_effort_that_is_planned_and_printed_is_the_work_of_the_solved_motion(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plan", name]) == 0
    said = TAKES.search(capsys.readouterr().out)
    assert said is not None
    scene = Scene.load(name)
    planned, motion = solved_as_planned(scene)
    work = motion.work
    assert (int(said["segments"]), int(said["orders"])) == (work.segments, work.series_orders)
    assert work.factorisations == int(said["all"])
    assert planned.task.start.work.factorisations == motion.start.work.factorisations == int(said["start"])
    assert (planned.solved.stop, planned.solved.status.complete) == (scene.time.stop, True)
    assert planned.tolerance == scene.tolerance == float(said["tolerance"])
    assert planned.part == pytest.approx(planned.tolerance / motion.unit, rel=1e-12)
    assert int(said["few"]) <= work.series_orders / work.segments <= int(said["many"] or said["few"])
    # Nothing is summed at the instants.
    assert planned.work.coordinates_evaluated == 0 < work.coordinates_evaluated


@pytest.mark.parametrize("tolerance", [1e-3, 1e-15])
def test_the_tolerance_that_is_planned_is_the_asked_one_or_the_finest(tolerance: float) -> None:
    planned, motion = solved_as_planned(Scene.load("five-link").model_copy(update={"tolerance": tolerance}))
    noted = any(note.startswith("the tolerance of ") for note in motion.notes)
    finest = planned.tolerance != pytest.approx(tolerance, rel=1e-12, abs=0.0)
    assert noted == finest == (tolerance < 1e-13)


def test_a_long_table_is_planned_by_a_map_and_says_why(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    times = np.linspace(0.0, 0.4, 2100)
    table = {"times": times.tolist(), "values": (9.0 * np.sin(times)).tolist()}
    scene = scene_with("steer", laws={"rack": {"table": table}})
    planned, motion = solved_as_planned(scene)
    assert planned.task.method.name == motion.method == "map"
    assert planned.solved.notes[0] in motion.notes
    monkeypatch.setattr("validate.commands.usage.load_scene", lambda _: scene)
    assert main(["plan", "steer"]) == 0
    out = capsys.readouterr().out
    assert "solved by a map of the inputs: series in time would be about 2.1e+03, and 2000 are" in out
    assert "in the inputs, each proven on a patch of their path, of order" in out
