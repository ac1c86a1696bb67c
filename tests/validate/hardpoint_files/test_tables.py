"""Tables of points as people write them: each becomes the car that it says, or a line that asks."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pytest
from foreign_files import CAR, OPTIMUMK, STRUT, drawn, imported, table

from pointcoord import Scene
from validate.cli import main
from validate.hardpoint_files.format import formats
from validate.tables.errors import FileError

WORDS = {
    "lower_arm_front": "LCA_IN_FRONT",
    "lower_arm_rear": "LCA_IN_REAR",
    "lower_ball_joint": "LCA_OUT",
    "upper_arm_front": "UCA_IN_FRONT",
    "upper_arm_rear": "UCA_IN_REAR",
    "upper_ball_joint": "UCA_OUT",
    "tie_rod_outer": "TIE_ROD_OUT",
    "tie_rod_inner": "TIE_ROD_IN",
    "wheel_centre": "WHEEL_CENTER",
    "wheel_axis_inner": "Wheel Spindle Point",
}
OURS = "rearward,right,up"
# Another car for each wheel, so that a wheel that is taken for another shows; x rearward, y right, z up.
WHEELS = {
    ("front", "right"): CAR,
    ("front", "left"): {name: (x, -y - 1.0, z) for name, (x, y, z) in CAR.items()},
    ("rear", "right"): {name: (x + 1500.0, y + 2.0, z) for name, (x, y, z) in CAR.items()},
    ("rear", "left"): {name: (x + 1500.0, -y - 3.0, z) for name, (x, y, z) in CAR.items()},
}


def cells(place: Sequence[float]) -> str:
    return ",".join(map(repr, place))


def rows(name: Callable[[str], str], points: Mapping[str, Sequence[float]] = CAR) -> list[str]:
    return [f"{name(WORDS[ours])},{cells(place)}" for ours, place in points.items()]


# A sheet of OptimumK, saved as CSV.


def sheet() -> str:
    """A suspension in the form of a sheet of OptimumK; x forward, y left, z up; mm."""
    lines = []
    for ours, theirs in OPTIMUMK.items():
        if ours in CAR and "wheel" not in ours:
            (x, y, z), (u, v, w) = CAR[ours], WHEELS["front", "left"][ours]
            lines.append(f",{theirs},{-u!r},{-v!r},{w!r},,{-x!r},{-y!r},{z!r}")
    return "\n".join(
        [
            ",Name:,Our own,,,,,,",
            ",Version:,2.0.2,Modified by:,,,Modified on:,46046.06,",
            "Comments:,,,,,,,,",
            "User Options,Length,millimetre,mm,,,,,",
            "Double A-Arm,Point Name,Left,,,,Right,,",
            ",,X,Y,Z,,X,Y,Z",
            *lines,
            "Rack Pinion,Steering Ratio,119.63,,,,,,",
            ",Static Camber,-0.96,,,,-0.96,,",
            ",Static Toe,0.5,,,,0.25,,",
            ",Spring,Push Pull,21.2,,,,21.2,",
        ]
    )


def test_a_sheet_of_optimumk_gives_the_wheel_whose_columns_are_named(tmp_path: Path) -> None:
    """Titles that stand twice are not guessed at; its names have its axes, and static angles are told."""
    with pytest.raises(FileError, match=r"line 6: has two columns of x .*\[table\]"):
        imported(tmp_path, sheet(), side="right")
    names = tmp_path / "names.toml"
    columns = "[table]\nname = 2\nx = 7\ny = 8\nz = 9\n"
    names.write_text(columns)
    with pytest.raises(FileError, match=r"lacks wheel_centre.* 'Static Toe' on line .*\+ toe in"):
        imported(tmp_path, sheet(), side="right", names=str(names))
    given = {name: [-x, -y, z] for name, (x, y, z) in CAR.items() if "wheel" in name}
    lines = [f"{name} = {place!r}" for name, place in given.items()]
    names.write_text("\n".join([columns, "[names]", *lines]))
    found = imported(tmp_path, sheet(), side="right", names=str(names))
    assert (drawn(found), found.scene.mechanism.side, found.doubts) == (CAR, "right", ())


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
    assert not found.others
    assert any("pushrod_outer is taken for a point of the lower arm" in fact for fact in found.facts)


# Which wheel.


def corner(part: str, side: str) -> str:
    return (part[0] + side[0]).upper()


def one_column(title: str) -> str:
    lines = (f"{corner(*of)},{row}" for of, car in WHEELS.items() for row in rows(str, car))
    return "\n".join([f"{title},Point,x_mm,y_mm,z_mm", *lines])


def called(name: Callable[[str, str, str], str]) -> str:
    """The four wheels by names that say which."""
    lines = (row for of, car in WHEELS.items() for row in rows(lambda own, of=of: name(own, *of), car))
    return "\n".join(["Point,X,Y,Z", *lines])


SHAPES: dict[str, str] = {
    "a column of corners": one_column("corner"),
    "names that begin with a corner": called(lambda own, part, side: f"{corner(part, side)}_{own}"),
    "names between axle and side": called(lambda own, part, side: f"{part.title()} {own} {side[0].upper()}"),
    "tables under headings": "\n".join(
        line
        for part in ("front", "rear")
        for line in (
            f"{part.upper()} SUSPENSION,,,,,,",
            "Point,Left X,Left Y,Left Z,Right X,Right Y,Right Z",
            *(f"{WORDS[n]},{cells(WHEELS[part, 'left'][n])},{cells(WHEELS[part, 'right'][n])}" for n in CAR),
        )
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
        assert not found.others


def test_a_lonely_r_is_right_beside_an_l_and_asked_about_beside_an_f(tmp_path: Path) -> None:
    name = "{0}_{1}"
    rear, left = WHEELS["rear", "right"], WHEELS["front", "left"]

    def lettered(**cars: Mapping[str, Sequence[float]]) -> str:
        lines = (row for x, car in cars.items() for row in rows(lambda own, x=x: name.format(x, own), car))
        return "\n".join(["Point,X,Y,Z", *lines])

    assert drawn(imported(tmp_path, lettered(L=left, R=CAR), axes=OURS, side="right")) == CAR
    with pytest.raises(FileError, match=r"has lower_arm_front twice, .*--names"):
        imported(tmp_path, lettered(F=CAR, R=rear), axes=OURS)
    names = tmp_path / "names.toml"
    lines = (f'{ours} = "{name.format("R", word)}"' for ours, word in WORDS.items())
    names.write_text("\n".join(["[names]", *lines]))
    assert drawn(imported(tmp_path, lettered(F=CAR, R=rear), axes=OURS, names=str(names))) == rear


SECTIONS = {
    "LOWER A-ARM": {
        "Front inboard": "lower_arm_front",
        "Rear inboard": "lower_arm_rear",
        "Outboard": "lower_ball_joint",
    },
    "UPPER A-ARM": {
        "Front inboard": "upper_arm_front",
        "Rear inboard": "upper_arm_rear",
        "Outboard": "upper_ball_joint",
    },
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
    assert [point.name for point in found.others] == ["Mass"]
    assert "LOWER A-ARM Front inboard, line 3" in found.text


BOTH = [f"{WORDS[name]},{cells(WHEELS['front', 'left'][name])},{cells(CAR[name])}" for name in CAR]


def test_columns_that_are_not_known_are_those_that_the_user_names(tmp_path: Path) -> None:
    text, names = "\n".join(["Point,x,y,z,hoch,quer,lang", *BOTH]), tmp_path / "names.toml"
    names.write_text('[table]\nname = "Point"\nx = "Hoch"\ny = "quer"\nz = "lang"\n')
    assert drawn(imported(tmp_path, text, axes=OURS, names=str(names))) == CAR
    names.write_text('[table]\nname = "Point"\nx = "X"\ny = "Y"\n')
    with pytest.raises(FileError, match=r"\[table\] is"):
        imported(tmp_path, text, names=str(names))


def test_a_column_of_corners_under_another_title_is_the_one_that_the_user_names(tmp_path: Path) -> None:
    names = tmp_path / "names.toml"
    names.write_text('[table]\nname = "Point"\nx = "x_mm"\ny = "y_mm"\nz = "z_mm"\ncorner = "Ecke"\n')
    choices = {"axes": OURS, "part": "rear", "side": "left", "names": str(names)}
    assert drawn(imported(tmp_path, one_column("Ecke"), **choices)) == WHEELS["rear", "left"]


def test_a_file_of_names_that_is_not_there_is_written_to_be_filled_in(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, names, scene = (tmp_path / name for name in ("car.csv", "names.toml", "car.toml"))
    text = "\n".join(["Punkt,Hoch,Quer,Laengs", *rows(str)])
    table.write_text(text.replace("LCA_OUT", "Traggelenk"))
    words = ["import", str(table), "--names", str(names), "--axes", OURS, "-o", str(scene)]
    assert main(words) == 2
    assert "names.toml was not there: it is written" in capsys.readouterr().err
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


# Names.


SPELLINGS = """
lower_arm_front LCA front|Lower Wishbone, Front Pivot|lowerWishboneFrontPivot|front lower inner
lower_arm_front LCA Fore Inboard|Lower control arm - forward chassis pickup|bottom forward chassis pickup
lower_arm_rear LCA aft|Lower wishbone rear inboard|lower control arm back|LWB_rear|2 Lower wishbone rear pivot
lower_ball_joint LBJ|Lower BallJoint|LCA outer|Lower outboard|lower kingpin pickup|Lower wishbone upright
upper_arm_front UCA_FRONT|Upper arm forward inner|(5) Point 5: Upper Wishbone Front Pivot|top wishbone front
upper_arm_rear UCA rear pivot|upper a arm aft chassis|upperRearInner
upper_ball_joint UBJ|UCA Out|Upper outer ball joint|top ball joint
tie_rod_outer Toe link outboard|TRO|TieRod_Out|Outer track rod ball joint|tie rod end outer
tie_rod_inner tierod inner|Track rod chassis|TRI|toe-link inboard
wheel_centre WC|Wheel Center|wheelCentre|Wheel centre point
"""


def test_a_point_is_known_by_many_names() -> None:
    csv = formats()["csv"]
    theirs = {csv.in_our_words(name): our for our, names in csv.names.items() for name in names}
    for ours, spellings in (line.split(maxsplit=1) for line in SPELLINGS.strip().splitlines()):
        for spelling in spellings.split("|"):
            assert theirs[csv.in_our_words(spelling)] == ours, spelling


def test_a_name_with_a_word_more_or_less_is_another_point(tmp_path: Path) -> None:
    others = (
        *("Lower damper front", "LCA front outer", "Lower arm", "LCA front spring"),
        *("UCA outer pushrod", "Rack end", "LF", "Wheel"),
    )
    text = "\n".join(["Point,X,Y,Z", *rows(str), *(f"{other},1,2,3" for other in others)])
    found = imported(tmp_path, text, axes=OURS)
    assert drawn(found) == CAR
    assert tuple(point.name for point in found.others) == others


# Axes and units.


def test_a_strut_is_known_by_its_words(tmp_path: Path) -> None:
    points = {n: p for n, p in STRUT.mechanism.points.items() if n not in ("rack_centre", "strut_rod_end")}
    words = WORDS | {"strut_top": "Strut upper mount", "strut_lower": "Strut lower point"}
    text = "\n".join(["Point,X,Y,Z", *(f"{words[name]},{cells(place)}" for name, place in points.items())])
    found = imported(
        tmp_path, text, axes=OURS, **({} if "wheel_axis_inner" in points else {"camber": 0.0, "toe": 0.0})
    )
    assert found.scene.mechanism.type == "macpherson"
    assert {name: drawn(found)[name] for name in points} == points


SPELT = [f"{name.replace('_', ' ').title()},{cells(place)}" for name, place in CAR.items()]


@pytest.mark.parametrize(
    ("lines", "side", "words", "others"),
    [
        (rows(str), None, ("--axes rearward,right,up of a right", "--axes rearward,left,up of a left"), ()),
        (rows(str), "right", ("of a right wheel",), ("of a left wheel",)),
        # Our own words in another's spelling are not our own names.
        (SPELT, None, ("does not say where",), ()),
    ],
)
def test_axes_that_nobody_says_are_asked_for_with_those_that_fit(
    lines: Sequence[str], side: str | None, words: Sequence[str], others: Sequence[str], tmp_path: Path
) -> None:
    with pytest.raises(FileError, match="does not say where x, y and z point") as caught:
        imported(tmp_path, "\n".join(["Point,X,Y,Z", *lines]), side=side)
    assert [word for word in words if word not in str(caught.value)] == []
    assert [word for word in others if word in str(caught.value)] == []


METRES = {name: tuple(n / 1000 for n in place) for name, place in CAR.items()}
NUMBERED = (f"{z!r},{i},{x!r},{WORDS[n]},{y!r}" for i, (n, (x, y, z)) in enumerate(CAR.items(), 1))


@pytest.mark.parametrize(
    ("text", "choices", "facts"),
    [
        (table(), {}, ("by names such as 'CHAS_LowFor'",)),
        (table(per_unit="1000", titles="Point Name,X (m),Y (m),Z (m)\n"), {}, ("in m, by the file",)),
        (table(ending="_FR"), {}, ()),
        (table(order=(2, 1, 0), signs=(1, -1, 1)), {"axes": "up,left,rearward"}, ("by --axes",)),
        ("\n".join(["Point,X (rearward),Y [right],Z (up)", *rows(str)]), {}, ("by its titles",)),
        ("\n".join(["Point,x_m,y_m,z_m", *rows(str, METRES)]), {"axes": OURS}, ()),
        ("\n".join(["Point,X metres,Y metres,Z metres", *rows(str, METRES)]), {"axes": OURS}, ()),
        ("\n".join(["Z,No.,X,Name,Y", *NUMBERED]), {"axes": OURS}, ()),
        (
            "\n".join(["Point,X,Y,Z,RX,Mass", *(f"{row},1.5,2.5" for row in rows(str))]),
            {"axes": OURS},
            ("the column 'RX' is not read", "the column 'Mass' is not read"),
        ),
    ],
)
def test_a_table_is_the_car_however_it_is_written(
    text: str, choices: Mapping[str, str], facts: Sequence[str], tmp_path: Path
) -> None:
    found = imported(tmp_path, text, **choices)
    assert drawn(found) == CAR
    assert found.scene.mechanism.side == "right"
    assert [fact for fact in facts if not any(fact in said for said in found.facts)] == []


# Other forms of a table.


ADAMS = {
    "lower_arm_front": "lca_front",
    "lower_arm_rear": "lca_rear",
    "lower_ball_joint": "lca_outer",
    "upper_arm_front": "uca_front",
    "upper_arm_rear": "uca_rear",
    "upper_ball_joint": "uca_outer",
    "tie_rod_outer": "tierod_outer",
    "tie_rod_inner": "tierod_inner",
    "wheel_centre": "wheel_center",
}
SUBSYSTEM = """\
$---------------------------------------------------------------------MDI_HEADER
[MDI_HEADER]
 FILE_TYPE     =  'sub'
 FILE_VERSION  =  4.0
