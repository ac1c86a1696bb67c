"""A hardpoint misread: the coordinates of the drawing that make our numbers theirs, and by how much.

One coordinate first, then two, then the three of a point. With J how the numbers change with each coordinate
of the drawing (differences of solved designs, once for the car), least squares of J a = theirs - ours picks
the likeliest; their amounts are found by solving the corrected designs. A point that another one stands in
for, as the tie rod's inner end does for the rack's centre, is misread with it or alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache, partial
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, Sweep, sweep
from pointcoord.linkage.car_axes import Direction
from validate.diagnosis.evidence import Evidence, Row, Solved, kind_of, order
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.least import LIKELY, Fit, fitted
from validate.diagnosis.other_car import Change, Content, by_what_tells, gives, supposed

Array = NDArray[np.float64]
Coordinate = tuple[str, ...]
"""Of a point, such as `tie_rod_outer.z`, and of the points that are read with it."""
Chosen = tuple[Coordinate, ...]

STEP = 0.05  # mm, of the differences
SAME = 1e-9  # of a scene's time: instants that are counted from another start are rounded otherwise
MOST_INSTANTS = 25  # that amounts are found from
LIKELIEST = 4  # of each number of coordinates
# How many times what the best choice leaves another may leave.
POORER = 30.0
# Of the car's size: what is read wrongly by more is another car, and whether it closes takes long to find.
FARTHEST = 0.1
MOST_POINTS = 2  # that are misread each by itself
TOO: Mapping[Direction, str] = {
    "up": "high",
    "down": "low",
    "outboard": "far out",
    "inboard": "far in",
    "rearward": "far back",
    "forward": "far forward",
}


def points_that_rest_elsewhere(evidence: Evidence) -> Iterator[Hypothesis]:
    """A point of the chassis that is given elsewhere than drawn, and otherwise as ours, was misread.

    More than a few that are have something else in common. One of a body that stays as it is drawn counts if
    no other point of a body is wrong.
    """
    topology, drawn = evidence.scene.mechanism.topology, evidence.scene.mechanism.points
    moving = (*topology.moving, *topology.carried)
    wrong = [row for row in evidence.wrong if kind_of(row) == "point" and order(row) == 0]
    rest, moved = ([row for row in wrong if (row[1] in moving) is of_body] for of_body in (False, True))
    if len(moved) == 1 and moved[0][1] in drawn:
        (row,) = moved
        stays = (np.abs(evidence.held[row] - drawn[row[1]]) <= evidence.allowed[row]).all()
        rest += moved if stays else []
    for row in rest if len(rest) <= MOST_POINTS else ():
        gap, allowed = evidence.given[row] - evidence.held[row], evidence.allowed[row].max(axis=0)
        off = [i for i in range(3) if abs(gap[0, i]) > allowed[i]]
        if off and (np.ptp(gap, axis=0) <= 2.0 * allowed).all():
            said = (_said(evidence, (f"{row[1]}.{'xyz'[i]}",), float(gap[0, i])) for i in off)
            there = {row: (evidence.held[row] + gap[0], evidence.rounded(row, gap[0]))}
            yield Hypothesis(row, " and ".join(said), there, len(off), 1.5 + len(off), rests=True)


def misread_hardpoints(evidence: Evidence) -> Iterator[Hypothesis]:
    """The likeliest, of three coordinates at most, or of one where another fault is supposed already."""
    few = _few_instants(evidence.scene)
    at = np.searchsorted(0.5 * (evidence.times[1:] + evidence.times[:-1]), few)
    if np.abs(evidence.times[at] - few).max() <= SAME * np.ptp(evidence.scene.instants):
        there = evidence.at(at)
        yield from by_what_tells(
            evidence, lambda looked, several: _misread(evidence, there, looked, 3 if several else 1)
        )


def _few_instants(scene: Scene) -> Array:
    return scene.instants[:: -(-len(scene.instants) // MOST_INSTANTS)]


def _designs(solved: Solved, chosen: Chosen, amounts: Array) -> Sweep:
    """The car with coordinates drawn so much more, (designs, coordinates), at a few instants."""
    instants = _few_instants(solved.scene)
    time = solved.scene.time.model_copy(update={"stop": float(instants[-1]), "samples": len(instants)})
    mechanism = solved.scene.mechanism
    # A point that is varied, by nothing, does not go along with the one that stands in for it.
    alone = [f"{name}.x" for name in mechanism.topology.stand_ins if name in mechanism.points]
    offsets = {name: np.zeros(len(amounts)) for name in (*alone, *(n for names in chosen for n in names))}
    for names, amount in zip(chosen, amounts.T, strict=True):
        for name in names:
            offsets[name] += amount
    return sweep(solved.fine.model_copy(update={"time": time}), offsets=offsets)


def _numbers(found: Sweep, looked: Sequence[Row]) -> Array:
    """Numbers of designs, (designs, M); NaN of those that cannot be solved."""
    parts = [found.numbers[quantity][name].reshape(len(found), -1) for quantity, name in looked]
    return np.concatenate(parts, axis=1)


@lru_cache(maxsize=1)
def _beside(solved: Solved) -> tuple[Chosen, Sweep]:
    """Every coordinate of the drawing, and the car as drawn and with each a little less.

    Those of a point that others stand at the place of are there with theirs too.
    """
    points = solved.scene.mechanism.points
    with_others: dict[str, list[str]] = {}
    for missing, point in solved.scene.mechanism.topology.stand_ins.items():
        if missing in points and points[missing] == points[point]:
            with_others.setdefault(point, []).append(missing)
    together = [(point, *others) for point, others in with_others.items()]
    names = tuple(
        tuple(f"{name}.{axis}" for name in some)
        for some in (*together, *((point,) for point in points))
        for axis in "xyz"
    )
    less = np.concatenate([np.zeros((1, len(names))), -STEP * np.eye(len(names))])
    return names, _designs(solved, names, less)


def _misread(evidence: Evidence, few: Evidence, looked: Sequence[Row], most: int) -> list[Hypothesis]:
    """The likeliest by some numbers, with more coordinates, `most` at most, only where fewer do not do.

    Args:
        few: the same at the instants that designs are solved at.
    """
    theirs, off = few.joined(looked)
    if not np.isfinite(theirs).all():
        return []
    names, beside = _beside(evidence.solved)
    ours, *less = _numbers(beside, looked)
    slopes = (ours - np.array(less)) / STEP
    usable = np.isfinite(slopes).all(axis=1) & (np.abs(slopes).max(axis=1) > 0.0)
    names = tuple(name for name, use in zip(names, usable, strict=True) if use)
    slopes, gap = slopes[usable], np.concatenate([few.held[row].ravel() for row in looked]) - theirs
    farthest = FARTHEST * float(np.ptp([*evidence.scene.mechanism.points.values()], axis=0).max())

    def read(chosen: Chosen, amounts: Array) -> Array:
        return _numbers(_designs(evidence.solved, chosen, np.clip(amounts, -farthest, farthest)), looked)

    for choices in (groups := _groups(names)[:most]):
        found: dict[Chosen, Fit] = {}
        for some in _likeliest(choices, slopes, gap, farthest):
            chosen = tuple(names[i] for i in some)
            first = gap, slopes[some].T
            fit = fitted(
                partial(read, chosen), [0.0] * len(some), STEP, theirs, off, rounded=True, known=first
            )
            # Of one that is off by nothing the others are a choice of their own.
            if fit and fit.amounts.all() and np.abs(fit.amounts).max() < farthest:
                found[chosen] = fit
        best = min((fit.left for fit in found.values()), default=0.0)
        likely = [(c, fit.amounts) for c, fit in found.items() if fit.left <= POORER * best]
        made = (
            supposed(evidence, [_coordinate(evidence, names) for names in chosen], amounts.tolist())
            for chosen, amounts in likely
        )
        hypotheses = [one for one in made if one]
        if any(gives(evidence, one, looked) for one in hypotheses) or choices is groups[-1]:
            return hypotheses
    return []


def _groups(names: Chosen) -> list[list[tuple[int, ...]]]:
    """The choices of one coordinate, of two, and of the three of a point, by their places."""
    places = range(len(names))
    points = [tuple(name.rpartition(".")[0] for name in some) for some in names]
    return [
        [(i,) for i in places],
        [(i, k) for i, k in combinations(places, 2) if not {*names[i]} & {*names[k]}],
        [three for three in combinations(places, 3) if len({points[i] for i in three}) == 1],
    ]


def _likeliest(
    choices: Sequence[tuple[int, ...]], slopes: Array, gap: Array, farthest: float
) -> list[list[int]]:
    """The choices that leave the least by linear least squares."""
    products, right, whole = slopes @ slopes.T, slopes @ -gap, float(gap @ gap)
    left: list[tuple[float, list[int]]] = []
    for chosen in map(list, choices):
        amounts = np.linalg.lstsq(products[np.ix_(chosen, chosen)], right[chosen], rcond=1e-12)[0]
        rest = whole - float(amounts @ right[chosen])
        if rest <= LIKELY**2 * whole and np.abs(amounts).max() <= farthest:
            left.append((rest, chosen))
    return [chosen for _, chosen in sorted(left)[:LIKELIEST]]


def _coordinate(evidence: Evidence, names: Coordinate) -> Change:
    def put(content: Content, more: float) -> None:
        for point, _, axis in (name.rpartition(".") for name in names):
            content["mechanism"]["points"][point]["xyz".index(axis)] += more

    return Change(names, 0.0, STEP, put, partial(_said, evidence, names))


def _said(evidence: Evidence, names: Coordinate, amount: float) -> str:
    coordinate, *others = names
    point, _, axis = coordinate.rpartition(".")
    place = evidence.scene.mechanism.points[point]["xyz".index(axis)]
    direction = np.eye(3)["xyz".index(axis)] * np.sign(amount)
    words = [
        word for way, word in TOO.items() if evidence.scene.mechanism.axes.component(direction, way) > 0.999
    ]
    word = words[0] if words else "large" if amount > 0.0 else "small"
    with_it = "".join(f", and {other.rpartition('.')[0]} with it" for other in others)
    drawn = f"{abs(amount):.4g} mm too {word}, at {place + amount:.6g} for {place:.6g}"
    return f"{coordinate} drawn {drawn}{with_it}"
