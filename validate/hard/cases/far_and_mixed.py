"""Cars far from the origin, very small and very large cars, and links of very different length in one car.

The error has to grow with the size of the mechanism, not with its distance from the origin. The paper's
hardpoints are whole millimetres, so a shift by whole millimetres is exact, and so is a scale by a power of
two: nothing changes but the place or the unit. The car at home says what a rate may be off by far away.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.adjudication.reference_solution import reference_solution
from validate.cars.car import moved, scaled
from validate.cars.scene_content import scene_content
from validate.formulations.protocol import Accuracy, Solution
from validate.hard.cars import CARS
from validate.hard.case import RIGHT, Answer, Case, Expected, Trial, coarse, decades
from validate.hard.cases.near_points import assembled, drawn_angle, nearer
from validate.hard.classify import judged_answer
from validate.hard.trial import Tried, scene_case, solved, try_scene

Array = NDArray[np.float64]

GROUP = "Far from the origin, and mixed sizes"
SOLVERS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
AWAY = (1.0, -1.0, 3.0)
# A model subtracts an origin of its own that lies within a few sizes of the car, wherever the car is: its
# own coordinates are up to 8 sizes instead of 1, and rounded so much more coarsely.
PLACED = 8.0
# A car at home may happen to be off by less than another by this factor: errors of a few roundings each.
LUCKY = 16.0
RATES = tuple(quantity for quantity in QUANTITIES if quantity != "position")
# A thousand times the rest of the car is as mixed as parts of one machine are.
MIXED = Expected(("right", "refused"), right_from=1e-3)

# Beyond 1e9 mm a millimetre is less than one part in 1e9: a model may decline to take that for a drawing.
NEARER = Expected(("right", "refused"), right_from=1e-9)


def moved_car(distance: float, car: str = "paper") -> dict[str, Any]:
    """A car in motion of `CARS`, with its origin some whole millimetres away."""
    there = moved(CARS[car], distance * np.array(AWAY))
    return scene_content(there, (1.5, 0.25, 0.125), (0.0, 30.0, 10.0), stop=0.4)


@cache
def at_home(name: str, car: str = "paper") -> tuple[Solution, Mapping[str, float]]:
    """A formulation's solution of the car at home, and its largest error of each quantity."""
    scene = Scene.from_mapping(moved_car(0.0, car))
    solution = solved(name, scene)
    assert isinstance(solution, Solution)  # nothing about it is hard
    return solution, errors(solution, reference_solution(scene))


def errors(solution: Solution, reference: Solution) -> dict[str, float]:
    """Largest error of each quantity that does not know where the origin is."""
    return {
        quantity: max(
            float(np.abs(array - reference.numbers[quantity][name]).max())
            for name, array in solution.numbers[quantity].items()
        )
        for quantity in RATES
    }


def far_car(value: float, car: str = "paper") -> dict[str, Any]:
    """The car moved by 1 mm over the parameter."""
    return moved_car(1.0 / value, car)


def far(value: float, car: str = "paper") -> Trial:
    """The moved car, each rate held to what the car at home may be off by."""
    content = far_car(value, car)
    found: list[Tried] = []

    def measure(tried: Tried) -> Mapping[str, float | str]:
        found.append(tried)
        if tried.reference is None:
            return {}
        ratios: dict[str, float | str] = {}
        for name, solution in tried.solutions.items():
            home = at_home(name, car)[1]
            for quantity, error in errors(solution, tried.reference).items():
                text = f"error of {quantity.replace('_', ' ')} of {name}, times that at home"
                ratios[text] = error / home[quantity] if home[quantity] else float(error > 0.0)
        return ratios

    trial = try_scene(value, content, SOLVERS, measure)
    tried = found[0]
    answers = tuple(
        _as_at_home(a, tried, car) if a.outcome == "right" and tried.reference is not None else a
        for a in trial.answers
    )
    return replace(trial, answers=answers)


def _as_at_home(answer: Answer, tried: Tried, car: str) -> Answer:
    """An answer that is right by its own bounds, held to those that the car has at home as well.

    Positions are allowed one rounding of a far coordinate more; then they are taken as true, and rates and
    angles are allowed nothing more than at home.
    """
    assert tried.reference is not None
    solution, home = tried.solutions[answer.formulation], at_home(answer.formulation, car)[0]
    places, near = solution.position, home.position
    farthest, nearest = (max(float(np.abs(p).max()) for p in q.values()) for q in (places, near))
    for away, position in ((farthest, places), (nearest, tried.reference.position)):
        strict = replace(
            solution.with_numbers({"position": position}), accuracy=_held_to(home.accuracy, EPS * away)
        )
        judged = judged_answer(tried.scene, strict, tried.reference)
        if judged.outcome != "right":
            return replace(
                answer, outcome="wrong", reason=f"by the bounds of the car at home: {judged.reason}"
            )
    return answer


