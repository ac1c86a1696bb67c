"""Hardpoints of other programs become the car that they are, or a line that says why not."""

from collections.abc import Mapping
from math import cos, degrees, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign_files import CAR, OPTIMUMK, STRUT, WISHBONE, chrono, drawn, imported, lotus_report, table

from pointcoord import PointcoordError, Scene, standing
from pointcoord.mechanism import mechanism_file
from validate.cli import main
from validate.closed_drawing import warnings_of
from validate.errors import UsageError
from validate.hardpoint_files.contents import Axes
from validate.hardpoint_files.format import MJCF, READERS, TABLE, formats
from validate.hardpoint_files.importing import import_hardpoints
from validate.tables.errors import FileError

POINTS = WISHBONE.mechanism.points
MIRRORED = {name: (x, -y, z) for name, (x, y, z) in CAR.items()}
EXCHANGED = OPTIMUMK | {
    "lower_arm_front": OPTIMUMK["lower_arm_rear"],
    "lower_arm_rear": OPTIMUMK["lower_arm_front"],
}
LEFT_CHRONO = chrono("double_wishbone", POINTS, 1)


def test_the_scene_that_is_written_is_the_one_that_is_returned_and_validates(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / "report.txt", tmp_path / "scene.toml"
    source.write_text(lotus_report())
    assert main(["import", str(source), "-o", str(target)]) == 0
    out, err = capsys.readouterr()
    assert "caster: the file prints 4.94 deg, its points give 4.9360: agrees" in out
    assert "point not recognised: Part 1 C of G, line 19" in out
    told = "points not recognised: Part 1 C of G, line 19, Bracket of our own, line 20"
    assert err.splitlines() == [f"pointcoord: note: {source}: {told}"]
    found = import_hardpoints(source)
    assert (Scene.load(target), drawn(found)) == (found.scene, CAR)
    text = target.read_text()
    assert "lower_arm_front  = [-110, 257, 69]     # Lower wishbone front pivot, line 9" in text
    assert "# not used: Bracket of our own, line 20" in text
    assert main(["validate", str(target)]) == 0
    assert "1 of 1 scene agrees" in capsys.readouterr().out
    assert main(["import", str(source), "-q"]) == 2
    assert "unrecognized" in capsys.readouterr().err
    assert main(["import", str(source)]) == 0
    assert capsys.readouterr().out == text


def test_a_car_that_reaches_less_goes_a_quarter_of_the_way(tmp_path: Path) -> None:
    small = {name: (0.14 * x, 0.14 * y, 0.14 * z) for name, (x, y, z) in WISHBONE.mechanism.points.items()}
    found = imported(tmp_path, lotus_report(small), unit="mm")
    law = found.scene.inputs["wheel_travel"].polynomial
    nearer = min(abs(end.value) for end in standing(found.scene).reach["wheel_travel"])
    assert law is not None
    assert nearer < 40.0
    assert law[1] == -2.0 * law[0]
    assert 0.24 * nearer < -law[0] <= 0.25 * nearer


@pytest.mark.parametrize(("camber", "toe"), [("", ""), ("-1.5", "0.25")])
def test_a_strut_of_chrono_has_its_axis_and_the_angles_that_it_says(
    camber: str, toe: str, tmp_path: Path
) -> None:
    points = STRUT.mechanism.points
    found = imported(tmp_path, chrono("macpherson", points, -1, camber, toe))
    part = found.scene.mechanism
    assert (part.type, part.side) == ("macpherson", "left")
    derived = {"strut_rod_end", "wheel_axis_inner"}
    assert {point.name for point in found.drawing.points if point.source.startswith("from ")} == derived
    for name in {*points} - derived - {"rack_centre"}:
        assert part.points[name] == points[name], name
    # Anywhere on the strut's line will do, and halfway is far from both ends.
    both = np.add(part.points["strut_top"], part.points["strut_lower"])
    assert np.array_equal(2.0 * np.array(part.points["strut_rod_end"]), both)
    # The spindle's y axis after Chrono's turns, by matrices: about x by -camber, then about z by -toe.
    c, t = radians(float(camber or 0)), radians(float(toe or 0))
    about_x = np.array([[1, 0, 0], [0, cos(c), sin(c)], [0, -sin(c), cos(c)]])
    about_z = np.array([[cos(t), sin(t), 0], [-sin(t), cos(t), 0], [0, 0, 1]])
    forward, left, up = about_z @ about_x @ np.array([0.0, 1.0, 0.0])
    axis = np.subtract(part.points["wheel_centre"], part.points["wheel_axis_inner"])
    np.testing.assert_allclose(axis / 100.0, [-forward, -left, up], rtol=0, atol=1e-13)
    assert degrees(found.stands.angles["toe"]) == pytest.approx(float(toe or 0), abs=1e-11)
    # Projected, as ours is: tan(camber) over cos(toe).
    assert np.tan(found.stands.angles["camber"]) == pytest.approx(np.tan(c) / cos(t), abs=1e-13)


def test_static_angles_make_the_spin_axis_that_a_file_lacks(tmp_path: Path) -> None:
    found = imported(tmp_path, NO_SPINDLE, camber=-2.0, toe=0.5)
    assert degrees(found.stands.angles["camber"]) == pytest.approx(-2.0, abs=1e-11)
    assert degrees(found.stands.angles["toe"]) == pytest.approx(0.5, abs=1e-11)


# Planted faults: what would make another car is refused, and the line names what it should be.


def test_a_tie_rod_through_the_middle_of_the_car_is_warned_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    x, y, z = CAR["tie_rod_inner"]
    (tmp_path / "car.csv").write_text(table({**CAR, "tie_rod_inner": (x, -y, z)}))
    assert main(["import", str(tmp_path / "car.csv")]) == 0
    assert f"tie_rod_inner lies {y:.4g} mm beyond the middle of the car" in capsys.readouterr().err


LEFT_STRUT = chrono("macpherson", STRUT.mechanism.points, -1)
ASIDE = {name: (x, y - 700.0, z) for name, (x, y, z) in CAR.items()} | {"wheel_centre": (0.0, -5.0, 210.0)}


@pytest.mark.parametrize(
    ("text", "choices", "side", "warning"),
    [
        # Exchanged columns of right-handed axes are left-handed.
        (table(order=(1, 0, 2)), {"axes": "left,forward,up"}, "right", ""),
        (table(per_unit="1000"), {"unit": "m"}, "right", ""),
        (table(per_unit="1000"), {"unit": "in"}, "right", "13.7 mm long"),
        (table(names=EXCHANGED), {"axes": "forward,left,up"}, "right", "lower_arm_front"),
        (table(), {"side": "right", "mirror": True}, "left", ""),
        (LEFT_STRUT, {"side": "left", "mirror": True}, "right", ""),
        (table(ASIDE), {"side": "right"}, "right", ""),
    ],
)
def test_what_the_points_speak_against_is_taken_where_the_user_says_it_and_warned_of(
    text: str, choices: Mapping[str, Any], side: str, warning: str, tmp_path: Path
) -> None:
    found = imported(tmp_path, text, **choices)
    told = " ".join(warnings_of(found.scene, found.stands.closing))
    assert found.scene.mechanism.side == side
    assert warning in told, told
    assert any("left-handed" in fact for fact in found.drawing.facts) == (
        "left,forward" in choices.get("axes", "")
    )


def test_a_report_of_both_axles_gives_the_one_that_is_asked_for(tmp_path: Path) -> None:
    rear = {name: (x + 9.0, y, z + 1.0) for name, (x, y, z) in CAR.items()}
    rear["wheel_axis_inner"] = (10.0, 658.0, 211.0)
    text = lotus_report() + lotus_report(rear, {"CAMBER ANGLE": 0.0, "TOE ANGLE (SAE)": 0.95}).replace(
        "FRONT SUSPENSION", "REAR SUSPENSION"
    )
    with pytest.raises(FileError, match="--part front or --part rear"):
        imported(tmp_path, text)
    assert drawn(imported(tmp_path, text, part="front")) == CAR
    found = imported(tmp_path, text, part="rear")
    assert drawn(found) == rear
    # The inner point lies 1 mm behind the centre, 60 mm further in: 0.955 deg of toe in.
    assert [(check.printed, check.verdict) for check in found.angles] == [(0.0, "agrees"), (0.95, "agrees")]


def test_points_that_are_not_those_of_the_printed_angles_end_with_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / "report.txt", tmp_path / "scene.toml"
    x, y, z = CAR["upper_ball_joint"]
    # A mm across a kingpin of 221 mm is 0.26 deg; the printed digits leave 0.005 + 0.019 deg open.
    source.write_text(lotus_report({**POINTS, "upper_ball_joint": (x, y - 1.0, z)}))
    assert main(["import", str(source), "-o", str(target)]) == 1
    out, err = capsys.readouterr()
    assert "kingpin: the file prints 7 deg, its points give 7.2" in out
    assert "disagrees" in out
    assert "KINGPIN ANGLE is printed as 7 deg" in err
    assert target.exists()


# What is not known is asked for.


def test_points_that_the_file_lacks_are_asked_for_beside_those_that_are_not_known(tmp_path: Path) -> None:
    text = table().replace("CHAS_TiePnt", "Rack End").replace("Wheel Center", "Hub")
    with pytest.raises(FileError) as caught:
        imported(tmp_path, text)
    parts = ("lacks wheel_centre", "tie_rod_inner", "'CHAS_TiePnt'", "'Rack End' on line", "'Hub' on line")
    assert [part for part in parts if part not in str(caught.value)] == []
    names = tmp_path / "names.toml"
    # What is given goes before what the file has by a name that is known.
    given = "wheel_centre = [0, -718.0, 210]\nlower_arm_rear = [-90, -257, 78]\n"
    names.write_text(f'[names]\ntie_rod_inner = "rack end"\n{given}')
    found = imported(tmp_path, text, names=str(names))
    assert drawn(found) == CAR
    assert [point.name for point in found.drawing.others] == ["CHAS_LowAft", "Hub", "NSMA_PPAttPnt"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[names]\ntie_rod = 'x'", "did you mean 'tie_rod_"),
        ("[names]\ntie_rod_inner = 'Nothing'", "no point in .* named 'Nothing'"),
        ("[names]\n\ntie_rod_inner = ?", "line 3"),
    ],
)
def test_a_wrong_file_of_names_is_told_in_a_line(text: str, words: str, tmp_path: Path) -> None:
    names = tmp_path / "names.toml"
    names.write_text(text)
    with pytest.raises((FileError, PointcoordError), match=words):
        imported(tmp_path, table(), names=str(names))


