"""What `plot` draws is what was computed, with its units and signs."""

from pathlib import Path

import numpy as np
import pytest
from program import short_scene

from pointcoord import Scene, simulate
from pointcoord.effects.registry import NUMBERS_OF_THE_CAR
from validate.cli import main
from validate.curves import picture
from validate.curves.numbers import Curves, angles_of, asking_for, found, numbers_of, usual

WISHBONE = Scene.load("double-wishbone")
MOTION = simulate(WISHBONE)
NUMBERS = numbers_of(WISHBONE)


def read(words: str) -> list[np.ndarray]:
    return [number.read(MOTION, MOTION) for number in found(words, NUMBERS)]


def test_few_words_name_the_number_that_the_motion_has() -> None:
    for quantity, channel in MOTION.numbers.items():
        for name, array in channel.items():
            shaped = array.reshape(len(array), -1)
            for words in (f"{quantity}.{name}", *([name] if channel.quantity.of == "car" else [])):
                assert (np.stack(read(words), axis=-1) == shaped).all()
    (height,) = read("wheel_centre.z")
    assert (height == MOTION.position["wheel_centre"][:, 2]).all()
    assert (np.stack(read("angular_velocity"), axis=-1) == MOTION.angular_velocity["knuckle"]).all()
    (rack,) = read("rack")
    assert rack == pytest.approx(15.0 * np.sin(4.0 * MOTION.times), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "changes", "expected"),
    [
        ("double-wishbone", {}, (["camber", "kingpin", "toe", "caster"], ["travel"])),
        ("steer", {}, (["rack"], ["camber", "kingpin"])),
        ("steer", {"effects": ()}, (["time"], [f"position.wheel_centre.{axis}" for axis in "xyz"])),
    ],
)
def test_without_a_word_the_curves_are_those_of_an_engineer(
    name: str, changes: dict[str, object], expected: tuple[list[str], list[str]]
) -> None:
    scene = Scene.load(name).model_copy(update=changes)
    curves = usual(scene, simulate(scene), angles_of(scene))
    assert ([n.called for n in curves.across], [n.called for n in curves.up]) == expected


def test_angles_are_in_degrees_and_each_axis_says_its_sign() -> None:
    curves = Curves(tuple(found("wheel_centre.z", NUMBERS)), tuple(found("camber", NUMBERS)))
    (axes,) = picture.figure(curves, lambda n: n.shown(MOTION, MOTION), "car").axes
    assert np.array_equal(axes.lines[0].get_xdata(), MOTION.position["wheel_centre"][:, 2])
    assert np.array_equal(axes.lines[0].get_ydata(), np.degrees(MOTION.wheel["camber"]))
    said = " ".join(axes.get_ylabel().split())
    assert said == f"camber [deg] + {NUMBERS_OF_THE_CAR['camber'].sign}"
    assert axes.get_xlabel().splitlines() == ["position of wheel centre, z [mm]", "+ up"]


def test_no_label_of_a_picture_reaches_over_its_edge_or_another_panel() -> None:
    every = tuple(n for n in NUMBERS if n.of_the_car and not n.effect)
    travel, time = found("travel", NUMBERS), found("time", NUMBERS)
    for curves in (Curves(every, travel), Curves(time, every + found("velocity.wheel_centre", NUMBERS))):
        page = picture.figure(curves, lambda n: n.shown(MOTION, MOTION), WISHBONE.title)
        page.draw_without_rendering()
        frame = page.bbox
        named = [axis.label for a in page.axes for axis in (a.xaxis, a.yaxis) if axis.label.get_text()]
        labels = [label.get_window_extent() for label in named]
        assert len(labels) > len(page.axes)
        for box in (*labels, *(text.get_window_extent() for text in page.texts)):
            assert frame.x0 <= box.x0 <= box.x1 <= frame.x1
            assert frame.y0 <= box.y0 <= box.y1 <= frame.y1
        assert not [(a, b) for i, a in enumerate(labels) for b in labels[:i] if a.overlaps(b)]


def test_the_same_scene_gives_the_same_bytes_and_titles_files_and_columns_are_text(
    tmp_path: Path, capsysbinary: pytest.CaptureFixture[bytes]
) -> None:
    scene, target = short_scene(tmp_path, title='"$\\\\frac{1}$ </text><script>"'), tmp_path / "a.svg"
    words = ["plot", "-q", scene, "--y", "camber", "--x", "wheel_centre.z"]
    assert main([*words, "-o", str(target)]) == 0
    assert main(words) == 0
    out, err = capsysbinary.readouterr()
    assert (out, err) == (target.read_bytes(), b"")
    assert out.startswith(b"<?xml")
    assert b"<script>" not in out
    file = tmp_path / "$\\frac{1$.csv"
    file.write_text("time [s],$\\frac{2$\n0,1\n1,2\n", encoding="utf-8")
    assert main(["plot", str(file), "--y", "$\\frac{2$", "-o", str(tmp_path / "a.png")]) == 0


def test_what_is_named_is_computed_though_the_scene_does_not_ask_for_it() -> None:
    bounce = Scene.load("bounce")
    assert "toe" in asking_for(bounce, found("toe", numbers_of(bounce))).effects
    few = WISHBONE.model_copy(update={"points": ("tie_rod_outer",)})
    for words in ("wheel_centre.z", "travel"):
        named = found(words, numbers_of(few))
        motion = simulate(asking_for(few, named))
        assert [n.read(motion, motion).tolist() for n in named] == [one.tolist() for one in read(words)]
