"""The car that is drawn is the car that is solved: positions and rates are those of the closed form."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from jets import errors_of
from kinds import KINDS, Array, Kind, inputs_at
from strut_motion import drawn_inputs

import absolute

EPS = float(np.finfo(float).eps)
SIZE = 500.0
# A collinear strut closes to another car than is drawn; `exact_form` is its own.
DRAWN = {name: kind for name, kind in KINDS.items() if name != "collinear strut"}


@settings(max_examples=60, deadline=None)
@given(name=st.sampled_from(sorted(KINDS)), seed=st.integers(0, 10**6))
def test_a_drawing_that_closes_comes_back_to_rounding(name: str, seed: int) -> None:
    kind = KINDS[name]
    car = kind.random_car(seed, True)
    # A drawing at its own dead point, or within rounding of it, is refused.
    exact = kind.exact(car, *((x, 0, 0) for x in drawn_inputs(car)))
    if exact is None or min(exact.margins) < 1e-4:
        return
    closed = absolute.close_drawing(kind.build(car))
    # Rounding of the rows and of the drawn inputs, magnified by the condition number.
    condition = 60.0 / float(min(exact.margins)) ** 0.5
    assert max(closed.movement.values()) <= EPS * SIZE * condition
    for point, place in car.items():
        assert np.abs(closed.position[point] - place).max() <= closed.movement[point]
    for value, wanted in zip(closed.inputs.values(), drawn_inputs(car), strict=True):
        assert abs(value - wanted) <= 4 * EPS * max(1.0, abs(wanted))


@settings(max_examples=90, deadline=None)
@given(name=st.sampled_from(sorted(DRAWN)), seed=st.integers(0, 10**6), closing=st.booleans())
def test_motion_of_random_cars_is_that_of_their_closed_form(name: str, seed: int, closing: bool) -> None:
    kind = DRAWN[name]
    car = kind.random_car(seed, closing)
    random = np.random.default_rng(seed)
    angle, rack = drawn_inputs(car)
    goal = (
        (angle + random.uniform(-0.3, 0.3), *random.uniform(-1, 1, 2)),
        (rack + random.uniform(-40, 40), *random.uniform(-200, 200, 2)),
    )
    exact = kind.exact(car, *goal)
    try:
        motion = absolute.solve(kind.build(car), inputs_at(*goal), conditions=True)
    except absolute.PoseError:
        # Beyond a limit, behind one on the way there, or the drawing itself is (not closing) beyond it.
        drawn = kind.exact(car, (angle, 0, 0), (rack, 0, 0))
        assert exact is None or drawn is None or min(*exact.margins, *drawn.margins) < 0.05
        return
    assert exact is not None
    assert motion.condition is not None
    condition = motion.condition[0]
    speed = max(np.abs(series).max() for series in motion.velocity.values())
    for power, (part, found, spins) in enumerate(
        (
            ("x", motion.position, {}),
            ("v", motion.velocity, motion.angular_velocity),
            ("a", motion.acceleration, motion.angular_acceleration),
        ),
        1,
    ):
        # The rates pass through the inverse once more than the pose they stand on.
        tolerance = 4 * EPS * condition**power * (SIZE if power == 1 else max(speed, speed**2 / SIZE, 200.0))
        for point, place in exact.points.items():
            error = errors_of([getattr(x, part) for x in place], found[point][0])
            assert error.max() <= tolerance, (point, part)
        for body, series in spins.items():
            assert errors_of(exact.spins[body][power - 2], series[0]).max() <= tolerance / SIZE, body


def test_steering_turns_the_knuckle_about_the_kingpin(kind: Kind) -> None:
    t = np.linspace(0.0, 1.0, 9)
    inputs: dict[str, Array] = {
        "arm_angle": np.tile([1.5, 0.0, 0.0], (9, 1)),
        "rack": np.stack([30 * t, np.full_like(t, 30.0), 0 * t], -1),
    }
    motion = absolute.solve(kind.build(kind.car), inputs, conditions=True)
    assert motion.condition is not None
    spin = motion.angular_velocity["knuckle"]
    axis = motion.position[kind.kingpin[1]] - motion.position[kind.kingpin[0]]
    axis /= np.linalg.norm(axis, axis=-1)[:, None]
    rate = np.linalg.norm(spin, axis=-1)
    assert (rate > 0.1).all()
    # The axis has the rounding of its ends over its length, which is above 50 mm.
    tolerance = EPS * motion.condition.max() * SIZE / 50.0
    assert np.allclose(np.cross(axis, spin / rate[:, None]), 0.0, atol=tolerance)


def test_a_rack_line_that_is_not_drawn_passes_through_the_drawn_end(kind: Kind) -> None:
    bare = {name: place for name, place in kind.car.items() if name != "rack_centre"}
    inputs = kind.inputs(np.array([1.0]))
    short = absolute.solve(kind.build(bare), inputs)
    full = absolute.solve(kind.build({**bare, "rack_centre": bare["tie_rod_inner"]}), inputs)
    for name, place in full.position.items():
        assert (short.position[name] == place).all()