$---------------------------------------------------------------------HARDPOINT
[HARDPOINT]
{{hardpoint_name               symmetry      x_value         y_value         z_value}}
{}
$---------------------------------------------------------------------PARAMETER
[PARAMETER]
{{parameter_name               symmetry      type            value}}
 'kinematic_flag'             'single'      'integer'       0
"""


def test_hardpoints_of_adams_car_are_known_by_their_names_with_their_axes_and_sides(tmp_path: Path) -> None:
    both = [
        f"hp{side[0]}_{theirs}  {'  '.join(map(repr, WHEELS['front', side][ours]))}"
        for side in ("left", "right")
        for ours, theirs in ADAMS.items()
    ]
    text = "\n".join([*both, "hpl_damper 1 2 3"])
    for side in ("left", "right"):
        found = imported(tmp_path, text, side=side, camber=0.0, toe=0.0)
        given = {name: WHEELS["front", side][name] for name in ADAMS}
        assert {name: drawn(found)[name] for name in ADAMS} == given
        assert found.scene.mechanism.side == side
        assert "by names such as 'hp" in found.facts[0]


def test_a_subsystem_of_adams_car_prints_the_left_wheel(tmp_path: Path) -> None:
    left = WHEELS["front", "left"]
    lines = (f" '{theirs}' 'left/right' {' '.join(map(repr, left[ours]))}" for ours, theirs in ADAMS.items())
    found = imported(tmp_path, SUBSYSTEM.format("\n".join(lines)), camber=-1.0, toe=0.0)
    assert {name: drawn(found)[name] for name in ADAMS} == {name: left[name] for name in ADAMS}
    assert found.scene.mechanism.side == "left"


UNTITLED = "has 6 numbers for 'LCA_IN_FRONT'"


def test_lines_of_settings_are_told_and_a_point_without_a_place_is_not_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "\n".join(["Point,X,Y,Z", *rows(str), ",,,", "Steering rack,1.3,,", "Wheel size,none,,"])
    found = imported(tmp_path, text, axes=OURS)
    assert drawn(found) == CAR
    assert "lines without a point: 'Steering rack' on line 13, 'Wheel size' on line 14" in found.facts
    broken = text.replace(f"{WORDS['tie_rod_inner']},{cells(CAR['tie_rod_inner'])}", "TIE_ROD_IN,none,,")
    assert "TIE_ROD_IN,none" in broken
    with pytest.raises(FileError, match=r"lacks tie_rod_inner .*without three numbers: 'TIE_ROD_IN' on line"):
        imported(tmp_path, broken, axes=OURS)
    assert main(["import", str(tmp_path / "car.txt"), "--axes", OURS]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("\n".join(BOTH).replace(",", " "), UNTITLED),
        ("\n".join(["Point,XL,YL,ZL,XR,YR,ZR", *BOTH]), r"titles that are not known.* \[table\]"),
        ("\n".join(["Punkt,Hoch,Quer,Laengs", *rows(str)]), "line 1: .* not known: 'Hoch, Quer, Laengs'"),
        (
            "\n".join(["Point,Right X,Right Y,Right Z", *rows("{}_L".format)]),
            "'LCA_IN_FRONT_L' for the right",
        ),
        (
            "\n".join(["Point,X (rearward),Y,Z", *rows(str)]),
            r"directions \['rearward'\]; allowed: .* all three or none",
        ),
        ("-3.5,529,122.84\n-45,190,129.9", "line 1: has coordinates without a name"),
        ("Point,LCA_IN,LCA_OUT,LBJ\nX,1,2,3\nY,4,5,6", "titles that are not known: .* a point a line"),
        ("Point;X;Y;Z\nLBJ;1.5;2;3\nUBJ;1,500;2;3", "line 3: has numbers with points and with commas"),
        (
            "Point,X (forward),Y (left),Z (up)\nA,1,2,3\nPoint,X (left),Y (up),Z (forward)\nB,1,2,3",
            "in different axes",
        ),
    ],
)
def test_a_table_that_cannot_be_read_is_told_in_one_line(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match=words):
        imported(tmp_path, text, axes=OURS)
