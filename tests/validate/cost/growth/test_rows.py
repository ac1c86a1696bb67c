"""Growth as rows: planted exponents come out, and what is not measured says why."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from grown_tasks import FakeClock, Planted

from validate.cost.findings import growths
from validate.cost.growth.child import Limits
from validate.cost.growth.designs import INSTANTS, DesignsInALoop, DesignsTogether
from validate.cost.growth.instants import ManyInstants
from validate.cost.growth.rows import FULL, QUICK, Line, Plan, measure_growth, nearest_setting
from validate.cost.growth.task import Measured, Task, measure
from validate.cost.growth.unknowns import LongChain
from validate.cost.row import Row
from validate.cost.scenes import own_scene, study_scene
from validate.cost.store import Header, Store
from validate.cost.way import Setting
from validate.cost.ways.registry import WAYS, ways_named

STEER = study_scene("steer", own_scene("steer"))
SMALL = replace(
    FULL, instants=(100, 1_000, 10_000), designs=(1, 10, 100), unknowns=(15, 45, 150), limits=Limits(20.0)
)
OURS = ways_named(["series", "newton", "absolute"])


def memory() -> Store:
    return Store(None, Header.here())


class Planning:
    """In place of a process: seconds and bytes by a law of the task's kind and size."""

    def __init__(self, law: Callable[[Task], tuple[float, int]]) -> None:
        self.law = law
        self.measured: list[Task] = []

    def __call__(self, task: Task, limits: Limits) -> Measured:
        self.measured.append(task)
        seconds, bytes_ = self.law(task)
        clock = FakeClock()
        return replace(measure(Planted(clock, 1, seconds), limits.seconds, clock), peak_bytes=bytes_)


def in_proportion(task: Task) -> tuple[float, int]:
    return 1e-4 * task.size, 1000 * task.size


def test_planted_exponents_come_out_of_the_rows() -> None:
    exponents = {ManyInstants: 1.0, DesignsInALoop: 1.0, DesignsTogether: 0.7, LongChain: 2.8}

    def law(task: Task) -> tuple[float, int]:
        exponent = exponents[type(task)]
        return 1e-6 * task.size**exponent, int(1e4 * task.size ** (0.5 * exponent))

    found = measure_growth(memory(), [STEER], OURS, plan=SMALL, apart=Planning(law))
    expected = {"instants": 1.0, "unknowns": 2.8}
    for one in growths(found):
        exponent = expected.get(one.against, 0.7 if "together" in one.setting else 1.0)
        assert one.fit is not None
        # Bytes are rounded to whole ones, at ten thousand and more of them.
        wanted = exponent if one.of == "time" else 0.5 * exponent
        assert one.fit.exponent == pytest.approx(wanted, abs=1e-4), one
    lines = {(g.against, g.way, g.setting) for g in growths(found)}
    assert ("designs", "series", "1e-9 mm, together") in lines
    assert ("designs", "absolute", "one by one") in lines
    assert ("unknowns", "newton", "1e-9 mm") in lines


def test_a_row_says_what_was_varied_and_how_many_poses_it_is_of() -> None:
    found = measure_growth(memory(), [STEER], OURS, plan=SMALL, apart=Planning(in_proportion))
    by = {(row.against, row.scene, row.way, row.setting, row.size): row for row in found}
    assert len(by) == len(found) == 3 * (2 * 3 + 5 + 2)
    assert by["instants", "steer", "series", "1e-9 mm", 1000].configurations == 1000
    alone = by["designs", "steer, positions alone", "newton", "1e-9 mm, one by one", 10]
    assert alone.configurations == 10 * INSTANTS
    assert alone.peak_bytes == 10_000
    assert alone.times["solve"].median == pytest.approx(0.6 * 1e-3)
    assert by["unknowns", "chain of four-bars", "series", "1e-9 mm", 45].configurations == 5
    assert all(row.part == "growth" and row.status == "measured" for row in found)


def test_positions_alone_ask_for_nothing_else() -> None:
    apart = Planning(in_proportion)
    measure_growth(memory(), [STEER], OURS, plan=SMALL, apart=apart)
    asked = {task.scene.effects for task in apart.measured if isinstance(task, ManyInstants)}
    assert asked == {(), STEER.scene.effects}
    assert all(not t.scene.effects for t in apart.measured if isinstance(t, DesignsInALoop | DesignsTogether))


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (lambda task: (2.0 * task.size / 1000, 0), "a run would take some 200 s, as the smaller ones say"),
        (lambda task: (1e-3, 2**20 * task.size), "it would need some 98 GiB, as the smaller ones say"),
    ],
)
def test_what_would_take_too_much_is_left_out_with_the_reason(
    law: Callable[[Task], tuple[float, int]], words: str
) -> None:
    plan = replace(SMALL, instants=(100, 1_000, 100_000, 1_000_000), designs=(), unknowns=())
    apart = Planning(law)
    found = measure_growth(memory(), [STEER], ways_named(["series"]), plan=plan, apart=apart)
    assert [task.size for task in apart.measured] == [100, 100, 1000, 1000]
    left = [row for row in found if row.status == "left out"]
    assert {row.size for row in left} == {100_000, 1_000_000}
    assert left[0].reason.startswith(words)
    assert all(row.reason and not row.times and row.peak_bytes is None for row in left)


