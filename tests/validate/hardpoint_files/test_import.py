"""Hardpoints of other programs become the car that they are, or a line that says why not."""

import shlex
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_lines import cases
from foreign_files import CAR, FOUR_BAR, WELDED, WISHBONE, chrono, drawn, imported, lotus_report, table
from program import complaints

from pointcoord import Scene, standing
from pointcoord.mechanism import mechanism_file
from validate.cli import main
from validate.closed_drawing import warnings_of
from validate.hardpoint_files.contents import Axes
from validate.hardpoint_files.format import MJCF, READERS, TABLE, formats
from validate.hardpoint_files.importing import import_hardpoints
from validate.tables.errors import FileError

GIVEN = Path(__file__).parents[2] / "oracle" / "given" / "import"
POINTS = WISHBONE.mechanism.points
MIRRORED = {name: (x, -y, z) for name, (x, y, z) in CAR.items()}
ASIDE = {name: (x, y - 700.0, z) for name, (x, y, z) in CAR.items()} | {"wheel_centre": (0.0, -5.0, 210.0)}
# Our own words in another's spelling are not our own names, which have our axes.
TITLED = [f"{name.replace('_', ' ').title()},{x},{y},{z}" for name, (x, y, z) in CAR.items()]
FILES = {
    "titled.csv": "\n".join(["Point,X,Y,Z", *TITLED]),
    "aside.csv": table(ASIDE),
    "mirrored.json": chrono("double_wishbone", MIRRORED, 1),
    "four-bar.xml": FOUR_BAR,
    "welded.xml": WELDED,
}
# Another car for each wheel, so that a wheel that is taken for another shows; x rearward, y right, z up.
WHEELS = {
    wheel: {name: (x + back, out * y + off, z) for name, (x, y, z) in CAR.items()}
    for wheel, back, out, off in (
        ("front right", 0.0, 1.0, 0.0),
        ("front left", 0.0, -1.0, -1.0),
        ("rear right", 1500.0, 1.0, 2.0),
        ("rear left", 1500.0, -1.0, -3.0),
    )
}


