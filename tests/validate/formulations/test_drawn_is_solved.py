"""What is drawn is what is solved: random cars of every suspension, by all mechanics.

A closed form of each suspension decides, in many digits; it is no part of any of the three.
"""

import math
from collections.abc import Mapping

import numpy as np
from cars_in_closed_form import DRAWN, cars_of, pose_of
from hypothesis import assume, given, note, settings
from hypothesis import strategies as st
from mechanism_closed_forms import NoPoseError

import absolute
from pointcoord import AssemblyError, InputOutOfRange, Scene, SceneError, simulate
from pointcoord.numerics.arrays import Array
from validate.cars.car import Car
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.formulations.registry import formulation
from validate.hard.subjects import drawn_angle, scene_content
from validate.reference import NoReferenceError

Places = Mapping[str, Array]

EPS = float(np.finfo(float).eps)
MODELS = ("pointcoord", "pointcoord-newton", "absolute", "relative")
SHARES = st.floats(-1.0, 1.0)
# A car is solved by four models, so the short profile searches briefly.
EXAMPLES = settings.default.max_examples if settings.default else 100
searched = settings(max_examples=EXAMPLES if EXAMPLES > 100 else 12)


def scene_at(car: Car, angle: float, rack: float) -> Scene:
    """A single instant of a car."""
    return Scene.from_mapping(scene_content(car, angle, rack, effects=()))


def solved(name: str, scene: Scene) -> Solution:
    """A model's solution; a car that it cannot assemble, or is refused as another car, is passed over."""
    try:
        return formulation(name).solve(scene)
    except FormulationError as error:
        of_drawing = isinstance(error.reason, absolute.PoseError) and error.reason.instant is None
        assume(not of_drawing)
        assume(not isinstance(error.reason, AssemblyError | InputOutOfRange | SceneError))
        raise
    except SceneError:
        assume(False)
        raise


def allowed(solution: Solution) -> float:
    """What a model says that its points may be off by, mm, carried ones too."""
    return max(float(claim.max()) for claim in solution.accuracy.claims["position"].values())


def true_places(scene: Scene) -> Places:
    try:
        instant = reference_instant(scene, inputs_at(scene, 0.0))
    except NoReferenceError:
        assume(False)
        raise
    return {name: np.array(instant.position_as_float(name)) for name in instant.position}


def off(one: Places, two: Places) -> dict[str, float]:
    return {name: float(np.abs(np.subtract(one[name], two[name])).max()) for name in one}


def drawn(car: Car) -> tuple[float, float]:
    """Arm angle and rack travel of a drawing, which is positive against `right`."""
    rack = car.array["tie_rod_inner"] - car.array.get("rack_centre", car.array["tie_rod_inner"])
    return drawn_angle(car), -float(rack @ np.array(car.right))


@searched
@given(cars_of(DRAWN), st.just((0.0, 0.0)) | st.tuples(SHARES, SHARES))
def test_all_mechanics_give_the_closed_form_which_at_its_own_inputs_gives_the_drawing(
    car: Car, moved: tuple[float, float]
) -> None:
    note(repr(car))
    angle, travel = drawn(car)
    scene = scene_at(car, angle + 0.25 * moved[0], travel + 20.0 * moved[1])
    asked = {name: inputs_at(scene, 0.0)[name][0] for name in ("arm_angle", "rack")}
    try:
        exact = {name: place.astype(float) for name, place in pose_of(Car.of(scene), **asked).items()}
    except NoPoseError:
        assume(False)
        raise
    far = max(float(np.abs(place).max()) for place in exact.values())
    last = 2.0 * EPS * far  # both are rounded
    first = solved("pointcoord", scene)
    for name in MODELS:
        solution = first if name == "pointcoord" else solved(name, scene)
        there = {n: place[0] for n, place in solution.numbers["position"].items()}
        for point, distance in off(there, exact).items():
            assert distance <= allowed(solution) + last, (name, point)
    for point, distance in off(true_places(scene), exact).items():
        assert distance <= last, ("reference", point)
    if moved == (0.0, 0.0):
        # The arm angle is rounded, by half a unit of its cosine and of itself, which raises the ball joint by
        # up to 2 pi u of the arm; each coordinate is rounded by half a unit where it is put on a line or
        # circle. The condition number says what comes of both, and a carried point moves farther.
        raised = float(first.accuracy.condition.max()) * max(
            1.0, float(simulate(scene).proof().carried_gain.max())
        )
        rounding = raised * EPS * (math.pi * math.sqrt(3.0) * car.size + far)
        for point, distance in off({n: np.array(p) for n, p in car.points.items()}, exact).items():
            assert distance <= rounding, point
