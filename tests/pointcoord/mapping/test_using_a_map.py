"""A map as a user has it: shapes, ranges, laws composed with it, effects, and files."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from within_bounds import differing

from pointcoord import (
    InputOutOfRange,
    KinematicMap,
    MapError,
    NotComputed,
    NotCovered,
    PointcoordError,
    Scene,
    UnknownName,
    kinematic_map,
)
from pointcoord.numerics.arrays import Array

RANGES = {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)}
AT = {"arm_angle": 1.0, "rack": 1.0}


@pytest.fixture(scope="module")
def steered() -> KinematicMap:
    return kinematic_map(Scene.load("steer"), RANGES)


def test_inputs_of_any_shape_give_arrays_of_that_shape(steered: KinematicMap) -> None:
    angles = np.linspace(0.9, 1.1, 6).reshape(2, 1, 3)
    racks = np.linspace(-10.0, 10.0, 4).reshape(4, 1)
    found = steered({"arm_angle": angles, "rack": racks}, {"arm_angle": 1.0, "rack": racks})
    assert found.position["wheel_centre"].shape == (2, 4, 3, 3)
    assert found.position["strut_top"].shape == (2, 4, 3, 3)
    assert found.velocity["wheel_centre"].shape == (2, 4, 3, 3)
    assert found.wheel["camber"].shape == (2, 4, 3)
    assert not found.acceleration.computed
    assert steered(AT).position["wheel_centre"].shape == (3,)
    assert steered({"arm_angle": np.empty((0, 2)), "rack": 0.0}).position["wheel_centre"].shape == (0, 2, 3)


def test_one_pose_and_many_are_summed_alike(steered: KinematicMap) -> None:
    generator = np.random.default_rng(1)
    values = generator.uniform((0.9, -10.0), (1.1, 10.0), (50, 2))
    speeds, changes = generator.normal(size=(2, 50, 2))
    given = (dict(zip(steered.inputs, state.T, strict=True)) for state in (values, speeds, changes))
    many = steered(*given)
    for i in range(50):
        one = steered.evaluate(values[i], speeds[i], changes[i])
        # Rounding: relative to terms below 1e3 mm, 1e3 mm / s and 1e4 mm / s^2, with the sums' hundred terms.
        for d, size in enumerate((1e3, 1e3, 1e4)):
            channel = (many.position, many.velocity, many.acceleration)[d]
            for name, state in zip(steered.points, one[d], strict=True):
                assert np.abs(state - channel[name][i]).max() <= 100 * 2.0**-52 * size
        assert np.abs(steered.evaluate(values[i])[0] - one[0]).max() <= 100 * 2.0**-52 * 1e3


def test_a_map_is_within_its_tolerance_and_covers_its_range(steered: KinematicMap) -> None:
    assert len(steered.series.low) > 1
    assert steered.bound.position <= steered.tolerance == 1e-9
    assert steered.share_covered == 1.0
    assert steered.uncovered == ()


def test_a_car_that_is_drawn_far_away_is_mapped_as_well_near_itself(steered: KinematicMap) -> None:
    content = steered.scene.model_dump(exclude_none=True)
    far = (2.0**30, -(2.0**29), 2.0**31)
    points = content["mechanism"]["points"]
    content["mechanism"]["points"] = {
        name: tuple(c + shift for c, shift in zip(place, far, strict=True)) for name, place in points.items()
    }
    map = kinematic_map(Scene.from_mapping(content), RANGES)
    # Whole numbers of mm below 2^53 are moved without rounding, so what is solved is the same.
    assert (map.evaluate([1.01, 2.0]) == steered.evaluate([1.01, 2.0]))[0].all()
    near, moved = (one({"arm_angle": 1.01, "rack": 2.0}).position["wheel_centre"] for one in (steered, map))
    assert (np.abs(moved - far - near) <= map.bound.position + steered.bound.position).all()
    # A number near 2^31 is rounded by up to 2^-22, and the bound says so.
    assert 2.0**-23 <= map.bound.position <= 2.0**-21


def test_an_input_can_be_held(steered: KinematicMap) -> None:
    map = kinematic_map(Scene.load("steer"), {"arm_angle": (0.9, 1.1), "rack": (4.0, 4.0)})
    assert map.inputs == ("arm_angle",)
    angles = np.linspace(0.9, 1.1, 7)
    for given in ({"arm_angle": angles}, {"arm_angle": angles, "rack": 4.0}):
        found = map(given, {"arm_angle": 1.0})
        wanted = steered({"arm_angle": angles, "rack": 4.0}, {"arm_angle": 1.0, "rack": 0.0})
        apart = np.abs(found.position["wheel_centre"] - wanted.position["wheel_centre"])
        assert apart.max() <= map.bound.position + steered.bound.position
        rate = np.abs(found.velocity["wheel_centre"] - wanted.velocity["wheel_centre"])
        assert rate.max() <= map.bound.velocity["arm_angle"] + steered.bound.velocity["arm_angle"]
    with pytest.raises(InputOutOfRange, match="'rack' is 5; allowed: 4, as the map holds this input"):
        map({"arm_angle": angles, "rack": 5.0})
    with pytest.raises(InputOutOfRange, match="'rack' is 1; allowed: 0"):
        map({"arm_angle": angles}, {"arm_angle": 1.0, "rack": 1.0})


@pytest.mark.parametrize("value", [1.1 + 1e-12, 0.9 - 1e-12, np.nan, np.inf])
def test_a_value_out_of_range_is_refused_with_its_name_and_the_range(
    steered: KinematicMap, value: float
) -> None:
    for values in (value, [1.0, value]):
        with pytest.raises(InputOutOfRange, match=r"'arm_angle' is .*; allowed: 0.9 to 1.1") as caught:
            steered({"arm_angle": values, "rack": 0.0})
        assert caught.value.name == "arm_angle"
        assert not steered.covers({"arm_angle": values, "rack": 0.0}).all()
    with pytest.raises(InputOutOfRange, match="'arm_angle'"):
        steered.evaluate([value, 0.0])


REFUSED: list[tuple[Callable[[KinematicMap], object], type[PointcoordError], str]] = [
    (lambda m: m({"arm_angle": 1.0}), UnknownName, "no given input named 'rack'"),
    (lambda m: m({**AT, "roll": 1.0}), UnknownName, "no input named 'roll'"),
    (lambda m: m(AT, {"rack": 1.0}), UnknownName, "a rate named 'arm_angle'"),
    (lambda m: m(AT, None, AT), NotComputed, "give the rates of the inputs as well"),
    (
        lambda m: m(AT, {**AT, "rack": np.inf}),
        InputOutOfRange,
        "'rack' is inf; allowed: finite rates",
    ),
    (
        lambda m: m.evaluate([1.0, 0.0], [1.0, np.nan]),
        InputOutOfRange,
        "'rack' is nan; allowed: finite rates",
    ),
    (lambda m: m({**AT, "heave": np.nan}), InputOutOfRange, "'heave' is nan"),
    (lambda m: m(AT).velocity["wheel_centre"], NotComputed, "velocity of wheel_centre was not computed"),
    (lambda m: m.evaluate([1.0, 0.0, 3.0]), MapError, r"values have the shape \(3,\); allowed: \(2,\), a"),
    (lambda m: m({"arm_angle": [1.0, 1.0], "rack": np.ones(3)}), MapError, r"\(2,\), \(3,\).*broadcast"),
    (lambda m: m.covers({**AT, "arm_angle": "x"}), MapError, "arm_angle.*numbers.*'x'"),
    (lambda m: m([1.0, 0.0]), MapError, "values is of type list; allowed: .* by input"),
    (lambda m: m.save(None), MapError, "None.*path of a file"),
    (lambda m: m.save("/no/such/folder/map.npz"), MapError, "cannot be written"),
]


@pytest.mark.parametrize(("use", "kind", "words"), REFUSED)
def test_what_a_map_cannot_give_is_refused_in_words(
    steered: KinematicMap, use: Callable[[Any], object], kind: type[PointcoordError], words: str
) -> None:
    with pytest.raises(kind, match=words):
        use(steered)


UNUSABLE: list[tuple[dict[str, Any], type[PointcoordError], str]] = [
    ({"ranges": {"arm_angle": (0.9, 1.1)}}, UnknownName, "no range of an input named 'rack'"),
    ({"ranges": {**RANGES, "heave": (0.0, 1.0)}}, MapError, "moves the whole chassis"),
    ({"ranges": {**RANGES, "rack": (5.0, -5.0)}}, MapError, r"ranges\['rack'\] is \(5.0, -5.0\)"),
    ({"ranges": {**RANGES, "rack": 5.0}}, MapError, r"ranges\['rack'\] is 5.0; allowed: two finite numbers"),
    (
        {"ranges": {**RANGES, "rack": (0.0, 5e-324)}},
        MapError,
        "rack.*5e-324.*equal numbers to hold the input",
    ),
    ({"ranges": {"arm_angle": (1.0, 1.0), "rack": (0.0, 0.0)}}, MapError, "leave 0 inputs free"),
    ({"ranges": {**RANGES, "arm_angle": (3.0, 3.5)}}, InputOutOfRange, "'arm_angle' is 3.5"),
    ({"ranges": 7}, MapError, "ranges is of type int"),
    ({"tolerance": 0.0}, MapError, "tolerance is 0.0; allowed: a finite number of mm above 0"),
    ({"tolerance": "1e-9"}, MapError, "tolerance is '1e-9'"),
    ({"halvings": 11}, MapError, "halvings is 11; allowed: a whole number"),
    ({"tolerance": 1e-15}, NotCovered, "rounding alone exceeds the tolerance"),
]


@pytest.mark.parametrize(("settings", "kind", "words"), UNUSABLE)
def test_what_makes_no_map_is_refused_in_words(
    settings: dict[str, Any], kind: type[PointcoordError], words: str
) -> None:
    with pytest.raises(kind, match=words):
        kinematic_map(Scene.load("steer"), **{"ranges": RANGES, **settings})


def test_a_map_takes_no_loads() -> None:
    scene = scene_with("pushrod", {"loads": {"": {"force": [0.0, 0.0, 3e3]}}}, effects=["loads"])
    with pytest.raises(MapError, match="without derivatives"):
        kinematic_map(scene, dict.fromkeys(scene.inputs, (-1.0, 1.0)))


def test_a_saved_map_comes_back_to_the_last_bit(steered: KinematicMap, tmp_path: Path) -> None:
    rates = {"arm_angle": 0.3, "rack": 7.0}
    inputs = {"arm_angle": np.linspace(0.9, 1.1, 60), "rack": np.linspace(10.0, -10.0, 60)}
    gaps = kinematic_map(Scene.load("steer"), {"arm_angle": (1.0, 1.0), "rack": (-10.0, 300.0)}, halvings=3)
    gaps.save(tmp_path / "gaps.npz")
    assert KinematicMap.load(tmp_path / "gaps.npz").uncovered == gaps.uncovered != ()
    steered.save(tmp_path / "map.npz")
    for again in (KinematicMap.load(tmp_path / "map.npz"), pickle.loads(pickle.dumps(steered))):
        one, other = (map(inputs, rates, rates) for map in (again, steered))
        assert differing(one.numbers, other.numbers) == []
        assert again.bound == steered.bound
        assert again.uncovered == steered.uncovered
        assert dict(again.ranges) == dict(steered.ranges)
        assert again.scene == steered.scene
        assert repr(again) == repr(steered)


def _changed(path: Path, name: str, change: Callable[[Any], Any]) -> None:
    with np.load(path) as file:
        arrays = {key: file[key] for key in file.files}
    arrays[name] = change(arrays[name])
    np.savez(path, **arrays)


def _nudged(coefficients: Array) -> Array:
    coefficients[0, 3, 7] += 1e-8
    return coefficients


DAMAGE: dict[str, tuple[Callable[[Path], object], str]] = {
    "none there": (lambda p: p.unlink(), "cannot be read: No such file"),
    "a text": (lambda p: p.write_text("arm_angle"), "is not an npz file"),
    "empty": (lambda p: p.write_bytes(b""), "is not an npz file"),
    "cut off": (lambda p: p.write_bytes(p.read_bytes()[:1000]), "is not an npz file, or is damaged"),
    "another npz": (lambda p: np.savez(p, a=np.zeros(3)), "is not a kinematic map"),
    "another version": (
        lambda p: _changed(p, "version", lambda v: v + 1),
        "of version 3; allowed",
    ),
    "a coefficient off by 1e-8": (
        lambda p: _changed(p, "coefficients", _nudged),
        "differs from what was saved",
    ),
    "another scene": (lambda p: _changed(p, "head", lambda t: str(t).replace("460", "461")), "is damaged"),
    "objects": (
        lambda p: _changed(p, "off", lambda c: np.array([None])),
        "is not an npz file, or is damaged",
    ),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_file_that_is_no_map_is_refused_in_words(
    steered: KinematicMap, tmp_path: Path, damage: str
) -> None:
    path = tmp_path / "map.npz"
    steered.save(path)
    spoil, words = DAMAGE[damage]
    spoil(path)
    with pytest.raises(MapError, match=words):
        KinematicMap.load(path)