def _held_to(home: Accuracy, rounding: float) -> Accuracy:
    """What a car may be off by that is off by as much at home, with a rounding of its positions."""

    def widened(quantity: str, more: float) -> dict[str, Array]:
        claims = home.claims[quantity]
        largest = max(float(np.max(claim)) for claim in claims.values())
        return {name: np.full_like(claim, PLACED * LUCKY * largest + more) for name, claim in claims.items()}

    rates = {quantity: widened(quantity, 0.0) for quantity in RATES}
    return replace(home, claims={"position": widened("position", rounding), **rates})


def scaled_car(scale: float, car: str = "paper") -> dict[str, Any]:
    """A car in motion of `CARS`, all lengths multiplied."""
    rack = (0.0, 30.0 * scale, 10.0 * scale)
    there = scaled(CARS[car], scale)
    return scene_content(there, (1.5, 0.25, 0.125), rack, tolerance=1e-9 * scale, stop=0.4)


def heaved_back(value: float, car: str = "paper") -> dict[str, Any]:
    """The car drawn far up, with a heave that brings it back to where it is at home."""
    distance = 1.0 / value
    there = moved(CARS[car], np.array([0.0, 0.0, distance]))
    return scene_content(there, (1.5, 0.25, 0.125), (0.0, 30.0, 10.0), (-distance, 20.0), stop=0.4)


def lengthened(value: float, points: tuple[str, ...], base: str, car: str = "paper") -> dict[str, Array]:
    """Points moved away from another until they are 1 / value times as far from it."""
    p = assembled(car)
    return {n: p[base] + (x - p[base]) / value if n in points else x for n, x in p.items()}


def mixed(
    value: float, points: Callable[[float], Mapping[str, Array]], shrinking: bool, car: str = "paper"
) -> dict[str, Any]:
    """A motion of a car with a link that is out of proportion; a short link follows no more than itself."""
    share = value if shrinking else 1.0
    arm, rack = (drawn_angle(car), 0.1 * share, 0.05 * share), (0.0, 10.0 * share, 5.0 * share)
    return scene_content(CARS[car].drawn_as(points(value)), arm, rack, stop=1.0)


def _mixed_case(
    name: str,
    why: str,
    parameter: str,
    points: Callable[[float], Mapping[str, Array]],
    shrinking: bool,
    car: str = "paper",
) -> Case:
    return scene_case(
        name=name,
        group=GROUP,
        why=why,
        parameter=parameter,
        # Where it is refused, each refusal takes a second.
        values=(1.0, 1e-3, 1e-6, 1e-12) if car == "wishbone" else (*decades(-4), 1e-6, 1e-9, 1e-12),
        expected=dict.fromkeys(SOLVERS, MIXED),
        behaviour=f"right within the bound, or refused; right from {MIXED.right_from:g} up",
        scene=lambda value: mixed(value, points, shrinking, car),
    )


def _sizes(name: str, why: str, values: tuple[float, ...], car: str = "paper") -> Case:
    return scene_case(
        name=name,
        group=GROUP,
        why=why,
        parameter="size, in parts of a car of some 500 mm",
        values=values,
        expected=dict.fromkeys(SOLVERS, RIGHT),
        behaviour="right at every size, 1e-3 mm to 1e6 mm",
        scene=partial(scaled_car, car=car),
    )


