"""The report in a browser: headless Chromium, from disk; not collected unless this file is named.

    pytest tests/browser/page.py -n 0

needs Chromium in the path of programs. The report of all built-in scenes is made, if REPORT is no folder that
holds it, and opened once; every test looks at the same page and leaves it as it found it. After each test the
page must not have complained of anything, nor have asked for anything but itself.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_rows import measured
from playwright.sync_api import Browser, Page, sync_playwright

from pointcoord.numerics.arrays import Array
from validate.cli import main
from validate.cost.report import Report
from validate.cost.ways.registry import WAYS
from validate.html.page import page as page_of
from validate.html.run import Run
from validate.output.document import Head

WINDOW = {"width": 1200, "height": 900}
PHONE = {"width": 390, "height": 844}
# A4 without margins of 15 mm, at 96 pixels an inch.
PAPER = {"width": 680, "height": 1009}
# Seconds of work of the page's own process until all of it is there: time on a clock would measure what
# else the machine does. 2.2 s were seen, and the script of plotly takes most of them.
LOAD = 8.0
# The guidelines for accessible content (WCAG 2.2, 1.4.3 and 1.4.11) on text and on lines.
TEXT, LINES = 4.5, 3.0
# Functions of `page.js` beside this file by their names.
SCRIPTS = dict(
    re.findall(r"^//: (\w+)\n(.+?)(?=^//:|\Z)", Path(__file__).with_suffix(".js").read_text(), re.M | re.S)
)


@dataclass
class Opened:
    """A page, the folder of its report, and what it said or asked for that it should not.

    Attributes:
        work: seconds of the page's own process until it was loaded.
    """

    page: Page
    folder: Path
    work: float = 0.0
    complaints: list[str] = field(default_factory=list)


def chromium() -> str:
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    assert found, "there is no Chromium in the path of programs"
    return found


def opened(browser: Browser, folder: Path, **options: Any) -> Opened:
    page = browser.new_context(**options).new_page()
    page.set_default_timeout(120_000)
    one = Opened(page, folder)
    address = (folder / "index.html").as_uri()
    page.on("console", lambda said: one.complaints.append(f"{said.type}: {said.text}"))
    page.on("pageerror", lambda error: one.complaints.append(f"error: {error}"))
    page.on("dialog", lambda dialog: (one.complaints.append(f"dialog: {dialog.message}"), dialog.dismiss()))

    def asked(url: str) -> None:
        if not url.startswith(("data:", "blob:")) and url != address:
            one.complaints.append(f"asks for {url}")

    page.on("request", lambda request: asked(request.url))
    devices = page.context.new_cdp_session(page)
    devices.send("Performance.enable")
    page.goto(address)
    metrics = devices.send("Performance.getMetrics")["metrics"]
    one.work = next(metric["value"] for metric in metrics if metric["name"] == "ProcessTime")
    devices.detach()
    return one


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as program:
        # Without a graphics processor the browser's own process for it may hang.
        started = program.chromium.launch(executable_path=chromium(), args=["--no-sandbox", "--disable-gpu"])
        yield started
        started.close()


@pytest.fixture(scope="session")
def session(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Opened:
    made = os.environ.get("REPORT")
    folder = Path(made) if made else tmp_path_factory.mktemp("report")
    if not made:
        assert main(["report", "-q", str(folder)]) == 0
    return opened(browser, folder, viewport=WINDOW, color_scheme="light")


@pytest.fixture
def report(session: Opened) -> Iterator[Opened]:
    """The page in a wide window, light, at its top; afterwards it has not complained."""
    session.page.bring_to_front()
    session.page.set_viewport_size(WINDOW)
    session.page.emulate_media(media="screen", color_scheme="light", reduced_motion="no-preference")
    session.page.evaluate("scrollTo(0, 0); document.activeElement.blur()")
    yield session
    assert session.complaints == []


@pytest.fixture
def page(report: Opened) -> Page:
    return report.page


def settled(page: Page, folded: int = 1) -> None:
    """Of each section so many that open are open, all plots drawn for the window as it is."""
    page.evaluate(SCRIPTS["settled"], folded)


def until(page: Page, what: str) -> None:
    """Wait for what a line of script says: playwright's own way runs text, which the policy forbids."""
    page.evaluate(
        f"""async () => {{
            const start = performance.now();
            while (!({what})) {{
                if (performance.now() - start > 60_000) throw new Error("never");
                await new Promise((go) => setTimeout(go, 10));
            }}
        }}"""
    )


def test_the_page_is_there_after_few_seconds_of_work_and_no_name_of_a_point_covers_another_or_a_joint(
    report: Opened,
) -> None:
    assert 0.0 < report.work < LOAD
    settled(report.page, folded=99)
    assert report.page.locator("[data-plot] .main-svg").count() > 20
    settled(report.page)
    assert report.page.evaluate(SCRIPTS["covered_names"]) == []


