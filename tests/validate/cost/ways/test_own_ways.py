"""The library's ways and the absolute model solve what a user would solve, and are as exact as they say."""

import numpy as np
import pytest

from pointcoord import Scene, simulate
from pointcoord.simulation import finest_tolerance
from validate.cost.errors import Truth, errors_of, truth_of
from validate.cost.instants import study_instants
from validate.cost.row import QuantityError
from validate.cost.scenes import STUDY_SCENES, own_scene
from validate.cost.way import LeftOut, Setting, Way
from validate.cost.ways.registry import ways_named
from validate.formulations.protocol import Numbers

NEWTON_LIKE = ("newton", "newton-cold", "chord", "absolute", "relative")
FINEST = 1e-13  # mm
TRUTHS: dict[str, Truth] = {}


def way(name: str) -> Way:
    return ways_named([name])[0]


def truth(scene: Scene, count: int = 9) -> Truth:
    key = f"{scene.model_dump_json()} {count}"
    if key not in TRUTHS:
        TRUTHS[key] = truth_of(scene, study_instants(scene, count))
    return TRUTHS[key]


def solved(name: str, scene: Scene, instants: np.ndarray, value: float | None = None) -> Numbers:
    ready = way(name).prepare(scene, Setting("", value))
    return ready.output(ready.rates(ready.solve(instants)))


def errors(name: str, scene: Scene, value: float | None = None, count: int = 9) -> dict[str, QuantityError]:
    right = truth(scene, count)
    found, not_given = errors_of(solved(name, scene, right.instants, value), right)
    assert not_given == {}
    return found


@pytest.mark.parametrize("name", STUDY_SCENES)
@pytest.mark.parametrize("setting", way("series").settings[::4], ids=lambda setting: setting.words)
@pytest.mark.parametrize("who", ["series", "map", "newton", "newton-cold", "chord"])
def test_no_position_is_farther_off_than_it_was_asked_to_be(name: str, setting: Setting, who: str) -> None:
    # Beside it there is rounding: 1e-16 of 1000 mm, times a condition number of 1e4 near the toggle.
    assert setting.value is not None
    assert errors(who, own_scene(name), setting.value)["position"].largest < setting.value + 1e-11


@pytest.mark.parametrize("name", STUDY_SCENES)
@pytest.mark.parametrize("who", NEWTON_LIKE)
def test_what_solves_each_instant_is_off_by_rounding_in_every_quantity(name: str, who: str) -> None:
    scene = own_scene(name)
    # Near the toggle position is off as above, velocity 1e1 and acceleration 1e4 times as much.
    near = name == "near-toggle"
    limits = {"position": 1e-10, "velocity": 1e-9, "acceleration": 1e-6}
    turns = {"angular_velocity": 1e-11, "angular_acceleration": 1e-8, "wheel": 1e-12}
    for quantity, error in errors(who, scene, FINEST).items():
        assert error.largest < ({**limits, **turns}[quantity] if near else 1e-11), quantity


@pytest.mark.parametrize("name", ["steer", "off-axis-strut", "bounce-on-a-heaving-chassis"])
def test_the_series_way_gives_what_a_motion_gives_at_the_same_instants(name: str) -> None:
    scene = Scene.load(name)
    instants = study_instants(scene, 7)
    mine = solved("series", scene, instants, 1e-6)
    motion = simulate(scene.model_copy(update={"tolerance": 1e-6})).at(instants)
    assert_same(mine, {q: dict(c) for q, c in motion.numbers.items() if c.computed})


@pytest.mark.parametrize("name", ["steer", "double-wishbone", "bounce-on-a-heaving-chassis"])
def test_the_newton_way_gives_what_a_motion_gives_at_the_scenes_instants(name: str) -> None:
    scene = Scene.load(name)
    # Without a tolerance of its own the way is as fine as rounding allows.
    motion = simulate(scene.model_copy(update={"tolerance": finest_tolerance(scene)}), "newton")
    assert_same(
        solved("newton", scene, scene.instants), {q: dict(c) for q, c in motion.numbers.items() if c.computed}
    )


def assert_same(mine: Numbers, theirs: Numbers) -> None:
    assert {q: set(names) for q, names in mine.items()} == {q: set(names) for q, names in theirs.items()}
    for quantity, names in theirs.items():
        for name, array in names.items():
            # The same sums, but perhaps in blocks of other lengths.
            np.testing.assert_allclose(mine[quantity][name], array, rtol=1e-13, atol=1e-12)


