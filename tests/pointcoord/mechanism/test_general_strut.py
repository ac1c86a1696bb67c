"""The strut as drawn: what is drawn is what is solved, and the paper's strut is its special case."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, SceneError, simulate
from pointcoord.results.closing import NOTICED

Array = NDArray[np.float64]
Car = dict[str, tuple[float, ...]]
SCENE = Scene.load("off-axis-strut")
CAR: Car = dict(SCENE.mechanism.points)


def drawn_angle(points: Car) -> float:
    arm = np.subtract(points["lower_ball_joint"], points["lower_arm_front"])
    return float(np.arccos(arm[2] / np.linalg.norm(arm)))


def closed_collinear(make_scene: Callable[..., Scene], table: Car) -> Car:
    """The paper's car where its collinear closing puts it."""
    motion = simulate(make_scene([drawn_angle(table)], [0.0], stop=0.0, samples=1, points=table))
    return {name: tuple(place[0].tolist()) for name, place in motion.position.items()}


def test_the_collinear_strut_is_the_general_one_with_its_ball_joint_on_the_axis(
    make_scene: Callable[..., Scene], table: Car
) -> None:
    car = closed_collinear(make_scene, table)
    laws: Any = ((1.4, 0.3, -0.1), (0.0, 30.0))
    straight, general = (
        simulate(make_scene(*laws, stop=0.8, points=car, closure=closure))
        for closure in ("collinear", "drawn")
    )
    bound = straight.proof().bound + general.proof().bound
    carried = straight.proof().carried_bound + general.proof().carried_bound
    # The closed car is rounded to doubles at 500 mm, so both close it anew, up to `condition` times as far.
    closing = 2 * np.finfo(float).eps * 512.0 * straight.proof().condition
    for name in straight.position:
        gap = np.abs(straight.position[name] - general.position[name]).max(axis=-1)
        assert (gap <= np.maximum(bound, carried) + closing).all()
    assert np.allclose(straight.wheel["camber"], general.wheel["camber"], rtol=0.0, atol=1e-11)
    assert np.allclose(straight.wheel["kingpin"], general.wheel["kingpin"], rtol=0.0, atol=1e-11)


def moved(name: str, by: tuple[float, float, float]) -> Car:
    return {**CAR, name: tuple(np.add(CAR[name], by).tolist())}


def test_closing_says_what_moves_and_what_the_drawing_misses(make_scene: Callable[..., Scene]) -> None:
    aside = np.cross(np.subtract(CAR["strut_top"], CAR["strut_lower"]), (1.0, 0.0, 0.0))
    aside = 0.5 * aside / np.linalg.norm(aside)
    car = moved("strut_rod_end", tuple(aside))
    motion = simulate(make_scene([1.63], [0.0], stop=0.0, samples=1, points=car, closure="drawn"))
    closing = motion.closing
    assert closing.point == "strut_rod_end"
    assert closing.largest == pytest.approx(0.5, rel=1e-3)
    assert closing.noticeable
    assert closing.largest > NOTICED
    assert not closing.changes_the_car
    assert closing.misses == {"strut_rod_end on the strut axis": pytest.approx(0.5, rel=1e-3)}
    # No other point feels it.
    assert max(far for name, far in closing.movements.items() if name != "strut_rod_end") < 1e-9


@pytest.mark.parametrize(("share", "refused"), [(0.0099, False), (0.0101, True)])
def test_one_percent_of_the_size_is_the_limit_of_closing(
    make_scene: Callable[..., Scene], share: float, refused: bool
) -> None:
    aside = np.cross(np.subtract(CAR["strut_top"], CAR["strut_lower"]), (1.0, 0.0, 0.0))
    far = share * 645.0  # mm: the car is 645 mm high
    car = moved("strut_rod_end", tuple(far * aside / np.linalg.norm(aside)))
    scene = make_scene([1.63], [0.0], stop=0.0, samples=1, points=car, closure="drawn")
    if refused:
        with pytest.raises(SceneError, match="another car") as caught:
            simulate(scene)
        assert "strut_rod_end on the strut axis" in caught.value.problem
    else:
        # The rod's end keeps its distance from the top, so that it moves a little more than across.
        assert simulate(scene).closing.largest == pytest.approx(far, rel=0.01)