def changed(text: str, changes: Iterable[str]) -> str:
    """A file's text after changes."""
    for one in changes:
        change = one.encode().decode("unicode_escape")
        old, arrow, new = change.partition(" ->")
        assert not arrow or old in text, change
        text = text.replace(old, new.removeprefix(" ")) if arrow else change
    return text


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with files of other programs."""
    shutil.copytree(GIVEN, tmp_path, dirs_exist_ok=True)
    for more in (GIVEN / "chrono-vehicle", Path(__file__).with_name("tables")):
        shutil.copytree(more, tmp_path, dirs_exist_ok=True)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_file_that_makes_no_car_or_another_is_refused_in_one_line_with_what_would_help(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for line, parts in cases(__file__, "refused.txt"):
        words, *changes = line.split(" ; ")
        name, *options = shlex.split(words.replace("\\n", "\n"))
        path, names = Path(name), folder / "names.toml"
        before = path.read_text(encoding="utf-8")
        path.write_text(changed(before, changes), encoding="utf-8")
        if "--names" in options:
            at = options.index("--names") + 1
            names.write_text(options[at])
            options[at] = str(names)
        assert main(["import", name, *options, "-o", "scene.toml"]) == 2, line
        (said,) = complaints(capsys.readouterr().err)
        for part in parts:
            wanted = part.removeprefix("not: ")
            assert (wanted in said) == (wanted == part), (part, said)
        assert any(where in said for where in (path.name, "names.toml", "--", "axes are")), said
        assert not (folder / "scene.toml").exists()
        path.write_text(before, encoding="utf-8")


def test_a_table_is_the_car_however_it_is_written(folder: Path) -> None:
    for words, (wheel, others, fact) in cases(__file__, "taken.txt"):
        name, *options = words.split()
        choices: dict[str, Any] = dict(zip((o.strip("-") for o in options[::2]), options[1::2], strict=True))
        angles = {angle: float(choices[angle]) for angle in ("camber", "toe") if angle in choices}
        found = import_hardpoints(name, **choices | angles)
        # Where the angles are given the spin axis is made of them.
        its = drawn(found) | ({"wheel_axis_inner": WHEELS[wheel]["wheel_axis_inner"]} if angles else {})
        assert (its, found.scene.mechanism.side) == (WHEELS[wheel], wheel.split()[1]), words
        if others != "*":
            names = [source.partition(", line")[0] for source in found.drawing.others]
            assert " & ".join(names) == others, words
        assert any(fact in said for said in found.drawing.facts), words


def test_a_rocker_of_optimumk_makes_a_car_with_a_pushrod_and_the_same_damper(folder: Path) -> None:
    car = {n: p for n, p in Scene.load("pushrod").mechanism.points.items() if n != "rack_centre"}
    found = import_hardpoints("optimumk-rocker.csv")
    assert found.scene.mechanism.type == "double_wishbone_pushrod"
    assert found.scene.mechanism.side == "left"
    assert drawn(found) == {name: (x, -y, z) for name, (x, y, z) in car.items()}
    assert not found.drawing.others
    assert any("pushrod_outer is taken as a point of the lower arm" in fact for fact in found.drawing.facts)


def test_a_file_of_names_that_is_not_there_is_written_to_be_filled_in(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = folder / "names.toml"
    words = ["import", "unknown-titles.csv", "--names", "names.toml", "--axes", "rearward,right,up"]
    words += ["-o", "car.toml"]
    assert main(words) == 2
    assert "names.toml did not exist, so a form is written" in capsys.readouterr().err
    filled = names.read_text().replace("# [table]", "[table]").replace('# name = "Point"', "name = 1")
    for axis, title in (("x", "Hoch"), ("y", "Quer"), ("z", "Laengs")):
        filled = filled.replace(f'# {axis} = "{axis.upper()}"', f'{axis} = "{title}"')
    names.write_text(filled)
    assert main(words) == 2  # one name is not known yet
    assert "lacks lower_ball_joint" in capsys.readouterr().err
    line = '# lower_ball_joint = "its name", or'
    names.write_text(names.read_text().replace(line, 'lower_ball_joint = "Traggelenk" #'))
    assert main(words) == 0
    assert Scene.load("car.toml").mechanism.points.items() >= CAR.items()


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
    # A mm across a kingpin of 221 mm is 0.26 deg; the printed digits leave 0.005 + 0.019 deg open.
    x, y, z = CAR["upper_ball_joint"]
    source.write_text(lotus_report({**POINTS, "upper_ball_joint": (x, y - 1.0, z)}))
    assert main(["import", str(source), "-o", str(target)]) == 1
    out, err = capsys.readouterr()
    assert "kingpin: the file prints 7 deg, its points give 7.2" in out
    assert "disagrees" in out
    assert "KINGPIN ANGLE is printed as 7 deg" in err
    assert Scene.load(target).mechanism.points["upper_ball_joint"] == (x, y - 1.0, z)


def test_a_car_that_reaches_less_goes_a_quarter_of_the_way(tmp_path: Path) -> None:
    small = {name: (0.14 * x, 0.14 * y, 0.14 * z) for name, (x, y, z) in POINTS.items()}
    found = imported(tmp_path, lotus_report(small), unit="mm")
    law = found.scene.inputs["wheel_travel"].polynomial
    nearer = min(abs(end.value) for end in standing(found.scene).reach["wheel_travel"])
    assert law is not None
    assert nearer < 40.0
    assert law[1] == -2.0 * law[0]
    assert 0.24 * nearer < -law[0] <= 0.25 * nearer


@pytest.mark.parametrize(
    ("file", "choices", "warning"),
    [
        # Exchanged columns of right-handed axes are left-handed.
        ("table-left-forward-up.csv", {"axes": "left,forward,up"}, "left-handed"),
        ("table-without-unit.csv", {"unit": "in"}, "13.7 mm long"),
        ("table-front-and-rear-exchanged.csv", {"axes": "forward,left,up"}, "lower_arm_front"),
        ("chrono-strut.json", {"side": "left", "mirror": True}, ""),
        ("aside.csv", {"side": "right"}, ""),
        ("table-tie-rod-across.csv", {}, "tie_rod_inner lies 178 mm beyond the middle of the car"),
    ],
)
def test_what_the_points_speak_against_is_taken_where_the_user_says_it_and_warned_of(
    file: str, choices: Mapping[str, Any], warning: str, folder: Path
) -> None:
    found = import_hardpoints(file, **choices)
    told = " ".join([*warnings_of(found.scene, found.stands.closing), *found.drawing.facts])
    assert found.scene.mechanism.side == "right"
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


def test_points_that_are_not_known_are_taken_as_a_file_of_names_says(tmp_path: Path) -> None:
    text, names = table().replace("CHAS_TiePnt", "Rack End").replace("Wheel Center", "Hub"), "names.toml"
    # What is given goes before what the file has by a name that is known.
    given = "wheel_centre = [0, -718.0, 210]\nlower_arm_rear = [-90, -257, 78]\n"
    (tmp_path / names).write_text(f'[names]\ntie_rod_inner = "rack end"\n{given}')
    found = imported(tmp_path, text, names=str(tmp_path / names))
    assert drawn(found) == CAR
    assert [*found.drawing.others] == ["CHAS_LowAft, line 3", "Hub, line 10", "NSMA_PPAttPnt, line 12"]


def test_a_vehicle_of_chrono_is_the_car_that_its_files_make_together(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Axles are front and rear by where they are, and have numbers if there are more than two."""
    file, spring = folder / "own/vehicle/car.json", folder / "own/suspension/front.json"
    spring.write_text(spring.read_text().replace("DoubleWishbone", "DoubleWishboneReduced"))
    assert import_hardpoints(file, part="front").scene.mechanism.type == "double_wishbone"
    assert main(["import", str(file), "--part", "rear", "-o", "car.toml"]) == 0
    told = capsys.readouterr().out
    assert "Tierod: Location Chassis, of rear.json" in told
    assert "a straight rack across the car" in told
    assert main(["validate", "car.toml", "-q"]) == 0
    text = file.read_text()
    file.write_text(text.replace("1.5,", "-1.5,"))  # listed first, and behind the other
    assert import_hardpoints(file, part="front").scene.mechanism.type == "macpherson"
    behind = '{"Suspension Input File": "own/suspension/rear.json", "Suspension Location": [-2.5, 0, 0.125]},'
    file.write_text(text.replace('"Axles": [', f'"Axles": [{behind}'))
    with pytest.raises(FileError, match="--part 1 or --part 2 or --part 3"):
        import_hardpoints(file)
    first, last = (drawn(import_hardpoints(file, part=part))["wheel_centre"] for part in "13")
    np.testing.assert_allclose(np.subtract(first, last), [1250, 0, 0], atol=1e-12)


def test_axes_are_named_in_any_letters() -> None:
    assert Axes.of("Forward, left up").words == "x forward, y left, z up"


@pytest.mark.parametrize("name", formats())
def test_a_format_s_table_speaks_of_points_that_there_are(name: str) -> None:
    one = formats()[name]
    assert one.name in (*READERS, TABLE, MJCF)
    kinds = {*one.called.values(), *one.suspensions}
    assert {*one.notes} <= {"", *kinds}
    points = {kind: {*mechanism_file(kind).points} for kind in kinds}
    assert {*one.names} <= set().union(*points.values())
    for kind in kinds:
        theirs = [name for some in one.names_of(kind).values() for name in some]
        assert len(theirs) == len({*theirs})