# The drawing in space.


def joints(page: Page) -> Array:
    """Where the joints of the first drawing are in it, (P, 2)."""
    read = """all => all.map((one) => one.tagName === "rect"
        ? [Number(one.getAttribute("x")) + 4, Number(one.getAttribute("y")) + 4]
        : [Number(one.getAttribute("cx")), Number(one.getAttribute("cy"))])"""
    return np.array(page.locator(".spatial").first.locator(".joint").evaluate_all(read), dtype=float)


def ends(page: Page, stroke: str) -> Array:
    """Ends of the lines of one stroke of the first drawing, (L, 4)."""
    read = "all => all.map((one) => ['x1', 'y1', 'x2', 'y2'].map((name) => Number(one.getAttribute(name))))"
    return np.array(page.locator(".spatial").first.locator(f"g .{stroke}").evaluate_all(read), dtype=float)


def motion_of(page: Page) -> Any:
    """What the first drawing shows."""
    return json.loads(page.locator("[data-motion]").first.get_attribute("data-motion") or "")


def slider(page: Page) -> Any:
    return page.locator(".spatial input[type=range]").first


def slide(page: Page, value: int) -> None:
    slider(page).evaluate(
        "(one, value) => { one.value = value; one.dispatchEvent(new Event('input')); }", value
    )


def seen_from(page: Page, name: str) -> None:
    page.locator(".spatial").first.get_by_role("button", name=f"{name} view").click()


def test_the_slider_shows_each_instant_to_scale(page: Page) -> None:
    motion = motion_of(page)
    axes, last = np.array(motion["axes"]), len(motion["times"]) - 1
    # From the right the front is to the right; of the page, down is positive.
    for view, across, upward in (
        ("Rear", (1, 0, 0), (0, 0, -1)),
        ("Right", (0, -1, 0), (0, 0, -1)),
        ("Top", (1, 0, 0), (0, 1, 0)),
    ):
        seen_from(page, view)
        shown, true = [], []
        for frame in (0, last // 3, last):
            slide(page, frame)
            places = joints(page)
            drawn = np.concatenate([places[list(pair)].reshape(1, 4) for pair in motion["lines"]])
            assert np.abs(ends(page, "tube") - drawn).max() < 0.011  # two digits behind the point
            # And two models that agree, to two digits of a mm.
            assert np.abs(ends(page, "thread") - drawn).max() < 0.021
            shown.append(places)
            true.append(
                np.array(motion["models"][0]["frames"][frame]) @ axes.T @ np.array([across, upward]).T
            )
        assert np.abs(shown[0] - shown[2]).max() > 20.0
        flat, places = (np.concatenate(some) - np.mean(some, axis=(0, 1)) for some in (true, shown))
        scale = float(np.sum(flat * places) / np.sum(flat * flat))
        assert scale > 0.1
        assert np.abs(scale * flat - places).max() < 0.011
    slide(page, 0)
    seen_from(page, "Oblique")


@pytest.mark.parametrize(("wish", "steps"), [("no-preference", 1000), ("reduce", 20)])
def test_play_goes_through_the_instants_until_it_is_stopped_in_few_pictures_for_who_wants_little_motion(
    page: Page, wish: Any, steps: int
) -> None:
    page.emulate_media(reduced_motion=wish)
    first, count = joints(page), int(slider(page).get_attribute("max") or "") + 1
    page.get_by_role("button", name="Play the motion").first.click()
    until(page, "document.querySelector('.spatial input').value >= 3")
    page.get_by_role("button", name="Stop the motion").click()
    stopped = slider(page).input_value()
    assert int(stopped) % ceil(count / steps) == 0
    assert np.abs(joints(page) - first).max() > 1.0
    page.wait_for_timeout(200)
    assert slider(page).input_value() == stopped
    assert page.get_by_role("button", name="Stop the motion").count() == 0
    assert page.locator(".spatial output").first.inner_text() == slider(page).get_attribute("aria-valuetext")
    slide(page, 0)


def test_a_drag_of_a_quarter_turn_shows_the_car_from_the_right(page: Page) -> None:
    seen_from(page, "Right")
    right = joints(page)
    seen_from(page, "Rear")
    assert np.abs(right - joints(page)).max() > 20.0
    svg = page.locator(".spatial > svg").first
    svg.scroll_into_view_if_needed()
    box = svg.bounding_box()
    assert box is not None
    x, y = box["x"] + 100, box["y"] + 100
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 100, y, steps=3)
    page.mouse.move(x + 157, y, steps=3)
    page.mouse.up()
    page.mouse.move(x, y, steps=3)
    # A pixel turns by 0.01 rad; a quarter turn is 0.08 pixels more than 157.
    assert np.abs(joints(page) - right).max() < 0.0009 * box["width"]
    seen_from(page, "Oblique")


