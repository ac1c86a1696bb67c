"""A hardpoint misread: the coordinates of the drawing that make our numbers theirs, and by how much.

One coordinate first, then two, then the three of a point. With J how the numbers change with each coordinate
of the drawing (central differences of solved designs), least squares of J a = theirs - ours picks the
likeliest; Gauss and Newton's method, which solves the corrected designs, finds their amounts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, sweep
from pointcoord.linkage.car_axes import Direction
from validate.diagnosis.evidence import Evidence, Row, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, Kind

Array = NDArray[np.float64]
Names = tuple[str, ...]

STEP = 0.05  # mm, of the differences
MOST_INSTANTS = 25  # that amounts are found from
LIKELIEST = 4  # of each number of coordinates
ITERATIONS = 6
# How many times what the best choice leaves another may leave.
POORER = 30.0
# Of the car's size: what is read wrongly by more is another car, and whether it closes takes long to find.
FARTHEST = 0.1
# What least squares may leave of the difference, and be worth a try.
PROMISING = 0.5
TOO: Mapping[Direction, str] = {
    "up": "high",
    "down": "low",
    "outboard": "far out",
    "inboard": "far in",
    "rearward": "far back",
    "forward": "far forward",
}


class Hardpoint(Kind):
    """Up to three coordinates of the drawing."""

    name, solves, of_time = "hardpoint", True, True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The likeliest, with more coordinates only where fewer do not do."""
        few = _fewer(evidence)
        looked = looked_at(evidence)
        if few is None or not looked:
            return
        scene, some = few
        ours, theirs = (
            np.concatenate([numbers[row][some].ravel() for row in looked])
            for numbers in (evidence.held, evidence.given)
        )
        if not np.isfinite(theirs).all():
            return
        points = evidence.scene.mechanism.points
        names = [f"{point}.{axis}" for point in points for axis in "xyz"]
        slopes = _slopes(scene, names, looked)
        usable = np.isfinite(slopes).all(axis=1) & (np.abs(slopes).max(axis=1) > 0.0)
        names, slopes = [n for n, use in zip(names, usable, strict=True) if use], slopes[usable]
        gap = theirs - ours
        for tried in _likeliest(names, slopes, gap, _farthest(scene)):
            done = False
            for chosen, amounts in _refined(scene, looked, theirs, tried).items():
                numbers = _solved(evidence.solved.fine, chosen, amounts)
                if numbers is None:
                    continue
                at = np.searchsorted(evidence.scene.instants, evidence.times)
                rows = {
                    row: (numbers[row][at], evidence.rounded(row, *amounts))
                    for row in evidence.held
                    if row in numbers
                }
                words = " and ".join(
                    _said(evidence, c, a) for c, a in zip(chosen, amounts.tolist(), strict=True)
                )
                count = len(chosen)
                yield Hypothesis(self.name, chosen, words, rows, count, 1.5 + count, whole=True)
                done |= all(evidence.left(row, *rows[row]) <= 1.0 for row in looked)
            if done:
                return


def looked_at(evidence: Evidence) -> tuple[Row, ...]:
    """Numbers of one unit that disagree: positions if there are any, then angles, else what comes first."""
    for of in ("mm", "rad"):
        best = [row for row in evidence.wrong if length_or_angle(row) == of and order(row) == 0]
        if best:
            return tuple(best)
    return evidence.wrong_of(evidence.wrong[0][0])