ARM_AXIS = ("lower_arm_front", "lower_arm_rear")
LONG = "how long it is in the paper's car over how long it is"
CASES: tuple[Case, ...] = (
    Case(
        name="far-from-the-origin",
        group=GROUP,
        why="Coordinates far from the origin keep few digits of the car, and differences of them lose more.",
        parameter="1 mm over the distance along x; thrice as far along z",
        values=decades(),
        expected={"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": NEARER, "relative": NEARER},
        behaviour="rates and angles as right as at home, positions but for one rounding of a coordinate",
        examine=far,
        content=far_car,
    ),
    Case(
        name="far-from-the-origin-beside",
        group=GROUP,
        why="The same with the strut's axis beside the ball joint, which is one more difference of places.",
        parameter="1 mm over the distance along x; thrice as far along z",
        values=decades(),
        expected={"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": NEARER, "relative": NEARER},
        behaviour="rates and angles as right as at home, positions but for one rounding of a coordinate",
        examine=partial(far, car="beside"),
        content=partial(far_car, car="beside"),
    ),
    scene_case(
        name="far-and-heaved-back",
        group=GROUP,
        why="Drawn far up and heaved back, a car comes to stand near the origin by two far coordinates.",
        parameter="1 mm over the distance along up, which the heave cancels",
        values=decades(-9),
        expected=dict.fromkeys(SOLVERS, RIGHT),
        behaviour="right within the bound, rates and angles as right as at home",
        scene=heaved_back,
    ),
    _sizes(
        "sizes-by-powers-of-two",
        "Squares of small and large lengths differ by twice as many decades as the lengths.",
        tuple(2.0**k for k in range(11, -20, -3)),
    ),
    _sizes(
        "sizes-by-powers-of-ten",
        "As by powers of two, and every coordinate is rounded anew.",
        decades(-6, 4),
    ),
    _sizes(
        "sizes-beside",
        "By powers of ten with the strut's axis beside the ball joint.",
        decades(-6, 4),
        "beside",
    ),
    Case(
        name="far-from-the-origin-wishbone",
        group=GROUP,
        why="The same of a double wishbone, whose knuckle has no direction of its own.",
        parameter="1 mm over the distance along x; thrice as far along z",
        values=coarse(decades()),
        expected={"pointcoord": RIGHT, "pointcoord-newton": RIGHT, "absolute": NEARER, "relative": NEARER},
        behaviour="rates and angles as right as at home, positions but for one rounding of a coordinate",
        examine=partial(far, car="wishbone"),
        content=partial(far_car, car="wishbone"),
    ),
    scene_case(
        name="far-and-heaved-back-wishbone",
        group=GROUP,
        why="A double wishbone drawn far up and heaved back.",
        parameter="1 mm over the distance along up, which the heave cancels",
        values=coarse(decades(-9)),
        expected=dict.fromkeys(SOLVERS, RIGHT),
        behaviour="right within the bound, rates and angles as right as at home",
        scene=partial(heaved_back, car="wishbone"),
    ),
    _sizes(
        "sizes-wishbone",
        "By powers of ten, a double wishbone.",
        coarse(decades(-6, 4)),
        "wishbone",
    ),
    _mixed_case(
        "tie-rod-long-wishbone",
        "The tie rod of a double wishbone is up to 1e14 mm long.",
        LONG,
        partial(lengthened, points=("tie_rod_inner",), base="tie_rod_outer", car="wishbone"),
        False,
        "wishbone",
    ),
    _mixed_case(
        "arm-long-wishbone",
        "The lower arm of a double wishbone is up to 1e14 mm long; its angle shrinks with it.",
        LONG,
        partial(lengthened, points=ARM_AXIS, base="lower_ball_joint", car="wishbone"),
        True,
        "wishbone",
    ),
    _mixed_case(
        "upper-arm-long-wishbone",
        "The upper arm is up to 1e14 mm long, so that its ball joint moves on what is nearly a plane.",
        LONG,
        partial(
            lengthened,
            points=("upper_arm_front", "upper_arm_rear"),
            base="upper_ball_joint",
            car="wishbone",
        ),
        False,
        "wishbone",
    ),
    _mixed_case(
        "tie-rod-at-the-strut",
        "The tie rod ends as little as 1e-10 mm from the strut's foot, in a car of 500 mm.",
        "distance, in parts of what it is in the paper's car",
        nearer("tie_rod_outer", "strut_lower"),
        True,
    ),
    _mixed_case(
        "tie-rod-long",
        "The tie rod is up to 1e14 mm long, so that its outer end moves on what is nearly a plane.",
        LONG,
        partial(lengthened, points=("tie_rod_inner", "rack_centre"), base="tie_rod_outer"),
        False,
    ),
    _mixed_case(
        "strut-long",
        "The strut is up to 1e14 mm long, so that its direction hardly changes.",
        LONG,
        partial(lengthened, points=("strut_top", "strut_rod_end"), base="lower_ball_joint"),
        False,
    ),
    _mixed_case(
        "arm-long",
        "The arm is up to 1e14 mm long, so that a small angle is a long way; the angle shrinks with it.",
        LONG,
        partial(lengthened, points=ARM_AXIS, base="lower_ball_joint"),
        True,
    ),
    _mixed_case(
        "strut-long-beside",
        "The strut's top is up to 5e14 mm above a ball joint beside its axis, in a car of 500 mm.",
        LONG,
        partial(lengthened, points=("strut_top", "strut_rod_end"), base="strut_lower", car="beside"),
        False,
        "beside",
    ),
    _mixed_case(
        "arm-long-beside",
        "The arm is as long, its ball joint beside the axis of the strut.",
        LONG,
        partial(
            lengthened, points=("lower_arm_front", "lower_arm_rear"), base="lower_ball_joint", car="beside"
        ),
        True,
        "beside",
    ),
)
