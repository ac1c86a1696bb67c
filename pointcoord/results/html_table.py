"""A result as a notebook shows it: a table of HTML in which no text acts."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape


def html_table(caption: str, head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table under its caption.

    >>> html_table("<a>", ["x"], [["1"]])
    '<table><caption>&lt;a&gt;</caption><tr><th>x</th></tr><tr><td>1</td></tr></table>'
    """
    lines = ["".join(f"<th>{escape(name)}</th>" for name in head)]
    lines += ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    return (
        f"<table><caption>{escape(caption)}</caption>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"
    )
