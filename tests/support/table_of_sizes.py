"""How many lines of Python each room has, and what they are, as a table in Markdown.

python -m tests.support.table_of_sizes
"""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[2]
KINDS = ("code", "imports", "docstrings", "comments, blank")


def lines_of(path: Path) -> Counter[str]:
    """How many lines of a file are of each kind."""
    text = path.read_text(encoding="utf-8")
    stripped = (line.strip() for line in text.splitlines())
    kinds = ["code" if line and not line.startswith("#") else "comments, blank" for line in stripped]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            kind = "imports"
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            kind = "docstrings"
        else:
            continue
        assert node.end_lineno is not None
        kinds[node.lineno - 1 : node.end_lineno] = [kind] * (node.end_lineno - node.lineno + 1)
    return Counter(kinds)


def rooms() -> dict[str, Counter[str]]:
    """The lines of each package, of each of its rooms, and of the tests."""
    found: dict[str, Counter[str]] = {}
    for package in ("pointcoord", "absolute", "validate", "tests"):
        for path in sorted((ROOT / package).rglob("*.py")):
            lines, parts = lines_of(path), path.relative_to(ROOT).parts
            found.setdefault(package, Counter()).update(lines)
            if package in ("pointcoord", "validate"):
                room = f"{package}/{parts[1]}" if len(parts) > 2 else f"{package}, its own files"
                found.setdefault(room, Counter()).update(lines)
    return found


if __name__ == "__main__":
    print(f"| room | lines | {' | '.join(KINDS)} |")
    print("|---" * (len(KINDS) + 2) + "|")
    for room, counted in rooms().items():
        cells = (f"{number:,}" for number in (counted.total(), *(counted[kind] for kind in KINDS)))
        print(f"| {room} | {' | '.join(cells)} |")
