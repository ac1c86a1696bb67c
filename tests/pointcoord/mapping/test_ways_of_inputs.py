"""The way of the inputs: the boxes that hold it, up to where it is covered, and where it starts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.method import MAP
from pointcoord.patches.domain import Domain
from pointcoord.patches.lookup import Lookup, Marked, touched
from pointcoord.patches.path import Spans, covered_until, way_of
from pointcoord.patches.way_map import map_way
from pointcoord.simulation import map_limits, prepare_task
from pointcoord.time_functions import Polynomial, Sine

Array = NDArray[np.float64]
Make = Callable[..., Scene]


def test_a_pose_of_another_assembly_is_not_the_patch_s(make_scene: Make) -> None:
    scene = make_scene([1.6, 0.05], [0.0, 3.0])
    task = prepare_task(scene, MAP)
    mechanism = task.readout.mechanism
    way = map_way(mechanism, task.functions, task.start, 0.0, 2.0, map_limits(scene, mechanism, 0))
    values = np.array([1.6, 0.0])
    y = task.start.y
    assert way.patches.holds(values, y)
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
    assert not way.patches.holds(values, other)


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
