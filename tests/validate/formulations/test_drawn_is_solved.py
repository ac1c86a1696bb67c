"""What is drawn is what is solved: random cars of every suspension that has a closed form, in many digits.

tests/mechanisms compares the other models with the reference, and tests/oracle random cars.
"""

import math

import numpy as np
from cars_in_closed_form import DRAWN, cars_of, pose_of
from hypothesis import assume, given, note, settings
from hypothesis import strategies as st
from mechanism_closed_forms import NoPoseError

from pointcoord import AssemblyError, InputOutOfRange, Scene, SceneError, simulate
from validate.cars.car import Car
from validate.formulations.protocol import FormulationError
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.formulations.registry import formulation
from validate.hard.subjects import drawn_angle, scene_content
from validate.reference import NoReferenceError

EPS = float(np.finfo(float).eps)
SHARES = st.floats(-1.0, 1.0)
# The short profile searches briefly.
EXAMPLES = settings.default.max_examples if settings.default else 100
searched = settings(max_examples=EXAMPLES if EXAMPLES > 100 else 12)


@searched
@given(cars_of(DRAWN), st.just((0.0, 0.0)) | st.tuples(SHARES, SHARES))
def test_pointcoord_and_the_reference_give_the_closed_form_which_at_its_own_inputs_gives_the_drawing(
    car: Car, moved: tuple[float, float]
) -> None:
    note(repr(car))
    # The travel of a drawing is positive against `right`.
    rack = car.array["tie_rod_inner"] - car.array.get("rack_centre", car.array["tie_rod_inner"])
    angle, travel = drawn_angle(car) + 0.25 * moved[0], 20.0 * moved[1] - float(rack @ np.array(car.right))
    scene = Scene.from_mapping(scene_content(car, angle, travel, effects=()))
    inputs = inputs_at(scene, 0.0)
    try:
        exact = pose_of(Car.of(scene), **{name: inputs[name][0] for name in ("arm_angle", "rack")})
        solution = formulation("pointcoord").solve(scene)
        reference = reference_instant(scene, inputs)
    except (NoPoseError, NoReferenceError, SceneError):
        assume(False)
        raise
    except FormulationError as error:
        assume(not isinstance(error.reason, AssemblyError | InputOutOfRange | SceneError))
        raise
    right = {name: place.astype(float) for name, place in exact.items()}
    far = max(float(np.abs(place).max()) for place in right.values())
    last = 2.0 * EPS * far  # both are rounded
    claims = solution.accuracy.claims["position"]
    widest = max(float(claim.max()) for claim in claims.values())  # of carried points too
    for name, place in right.items():
        assert np.abs(solution.numbers["position"][name][0] - place).max() <= widest + last, name
        assert np.abs(np.array(reference.position[name], dtype=float) - place).max() <= last, name
    if moved == (0.0, 0.0):
        # The arm angle is rounded, by half a unit of its cosine and of itself, which raises the ball joint by
        # up to 2 pi u of the arm; each coordinate is rounded by half a unit where it is put on a line or
        # circle. The condition number says what comes of both, and a carried point moves farther.
        gain = max(1.0, float(simulate(scene).proof().carried_gain.max()))
        raised = float(solution.accuracy.condition.max()) * gain
        rounding = raised * EPS * (math.pi * math.sqrt(3.0) * car.size + far)
        for name, place in car.points.items():
            assert np.abs(np.array(place) - right[name]).max() <= rounding, name
