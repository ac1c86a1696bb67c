"""Two formulations on one scene: every quantity's largest difference, against a derived tolerance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord.scene import Scene
from validate.formulation import Formulation, Solution
from validate.formulations import formulation
from validate.tolerance import (
    CARRIED,
    KNUCKLE,
    Factors,
    angle_tolerance,
    body_tolerances,
    carried_tolerances,
    factors,
    point_tolerances,
)

Array = NDArray[np.float64]
# Numbers below the smallest normal one lose digits, and so do tolerances made of them.
SMALLEST = float(np.finfo(float).tiny)
Verdict = Literal["agrees", "disagrees"]

UNITS = {
    "position": "mm",
    "velocity": "mm/s",
    "acceleration": "mm/s^2",
    "angular_velocity": "rad/s",
    "angular_acceleration": "rad/s^2",
    "wheel": "rad",
}


@dataclass(frozen=True)
class Comparison:
    """One quantity of one point, body or angle over a scene.

    Attributes:
        difference: largest difference of any component, and the `instant` (s) where it is.
        tolerance: what it was held to at that instant.
        share: largest difference / tolerance over all instants; it agrees up to 1.
    """

    scene: str
    first: str
    second: str
    quantity: str
    name: str
    unit: str
    difference: float
    tolerance: float
    share: float
    instant: float
    verdict: Verdict


@dataclass(frozen=True)
class Outcome:
    """All comparisons of one scene and pair, with the factors of their tolerances.

    Attributes:
        solutions: both solved scenes, for whoever wants to look further.
        notes: what the formulations said themselves of numbers without meaning.
    """

    scene: str
    rows: tuple[Comparison, ...]
    factors: Factors
    solutions: tuple[Solution, Solution]
    notes: tuple[str, ...]

    @property
    def agreed(self) -> bool:
        """Whether every row agrees."""
        return all(row.verdict == "agrees" for row in self.rows)

    @property
    def disagreements(self) -> tuple[Comparison, ...]:
        """The rows that do not."""
        return tuple(row for row in self.rows if row.verdict == "disagrees")


def compare(
    scene: Scene, first: str | Formulation, second: str | Formulation, name: str | None = None
) -> Outcome:
    """Solve a scene by two formulations and compare all that the scene asks for.

    Args:
        first, second: names of formulations, or formulations themselves.
        name: what to call the scene in the rows; its title if not given.
    Raises:
        FormulationError: one of them refuses the scene.
        SceneError: the scene's own hardpoints make no mechanism.
    """
    one, two = (formulation(f) if isinstance(f, str) else f for f in (first, second))
    widened = _with_basis(scene)
    return compare_solutions(scene, one.solve(widened), two.solve(widened), name or scene.title or "scene")


def _with_basis(scene: Scene) -> Scene:
    """The scene with the rates that the tolerances of its effects are derived from."""
    needs = {"acceleration", "knuckle_rates"}.intersection(scene.effects)
    extra = [e for e in ("velocity", "acceleration") if needs and e not in scene.effects]
    return scene.model_copy(update={"effects": (*scene.effects, *extra)})


def compare_solutions(scene: Scene, one: Solution, two: Solution, name: str) -> Outcome:
    """Compare two solved scenes."""
    f = factors(one, two)
    rows = []
    for quantity, part, first, second, tolerance in _pairs(scene, one, two, f):
        gap = np.abs(first - second)
        if quantity == "wheel":
            # Whole turns apart is the same angle.
            gap = np.minimum(gap, np.abs(2.0 * np.pi - gap))
        gap = gap.max(axis=-1) if gap.ndim > 1 else gap
        # A NaN is a disagreement, and the worst one.
        gap = np.where(np.isfinite(gap), gap, np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.where(gap == 0.0, 0.0, gap / (tolerance + SMALLEST))
        # A tolerance that is not finite would let everything pass.
        shares = np.where(np.isfinite(tolerance), shares, np.inf)
        worst = int(np.argmax(gap))
        share = float(np.max(shares))
        rows.append(
            Comparison(
                scene=name,
                first=one.formulation,
                second=two.formulation,
                quantity=quantity,
                name=part,
                unit=UNITS[quantity],
                difference=float(gap[worst]),
                tolerance=float(tolerance[worst]),
                share=share,
                instant=float(one.times[worst]),
                verdict="agrees" if share <= 1.0 else "disagrees",
            )
        )
    return Outcome(name, tuple(rows), f, (one, two), (*one.notes, *two.notes))


def _pairs(
    scene: Scene, one: Solution, two: Solution, f: Factors
) -> Iterator[tuple[str, str, Array, Array, Array]]:
    """Quantity, name, both arrays and the tolerance of everything that the scene asks for."""
    tolerances, carried = point_tolerances(f), carried_tolerances(f)
    quantities = ["position", *(e for e in ("velocity", "acceleration") if e in scene.effects)]
    for quantity in quantities:
        mine, other = _same_names(quantity, getattr(one, quantity), getattr(two, quantity))
        for point in mine:
            held_to = (carried if point in CARRIED else tolerances)[quantity]
            yield quantity, point, mine[point], other[point], held_to
    if "knuckle_rates" in scene.effects:
        spin, spin_rate = (
            min(_largest(s[quantity]) for s in (_rates(one), _rates(two)))
            for quantity in ("angular_velocity", "angular_acceleration")
        )
        body = body_tolerances({p: one.position[p] for p in KNUCKLE}, tolerances, spin, spin_rate)
        for quantity in ("angular_velocity", "angular_acceleration"):
            mine, other = _same_names(quantity, _rates(one)[quantity], _rates(two)[quantity])
            for name in mine:
                yield quantity, name, mine[name], other[name], body[quantity]
    if "wheel_angles" in scene.effects:
        mine, other = _same_names("wheel", one.wheel, two.wheel)
        for name in mine:
            yield "wheel", name, mine[name], other[name], angle_tolerance(name, one.position, f)


def _rates(solution: Solution) -> dict[str, Mapping[str, Array]]:
    return {
        "angular_velocity": solution.angular_velocity,
        "angular_acceleration": solution.angular_acceleration,
    }


def _largest(rates: Mapping[str, Array]) -> float:
    norms = [np.linalg.norm(rate, axis=-1) for rate in rates.values()]
    return max((float(np.max(n[np.isfinite(n)], initial=0.0)) for n in norms), default=0.0)


def _same_names(
    quantity: str, one: Mapping[str, Array], two: Mapping[str, Array]
) -> tuple[Mapping[str, Array], Mapping[str, Array]]:
    """Both mappings, after a check that a missing name cannot pass for agreement."""
    if set(one) != set(two) or not one:
        raise ValueError(f"{quantity}: one formulation gives {sorted(one)}, the other {sorted(two)}")
    return one, two
