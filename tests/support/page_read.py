"""A page as its readers have it: elements, cells of tables, plots, what is said."""

import json
from html.parser import HTMLParser
from typing import Any


class Read(HTMLParser):
    """What a page holds.

    Attributes:
        tags: its elements with their attributes, in their order.
        rows: of its tables, of each cell class, words with the small print below them, and without.
        verdict: the class of the verdict, and its words without small print.
        scripts: their code. text: all words that are seen.
    """

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[tuple[str, str, str]]] = []
        self.verdict = ("", "")
        self.scripts: list[str] = []
        self.text = ""
        self._into: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.tags.append((tag, given))
        if tag == "tr":
            self.rows.append([])
        elif tag in ("th", "td"):
            self.rows[-1].append((given.get("class") or "", "", ""))
        elif tag == "script":
            self.scripts.append("")
        status = tag == "p" and given.get("role") == "status"
        if status:
            self.verdict = (given.get("class") or "", "")
        if tag in ("th", "td", "p", "script", "style", "small"):
            self._into.append("verdict" if status else tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in ("th", "td", "p", "script", "style", "small"):
            self._into.pop()

    def handle_data(self, data: str) -> None:
        into = self._into[-1] if self._into else ""
        if {"th", "td"} & {*self._into}:
            kind, every, words = self.rows[-1][-1]
            self.rows[-1][-1] = (kind, every + data, words if into == "small" else words + data)
        elif into == "verdict":
            self.verdict = (self.verdict[0], self.verdict[1] + data)
        elif into == "script":
            self.scripts[-1] += data
        if into not in ("script", "style"):
            self.text += data

    @property
    def cells(self) -> list[list[str]]:
        """The words of the tables, with the small print."""
        return [[every for _, every, _ in row] for row in self.rows]

    @property
    def words(self) -> list[list[str]]:
        """The words of the tables, without the small print."""
        return [[words for _, _, words in row] for row in self.rows]

    def of(self, name: str) -> list[list[tuple[str, str]]]:
        """Class and words of the cells of rows that begin with a name."""
        rows = ([(kind, every) for kind, every, _ in row] for row in self.rows)
        return [row for row in rows if row and row[0][1].startswith(name)]

    @property
    def plots(self) -> list[tuple[str, dict[str, Any]]]:
        """Of each plot what a screen reader says, and what plotly draws."""
        return [
            (given["aria-label"] or "", json.loads(given["data-plot"] or ""))
            for given in self._with("data-plot")
        ]

    @property
    def by_words(self) -> dict[str, dict[str, Any]]:
        """The plots by what a screen reader says."""
        return dict(self.plots)

    @property
    def motions(self) -> list[dict[str, Any]]:
        """The drawings that move."""
        return [json.loads(given["data-motion"] or "") for given in self._with("data-motion")]

    def _with(self, attribute: str) -> list[dict[str, str | None]]:
        return [given for _, given in self.tags if attribute in given]
