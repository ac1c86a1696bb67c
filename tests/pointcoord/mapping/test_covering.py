"""What a covering is cut into and where it ends: orders, limits, folds, seams, and never another assembly."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from changed_scenes import scene_with
from sample_cars import by_drawn_car

from pointcoord import NotCovered, Scene, kinematic_map, standing
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.patches import flood as flooding
from pointcoord.patches.domain import Domain
from pointcoord.patches.flood import FOLD, SEAM, UNREACHED, Limits, flood
from pointcoord.patches.lookup import Lookup
from pointcoord.patches.patches import ProvenPatches
from pointcoord.patches.path import Spans, covered_until, way_of
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.follower import follow
from pointcoord.time_functions import Polynomial, Sine
from validate.formulations.reference_solution import reference_instant

# Where two branches of the paper's car nearly meet: arm angle, rad, and rack, mm.
SADDLE = (float(np.radians(35.118)), -0.0029)
RANGES = {"arm_angle": (0.9, 1.1), "rack": (-10.0, 10.0)}


STRUT = scene_mechanism(Scene.load("bounce"))


@by_drawn_car
def test_a_range_beyond_the_reach_is_covered_up_to_the_fold_and_refused_beyond(car: str) -> None:
    scene = scene_with(car, effects=[])
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
    map = kinematic_map(scene_with("bounce", effects=[]), ranges, 1e-6, halvings=5)
    assert 0.2 < map.share_covered < 1.0
    low, high = np.array([*ranges.values()]).T
    values = np.random.default_rng(4).uniform(low, high, (400, 2))
    covered = map.covers({"arm_angle": values[:, 0], "rack": values[:, 1]})
    inputs = {"arm_angle": values[:, 0], "rack": values[:, 1]}
    closed = close_drawing(STRUT)
    known = STRUT.known_series({name: value[:, None] for name, value in inputs.items()})[:, 0]
    # Straight from the drawing, along paths that are proven to keep to their branch.
    paths = follow(STRUT.map, np.tile(closed.y, (400, 1)), known)
    reached = paths.done >= 1.0
    both = covered & reached
    assert both.sum() > 60
    places = STRUT.places(paths.y[both])
    found = np.array([map.evaluate(value)[0] for value in values[both]])
    for i, name in enumerate(map.points):
        # Paths end where Newton's method does, with condition numbers near the folds of 1e5 or so.
        assert np.abs(found[:, i] - places[name] * STRUT.unit).max() <= map.bound.position + 1e-8
    # Inputs that no straight way leads to may be reached around a fold, but not where there is no assembly.
    for value in values[covered & ~reached][:5]:
        assert np.isfinite(map.evaluate(value)).all()


def test_neighbours_are_the_same_assembly_if_either_is_alone_around_the_other_and_else_one_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    domain, middle = Domain(STRUT, RANGES, 6), np.array([64, 64])
    begun = middle, assemble(STRUT, dict(zip(domain.free, domain.inputs_at(middle), strict=True))).y
    sound = flood(domain, Limits(1e-9), begun)
    kept = sound.patches
    assert sound.given_up == ()
    assert kept.holds(np.array([1.0, 0.0]), begun[1])
    assert not ProvenPatches.none(domain, 8).holds(np.array([1.0, 0.0]), begun[1])
    assert flooding._seams(replace(kept, unique_within=0.0 * kept.unique_within)).any()
    for place in (0, -1):
        alone = kept.unique_within.copy()
        alone[place] = 0.0
        assert not flooding._seams(replace(kept, unique_within=alone)).any()
    for coordinate in (0, 7):
        series = kept.series.copy()
        series[-1, 0, coordinate] += 2.0 * kept.unique_within.max()
        spoilt = replace(kept, series=series)
        monkeypatch.setattr(flooding.ProvenPatches, "joined", lambda none, others, spoilt=spoilt: spoilt)
        seamed = flood(domain, Limits(1e-9), begun)
        monkeypatch.undo()
        assert seamed.patches.low.tolist() == kept.low[:-1].tolist()
        assert [reason for _, reason in seamed.given_up] == [SEAM]


def test_a_way_is_followed_up_to_what_is_not_covered_and_no_further() -> None:
    domain = Domain(STRUT, {"arm_angle": (1.4, 1.8), "rack": (-20.0, 20.0)}, 6)
    laws, table = [Polynomial((1.4, 0.4)), Sine(19.0, 3.0)], np.zeros((64, 64), dtype=np.int64)
    spans = way_of(dict(zip(domain.free, laws, strict=True)), 0.0, 1.0)
    assert covered_until(laws, spans, Lookup(domain, table)) == 1.0
    # A gap beside the way, that a coarse span touches, and one on it.
    where = np.array([laws[0].series(0.7, 0)[0], laws[1].series(0.7, 0)[0]])
    column, row = ((where - [1.4, -20.0]) * 64 / [0.4, 40.0]).astype(int)
    table[column, row + 4] = -1
    coarse = Spans.of(laws, np.array([0.0, 0.5]), np.array([0.5, 1.0]))
    assert covered_until(laws, coarse, Lookup(domain, table)) == 1.0
    table[column, row] = -1
    # Up to where the arm enters the column, or the rack the row, less a part of a box.
    assert column / 64.0 - 0.5 / 64 <= covered_until(laws, coarse, Lookup(domain, table)) <= 0.7
    table[0, 32] = -1
    assert covered_until(laws, coarse, Lookup(domain, table)) == -np.inf


# Half the ranges of arm angle and rack travel about the drawing: so wide that assemblies end inside.
WIDE = {"arm_angle": 0.625, "rack": 160.0}


def test_every_covered_pose_of_a_wide_range_is_on_the_branch_of_the_drawing() -> None:
    scene = Scene.load("off-axis-strut")
    drawn = {n: round(64.0 * value) / 64.0 for n, value in drawn_inputs(scene).items() if n in WIDE}
    map = kinematic_map(scene, {n: (drawn[n] - half, drawn[n] + half) for n, half in WIDE.items()}, 1e-6)
    assert 0.3 < map.share_covered < 1.0
    shares = np.random.default_rng(5).integers(-1024, 1025, (30, 2)) / 1024
    refused = 0
    for share in shares.tolist():
        value = {n: drawn[n] + s * half for s, (n, half) in zip(share, WIDE.items(), strict=True)}
        if not map.covers(value):
            refused += 1
            with pytest.raises(NotCovered):
                map(value)
            continue
        exact = reference_instant(scene, {n: (number, 0.0, 0.0) for n, number in value.items()}).position
        for point, place in map(value).position.items():
            error = max(abs(Fraction(float(a)) - b) for a, b in zip(place, exact[point], strict=True))
            assert error <= map.bound.position, (point, float(error))
    assert 0 < refused < len(shares)
