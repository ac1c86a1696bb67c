"""Collinear struts drawn far from closing, and what closing makes of them in both models.

python -m tests.support.badly_drawn_struts [COUNT]        a table of how often they agree
"""

import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

import absolute
from pointcoord import Scene, SceneError
from pointcoord.numerics.arrays import Array
from validate.closed_drawing import closed_drawing

Places = Mapping[str, Array]

SEED = 20261123
# Shares of the car's size by which points are moved at most, and the bounds of the table's columns.
SHARES = (0.01, 0.03, 0.1, 0.2, 0.35, 0.5)
# Assemblies are some mm apart at least, but next to a fold; both models claim less than 1e-6 mm elsewhere.
SAME = 1e-3
SAME_PLACE, OTHER_PLACE = "the same assembly", "different assemblies"
ONE, OTHER, NEITHER = "absolute refuses", "pointcoord refuses", "both refuse"
OUTCOMES = (SAME_PLACE, OTHER_PLACE, ONE, OTHER, NEITHER)


@dataclass(frozen=True)
class BadlyDrawn:
    """A scene's content, and by which share of the car's size its points are moved at most."""

    share: float
    content: dict[str, Any]


def badly_drawn(number: int) -> BadlyDrawn:
    """The scene `bounce` with every point moved; half of them of another car, whose points are moved by up to
    a tenth of its size first and whose strut is put on its line."""
    rng = np.random.default_rng([SEED, number])
    content = Scene.load("bounce").model_dump(exclude_none=True)
    points = {name: np.array(place, float) for name, place in content["mechanism"]["points"].items()}
    size = float(np.ptp(np.array(list(points.values())), axis=0).max())
    share = 10.0 ** rng.uniform(*np.log10([SHARES[0], SHARES[-1]]))
    if rng.random() < 0.5:
        points = {name: place + rng.uniform(-0.1, 0.1, 3) * size for name, place in points.items()}
        ball, line = points["lower_ball_joint"], points["strut_top"] - points["lower_ball_joint"]
        for name in ("strut_lower", "strut_rod_end"):
            points[name] = ball + (points[name] - ball) @ line / (line @ line) * line
        points["rack_centre"][[0, 2]] = points["tie_rod_inner"][[0, 2]]
    moved = {n: (place + rng.uniform(-share, share, 3) * size).tolist() for n, place in points.items()}
    content["mechanism"]["points"] = moved
    content["time"] = {"start": 0.0, "stop": 0.1, "samples": 2}
    return BadlyDrawn(share, content)


def closed_by_pointcoord(scene: Scene) -> Places | None:
    """Where its points are; None where it refuses."""
    try:
        return closed_drawing(scene).places or None
    except SceneError:
        return None


def closed_by_absolute(scene: Scene) -> Places | None:
    """Where its points are; None where it refuses."""
    try:
        closed = absolute.close_drawing(absolute.compile(scene.mechanism.plain(tuple(scene.inputs))))
    except absolute.AbsoluteError:
        return None
    return dict(closed.position)


def outcome(drawn: BadlyDrawn) -> str:
    """One of `OUTCOMES`; a drawing that is no scene, as with its wheel inboard, is refused by both."""
    try:
        scene = Scene.from_mapping(drawn.content)
    except SceneError:
        return NEITHER
    ours, theirs = closed_by_pointcoord(scene), closed_by_absolute(scene)
    if ours is None or theirs is None:
        return NEITHER if ours is theirs else ONE if theirs is None else OTHER
    apart = max(float(np.abs(ours[name] - theirs[name]).max()) for name in ours)
    return SAME_PLACE if apart < SAME else OTHER_PLACE


def table(count: int) -> str:
    """How often each outcome is met, by how far points are moved, as Markdown."""
    found = Counter[tuple[str, int]]()
    for drawn in map(badly_drawn, range(count)):
        column = int(np.searchsorted(SHARES, drawn.share)) - 1
        found[outcome(drawn), column] += 1
    columns = range(len(SHARES) - 1)
    heads = [f"{100 * a:.3g} to {100 * b:.3g} %" for a, b in pairwise(SHARES)]
    lines = [f"| points moved by up to | {' | '.join(heads)} | all |", "|---" * (len(heads) + 2) + "|"]
    for name in OUTCOMES:
        counts = [found[name, column] for column in columns]
        lines.append(f"| {name} | {' | '.join(map(str, counts))} | {sum(counts)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table(int(sys.argv[1]) if len(sys.argv) > 1 else 3000))
