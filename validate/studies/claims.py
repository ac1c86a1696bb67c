"""Whether what a formulation claims of its accuracy holds, number by number, and how loose it is.

Random scenes by number (see `random_scenes`), a tenth of them close to a singular pose, each number of every
instant held against the reference:

    python -m validate.studies.claims --formulation pointcoord --count 300
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import SceneError
from pointcoord.effects.registry import QUANTITIES
from validate.adjudication.reference_solution import DUST, as_solution, inputs_at, reference_instant, scales
from validate.cars.random_scenes import RandomScene, random_scene
from validate.cars.registry import VARIANTS, Variant
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.registry import NAMES, formulation
from validate.output.report import table
from validate.reference import NoReferenceError
from validate.reference.exact import as_fraction
from validate.reference.instant import Instant

Array = NDArray[np.float64]
LEVELS = (0.5, 0.9, 0.99)


@dataclass(frozen=True)
class Held:
    """The numbers of one quantity of one scene, held against the reference.

    Attributes:
        scene, kind: its number, and what it comes close to.
        variant: its kind of suspension.
        error, claim: of every number that is off, (numbers,).
        exact: how many are not off at all.
    """

    scene: int
    kind: str
    variant: Variant
    quantity: str
    error: Array
    claim: Array
    exact: int

    @property
    def share(self) -> float:
        """Largest error in parts of its claim; above 1 the claim is broken."""
        with np.errstate(divide="ignore"):
            return float(np.max(self.error / self.claim, initial=0.0))


def held_scene(car: RandomScene, name: str) -> list[Held]:
    """All quantities of a scene; none where the formulation refuses it or there is no reference."""
    scene = car.scene
    try:
        solution = formulation(name).solve(scene)
        instants = [reference_instant(scene, inputs_at(scene, t)) for t in scene.instants.tolist()]
    except (FormulationError, SceneError, NoReferenceError):
        return []
    reference = as_solution(scene, instants)
    return [_held(car, quantity, solution, reference, instants) for quantity in asked_numbers(scene)]


def _held(
    car: RandomScene, quantity: str, solution: Solution, reference: Solution, instants: Sequence[Instant]
) -> Held:
    found: list[tuple[float, float]] = []
    # The reference's own error is that of numbers as large as the largest ones that a number is made of.
    dust = DUST * scales(reference.numbers)[quantity]
    for name in reference.numbers[quantity]:
        numbers = solution.numbers[quantity][name].reshape(len(instants), -1)
        claims = solution.accuracy.claims[quantity][name].reshape(len(instants), -1)
        for row, claim, instant in zip(numbers, claims, instants, strict=True):
            errors = (_distance(a, b) for a, b in zip(row, _exact(instant, quantity, name), strict=True))
            found += [(e if e > dust else 0.0, float(c)) for e, c in zip(errors, claim, strict=True)]
    error, claim = np.array(found).reshape(-1, 2).T
    off = error > 0.0
    return Held(
        car.number, car.kind, car.variant, quantity, error[off], claim[off], int(np.count_nonzero(~off))
    )


def _exact(instant: Instant, quantity: str, name: str) -> Sequence[Any]:
    return [instant.effects[name]] if quantity == "wheel" else list(getattr(instant, quantity)[name])


def _distance(found: float, exact: Any) -> float:
    return float(abs(as_fraction(exact, "number") - Fraction(float(found))))


def study(cars: Iterable[RandomScene], name: str) -> list[Held]:
    """Every quantity of every scene that is answered and has a reference."""
    return [held for car in cars for held in held_scene(car, name)]


def study_text(helds: Sequence[Held]) -> str:
    """A row for each suspension and quantity: numbers, the largest error / claim, claim / error at levels."""
    rows = []
    for variant, quantity in itertools.product(VARIANTS, QUANTITIES):
        part = [held for held in helds if (held.variant, held.quantity) == (variant, quantity)]
        if not part:
            continue
        worst = max(part, key=lambda held: held.share)
        with np.errstate(divide="ignore"):
            loose = np.concatenate([held.claim / held.error for held in part])
        rows.append(
            (
                variant.words,
                QUANTITIES[quantity].words,
                str(sum(len(held.error) + held.exact for held in part)),
                str(sum(held.exact for held in part)),
                f"{worst.share:.7g}",
                f"{worst.scene} ({worst.kind})",
                *(f"{np.quantile(loose, level):.3g}" if len(loose) else "-" for level in LEVELS),
            )
        )
    head = ("suspension", "quantity", "numbers", "exact", "largest error / claim", "scene")
    levels = tuple(f"claim / error at {100 * level:g}%" for level in LEVELS)
    scenes = len({held.scene for held in helds})
    return f"{scenes} scenes held against the reference\n{table((*head, *levels), rows)}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study and print it; 0 if every claim holds, else 1."""
    parser = argparse.ArgumentParser(prog="python -m validate.studies.claims", description=study.__doc__)
    parser.add_argument("--formulation", default="pointcoord", choices=NAMES)
    parser.add_argument("--count", type=int, default=300, help="scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    options = parser.parse_args(arguments)
    cars = (random_scene(number) for number in range(options.first, options.first + options.count))
    helds = study(cars, options.formulation)
    print(study_text(helds))
    return 1 if any(not held.share <= 1.0 for held in helds) else 0


if __name__ == "__main__":
    raise SystemExit(main())
