"""Faults in the drawing of the car: a misread hardpoint; and, from the lengths of the links in the given
positions, a rod of another length and another assembly.

The exact derivatives of all numbers by each coordinate of the drawing, computed once, show which coordinates
are worth a search.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from itertools import combinations

import numpy as np

from pointcoord import Scene
from pointcoord.linkage.directions import Direction
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.sweeping.designs import coordinates_of
from pointcoord.sweeping.hardpoint_slopes import slopes_of_motion
from validate.arrays import Array
from validate.diagnosis.evidence import Evidence
from validate.diagnosis.fault import Fault
from validate.diagnosis.other_car import Change, any_of
from validate.diagnosis.solved import Content

# Largest misreading, as a share of the car's size: a larger one is a different car, and slow to solve.
FARTHEST = 0.1
TOO: Mapping[Direction, str] = {
    "up": "high",
    "down": "low",
    "outboard": "far out",
    "inboard": "far in",
    "rearward": "far back",
    "forward": "far forward",
}


def misread_hardpoints(evidence: Evidence) -> Iterator[Fault]:
    """Each coordinate alone, and each coordinate of points that are read together."""
    motion, points = evidence.solved.motion, evidence.scene.mechanism.points
    if motion is None:
        return iter(())
    alone = coordinates_of(evidence.scene, [*points])
    slopes = slopes_of_motion(evidence.scene, motion.solved, evidence.few.times, alone).numbers
    farthest = FARTHEST * float(np.ptp([*points.values()], axis=0).max())

    def change(together: Mapping[str, float], i: int) -> Change:
        def put(content: Content, more: float) -> None:
            for name, sign in together.items():
                content["mechanism"]["points"][name][i] += sign * more

        moved = [alone.index(f"{point}.{'xyz'[i]}") for point in together]
        signs = [*together.values()]
        by = {row: np.tensordot(signs, slopes[row.quantity][row.name][moved], 1) for row in evidence.wrong}
        words = partial(_in_words, evidence.scene, [*together], i)
        return Change(put, words, slopes=by, farthest=farthest)

    return any_of(evidence, [change(some, i) for i in range(3) for some in _read_together(evidence.scene, i)])


def _read_together(scene: Scene, i: int) -> list[dict[str, float]]:
    """The points whose coordinate i may be misread together, with the sign of the change of each.

    Every point alone, each point together with the coincident points whose place it takes, as tie_rod_inner
    takes that of rack_centre, and all of these together with their mirror images at the other wheel, which a
    scene gives once.
    """
    points, topology = scene.mechanism.points, scene.mechanism.topology
    groups = {point: {point: 1.0} for point in points}
    for missing, point in topology.stand_ins.items():
        if missing in points and points[missing] == points[point]:
            groups[point][missing] = 1.0
    found = [*(group for group in groups.values() if len(group) > 1), *({point: 1.0} for point in points)]
    mirror = np.eye(3) - 2.0 * np.outer(scene.mechanism.right, scene.mechanism.right)
    if abs(mirror[i, i]) != 1.0:
        return found  # the mirror image of a coordinate is none
    for one, two in combinations(topology.sides, 2):
        for group in tuple(found):
            images = {point: point.replace(f"{one}.", f"{two}.", 1) for point in group}
            if all(
                image != point and np.array_equal(mirror @ points[point], points.get(image, ()))
                for point, image in images.items()
            ):
                found.append(group | {image: float(mirror[i, i]) for image in images.values()})
    return found


def _in_words(scene: Scene, together: list[str], i: int, more: float) -> str:
    point, *others = together
    drawn, part = scene.mechanism.points[point][i], point.rpartition(".")[0]
    component = scene.mechanism.axes.on(scene.mechanism.topology.sides.get(part, "")).component
    direction = np.eye(3)[i] * np.sign(more)
    word = next((word for way, word in TOO.items() if component(direction, way) > 0.999), "")
    word = word or ("large" if more > 0.0 else "small")
    with_it = "".join(f", and {other} with it" for other in others)
    amount = f"{abs(more):.4g} mm too {word}"
    return f"{point}.{'xyz'[i]} seems {amount}: {drawn + more:.6g}, not {drawn:.6g}{with_it}"


def wrong_lengths(evidence: Evidence) -> Iterator[Fault]:
    """One rod is too long or too short: given positions keep all lengths of the links but that of a rod."""
    lengths = _lengths(evidence)
    others = [ends for ends, (gap, off, _) in lengths.items() if (np.abs(gap) > off).any()]
    for rod, ends in evidence.scene.mechanism.plain(())["rods"].items():
        if others == [(*ends,)]:
            gap, off, ours = lengths[others[0]]
            more = float(gap.mean())
            if (np.abs(gap - more) <= off).all():
                amount = f"{abs(more):.4g} mm too {'long' if more > 0.0 else 'short'}"
                yield _of_links(evidence, f"{rod} is {amount}: {ours + more:.6g} mm, not {ours:.6g}")


def other_assemblies(evidence: Evidence) -> Iterator[Fault]:
    """Given positions that keep all lengths of the links, unlike ours: another pose of the same mechanism."""
    lengths = _lengths(evidence)
    if lengths and all((np.abs(gap) <= off).all() for gap, off, _ in lengths.values()):
        words = f"all {len(lengths)} lengths of the links are kept: another assembly, or other inputs"
        yield _of_links(evidence, words)


def _of_links(evidence: Evidence, words: str) -> Fault:
    """A fault of the positions, which are those of another mechanism or pose."""
    places = [row for row in evidence.given if row.is_place]
    rows = {row: (evidence.given[row], evidence.allowed[row]) for row in places}
    return Fault(words, rows, cost=2.5, whole=True)


def _lengths(evidence: Evidence) -> dict[tuple[str, str], tuple[Array, Array, float]]:
    """By link: how much longer it is in the given positions, (N,), the tolerance of this, and its length.

    Links are rods, and every two points of a moving body; points at rest are taken where they are. Empty if a
    moving point is not given.
    """
    topology, plain = evidence.scene.mechanism.topology, evidence.scene.mechanism.plain(())
    placed = {row.name: row for row in evidence.given if row.is_place}
    free = {*topology.moving, *topology.carried}
    if not free <= placed.keys():
        return {}
    there = {row: (evidence.given if name in free else evidence.trusted)[row] for name, row in placed.items()}
    bodies = (points for body, points in plain["bodies"].items() if body != CHASSIS)
    links = {
        *map(tuple, plain["rods"].values()),
        *(ends for body in bodies for ends in combinations(body, 2)),
    }
    found = {}
    for start, end in links:
        if start in placed and end in placed:
            one, two = placed[start], placed[end]
            theirs, ours = (np.linalg.norm(of[one] - of[two], axis=-1) for of in (there, evidence.trusted))
            off = 2.0 * np.linalg.norm(evidence.rounded(one) + evidence.rounded(two), axis=-1)
            found[start, end] = theirs - ours, off, float(ours[0])
    return found
