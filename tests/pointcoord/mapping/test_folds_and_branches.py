"""A map ends at folds, says so, and never goes over to another assembly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import PAPER_STRUT, SampleCar, by_car

from pointcoord import AssemblyError, NotCovered, Scene, kinematic_map, simulate, standing
from pointcoord.patches import flood as flooding
from pointcoord.patches.domain import Domain
from pointcoord.patches.flood import FOLD, SEAM, UNREACHED, Limits, flood
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.follower import follow

Array = NDArray[np.float64]

# Where two branches of the paper's car nearly meet: arm angle, rad, and rack, mm.
SADDLE = (float(np.radians(35.118)), -0.0029)


def scene_of(car: SampleCar) -> Scene:
    return Scene.from_mapping(
        {
            "mechanism": {
                "type": car.type,
                "closure": car.closure,
                "side": car.side,
                "points": {name: list(place) for name, place in car.points.items()},
            },
            "inputs": {"arm_angle": {"constant": 1.0}, "rack": {"constant": 0.0}},
            "time": {"start": 0.0, "stop": 0.0, "samples": 1},
        }
    )


@by_car
def test_a_range_beyond_the_reach_is_covered_up_to_the_fold_and_refused_beyond(car: SampleCar) -> None:
    scene = scene_of(car)
    stand = standing(scene)
    drawn = stand.inputs
    first, last = (end.value for end in stand.reach["rack"])
    middle, half = 0.5 * (first + last), 0.6 * (last - first)
    ranges = {"arm_angle": (drawn["arm_angle"],) * 2, "rack": (middle - half, middle + half)}
    map = kinematic_map(scene, ranges, halvings=9)
    racks = np.linspace(middle - half, middle + half, 4001)
    covered = map.covers({"rack": racks})
    smallest = 2.0 * half / 2**9
    assert not covered[(racks < first) | (racks > last)].any()
    # Patches shrink with the distance from a fold, so the smallest lies within a few of its own width.
    assert covered[(racks > first + 10 * smallest) & (racks < last - 10 * smallest)].all()
    assert {gap.reason for gap in map.uncovered} == {FOLD, UNREACHED}
    with pytest.raises(NotCovered, match="the map does not cover rack = ") as caught:
        map({"rack": [0.5 * (first + last), last + 0.01 * half]})
    assert caught.value.inputs["rack"] == last + 0.01 * half
    assert (caught.value.count, caught.value.asked) == (1, 2)
    with pytest.raises(NotCovered):
        map.evaluate([last + 0.01 * half])


def test_near_a_saddle_where_branches_nearly_meet_the_branch_is_the_drawing_s() -> None:
    ranges = {
        "arm_angle": (SADDLE[0] - 0.004, SADDLE[0] + 0.004),
        "rack": (SADDLE[1] - 0.2, SADDLE[1] + 0.2),
    }
    map = kinematic_map(scene_of(PAPER_STRUT), ranges, 1e-6, halvings=5)
    assert 0.2 < map.share_covered < 1.0
    mechanism = PAPER_STRUT.mechanism()
    low, high = np.array([*ranges.values()]).T
    values = np.random.default_rng(4).uniform(low, high, (400, 2))
    covered = map.covers({"arm_angle": values[:, 0], "rack": values[:, 1]})
    inputs = {"arm_angle": values[:, 0], "rack": values[:, 1]}
    closed = close_drawing(mechanism)
    known = mechanism.known_series({name: value[:, None] for name, value in inputs.items()})[:, 0]
    # Straight from the drawing, along paths that are proven to keep to their branch.
    paths = follow(mechanism.map, np.tile(closed.y, (400, 1)), known)
    reached = paths.done >= 1.0
    both = covered & reached
    assert both.sum() > 60
    places = mechanism.places(paths.y[both])
    found = map.evaluate(values[both])[0]
    for i, name in enumerate(map.points):
        # Paths end where Newton's method does, with condition numbers near the folds of 1e5 or so.
        assert np.abs(found[:, i] - places[name] * mechanism.unit).max() <= map.bound.position + 1e-8
    # Inputs that no straight way leads to may be reached around a fold, but not where there is no assembly.
    for value in values[covered & ~reached][:5]:
        assert np.isfinite(map.evaluate(value)).all()


@by_car
def test_neighbouring_patches_are_one_function_where_they_touch(car: SampleCar) -> None:
    drawn = car.drawn_inputs
    middle = 1.0 if car is PAPER_STRUT else drawn["arm_angle"]
    ranges = {"arm_angle": (middle - 0.2, middle + 0.2), "rack": (drawn["rack"] - 25.0, drawn["rack"] + 25.0)}
    map = kinematic_map(scene_of(car), ranges)
    assert len(map.patches) > 2
    nothing = 1e-13
    for patch in map.patches:
        (low, high), (left, right) = patch.ranges["arm_angle"], patch.ranges["rack"]
        racks = np.linspace(left, right, 5)[1:-1]
        for end in (low, high):
            sides = [end - nothing, end + nothing]
            if not ranges["arm_angle"][0] < sides[0] < sides[1] < ranges["arm_angle"][1]:
                continue
            here, there = (map.evaluate(np.stack([np.full(3, side), racks], axis=-1)) for side in sides)
            # Twice 1e-13 rad at rates below 2000 mm a rad.
            assert np.abs(here - there).max() <= 2.0 * map.bound.position + 4e-10


def test_a_patch_of_another_assembly_is_given_up_at_its_seam(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = PAPER_STRUT.mechanism()
    domain = Domain(mechanism, {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)}, 6)
    start = assemble(mechanism, {"arm_angle": np.array(1.0), "rack": np.array(0.0)})
    entry = (np.array([64, 64]), start.y)
    sound = flood(domain, 8, Limits(1e-9), entry, 4096)
    assert sound.given_up == ()
    kept = sound.patches
    series = kept.series.copy()
    series[-1, 0] += 2.0 * kept.unique_within[-1]  # an assembly that is proven to be another one
    monkeypatch.setattr(
        flooding.ProvenPatches, "joined", lambda none, kept: replace(sound.patches, series=series)
    )
    seamed = flood(domain, 8, Limits(1e-9), entry, 4096)
    assert len(seamed.patches.low) == len(kept.low) - 1
    assert [reason for _, reason in seamed.given_up] == [SEAM]


@pytest.mark.parametrize("corner", [(0, 0), (128, 0), (0, 128), (128, 128)])
def test_where_no_path_leads_far_boxes_are_entered_from_their_neighbours(
    monkeypatch: pytest.MonkeyPatch, corner: tuple[int, int]
) -> None:
    mechanism = PAPER_STRUT.mechanism()
    domain = Domain(mechanism, {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)}, 6)
    arm_angle, rack = domain.inputs_at(np.array(corner))
    start = assemble(mechanism, {"arm_angle": arm_angle, "rack": rack})
    monkeypatch.setattr(flooding, "STEPS", 1)
    found = flood(domain, 8, Limits(1e-6), (np.array(corner), start.y), 4096)
    assert found.given_up == ()
    assert np.prod(found.patches.high - found.patches.low, axis=-1).sum() == 64**2


def test_a_range_that_the_drawing_cannot_reach_is_refused_with_what_stops_it() -> None:
    scene = scene_of(PAPER_STRUT)
    last = standing(scene).reach["rack"][1].value
    with pytest.raises(AssemblyError, match=r"wanted .*rack"):
        kinematic_map(scene, {"arm_angle": (1.6, 1.7), "rack": (last + 50.0, last + 60.0)})


def test_where_the_map_has_no_answer_simulation_has_none_or_a_fold_is_near() -> None:
    scene = scene_of(PAPER_STRUT)
    ranges = {"arm_angle": (0.5, 1.0), "rack": (-80.0, 80.0)}
    map = kinematic_map(scene, ranges, 1e-6)
    low, high = np.array([*ranges.values()]).T
    values = np.random.default_rng(6).uniform(low, high, (300, 2))
    covered = map.covers({"arm_angle": values[:, 0], "rack": values[:, 1]})
    assert 0 < covered.sum() < 300
    content = scene.model_dump(exclude_none=True)
    for value in values[~covered][:12]:
        names = ("arm_angle", "rack")
        content["inputs"] = {n: {"constant": float(v)} for n, v in zip(names, value, strict=True)}
        try:
            motion = simulate(Scene.from_mapping(content))
        except AssemblyError:
            continue
        assert motion.start.condition > 1e3
