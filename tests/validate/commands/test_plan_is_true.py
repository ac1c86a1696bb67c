"""What `pointcoord plan` says of a scene is so."""

import numpy as np
import pytest

from pointcoord import Scene
from validate.cli import main


@pytest.mark.parametrize("scene", ["slider-crank", "andrews-squeezer", "spatial-four-bar"])
def test_a_crank_that_turns_round_has_no_end_that_a_scene_could_go_beyond(
    scene: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert Scene.load(scene).functions["crank"].series(np.array([2.0]), 0)[0, 0] > 2.0 * np.pi
    assert main(["plan", scene]) == 0
    said = capsys.readouterr()
    assert "the other inputs held, it goes all the way round" in said.out
    assert said.err == ""


@pytest.mark.parametrize(
    ("scene", "side"), [("five-link", ", left side"), ("axle-steer", ""), ("slider-crank", "")]
)
def test_a_mechanism_is_on_a_side_of_the_car_if_it_carries_one_wheel(
    scene: str, side: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plan", scene]) == 0
    assert f"mechanism: {Scene.load(scene).mechanism.name}{side}; inputs: " in capsys.readouterr().out