NO_SPINDLE = "\n".join(line for line in lotus_report().splitlines() if "spindle" not in line)


@pytest.mark.parametrize(
    ("text", "choices", "words"),
    [
        (table(order=(1, 0, 2)), {}, "lower_arm_front lies along [+]y from lower_arm_rear"),
        (table(names=EXCHANGED), {}, "lower_arm_front lies along -x from lower_arm_rear"),
        (table(per_unit="1000"), {}, r"spans 0\.54 mm .*--unit m makes 540 mm"),
        (table(titles="Point,X (mm),Y (mm),Z (mm)\n"), {"unit": "m"}, "states that its lengths are in mm"),
        (LEFT_STRUT, {"side": "right"}, "--side left --mirror makes the right wheel"),
        # A file that has the wheel is not told to mirror the other one.
        (
            table(ending=" FR"),
            {"side": "right", "axes": "forward,right,up"},
            "by --side, but [^;]*; allowed:(?!.*--mirror)",
        ),
        (table(), {"side": "left"}, "a left wheel by --side, but wheel_centre lies"),
        (table(ending=" FL"), {}, "a left wheel by the file"),
        (chrono("double_wishbone", MIRRORED, 1), {}, "a left wheel by the file"),
        (table(ASIDE), {}, "--side right if y is not counted from the middle"),
        (lotus_report(), {"part": "rear"}, "has no points of axle rear"),
        (NO_SPINDLE, {}, "lacks wheel_axis_inner.* for the spin axis.*--camber and --toe"),
        (NO_SPINDLE, {"toe": 1.0}, "is given --camber None and --toe 1.0"),
        (
            table(),
            {"camber": 1.0, "toe": 0.0},
            "direction of its spin axis by wheel_axis_inner; .*neither --camber",
        ),
        (lotus_report().replace("257.00     69.00", "257.00", 1), {}, "line 9: has 2 numbers"),
        (
            lotus_report().replace("    69.00", "    6q.00", 1),
            {},
            "line 9: z of 'Lower wishbone front pivot' is '6q.00'",
        ),
        (lotus_report().replace("Double Wishbone", "Trailing arm"), {}, "called 'Trailing arm, damper"),
        (
            table().replace("CHAS_LowAft,-90.0", "CHAS_LowAft,nan"),
            {},
            "lacks lower_arm_rear .*without three numbers: 'CHAS_LowAft' on line 3",
        ),
        (table().replace("CHAS_LowAft,", ","), {}, "line 3: has coordinates without a name"),
        (table() + "CHAS_LowAft,1,2,3\n", {}, "line 13: has lower_arm_rear twice, 'CHAS_LowAft' on line 3"),
        (table(titles="Point,X,Y\n"), {}, "line 1: has no columns of z"),
        (table(titles="Point,X (m),Y (mm),Z (m)\n"), {}, "line 1: has units .'m', 'mm'."),
        ("A,1,2,3,4,5,6", {}, "has 6 numbers for 'A'"),
        ("Point,X,Y,Z\nA,1,5,2,5,3,5", {}, "line 2: has 7 cells under 4 titles; allowed: a title for each"),
        (
            table(titles="Punkt,Hoch,Quer,Laengs\n"),
            {},
            "line 1: has unknown titles: 'Punkt, Hoch, Quer, Laengs'",
        ),
        ("Point Hoch Quer Laengs\nA 1 2 3", {}, "line 1: has unknown titles: 'Point Hoch Quer Laengs'"),
        ("Point,X,Y,Z,X,Y,Z\nA,1,2,3,4,5,6", {}, "line 1: has 2 columns of x"),
        ("-3.5,529,122.84\n-45,190,129.9", {}, "line 1: has coordinates without a name"),
        ("Point;X;Y;Z\nLBJ;1.5;2;3\nUBJ;1,500;2;3", {}, "line 3: has numbers with points and with commas"),
        ("", {}, "has no points"),
        ("PK\x03\x04\x00\x00", {}, "is not text"),
        (LEFT_CHRONO.replace("]", ",", 1), {}, "is not JSON"),
        (
            LEFT_CHRONO.replace("{", "{ // Type\n/* a\n\nb */", 1).replace("0.718", "x"),
            {},
            "line 12: is not JSON",
        ),
        (
            LEFT_CHRONO.replace('"Tierod"', '"Rod"'),
            {},
            "lacks tie_rod_outer .*not recognised: .*'Rod: Location",
        ),
    ],
)
def test_a_file_that_makes_no_car_or_another_is_told_in_one_line_with_what_would_help(
    text: str,
    choices: Mapping[str, Any],
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(FileError, match=words):
        imported(tmp_path, text, **choices)
    options = [f"--{name}={value}" for name, value in choices.items()]
    assert main(["import", str(tmp_path / "car.txt"), "-o", str(tmp_path / "car.toml"), *options]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert not (tmp_path / "car.toml").exists()


def test_axes_are_three_directions_at_right_angles() -> None:
    assert Axes.of("Forward, left up").words == "x forward, y left, z up"
    for words in ("forward,left", "forward,left,down,up", "forward,rearward,up", "north,left,up", ""):
        with pytest.raises(UsageError, match="axes are "):
            Axes.of(words)


@pytest.mark.parametrize("name", formats())
def test_a_format_s_table_speaks_of_points_that_there_are(name: str) -> None:
    one = formats()[name]
    assert one.form in (*READERS, TABLE, MJCF)
    assert {*one.called.values(), *one.notes} <= one.suspensions.keys()
    points = {kind: {*mechanism_file(kind).points} for kind in one.suspensions}
    assert {*one.names} <= set().union(*points.values())
    for kind, names in one.suspensions.items():
        assert {*names} <= points[kind]
        theirs = [name for some in one.names_of(kind).values() for name in some]
        assert len(theirs) == len({*theirs})
