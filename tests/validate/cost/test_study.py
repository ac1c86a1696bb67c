"""The study goes through its scenes, ways and settings."""

from typing import Any

import numpy as np

from pointcoord import Scene, simulate
from validate.cost.race import Effort, race
from validate.cost.scenes import own_scene, study_instants, with_rates
from validate.cost.study import Study, measure, runners_of
from validate.cost.table import measured_here
from validate.cost.way import Way
from validate.cost.ways.registry import ways_named

STEER = with_rates(own_scene("steer"))
BARE = STEER.model_copy(update={"effects": ()})
FEW = Effort(repeats=2, least=0.0)


def test_instants_are_special_to_no_way_and_one_lies_in_each_part_of_the_time() -> None:
    scene = own_scene("bounce")
    instants, time = study_instants(scene), scene.time
    assert np.floor(instants / time.stop * len(instants)).tolist() == list(range(len(instants)))
    special = [scene.instants, np.linspace(time.start, time.stop, 2 * len(instants) + 1)]
    for tolerance in (1e-3, 1e-9, 1e-13):
        solved: Any = simulate(scene.model_copy(update={"tolerance": tolerance})).solved
        special.append(np.array([segment.start for segment in solved.chain.segments]))
    assert np.abs(instants[:, None] - np.concatenate(special)).min() > 1e-9 * time.stop


def test_every_setting_is_raced_for_positions_alone_and_for_everything() -> None:
    ways = ways_named(["series", "absolute"])
    runners = runners_of("steer", STEER, ways)
    count = {way.name: sum(one.row.way == way.name for one in runners) for way in ways}
    assert count == {"series": 24, "absolute": 2}
    assert len(runners_of("bare", BARE, ways)) == 13
    alone = next(one for one in runners if one.row.quantity == "position")
    assert alone.set_up()().keys() == {"position"}
    rows = race(runners_of("steer", STEER, ways, quick=True), FEW)
    keys = [(row.way, row.setting, row.quantity) for row in rows]
    assert len(set(keys)) == len(keys)
    quantities = {row.quantity for row in rows if row.way == "series"}
    assert quantities == {"position", *dict.fromkeys(row.quantity for row in rows)}
    assert {"velocity", "acceleration", "angular_velocity", "angular_acceleration"} < quantities
    assert all(row.verdict == "measured" and row.poses == 24 for row in rows)


def test_a_way_that_is_not_installed_is_left_out_and_one_that_refuses_has_failed() -> None:
    def refuses(scene: Scene, value: float) -> Any:
        raise ValueError("it does not want to")

    ways = [Way("a", "", refuses, (1.0,), package="no_such_package"), Way("b", "", refuses, (1.0,))]
    rows = race(runners_of("steer", STEER, ways), FEW)
    assert {(row.way, row.verdict, row.reason) for row in rows} == {
        ("a", "left out", "needs the package 'no_such_package', which is not installed"),
        ("b", "failed", "ValueError: it does not want to"),
    }


def test_rows_say_where_they_were_measured_and_whether_it_was_a_quick_look() -> None:
    here = measured_here("a command")
    ((row,),) = measure(Study({"bare": BARE}, ways_named(["absolute"]), here, quick=True))
    assert {name: getattr(row, name) for name in here} == here
    assert (row.quick, row.verdict, row.scene) == (True, "measured", "bare")