def test_the_arrow_keys_turn_the_drawing_and_back_and_move_the_slider_which_says_its_time(page: Page) -> None:
    first = joints(page)
    page.locator(".spatial > svg").first.focus()
    for key, opposite in (("ArrowRight", "ArrowLeft"), ("ArrowUp", "ArrowDown")):
        for pressed, least, most in ((key, 5.0, np.inf), (opposite, 0.0, 0.011)):
            for _ in range(3):
                page.keyboard.press(pressed)
            assert least <= np.abs(joints(page) - first).max() < most
    slider(page).focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    assert slider(page).input_value() == "2"
    assert slider(page).get_attribute("aria-valuetext") == f"{motion_of(page)['times'][2]:g} s"
    page.keyboard.press("Home")
    assert slider(page).input_value() == "0"


def test_each_model_and_the_names_can_be_taken_away_and_a_point_is_named_where_the_pointer_is(
    page: Page,
) -> None:
    figure = page.locator(".spatial").first
    for name, stroke in (("pointcoord", "tube"), ("absolute", "thread"), ("the drawing", "drawn")):
        box = figure.get_by_role("checkbox", name=name, exact=True)
        lines = figure.locator(f"svg[role=application] .{stroke}").first
        assert lines.is_visible()
        box.uncheck()
        assert not lines.is_visible()
        box.check()
        assert lines.is_visible()
    figure.locator(".names input").uncheck()
    shown = figure.locator("svg > text:visible")
    assert shown.count() == 0
    joint = figure.locator(".joint.chassis").first
    joint.hover(force=True)
    assert shown.count() == 1
    motion = motion_of(page)
    assert shown.first.text_content() in [motion["points"][i] for i in motion["chassis"]]
    page.mouse.move(2, 2)
    assert shown.count() == 0
    figure.locator(".names input").check()


# Names, keys, headings.


def test_everything_that_can_be_used_and_every_picture_has_a_name_and_landmarks_tell_the_page_apart(
    page: Page,
) -> None:
    settled(page, folded=99)
    devices = page.context.new_cdp_session(page)
    nodes = devices.send("Accessibility.getFullAXTree")["nodes"]
    devices.detach()
    found = [
        (node["role"]["value"], node.get("name", {}).get("value", ""))
        for node in nodes
        if not node["ignored"] and "role" in node
    ]
    roles = [role for role, _ in found]
    used = {"button", "link", "checkbox", "slider", "application", "image", "img", "region", "table"}
    assert {"button", "link", "checkbox", "slider", "application"} <= {*roles}
    assert [role for role, name in found if role in used and not name.strip()] == []
    for kind in ("button", "slider", "application"):
        names = [name for role, name in found if role == kind]
        assert len(set(names)) == len(names), kind
    pictures = [name for role, name in found if role in ("image", "img")]
    assert len(pictures) >= page.locator("[data-plot]:visible").count() > 10
    assert all(" from " in name for name in pictures)
    assert [roles.count(name) for name in ("banner", "navigation", "main", "contentinfo")] == [1] * 4
    levels = page.locator("h1, h2, h3, h4").evaluate_all("all => all.map((one) => Number(one.tagName[1]))")
    assert (levels[0], levels.count(1)) == (1, 1)
    assert all(after - before <= 1 for before, after in pairwise(levels))
    assert page.locator("html").get_attribute("lang") == "en"
    links = page.locator("a[href^='#']")
    assert all(links.evaluate_all("all => all.map((a) => document.querySelector(a.hash) !== null)"))


def test_every_control_is_reached_by_the_tab_key_and_shows_it(page: Page) -> None:
    settled(page)
    wanted = page.evaluate(
        """() => {
            const all = [...document.querySelectorAll("a[href], button, input, summary, [tabindex='0']")]
                .filter((one) => one.checkVisibility());
            all.forEach((one, i) => { one.dataset.stop = i; });
            return all.length;
        }"""
    )
    page.evaluate("document.activeElement.blur(); getSelection().removeAllRanges(); scrollTo(0, 0)")
    reached, faint = set(), []
    for _ in range(wanted + 2):
        page.keyboard.press("Tab")
        stop, width = page.evaluate(
            """() => {
                const one = document.activeElement, style = getComputedStyle(one);
                return [one.dataset.stop, style.outlineStyle === "none" ? 0 : parseFloat(style.outlineWidth)];
            }"""
        )
        if stop is not None:
            reached.add(int(stop))
            if width < 2:
                faint.append(stop)
    assert reached == set(range(wanted))
    assert faint == []


def test_the_first_tab_leads_past_the_list_of_sections(page: Page) -> None:
    page.reload()
    skip = page.get_by_role("link", name="Skip to the report")
    page.keyboard.press("Tab")
    box = skip.bounding_box()
    assert box is not None
    assert box["y"] >= 0
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "main"
    page.evaluate("history.replaceState(null, '', location.pathname)")


