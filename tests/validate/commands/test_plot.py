"""What `plot` draws is what was computed, with its units and signs."""

from pathlib import Path

import numpy as np
import pytest
from program import short_scene

from pointcoord import NotComputed, Scene, simulate, sweep
from pointcoord.effects.registry import NUMBERS_OF_THE_CAR
from validate.cli import main
from validate.curves import picture
from validate.curves.numbers import Curves, found, numbers_of, usual
from validate.curves.of_file import read_written
from validate.errors import UsageError
from validate.output.columns import ENDINGS

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
    ("name", "effects", "expected"),
    [
        ("double-wishbone", None, (["camber", "kingpin", "toe", "caster"], ["travel"])),
        ("steer", None, (["rack"], ["camber", "kingpin"])),
        ("steer", (), (["time"], ["wheel_centre.x", "wheel_centre.y", "wheel_centre.z"])),
    ],
)
def test_without_a_word_the_curves_are_those_of_an_engineer(
    name: str, effects: tuple[str, ...] | None, expected: tuple[list[str], list[str]]
) -> None:
    scene = Scene.load(name)
    if effects is not None:
        scene = scene.model_copy(update={"effects": effects})
    curves = usual(scene, numbers_of(scene), simulate(scene))
    assert ([n.short for n in curves.across], [n.short for n in curves.up]) == expected


def test_angles_are_in_degrees_and_each_axis_says_its_sign() -> None:
    curves = Curves(tuple(found("wheel_centre.z", NUMBERS)), tuple(found("camber", NUMBERS)))
    camber = MOTION.wheel["camber"]
    for degrees, unit, values in ((True, "[deg]", np.degrees(camber)), (False, "[rad]", camber)):
        (axes,) = picture.figure(curves, lambda n, d=degrees: n.shown(MOTION, MOTION, d), "car", degrees).axes
        assert np.array_equal(axes.lines[0].get_xdata(), MOTION.position["wheel_centre"][:, 2])
        assert np.array_equal(axes.lines[0].get_ydata(), values)
        said = " ".join(axes.get_ylabel().split())
        assert said == f"camber {unit} + {NUMBERS_OF_THE_CAR['camber'].sign}"
        assert axes.get_xlabel().splitlines() == ["position of wheel centre, z [mm]", "+ up"]


def test_no_label_of_a_picture_reaches_over_its_edge_or_another_panel() -> None:
    every = tuple(n for n in NUMBERS if n.of_the_car and n.missing is None)
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


def test_the_same_scene_gives_the_same_bytes_and_its_title_is_text(
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
    assert main([*words, "-o", str(tmp_path / "a.png")]) == 0
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_point_that_the_scene_does_not_report_is_said_how_to_have() -> None:
    scene = WISHBONE.model_copy(update={"points": ("tie_rod_outer",)})
    for words in ("wheel_centre.z", "travel"):
        with pytest.raises(NotComputed, match="add 'wheel_centre' to the scene's points"):
            found(words, numbers_of(scene))
    with pytest.raises(UsageError, match="is more than one number"):
        found("z", numbers_of(scene))


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of three designs, of which the middle one cannot be solved, in every kind of file."""
    folder = tmp_path_factory.mktemp("sweep")
    for ending in ENDINGS:
        words = ("--designs", str(folder / "designs.csv"), "--instants", "7", "-q")
        (folder / "designs.csv").write_text("tie_rod_inner.y\n178\n640\n180\n", encoding="utf-8")
        assert main(("sweep", "double-wishbone", *words, "-o", str(folder / f"sweep{ending}"))) == 3
    return folder


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_file_of_a_sweep_has_a_curve_for_each_design(ending: str, swept: Path) -> None:
    written = read_written(str(swept / f"sweep{ending}"))
    few = WISHBONE.model_copy(update={"time": WISHBONE.time.model_copy(update={"samples": 7})})
    designs = sweep(few, {"tie_rod_inner.y": [178.0, 180.0]})
    camber = written.values["wheel", "camber"]
    assert camber.shape == (7, 3)
    # CSV has every digit, and degrees are one rounding away.
    assert pytest.approx(np.degrees(designs.numbers["wheel"]["camber"]), rel=1e-14) == camber[:, ::2].T
    assert np.isnan(camber[:, 1]).all()
    assert [n.words for n in written.varied] == ["tie_rod_inner.y"]
    assert written.across.path == ("time",)
    assert {number.path[-1] for number in written.angles} == {"camber", "kingpin", "toe", "caster"}
    shade = picture.Shade("tie_rod_inner.y [mm]", written.values["tie_rod_inner", "y"][0])
    curves = Curves((written.across,), written.angles[:1])
    axes, bar = picture.figure(curves, lambda n: written.values[n.path], "sweep", False, shade).axes
    drawn = [np.asarray(line.get_xydata()) for line in axes.lines if len(line.get_xdata()) == 7]
    for line, rows in zip(drawn, camber.T, strict=True):
        assert np.array_equal(line[:, 1], rows, equal_nan=True)
    assert bar.get_ylabel() == "tie_rod_inner.y [mm]"
    assert axes.get_ylabel() == "camber [deg]\n+ where the wheel leans out at the top"


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        ((), 0, ""),
        (("--x", "camber"), 0, ""),
        (("--y", "wheel_centre.z"), 0, ""),
        (("--y", "cambr"), 2, "'cambr' names no number that is here (did you mean 'camber'?)"),
        (("--instants", "3"), 2, "are about a scene; a file has its own rows and units"),
    ],
)
def test_plot_draws_the_columns_of_a_file(
    words: tuple[str, ...], status: int, told: str, swept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = swept / "sweep.png"
    target.unlink(missing_ok=True)
    assert main(("plot", str(swept / "sweep.csv"), *words, "-o", str(target))) == status
    assert target.exists() == (status == 0)
    assert told in capsys.readouterr().err
