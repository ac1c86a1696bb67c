"""Wrong descriptions and inputs are refused in one line with the name, the place and the value."""

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from changed_scenes import change
from mechanism_files import plain_scene
from one_arm import plain as one_arm
from shipped import Motion

import absolute
from absolute import DescriptionError, InputError

TURN: dict[str, Any] = {"turn": {"angle": "crank", "from": "drawing", "on": "chassis"}}
STRUT = plain_scene("steer", ["arm_angle", "rack"])
POINTS = STRUT["points"]
HELD = {"arm_angle": np.array([[1.6, 0.0, 0.0]]), "rack": np.array([[0.0, 0.0, 0.0]])}


def crank(inputs: dict[str, Any]) -> dict[str, Any]:
    """A crank of 300 mm about x, and beside it a rod of 700 mm to a point that slides to the right."""
    bore = {"points": ["slide"], "body": "chassis", "through": "a", "along": "right", "turns": True}
    return {
        "name": "crank",
        "bodies": {"chassis": ["a", "b"], "crank": ["a", "b", "end"]},
        "points": {"a": (0, 0, 0), "b": (100, 0, 0), "end": (0, 180, 240), "slide": (0, 837.6, 0)},
        "rods": {"rod": ["end", "slide"]},
        "slides": {"bore": bore},
        "inputs": inputs,
        **{"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0), "side": "left"},
    }


def four_bar(tilt: float = 0.0, **more: Any) -> dict[str, Any]:
    """Hinges along x at (0, 0), (40, 30), (160, 60), (150, 0) in y and z; the last one tilted."""
    places = [(0, 0), (40, 30), (160, 60), (150, 0)]
    points = {f"p{i}": (0, y, z) for i, (y, z) in enumerate(places)}
    points |= {f"q{i}": (100, y + (100 * tilt if i == 3 else 0), z) for i, (y, z) in enumerate(places)}
    bodies = {
        "chassis": ["p0", "q0", "p3", "q3"],
        "crank": ["p0", "q0", "p1", "q1"],
        "coupler": ["p1", "q1", "p2", "q2"],
        "rocker": ["p2", "q2", "p3", "q3"],
    }
    inputs = {"turn": {"angle": "crank", "from": "drawing", "on": "chassis"}}
    axes = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0), "side": "left"}
    return {"name": "four-bar", "bodies": bodies, "points": points, "inputs": inputs, **axes, **more}


LOAD = {"force": [300.0, -900.0, 4000.0], "moment": [2e4, -5e4, 1e4]}
AXLE = plain_scene("axle-steer", wheel_radius=300.0, car={"wheelbase": 1600.0})
LOOSE = plain_scene("bounce", ["arm_angle", "rack"], wheel_radius=300.0)
LOOSE["inputs"]["rack"] = {"height": "tie_rod_inner", "along": "left"}
BARS = four_bar(roles={"wheel_axis": ["q1", "q2"], "knuckle": "coupler"}, wheel_radius=300.0)
BASES: dict[str, dict[str, Any]] = {
    "crank": crank(TURN),
    "strut": STRUT,
    "arm": one_arm(),
    "axle": AXLE,
    "five links": plain_scene("five-link"),
    "loose": LOOSE,
    "loaded": one_arm(loads={"": LOAD}),
    "four bar": BARS | {"loads": {"": LOAD}},
}
LINES = Path(__file__).with_name("refused.txt").read_text(encoding="utf-8").splitlines()
CASES = [[part.strip() for part in line.split(" | ")] for line in LINES if " | " in line and line[0] != "#"]


def compiled(described: dict[str, Any], asked: str) -> None:
    model = absolute.compile(described)
    if asked:
        still = {name: np.zeros((1, 3)) for name in described["inputs"]}
        effects = [] if asked == "loads" else asked.split(", ")
        absolute.solve(model, still, effects=effects, loads=asked == "loads")
    absolute.close_drawing(model)


def refused(described: dict[str, Any], *words: str, asked: str = "") -> Any:
    """The error, in one line, for a description that is wrong, or that has not what effects or loads need."""
    with pytest.raises((DescriptionError, InputError)) as caught:
        compiled(described, asked)
    told = str(caught.value)
    assert [word for word in words if word not in told] == [], told
    assert "\n" not in told
    assert caught.value.name or asked == "loads"
    return caught.value


@pytest.mark.parametrize(("base", "changes", "asked", "words"), CASES)
def test_what_cannot_be_described_or_lacks_something_is_said_in_one_line(
    base: str, changes: str, asked: str, words: str
) -> None:
    described = copy.deepcopy(BASES[base])
    refused(change(described, changes) if changes else described, *words.split(" & "), asked=asked)


def drawn(**points: Any) -> dict[str, Any]:
    """The strut with other points."""
    return STRUT | {"points": POINTS | points}


def test_neither_the_rounding_nor_the_length_of_a_direction_matters_nor_what_is_next_to_zero() -> None:
    assert absolute.compile(STRUT | {"right": (0.0, 1.0, 0.999e-6)})
    plain = Motion(STRUT, HELD).solve().position
    others = [STRUT | {"up": (0.0, 0.0, by), "right": (0.0, by, 0.0)} for by in (1e-200, 1e155)]
    for described in others:
        found = Motion(described, HELD).solve().position
        assert all((found[name] == place).all() for name, place in plain.items())
    rack = HELD | {"rack": np.array([[60.0, 0.0, 0.0]])}
    zero, tiny = (Motion(drawn(rack_centre=(570.0, y, 90.0)), rack).solve() for y in (0.0, -1e-110))
    assert (zero.position["wheel_centre"] == tiny.position["wheel_centre"]).all()


