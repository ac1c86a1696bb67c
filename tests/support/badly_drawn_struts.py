"""Collinear struts drawn far from closing, and what closing makes of them in both models.

python -m tests.support.badly_drawn_struts [COUNT]        a table of how often they agree
"""

import sys
from collections import Counter
from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np

import absolute
from pointcoord import Scene, SceneError
from validate.closed_drawing import closed_drawing

SEED = 20261123
# Shares of the car's size by which points are moved at most, and the bounds of the table's columns.
SHARES = (0.01, 0.03, 0.1, 0.2, 0.35, 0.5)
# Assemblies are some mm apart at least, but next to a fold; both models claim less than 1e-6 mm elsewhere.
SAME = 1e-3
SAME_PLACE, OTHER_PLACE = "the same assembly", "different assemblies"
ONE, OTHER, NEITHER = "absolute refuses", "pointcoord refuses", "both refuse"
OUTCOMES = (SAME_PLACE, OTHER_PLACE, ONE, OTHER, NEITHER)


def badly_drawn(number: int) -> tuple[float, dict[str, Any]]:
    """By which share of its size the points of a car are moved at most, and the scene's content.

    The car is that of the scene `bounce`; half of them are another one, whose points are moved by up to a
    tenth of its size first and whose strut is put on its line.
    """
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
    return share, content


def outcome(drawn: tuple[float, dict[str, Any]]) -> str:
    """One of `OUTCOMES`; a drawing that is no scene, as with its wheel inboard, is refused by both."""
    ours = theirs = None
    try:
        scene = Scene.from_mapping(drawn[1])
    except SceneError:
        return NEITHER
    with suppress(SceneError):
        ours = closed_drawing(scene).places
    with suppress(absolute.AbsoluteError):
        plain = scene.mechanism.plain(tuple(scene.inputs))
        theirs = absolute.close_drawing(absolute.compile(plain)).position
    if not (ours and theirs):
        return OTHER if theirs else ONE if ours else NEITHER
    apart = max(float(np.abs(ours[name] - theirs[name]).max()) for name in ours)
    return SAME_PLACE if apart < SAME else OTHER_PLACE


def table(count: int) -> str:
    """How often each outcome is met, by how far points are moved, as Markdown."""
    found = Counter[tuple[str, int]]()
    for drawn in map(badly_drawn, range(count)):
        found[outcome(drawn), int(np.searchsorted(SHARES, drawn[0])) - 1] += 1
    columns = range(len(SHARES) - 1)
    heads = [f"{100 * a:.3g} to {100 * b:.3g} %" for a, b in pairwise(SHARES)]
    lines = [f"| points moved by up to | {' | '.join(heads)} | all |", "|---" * (len(heads) + 2) + "|"]
    for name in OUTCOMES:
        counts = [found[name, column] for column in columns]
        lines.append(f"| {name} | {' | '.join(map(str, counts))} | {sum(counts)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table(int(sys.argv[1]) if len(sys.argv) > 1 else 3000))
