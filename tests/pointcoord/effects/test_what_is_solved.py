"""A scene solves for what it reports, and what stands still once: shown by counts of work and by numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import ArrayLike

from pointcoord import AssemblyError, NotComputed, Scene, simulate
from pointcoord.method import METHODS
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.simulation import effort, prepare_task, solve_by_series
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.taylor import Settings, build_chain
from pointcoord.time_functions import Polynomial, Sine, Table, TimeFunction
from validate.comparison.compare import compare
from validate.formulations.registry import formulation

STRUT = ("strut_lower", "strut_rod_end", "strut_top")


def scene(name: str, points: Sequence[str] | None = None, effects: Sequence[str] | None = None) -> Scene:
    """A built-in scene that reports some of its points, and other effects."""
    found = Scene.load(name)
    changes: dict[str, object] = {} if points is None else {"points": tuple(points)}
    return found.model_copy(update=changes | ({} if effects is None else {"effects": tuple(effects)}))


def unknowns_per_order(scene: Scene) -> float:
    """Unknowns of each linear solve for an order of a series."""
    work = solve_by_series(prepare_task(scene, METHODS["series"])).states.work
    assert work.rate_solves == work.series_orders > 0
    return work.unknowns_solved / work.rate_solves


@pytest.mark.parametrize(
    ("name", "points", "unknowns"),
    [
        # The rack and the steering arm move; the arm's ball joint, 3, and the strut line with the two places
        # on it, 4 and 4, stand still.
        ("steer", None, 3 + 3),
        # The rack stands still.
        ("bounce", None, 3 + 4 + 4 + 3),
        ("bounce-and-steer", None, 3 + 4 + 4 + 3 + 3),
        # The strut and the arm that it hangs on; no rack, no tie rod.
        ("bounce", STRUT, 3 + 4 + 4),
        ("bounce-and-steer", STRUT, 3 + 4 + 4),
        ("bounce-and-steer", ["lower_ball_joint"], 3),
        ("bounce-and-steer", ["tie_rod_inner"], 3),
        # A wheel hangs on everything but the strut's rod end, which the strut line needs.
        ("bounce-and-steer", ["wheel_centre"], 3 + 4 + 4 + 3 + 3),
        ("double-wishbone", None, 3 + 3 + 3 + 3),
        ("double-wishbone", ["upper_ball_joint"], 3 + 3),
        # A strut whose axis is fixed in the knuckle turns with it: only its rod end is left out.
        ("off-axis-strut", ["strut_lower"], 22 - 3),
    ],
)
def test_only_the_blocks_that_move_and_are_needed_are_solved_for(
    name: str, points: Sequence[str] | None, unknowns: int
) -> None:
    assert unknowns_per_order(scene(name, points, [])) == unknowns


def test_what_stands_still_is_a_constant_of_every_series() -> None:
    solved = solve_by_series(prepare_task(scene("steer"), METHODS["series"]))
    layout, segments = solved.readout.mechanism.layout, solved.states.chain.segments
    for point in ("lower_ball_joint", "strut_lower", "strut_rod_end"):
        places = list(layout.vector(point))
        first = segments[0].coefficients[0, places]
        for segment in segments:
            assert np.array_equal(segment.coefficients[0, places], first)
            assert not segment.coefficients[1:, places].any()
    outer = list(layout.vector("tie_rod_outer"))
    assert all(segment.coefficients[1, outer].all() for segment in segments)


@pytest.mark.parametrize("name", ["steer", "bounce-and-steer", "double-wishbone"])
def test_points_that_are_not_reported_are_not_evaluated(name: str) -> None:
    everything, one = scene(name, None, ["velocity"]), scene(name, ["lower_ball_joint"], ["velocity"])
    topology = everything.mechanism.topology
    moving = len(topology.moving) + len(topology.carried)
    assert simulate(everything).work.coordinates_evaluated == 2 * 3 * moving
    assert simulate(one).work.coordinates_evaluated == 2 * 3
    chassis = scene(name, ["lower_arm_front"], ["velocity"])
    assert simulate(chassis).work.coordinates_evaluated == 0
    assert not simulate(chassis).velocity["lower_arm_front"].any()


@dataclass(frozen=True)
class Told:
    """A law that says of itself that it moves, so that nothing is taken for standing still."""

    law: TimeFunction

    def series(self, instants: ArrayLike, order: int) -> np.ndarray:
        """The law's."""
        return self.law.series(instants, order)

    def rounding(self, instants: np.ndarray, derivative: int = 0) -> np.ndarray:
        """The law's."""
        return self.law.rounding(instants, derivative)

    def enclosed(self, instants: np.ndarray) -> list[Enclosed]:
        """The law's."""
        return self.law.enclosed(instants)

    @property
    def breaks(self) -> tuple[float, ...]:
        """The law's."""
        return self.law.breaks

    @property
    def still(self) -> bool:
        """No."""
        return False


