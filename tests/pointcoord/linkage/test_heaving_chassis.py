"""A chassis that moves up and down carries the whole motion with it."""

from collections.abc import Callable

import numpy as np

from pointcoord import Scene, simulate

EPS = np.finfo(float).eps


def test_a_heave_of_any_speed_leaves_the_series_as_they_are(make_scene: Callable[..., Scene]) -> None:
    # 1e6 turns in a second would take as many series if the chassis' motion were part of what is solved.
    sine = {"sine": {"amplitude": 1.0, "angular_frequency": 1e7}}
    still, moved = simulate(make_scene()), simulate(make_scene(heave=sine))
    assert moved.work.segments == still.work.segments
    top = moved.velocity["strut_top"][:, 2]
    assert np.abs(top - 1e7 * np.cos(1e7 * moved.times)).max() <= 4 * EPS * 1e7