def test_sizes_above_one_that_failed_are_left_out() -> None:
    def apart(task: Task, limits: Limits) -> Measured:
        if task.size == 1000:
            return Measured("failed", "its process was\nended by the signal SIGKILL")
        return Planning(in_proportion)(task, limits)

    plan = replace(SMALL, designs=(), unknowns=(), alone=False)
    found = measure_growth(memory(), [STEER], ways_named(["series"]), plan=plan, apart=apart)
    assert [(row.size, row.status, row.reason) for row in found] == [
        (100, "measured", ""),
        (1000, "failed", "its process was ended by the signal SIGKILL"),
        (10_000, "left out", "1000 instants failed"),
    ]
    assert found[1].configurations == 0


def test_a_way_whose_package_is_missing_is_left_out() -> None:
    way = replace(ways_named(["series"])[0], package="not_a_package")
    plan = replace(SMALL, unknowns=(), designs=())
    apart = Planning(in_proportion)
    found = measure_growth(memory(), [STEER], [way], plan=plan, apart=apart)
    assert {row.status for row in found} == {"left out"}
    assert all("'not_a_package', which is not installed" in row.reason for row in found)
    assert not apart.measured


def test_a_killed_run_goes_on_where_it_stopped(tmp_path: Path) -> None:
    class Killed(Exception):
        pass

    first = Planning(in_proportion)

    def killed(task: Task, limits: Limits) -> Measured:
        if len(first.measured) == 7:
            raise Killed
        return first(task, limits)

    with pytest.raises(Killed):
        measure_growth(Store(tmp_path / "rows", Header.here()), [STEER], OURS, plan=SMALL, apart=killed)
    second = Planning(in_proportion)
    found = measure_growth(Store(tmp_path / "rows", Header.here()), [STEER], OURS, plan=SMALL, apart=second)
    assert len(second.measured) == len(found) - 7
    again = measure_growth(Store(tmp_path / "rows", Header.here()), [STEER], OURS, plan=SMALL, apart=killed)
    assert again == found


def test_progress_is_told_before_each_measurement() -> None:
    told: list[tuple[str, int, int]] = []
    measure_growth(
        memory(),
        [STEER],
        ways_named(["series"]),
        False,
        lambda what, done, of: told.append((what, done, of)),
        plan=replace(SMALL, designs=(), unknowns=(15,)),
        apart=Planning(in_proportion),
    )
    assert [done for _, done, _ in told] == list(range(7))
    assert {of for *_, of in told} == {7}
    assert told[0][0] == "growth: steer, positions alone, series 1e-9 mm, 100 instants"


@pytest.mark.parametrize("plan", [FULL, QUICK])
def test_plans_name_ways_and_methods_that_there_are(plan: Plan) -> None:
    for sizes in (plan.instants, plan.designs, plan.unknowns):
        assert list(sizes) == sorted(set(sizes))
    assert all(size % 3 == 0 for size in plan.unknowns)
    assert {"series", "newton", "absolute"} & set(plan.ways) <= {way.name for way in WAYS}


def test_a_way_is_set_as_near_to_a_nanometre_as_it_can_be() -> None:
    dial = tuple(Setting(f"{value:g}", value) for value in (1e-3, 1e-8, 1e-12))
    assert nearest_setting(dial).value == 1e-8
    assert nearest_setting((Setting("plain"),)).words == "plain"


def test_numbers_of_a_real_point_are_held_to_the_reference() -> None:
    (way,) = ways_named(["series"])
    task = ManyInstants(STEER.scene, way, nearest_setting(way.settings), 50)
    run = task.prepare()
    output = run.output(run.rates(run.solve()))
    errors = task.check(output)
    assert errors["position"].largest <= 1e-9
    assert {"velocity", "acceleration"} <= set(errors)
    # The last instant is among those that are checked.
    spoilt = {"wheel_centre": output["position"]["wheel_centre"].copy()}
    spoilt["wheel_centre"][-1, 2] += 1e-3
    worse = task.check({**output, "position": {**output["position"], **spoilt}})
    assert worse["position"].largest == pytest.approx(1e-3, rel=1e-5)


def test_a_line_measures_its_task_of_the_size() -> None:
    apart = Planning(in_proportion)
    line = Line(
        "designs", "car", "", "way", "", None, False, (1, 2), 3, lambda size: LongChain("series", size)
    )
    row: Row = line.row(6, [], Limits(), apart)
    assert (row.size, row.configurations) == (6, 18)
    assert apart.measured == [LongChain("series", 6)]
