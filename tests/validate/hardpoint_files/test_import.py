"""Hardpoints of other programs become the car that they are, or a line that says why not."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

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
SIDE_RIGHT = {"side": "right", "axes": "forward,right,up"}


def test_the_scene_that_is_written_is_the_one_that_is_returned_and_validates(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / "report.txt", tmp_path / "scene.toml"
    source.write_text(lotus_report())
    assert main(["import", str(source), "-o", str(target)]) == 0
    out, err = capsys.readouterr()
    assert "caster: the file prints 4.94 deg, its points give 4.9360: agrees" in out
    told = "points not recognised: Part 1 C of G, line 19, Bracket of our own, line 20"
    assert err.splitlines() == [f"pointcoord: note: {source}: {told}"]
    found = import_hardpoints(source)
    assert (Scene.load(target), drawn(found)) == (found.scene, CAR)
    text = target.read_text()
    assert "lower_arm_front  = [-110, 257, 69]     # Lower wishbone front pivot, line 9" in text
    assert "# not used: Bracket of our own, line 20" in text
    assert main(["validate", str(target), "-q"]) == 0
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


NO_SPINDLE = "\n".join(line for line in lotus_report().splitlines() if "spindle" not in line)
LEFT_STRUT = chrono("macpherson", STRUT.mechanism.points, -1)


ASIDE = {name: (x, y - 700.0, z) for name, (x, y, z) in CAR.items()} | {"wheel_centre": (0.0, -5.0, 210.0)}
ACROSS = {**CAR, "tie_rod_inner": (-10.0, -178.0, 154.0)}


@pytest.mark.parametrize(
    ("text", "choices", "side", "warning"),
    [
        # Exchanged columns of right-handed axes are left-handed.
        (table(order=(1, 0, 2)), {"axes": "left,forward,up"}, "right", "left-handed"),
        (table(per_unit="1000"), {"unit": "in"}, "right", "13.7 mm long"),
        (table(names=EXCHANGED), {"axes": "forward,left,up"}, "right", "lower_arm_front"),
        (LEFT_STRUT, {"side": "left", "mirror": True}, "right", ""),
        (table(ASIDE), {"side": "right"}, "right", ""),
        (table(ACROSS), {}, "right", "tie_rod_inner lies 178 mm beyond the middle of the car"),
    ],
)
def test_what_the_points_speak_against_is_taken_where_the_user_says_it_and_warned_of(
    text: str, choices: Mapping[str, Any], side: str, warning: str, tmp_path: Path
) -> None:
    found = imported(tmp_path, text, **choices)
    told = " ".join([*warnings_of(found.scene, found.stands.closing), *found.drawing.facts])
    assert found.scene.mechanism.side == side
    assert warning in told, told


def test_a_report_of_both_axles_gives_the_one_that_is_asked_for(tmp_path: Path) -> None:
    rear = {name: (x + 9.0, y, z + 1.0) for name, (x, y, z) in CAR.items()}
    rear["wheel_axis_inner"] = (10.0, 658.0, 211.0)
    behind = lotus_report(rear, {"CAMBER ANGLE": 0.0, "TOE ANGLE (SAE)": 0.95})
    text = lotus_report() + behind.replace("FRONT SUSPENSION", "REAR SUSPENSION")
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


ROWS = [f"{name.replace('_', ' ').title()},{x},{y},{z}" for name, (x, y, z) in CAR.items()]


@pytest.mark.parametrize(
    ("text", "choices", "words"),
    [
        (table(order=(1, 0, 2)), {}, "lower_arm_front lies along [+]y from lower_arm_rear"),
        (table(names=EXCHANGED), {}, "lower_arm_front lies along -x from lower_arm_rear"),
        # Our own words in another's spelling are not our own names, which have our axes.
        ("\n".join(["Point,X,Y,Z", *ROWS]), {}, "does not give the directions of x, y and z.* lies along"),
        (table(per_unit="1000"), {}, r"spans 0\.54 mm .*--unit m makes 540 mm"),
        (table(titles="Point,X (mm),Y (mm),Z (mm)\n"), {"unit": "m"}, "states that its lengths are in mm"),
        (LEFT_STRUT, {"side": "right"}, "--side left --mirror makes the right wheel"),
        # A file that has the wheel is not told to mirror the other one.
        (table(ending=" FR"), SIDE_RIGHT, "by --side, but [^;]*; allowed:(?!.*--mirror)"),
        (table(), {"side": "left"}, "a left wheel by --side, but wheel_centre lies"),
        (table(ending=" FL"), {}, "a left wheel by the file"),
        (chrono("double_wishbone", MIRRORED, 1), {}, "a left wheel by the file"),
        (table(ASIDE), {}, "--side right if y is not counted from the middle"),
        (lotus_report(), {"part": "rear"}, "has no points of axle rear"),
        (NO_SPINDLE, {}, "lacks wheel_axis_inner.* for the spin axis.*--camber and --toe"),
        (NO_SPINDLE, {"toe": 1.0}, "is given --camber None and --toe 1.0"),
        (table(), {"camber": 1.0, "toe": 0.0}, "its spin axis by wheel_axis_inner; .*neither --camber"),
        (lotus_report().replace("257.00     69.00", "257.00", 1), {}, "line 9: has 2 numbers"),
        (lotus_report().replace("    69.00", "    6q.00", 1), {}, "line 9: z of 'Lower w.*' is '6q.00'"),
        (lotus_report().replace("Double Wishbone", "Trailing arm"), {}, "called 'Trailing arm, damper"),
        (table().replace("LowAft,-90.0", "LowAft,nan"), {}, "lacks lower_arm_rear .*'CHAS_LowAft' on line 3"),
        (table().replace("CHAS_LowAft,", ","), {}, "line 3: has coordinates without a name"),
        (table() + "CHAS_LowAft,1,2,3\n", {}, "line 13: has lower_arm_rear twice, 'CHAS_LowAft' on line 3"),
        (table(titles="Point,X,Y\n"), {}, "line 1: has no columns of z"),
        (table(titles="Point,X (m),Y (mm),Z (m)\n"), {}, "line 1: has units .'m', 'mm'."),
        ("A,1,2,3,4,5,6", {}, "has 6 numbers for 'A'"),
        ("Point,X,Y,Z\nA,1,5,2,5,3,5", {}, "line 2: has 7 cells under 4 titles; allowed: a title for each"),
        (table(titles="Punkt,Hoch,Quer,Laengs\n"), {}, "line 1: has unknown titles: 'Punkt, Hoch, Quer, "),
        ("Point Hoch Quer Laengs\nA 1 2 3", {}, "line 1: has unknown titles: 'Point Hoch Quer Laengs'"),
        ("Point,X,Y,Z,X,Y,Z\nA,1,2,3,4,5,6", {}, "line 1: has 2 columns of x"),
        ("-3.5,529,122.84\n-45,190,129.9", {}, "line 1: has coordinates without a name"),
        ("Point;X;Y;Z\nLBJ;1.5;2;3\nUBJ;1,500;2;3", {}, "line 3: has numbers with points and with commas"),
        ("", {}, "has no points"),
        ("PK\x03\x04\x00\x00", {}, "is not text"),
        (LEFT_CHRONO.replace("]", ",", 1), {}, "is not JSON"),
        (LEFT_CHRONO.replace("{", "{ // A\n/* b\n\n*/", 1).replace("0.718", "x"), {}, "line 12: is not JSON"),
        (LEFT_CHRONO.replace('"Tierod"', '"Rod"'), {}, "lacks tie_rod_outer .*not recognised: .*'Rod: Loc"),
        (LEFT_CHRONO.replace("DoubleWishbone", "MyDoubleWishbone"), {}, "called 'MyDoubleWishbone'"),
        (table(), {"names": "[names]\ntie_rod = 'x'"}, "did you mean 'tie_rod_"),
        (table(), {"names": "[names]\ntie_rod_inner = 'No'"}, "no point in .* named 'No'"),
        (table(), {"names": "[names]\n\ntie_rod_inner = ?"}, "line 3"),
        (table(), {"names": '[table]\nname = "Point"\nx = "X"\ny = "Y"'}, r"\[table\] is"),
    ],
)
def test_a_file_that_makes_no_car_or_another_is_refused_with_what_would_help(
    text: str, choices: Mapping[str, Any], words: str, tmp_path: Path
) -> None:
    """That the program says it in one line is in tests/test_fuzz.py."""
    if "names" in choices:
        names = tmp_path / "names.toml"
        names.write_text(choices["names"])
        choices = {"names": str(names)}
    with pytest.raises((FileError, PointcoordError), match=words):
        imported(tmp_path, text, **choices)


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
