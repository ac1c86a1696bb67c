"""What is drawn is what is solved, of every suspension that takes its drawing as it stands."""

from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import AssemblyError, Scene, SceneError, simulate
from pointcoord.results.closing import NOTICED


def with_its_rod_end_aside(make_scene: Callable[..., Scene], far: float) -> Scene:
    """A strut whose rod's end is drawn so far beside its axis, mm."""
    car = dict(Scene.load("off-axis-strut").mechanism.points)
    across = np.cross(np.subtract(car["strut_top"], car["strut_lower"]), (1.0, 0.0, 0.0))
    car["strut_rod_end"] = tuple(car["strut_rod_end"] + far * across / np.linalg.norm(across))
    return make_scene([1.63], [0.0], stop=0.0, samples=1, points=car, closure="drawn")


def test_closing_says_what_moves_and_what_the_drawing_misses(make_scene: Callable[..., Scene]) -> None:
    closing = simulate(with_its_rod_end_aside(make_scene, 0.5)).closing
    assert closing.point == "strut_rod_end"
    assert closing.largest == pytest.approx(0.5, rel=1e-3)
    assert closing.noticeable
    assert closing.largest > NOTICED
    assert not closing.changes_the_car
    assert closing.misses == {"strut_rod_end on the strut axis": pytest.approx(0.5, rel=1e-3)}
    # No other point feels it.
    assert max(far for name, far in closing.movements.items() if name != "strut_rod_end") < 1e-9


def test_one_percent_of_the_size_is_the_limit_of_closing(make_scene: Callable[..., Scene]) -> None:
    size = 645.0  # mm: the car is so high
    # The rod's end keeps its distance from the top, so that it moves a little more than across.
    scene = with_its_rod_end_aside(make_scene, 0.0099 * size)
    assert simulate(scene).closing.largest == pytest.approx(0.0099 * size, rel=0.01)
    with pytest.raises(SceneError, match="another car") as caught:
        simulate(with_its_rod_end_aside(make_scene, 0.0101 * size))
    assert "strut_rod_end lies 6.52 mm off the strut axis" in caught.value.problem


def test_a_drawing_too_crooked_to_close_is_refused_as_a_drawing(
    make_scene: Callable[..., Scene], table: dict[str, tuple[float, ...]]
) -> None:
    # The strut's lower point 200 mm in front of its line: no input is to blame, the drawing is.
    x, y, z = table["strut_lower"]
    with pytest.raises(
        AssemblyError, match=r"the drawing cannot be assembled.*; draw the points of these closer"
    ) as caught:
        simulate(make_scene(points={**table, "strut_lower": (x - 200.0, y, z)}))
    assert caught.value.reduce == ""
    assert any("strut_lower" in name for name in caught.value.limits)


def test_pieces_of_the_strut_that_would_turn_over_are_refused(
    make_scene: Callable[..., Scene], table: dict[str, tuple[float, ...]]
) -> None:
    # The knuckle's piece points up the strut; drawn at 100 degrees to the rod and at 120 to the way from
    # ball joint to top, it has no sense that both agree on.
    x, y, z = table["lower_ball_joint"]
    folded = {**table, "strut_lower": (x + 60.0, y, z - 6.0), "strut_rod_end": (420.0, -180.0, 466.0)}
    with pytest.raises(AssemblyError, match=r"can close in two ways, .* turns over against") as caught:
        simulate(make_scene(points=folded))
    assert caught.value.problem.startswith("the drawing")
