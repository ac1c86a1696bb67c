"""Another number of the car than the scene says, such as the wheel's radius: found by least squares."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, Scene, simulate
from pointcoord.effects.car_number import CarNumbers
from pointcoord.effects.registry import EFFECTS
from validate.diagnosis.evidence import Evidence, Row, kind_of
from validate.diagnosis.hypothesis import Hypothesis
from validate.diagnosis.least import as_meant, fitted

Array = NDArray[np.float64]

FEW = 25  # instants that a number is looked for at
STEP = 1e-4  # of the number, of differences by it
RADIUS = "wheel_radius"
LEAST = 1e-9  # of the number, that it may be: at a radius of nothing the contact point is the wheel centre
UNITS = {"wheelbase": "mm", "centre_of_gravity_height": "mm", "spring_free_length": "mm", RADIUS: "mm"}
MADE_OF = {
    number.name: (*number.data, *([RADIUS] if number.needs_radius else []))
    for effect in EFFECTS.values()
    if isinstance(effect, CarNumbers)
    for number in effect.numbers
}
"""By the name of a number of the car, what the scene says of the car that it is made of."""


def other_data(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each number that those which disagree are made of, by itself."""
    made_of = {row: MADE_OF.get(row[1].rpartition(".")[2], ()) for row in evidence.wrong}
    for name in dict.fromkeys(name for names in made_of.values() for name in names):
        value, looked = _of(evidence.scene, name), [row for row, names in made_of.items() if name in names]
        if evidence.other_cars and value is not None and (one := _other(evidence, name, value, looked)):
            yield one


def _other(evidence: Evidence, name: str, value: float, looked: list[Row]) -> Hypothesis | None:
    few = evidence.thinned(FEW)
    known = [row for row in looked if kind_of(row) == "car" and np.isfinite(few.given[row]).all()]
    theirs, off = few.joined(known) if known else (np.empty(0), np.empty(0))

    def read(values: Array) -> Array:
        found = np.full((len(values), len(theirs)), np.nan)
        for i, (other,) in enumerate(values.tolist()):
            try:
                car = _with(evidence.solved.fine, name, max(other, LEAST * value))
                there = simulate(car).at(few.times).numbers
            except PointcoordError:
                continue
            found[i] = np.concatenate([there[quantity][of] for quantity, of in known])
        return found

    found = fitted(read, [value], STEP * value, theirs) if known else None
    if found is None:
        return None
    other = max(float(as_meant(found, read, theirs, off)[1][0]), LEAST * value)
    unit = f" {UNITS[name]}" if name in UNITS else ""
    words = f"{name} is {other:.6g}{unit}, not {value:.6g}"
    if name == RADIUS and other == LEAST * value:
        words = "the wheel centre is taken for the contact point"
    motion = simulate(_with(evidence.solved.fine, name, other))
    return Hypothesis(name, words, evidence.by(motion), 1, 1.5)


def _of(scene: Scene, name: str) -> float | None:
    """A number that a scene says of the car; None of what it does not say, and of words."""
    part = scene.mechanism
    value = part.wheel_radius if name == RADIUS else getattr(part.car, name, None)
    return value if isinstance(value, float) else None


def _with(scene: Scene, name: str, value: float) -> Scene:
    """The scene with another number."""
    part = scene.mechanism
    if name != RADIUS and part.car is not None:
        other = part.model_copy(update={"car": part.car.model_copy(update={name: value})})
    else:
        other = part.model_copy(update={name: value})
    return scene.model_copy(update={"mechanism": other})
