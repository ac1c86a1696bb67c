"""A drawing as a picture: three views of the hardpoints, as drawn and as closed, in one SVG file.

For someone who has written hardpoints into a scene file: the picture shows a wrong sign, axis or side before
anything is solved. The views are from behind, from the left and from above. What is joined to what comes from
the topology.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from textwrap import wrap
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.topology import Topology
from validate.closed_drawing import ClosedDrawing

Array = NDArray[np.float64]
Places = Mapping[str, Array]

VIEW = 290.0  # px, side of the square that a view is scaled into
MARGIN = 30.0
LINE = 15.0  # px, from line to line of text
LETTERS = 150  # to a line
LETTER = 6.5  # px, wide
TOGETHER = 9.0  # px: points closer than that have one number
CLEAR = 16.0  # px: a number so far from every other point and number is clear enough
# Where a number may stand beside its point, to the right and down, the first that is clear.
AROUND = ((1, -1), (1, 0), (1, 1), (0, -1), (0, 1), (-1, -1), (-1, 0), (-1, 1))
KEY = (
    "blue: as drawn; red: as closed, where that differs by a pixel; filled: on the chassis; "
    "dashed: steering axis and spin axis"
)
STYLE = """
text { font: 11px sans-serif; fill: #222 }
.title { font-size: 13px; font-weight: bold }
.member { stroke: #3b6ea5; stroke-width: 2.5; stroke-linecap: round }
.closed { stroke: #c44e2b; stroke-width: 1 }
.axis { stroke: #888; stroke-width: 1; stroke-dasharray: 7 4 }
.body { fill: #3b6ea5; fill-opacity: 0.15; stroke: none }
.chassis { fill: #222 }
.moving { fill: #fff; stroke: #222; stroke-width: 1.5 }
.number { text-anchor: middle; paint-order: stroke; stroke: #fff; stroke-width: 3px }
.frame { fill: none; stroke: #ddd }
"""


@dataclass(frozen=True)
class View:
    """A direction to look along: the car's axes that point right and up on the paper."""

    title: str
    right: Array
    up: Array


def svg(drawing: ClosedDrawing) -> str:
    """The picture of a scene's drawing; what closing moves by more than a pixel is drawn a second time."""
    scene, topology = drawing.scene, drawing.mechanism.topology
    points = {name: np.array(scene.mechanism.points[name]) for name in topology.points}
    numbers = {name: str(i) for i, name in enumerate(points, 1)}
    width, top = 3 * VIEW + 4 * MARGIN, 2 * LINE + MARGIN
    lines = [
        f"{numbers[name]}  {name}: {', '.join(f'{c:.6g}' for c in place)} mm"
        f"{' (on the chassis)' if name in topology.chassis else ''}"
        for name, place in points.items()
    ]
    rows, below_lines = -(-len(lines) // 2), wrap(drawing.words, LETTERS)
    height = top + VIEW + MARGIN + (rows + len(below_lines) + 3) * LINE
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}">',
        f'<style>{STYLE}</style><rect width="100%" height="100%" fill="#fff"/>',
        _text(MARGIN, 1.5 * LINE, scene.title or "scene", "title"),
    ]
    up, right = np.array(scene.mechanism.up), np.array(scene.mechanism.right)
    rearward = np.cross(right, up)
    views = (
        View(f"from behind: {_named(right)} right, {_named(up)} up", right, up),
        View(f"from the left: {_named(rearward)} right, {_named(up)} up", rearward, up),
        View(f"from above: {_named(right)} right, {_named(rearward)} down", right, -rearward),
    )
    # One scale for all views, so that lengths can be compared between them.
    scale = VIEW / max(float(np.ptp([p @ a for p in points.values()])) for a in (right, up, rearward))
    for i, view in enumerate(views):
        corner = (MARGIN + i * (VIEW + MARGIN), top)
        parts += _view(view, corner, scale, topology, points, drawing.places, numbers)
    below = top + VIEW + MARGIN + LINE
    for i, line in enumerate(lines):
        parts.append(_text(MARGIN + (i // rows) * width / 2, below + (i % rows) * LINE, line))
    below_lines = [KEY, *below_lines]
    for i, line in enumerate(below_lines):
        parts.append(_text(MARGIN, below + (rows + 0.5 + i) * LINE, line))
    return "\n".join([*parts, "</svg>", ""])


def _named(direction: Array) -> str:
    """A direction of the car in the axes that its points are given in: +y, -x, or its three components."""
    along = np.flatnonzero(direction)
    if len(along) == 1:
        return f"{'+' if direction[along[0]] > 0.0 else '-'}{'xyz'[along[0]]}"
    return f"({', '.join(f'{c:.3g}' for c in direction)})"


def _view(
    view: View,
    corner: tuple[float, float],
    scale: float,
    topology: Topology,
    points: Places,
    closed: Places,
    numbers: Mapping[str, str],
) -> list[str]:
    flat = {name: np.array([p @ view.right, -(p @ view.up)]) for name, p in points.items()}
    middle = 0.5 * (np.min(list(flat.values()), axis=0) + np.max(list(flat.values()), axis=0))
    centre = np.array(corner) + 0.5 * VIEW

    def at(place: Array) -> Array:
        return np.asarray(centre + scale * (np.array([place @ view.right, -(place @ view.up)]) - middle))

    drawn = {name: at(p) for name, p in points.items()}
    moved = {name: at(p) for name, p in closed.items()}
    room = 0.45 * MARGIN
    parts = [
        f'<rect class="frame" x="{corner[0] - room:.1f}" y="{corner[1] - room:.1f}" '
        f'width="{VIEW + 2 * room:.1f}" height="{VIEW + 2 * room:.1f}"/>',
        _text(corner[0] - room, corner[1] - room - 4, view.title),
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
    frame = np.array(corner) + np.array([[-room, -room], [VIEW + room, VIEW + room]])
    return parts + [_text(x, y, text, "number") for x, y, text in _labels(drawn, numbers, frame)]


def _labels(
    drawn: Mapping[str, Array], numbers: Mapping[str, str], frame: Array
) -> list[tuple[float, float, str]]:
    """A number beside every point, where there is room; points that fall together on the paper share one."""
    groups: list[tuple[Array, list[str]]] = []
    for name, place in drawn.items():
        for other, together in groups:
            if np.abs(other - place).max() < TOGETHER:
                together.append(numbers[name])
                break
        else:
            groups.append((place, [numbers[name]]))
    found: list[tuple[float, float, str]] = []
    taken = list(drawn.values())
    for place, together in groups:
        text = ", ".join(together)
        wide = LETTER * len(text)
        around = place + np.array(AROUND) * np.array([6.0 + 0.5 * wide, 11.0])
        half = np.array([0.5 * wide, 6.0])
        others = np.array([other for other in taken if np.abs(other - place).max() >= TOGETHER])
        others = others.reshape(-1, 2)  # none where all points fall together
        # A number is wider than it is high, and reaches further to its sides.
        away = np.linalg.norm((around[:, None] - others) / (1.0 + half / 20.0), axis=-1)
        clear = np.minimum(away.min(axis=1, initial=CLEAR), CLEAR)
        clear[~((frame[0] <= around - half) & (around + half <= frame[1])).all(axis=1)] = 0.0
        best = around[int(np.argmax(clear))]
        taken.append(best)
        found.append((best[0], best[1] + 4.0, text))
    return found


def _line(kind: str, start: Array, end: Array) -> str:
    (a, b), (c, d) = start, end
    return f'<line class="{kind}" x1="{a:.1f}" y1="{b:.1f}" x2="{c:.1f}" y2="{d:.1f}"/>'


def _text(x: float, y: float, text: str, kind: str = "plain") -> str:
    shown = escape("".join(c if c.isprintable() else " " for c in text))
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}">{shown}</text>'