# Colours.


def require_contrast(found: Any) -> None:
    assert len(found["text"]) > 500
    assert len(found["line"]) > 100
    assert found["cells"] > 20
    assert [one for one in found["text"] if one[0] < TEXT] == []
    assert [one for one in found["line"] if one[0] < LINES] == []


@pytest.mark.parametrize(("scheme", "behind"), [("light", (255, 255, 255)), ("dark", (22, 24, 27))])
def test_text_and_lines_stand_out_of_what_is_behind_them(page: Page, scheme: Any, behind: Any) -> None:
    page.emulate_media(color_scheme=scheme)
    settled(page)
    require_contrast(page.evaluate(SCRIPTS["contrast"]))
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == f"rgb{behind}"


# Windows, phones and paper.


@pytest.mark.parametrize("size", [WINDOW, PHONE], ids=["window", "phone"])
def test_nothing_is_wider_than_the_window_and_no_label_is_cut(page: Page, size: Any) -> None:
    page.set_viewport_size(size)
    settled(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
    assert page.evaluate(SCRIPTS["outside"]) == page.evaluate(SCRIPTS["cut"]) == []


def test_a_table_wider_than_a_phone_says_so_until_its_end_is_seen(page: Page) -> None:
    page.set_viewport_size(PHONE)
    page.locator("#agreement details").evaluate_all("all => all.forEach((one) => { one.open = true; })")
    table = page.locator("#agreement .scroll")
    hint = page.locator("#agreement .hint")
    table.scroll_into_view_if_needed()
    until(page, "document.querySelector('#agreement .more-right')")
    assert hint.is_visible()
    table.evaluate("(one) => { one.scrollLeft = one.scrollWidth; }")
    until(page, "document.querySelector('#agreement .more-left:not(.more-right)')")
    table.evaluate("(one) => { one.scrollLeft = 0; }")
    page.set_viewport_size({"width": 2000, "height": 900})
    until(page, "document.querySelector('#agreement .hint').hidden")
    assert not hint.is_visible()


def test_on_a_phone_every_entry_of_a_long_legend_is_seen(browser: Browser, tmp_path: Path) -> None:
    rows = tuple(
        row
        for k, way in enumerate(WAYS)
        for row in measured("bounce", way.name, "a", {"position": 10.0**-k}, 1e-5)
    )
    run = Run(Head.of("cost", ("pointcoord", "cost")), cost=Report("rows", "", rows))
    (tmp_path / "index.html").write_text(page_of(run, {}), encoding="utf-8")
    phone = opened(browser, tmp_path, viewport=PHONE)
    settled(phone.page)
    shown = phone.page.evaluate(SCRIPTS["legend_shown"])
    phone.page.context.close()
    assert sorted(shown) == sorted(way.name for way in WAYS)
    assert phone.complaints == []


def test_paper_shows_all_of_it_in_ink_on_white_and_in_plots_no_wider_than_their_places(page: Page) -> None:
    settled(page)
    first = page.locator("details[open]").count()
    page.set_viewport_size(PAPER)
    page.emulate_media(media="print", color_scheme="dark")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    plots = page.evaluate(SCRIPTS["plots_within"])
    cut = page.evaluate(SCRIPTS["cut"])
    contrast = page.evaluate(SCRIPTS["contrast"])
    behind = page.evaluate("getComputedStyle(document.body).backgroundColor")
    shown = [page.locator(one).first.is_visible() for one in ("nav", ".play", ".spatial input")]
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert len(plots) > 20
    assert all(plots)
    assert cut == []
    assert shown == [False, False, False]
    assert behind == "rgb(255, 255, 255)"
    require_contrast(contrast)
    assert page.locator("details[open]").count() == first


def test_a_finger_that_moves_up_over_a_drawing_or_a_plot_moves_the_page(
    browser: Browser, report: Opened
) -> None:
    phone = opened(browser, report.folder, viewport=PHONE, has_touch=True, is_mobile=True)
    devices = phone.page.context.new_cdp_session(phone.page)
    for place in (".spatial > svg", "[data-plot]"):
        one = phone.page.locator(place).first
        one.evaluate("(one) => one.scrollIntoView({ block: 'center' })")
        if place != ".spatial > svg":
            one.locator(".main-svg").first.wait_for()
        before = phone.page.evaluate("scrollY")
        box = one.bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        devices.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]})
        for up in range(20, 201, 20):
            moved = {"type": "touchMove", "touchPoints": [{"x": x, "y": y - up}]}
            devices.send("Input.dispatchTouchEvent", moved)
        devices.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        until(phone.page, f"scrollY > {before + 100}")
    phone.page.context.close()
    assert phone.complaints == []
