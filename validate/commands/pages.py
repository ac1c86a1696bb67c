"""The pages in `help/`: what a command does, and what it takes; `usage.Command` makes its options of them."""

from __future__ import annotations

import re
from pathlib import Path

PAGES = Path(__file__).with_name("help")


def page(name: str) -> tuple[str, str, str]:
    """The page of a command in `help/`: what it does in a line, its description, its options.

    A line `<name>` stands for the part of that name of `shared.txt`.
    """
    names_and_parts = re.split(r"^\[(\w+)\]\n", _read("shared"), flags=re.M)[1:]
    shared = dict(zip(names_and_parts[::2], names_and_parts[1::2], strict=True))
    text = _read(name)
    while (whole := re.sub(r"^<(\w+)>\n", lambda found: shared[found[1]], text, flags=re.M)) != text:
        text = whole
    head, _, options = text.partition("\noptions:\n")
    summary, _, description = head.partition("\n")
    return summary, description.strip(), options.strip()


def _read(name: str) -> str:
    return (PAGES / f"{name}.txt").read_text(encoding="utf-8")
