"""Tables of points as people write them: each becomes the car that it says, or a line that asks."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pytest
from foreign_files import CAR, STRUT, drawn, imported, table

from pointcoord import Scene
from validate.cli import main
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


def corner(part: str, side: str) -> str:
    return (part[0] + side[0]).upper()


def one_column(word: Callable[[str, str], str], title: str) -> str:
    lines = [f"{title},Point,x_mm,y_mm,z_mm"]
    return "\n".join(
        [*lines, *(f"{word(*of)},{row}" for of, car in WHEELS.items() for row in rows(str, car))]
    )


def by_names(word: Callable[[str, str, str], str]) -> str:
    of_wheels = ((of, car) for of, car in WHEELS.items())
    return "\n".join(
        ["Point,X,Y,Z", *(r for of, car in of_wheels for r in rows(lambda n, of=of: word(*of, n), car))]
    )


SHAPES: dict[str, str] = {
    "a column of corners": one_column(corner, "corner"),
    "a column of wheels in words": one_column(lambda part, side: f"{part} {side}", "Wheel"),
    "names that begin with a corner": by_names(lambda part, side, name: f"{corner(part, side)}_{name}"),
    "names between axle and side": by_names(lambda part, side, name: f"{part.title()} {name} {side[0]}"),
}


@pytest.mark.parametrize("text", SHAPES.values(), ids=SHAPES)
def test_each_wheel_of_a_table_of_four_is_the_one_that_is_asked_for(text: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="--part front or --part rear"):
        imported(tmp_path, text, axes=OURS)
    with pytest.raises(FileError, match="--side left or --side right"):
        imported(tmp_path, text, axes=OURS, part="front")
    for (part, side), car in WHEELS.items():
        found = imported(tmp_path, text, axes=OURS, part=part, side=side)
        assert drawn(found) == car
        assert found.scene.mechanism.side == side
        assert not found.unknown


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("unit", ["", " (m)", "_mm", " metres"])
def test_titles_say_the_wheel_and_the_unit(side: str, unit: str, tmp_path: Path) -> None:
    per = 1000 if "m" in unit and "mm" not in unit else 1
    both = {name: (*WHEELS["front", "left"][name], *CAR[name]) for name in CAR}
    text = "\n".join(
        [
            "Point," + ",".join(f"{s} {axis}{unit}" for s in ("Left", "R") for axis in "XYZ"),
            *rows(str, {name: [n / per for n in six] for name, six in both.items()}),
        ]
    )
    found = imported(tmp_path, text, axes=OURS, side=side)
    for name, place in drawn(found).items():
        assert place == pytest.approx(WHEELS["front", side][name], rel=1e-15, abs=1e-12)
    if unit:
        with pytest.raises(FileError, match="says that its lengths are in m"):
            imported(tmp_path, text, axes=OURS, side=side, unit="in")


@pytest.mark.parametrize("before", [True, False])
def test_a_lonely_r_is_right_beside_an_l_and_asked_about_beside_an_f(before: bool, tmp_path: Path) -> None:
    def lettered(cars: Mapping[str, Mapping[str, Sequence[float]]]) -> str:
        lines = ["Point,X,Y,Z"]
        for letter, car in cars.items():
            lines += rows(lambda name, x=letter: f"{x}_{name}" if before else f"{name} {x}", car)
        return "\n".join(lines)

    rear, left = WHEELS["rear", "right"], WHEELS["front", "left"]
    assert drawn(imported(tmp_path, lettered({"L": left, "R": CAR}), axes=OURS, side="right")) == CAR
    text = lettered({"F": CAR, "R": rear})
    with pytest.raises(FileError, match=r"has lower_arm_front twice, .*--names"):
        imported(tmp_path, text, axes=OURS)
    names = tmp_path / "names.toml"
    lines = (f'{ours} = "{f"R_{word}" if before else f"{word} R"}"' for ours, word in WORDS.items())
    names.write_text("\n".join(["[names]", *lines]))
    assert drawn(imported(tmp_path, text, axes=OURS, names=str(names))) == rear


BOTH = [f"{WORDS[name]},{cells(WHEELS['front', 'left'][name])},{cells(CAR[name])}" for name in CAR]


@pytest.mark.parametrize("titles", ["xl,yl,zl,xr,yr,zr", "x,y,z,x,y,z", "x,y,z,hoch,quer,lang"])
@pytest.mark.parametrize("by", ["title", "number"])
def test_columns_that_are_not_known_are_those_that_the_user_names(
    titles: str, by: str, tmp_path: Path
) -> None:
    text, words = "\n".join([f"Point,{titles}", *BOTH]), titles.split(",")
    names = tmp_path / "names.toml"
    if "hoch" not in titles:
        with pytest.raises(FileError, match=r"line 1: has .*\[table\]"):
            imported(tmp_path, text, axes=OURS)
    for first, car in ((0, WHEELS["front", "left"]), (3, CAR)):
        at: Sequence[str | int] = range(first + 2, first + 5)
        if by == "title" and len({*words}) == 6:
            at = [f'"{word}"' for word in words[first : first + 3]]
        x, y, z = at
        name = 1 if by == "number" else '"Point"'
        names.write_text(f"[table]\nname = {name}\nx = {x}\ny = {y}\nz = {z}\n")
        assert drawn(imported(tmp_path, text, axes=OURS, names=str(names))) == car


def test_a_column_of_corners_under_another_title_is_the_one_that_the_user_names(tmp_path: Path) -> None:
    names = tmp_path / "names.toml"
    names.write_text('[table]\nname = "Point"\nx = "x_mm"\ny = "y_mm"\nz = "z_mm"\ncorner = "Ecke"\n')
    for (part, side), car in WHEELS.items():
        choices = {"axes": OURS, "part": part, "side": side, "names": str(names)}
        assert drawn(imported(tmp_path, one_column(corner, "Ecke"), **choices)) == car


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


def test_a_strut_is_known_by_its_words_and_a_word_more_or_less_is_another_point(tmp_path: Path) -> None:
    points = {n: p for n, p in STRUT.mechanism.points.items() if n not in ("rack_centre", "strut_rod_end")}
    words = WORDS | {"strut_top": "Strut upper mount", "strut_lower": "Strut lower point"}
    others = ("Lower damper front", "LCA front outer", "Lower arm", "Rack end", "LF", "Wheel")
    lines = [f"{words[name]},{cells(place)}" for name, place in points.items()]
    text = "\n".join(["Point,X,Y,Z", *lines, *(f"{other},1,2,3" for other in others)])
    found = imported(tmp_path, text, axes=OURS)
    assert found.scene.mechanism.type == "macpherson"
    assert {name: drawn(found)[name] for name in points} == points
    assert {one.name for one in (*found.unknown, *found.not_needed)} == {*others}


def test_axes_that_nobody_says_are_asked_for_with_those_that_fit(tmp_path: Path) -> None:
    text = "\n".join(["Point,X,Y,Z", *rows(str)])
    with pytest.raises(FileError, match="does not say where x, y and z point") as caught:
        imported(tmp_path, text)
    for words in ("--axes rearward,right,up of a right wheel", "--axes rearward,left,up of a left wheel"):
        assert words in str(caught.value)
    with pytest.raises(FileError) as caught:
        imported(tmp_path, text, side="right")
    assert "of a left wheel" not in str(caught.value)
    # Our own words in another's spelling are not our own names.
    spelt = "\n".join(["Point,X,Y,Z", *(f"{n.replace('_', ' ').title()},{cells(p)}" for n, p in CAR.items())])
    with pytest.raises(FileError, match="does not say where"):
        imported(tmp_path, spelt)
    assert any("by names such as 'CHAS_LowFor'" in fact for fact in imported(tmp_path, table()).facts)


FORMS = {
    "columns turned about": "\n".join(
        ["Z,X,Name,Y", *(f"{z!r},{x!r},{WORDS[n]},{y!r}" for n, (x, y, z) in CAR.items())]
    ),
    "numbers of lines": "\n".join(["No.,Point,X,Y,Z", *(f"{i},{row}" for i, row in enumerate(rows(str), 1))]),
    "blanks": "\n".join(["Point X Y Z", *rows(str)]).replace(",", "  "),
    "decimal commas": "\n".join(["Point;X;Y;Z", *rows(str)]).replace(",", ";").replace(".", ","),
}


@pytest.mark.parametrize("text", FORMS.values(), ids=FORMS)
def test_the_same_car_in_another_form_is_the_same_car(text: str, tmp_path: Path) -> None:
    assert drawn(imported(tmp_path, text, axes=OURS)) == CAR


def test_what_is_no_point_is_told(tmp_path: Path) -> None:
    lines = [*(f"{row},1.5" for row in rows(str)), ",,,,", "Steering rack,1.3,,,", "Wheel size,none,,,"]
    text = "\n".join(["Point,X,Y,Z,Mass", *lines])
    found = imported(tmp_path, text, axes=OURS)
    assert drawn(found) == CAR
    assert {"lines without a point: 'Steering rack' on line 13", "the column 'Mass' is not read"} <= {
        *found.facts
    }
    broken = text.replace(f"{WORDS['tie_rod_inner']},{cells(CAR['tie_rod_inner'])}", "TIE_ROD_IN,none,,")
    with pytest.raises(FileError, match="x of 'TIE_ROD_IN' is 'none'"):
        imported(tmp_path, broken, axes=OURS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("-3.5,529,122.84\n-45,190,129.9", "line 1: has coordinates without a name"),
        ("\n".join(BOTH), r"line 1: has 6 numbers for 'LCA_IN_FRONT'"),
        ("\n".join(["Point,X,Y,Z", *BOTH]), r"line 2: has 6 numbers for 'LCA_IN_FRONT'"),
        ("\n".join(BOTH).replace(",", " "), "line 1: .* more than three"),
        ("Point,LCA_IN,LCA_OUT,LBJ\nX,1,2,3\nY,4,5,6", r"line 1: has titles that are not known.*\[table\]"),
        ("Punkt,Hoch,Quer,Laengs\nLBJ,1,2,3", "line 1: has titles that are not known: 'Punkt, Hoch"),
        ("Point,old X,old Y,old Z\nLBJ,1,2,3", "has no column of x"),
        ("Point,X,Y,Z\n,(m),(m),(m)\nLBJ,1,2,3\nUBJ,4,5,6", "lacks"),
        ("Point;X;Y;Z\nLBJ;1.5;2;3\nUBJ;1,500;2;3", "line 3: has numbers with points and with commas"),
        (
            "VERSION\n  15\nTEMP_SETTINGS\n  14\nDouble Wishbone, Push Rod",
            "is a data file of Lotus .* text report",
        ),
        ("Point,X,Y,Z\nTie rod inner,0,0\nLBJ,1", "line 2: z of 'Tie rod inner' is ''"),
        ("Point,X,Y,Z\nA,1,2,3\nPoint,X (m),Y (m),Z (m)\nB,1,2,3", "line 3: has other titles"),
        ("Point,Right X,Right Y,Right Z\nLBJ_L,1,2,3", "line 2: has 'LBJ_L' for the right wheel"),
        (
            "\n".join(["X,Y,Z,", *(f"{cells(p)},{WORDS[n]}" for w in WHEELS.values() for n, p in w.items())]),
            r"line 12: has lower_arm_front twice, .* one wheel of one axle",
        ),
    ],
)
def test_a_table_that_cannot_be_read_is_told_in_one_line(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match=words):
        imported(tmp_path, text, axes=OURS)


def test_points_in_one_place_make_no_car(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # A table whose tie rod nobody has filled in.
    car = CAR | {"tie_rod_inner": (0.0, 0.0, 0.0), "tie_rod_outer": (0.0, 0.0, 0.0)}
    (tmp_path / "car.txt").write_text("\n".join(["Point,X,Y,Z", *rows(str, car)]))
    assert main(["import", str(tmp_path / "car.txt"), "--axes", OURS]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "tie_rod_inner - tie_rod_outer has no length" in line
