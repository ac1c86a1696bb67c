"""What joins the bodies of a mechanism, in words."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from pointcoord.linkage.directions import DIRECTIONS
from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import Slide, Structure


def joints(structure: Structure) -> Iterator[str]:
    """Every ball joint, hinge, slide and rod, one a line."""
    for one, other in combinations(structure.bodies, 2):
        shared = structure.shared(one, other)
        if len(shared) == 1:
            yield f"ball joint of {one} and {other} at {shared[0]}"
        if len(shared) == 2:
            yield f"hinge of {one} and {other} about {shared[0]} - {shared[1]}"
    for name, slide in structure.slides.items():
        yield _slide(name, slide)
    for rod, (start, end) in structure.rods.items():
        yield f"rod {rod} from {_end(structure, start)} to {_end(structure, end)}"


def _slide(name: str, slide: Slide) -> str:
    line = slide.along if slide.along in DIRECTIONS else f"towards {slide.along} as drawn"
    turns = "" if slide.turns else ", and does not turn"
    points = " and ".join(slide.points)
    return f"slide {name}: {points} on the line of {slide.body} through {slide.through} {line}{turns}"


def _end(structure: Structure, point: str) -> str:
    bodies = structure.bodies_of(point)
    return f"{point} ({', '.join(bodies)})" if bodies else point


def bodies(structure: Structure) -> Iterator[str]:
    """Every moving body with its points."""
    return (f"{body}: {', '.join(points)}" for body, points in structure.bodies.items() if body != CHASSIS)