def _fewer(evidence: Evidence) -> tuple[Scene, NDArray[np.intp]] | None:
    """The scene at some of its instants, evenly, and which of the evidence's these are."""
    scene, every = evidence.solved.fine, evidence.scene.instants
    stride = -(-len(every) // MOST_INSTANTS)
    some = np.arange(0, len(every), stride)
    if not np.isin(every[some], evidence.times).all():
        return None
    stop = float(every[some[-1]])
    time = scene.time.model_copy(update={"stop": stop, "samples": len(some)})
    return scene.model_copy(update={"time": time, "points": None}), np.searchsorted(
        evidence.times, every[some]
    )


def _farthest(scene: Scene) -> float:
    """The largest amount that a coordinate is supposed to be off by, mm."""
    return FARTHEST * float(np.ptp([*scene.mechanism.points.values()], axis=0).max())


def _read(scene: Scene, offsets: dict[str, Array], rows: Sequence[Row]) -> Array:
    """Numbers of rows of several designs, (designs, numbers); NaN of designs that cannot be solved."""
    found = sweep(scene, offsets=offsets)
    return np.concatenate([found.numbers[q][name].reshape(len(found), -1) for q, name in rows], axis=1)


def _slopes(scene: Scene, names: Sequence[str], rows: Sequence[Row]) -> Array:
    """How the numbers change with each coordinate, (coordinates, numbers)."""
    steps = np.concatenate([STEP * np.eye(len(names)), -STEP * np.eye(len(names))])
    read = _read(scene, {name: steps[:, i] for i, name in enumerate(names)}, rows)
    return (read[: len(names)] - read[len(names) :]) / (2.0 * STEP)


def _likeliest(
    names: Sequence[str], slopes: Array, gap: Array, farthest: float
) -> Iterator[dict[Names, Array]]:
    """By the coordinates that are chosen, their amounts by least squares; one, two, three coordinates."""
    products, right, whole = slopes @ slopes.T, slopes @ gap, float(gap @ gap)
    places = range(len(names))
    points = [name.rpartition(".")[0] for name in names]
    threes = [three for three in combinations(places, 3) if len({points[i] for i in three}) == 1]
    groups: tuple[list[tuple[int, ...]], ...] = (
        [(i,) for i in places],
        [*combinations(places, 2)],
        [*threes],
    )
    for choices in groups:
        left: list[tuple[float, tuple[int, ...], Array]] = []
        for some in choices:
            chosen = list(some)
            solved = np.linalg.lstsq(products[np.ix_(chosen, chosen)], right[chosen], rcond=1e-12)
            amounts = solved[0].astype(np.float64)
            rest = whole - float(amounts @ right[chosen])
            left.append((rest, some, amounts))
        left.sort(key=lambda one: one[0])
        yield {
            tuple(names[i] for i in some): amounts
            for rest, some, amounts in left[:LIKELIEST]
            if rest <= PROMISING**2 * whole and np.abs(amounts).max() <= farthest
        }


def _refined(
    scene: Scene, rows: Sequence[Row], theirs: Array, begun: dict[Names, Array]
) -> dict[Names, Array]:
    """Amounts by Gauss and Newton's method, all choices together."""
    amounts = dict(begun)
    active = list(begun)
    for _ in range(ITERATIONS):
        if not active:
            break
        designs = [
            (chosen, amounts[chosen] + step)
            for chosen in active
            for step in (np.zeros(len(chosen)), *(STEP * np.eye(len(chosen))), *(-STEP * np.eye(len(chosen))))
        ]
        offsets = {name: np.zeros(len(designs)) for chosen in active for name in chosen}
        for i, (chosen, values) in enumerate(designs):
            for name, value in zip(chosen, values.tolist(), strict=True):
                offsets[name][i] = value
        try:
            read = _read(scene, offsets, rows)
        except PointcoordError:
            return amounts
        first, still = 0, []
        rests: dict[Names, float] = {}
        for chosen in active:
            n = len(chosen)
            here, more, less = (
                read[first],
                read[first + 1 : first + n + 1],
                read[first + n + 1 : first + 2 * n + 1],
            )
            first += 2 * n + 1
            if not np.isfinite(read[first - 2 * n - 1 : first]).all():
                del amounts[chosen]
                continue
            rests[chosen] = float(np.linalg.norm(theirs - here))
            change = np.linalg.lstsq(((more - less) / (2.0 * STEP)).T, theirs - here, rcond=None)[0]
            amounts[chosen] = amounts[chosen] + change
            if np.abs(amounts[chosen]).max() > _farthest(scene):
                del amounts[chosen], rests[chosen]
                continue
            if np.abs(change).max() > 1e-10 * (1.0 + np.abs(amounts[chosen]).max()):
                still.append(chosen)
        # Once designs are solved at their amounts, those that miss by much more than the best are out.
        poor = [chosen for chosen, rest in rests.items() if rest > POORER * min(rests.values())]
        amounts = {chosen: values for chosen, values in amounts.items() if chosen not in poor}
        active = [chosen for chosen in still if chosen not in poor]
    return amounts


def _solved(scene: Scene, chosen: Names, amounts: Array) -> dict[Row, Array] | None:
    """All numbers of a corrected design at the scene's instants."""
    offsets = {name: np.array([amount]) for name, amount in zip(chosen, amounts.tolist(), strict=True)}
    found = sweep(scene, offsets=offsets)
    if not found.solved.all():
        return None
    return {(q, name): np.asarray(a[0]) for q, part in found.numbers.items() for name, a in part.items()}


def _said(evidence: Evidence, coordinate: str, amount: float) -> str:
    """A coordinate, how far off it is drawn and to which side."""
    point, _, axis = coordinate.rpartition(".")
    place = evidence.scene.mechanism.points[point]["xyz".index(axis)]
    direction = np.eye(3)["xyz".index(axis)] * np.sign(amount)
    words = [word for way, word in TOO.items() if evidence.axes.component(direction, way) > 0.999]
    word = words[0] if words else "large" if amount > 0.0 else "small"
    return f"{coordinate} drawn {abs(amount):.4g} mm too {word}, at {place + amount:.6g} for {place:.6g}"


KIND = Hardpoint()
