"""Tables of points as programs write them: each becomes the car that it says, or a line that asks."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest
from foreign_files import CAR, LOTUS, OPTIMUMK, drawn, imported, table

from pointcoord import Scene
from validate.cli import main
from validate.tables.errors import FileError

WORDS = LOTUS | {
    "upper_ball_joint": "UPPER WISHBONE, outer ball-joint",
    "tie_rod_inner": "Inner_track_rod_ball_joint",
    "wheel_centre": "Wheel Center",
    "wheel_axis_inner": "Wheel Spindle Point",
}
OURS = "rearward,right,up"
# Another car for each wheel, so that a wheel that is taken for another shows; x rearward, y right, z up.
WHEELS = {
    (part, side): {name: (x + back, out * y + off, z) for name, (x, y, z) in CAR.items()}
    for part, side, back, out, off in (
        ("front", "right", 0.0, 1.0, 0.0),
        ("front", "left", 0.0, -1.0, -1.0),
        ("rear", "right", 1500.0, 1.0, 2.0),
        ("rear", "left", 1500.0, -1.0, -3.0),
    )
}
POINT = "Point,X,Y,Z"


def cells(place: Sequence[float]) -> str:
    return ",".join(map(repr, place))


def rows(name: str = "{}", points: Mapping[str, Sequence[float]] = CAR) -> list[str]:
    return [f'"{name.format(WORDS[ours])}",{cells(place)}' for ours, place in points.items()]


def test_a_sheet_of_optimumk_gives_the_wheel_whose_columns_are_named(tmp_path: Path) -> None:
    """Titles that stand twice are not guessed at; its names have its axes, and static angles are told."""
    lines = ["Double A-Arm,Point Name,Left,,,,Right,,", ",,X,Y,Z,,X,Y,Z"]
    for ours, theirs in OPTIMUMK.items():
        if "wheel" not in ours:
            (x, y, z), (u, v, w) = CAR[ours], WHEELS["front", "left"][ours]
            lines.append(f",{theirs},{-u!r},{-v!r},{w!r},,{-x!r},{-y!r},{z!r}")
    text = "\n".join([*lines, ",Static Camber,-0.96,,,,-0.96,,", ",Static Toe,0.5,,,,0.25,,"])
    with pytest.raises(FileError, match=r"line 1: has unknown titles: .*\[table\]"):
        imported(tmp_path, text, side="right")
    names = tmp_path / "names.toml"
    columns = "[table]\nname = 2\nx = 7\ny = 8\nz = 9\n"
    names.write_text(columns)
    with pytest.raises(FileError, match=r"lacks wheel_centre.* 'Static Toe' on line .*\+ toe in"):
        imported(tmp_path, text, side="right", names=str(names))
    given = {name: [-x, -y, z] for name, (x, y, z) in CAR.items() if "wheel" in name}
    names.write_text(
        "\n".join([columns, "[names]", *(f"{name} = {place!r}" for name, place in given.items())])
    )
    found = imported(tmp_path, text, side="right", names=str(names))
    assert (drawn(found), found.scene.mechanism.side) == (CAR, "right")


ROCKER = {
    "pushrod_outer": "NSMA_PPAttPnt_L",
    "pushrod_inner": "ROCK_RodPnt_L",
    "rocker_front": "CHAS_RocAxi_L",
    "rocker_rear": "CHAS_RocPiv_L",
    "damper_rocker": "ROCK_CoiPnt_L",
    "damper_top": "CHAS_AttPnt_L",
}


def test_a_rocker_of_optimumk_makes_a_car_with_a_pushrod_and_the_same_damper(tmp_path: Path) -> None:
    car = {n: p for n, p in Scene.load("pushrod").mechanism.points.items() if n != "rack_centre"}
    lines = (f"{(OPTIMUMK | ROCKER)[n]},{-x!r},{y!r},{z!r}" for n, (x, y, z) in car.items())
    found = imported(tmp_path, "\n".join(["Name,X,Y,Z", *lines]))
    assert found.scene.mechanism.type == "double_wishbone_pushrod"
    assert found.scene.mechanism.side == "left"
    assert drawn(found) == {name: (x, -y, z) for name, (x, y, z) in car.items()}
    assert not found.drawing.others
    assert any("pushrod_outer is taken as a point of the lower arm" in fact for fact in found.drawing.facts)


def corners(title: str) -> str:
    """The four wheels, with a column that says which."""
    lines = (f"{p[0]}{s[0]},{row}" for (p, s), car in WHEELS.items() for row in rows(points=car))
    return "\n".join([f"{title},Point,X (mm),Y (mm),Z (mm)", *lines])


def headings(first: str, second: str) -> str:
    """The wheels of two axles, each axle under its heading, the first one over the titles."""
    lines = []
    for part, head in (("front", [first, POINT]), ("rear", [second])):
        lines += head
        for side in ("left", "right"):
            lines += rows(f"{{}}_{side[0]}", WHEELS[part, side])
    return "\n".join(lines)


SHAPES: dict[str, str] = {
    "headings of axles": headings("FRONT SUSPENSION", "REAR SUSPENSION"),
    "headings of axles in a row of cells": headings("Front,,,", "Rear,,,"),
    "a column of corners": corners("Corner"),
    "names that begin with a corner": "\n".join(
        [POINT, *(row for (p, s), car in WHEELS.items() for row in rows(f"{p[0]}{s[0]}_{{}}", car))]
    ),
}


@pytest.mark.parametrize("text", SHAPES.values(), ids=SHAPES)
def test_each_wheel_of_a_table_of_four_is_the_one_that_is_asked_for(text: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="--part front or --part rear"):
        imported(tmp_path, text, axes=OURS)
    with pytest.raises(FileError, match="--side left or --side right"):
        imported(tmp_path, text, axes=OURS, part="front")
    for part, side in (("front", "left"), ("rear", "right")):
        found = imported(tmp_path, text, axes=OURS, part=part, side=side)
        assert drawn(found) == WHEELS[part, side]
        assert found.scene.mechanism.side == side
        assert not found.drawing.others


SECTIONS = {
    f"{level.upper()} A-ARM": {
        "Front inboard": f"{level}_arm_front",
        "Rear inboard": f"{level}_arm_rear",
        "Outboard": f"{level}_ball_joint",
    }
    for level in ("lower", "upper")
} | {
    "TIE ROD": {"Inboard": "tie_rod_inner", "Outboard": "tie_rod_outer"},
    "WHEEL": {"Center": "wheel_centre", "Spindle point": "wheel_axis_inner", "Mass": ""},
}


@pytest.mark.parametrize("commas", ["", ",,,"])
def test_a_name_is_put_together_of_the_heading_of_its_section_and_its_own(
    commas: str, tmp_path: Path
) -> None:
    lines = ["Point,X,Y,Z"]
    for heading, its in SECTIONS.items():
        lines.append(heading + commas)
        lines += [f"{name},{cells(CAR.get(ours, (1.0, 2.0, 3.0)))}" for name, ours in its.items()]
    found = imported(tmp_path, "\n".join(lines), axes=OURS)
    assert drawn(found) == CAR
    assert [point.name for point in found.drawing.others] == ["Mass"]
    assert "LOWER A-ARM Front inboard, line 3" in found.text


def test_columns_that_are_not_known_are_those_that_the_user_names(tmp_path: Path) -> None:
    lines = [f'"{WORDS[name]}",{cells(WHEELS["front", "left"][name])},{cells(CAR[name])}' for name in CAR]
    text, names = "\n".join(["Point,x,y,z,hoch,quer,lang", *lines]), tmp_path / "names.toml"
    names.write_text('[table]\nname = "Point"\nx = "Hoch"\ny = "quer"\nz = "lang"\n')
    assert drawn(imported(tmp_path, text, axes=OURS, names=str(names))) == CAR
    names.write_text('[table]\nname = "Point"\nx = 3\ny = 4\nz = 5\ncorner = "Ecke"\n')
    choices = {"axes": OURS, "part": "rear", "side": "left", "names": str(names)}
    found = imported(tmp_path, corners("Ecke") + "\nfr,Battery,1,2,3", **choices)
    assert drawn(found) == WHEELS["rear", "left"]
    assert [point.name for point in found.drawing.others] == ["Battery"]


def test_a_file_of_names_that_is_not_there_is_written_to_be_filled_in(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, names, scene = (tmp_path / name for name in ("car.csv", "names.toml", "car.toml"))
    text = "\n".join(["Punkt,Hoch,Quer,Laengs", *rows()])
    table.write_text(text.replace(WORDS["lower_ball_joint"], "Traggelenk"))
    words = ["import", str(table), "--names", str(names), "--axes", OURS, "-o", str(scene)]
    assert main(words) == 2
    assert "names.toml did not exist, so a form is written" in capsys.readouterr().err
    filled = names.read_text().replace("# [table]", "[table]").replace('# name = "Point"', "name = 1")
    for axis, title in (("x", "Hoch"), ("y", "Quer"), ("z", "Laengs")):
        filled = filled.replace(f'# {axis} = "{axis.upper()}"', f'{axis} = "{title}"')
    names.write_text(filled)
    assert main(words) == 2  # one name is not known yet
    assert "lacks lower_ball_joint" in capsys.readouterr().err
    names.write_text(
        names.read_text().replace('# lower_ball_joint = "its name", or', 'lower_ball_joint = "Traggelenk" #')
    )
    assert main(words) == 0
    assert Scene.load(str(scene)).mechanism.points.items() >= CAR.items()


def test_a_name_with_a_word_more_or_less_is_another_point(tmp_path: Path) -> None:
    others = ("Lower wishbone front", "Lower wishbone front pivot damper", "front", "Wheel")
    text = "\n".join([POINT, *rows(), *(f"{other},1,2,3" for other in others), "Steering rack,1.3,,"])
    found = imported(tmp_path, text, axes=OURS)
    assert drawn(found) == CAR
    assert tuple(point.name for point in found.drawing.others) == others
    assert "lines without a point: 'Steering rack' on line 16" in found.drawing.facts


NUMBERED = (
    f"{z!r},{i},{x!r},{WORDS[n].replace(',', '')},{y!r}" for i, (n, (x, y, z)) in enumerate(CAR.items(), 1)
)


@pytest.mark.parametrize(
    ("text", "choices", "fact"),
    [
        (table(per_unit="1000", titles="Name,X [metres],Y [metres],Z [metres]\n"), {}, "in m, by the file"),
        (table(order=(2, 1, 0), signs=(1, -1, 1)), {"axes": "up,left,rearward"}, "by --axes"),
        ("\n".join(["Z,No.,X,Name,Y", *NUMBERED]), {"axes": OURS}, ""),
        (table(order=(2, 1, 0), titles="Point Z Y X\n", separator=" ").replace("Wheel ", "Wheel_"), {}, ""),
        ("\n".join([f"{POINT},RX", *(f"{row},1.5" for row in rows())]), {"axes": OURS}, ""),
    ],
)
def test_a_table_is_the_car_however_it_is_written(
    text: str, choices: Mapping[str, str], fact: str, tmp_path: Path
) -> None:
    found = imported(tmp_path, text, **choices)
    assert drawn(found) == CAR
    assert found.scene.mechanism.side == "right"
    assert any(fact in said for said in found.drawing.facts)


ADAMS = {
    f"{level}_{ours}": f"{level[0]}ca_{theirs}"
    for level in ("lower", "upper")
    for ours, theirs in (("arm_front", "front"), ("arm_rear", "rear"), ("ball_joint", "outer"))
} | {
    "tie_rod_outer": "tierod_outer",
    "tie_rod_inner": "tierod_inner",
    "wheel_centre": "wheel_center",
}
SUBSYSTEM = """\
$---------------------------------------------------------------------HARDPOINT
[HARDPOINT]
{{hardpoint_name               symmetry      x_value         y_value         z_value}}
{}
[PARAMETER]
 'kinematic_flag'             'single'      'integer'       0
"""


def test_hardpoints_of_adams_car_are_known_by_their_names_with_their_axes_and_sides(tmp_path: Path) -> None:
    both = [
        f"hp{side[0]}_{theirs}  {'  '.join(map(repr, WHEELS['front', side][ours]))}"
        for side in ("left", "right")
        for ours, theirs in ADAMS.items()
    ]
    text = "\n".join([*both, "hpl_damper 1 2 3"])
    left = WHEELS["front", "left"]
    lines = (f" '{theirs}' 'left/right' {' '.join(map(repr, left[ours]))}" for ours, theirs in ADAMS.items())
    for side, file in (("left", text), ("right", text), ("left", SUBSYSTEM.format("\n".join(lines)))):
        found = imported(tmp_path, file, side=side, camber=0.0, toe=0.0)
        given = {name: WHEELS["front", side][name] for name in ADAMS}
        assert {name: drawn(found)[name] for name in ADAMS} == given
        assert found.scene.mechanism.side == side
        assert "by names such as" in found.drawing.facts[0]
