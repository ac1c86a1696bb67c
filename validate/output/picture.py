"""A picture of a drawing: three views of the hardpoints, as drawn and as closed, in one SVG file.

It shows a wrong sign, axis or side of a hardpoint before a motion is solved. The views are from behind, from
the left and from above. The lines between points come from the topology.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import wrap
from xml.sax.saxutils import escape

import numpy as np

from pointcoord.linkage.topology import Topology
from validate.arrays import Array
from validate.closed_drawing import ClosedDrawing

Places = Mapping[str, Array]

VIEW = 290.0  # px, side of the square that a view is scaled into
MARGIN = 30.0
LINE = 15.0  # px, from line to line of text
LETTERS = 150  # characters in a line of text
LETTER = 6.5  # px, width of a character
TOGETHER = 9.0  # px: points closer than this share one label
CLEAR = 16.0  # px: a label at this distance from every other point and label is clear enough
# Positions of a label relative to its point, right and down, in order of preference.
AROUND = ((1, -1), (1, 0), (1, 1), (0, -1), (0, 1), (-1, -1), (-1, 0), (-1, 1))
KEY = (
    "blue: as drawn; red: as closed, where that differs by a pixel; filled: on the chassis; "
    "dashed: steering axis and spin axis"
)
STYLE = Path(__file__).with_name("picture.css")


def svg(drawing: ClosedDrawing) -> str:
    """The picture of a drawing. If closing moves a point by more than a pixel, both states are drawn."""
    part, topology = drawing.scene.mechanism, drawing.mechanism.topology
    points = {name: np.array(part.points[name]) for name in topology.points}
    width, top = 3 * VIEW + 4 * MARGIN, 2 * LINE + MARGIN
    lines = [
        f"{i}  {name}: {', '.join(f'{c:.6g}' for c in place)} mm"
        f"{' (on the chassis)' if name in topology.chassis else ''}"
        for i, (name, place) in enumerate(points.items(), 1)
    ]
    rows, below_lines = -(-len(lines) // 2), [KEY, *wrap(drawing.words, LETTERS)]
    below = top + VIEW + MARGIN + LINE
    height = below + (rows + len(below_lines) + 1) * LINE
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}">',
        f'<style>\n{STYLE.read_text(encoding="utf-8")}</style><rect width="100%" height="100%" fill="#fff"/>',
        _text(MARGIN, 1.5 * LINE, drawing.scene.title or "scene", "title"),
    ]
    up, right = np.array(part.up), np.array(part.right)
    rearward = np.cross(right, up)
    # The title of each view, and the directions of the car that point right and down on the paper.
    views = (
        (f"from behind: {_named(right)} right, {_named(up)} up", right, -up),
        (f"from the left: {_named(rearward)} right, {_named(up)} up", rearward, -up),
        (f"from above: {_named(right)} right, {_named(rearward)} down", right, rearward),
    )
    # One scale for all views, so that lengths can be compared between them.
    scale = VIEW / max(float(np.ptp([p @ a for p in points.values()])) for a in (right, up, rearward))
    for i, (title, *axes) in enumerate(views):
        drawn, closed = ({n: scale * (axes @ p) for n, p in of.items()} for of in (points, drawing.places))
        corner = np.array([MARGIN + i * (VIEW + MARGIN), top])
        ends = np.min([*drawn.values()], axis=0), np.max([*drawn.values()], axis=0)
        shift = corner + 0.5 * VIEW - np.mean(ends, axis=0)
        moved = ({n: shift + place for n, place in of.items()} for of in (drawn, closed))
        parts += _view(title, corner, topology, *moved)
    for i, line in enumerate(lines):
        parts.append(_text(MARGIN + (i // rows) * width / 2, below + (i % rows) * LINE, line))
    for i, line in enumerate(below_lines):
        parts.append(_text(MARGIN, below + (rows + 0.5 + i) * LINE, line))
    return "\n".join([*parts, "</svg>", ""])


def _named(direction: Array) -> str:
    """A direction in the axes of the scene's points: +y, -x, or its three components."""
    along = np.flatnonzero(direction)
    if len(along) == 1:
        return f"{'+' if direction[along[0]] > 0.0 else '-'}{'xyz'[along[0]]}"
    return f"({', '.join(f'{c:.3g}' for c in direction)})"


def _view(title: str, corner: Array, topology: Topology, drawn: Places, moved: Places) -> list[str]:
    """A view in its frame, from the positions of the points on the paper, (2,), as drawn and as closed."""
    room = 0.45 * MARGIN
    frame = corner + np.array([[-room, -room], [VIEW + room, VIEW + room]])
    (x, y), (side, _) = frame[0], frame[1] - frame[0]
    parts = [
        f'<rect class="frame" x="{x:.1f}" y="{y:.1f}" width="{side:.1f}" height="{side:.1f}"/>',
        _text(x, y - 4, title),
    ]
    for body in topology.bodies.values():
        ends = " ".join(f"{x:.1f},{y:.1f}" for x, y in (drawn[name] for name in body))
        parts.append(f'<polygon class="body" points="{ends}"/>')
    lines = (ends for role, ends in topology.roles.items() if role.rpartition(".")[2].endswith("_axis"))
    parts += [_line("axis", drawn[a], drawn[b]) for a, b in lines]
    segments = [ends for constraint in topology.constraints for ends in constraint.segments]
    parts += [_line("member", drawn[a], drawn[b]) for a, b in segments]
    if any(np.abs(moved[name] - drawn[name]).max() > 1.0 for name in moved):
        parts += [_line("closed", moved[a], moved[b]) for a, b in segments]
    for name, (x, y) in drawn.items():
        kind = "chassis" if name in topology.chassis else "moving"
        parts.append(f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="3"/>')
    return [*parts, *_labels(drawn, frame)]


def _labels(drawn: Places, frame: Array) -> Iterator[str]:
    """A label next to every point, where there is room; points that coincide on the paper share a label."""
    groups: list[tuple[Array, list[str]]] = []
    for i, place in enumerate(drawn.values(), 1):
        near = (together for other, together in groups if np.abs(other - place).max() < TOGETHER)
        if (together := next(near, None)) is not None:
            together.append(str(i))
        else:
            groups.append((place, [str(i)]))
    taken = list(drawn.values())
    for place, together in groups:
        text = ", ".join(together)
        half = np.array([0.5 * LETTER * len(text), 6.0])
        around = place + np.array(AROUND) * np.array([6.0 + half[0], 11.0])
        others = np.array([other for other in taken if np.abs(other - place).max() >= TOGETHER])
        others = others.reshape(-1, 2)  # empty if all points coincide
        # A label is wider than high, so distances to its sides count less.
        away = np.linalg.norm((around[:, None] - others) / (1.0 + half / 20.0), axis=-1)
        clear = np.minimum(away.min(axis=1, initial=CLEAR), CLEAR)
        clear[~((frame[0] <= around - half) & (around + half <= frame[1])).all(axis=1)] = 0.0
        best = around[int(np.argmax(clear))]
        taken.append(best)
        yield _text(best[0], best[1] + 4.0, text, "number")


def _line(kind: str, start: Array, end: Array) -> str:
    (a, b), (c, d) = start, end
    return f'<line class="{kind}" x1="{a:.1f}" y1="{b:.1f}" x2="{c:.1f}" y2="{d:.1f}"/>'


def _text(x: float, y: float, text: str, kind: str = "plain") -> str:
    shown = escape("".join(c if c.isprintable() else " " for c in text))
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}">{shown}</text>'