def test_lines_that_lead_nearly_along_each_other_are_taken() -> None:
    described = one_arm()
    slide = described["slides"]["guide"] | {"along": "left"}
    described["points"]["guide_end"] = tuple(np.add(described["points"]["guide"], [0.0, -0.1, 80.0]))
    assert absolute.compile(described | {"slides": {"guide": slide}})


def test_a_car_too_small_or_too_far_out_for_doubles_is_refused() -> None:
    for factor in (5e-324, 1e-110, 0.0):
        refused(drawn(**{n: tuple(factor * x for x in p) for n, p in POINTS.items()}), "1e-100 mm")
    # At least half of the digits are needed: 500 mm at 3e10 mm have fewer.
    refused(drawn(**{name: tuple(np.add(p, 1e11)) for name, p in POINTS.items()}), "apart")


@pytest.mark.parametrize("value", [1e10, 1e100])
def test_one_coordinate_far_from_the_others_is_solved_or_refused_without_a_warning(value: float) -> None:
    for number, (name, place) in enumerate(POINTS.items()):
        point = tuple(value if k == number % 3 else x for k, x in enumerate(place))
        try:
            solution = Motion(drawn(**{name: point}), HELD).solve()
        except (DescriptionError, absolute.PoseError):
            continue
        assert all(np.isfinite(array).all() for array in solution.acceleration.values())


@pytest.mark.parametrize(
    ("tilt", "turn", "rate", "effects", "kind", "words"),
    [
        (1e-2, [0.0], 0.0, [], absolute.DescriptionError, "hinge of.*overconstrained"),
        (1e-9, [0.0, 0.5], 0.0, [], absolute.PoseError, "hinge of"),
        (1e-10, [0.0], 1.0, [], absolute.AssemblyError, r"hinge of.*locked"),
        (1e-10, [0.0], 0.0, ["toe_by_travel"], absolute.AssemblyError, r"hinge of.*locked"),
    ],
)
def test_a_four_bar_whose_hinges_are_not_parallel_is_locked(
    tilt: float, turn: list[float], rate: float, effects: list[str], kind: type[Exception], words: str
) -> None:
    bars = four_bar(tilt, roles={"wheel_axis": ["q1", "q2"]})
    with pytest.raises(kind, match=words):
        Motion(bars, {"turn": np.array([[value, rate, 0.0] for value in turn])}).solve(effects=effects)
    if tilt == 1e-10:
        assert Motion(bars, {"turn": np.zeros((1, 3))}).solve(effects=["toe"]).effects


TWO = np.zeros((2, 3))


@pytest.mark.parametrize(
    ("inputs", "name", "instant", "say"),
    [
        ({"arm_angle": TWO}, "rack", None, r"missing: \['rack'\]"),
        # The first by name of several wrong inputs.
        ({"y": 0, "x": 0, "arm_angle": TWO, "rack": TWO}, "x", None, r"unknown: \['x', 'y'\]"),
        ({"arm_angle": TWO, "rack": np.zeros((3, 3))}, "rack", None, "3 instants, the others have 2"),
        ({"arm_angle": TWO, "rack": np.zeros(2)}, "rack", None, "shape"),
        ({"arm_angle": TWO[:, :2], "rack": TWO}, "arm_angle", None, "shape"),
        ({"arm_angle": TWO[:1], "rack": [["a", "b", "c"]]}, "rack", None, "not an array of numbers"),
        ({"arm_angle": TWO, "rack": [[0, 0, 0], [0, np.nan, 0]]}, "rack", 1, "finite"),
    ],
)
def test_the_input_at_fault_is_named_with_its_first_bad_instant(
    inputs: dict[str, Any], name: str, instant: int | None, say: str
) -> None:
    with pytest.raises(InputError, match=say) as caught:
        Motion(STRUT, inputs).solve()
    assert (caught.value.name, caught.value.instant) == (name, instant)


@pytest.mark.parametrize(
    ("name", "fast", "instant"), [("arm_angle", [1e200, 0.0], 0), ("rack", [1e300, 1e308], 100)]
)
def test_rates_too_large_for_floating_point_are_refused_with_their_instant(
    name: str, fast: list[float], instant: int
) -> None:
    inputs = {"arm_angle": np.tile([1.6, 0.1, 0.2], (102, 1)), "rack": np.tile([5.0, 0.3, 0.4], (102, 1))}
    inputs[name][instant, 1:] = fast
    with pytest.raises(InputError, match=f"instant {instant}: .*overflow.*smaller") as caught:
        Motion(STRUT, inputs).solve()
    assert caught.value.instant == instant
    kept = caught.value.partial
    assert (0 if kept is None else len(kept.residual)) == instant


@pytest.mark.parametrize("fast", [1e-300, 1e152])
def test_rates_are_in_proportion_to_those_of_the_inputs(fast: float) -> None:
    def moving(scale: float) -> absolute.Solution:
        # Time runs faster by `scale`: rates by it, accelerations by its square.
        scales = np.array([1.0, scale, scale**2])
        arm, rack = np.array([[1.6, 0.25, 0.1]]) * scales, np.array([[10.0, 5.0, 2.0]]) * scales
        return Motion(STRUT, {"arm_angle": arm, "rack": rack}).solve()

    plain, quick = moving(1.0), moving(fast)
    for name in POINTS:
        assert np.abs(quick.velocity[name] / fast - plain.velocity[name]).max() <= 1e-10
        if fast > 1.0:
            assert np.abs(quick.acceleration[name] / fast**2 - plain.acceleration[name]).max() <= 1e-10