@pytest.mark.parametrize("who", ["series", "newton", "absolute", "relative"])
def test_a_chassis_that_moves_and_an_origin_far_away_are_in_the_numbers(who: str) -> None:
    content = Scene.load("bounce-on-a-heaving-chassis").model_dump(exclude_none=True)
    points = content["mechanism"]["points"]
    content["mechanism"]["points"] = {name: [x + 1e5, y, z] for name, (x, y, z) in points.items()}
    scene = Scene.from_mapping(content)
    found = errors(who, scene, FINEST)
    # A place 1e5 mm away is rounded by 1e-11 mm.
    assert found["position"].largest < 2e-11
    assert found["velocity"].largest < 1e-9
    assert found["acceleration"].largest < 1e-8


@pytest.mark.parametrize("who", ["series-differences", "newton-differences"])
def test_differences_are_off_by_the_square_of_their_step_and_then_by_rounding(who: str) -> None:
    scene = own_scene("double-wishbone")
    # At all instants that are no nearer to an end of the time than the longest step.
    coarse, fine, finest = (errors(who, scene, share) for share in (1e-2, 1e-3, 1e-6))
    for quantity in ("velocity", "angular_velocity", "acceleration", "angular_acceleration"):
        assert coarse[quantity].largest / fine[quantity].largest == pytest.approx(100.0, rel=0.03), quantity
    # The second difference of places that are rounded by 1e-13 mm, over the square of a step of 2e-6 s.
    assert 1e-4 < finest["acceleration"].largest < 1.0
    assert finest["velocity"].largest < 1e-6
    assert coarse["position"].largest < 1e-11


def test_near_an_end_of_the_time_differences_are_of_a_parabola_inside() -> None:
    scene = own_scene("double-wishbone")
    ends = np.array([0.001, 1.999])  # a step of 0.02 s does not fit beside them
    right = truth_of(scene, ends)
    of_velocity, of_acceleration = [], []
    for share in (1e-2, 5e-3):
        found, _ = errors_of(solved("series-differences", scene, ends, share), right)
        of_velocity.append(found["velocity"].largest)
        of_acceleration.append(found["acceleration"].largest)
    # Off by the square of the step and by the step itself, and 0.001 s of the way in.
    assert of_velocity[0] / of_velocity[1] == pytest.approx(4.0, rel=0.25)
    assert of_acceleration[0] / of_acceleration[1] == pytest.approx(2.0, rel=0.2)


def test_the_printed_formulas_are_right_in_position_and_wrong_in_acceleration() -> None:
    found = errors("printed", own_scene("bounce"), FINEST)
    assert found["position"].largest < 1e-11
    assert found["acceleration"].largest > 1.0


@pytest.mark.parametrize("name", ["off-axis-strut", "double-wishbone"])
def test_the_printed_formulas_are_left_out_where_the_paper_has_none(name: str) -> None:
    with pytest.raises(LeftOut, match="the paper prints the strut with its ball joint on the strut axis"):
        way("printed").prepare(own_scene(name), Setting())


@pytest.mark.parametrize("who", ["series-differences", "newton-differences"])
def test_differences_are_left_out_where_there_is_nothing_to_take_them_of(who: str) -> None:
    scene = own_scene("steer").model_copy(update={"effects": ("wheel_angles",)})
    with pytest.raises(LeftOut, match="asks for no rates"):
        way(who).prepare(scene, Setting("", 1e-3))
    content = own_scene("steer").model_dump(exclude_none=True)
    content["time"] = {"start": 0.1, "stop": 0.1, "samples": 1}
    with pytest.raises(LeftOut, match="one instant"):
        way(who).prepare(Scene.from_mapping(content), Setting("", 1e-3))


@pytest.mark.parametrize("who", ["series", "newton", "absolute", "relative"])
@pytest.mark.parametrize("effects", [(), ("wheel_angles",), ("velocity",), ("knuckle_rates", "toe")])
def test_what_a_scene_does_not_ask_for_is_not_computed(who: str, effects: tuple[str, ...]) -> None:
    scene = own_scene("off-axis-strut").model_copy(update={"effects": effects})
    right = truth(scene, 3)
    numbers = solved(who, scene, right.instants)
    assert set(numbers) == set(right.exact)
    found, not_given = errors_of(numbers, right)
    assert not_given == {}
    # A chain of a scene's own tolerance, 1e-9 mm, for the series.
    assert all(error.largest < 1e-7 for error in found.values())


@pytest.mark.parametrize(
    "who", ["series", "newton", "newton-cold", "printed", "absolute", "relative", "series-differences"]
)
def test_what_was_done_is_counted(who: str) -> None:
    scene = own_scene("steer")
    chosen = way(who).settings[-1]
    ready = way(who).prepare(scene, chosen)
    few, many = (ready.counts(ready.rates(ready.solve(study_instants(scene, count)))) for count in (4, 40))
    assert few["factorisations"] > 0
    # One chain serves any instant; what solves each by itself factorises for each.
    assert (few == many) == way(who).dense
    assert way(who).dense or many["factorisations"] >= few["factorisations"] + 36
