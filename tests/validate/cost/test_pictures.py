"""The pictures show what the rows hold: points where they were measured, and by name what has none."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from made_rows import alike, dialled, error, grown, measured, study
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

from validate.cost.findings import findings, growths
from validate.cost.looks import FURTHER, LOOKS, looks
from validate.cost.picture import error_time, growing, headline
from validate.cost.picture.look import spread, style
from validate.cost.row import Row
from validate.cost.ways.registry import WAYS


def panels(figure: Figure) -> dict[str, Axes]:
    return {axes.get_title(loc="left"): axes for axes in figure.axes if axes.axison}


def texts(axes: Axes) -> str:
    return "\n".join(text.get_text() for text in axes.texts)


def points(axes: Axes, colour: str, marker: str) -> list[tuple[float, float]]:
    return [
        (float(x), float(y))
        for line in axes.lines
        if line.get_marker() == marker and to_hex(line.get_color()) == colour
        for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)
        if math.isfinite(y)
    ]


def test_no_two_ways_share_a_marker_or_a_line_so_that_colour_is_not_needed() -> None:
    assert {way.name for way in WAYS} <= set(LOOKS)
    for of in ("marker", "symbol"):
        known = [getattr(look, of) for look in LOOKS.values()]
        assert len(set(known)) == len(known)
        assert not {getattr(look, of) for look in FURTHER} & set(known)
    lines = [(look.colour, look.dash) for look in (*LOOKS.values(), *FURTHER[:8])]
    assert len(set(lines)) == len(lines)
    for one, other in combinations(FURTHER, 2):
        assert (one.colour, one.marker) != (other.colour, other.marker)
    found = looks(["series", "of a user", "another"])
    assert looks(["another", "of a user", "series"]) == found
    assert found["of a user"] != found["another"]


def test_a_way_that_serves_any_instant_is_filled_and_another_hollow() -> None:
    for name, look in LOOKS.items():
        assert style(look, True)["markerfacecolor"] == look.colour, name
        assert style(look, False)["markerfacecolor"] == "white", name


def luminance(colour: str) -> float:
    """Relative luminance (WCAG 2.2)."""
    parts = np.array(to_rgb(colour))
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def test_lines_stand_out_of_white_paper_and_of_a_dark_page() -> None:
    for look in (*LOOKS.values(), *FURTHER):
        for behind in ("#ffffff", "#16181b"):
            low, high = sorted(map(luminance, (look.colour, behind)))
            assert (high + 0.05) / (low + 0.05) >= 3.0, (look.colour, behind)  # WCAG 2.2, 1.4.11


def test_every_measured_setting_is_a_point_at_its_time_and_error() -> None:
    rows = dialled("bounce", "series", 4e-6, 0.05, 2e-13, dense=True, output=0.0)
    axes = panels(error_time.figure(rows))["position"]
    found = points(axes, LOOKS["series"].colour, LOOKS["series"].marker)
    wanted = [
        (row.times["solve"].median / row.configurations * 1e6, row.errors["position"].largest) for row in rows
    ]
    assert found == [pytest.approx(one, rel=1e-12) for one in wanted]
    (low, high), (left, right) = axes.get_ylim(), axes.get_xlim()
    assert all(left < time < right and low < largest < high for time, largest in wanted)


def test_a_panel_is_there_for_every_quantity_with_its_unit() -> None:
    found = panels(error_time.figure([measured("bounce", "newton", "", alike(1e-12), 1e-5)]))
    assert list(found) == ["position", "velocity", "acceleration", "angular velocity", "angular acceleration"]
    assert found["angular acceleration"].get_ylabel() == "largest error, rad/s^2"


def test_an_exact_zero_is_at_the_foot_and_not_lost() -> None:
    rows = [
        measured("bounce", "absolute", "", {"position": 0.0}, 1e-5),
        measured("bounce", "newton", "", {"position": 1e-12}, 1e-5),
    ]
    axes = panels(error_time.figure(rows))["position"]
    ((_, height),) = points(axes, LOOKS["absolute"].colour, "D")
    assert axes.get_ylim()[0] < height < 1e-13
    assert "exactly 0" in texts(axes)
    assert "exactly 0" not in texts(panels(error_time.figure(rows[1:]))["position"])


def test_ways_without_a_point_are_named_below_the_panel_with_what_became_of_them() -> None:
    good = measured("bounce", "newton", "", alike(1e-12), 1e-5)
    rows = [
        good,
        Row("accuracy", "bounce", "exudyn", status="failed", reason="diverged"),
        Row("accuracy", "bounce", "printed", status="left out", reason="of a strut"),
        replace(good, way="mujoco", errors={"position": error(1e-12)}),
        replace(good, way="relative", errors={"position": error(math.nan), "velocity": error(1e-12)}),
        replace(good, way="series", setting="1e-2 mm"),
        replace(good, way="series", setting="1e-3 mm", status="failed"),
    ]
    found = panels(error_time.figure(rows))
    assert "failed: exudyn, series 1e-3 mm" in texts(found["position"])
    assert "left out: printed" in texts(found["position"])
    assert "not a number: relative" in texts(found["position"])
    assert "not given: mujoco" in texts(found["velocity"])
    assert "not given" not in texts(found["position"])


def test_the_references_radius_is_a_line_where_it_is_near_the_errors_and_a_number_always() -> None:
    near = replace(
        measured("bounce", "newton", "", {}, 1e-5), errors={"position": error(1e-10, radius=1e-12)}
    )
    far = measured("bounce", "newton", "", {"position": 1e-10}, 1e-5)
    for row, is_line in ((near, True), (far, False)):
        axes = panels(error_time.figure([row]))["position"]
        assert any(line.get_linestyle() == "-." for line in axes.lines) is is_line
        assert "reference's own radius: 1e-" in texts(axes)


def test_the_floor_of_a_dialled_way_is_drawn_at_its_smallest_error() -> None:
    axes = panels(error_time.figure(dialled("bounce", "newton", 6e-5, 0.01, 3e-11)))["position"]
    heights = [float(part[0][1]) for lines in axes.collections for part in lines.get_segments()]
    assert heights == [3e-11]


def test_growth_shows_the_exponent_of_every_way_and_what_was_not_measured() -> None:
    rows = [row for row in study() if row.against == "unknowns"]
    figure = growing.figure(growths(rows), frozenset({"series"}))
    time = panels(figure)["time"]
    assert "series*  p = 1.10 \u00b1 0.00" in texts(time)
    assert "relative  p = 2.90 \u00b1 0.00" in texts(time)
    below = "\n".join(text.get_text() for text in figure.texts)
    assert "x  relative at 1500 unknowns: left out: would take an hour" in below
    assert any(line.get_marker() == "x" for line in time.lines)
    memory = panels(figure)["memory"]
    assert memory.get_ylabel().endswith("MB")
    assert (1500.0, pytest.approx(13.501)) in points(memory, LOOKS["series"].colour, "o")


def test_settings_of_one_way_are_told_apart_in_a_growth() -> None:
    rows = [
        *grown("bounce", "series", "one by one", "designs", [1, 10, 100], 0.0, 2e-3),
        *grown("bounce", "series", "together", "designs", [1, 10, 100], 0.0, 1e-5),
    ]
    axes = panels(growing.figure(growths(rows), frozenset()))["time"]
    assert "series one by one" in texts(axes)
    assert "series together" in texts(axes)


def test_the_headline_has_errors_and_growth_and_does_without_what_was_not_measured() -> None:
    rows = study()
    figure = headline.figure(rows, findings(rows))
    assert figure is not None
    assert len(panels(figure)) == 3
    alone = [row for row in rows if row.part == "accuracy"]
    figure = headline.figure(alone, findings(alone))
    assert figure is not None
    assert len(panels(figure)) == 2
    assert headline.figure([], findings([])) is None
    failed = [Row("accuracy", "bounce", "series", status="failed", reason="locked")]
    assert headline.figure(failed, findings(failed)) is None


def all_ways() -> list[Row]:
    """A study of every way that has a look, with growth of some under two settings."""
    rows = [measured("bounce", way, "", alike(10.0**-k), 10.0**-k) for k, way in enumerate(LOOKS, 1)]
    for way in ("series", "newton", "relative"):
        for setting in ("1e-9 mm, one by one", "1e-9 mm, together"):
            rows += grown("bounce", way, setting, "designs", [1, 10, 100], 0.0, 2e-3, bytes_each=10.0)
        rows += grown("bounce", way, "", "instants", [100, 1000, 10000], 0.0, 2e-3)
    return rows


@pytest.mark.parametrize("growth", [True, False])
def test_no_text_runs_out_of_a_picture(growth: bool) -> None:
    rows = [row for row in all_ways() if growth or row.part == "accuracy"]
    found = findings(rows)
    figures = [
        headline.figure(rows, found),
        error_time.figure([row for row in rows if row.part == "accuracy"]),
    ]
    for against in ("designs", "instants"):
        grows = [g for g in found.growths if g.against == against]
        figures += [growing.figure(grows, frozenset({"series"}))] if grows else []
    for figure in figures:
        assert figure is not None
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        drawn, (wide, high) = figure.get_tightbbox(canvas.get_renderer()), figure.get_size_inches()
        assert drawn.x0 >= 0.0
        assert drawn.x1 <= wide
        assert drawn.y0 >= 0.0
        assert drawn.y1 <= high


def test_labels_that_crowd_are_moved_apart_and_others_stay() -> None:
    assert spread([0.1, 0.5, 0.9], 0.1) == pytest.approx([0.1, 0.5, 0.9])
    assert spread([0.5, 0.5], 0.1) == pytest.approx([0.45, 0.55])
    moved = spread([0.52, 0.5, 0.51, 0.1], 0.1)
    assert moved[3] == pytest.approx(0.1)
    assert sorted(moved[:3]) == [moved[1], moved[2], moved[0]]
    assert moved[2] - moved[1] == pytest.approx(0.1)
    assert moved[0] - moved[2] == pytest.approx(0.1)
    assert spread([], 0.1) == []
