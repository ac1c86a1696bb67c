"""The reference of cars drawn so near to where assemblies meet that their side is a matter of rounding.

A drawing need not be assembled, so `solve_reference` calls a side unclear that is less than 1e-9 of the
lengths that it is made of. A hard case draws such cars on purpose, and its coordinates are exact: the sign of
an exact product of them is the side that was drawn, however small the product is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pointcoord import Scene
from validate.adjudication.true_solution import as_solution
from validate.adjudication.verdicts import inputs_at
from validate.formulations.protocol import Solution
from validate.hard.case import Answer, Trial
from validate.hard.judged import judged_answer
from validate.hard.trial import Measure, Tried, solved, try_scene
from validate.reference import AmbiguousAssemblyError, Instant, NoReferenceError
from validate.reference.design import Design, exact_vector, values_only
from validate.reference.instant import prove_instant
from validate.reference.macpherson import Choices
from validate.reference.solve import with_enough_digits
from validate.reference.vectors import cross, dot, minus

DIGITS = 60


def drawn_choices(scene: Scene) -> Choices:
    """The four signs of a drawing, from exact products (see `validate.reference.macpherson.Choices`).

    Raises:
        AmbiguousAssemblyError: a product is exactly zero, so that nothing tells the side.
    """
    part = scene.mechanism
    p = {name: exact_vector(place, name) for name, place in part.points.items()}
    ball, top = p["lower_ball_joint"], p["strut_top"]
    front, strut = p["lower_arm_front"], minus(p["strut_top"], ball)
    # The knuckle's side of the strut, the line that the tie rod turns it about, and the rod's direction.
    drawn = part.closure == "drawn"
    along = minus(top, p["strut_lower"]) if drawn else minus(p["strut_lower"], ball)
    steered, slid = (strut, along) if drawn else (along, strut)
    axis, up = minus(p["lower_arm_rear"], front), exact_vector(part.up, "up")
    inner, outer = minus(p["tie_rod_inner"], ball), minus(p["tie_rod_outer"], ball)
    products = {
        "arm": dot(cross(axis, up), minus(ball, front)),
        "strut": dot(along, strut),
        "rod": -dot(minus(p["strut_rod_end"], top), slid),
        "tie": dot(cross(steered, inner), outer),
    }
    for name, product in products.items():
        if product == 0:
            remedy = "the drawing lies exactly where two assemblies meet"
            raise AmbiguousAssemblyError(f"the sign of the {name} choice", 0.0, 0.0, remedy)
    return Choices(**{name: 1 if product > 0 else -1 for name, product in products.items()})


def instant_on_side(scene: Scene, time: float) -> Instant:
    """The proven instant on the side of the drawing.

    Raises:
        NoReferenceError: there is no pose, or none can be proven.
    """
    part, choices = scene.mechanism, drawn_choices(scene)
    design = Design.from_points(dict(part.points), part.up, part.right, part.side, part.closure)
    driven = design.driven(inputs_at(scene, time))

    def attempt(working: int) -> Instant:
        known = design.known(driven)
        still = values_only(known)
        chosen = design.linkage.candidate(still, choices)
        chosen.require_feasible(float(design.unit))
        start = design.linkage.unknown_of(chosen.points, still)
        return prove_instant(design, known, start, choices, DIGITS, working)

    return with_enough_digits(attempt, DIGITS)


def solution_on_side(scene: Scene) -> Solution:
    """The reference at all instants of a scene, on the side of its drawing.

    Raises:
        NoReferenceError: an instant has no pose, or none can be proven.
    """
    return as_solution(scene.instants, [instant_on_side(scene, t) for t in scene.instants.tolist()])


def try_on_side(
    value: float, content: Mapping[str, Any], formulations: Sequence[str], measure: Measure | None = None
) -> Trial:
    """As `try_scene`; where the drawn side is unclear to the reference, by the exact signs of the drawing."""
    trial = try_scene(value, content, formulations, measure)
    if all(answer.outcome != "unjudged" for answer in trial.answers):
        return trial
    scene = Scene.from_mapping(content)
    try:
        reference = solution_on_side(scene)
    except NoReferenceError as error:
        return replace(trial, facts={**trial.facts, "reference": f"{type(error).__name__}: {error}"})
    tried = {name: solved(name, scene) for name in formulations}
    solutions = {name: one for name, one in tried.items() if isinstance(one, Solution)}
    answers = tuple(
        one if isinstance(one, Answer) else judged_answer(scene, one, reference) for one in tried.values()
    )
    facts = {**trial.facts, "reference": "on the side of the exact sign of the drawing"}
    if measure is not None:
        facts |= measure(Tried(value, scene, solutions, reference))
    return Trial(value, answers, facts)
