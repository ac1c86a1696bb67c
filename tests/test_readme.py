"""What the README shows is what its commands print."""

import contextlib
import io
import re
from pathlib import Path

import numpy as np
import pytest

from pointcoord import Scene
from validate.commands.topics import TOPICS
from validate.comparison.compare import compare

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = sorted(
    page.relative_to(ROOT).as_posix()
    for folder in (".", "pointcoord", "validate")
    for page in (ROOT / folder).glob("README.md" if folder == "." else "**/README.md")
)


@pytest.mark.parametrize("page", ["README.md", "pointcoord/README.md"])
def test_the_python_lines_print_what_a_page_shows(page: str) -> None:
    blocks = re.findall(
        r"```(?:python|text)\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), flags=re.S
    )
    printed, names = io.StringIO(), {}
    with contextlib.redirect_stdout(printed):
        for code in blocks[::2]:
            exec(compile(code, page, "exec"), names)
    lines, expected = printed.getvalue().splitlines(), "".join(blocks[1::2]).splitlines()
    assert len(lines) == len(expected)
    for line, want in zip(lines, expected, strict=True):
        numbers = [[float(n) for n in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text)] for text in (line, want)]
        # Eight decimals are shown.
        np.testing.assert_allclose(*numbers, rtol=0, atol=1.01e-8)
        assert re.sub(r"[-\d. \[\]]", "", line) == re.sub(r"[-\d. \[\]]", "", want)


@pytest.mark.parametrize(
    "scene", re.findall(r"^\| quantity \| (.*?) \| the other", README, flags=re.M)[0].split(" | ")
)
def test_the_agreement_table_is_what_the_comparison_finds(scene: str) -> None:
    (agreement,) = re.findall(r"^\| quantity \|.*?\n\n", README, flags=re.S | re.M)
    head, _, *body = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in agreement.strip().splitlines()
    ]
    outcome = compare(Scene.load(scene), "pointcoord", "absolute", scene)
    for line in body:
        name = line[0].split(",")[0].replace(" ", "_")
        rows = [row for row in outcome.rows if name in (row.quantity, row.name.rpartition(".")[2])]
        assert bool(rows) == bool(line[head.index(scene)])
        if not rows:
            continue
        shown = float(line[head.index(scene)])
        found = max(row.difference for row in rows)
        # Differences are rounding: another machine rounds otherwise, but not by an order of magnitude.
        assert shown / 10 < found < shown * 10
        # A tolerance is known at the instant of the largest difference, which rounding may move.
        assert max(row.tolerance for row in rows) < 1.5 * float(line[-1])


def test_the_readme_can_be_read_in_a_minute_or_two() -> None:
    assert len(README.splitlines()) <= 150


@pytest.mark.parametrize("page", PAGES)
def test_links_between_pages_lead_somewhere(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", text):
        assert target.startswith("http") or ((ROOT / page).parent / target).exists(), target


def test_every_page_is_reached_from_the_readme_and_printed_by_help() -> None:
    assert {*PAGES} <= {"README.md", *re.findall(r"\]\(([^)#]+\.md)", README)}
    assert {f"{folder}/README.md" for folder in TOPICS.values()} == {*PAGES} - {"README.md"}
