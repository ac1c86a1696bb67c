"""What two wheels make: closed forms in many digits, laws of mirrors, and where there is no number."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from mpmath import acot, atan, cos, cot, mpf, sin, workdps
from numpy.typing import NDArray

from pointcoord import Motion, Scene, SceneError, simulate

Array = NDArray[np.float64]
DIGITS = 40
RADIUS, WHEELBASE = 300.0, 2500.0
SIDES = {"left": -1.0, "right": 1.0}
# A wheel on a hinge that is fixed in the car: upright it steers, lengthwise it travels.
CORNER = {
    "bodies": {"chassis": ["a", "b"], "knuckle": ["a", "b", "inner", "centre"]},
    "inputs": {"turn": {"angle": "knuckle", "from": "drawing"}},
    "roles": {"knuckle": "knuckle", "wheel_axis": ["inner", "centre"]},
}
UPRIGHT = {"a": (0.0, 700.0, 100.0), "b": (0.0, 700.0, 500.0)}
LENGTHWISE = {"a": (-100.0, 150.0, 420.0), "b": (100.0, 150.0, 420.0)}
WHEEL = {"inner": (0.0, 660.0, 300.0), "centre": (0.0, 760.0, 300.0)}


def axle(hinge: Mapping[str, Any], turns: Mapping[str, list[float]], effects: list[str]) -> Scene:
    """Two such wheels; the right one's hinge and wheel are given, and the left one's are mirrored."""
    parts = {side: {"mechanism": CORNER, "side": side, "mirrored": side == "left"} for side in SIDES}
    return Scene.from_mapping(
        {
            "effects": effects,
            "mechanism": {
                "parts": parts,
                "points": {**hinge, **WHEEL},
                "wheel_radius": RADIUS,
                "car": {"wheelbase": WHEELBASE},
            },
            "inputs": {f"{side}.turn": {"polynomial": turn} for side, turn in turns.items()},
            "time": {"start": 0.0, "stop": 1.0, "samples": 9},
        }
    )


def assert_exact(motion: Motion, exact: Mapping[tuple[str, str], list[mpf]], within: float) -> None:
    """Each number to within its proven bound of what it exactly is, and that within some roundings."""
    proof = motion.proof(rates=True)
    for (quantity, name), values in exact.items():
        bound = proof.proven[quantity][name]
        for found, value, most in zip(motion.numbers[quantity][name], values, bound, strict=True):
            assert abs(mpf(float(found)) - value) <= most, (name, found, value, most)
        size = np.maximum(1.0, np.abs(motion.numbers[quantity][name]))
        assert (bound <= within * size).all(), (name, bound)


def test_steered_wheels_are_what_the_formulas_make_of_their_angles() -> None:
    """Wheels that turn about upright hinges by their inputs, the outer one by more or less than it has to."""
    for sign in (1.0, -1.0):
        turns = {"left": [0.2 * sign, 0.3 * sign], "right": [0.17 * sign, 0.35 * sign]}
        motion = simulate(axle(UPRIGHT, turns, ["steer_angle", "ackermann", "toe"]))
        exact: dict[tuple[str, str], list[mpf]] = {}
        with workdps(DIGITS):
            track, base = 2 * mpf(760), mpf(WHEELBASE)
            for time in motion.times.tolist():
                left, right = (mpf(turns[s][0]) + mpf(turns[s][1]) * mpf(time) for s in SIDES)
                inner, outer = (left, right) if sign > 0 else (-right, -left)
                radius = base * (cot(inner) + cot(outer)) / 2
                ideal = atan(base / (radius - track / 2)) - atan(base / (radius + track / 2))
                for key, value in {
                    ("wheel", "left.steer_angle"): left,
                    ("wheel", "right.steer_angle"): right,
                    ("wheel", "left.toe"): -left,
                    ("wheel", "right.toe"): right,
                    ("dimension", "turning_radius"): radius,
                    ("ackermann", "ackermann"): 100 * (inner - outer) / ideal,
                    ("steer_error", "ackermann_error"): outer - acot(cot(inner) + track / base),
                }.items():
                    exact.setdefault(key, []).append(value)
            assert_exact(motion, exact, 1e-11)


def test_a_car_that_turns_about_one_point_has_100_per_cent_and_no_error() -> None:
    inner = np.linspace(0.1, 0.6, 9)
    outer = np.arctan(1.0 / (1.0 / np.tan(inner) + 2 * 760.0 / WHEELBASE))
    content = axle(UPRIGHT, {"left": [0.0], "right": [0.0]}, ["ackermann"]).model_dump(exclude_none=True)
    times = np.linspace(0.0, 1.0, 9).tolist()
    for side, angle in (("left", inner), ("right", outer)):
        content["inputs"][f"{side}.turn"] = {"table": {"times": times, "values": angle.tolist()}}
    motion = simulate(Scene.from_mapping(content))
    assert motion.ackermann["ackermann"] == pytest.approx(100.0, abs=1e-9)
    assert motion.steer_error["ackermann_error"] == pytest.approx(0.0, abs=1e-13)
    # About the point on the rear axle's line: as far from the middle as the inner wheel's normal meets it.
    middle = WHEELBASE / np.tan(inner) + 760.0
    assert motion.dimension["turning_radius"] == pytest.approx(middle, rel=1e-12)


def test_wheels_that_are_not_steered_to_the_same_side_turn_about_nothing() -> None:
    motion = simulate(axle(UPRIGHT, {"left": [-0.2, 0.4], "right": [0.0, 0.1]}, ["ackermann"]))
    both = (motion.times > 0.5) & (motion.times > 0.0)
    for quantity in ("dimension", "ackermann", "steer_error"):
        for array in motion.numbers[quantity].values():
            assert np.isfinite(array).tolist() == both.tolist()
    assert any("not steered to the same side" in note for note in motion.notes)


def test_a_number_that_is_off_by_a_nanometre_is_not_within_its_bound() -> None:
    motion = simulate(axle(LENGTHWISE, {"left": [0.05], "right": [-0.05]}, ["axle"]))
    exact = {("dimension", "axle_roll_centre_offset"): [mpf(0)] * 9}
    assert_exact(motion, exact, 1e-11)
    with pytest.raises(AssertionError):
        assert_exact(motion, {key: [mpf("1e-6")] * 9 for key in exact}, 1e-11)


def test_swing_axles_roll_about_where_the_lines_through_their_hinges_meet() -> None:
    turns = {"left": [0.05, 0.1], "right": [0.02, 0.03]}
    motion = simulate(axle(LENGTHWISE, turns, ["axle"]))
    exact: dict[tuple[str, str], list[mpf]] = {}
    with workdps(DIGITS):
        for time in motion.times.tolist():
            contacts, hinges = {}, {}
            for side, sign in SIDES.items():
                turn = mpf(turns[side][0]) + mpf(turns[side][1]) * mpf(time)
                hinge = (mpf(sign) * 150, mpf(420))
                # About forward to rearward, as the hinge leads: y to z.
                y, z = mpf(sign) * 760 - hinge[0], mpf(300) - hinge[1]
                wheel = (hinge[0] + y * cos(turn) - z * sin(turn), hinge[1] + y * sin(turn) + z * cos(turn))
                # The spin axis turns along, and the disc's lowest point lies square to it.
                down = (sin(turn), -cos(turn))
                contacts[side] = tuple(w + RADIUS * d for w, d in zip(wheel, down, strict=True))
                hinges[side] = hinge
            (y1, z1), (y2, z2) = contacts["left"], contacts["right"]
            slope = {s: (hinges[s][1] - contacts[s][1]) / (hinges[s][0] - contacts[s][0]) for s in SIDES}
            across = (z2 - z1 + slope["left"] * y1 - slope["right"] * y2) / (slope["left"] - slope["right"])
            height = z1 + slope["left"] * (across - y1)
            ground = z1 + (z2 - z1) * (across - y1) / (y2 - y1)
            for key, value in {
                "track": y2 - y1,
                "axle_roll_centre_offset": across,
                "axle_roll_centre_height": height - ground,
            }.items():
                exact.setdefault(("dimension", key), []).append(value)
        assert_exact(motion, exact, 1e-11)


AXLE = Scene.load("axle-steer").model_dump(exclude_none=True)
EVERY = ["camber", "toe", "steer_angle", "caster", "steering_axis", "roll_centre", "axle", "ackermann"]
LAWS = {
    "left.wheel_travel": {"polynomial": [-15.0, 40.0]},
    "right.wheel_travel": {"polynomial": [25.0, -10.0]},
    "rack": {"polynomial": [6.0, 15.0]},
}
ODD = ("steer_angle", "axle_roll_centre_offset")
"""Numbers that count to the left or to the right."""


def wishbones(laws: Mapping[str, Any], **changes: Any) -> Motion:
    """Two double wishbones on one rack."""
    mechanism = {**AXLE["mechanism"], "wheel_radius": 270.0, "car": {"wheelbase": 1600.0}, **changes}
    time = {"start": 0.0, "stop": 1.0, "samples": 7}
    content = {**AXLE, "mechanism": mechanism, "effects": EVERY, "inputs": laws, "time": time}
    return simulate(Scene.from_mapping(content))


def numbers_of(motion: Motion) -> dict[str, Array]:
    return {n: a for q, of in motion.numbers.items() if q != "position" for n, a in of.items()}


def bounds_of(motion: Motion) -> dict[str, Array]:
    proven = motion.proof(rates=True).proven
    return {n: a for q, of in proven.items() if q != "position" for n, a in of.items()}


def test_a_mirrored_motion_has_the_mirrored_numbers() -> None:
    left, right = (LAWS[f"{side}.wheel_travel"] for side in SIDES)
    back = {"polynomial": [-c for c in LAWS["rack"]["polynomial"]]}
    one = wishbones(LAWS)
    other = wishbones({"left.wheel_travel": right, "right.wheel_travel": left, "rack": back})
    found, mirrored, allowed, more = *map(numbers_of, (one, other)), *map(bounds_of, (one, other))
    swapped = {"left": "right", "right": "left", "": ""}
    assert {n.rpartition(".")[0] for n in found} == {*swapped}
    for name, array in found.items():
        part, dot, own = name.rpartition(".")
        there = swapped[part] + dot + own
        sign = -1.0 if own in ODD else 1.0
        assert (np.abs(array - sign * mirrored[there]) <= allowed[name] + more[there]).all(), name


def test_both_wheels_of_an_axle_are_what_each_is_alone() -> None:
    found = numbers_of(wishbones(LAWS))
    points = {
        n.partition(".")[2]: p for n, p in AXLE["mechanism"]["points"].items() if n.startswith("right.")
    }
    for side, sign in SIDES.items():
        drawn = {name: (x, sign * y, z) for name, (x, y, z) in points.items()}
        mechanism = {"type": "double_wishbone", "side": side, "points": drawn, "wheel_radius": 270.0}
        inputs = {name.removeprefix(f"{side}."): law for name, law in LAWS.items()}
        known = {name: law for name, law in inputs.items() if "." not in name}
        own = [effect for effect in EVERY if effect not in ("axle", "ackermann")]
        content = {**AXLE, "mechanism": mechanism, "effects": own, "inputs": known}
        content["time"] = {"start": 0.0, "stop": 1.0, "samples": 7}
        for name, array in numbers_of(simulate(Scene.from_mapping(content))).items():
            assert found[f"{side}.{name}"] == pytest.approx(array, rel=1e-11, abs=1e-11), name


def test_turned_and_scaled_axes_change_no_number() -> None:
    plain = wishbones(LAWS)
    turned = {n: (-z, y, x) for n, (x, y, z) in AXLE["mechanism"]["points"].items()}
    found = wishbones(LAWS, points=turned, up=(-1.0, 0.0, 0.0))
    for name, array in numbers_of(plain).items():
        assert numbers_of(found)[name] == pytest.approx(array, rel=1e-11, abs=1e-11), name


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wheel_radius": None}, "no wheel_radius"),
        ({"car": None}, "wheelbase"),
    ],
)
def test_what_an_axle_lacks_is_said(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError, match=words):
        wishbones(LAWS, **changes)


def test_one_wheel_is_no_axle() -> None:
    scene = Scene.load("double-wishbone")
    with pytest.raises(SceneError, match="needs two parts on opposite sides"):
        scene.model_copy(update={"effects": ["axle"]})
