"""A motion through a map of its inputs: the same numbers as by series, however long or rough it is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import (
    AssemblyError,
    Motion,
    MotionNotMapped,
    MotionTooLong,
    PointcoordError,
    Scene,
    simulate,
    simulation,
    standing,
)
from pointcoord.effects.registry import EFFECTS
from pointcoord.method import MAP
from pointcoord.patches import way_map
from pointcoord.patches.domain import Domain
from pointcoord.patches.lookup import Lookup, Marked, touched
from pointcoord.patches.path import Spans, covered_until, way_of
from pointcoord.patches.way_map import map_way, starts_on
from pointcoord.simulation import map_limits, prepare_task
from pointcoord.solve.assembly import close_drawing, follow, stepped
from pointcoord.time_functions import Polynomial, Sine, Table, TimeFunction

Array = NDArray[np.float64]
Make = Callable[..., Scene]
BUILT_IN = ("bounce", "steer", "bounce-and-steer", "double-wishbone", "bounce-on-a-heaving-chassis")


def table(rows: int, middle: float, size: float, turns: float = 3.0, noise: float = 0.0) -> dict[str, Any]:
    """A law of many rows over a second."""
    times = np.linspace(0.0, 1.0, rows)
    rough = noise * np.random.default_rng(rows).normal(size=rows)
    values = middle + size * np.sin(2.0 * np.pi * turns * times) + rough
    return {"table": {"times": times.tolist(), "values": values.tolist()}}


def largest_share(one: Motion, other: Motion) -> float:
    """Of the sum of what both prove, how much the difference of any number uses up."""
    proofs, worst = (one.proof(rates=True), other.proof(rates=True)), 0.0
    for quantity, channel in one.numbers.items():
        for name, array in channel.items():
            allowed = sum(proof.proven[quantity][name] for proof in proofs)
            apart = np.abs(array - other.numbers[quantity][name])
            assert np.isfinite(allowed).all()
            worst = max(worst, float((apart / np.maximum(allowed, 1e-300)).max()))
    return worst


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_number_is_that_of_the_series_within_what_both_prove(name: str) -> None:
    scene = Scene.load(name).model_copy(update={"effects": tuple(EFFECTS)})
    mapped, series = simulate(scene, "map"), simulate(scene, "series")
    assert (mapped.method, mapped.status.complete) == ("map", True)
    assert len(mapped.times) == len(series.times)
    assert largest_share(mapped, series) <= 1.0
    between = np.linspace(scene.time.start, scene.time.stop, 37)
    one, other = mapped.at(between), series.at(between)
    bound = mapped.proof_of(one).bound + series.proof_of(other).bound
    assert (
        np.abs(one.position["tie_rod_outer"] - other.position["tie_rod_outer"]).max(axis=-1) <= bound
    ).all()


@pytest.mark.parametrize("name", ["steer", "double-wishbone"])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_positions_and_rates_are_held_to_the_tolerance_of_the_scene(name: str, tolerance: float) -> None:
    scene = Scene.load(name).model_copy(update={"tolerance": tolerance})
    motion = simulate(scene, "map")
    proof = motion.proof(rates=True)
    assert proof.bound.max() <= tolerance
    assert proof.carried_bound.max() <= tolerance
    part = tolerance / motion.unit
    laws = [f.series(motion.times, 2) for f in scene.functions.values()]
    domain, way = motion.solved.states.way.domain, motion.solved.states.way
    _, half = domain.middle_and_half(way.patches.low, way.patches.high)
    names = list(scene.functions)
    # S_i of the patches, per unit of each input; the largest of any patch.
    sizes = (np.abs(way.patches.coefficients[:, 1 : 1 + len(domain.free)]).max(axis=-1) / half).max(axis=0)
    speed = sum(
        size * np.abs(laws[names.index(input)][:, 1]) for size, input in zip(sizes, domain.free, strict=True)
    )
    later = sum(
        size * 2.0 * np.abs(laws[names.index(input)][:, 2])
        for size, input in zip(sizes, domain.free, strict=True)
    )
    # Rounding is bounded apart: some hundred units of it, relative to the same.
    room = part + 1e-13
    for point, errors in proof.proven["velocity"].items():
        assert (errors.max(axis=-1) <= room * speed).all(), point
    for point, errors in proof.proven["acceleration"].items():
        assert (errors.max(axis=-1) <= room * (later + speed**2 / motion.unit)).all(), point


@pytest.mark.parametrize("arm", [[1.6], [1.6, 0.05]])
def test_an_input_that_leaves_its_reach_and_comes_back_between_instants_is_refused(
    make_scene: Make, arm: Any
) -> None:
    far = standing(make_scene(arm)).reach["rack"][1].value
    # Zero at both instants, and half as far again as the rack goes in between.
    rack = (24.0 * far * np.polynomial.Polynomial([0.0, 0.0, 1.0, -2.0, 1.0])).coef
    scene = make_scene(arm, rack, stop=1.0, samples=2)
    assert len(simulate(scene, "newton").times) == 2
    for method in ("series", "map", "auto"):
        with pytest.raises(AssemblyError, match="rack") as caught:
            simulate(scene, method)
        assert list(caught.value.partial.times) == [0.0]
    within = make_scene(arm, 0.5 * rack, stop=1.0, samples=2)
    assert largest_share(simulate(within, "map"), simulate(within, "series")) <= 1.0


def test_a_motion_that_stops_halfway_keeps_what_lies_before(make_scene: Make) -> None:
    scene = make_scene([1.6], [0.0, 100.0], samples=101)
    stopped = {}
    for method in ("series", "map"):
        with pytest.raises(AssemblyError) as caught:
            simulate(scene, method)
        stopped[method] = caught.value
    series, mapped = (stopped[method].partial for method in ("series", "map"))
    # The series come nearer to the fold than the smallest box, which is 2^-16 of the range.
    assert len(series.times) - 1 <= len(mapped.times) <= len(series.times)
    assert np.isfinite(mapped.proof().bound).all()
    assert stopped["map"].limits == stopped["series"].limits


def test_a_smooth_table_of_2100_rows_is_solved_and_says_how(make_scene: Make) -> None:
    scene = make_scene(table(2100, 1.6, 0.1), table(2100, 0.0, 20.0), stop=1.0, samples=301)
    with pytest.raises(MotionTooLong):
        simulate(scene, "series")
    motion = simulate(scene)
    assert motion.method == "map"
    assert "solved by a map of the inputs: series in time would be about 2.1e+03" in motion.notes[-1]
    assert largest_share(motion, simulate(scene, "newton")) <= 1.0


def test_noise_and_a_million_swings_are_solved(make_scene: Make) -> None:
    noisy = make_scene(table(20000, 1.6, 0.1, 3.0, 0.01), table(20000, 0.0, 9.0, 2.0, 2.0), stop=1.0)
    swings = {"sine": {"amplitude": 0.1, "angular_frequency": 6.0, "offset": 1.6}}
    long = make_scene(swings, stop=1e6, samples=21)
    for scene in (noisy, long):
        motion = simulate(scene)
        assert motion.method == "map"
        assert largest_share(motion, simulate(scene, "newton")) <= 1.0


@pytest.mark.parametrize("name", BUILT_IN)
def test_what_series_solve_keeps_their_digits(name: str) -> None:
    scene = Scene.load(name)
    motion, series = simulate(scene), simulate(scene, "series")
    assert motion.method == series.method == "series"
    assert motion.notes == series.notes
    for point, places in series.position.items():
        assert np.array_equal(motion.position[point], places)


def test_where_neither_way_leads_to_the_end_the_series_say_why(make_scene: Make) -> None:
    # Beyond the reach of the rack at its crests, and too long.
    law = {"sine": {"amplitude": 150.0, "angular_frequency": 40.0}}
    with pytest.raises(AssemblyError, match="rack"):
        simulate(make_scene([1.6], law, stop=1e4, samples=3))


@pytest.mark.parametrize("rate", [0.0, 1e-25, 3.0])
def test_an_input_at_a_single_instant_has_its_rate(make_scene: Make, rate: float) -> None:
    scene = make_scene([1.6], [0.0, rate], start=0.0, stop=0.0, samples=1)
    velocity = simulate(scene, "map").velocity["tie_rod_inner"]
    assert velocity[0].tolist() == [0.0, -rate, 0.0]


def test_a_pose_of_another_assembly_is_not_the_patch_s(make_scene: Make) -> None:
    scene = make_scene([1.6, 0.05], [0.0, 3.0])
    task = prepare_task(scene, MAP)
    mechanism = task.readout.mechanism
    way = map_way(mechanism, task.functions, task.start, 0.0, 2.0, map_limits(scene, mechanism, 0))
    values = np.array([1.6, 0.0])
    y = task.start.y
    assert way.patches is not None
    assert starts_on(way.domain, way.order, way.patches, way.lookup, values, y)
    # The tie rod on the other side of the plane through its other end and the points that hold its outer one.
    layout = mechanism.layout
    a, b, c, outer = (
        y[list(layout.vector(name))]
        for name in ("lower_ball_joint", "strut_lower", "tie_rod_inner", "tie_rod_outer")
    )
    normal = np.cross(b - a, c - a)
    other = y.copy()
    other[list(layout.vector("tie_rod_outer"))] -= 2.0 * (outer - a) @ normal / (normal @ normal) * normal
    assert np.abs(mechanism.map.residual(other)).max() < 1e-14
    assert not starts_on(way.domain, way.order, way.patches, way.lookup, values, other)


def test_near_a_fold_what_no_patch_covers_is_refused_with_its_place(
    make_scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(way_map, "HALVINGS", {1: 3})
    far = standing(make_scene([1.6])).reach["rack"][1].value
    scene = make_scene([1.6], [0.0, 0.99 * far], stop=1.0, samples=41)
    with pytest.raises(MotionNotMapped, match=r"does not cover their way after t = .*a fold") as caught:
        simulate(scene, "map")
    error = caught.value
    assert set(error.inputs) == {"arm_angle", "rack"}
    assert 0 < len(error.partial.times) < 41
    assert error.partial.times[-1] <= error.instant
    assert np.isfinite(error.partial.proof().bound).all()
    # Nothing but the map is in the way.
    assert simulate(scene).method == "series"


@pytest.mark.parametrize(
    ("arm", "rack", "kind"),
    [
        ([1.6], [0.0, 100.0], AssemblyError),
        ([1.6, 0.3], [0.0, 20.0, 30.0], AssemblyError),
        ([1.6], [0.0, 55.0], MotionNotMapped),
        ([1.6, 0.2], [0.0, 30.0], MotionNotMapped),
    ],
)
def test_what_stops_a_map_is_what_stops_a_path_that_is_proven_step_by_step(
    make_scene: Make,
    monkeypatch: pytest.MonkeyPatch,
    arm: list[float],
    rack: list[float],
    kind: type[PointcoordError],
) -> None:
    # Of a map that gives up at once all of the way to the next instant is looked at.
    monkeypatch.setattr(way_map, "HALVINGS", {1: 0, 2: 0})
    scene = make_scene(arm, rack, stop=2.0, samples=2)
    said = {}
    for stepping in (True, False):
        if not stepping:
            monkeypatch.setattr(simulation, "stepped", lambda *_: None)
        with pytest.raises(kind) as caught:
            simulate(scene, "map")
        said[stepping] = caught.value
    plain, quick = said[False], said[True]
    if isinstance(plain, AssemblyError):
        assert (quick.limits, quick.reduce, quick.instant) == (plain.limits, plain.reduce, plain.instant)
        # Both end at the fold, which is found to the square root of rounding in the unknowns, and so to some
        # roundings of the inputs' own sizes.
        for name, value in plain.reached.items():
            assert abs(quick.reached[name] - value) <= 1e-12 * max(abs(value), abs(plain.wanted[name]))


def test_a_step_is_not_taken_across_a_fold_nor_far_from_its_tangent(make_scene: Make) -> None:
    scene = make_scene([1.6], [0.0])
    task = prepare_task(scene, MAP)
    mechanism, y = task.readout.mechanism, task.start.y

    def at(rack: float) -> Array:
        series = {"arm_angle": np.array([1.6]), "rack": np.array([rack])}
        return mechanism.known_series(series)[0]

    far = 200.0 * float(follow(mechanism.map, y, at(200.0)).done)
    assert 100.0 < far < 200.0
    near = stepped(mechanism.map, y, at(1e-2 * far))
    assert near is not None
    proven = follow(mechanism.map, y, at(1e-2 * far))
    assert np.abs(near - proven.y).max() < 1e-14
    assert follow(mechanism.map, y, at(0.999 * far)).done == 1.0
    assert stepped(mechanism.map, y, at(0.999 * far)) is None
    assert stepped(mechanism.map, y, at(1.001 * far)) is None


LAWS: list[TimeFunction] = [
    Polynomial((1.0, 2.0, -3.0, 0.5)),
    Polynomial((1.5,)),
    Polynomial((0.0, 1e-25)),
    Sine(0.3, 7.0, 0.2, 1.5),
    Sine(-0.3, 1e6, 0.2, 1.5),
    Sine(0.3, -40.0, 1e9, -1.0),
    Table(tuple(np.linspace(0.0, 1.0, 50)), tuple(np.random.default_rng(2).normal(size=50))),
    Table((0.0, 0.3, 0.5, 1.0), (2.0, 2.0, 2.0, 2.0)),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
def test_a_law_lies_within_what_it_says_of_a_span_and_nearly_fills_it(law: TimeFunction) -> None:
    edges = np.unique(np.concatenate([np.linspace(0.0, 1.0, 400), np.array(law.breaks)]))
    first, last = edges[:-1], edges[1:]
    low, high = law.values_over(first, last)
    inside = first[:, None] + (last - first)[:, None] * np.linspace(0.0, 1.0, 201)
    values = law.series(np.minimum(inside, last[:, None]), 0)[..., 0]
    assert (values >= low[:, None]).all()
    assert (values <= high[:, None]).all()
    whole = float(np.ptp(values))
    # The second derivative of a span of 1/400 is all that is too much.
    assert high.max() - low.min() <= 1.1 * whole + 1e-12 * np.abs(values).max()


def test_the_boxes_of_a_way_are_found_as_one_by_one(strut: Any) -> None:
    domain = Domain(strut, {"arm_angle": (1.4, 1.8), "rack": (-20.0, 20.0)}, 4)
    rng = np.random.default_rng(5)
    middle = rng.uniform([1.4, -20.0], [1.8, 20.0], (60, 2))
    half = rng.uniform(0.0, [0.03, 3.0], (60, 2))
    low, high = np.maximum(middle - half, [1.4, -20.0]), np.minimum(middle + half, [1.8, 20.0])
    marks = np.zeros((16, 16), dtype=bool)
    along = 16 / np.array([0.4, 40.0])
    for first, last in zip(low - [1.4, -20.0], high - [1.4, -20.0], strict=True):
        for i in range(16):
            for j in range(16):
                cell = np.array([i, j])
                marks[i, j] |= bool((first * along <= cell + 1).all() and (last * along >= cell).all())
    found = Marked.touched_by(domain, low, high)
    corners = np.argwhere(np.ones((16, 16), dtype=bool))
    alone = found.any_in(corners, corners + 1).reshape(16, 16)
    assert not (marks & ~alone).any()
    assert (alone & ~marks).sum() <= 2
    few = marks & (rng.uniform(size=marks.shape) < 0.1)
    first, last = touched(domain, low, high)
    wanted = [few[a[0] : b[0], a[1] : b[1]].any() for a, b in zip(first, last, strict=True)]
    assert Marked.of(few).any_in(first, last).tolist() == wanted


def test_a_way_is_followed_up_to_what_is_not_covered_and_no_further(strut: Any) -> None:
    domain = Domain(strut, {"arm_angle": (1.4, 1.8), "rack": (-20.0, 20.0)}, 6)
    laws = [Polynomial((1.4, 0.4)), Sine(19.0, 3.0)]
    table = np.zeros((64, 64), dtype=np.int64)
    spans = way_of(dict(zip(domain.free, laws, strict=True)), 0.0, 1.0)
    assert covered_until(laws, spans, Lookup(domain, table)) == 1.0
    # A gap beside the way, that a coarse span touches, and one on it.
    where = np.array([laws[0].series(0.7, 0)[0], laws[1].series(0.7, 0)[0]])
    column, row = ((where - [1.4, -20.0]) * 64 / [0.4, 40.0]).astype(int)
    table[column, row + 4] = -1
    coarse = Spans.of(laws, np.array([0.0, 0.5]), np.array([0.5, 1.0]))
    assert covered_until(laws, coarse, Lookup(domain, table)) == 1.0
    table[column, row] = -1
    end = covered_until(laws, coarse, Lookup(domain, table))
    # Where the arm enters the column, or the rack the row, less a part of a box.
    entered = column / 64.0
    assert entered - 0.5 / 64 <= end <= 0.7
    table[0, 32] = -1
    assert covered_until(laws, coarse, Lookup(domain, table)) == -np.inf


def test_a_pose_that_stands_still_is_solved_too(make_scene: Make, strut: Any) -> None:
    scene = make_scene([1.6], [2.0], samples=3)
    motion = simulate(scene, "map")
    assert largest_share(motion, simulate(scene, "newton")) <= 1.0
    assert close_drawing(strut).done == 1.0