@pytest.mark.parametrize("name", ["steer", "bounce"])
def test_a_chain_of_what_moves_is_the_chain_of_everything(name: str) -> None:
    task = prepare_task(scene(name), METHODS["series"])
    mechanism, time = task.readout.mechanism, task.scene.time
    plain = {input: Told(law) for input, law in task.functions.items()}
    settings = Settings(1e-13, 2)
    start = assemble(
        mechanism, {n: f.series(time.start, 0)[0] for n, f in plain.items()}, closed=close_drawing(mechanism)
    )
    few, all_of_it = (
        build_chain(mechanism, laws, start, time.start, time.stop, settings)
        for laws in (task.functions, plain)
    )
    assert few.work.unknowns_solved / few.work.rate_solves < mechanism.map.unknowns
    assert all_of_it.work.unknowns_solved / all_of_it.work.rate_solves == mechanism.map.unknowns
    # What the tolerance leaves out of either, and what rounding does to poses of condition numbers below 100.
    allowed = 2.0 * 1e-13 + 1e-13
    for instant in np.linspace(time.start, time.stop, 57):
        here, there = (next(s for s in chain.segments if instant <= s.stop) for chain in (few, all_of_it))
        places = [
            ((instant - s.start) / s.scale) ** np.arange(s.order + 1.0) @ s.coefficients
            for s in (here, there)
        ]
        assert np.abs(places[0] - places[1]).max() <= allowed


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("name", "points"),
    [
        ("steer", STRUT),
        ("steer", ["wheel_centre", "rack_centre"]),
        ("bounce-on-a-heaving-chassis", STRUT),
        ("bounce-on-a-heaving-chassis", ["tie_rod_inner"]),
        ("off-axis-strut", ["wheel_centre"]),
        ("double-wishbone", ["upper_ball_joint", "lower_arm_rear"]),
    ],
)
@pytest.mark.parametrize("effects", [(), ("velocity", "acceleration"), ("wheel_angles", "knuckle_rates")])
def test_fewer_points_are_the_same_points_and_as_well_proven(
    name: str, points: Sequence[str], effects: tuple[str, ...], method: str
) -> None:
    few, whole = (simulate(scene(name, p, effects), method) for p in (points, None))
    assert sorted(few.position) == sorted(points)
    bounds = [motion.proof(rates=True).proven for motion in (few, whole)]
    for quantity, channel in few.numbers.items():
        assert set(channel) <= set(whole.numbers[quantity])
        for number, found in channel.items():
            allowed = bounds[0][quantity][number] + bounds[1][quantity][number]
            assert np.isfinite(allowed).all()
            assert (np.abs(found - whole.numbers[quantity][number]) <= allowed).all(), (quantity, number)
    assert np.isfinite(few.proof().bound).all()
    assert np.isfinite(few.proof().carried_bound).all()


def test_where_the_tie_rod_ends_the_motion_the_strut_goes_on_and_says_what_it_does_not_know() -> None:
    far = {
        "inputs": {
            "arm_angle": {"polynomial": [1.5707963267948966, 0.1]},
            "rack": {"polynomial": [0.0, 500.0]},
        },
        "time": {"start": 0.0, "stop": 1.0, "samples": 11},
    }
    with pytest.raises(AssemblyError):
        simulate(scene("steer", None, []).model_copy(update=far))
    motion = simulate(scene("steer", STRUT, []).model_copy(update=far))
    assert motion.status.complete
    assert any("tie_rod_outer" in note and "nor whether it can follow" in note for note in motion.notes)
    assert np.isfinite(motion.proof().bound).all()


def test_a_point_that_is_not_reported_is_not_computed_and_the_advice_gives_it() -> None:
    asked = scene("bounce", STRUT, ["velocity"])
    motion = simulate(asked)
    for channel in (motion.position, motion.velocity):
        with pytest.raises(NotComputed, match="add 'tie_rod_outer' to the scene's points"):
            channel["tie_rod_outer"]
    more = simulate(asked.model_copy(update={"points": (*STRUT, "tie_rod_outer")}))
    assert np.isfinite(more.velocity["tie_rod_outer"]).all()


def test_the_plan_counts_what_is_solved_once_and_what_is_not_needed() -> None:
    steer, strut = effort(scene("steer")), effort(scene("bounce", STRUT, []))
    assert (steer.moving, steer.still, steer.not_needed, steer.points_not_needed) == (6, 11, 0, ())
    assert (strut.moving, strut.still, strut.not_needed) == (11, 0, 6)
    assert strut.points_not_needed == ("tie_rod_outer", "tie_rod_inner", "wheel_centre")


@pytest.mark.parametrize("who", ["absolute", "relative", "pointcoord-newton"])
def test_every_formulation_gives_the_points_that_are_reported_and_agrees(who: str) -> None:
    asked = scene("bounce", STRUT, ["velocity", "acceleration"])
    second = formulation(who)
    given = {quantity: set(names) for quantity, names in second.solve(asked).numbers.items() if names}
    assert given == {quantity: set(STRUT) for quantity in ("position", "velocity", "acceleration")}
    found = compare(asked, "pointcoord", second)
    assert found.agreed
    assert {row.name for row in found.rows} == set(STRUT)


@pytest.mark.parametrize(
    ("law", "still"),
    [
        (Polynomial((3.0,)), True),
        (Polynomial((3.0, 0.0, 0.0)), True),
        (Polynomial((3.0, 0.0, 1e-300)), False),
        (Sine(0.0, 5.0, 1.0, 2.0), True),
        (Sine(2.0, 0.0, 1.0, 2.0), True),
        (Sine(1e-300, 5.0), False),
        (Table((0.0, 1.0, 2.0, 3.0), (2.0, 2.0, 2.0, 2.0)), True),
        (Table((0.0, 1.0, 2.0, 3.0), (2.0, 2.0, 2.0, 2.5)), False),
    ],
)
def test_a_law_stands_still_by_its_form(law: TimeFunction, still: bool) -> None:
    assert law.still is still
    if still:
        assert not law.series(np.linspace(0.0, 3.0, 31), 6)[:, 1:].any()
